//! Reads the state in which a model is evaluated from a JSON object of names and numbers.

use std::collections::HashSet;

use hodograph_generator::model::mechanism::{Mechanism, Orientation, Variable};
use hodograph_generator::numeric::start::{self, Given};

use super::fields::number;
use super::{Failure, Fields, Json, Kind};
use crate::spelling;

/// The values of everything that a model leaves open.
#[derive(Clone, Debug)]
pub struct State {
    /// s
    pub time: f64,
    /// per parameter of the mechanism, in its declared unit (fixed ones too)
    pub parameters: Vec<f64>,
    /// per input
    pub inputs: Vec<f64>,
    /// per coordinate
    pub coordinates: Vec<f64>,
    /// per independent speed
    pub speeds: Vec<f64>,
}

impl State {
    /// The same state for the numeric evaluation of the generator.
    pub fn to_numeric(&self) -> hodograph_generator::numeric::State {
        hodograph_generator::numeric::State {
            parameters: self.parameters.clone(),
            inputs: self.inputs.clone(),
            time: self.time,
            coordinates: self.coordinates.clone(),
            speeds: self.speeds.clone(),
        }
    }
}

/// Number of independent speeds, which come first in `Mechanism::speeds`.
pub fn independent(mechanism: &Mechanism) -> usize {
    mechanism.speeds.iter().filter(|speed| !speed.dependent).count()
}

fn values(quantities: &[Variable]) -> Vec<f64> {
    quantities.iter().map(|quantity| quantity.value.unwrap_or(0.0)).collect()
}

