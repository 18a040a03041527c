//! The hodograph: velocities, impulses and works of a collision as functions of the normal impulse.

use nalgebra::{Vector2, Vector3};

use crate::{
    Impact, ImpactError, Law, Motion, ReducedMatrix, Scalar, Snapshot, Surface,
    scalar::constant,
    solve::{AnyArc, Contact, Restitution, Slide, State, Terminal, Units, checked, collide, slide, slips},
};

/// A solved collision that can be evaluated at any normal impulse: the curve of v_s over v_t that the paper
/// calls hodograph, with the normal velocity, the impulses and the works along it. Every point is computed to
/// machine precision, not interpolated.
///
/// ```
/// # use hodograph::{Hodograph, Law, ReducedMatrix, Surface};
/// # use nalgebra::Vector3;
/// let matrix = ReducedMatrix::new(0.2251, -0.1094, 0.1258, 0.2360, 0.1158, 0.2702);
/// let surface = Surface { mu: 0.6, e: 0.8, law: Law::Stronge };
/// let hodograph = Hodograph::new(&matrix, &Vector3::new(-0.946, 1.063, 0.0), &surface)?;
/// for snapshot in hodograph.points(100) {
///     let (v_t, v_s) = (snapshot.velocity.y, snapshot.velocity.z);
///     # let _ = (v_t, v_s);
/// }
/// # Ok::<(), hodograph::ImpactError<f64>>(())
/// ```
///
/// Cost: [`Hodograph::new`] is one [`crate::solve`] that always locates the end of compression. A point of
/// the sliding arc is computed from the start of the collision and costs no more than a solve. A point after
/// slip has stopped costs some twenty operations. Nothing is allocated.
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct Hodograph<T: nalgebra::Scalar> {
    approach: Vector3<T>,
    matrix: ReducedMatrix<T>,
    mu: T,
    impact: Impact<T>,
    terminal: Option<(Vector2<T>, Vector2<T>, T)>,
}

impl<T: Scalar> Hodograph<T> {
    /// Solves the collision; the arguments are those of [`crate::solve`].
    ///
    /// # Errors
    /// Those of [`crate::solve`].
    #[inline]
    pub fn new(
        matrix: &ReducedMatrix<T>,
        approach: &Vector3<T>,
        surface: &Surface<T>,
    ) -> Result<Self, ImpactError<T>> {
        let matrix = &checked(matrix, approach, surface)?.unwrap_or(*matrix);
        let mut restitution = Restitution::new(surface.law, surface.e);
        restitution.thorough = true;
        let impact = collide::<AnyArc, T>(matrix, approach, -approach.x, surface, restitution)?;
        let terminal = (impact.path.last() != Motion::Sliding).then(|| {
            let Terminal { push, gain, rate, .. } = Terminal::of(&Contact::new(matrix, surface.mu));
            (push, gain, rate)
        });
        Ok(Self { approach: *approach, matrix: *matrix, mu: surface.mu, impact, terminal })
    }

    /// The outcome, as of [`crate::solve`]; the end of compression is known under every law.
    #[inline]
    pub fn impact(&self) -> &Impact<T> {
        &self.impact
    }

    /// The normal impulse of the whole collision I_n2, in N s.
    #[inline]
    pub fn normal_impulse(&self) -> T {
        self.impact.impulse.x
    }

    /// All quantities at the normal impulse `normal_impulse`, in N s: at 0 and below the approach, at I_n2
    /// and above the outcome. [`snapshot_at`] goes on beyond the end of the collision.
    #[inline]
    pub fn at(&self, normal_impulse: T) -> Snapshot<T> {
        let zero = T::zero();
        let after = self.impact.path.last();
        if normal_impulse >= self.impact.impulse.x {
            return self.end(after);
        }
        let (contact, share) = Contact::limited(&self.matrix, self.mu);
        let speed = -self.approach.x;
        let scale = speed / self.matrix.nn;
        let units = Units { approach: &self.approach, scale, speed, contact: &contact };
        let tangential = Vector2::new(self.approach.y, self.approach.z) / speed;
        let slip = tangential.norm();
        let slides = slips(slip);
        let first = if slides { Motion::Sliding } else { after };
        // False at the beginning, and for NaN.
        let begun = normal_impulse > zero;
        if !begun {
            return units.snapshot(&State::before(-T::one()), &tangential, first);
        }
        let stop = normal_impulse / scale;
        let slip_end = self.impact.phases.slip_end.map(|snapshot| self.state(&snapshot, scale, speed));
        let from = match slip_end {
            None if !slides => State::before(-T::one()),
            Some(end) if stop >= end.normal => end,
            _ => match slide(&contact, tangential, slip, &mut Restitution::until(stop / share)) {
                Slide::Ended(state, velocity) => {
                    return units.snapshot(&state.in_units(share, T::one()), &velocity, first);
                }
                // The impulse asked for is the end of slip up to rounding.
                Slide::Stopped(state) | Slide::Endless(state) | Slide::OverBudget(state) => {
                    return units.snapshot(&state.in_units(share, T::one()), &Vector2::zeros(), first);
                }
            },
        };
        let Some((push, gain, rate)) = self.terminal else { return self.end(after) };
        let (state, slip) = from.after(&push, &gain, rate, stop);
        units.snapshot(&state, &slip, after)
    }

