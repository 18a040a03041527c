//! The derivative of the outcome of a collision with respect to its input: velocity of approach, reduced
//! matrix, mu and e.
//!
//! Theory: docs/theory.md, section 13.

use nalgebra::{Matrix3, SMatrix, Vector2, Vector3};

use crate::{
    Impact, ImpactError, Path, ReducedMatrix, Scalar, Surface,
    dual::Dual,
    scalar::constant,
    solve,
    solve::{Contact, impact_without_collision, solve_real, without_collision},
};

/// Inputs: approach velocity (3), reduced matrix (6), mu, e.
const INPUTS: usize = 11;

/// Why an outcome is not differentiable at an input. The derivative returned is then one-sided: it holds for
/// changes of the input that keep the path of the collision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum NonSmoothness {
    /// There is no slip at the start. The outcome is continuous there, but the effect of a little slip
    /// depends on its direction: the columns of v_t and v_s are set to zero and have no meaning. The
    /// other columns hold for changes without slip.
    NoSlip,
    /// mu = mu_c: after slip has stopped the contact sticks for a greater mu and slides on for a smaller one.
    /// The derivative is the one for the path that the solver took.
    CriticalFriction,
    /// Slip stops just when the collision ends: a change of the input to one side removes the terminal phase.
    /// The derivative is the one for the path that the solver took.
    PathChange,
    /// Slip keeps its direction from the start (h = 0) while v_n depends on that direction (b.d' is not
    /// zero): the derivative of v_n is the one for changes that keep the direction of slip constant.
    /// Planar systems, in which symmetry keeps it, are not affected.
    Straight,
    /// The outcome jumps at this input: v_n has a turning point just where the law ends the collision, or
    /// just where the bodies would approach a second time. The derivative is the one on this side of the
    /// jump.
    Grazing,
}

/// The outcome of a collision and its derivative.
///
/// The columns of both matrices are derivatives with respect to v_n1, v_t1, v_s1 (approach), m_nn, m_nt,
/// m_ns, m_tt, m_ts, m_ss, mu, e, in this order. An off-diagonal entry of the reduced matrix is one input,
/// which stands twice in the matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
#[non_exhaustive]
pub struct ImpactDerivative<T: nalgebra::Scalar> {
    /// The outcome itself.
    pub impact: Impact<T>,
    /// Derivative of the impulse (rows n, t, s).
    pub impulse: SMatrix<T, 3, 11>,
    /// Derivative of the velocity of separation (rows n, t, s).
    pub velocity: SMatrix<T, 3, 11>,
    /// Why the derivative is one-sided only, if it is.
    ///
    /// At mu = 0, e = 0 and e = 1, where the range of an input ends, the column of that input is one-sided
    /// by itself and nothing is reported.
    pub non_smoothness: Option<NonSmoothness>,
}

impl<T: Scalar> ImpactDerivative<T> {
    /// Derivative of the impulse with respect to the velocity of approach, kg.
    #[inline]
    pub fn impulse_by_approach(&self) -> Matrix3<T> {
        self.impulse.fixed_columns::<3>(0).into_owned()
    }

    /// Derivative of the velocity of separation with respect to the velocity of approach, without unit.
    #[inline]
    pub fn velocity_by_approach(&self) -> Matrix3<T> {
        self.velocity.fixed_columns::<3>(0).into_owned()
    }

    /// Derivative of the impulse with respect to the entries nn, nt, ns, tt, ts, ss of the reduced matrix, N
    /// s kg.
    #[inline]
    pub fn impulse_by_matrix(&self) -> SMatrix<T, 3, 6> {
        self.impulse.fixed_columns::<6>(3).into_owned()
    }

    /// Derivative of the velocity of separation with respect to the entries nn, nt, ns, tt, ts, ss of the
    /// reduced matrix, kg m/s.
    #[inline]
    pub fn velocity_by_matrix(&self) -> SMatrix<T, 3, 6> {
        self.velocity.fixed_columns::<6>(3).into_owned()
    }

    /// Derivatives of impulse (N s) and velocity of separation (m/s) with respect to mu.
    #[inline]
    pub fn by_friction(&self) -> (Vector3<T>, Vector3<T>) {
        (self.impulse.column(9).into_owned(), self.velocity.column(9).into_owned())
    }

    /// Derivatives of impulse (N s) and velocity of separation (m/s) with respect to e.
    #[inline]
    pub fn by_restitution(&self) -> (Vector3<T>, Vector3<T>) {
        (self.impulse.column(10).into_owned(), self.velocity.column(10).into_owned())
    }
}

