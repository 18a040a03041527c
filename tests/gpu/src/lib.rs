//! Routines of shipped models as kernels: each thread answers for one state.
//!
//! States and answers are columns, component by component (`states[component * count + thread]`), so that
//! neighbouring threads read neighbouring numbers. An answer that does not exist is NaN: a caller on the host
//! asks the same routine there for the reason.
#![no_std]
#![feature(abi_ptx, stdarch_nvptx)]

use core::arch::nvptx::{_block_dim_x, _block_idx_x, _thread_idx_x};

use hodograph::{Contacts, Law, Mechanism, State, Surface};
use hodograph_models::{
    arm_7dof::Arm7dof, planar_double_pendulum::PlanarDoublePendulum, puma_560::Puma560, two_sleds::TwoSleds,
};

/// Nothing of ours panics; the language wants to know what would happen.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// The number of this thread among all.
fn thread() -> usize {
    // SAFETY: these read registers that every thread has.
    let [block, size, place] = unsafe { [_block_idx_x(), _block_dim_x(), _thread_idx_x()] };
    block as usize * size as usize + place as usize
}

/// Columns of `count` states in the memory of the device.
#[derive(Clone, Copy)]
struct Columns {
    first: *mut f64,
    count: usize,
}

impl Columns {
    /// The components of one state.
    ///
    /// # Safety
    ///
    /// There are `N` columns, and `thread` is less than their length.
    unsafe fn read<const N: usize>(self, thread: usize) -> [f64; N] {
        core::array::from_fn(|component| {
            // SAFETY: the caller's promise.
            unsafe { self.first.add(component * self.count + thread).read() }
        })
    }

    /// Writes the components of one state.
    ///
    /// # Safety
    ///
    /// That of [`Columns::read`]; no other thread writes this state.
    unsafe fn write<const N: usize>(self, thread: usize, values: [f64; N]) {
        for (component, value) in values.into_iter().enumerate() {
            // SAFETY: the caller's promise.
            unsafe { self.first.add(component * self.count + thread).write(value) };
        }
    }
}

/// Accelerations of `M` with N coordinates, P speeds and W inputs, which are zero.
unsafe fn accelerations<M: Mechanism<f64> + Default, const N: usize, const P: usize, const W: usize>(
    count: usize,
    [coordinates, speeds, rates]: [*mut f64; 3],
) {
    let thread = thread();
    if thread >= count {
        return;
    }
    let columns = |first| Columns { first, count };
    // SAFETY: the kernels' promise.
    let (q, u) = unsafe { (columns(coordinates).read::<N>(thread), columns(speeds).read::<P>(thread)) };
    let mut answer = [f64::NAN; P];
    let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[0.0; W] };
    if M::default().accelerations(&state, &mut answer).is_err() {
        answer = [f64::NAN; P];
    }
    // SAFETY: the kernels' promise.
    unsafe { columns(rates).write(thread, answer) };
}

/// Speeds after a collision of the first contact of `M`.
unsafe fn collide<M: Contacts<f64> + Default, const N: usize, const P: usize, const W: usize>(
    count: usize,
    surface: &Surface<f64>,
    [coordinates, speeds, after]: [*mut f64; 3],
) {
    let thread = thread();
    if thread >= count {
        return;
    }
    let columns = |first| Columns { first, count };
    // SAFETY: the kernels' promise.
    let (q, u) = unsafe { (columns(coordinates).read::<N>(thread), columns(speeds).read::<P>(thread)) };
    let mut answer = u;
    let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[0.0; W] };
    if M::default().collide(0, &state, surface, &mut answer).is_err() {
        answer = [f64::NAN; P];
    }
    // SAFETY: the kernels' promise.
    unsafe { columns(after).write(thread, answer) };
}

/// A kernel for accelerations, by its name, the mechanism, and the numbers of coordinates, speeds and inputs.
macro_rules! accelerations {
    ($($name:ident: $mechanism:ty, $n:literal, $p:literal, $w:literal;)*) => {$(
        /// Accelerations of `count` states.
        ///
        /// # Safety
        ///
        /// `q`, `u` and `rates` are columns of `count` numbers in the memory of the device.
        #[unsafe(no_mangle)]
        pub unsafe extern "ptx-kernel" fn $name(count: usize, q: *mut f64, u: *mut f64, rates: *mut f64) {
            // SAFETY: the caller's promise.
            unsafe { accelerations::<$mechanism, $n, $p, $w>(count, [q, u, rates]) };
        }
    )*};
}

/// A kernel for collisions.
macro_rules! collisions {
    ($($name:ident: $mechanism:ty, $n:literal, $p:literal, $w:literal;)*) => {$(
        /// Speeds after collisions of `count` states, by Stronge's hypothesis.
        ///
        /// # Safety
        ///
        /// `q`, `u` and `after` are columns of `count` numbers in the memory of the device.
        #[unsafe(no_mangle)]
        pub unsafe extern "ptx-kernel" fn $name(
            count: usize,
            mu: f64,
            e: f64,
            q: *mut f64,
            u: *mut f64,
            after: *mut f64,
        ) {
            let surface = Surface { mu, e, law: Law::Stronge };
            // SAFETY: the caller's promise.
            unsafe { collide::<$mechanism, $n, $p, $w>(count, &surface, [q, u, after]) };
        }
    )*};
}

accelerations! {
    accelerations_of_double_pendulum: PlanarDoublePendulum<f64>, 2, 2, 0;
    accelerations_of_two_sleds: TwoSleds<f64>, 6, 4, 0;
    accelerations_of_puma_560: Puma560<f64>, 6, 6, 6;
    accelerations_of_arm_7dof: Arm7dof<f64>, 7, 7, 0;
}

collisions! {
    collisions_of_double_pendulum: PlanarDoublePendulum<f64>, 2, 2, 0;
    collisions_of_two_sleds: TwoSleds<f64>, 6, 4, 0;
}
