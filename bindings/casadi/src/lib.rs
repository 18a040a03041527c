//! Mechanisms as external functions of CasADi.
//!
//! [`external!`] makes a generated module four C functions with which `casadi.external` calls it, each with
//! its Jacobian: a shared library (`crate-type = ["cdylib"]`) that has
//!
//! ```ignore
//! hodograph::mechanism!("cart_pole.mech");
//! hodograph_casadi::external!("cart_pole" => cart_pole::CartPole(q, u, inputs));
//! ```
//!
//! offers, with n coordinates, p independent speeds and m named inputs,
//!
//! | function | inputs | outputs |
//! | --- | --- | --- |
//! | `cart_pole` | `q` (n), `u` (p), `inputs` (m) | `q_rates` (n), `u_rates` (p): the right side of the equations of motion |
//! | `cart_pole_inverse_dynamics` | `q` (n), `u` (p), `acceleration` (p), `inputs` (m) | `forces` (p): generalised forces that must be added to the loads |
//!
//! Units and order are those of the model; `inputs` is there only where the model has some. Jacobians are
//! those of `accelerations_derivatives`, `coordinate_rates_derivatives`, `inverse_dynamics_derivatives` and
//! `mass_matrix`: programs of their own, without steps and truncation. Where the module answers an error (a
//! singular state, a number that is not finite), the function returns 1, which CasADi reports as a failed
//! evaluation; optimisers such as IPOPT then shorten their step. `NAME_last_error()`, a function of C without arguments, answers why
//! the last evaluation of the calling thread that failed did so, as `singular_state: the state is singular: ..`.
//!
//! Parameters are those that the model states. A mechanism with closed loops has coordinates that follow
//! others, so its rates are no function of freely chosen coordinates: CasADi refuses to load it, and stderr
//! says why. For a model with explicit time `external!` does not compile: its modules ask for the time first.
//!
//! Safe code computes ([`Function`]); `unsafe` is in the module `abi`, which copies numbers from and to C,
//! and in the symbols of [`external!`].

#![deny(unsafe_code)]

#[allow(unsafe_code)]
mod abi;
mod functions;
mod layout;
mod symbols;

#[doc(hidden)]
pub use abi::{Int, evaluate, last_error, work};
pub use functions::{Dynamics, Function, InverseDynamics, InverseDynamicsJacobian, Rates, RatesJacobian};
pub use layout::{Block, Layout};

#[doc(hidden)]
pub use hodograph;
