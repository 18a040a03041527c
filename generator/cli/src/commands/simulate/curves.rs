//! The figure of a motion: coordinates, speeds, gaps and normal forces over time.

use std::path::Path;

use hodograph::{Contacts, Kind as Of, Mechanism, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Simulation;

use super::gap::gap;
use crate::plot::figure::{Axis, Figure, Panel, Series};
use crate::plot::file::Format;
use crate::plot::label::Label;
use crate::stop::Outcome;

/// Numbers over time.
pub struct Curves<'m> {
    mechanism: &'m InterpretedMechanism,
    coordinates: Vec<Vec<[f64; 2]>>,
    speeds: Vec<Vec<[f64; 2]>>,
    gaps: Vec<Vec<[f64; 2]>>,
    forces: Vec<Vec<[f64; 2]>>,
}

impl<'m> Curves<'m> {
    /// None yet.
    pub fn new(mechanism: &'m InterpretedMechanism) -> Self {
        let none = |kind| vec![Vec::new(); mechanism.count(kind)];
        Curves {
            mechanism,
            coordinates: none(Of::Coordinate),
            speeds: none(Of::Speed),
            gaps: none(Of::Contact),
            forces: none(Of::Contact),
        }
    }

    /// The state of a simulation.
    pub fn add(&mut self, simulation: &Simulation<'_>) {
        let t = simulation.time();
        let (q, u) = (simulation.coordinates(), simulation.speeds());
        self.coordinates.iter_mut().zip(q).for_each(|(curve, &value)| curve.push([t, value]));
        self.speeds.iter_mut().zip(u).for_each(|(curve, &value)| curve.push([t, value]));
        let state = State { time: t, coordinates: q, speeds: u, inputs: simulation.inputs() };
        let forces = simulation.contact_forces().map_or(Vec::new(), |(forces, _)| forces);
        for contact in 0..self.gaps.len() {
            if let Some(gap) = gap(self.mechanism as &dyn Contacts<f64>, contact, &state) {
                self.gaps[contact].push([t, gap]);
                let force = forces.iter().find(|(index, _)| *index == contact);
                self.forces[contact].push([t, force.map_or(0.0, |(_, force)| force.x)]);
            }
        }
    }

    /// Writes the figure.
    ///
    /// # Errors
    ///
    /// Where the format is none, or the file cannot be written.
    pub fn save(self, path: &Path) -> Outcome {
        let format = Format::of(None, Some(path))?;
        let mechanism = self.mechanism;
        let mut figure = Figure::new(mechanism.name());
        for (title, unit, kind, curves) in [
            ("coordinates", "", Of::Coordinate, self.coordinates),
            ("speeds", "", Of::Speed, self.speeds),
            ("gap", "m", Of::Contact, self.gaps),
            ("normal force", "N", Of::Contact, self.forces),
        ] {
            let mut panel =
                Panel::new(Axis::new(Label::symbol("t", ""), "s"), Axis::new(Label::words(title), unit));
            for (index, points) in curves.into_iter().enumerate().filter(|(_, points)| !points.is_empty()) {
                let name = mechanism.component(kind, index).map_or("", |component| component.name);
                panel.series.push(Series::new(Label::name(name), index, points));
            }
            if !panel.series.is_empty() {
                figure = figure.panel(panel);
            }
        }
        figure.save(path, format)
    }
}
