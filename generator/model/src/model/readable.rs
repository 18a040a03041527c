//! Records which parts of a mechanism were read without mistakes.

/// The parts of a mechanism that say what the model says; the others, which hold a mistake or rest on one,
/// hold stand-ins.
#[derive(Clone, Debug, Default)]
pub struct Readable {
    /// all that says how it moves: names, quantities, definitions, frames, points and equations
    pub motion: bool,
    /// the initial values of the coordinates
    pub initial_values: bool,
    /// the orientation of each frame
    pub frames: Vec<bool>,
    /// the mass of each body and particle
    pub masses: Vec<bool>,
    /// each body and particle as a whole
    pub bodies: Vec<bool>,
    /// each shape
    pub shapes: Vec<bool>,
    /// each contact
    pub contacts: Vec<bool>,
}

impl Readable {
    /// Whether the motion and all that has mass can be read.
    pub fn is_whole(&self) -> bool {
        self.motion && self.bodies.iter().all(|body| *body)
    }
}
