//! The end of slip. In three dimensions slip does not change its sign smoothly there (docs/theory.md, section
//! 17.5).
//!
//! Close to the end only the slip changes: with dt = s dtau, phi' = h(phi) and (ln s)' = g(phi), where g and
//! h are the accelerations along the slip and perpendicular to it. If phi tends to a direction with g < 0,
//! slip ends, after a time that these equations give; if g becomes positive, slip grows again and misses
//! zero. Slip that turns into a jam (section 17.6) ends there: its impact without collision removes the
//! remaining slip.

use hodograph::ContactError;
use hodograph::generated::hypot;
use nalgebra::Vector2;

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::forces::{Forces, Hold, Lacking, forces};
use crate::contact_problem::Wanted;
use crate::integration::motion::{DIRECTION, Evaluation};

/// The future of slip.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Fate {
    /// It ends after this time, s.
    Ends(f64),
    /// It does not end.
    PassesBy,
}

/// Slip that ends within this part of the time of the problem is followed to its end separately.
pub(crate) const ENDING: f64 = 5e-9;
const STEPS: usize = 4000;
/// Difference of angles for the slope of h, rad.
const TURN: f64 = 1e-5;
/// That difference is divided by ten at most this many times.
const LESS: usize = 5;
/// The direction counts as settled at this distance from its limit, rad: the remaining time of slip is less
/// than [`ENDING`], and its error of first order in this.
const SETTLED: f64 = 1e-6;

/// Follows the slip of the contact with this index to its end, with all else constant; only an end within
/// this time counts.
pub(crate) fn fate(support: &ClosedContacts, holds: &[Hold], mu: &[f64], place: usize, within: f64) -> Fate {
    let slip = support.slip(place);
    let start = slip.norm();
    let mut holds = holds.to_vec();
    // g and h in a direction.
    let mut rates = |phi: f64| -> Result<(f64, f64), Lacking> {
        let d = Vector2::new(phi.cos(), phi.sin());
        holds[place] = Hold::Slide(d);
        let a = forces(support, &holds, mu, None, Wanted::Acceleration)?.acceleration;
        let a = Vector2::new(a[3 * place + 1], a[3 * place + 2]);
        Ok((a.dot(&d), d.x * a.y - d.y * a.x))
    };
    // Whether there are no rates because the contact jams.
    let without = |lacking: Lacking, time: f64| match lacking {
        Lacking::Contact(at, ContactError::Jam { .. } | ContactError::ImpactWithoutCollision { .. })
            if at == place && time < within =>
        {
            Fate::Ends(time)
        }
        _ => Fate::PassesBy,
    };
    let (mut size, mut phi, mut time) = (0.0_f64, slip.y.atan2(slip.x), 0.0);
    for _ in 0..STEPS {
        let (g, h) = match rates(phi) {
            Ok(rates) => rates,
            Err(lacking) => return without(lacking, time),
        };
        // A contact that nearly jams has forces only in nearby directions.
        let turns = std::iter::successors(Some(TURN), |turn| Some(0.1 * turn)).take(LESS);
        let slope = turns.into_iter().find_map(|turn| {
            let (before, after) = (rates(phi - turn).ok()?, rates(phi + turn).ok()?);
            Some((after.1 - before.1) / (2.0 * turn))
        });
        let Some(slope) = slope else {
            return without(
                rates(phi + TURN).err().or(rates(phi - TURN).err()).unwrap_or(Lacking::Common),
                time,
            );
        };
        if size < -16.0 || (slope < 0.0 && h.abs() <= -SETTLED * slope) {
            let end = time - start * size.exp() / g;
            // Rates near a jam are unbounded; this method does not follow them.
            return if g < 0.0 && end < within { Fate::Ends(end) } else { Fate::PassesBy };
        }
        if size > 0.7 {
            return Fate::PassesBy;
        }
        // The Runge-Kutta method of order 4 with steps that are short compared with all rates: with longer
        // ones it is unstable where the direction settles fast.
        let d = 0.1 / (g.abs() + h.abs() + slope.abs()).max(f64::MIN_POSITIVE);
        let mut stage = || {
            let b = rates(phi + 0.5 * d * h)?;
            let c = rates(phi + 0.5 * d * b.1)?;
            Ok((b, c, rates(phi + d * c.1)?))
        };
        let (b, c, e) = match stage() {
            Ok(stages) => stages,
            Err(lacking) => return without(lacking, time),
        };
        let s = start * size.exp();
        let half = |g: f64| s * (0.5 * d * g).exp();
        time += d / 6.0 * (s + 2.0 * half(g) + 2.0 * half(b.0) + s * (d * c.0).exp());
        size += d / 6.0 * (g + 2.0 * b.0 + 2.0 * c.0 + e.0);
        phi += d / 6.0 * (h + 2.0 * b.1 + 2.0 * c.1 + e.1);
    }
    Fate::PassesBy
}

