//! What is kept of a motion beside its samples: its events, of which pages and recordings are made.

use hodograph::{Contacts, Law, Selection, State, Surface};
use hodograph_animation::{Recording, Series, Setup, mcap_file, page};
use hodograph_generator::numeric;
use hodograph_simulation::{Event, EventKind};
use numpy::{PyArray1, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyType};
use serde::{Deserialize, Serialize};

use hodograph::ComponentKind;
use hodograph::nalgebra::Vector3;

use crate::ends::Ends;
use crate::errors;
use crate::machine::Machine;

/// The events of a motion, and what they are events of.
#[derive(Default, Serialize, Deserialize)]
pub struct Kept {
    events: Vec<Event>,
    /// after each event: the forces of closed contacts along n, t, s, and the inputs
    forces: Vec<Vec<(usize, [f64; 3])>>,
    inputs: Vec<Vec<f64>>,
    /// the name of each event
    names: Vec<String>,
    contacts: Vec<String>,
    /// mu, e and the name of the law of contacts, by number
    surfaces: Vec<(usize, f64, f64, String)>,
    /// the state that was given, before what happened there: coordinates, speeds, inputs
    start: (f64, [Vec<f64>; 3]),
}

impl Kept {
    /// Adds an event.
    pub fn add(&mut self, event: Event, forces: Vec<(usize, Vector3<f64>)>, inputs: &[f64]) {
        self.forces.push(forces.into_iter().map(|(contact, force)| (contact, force.into())).collect());
        self.inputs.push(inputs.to_vec());
        self.events.push(event);
    }

    /// Adds what the events are events of.
    pub fn describe(
        &mut self,
        machine: &Machine,
        ends: &Ends,
        surfaces: Vec<(usize, Surface<f64>)>,
        start: &State<'_>,
    ) {
        self.start = (start.time, [start.coordinates, start.speeds, start.inputs].map(<[f64]>::to_vec));
        self.names = self.events.iter().map(|event| ends.name(&event.kind).to_owned()).collect();
        let contacts = 0..machine.count(ComponentKind::Contact);
        self.contacts =
            contacts.map(|contact| machine.name_of(ComponentKind::Contact, contact).to_owned()).collect();
        let of = |(contact, surface): (usize, Surface<f64>)| {
            (contact, surface.mu, surface.e, surface.law.name().to_owned())
        };
        self.surfaces = surfaces.into_iter().map(of).collect();
    }

    fn surfaces(&self) -> Vec<(usize, Surface<f64>)> {
        let of = |(contact, mu, e, law): &(usize, f64, f64, String)| {
            Some((*contact, Surface { mu: *mu, e: *e, law: Law::named(law)? }))
        };
        self.surfaces.iter().filter_map(of).collect()
    }
}

/// What is kept of a motion.
#[pyclass(frozen)]
pub struct Record {
    kept: Kept,
}

/// Time, coordinates, speeds, inputs and forces of the samples.
pub type Samples<'py> = (
    PyReadonlyArrayDyn<'py, f64>,
    PyReadonlyArrayDyn<'py, f64>,
    PyReadonlyArrayDyn<'py, f64>,
    PyReadonlyArrayDyn<'py, f64>,
    PyReadonlyArrayDyn<'py, f64>,
);

impl Record {
    /// The record of what was kept.
    pub fn of(kept: Kept) -> Self {
        Record { kept }
    }

    /// The page, the recording or the curves of a motion.
    pub fn shown<'py>(
        &self,
        py: Python<'py>,
        (machine, text): (&Machine, &str),
        what: &str,
        samples: &Samples<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let read =
            |array: &PyReadonlyArrayDyn<'py, f64>| array.as_array().iter().copied().collect::<Vec<f64>>();
        let (time, q, u) = (read(&samples.0), read(&samples.1), read(&samples.2));
        let (inputs, forces) = (read(&samples.3), read(&samples.4));
        let rows = time.len();
        let row = |numbers: &[f64], row: usize| {
            let width = numbers.len() / rows.max(1);
            numbers.get(row * width..(row + 1) * width).unwrap_or(&[]).to_vec()
        };
        let (start, [coordinates, speeds, held]) = self.kept.start.clone();
        let parameters = machine.all_parameters().to_vec();
        let begin = numeric::State { parameters, inputs: held, time: start, coordinates, speeds };
        let setup = Setup::of(machine.model(), &begin, &self.kept.surfaces(), text.to_owned());
        let contacts: &dyn Contacts<f64> = machine.contacts();
        let mut recording = Recording::new(contacts, machine.model(), &begin, setup);
        let mut events = (0..self.kept.events.len()).peekable();
        for (sample, &now) in time.iter().enumerate() {
            // A motion is first shown as it begins; later what happened at a time comes before the state then.
            if sample > 0 {
                self.show_events(&mut recording, &mut events, now);
            }
            let forces = row(&forces, sample);
            let forces: Vec<(usize, Vector3<f64>)> = forces
                .chunks_exact(3)
                .enumerate()
                .filter(|(_, force)| force.iter().any(|part| *part != 0.0))
                .map(|(contact, force)| (contact, Vector3::from_row_slice(force)))
                .collect();
            let (q, u, inputs) = (row(&q, sample), row(&u, sample), row(&inputs, sample));
            recording.sample(&State { time: now, coordinates: &q, speeds: &u, inputs: &inputs }, &forces);
        }
        self.show_events(&mut recording, &mut events, f64::INFINITY);
        let recorded = recording.finish();
        match what {
            "html" => Ok(page(&recorded.shown).into_pyobject(py)?.into_any()),
            "mcap" => {
                let late = time.iter().any(|time| !(0.0..=mcap_file::LAST).contains(time));
                if late {
                    let message = format!("times in a recording lie between 0 and {} s", mcap_file::LAST);
                    return Err(errors::argument(py, "time", "bad_option", &message));
                }
                let bytes = mcap_file::bytes(&recorded.shown, &recorded.states)
                    .map_err(|error| errors::argument(py, "mcap", "bad_option", &error.to_string()))?;
                Ok(PyBytes::new(py, &bytes).into_any())
            }
            _ => {
                let curves = PyList::empty(py);
                for Series { panel, name, unit, values } in
                    recorded.states.iter().chain(&recorded.shown.series)
                {
                    curves.append((panel, name, unit, PyArray1::from_slice(py, values)))?;
                }
                let times = PyArray1::from_slice(py, &recorded.shown.times);
                Ok((times, curves).into_pyobject(py)?.into_any())
            }
        }
    }
}

