//! Locates events: finds the first point of a step at which one of several functions falls below zero.
//!
//! Each function is interpolated at Chebyshev points; their number is increased, or the step divided, until
//! the last coefficients are negligible. Between its points the polynomial p is bounded: on an interval of
//! half width r about m it is at least p(m) - |p'(m)| r - P r^2 / 2, where P bounds |p''|. Intervals in which
//! this excludes a zero are skipped, on intervals in which p' cannot vanish the ends are compared, and all
//! others are halved. So no extremum is missed.
//!
//! Functions of forces are looked at first where the integration has evaluated the forces anyway, at eight of its
//! stages: most are far from zero there, and need no point of their own.
//!
//! A function that oscillates between the points may look smooth at them. So a step is examined in pieces, in
//! each of which angles change by a few radians at most, and the slope of the polynomial is compared with
//! that of the function, which is known for gaps (docs/theory.md, section 17.12).

use std::sync::LazyLock;

use nalgebra::{SMatrix, SVector};
use smallvec::SmallVec;

use crate::integration::stepper::PLACES;

/// The degrees that are tried; each is twice the previous one, so that points are reused. The first is
/// skipped if the function rotates faster than its points resolve.
const DEGREES: [usize; 4] = [4, 8, 16, 32];
/// The part of the rotation resolved by nine points that five points resolve.
const FEW_TURNS: f64 = 0.5;
/// Largest number of bisections of a step in which a function is not smooth.
const DEPTH: usize = 24;

/// Largest number of evaluations of the functions in a step, and additionally in each of its pieces.
const MOST: usize = 2000;
const OF_A_PIECE: usize = 36;
/// A step is bisected at least this many times before a deviation is attributed to rounding.
const HALVED: usize = 3;

/// Points of a piece, in [-1, 1], at which slopes are compared, and the greatest difference relative to the
/// terms of the polynomial's slope.
const SLOPES_AT: [f64; 2] = [-0.371, 0.653];
const SLOPES_DIFFER: f64 = 1e-3;

/// A function is not smooth in a piece of a step that has been bisected so many times, if the last coefficients
/// of the polynomial through nine points exceed this part of its size.
const SHORT: usize = 6;
const JUMPS: f64 = 1e-2;
/// The greatest difference of a function from its polynomial at a zero, in units of what the polynomial may be off by.
const ELSEWHERE: f64 = 10.0;

/// Values of a lower order exclude a zero where the polynomial through them stays within this part of its mean.
const NEAR: f64 = 0.9;

/// The values of so many functions, and so many points, need no memory from the heap.
pub(crate) type Values = SmallVec<[f64; 12]>;
/// The rates of functions where they are known; the list is as long as that of the functions.
pub(crate) type Slopes = SmallVec<[Option<f64>; 12]>;
type AtPoints<T> = SmallVec<[T; 9]>;

/// Functions whose first zero crossing is sought.
pub(crate) struct Functions<'f> {
    /// number of functions
    pub count: usize,
    /// bounds of their rounding errors
    pub noise: &'f [f64],
    /// one of them at the [`PLACES`] of the step, by states of a lower order; `None` where it is not known
    pub near: &'f dyn Fn(usize) -> Option<[f64; 8]>,
    /// these of them at a fraction of the step; `None` if they cannot be evaluated there
    pub values: &'f mut dyn FnMut(f64, &[usize]) -> Option<Values>,
    /// their rates with respect to the fraction, where they are known
    pub slopes: &'f mut dyn FnMut(f64) -> Slopes,
}

/// The functions have no values somewhere in the step, or the step is too long for them: a shorter one must
/// be examined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Unresolved;

/// A place where a function falls below zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Index of the function.
    pub function: usize,
    /// Fraction of the step.
    pub place: f64,
}

/// cos(k pi / 32) over a full turn.
static COSINES: LazyLock<[f64; 64]> =
    LazyLock::new(|| std::array::from_fn(|k| (k as f64 * std::f64::consts::PI / 32.0).cos()));

