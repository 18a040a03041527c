//! embassy: the timer's interrupt signals, and a task that waits for it runs the controller.

#![no_std]
#![no_main]

use core::hint::black_box;

use cortex_m::peripheral::syst::SystClkSource;
use embassy_executor::Spawner;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
// The vectors of the device.
use lm3s6965 as _;
use shapes::Controller;
use shapes::two_sleds::{Coordinates, Speeds};

static TICK: Signal<CriticalSectionRawMutex, ()> = Signal::new();
static PREDICTED: Signal<CriticalSectionRawMutex, Speeds<f32>> = Signal::new();

#[cortex_m_rt::exception]
fn SysTick() {
    TICK.signal(());
}

#[embassy_executor::task]
async fn control() {
    let mut controller = Controller::default();
    loop {
        TICK.wait().await;
        let (q, u) = (black_box(Coordinates::default()), black_box(Speeds::default()));
        if let Ok(speeds) = controller.sample(&q, &u) {
            PREDICTED.signal(speeds);
        }
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    if let Some(core) = cortex_m::Peripherals::take() {
        let mut timer = core.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(shapes::CLOCK / shapes::RATE - 1);
        timer.clear_current();
        timer.enable_counter();
        timer.enable_interrupt();
    }
    if spawner.spawn(control()).is_ok() {
        loop {
            black_box(PREDICTED.wait().await);
        }
    }
}
