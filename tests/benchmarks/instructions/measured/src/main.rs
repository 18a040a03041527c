//! The program that valgrind executes: every routine of a shipped model once, or the solver over the nine
//! collisions of the paper and random ones.

#[macro_use]
mod answers;
mod specialised;

use std::hint::black_box;

use hodograph::{ComponentKind, Contacts, Law, State, Surface};

/// Numbers that a mechanism is called with, and room for what it answers.
struct Bench {
    coordinates: Vec<f64>,
    speeds: Vec<f64>,
    inputs: Vec<f64>,
    out: Vec<f64>,
}

impl Bench {
    /// The initial state; speeds that are 0 there are not, so that nothing is too easy.
    fn of(mechanism: &dyn Contacts) -> Bench {
        let [n, p, inputs] = [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input]
            .map(|kind| mechanism.count(kind));
        let mut bench = Bench {
            coordinates: vec![0.0; n],
            speeds: vec![0.0; p],
            inputs: vec![0.0; inputs],
            out: vec![0.0; n.max(p * p).max(3 * p)],
        };
        let _ = mechanism.initial_state(&mut bench.coordinates, &mut bench.speeds, &mut bench.inputs);
        for (i, speed) in bench.speeds.iter_mut().enumerate().filter(|(_, speed)| **speed == 0.0) {
            *speed = 0.3 * (1.0 + i as f64).sin();
        }
        bench.approach(mechanism);
        bench
    }

    /// Turns the motion round where the first contact separates.
    fn approach(&mut self, mechanism: &dyn Contacts) {
        let Bench { coordinates, speeds, inputs, .. } = self;
        let state = State { time: 0.0, coordinates, speeds, inputs };
        if mechanism.contact_velocity(0, &state).is_ok_and(|velocity| velocity.x > 0.0) {
            speeds.iter_mut().for_each(|speed| *speed = -*speed);
        }
    }
}

const SURFACE: Surface<f64> = Surface { mu: 0.3, e: 0.6, law: Law::Stronge };

macro_rules! models {
    ($($feature:literal $module:ident $type:ident,)*) => {
        $(mod $module {
            use super::{Bench, SURFACE, State, black_box};
            use hodograph::{Contacts, Mechanism};
            use hodograph_models::$module::$type;

            type Model = $type<f64>;

            /// A function that valgrind can tell from others, by its name.
            macro_rules! measured {
                ($name:ident, $mechanism:ident, $state:ident, $room:ident, $call:expr) => {
                    #[inline(never)]
                    fn $name($mechanism: &Model, $state: &State<'_>, $room: &mut [f64]) {
                        // so that the compiler does not make one function of two that do the same
                        black_box((module_path!(), stringify!($name)));
                        let _ = black_box($call);
                    }
                };
            }
            measured!(coordinate_rates, m, x, out, Mechanism::coordinate_rates(m, x, &mut out[..x.coordinates.len()]));
            measured!(accelerations, m, x, out, Mechanism::accelerations(m, x, &mut out[..x.speeds.len()]));
            measured!(mass_matrix, m, x, out, Mechanism::mass_matrix(m, x, &mut out[..x.speeds.len().pow(2)]));
            measured!(forcing, m, x, out, Mechanism::forcing(m, x, &mut out[..x.speeds.len()]));
            measured!(inverse_dynamics, m, x, out, Mechanism::inverse_dynamics(m, x, x.speeds, &mut out[..x.speeds.len()]));
            measured!(contact_state, m, x, _out, Contacts::contact_state(m, 0, x));
            measured!(response, m, x, out, Contacts::response(m, 0, x, &mut out[..3 * x.speeds.len()]));
            measured!(collide, m, x, out, Contacts::collide(m, 0, x, &SURFACE, &mut out[..x.speeds.len()]));
            measured!(contact_mode, m, x, out, Contacts::contact_mode(m, 0, x, &SURFACE, &mut out[..x.speeds.len()]));

            pub fn run() {
                let model = black_box(Model::default());
                let Bench { coordinates, speeds, inputs, mut out } = Bench::of(&model);
                let state = State { time: 0.0, coordinates: &coordinates, speeds: &speeds, inputs: &inputs };
                let state = black_box(&state);
                for routine in [
                    coordinate_rates, accelerations, mass_matrix, forcing, inverse_dynamics, contact_state, response, collide, contact_mode,
                ] {
                    routine(&model, state, &mut out);
                }
            }
        })*

        /// What can be measured, each in a run of its own: a name and what it runs.
        const SUBJECTS: &[(&str, fn())] = &[$(($feature, $module::run),)* ("sets", sets::run), ("solver", solver::run)];
    };
}

