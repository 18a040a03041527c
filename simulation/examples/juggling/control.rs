//! The controller of the juggler, for a desktop and for firmware: no standard library, no allocation, the
//! same work at every sample.
//!
//! While the ball falls the controller asks the generated collision what a strike would do. A strike is a
//! vertical speed of the paddle and its two tilts; its outcome is the velocity of the ball after it. One step
//! of Newton's method per sample, with four collisions, moves the strike towards the one that sends the ball
//! to the height that is asked for and back to the middle. The paddle is moved so that it makes this strike
//! when the ball arrives.

use hodograph::nalgebra::{Matrix3, Vector3, convert};
use hodograph::{Scalar, Surface};

use super::juggler::{Coordinates, Inputs, Juggler, Speeds};

/// How the paddle meets the ball.
#[derive(Clone, Copy, Debug)]
pub struct Strike<T> {
    /// vertical speed of the paddle, m/s
    pub rise: T,
    /// tilt about N.x, rad
    pub a: T,
    /// tilt about P.y, rad
    pub b: T,
}

/// What the controller knows and remembers.
#[derive(Clone, Debug)]
pub struct Control<T: Scalar> {
    model: Juggler<T>,
    /// What the controller takes for the surface. It learns e from the bounces that it sees.
    pub surface: Surface<T>,
    /// The strike that is planned.
    pub strike: Strike<T>,
    /// accelerations of the paddle at the sample before: slide and tilts
    pushed: [T; 3],
    /// normal velocity of the ball against the paddle at the sample before, m/s
    approach: T,
}

/// The ball when it meets the paddle.
struct Meeting<T> {
    /// from now, s
    after: T,
    coordinates: Coordinates<T>,
    speeds: Speeds<T>,
}

impl<T: Scalar> Control<T> {
    /// A controller that takes the juggler and its surface for these.
    pub fn new(model: Juggler<T>, surface: Surface<T>) -> Self {
        let zero = T::zero();
        Control {
            model,
            surface,
            strike: Strike { rise: convert(0.3), a: zero, b: zero },
            pushed: [zero; 3],
            approach: zero,
        }
    }

    /// Force and torques for the next period, from the state now and the height (of the centre of the ball,
    /// m) that is asked for.
    pub fn act(&mut self, q: &Coordinates<T>, u: &Speeds<T>, height: T) -> Inputs<T> {
        self.learn(q, u);
        match self.meeting(q, u) {
            Some(meeting) => {
                self.improve(&meeting, height);
                self.push(q, u, meeting.after);
            }
            None => self.pushed = [T::zero(); 3],
        }
        let [h, a, b] = self.pushed;
        let zero = T::zero();
        let acceleration =
            Speeds { uh: h, ua: a, ub: b, ux: zero, uy: zero, uz: zero, w1: zero, w2: zero, w3: zero };
        let none = Inputs { lift: zero, ta: zero, tb: zero };
        let needed = self.model.inverse_dynamics(q, u, &acceleration, &none);
        let limited = |value: T, most: f64| value.clamp(convert(-most), convert(most));
        needed.map_or(none, |needed| Inputs {
            lift: limited(needed[0], 200.0),
            ta: limited(needed[1], 10.0),
            tb: limited(needed[2], 10.0),
        })
    }

    /// Takes the ratio of the normal velocities at a bounce into account, where there was one since the last
    /// sample.
    fn learn(&mut self, q: &Coordinates<T>, u: &Speeds<T>) {
        let Ok(velocity) = self.model.contact_velocity_bounce(q, u) else { return };
        let (before, after) = (self.approach, velocity[0]);
        self.approach = after;
        if before < convert(-0.5) && after > convert(0.1) {
            let seen = (after / -before).clamp(T::zero(), T::one());
            self.surface.e += (seen - self.surface.e) * convert(0.5);
        }
    }

