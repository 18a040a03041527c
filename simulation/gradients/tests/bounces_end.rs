//! Bounces of two corners that end together.

use hodograph::Law;
use hodograph_gradients::{By, Reason};

use crate::common::{Task, read};

const G: f64 = 9.81;

/// A crate with this inclination, speed and spin 0.08 m above the ground.
fn crate_above(inclination: f64, speed: f64, spin: f64, mu: f64, e: f64) -> Task {
    let mechanism = read("falling_crate.mech");
    let (q, u) = (vec![0.0, 0.08, inclination], vec![speed, 0.0, spin]);
    Task { mechanism, q, u, mu, e, law: Law::Newton }
}

/// A crate falls on its corners in turn, faster and faster, until both slide. Slip keeps its direction, so all impulses along the
/// ground are mu times those along the normal, and these are the weight times the time: u(t) = u - mu g t once the crate lies,
/// whatever the bounces were. The bounces that are left out below the tolerance leave 1e-6.
#[test]
fn a_crate_falls_flat() {
    for (inclination, speed, spin, mu, e, time) in
        [(0.05, 1.0, 0.0, 0.3, 0.5, 0.25), (0.1, 1.0, 1.0, 0.2, 0.3, 0.3), (0.03, 2.0, 0.1, 0.1, 0.6, 0.7)]
    {
        let task = crate_above(inclination, speed, spin, mu, e);
        let by = [
            By::Friction(None),
            By::Restitution(None),
            By::Speed(0),
            By::Coordinate(1),
            By::Coordinate(2),
            By::Parameter(0),
            By::Parameter(1),
            By::Parameter(2),
        ];
        let found = task.differentiate(&by, &[time]);
        assert!(found.undefined.is_none(), "{}", found.undefined.unwrap());
        let last = found.events.iter().rev().take_while(|event| event.event.kind.name() == "contact");
        assert!(last.count() >= 2, "{:?}", found.events.last());
        let derivative = found.samples[0].derivative.as_ref().unwrap();
        let exact = [-G * time, 0.0, 1.0, 0.0, 0.0, 0.0, -mu * time, 0.0];
        for (column, exact) in exact.into_iter().enumerate() {
            let found = derivative[(3, column)];
            assert!((found - exact).abs() < 2e-6, "{:?}: {found} and not {exact}", by[column]);
            // It lies on the ground: z = h, with neither inclination nor speeds.
            for (row, exact) in [(1, f64::from(u8::from(column == 7))), (2, 0.0), (4, 0.0), (5, 0.0)] {
                let found = derivative[(row, column)];
                assert!((found - exact).abs() < 1e-9, "row {row}, {:?}: {found}", by[column]);
            }
        }
        // Where it is: the time since it touches the ground, but for the bounces, which differences have to 1e-5.
        for (column, &by) in by.iter().enumerate() {
            let h = 1e-5;
            let (above, below) = (task.changed(by, h).end(time).0, task.changed(by, -h).end(time).0);
            let difference = (above[0] - below[0]) / (2.0 * h);
            let found = derivative[(0, column)];
            assert!((found - difference).abs() < 1e-5, "{by:?}: {found} and not {difference}");
        }
    }
}

/// Where the least change of the start turns the order in which corners strike, ever more from bounce to bounce, the derivative
/// grows as heights fall.
#[test]
fn bounces_in_an_order_that_grows_unstable_have_no_derivative() {
    let task = crate_above(0.02, 2.0, 0.5, 0.2, 0.7);
    let found = task.differentiate(&[By::Coordinate(1), By::Friction(None)], &[0.3, 0.6]);
    let why = found.undefined.as_ref().unwrap();
    assert_eq!(why.reason, Reason::Settling);
    assert!(found.samples[0].derivative.is_some() && found.samples[1].derivative.is_none());
    let told = why.to_string();
    assert!(told.contains("end together") && told.contains("before this time"), "{told}");
}
