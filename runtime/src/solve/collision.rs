//! Solves one collision: checks the input, follows the sliding arc and then the terminal arc in units where
//! m_nn = 1 and v_n1 = -1, verifies the outcome and converts it to the units of the input.
//!
//! Theory: docs/theory.md, sections 1 and 10.

use nalgebra::{Vector2, Vector3};

use super::{
    contact::Contact,
    input::checked,
    range::AnyArc,
    restitution::{LinearArc, Restitution, State},
    snapshots::{Units, phases},
    straight::{Slide, Slides},
    terminal::Terminal,
};
use crate::{
    ContactSurface, Impact, ImpactError, Path, ReducedMatrix, Sensitivity, Surface,
    scalar::{Arithmetic, Real, constant, larger, length},
};

/// Solves one collision: reduced matrix and velocity of approach (n, t, s) in, impulse and velocity of
/// separation out.
///
/// The reduced matrix is in 1/kg, velocities are in m/s, impulses in N s. n is the contact normal; t and s
/// are any orthonormal pair in the contact plane. No slip at the start, slip that keeps its direction,
/// singular matrices and repeated compression are all allowed.
///
/// Every outcome is checked against the laws of impact before it is returned; one that violates them because
/// of rounding becomes an error.
///
/// ```
/// # use hodograph::{Law, ReducedMatrix, Surface, solve};
/// # use nalgebra::Vector3;
/// // The two sleds of the paper.
/// let matrix = ReducedMatrix::new(0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211);
/// let approach = Vector3::new(-0.946108022, 1.06306701, 0.0);
/// let hit = solve(&matrix, &approach, &Surface { mu: 0.6, e: 0.8, law: Law::Stronge })?;
/// assert!((hit.velocity.x - 0.5115321742_f64).abs() < 1e-9);
/// assert!((hit.contact_work + 2.232487328_f64).abs() < 1e-9);
/// # Ok::<(), hodograph::ImpactError<f64>>(())
/// ```
///
/// # Errors
/// Each reason is a variant of [`ImpactError`]; [`ImpactError::BudgetExceeded`] comes of [`crate::Budgeted`]
/// surfaces alone. No number of an outcome is NaN or infinite.
#[inline]
pub fn solve<T: crate::Scalar>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    solve_real(matrix, approach, surface)
}

/// [`solve`] for every number type of the solver: the public scalars and dual numbers.
#[inline]
pub(crate) fn solve_real<T: Real>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    let (quadratures, surface) = (surface.quadratures(), surface.surface());
    let cleaned;
    let matrix = match checked(matrix, approach, surface)? {
        None => matrix,
        Some(matrix) => {
            cleaned = matrix;
            &cleaned
        }
    };
    let restitution = Restitution::new(surface.law, surface.e).within(quadratures);
    collide::<AnyArc, T>(matrix, approach, -approach.x, surface, restitution)
}

/// Solves an impact whose input has been checked. Velocities are divided by `speed`; `A` follows the sliding
/// arc.
#[inline(always)]
pub(crate) fn collide<A: Slides, T: Real>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    speed: T,
    surface: &Surface<T>,
    mut restitution: Restitution<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    let (contact, share) = Contact::limited(matrix, surface.mu);
    let tangential = Vector2::new(approach.y, approach.z) / speed;
    let mut slip = length(&tangential);
    if !slip.is_finite() {
        slip = long(&tangential);
        if !slip.is_finite() {
            return Err(ImpactError::NotFinite { value: approach.x });
        }
    }
    let slides = slips(slip);
    let mut sensitivity = Sensitivity::of_start(&contact, &tangential, slip);
    let mut slid = Slid::none(&restitution);
    if slides {
        let slide = A::slide(&contact, tangential, slip, &mut restitution);
        if let Some(reached) = slid.ends(slide, &mut restitution) {
            return Err(ImpactError::BudgetExceeded {
                quadratures: restitution.quadratures,
                normal_velocity: reached * speed,
            });
        }
    }
    let tangential = &tangential;
    let begun = Begun { matrix, approach, speed, surface, contact: &contact, share, tangential, slip };
    begun.concluded(&mut slid, slides, &mut restitution, &mut sensitivity)
}

/// A collision after its sliding arc.
pub(super) struct Slid<T: Real> {
    state: State<T>,
    /// Its end, if that came during slip.
    ended: Option<(State<T>, Vector2<T>, Path)>,
    stops: bool,
    endless: bool,
}

impl<T: Real> Slid<T> {
    /// Without slip.
    #[inline(always)]
    pub fn none(restitution: &Restitution<T>) -> Self {
        Self { state: restitution.start(), ended: None, stops: false, endless: false }
    }

