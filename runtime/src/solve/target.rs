//! What each law of restitution says: the quantity whose target ends the collision, and the target itself,
//! which is formed where compression ends. The rest of the solver asks here and knows no law by name. Units:
//! m_nn = 1 and v_n1 = -1.
//!
//! Theory: docs/theory.md, section 9.

use crate::{Law, scalar::Real};

/// The quantities that a law may watch during restitution. Each rises towards its target.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Watched {
    /// The normal velocity v_n.
    Velocity,
    /// The normal impulse I_n.
    Impulse,
    /// The normal work since compression ended.
    Work,
}

/// What a target may depend on: the collision where its latest compression ended.
pub(crate) struct Compression<T> {
    /// Normal impulse I_n.
    pub normal: T,
    /// Normal work since the beginning, negative.
    pub work: T,
    /// The least normal work at the end of any compression so far: `work`, if there was only one.
    pub least_work: T,
}

/// Where restitution ends.
pub(crate) struct Target<T> {
    /// The value of v_n, I_n or the normal work since the beginning.
    pub value: T,
    /// Where work is watched, the work from the end of the latest compression to the target, without the
    /// cancellation of a difference of totals; else nothing.
    pub work: Option<T>,
}

impl Law {
    /// The quantity that the law watches.
    #[inline(always)]
    pub(crate) const fn watched(self) -> Watched {
        match self {
            Self::Newton => Watched::Velocity,
            Self::Poisson => Watched::Impulse,
            Self::Stronge => Watched::Work,
        }
    }

    /// Whether the target is e |v_n1| from the beginning, so that nobody needs to know where compression ends.
    #[inline(always)]
    pub(crate) const fn is_known_before(self) -> bool {
        matches!(self, Self::Newton)
    }

    /// The target after this compression: (48), (51) or (54).
    #[inline(always)]
    pub(crate) fn target<T: Real>(self, e: T, compression: &Compression<T>) -> Target<T> {
        let one = T::one();
        match self {
            Self::Newton => Target { value: e, work: None },
            Self::Poisson => Target { value: (one + e) * compression.normal, work: None },
            Self::Stronge => {
                let (square, least) = (e * e, compression.least_work);
                let work = (least - compression.work) - square * least;
                Target { value: (one - square) * least, work: Some(work) }
            }
        }
    }

    /// The derivative by e at e = 0 of the normal impulse after compression, where v_n rises from zero at the
    /// rate `rate` per I_n (theory, 13.2). `approach` is |v_n1|, `normal` and `work` are those of compression.
    #[inline]
    pub(crate) fn rebound_by_e<T: Real>(self, approach: T, normal: T, work: T, rate: T) -> T {
        match self {
            Self::Newton => approach / rate,
            Self::Poisson => normal,
            Self::Stronge => (-(work + work) / rate).sqrt(),
        }
    }
}
