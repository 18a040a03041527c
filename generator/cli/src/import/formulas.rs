//! Writes numbers, vectors and sums in the model language.

use nalgebra::Vector3;

/// Puts a sum in brackets, so that it can be a factor.
pub fn bracketed(term: &str) -> String {
    if term.contains(' ') { format!("({term})") } else { term.to_owned() }
}

/// The shortest decimal that reads back exactly.
pub fn decimal(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// An angle, as a multiple of pi if it is one to 10 digits.
pub fn angle(number: f64) -> String {
    let twelfths = number / std::f64::consts::PI * 12.0;
    let count = twelfths.round();
    if count == 0.0 || (twelfths - count).abs() > 6e-10 || count.abs() > 24.0 {
        return decimal(number);
    }
    let (sign, count) = (if count < 0.0 { "-" } else { "" }, count.abs() as u32);
    let common = (1..=12).rev().find(|&d| 12 % d == 0 && count % d == 0).unwrap_or(1);
    let top = if count == common { "pi".to_owned() } else { format!("{}*pi", count / common) };
    if common == 12 { format!("{sign}{top}") } else { format!("{sign}{top}/{}", 12 / common) }
}

/// `rotate(..)` or `space(..)` for roll, pitch and yaw; `None` if all are zero.
pub fn rotation(rpy: &Vector3<f64>) -> Option<String> {
    let turns: Vec<(&str, f64)> =
        ["x", "y", "z"].into_iter().zip(rpy.iter().copied()).filter(|&(_, angle)| angle != 0.0).collect();
    match turns[..] {
        [] => None,
        [(axis, about)] => Some(format!("rotate({axis}, {})", angle(about))),
        _ => Some(format!("space(xyz, {}, {}, {})", angle(rpy.x), angle(rpy.y), angle(rpy.z))),
    }
}

/// The axis of a rotation in the model language.
pub fn axis_word(axis: &Vector3<f64>) -> String {
    match aligned(axis) {
        Some((sign, letter)) => format!("{sign}{letter}"),
        None => format!("[{}, {}, {}]", decimal(axis.x), decimal(axis.y), decimal(axis.z)),
    }
}

/// A vector given by its components along the axes of a frame.
pub fn combination(vector: &Vector3<f64>, axes: &str) -> String {
    match aligned(vector) {
        Some((sign, letter)) => format!("{sign}{axes}.{letter}"),
        None => format!("{axes}.vec({}, {}, {})", decimal(vector.x), decimal(vector.y), decimal(vector.z)),
    }
}

/// The sign and the name of the axis, if the vector is a coordinate axis.
pub fn aligned(vector: &Vector3<f64>) -> Option<(&'static str, &'static str)> {
    let (index, largest) = vector.iter().copied().enumerate().find(|(_, number)| *number != 0.0)?;
    let alone = vector.iter().filter(|&&number| number != 0.0).count() == 1;
    (alone && largest.abs() == 1.0).then(|| (if largest < 0.0 { "-" } else { "" }, ["x", "y", "z"][index]))
}

/// `factor*vector`, with a sign of the vector moved to the front.
pub fn times(factor: &str, vector: &str) -> String {
    let factor = if factor.starts_with('(') { factor.to_owned() } else { bracketed(factor) };
    match vector.strip_prefix('-') {
        Some(vector) => format!("-{factor}*{vector}"),
        None => format!("{factor}*{vector}"),
    }
}

/// `a*v + b*w + ..`
pub fn weighted(factors: &[String], vectors: &[String]) -> String {
    let terms: Vec<String> =
        factors.iter().zip(vectors).map(|(factor, vector)| times(factor, vector)).collect();
    terms.join(" + ").replace("+ -", "- ")
}
