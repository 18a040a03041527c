//! The figure of several hodographs of one contact: slip that starts in many directions, for each coefficient
//! of friction. Hodographs of one system do not intersect, except where slip stops.

use hodograph::{ReducedMatrix, invariant_directions, rates};

use super::figure::{Axis, Figure, Legend, Panel, Series};
use super::label::Label;
use super::trace::trace;

/// The styles of the hodographs, of that of the given approach, and of invariant directions: where slip
/// grows, where it decreases, where it turns away.
const STYLES: [usize; 5] = [0, 3, 1, 2, 4];

/// Every so many samples of a course one is drawn.
const STRIDE: usize = 5;

/// The figure of a contact with `starts` hodographs for each coefficient of friction, including that of the
/// given approach. All have its v_n1 and its speed of slip, or without slip |v_n1|.
pub fn figure(
    title: &str,
    matrix: &ReducedMatrix<f64>,
    approach: [f64; 3],
    (mu, e): (&[f64], f64),
    starts: usize,
) -> (Figure, Vec<String>) {
    let [v_n, v_t, v_s] = approach;
    let slip = v_t.hypot(v_s);
    let (speed, first) = if slip > 0.0 { (slip, v_s.atan2(v_t)) } else { (v_n.abs(), 0.0) };
    let mut failures = Vec::new();
    let columns = mu.len().clamp(1, 3);
    let empty = Figure { columns, panel_size: [410.0, 420.0], legend: Legend::Below, ..Figure::new(title) };
    let figure = mu.iter().fold(empty, |figure, &mu| {
        let velocity = |index: &str| Axis::new(Label::symbol("v", index), "m/s");
        let mut panel = Panel::new(velocity("t"), velocity("s"));
        panel.equal = true;
        panel.title = Label::symbol("\u{3bc}", "")
            .then(&format!(" = {mu}, "))
            .with("s", "")
            .then(" = ")
            .with("n", "")
            .then(" \u{d7} ")
            .with("t", "");
        for direction in invariant_directions(matrix, mu).into_iter().flatten() {
            let g = rates(matrix, mu, direction).y;
            let step = 1e-6;
            let stable = rates(matrix, mu, direction + step).z < rates(matrix, mu, direction - step).z;
            let (words, style) = match (stable, g > 0.0) {
                (true, true) => ("slip grows in this direction", STYLES[2]),
                (true, false) => ("slip stops in this direction", STYLES[3]),
                (false, _) => ("slip turns away from this direction", STYLES[4]),
            };
            let end = [speed * direction.cos(), speed * direction.sin()];
            panel.series.push(Series::new(Label::words(words), style, vec![[0.0, 0.0], end]));
        }
        for start in (0..starts).rev() {
            let phi = first + std::f64::consts::TAU * start as f64 / starts as f64;
            let found = trace(matrix, [v_n, speed * phi.cos(), speed * phi.sin()], mu, e);
            // A small figure needs fewer points; the last ones are the ends of slip and of the collision.
            let last = found.samples.len().saturating_sub(2);
            let kept =
                found.samples.iter().enumerate().filter(|(index, _)| index % STRIDE == 0 || *index >= last);
            let points = kept.map(|(_, sample)| [sample.velocity[1], sample.velocity[2]]).collect();
            let (words, style) = match start {
                0 => ("hodograph of the approach given", STYLES[1]),
                _ => ("hodographs of other directions of approach", STYLES[0]),
            };
            panel.series.push(Series { directed: true, ..Series::new(Label::words(words), style, points) });
            if found.samples.is_empty() {
                failures.extend(found.failures);
            }
        }
        figure.panel(panel)
    });
    (figure, failures)
}
