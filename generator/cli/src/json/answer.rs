//! Writes an impact as JSON for `solve` and `collide`.

use hodograph::{Cause, Impact, Motion, Snapshot};
use serde::Serialize;

use super::characteristics::Characteristics;
use super::{Failure, Kind};

/// The outcome of an impact.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// impulse on the striking point along n, t, s, N s
    pub impulse: [f64; 3],
    /// velocity of separation along n, t, s, m/s
    pub v: [f64; 3],
    /// work of the contact impulse (23), J
    #[serde(rename = "dE")]
    pub contact_work: f64,
    /// work of the normal impulse (35b), J
    #[serde(rename = "dEn")]
    pub normal_work: f64,
    /// the phases of the collision
    pub path: &'static [&'static str],
    /// number of compression phases
    pub compressions: u32,
    /// why a small change of the input may change the outcome considerably
    pub sensitivity: Vec<&'static str>,
    /// the number of steps of a method other than `exact`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<u32>,
    /// the states at the requested normal impulses
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub at: Vec<At>,
    /// the characteristic quantities, if requested
    #[serde(skip_serializing_if = "Option::is_none")]
    pub characteristics: Option<Characteristics>,
}

/// The state at a normal impulse.
#[derive(Clone, Debug, Serialize)]
pub struct At {
    /// impulse so far along n, t, s, N s
    pub impulse: [f64; 3],
    /// velocity along n, t, s, m/s
    pub v: [f64; 3],
    /// work of the contact impulse so far, J
    #[serde(rename = "dE")]
    pub contact_work: f64,
    /// work of the normal impulse so far, J
    #[serde(rename = "dEn")]
    pub normal_work: f64,
    /// the mode of the contact
    pub motion: &'static str,
}

impl From<Snapshot<f64>> for At {
    fn from(snapshot: Snapshot<f64>) -> Self {
        At {
            impulse: snapshot.impulse.map(|number| number + 0.0).into(),
            v: snapshot.velocity.map(|number| number + 0.0).into(),
            contact_work: snapshot.contact_work + 0.0,
            normal_work: snapshot.normal_work + 0.0,
            motion: match snapshot.motion {
                Motion::Sliding => "sliding",
                Motion::Sticking => "sticking",
                Motion::Renewal => "renewal",
            },
        }
    }
}

impl TryFrom<&Impact<f64>> for Answer {
    type Error = Failure;

    /// # Errors
    ///
    /// `not_finite` if the outcome is out of the range of doubles.
    fn try_from(impact: &Impact<f64>) -> Result<Self, Failure> {
        let works = [impact.contact_work, impact.normal_work];
        if !impact.impulse.iter().chain(impact.velocity.iter()).chain(&works).all(|number| number.is_finite())
        {
            return Err(Failure::new(
                Kind::Of(Cause::NotFinite),
                "the outcome is out of the range of doubles: choose units in which the numbers are nearer to 1",
            ));
        }
        // Replace negative zeros for readers.
        Ok(Answer {
            impulse: impact.impulse.map(|number| number + 0.0).into(),
            v: impact.velocity.map(|number| number + 0.0).into(),
            contact_work: impact.contact_work + 0.0,
            normal_work: impact.normal_work + 0.0,
            path: impact.path.phases(),
            compressions: impact.compressions,
            sensitivity: impact.sensitivity.names().collect(),
            steps: None,
            at: Vec::new(),
            characteristics: None,
        })
    }
}
