//! A simulation together with the mechanism that it borrows.

use std::sync::Arc;

use hodograph::{Contacts, State};
use hodograph_simulation::{Options, Simulation, SimulationError};

/// A motion and its mechanism.
pub struct Running {
    // Dropped first, since it borrows from the mechanism.
    simulation: Simulation<'static>,
    mechanism: Arc<dyn Contacts<f64>>,
}

impl Running {
    /// A motion that starts in this state.
    ///
    /// # Errors
    ///
    /// Those of [`Simulation::new`].
    pub fn begin(
        mechanism: Arc<dyn Contacts<f64>>,
        state: &State<'_>,
        options: Options,
    ) -> Result<Self, SimulationError> {
        // SAFETY: the mechanism stands in the heap, where it stays until the last clone of the `Arc` is gone. This struct
        // keeps one, lets nobody change it, and drops the simulation before it; no reference to the simulation with its
        // false lifetime leaves the struct, since `simulation` and `with` shorten it.
        let borrowed: &'static dyn Contacts<f64> = unsafe { &*Arc::as_ptr(&mechanism) };
        Ok(Self { simulation: Simulation::new(borrowed, state, options)?, mechanism })
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &dyn Contacts<f64> {
        &*self.mechanism
    }

    /// The motion. Do not store a reference to its own `mechanism()`; use that of this struct.
    pub fn simulation(&self) -> &Simulation<'_> {
        &self.simulation
    }

    /// Changes the motion.
    pub fn with<R>(&mut self, change: impl FnOnce(&mut Simulation<'_>) -> R) -> R {
        // A closure for every lifetime cannot store a shorter reference in the simulation.
        change(&mut self.simulation)
    }
}
