//! Evaluates a state several times: as it is, with all speeds zero, with one speed 1 and the others 0
//! (partial velocities), and moving on (accelerations).

use super::evaluator::{Evaluator, Level};
use super::hyper_dual::*;
use super::motion::{Instant, Maps};
use super::state::{Failure, State};
use crate::model::mechanism::*;

/// Components along N.x, N.y, N.z.
pub type Vector3 = [f64; 3];

/// Values without what they carry.
pub fn values(v: Triple) -> Vector3 {
    v.map(|c| c.re)
}

/// Rates along the motion that goes on.
pub fn accelerations(v: Triple) -> Vector3 {
    v.map(|c| c.e2)
}

/// Dot product.
pub fn dot3(a: Vector3, b: Vector3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Difference.
pub fn sub3(a: Vector3, b: Vector3) -> Vector3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Cross product.
pub fn cross3(a: Vector3, b: Vector3) -> Vector3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Length.
pub fn norm3(a: Vector3) -> f64 {
    dot3(a, a).sqrt()
}

/// Whether two lists of vectors are the same, but for rounding.
pub fn alike(a: &[Vector3], b: &[Vector3]) -> bool {
    let size = |list: &[Vector3]| list.iter().fold(0.0_f64, |size, v| size.max(norm3(*v)));
    let apart = a.iter().zip(b).fold(0.0_f64, |apart, (a, b)| apart.max(norm3(sub3(*a, *b))));
    apart <= 1e-9 * (size(a) + size(b))
}

/// The evaluations of a state.
pub struct Views<'m> {
    /// as it is
    pub now: Evaluator<'m>,
    /// with all independent speeds 0: what is left is prescribed motion
    pub rest: Evaluator<'m>,
    /// with one independent speed 1, the others 0
    pub units: Vec<Evaluator<'m>>,
    /// as it is, with e2 the rate of everything while the independent speeds stay
    pub onward: Evaluator<'m>,
    /// rates of the coordinates
    pub rates: Vec<f64>,
    /// all speeds, the dependent ones after the independent ones
    pub speeds: Vec<f64>,
    /// rates of the dependent speeds while the independent ones stay
    pub dependent_accelerations: Vec<f64>,
    /// per independent speed: what its unit adds to each dependent speed
    pub dependent_partials: Vec<Vec<f64>>,
}

impl<'m> Views<'m> {
    /// All views of a state.
    pub fn at(m: &'m Mechanism, state: &'m State) -> Result<Self, Failure> {
        let at = |time: HyperDual, coordinates: Vec<HyperDual>| Instant { m, state, time, coordinates };
        let still = at(
            HyperDual::constant(state.time),
            state.coordinates.iter().map(|q| HyperDual::constant(*q)).collect(),
        );
        let maps = still.maps()?;
        let view = |maps: &Maps, independent: &[HyperDual]| {
            let speeds = maps.speeds(independent);
            (maps.rates(&speeds), speeds)
        };
        let independent: Vec<HyperDual> = state.speeds.iter().map(|u| HyperDual::constant(*u)).collect();
        let p = independent.len();
        let (rates, speeds) = view(&maps, &independent);
        let onward = at(
            HyperDual { re: state.time, e2: 1.0, ..HyperDual::ZERO },
            state
                .coordinates
                .iter()
                .zip(&rates)
                .map(|(q, r)| HyperDual { re: *q, e2: r.re, ..HyperDual::ZERO })
                .collect(),
        );
        let onward_maps = onward.maps()?;
        let (onward_rates, onward_speeds) = view(&onward_maps, &independent);
        let evaluator_at = |w: &[HyperDual]| {
            let (rates, speeds) = view(&maps, w);
            let dependent: Vec<f64> = speeds.iter().skip(p).map(|u| u.re).collect();
            (still.evaluator(&rates, speeds), dependent)
        };
        let mut unit = vec![HyperDual::ZERO; p];
        let (rest, at_rest) = evaluator_at(&unit);
        let mut units = Vec::new();
        let mut dependent_partials = Vec::new();
        for r in 0..p {
            unit[r] = HyperDual::ONE;
            let (evaluator, moving) = evaluator_at(&unit);
            units.push(evaluator);
            dependent_partials.push(moving.iter().zip(&at_rest).map(|(u, rest)| u - rest).collect());
            unit[r] = HyperDual::ZERO;
        }
        Ok(Views {
            now: still.evaluator(&rates, speeds.clone()),
            rest,
            units,
            rates: rates.iter().map(|r| r.re).collect(),
            speeds: speeds.iter().map(|u| u.re).collect(),
            dependent_accelerations: onward_speeds[p.min(onward_speeds.len())..]
                .iter()
                .map(|u| u.e2)
                .collect(),
            dependent_partials,
            onward: onward.evaluator(&onward_rates, onward_speeds),
        })
    }

    /// Partial velocities: what each unit of speed adds.
    pub fn partials<'v>(
        &'v self,
        of: impl Fn(&Evaluator<'v>) -> Result<Triple, Failure>,
    ) -> Result<Vec<Vector3>, Failure>
    where
        'm: 'v,
    {
        let rest = values(of(&self.rest)?);
        self.units.iter().map(|unit| Ok(sub3(values(of(unit)?), rest))).collect()
    }

    /// The parts of a vector that is linear in the speeds: of each independent speed, then what is left where
    /// all are 0.
    pub fn vector_parts<'v>(
        &'v self,
        of: impl Fn(&Evaluator<'v>) -> Result<Triple, Failure>,
    ) -> Result<Vec<Vector3>, Failure>
    where
        'm: 'v,
    {
        let mut parts = self.partials(&of)?;
        parts.push(values(of(&self.rest)?));
        Ok(parts)
    }

    /// The parts of something linear in the speeds: of each independent speed, then what is left where all
    /// are 0.
    pub fn parts<'v>(
        &'v self,
        of: impl Fn(&Evaluator<'v>) -> Result<f64, Failure>,
    ) -> Result<Vec<f64>, Failure>
    where
        'm: 'v,
    {
        let rest = of(&self.rest)?;
        let units = self.units.iter().map(|unit| Ok(of(unit)? - rest));
        units.chain([Ok(rest)]).collect()
    }

    /// The parts of the rate of a scalar that is free of speeds.
    pub fn rate_parts(&self, scalar: &Scalar) -> Result<Vec<f64>, Failure> {
        self.parts(|values| Ok(values.scalar(scalar, Level::Geometry)?.e1))
    }
}
