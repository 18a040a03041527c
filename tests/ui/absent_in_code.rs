//! A path that leads to no model is one error, whatever the code around makes of the module.

hodograph::mechanism!("no_such.mech");

use hodograph::{Law, Surface};
use no_such::{Coordinates, Parameters, NoSuch, Speeds};

pub mod everything {
    pub use super::no_such::*;

    pub fn rates(rod: &NoSuch<f64>, q: &Coordinates<f64>, u: &Speeds<f64>) -> Speeds<f64> {
        rod.accelerations(q, u).unwrap_or_default()
    }
}

/// A record that holds the mechanism.
#[derive(Clone, Debug)]
pub struct Simulation {
    rod: NoSuch<f64>,
    q: Coordinates<f64>,
    inputs: crate::no_such::Inputs<f64>,
}

impl Simulation {
    fn step(&mut self, dt: f64) {
        self.q.q1 += dt * self.inputs.torque;
        let Coordinates { q1, .. } = self.q;
        let hit = self.rod.collide_tip(&self.q, &Speeds { u1: q1 }, &Surface { mu: 0.3, e: 0.5, law: Law::Poisson });
        match hit {
            Ok(hit) => println!("{:?} {}", hit.speeds.u1, hit.impulse[0]),
            Err(error) => println!("{error}"),
        }
    }
}

trait Pendulum {
    fn length(&self) -> f64;
}

impl Pendulum for NoSuch<f64> {
    fn length(&self) -> f64 {
        self.parameters().l
    }
}

fn main() {
    let rod = NoSuch::new(Parameters { l: 1.0, ..Parameters::default() }).unwrap();
    let inputs = no_such::Inputs { torque: 2.0 };
    let mut simulation = Simulation { rod, q: Coordinates { q1: 0.5 }, inputs };
    simulation.step(0.1);
    let states: Vec<Coordinates<f64>> = (0..3).map(|i| Coordinates { q1: f64::from(i) }).collect();
    for q in &states {
        let energy: f64 = simulation.rod.potential_energy(q).unwrap();
        println!("{energy} {}", simulation.rod.length());
    }
    everything::rates(&simulation.rod, &simulation.q, &Speeds { u1: 1.0 });
}
