//! The interface of the WebAssembly module: memory for a question, and the answer.
//!
//! The page calls `room(length)`, writes a question there, calls `ask(place, length)` and reads as many bytes
//! as that says at `answer()`. The module imports one function, `host.go_on(time)`: how far a motion is, and
//! whether to go on.

#![cfg(target_arch = "wasm32")]
#![allow(unsafe_code)]

use std::cell::RefCell;

thread_local! {
    static ANSWER: RefCell<String> = const { RefCell::new(String::new()) };
}

#[link(wasm_import_module = "host")]
unsafe extern "C" {
    safe fn go_on(time: f64) -> u32;
}

/// Room for a question of so many bytes.
#[unsafe(no_mangle)]
pub extern "C" fn room(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

/// Answers the question that stands at a place that `room` gave; the length of the answer.
///
/// # Safety
///
/// `place` and `length` are those of one call of `room`, and are given once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ask(place: *mut u8, length: usize) -> usize {
    // SAFETY: by the contract above this is the slice that `room` leaked.
    let bytes = unsafe { Box::from_raw(core::ptr::slice_from_raw_parts_mut(place, length)) };
    let text = crate::answer(&String::from_utf8_lossy(&bytes), &|time| go_on(time) != 0);
    ANSWER.with_borrow_mut(|answer| {
        *answer = text;
        answer.len()
    })
}

/// Where the last answer is, until the next question.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    ANSWER.with_borrow(|answer| answer.as_ptr())
}
