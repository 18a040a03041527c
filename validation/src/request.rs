//! Requests and answers.

use std::collections::BTreeMap;

use hodograph::{ComponentKind, Contacts, Law, Surface};
use hodograph_simulation::{ImpactsAtOnce, Options};
use serde::{Deserialize, Serialize};

use crate::toss::{Failure, Toss, follow};

/// Tosses of one mechanism with one set of constants.
#[derive(Deserialize)]
pub struct Request {
    /// `cube` or `elbow`
    mechanism: String,
    /// parameters of the model by name, SI units; others have the values of the model
    parameters: BTreeMap<String, f64>,
    mu: f64,
    e: f64,
    law: String,
    /// treatment of several impacts: `sequential`, `approaching`, or `sampled` with the seed
    together: String,
    #[serde(default)]
    seed: u64,
    /// relative and absolute tolerance of the integration
    tolerance: f64,
    /// longest computation of a toss, s
    patience: f64,
    /// time between frames, s
    frame: f64,
    tosses: Vec<Toss>,
}

/// What comes of a request.
#[derive(Default, Serialize)]
pub struct Answer {
    /// why nothing was computed
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<String>,
    /// coordinates in the order of the model at every frame of every toss; fewer frames where it failed
    frames: Vec<Vec<Vec<f64>>>,
    failures: Vec<Failure>,
}

impl Answer {
    /// An answer without motions.
    pub fn refused(why: String) -> Self {
        Self { refused: Some(why), ..Self::default() }
    }
}

/// Predicts all tosses of a request.
pub fn answer(request: &Request) -> Answer {
    let done = match request.mechanism.as_str() {
        "cube" => predict(crate::cube::Cube::<f64>::default(), request),
        "elbow" => predict(crate::elbow::Elbow::<f64>::default(), request),
        other => Err(format!("no mechanism `{other}`")),
    };
    done.unwrap_or_else(Answer::refused)
}

fn predict(mut mechanism: impl Contacts<f64>, request: &Request) -> Result<Answer, String> {
    let mut values = vec![0.0; mechanism.count(ComponentKind::Parameter)];
    mechanism.parameter_values(&mut values).map_err(|error| error.to_string())?;
    for (name, value) in &request.parameters {
        let place =
            mechanism.index(ComponentKind::Parameter, name).ok_or(format!("no parameter `{name}`"))?;
        values[place] = *value;
    }
    mechanism.set_parameter_values(&values).map_err(|error| error.to_string())?;
    let law = Law::named(&request.law).ok_or(format!("no law `{}`", request.law))?;
    let together = ImpactsAtOnce::named(&request.together, request.seed)
        .ok_or(format!("no treatment `{}`", request.together))?;
    let options = Options {
        relative_tolerance: request.tolerance,
        absolute_tolerance: request.tolerance,
        surface: Some(Surface { mu: request.mu, e: request.e, law }),
        together,
        ..Options::default()
    };
    let mut answer = Answer::default();
    for (index, toss) in request.tosses.iter().enumerate() {
        let (frames, failure) = follow(&mechanism, toss, &options, request.frame, request.patience);
        answer.frames.push(frames);
        answer.failures.extend(failure.map(|(kind, time, message)| Failure { index, kind, time, message }));
    }
    Ok(answer)
}
