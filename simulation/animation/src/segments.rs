//! Chooses the points of a mechanism that the animation connects by lines.

/// The lines of a stick figure: from each point to the one relative to which it is defined (`from`, index in
/// the list; `None` for an independent point), and from the centre of each body to its points. Every line
/// occurs once, and none connects a point with itself.
pub fn segments(from: &[Option<usize>], bodies: &[(usize, Vec<usize>)]) -> Vec<[usize; 2]> {
    let chain = from.iter().enumerate().filter_map(|(point, from)| from.map(|from| [from, point]));
    let spokes = bodies.iter().flat_map(|(centre, points)| points.iter().map(move |&point| [*centre, point]));
    let mut lines: Vec<[usize; 2]> = Vec::new();
    for [a, b] in chain.chain(spokes) {
        let (a, b) = (a.min(b), a.max(b));
        if a != b && b < from.len() && !lines.contains(&[a, b]) {
            lines.push([a, b]);
        }
    }
    lines
}
