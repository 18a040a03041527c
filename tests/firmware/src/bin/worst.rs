//! Every routine of every shipped model at random states, many of them hard, and the solver within several
//! budgets: the emulator counts the instructions of each call. A line says how many calls of a routine there
//! were.
//!
//! On this machine all states are called, as many as `HODOGRAPH_STATES` says; on a board those that were
//! chosen here, named in the file `HODOGRAPH_CHOSEN` when the program was built. A state depends on its
//! number alone.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;

use firmware::bits::Number;
use firmware::board::{Output, Write, counted, run};
use firmware::hard;
use firmware::random::Random;
use firmware::shipped;
use hodograph::nalgebra::{Matrix3, Vector3};
use hodograph::{ComponentKind, Contacts, ReducedMatrix, State, Surface, solve};

/// More coordinates, speeds or inputs than any shipped model has.
const MOST: usize = 16;
/// Budgets of the solver alone, in quadratures; the last is none.
const BUDGETS: [(u32, &str); 10] = [
    (0, "0"),
    (1, "1"),
    (2, "2"),
    (3, "3"),
    (4, "4"),
    (6, "6"),
    (8, "8"),
    (12, "12"),
    (24, "24"),
    (u32::MAX, "none"),
];

#[cfg(feature = "double")]
type Chosen = f64;
#[cfg(not(feature = "double"))]
type Chosen = f32;

/// States chosen for a routine: what it belongs to, the routine, their numbers.
#[cfg(target_os = "none")]
type Choice = (&'static str, &'static str, &'static [u32]);
#[cfg(target_os = "none")]
static CHOSEN: &[Choice] = include!(concat!(env!("OUT_DIR"), "/chosen.rs"));

/// The numbers of the states at which a routine is called.
#[cfg(target_os = "none")]
fn numbers(name: &str, routine: &str) -> impl Iterator<Item = u32> + use<> {
    let mut chosen = CHOSEN.iter().filter(|entry| entry.0 == name && entry.1 == routine);
    chosen.next().map_or(&[][..], |entry| entry.2).iter().copied()
}
#[cfg(not(target_os = "none"))]
fn numbers(_: &str, _: &str) -> impl Iterator<Item = u32> + use<> {
    let many = std::env::var("HODOGRAPH_STATES").ok().and_then(|text| text.parse().ok());
    0..many.unwrap_or(1000)
}

/// Random numbers of one state.
fn of_state(seed: u64, number: u32) -> Random {
    Random::new(seed.wrapping_add(u64::from(number + 1).wrapping_mul(0xd134_2543_de82_ef95)))
}

#[inline(never)]
fn mechanism<T: Number>(output: &mut Output, mechanism: &dyn Contacts<T>) {
    let zero = T::zero();
    let [n, p, inputs] = [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input]
        .map(|kind| mechanism.count(kind));
    let (mut q0, mut u0, mut w0) = ([zero; MOST], [zero; MOST], [zero; MOST]);
    if mechanism.initial_state(&mut q0[..n], &mut u0[..p], &mut w0[..inputs]).is_err() {
        return;
    }
    for routine in ["accelerations", "collide", "contact_mode"] {
        let mut calls = 0;
        for number in numbers(mechanism.name(), routine) {
            let mut random = of_state(n as u64 + 100 * p as u64, number);
            let family = number % hard::FAMILIES;
            // Far angles are reduced in more digits.
            let far = if family == 7 { 1000.0 } else { 0.5 };
            let mut near = |from: &[T; MOST], size: f64| from.map(|x| x + T::of(size * random.number()));
            let (mut q, u, w) = (near(&q0, far), near(&u0, 2.0), near(&w0, 1.0));
            let _ = mechanism.normalise(&mut q[..n]);
            let time = T::of(random.number());
            let ahead = State { time, coordinates: &q[..n], speeds: &u[..p], inputs: &w[..inputs] };
            let (speeds, surface) = struck(&mut random, family, mechanism, &ahead);
            let state = black_box(State { speeds: &speeds[..p], ..ahead });
            let mut out = [zero; MOST];
            let out = &mut out[..p];
            let _ = match routine {
                "accelerations" => counted(|| mechanism.accelerations(&state, out).is_ok()),
                "collide" => counted(|| mechanism.collide(0, &state, &surface, out).is_ok()),
                _ => counted(|| mechanism.contact_mode(0, &state, &surface, out).is_ok()),
            };
            calls += 1;
        }
        let _ = writeln!(output, "{}\t{routine}\t{calls}", mechanism.name());
    }
}

/// Speeds with which the contact approaches as its family says, and the surface.
fn struck<T: Number>(
    random: &mut Random,
    family: u32,
    mechanism: &dyn Contacts<T>,
    state: &State<'_, T>,
) -> ([T; MOST], Surface<T>) {
    let mut speeds = [T::zero(); MOST];
    speeds[..state.speeds.len()].copy_from_slice(state.speeds);
    let mut response = [T::zero(); 3 * MOST];
    let known = mechanism.contact_state(0, state);
    let (matrix, v) = match &known {
        Ok(contact) => (contact.reduced, contact.velocity),
        Err(_) => (
            ReducedMatrix::from([T::one(), T::zero(), T::zero(), T::one(), T::zero(), T::one()]),
            -Vector3::x(),
        ),
    };
    let doubles = |number: T| number.to_subset().unwrap_or(0.0);
    let entries: [T; 6] = matrix.into();
    let v = v.map(doubles);
    let ordinary = if v.x > 0.0 { -v } else { v };
    let (aim, surface) = hard::case(random, family, &ReducedMatrix::from(entries.map(doubles)), &ordinary);
    if v.x > 0.0 {
        speeds = speeds.map(|u| -u);
    }
    let change = (aim - ordinary).map(T::of);
    if family >= 4
        && mechanism.response(0, state, &mut response[..3 * state.speeds.len()]).is_ok()
        && let Some(inverse) = Matrix3::from(matrix).try_inverse()
    {
        let impulse = inverse * change;
        for (u, row) in speeds.iter_mut().zip(response.chunks_exact(3)) {
            *u += row[0] * impulse.x + row[1] * impulse.y + row[2] * impulse.z;
        }
    }
    (speeds, Surface { mu: T::of(surface.mu), e: T::of(surface.e), law: surface.law })
}

/// The solver alone, on contacts of all families, within each budget.
#[inline(never)]
fn alone<T: Number>(output: &mut Output) {
    for (budget, name) in BUDGETS {
        let mut calls = 0;
        for number in numbers("solve", name) {
            let mut random = of_state(16, number);
            let (matrix, ordinary) = hard::contact(&mut random);
            let (v, surface) = hard::case(&mut random, number % hard::FAMILIES, &matrix, &ordinary);
            let entries: [f64; 6] = matrix.into();
            let matrix = black_box(ReducedMatrix::from(entries.map(T::of)));
            let (v, surface) =
                (v.map(T::of), Surface { mu: T::of(surface.mu), e: T::of(surface.e), law: surface.law });
            let surface = black_box(surface.with_budget(budget));
            let _ = counted(|| solve(&matrix, &v, &surface).is_ok());
            calls += 1;
        }
        let _ = writeln!(output, "solve\t{name}\t{calls}");
    }
}

fn program(output: &mut Output) {
    alone::<Chosen>(output);
    shipped!(mechanism, Chosen, output);
}

#[cfg(not(target_os = "none"))]
fn main() {
    run(program);
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    run(program)
}
