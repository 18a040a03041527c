//! Records the states and events of a motion for its figure, its animated page and viewers of robots.

use hodograph::{ComponentKind, Contacts, State as Borrowed};
use hodograph_model::model::mechanism::{LoadKind, Mechanism as Model, Place, Variable, Vector};
use hodograph_model::numeric::views::values;
use hodograph_model::numeric::{Level, State, Views};
use hodograph_simulation::{Event, EventKind, Simulation};
use nalgebra::Vector3;

use crate::energies::Energies;
use crate::gap::gap;
use crate::solids::{self, Solids};
use crate::{Animation, Force, Frame, Happening, Point, Series, Setup, rigid, segments};

/// A motion as it will be shown.
pub struct Recording<'m> {
    mechanism: &'m dyn Contacts<f64>,
    model: &'m Model,
    shown: Animation,
    energies: Energies,
    solids: Solids,
    start: State,
    /// per contact, m and N; empty without a gap
    gaps: Vec<Vec<f64>>,
    pressures: Vec<Vec<f64>>,
    coordinates: Vec<Vec<f64>>,
    speeds: Vec<Vec<f64>>,
    /// per contact: its force at the last moment, along n, t, s
    last: Vec<Option<Vector3<f64>>>,
}

/// A recorded motion.
pub struct Recorded {
    /// what is to be seen
    pub shown: Animation,
    /// coordinates and speeds at the same moments
    pub states: Vec<Series>,
    /// what is not shown, and why
    pub notes: Vec<String>,
}

impl<'m> Recording<'m> {
    /// Nothing yet, of a motion from a state; `setup` says of which.
    pub fn new(mechanism: &'m dyn Contacts<f64>, model: &'m Model, state: &State, setup: Setup) -> Self {
        let from: Vec<Option<usize>> = model
            .points
            .iter()
            .map(|point| match &point.place {
                Place::Offset { from, .. } | Place::Material { from, .. } => Some(from.0),
                Place::Origin | Place::Velocity(_) => None,
            })
            .collect();
        // A point that moves away from O by itself hangs on nothing: no line leads there.
        let hangs = |(point, from): (usize, Option<usize>)| {
            from.filter(|&from| from != 0 || rigid::turns_about_origin(mechanism, point, state))
        };
        let from: Vec<Option<usize>> = from.into_iter().enumerate().map(hangs).collect();
        // where shapes touch no line leads: the shape is drawn
        let quiet = solids::places_of_shapes(model);
        let from: Vec<Option<usize>> =
            from.into_iter().zip(&quiet).map(|(from, quiet)| from.filter(|_| !quiet)).collect();
        let bodies: Vec<(usize, Vec<usize>)> = model
            .contacts
            .iter()
            .filter(|contact| contact.shapes.is_none())
            .filter_map(|contact| {
                contact.body.map(|body| (model.bodies[body.0].centre.0, vec![contact.point.0]))
            })
            .collect();
        let mut shown = Animation {
            title: model.name.clone(),
            points: model
                .points
                .iter()
                .zip(quiet)
                .map(|(point, quiet)| Point { name: point.name.clone(), places: Vec::new(), quiet })
                .collect(),
            frames: model
                .bodies
                .iter()
                .filter_map(|body| {
                    let name = model.frames[body.frame?.0].name.clone();
                    Some(Frame { name, at: body.centre.0, axes: Vec::new() })
                })
                .collect(),
            segments: segments(&from, &bodies),
            forces: model
                .contacts
                .iter()
                .map(|contact| Force { name: contact.name.clone(), at: Vec::new(), force: Vec::new() })
                .collect(),
            up: up(model, state),
            setup,
            ..Animation::default()
        };
        let solids = Solids::of(model, state, &mut shown);
        let none = |kind| vec![Vec::new(); mechanism.count(kind)];
        Recording {
            mechanism,
            model,
            shown,
            energies: Energies::default(),
            solids,
            start: state.clone(),
            gaps: none(ComponentKind::Contact),
            pressures: none(ComponentKind::Contact),
            coordinates: none(ComponentKind::Coordinate),
            speeds: none(ComponentKind::Speed),
            last: vec![None; mechanism.count(ComponentKind::Contact)],
        }
    }

