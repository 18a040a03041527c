//! Poisson's hypothesis for several contacts at once: closed forms of docs/theory.md, section 17.13.

use hodograph::{Law, Surface};
use hodograph_simulation::{EventKind, ImpactsAtOnce, Options, Simulation};

use crate::common::{Body, Line, Part, start};
use crate::many;
use hodograph_random::Random;

/// A block of half width a and half height h on its two lower corners.
fn block(m: f64, a: f64, h: f64) -> Body {
    let corner = |x: f64| Line::floor(Part::Point(x, -h));
    Body::new(m, m * (a * a + h * h) / 3.0, &[corner(-a), corner(a)])
}

/// Options with an e of each corner.
fn options(mu: f64, e: [f64; 2], law: Law, together: ImpactsAtOnce) -> Options {
    let surfaces = vec![(0, Surface { mu, e: e[0], law }), (1, Surface { mu, e: e[1], law })];
    Options { surfaces, together, ..Options::default() }
}

fn near(value: f64, wanted: f64) {
    assert!((value - wanted).abs() < 1e-12 * wanted.abs().max(1.0) * 10.0, "{value} {wanted}");
}

/// The change of energy of the impacts so far, J.
fn impacts(simulation: &Simulation<'_>) -> f64 {
    simulation.energy().unwrap().impacts
}

/// A block turns on one smooth corner and strikes with the other. Where it is flat both are pressed, and each returns its
/// own e of that; a slender one leaves the corner on which it turned.
#[test]
fn a_block_that_falls_on_its_second_corner() {
    let (m, v) = (2.0, 0.7);
    for (a, h) in [(0.3, 0.1), (0.2, 0.2), (0.1, 0.3)] {
        let body = block(m, a, h);
        let alpha = m * a * a / body.inertia;
        for [left, right] in [[0.5, 0.5], [0.8, 0.3], [0.2, 0.6], [0.0, 0.9], [1.0, 1.0]] {
            let chosen = options(0.0, [left, right], Law::Poisson, ImpactsAtOnce::Simultaneous);
            let simulation = start(&body, &[0.0, h, 0.0], &[0.0, -0.5 * v, -0.5 * v / a], chosen);
            let [_, z, omega] = simulation.speeds() else { unreachable!() };
            let wanted = if alpha <= 1.0 {
                [(1.0 - alpha) / (1.0 + alpha) * (1.0 + right) * v, right * v]
            } else if left >= right {
                let first = (alpha * alpha - 1.0) * (left - right);
                let second = (1.0 + alpha).powi(2) * right - (alpha - 1.0).powi(2) * left;
                [first * v / (4.0 * alpha), second * v / (4.0 * alpha)]
            } else {
                // The corner would approach with what it is given, and gets more.
                [0.0, right * v]
            };
            near(z - a * omega, wanted[0]);
            near(z + a * omega, wanted[1]);
            assert!(impacts(&simulation) <= 1e-15, "{a} {left} {right}");
        }
    }
}

/// A block falls flat and slides. Compression presses its leading edge by what friction turns; expansion returns e of that,
/// and the block turns, for as long as friction stops it; by Moreau's law it does not.
#[test]
fn a_block_that_falls_flat_and_slides() {
    let (m, a, h, v, mu, e) = (1.5, 0.3, 0.2, 2.0, 0.5, 0.6);
    let body = block(m, a, h);
    let about_edge = body.inertia + m * h * h;
    for u in [0.0, 0.3, 0.6, 0.99, 1.1, 1.3, 1.7, 2.5, -0.6] {
        for together in [ImpactsAtOnce::Approaching, ImpactsAtOnce::Simultaneous] {
            let begin =
                |law: Law| start(&body, &[0.0, h, 0.0], &[u, -v, 0.0], options(mu, [e; 2], law, together));
            let simulation = begin(Law::Poisson);
            let [x, z, omega] = simulation.speeds() else { unreachable!() };
            // In units of m: friction of compression, and that of expansion which would end the slip.
            let stopped = f64::clamp(u, -mu * v, mu * v);
            let turned = e * h * stopped;
            let rest = -(u - stopped + h * m * turned / body.inertia) * body.inertia / about_edge;
            let friction = rest.clamp(-mu * e * v, mu * e * v);
            near(*x, u - stopped + friction);
            near(*z, e * v);
            near(*omega, m * (turned + h * friction) / body.inertia);
            if u.abs() <= mu * v {
                near(*omega, e * h * m * u / about_edge);
            }
            assert!(impacts(&simulation) < 0.0);
            let moreau = begin(Law::Newton);
            let most = mu * (1.0 + e) * v;
            near(moreau.speeds()[0], u - f64::clamp(u, -most, most));
            near(moreau.speeds()[1], e * v);
            near(moreau.speeds()[2], 0.0);
        }
    }
}

/// All balls of a cradle at once: compression leaves all with the same speed, expansion returns e of what it took.
#[test]
fn a_cradle_struck_at_once() {
    let cradle = many::model("cradle5");
    for e in [0.0, 0.4, 1.0] {
        let mut start = many::Start::of(&cradle);
        start.coordinates.fill(0.0);
        start.speeds[0] = -2.0;
        let options =
            Options { together: ImpactsAtOnce::Simultaneous, ..many::surface(0.0, e, Law::Poisson) };
        let simulation = Simulation::new(&cradle, &start.state(), options).unwrap();
        for (i, speed) in simulation.speeds().iter().enumerate() {
            near(*speed, -2.0 * ((1.0 + e) / 5.0 - if i == 0 { e } else { 0.0 }));
        }
    }
}

/// With unlike e and friction no impact gives energy.
#[test]
fn no_impact_gives_energy() {
    let mut struck = 0;
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let (a, h) = (random.between(0.05, 0.4), random.between(0.05, 0.4));
        let body = block(1.0, a, h);
        let (mu, e) = (random.between(0.0, 1.5), [random.between(0.0, 1.0), random.between(0.0, 1.0)]);
        let u = [random.between(-2.0, 2.0), -random.between(0.5, 2.0), random.between(-0.5, 0.5)];
        let chosen = options(mu, e, Law::Poisson, ImpactsAtOnce::Simultaneous);
        let mut simulation = start(&body, &[0.0, h, 0.0], &u, chosen);
        for event in simulation.advance_to(1e-3).unwrap() {
            if let EventKind::SimultaneousCollision(impact) = event.kind {
                assert!(impact.energy_change <= 1e-12, "{seed}: {:e}", impact.energy_change);
                struck += 1;
            }
        }
    }
    assert!(struck > 40, "{struck}");
}