/// cos(m pi / n), reduced to one turn, so that equal angles give equal bits.
fn cosine(m: usize, n: usize) -> f64 {
    let turn = m % (2 * n);
    match COSINES.len() / 2 % n {
        0 => COSINES[turn * (COSINES.len() / 2 / n)],
        _ => (turn as f64 * std::f64::consts::PI / n as f64).cos(),
    }
}

/// A polynomial by its Chebyshev coefficients on [-1, 1].
struct Chebyshev {
    coefficients: AtPoints<f64>,
    /// Bound of the second derivative.
    bend: f64,
    /// Bound of the difference from the function.
    error: f64,
}

impl Chebyshev {
    /// The polynomial through values at cos(k pi / n), k = 0 .. n.
    fn through(values: &[f64]) -> Self {
        let n = values.len() - 1;
        let nf = n as f64;
        let mut coefficients = AtPoints::from_elem(0.0, n + 1);
        for (j, coefficient) in coefficients.iter_mut().enumerate() {
            let mut sum = 0.0;
            for (k, value) in values.iter().enumerate() {
                let weight = if k == 0 || k == n { 0.5 } else { 1.0 };
                sum += weight * value * cosine(j * k, n);
            }
            let half = if j == 0 || j == n { 1.0 } else { 2.0 };
            *coefficient = half * sum / nf;
        }
        let bend = coefficients.iter().enumerate().map(|(k, c)| {
            let k = (k * k) as f64;
            c.abs() * k * (k - 1.0) / 3.0
        });
        let bend = bend.sum();
        let last = coefficients.iter().rev().take(3).map(|c| c.abs()).fold(0.0, f64::max);
        // The coefficients are sums of the values, so rounding leaves an error even if the last of them
        // vanish.
        let size: f64 = coefficients.iter().map(|c| c.abs()).sum();
        Self { coefficients, bend, error: 2.0 * last + 4.0 * f64::EPSILON * size }
    }

    fn size(&self) -> f64 {
        self.coefficients.iter().map(|c| c.abs()).sum()
    }

    /// Value and derivative.
    fn at(&self, x: f64) -> (f64, f64) {
        // Clenshaw's recurrence, and its derivative.
        let (mut b1, mut b2, mut d1, mut d2) = (0.0, 0.0, 0.0, 0.0);
        for &c in self.coefficients.iter().skip(1).rev() {
            let d = 2.0 * b1 + 2.0 * x * d1 - d2;
            (d2, d1) = (d1, d);
            let b = c + 2.0 * x * b1 - b2;
            (b2, b1) = (b1, b);
        }
        let first = self.coefficients.first().copied().unwrap_or(0.0);
        (first + x * b1 - b2, b1 + x * d1 - d2)
    }

    /// Whether its slope at a point is the given one, up to the accuracy of interpolated slopes. Far from zero more is
    /// allowed: what oscillates as far as zero has slopes of more than its distance, and where two branches are next to
    /// each other, rounding makes a function jump from one to the other.
    fn has_slope(&self, x: f64, slope: f64, noise: f64) -> bool {
        let terms = |(k, c): (usize, &f64)| (k * k) as f64 * c.abs();
        let far = self.coefficients.first().map_or(0.0, |first| first.abs());
        let size: f64 = self.coefficients.iter().enumerate().map(terms).sum();
        let rounding = 1e3 * noise + 1e-12 * self.size();
        (self.at(x).1 - slope).abs() <= SLOPES_DIFFER * size.max(slope.abs()).max(far) + rounding
    }

    /// The first point in [low, high] where the polynomial falls below -noise.
    fn first_below(&self, low: f64, high: f64, noise: f64, depth: usize) -> Option<f64> {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let (value, slope) = self.at(middle);
        let reach = slope.abs() * half + 0.5 * self.bend * half * half;
        if value - reach >= -noise {
            return None;
        }
        if reach <= f64::EPSILON * self.size() {
            // The polynomial is constant here: bisection of a function that is always zero must end.
            return (value < -noise).then_some(low);
        }
        let monotone = slope.abs() > self.bend * half;
        if monotone || depth == 0 || half < 1e-13 {
            let (first, last) = (self.at(low).0, self.at(high).0);
            if first < -noise {
                return Some(low);
            }
            return (last < -noise).then(|| self.bisect(low, high));
        }
        self.first_below(low, middle, noise, depth - 1)
            .or_else(|| self.first_below(middle, high, noise, depth - 1))
    }

