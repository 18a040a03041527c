//! Mechanisms with several contacts, read from their model files, and their motions.

use hodograph::{ComponentKind, Contacts, Law, Mechanism, State, Surface};
use hodograph_interpreter::{InterpretedMechanism, NumericMechanism};
use hodograph_simulation::{Event, EventKind, Options, Progress, Simulation, SimulationError};

/// A model of `tests/data/many_contacts`, or of this package.
pub fn model(name: &str) -> InterpretedMechanism {
    let root = env!("CARGO_MANIFEST_DIR");
    let own = format!("{root}/models/{name}.mech");
    let path = if std::path::Path::new(&own).exists() {
        own
    } else {
        format!("{root}/../tests/data/many_contacts/{name}.mech")
    };
    InterpretedMechanism::read(path.as_ref()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The mechanism of a text without a derivation.
pub fn numeric(name: &str, text: &str) -> NumericMechanism {
    let path = std::env::temp_dir().join(format!("hodograph-{name}-{}.mech", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let mechanism = NumericMechanism::read(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    mechanism
}

/// The same model with other parameters.
pub fn with_parameters(mechanism: &InterpretedMechanism, changes: &[(&str, f64)]) -> InterpretedMechanism {
    let mut values = mechanism.all_parameters().to_vec();
    for (name, value) in changes {
        let place =
            mechanism.index(ComponentKind::Parameter, name).unwrap_or_else(|| panic!("no parameter {name}"));
        values[place] = *value;
    }
    let (model, program) = (mechanism.model().clone(), mechanism.program().clone());
    InterpretedMechanism::with_parameters(model, program, &values).unwrap_or_else(|error| panic!("{error}"))
}

/// A start state.
#[derive(Clone, Debug)]
pub struct Start {
    pub coordinates: Vec<f64>,
    pub speeds: Vec<f64>,
    pub inputs: Vec<f64>,
}

impl Start {
    /// The one that the model states.
    pub fn of(mechanism: &InterpretedMechanism) -> Self {
        let model = mechanism.model();
        let stated = |name: &str| {
            [&model.coordinates, &model.speeds, &model.inputs]
                .into_iter()
                .flatten()
                .find(|variable| variable.name == name)
                .and_then(|variable| variable.value)
                .unwrap_or(0.0)
        };
        let values = |kind| (0..mechanism.count(kind)).map(|i| stated(name(mechanism, kind, i))).collect();
        Self {
            coordinates: values(ComponentKind::Coordinate),
            speeds: values(ComponentKind::Speed),
            inputs: values(ComponentKind::Input),
        }
    }

    /// Sets a coordinate, speed or input by its name.
    pub fn set(&mut self, mechanism: &InterpretedMechanism, name: &str, value: f64) {
        let lists = [
            (ComponentKind::Coordinate, &mut self.coordinates),
            (ComponentKind::Speed, &mut self.speeds),
            (ComponentKind::Input, &mut self.inputs),
        ];
        for (kind, list) in lists {
            if let Some(place) = mechanism.index(kind, name) {
                list[place] = value;
                return;
            }
        }
        panic!("no variable {name}");
    }

    pub fn state(&self) -> State<'_> {
        State { time: 0.0, coordinates: &self.coordinates, speeds: &self.speeds, inputs: &self.inputs }
    }
}

/// The name of a component.
pub fn name(mechanism: &InterpretedMechanism, kind: ComponentKind, index: usize) -> &str {
    mechanism.component(kind, index).map_or("?", |component| component.name)
}

/// One surface for all contacts.
pub fn surface(mu: f64, e: f64, law: Law) -> Options {
    Options { surface: Some(Surface { mu, e, law }), ..Options::default() }
}

/// How a motion ended, and what happened until then.
pub struct Ended {
    pub events: Vec<Event>,
    pub error: Option<SimulationError>,
    pub time: f64,
    pub coordinates: Vec<f64>,
    pub speeds: Vec<f64>,
    /// kinetic and potential energy at the start, J
    pub before: f64,
    /// change of energy that no work accounts for, J
    pub account: f64,
}

impl Ended {
    /// The name of how it ended: the error, `rest`, `singular` or `moves`.
    pub fn outcome(&self) -> &'static str {
        match (&self.error, self.events.last().map(|event| &event.kind)) {
            (Some(error), _) => error.kind.name(),
            (None, Some(EventKind::Rest)) => "rest",
            (None, Some(EventKind::Singular)) => "singular",
            _ => "moves",
        }
    }

    pub fn names(&self) -> Vec<String> {
        self.events
            .iter()
            .map(|event| format!("{} {:.12} {:?}", event.kind.name(), event.time, event.contact))
            .collect()
    }
}

/// Follows a motion to a time or to its own end.
pub fn follow(mechanism: &dyn Contacts<f64>, start: &Start, options: Options, until: f64) -> Ended {
    let mut simulation =
        Simulation::new(mechanism, &start.state(), options).unwrap_or_else(|error| panic!("{error}"));
    // Bodies may collide at the start: what is left is accounted for from before that.
    let unworked = |simulation: &Simulation<'_>| {
        let account = simulation.energy().unwrap();
        account.total().unwrap_or(account.kinetic) - account.friction - account.impacts - account.inputs
    };
    let before = unworked(&simulation);
    let (mut events, mut error): (Vec<Event>, _) = (Vec::new(), None);
    loop {
        match simulation.advance(until) {
            Ok(Progress::Event(event)) => {
                let ends = matches!(event.kind, EventKind::Singular);
                events.push(event);
                if ends {
                    break;
                }
            }
            Ok(Progress::Reached) => break,
            Err(what) => {
                error = Some(what);
                break;
            }
        }
    }
    Ended {
        events,
        error,
        time: simulation.time(),
        coordinates: simulation.coordinates().to_vec(),
        speeds: simulation.speeds().to_vec(),
        before,
        account: unworked(&simulation) - before,
    }
}

impl Ended {
    /// The impact that gave the most kinetic energy, and how much, J.
    pub fn gain(&self) -> Option<(&'static str, f64)> {
        let change = |event: &Event| match &event.kind {
            EventKind::Collision(struck) | EventKind::ImpactWithoutCollision(struck) => {
                Some((event.kind.name(), struck.outcome.energy_change))
            }
            EventKind::SimultaneousCollision(struck) => Some((event.kind.name(), struck.energy_change)),
            _ => None,
        };
        self.events.iter().filter_map(change).max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The starts: the usual ones, or what `HODOGRAPH_DROPS` says, a number of them or a range.
pub fn drops(usual: impl IntoIterator<Item = u64>) -> Vec<u64> {
    let text = std::env::var("HODOGRAPH_DROPS").unwrap_or_default();
    let (from, to) = text.split_once("..").unwrap_or(("0", &text));
    match (from.parse::<u64>(), to.parse::<u64>()) {
        (Ok(from), Ok(to)) => (from..to).collect(),
        _ => usual.into_iter().collect(),
    }
}
