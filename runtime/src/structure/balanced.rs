//! The sliding arc of a balanced contact, m_nt = m_ns = 0, in closed form: tangential impulses do not change
//! v_n, and v_n is linear in I_n.
//!
//! Along the eigenvectors of T the components of slip are exponentials of sigma, where dI_n = s dsigma: v_1'
//! = -alpha v_1 and v_2' = -nu v_2 with alpha = mu lambda_1 >= nu = mu lambda_2. I_n, the integral of s, is
//! an incomplete beta function of the direction of slip. Two series give it, one where slip is near the
//! direction of v_1 and one elsewhere.
//!
//! Theory: docs/theory.md, section 11.3.

use nalgebra::{Vector2, Vector3};

use super::{
    Balanced, Shape,
    course::{Course, Point, decayed, elapsed, follow, stays},
};
use crate::{
    ReducedMatrix, Surface,
    scalar::{Real, constant, length},
    solve::{Contact, Restitution, Slide, State, slide_rarely, straight},
};

/// The greatest (v_2 / v_1)^2 at which the series about the direction of v_1 is used.
const NEAR: f64 = 0.5;

/// The greatest number of terms of either series; their terms fall at least like (1/2)^k and (2/3)^k.
const TERMS: u32 = 128;

#[expect(private_bounds, private_interfaces, reason = "nobody else implements this")]
impl Shape for Balanced {
    #[inline(always)]
    fn impose<T: Real>(m: &mut ReducedMatrix<T>, _: &mut Vector3<T>, _: &mut Surface<T>) {
        (m.nt, m.ns) = (T::zero(), T::zero());
    }

    #[inline(always)]
    fn slide<T: Real>(
        c: &Contact<T>,
        from: Vector2<T>,
        speed: T,
        restitution: &mut Restitution<T>,
    ) -> Slide<T> {
        if !c.is_ordinary() {
            return slide_rarely(c, from, speed, restitution);
        }
        let (axis, values) = principal(c);
        decay(c, from, speed, axis, values, restitution)
    }
}

/// Unit vector along the axis of the greater eigenvalue of T, and both eigenvalues, the greater first.
#[inline(always)]
fn principal<T: Real>(c: &Contact<T>) -> (Vector2<T>, [T; 2]) {
    let (one, zero) = (T::one(), T::zero());
    let half = constant::<T>(0.5);
    let (middle, difference) = ((c.tt + c.ss) * half, (c.tt - c.ss) * half);
    let radius = (difference * difference + c.ts * c.ts).sqrt();
    if radius <= zero {
        return (Vector2::new(one, zero), [middle; 2]);
    }
    let greater = middle + radius;
    let lesser = (c.tt * c.ss - c.ts * c.ts) / greater;
    // Two vectors lie along the axis; the longer one has lost no digits.
    let axis = if difference >= zero {
        Vector2::new(difference + radius, c.ts)
    } else {
        Vector2::new(c.ts, radius - difference)
    };
    (axis / length(&axis), [greater, if lesser > zero { lesser } else { zero }])
}

/// Follows the sliding arc of a contact whose T has these eigenvalues, the first with the eigenvector `axis`.
#[inline(always)]
pub(super) fn decay<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    axis: Vector2<T>,
    [greater, lesser]: [T; 2],
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    let (first, second) = (axis.dot(&from), axis.x * from.y - axis.y * from.x);
    let (fast, slow) = (c.mu * greater, c.mu * lesser);
    let difference = fast - slow;
    let turns = (difference * first * second).abs() > T::default_epsilon() * fast * speed * speed;
    if !turns || stays(first, second) {
        return straight(c, from / speed, speed, restitution.start(), restitution);
    }
    let begin = restitution.start();
    follow(
        Decay { mu: c.mu, axis, begin, start: [first, second], rates: [fast, slow], difference },
        restitution,
    )
}

/// The arc; xi = (1 - e^(-nu sigma)) / nu, in which I_n soon becomes linear.
struct Decay<T: Real> {
    mu: T,
    axis: Vector2<T>,
    begin: State<T>,
    /// v_1 and v_2 at the start.
    start: [T; 2],
    /// alpha and nu.
    rates: [T; 2],
    /// alpha - nu
    difference: T,
}

impl<T: Real> Decay<T> {
    #[inline(always)]
    fn plane(&self, first: T, second: T) -> Vector2<T> {
        self.axis * first + Vector2::new(-self.axis.y, self.axis.x) * second
    }

    /// The state at the normal impulse `normal`, where the integrals of v_1 and v_2 over sigma are `first`
    /// and `second` times their values at the start, and the normal work since the start.
    #[inline(always)]
    fn state(&self, normal: T, first: T, second: T) -> (State<T>, T) {
        let [v1, v2] = self.start;
        let State { normal: before, tangential, velocity, work } = self.begin;
        let since = normal * (normal * constant(0.5) + velocity);
        let state = State {
            normal: before + normal,
            tangential: tangential - self.plane(v1 * first, v2 * second) * self.mu,
            velocity: velocity + normal,
            work: work + since,
        };
        (state, since)
    }

    /// I_n from the start to `sigma`; to the end of slip if it is `None`.
    #[inline(always)]
    fn impulse(&self, sigma: Option<T>) -> T {
        let [mut first, mut second] = self.start;
        let [fast, slow] = self.rates;
        let ratio = second / first;
        let square = ratio * ratio;
        let near = constant::<T>(NEAR);
        let (mut before, mut sigma) = (T::zero(), sigma);
        if square < near {
            // sigma at which one series replaces the other; the result does not depend on it.
            let change = ((near / square).ln() / (self.difference + self.difference)).primal();
            let ends = sigma.filter(|sigma| *sigma <= change);
            before = self.near(ends.unwrap_or(change));
            if ends.is_some() {
                return before;
            }
            (first, second) = (first * (-fast * change).exp(), second * (-slow * change).exp());
            sigma = sigma.map(|sigma| sigma - change);
        }
        before + self.far(first, second, sigma)
    }

