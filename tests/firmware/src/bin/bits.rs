//! Every shipped model at 100 states and the reference collisions: one line per model, routine and type with
//! a digest of all bits. Two machines that print the same have computed the same.
//!
//! With the feature `double` in doubles, else in singles.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;

use firmware::bits::{Digest, Number};
use firmware::board::{Output, Write, measured, run};
use firmware::random::Random;
use firmware::shipped;
use hodograph::nalgebra::Vector3;
use hodograph::{ComponentKind, Contacts, Law, ReducedMatrix, State, Surface, solve};

/// States per model.
const STATES: u32 = 100;
/// More coordinates, speeds or inputs than any shipped model has.
const MOST: usize = 16;

#[cfg(feature = "double")]
type Chosen = f64;
#[cfg(not(feature = "double"))]
type Chosen = f32;

type Case = ([f64; 6], [f64; 3], f64, f64, Law);
static CASES: &[Case] = &include!(concat!(env!("OUT_DIR"), "/cases.rs"));

/// Name, digest, and the most stack of a call.
#[derive(Default)]
struct Line {
    digest: Digest,
    calls: u32,
    stack: usize,
}

impl Line {
    /// Calls a routine that answers by a slice and returns other numbers; measures it and takes its bits in.
    fn call<T: Number, E>(&mut self, out: &mut [T], call: impl FnOnce(&mut [T]) -> Result<Vector3<T>, E>) {
        out.fill(T::zero());
        self.calls += 1;
        let (answer, stack) = measured(|| call(out));
        self.stack = self.stack.max(stack.unwrap_or(0));
        match answer {
            Ok(rest) => {
                self.digest.take(out);
                self.digest.take(rest.as_slice());
            }
            Err(_) => self.digest.error(),
        }
    }

    fn print<T: Number>(&self, output: &mut Output, model: &str, routine: &str) {
        let Digest { numbers, errors, .. } = self.digest;
        let (name, value) = (T::NAME, self.digest.value());
        let _ = writeln!(
            output,
            "{model}\t{routine}\t{name}\t{numbers}\t{errors}\t{value:016x}\t{}\t{}",
            self.calls, self.stack
        );
    }
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
    let mut random = Random::new(n as u64 + 100 * p as u64);
    let (mut accelerations, mut collide, mut mode) = (Line::default(), Line::default(), Line::default());
    for number in 0..STATES {
        let mut near = |from: &[T; MOST], size: f64| from.map(|x| x + T::of(size * random.number()));
        let (mut q, u, w) = (near(&q0, 0.5), near(&u0, 2.0), near(&w0, 1.0));
        let _ = mechanism.normalise(&mut q[..n]);
        let time = T::of(random.number());
        let (mu, e) = (T::of(0.75 + 0.75 * random.number()), T::of(0.5 + 0.5 * random.number()));
        let law = [Law::Newton, Law::Poisson, Law::Stronge][number as usize % 3];
        let surface = Surface { mu, e, law };
        let mut speeds = u;
        let ahead = State { time, coordinates: &q[..n], speeds: &u[..p], inputs: &w[..inputs] };
        if mechanism.contact_velocity(0, &ahead).is_ok_and(|velocity| velocity.x > zero) {
            speeds = u.map(|u| -u);
        }
        let state = black_box(State { speeds: &speeds[..p], ..ahead });
        let mut out = [zero; MOST];
        accelerations
            .call(&mut out[..p], |out| mechanism.accelerations(&state, out).map(|()| Vector3::zeros()));
        collide.call(&mut out[..p], |out| {
            mechanism.collide(0, &state, &surface, out).map(|hit| hit.impulse_on_point)
        });
        mode.call(&mut out[..p], |out| {
            mechanism.contact_mode(0, &state, &surface, out).map(|_| Vector3::zeros())
        });
    }
    let name = mechanism.name();
    accelerations.print::<T>(output, name, "accelerations");
    collide.print::<T>(output, name, "collide");
    mode.print::<T>(output, name, "contact_mode");
}

#[inline(never)]
fn reference<T: Number>(output: &mut Output) {
    let mut line = Line::default();
    for (m, v, mu, e, law) in CASES {
        let m = ReducedMatrix::<T>::from(m.map(T::of));
        let v = Vector3::from(v.map(T::of));
        let surface = black_box(Surface { mu: T::of(*mu), e: T::of(*e), law: *law });
        let mut out = [T::zero(); 3];
        line.call(&mut out, |out| {
            solve(&m, &v, &surface).map(|hit| {
                out.copy_from_slice(hit.impulse.as_slice());
                hit.velocity
            })
        });
    }
    line.print::<T>(output, "reference collisions", "solve");
}

fn program(output: &mut Output) {
    reference::<Chosen>(output);
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
