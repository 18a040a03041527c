//! Names, units and counts of a mechanism, its parameters and its initial state, for the trait `Mechanism`.

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use crate::Emitter;
use hodograph_model::model::mechanism::{Orientation, Variable};

impl Emitter<'_> {
    pub(super) fn description(&self) -> TokenStream {
        let krate = self.krate;
        let m = self.mechanism;
        let component = |name: &str, unit: &str| quote!(#krate::Component { name: #name, unit: #unit });
        let declared = |quantity: &Variable| {
            component(&quantity.name, if quantity.unit.is_empty() { "1" } else { &quantity.unit })
        };
        let parameters = m.parameters.iter().filter(|parameter| !parameter.fixed).map(declared);
        let coordinates = m.coordinates.iter().map(declared);
        let followers = (0..m.coordinates.len()).filter(|&index| m.coordinates[index].dependent);
        let followers = followers.map(Literal::usize_unsuffixed);
        let speeds = m.speeds.iter().filter(|speed| !speed.dependent).map(declared);
        let dependent = m.speeds.iter().filter(|speed| speed.dependent).map(declared);
        let inputs = m.inputs.iter().map(declared);
        let points = m.points.iter().map(|point| component(&point.name, ""));
        let frames = m.frames.iter().map(|frame| component(&frame.name, ""));
        let contacts = m.contacts.iter().map(|contact| component(&contact.name, ""));
        let quantities = self.named_quantities();
        let quantities = quantities.iter().map(|quantity| quantity.description());
        let quantities = quantities.map(|row| component(row.word, row.unit));
        let quaternions = m.frames.iter().filter_map(|frame| match &frame.orientation {
            Orientation::Quaternion(ids) => {
                let ids = ids.iter().map(|id| Literal::usize_unsuffixed(id.0));
                Some(quote!([#(#ids),*]))
            }
            _ => None,
        });
        let name = &m.name;
        quote! {
            const DESCRIPTION: #krate::generated::Description = #krate::generated::Description {
                name: #name,
                parameters: &[#(#parameters),*],
                coordinates: &[#(#coordinates),*],
                dependent_coordinates: &[#(#followers),*],
                speeds: &[#(#speeds),*],
                dependent_speeds: &[#(#dependent),*],
                inputs: &[#(#inputs),*],
                points: &[#(#points),*],
                frames: &[#(#frames),*],
                contacts: &[#(#contacts),*],
                quantities: &[#(#quantities),*],
                quaternions: &[#(#quaternions),*],
            };
        }
    }

    /// Names and counts.
    pub(super) fn names_and_counts(&self) -> TokenStream {
        let krate = self.krate;
        quote! {
            fn name(&self) -> &str {
                DESCRIPTION.name
            }
            fn count(&self, kind: #krate::ComponentKind) -> usize {
                DESCRIPTION.count(kind)
            }
            fn component(
                &self,
                kind: #krate::ComponentKind,
                index: usize,
            ) -> ::core::option::Option<#krate::Component<'_>> {
                DESCRIPTION.component(kind, index)
            }
            fn dependent_coordinate(&self, index: usize) -> ::core::option::Option<usize> {
                DESCRIPTION.dependent_coordinates.get(index).copied()
            }
            fn normalise(&self, coordinates: &mut [T]) -> ::core::result::Result<(), #krate::StateError> {
                DESCRIPTION.normalise(coordinates)
            }
        }
    }

    /// Parameters and initial values.
    pub(super) fn parameters_by_slices(&self) -> TokenStream {
        let krate = self.krate;
        let (get, set) = if self.parameters.is_empty() {
            (
                quote!(#krate::generated::check_length(parameters, 0, "parameters")),
                quote! {
                    #krate::generated::check_length(parameters, 0, "parameters")?;
                    ::core::result::Result::Ok(())
                },
            )
        } else {
            let size = Literal::usize_unsuffixed(self.parameters.len());
            (
                quote!(#krate::generated::write_array::<T, #size>(parameters, self.parameters, "parameters")),
                quote! {
                    let parameters = #krate::generated::array::<T, #size>(parameters, "parameters")?;
                    Self::set_parameters(self, ::core::convert::From::from(parameters))
                },
            )
        };
        let initial =
            [(&self.coordinates, "coordinates"), (&self.speeds, "speeds"), (&self.inputs, "inputs")].map(
                |(record, slice)| {
                    let variable = format_ident!("{slice}");
                    if record.is_empty() {
                        return quote!(#krate::generated::check_length(#variable, 0, #slice)?;);
                    }
                    let (name, size) = (record.name(), Literal::usize_unsuffixed(record.len()));
                    quote! {
                        let values = <#name<T> as ::core::default::Default>::default();
                        #krate::generated::write_array::<T, #size>(#variable, values, #slice)?;
                    }
                },
            );
        quote! {
            fn parameter_values(&self, parameters: &mut [T]) -> ::core::result::Result<(), #krate::StateError> {
                #get
            }
            fn set_parameter_values(
                &mut self,
                parameters: &[T],
            ) -> ::core::result::Result<(), #krate::ParameterError> {
                #set
            }
            fn initial_state(
                &self,
                coordinates: &mut [T],
                speeds: &mut [T],
                inputs: &mut [T],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #(#initial)*
                ::core::result::Result::Ok(())
            }
        }
    }
}