/// Solves a collision and differentiates its outcome.
///
/// [`solve`] runs on dual numbers, so that there is no step size and no truncation error. It allocates
/// nothing and does not panic; it needs about 62 kB of stack (`f64` on x86-64), thirteen times that of
/// [`solve`].
///
/// ```
/// # use hodograph::{Law, ReducedMatrix, Surface, derivative, solve};
/// # use nalgebra::Vector3;
/// let matrix = ReducedMatrix::new(0.2251, -0.1094, 0.1258, 0.2360, 0.1158, 0.2702);
/// let approach = Vector3::new(-0.946, 1.063, 0.0);
/// let surface = |mu| Surface { mu, e: 0.8, law: Law::Stronge };
/// let d = derivative(&matrix, &approach, &surface(0.6))?;
/// let (by_mu, _) = d.by_friction();
/// let impulse = |mu| solve(&matrix, &approach, &surface(mu)).map(|impact| impact.impulse);
/// let difference = (impulse(0.6 + 1e-5)? - impulse(0.6 - 1e-5)?) / 2e-5;
/// assert!(d.non_smoothness.is_none() && (by_mu - difference).norm() < 1e-6 * by_mu.norm());
/// # Ok::<(), hodograph::ImpactError<f64>>(())
/// ```
///
/// # Errors
/// Those of [`solve`].
pub fn derivative<T: Scalar>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<ImpactDerivative<T>, ImpactError<T>> {
    differentiate(matrix, approach, surface, solve, solve_real)
}

/// Solves an impact without collision, as [`impact_without_collision`] does, and differentiates its outcome.
///
/// v_n1 is zero by definition: its column is zero and has no meaning.
///
/// ```
/// # use hodograph::{Law, ReducedMatrix, Surface, derivative_without_collision, impact_without_collision};
/// # use nalgebra::Vector2;
/// let (matrix, slip) = (ReducedMatrix::new(1.6, 1.2, 0.1, 3.4, 0.2, 0.5), Vector2::new(1.0, 0.2));
/// let surface = |mu| Surface { mu, e: 0.5, law: Law::Stronge };
/// let d = derivative_without_collision(&matrix, &slip, &surface(1.6))?;
/// let (by_mu, _) = d.by_friction();
/// let impulse = |mu| impact_without_collision(&matrix, &slip, &surface(mu)).map(|impact| impact.impulse);
/// let difference = (impulse(1.6 + 1e-5)? - impulse(1.6 - 1e-5)?) / 2e-5;
/// assert!(d.non_smoothness.is_none() && (by_mu - difference).norm() < 1e-6 * by_mu.norm());
/// # Ok::<(), hodograph::ImpactError<f64>>(())
/// ```
///
/// # Errors
/// Those of [`impact_without_collision`].
pub fn derivative_without_collision<T: Scalar>(
    matrix: &ReducedMatrix<T>,
    slip: &Vector2<T>,
    surface: &Surface<T>,
) -> Result<ImpactDerivative<T>, ImpactError<T>> {
    let approach = Vector3::new(T::zero(), slip.x, slip.y);
    differentiate(
        matrix,
        &approach,
        surface,
        |matrix, approach, surface| impact_without_collision(matrix, &approach.yz(), surface),
        |matrix, approach, surface| without_collision(matrix, &Vector2::new(approach.y, approach.z), surface),
    )
}

/// The derivative of the outcome of `solve`; `lifted` is the same function on dual numbers.
#[inline(always)]
fn differentiate<T: Scalar>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &Surface<T>,
    solve: impl Fn(&ReducedMatrix<T>, &Vector3<T>, &Surface<T>) -> Result<Impact<T>, ImpactError<T>>,
    lifted: impl FnOnce(
        &ReducedMatrix<Dual<T, INPUTS>>,
        &Vector3<Dual<T, INPUTS>>,
        &Surface<Dual<T, INPUTS>>,
    ) -> Result<Impact<Dual<T, INPUTS>>, ImpactError<Dual<T, INPUTS>>>,
) -> Result<ImpactDerivative<T>, ImpactError<T>> {
    let impact = solve(matrix, approach, surface)?;
    let input = Dual::<T, INPUTS>::input;
    let [nn, nt, ns, tt, ts, ss] = <[T; 6]>::from(*matrix);
    let hit = lifted(
        &ReducedMatrix::new(
            input(nn, 3),
            input(nt, 4),
            input(ns, 5),
            input(tt, 6),
            input(ts, 7),
            input(ss, 8),
        ),
        &Vector3::new(input(approach.x, 0), input(approach.y, 1), input(approach.z, 2)),
        &Surface { mu: input(surface.mu, 9), e: input(surface.e, 10), law: surface.law },
    );
    // Not reached: the same calculation has just succeeded in plain numbers.
    let Ok(hit) = hit else { return Err(ImpactError::NotFinite { value: surface.e }) };
    let rows = |v: &Vector3<Dual<T, INPUTS>>| {
        SMatrix::from_fn(|i, j| {
            let entry = v.as_slice().get(i).and_then(|d| d.partials.get(j));
            entry.copied().unwrap_or(T::zero())
        })
    };
    let mut result = ImpactDerivative {
        impact,
        impulse: rows(&hit.impulse),
        velocity: rows(&hit.velocity),
        non_smoothness: None,
    };
    if surface.e <= T::zero() {
        plastic(matrix, approach, surface, &mut result);
    }
    result.non_smoothness = non_smoothness(matrix, approach, surface, &result, solve);
    Ok(result)
}

