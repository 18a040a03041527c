//! A picture of a motion: the mechanism as lines, at several times, from the side.

use std::fmt::Write;

/// Lines in a vertical plane.
#[derive(Debug, Default)]
pub struct Picture {
    strokes: Vec<(Vec<[f64; 2]>, &'static str)>,
}

/// Width of the picture, pixels.
const WIDTH: f64 = 900.0;
/// Free space around, pixels.
const MARGIN: f64 = 20.0;

impl Picture {
    /// Adds a line through points (to the right and upwards, m) with a colour.
    pub fn line(&mut self, points: &[[f64; 2]], colour: &'static str) {
        self.strokes.push((points.to_vec(), colour));
    }

    /// As a file in the format SVG. The floor is at height 0.
    pub fn svg(&self) -> String {
        let all = || self.strokes.iter().flat_map(|(points, _)| points);
        let range = |axis: usize| {
            all().map(|point| point[axis]).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            })
        };
        let ((left, right), (low, high)) = (range(0), range(1));
        let (low, high) = (low.min(0.0), high.max(0.0));
        let scale = (WIDTH - 2.0 * MARGIN) / (right - left).max(0.6 * (high - low)).max(1e-9);
        let height = (high - low) * scale + 2.0 * MARGIN;
        let place = |[x, z]: [f64; 2]| [MARGIN + (x - left) * scale, MARGIN + (high - z) * scale];
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.2}\">\n<rect width=\"{WIDTH}\" height=\"{height:.2}\" fill=\"#fff\"/>\n"
        );
        let floor = place([0.0, 0.0])[1];
        let _ = writeln!(text, "<path d=\"M0 {floor:.2}H{WIDTH}\" stroke=\"#888\" stroke-width=\"2\"/>");
        for (points, colour) in &self.strokes {
            let d: Vec<String> =
                points.iter().map(|point| place(*point)).map(|[x, y]| format!("{x:.2} {y:.2}")).collect();
            let _ = writeln!(
                text,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\" stroke-linejoin=\"round\"/>",
                d.join(" ")
            );
        }
        text + "</svg>\n"
    }
}
