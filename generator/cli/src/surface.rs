//! Reads laws of restitution by name, and the surfaces of a contact from options.

use hodograph::{Law, Surface};

use crate::json::{Failure, Kind};

/// The law of that name.
///
/// # Errors
///
/// `unknown_name`.
pub fn law(name: &str) -> Result<Law, Failure> {
    Law::named(name).ok_or_else(|| {
        Failure::new(Kind::UnknownName, format!("there is no law `{name}`: give newton, poisson or stronge"))
    })
}

/// The surfaces as they stand on the command line.
#[derive(Clone, Debug, clap::Args)]
pub struct SurfaceArguments {
    /// Coulomb's coefficient of friction, not negative
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    pub mu: f64,
    /// coefficient of restitution, between 0 and 1
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    pub e: f64,
    /// hypothesis of restitution: newton, poisson or stronge
    #[arg(long, value_name = "LAW")]
    pub law: String,
}

impl SurfaceArguments {
    /// The surfaces; the solver checks the numbers.
    ///
    /// # Errors
    ///
    /// `unknown_name`, `not_finite`.
    pub fn surface(&self) -> Result<Surface<f64>, Failure> {
        for (option, value) in [("--mu", self.mu), ("--e", self.e)] {
            if !value.is_finite() {
                return Err(Failure::new(
                    Kind::NotFinite,
                    format!("{option} is {value}: give a finite number"),
                ));
            }
        }
        Ok(Surface { mu: self.mu, e: self.e, law: law(&self.law)? })
    }
}
