//! A length and a time of the problem, in which tolerances are measured.
//!
//! Whether something is short, near or slow depends on units. The length is the greatest of the gaps and
//! lever arms of contacts, the time that in which their free accelerations or velocities cover this length
//! (docs/theory.md, section 18.14).

use hodograph::{ComponentKind, Contacts, State};

use crate::closed::angles::Angles;
use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::lengths::Lengths;
use crate::closed::torques::WithTorques;

/// Units of a problem.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Scales {
    /// m
    pub length: f64,
    /// s
    pub time: f64,
    /// the smallest normal velocity that matters, m/s: below it a contact opens by less than 1e-12 of the
    /// length; infinite if there is no bound
    pub slow: f64,
}

/// A gap or a fall below this part of the greatest coordinate counts as closed, and does not define a length; a
/// velocity below this part of its terms does not define a velocity.
const TOUCHES: f64 = 1e-9;
/// The smallest velocity that matters, relative to that of a fall through the length; the height of its rise
/// is the square of this.
const SEEN: f64 = 1e-6;
/// For estimates of rounding, coordinates count as no smaller than this part of the length of the problem.
pub(crate) const SIZE: f64 = 5e-3;
/// The part of the terms of a normal velocity that rounding and projections leave.
pub(crate) const OWN: f64 = 1e-13;
/// Points that start closer than this, m, or fall by less, are meant to touch: that is not a length of the problem.
const NEAR: f64 = 1e-6;

impl Scales {
    /// The scales of a start state; 1 if it does not determine them.
    pub fn of(
        mechanism: &dyn Contacts<f64>,
        (angles, lengths): (&Angles, &Lengths),
        state: &State<'_>,
    ) -> Self {
        let place = lengths.greatest(state.coordinates);
        let (mut length, mut gaps) = (0.0_f64, 0.0_f64);
        let (mut acceleration, mut speed, mut approach) = (0.0_f64, 0.0_f64, 0.0_f64);
        for contact in 0..mechanism.count(ComponentKind::Contact) {
            let Ok(Some(gap)) = mechanism.gap(contact, state) else { continue };
            let plain = WithTorques::new(mechanism, &[]);
            let Ok(alone) = ClosedContacts::new(plain, state, &[contact], true) else { continue };
            gaps = gaps.max(gap.abs());
            for (index, row) in alone.partials.row_iter().enumerate() {
                // The velocity of the point per angular speed is a lever arm.
                if let Some(unit) = angles.unit(index) {
                    length = length.max(row.norm() / unit);
                }
            }
            acceleration = acceleration.max(alone.beta.norm());
            let whole = alone.velocity.norm();
            if whole > TOUCHES * alone.velocity_size(0, state.speeds) {
                speed = speed.max(whole);
            }
            let normal = alone.velocity[0].abs();
            if normal > TOUCHES * alone.normal_size(0, state.speeds) {
                approach = approach.max(normal);
            }
        }
        let known = |value: f64| value.is_finite() && value > 0.0;
        // Motion along a surface defines the length only if nothing approaches.
        let fall = if approach > 0.0 { approach } else { speed }.powi(2) / acceleration;
        if gaps > NEAR.max(TOUCHES * place) {
            length = length.max(gaps);
        }
        if !known(length) {
            // A fall shorter than a gap that counts as closed defines none either: later motion may be of any size.
            let resolved = known(fall) && fall > NEAR.max(TOUCHES * place);
            length = if resolved { fall } else { 1.0 };
        }
        // The faster of falling and moving.
        let time = (length / acceleration).sqrt().min(length / speed);
        let slow = SEEN * (length * acceleration).sqrt().max(approach);
        Self {
            length,
            time: if known(time) { time } else { 1.0 },
            slow: if known(slow) { slow } else { f64::INFINITY },
        }
    }
}

#[cfg(test)]
mod tests {
    use hodograph_models::slender_rod_5dof::{Coordinates, SlenderRod5dof, Speeds};

    use super::*;

    #[test]
    fn a_rod_that_falls_has_the_scales_of_its_fall() {
        let rod = SlenderRod5dof::<f64>::default();
        let q: [f64; 5] = Coordinates { z: 2.0, ..Coordinates::default() }.into();
        let u: [f64; 5] = Speeds::default().into();
        let scales = Scales::of(
            &rod,
            (&Angles::of(&rod), &Lengths::of(&rod)),
            &State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] },
        );
        assert!(scales.length >= 1.0 && scales.length < 4.0, "{scales:?}");
        assert!((0.2..0.8).contains(&scales.time), "{scales:?}");
    }

    #[test]
    fn a_rod_on_the_floor_has_the_length_of_its_arm() {
        let rod = SlenderRod5dof::<f64>::default();
        let (l, tilt) = (0.5, 0.6_f64);
        let q: [f64; 5] = Coordinates { z: l * tilt.sin(), q5: tilt, ..Coordinates::default() }.into();
        let u: [f64; 5] = Speeds { u1: 0.0, u2: 0.0, u3: -1e-3, u4: 0.0, u5: 0.0 }.into();
        let scales = Scales::of(
            &rod,
            (&Angles::of(&rod), &Lengths::of(&rod)),
            &State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] },
        );
        assert!((scales.length - l).abs() < 1e-9, "{scales:?}");
    }
}
