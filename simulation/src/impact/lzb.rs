//! Solves a simultaneous impact of several contacts without friction after Liu, Zhao and Brogliato (2008).
//!
//! Each contact is a spring of given stiffness, so stiff that nothing moves during the impact: its
//! compression c_i changes by c_i' = -v_i, and its force k_i c_i changes the normal velocities by v' = W_nn
//! (k c). For the energies E_i = k_i c_i^2 / 2 and the impulses I_i this is the distributing law dI_i / dI_j
//! = (k_i / k_j)^(1/2) (E_i / E_j)^(1/2) of linear springs (eta = 1). Only the ratios of the k_i matter. An
//! expanding contact loses energy: c_i' = -v_i / e_i^2, which is the energetic coefficient of restitution
//! (Stronge) of that contact alone.
//!
//! While every contact keeps compressing, expanding or not touching, x_i = c_i (k_i / d_i)^(1/2), d_i = 1 or
//! 1 / e_i^2, obeys x'' = -S x with S symmetric: its eigenvectors give the motion in closed form, and only
//! the instants at which a contact changes are found numerically.

use nalgebra::{DMatrix, DVector};

/// The effect of the contacts on each other.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    /// normal impulses, N s
    pub impulses: DVector<f64>,
    /// normal velocities after, m/s
    pub velocities: DVector<f64>,
    /// work of each normal impulse, J
    pub works: Vec<f64>,
}

/// Why there is no outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// This contact has no normal mobility.
    Immobile(usize),
    /// The work of the computation reached its bound.
    TooLong,
}

/// Largest number of steps: for stiffnesses in a ratio of 1e6 some 1e5 are needed.
const STEPS: usize = 2_000_000;
/// Largest number of changes of contacts.
const CHANGES: usize = 20_000;
/// A step, relative to the shortest period divided by two pi.
const STEP: f64 = 0.05;
/// Normal velocities below this part of the fastest count as zero.
const NONE: f64 = 1e-13;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Open,
    Compress,
    Expand,
}

struct Impact<'a> {
    coupled: &'a DMatrix<f64>,
    stiffness: &'a [f64],
    restitution: &'a [f64],
    phases: Vec<Phase>,
    compression: DVector<f64>,
    velocity: DVector<f64>,
    none: f64,
}

/// The state at a time after a change, as far as it is needed to find the next one.
struct Moment {
    compression: DVector<f64>,
    velocity: DVector<f64>,
    impulse: DVector<f64>,
}

/// The motion between two changes, by eigenvectors.
struct Piece {
    active: Vec<usize>,
    /// k_i d_i and its root
    scale: Vec<f64>,
    vectors: DMatrix<f64>,
    rates: Vec<f64>,
    place: DVector<f64>,
    speed: DVector<f64>,
    fastest: f64,
}

/// Solves the impact: `coupled` is W_nn (1/kg), `velocity` the normal velocities before (m/s).
pub(crate) fn solve(
    coupled: &DMatrix<f64>,
    velocity: &DVector<f64>,
    stiffness: &[f64],
    restitution: &[f64],
) -> Result<Outcome, Fault> {
    let k = velocity.len();
    if let Some(contact) = (0..k).find(|&i| coupled[(i, i)] <= 0.0) {
        return Err(Fault::Immobile(contact));
    }
    let mut impact = Impact {
        coupled,
        stiffness,
        restitution,
        phases: vec![Phase::Open; k],
        compression: DVector::zeros(k),
        velocity: velocity.clone(),
        none: NONE * velocity.amax(),
    };
    let mut impulses = DVector::zeros(k);
    let mut works = vec![0.0; k];
    let mut steps = 0;
    for _ in 0..CHANGES {
        impact.close();
        if impact.phases.iter().all(|phase| *phase == Phase::Open) {
            return Ok(Outcome { impulses, velocities: impact.velocity, works });
        }
        let piece = impact.piece();
        let (moment, contact) = impact.follow(&piece, &mut steps)?;
        for &i in &piece.active {
            let (before, after) = (impact.compression[i], moment.compression[i].max(0.0));
            works[i] -= 0.5 * stiffness[i] * (after * after - before * before) / impact.loss(i);
        }
        impulses += &moment.impulse;
        impact.compression = moment.compression;
        impact.velocity = moment.velocity;
        impact.change(contact);
    }
    Err(Fault::TooLong)
}