    /// Takes the end of the arc. If the arc exceeds its budget, the normal velocity that was reached.
    #[inline(always)]
    pub fn ends(&mut self, slide: Slide<T>, restitution: &mut Restitution<T>) -> Option<T> {
        match slide {
            Slide::Ended(end, velocity) => self.ended = Some((end, velocity, Path::Sliding)),
            Slide::Stopped(stopped) => {
                restitution.grazing.moved(stopped.velocity);
                (self.state, self.stops) = (stopped, true);
            }
            Slide::Endless(stopped) => (self.state, self.endless) = (stopped, true),
            Slide::OverBudget(reached) => return Some(reached.velocity),
        }
        None
    }
}

/// A collision as it began, with its contact in the units of the solver.
pub(super) struct Begun<'a, T: Real> {
    pub matrix: &'a ReducedMatrix<T>,
    pub approach: &'a Vector3<T>,
    /// The unit of velocity.
    pub speed: T,
    pub surface: &'a Surface<T>,
    pub contact: &'a Contact<T>,
    /// The friction that is calculated with over the true one.
    pub share: T,
    /// Slip of approach and its length.
    pub tangential: &'a Vector2<T>,
    pub slip: T,
}

impl<T: Real> Begun<'_, T> {
    /// Follows the collision from the end of its sliding arc, if it `slips`, to its own end; verifies the outcome and
    /// converts it to the units of the input.
    #[inline(always)]
    pub fn concluded(
        &self,
        slid: &mut Slid<T>,
        slips: bool,
        restitution: &mut Restitution<T>,
        sensitivity: &mut Sensitivity,
    ) -> Result<Impact<T>, ImpactError<T>> {
        let Self { matrix, approach, speed, surface, contact, share, tangential, slip } = *self;
        let Slid { state, ended, stops, endless } = slid;
        let stops = *stops;
        if ended.is_none() && !*endless {
            *ended = after_slip(contact, state, slips, restitution, sensitivity);
        }
        let Some((mut end, velocity, path)) = *ended else {
            let normal_velocity = state.velocity * speed;
            return Err(if normal_velocity.is_finite() {
                ImpactError::Wedged { normal_velocity, law: surface.law }
            } else {
                ImpactError::NotFinite { value: normal_velocity }
            });
        };
        restitution.verify(contact, tangential, slip, &end, &velocity)?;
        if end.velocity < T::zero() {
            // What rounding has left of a restitution too small to be seen; derivatives stay.
            end.velocity -= end.velocity.primal();
        }
        let slides = path == Path::Sliding && !stops;
        sensitivity.ended(contact, restitution, &end, slides.then_some(&velocity));
        let mut slip_end = stops.then_some(*state);
        if share < T::one() && slips {
            let Restitution { first, latest, .. } = &mut *restitution;
            in_true_friction(share, [Some(&mut end), slip_end.as_mut(), first.as_mut(), latest.as_mut()]);
        }
        let scale = speed / matrix.nn;
        let impulse = Vector3::new(end.normal, end.tangential.x, end.tangential.y) * scale;
        let separation = Vector3::new(end.velocity, velocity.x, velocity.y) * speed;
        let normal_work = end.work * scale * speed;
        let contact_work = impulse.dot(&(separation + approach)) * constant(0.5);
        // The sum is finite only if all terms are; which one is not is found in `in_range`.
        let sum = impulse.x + impulse.y + impulse.z + separation.x + separation.y + separation.z;
        if !(sum + (contact_work + normal_work)).is_finite() || impulse.x < least() {
            in_range(&impulse, &separation, [contact_work, normal_work])?;
        }
        Ok(Impact {
            approach: *approach,
            impulse,
            velocity: separation,
            contact_work,
            normal_work,
            path,
            compressions: restitution.compressions,
            phases: phases(&Units { approach, scale, speed, contact }, restitution, slip_end, path),
            sensitivity: *sensitivity,
        })
    }
}

/// Converts normal impulses below eps^2 from the limited friction that was calculated with to the true
/// friction, which is `1 / share` times as large. Impulses that small change v_n by nothing; they only
/// measure how long friction acted (theory, section 1.2).
#[cold]
#[inline(never)]
fn in_true_friction<T: Real>(share: T, states: [Option<&mut State<T>>; 4]) {
    let least = T::default_epsilon() * T::default_epsilon();
    for state in states.into_iter().flatten().filter(|state| state.normal <= least) {
        *state = state.in_units(share, T::one());
    }
}

