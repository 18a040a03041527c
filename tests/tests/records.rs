//! Records of a generated module in a loop: arithmetic, names, units and text.

use hodograph::Path;
use hodograph_models::spring_damper_cart_rod as cart;
use hodograph_models::two_sleds::{Coordinates, Speeds, TwoSleds};

/// A step written with records is the step written with arrays.
#[test]
#[allow(clippy::assign_op_pattern)] // the sum of records is tried too
fn a_step_of_a_loop() {
    let sleds = TwoSleds::<f64>::default();
    let (mut q, mut u) = (Coordinates::default(), Speeds { u1: 1.0, u3: 0.1, u4: 1.0, u6: 0.1 });
    let (mut numbers, dt) = (<[f64; _]>::from(q), 1e-3);
    for _ in 0..100 {
        let rates = sleds.coordinate_rates(&q, &u).unwrap();
        let changes = <[f64; _]>::from(rates);
        numbers.iter_mut().zip(changes).for_each(|(number, change)| *number += dt * change);
        q = q + dt * rates;
        u += dt * sleds.accelerations(&q, &u).unwrap();
    }
    assert_eq!(<[f64; _]>::from(q), numbers);
    assert_eq!(-(u - u * 2.0), u);
    assert_eq!((u * 4.0 / 4.0).get(0), Some(u.u1));
    assert_eq!(u.get(4), None);
    assert_eq!(u.iter().map(|(_, number)| number).sum::<f64>(), u.u1 + u.u3 + u.u4 + u.u6);
}

#[test]
fn names_units_and_text() {
    assert_eq!(Speeds::<f64>::NAMES, ["u1", "u3", "u4", "u6"]);
    assert_eq!(Speeds::<f64>::UNITS, ["m/s", "rad/s", "m/s", "rad/s"]);
    let u = Speeds { u1: 1.0, u3: 0.125, u4: -2.0, u6: 0.0 };
    assert_eq!(u.to_string(), "u1 = 1 m/s, u3 = 0.125 rad/s, u4 = -2 m/s, u6 = 0 rad/s");
    assert_eq!(format!("{u:.1}"), "u1 = 1.0 m/s, u3 = 0.1 rad/s, u4 = -2.0 m/s, u6 = 0.0 rad/s");
    assert_eq!(cart::Coordinates::<f32>::NAMES.len(), cart::Coordinates::<f32>::UNITS.len());
    assert_eq!(Path::SlidingThenSticking.to_string(), "sliding, then sticking");
}
