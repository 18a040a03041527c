//! The traits `Mechanism` and `Contacts` for the mechanism's type: slices in, the type's own methods, slices out.

mod contacts;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::Emitter;
use super::record::Record;
use super::routine::Arguments;
use crate::model::mechanism::{Orientation, Variable};
use crate::program::{PointQuantity, Quantity};
use crate::rust_names::snake_case;

/// What a method of the traits writes, and where.
struct Written {
    /// the type's own method
    method: Ident,
    /// the slice that receives the result
    slice: Ident,
    /// what is in the slice, for the message about its length
    what: &'static str,
}

impl Emitter<'_> {
    /// Both implementations, with the names and units that they tell.
    pub fn traits(&self) -> TokenStream {
        let description = self.description();
        let mechanism = self.mechanism_trait();
        let contacts = self.contacts_trait();
        quote! { #description #mechanism #contacts }
    }

    fn description(&self) -> TokenStream {
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
                quaternions: &[#(#quaternions),*],
            };
        }
    }

    fn mechanism_trait(&self) -> TokenStream {
        let (krate, name) = (self.krate, &self.name);
        let told = self.told();
        let parameters = self.parameters_by_slices();
        let quantities = self.quantities_by_slices();
        let configuration = self.configuration_by_slices();
        let geometry = self.geometry_by_slices();
        quote! {
            /// The methods of the same names, with slices.
            impl<T: #krate::Scalar> #krate::Mechanism<T> for #name<T> {
                #told
                #parameters
                #(#quantities)*
                #configuration
                #geometry
            }
        }
    }

    /// Names and numbers.
    fn told(&self) -> TokenStream {
        let krate = self.krate;
        quote! {
            fn name(&self) -> &str {
                DESCRIPTION.name
            }
            fn count(&self, kind: #krate::Kind) -> usize {
                DESCRIPTION.count(kind)
            }
            fn component(
                &self,
                kind: #krate::Kind,
                index: usize,
            ) -> ::core::option::Option<#krate::Component<'_>> {
                DESCRIPTION.component(kind, index)
            }
            fn dependent_coordinate(&self, index: usize) -> ::core::option::Option<usize> {
                DESCRIPTION.dependent_coordinates.get(index).copied()
            }
            fn normalize(&self, coordinates: &mut [T]) -> ::core::result::Result<(), #krate::StateError> {
                DESCRIPTION.normalize(coordinates)
            }
        }
    }

    /// Parameters and initial values.
    fn parameters_by_slices(&self) -> TokenStream {
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
            fn parameters(&self, parameters: &mut [T]) -> ::core::result::Result<(), #krate::StateError> {
                #get
            }
            fn set_parameters(
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

    /// The statements that make the arguments of a method of a `State`.
    fn unpack(&self, arguments: Arguments) -> TokenStream {
        let krate = self.krate;
        let record = |used: bool, record: &Record, variable: TokenStream, slice: &str| {
            used.then(|| {
                let (name, size) = (record.name(), Literal::usize_unsuffixed(record.len()));
                let field = format_ident!("{slice}");
                quote! {
                    let #variable = &<#name<T> as ::core::convert::From<[T; #size]>>::from(
                        #krate::generated::array::<T, #size>(state.#field, #slice)?,
                    );
                }
            })
        };
        let time = arguments.time.then(|| quote!(let time = state.time;));
        let coordinates = record(arguments.coordinates, &self.coordinates, quote!(q), "coordinates");
        let speeds = record(arguments.speeds, &self.speeds, quote!(u), "speeds");
        let inputs = record(arguments.inputs, &self.inputs, quote!(inputs), "inputs");
        quote! {
            DESCRIPTION.check(state)?;
            #time #coordinates #speeds #inputs
        }
    }

    /// The type's own method, called with what a `State` gives.
    fn own(&self, method: &Ident, quantities: &[Quantity]) -> (TokenStream, TokenStream) {
        let arguments = self.arguments(quantities);
        (self.unpack(arguments), {
            let passed = self.passed(arguments);
            quote!(Self::#method(self, #passed))
        })
    }

    /// The size of a record, where a quantity is one.
    fn record_of(&self, quantity: Quantity) -> Option<&Record> {
        match quantity {
            Quantity::CoordinateRates => Some(&self.coordinates),
            Quantity::Accelerations => Some(&self.speeds),
            Quantity::DependentSpeeds | Quantity::DependentAccelerations => Some(&self.dependent),
            _ => None,
        }
    }

    /// The statements that write a quantity into a slice; where the mechanism has none, the slice must be empty.
    fn written(&self, quantity: Quantity, to: &Written) -> TokenStream {
        let krate = self.krate;
        let Written { method, slice, what } = to;
        let Some(output) = self.program.output(quantity).filter(|output| !output.values.is_empty()) else {
            return quote! {
                DESCRIPTION.check(state)?;
                #krate::generated::check_length(#slice, 0, #what)
            };
        };
        let (unpack, call) = self.own(method, &[quantity]);
        let write = match self.record_of(quantity) {
            Some(record) => {
                let size = Literal::usize_unsuffixed(record.len());
                quote!(#krate::generated::write_array::<T, #size>(#slice, #call?, #what))
            }
            None => {
                let (rows, columns) =
                    (Literal::usize_unsuffixed(output.rows), Literal::usize_unsuffixed(output.columns));
                quote!(#krate::generated::write_rows::<T, #rows, #columns>(#slice, &#call?, #what))
            }
        };
        quote! { #unpack #write }
    }

    fn quantities_by_slices(&self) -> Vec<TokenStream> {
        let krate = self.krate;
        let vectors = [
            (Quantity::CoordinateRates, "coordinate_rates", "rates", "the rates of the coordinates"),
            (Quantity::Accelerations, "accelerations", "accelerations", "the accelerations"),
            (Quantity::DependentSpeeds, "dependent_speeds", "speeds", "the dependent speeds"),
            (
                Quantity::DependentAccelerations,
                "dependent_accelerations",
                "accelerations",
                "the dependent accelerations",
            ),
            (Quantity::MassMatrix, "mass_matrix", "matrix", "the mass matrix"),
            (Quantity::Forcing, "forcing", "forcing", "the forcing"),
        ];
        let mut methods: Vec<TokenStream> = vectors
            .into_iter()
            .map(|(quantity, method, slice, what)| {
                let to = Written { method: format_ident!("{method}"), slice: format_ident!("{slice}"), what };
                let body = self.written(quantity, &to);
                let Written { method, slice, .. } = to;
                quote! {
                    fn #method(
                        &self,
                        state: &#krate::State<'_, T>,
                        #slice: &mut [T],
                    ) -> ::core::result::Result<(), #krate::StateError> {
                        #body
                    }
                }
            })
            .collect();
        methods.push(self.inverse_dynamics_by_slices());
        methods.push(self.energies_by_slices());
        methods
    }

    fn inverse_dynamics_by_slices(&self) -> TokenStream {
        let krate = self.krate;
        let to = Written {
            method: format_ident!("inverse_dynamics"),
            slice: format_ident!("forces"),
            what: "the generalized forces",
        };
        let body = self.written(Quantity::InverseDynamics, &to);
        let given = self.given_accelerations();
        quote! {
            fn inverse_dynamics(
                &self,
                state: &#krate::State<'_, T>,
                accelerations: &[T],
                forces: &mut [T],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #given
                #body
            }
        }
    }

    /// The statement that makes the given rates of the independent speeds of a slice.
    fn given_accelerations(&self) -> TokenStream {
        let krate = self.krate;
        if self.speeds.is_empty() {
            return quote!(#krate::generated::check_length(accelerations, 0, "the accelerations")?;);
        }
        let size = Literal::usize_unsuffixed(self.speeds.len());
        quote! {
            let acceleration = &<Speeds<T> as ::core::convert::From<[T; #size]>>::from(
                #krate::generated::array::<T, #size>(accelerations, "the accelerations")?,
            );
        }
    }

    fn energies_by_slices(&self) -> TokenStream {
        let krate = self.krate;
        let energy = |quantity: Quantity, method: &str, result: TokenStream| {
            let method = format_ident!("{method}");
            let body = match self.program.output(quantity).filter(|output| !output.values.is_empty()) {
                Some(_) => {
                    let (unpack, call) = self.own(&method, &[quantity]);
                    match quantity {
                        Quantity::PotentialEnergy => {
                            quote!(#unpack ::core::result::Result::map(#call, ::core::option::Option::Some))
                        }
                        _ => quote!(#unpack #call),
                    }
                }
                None => {
                    let none = match quantity {
                        Quantity::PotentialEnergy => quote!(::core::option::Option::None),
                        _ => quote!(T::zero()),
                    };
                    quote! {
                        DESCRIPTION.check(state)?;
                        ::core::result::Result::Ok(#none)
                    }
                }
            };
            quote! {
                fn #method(
                    &self,
                    state: &#krate::State<'_, T>,
                ) -> ::core::result::Result<#result, #krate::StateError> {
                    #body
                }
            }
        };
        let kinetic = energy(Quantity::KineticEnergy, "kinetic_energy", quote!(T));
        let potential =
            energy(Quantity::PotentialEnergy, "potential_energy", quote!(::core::option::Option<T>));
        quote! { #kinetic #potential }
    }

    fn configuration_by_slices(&self) -> TokenStream {
        let krate = self.krate;
        let written = |quantity: Quantity, method: &str, slice: &str, what: &'static str| {
            let to = Written { method: format_ident!("{method}"), slice: format_ident!("{slice}"), what };
            self.written(quantity, &to)
        };
        let residual = written(
            Quantity::ConfigurationResidual,
            "configuration_residual",
            "residual",
            "the residual of the configuration equations",
        );
        let jacobian = written(
            Quantity::ConfigurationJacobian,
            "configuration_jacobian",
            "jacobian",
            "the derivatives of the configuration equations",
        );
        quote! {
            fn configuration(
                &self,
                state: &#krate::State<'_, T>,
                residual: &mut [T],
                jacobian: &mut [T],
            ) -> ::core::result::Result<(), #krate::StateError> {
                { #residual }?;
                #jacobian
            }
        }
    }

    /// A `match` over the numbers of a kind; what has no arm has no such thing.
    fn by_number(&self, number: &str, kind: &str, arms: Vec<(usize, TokenStream)>) -> TokenStream {
        let krate = self.krate;
        let (number, kind) = (format_ident!("{number}"), format_ident!("{kind}"));
        let arms = arms.into_iter().map(|(index, body)| {
            let index = Literal::usize_unsuffixed(index);
            quote!(#index => { #body })
        });
        quote! {
            match #number {
                #(#arms)*
                index => ::core::result::Result::Err(::core::convert::From::from(
                    #krate::StateError::Missing { kind: #krate::Kind::#kind, index },
                )),
            }
        }
    }

    /// What is written where the program does not have a quantity.
    fn undefined(&self, what: &str) -> TokenStream {
        let krate = self.krate;
        quote! {
            ::core::result::Result::Err(::core::convert::From::from(#krate::StateError::Undefined { what: #what }))
        }
    }

    fn geometry_by_slices(&self) -> TokenStream {
        let krate = self.krate;
        let m = self.mechanism;
        let point = |quantity: PointQuantity, method: &str, at_origin: TokenStream, what: &'static str| {
            let arms = m.points.iter().enumerate().map(|(index, point)| {
                let number = Quantity::Point(index as u32, quantity);
                let has = self.program.output(number).is_some_and(|output| !output.values.is_empty());
                let own = format_ident!("{method}_{}", snake_case(&point.name));
                let body = match (has, quantity) {
                    _ if index == 0 => quote!(DESCRIPTION.check(state)?; #at_origin),
                    (false, _) => self.undefined(what),
                    (true, PointQuantity::Jacobian) => {
                        let to = Written { method: own, slice: format_ident!("jacobian"), what };
                        self.written(number, &to)
                    }
                    (true, _) => {
                        let (unpack, call) = self.own(&own, &[number]);
                        quote!(#unpack #call)
                    }
                };
                (index, body)
            });
            self.by_number("point", "Point", arms.collect())
        };
        let zero = quote!(::core::result::Result::Ok(#krate::nalgebra::Vector3::zeros()));
        let given = self.given_accelerations();
        let acceleration =
            point(PointQuantity::Acceleration, "acceleration", zero.clone(), "acceleration of this point");
        let position = point(PointQuantity::Position, "position", zero.clone(), "position of this point");
        let velocity = point(PointQuantity::Velocity, "velocity", zero, "velocity of this point");
        let size = Literal::usize_unsuffixed(3 * self.speeds.len());
        let still = quote! {
            #krate::generated::check_length(jacobian, #size, "the partial velocities")?;
            jacobian.fill(T::zero());
            ::core::result::Result::Ok(())
        };
        let jacobian = point(PointQuantity::Jacobian, "jacobian", still, "the partial velocities");
        let frames = m.frames.iter().enumerate().map(|(index, frame)| {
            let quantity = Quantity::Orientation(index as u32);
            let body = if index == 0 {
                quote! {
                    DESCRIPTION.check(state)?;
                    ::core::result::Result::Ok(#krate::nalgebra::Matrix3::identity())
                }
            } else if self.program.output(quantity).is_some() {
                let (unpack, call) =
                    self.own(&format_ident!("orientation_{}", snake_case(&frame.name)), &[quantity]);
                quote!(#unpack #call)
            } else {
                self.undefined("orientation of this frame")
            };
            (index, body)
        });
        let orientation = self.by_number("frame", "Frame", frames.collect());
        let (vector, matrix) = (quote!(#krate::nalgebra::Vector3<T>), quote!(#krate::nalgebra::Matrix3<T>));
        quote! {
            fn position(
                &self,
                point: usize,
                state: &#krate::State<'_, T>,
            ) -> ::core::result::Result<#vector, #krate::StateError> {
                #position
            }
            fn velocity(
                &self,
                point: usize,
                state: &#krate::State<'_, T>,
            ) -> ::core::result::Result<#vector, #krate::StateError> {
                #velocity
            }
            fn acceleration(
                &self,
                point: usize,
                state: &#krate::State<'_, T>,
                accelerations: &[T],
            ) -> ::core::result::Result<#vector, #krate::StateError> {
                #given
                #acceleration
            }
            fn jacobian(
                &self,
                point: usize,
                state: &#krate::State<'_, T>,
                jacobian: &mut [T],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #jacobian
            }
            fn orientation(
                &self,
                frame: usize,
                state: &#krate::State<'_, T>,
            ) -> ::core::result::Result<#matrix, #krate::StateError> {
                #orientation
            }
        }
    }
}
