//! RTIC 2: the controller is a local resource of the timer's interrupt; what it finds is shared with a task
//! of lower priority.

#![no_std]
#![no_main]

/// The application.
#[rtic::app(device = lm3s6965, peripherals = false)]
mod app {
    use core::hint::black_box;
    use cortex_m::peripheral::syst::SystClkSource;
    use shapes::Controller;
    use shapes::two_sleds::{Coordinates, Speeds};

    #[shared]
    struct Shared {
        predicted: Speeds<f32>,
    }

    #[local]
    struct Local {
        controller: Controller,
    }

    #[init]
    fn init(context: init::Context) -> (Shared, Local) {
        let mut timer = context.core.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(shapes::CLOCK / shapes::RATE - 1);
        timer.clear_current();
        timer.enable_counter();
        timer.enable_interrupt();
        (Shared { predicted: Speeds::default() }, Local { controller: Controller::default() })
    }

    #[task(binds = SysTick, priority = 2, local = [controller], shared = [predicted])]
    fn sample(mut context: sample::Context) {
        let (q, u) = (black_box(Coordinates::default()), black_box(Speeds::default()));
        if let Ok(speeds) = context.local.controller.sample(&q, &u) {
            context.shared.predicted.lock(|predicted| *predicted = speeds);
        }
    }

    #[idle(shared = [predicted])]
    fn idle(mut context: idle::Context) -> ! {
        loop {
            context.shared.predicted.lock(|predicted| {
                black_box(*predicted);
            });
        }
    }
}
