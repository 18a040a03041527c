//! Bodies at the edge of friction: a thousandth of a billionth decides whether they stick or slide.

use crate::many::{Ended, Start, follow, model, surface};
use hodograph::{ComponentKind, Law, Mechanism};

const G: f64 = 9.81;
/// tan of the angle of the incline in the model
const TAN: f64 = 0.3;
/// mu - tan of the angle, or of mu m g less the push over m g
const EXCESS: [f64; 9] = [1e-6, 1e-9, 1e-12, 0.0, -1e-12, -1e-11, -1e-10, -1e-9, -1e-6];
/// A speed that should be this one after a second, from rest; `rounding` is what may be off of accelerations of
/// size G that cancel.
fn moves(end: &Ended, index: usize, wanted: f64, rounding: f64, what: &str) {
    assert!(end.error.is_none(), "{what}: {:?}", end.error);
    let speed = end.speeds[index];
    if wanted <= 0.0 {
        assert_eq!(end.outcome(), "rest", "{what}: {:?}", end.names());
        assert_eq!(speed, 0.0, "{what}");
    } else {
        assert_eq!(end.outcome(), "moves", "{what}: {:?}", end.names());
        assert!(
            speed > 0.0 && (speed - wanted).abs() < 1e-9 * wanted + rounding * G,
            "{what}: {speed:e} {wanted:e}"
        );
        assert!(end.account.abs() < 1e-15, "{what}: {:e}", end.account);
    }
}

/// A box on its four corners, turned by any angle about the normal of the incline.
#[test]
fn a_box_on_four_corners_sticks_or_slides() {
    let mechanism = model("box_on_incline");
    let down = mechanism.index(ComponentKind::Speed, "ux").unwrap();
    for (k, excess) in EXCESS.into_iter().enumerate() {
        for turn in [0.0, 0.37 * (k + 1) as f64] {
            let mut start = Start::of(&mechanism);
            start.set(&mechanism, "e0", (0.5_f64 * turn).cos());
            start.set(&mechanism, "e3", (0.5_f64 * turn).sin());
            let end = follow(&mechanism, &start, surface(TAN + excess, 0.3, Law::Poisson), 1.0);
            let wanted = -excess * G * TAN.atan().cos();
            moves(&end, down, wanted, 2e-15, &format!("{excess:e}, turned by {turn}"));
        }
    }
}

/// A crate on two feet that is pushed, in a plane.
#[test]
fn a_crate_on_two_feet_sticks_or_slides() {
    let mechanism = model("crate");
    let along = mechanism.index(ComponentKind::Speed, "u1").unwrap();
    for excess in EXCESS {
        let mut start = Start::of(&mechanism);
        start.set(&mechanism, "push", 2.0 * G * (TAN - excess));
        let end = follow(&mechanism, &start, surface(TAN, 0.3, Law::Poisson), 1.0);
        moves(&end, along, -excess * G, 2e-15, &format!("{excess:e}"));
    }
}
