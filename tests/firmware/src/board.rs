//! Where a program runs: on a board in an emulator, which prints by semihosting, or on this machine.

/// Something that lines are written to.
pub use core::fmt::Write;

/// What a call cost: bytes of stack that were written to, where this can be told.
pub type Stack = Option<usize>;

#[cfg(not(target_os = "none"))]
mod here {
    /// The standard output.
    pub struct Output;

    impl core::fmt::Write for Output {
        fn write_str(&mut self, text: &str) -> core::fmt::Result {
            print!("{text}");
            Ok(())
        }
    }

    /// As on a board: an emulator of this machine's processor counts too.
    #[unsafe(no_mangle)]
    #[inline(never)]
    extern "C" fn mark_begin() {
        core::hint::black_box(0);
    }
    #[unsafe(no_mangle)]
    #[inline(never)]
    extern "C" fn mark_end() {
        core::hint::black_box([1, 2]);
    }

    /// Calls between the two marks.
    #[inline(never)]
    pub fn counted<R>(call: impl FnOnce() -> R) -> R {
        mark_begin();
        let answer = core::hint::black_box(call());
        mark_end();
        answer
    }

    /// Calls: nothing is measured on this machine.
    pub fn measured<R>(call: impl FnOnce() -> R) -> (R, super::Stack) {
        (call(), None)
    }

    /// Runs a program.
    pub fn run(program: impl FnOnce(&mut Output)) {
        program(&mut Output);
    }
}

#[cfg(target_os = "none")]
mod there {
    use core::hint::black_box;

    use cortex_m_semihosting::{debug, hio};

    /// The standard output of the emulator.
    pub struct Output(hio::HostStream);

    impl core::fmt::Write for Output {
        fn write_str(&mut self, text: &str) -> core::fmt::Result {
            self.0.write_all(text.as_bytes()).map_err(|()| core::fmt::Error)
        }
    }

    /// Stack that nobody has written to.
    const PAINT: u32 = 0xa5a5_5a5a;
    /// So much of it is painted, bytes.
    const PAINTED: usize = 64 * 1024;

    /// Between the calls of these two the emulator counts instructions. They differ, or the linker would make
    /// one of them.
    #[unsafe(no_mangle)]
    #[inline(never)]
    extern "C" fn mark_begin() {
        cortex_m::asm::nop();
    }
    #[unsafe(no_mangle)]
    #[inline(never)]
    extern "C" fn mark_end() {
        cortex_m::asm::nop();
        cortex_m::asm::nop();
    }

    /// A frame of its own, below that of the caller.
    #[inline(never)]
    fn apart<R>(call: impl FnOnce() -> R) -> R {
        call()
    }

    /// Calls between the two marks.
    #[inline(never)]
    pub fn counted<R>(call: impl FnOnce() -> R) -> R {
        mark_begin();
        let answer = black_box(apart(call));
        mark_end();
        answer
    }

    /// Calls, and tells how much stack was written to.
    #[inline(never)]
    pub fn measured<R>(call: impl FnOnce() -> R) -> (R, super::Stack) {
        let top = cortex_m::register::msp::read() as usize;
        let bottom = top - PAINTED;
        for at in (bottom..top - 8).step_by(4) {
            // SAFETY: below the stack pointer is free memory of the board; no interrupt uses it here.
            unsafe { (at as *mut u32).write_volatile(PAINT) };
        }
        mark_begin();
        let answer = black_box(apart(call));
        mark_end();
        // SAFETY: as above.
        let touched = |at: &usize| unsafe { (*at as *const u32).read_volatile() != PAINT };
        let first = (bottom..top).step_by(4).find(touched).unwrap_or(top);
        (answer, Some(top - first))
    }

    /// Runs a program and ends the emulation.
    pub fn run(program: impl FnOnce(&mut Output)) -> ! {
        if let Ok(out) = hio::hstdout() {
            program(&mut Output(out));
            debug::exit(debug::EXIT_SUCCESS);
        }
        debug::exit(debug::EXIT_FAILURE);
        loop {}
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        debug::exit(debug::EXIT_FAILURE);
        loop {}
    }
}

#[cfg(not(target_os = "none"))]
pub use here::{Output, counted, measured, run};
#[cfg(target_os = "none")]
pub use there::{Output, counted, measured, run};