    /// The zero between a point where the polynomial is not negative and one where it is.
    fn bisect(&self, mut low: f64, mut high: f64) -> f64 {
        if self.at(low).0 <= 0.0 {
            return low;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.at(middle).0 > 0.0 { low = middle } else { high = middle }
        }
        high
    }
}

/// The inverse of the values of Chebyshev's polynomials at the [`PLACES`] of a step: it turns values there into
/// coefficients.
static BY_PLACES: LazyLock<SMatrix<f64, 8, 8>> = LazyLock::new(|| {
    let mut values = SMatrix::<f64, 8, 8>::zeros();
    for (row, place) in PLACES.iter().enumerate() {
        let x = 2.0 * place - 1.0;
        let (mut before, mut here) = (x, 1.0);
        for column in 0..8 {
            values[(row, column)] = here;
            (before, here) = (here, 2.0 * x * here - before);
        }
    }
    values.try_inverse().unwrap_or_else(SMatrix::zeros)
});

/// Whether a function is far from zero in the whole step by its values at the [`PLACES`].
fn stays_away(values: &[f64; 8]) -> bool {
    let coefficients = *BY_PLACES * SVector::from(*values);
    let last = coefficients.iter().rev().take(3).map(|c| c.abs()).fold(0.0, f64::max);
    let rest: f64 = coefficients.iter().skip(1).map(|c| c.abs()).sum();
    rest + 8.0 * 2.0 * last < NEAR * coefficients[0]
}

