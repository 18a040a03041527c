//! Draws curves and marks.

use super::canvas::{Canvas, Colour, Shape};
use super::figure::Sign;

/// The styles of curves: colours that colour-blind readers can distinguish (after Okabe and Ito, darkened
/// where they are pale on white), and dashes for print.
pub const STYLES: [Style; 6] = [
    Style { colour: Colour([0, 114, 178], 1.0), dashes: &[] },
    Style { colour: Colour([213, 94, 0], 1.0), dashes: &[8.0, 3.0] },
    Style { colour: Colour([0, 130, 95], 1.0), dashes: &[8.0, 2.5, 1.5, 2.5] },
    Style { colour: Colour([0, 0, 0], 1.0), dashes: &[2.0, 2.0] },
    Style { colour: Colour([170, 70, 130], 1.0), dashes: &[14.0, 3.0] },
    Style { colour: Colour([130, 100, 0], 1.0), dashes: &[5.0, 2.0, 1.5, 2.0, 1.5, 2.0] },
];

/// The colour, and the lengths of dashes and gaps in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    pub colour: Colour,
    pub dashes: &'static [f64],
}

/// The style with an index: after the last colour the colours repeat with other dashes; 36 styles differ.
pub fn style(index: usize) -> Style {
    let count = STYLES.len();
    Style { dashes: STYLES[(index + index / count) % count].dashes, ..STYLES[index % count] }
}

pub const BLACK: Colour = Colour([30, 30, 30], 1.0);
/// Width of curves, pixels.
const WIDTH: f64 = 1.6;
/// Points closer than this count as one, pixels.
const MIN_DISTANCE: f64 = 0.05;
/// Length and half the width of an arrowhead, pixels.
const ARROW: [f64; 2] = [9.0, 3.6];
/// The places of arrowheads as parts of the length of a curve.
const ARROWS_AT: [f64; 2] = [0.3, 0.7];

/// Draws a curve through points of the sheet.
pub fn curve(canvas: &Canvas, places: &[[f64; 2]], style: Style, directed: bool) {
    let finite = |place: &[f64; 2]| place.iter().all(|number| number.is_finite());
    let pieces: Vec<Vec<[f64; 2]>> =
        places.split(|place| !finite(place)).map(thinned).filter(|piece| piece.len() > 1).collect();
    for points in &pieces {
        let dashes = style.dashes.to_vec();
        canvas.push(Shape::Line { points: points.clone(), colour: style.colour, width: WIDTH, dashes });
    }
    let longest = pieces.iter().max_by(|a, b| length(a).total_cmp(&length(b)));
    if let Some(piece) = longest.filter(|piece| directed && length(piece) > 6.0 * ARROW[0]) {
        for part in ARROWS_AT {
            arrow(canvas, piece, part * length(piece), style.colour);
        }
    }
}

/// The points without those that are too close to the previous one.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        let far = kept.last().is_none_or(|last| distance(last, point) >= MIN_DISTANCE);
        if far || index + 1 == points.len() {
            kept.push(*point);
        }
    }
    kept
}

fn distance(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn length(points: &[[f64; 2]]) -> f64 {
    points.windows(2).map(|pair| distance(&pair[0], &pair[1])).sum()
}

/// An arrowhead with its middle at this length along a curve.
fn arrow(canvas: &Canvas, points: &[[f64; 2]], along: f64, colour: Colour) {
    let (tail, tip) = (place(points, along - ARROW[0] / 2.0), place(points, along + ARROW[0] / 2.0));
    let size = distance(&tail, &tip);
    if size == 0.0 {
        return;
    }
    let [x, y] = [0, 1].map(|axis| (tip[axis] - tail[axis]) / size);
    let corner = |side: f64| {
        [tip[0] - ARROW[0] * x - side * ARROW[1] * y, tip[1] - ARROW[0] * y + side * ARROW[1] * x]
    };
    canvas.push(Shape::Polygon { points: vec![tip, corner(1.0), corner(-1.0)], colour });
}

/// The point at this length along a curve.
fn place(points: &[[f64; 2]], mut along: f64) -> [f64; 2] {
    for pair in points.windows(2) {
        let step = distance(&pair[0], &pair[1]);
        if along <= step && step > 0.0 {
            return [0, 1].map(|axis| pair[0][axis] + (pair[1][axis] - pair[0][axis]) * along / step);
        }
        along -= step;
    }
    points[points.len() - 1]
}

/// Draws a mark.
pub fn mark(canvas: &Canvas, sign: Sign, [x, y]: [f64; 2], colour: Colour) {
    /// Half the size of a mark, and the width of its lines.
    const HALF: f64 = 5.0;
    const LINE: f64 = 1.6;
    let line = |points: &[[f64; 2]]| {
        let points = points.iter().map(|[right, down]| [x + right * HALF, y + down * HALF]).collect();
        canvas.push(Shape::Line { points, colour, width: LINE, dashes: Vec::new() });
    };
    let circle = |radius: f64, width| {
        canvas.push(Shape::Circle { centre: [x, y], radius, colour, width });
    };
    match sign {
        Sign::Dot => circle(0.8 * HALF, None),
        Sign::Circle => circle(HALF, Some(LINE)),
        Sign::Cross => {
            line(&[[-1.0, -1.0], [1.0, 1.0]]);
            line(&[[-1.0, 1.0], [1.0, -1.0]]);
        }
        Sign::Square => {
            line(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [0.0, -1.0]])
        }
        Sign::Triangle => line(&[[-1.0, 0.8], [1.0, 0.8], [0.0, -1.0], [-1.0, 0.8], [0.0, 0.8]]),
        Sign::Block => {
            let corner = |right: f64, down: f64| [x + right * 0.7 * HALF, y + down * 0.7 * HALF];
            let points = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            canvas.push(Shape::Polygon { points, colour });
        }
    }
}