impl State {
    /// The same state for the traits of mechanisms.
    pub fn borrowed(&self) -> hodograph::State<'_> {
        let State { time, coordinates, speeds, inputs, .. } = self;
        hodograph::State { time: *time, coordinates, speeds, inputs }
    }

    /// The values of the model file, 0 for those that it does not state, and unit quaternions.
    pub fn initial(mechanism: &Mechanism) -> Self {
        let mut state = State {
            time: 0.0,
            parameters: values(&mechanism.parameters),
            inputs: values(&mechanism.inputs),
            coordinates: values(&mechanism.coordinates),
            speeds: values(&mechanism.speeds[..independent(mechanism)]),
        };
        for frame in &mechanism.frames {
            if let Orientation::Quaternion([scalar, ..]) = frame.orientation
                && mechanism.coordinates[scalar.0].value.is_none()
            {
                state.coordinates[scalar.0] = 1.0;
            }
        }
        state
    }

    /// Sets the values in `{"parameters":{..},"t":0,"q":{..},"u":{..},"inputs":{..}}`, all of it optional,
    /// and returns the names of the given values.
    ///
    /// # Errors
    ///
    /// `bad_json`, `unknown_name`, `not_finite`.
    pub fn read(&mut self, text: &str, mechanism: &Mechanism) -> Result<HashSet<String>, Failure> {
        let state = self;
        let mut given = HashSet::new();
        for (name, value) in Fields::new(Json::parse(text)?, "the state")?.into_inner() {
            match name.as_str() {
                "t" => state.time = number(&value, "t")?,
                "parameters" | "inputs" | "q" | "u" => {
                    let fields = Fields::new(value, &format!("`{name}`"))?;
                    for (entry, value) in fields.into_inner() {
                        let value = number(&value, &format!("{name}.{entry}"))?;
                        *state.slot(mechanism, &name, &entry)? = value;
                        if given.contains(&entry) {
                            return Err(Failure::bad_json(format!(
                                "`{entry}` is given under `parameters` and under `inputs`: give it once"
                            )));
                        }
                        given.insert(entry);
                    }
                }
                other => {
                    let hint = spelling::hint(other, ["parameters", "t", "q", "u", "inputs"]);
                    return Err(Failure::new(
                        Kind::UnknownName,
                        format!("a state has no field `{other}`: {hint}"),
                    ));
                }
            }
        }
        Ok(given)
    }

    /// Sets one value by its name: a parameter or an input, or, unless only `parameters` are allowed, a
    /// coordinate, a speed or the time `t`.
    ///
    /// # Errors
    ///
    /// `unknown_name`.
    pub fn set(
        &mut self,
        mechanism: &Mechanism,
        name: &str,
        value: f64,
        parameters: bool,
    ) -> Result<(), Failure> {
        let is = |list: &[Variable]| list.iter().any(|quantity| quantity.name == name);
        let option = |what: &str| {
            let message = format!("`{name}` is a {what}, no parameter: give it as --state {name}={value}");
            Err(Failure::new(Kind::UnknownName, message))
        };
        let section = match () {
            () if parameters && is(&mechanism.coordinates) => return option("coordinate"),
            () if parameters && is(&mechanism.speeds[..self.speeds.len()]) => return option("speed"),
            // a dependent one
            () if parameters && is(&mechanism.speeds) => "u",
            () if parameters || is(&mechanism.parameters) || is(&mechanism.inputs) => "parameters",
            () if is(&mechanism.coordinates) => "q",
            () if is(&mechanism.speeds) => "u",
            () if name == "t" => {
                self.time = value;
                return Ok(());
            }
            () => {
                let all = names(&mechanism.coordinates)
                    .chain(names(&mechanism.speeds[..self.speeds.len()]))
                    .chain(names(&mechanism.inputs))
                    .chain(["t"]);
                let hint = spelling::hint(name, all);
                let message = format!("there is no coordinate, speed, input or parameter `{name}`: {hint}");
                return Err(Failure::new(Kind::UnknownName, message));
            }
        };
        *self.slot(mechanism, section, name)? = value;
        Ok(())
    }

    /// Evaluates the initial values that the model states in terms of others again, except those that are
    /// given.
    ///
    /// # Errors
    ///
    /// `inconsistent_state`.
    pub fn complete(&mut self, mechanism: &Mechanism, given: impl Fn(&str) -> bool) -> Result<(), Failure> {
        let follows = |quantity: &Variable| quantity.initial.is_some();
        if !mechanism.coordinates.iter().chain(&mechanism.speeds).any(follows) {
            return Ok(());
        }
        let among = |list: &[Variable]| list.iter().map(|quantity| given(&quantity.name)).collect();
        let kept = Given { coordinates: among(&mechanism.coordinates), speeds: among(&mechanism.speeds) };
        let mut numbers = self.to_numeric();
        let open = start::complete(mechanism, &mut numbers, &kept);
        if let Some(&slot) = open.first() {
            let quantity = mechanism.coordinates.iter().chain(&mechanism.speeds).nth(slot);
            let name = quantity.map_or("", |quantity| quantity.name.as_str());
            return Err(Failure::new(
                Kind::InconsistentState,
                format!(
                    "the initial value of {name} cannot be found with these numbers: give {name} in the state"
                ),
            ));
        }
        (self.coordinates, self.speeds) = (numbers.coordinates, numbers.speeds);
        Ok(())
    }

    /// The value with that name.
    fn slot(&mut self, mechanism: &Mechanism, section: &str, name: &str) -> Result<&mut f64, Failure> {
        let unknown = |message: String| Err(Failure::new(Kind::UnknownName, message));
        let find = |list: &[Variable]| list.iter().position(|quantity| quantity.name == name);
        let parameter = find(&mechanism.parameters);
        let input = find(&mechanism.inputs);
        let coordinate = find(&mechanism.coordinates);
        let speed = find(&mechanism.speeds);
        let loads = section == "parameters" || section == "inputs";
        match (section, parameter, input, coordinate, speed) {
            (_, Some(index), ..) if loads => {
                let parameter = &mechanism.parameters[index];
                if parameter.fixed {
                    return unknown(format!(
                        "parameter `{name}` is `fixed` in the model: its value {} is built in; take out `fixed` there to \
                         give another",
                        parameter.value.unwrap_or(0.0)
                    ));
                }
                Ok(&mut self.parameters[index])
            }
            (_, _, Some(index), ..) if loads => Ok(&mut self.inputs[index]),
            ("q", _, _, Some(index), _) => Ok(&mut self.coordinates[index]),
            ("u", _, _, _, Some(index)) if index < self.speeds.len() => Ok(&mut self.speeds[index]),
            ("u", _, _, _, Some(_)) => unknown(format!(
                "`{name}` is a dependent speed: it follows from the constraints; give the independent ones ({})",
                names(&mechanism.speeds[..self.speeds.len()]).collect::<Vec<_>>().join(", ")
            )),
            (_, Some(_), ..) | (_, _, Some(_), ..) => {
                unknown(format!("`{name}` is no {}: give it under `parameters`", what(section)))
            }
            (_, _, _, Some(_), _) => unknown(format!("`{name}` is a coordinate: give it under `q`")),
            (_, _, _, _, Some(_)) => unknown(format!("`{name}` is a speed: give it under `u`")),
            _ => {
                let hint = match section {
                    "q" => spelling::hint(name, names(&mechanism.coordinates)),
                    "u" => spelling::hint(name, names(&mechanism.speeds[..self.speeds.len()])),
                    _ => spelling::hint(
                        name,
                        names(&mechanism.parameters)
                            .zip(&mechanism.parameters)
                            .filter(|(_, parameter)| !parameter.fixed)
                            .map(|(name, _)| name)
                            .chain(names(&mechanism.inputs)),
                    ),
                };
                unknown(format!("there is no {} `{name}`: {hint}", what(section)))
            }
        }
    }
}

fn names(quantities: &[Variable]) -> impl Iterator<Item = &str> + Clone {
    quantities.iter().map(|quantity| quantity.name.as_str())
}

fn what(section: &str) -> &'static str {
    match section {
        "q" => "coordinate",
        "u" => "speed",
        _ => "parameter or input",
    }
}
