//! A controller in an interrupt of 1 kHz that juggles a ball: in singles, or in doubles with the feature
//! `double`. The machine itself runs beside it, in doubles and with other parameters; while it moves the
//! clock stands.
//!
//! Prints each top of the ball's flight, a digest of the motion, and, on a board, deadlines that were missed
//! and the longest time that a sample took.

#![cfg_attr(target_os = "none", no_std, no_main)]

use firmware::bits::{Digest, Number};
use firmware::board::{Output, Write, run};
use firmware::juggling::control::Control;
use firmware::juggling::juggler::{Coordinates, Inputs, Juggler, Speeds};
use firmware::juggling::plant::Plant;
use firmware::juggling::trial;

#[cfg(feature = "double")]
type Chosen = f64;
#[cfg(not(feature = "double"))]
type Chosen = f32;

/// Samples per second.
const RATE: u32 = 1000;

/// What the interrupt reads, works with and writes.
struct Shared {
    control: Control<Chosen>,
    coordinates: Coordinates<Chosen>,
    speeds: Speeds<Chosen>,
    height: Chosen,
    inputs: Inputs<Chosen>,
}

impl Shared {
    fn sample(&mut self) {
        self.inputs = self.control.act(&self.coordinates, &self.speeds, self.height);
    }
}

fn program(output: &mut Output) {
    let (parameters, surface) = trial::truth();
    let (coordinates, speeds) = trial::start();
    let Ok(juggler) = Juggler::new(parameters) else { return };
    let mut plant = Plant { juggler, surface, coordinates, speeds };
    let of = <Chosen as Number>::of;
    let sensed = |plant: &Plant<f64>| {
        let coordinates = <[f64; 10]>::from(plant.coordinates).map(of);
        let speeds = <[f64; 9]>::from(plant.speeds).map(of);
        (Coordinates::from(coordinates), Speeds::from(speeds))
    };
    let (coordinates, speeds) = sensed(&plant);
    let (control, zero) = (trial::control(), of(0.0));
    let inputs = Inputs { lift: zero, ta: zero, tb: zero };
    let mut clock =
        clock::Clock::new(Shared { control, coordinates, speeds, height: of(trial::command(0.0)), inputs });
    let mut digest = Digest::default();
    let samples = trial::UNTIL as u32 * RATE;
    for sample in 0..samples {
        let time = f64::from(sample) / f64::from(RATE);
        let (coordinates, speeds) = sensed(&plant);
        let inputs = clock.period(|shared| {
            (shared.coordinates, shared.speeds, shared.height) =
                (coordinates, speeds, of(trial::command(time)));
        });
        let forces = <[Chosen; 3]>::from(inputs).map(f64::from);
        digest.take(&forces);
        let before = plant.speeds.uz;
        if plant.advance(&Inputs::from(forces), 1.0 / f64::from(RATE)).is_err() {
            let _ = writeln!(output, "{time:.3}\tthe plant has no further motion");
            return;
        }
        if before > 0.0 && plant.speeds.uz <= 0.0 {
            let Coordinates { x, y, z, .. } = plant.coordinates;
            let _ = writeln!(
                output,
                "{time:.3}\t{z:.4}\t{:.1}\t{:.1}\t{:.1}",
                trial::command(time),
                1e3 * x,
                1e3 * y
            );
        }
    }
    let _ = writeln!(output, "digest\t{}\t{:016x}", digest.numbers, digest.value());
    clock.report(output, samples);
}

/// The clock of this machine stands: nothing is measured.
#[cfg(not(target_os = "none"))]
mod clock {
    use super::{Chosen, Inputs, Output, Shared};

    pub struct Clock(Shared);

    impl Clock {
        pub fn new(shared: Shared) -> Self {
            Clock(shared)
        }
        pub fn period(&mut self, sense: impl FnOnce(&mut Shared)) -> Inputs<Chosen> {
            sense(&mut self.0);
            self.0.sample();
            self.0.inputs
        }
        pub fn report(&self, _: &mut Output, _: u32) {}
    }
}

/// The system timer of the board.
#[cfg(target_os = "none")]
mod clock {
    use core::cell::RefCell;

    use cortex_m::interrupt::{self, Mutex};
    use cortex_m::peripheral::SYST;
    use cortex_m::peripheral::syst::SystClkSource;
    use cortex_m_rt::exception;

    use super::{Chosen, Inputs, Output, RATE, Shared, Write};

    /// Ticks of the timer per second on the boards `mps2-an386` and `mps2-an500`.
    const TICKS: u32 = 25_000_000;

    struct Board {
        timer: SYST,
        shared: Shared,
        /// whether the sample of this period is done
        done: bool,
        /// samples that took longer than a period
        missed: u32,
        /// ticks of the longest sample
        longest: u32,
    }

    static BOARD: Mutex<RefCell<Option<Board>>> = Mutex::new(RefCell::new(None));

    fn with<R>(act: impl FnOnce(&mut Board) -> R) -> Option<R> {
        interrupt::free(|section| BOARD.borrow(section).try_borrow_mut().ok()?.as_mut().map(act))
    }

    /// The control loop: once per period.
    #[exception]
    fn SysTick() {
        with(|board| {
            let _ = board.timer.has_wrapped();
            board.shared.sample();
            let used = TICKS / RATE - 1 - SYST::get_current();
            let late = board.timer.has_wrapped();
            board.missed += u32::from(late);
            board.longest = board.longest.max(if late { TICKS / RATE } else { used });
            board.done = true;
        });
    }

    pub struct Clock;

    impl Clock {
        pub fn new(shared: Shared) -> Self {
            if let Some(peripherals) = cortex_m::Peripherals::take() {
                let mut timer = peripherals.SYST;
                timer.set_clock_source(SystClkSource::Core);
                timer.set_reload(TICKS / RATE - 1);
                timer.enable_interrupt();
                let board = Board { timer, shared, done: false, missed: 0, longest: 0 };
                interrupt::free(|section| {
                    if let Ok(mut place) = BOARD.borrow(section).try_borrow_mut() {
                        *place = Some(board);
                    }
                });
            }
            Clock
        }

        /// Lets the clock run until the interrupt has been served.
        pub fn period(&mut self, sense: impl FnOnce(&mut Shared)) -> Inputs<Chosen> {
            with(|board| {
                sense(&mut board.shared);
                board.done = false;
                board.timer.clear_current();
                board.timer.enable_counter();
            });
            while !with(|board| board.done).unwrap_or(true) {
                cortex_m::asm::nop();
            }
            let none = Inputs { lift: 0.0, ta: 0.0, tb: 0.0 };
            with(|board| {
                board.timer.disable_counter();
                board.shared.inputs
            })
            .unwrap_or(none)
        }

        pub fn report(&self, output: &mut Output, samples: u32) {
            with(|board| {
                let period = TICKS / RATE;
                let share = 100.0 * f64::from(board.longest) / f64::from(period);
                let missed = board.missed;
                let _ = writeln!(
                    output,
                    "deadlines\t{missed} of {samples} missed\tlongest sample {share:.1} % of a period"
                );
            });
        }
    }
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
