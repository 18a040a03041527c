//! The variables of a unit; their index is their value reference.

use hodograph::{Cause, ComponentKind, Contacts, Law, State, Surface};
use hodograph_simulation::{Indicator, Options, Simulation};

use crate::words::Told;

/// The data of a unit besides its generated module: the options of `hodograph export --fmu`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Defaults {
    /// greatest step of the integration in co-simulation, s
    pub max_step: f64,
    /// index, mu, e and the name of the law of each contact that can close
    pub surfaces: &'static [(usize, f64, f64, &'static str)],
}

/// The default tolerance of the integration; bounces that are lower than this, m, are the last ones.
pub const TOLERANCE: f64 = 1e-12;

/// The kinds of variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VariableKind {
    /// the independent variable
    Time,
    /// tolerance of the integration in co-simulation
    Tolerance,
    /// greatest step of the integration in co-simulation
    MaxStep,
    /// a parameter of the model
    Parameter(usize),
    /// coefficient of friction of a contact
    Mu(usize),
    /// coefficient of restitution of a contact
    Restitution(usize),
    /// hypothesis of restitution of a contact
    Law(usize),
    /// an input
    Input(usize),
    /// a coordinate
    Coordinate(usize),
    /// an independent speed
    Speed(usize),
    /// rate of a coordinate
    CoordinateRate(usize),
    /// rate of an independent speed
    SpeedRate(usize),
    /// a dependent speed
    DependentSpeed(usize),
    /// position of a point along an axis of N
    Position(usize, usize),
    /// gap of a contact
    Gap(usize),
    /// force at a contact along n, t or s
    Force(usize, usize),
    /// mode of a contact: open, stick, slide
    Phase(usize),
    /// kinetic energy
    KineticEnergy,
    /// potential energy
    PotentialEnergy,
    /// number of events so far
    Events,
    /// an event indicator
    Indicator(usize),
}

/// A variable; its index is its value reference.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// name
    pub name: String,
    /// unit of the model; empty or `1` for a dimensionless variable
    pub unit: String,
    /// description in a sentence
    pub docs: String,
    /// the kind of variable
    pub kind: VariableKind,
}

/// The variables of a unit, and their start values.
#[derive(Clone, Debug)]
pub struct Layout {
    /// by value reference
    pub variables: Vec<Variable>,
    /// the event indicators, by the index in [`VariableKind::Indicator`]
    pub indicators: Vec<Indicator>,
    /// the contacts that can close, with their surfaces
    pub surfaces: Vec<(usize, Surface<f64>)>,
    /// the values of parameters, coordinates, speeds and inputs in the model
    pub start: [Vec<f64>; 4],
    /// whether the mechanism has a potential energy
    pub has_potential: bool,
}

