//! Mass, mass centre and inertia of shapes of uniform density (section 16.8 of docs/theory.md).

use super::algebra::*;
use crate::model::mechanism::{Axis, FrameId, Kind, Scalar, Shape, Vector};

/// Mass properties of a shape.
pub struct MassProperties {
    /// kg
    pub mass: Scalar,
    /// xx, yy, zz about the mass centre, kg m^2
    pub inertia: [Scalar; 3],
    /// xy, yz, zx of the inertia matrix, with a plus sign
    pub products: [Scalar; 3],
    /// the frame of these
    pub frame: FrameId,
    /// from the shape's place to the mass centre
    pub centre: Vector,
}

/// The mass properties of a shape that is no polytope; the error says what stands against it.
pub fn mass_properties(shape: &Shape) -> Result<MassProperties, &'static str> {
    let density = shape.density.clone().ok_or("it has no density")?;
    let times = |factors: Vec<Scalar>| Scalar::Mul(factors);
    let of_volume = |n: i64, d: i64, lengths: &[&Scalar]| {
        let mut factors = vec![ratio(n, d), density.clone()];
        factors.extend(lengths.iter().map(|length| (*length).clone()));
        times(factors)
    };
    let of_round = |n: i64, d: i64, lengths: &[&Scalar]| {
        let Scalar::Mul(mut factors) = of_volume(n, d, lengths) else { return integer(0) };
        factors.push(Scalar::Pi);
        times(factors)
    };
    // m times the sum of products
    let moment = |m: &Scalar, terms: Vec<(i64, i64, &Scalar, &Scalar)>| {
        let terms = terms.into_iter().map(|(n, d, a, b)| product([ratio(n, d), a.clone(), b.clone()]));
        product([m.clone(), Scalar::Add(terms.collect())])
    };
    let products = || [0, 0, 0].map(integer);
    let upright = |mass: Scalar, across: Scalar, along: Scalar, centre: Vector| {
        let axis = shape.axis.as_ref().and_then(as_axis);
        let (frame, axis) = axis.ok_or("its axis is no axis of a frame, such as `B.z`")?;
        let inertia = match axis {
            Axis::X => [along, across.clone(), across],
            Axis::Y => [across.clone(), along, across],
            Axis::Z => [across.clone(), across, along],
        };
        Ok(MassProperties { mass, inertia, products: products(), frame, centre })
    };
    match (shape.kind, &shape.sizes[..]) {
        (Kind::Sphere, [r]) => {
            let mass = of_round(4, 3, &[r, r, r]);
            let inertia = moment(&mass, vec![(2, 5, r, r)]);
            let inertia = [inertia.clone(), inertia.clone(), inertia];
            Ok(MassProperties {
                mass,
                inertia,
                products: products(),
                frame: shape.frame,
                centre: Vector::Zero,
            })
        }
        (Kind::Ellipsoid, [a, b, c]) => {
            let mass = of_round(4, 3, &[a, b, c]);
            let about = |p, q| moment(&mass, vec![(1, 5, p, p), (1, 5, q, q)]);
            let inertia = [about(b, c), about(c, a), about(a, b)];
            let frame = shape.axes.unwrap_or(shape.frame);
            Ok(MassProperties { inertia, products: products(), mass, frame, centre: Vector::Zero })
        }
        (Kind::Box, [a, b, c]) => {
            let mass = of_volume(1, 1, &[a, b, c]);
            let about = |p, q| moment(&mass, vec![(1, 12, p, p), (1, 12, q, q)]);
            let inertia = [about(b, c), about(c, a), about(a, b)];
            let frame = shape.axes.unwrap_or(shape.frame);
            Ok(MassProperties { inertia, products: products(), mass, frame, centre: Vector::Zero })
        }
        (Kind::Cylinder, [r, l]) => {
            let mass = of_round(1, 1, &[r, r, l]);
            let across = moment(&mass, vec![(1, 4, r, r), (1, 12, l, l)]);
            let along = moment(&mass, vec![(1, 2, r, r)]);
            upright(mass, across, along, Vector::Zero)
        }
        (Kind::Capsule, [r, l]) => {
            // the cylinder between, and two half balls whose mass centres are 3/8 r beyond its ends
            let (between, ends) = (of_round(1, 1, &[r, r, l]), of_round(4, 3, &[r, r, r]));
            let across = sum([
                moment(&between, vec![(1, 4, r, r), (1, 12, l, l)]),
                moment(&ends, vec![(2, 5, r, r), (3, 8, l, r), (1, 4, l, l)]),
            ]);
            let along = sum([moment(&between, vec![(1, 2, r, r)]), moment(&ends, vec![(2, 5, r, r)])]);
            upright(sum([between, ends]), across, along, Vector::Zero)
        }
        (Kind::Cone, [r, h]) => {
            let mass = of_round(1, 3, &[r, r, h]);
            let across = moment(&mass, vec![(3, 20, r, r), (3, 80, h, h)]);
            let along = moment(&mass, vec![(3, 10, r, r)]);
            let up =
                shape.axis.as_ref().map_or(Vector::Zero, |a| scaled(product([ratio(1, 4), h.clone()]), a));
            upright(mass, across, along, up)
        }
        (Kind::Torus, [big, r]) => {
            let Scalar::Mul(mut factors) = of_round(2, 1, &[big, r, r]) else { return Err("") };
            factors.push(Scalar::Pi);
            let mass = times(factors);
            let across = moment(&mass, vec![(1, 2, big, big), (5, 8, r, r)]);
            let along = moment(&mass, vec![(1, 1, big, big), (3, 4, r, r)]);
            upright(mass, across, along, Vector::Zero)
        }
        (Kind::Disc, _) => Err("a disc is a thin rim without volume; a wheel of some width is a cylinder"),
        (Kind::Rectangle, _) => Err("a rectangle has no volume: the mass of a block is that of a `box`"),
        _ => Err("it has no end"),
    }
}