/// An error if a quantity of the outcome is not finite, or if the normal impulse is so small that it has lost
/// digits (denormal).
#[cold]
#[inline(never)]
fn in_range<T: Real>(
    impulse: &Vector3<T>,
    separation: &Vector3<T>,
    [contact_work, normal_work]: [T; 2],
) -> Result<(), ImpactError<T>> {
    let [n, t, s] = [impulse.x, impulse.y, impulse.z];
    for value in [n, t, s, separation.x, separation.y, separation.z, contact_work, normal_work] {
        if !value.is_finite() {
            return Err(ImpactError::NotFinite { value });
        }
    }
    if n < least() { Err(ImpactError::NotFinite { value: n }) } else { Ok(()) }
}

/// The smallest normal number of the number type, about.
#[inline(always)]
fn least<T: Real>() -> T {
    constant(if T::default_epsilon() > constant(1e-10) { 1.2e-38 } else { 2.3e-308 })
}

/// The length of a vector whose square may overflow or underflow.
#[cold]
#[inline(never)]
pub(super) fn long<T: Real>(v: &Vector2<T>) -> T {
    let size = larger(v.x.abs(), v.y.abs()).primal();
    if size > T::zero() { length(&(v / size)) * size } else { T::zero() }
}

/// Whether slip counts as present, in units where v_n1 = -1.
#[inline(always)]
pub(crate) fn slips<T: Arithmetic>(slip: T) -> T::Mask {
    let eps = T::default_epsilon();
    (eps * eps * eps * eps).below(slip)
}

/// Slip and normal velocity vanish at the same impulse: compression ends. True if the collision ends with it
/// (e = 0).
#[cold]
#[inline(never)]
fn stop_together<T: Real>(restitution: &mut Restitution<T>, state: &State<T>) -> bool {
    restitution.compressed(state)
}

/// Follows the arc after slip has stopped, to the end of the collision; `None` if the law never ends it.
#[inline(always)]
fn after_slip<T: Real>(
    contact: &Contact<T>,
    state: &mut State<T>,
    slips: bool,
    restitution: &mut Restitution<T>,
    sensitivity: &mut Sensitivity,
) -> Option<(State<T>, Vector2<T>, Path)> {
    if T::INLINED {
        after_slip_here(contact, state, slips, restitution, sensitivity)
    } else {
        after_slip_apart(contact, state, slips, restitution, sensitivity)
    }
}

#[inline(never)]
fn after_slip_apart<T: Real>(
    contact: &Contact<T>,
    state: &mut State<T>,
    slips: bool,
    restitution: &mut Restitution<T>,
    sensitivity: &mut Sensitivity,
) -> Option<(State<T>, Vector2<T>, Path)> {
    after_slip_here(contact, state, slips, restitution, sensitivity)
}

#[inline(always)]
fn after_slip_here<T: Real>(
    contact: &Contact<T>,
    state: &mut State<T>,
    slips: bool,
    restitution: &mut Restitution<T>,
    sensitivity: &mut Sensitivity,
) -> Option<(State<T>, Vector2<T>, Path)> {
    let Terminal { sticks, push, gain, rate, mu_c } = Terminal::of(contact);
    // Where slip and normal velocity vanish together, rounding must not decide which does so first. A wrong
    // sign of v_n does most harm where v_n hardly changes afterwards, or where compression has ended
    // before: the bound is wider there.
    let again = restitution.compressions > 0 && state.velocity < T::zero();
    let more = constant::<T>(if again || rate <= constant(0.01) { 32.0 } else { 1.0 });
    if slips && state.velocity.abs() <= more * contact.together(state.normal) {
        state.velocity = T::zero();
        if restitution.compressions == 0 && stop_together(restitution, state) {
            return Some((*state, Vector2::zeros(), Path::Sliding));
        }
    }
    sensitivity.stopped(contact.mu, mu_c);
    let path = match (slips, sticks) {
        (true, true) => Path::SlidingThenSticking,
        (true, false) => Path::SlidingThenRenewal,
        (false, true) => Path::Sticking,
        (false, false) => Path::Renewal,
    };
    match restitution.follow_linear(state, rate, &push, None) {
        LinearArc::Ended { impulse, velocity, work } => {
            let end = State {
                normal: state.normal + impulse,
                tangential: state.tangential - push * impulse,
                velocity,
                work,
            };
            // A terminal arc without impulse is not reported as a phase.
            let path = if slips && impulse <= T::zero() { Path::Sliding } else { path };
            Some((end, gain * impulse, path))
        }
        _ => None,
    }
}