/// The first crossing of functions over the fractions [0, 1] of a step. `turns` is the rotation in the step
/// beyond what nine points resolve; it determines the least number of pieces.
///
/// # Errors
///
/// [`Unresolved`] if functions have no values, or too many evaluations were needed.
pub(crate) fn first_crossing(
    functions: &mut Functions<'_>,
    turns: f64,
) -> Result<Option<Crossing>, Unresolved> {
    if functions.count == 0 {
        return Ok(None);
    }
    let mut active: SmallVec<[usize; 12]> = (0..functions.count).collect();
    if turns <= FEW_TURNS {
        active.retain(|function| !(functions.near)(*function).is_some_and(|values| stays_away(&values)));
    }
    if active.is_empty() {
        return Ok(None);
    }
    let pieces = (turns.ceil() as usize).max(1);
    let mut left = MOST + OF_A_PIECE * pieces;
    let degrees = if turns / pieces as f64 <= FEW_TURNS { &DEGREES[..] } else { &DEGREES[1..] };
    for piece in 0..pieces {
        let end = |piece: usize| piece as f64 / pieces as f64;
        let found = within(&active, functions, (&mut left, degrees), end(piece), end(piece + 1), DEPTH)?;
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

fn within(
    active: &[usize],
    functions: &mut Functions<'_>,
    (budget, degrees): (&mut usize, &[usize]),
    low: f64,
    high: f64,
    depth: usize,
) -> Result<Option<Crossing>, Unresolved> {
    let mut points: AtPoints<Option<Values>> = AtPoints::new();
    let mut unresolved = SmallVec::<[usize; 12]>::from_slice(active);
    let mut jumps = SmallVec::<[usize; 12]>::new();
    let mut found: Option<Crossing> = None;
    let mut values = |functions: &mut Functions<'_>, place: f64, asked: &[usize]| {
        *budget = budget.checked_sub(1)?;
        let found = (functions.values)(place, asked)?;
        let mut all = Values::from_elem(f64::NAN, functions.count);
        asked.iter().zip(found).for_each(|(&function, value)| all[function] = value);
        Some(all)
    };
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let slopes = SLOPES_AT.map(|x| (functions.slopes)(middle + half * x));
    for &degree in degrees {
        // Every second point is known.
        let mut next = AtPoints::from_elem(None, degree + 1);
        for (k, slot) in next.iter_mut().enumerate() {
            let known = if points.is_empty() || k % 2 == 1 {
                None
            } else {
                points.get_mut(k / 2).and_then(Option::take)
            };
            let x = (k as f64 * std::f64::consts::PI / degree as f64).cos();
            let place = if k == 0 {
                high
            } else if k == degree {
                low
            } else {
                low + 0.5 * (high - low) * (1.0 + x)
            };
            *slot = known.or_else(|| values(functions, place, &unresolved));
        }
        points = next;
        let rows: AtPoints<&Values> =
            points.iter().map(Option::as_ref).collect::<Option<_>>().ok_or(Unresolved)?;
        let mut left = SmallVec::new();
        for function in unresolved {
            let column: AtPoints<f64> = rows.iter().map(|row| row[function]).collect();
            let polynomial = Chebyshev::through(&column);
            let noise = functions.noise.get(function).copied().unwrap_or(0.0);
            let (size, error) = (polynomial.size(), polynomial.error);
            let rest = size - 2.0 * polynomial.coefficients[0].abs();
            let fine = (1e-13 * size).max(4.0 * noise);
            let rounding = degree == DEGREES[3] && depth + HALVED <= DEPTH && error <= 1e-9 * size;
            let known = slopes.iter().map(|slopes| slopes.get(function).copied().flatten());
            let alike = SLOPES_AT
                .iter()
                .zip(known)
                .all(|(&x, slope)| slope.is_none_or(|slope| polynomial.has_slope(x, slope * half, noise)));
            if degree == DEGREES[1] && depth + SHORT <= DEPTH && error > JUMPS * size {
                jumps.push(function);
            }
            if !alike && !rounding {
                left.push(function);
                continue;
            }
            // Far from zero, or well interpolated.
            if polynomial.coefficients[0] > 0.0 && rest + 8.0 * error < 0.0 {
                continue;
            }
            if error > fine && !rounding {
                left.push(function);
                continue;
            }
            if let Some(x) = polynomial.first_below(-1.0, 1.0, noise + error, 60) {
                let place = low + 0.5 * (high - low) * (1.0 + x);
                // A function with several branches may be on another one there than at all points.
                let there = values(functions, place, &[function]).ok_or(Unresolved)?[function];
                if (there - polynomial.at(x).0).abs() > ELSEWHERE * (error + fine) {
                    left.push(function);
                    continue;
                }
                if found.is_none_or(|crossing| place < crossing.place) {
                    found = Some(Crossing { function, place });
                }
            }
        }
        unresolved = left;
        if unresolved.is_empty() {
            return Ok(found);
        }
        // More points do not help where all that is left jumps, or has a kink.
        if degree == DEGREES[1] && unresolved.iter().all(|function| jumps.contains(function)) {
            break;
        }
    }
    // Behind a crossing nothing is looked for.
    let high = found.map_or(high, |crossing| crossing.place);
    let middle = 0.5 * (low + high);
    if depth == 0 || high - low < 1e-12 {
        // Not smooth even here: the values at the ends decide.
        let ends = (values(functions, low, &unresolved), values(functions, high, &unresolved));
        if let (Some(_), Some(last)) = ends {
            for function in unresolved {
                let noise = functions.noise.get(function).copied().unwrap_or(0.0);
                if last[function] < -noise && found.is_none_or(|crossing| high < crossing.place) {
                    found = Some(Crossing { function, place: high });
                }
            }
        }
        return Ok(found);
    }
    let rest = unresolved;
    let first = within(&rest, functions, (budget, degrees), low, middle, depth - 1)?;
    let earliest = |a: Option<Crossing>, b: Option<Crossing>| match (a, b) {
        (Some(a), Some(b)) => Some(if b.place < a.place { b } else { a }),
        (a, b) => a.or(b),
    };
    if let Some(first) = first {
        return Ok(earliest(found, Some(first)));
    }
    if found.is_some_and(|crossing| crossing.place <= middle) {
        return Ok(found);
    }
    Ok(earliest(found, within(&rest, functions, (budget, degrees), middle, high, depth - 1)?))
}

#[cfg(test)]
mod tests {
    use smallvec::smallvec;

    use super::*;

    fn crossing(noise: f64, values: &mut dyn FnMut(f64) -> Option<f64>) -> Result<Option<f64>, Unresolved> {
        let mut functions = Functions {
            count: 1,
            noise: &[noise],
            near: &|_| None,
            values: &mut |x, _| values(x).map(|value| smallvec![value]),
            slopes: &mut |_| smallvec![None],
        };
        Ok(first_crossing(&mut functions, 1.0)?.map(|crossing| crossing.place))
    }

    fn first(f: impl Fn(f64) -> f64) -> Option<f64> {
        crossing(0.0, &mut |x| Some(f(x))).unwrap()
    }

    /// A cosine with many periods looks constant at the nine points of a piece; its slopes reveal it.
    #[test]
    fn turns_between_the_points_are_seen_by_their_slopes() {
        let mut missed = 0;
        for k in 1..400 {
            let omega = 2.0 * std::f64::consts::PI * f64::from(k);
            let gap = |x: f64| 0.5 + 0.6 * (omega * x + 0.1).cos() - 0.01 * x;
            let rate = |x: f64| -0.6 * omega * (omega * x + 0.1).sin() - 0.01;
            let mut functions = Functions {
                count: 1,
                noise: &[0.0],
                near: &|_| None,
                values: &mut |x, _| Some(smallvec![gap(x)]),
                slopes: &mut |x| smallvec![Some(rate(x))],
            };
            let found = first_crossing(&mut functions, 1.0).unwrap();
            let mut x = 0.0;
            while gap(x) > 0.0 {
                x += 1e-3 / omega;
            }
            let place = found.map_or(f64::NAN, |crossing| crossing.place);
            missed += usize::from((place - x).abs() > 2e-3 / omega);
        }
        assert_eq!(missed, 0);
    }

    /// The gap of a vertex that passes beside a face is its height where the bodies overlap, and where it is within the
    /// face, but not in between: all points lie on a line whose zero is none. It is found where bodies overlap.
    #[test]
    fn zeros_of_another_branch_are_none() {
        let gap = |x: f64| if (0.02..0.0308).contains(&x) { 0.003 } else { 0.0301 - x };
        let place = first(gap).unwrap();
        assert!((place - 0.0308).abs() < 1e-6, "{place}");
    }

    /// Where corners meet, a contact that is none is positive by next to nothing until bodies overlap: it does not take the
    /// place of the one that touches.
    #[test]
    fn next_to_nothing_is_no_zero() {
        let other = |x: f64| if (-3e-10..6e-6).contains(&(x - 0.5)) { 3e-10 } else { 0.5 - x };
        let mut functions = Functions {
            count: 2,
            noise: &[1e-16; 2],
            near: &|_| None,
            values: &mut |x, asked| {
                Some(asked.iter().map(|&one| if one == 0 { other(x) } else { 0.5 - x }).collect())
            },
            slopes: &mut |_| smallvec![Some(-1.0); 2],
        };
        let found = first_crossing(&mut functions, 1.0).unwrap().unwrap();
        assert!(found.function == 1 && (found.place - 0.5).abs() < 1e-13, "{found:?}");
    }

    /// Where two sides of a body are at a tie, rounding makes a gap jump between two values that are next to each other. Far
    /// from zero that is no reason to look closer, though the slope between the points is not the one that is known.
    #[test]
    fn jumps_between_two_branches_are_not_looked_at_for_ever() {
        let jumps = |x: f64| (x * 1e7).fract() < 0.3;
        let mut looks = 0;
        let mut functions = Functions {
            count: 1,
            noise: &[1e-16],
            near: &|_| None,
            values: &mut |x, _| {
                looks += 1;
                Some(smallvec![0.0353 - 1e-9 * x + if jumps(x) { 4e-10 } else { 0.0 }])
            },
            slopes: &mut |_| smallvec![Some(-1e-9)],
        };
        assert!(first_crossing(&mut functions, 1.0).unwrap().is_none());
        assert!(looks < 20, "{looks}");
    }

    /// What the values at the places of a step exclude has no zero in it: of functions of a turn in all, as far down as
    /// they go, none that falls below a thirtieth of its mean is excluded, and most that stay above half of it are.
    #[test]
    fn places_exclude_no_zero() {
        let (mut excluded, mut far) = (0, 0);
        for k in 0..4000 {
            let part = f64::from(k) / 4000.0;
            let (turn, phase) = (2.0 * (17.0 * part).fract(), 6.3 * (61.0 * part).fract());
            let (depth, tilt) = (2.0 * (101.0 * part).fract(), (211.0 * part).fract() - 0.5);
            let f = |x: f64| 1.0 + depth * (turn * x + phase).cos() + tilt * (x - 0.5);
            let least = (0..=1000).map(|i| f(f64::from(i) / 1000.0)).fold(f64::INFINITY, f64::min);
            let mean = 0.5 * (f(0.0) + f(1.0));
            let away = stays_away(&PLACES.map(f));
            assert!(!away || least > mean / 30.0, "{k}: {least}");
            if least > 0.5 * mean.abs() {
                far += 1;
                excluded += u32::from(away);
            }
        }
        assert!(far > 500 && 10 * excluded > 9 * far, "{excluded} of {far}");
    }

    #[test]
    fn crossings_are_found_wherever_they_are() {
        for k in 1..200 {
            let zero = f64::from(k) / 200.0;
            let place = first(|x| zero - x).unwrap();
            assert!((place - zero).abs() < 1e-12);
            // Down and up again within a thousandth of the step: no sign change between the ends.
            let width = 5e-4;
            if zero < 0.99 {
                let place = first(|x| (x - zero) * (x - zero - width) * (1.0 + x)).unwrap();
                assert!((place - zero).abs() < 1e-9, "{zero}: {place}");
            }
        }
    }

    #[test]
    fn oscillations_are_resolved() {
        // The dip below zero is the 23rd minimum.
        let f = |x: f64| 1.0001 + (300.0 * x).cos() - 0.0002 * x;
        let place = first(f).unwrap();
        let mut x = 0.0;
        while f(x) > 0.0 {
            x += 1e-7;
        }
        assert!((place - x).abs() < 2e-7, "{place} {x}");
        assert!(first(|x| 1.0001 + (300.0 * x).cos()).is_none());
        assert!(first(|x: f64| (x - 0.3).powi(2)).is_none());
    }

    /// Rounding errors that no polynomial resolves, and functions without values, cost a bounded number of
    /// evaluations.
    #[test]
    fn the_work_is_bounded() {
        let mut count = 0;
        let mut evaluated = |f: &dyn Fn(f64) -> Option<f64>| {
            count = 0;
            let found = crossing(0.0, &mut |x| {
                count += 1;
                f(x)
            });
            (found, count)
        };
        let rough = |x: f64| 1e-10 * ((1e9 * x).sin() * 1e6).sin();
        let (found, count) = evaluated(&|x| Some(1.5 - x + rough(x)));
        assert_eq!(found, Ok(None));
        assert!(count < 1000, "{count}");
        let (found, count) = evaluated(&|x| Some(0.625 - x + rough(x)));
        assert!((found.unwrap().unwrap() - 0.625).abs() < 1e-8 && count < 1000, "{count}");
        let (found, count) = evaluated(&|x| (x < 0.7).then_some(1.0));
        assert!(found == Err(Unresolved) && count < 100, "{count}");
        // Noise as large as the function.
        let (_, count) = evaluated(&|x| Some(1.0001 + (1e9 * x).sin()));
        assert!(count <= MOST + OF_A_PIECE, "{count}");
    }

    /// A force that is zero during the whole contact, exactly or up to rounding, does not cross zero and
    /// costs only a few bisections.
    #[test]
    fn functions_that_stay_zero_are_not_halved_for_ever() {
        assert!(first(|_| 0.0).is_none());
        assert!(first(|x| 1e-30 * x * (1.0 - x)).is_none());
        for k in 0..60 {
            let tiny = 1e-16 * f64::from(k).exp2();
            let _ = first(|x| tiny * (1e5 * x).sin());
            let _ = crossing(1.0, &mut |x| Some(tiny * (20.0 * x).sin() - 1.0));
        }
    }

    #[test]
    fn kinks_do_not_hide_a_crossing() {
        let place = first(|x: f64| (x - 0.4).abs() - 1e-4).unwrap();
        assert!((place - 0.3999).abs() < 1e-6, "{place}");
    }
}
