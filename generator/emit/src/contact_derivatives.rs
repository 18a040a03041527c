//! Emits a routine for the quantities of a collision together with their derivatives with respect to the
//! state.

use std::ops::Range;

use proc_macro2::{Ident, TokenStream};
use quote::quote;

use super::Emitter;
use super::interface::{Field, Struct, Type};
use super::routine::Routine;
use super::values::local;
use hodograph_program::program::{ContactQuantity, Output};

impl Emitter<'_> {
    /// The struct of a contact with its derivatives; `None` if no contact has them.
    pub fn contact_derivatives_record(&self) -> Option<Struct> {
        let mut contacts = 0..self.mechanism.contacts.len();
        contacts.find(|&contact| self.contact_derivatives(contact).is_some())?;
        let [p, n, m] = self.derivative_sizes();
        let response = Type::of_shape(p, 3);
        let field = |name: &str, of: Type, docs: &str| Field::new(name, of, docs);
        let fields = vec![
            field("velocity", Type::Vector(3), "velocity along the contact basis, in m/s"),
            field(
                "velocity_by_coordinates",
                Type::of_shape(3, n),
                "its derivatives with respect to the coordinates",
            ),
            field(
                "velocity_by_speeds",
                Type::of_shape(3, p),
                "its derivatives with respect to the speeds: the partial velocities",
            ),
            field(
                "velocity_by_inputs",
                Type::of_shape(3, m),
                "its derivatives with respect to the named inputs",
            ),
            field("reduced", Type::Reduced, "reduced mass matrix along the contact basis, in 1/kg"),
            field(
                "reduced_by_coordinates",
                Type::of_shape(6, n),
                "derivatives of nn, nt, ns, tt, ts, ss (rows) with respect to the coordinates",
            ),
            field("response", response.clone(), "response M^-1 V^T, as of the method `response_..`"),
            field(
                "response_by_coordinates",
                Type::Array(Box::new(response), n),
                "its derivatives with respect to each coordinate",
            ),
            field("gap", Type::Optional(Box::new(Type::Number)), "gap, in m, where the model gives one"),
            field(
                "gap_by_coordinates",
                Type::Optional(Box::new(Type::Vector(n))),
                "its derivatives with respect to the coordinates",
            ),
        ];
        let docs = "What a collision at a contact is made of, with its derivatives. Columns belong to the independent coordinates, independent speeds and named \
                    inputs, in their order; dependent ones follow.";
        Some(Struct::of_results("ContactDerivatives", docs, fields))
    }

    /// Numbers of independent speeds, independent coordinates and named inputs.
    fn derivative_sizes(&self) -> [usize; 3] {
        let p = self.speeds.len();
        [p, self.mechanism.independent_states() - p, self.mechanism.inputs.len()]
    }

    /// The routine of a contact with its derivatives.
    pub fn contact_derivatives(&self, contact: usize) -> Option<Routine> {
        if !self.collides(contact) {
            return None;
        }
        let output = self.contact_output(contact, ContactQuantity::Derivatives)?;
        let [p, n, m] = self.derivative_sizes();
        let krate = self.krate;
        let matrix = |rows: Range<usize>, columns: Range<usize>| self.entries(output, rows, columns);
        let (coordinates, speeds, inputs) = (1..1 + n, 1 + n..1 + n + p, 1 + n + p..1 + n + p + m);
        let velocity = matrix(0..3, 0..1);
        let [by_coordinates, by_speeds, by_inputs] =
            [coordinates.clone(), speeds, inputs].map(|columns| matrix(0..3, columns));
        let reduced: Vec<Ident> = (3..9).map(|row| local(output.values[row * output.columns])).collect();
        let reduced_by = matrix(3..9, coordinates.clone());
        let response = self.response_of(output, 0);
        let response_by = coordinates.clone().map(|column| self.response_of(output, column));
        let gap = 9 + 3 * p;
        let (gap, gap_by) = match output.values.get(gap * output.columns) {
            Some(&value) => {
                let value = local(value);
                let entries = coordinates.map(|column| local(output.values[gap * output.columns + column]));
                let by = if n == 0 {
                    quote!(#krate::nalgebra::SVector::zeros())
                } else {
                    quote!(#krate::nalgebra::SVector::from([#(#entries),*]))
                };
                (quote!(::core::option::Option::Some(#value)), quote!(::core::option::Option::Some(#by)))
            }
            None => (quote!(::core::option::Option::None), quote!(::core::option::Option::None)),
        };
        let value = quote! {
            ContactDerivatives {
                velocity: #velocity,
                velocity_by_coordinates: #by_coordinates,
                velocity_by_speeds: #by_speeds,
                velocity_by_inputs: #by_inputs,
                reduced: #krate::ReducedMatrix::new(#(#reduced),*),
                reduced_by_coordinates: #reduced_by,
                response: #response,
                response_by_coordinates: [#(#response_by),*],
                gap: #gap,
                gap_by_coordinates: #gap_by,
            }
        };
        let docs = format!(
            "Velocity, reduced mass matrix, response and gap at {} with their derivatives by the state, in one call.",
            self.contact_words(contact)
        );
        let name = self.contact_method("contact_derivatives", contact);
        Some(Routine {
            name,
            docs,
            quantities: vec![output.quantity],
            answer: Type::of_struct("ContactDerivatives"),
            value,
        })
    }

    /// Some rows and columns of an output.
    fn entries(&self, output: &Output, rows: Range<usize>, columns: Range<usize>) -> TokenStream {
        let krate = self.krate;
        if columns.is_empty() {
            return quote!(#krate::nalgebra::SMatrix::zeros());
        }
        let columns = columns.map(|column| {
            let entries = rows.clone().map(|row| local(output.values[row * output.columns + column]));
            quote!([#(#entries),*])
        });
        quote!(#krate::nalgebra::SMatrix::from([#(#columns),*]))
    }

    /// The response, or its derivative, in a column of the output: it stands there by rows.
    fn response_of(&self, output: &Output, column: usize) -> TokenStream {
        let krate = self.krate;
        let p = self.speeds.len();
        if p == 0 {
            return quote!(#krate::nalgebra::SMatrix::zeros());
        }
        let columns = (0..3).map(|axis| {
            let entries =
                (0..p).map(|speed| local(output.values[(9 + 3 * speed + axis) * output.columns + column]));
            quote!([#(#entries),*])
        });
        quote!(#krate::nalgebra::SMatrix::from([#(#columns),*]))
    }
}