impl Layout {
    /// The variables of a mechanism.
    ///
    /// # Errors
    ///
    /// A sentence: a contact that can close has no surface, or the motion cannot start in the state of the
    /// model.
    pub fn of(mechanism: &dyn Contacts<f64>, defaults: &Defaults) -> Result<Self, String> {
        let count = |kind| mechanism.count(kind);
        let zeros = |kind| vec![0.0; count(kind)];
        let mut parameters = zeros(ComponentKind::Parameter);
        let (mut q, mut u) = (zeros(ComponentKind::Coordinate), zeros(ComponentKind::Speed));
        let mut inputs = zeros(ComponentKind::Input);
        mechanism.parameter_values(&mut parameters).map_err(|error| error.told())?;
        mechanism.initial_state(&mut q, &mut u, &mut inputs).map_err(|error| error.told())?;
        let guess = q.clone();
        close_loops(mechanism, 0.0, &mut q, &u, &inputs)?;
        let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &inputs };
        let mut surfaces = Vec::new();
        for contact in 0..count(ComponentKind::Contact) {
            if let Ok(None) = mechanism.gap(contact, &state) {
                continue;
            }
            let own = defaults.surfaces.iter().find(|(index, ..)| *index == contact);
            let given = own.and_then(|&(_, mu, e, law)| Some(Surface { mu, e, law: Law::named(law)? }));
            let Some(surface) = given.or_else(|| mechanism.surface(contact)) else {
                let name =
                    mechanism.component(ComponentKind::Contact, contact).map_or("?", |found| found.name);
                return Err(format!("{}: contact {name} has no surface", Cause::NoSurface.name()));
            };
            surfaces.push((contact, surface));
        }
        let options = Options { surfaces: surfaces.clone(), ..Options::default() };
        let simulation = Simulation::new(mechanism, &state, options).map_err(|error| error.told())?;
        let has_potential = mechanism.potential_energy(&state).map_err(|error| error.told())?.is_some();
        let mut layout = Self {
            variables: Vec::new(),
            indicators: simulation.indicators(),
            surfaces,
            start: [parameters, guess, u.clone(), inputs.clone()],
            has_potential,
        };
        layout.variables = layout.all(mechanism, &state);
        Ok(layout)
    }

    /// The variable with a value reference.
    pub fn get(&self, reference: u32) -> Option<&Variable> {
        self.variables.get(usize::try_from(reference).ok()?)
    }

    /// The kinds of the variables with these value references, of which there must be `room`.
    ///
    /// # Errors
    ///
    /// A sentence: the numbers of references and values differ, or a variable does not exist.
    pub fn kinds(&self, references: &[u32], room: usize) -> Result<Vec<VariableKind>, String> {
        if references.len() != room {
            let count = references.len();
            return Err(format!("there are {count} variables and {room} values: all are scalars"));
        }
        let what = |reference: &u32| match self.get(*reference) {
            Some(variable) => Ok(variable.kind),
            None => Err(format!("there is no variable with the value reference {reference}")),
        };
        references.iter().map(what).collect()
    }

    /// The value reference of a variable.
    pub fn reference(&self, what: VariableKind) -> Option<usize> {
        self.variables.iter().position(|variable| variable.kind == what)
    }

    fn all(&self, mechanism: &dyn Contacts<f64>, state: &State<'_>) -> Vec<Variable> {
        let mut all = Vec::new();
        let mut add = |name: String, unit: &str, docs: &str, what: VariableKind| {
            all.push(Variable { name, unit: unit.to_owned(), docs: docs.to_owned(), kind: what });
        };
        let named = |kind: ComponentKind, index: usize| {
            let found = mechanism.component(kind, index);
            found.map_or((String::new(), String::new()), |found| {
                (found.name.to_owned(), found.unit.to_owned())
            })
        };
        let count = |kind| 0..mechanism.count(kind);
        add("time".into(), "s", "time", VariableKind::Time);
        add(
            "hodograph.tolerance".into(),
            "",
            "relative and absolute tolerance of the integration in co-simulation; lower bounces end in contact",
            VariableKind::Tolerance,
        );
        let docs = "greatest step of the integration in co-simulation";
        add("hodograph.max_step".into(), "s", docs, VariableKind::MaxStep);
        for index in count(ComponentKind::Parameter) {
            let (name, unit) = named(ComponentKind::Parameter, index);
            add(name, &unit, "parameter of the model", VariableKind::Parameter(index));
        }
        let contact =
            |index: usize, what: &str| format!("contacts.{}.{what}", named(ComponentKind::Contact, index).0);
        for &(index, _) in &self.surfaces {
            add(contact(index, "mu"), "", "coefficient of friction", VariableKind::Mu(index));
            add(contact(index, "e"), "", "coefficient of restitution", VariableKind::Restitution(index));
            add(contact(index, "law"), "", "hypothesis of restitution", VariableKind::Law(index));
        }
        for index in count(ComponentKind::Input) {
            let (name, unit) = named(ComponentKind::Input, index);
            add(name, &unit, "input of the model", VariableKind::Input(index));
        }
        for (kind, docs, what) in [
            (ComponentKind::Coordinate, "coordinate", VariableKind::Coordinate as fn(usize) -> VariableKind),
            (ComponentKind::Speed, "independent speed", VariableKind::Speed),
        ] {
            for index in count(kind) {
                let (name, unit) = named(kind, index);
                add(name, &unit, docs, what(index));
            }
        }
        for (kind, what) in [
            (ComponentKind::Coordinate, VariableKind::CoordinateRate as fn(usize) -> VariableKind),
            (ComponentKind::Speed, VariableKind::SpeedRate),
        ] {
            for index in count(kind) {
                let (name, unit) = named(kind, index);
                add(format!("der({name})"), &per_second(&unit), "its rate", what(index));
            }
        }
        for index in count(ComponentKind::DependentSpeed) {
            let (name, unit) = named(ComponentKind::DependentSpeed, index);
            add(name, &unit, "dependent speed", VariableKind::DependentSpeed(index));
        }
        for index in count(ComponentKind::Point) {
            // The model states only the velocity of some points.
            if mechanism.position(index, state).is_err() {
                continue;
            }
            let (name, _) = named(ComponentKind::Point, index);
            for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                let docs = "position from O along this axis of N";
                add(format!("points.{name}.{letter}"), "m", docs, VariableKind::Position(index, axis));
            }
        }
        for &(index, _) in &self.surfaces {
            add(contact(index, "gap"), "m", "distance of the striking point", VariableKind::Gap(index));
            for (axis, letter) in ["n", "t", "s"].into_iter().enumerate() {
                let docs =
                    "force on the striking point along this axis of the contact, zero where it is open";
                add(contact(index, &format!("force.{letter}")), "N", docs, VariableKind::Force(index, axis));
            }
            add(contact(index, "phase"), "", "what the bodies do", VariableKind::Phase(index));
        }
        add("energy.kinetic".into(), "J", "kinetic energy in N", VariableKind::KineticEnergy);
        if self.has_potential {
            add("energy.potential".into(), "J", "of gravity and springs", VariableKind::PotentialEnergy);
        }
        // all others of the unit's own have a point in their names
        let kinds = [
            ComponentKind::Parameter,
            ComponentKind::Input,
            ComponentKind::Coordinate,
            ComponentKind::Speed,
            ComponentKind::DependentSpeed,
        ];
        let taken =
            |name: &str| kinds.iter().any(|&kind| count(kind).any(|index| named(kind, index).0 == name));
        let mut events = "events".to_owned();
        while taken(&events) {
            events.push('_');
        }
        add(events, "", "number of events since the start", VariableKind::Events);
        for (place, indicator) in self.indicators.iter().enumerate() {
            let of = indicator
                .contact
                .map_or(String::new(), |contact| format!("{}.", named(ComponentKind::Contact, contact).0));
            let docs = "event where it falls to zero; 1 where it watches nothing";
            let name = format!("indicators.{of}{}", indicator.kind.name());
            add(name, "", docs, VariableKind::Indicator(place));
        }
        all
    }
}