    /// `count` snapshots at equal steps of the normal impulse, from the approach to the outcome; if `count`
    /// is one, the outcome.
    #[inline]
    pub fn points(
        &self,
        count: usize,
    ) -> impl ExactSizeIterator<Item = Snapshot<T>> + DoubleEndedIterator + Clone + '_ {
        let last = count.saturating_sub(1);
        (0..count).map(move |index| {
            let impulse = self.impact.impulse.x;
            if index == last {
                return self.at(impulse);
            }
            self.at(impulse * (constant::<T>(index as f64) / constant::<T>(last as f64)))
        })
    }

    fn end(&self, motion: Motion) -> Snapshot<T> {
        let Impact { impulse, velocity, contact_work, normal_work, .. } = self.impact;
        Snapshot { impulse, velocity, contact_work, normal_work, motion }
    }

    fn state(&self, snapshot: &Snapshot<T>, scale: T, speed: T) -> State<T> {
        let impulse = snapshot.impulse / scale;
        State {
            normal: impulse.x,
            tangential: Vector2::new(impulse.y, impulse.z),
            velocity: snapshot.velocity.x / speed,
            work: snapshot.normal_work / (scale * speed),
        }
    }
}

/// All quantities at a normal impulse, in N s, that is known (sections 3.1 to 3.3 of the paper: "suppose that
/// I_n2 is known"): without any law of restitution, and so also beyond the end that a law would set, as if
/// the bodies stayed in contact. At 0 and below it is the approach.
///
/// ```
/// # use hodograph::{ReducedMatrix, snapshot_at};
/// # use nalgebra::Vector3;
/// let matrix = ReducedMatrix::new(0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211);
/// let approach = Vector3::new(-0.946108022, 1.06306701, 0.0);
/// // At mu = 1.6 slip stops at 2.328 N s, and the contact sticks: v_n rises by 1 / c_n (45c).
/// let [a, b] = [3.0_f64, 30.0].map(|impulse| snapshot_at(&matrix, &approach, 1.6, impulse));
/// assert!(((b?.velocity.x - a?.velocity.x) * 42.592 - 27.0).abs() < 1e-3);
/// # Ok::<(), hodograph::ImpactError<f64>>(())
/// ```
///
/// # Errors
/// As [`crate::solve`] for what is wrong with the input, [`ImpactError::NotFinite`] for an impulse that is
/// not finite or a velocity beyond the range of the number type, and [`ImpactError::BudgetExceeded`] where
/// the sliding arc takes more stretches than the solver makes.
pub fn snapshot_at<T: Scalar>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    mu: T,
    normal_impulse: T,
) -> Result<Snapshot<T>, ImpactError<T>> {
    let zero = T::zero();
    // No law ends the arc: which one is named does not matter.
    let surface = Surface { mu, e: zero, law: Law::Poisson };
    let matrix = &checked(matrix, approach, &surface)?.unwrap_or(*matrix);
    if !normal_impulse.is_finite() {
        return Err(ImpactError::NotFinite { value: normal_impulse });
    }
    let (contact, share) = Contact::limited(matrix, mu);
    let speed = -approach.x;
    let scale = speed / matrix.nn;
    let units = Units { approach, scale, speed, contact: &contact };
    let tangential = Vector2::new(approach.y, approach.z) / speed;
    let (slip, stop) = (tangential.norm(), normal_impulse / scale);
    let slides = slips(slip);
    let Terminal { sticks, push, gain, rate, .. } = Terminal::of(&contact);
    let after = if sticks { Motion::Sticking } else { Motion::Renewal };
    let first = if slides { Motion::Sliding } else { after };
    let snapshot = if normal_impulse <= zero {
        units.snapshot(&State::before(-T::one()), &tangential, first)
    } else {
        let arc = slides.then(|| {
            let mut restitution = Restitution::until(stop / share);
            (slide(&contact, tangential, slip, &mut restitution), restitution.quadratures)
        });
        match arc {
            Some((Slide::Ended(state, velocity), _)) => {
                units.snapshot(&state.in_units(share, T::one()), &velocity, first)
            }
            Some((Slide::Endless(state) | Slide::OverBudget(state), quadratures)) => {
                let normal_velocity = state.velocity * speed;
                return Err(ImpactError::BudgetExceeded { quadratures, normal_velocity });
            }
            Some((Slide::Stopped(state), _)) => {
                let from = state.in_units(share, T::one());
                let (state, slip) = from.after(&push, &gain, rate, stop);
                units.snapshot(&state, &slip, after)
            }
            None => {
                let (state, slip) = State::before(-T::one()).after(&push, &gain, rate, stop);
                units.snapshot(&state, &slip, after)
            }
        }
    };
    let Snapshot { impulse, velocity, contact_work, normal_work, .. } = snapshot;
    let numbers = impulse.iter().chain(velocity.iter()).copied().chain([contact_work, normal_work]);
    match numbers.into_iter().find(|value| !value.is_finite()) {
        Some(value) => Err(ImpactError::NotFinite { value }),
        None => Ok(snapshot),
    }
}

impl<T: Scalar> State<T> {
    /// The state on a terminal arc (45), (46) that begins here, at a later normal impulse, and the tangential
    /// velocity there.
    fn after(&self, push: &Vector2<T>, gain: &Vector2<T>, rate: T, normal: T) -> (Self, Vector2<T>) {
        let impulse = normal - self.normal;
        let velocity = self.velocity + rate * impulse;
        let state = Self {
            normal,
            tangential: self.tangential - push * impulse,
            velocity,
            work: self.work + (self.velocity + velocity) * impulse * constant(0.5),
        };
        (state, gain * impulse)
    }
}
