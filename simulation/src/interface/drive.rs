//! The named inputs of a mechanism as functions of time and state, or from a sampled controller.

use std::fmt;
use std::sync::Arc;

/// A function that writes the inputs for a time, coordinates and speeds.
pub type InputFunction = Arc<dyn Fn(f64, &[f64], &[f64], &mut [f64]) + Send + Sync>;

/// A controller: it computes inputs at its sampling times, and may have a state. Every cloneable closure with
/// this signature is a controller.
pub trait Controller: Send {
    /// Writes the inputs for a time, coordinates and speeds; the slice contains the previous inputs.
    fn control(&mut self, time: f64, coordinates: &[f64], speeds: &[f64], inputs: &mut [f64]);
    /// A copy with the controller's state.
    fn boxed_clone(&self) -> Box<dyn Controller>;
}

impl<F> Controller for F
where
    F: FnMut(f64, &[f64], &[f64], &mut [f64]) + Clone + Send + 'static,
{
    fn control(&mut self, time: f64, coordinates: &[f64], speeds: &[f64], inputs: &mut [f64]) {
        self(time, coordinates, speeds, inputs);
    }

    fn boxed_clone(&self) -> Box<dyn Controller> {
        Box::new(self.clone())
    }
}

/// The source of the inputs of a mechanism.
#[derive(Default)]
pub enum Drive {
    /// Constant: the values of the start state.
    #[default]
    Held,
    /// A smooth function of time and state, evaluated within steps.
    Continuous(InputFunction),
    /// A sampled controller: computed every `period` seconds from the start on, and constant in between.
    Sampled {
        /// sampling time, s
        period: f64,
        /// the law of control
        controller: Box<dyn Controller>,
    },
    /// Values that are given beforehand, constant in between.
    Table(Samples),
}

/// Inputs at times k T after the start, k = 0, 1, ..; each remains until the next one, the last one to the end.
#[derive(Clone, Debug)]
pub struct Samples {
    /// T, s
    pub period: f64,
    /// for each k a number for every named input; one k at least
    pub values: Arc<[Vec<f64>]>,
}

impl Samples {
    /// The inputs from k T on.
    pub(crate) fn from(&self, k: usize) -> &[f64] {
        self.values.get(k).or(self.values.last()).map_or(&[], |values| &values[..])
    }
}

impl Clone for Drive {
    fn clone(&self) -> Self {
        match self {
            Self::Held => Self::Held,
            Self::Continuous(function) => Self::Continuous(Arc::clone(function)),
            Self::Sampled { period, controller } => {
                Self::Sampled { period: *period, controller: controller.boxed_clone() }
            }
            Self::Table(samples) => Self::Table(samples.clone()),
        }
    }
}

impl fmt::Debug for Drive {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Held => out.write_str("Held"),
            Self::Continuous(_) => out.write_str("Continuous"),
            Self::Sampled { period, .. } => write!(out, "Sampled({period} s)"),
            Self::Table(samples) => {
                write!(out, "Table({} s, {} samples)", samples.period, samples.values.len())
            }
        }
    }
}
