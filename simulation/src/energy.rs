//! The energy account of a motion: kinetic and potential energy, and the works of friction, impacts and
//! inputs.

/// The energies at one time and the works since the start, J. The sum of kinetic and potential energy changes
/// by the sum of the works, and by the works of prescribed motion and of loads without potential.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyAccount {
    /// kinetic energy
    pub kinetic: f64,
    /// potential energy of gravity and springs; `None` where the model has neither, or where it is not a
    /// function of the coordinates
    pub potential: Option<f64>,
    /// work of friction in contact that lasts, that of its torques among it, not positive
    pub friction: f64,
    /// change of kinetic energy in impacts
    pub impacts: f64,
    /// work of the named inputs
    pub inputs: f64,
}

impl EnergyAccount {
    /// Kinetic and potential energy; `None` where there is no potential energy: it is not zero where it is
    /// not defined.
    pub fn total(&self) -> Option<f64> {
        self.potential.map(|potential| self.kinetic + potential)
    }
}
