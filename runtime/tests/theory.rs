//! Numbers and formulas that docs/theory.md states.

use hodograph::{Characteristics, ContactMode, ReducedMatrix, Selection, contact_force, contact_mode, rates};
use nalgebra::{Complex, Vector2, Vector3};

const SLEDS: ReducedMatrix<f64> =
    ReducedMatrix::new(0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211);

/// 17.3: sticking and two directions of slip fit, although mu |b| < m_nn.
#[test]
fn several_modes_fit_below_the_bound() {
    let m = ReducedMatrix::<f64>::new(4.0, 3.8, -3.8, 6.5, -1.91, 4.7);
    let (beta, rest, mu) = (Vector3::new(-1.0, 0.0, 1.5), Vector2::zeros(), 0.6_f64);
    assert!(mu * m.nt.hypot(m.ns) < 0.81 * m.nn);
    let chosen = contact_mode(&m, &beta, &rest, mu).expect("a mode");
    assert_eq!(chosen.selection, Selection::SeveralModes);
    let stick = contact_force(ContactMode::Stick, &m, &beta, &rest, mu).expect("a force");
    let part = stick.force.yz().norm() / (mu * stick.force.x);
    assert!((part - 0.935486).abs() < 1e-6, "{part}");
    // Acceleration while slip begins along phi: along phi, and across it.
    let acceleration = |phi: f64| {
        let d = Vector2::new(phi.cos(), phi.sin());
        let slip = contact_force(ContactMode::Slide, &m, &beta, &(d * 1e-9), mu).expect("a force");
        assert!(slip.acceleration.x.abs() < 1e-12);
        let a = slip.acceleration.yz();
        (a.dot(&d), d.x * a.y - d.y * a.x)
    };
    for (phi, gamma) in [(0.1097358, 0.024835), (0.4870097, 0.329872)] {
        let (along, across) = acceleration(phi);
        assert!((along - gamma).abs() < 1e-5 && across.abs() < 1e-5, "{phi}: {along} {across}");
    }
    // Slip between the first and 3.6716 turns towards the second.
    assert!(acceleration(0.2).1 > 0.0 && acceleration(3.6).1 < 0.0 && acceleration(0.05).1 < 0.0);
}

/// (2.3), (2.6) to (2.8), against (31) to (33).
#[test]
fn the_complex_form_is_that_of_the_paper() {
    for mu in [0.3, 1.1, 4.0] {
        let m = SLEDS;
        let beta = Complex::new(m.nt, m.ns);
        let tau = 0.5 * (m.tt + m.ss);
        let n = Complex::new(0.5 * (m.tt - m.ss), m.ts) * mu;
        for k in 0..100 {
            let phi = 0.0631 * f64::from(k);
            let [_, g, h] = <[f64; 3]>::from(rates(&m, mu, phi));
            let d = Complex::from_polar(1.0, phi);
            let both = beta * d.conj() - mu * tau - n * d.conj() * d.conj();
            assert!((both - Complex::new(g, h)).norm() < 1e-14);
            let quartic = n.conj() * d.powi(4) - beta.conj() * d.powi(3) + beta * d - n;
            assert!((quartic - Complex::new(0.0, 2.0 * h) * d * d).norm() < 1e-14);
            let potential = (beta * d.conj() - n * d.conj() * d.conj() * 0.5).re - 0.5 * mu * tau;
            assert!((g - (2.0 * potential - (beta * d.conj()).re)).abs() < 1e-14);
            let slope = (n * d.conj() * d.conj() * 2.0 - beta * d.conj()).re;
            let step = 1e-5;
            let difference = (rates(&m, mu, phi + step).z - rates(&m, mu, phi - step).z) / (2.0 * step);
            assert!((slope - difference).abs() < 1e-8);
            let across = Vector2::new(-phi.sin(), phi.cos());
            let quadratic =
                m.tt * across.x * across.x + 2.0 * m.ts * across.x * across.y + m.ss * across.y * across.y;
            assert!((slope + g + mu * quadratic).abs() < 1e-14);
        }
    }
}

/// 3.3: h has no constant term and no harmonic above the second, so at most 240 degrees lie between
/// neighbouring zeros.
#[test]
fn neighbouring_zeros_are_at_most_240_degrees_apart() {
    let third = core::f64::consts::TAU / 3.0;
    let mut widest = 0.0_f64;
    let step = 2.0 * third / 960.0;
    for stretch in [1.02, 1.1, 0.3, 0.0] {
        for turn in 0..60 {
            // The second harmonic alone has zeros 90 degrees apart, the first alone 180; together they come
            // near the bound.
            let (sin, cos) = (0.11 * f64::from(turn)).sin_cos();
            let m = ReducedMatrix::new(4.0, 0.25 * stretch * cos, 0.25 * stretch * sin, 1.0, 0.0, 0.5);
            let h = |phi: f64| rates(&m, 1.0, phi).z;
            let mut last = None;
            for k in 0..2880 {
                let phi = f64::from(k) * step;
                assert!((h(phi) + h(phi + third) + h(phi + 2.0 * third)).abs() < 1e-14);
                if h(phi) * h(phi + step) <= 0.0 {
                    widest = last.map_or(widest, |last| widest.max(phi - last));
                    last = Some(phi);
                }
            }
        }
    }
    assert!(widest > 4.0 && widest < 2.0 * third + step, "{widest}");
}

/// 12: renewed slip keeps its direction, also where the tangential block has lost its determinant.
#[test]
fn renewed_slip_does_not_turn() {
    let mut count = 0;
    for k in 1..2000 {
        let [p, q, r] =
            [0.754_877_666, 0.569_840_291, 0.324_717_957].map(|step: f64| (f64::from(k) * step).fract());
        let small = 10.0_f64.powf(-14.0 * p);
        let (sin, cos) = (core::f64::consts::TAU * q).sin_cos();
        let (tt, ts, ss) =
            (cos * cos + small * sin * sin, cos * sin * (1.0 - small), sin * sin + small * cos * cos);
        // b lies in the range of T, so that the matrix is positive definite with m_nn = 1.
        let (along, across) = (0.6 * (2.0 * r - 1.0), 0.6 * small.sqrt() * (2.0 * q - 1.0));
        let (nt, ns) = (along * cos - across * sin, along * sin + across * cos);
        let m = ReducedMatrix::new(1.0, nt, ns, tt, ts, ss);
        let mu = 0.7 * Characteristics::of(&m, 1.0).mu_c * r;
        let Some(renewal) = Characteristics::of(&m, mu).renewal else { continue };
        let [_, g, h] = <[f64; 3]>::from(rates(&m, mu, renewal.phi_hat));
        assert!(g > 0.0 && h.abs() <= 4.0 * f64::EPSILON * (nt.hypot(ns) + mu), "{k}: {g} {h}");
        count += 1;
    }
    assert_eq!(count, 1999);
}
