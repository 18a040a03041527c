//! Grounds with hollows that are too narrow for the spheres that roll on them (section 16.13 of docs/theory.md).

use super::bodies::number;
use super::states::at_rest;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::*;
use crate::numeric::views::dot3;
use crate::numeric::{Evaluator, Failure, Level, State};

/// How far around the start a ground is looked at, in radii of the sphere, and how often along each axis.
const AROUND: f64 = 20.0;
const PLACES: i32 = 40;
/// By which share of the radius slopes are compared that tell a curvature.
const APART: f64 = 1e-5;

/// A warning for each contact of a sphere on a surface or curve that is more curved than the sphere, somewhere around the
/// start.
pub fn narrow(m: &Mechanism) -> Vec<Diagnostic> {
    let state = State::of(m);
    let values = at_rest(m, &state);
    m.contacts.iter().filter_map(|contact| narrowest(m, &values, contact).ok()?).collect()
}

fn narrowest(
    m: &Mechanism,
    values: &Evaluator<'_>,
    contact: &Contact,
) -> Result<Option<Diagnostic>, Failure> {
    let Some([sphere, ground]) = contact.shapes.map(|pair| pair.map(|id| &m.shapes[id.0])) else {
        return Ok(None);
    };
    let (Kind::Sphere, Some(height), [radius]) = (sphere.kind, &ground.height, &sphere.sizes[..]) else {
        return Ok(None);
    };
    let radius = values.scalar(radius, Level::Motion)?.re;
    let place = |anchor: &Anchor| -> Result<[f64; 3], Failure> {
        let (at, by) = (values.position(anchor.point)?, values.vector(&anchor.by, Level::Geometry)?);
        Ok([0, 1, 2].map(|i| at[i].re + by[i].re))
    };
    let (centre, origin) = (place(&sphere.at)?, place(&ground.at)?);
    let axes = values.orientation(ground.axes.unwrap_or(ground.frame))?;
    let from = [0, 1, 2].map(|i| centre[i] - origin[i]);
    let along = |axis: usize| dot3(from, [0, 1, 2].map(|row| axes[row][axis].re));
    let is_curve = ground.kind == Kind::Curve;
    let slopes = |x: f64, y: f64| -> Option<[f64; 2]> {
        let slopes = height.slopes_at([x, y])?;
        let [a, b] = slopes.each_ref().map(|slope| values.scalar(slope, Level::Motion).ok());
        Some([a?.re, if is_curve { 0.0 } else { b?.re }])
    };
    // the radius of the tightest hollow, and where it is
    let mut tightest: Option<(f64, [f64; 2])> = None;
    let step = 2.0 * AROUND * radius / f64::from(PLACES);
    let across = if is_curve { 0..=0 } else { -PLACES / 2..=PLACES / 2 };
    for j in across {
        for i in -PLACES / 2..=PLACES / 2 {
            let y = if is_curve { 0.0 } else { along(1) + step * f64::from(j) };
            let x = along(0) + step * f64::from(i);
            let h = APART * radius;
            let around =
                [slopes(x + h, y), slopes(x - h, y), slopes(x, y + h), slopes(x, y - h), slopes(x, y)];
            let [Some(east), Some(west), Some(north), Some(south), Some([p, q])] = around else { continue };
            let [xx, xy, yy] = [east[0] - west[0], north[0] - south[0], north[1] - south[1]]
                .map(|difference| difference / (2.0 * h));
            let curvature = greatest_curvature([p, q], [xx, xy, yy]);
            if curvature > tightest.map_or(1.0 / radius, |(radius, _)| 1.0 / radius) {
                tightest = Some((1.0 / curvature, [x, y]));
            }
        }
    }
    let Some((least, [x, y])) = tightest else { return Ok(None) };
    let at =
        if is_curve { format!("x = {}", number(x)) } else { format!("x = {}, y = {}", number(x), number(y)) };
    let message = format!(
        "`{}` is larger than a hollow of `{}`: it touches at several places there",
        sphere.name, ground.name
    );
    let help = format!(
        "near {at} the ground has a radius of {} m, and the sphere one of {} m; one contact knows one place only",
        number(least),
        number(radius)
    );
    let span = contact.point_span.to(contact.against_span);
    Ok(Some(Diagnostic::new(codes::NARROW, span, message).related(ground.span, "this ground").help(help)))
}

/// The greatest curvature of a surface z = h(x, y), upwards: the greatest eigenvalue of the second derivatives xx, xy, yy
/// beside the matrix 1 + p^2, p q, 1 + q^2 of its slopes, over the length of (p, q, 1).
fn greatest_curvature([p, q]: [f64; 2], [xx, xy, yy]: [f64; 3]) -> f64 {
    let (e, f, g, steep) = (1.0 + p * p, p * q, 1.0 + q * q, (1.0 + p * p + q * q).sqrt());
    let mean = (xx * g - 2.0 * xy * f + yy * e) / (2.0 * steep.powi(3));
    let gauss = (xx * yy - xy * xy) / steep.powi(4);
    mean + (mean * mean - gauss).max(0.0).sqrt()
}
