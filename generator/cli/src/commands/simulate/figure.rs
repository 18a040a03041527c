//! The figure of a motion: coordinates, speeds, gaps, normal forces and energies over time, a panel for each
//! unit.

use hodograph_animation::{Recorded, Series as Curve};

use crate::plot::figure::{Axis, Figure, Panel, Series};
use crate::plot::label::Label;

/// Width and height of a panel, pixels.
const PANEL: [f64; 2] = [760.0, 200.0];

/// The figure of a recorded motion.
pub fn figure(recorded: &Recorded) -> Figure {
    let times = &recorded.shown.times;
    let mut figure = Figure { panel_size: PANEL, ..Figure::new(&recorded.shown.title) };
    for ((title, unit), curves) in grouped(recorded.states.iter().chain(&recorded.shown.series)) {
        let unit = if unit == "1" { "" } else { unit };
        let mut panel =
            Panel::new(Axis::new(Label::symbol("t", ""), "s"), Axis::new(Label::words(title), unit));
        for (index, curve) in curves.into_iter().enumerate() {
            let points = times.iter().zip(&curve.values).map(|(&time, &value)| [time, value]).collect();
            // Energies have names in words, the others those of the model.
            let label = match title {
                "energy" => Label::words(&curve.name),
                _ => Label::name(&curve.name),
            };
            panel.series.push(Series::new(label, index, points));
        }
        figure = figure.panel(panel);
    }
    figure
}

/// The title of a panel and its unit.
type Kind<'a> = (&'a str, &'a str);

/// The curves grouped by kind and unit, in the order of their first occurrence.
fn grouped<'a>(curves: impl Iterator<Item = &'a Curve>) -> Vec<(Kind<'a>, Vec<&'a Curve>)> {
    let mut groups: Vec<(Kind<'a>, Vec<&'a Curve>)> = Vec::new();
    for curve in curves {
        let kind = (curve.panel.as_str(), curve.unit.as_str());
        match groups.iter_mut().find(|(other, _)| *other == kind) {
            Some((_, group)) => group.push(curve),
            None => groups.push((kind, vec![curve])),
        }
    }
    groups
}
