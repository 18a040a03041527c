//! The task of a fit, and why it fails.

use std::fmt;

use crate::{By, GradientError, Loss, Trajectory};

/// The task of a fit.
#[derive(Clone, Debug)]
pub struct FitTask<'a> {
    /// the motions
    pub trajectories: &'a [Trajectory],
    /// the measured quantities: indices into coordinates followed by independent speeds
    pub measured: &'a [usize],
    /// the divisors of the differences of each quantity: its measurement error, or its scale
    pub units: &'a [f64],
    /// parameters, mu and e
    pub variables: &'a [By],
    /// what a difference costs
    pub loss: Loss,
    /// duration from the start of each motion, s, within which nothing is struck: its start state is fitted to the first row
    /// and to the samples within it, with the values that are tried; `None` takes the first row as it is
    pub flight: Option<f64>,
    /// durations from the start, s, increasing: the values are fitted to the samples within the first one, then from there to
    /// those within the next one, and so on, at last to all
    pub horizons: &'a [f64],
    /// number of starts, at least 1: that of the mechanism and the options, and others at random, from a quarter to four
    /// times its values
    pub starts: usize,
    /// number of bootstrap samples, none or two at least: trajectories are drawn with replacement and fitted again
    pub bootstrap: usize,
    /// the seed of the starts and the bootstrap samples
    pub seed: u64,
}

/// Why a fit fails.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum FitError {
    /// A motion cannot be simulated with the initial values: the trajectory, and the error.
    Motion(String, GradientError),
    /// The differences between this trajectory and its motion are out of the range of doubles.
    NotFinite(String),
    /// The task has a mistake.
    BadRequest(String),
}

impl fmt::Display for FitError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Motion(name, error) => write!(out, "trajectory {name}: {error}"),
            Self::NotFinite(name) => write!(
                out,
                "trajectory {name}: the squares of its differences are out of the range of doubles: look at its start, and at the errors of \
                 its measurements"
            ),
            Self::BadRequest(what) => out.write_str(what),
        }
    }
}

impl std::error::Error for FitError {}
