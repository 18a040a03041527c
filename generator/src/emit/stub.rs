//! The module of a model with mistakes: enough that one mistake does not cause ten.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::{Options, conformance};
use crate::model::mechanism::Mechanism;
use crate::program::operation::{Bits, Operation, Value};
use crate::program::{ContactQuantity as C, PointQuantity as P, Quantity as Q, Structure};
use crate::program::{Output, Program};
use crate::rust_names;

/// The module of a sound model whose derivation is missing: everything has its type, and nothing a meaning.
pub fn stub(mechanism: &Mechanism, options: &Options) -> TokenStream {
    let mut quantities = vec![
        Q::CoordinateRates,
        Q::DependentSpeeds,
        Q::MassMatrix,
        Q::Forcing,
        Q::Accelerations,
        Q::DependentAccelerations,
        Q::InverseDynamics,
        Q::KineticEnergy,
        Q::PotentialEnergy,
        Q::ConfigurationResidual,
        Q::ConfigurationJacobian,
        Q::ConstraintResidual,
    ];
    for (index, contact) in (0u32..).zip(&mechanism.contacts) {
        let all = [
            C::Normal,
            C::First,
            C::Second,
            C::Velocity,
            C::FreeAcceleration,
            C::PartialVelocities,
            C::Remainder,
            C::Reduced,
            C::Response,
            C::DependentResponse,
        ];
        quantities.extend(all.map(|quantity| Q::Contact(index, quantity)));
        quantities.extend(contact.gap.is_some().then_some(Q::Contact(index, C::Gap)));
    }
    for (index, _) in (0u32..).zip(&mechanism.points) {
        quantities.extend(
            [P::Position, P::Velocity, P::Jacobian, P::Acceleration]
                .map(|quantity| Q::Point(index, quantity)),
        );
    }
    quantities.extend((0u32..).zip(&mechanism.frames).map(|(index, _)| Q::Orientation(index)));
    let outputs = quantities.into_iter().filter_map(|quantity| {
        let (rows, columns) = conformance::shape(mechanism, quantity)?;
        Some(Output { quantity, rows, columns, values: vec![Value(0); rows * columns] })
    });
    let program = Program {
        operations: vec![Operation::Constant(Bits::new(0.0))],
        outputs: outputs.collect(),
        guards: vec![],
        structures: vec![Structure::General; mechanism.contacts.len()],
    };
    super::module(mechanism, &program, options)
        .unwrap_or_else(|_| skeleton(&options.module, Some(&mechanism.name), &options.tracked))
}

/// A module with the types that every mechanism has, and nothing in them. `tracked` as in [`super::Options`].
pub fn skeleton(module: &str, mechanism: Option<&str>, tracked: &[TokenStream]) -> TokenStream {
    let module = rust_names::ident(module);
    let name = rust_names::ident(&rust_names::type_name(mechanism.unwrap_or("Mechanism")));
    let records = ["Parameters", "Coordinates", "Speeds", "DependentSpeeds", "Inputs"]
        .map(|name| format_ident!("{name}"));
    quote! {
        /// The model has mistakes.
        #[allow(dead_code, clippy::all)]
        pub mod #module {
            #(const _: &[u8] = ::core::include_bytes!(#tracked);)*
            #(
                /// The model has mistakes.
                #[derive(Clone, Copy, Debug, Default, PartialEq)]
                pub struct #records<T = f64>(::core::marker::PhantomData<T>);
            )*
            /// The model has mistakes.
            #[derive(Clone, Copy, Debug, Default, PartialEq)]
            pub struct #name<T = f64>(::core::marker::PhantomData<T>);
        }
    }
}