    /// The state of a simulation, after the events at its time.
    pub fn add(&mut self, simulation: &Simulation<'_>) {
        let state = Borrowed {
            time: simulation.time(),
            coordinates: simulation.coordinates(),
            speeds: simulation.speeds(),
            inputs: simulation.inputs(),
        };
        let forces = simulation.contact_forces().map_or(Vec::new(), |(forces, _)| forces);
        self.sample(&state, &forces);
    }

    /// A state, with the forces of closed contacts along their n, t, s, N.
    pub fn sample(&mut self, state: &Borrowed<'_>, forces: &[(usize, Vector3<f64>)]) {
        self.moment(state, |contact| {
            forces.iter().find(|(index, _)| *index == contact).map(|(_, force)| *force)
        });
    }

    /// A state by itself, without forces of contacts.
    pub fn still(&mut self, state: &Borrowed<'_>) {
        self.sample(state, &[]);
    }

    /// The state in which an event found the mechanism: curves jump there, instead of rising towards it from
    /// the moment before.
    pub fn before(&mut self, event: &Event, simulation: &Simulation<'_>) {
        self.before_with(event, simulation.inputs());
    }

    /// As [`Recording::before`], with the inputs then.
    pub fn before_with(&mut self, event: &Event, inputs: &[f64]) {
        let speeds = match &event.kind {
            EventKind::Collision(struck) | EventKind::ImpactWithoutCollision(struck) => &struck.speeds_before,
            EventKind::SimultaneousCollision(struck) => &struck.speeds_before,
            _ => &event.speeds,
        };
        let state = Borrowed { time: event.time, coordinates: &event.coordinates, speeds, inputs };
        // Which contacts were closed is known; their forces are those of the moment before.
        let last = self.last.clone();
        self.shown.before.push(self.shown.times.len());
        self.moment(&state, |contact| last.get(contact).copied().flatten());
    }

    /// A moment, with the force of each closed contact along its n, t, s.
    fn moment(&mut self, state: &Borrowed<'_>, force: impl Fn(usize) -> Option<Vector3<f64>>) {
        let (mechanism, model) = (self.mechanism, self.model);
        self.shown.times.push(state.time);
        self.coordinates.iter_mut().zip(state.coordinates).for_each(|(curve, &value)| curve.push(value));
        self.speeds.iter_mut().zip(state.speeds).for_each(|(curve, &value)| curve.push(value));
        for (index, point) in self.shown.points.iter_mut().enumerate() {
            point.places.push(place(mechanism, index, state));
        }
        let mut frames = self.shown.frames.iter_mut();
        for body in &model.bodies {
            if let (Some(frame), Some(shown)) = (body.frame, body.frame.and_then(|_| frames.next())) {
                // Its columns are the axes along N.
                let turned = mechanism.orientation(frame.0, state).unwrap_or_default();
                shown.axes.push([0, 1, 2].map(|axis| turned.column(axis).into_owned().into()));
            }
        }
        for ((frame, _), shown) in self.solids.frames.iter().zip(frames) {
            let turned = mechanism.orientation(frame.0, state).unwrap_or_default();
            shown.axes.push([0, 1, 2].map(|axis| turned.column(axis).into_owned().into()));
        }
        self.solids.moment(mechanism, model, state);
        for (contact, shown) in self.shown.forces.iter_mut().enumerate() {
            let here = mechanism.contact_state(contact, state);
            let along = force(contact);
            self.last[contact] = along;
            let force = along.zip(here.ok());
            shown.at.push(place(mechanism, model.contacts[contact].point.0, state));
            shown.force.push(force.map(|(force, here)| {
                (here.normal * force.x + here.first * force.y + here.second * force.z).into()
            }));
            if let Some(gap) = gap(mechanism, contact, state) {
                self.gaps[contact].push(gap);
                self.pressures[contact].push(along.map_or(0.0, |force| force.x));
            }
        }
        self.energies.add(mechanism, state);
    }

    /// Something that happened, where the simulation now is.
    pub fn event(&mut self, event: &Event) {
        let (mechanism, model) = (self.mechanism, self.model);
        let state = Borrowed {
            time: event.time,
            coordinates: &event.coordinates,
            speeds: &event.speeds,
            inputs: &vec![0.0; mechanism.count(ComponentKind::Input)],
        };
        let mut show = |contact: Option<usize>, impulse: Option<Vector3<f64>>| {
            let contact = contact.and_then(|contact| model.contacts.get(contact));
            self.shown.events.push(Happening {
                time: event.time,
                contact: contact.map_or(String::new(), |contact| contact.name.clone()),
                label: event.kind.name().replace('_', " "),
                at: contact.map(|contact| place(mechanism, contact.point.0, &state)),
                impulse: impulse.map(Into::into),
            });
        };
        match &event.kind {
            EventKind::Collision(struck) | EventKind::ImpactWithoutCollision(struck) => {
                show(event.contact, Some(struck.outcome.impulse_on_point));
            }
            EventKind::SimultaneousCollision(struck) => {
                struck
                    .shares
                    .iter()
                    .for_each(|share| show(Some(share.contact), Some(share.impulse_on_point)));
            }
            _ => show(event.contact, None),
        }
    }