/// The unit of a rate: `m/s` of `m`, `m/s^2` of `m/s`.
fn per_second(unit: &str) -> String {
    match unit {
        "" | "1" => "1/s".to_owned(),
        unit if unit.ends_with("/s") => format!("{unit}^2"),
        unit => format!("{unit}/s"),
    }
}

/// Largest number of Newton steps, and the relative change of a coordinate below which loops count as closed.
const STEPS: usize = 50;
const CLOSED: f64 = 1e-10;

/// Closes the loops of a state, starting from its dependent coordinates, and normalises quaternions.
///
/// # Errors
///
/// A sentence: the loops cannot be closed.
pub fn close_loops(
    mechanism: &dyn Contacts<f64>,
    time: f64,
    coordinates: &mut [f64],
    speeds: &[f64],
    inputs: &[f64],
) -> Result<(), String> {
    let mut left = f64::INFINITY;
    for _ in 0..STEPS {
        left = hodograph_simulation::close_loops(mechanism, time, coordinates, speeds, inputs)
            .map_err(|error| error.told())?;
        if left <= CLOSED {
            return Ok(());
        }
    }
    Err(format!(
        "the loops of the mechanism do not close from these coordinates (the last change of one was {left:e}): change them, or give a guess \
         nearer to the configuration meant"
    ))
}