impl Impact<'_> {
    /// d_i.
    fn loss(&self, i: usize) -> f64 {
        match self.phases[i] {
            Phase::Expand => 1.0 / (self.restitution[i] * self.restitution[i]),
            _ => 1.0,
        }
    }

    /// Approaching contacts begin to compress.
    fn close(&mut self) {
        for i in 0..self.phases.len() {
            if self.phases[i] == Phase::Open && self.velocity[i] < -self.none {
                self.phases[i] = Phase::Compress;
                self.compression[i] = 0.0;
            }
        }
    }

    /// The next phase of the contact that changes.
    fn change(&mut self, contact: usize) {
        let next = match self.phases[contact] {
            Phase::Compress if self.restitution[contact] > 0.0 => Phase::Expand,
            Phase::Compress => Phase::Open,
            Phase::Expand if self.velocity[contact] <= 0.0 => Phase::Compress,
            Phase::Expand => Phase::Open,
            Phase::Open => Phase::Compress,
        };
        if self.phases[contact] == Phase::Compress {
            self.velocity[contact] = 0.0;
        }
        if next == Phase::Open || self.phases[contact] == Phase::Open {
            self.compression[contact] = 0.0;
        }
        self.phases[contact] = next;
    }

    fn piece(&self) -> Piece {
        let active: Vec<usize> = (0..self.phases.len()).filter(|&i| self.phases[i] != Phase::Open).collect();
        let scale: Vec<f64> = active.iter().map(|&i| (self.stiffness[i] * self.loss(i)).sqrt()).collect();
        let m = active.len();
        let matrix =
            DMatrix::from_fn(m, m, |a, b| scale[a] * self.coupled[(active[a], active[b])] * scale[b]);
        let eigen = matrix.symmetric_eigen();
        let rates: Vec<f64> = eigen.eigenvalues.iter().map(|value| value.max(0.0).sqrt()).collect();
        let x = DVector::from_fn(m, |a, _| self.compression[active[a]] * scale[a] / self.loss(active[a]));
        let y = DVector::from_fn(m, |a, _| -self.velocity[active[a]] * scale[a]);
        let fastest = rates.iter().fold(0.0_f64, |a, b| a.max(*b));
        let place = eigen.eigenvectors.tr_mul(&x);
        let speed = eigen.eigenvectors.tr_mul(&y);
        Piece { active, scale, vectors: eigen.eigenvectors, rates, place, speed, fastest }
    }

    /// The state at a time after the piece began.
    fn at(&self, piece: &Piece, time: f64) -> Moment {
        let m = piece.active.len();
        let (mut x, mut y, mut sum) = (DVector::zeros(m), DVector::zeros(m), DVector::zeros(m));
        for a in 0..m {
            let rate = piece.rates[a];
            let angle = rate * time;
            let (sin, cos) = angle.sin_cos();
            // sin(angle) / rate and (1 - cos(angle)) / rate^2
            let first = if angle < 1e-4 { time * (1.0 - angle * angle / 6.0) } else { sin / rate };
            let half = (0.5 * angle).sin();
            let second = if angle < 1e-4 {
                0.5 * time * time * (1.0 - angle * angle / 12.0)
            } else {
                2.0 * half * half / (rate * rate)
            };
            let (place, speed) = (piece.place[a], piece.speed[a]);
            x[a] = place * cos + speed * first;
            y[a] = speed * cos - place * rate * sin;
            sum[a] = place * first + speed * second;
        }
        let (x, y, sum) = (&piece.vectors * x, &piece.vectors * y, &piece.vectors * sum);
        let k = self.phases.len();
        let (mut compression, mut impulse) = (DVector::zeros(k), DVector::zeros(k));
        for (a, &i) in piece.active.iter().enumerate() {
            compression[i] = x[a] * self.loss(i) / piece.scale[a];
            impulse[i] = piece.scale[a] * sum[a];
        }
        let mut velocity = &self.velocity + self.coupled * &impulse;
        for (a, &i) in piece.active.iter().enumerate() {
            velocity[i] = -y[a] / piece.scale[a];
        }
        Moment { compression, velocity, impulse }
    }

    /// The functions that are positive while the contacts keep their phases, and their rates.
    fn margins(&self, moment: &Moment) -> (Vec<f64>, Vec<f64>) {
        let force = DVector::from_fn(self.phases.len(), |i, _| self.stiffness[i] * moment.compression[i]);
        let rate = self.coupled * force;
        let pairs = self.phases.iter().enumerate().map(|(i, phase)| match phase {
            Phase::Open => (moment.velocity[i] + self.none, rate[i]),
            Phase::Compress => (-moment.velocity[i], -rate[i]),
            Phase::Expand => (moment.compression[i], -moment.velocity[i] * self.loss(i)),
        });
        pairs.unzip()
    }

    /// Whether a contact has changed by this time.
    fn changed(&self, i: usize, margin: f64, moment: &Moment) -> bool {
        margin < 0.0 || (self.phases[i] == Phase::Expand && moment.velocity[i] < -self.none)
    }

    /// Advances to the first change; returns the state there, and the contact.
    fn follow(&self, piece: &Piece, steps: &mut usize) -> Result<(Moment, usize), Fault> {
        let step = STEP / piece.fastest;
        let mut start = 0.0;
        let (mut margins, mut rates) = self.margins(&self.at(piece, 0.0));
        loop {
            *steps += 1;
            if *steps > STEPS {
                return Err(Fault::TooLong);
            }
            let mut end = start + step;
            let there = self.at(piece, end);
            let (next, next_rates) = self.margins(&there);
            let mut first: Option<usize> = None;
            for i in 0..next.len() {
                let mut until = None;
                if self.changed(i, next[i], &there) {
                    until = Some(end);
                } else if rates[i] < 0.0 && next_rates[i] > 0.0 && margins[i] > 0.0 {
                    // It may have been negative in between: check its minimum.
                    let least = bisect(start, end, |t| self.margins(&self.at(piece, t)).1[i] > 0.0);
                    let lowest = self.at(piece, least);
                    until = self.changed(i, self.margins(&lowest).0[i], &lowest).then_some(least);
                }
                let Some(until) = until else { continue };
                let time = bisect(start, until, |t| {
                    let moment = self.at(piece, t);
                    self.changed(i, self.margins(&moment).0[i], &moment)
                });
                if first.is_none() || time < end {
                    (first, end) = (Some(i), time);
                }
            }
            if let Some(contact) = first {
                return Ok((self.at(piece, end), contact));
            }
            (start, margins, rates) = (end, next, next_rates);
        }
    }
}