hodograph_models::every_mechanism!(models);

answers! {
    cart_5_link_answers cart_5_link Cart5Link 6 contact_matrices_tip_wall contact_matrices_tip_wall_into;
    arm_7dof_answers arm_7dof Arm7dof 7 contact_matrices_tool_plane contact_matrices_tool_plane_into;
    whipple_bicycle_answers whipple_bicycle WhippleBicycle 3 contact_matrices_kerb contact_matrices_kerb_into;
}

mod solver {
    use super::black_box;
    use hodograph_benchmark_impacts::{Case, METHODS};

    #[inline(never)]
    fn solve_nine(case: &Case) {
        exact(case);
    }

    #[inline(never)]
    fn solve_random(case: &Case) {
        // so that the compiler does not make one function of both
        black_box("random");
        exact(case);
    }

    fn exact(case: &Case) {
        for (_, _, method) in METHODS.iter().filter(|(_, name, _)| *name == "measured_exact") {
            let _ = black_box(method(case));
        }
    }

    pub fn run() {
        hodograph_benchmark_impacts::set("nine").iter().for_each(solve_nine);
        hodograph_benchmark_impacts::set("random").iter().for_each(solve_random);
    }
}

/// What a controller asks for, in one call and in one call each: for the arm and the bicycle, at their
/// initial states.
mod sets {
    use super::black_box;

    macro_rules! sets {
        ($($module:ident $type:ident $file:literal $contact:ident $together:ident $separately:ident,)*) => {
            $(
                hodograph::mechanism!($file, evaluate control(mass_matrix, forcing, accelerations, $contact));

                #[inline(never)]
                fn $together(m: &$module::$type<f64>, q: &$module::Coordinates<f64>, u: &$module::Speeds<f64>) {
                    black_box((module_path!(), stringify!($together)));
                    let _ = black_box(m.control(q, u));
                }

                #[inline(never)]
                fn $separately(m: &$module::$type<f64>, q: &$module::Coordinates<f64>, u: &$module::Speeds<f64>) {
                    black_box((module_path!(), stringify!($separately)));
                    let _ = black_box(m.mass_matrix(q));
                    let _ = black_box(m.forcing(q, u));
                    let _ = black_box(m.accelerations(q, u));
                    let _ = black_box(m.$contact(q));
                }
            )*

            pub fn run() {
                $(
                    let (m, q, u) = black_box((<$module::$type<f64>>::default(), $module::Coordinates::default(), $module::Speeds::default()));
                    $together(&m, &q, &u);
                    $separately(&m, &q, &u);
                )*
            }
        };
    }

    sets! {
        arm_7dof Arm7dof "../../../../models/arm_7dof.mech" contact_matrices_tool_plane arm_7dof_together arm_7dof_separately,
        four_bar FourBar "../../../../models/four_bar.mech" contact_matrices_coupler_wall four_bar_together four_bar_separately,
        whipple_bicycle WhippleBicycle "../../../../models/whipple_bicycle.mech" contact_matrices_kerb whipple_bicycle_together whipple_bicycle_separately,
    }
}

/// Runs the subject that is named, or tells the names of all. `specialised` runs specialised collisions, `times`
/// prints how long they take, `answers` runs routines by value and in place, `times_of_answers` prints how
/// long they take.
fn main() {
    match std::env::args().nth(1) {
        Some(name) if name == "specialised" => specialised::run(),
        Some(name) if name == "times" => specialised::times(),
        Some(name) if name == "answers" => run_answers(),
        Some(name) if name == "times_of_answers" => times_of_answers(),
        Some(name) => SUBJECTS.iter().filter(|(subject, _)| *subject == name).for_each(|(_, run)| run()),
        None => SUBJECTS.iter().for_each(|(subject, _)| println!("{subject}")),
    }
}
