//! The three laws of restitution: where each ends the collision, in units where m_nn = 1 and v_n1 = -1.
//!
//! Theory: docs/theory.md, section 9.

use nalgebra::Vector2;

use super::{contact::Contact, grazing::Grazing};
use crate::{Law, scalar::Real, scalar::constant, scalar::larger};

/// Slip over |v_n1| (times mu if that is above one) beyond which the balance of energy would lose digits of the work.
const FAST: f64 = 32.0;

/// Impulses, normal velocity and normal work at one point of a collision.
#[derive(Clone, Copy)]
pub(crate) struct State<T: Real> {
    /// Normal impulse I_n.
    pub normal: T,
    /// Tangential impulse (I_t, I_s).
    pub tangential: Vector2<T>,
    /// Normal velocity v_n.
    pub velocity: T,
    /// Normal work (35b).
    pub work: T,
}

impl<T: Real> State<T> {
    /// Before any impulse, with this v_n.
    #[inline]
    pub fn before(velocity: T) -> Self {
        Self { normal: T::zero(), tangential: Vector2::zeros(), velocity, work: T::zero() }
    }

    /// The same state in other units of normal and tangential impulse.
    #[inline]
    pub fn in_units(self, normal: T, tangential: T) -> Self {
        Self {
            normal: self.normal * normal,
            tangential: self.tangential * tangential,
            velocity: self.velocity,
            work: self.work * normal,
        }
    }
}

/// The law, and where it ends restitution. Compression ends at each upward zero of v_n.
#[derive(Clone, Copy)]
pub(crate) struct Restitution<T: Real> {
    law: Law,
    e: T,
    /// v_n at the start.
    start: T,
    /// Whether the work is always integrated directly.
    direct: bool,
    /// v_n, I_n or the normal work at which restitution ends, whichever the law speaks of.
    pub target: T,
    least_work: T,
    /// Normal work at the end of the latest compression.
    ended: T,
    /// Normal work from there to the end of restitution (Stronge): kept apart, because as a part of the whole it would lose digits.
    pub wanted: T,
    /// Normal work since then less the difference of the totals, which is what rounding took from it.
    lost: T,
    pub compressions: u32,
    /// Where the first and the latest compression ended, if that was located.
    pub first: Option<State<T>>,
    pub latest: Option<State<T>>,
    /// Locates the end of compression even where the law does not need it.
    pub thorough: bool,
    /// Ends the arc at this normal impulse, whatever the law.
    pub stop: Option<T>,
    /// The turning points of v_n.
    pub grazing: Grazing<T>,
}

impl<T: Real> Restitution<T> {
    /// For a collision with v_n1 = -1.
    #[inline]
    pub fn new(law: Law, e: T) -> Self {
        Self {
            law,
            e,
            start: -T::one(),
            direct: false,
            target: e,
            least_work: T::zero(),
            ended: T::zero(),
            wanted: T::zero(),
            lost: T::zero(),
            compressions: 0,
            first: None,
            latest: None,
            thorough: false,
            stop: None,
            grazing: Grazing::new(if law == Law::Newton { e } else { T::zero() }),
        }
    }

    /// For an impact without collision, v_n1 = 0 and f < 0: v_n starts so little below zero that no sum feels it.
    #[inline]
    pub fn without_collision(law: Law, e: T) -> Self {
        let eps = T::default_epsilon();
        // Newton's hypothesis asks for v_n2 = -e 0.
        let e = if law == Law::Newton { T::zero() } else { e };
        let start = -(eps * eps * eps * eps);
        Self { start, grazing: Grazing::falling(), ..Self::new(law, e) }
    }

    /// The state at the start.
    #[inline]
    pub fn start(&self) -> State<T> {
        State::before(self.start)
    }

    /// The same restitution where the work is integrated directly and impulses are counted in other units: what one was is `normal` (and
    /// `tangential`) now.
    #[cold]
    pub fn in_units(&self, normal: T, tangential: T, direct: bool) -> Self {
        Self {
            direct,
            target: if self.law == Law::Newton { self.target } else { self.target * normal },
            least_work: self.least_work * normal,
            ended: self.ended * normal,
            wanted: self.wanted * normal,
            lost: self.lost * normal,
            first: self.first.map(|state| state.in_units(normal, tangential)),
            latest: self.latest.map(|state| state.in_units(normal, tangential)),
            stop: self.stop.map(|stop| stop * normal),
            ..*self
        }
    }

    /// No law: the arc ends at a normal impulse.
    #[inline]
    pub fn until(normal: T) -> Self {
        Self { stop: Some(normal), ..Self::new(Law::Poisson, T::one()) }
    }

    /// Compression ends somewhere on this stretch, and the place is not needed.
    #[inline]
    pub fn compressed_somewhere(&mut self) {
        self.compressions += 1;
        self.latest = None;
    }

    /// Compression ends here: v_n = 0 and rising. True if the collision ends with it (e = 0).
    #[inline]
    pub fn compressed(&mut self, at: &State<T>) -> bool {
        let (normal, work) = (at.normal, at.work);
        self.compressions += 1;
        let here = Some(State { velocity: T::zero(), ..*at });
        if self.compressions == 1 {
            self.first = here;
        }
        self.latest = here;
        if work < self.least_work {
            self.least_work = work;
        }
        match self.law {
            Law::Newton => {}
            Law::Poisson => self.target = (T::one() + self.e) * normal,
            Law::Stronge => {
                let square = self.e * self.e;
                self.target = (T::one() - square) * self.least_work;
                self.wanted = (self.least_work - work) - square * self.least_work;
                (self.ended, self.lost) = (work, T::zero());
            }
        }
        self.e <= T::zero()
    }