/// The acceleration of slip that has just begun is zero up to rounding: below this part of its terms it
/// counts as zero. For steep inputs the rounding error of the event's time adds to it.
const BEGINS: f64 = 1e-7;

/// Slip below this part of the greatest speeds so far is a rounding error: it has just begun.
const ROUNDING: f64 = 1e-14;

/// Whether slip is a rounding error; `scale` holds the greatest speeds so far.
fn is_rounding(here: &Evaluation, place: usize, scale: &[f64]) -> bool {
    here.support.slip(place).norm() <= ROUNDING * here.support.velocity_size(place, scale)
}

/// The time after which slip would end at its present rate; `None` if it grows or has just begun. `scale`
/// holds the greatest speeds so far.
pub(crate) fn time_of_slip(here: &Evaluation, place: usize, scale: &[f64]) -> Option<f64> {
    let Hold::Slide(d) = here.holds[place] else { return None };
    let forces = here.forces.as_ref()?;
    let rate = Vector2::new(forces.acceleration[3 * place + 1], forces.acceleration[3 * place + 2]);
    let slip = here.support.slip(place).norm();
    let along = rate.dot(&d);
    if is_rounding(here, place, scale) && -along <= BEGINS * size_of_rate(here, forces, place) {
        return None;
    }
    (along < 0.0).then(|| slip / -along)
}

/// The sum of the magnitudes of the terms of the rate of slip.
fn size_of_rate(here: &Evaluation, forces: &Forces, place: usize) -> f64 {
    let support = &here.support;
    let size = |row: usize| {
        let terms = (0..forces.lambda.len()).map(|j| (support.coupled[(row, j)] * forces.lambda[j]).abs());
        support.beta[row].abs() + terms.sum::<f64>()
    };
    hypot(size(3 * place + 1), size(3 * place + 2))
}

/// Whether slip has passed zero: it is opposite to the direction in which it began, which its friction still
/// opposes, by more than rounding, and grows. So it is where slip began whose rate changed its sign before it
/// was as large as the errors of a step.
pub(crate) fn has_passed(here: &Evaluation, place: usize, scale: &[f64]) -> bool {
    let (Hold::Slide(d), Some(forces)) = (here.holds[place], here.forces.as_ref()) else { return false };
    let rate = Vector2::new(forces.acceleration[3 * place + 1], forces.acceleration[3 * place + 2]);
    here.support.slip(place).dot(&d) < 0.0
        && !is_rounding(here, place, scale)
        && -rate.dot(&d) > BEGINS * size_of_rate(here, forces, place)
}

/// Whether slip that has a direction is so small that its rate could end it within a time, were it
/// against the slip. A slip of 1e-10 m/s has the direction that the errors of the steps before leave it: it
/// may seem to grow while it turns, and ends nevertheless; slip that grows straight along its direction does not turn.
/// `speeds` are the generalised speeds, `scale` the greatest so far.
pub(crate) fn may_end(here: &Evaluation, place: usize, speeds: &[f64], scale: &[f64], within: f64) -> bool {
    if is_rounding(here, place, scale) {
        return false;
    }
    let (Hold::Slide(d), Some(forces)) = (here.holds[place], here.forces.as_ref()) else { return false };
    let rate = Vector2::new(forces.acceleration[3 * place + 1], forces.acceleration[3 * place + 2]);
    let (along, size) = (rate.dot(&d), hypot(rate.x, rate.y));
    let slip = here.support.slip(place).norm();
    along < STRAIGHT * size
        && slip > DIRECTION * here.support.velocity_size(place, speeds)
        && slip < within * size
}

