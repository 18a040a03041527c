//! What both programs do at each sample: predict what a collision of the two sleds would do, within a budget.

#![no_std]

hodograph::mechanism!("../../../models/two_sleds.mech");

use hodograph::{CollisionError, ImpactError, Law, Surface};
use two_sleds::{Coordinates, Speeds, TwoSleds};

/// Samples per second.
pub const RATE: u32 = 1000;
/// Instructions of the processor per second.
pub const CLOCK: u32 = 12_000_000;
/// The most quadratures of a collision.
pub const BUDGET: u32 = 8;

/// The controller: what it knows of the mechanism, and what it does where a collision has no answer in time.
#[derive(Debug)]
pub struct Controller {
    sleds: TwoSleds<f32>,
    last: Speeds<f32>,
}

impl Default for Controller {
    fn default() -> Self {
        Controller { sleds: TwoSleds::default(), last: Speeds::default() }
    }
}

impl Controller {
    /// The speeds after a collision in this state; the last ones known where it takes more than the budget.
    pub fn sample(
        &mut self,
        q: &Coordinates<f32>,
        u: &Speeds<f32>,
    ) -> Result<Speeds<f32>, CollisionError<f32>> {
        let surface = Surface { mu: 0.6, e: 0.8, law: Law::Stronge }.with_budget(BUDGET);
        match self.sleds.collide_bc_ac(q, u, &surface) {
            Ok(hit) => self.last = hit.speeds,
            Err(CollisionError::Impact(ImpactError::BudgetExceeded { .. })) => {}
            Err(error) => return Err(error),
        }
        Ok(self.last)
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