    /// Records the normal work `since` the end of the latest compression at `at`, which is more exact than the difference of the totals.
    #[inline]
    pub fn since(&mut self, at: &State<T>, since: T) {
        if self.law == Law::Stronge && self.compressions > 0 {
            self.lost = since - (at.work - self.ended);
        }
    }

    /// Whether restitution needs so little work that the balance of energy would lose it.
    #[inline]
    pub fn delicate(&self) -> bool {
        self.law == Law::Stronge
            && self.compressions > 0
            && self.wanted < -constant::<T>(0.05) * self.least_work
    }

    /// The normal work that restitution still needs (Stronge).
    #[inline]
    fn missing(&self, work: T) -> T {
        larger(self.wanted - ((work - self.ended) + self.lost), T::zero())
    }

    /// v_n falls through zero here: Poisson's or Stronge's law ends the collision before this point, or only after another compression.
    #[inline]
    pub fn falls(&mut self, at: &State<T>) {
        let size = match self.law {
            Law::Newton => return,
            Law::Poisson => self.target,
            Law::Stronge => self.least_work,
        };
        self.grazing.missed((self.target - self.watched(at)).abs() / size.abs());
    }

    #[inline]
    pub fn law(&self) -> Law {
        self.law
    }

    /// Whether slip is so fast that the work must not be found from the balance of energy.
    #[inline]
    pub fn fast(&self, contact: &Contact<T>, slip: T) -> bool {
        self.direct || slip * larger(T::one(), contact.mu) > constant(FAST)
    }

    /// Whether the law ends the collision here, but for this share of what it speaks of.
    #[inline]
    pub fn is_ended(&self, end: &State<T>, share: T) -> bool {
        let scale = match self.law {
            Law::Newton => T::one(),
            Law::Poisson => end.normal,
            Law::Stronge => -self.least_work,
        };
        (self.watched(end) - self.target).abs() <= share * scale
    }

    /// The quantity that the law watches.
    #[inline]
    pub fn watched(&self, state: &State<T>) -> T {
        match self.law {
            Law::Newton => state.velocity,
            Law::Poisson => state.normal,
            Law::Stronge => state.work,
        }
    }

    /// Whether no event lies between a state and a later one, if v_n is monotone between them; counts a compression that ends there.
    #[inline]
    pub fn passes(&mut self, from: &State<T>, to: &State<T>) -> bool {
        let zero = T::zero();
        if let Some(stop) = self.stop {
            return to.normal < stop;
        }
        if from.velocity < zero {
            if to.velocity < zero {
                return true;
            }
            if self.law == Law::Newton && self.target > to.velocity && !self.thorough {
                self.compressed_somewhere();
                return true;
            }
            return false;
        }
        to.velocity >= zero && self.watched(to) < self.target
    }

    /// Follows an arc on which v_n is linear in I_n with slope `rate`, for at most `length` (without end if `None`), against friction with
    /// the impulse `push` per I_n.
    #[inline]
    pub fn follow_linear(
        &mut self,
        from: &State<T>,
        rate: T,
        push: &Vector2<T>,
        length: Option<T>,
    ) -> LinearArc<T> {
        let (mut impulse, mut velocity, mut work) = (T::zero(), from.velocity, from.work);
        let half = constant::<T>(0.5);
        let within = |d: T| length.is_none_or(|l| d <= l);
        if let Some(stop) = self.stop {
            impulse = larger(stop - from.normal, T::zero());
            if !within(impulse) {
                return LinearArc::on(length);
            }
            velocity += rate * impulse;
            work += (from.velocity + velocity) * impulse * half;
            return LinearArc::Ended { impulse, velocity, work };
        }
        if velocity < T::zero() {
            let to_rest = -velocity / rate;
            if rate <= T::zero() || !within(to_rest) {
                return LinearArc::on(length);
            }
            impulse = to_rest;
            work += velocity * to_rest * half;
            velocity = T::zero();
            let tangential = from.tangential - push * impulse;
            if self.compressed(&State { normal: from.normal + impulse, tangential, velocity, work }) {
                return LinearArc::Ended { impulse, velocity, work };
            }
        }
        let (more, end) = match self.law {
            Law::Newton => {
                if rate <= T::zero() {
                    return LinearArc::on(length);
                }
                (larger((self.target - velocity) / rate, T::zero()), self.target)
            }
            Law::Poisson => {
                let more = larger(self.target - from.normal - impulse, T::zero());
                (more, velocity + rate * more)
            }
            Law::Stronge => {
                let missing = self.missing(work);
                let square = velocity * velocity + (missing + missing) * rate;
                if square < T::zero() || (square <= T::zero() && missing > T::zero()) {
                    return LinearArc::on(length);
                }
                if missing <= T::zero() {
                    (T::zero(), velocity)
                } else {
                    let end = square.sqrt();
                    ((missing + missing) / (velocity + end), end)
                }
            }
        };
        if end < T::zero() || !within(impulse + more) {
            return LinearArc::on(length);
        }
        work += (velocity + end) * more * half;
        LinearArc::Ended { impulse: impulse + more, velocity: end, work }
    }
}

/// How a linear arc ends.
pub(crate) enum LinearArc<T> {
    /// The law ended the collision after this impulse.
    Ended {
        /// I_n since the beginning of the arc.
        impulse: T,
        /// v_n at the end.
        velocity: T,
        /// Normal work since the collision began.
        work: T,
    },
    /// The arc came to its end first, after this impulse.
    Passed(T),
    /// The arc has no end, and the law does not end it.
    Endless,
}

impl<T> LinearArc<T> {
    #[inline]
    fn on(length: Option<T>) -> Self {
        match length {
            Some(l) => Self::Passed(l),
            None => Self::Endless,
        }
    }
}