/// Whether slip decreases along its direction, so that it reaches zero without turning.
pub(crate) fn straight(here: &Evaluation, place: usize) -> bool {
    let (Hold::Slide(d), Some(forces)) = (&here.holds[place], here.forces.as_ref()) else { return false };
    let rate = Vector2::new(forces.acceleration[3 * place + 1], forces.acceleration[3 * place + 2]);
    rate.dot(d) <= -STRAIGHT * rate.norm()
}

/// The least cosine of the angle between slip that decreases straight to zero, or grows straight, and its rate or the
/// opposite of it.
const STRAIGHT: f64 = 1.0 - 1e-9;

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector, Matrix3};

    use super::*;

    /// A contact of an arm whose direction of slip settles 85 times as fast as its speed decreases: long
    /// steps of tau miss the limit, and slip seemed not to end.
    #[test]
    fn slip_ends_where_its_direction_settles_fast() {
        let matrix = Matrix3::new(
            0.741_381_591_920_652_3,
            -1.000_236_584_274_807_8,
            1.062_651_207_638_403_2,
            -1.000_236_584_274_807_8,
            1.826_312_777_615_606,
            -1.865_554_810_261_542_2,
            1.062_651_207_638_403_2,
            -1.865_554_810_261_542_2,
            1.989_122_911_763_769_2,
        );
        let (mu, speed) = (0.989_894_920_948_807_7, 1e-9);
        for start in [0.35_f64, 0.365_675, 0.38] {
            let (sin, cos) = (start + std::f64::consts::PI).sin_cos();
            let support = ClosedContacts {
                contacts: vec![0],
                coupled: DMatrix::from_column_slice(3, 3, matrix.as_slice()),
                partials: DMatrix::identity(3, 3),
                response: DMatrix::from_column_slice(3, 3, matrix.as_slice()),
                velocity: DVector::from_vec(vec![0.0, speed * cos, speed * sin]),
                noise: DVector::zeros(3),
                beta: DVector::from_vec(vec![
                    -10.346_140_666_985_525,
                    0.503_588_089_344_682_7,
                    -1.466_481_949_624_804_3,
                ]),
            };
            let holds = [Hold::Slide(Vector2::new(cos, sin))];
            // The limit is 200.95 degrees, where slip decreases at 2.1 m/s^2; for other initial directions
            // the rate is a little different at first.
            match fate(&support, &holds, &[mu], 0, 1e-6) {
                Fate::Ends(time) => assert!((time * 2.13 / speed - 1.0).abs() < 0.05, "{start}: {time}"),
                Fate::PassesBy => panic!("{start}: slip does not end"),
            }
        }
    }

    /// A contact whose slip ends while it nearly jams: f / m_nn is 1.8e-6, and there are no forces 1e-5 rad
    /// away from the direction of slip. The end of its slip, 0.1 ps away, was not found, and the steps of the
    /// integration became too small.
    #[test]
    fn slip_ends_where_the_contact_nearly_jams() {
        let matrix = [
            2.059_726_188_497_477,
            -1.505_240_452_014_460_7,
            -1.017_189_099_961_77,
            -1.505_240_452_014_460_7,
            1.865_318_502_978_246,
            -0.568_880_403_432_778_9,
            -1.017_189_099_961_77,
            -0.568_880_403_432_778_9,
            3.939_633_766_850_63,
        ];
        let coupled = DMatrix::from_column_slice(3, 3, &matrix);
        let slip = Vector2::new(-8.715_869_267_983_4e-8, -3.564_504_716_391_248e-8);
        let support = ClosedContacts {
            contacts: vec![0],
            coupled: coupled.clone(),
            partials: DMatrix::identity(3, 3),
            response: coupled,
            velocity: DVector::from_vec(vec![0.0, slip.x, slip.y]),
            noise: DVector::zeros(3),
            beta: DVector::from_vec(vec![
                -10.872_127_680_008_283,
                0.219_501_540_502_147_62,
                -0.474_847_196_605_544,
            ]),
        };
        let direction = Vector2::new(-0.925_587_075_444_163_3, -0.378_534_761_641_147_85);
        match fate(&support, &[Hold::Slide(direction)], &[1.158_271_496_813_748_4], 0, 1e-6) {
            // The rate of the slip is 7.6e5 m/s^2.
            Fate::Ends(time) => assert!((time * 7.6e5 / slip.norm() - 1.0).abs() < 0.1, "{time:e}"),
            Fate::PassesBy => panic!("slip does not end"),
        }
    }
}
