//! The progress of a collision under a law of restitution: its compressions, the target that ends it
//! (`target` says what each law asks for), and straight arcs up to it in closed form. Units: m_nn = 1 and v_n1 = -1.
//!
//! Theory: docs/theory.md, section 9.

use nalgebra::Vector2;

use super::{
    contact::Contact,
    grazing::Grazing,
    target::{Compression, Watched},
};
use crate::{Law, scalar::Arithmetic, scalar::Real, scalar::constant, scalar::larger};

/// Slip over |v_n1| (times mu if mu > 1) above which the balance of energy would lose digits of the work.
const FAST: f64 = 32.0;

/// Impulses, normal velocity and normal work at one point of a collision.
#[derive(Clone, Copy)]
pub(crate) struct State<T: Arithmetic> {
    /// Normal impulse I_n.
    pub normal: T,
    /// Tangential impulse (I_t, I_s).
    pub tangential: Vector2<T>,
    /// Normal velocity v_n.
    pub velocity: T,
    /// Normal work (35b).
    pub work: T,
}

impl<T: Arithmetic> State<T> {
    /// The state before any impulse, with this v_n.
    #[inline]
    pub fn before(velocity: T) -> Self {
        Self { normal: T::zero(), tangential: Vector2::zeros(), velocity, work: T::zero() }
    }