    /// What was recorded so far.
    pub fn shown(&self) -> &Animation {
        &self.shown
    }

    /// The whole motion.
    pub fn finish(mut self) -> Recorded {
        let series = |panel: &str, name: &str, unit: &str, values| Series {
            panel: panel.to_owned(),
            name: name.to_owned(),
            unit: unit.to_owned(),
            values,
        };
        let model = self.model;
        let (energies, note) = self.energies.curves(model);
        for (name, values) in energies {
            self.shown.series.push(series("energy", name, "J", values));
        }
        self.shown.shapes = self.solids.finish(model, &self.start, &self.shown);
        let notes: Vec<String> = note.into_iter().chain(placeless(&self.shown.points)).collect();
        self.shown.notes.clone_from(&notes);
        for (panel, unit, curves) in [("gap", "m", self.gaps), ("normal force", "N", self.pressures)] {
            for (contact, values) in model.contacts.iter().zip(curves) {
                // A contact that never presses has no curve of its force.
                let flat = unit == "N" && values.iter().all(|&value| value == 0.0);
                if !values.is_empty() && !flat {
                    self.shown.series.push(series(panel, &contact.name, unit, values));
                }
            }
        }
        let states =
            [("coordinates", &model.coordinates, self.coordinates), ("speeds", &model.speeds, self.speeds)];
        let states = states.into_iter().flat_map(|(panel, variables, curves)| {
            let of =
                |(variable, values): (&Variable, _)| series(panel, &variable.name, &variable.unit, values);
            variables.iter().zip(curves).map(of).collect::<Vec<_>>()
        });
        Recorded { states: states.collect(), shown: self.shown, notes }
    }
}

/// How many numbers a moment is kept as: the time, places, axes, forces with their places, and curves.
pub fn numbers(mechanism: &dyn Contacts<f64>, model: &Model) -> usize {
    let count = |kind| mechanism.count(kind);
    1 + 3 * model.points.len()
        + 9 * model.bodies.len()
        + 8 * count(ComponentKind::Contact)
        + 3
        + count(ComponentKind::Coordinate)
        + count(ComponentKind::Speed)
}

/// What is to be said of points that are nowhere at any time, and so are not drawn.
fn placeless(points: &[Point]) -> Option<String> {
    let nowhere = |point: &&Point| point.places.iter().all(|place| place[0].is_nan());
    let names: Vec<&str> = points.iter().filter(nowhere).map(|point| point.name.as_str()).collect();
    let told = match &names[..] {
        [] => return None,
        [one] => (*one).to_owned(),
        [some @ .., last] if names.len() <= 4 => format!("{} and {last}", some.join(", ")),
        all => format!("{} and {} other points", all[..3].join(", "), all.len() - 3),
    };
    Some(format!(
        "the position of {told} follows from velocities alone, not from coordinates: it is not drawn"
    ))
}

/// Where a point is, along N.x, N.y, N.z; no number where it cannot be known.
fn place(mechanism: &dyn Contacts<f64>, point: usize, state: &Borrowed<'_>) -> [f64; 3] {
    mechanism.position(point, state).unwrap_or(Vector3::repeat(f64::NAN)).into()
}

/// Against gravity at the start; N.z where the model has none.
fn up(model: &Model, state: &State) -> [f64; 3] {
    let gravity = model.loads.iter().find_map(|load| match &load.kind {
        LoadKind::Gravity(vector) => Some(vector),
        _ => None,
    });
    let known = |vector: &Vector| -> Option<Vector3<f64>> {
        let views = Views::at(model, state).ok()?;
        Some(Vector3::from(values(views.now.vector(vector, Level::Motion).ok()?)))
    };
    match gravity.and_then(known) {
        Some(down) if down.norm() > 0.0 => (-down / down.norm()).into(),
        _ => [0.0, 0.0, 1.0],
    }
}