impl Record {
    /// Shows the events up to a time.
    fn show_events(
        &self,
        recording: &mut Recording<'_>,
        events: &mut std::iter::Peekable<std::ops::Range<usize>>,
        until: f64,
    ) {
        while let Some(index) = events.next_if(|&index| self.kept.events[index].time <= until) {
            let event = &self.kept.events[index];
            let inputs = &self.kept.inputs[index];
            let forces: Vec<(usize, Vector3<f64>)> =
                self.kept.forces[index].iter().map(|(contact, force)| (*contact, (*force).into())).collect();
            recording.before_with(event, inputs);
            let (coordinates, speeds) = (&event.coordinates[..], &event.speeds[..]);
            recording.sample(&State { time: event.time, coordinates, speeds, inputs }, &forces);
            recording.event(event);
        }
    }
}

/// Whether other modes were possible, in a word.
fn selection(selection: Selection) -> &'static str {
    match selection {
        Selection::Unique => "unique",
        Selection::SeveralModes => "several_modes",
        Selection::Indeterminate => "indeterminate",
        _ => "unknown",
    }
}

#[pymethods]
impl Record {
    /// All of it as a text, of which `from_text` makes it again.
    fn text(&self) -> PyResult<String> {
        serde_json::to_string(&self.kept)
            .map_err(|error| pyo3::exceptions::PyValueError::new_err(error.to_string()))
    }

    /// The record of a text.
    #[classmethod]
    fn from_text(_class: &Bound<'_, PyType>, text: &str) -> PyResult<Self> {
        let kept = serde_json::from_str(text)
            .map_err(|error| pyo3::exceptions::PyValueError::new_err(error.to_string()))?;
        Ok(Record { kept })
    }

    /// The events as tuples.
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let all = PyList::empty(py);
        let contact = |contact: usize| self.kept.contacts.get(contact).map(String::as_str);
        let numbers = |numbers: &[f64]| PyArray1::from_slice(py, numbers);
        for (event, name) in self.kept.events.iter().zip(&self.kept.names) {
            let (mut impulse, mut energy, mut before, mut mode, mut directions) =
                (None, None, None, None, (None, None));
            let shares = PyList::empty(py);
            match &event.kind {
                EventKind::Collision(struck) | EventKind::ImpactWithoutCollision(struck) => {
                    impulse = Some(numbers(struck.outcome.impulse_on_point.as_slice()));
                    energy = Some(struck.outcome.energy_change);
                    before = Some(numbers(&struck.speeds_before));
                }
                EventKind::SimultaneousCollision(struck) => {
                    energy = Some(struck.energy_change);
                    before = Some(numbers(&struck.speeds_before));
                    for share in &struck.shares {
                        let of = PyDict::new(py);
                        of.set_item("contact", contact(share.contact))?;
                        of.set_item("impulse", share.impulse)?;
                        of.set_item("impulse_on_point", numbers(share.impulse_on_point.as_slice()))?;
                        of.set_item("approach", share.approach)?;
                        of.set_item("separation", share.separation)?;
                        of.set_item("work", share.work)?;
                        shares.append(of)?;
                    }
                }
                EventKind::Contact { mode: touching, .. } => mode = Some(touching.name()),
                EventKind::Slip { direction, along, .. } | EventKind::Roll { direction, along, .. } => {
                    directions = (Some(numbers(direction)), Some(numbers(along)));
                }
                _ => {}
            }
            let (q, u) = (numbers(&event.coordinates), numbers(&event.speeds));
            let selected = event.kind.selection().map(selection);
            let first = (event.time, name, event.contact.and_then(contact), q, u);
            let (direction, along) = directions;
            let then = (impulse, energy, before, mode, direction, along, selected, shares);
            all.append((first, then))?;
        }
        Ok(all)
    }
}
