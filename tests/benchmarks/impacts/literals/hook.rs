//! The function that replaces a literal: returns its value, or the value times a factor if it is the literal under examination.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};

static WHICH: AtomicUsize = AtomicUsize::new(usize::MAX);
static FACTOR: AtomicU64 = AtomicU64::new(0);
static WORK: [AtomicU64; 4] = [const { AtomicU64::new(0) }; 4];

/// The literal with this number.
#[inline]
pub fn of(number: usize, value: f64) -> f64 {
    if WHICH.load(Relaxed) == number { value * f64::from_bits(FACTOR.load(Relaxed)) } else { value }
}

/// Multiplies a literal by a factor from now on, and all others by one.
pub fn set(number: usize, factor: f64) {
    WHICH.store(number, Relaxed);
    FACTOR.store(factor.to_bits(), Relaxed);
}

/// Counts a stretch, a short step, a block of the series or a direct integration of the work.
#[inline]
pub fn count(what: usize) {
    WORK[what].fetch_add(1, Relaxed);
}

/// The counts since the last call.
pub fn work() -> [u64; 4] {
    core::array::from_fn(|i| WORK[i].swap(0, Relaxed))
}