/// The column of e at e = 0, where the collision ends with compression: a small e adds a short piece of the
/// last phase (theory, 13.2).
fn plastic<T: Scalar>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &Surface<T>,
    result: &mut ImpactDerivative<T>,
) {
    let impact = &result.impact;
    let slip = impact.velocity.yz();
    let speed = slip.norm();
    let push = match impact.path {
        Path::SlidingThenSticking | Path::Sticking => {
            // The impulse of sticking, which gives no tangential velocity: T x = b.
            let hold = Contact::new(matrix, surface.mu).hold();
            Vector3::new(T::one(), -hold.x, -hold.y)
        }
        _ if speed > T::zero() => {
            Vector3::new(T::one(), -surface.mu * slip.x / speed, -surface.mu * slip.y / speed)
        }
        _ => return,
    };
    let rates = matrix.apply(&push);
    let rate = rates.x;
    let more = surface.law.rebound_by_e(-approach.x, impact.impulse.x, impact.normal_work, rate);
    if more.is_finite() {
        result.impulse.set_column(10, &(push * more));
        result.velocity.set_column(10, &(rates * more));
    }
}

/// Why there is no derivative at this input, if there is none: nearby inputs have another path, another
/// number of compressions, or an outcome that jumps.
fn non_smoothness<T: Scalar>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &Surface<T>,
    result: &ImpactDerivative<T>,
    solve: impl Fn(&ReducedMatrix<T>, &Vector3<T>, &Surface<T>) -> Result<Impact<T>, ImpactError<T>>,
) -> Option<NonSmoothness> {
    let here = &result.impact;
    if matches!(here.path, Path::Sticking | Path::Renewal) {
        return Some(NonSmoothness::NoSlip);
    }
    let step = T::default_epsilon().sqrt();
    let mut found = straight(matrix, approach, surface.mu).then_some(NonSmoothness::Straight);
    for sign in [T::one(), -T::one()] {
        let factor = T::one() + sign * step;
        let slip = Vector3::new(approach.x, approach.y * factor, approach.z * factor);
        let mu = Surface { mu: surface.mu * factor, ..*surface };
        let e = Surface { e: (surface.e * factor).min(T::one()), ..*surface };
        for (velocity, surface) in [(&slip, surface), (approach, &mu), (approach, &e)] {
            let Ok(near) = solve(matrix, velocity, surface) else {
                return Some(NonSmoothness::Grazing);
            };
            // The outcome jumps, or has the infinite slope of a square root.
            let moved = (near.impulse - here.impulse).norm();
            let jumps = moved > here.impulse.norm() * step.sqrt() * constant(64.0);
            if near.compressions != here.compressions || jumps {
                return Some(NonSmoothness::Grazing);
            }
            if near.path != here.path {
                let slides = |path: Path| path == Path::Sliding;
                found = Some(if slides(near.path) || slides(here.path) {
                    NonSmoothness::PathChange
                } else {
                    NonSmoothness::CriticalFriction
                });
            }
        }
    }
    let finite = result.impulse.iter().chain(result.velocity.iter()).all(|x| x.is_finite());
    if finite { found } else { Some(NonSmoothness::Grazing) }
}

/// Whether slip starts in an invariant direction while the rate of v_n depends on the direction.
fn straight<T: Scalar>(m: &ReducedMatrix<T>, v: &Vector3<T>, mu: T) -> bool {
    let slip = v.yz();
    let d = slip / slip.norm();
    let c = Contact::new(m, mu);
    let [.., h] = c.rates(&d);
    let across = c.b.y * d.x - c.b.x * d.y;
    let noise = constant::<T>(4.0) * T::default_epsilon() * c.slip_size();
    h.abs() <= noise && across.abs() > noise && mu > T::zero()
}