    /// The same state after multiplying normal and tangential impulses by these factors.
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

/// A law of restitution and the progress of a collision under it: compressions so far, and the target that
/// ends restitution. Compression ends wherever v_n rises through zero.
#[derive(Clone, Copy)]
pub(crate) struct Restitution<T: Real> {
    law: Law,
    e: T,
    /// v_n at the start.
    start: T,
    /// Whether the work is always integrated directly.
    direct: bool,
    /// The value of the watched quantity at which restitution ends.
    pub target: T,
    pub(super) least_work: T,
    /// Normal work at the end of the latest compression.
    ended: T,
    /// Normal work from there to the end of restitution, where work is watched. As the difference of `target` and `ended`
    /// it would lose digits.
    pub wanted: T,
    /// The normal work since the end of the latest compression, as integrated, less its value as the
    /// difference of total works: the rounding error of the latter.
    lost: T,
    pub compressions: u32,
    /// The states where the first and the latest compression ended, if they were located.
    pub first: Option<State<T>>,
    pub latest: Option<State<T>>,
    /// Whether to locate the end of compression even where the law does not need it.
    pub thorough: bool,
    /// If set, the arc ends at this normal impulse, and the law is not used.
    pub stop: Option<T>,
    /// The greatest number of quadratures.
    pub quadratures: u32,
    /// The turning points of v_n.
    pub grazing: Grazing<T>,
}

impl<T: Real> Restitution<T> {
    /// The beginning of a collision with v_n1 = -1.
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
            // Means nothing before compression ends. A zero too many in a row, and the compiler calls a function
            // that fills memory.
            wanted: if T::INLINED { e } else { T::zero() },
            lost: T::zero(),
            compressions: 0,
            first: None,
            latest: None,
            thorough: false,
            stop: None,
            quadratures: u32::MAX,
            grazing: Grazing::new(if law.is_known_before() { e } else { T::zero() }),
        }
    }

    /// The beginning of an impact without collision, v_n1 = 0 and f < 0. v_n starts at -eps^4 instead of
    /// zero, which changes no sum, so that compression comes first.
    #[inline]
    pub fn without_collision(law: Law, e: T) -> Self {
        let eps = T::default_epsilon();
        // Newton's hypothesis gives v_n2 = -e v_n1 = 0, as for e = 0.
        let e = if law.is_known_before() { T::zero() } else { e };
        let start = -(eps * eps * eps * eps);
        Self { start, grazing: Grazing::falling(), ..Self::new(law, e) }
    }

    /// The same with a budget of quadratures.
    #[inline]
    pub fn within(self, quadratures: u32) -> Self {
        Self { quadratures, ..self }
    }

    /// The state at the start.
    #[inline]
    pub fn start(&self) -> State<T> {
        State::before(self.start)
    }

    /// The same after multiplying normal and tangential impulses by these factors. `direct` says whether the
    /// work is always integrated directly.
    #[cold]
    pub fn in_units(&self, normal: T, tangential: T, direct: bool) -> Self {
        Self {
            direct,
            target: if self.watches(Watched::Velocity) { self.target } else { self.target * normal },
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

    /// No law: the arc ends at this normal impulse.
    #[inline]
    pub fn until(normal: T) -> Self {
        Self { stop: Some(normal), ..Self::new(Law::Poisson, T::one()) }
    }

    /// Counts an end of compression whose place the law does not need.
    #[inline]
    pub fn compressed_somewhere(&mut self) {
        self.compressions += 1;
        self.latest = None;
    }

    /// Records the end of compression at this state (v_n = 0 and rising) and sets the target. True if the
    /// collision ends here (e = 0).
    #[inline(always)]
    pub fn compressed(&mut self, at: &State<T>) -> bool {
        if T::INLINED { self.compressed_here(at) } else { self.compressed_apart(at) }
    }

    #[inline(never)]
    fn compressed_apart(&mut self, at: &State<T>) -> bool {
        self.compressed_here(at)
    }

    #[inline(always)]
    fn compressed_here(&mut self, at: &State<T>) -> bool {
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
        if !self.law().is_known_before() {
            let compression = Compression { normal, work, least_work: self.least_work };
            let target = self.law().target(self.e, &compression);
            self.target = target.value;
            if let Some(wanted) = target.work {
                self.wanted = wanted;
                (self.ended, self.lost) = (work, T::zero());
            }
        }
        self.e <= T::zero()
    }

    /// Records the normal work at `at` since the latest compression ended, which is more accurate than the
    /// difference of the total works.
    #[inline]
    pub fn since(&mut self, at: &State<T>, since: T) {
        if self.watches(Watched::Work) && self.compressions > 0 {
            self.lost = since - (at.work - self.ended);
        }
    }

    /// Whether restitution needs so little work that the balance of energy would lose its digits.
    #[inline]
    pub fn delicate(&self) -> bool {
        self.watches(Watched::Work)
            && self.compressions > 0
            && self.wanted < -constant::<T>(0.05) * self.least_work
    }

    /// The normal work that restitution still needs, where work is watched.
    #[inline]
    fn missing(&self, work: T) -> T {
        larger(self.wanted - ((work - self.ended) + self.lost), T::zero())
    }

    /// Records that v_n falls through zero at this state, and how near the target of an impulse or of a work
    /// is: on one side of the target the collision has ended before, on the other another compression
    /// follows.
    #[inline]
    pub fn falls(&mut self, at: &State<T>) {
        let size = match self.law().watched() {
            Watched::Velocity => return,
            Watched::Impulse => self.target,
            Watched::Work => self.least_work,
        };
        self.grazing.missed((self.target - self.watched(at)).abs() / size.abs());
    }

    #[inline(always)]
    pub fn law(&self) -> Law {
        match T::LAW {
            Some(law) => law,
            None => self.law,
        }
    }

    /// Whether the law watches this quantity.
    #[inline(always)]
    pub fn watches(&self, quantity: Watched) -> bool {
        self.law().watched() == quantity
    }

    /// Whether the target is known although compression has not ended, and is not where compression ends.
    #[inline(always)]
    pub fn skips_compression(&self) -> bool {
        self.law().is_known_before() && self.target > T::zero()
    }

    /// The normal impulse at which the arc ends without a law, if there is one: never in a routine that is
    /// specialised to collisions.
    #[inline(always)]
    pub fn stop(&self) -> Option<T> {
        if T::INLINED { None } else { self.stop }
    }

    /// Whether to locate the end of compression even where the law does not need it, likewise.
    #[inline(always)]
    pub fn thorough(&self) -> bool {
        !T::INLINED && self.thorough
    }

    /// Whether the work must be integrated directly because slip is so fast that the balance of energy would
    /// lose its digits.
    #[inline]
    pub fn fast(&self, contact: &Contact<T>, slip: T) -> bool {
        self.direct || slip * larger(T::one(), contact.mu) > constant(FAST)
    }

    /// Whether the law ends the collision at this state, up to an error of `share` relative to the scale of
    /// its quantity.
    #[inline]
    pub fn is_ended(&self, end: &State<T>, share: T) -> bool {
        let (residual, scale) = self.missed(end);
        residual <= share * scale
    }

    /// How far the law's quantity is from its target at this state, and the scale of this quantity.
    #[inline]
    pub fn missed(&self, end: &State<T>) -> (T, T) {
        let scale = match self.law().watched() {
            Watched::Velocity => T::one(),
            Watched::Impulse => end.normal,
            Watched::Work => -self.least_work,
        };
        ((self.watched(end) - self.target).abs(), scale)
    }

    /// The quantity whose target ends the collision.
    #[inline]
    pub fn watched(&self, state: &State<T>) -> T {
        match self.law().watched() {
            Watched::Velocity => state.velocity,
            Watched::Impulse => state.normal,
            Watched::Work => state.work,
        }
    }

    /// Whether no event that must be located lies between a state and a later one, if v_n is monotone between
    /// them. Counts an end of compression whose place is not needed. A v_n within `noise` of zero at the
    /// end counts as zero: compression ends, or v_n falls to zero, at the end of the stretch.
    #[inline]
    pub fn passes(&mut self, from: &State<T>, to: &State<T>, noise: T) -> bool {
        let zero = T::zero();
        if let Some(stop) = self.stop() {
            return to.normal < stop;
        }
        if from.velocity < zero {
            if to.velocity < noise {
                return true;
            }
            if self.law().is_known_before() && self.target > to.velocity && !self.thorough() {
                self.compressed_somewhere();
                return true;
            }
            return false;
        }
        to.velocity >= -noise && self.watched(to) < self.target
    }

    /// Follows an arc on which v_n is linear in I_n with slope `rate`, over an impulse of at most `length`
    /// (no limit if `None`). The tangential impulse is -`push` per I_n.
    #[inline(always)]
    pub fn follow_linear(
        &mut self,
        from: &State<T>,
        rate: T,
        push: &Vector2<T>,
        length: Option<T>,
    ) -> LinearArc<T> {
        if T::INLINED {
            self.follow_linear_here(from, rate, push, length)
        } else {
            self.follow_linear_apart(from, rate, push, length)
        }
    }

    /// [`Self::follow_linear`] as a function of its own.
    #[inline(never)]
    pub fn follow_linear_apart(
        &mut self,
        from: &State<T>,
        rate: T,
        push: &Vector2<T>,
        length: Option<T>,
    ) -> LinearArc<T> {
        self.follow_linear_here(from, rate, push, length)
    }

    #[inline(always)]
    fn follow_linear_here(
        &mut self,
        from: &State<T>,
        rate: T,
        push: &Vector2<T>,
        length: Option<T>,
    ) -> LinearArc<T> {
        let (mut impulse, mut velocity, mut work) = (T::zero(), from.velocity, from.work);
        let half = constant::<T>(0.5);
        let within = |d: T| length.is_none_or(|l| d <= l);
        if let Some(stop) = self.stop() {
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
            let at = State { normal: from.normal + impulse, tangential, velocity, work };
            if self.compressed(&at) {
                return LinearArc::Ended { impulse, velocity, work };
            }
        }
        let (more, end) = match self.law().watched() {
            Watched::Velocity => {
                if rate <= T::zero() {
                    return LinearArc::on(length);
                }
                (larger((self.target - velocity) / rate, T::zero()), self.target)
            }
            Watched::Impulse => {
                let more = larger(self.target - from.normal - impulse, T::zero());
                (more, velocity + rate * more)
            }
            Watched::Work => {
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
    /// The law had not ended the collision after this impulse, the length of the arc.
    Passed(T),
    /// The arc has no limit, and the law never ends the collision on it.
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
