//! Where planes cut a surface f(x, y, z) = 0, for drawing: by the signs of f at the corners of squares.

use std::collections::HashMap;

/// Planes across each axis, and squares along each side of a plane.
const PLANES: usize = 9;
const SQUARES: usize = 40;

/// Lines on the surface within a cube of a given width about the origin; a place at which f has no value is on neither side.
pub fn sections(width: f64, f: impl Fn([f64; 3]) -> Option<f64>) -> Vec<Vec<[f64; 3]>> {
    let mut out = Vec::new();
    for axis in 0..3 {
        for plane in 1..=PLANES {
            let off = width * (plane as f64 / (PLANES + 1) as f64 - 0.5);
            let place = |[a, b]: [f64; 2]| {
                let mut place = [off; 3];
                (place[(axis + 1) % 3], place[(axis + 2) % 3]) = (a, b);
                place
            };
            let lines = zeros(width, |at| f(place(at)));
            out.extend(lines.into_iter().map(|line| line.into_iter().map(place).collect()));
        }
    }
    out
}

/// An edge of the grid: its first corner, and whether it leads along the second axis.
type Edge = ([usize; 2], bool);

/// Lines along which a function of two coordinates vanishes, within a square about the origin.
fn zeros(width: f64, f: impl Fn([f64; 2]) -> Option<f64>) -> Vec<Vec<[f64; 2]>> {
    let at = |k: usize| width * (k as f64 / SQUARES as f64 - 0.5);
    let values: Vec<Vec<Option<f64>>> =
        (0..=SQUARES).map(|i| (0..=SQUARES).map(|j| f([at(i), at(j)])).collect()).collect();
    let other = |([i, j], up): Edge| if up { [i, j + 1] } else { [i + 1, j] };
    // where the function changes its sign along an edge, by linear interpolation
    let crossing = |edge: Edge| -> Option<[f64; 2]> {
        let ([i, j], up) = edge;
        let [k, l] = other(edge);
        let (a, b) = (values[i][j]?, values[k][l]?);
        let share = ((a < 0.0) != (b < 0.0)).then(|| a / (a - b))? * width / SQUARES as f64;
        Some(if up { [at(i), at(j) + share] } else { [at(i) + share, at(j)] })
    };
    let mut ends: HashMap<Edge, Vec<Edge>> = HashMap::new();
    let mut starts: Vec<Edge> = Vec::new();
    for i in 0..SQUARES {
        for j in 0..SQUARES {
            let around: [Edge; 4] =
                [([i, j], false), ([i + 1, j], true), ([i, j + 1], false), ([i, j], true)];
            let crossed: Vec<Edge> = around.into_iter().filter(|edge| crossing(*edge).is_some()).collect();
            for pair in crossed.chunks_exact(2) {
                for (from, to) in [(pair[0], pair[1]), (pair[1], pair[0])] {
                    ends.entry(from).or_default().push(to);
                    starts.push(from);
                }
            }
        }
    }
    // lines with ends first, then closed ones
    let (single, both): (Vec<Edge>, Vec<Edge>) = starts.into_iter().partition(|edge| ends[edge].len() == 1);
    let mut lines = Vec::new();
    for start in single.into_iter().chain(both) {
        let mut line = vec![start];
        let mut now = start;
        while let Some(next) = ends.get_mut(&now).and_then(Vec::pop) {
            if let Some(back) = ends.get_mut(&next) {
                back.retain(|edge| *edge != now);
            }
            line.push(next);
            now = next;
        }
        if line.len() > 1 {
            lines.push(line.into_iter().filter_map(crossing).collect());
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere([x, y, z]: [f64; 3]) -> Option<f64> {
        Some(x * x + y * y + z * z - 0.49)
    }

    /// Lines lie on the surface; the sections of a sphere are closed, one for each plane that cuts it.
    #[test]
    fn sections_of_a_sphere_are_circles() {
        let lines = sections(2.0, sphere);
        // planes at -0.8, -0.6, .. 0.8, of which seven cut it
        assert_eq!(lines.len(), 3 * 7);
        for line in &lines {
            assert!(line.len() > 20 && line.first() == line.last(), "{}", line.len());
            assert!(line.iter().all(|place| sphere(*place).unwrap().abs() < 3e-3));
        }
    }

    /// A line that leaves the cube has two ends; where the function has no value there is no line.
    #[test]
    fn lines_end_where_the_cube_or_the_function_does() {
        let plane = |[x, _, z]: [f64; 3]| Some(z - 0.3 * x - 0.01);
        let lines = sections(1.0, plane);
        assert!(!lines.is_empty() && lines.iter().all(|line| line.len() > 30 && line.first() != line.last()));
        let half = sections(1.0, |place| if place[0] < 0.0 { None } else { plane(place) });
        assert!(!half.is_empty() && half.concat().iter().all(|place| place[0] >= 0.0));
        assert!(sections(1.0, |_| None).is_empty() && sections(1.0, |_| Some(0.0)).is_empty());
    }
}
