//! What a collision that is one routine brings beside the usual one, over random states: the two sleds, the
//! planar double pendulum, the arm, and a mechanism for each other structure, under one law, with friction and restitution given at run time or fixed.

use std::hint::black_box;
use std::time::Instant;

use hodograph::{ComponentKind, Contacts, Law, State, Surface};

/// The states of each model.
const STATES: usize = 200;

/// How often the states are gone through to measure time; the fastest round counts. A round is so short that it
/// is often not interrupted.
const ROUNDS: usize = 500;

const SURFACE: Surface<f64> = Surface { mu: 0.3, e: 0.6, law: Law::Stronge };

/// Numbers between -1 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Coordinates and speeds around the initial state in which the first contact is struck.
fn states(mechanism: &dyn Contacts) -> Vec<(Vec<f64>, Vec<f64>)> {
    let [n, p] = [ComponentKind::Coordinate, ComponentKind::Speed].map(|kind| mechanism.count(kind));
    let (mut q, mut u) = (vec![0.0; n], vec![0.0; p]);
    let _ = mechanism.initial_state(&mut q, &mut u, &mut []);
    let (mut random, mut states) = (Random(7), Vec::new());
    while states.len() < STATES {
        let coordinates: Vec<f64> = q.iter().map(|q| q + 0.2 * random.next()).collect();
        let mut speeds: Vec<f64> = u.iter().map(|_| random.next()).collect();
        let state = State { time: 0.0, coordinates: &coordinates, speeds: &speeds, inputs: &[] };
        let Ok(velocity) = mechanism.contact_velocity(0, &state) else { continue };
        if velocity.x > 0.0 {
            speeds.iter_mut().for_each(|speed| *speed = -*speed);
        }
        states.push((coordinates, speeds));
    }
    states
}

fn copy<const N: usize>(to: &mut [f64; N], from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
}

macro_rules! models {
    ($($module:ident $machine:ident $file:literal $contact:ident $collide:ident: $shared:ident $known_law:ident $known_surface:ident;)*) => {
        $(
            hodograph::mechanism!(
                $file,
                specialise known_law($contact, law = Stronge),
                specialise known_surface($contact, law = Stronge, mu = 0.3, e = 0.6),
            );

            #[inline(never)]
            fn $shared(m: &$module::$machine<f64>, q: &$module::Coordinates<f64>, u: &$module::Speeds<f64>) {
                black_box(stringify!($shared));
                let _ = black_box(m.$collide(q, u, &black_box(SURFACE)));
            }

            #[inline(never)]
            fn $known_law(m: &$module::$machine<f64>, q: &$module::Coordinates<f64>, u: &$module::Speeds<f64>) {
                black_box(stringify!($known_law));
                let _ = black_box(m.known_law(q, u, black_box(SURFACE.mu), black_box(SURFACE.e)));
            }

            #[inline(never)]
            fn $known_surface(m: &$module::$machine<f64>, q: &$module::Coordinates<f64>, u: &$module::Speeds<f64>) {
                black_box(stringify!($known_surface));
                let _ = black_box(m.known_surface(q, u));
            }
        )*

        /// The states of a model, and what is called there.
        mod prepared {
            use super::*;

            $(pub fn $module() -> (super::$module::$machine<f64>, Vec<(super::$module::Coordinates<f64>, super::$module::Speeds<f64>)>) {
                let model = Default::default();
                let given = |(q, u): (Vec<f64>, Vec<f64>)| {
                    // as many numbers as the initial state has
                    let mut at = (super::$module::Coordinates::default().into(), super::$module::Speeds::default().into());
                    copy(&mut at.0, &q);
                    copy(&mut at.1, &u);
                    (super::$module::Coordinates::from(at.0), super::$module::Speeds::from(at.1))
                };
                let states = states(&model).into_iter().map(given).collect();
                (black_box(model), black_box(states))
            })*
        }

        /// Every routine once at each state.
        pub fn run() {
            $(
                let (model, states) = prepared::$module();
                for routine in [$shared, $known_law, $known_surface] {
                    states.iter().for_each(|(q, u)| routine(&model, q, u));
                }
            )*
        }

        /// Prints a line per model: microseconds of a call of the usual routine and of both specialised ones, whose
        /// answers must have its bits. The routines take turns, and of each the fastest round counts: other programs
        /// only delay.
        pub fn times() {
            $(
                let (model, states) = prepared::$module();
                for (q, u) in &states {
                    let text = |answer: &dyn std::fmt::Debug| format!("{answer:?}");
                    let usual = text(&model.$collide(q, u, &SURFACE));
                    assert_eq!(usual, text(&model.known_law(q, u, SURFACE.mu, SURFACE.e)));
                    assert_eq!(usual, text(&model.known_surface(q, u)));
                }
                let mut least = [f64::INFINITY; 3];
                for _ in 0..ROUNDS {
                    for (least, routine) in least.iter_mut().zip([$shared, $known_law, $known_surface]) {
                        let start = Instant::now();
                        states.iter().for_each(|(q, u)| routine(&model, q, u));
                        *least = least.min(start.elapsed().as_secs_f64() * 1e6 / states.len() as f64);
                    }
                }
                let [shared, known_law, known_surface] = least;
                println!("{} {shared:.4} {known_law:.4} {known_surface:.4}", stringify!($module));
            )*
        }
    };
}

models! {
    two_sleds TwoSleds "../../../../models/two_sleds.mech" bc_ac collide_bc_ac:
        two_sleds_shared two_sleds_known_law two_sleds_known_surface;
    planar_double_pendulum PlanarDoublePendulum "../../../../models/planar_double_pendulum.mech" tip_wall collide_tip_wall:
        planar_double_pendulum_shared planar_double_pendulum_known_law planar_double_pendulum_known_surface;
    crossing_rails CrossingRails "../../../models/crossing_rails.mech" upper_lower collide_upper_lower:
        crossing_rails_shared crossing_rails_known_law crossing_rails_known_surface;
    askew_gantry AskewGantry "../../../models/askew_gantry.mech" tool_table collide_tool_table:
        askew_gantry_shared askew_gantry_known_law askew_gantry_known_surface;
    gantry Gantry "../../../models/gantry.mech" tool_table collide_tool_table:
        gantry_shared gantry_known_law gantry_known_surface;
    arm_7dof Arm7dof "../../../../models/arm_7dof.mech" tool_plane collide_tool_plane:
        arm_7dof_shared arm_7dof_known_law arm_7dof_known_surface;
}