    /// Where and how fast the ball is when it meets the paddle, which is then at height zero and tilted as
    /// planned. `None`: it does not.
    fn meeting(&self, q: &Coordinates<T>, u: &Speeds<T>) -> Option<Meeting<T>> {
        let parameters = self.model.parameters();
        let (g, r) = (parameters.g, parameters.r);
        let Strike { rise, a, b } = self.strike;
        let normal = [b.sin(), -a.sin() * b.cos(), a.cos() * b.cos()];
        let (mut x, mut y, mut z, mut after) = (q.x, q.y, r, T::zero());
        // The tilted paddle is not everywhere at height zero: two rounds settle where it is met.
        for _ in 0..2 {
            z = (r - x * normal[0] - y * normal[1]) / normal[2];
            let square = u.uz * u.uz + (q.z - z) * g * convert(2.0);
            if square < T::zero() {
                return None;
            }
            after = (u.uz + square.sqrt()) / g;
            x = q.x + u.ux * after;
            y = q.y + u.uy * after;
        }
        let zero = T::zero();
        let coordinates = Coordinates { h: zero, a, b, x, y, z, ..*q };
        let speeds = Speeds { uh: rise, ua: zero, ub: zero, uz: u.uz - g * after, ..*u };
        (after > zero).then_some(Meeting { after, coordinates, speeds })
    }

    /// The velocity of the ball after a strike.
    fn outcome(&self, meeting: &Meeting<T>, strike: &Strike<T>) -> Option<Vector3<T>> {
        let q = Coordinates { a: strike.a, b: strike.b, ..meeting.coordinates };
        let u = Speeds { uh: strike.rise, ..meeting.speeds };
        let speeds = self.model.collide_bounce(&q, &u, &self.surface).ok()?.speeds;
        Some(Vector3::new(speeds.ux, speeds.uy, speeds.uz))
    }

    /// One step of Newton's method towards the strike that sends the ball where it shall go.
    fn improve(&mut self, meeting: &Meeting<T>, height: T) {
        let g = self.model.parameters().g;
        let Coordinates { x, y, z, .. } = meeting.coordinates;
        let rise = (((height - z) * g * convert(2.0)).max(T::zero())).sqrt();
        let flight = rise * convert(2.0) / g;
        let wanted = Vector3::new(-x / flight, -y / flight, rise);
        let Strike { rise, a, b } = self.strike;
        let (speed, angle): (T, T) = (convert(0.0078125), convert(0.001953125));
        let Some(now) = self.outcome(meeting, &self.strike) else { return };
        let Some(by_rise) = self.outcome(meeting, &Strike { rise: rise + speed, a, b }) else { return };
        let Some(by_a) = self.outcome(meeting, &Strike { rise, a: a + angle, b }) else { return };
        let Some(by_b) = self.outcome(meeting, &Strike { rise, a, b: b + angle }) else { return };
        let slopes =
            Matrix3::from_columns(&[(by_rise - now) / speed, (by_a - now) / angle, (by_b - now) / angle]);
        let Some(inverse) = slopes.try_inverse() else { return };
        let step = inverse * (wanted - now);
        let limited = |value: T, low: f64, high: f64| value.clamp(convert(low), convert(high));
        if step.iter().all(|part| part.is_finite()) {
            self.strike = Strike {
                rise: limited(rise + step[0], -0.5, 2.5),
                a: limited(a + step[1], -0.25, 0.25),
                b: limited(b + step[2], -0.25, 0.25),
            };
        }
    }

    /// The accelerations now of the smoothest motion to the strike: cubics of time that end with the place
    /// and the speed planned. Shortly before the strike they stay as they are.
    fn push(&mut self, q: &Coordinates<T>, u: &Speeds<T>, after: T) {
        if after < convert(0.008) {
            return;
        }
        let (two, four, six): (T, T, T) = (convert(2.0), convert(4.0), convert(6.0));
        let cubic = |place: T, speed: T, target: T, arrival: T| {
            ((target - place) * six / after - speed * four - arrival * two) / after
        };
        let zero = T::zero();
        let Strike { rise, a, b } = self.strike;
        self.pushed = [cubic(q.h, u.uh, zero, rise), cubic(q.a, u.ua, a, zero), cubic(q.b, u.ub, b, zero)];
    }
}
