//! Quantities of the whole mechanism for the trait `Mechanism`: equations of motion, energies, configuration
//! equations.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::Written;
use crate::Emitter;
use hodograph_program::program::Quantity;

impl Emitter<'_> {
    pub(super) fn quantities_by_slices(&self) -> Vec<TokenStream> {
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

    pub(super) fn configuration_by_slices(&self) -> TokenStream {
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
}
