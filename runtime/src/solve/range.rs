//! Follows the sliding arc, in other units where its rates are so large or so small that their sixth powers
//! would overflow or underflow.
//!
//! With x = 1 + mu (|m_nt| + |m_ns|) for normal and y = |m_nt| + |m_ns| + mu tr T for tangential rates, the
//! following units make all rates at most one: 1/x for I_n, y/x for v_tan, mu/x for I_tan; v_n keeps its
//! unit. Then
//!
//! dv_n = (1/x - (mu b/x).d) dI_n,  dv_tan = (b/y - (mu T/y) d) dI_n,  dI_tan = -d dI_n.
//!
//! b/y and mu b/x no longer differ by the factor mu. The arc does not need that they do, but the balance of
//! energy does; the work is therefore integrated directly.
//!
//! Theory: docs/theory.md, section 1.2.

use nalgebra::Vector2;

use super::{
    contact::Contact,
    restitution::{Restitution, State},
    sliding::{arc, arc_here},
    straight::{Slide, Slides, straight, straight_apart},
};
use crate::scalar::{Real, constant};

/// The arcs of any contact.
pub(crate) struct AnyArc;

impl Slides for AnyArc {
    #[inline(always)]
    fn slide<T: Real>(
        c: &Contact<T>,
        from: Vector2<T>,
        speed: T,
        restitution: &mut Restitution<T>,
    ) -> Slide<T> {
        slide(c, from, speed, restitution)
    }
}

/// Slides from the given tangential velocity.
#[inline(always)]
pub(crate) fn slide<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    if T::INLINED {
        slide_here(c, from, speed, restitution)
    } else {
        slide_apart(c, from, speed, restitution)
    }
}

/// [`slide`] with functions of their own for the arcs in either units.
#[inline]
fn slide_apart<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    if c.is_ordinary() {
        return arc(c, from, speed, restitution);
    }
    rescaled(c, from, speed, restitution)
}

/// [`slide`] for contacts of a structure whose closed form does not apply: a function of its own.
#[inline(always)]
pub(crate) fn slide_rarely<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    if T::INLINED { slide_far(c, from, speed, restitution) } else { slide_apart(c, from, speed, restitution) }
}

#[cold]
#[inline(never)]
fn slide_far<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    slide_apart(c, from, speed, restitution)
}

/// [`slide`] as a part of the caller: one arc, in whichever units.
#[inline(always)]
fn slide_here<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    let mut units = None;
    if !c.is_ordinary() {
        units_apart(c, speed, restitution, &mut units);
        if units.is_none() {
            return still(c, from, speed, restitution);
        }
    }
    let (contact, slip, size) = match &units {
        Some(Units { contact, tangential, .. }) => (contact, from / *tangential, speed / *tangential),
        None => (c, from, speed),
    };
    let slide = arc_here(contact, slip, size, restitution);
    // Asked anew: from the answer of before the compiler would make two arcs.
    if c.is_ordinary() { slide } else { back_apart(&units, slide, restitution) }
}

/// [`slide`] in the units of the module's description.
#[cold]
#[inline(never)]
fn rescaled<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    let Some(units) = Units::of(c, speed, restitution) else {
        return straight(c, from / speed, speed, restitution.start(), restitution);
    };
    let slide = arc(&units.contact, from / units.tangential, speed / units.tangential, restitution);
    units.back(slide, restitution)
}

/// The units of the module's description.
struct Units<T: Real> {
    /// x.
    normal: T,
    /// y/x.
    tangential: T,
    /// mu/x.
    rub: T,
    /// The contact in these units.
    contact: Contact<T>,
}

impl<T: Real> Units<T> {
    /// The units for a contact, to which the law is converted; `None` where slip of this speed does not
    /// change.
    #[inline(always)]
    fn of(c: &Contact<T>, speed: T, restitution: &mut Restitution<T>) -> Option<Self> {
        let one = T::one();
        let (x, y) = (c.normal_size(), c.slip_size());
        // f is at least 1/2, so that the collision ends before I_n = 8; until then slip changes by less than
        // rounding.
        let still = x <= constant(1.5) && y * constant(8.0) <= T::default_epsilon() * speed;
        if still || y <= T::zero() {
            return None;
        }
        let [b, mu_b] = [c.b / y, c.mu_b / x];
        let [tt, ts, ss] = [c.mu_tt / y, c.mu_ts / y, c.mu_ss / y];
        let contact = Contact { nn: one / x, mu: one, b, tt, ts, ss, mu_b, mu_tt: tt, mu_ts: ts, mu_ss: ss };
        let rub = c.mu / x;
        *restitution = restitution.in_units(x, one / rub, true);
        Some(Self { normal: x, tangential: y / x, rub, contact })
    }

    /// The end of the arc, and the law, in the units of the contact.
    #[inline(always)]
    fn back(&self, slide: Slide<T>, restitution: &mut Restitution<T>) -> Slide<T> {
        let normal = T::one() / self.normal;
        let back = |state: State<T>| state.in_units(normal, self.rub);
        *restitution = restitution.in_units(normal, self.rub, false);
        match slide {
            Slide::Ended(state, velocity) => Slide::Ended(back(state), velocity * self.tangential),
            Slide::Stopped(state) => Slide::Stopped(back(state)),
            Slide::Endless(state) => Slide::Endless(back(state)),
            Slide::OverBudget(state) => Slide::OverBudget(back(state)),
        }
    }
}

/// [`Units::of`] as a function of its own.
#[cold]
#[inline(never)]
fn units_apart<T: Real>(
    c: &Contact<T>,
    speed: T,
    restitution: &mut Restitution<T>,
    to: &mut Option<Units<T>>,
) {
    *to = Units::of(c, speed, restitution);
}

/// [`Units::back`] as a function of its own.
#[cold]
#[inline(never)]
fn back_apart<T: Real>(
    units: &Option<Units<T>>,
    slide: Slide<T>,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    match units {
        Some(units) => units.back(slide, restitution),
        None => slide,
    }
}

/// [`slide`] where slip does not change, as a function of its own.
#[cold]
#[inline(never)]
fn still<T: Real>(c: &Contact<T>, from: Vector2<T>, speed: T, restitution: &mut Restitution<T>) -> Slide<T> {
    straight_apart(c, from / speed, speed, restitution.start(), restitution)
}
