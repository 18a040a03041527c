//! Derivatives of collisions and saltation matrices of generated modules, against differences of what the
//! modules compute.

use hodograph::{Law, NonSmoothness, Surface};
use nalgebra::{SMatrix, SVector};

/// A central difference of fourth order.
fn difference<const N: usize>(h: f64, at: impl Fn(f64) -> SVector<f64, N>) -> SVector<f64, N> {
    ((at(h) - at(-h)) * 8.0 - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
}

/// A few independent speeds, and what a collision makes of them.
macro_rules! derivative {
    ($module:ident, $machine:ident, $collide:ident, $derivative:ident, $q:expr, $u:expr, $p:literal) => {
        for &law in Law::ALL {
            for mu in [0.15, 0.7] {
                use hodograph_models::$module::{Speeds, $machine};
                let machine = $machine::<f64>::default();
                let (q, u): (_, Speeds<f64>) = ($q, $u);
                let surface = Surface { mu, e: 0.6, law };
                let exact = machine.$derivative(&q, &u, &surface).expect("an outcome");
                assert_eq!(exact.outcome.non_smoothness, None);
                let after = |u: [f64; $p], surface: &Surface<f64>| {
                    let hit = machine.$collide(&q, &u.into(), surface).expect("an outcome");
                    SVector::<f64, $p>::from(<[f64; $p]>::from(hit.speeds))
                };
                let before = <[f64; $p]>::from(u);
                let near = |numeric: SVector<f64, $p>, column: SVector<f64, $p>| {
                    let error = (numeric - column).amax();
                    assert!(
                        error <= 1e-7 * (1.0 + column.amax()),
                        "{law:?} {mu}: {error:e} {numeric} {column}"
                    );
                };
                for column in 0..$p {
                    let numeric = difference(1e-4, |h| {
                        let mut u = before;
                        u[column] += h;
                        after(u, &surface)
                    });
                    near(numeric, exact.speeds.column(column).into());
                }
                near(
                    difference(1e-4, |h| after(before, &Surface { mu: mu + h, ..surface })),
                    exact.by_friction,
                );
                near(
                    difference(1e-4, |h| after(before, &Surface { e: 0.6 + h, ..surface })),
                    exact.by_restitution,
                );
            }
        }
    };
}

#[test]
fn speeds_after_by_speeds_before() {
    use hodograph_models::{free_box_corner, planar_double_pendulum, slender_rod_5dof, two_sleds};
    derivative!(
        free_box_corner,
        FreeBoxCorner,
        collide_corner,
        collide_corner_derivative,
        free_box_corner::Coordinates::default(),
        free_box_corner::Speeds::default(),
        6
    );
    derivative!(
        slender_rod_5dof,
        SlenderRod5dof,
        collide_end,
        collide_end_derivative,
        slender_rod_5dof::Coordinates::default(),
        slender_rod_5dof::Speeds::default(),
        5
    );
    // With constraints and dependent speeds.
    derivative!(
        two_sleds,
        TwoSleds,
        collide_bc_ac,
        collide_bc_ac_derivative,
        two_sleds::Coordinates::default(),
        two_sleds::Speeds::default(),
        4
    );
    // With a closed form.
    derivative!(
        planar_double_pendulum,
        PlanarDoublePendulum,
        collide_tip_wall,
        collide_tip_wall_derivative,
        planar_double_pendulum::Coordinates::default(),
        planar_double_pendulum::Speeds::default(),
        2
    );
}

/// Trajectories that start a little off meet the surface a little earlier or later: to where they meet it,
/// through the collision, and back to the same time.
macro_rules! saltation {
    ($module:ident, $machine:ident, $collide:ident, $gap:ident, $saltation:ident, $c:literal, $p:literal) => {{
        use hodograph_models::$module::{Coordinates, Speeds, $machine};
        const N: usize = $c + $p;
        let machine = $machine::<f64>::default();
        let split = |x: &SVector<f64, N>| {
            let q: [f64; $c] = std::array::from_fn(|i| x[i]);
            let u: [f64; $p] = std::array::from_fn(|i| x[$c + i]);
            (Coordinates::from(q), Speeds::from(u))
        };
        let joined = |q: &Coordinates<f64>, u: &Speeds<f64>| {
            let (q, u) = (<[f64; $c]>::from(*q), <[f64; $p]>::from(*u));
            SVector::<f64, N>::from_iterator(q.into_iter().chain(u))
        };
        let rates = |x: &SVector<f64, N>| {
            let (q, u) = split(x);
            let rates = machine.coordinate_rates(&q, &u).expect("regular");
            joined(&rates, &machine.accelerations(&q, &u).expect("regular"))
        };
        // Runge and Kutta's step; the times here are of the size of the deviation.
        let flow = |x: &SVector<f64, N>, t: f64| {
            let a = rates(x);
            let b = rates(&(x + a * (t / 2.0)));
            let c = rates(&(x + b * (t / 2.0)));
            let d = rates(&(x + c * t));
            x + (a + b * 2.0 + c * 2.0 + d) * (t / 6.0)
        };
        let (q, u) = (Coordinates::default(), Speeds::default());
        let start = joined(&q, &u);
        let surface_gap = machine.$gap(&q).expect("regular");
        for &law in Law::ALL {
            for mu in [0.15, 0.7] {
                let surface = Surface { mu, e: 0.6, law };
                let exact = machine.$saltation(&q, &u, &surface).expect("an outcome");
                assert_eq!(exact.non_smoothness, None);
                let through = |x: SVector<f64, N>| {
                    let gap = |t: f64| machine.$gap(&split(&flow(&x, t)).0).expect("regular") - surface_gap;
                    let (mut t0, mut t1) = (0.0, 1e-4);
                    for _ in 0..30 {
                        let (g0, g1) = (gap(t0), gap(t1));
                        if g1 == g0 {
                            break;
                        }
                        (t0, t1) = (t1, t1 - g1 * (t1 - t0) / (g1 - g0));
                    }
                    let met = flow(&x, t1);
                    let (q, u) = split(&met);
                    let hit = machine.$collide(&q, &u, &surface).expect("an outcome");
                    flow(&joined(&q, &hit.speeds), -t1)
                };
                let size = exact.matrix.amax();
                for column in 0..N {
                    let numeric = difference(2e-4, |h| {
                        let mut x = start;
                        x[column] += h;
                        through(x)
                    });
                    let error = (numeric - exact.matrix.column(column)).amax();
                    assert!(error <= 2e-7 * size, "{law:?} {mu}, column {column}: {error:e}");
                }
            }
        }
    }};
}

#[test]
fn saltation_of_generated_modules() {
    saltation!(free_box_corner, FreeBoxCorner, collide_corner, gap_corner, saltation_corner, 6, 6);
    saltation!(slender_rod_5dof, SlenderRod5dof, collide_end, gap_end, saltation_end, 5, 5);
}

/// A collision without slip has no derivative, and the module says so.
#[test]
fn modules_name_the_non_smoothness() {
    use hodograph_models::free_box_corner::{Coordinates, FreeBoxCorner, Speeds};
    let machine = FreeBoxCorner::<f64>::default();
    let q = Coordinates::default();
    let u = Speeds { u1: 0.0, u2: 0.0, u3: -1.0, u4: 0.0, u5: 0.0, u6: 0.0 };
    let surface = Surface { mu: 0.4, e: 0.5, law: Law::Poisson };
    let derivative = machine.collide_corner_derivative(&q, &u, &surface).expect("an outcome");
    assert_eq!(derivative.outcome.non_smoothness, Some(NonSmoothness::NoSlip));
    let saltation = machine.saltation_corner(&q, &u, &surface).expect("an outcome");
    assert_eq!(saltation.non_smoothness, Some(NonSmoothness::NoSlip));
    // Bodies that part do not collide.
    let parting = machine.saltation_corner(&q, &Speeds { u3: 1.0, ..u }, &surface);
    assert_eq!(parting.expect_err("no collision").kind(), "not_approaching");
}

/// At the same configuration and time, the block of the speeds is the derivative of the jump alone where
/// nothing moves the surface.
#[test]
fn saltation_has_the_derivative_of_the_jump() {
    use hodograph_models::free_box_corner::{Coordinates, FreeBoxCorner, Speeds};
    let machine = FreeBoxCorner::<f64>::default();
    let surface = Surface { mu: 0.4, e: 0.5, law: Law::Stronge };
    let (q, u) = (Coordinates::default(), Speeds::default());
    let derivative = machine.collide_corner_derivative(&q, &u, &surface).expect("an outcome");
    let saltation = machine.saltation_corner(&q, &u, &surface).expect("an outcome").matrix;
    // The gap does not depend on speeds, so that these columns keep the time of the collision.
    let block: SMatrix<f64, 6, 6> = saltation.fixed_view::<6, 6>(6, 6).into();
    assert_eq!(block, derivative.speeds);
    assert!(saltation.fixed_view::<6, 6>(0, 6).amax() == 0.0);
}
