//! The paper's own method as a check: integrates (34), then (45) or (46), up to a known normal impulse.

use nalgebra::Vector3;

use super::Contact;

/// What slip turns into when it ends.
#[derive(Clone, Copy, Debug)]
pub enum Terminal {
    /// (45), with c_n, c_t, c_s of (41)
    Stick(Vector3<f64>),
    /// (46), in the direction phi_hat
    Renewal(f64),
}

/// A place on the way.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// direction of slip, rad
    pub phi: f64,
    /// speed of slip, m/s
    pub slip: f64,
    /// normal velocity, m/s
    pub normal: f64,
    /// normal impulse, N s
    pub impulse: f64,
    /// work (35a), J
    pub work: f64,
    /// work of the normal impulse (35b), J
    pub normal_work: f64,
}

/// The course of a collision.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// where compression ended
    pub compression: Option<Place>,
    /// where slip ended
    pub slip: Option<Place>,
    /// where the collision ended
    pub end: Place,
}

/// f, g and h of (31), (32), (33).
pub fn slopes(contact: &Contact, mu: f64, phi: f64) -> (f64, f64, f64) {
    let m = &contact.reduced;
    let (s, c) = phi.sin_cos();
    let f = m.nn - mu * m.nt * c - mu * m.ns * s;
    let g = m.nt * c + m.ns * s - mu * (m.tt * c * c + m.ss * s * s + 2.0 * m.ts * s * c);
    let h = -m.nt * s + m.ns * c - mu * m.ts * (c * c - s * s) + mu * (m.tt - m.ss) * s * c;
    (f, g, h)
}

/// Integrates the collision up to the normal impulse `end`.
///
/// With dI_n = s dtau the singular point s = 0 of (34) lies at infinity, where s is exponentially small;
/// there the arc that follows takes over.
pub fn course(contact: &Contact, mu: f64, end: f64) -> Course {
    let mut place = Place {
        phi: 0.0,
        slip: contact.approach.y,
        normal: contact.approach.x,
        impulse: 0.0,
        work: 0.0,
        normal_work: 0.0,
    };
    let mut course = Course { compression: None, slip: None, end: place };
    let start = place.slip;
    while place.slip > 1e-13 * start {
        let mut step = 0.01;
        let mut next = advance(contact, mu, &place, step);
        if next.impulse >= end {
            step = fraction(contact, mu, &place, step, |there| there.impulse >= end);
            course.end = advance(contact, mu, &place, step);
            return course;
        }
        if course.compression.is_none() && next.normal >= 0.0 {
            let until = fraction(contact, mu, &place, step, |there| there.normal >= 0.0);
            course.compression = Some(advance(contact, mu, &place, until));
        }
        std::mem::swap(&mut place, &mut next);
    }
    course.slip = Some(place);
    course.end = terminal(contact, mu, &mut course, &place, end);
    course
}

/// The arc after slip has ended: everything is linear in the normal impulse, work is quadratic.
fn terminal(contact: &Contact, mu: f64, course: &mut Course, from: &Place, end: f64) -> Place {
    let (phi, normal_rate, slip_rate) = match Course::terminal(contact, mu) {
        Terminal::Stick(c) => (from.phi, 1.0 / c.x, 0.0),
        Terminal::Renewal(phi) => {
            let (f, g, _) = slopes(contact, mu, phi);
            (phi, f, g)
        }
    };
    let after = |impulse: f64| {
        let by = impulse - from.impulse;
        let normal = from.normal + normal_rate * by;
        let slip = slip_rate * by;
        let normal_work = 0.5 * (from.normal + normal) * by;
        Place {
            phi,
            slip,
            normal,
            impulse,
            normal_work: from.normal_work + normal_work,
            work: from.work + normal_work - 0.5 * mu * slip * by,
        }
    };
    if course.compression.is_none() {
        course.compression = Some(after(from.impulse - from.normal / normal_rate));
    }
    after(end)
}

/// One step of the classical Runge-Kutta method in tau.
fn advance(contact: &Contact, mu: f64, from: &Place, step: f64) -> Place {
    let rate = |y: [f64; 6]| {
        let [phi, slip, normal, ..] = y;
        let (f, g, h) = slopes(contact, mu, phi);
        [h, g * slip, f * slip, slip, slip * (normal - mu * slip), slip * normal]
    };
    let y = [from.phi, from.slip, from.normal, from.impulse, from.work, from.normal_work];
    let plus = |k: [f64; 6], by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
    let k1 = rate(y);
    let k2 = rate(plus(k1, 0.5 * step));
    let k3 = rate(plus(k2, 0.5 * step));
    let k4 = rate(plus(k3, step));
    let [phi, slip, normal, impulse, work, normal_work] =
        std::array::from_fn(|i| y[i] + step / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    Place { phi, slip, normal, impulse, work, normal_work }
}

/// The part of a step after which something has happened.
fn fraction(contact: &Contact, mu: f64, from: &Place, step: f64, happened: impl Fn(&Place) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, step);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if happened(&advance(contact, mu, from, middle)) { high = middle } else { low = middle }
    }
    high
}
