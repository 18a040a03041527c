//! Two typos in a model are two errors, whatever the code around makes of the module.

hodograph::mechanism! {
    mechanism Rod;
    parameters { m: kg = 1, l: m = 0.5 }
    coordinates { q1: rad }
    speeds { u1: rad/s }
    frames { B = N.rotate(z, q1); }
    points { G = O - l/2*B.y; P = O - l*B.y; }
    bodies { Rod1 { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }
    loads { gravity: -gravity*N.y; torque on B: torke*N.z; }
    contacts { tip { point: P of Rod1, normal: -N.x } }
}

use hodograph::{Law, Surface};
use rod::{Coordinates, Parameters, Rod, Speeds};

pub mod everything {
    pub use super::rod::*;

    pub fn rates(rod: &Rod<f64>, q: &Coordinates<f64>, u: &Speeds<f64>) -> Speeds<f64> {
        rod.accelerations(q, u).unwrap_or_default()
    }
}

/// A record that holds the mechanism.
#[derive(Clone, Debug)]
pub struct Simulation {
    rod: Rod<f64>,
    q: Coordinates<f64>,
    inputs: crate::rod::Inputs<f64>,
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

impl Pendulum for Rod<f64> {
    fn length(&self) -> f64 {
        self.parameters().l
    }
}

fn main() {
    let rod = Rod::new(Parameters { l: 1.0, ..Parameters::default() }).unwrap();
    let inputs = rod::Inputs { torque: 2.0 };
    let mut simulation = Simulation { rod, q: Coordinates { q1: 0.5 }, inputs };
    simulation.step(0.1);
    let states: Vec<Coordinates<f64>> = (0..3).map(|i| Coordinates { q1: f64::from(i) }).collect();
    for q in &states {
        let energy: f64 = simulation.rod.potential_energy(q).unwrap();
        println!("{energy} {}", simulation.rod.length());
    }
    everything::rates(&simulation.rod, &simulation.q, &Speeds { u1: 1.0 });
}