/// The first time at which a condition holds that does not hold at the start and holds at the end.
fn bisect(start: f64, end: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (start, end);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if holds(middle) { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use hodograph_random::Random;

    /// W_nn of balls on a line that touch.
    fn balls(masses: &[f64]) -> DMatrix<f64> {
        let k = masses.len() - 1;
        DMatrix::from_fn(k, k, |i, j| match i.abs_diff(j) {
            0 => 1.0 / masses[i] + 1.0 / masses[i + 1],
            1 => -1.0 / masses[i.max(j)],
            _ => 0.0,
        })
    }

    /// Speeds of the balls after the impact; the first ball arrives with speed 1.
    fn after(masses: &[f64], stiffness: &[f64], restitution: &[f64]) -> (Vec<f64>, Outcome) {
        let k = masses.len() - 1;
        let mut velocity = DVector::zeros(k);
        velocity[0] = -1.0;
        let outcome = solve(&balls(masses), &velocity, stiffness, restitution).unwrap();
        let mut speeds = vec![0.0; masses.len()];
        speeds[0] = 1.0;
        for (i, impulse) in outcome.impulses.iter().enumerate() {
            speeds[i] -= impulse / masses[i];
            speeds[i + 1] += impulse / masses[i + 1];
        }
        (speeds, outcome)
    }

    fn kinetic(masses: &[f64], speeds: &[f64]) -> f64 {
        masses.iter().zip(speeds).map(|(m, v)| 0.5 * m * v * v).sum()
    }

    /// The same impact with springs, by small Runge-Kutta steps.
    fn on_springs(w: &DMatrix<f64>, v: &DVector<f64>, k: &[f64], e: &[f64], dt: f64) -> DVector<f64> {
        let m = v.len();
        let rates = |c: &DVector<f64>, v: &DVector<f64>| {
            let force = DVector::from_fn(m, |i, _| k[i] * c[i].max(0.0));
            let closing = DVector::from_fn(m, |i, _| match (c[i] > 0.0, v[i] < 0.0) {
                (_, true) => -v[i],
                (true, false) => -v[i] / (e[i] * e[i]),
                _ => 0.0,
            });
            (closing, w * force)
        };
        let (mut c, mut v) = (DVector::zeros(m), v.clone());
        for _ in 0..2_000_000 {
            let (a1, b1) = rates(&c, &v);
            let (a2, b2) = rates(&(&c + 0.5 * dt * &a1), &(&v + 0.5 * dt * &b1));
            let (a3, b3) = rates(&(&c + 0.5 * dt * &a2), &(&v + 0.5 * dt * &b2));
            let (a4, b4) = rates(&(&c + dt * &a3), &(&v + dt * &b3));
            c += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
            v += dt / 6.0 * (b1 + 2.0 * b2 + 2.0 * b3 + b4);
            c.iter_mut().for_each(|c| *c = c.max(0.0));
            if c.iter().all(|c| *c == 0.0) && v.iter().all(|v| *v >= -1e-9) {
                return v;
            }
        }
        panic!("the balls do not part");
    }

    /// Three equal balls, two equal springs: c1, c2 = sin(t) / 2 +- sin(3^(1/2) t) / (2 3^(1/2)) until the
    /// first two separate; then the last two oscillate with the angular frequency 2^(1/2).
    #[test]
    fn three_equal_balls_have_the_closed_answer() {
        let (mut low, mut high) = (1.5_f64, 3.0_f64);
        let root = 3.0_f64.sqrt();
        for _ in 0..100 {
            let t = 0.5 * (low + high);
            if t.sin() + (root * t).sin() / root > 0.0 { low = t } else { high = t }
        }
        let t = low;
        // Velocities (n) of the two contacts and the compression of the second at that time.
        let first = -0.5 * (t.cos() + (root * t).cos());
        let second = -0.5 * (t.cos() - (root * t).cos());
        let squeezed = 0.5 * (t.sin() - (root * t).sin() / root);
        // Then c'' = -2 c: the speed of separation follows from the energy.
        let part = (second * second + 2.0 * squeezed * squeezed).sqrt();
        // v1' = -k c2 / m while v2' = 2 k c2 / m.
        let left = first - 0.5 * (part - second);
        let outcome = after(&[1.0; 3], &[1.0; 2], &[1.0; 2]).1;
        assert!((outcome.velocities[0] - left).abs() < 1e-11, "{} {left}", outcome.velocities);
        assert!((outcome.velocities[1] - part).abs() < 1e-11, "{} {part}", outcome.velocities);
    }

    #[test]
    fn random_chains_agree_with_springs_in_small_steps() {
        let mut generator = Random::new(7);
        let mut random = |low: f64, high: f64| generator.between(low, high);
        for round in 0..12 {
            let balls_of = 3 + round % 3;
            let masses: Vec<f64> = (0..balls_of).map(|_| random(0.5, 2.0)).collect();
            let stiffness: Vec<f64> = (1..balls_of).map(|_| random(0.3, 3.0)).collect();
            let restitution: Vec<f64> = (1..balls_of).map(|_| random(0.5, 1.0)).collect();
            let (speeds, outcome) = after(&masses, &stiffness, &restitution);
            let mut velocity = DVector::zeros(balls_of - 1);
            velocity[0] = -1.0;
            let stepped = on_springs(&balls(&masses), &velocity, &stiffness, &restitution, 2e-4);
            assert!((&outcome.velocities - &stepped).amax() < 2e-3, "{} {stepped}", outcome.velocities);
            // The works add up to the lost energy, and momentum is conserved.
            let lost = kinetic(&masses, &speeds) - 0.5 * masses[0];
            assert!((lost - outcome.works.iter().sum::<f64>()).abs() < 1e-12, "{lost} {:?}", outcome.works);
            assert!(lost <= 0.0 && outcome.works.iter().all(|work| *work <= 1e-12), "{:?}", outcome.works);
            let momentum: f64 = masses.iter().zip(&speeds).map(|(m, v)| m * v).sum();
            assert!((momentum - masses[0]).abs() < 1e-12);
        }
    }

    #[test]
    fn a_stiff_first_contact_answers_before_the_second() {
        // Successive impacts: the last ball takes all of the speed. The error decreases with the root of the
        // ratio.
        let mut before = 1.0;
        for ratio in [1e2, 1e4, 1e6] {
            let (speeds, _) = after(&[1.0; 3], &[ratio, 1.0], &[1.0; 2]);
            let error = speeds[0].abs().max(speeds[1].abs()).max((speeds[2] - 1.0).abs());
            assert!(error < 0.4 * before, "{ratio} {speeds:?}");
            before = error;
        }
        assert!(before < 5e-3, "{before}");
        // A stiff second contact: the last two move as one body, and share their speed only at the end.
        let (speeds, _) = after(&[1.0; 3], &[1.0, 1e6], &[1.0; 2]);
        assert!((speeds[0] + 1.0 / 3.0).abs() < 1e-3, "{speeds:?}");
        assert!((speeds[1] + speeds[2] - 4.0 / 3.0).abs() < 1e-3, "{speeds:?}");
    }

    #[test]
    fn plastic_contacts_lose_what_they_store() {
        let (speeds, outcome) = after(&[1.0; 3], &[1.0; 2], &[0.0; 2]);
        assert!(speeds[0] <= speeds[1] + 1e-12 && speeds[1] <= speeds[2] + 1e-12, "{speeds:?}");
        assert!(outcome.works.iter().all(|work| *work <= 0.0));
        // Two bodies alone: the law of restitution in closed form.
        for e in [0.0, 0.3, 1.0] {
            let (speeds, _) = after(&[2.0, 3.0], &[5.0], &[e]);
            assert!((speeds[1] - speeds[0] - e).abs() < 1e-12, "{e} {speeds:?}");
        }
    }

    #[test]
    fn symmetric_impacts_stay_symmetric() {
        // A ball falls between two equal ones; four supports of a plate, whose matrix has rank three.
        let coupled = DMatrix::from_row_slice(2, 2, &[2.0, 0.4, 0.4, 2.0]);
        let outcome = solve(&coupled, &DVector::from_element(2, -1.5), &[1.0; 2], &[0.6; 2]).unwrap();
        assert!((outcome.velocities[0] - 0.9).abs() < 1e-12, "{}", outcome.velocities);
        assert!((outcome.velocities[0] - outcome.velocities[1]).abs() < 1e-13);
        let arms = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
        let plate = DMatrix::from_fn(4, 4, |i, j| {
            1.0 + 2.0 * arms[i][0] * arms[j][0] + 3.0 * arms[i][1] * arms[j][1]
        });
        let outcome = solve(&plate, &DVector::from_element(4, -1.0), &[1.0; 4], &[0.5; 4]).unwrap();
        assert!(outcome.velocities.iter().all(|v| (v - 0.5).abs() < 1e-11), "{}", outcome.velocities);
        assert!(outcome.impulses.iter().all(|i| (i - 0.375).abs() < 1e-11), "{}", outcome.impulses);
    }

    #[test]
    fn what_is_impossible_is_said() {
        let none = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 0.0]);
        let answer = solve(&none, &DVector::from_element(2, -1.0), &[1.0; 2], &[1.0; 2]);
        assert_eq!(answer.unwrap_err(), Fault::Immobile(1));
        // A ratio that would need unbounded work.
        let answer = solve(&balls(&[1.0; 3]), &DVector::from_vec(vec![-1.0, 0.0]), &[1.0, 1e24], &[1.0; 2]);
        assert!(answer.is_err_and(|fault| fault == Fault::TooLong));
    }
}