    /// I_n from the start to `sigma`, where |v_2| < |v_1|: the integral of |v_1| (1 + z)^(1/2), z = (v_2 /
    /// v_1)^2, by the binomial series.
    #[inline(always)]
    fn near(&self, sigma: T) -> T {
        let [first, second] = self.start;
        let [fast, _] = self.rates;
        let double = self.difference + self.difference;
        let ratio = second / first;
        let z = ratio * ratio;
        let grown = z * (double * sigma).exp();
        let left = (-fast * sigma).exp();
        let (mut now, mut then, mut binomial) = (T::one(), left, T::one());
        let mut sum = T::zero();
        // The number of the term, in the number type: on some processors doubles are software.
        let mut k = T::zero();
        for _ in 0..TERMS {
            let rate = fast - double * k;
            let x = rate * sigma;
            // Where z^k |v_1| hardly changes the quotient would be nearly 0 / 0.
            let lasting =
                if x.abs() <= constant(0.5) { now * decayed(rate, sigma) } else { (now - then) / rate };
            let term = binomial * lasting;
            sum += term;
            if term.abs() <= last::<T>() * sum.abs() {
                break;
            }
            let twice = k + k;
            binomial *= (T::one() - twice) / (twice + constant(2.0));
            k += T::one();
            now *= z;
            then *= grown;
        }
        first.abs() * sum
    }

    /// I_n from any point where |v_2| is not small: the integral of |v_2| plus that of s - |v_2|, which is s
    /// R(u) with a power series R in u = (v_1 / s)^2.
    #[inline(always)]
    fn far(&self, first: T, second: T, sigma: Option<T>) -> T {
        let (one, zero) = (T::one(), T::zero());
        let [fast, slow] = self.rates;
        let double = self.difference + self.difference;
        let slip = length(&Vector2::new(first, second));
        if slip <= zero {
            return zero;
        }
        let (c, s) = (first / slip, second / slip);
        let u = c * c;
        // The parts of s and of u that are left after sigma, and those that are gone, both without
        // cancellation.
        let (steady, [kept, gone], [stays, lost]) = match sigma {
            None => (one / slow, [zero, one], [zero, one]),
            Some(sigma) => {
                let (a, b) = (-(-fast * sigma).exp_m1(), -(-slow * sigma).exp_m1());
                let gone = u * a * (constant::<T>(2.0) - a) + s * s * b * (constant::<T>(2.0) - b);
                let (x, y) = (c * (one - a), s * (one - b));
                let kept = (x * x + y * y).sqrt();
                let part = -(-double * sigma).exp_m1();
                let scale = one - u * part;
                (
                    decayed(slow, sigma),
                    [kept, gone / (one + kept)],
                    [(one - part) / scale, part * s * s / scale],
                )
            }
        };
        // 1 - (1 - u)^(1/2) = (slow + difference u) R + 2 difference u (1 - u) R', all coefficients positive.
        let half = constant::<T>(0.5);
        let (mut left, mut coefficient, mut power, mut sum) = (half, zero, u, zero);
        let (mut kept, mut gone) = (kept, gone);
        let mut n = one;
        for _ in 1..TERMS {
            let twice = n + n;
            let of_last = self.difference * (twice - constant(3.0)) * coefficient;
            coefficient = (of_last + left) / (slow + double * n);
            // s u^k at the start less that after sigma.
            gone += kept * lost;
            kept *= stays;
            let term = coefficient * power * gone;
            sum += term;
            if term <= last::<T>() * sum {
                break;
            }
            left *= (twice - one) / (twice + constant(2.0));
            power *= u;
            n += one;
        }
        second.abs() * steady + slip * sum
    }
}

/// The size of a term relative to the sum at which a series ends; smaller where numbers carry derivatives.
#[inline(always)]
fn last<T: Real>() -> T {
    T::default_epsilon() * if T::refined() { constant(1.0 / 4096.0) } else { constant(0.125) }
}

impl<T: Real> Course<T> for Decay<T> {
    #[inline(always)]
    fn start(&self) -> Point<T> {
        let [first, second] = self.start;
        let slip = self.plane(first, second);
        Point { state: self.begin, slip, rate: length(&slip), slope: T::one(), since: T::zero() }
    }

    #[inline(always)]
    fn at(&self, xi: T) -> Point<T> {
        let [fast, slow] = self.rates;
        let [first, second] = self.start;
        let sigma = elapsed(slow, xi);
        let left = T::one() - slow * xi;
        let (state, since) = self.state(self.impulse(Some(sigma)), decayed(fast, sigma), xi);
        let slip = self.plane(first * (-fast * sigma).exp(), second * left);
        // dxi = e^(-nu sigma) dsigma
        Point { state, slip, rate: length(&slip) / left, slope: T::one(), since }
    }

    #[inline(always)]
    fn from(&self, point: &Point<T>) -> Self {
        let (axis, slip) = (self.axis, &point.slip);
        let start = [axis.dot(slip), axis.x * slip.y - axis.y * slip.x];
        Self { begin: point.state, start, ..*self }
    }

    #[inline(always)]
    fn stop(&self) -> Option<(T, State<T>, T)> {
        let one = T::one();
        let [fast, slow] = self.rates;
        if slow <= T::zero() {
            return None;
        }
        let (state, since) = self.state(self.impulse(None), one / fast, one / slow);
        Some((one / slow, state, since))
    }

    #[inline(always)]
    fn turn(&self) -> Option<T> {
        None
    }
}
