//! Flags for situations in which a small change of the input changes the outcome of a collision, its path or
//! its derivatives by much.
//!
//! Theory: docs/theory.md, section 14.

/// Why an outcome is sensitive to its input. None of these is an error: the outcome is right for the input
/// given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Sensitivity {
    /// Slip stopped (or there was none), and mu is within 0.1 % of mu_c: the outcome is continuous there,
    /// but its derivatives and its path are not.
    pub near_mu_c: bool,
    /// v_n turned, or was about to, within 0.1 % of the speed of approach from where compression ends,
    /// begins again, or the law ends the collision: beyond that the outcome jumps.
    pub grazing: bool,
    /// The slip of approach lies within 0.001 rad of a direction from which it turns away to either side (h
    /// = 0, h' > 0). Not set where slip cannot turn because nothing moves the contact across it: in planar
    /// systems.
    pub unstable_direction: bool,
    /// There was no slip at the start, or so little (below the root of the rounding unit, over the speed of
    /// approach) that its direction means nothing.
    pub no_slip: bool,
    /// An impact without collision began where f is zero but for rounding: dynamic jam. With a little more
    /// of f nothing happens.
    pub jam: bool,
}

impl Sensitivity {
    /// Whether there is a reason at all.
    #[inline]
    pub const fn any(self) -> bool {
        self.near_mu_c || self.grazing || self.unstable_direction || self.no_slip || self.jam
    }

    /// The names of the flags that are set.
    #[inline]
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let Self { near_mu_c, grazing, unstable_direction, no_slip, jam } = self;
        let flags = [
            (near_mu_c, "near_mu_c"),
            (grazing, "grazing"),
            (unstable_direction, "unstable_direction"),
            (no_slip, "no_slip"),
            (jam, "jam"),
        ];
        flags.into_iter().filter_map(|(set, name)| set.then_some(name))
    }
}
