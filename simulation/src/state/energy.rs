//! The energy account of a motion: kinetic and potential energy, and the works of friction, impacts and
//! inputs.

/// The energies at one time and the works since the start, J. The sum of kinetic and potential energy changes
/// by the sum of the works, plus the works of prescribed motion and of loads without potential.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyAccount {
    /// kinetic energy
    pub kinetic: f64,
    /// potential energy of gravity and springs; `None` if it is not a function of the coordinates, or if one
    /// of these loads has none, as of a stiffness that depends on coordinates: that is an applied force
    pub potential: Option<f64>,
    /// work of friction in lasting contact, including its torques; not positive
    pub friction: f64,
    /// change of kinetic energy in impacts
    pub impacts: f64,
    /// work of the named inputs; 0 where loads have no value without them
    pub inputs: f64,
}

impl EnergyAccount {
    /// Kinetic plus potential energy; `None` if there is no potential energy, which is then undefined, not
    /// zero.
    pub fn total(&self) -> Option<f64> {
        self.potential.map(|potential| self.kinetic + potential)
    }
}
