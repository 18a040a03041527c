//! Rods that turn hundreds of times within a step of the integration: none misses the wall.
//!
//! `HODOGRAPH_SPINS=100000 cargo test --release -p hodograph-simulation --test all spins:: -- --nocapture`

use crate::many::{Start, follow, model, surface};
use hodograph::Law;
use hodograph_random::Random;

/// A rod of length 1 at angle q + spin t, whose pivot approaches a wall by h - v t.
struct Spin {
    spin: f64,
    angle: f64,
    height: f64,
    speed: f64,
}

impl Spin {
    fn random(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        // As many slow spins as fast ones.
        let spin = sign * 15.0 * 30.0_f64.powf(random.between(0.0, 1.0));
        let speed = 10.0_f64.powf(random.between(-0.8, 0.2));
        Self { spin, angle: random.between(-3.2, 3.2), height: 1.0 + speed * random.between(0.3, 6.0), speed }
    }

    fn gap(&self, t: f64) -> f64 {
        self.height - self.speed * t + (self.angle + self.spin * t).cos()
    }

    /// When the gap first closes. Before (h - 1) / v it is open; from there every turn is looked at: the gap's
    /// minimum of a turn is where its rate vanishes, on the way there it falls.
    fn strikes(&self) -> f64 {
        let first = (self.height - 1.0) / self.speed;
        // Rate: -v - spin sin(angle + spin t) = 0; minima have cos < 0 and d^2 gap / dt^2 > 0.
        let (turn, lag) = (std::f64::consts::TAU, (self.speed / self.spin.abs()).asin());
        // With x = the angle, taken to grow: minima at pi + lag.
        let grows = self.spin.signum();
        let from = grows * self.angle + self.spin.abs() * first;
        let mut low = ((from - std::f64::consts::PI - lag) / turn).ceil() * turn + std::f64::consts::PI + lag;
        let time = |x: f64| (x - grows * self.angle) / self.spin.abs();
        while self.gap(time(low)) > 0.0 {
            low += turn;
        }
        // The gap falls from the maximum before the minimum.
        let (mut above, mut below) = (time(low - std::f64::consts::PI - 2.0 * lag).max(first), time(low));
        for _ in 0..80 {
            let middle = 0.5 * (above + below);
            if self.gap(middle) > 0.0 { above = middle } else { below = middle }
        }
        below
    }
}

#[test]
fn fast_spins_strike_at_the_first_touch() {
    let count = std::env::var("HODOGRAPH_SPINS").ok().and_then(|text| text.parse().ok()).unwrap_or(300);
    let rod = model("spin");
    let (mut failures, mut longest, mut turns) = (Vec::new(), (0.0_f64, 0), 0.0_f64);
    for seed in 0..count {
        let spin = Spin::random(seed);
        let time = spin.strikes();
        // The state of the model is the angle and the place of the pivot: the wall stands at 1.9.
        let mut start = Start::of(&rod);
        start.set(&rod, "q1", spin.angle);
        start.set(&rod, "z", spin.height - 1.9);
        start.set(&rod, "u1", spin.spin);
        start.set(&rod, "w", -spin.speed);
        let end = follow(&rod, &start, surface(0.3, 0.5, Law::Poisson), time + 1e-6 * (1.0 + time));
        let first = end.events.first().map(|event| (event.kind.name(), event.time));
        // A rod that grazes the wall strikes next to the minimum of its gap, where a zero has half of the digits.
        let off = first.map_or(f64::INFINITY, |(_, struck)| (struck - time).abs());
        if end.error.is_some() || first.is_none_or(|(name, _)| name != "collision") || off > 1e-6 {
            println!("{seed}: spin {} {:?}, {first:?} for {time}", spin.spin, end.error);
            failures.push(seed);
        } else if off > longest.0 {
            longest = (off, seed);
        }
        turns = turns.max(spin.spin.abs() * time / std::f64::consts::TAU);
    }
    println!("{count} spins, up to {turns:.0} turns, {} missed, {longest:?} s off", failures.len());
    assert!(failures.is_empty(), "{failures:?}");
}
