//! The end of slip. In three dimensions no smooth function changes its sign there (docs/theory.md, section 17.5).
//!
//! Close to the end only the slip changes: with dt = s dtau, phi' = h(phi) and (ln s)' = g(phi), where g and h are the tangential accelerations along and across
//! the slip. If phi tends to a direction with g < 0, slip ends, after a time that these equations give; if g becomes positive, slip grows again and passes zero
//! by.

use nalgebra::Vector2;

use crate::closed_contacts::ClosedContacts;
use crate::forces::{Hold, forces};
use crate::motion::Evaluation;

/// What becomes of slip.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Fate {
    /// It ends after this time, s.
    Ends(f64),
    /// It does not end.
    PassesBy,
}

/// Slip that ends within this time is followed to its end by itself, s.
pub(crate) const ENDING: f64 = 1e-9;
const STEPS: usize = 4000;

/// Follows slip of the contact with this place to its end, all else unchanged.
pub(crate) fn fate(support: &ClosedContacts, holds: &[Hold], mu: &[f64], place: usize) -> Fate {
    let slip = support.slip(place);
    let start = slip.norm();
    let mut holds = holds.to_vec();
    // g and h in a direction.
    let mut rates = |phi: f64| -> Option<(f64, f64)> {
        let d = Vector2::new(phi.cos(), phi.sin());
        holds[place] = Hold::Slide(d);
        let a = forces(support, &holds, mu, None).ok()?.acceleration;
        let a = Vector2::new(a[3 * place + 1], a[3 * place + 2]);
        Some((a.dot(&d), d.x * a.y - d.y * a.x))
    };
    let (mut size, mut phi, mut time) = (0.0_f64, slip.y.atan2(slip.x), 0.0);
    for _ in 0..STEPS {
        let Some((g, h)) = rates(phi) else { return Fate::PassesBy };
        if size < -16.0 {
            return if g < 0.0 { Fate::Ends(time - start * size.exp() / g) } else { Fate::PassesBy };
        }
        if size > 0.7 {
            return Fate::PassesBy;
        }
        // Runge and Kutta's method of order 4, in units where the acceleration is one.
        let d = 0.1 / (g.abs() + h.abs()).max(f64::MIN_POSITIVE);
        let Some(b) = rates(phi + 0.5 * d * h) else { return Fate::PassesBy };
        let Some(c) = rates(phi + 0.5 * d * b.1) else { return Fate::PassesBy };
        let Some(e) = rates(phi + d * c.1) else { return Fate::PassesBy };
        let s = start * size.exp();
        let half = |g: f64| s * (0.5 * d * g).exp();
        time += d / 6.0 * (s + 2.0 * half(g) + 2.0 * half(b.0) + s * (d * c.0).exp());
        size += d / 6.0 * (g + 2.0 * b.0 + 2.0 * c.0 + e.0);
        phi += d / 6.0 * (h + 2.0 * b.1 + 2.0 * c.1 + e.1);
    }
    Fate::PassesBy
}

/// The time after which slip would end if its rate stayed; `None` where it grows.
pub(crate) fn time_of_slip(here: &Evaluation, place: usize) -> Option<f64> {
    let Hold::Slide(d) = here.holds[place] else { return None };
    let forces = here.forces.as_ref()?;
    let rate = Vector2::new(forces.acceleration[3 * place + 1], forces.acceleration[3 * place + 2]);
    let slip = here.support.slip(place).norm();
    let along = rate.dot(&d);
    (along < 0.0).then(|| slip / -along)
}
