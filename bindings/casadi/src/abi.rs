//! Where numbers cross from C and to C. All that is `unsafe` here are copies between the caller's memory and
//! one slice of the work vector that the caller lends; everything else is safe code on that slice.

use std::borrow::Cow;
use std::cell::RefCell;
use std::ffi::{CString, c_char, c_int, c_longlong};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::{ptr, slice};

use hodograph::{Cause, StateError};

use crate::functions::Function;
use crate::layout::Layout;

/// CasADi's integer (`casadi_int`).
pub type Int = c_longlong;

/// The error code of CasADi's functions.
const FAILED: c_int = 1;

thread_local! {
    /// Why the last evaluation of this thread that failed did so.
    static WHY: RefCell<CString> = RefCell::default();
}

/// Keeps why an evaluation fails, and answers the error code.
fn failed(why: &str) -> c_int {
    let why = CString::new(why).unwrap_or_default();
    let _ = WHY.try_with(|kept| kept.replace(why));
    FAILED
}

/// Why the last evaluation of this thread that failed did so: the name of the cause, a colon, and words. Empty where
/// none failed. The text lasts until the next one that fails.
#[doc(hidden)]
pub fn last_error() -> *const c_char {
    WHY.try_with(|kept| kept.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}

/// Writes how long the arrays of arguments, results, integers and numbers must be that [`evaluate`] is lent;
/// nonzero where there is no such function.
///
/// # Safety
///
/// Each pointer is null or may be written to.
#[doc(hidden)]
pub unsafe fn work(layout: &Layout, sizes: [*mut Int; 4]) -> c_int {
    if let Some(reason) = &layout.refused {
        eprintln!("hodograph: {reason}");
        return FAILED;
    }
    let (inputs, outputs) = layout.sizes();
    let wanted = [layout.inputs.len(), layout.outputs.len(), 0, inputs + outputs];
    for (size, wanted) in sizes.into_iter().zip(wanted) {
        if !size.is_null() {
            // SAFETY: it is not null, so the caller lets us write to it.
            unsafe { size.write(wanted as Int) };
        }
    }
    0
}

/// Evaluates a function; nonzero where it has no answer, and results are then as they were.
///
/// # Safety
///
/// By CasADi's interface of external functions, with the sizes that [`work`] and the sparsities of `layout`
/// tell: `arg` is null or has a pointer for every input, each null (for zeros) or to as many doubles as the
/// input has entries; `res` likewise for outputs (null: not wanted), to doubles that may be written;
/// `w` is to as many doubles as [`work`] asks for, which may be written and overlap none of the others. None
/// is in use elsewhere during the call.
#[doc(hidden)]
pub unsafe fn evaluate<F: Function>(
    layout: &Layout,
    arg: *const *const f64,
    res: *const *mut f64,
    w: *mut f64,
) -> c_int {
    let (count, results) = layout.sizes();
    if let Some(reason) = &layout.refused {
        return failed(reason);
    }
    if w.is_null() || !w.is_aligned() {
        return failed("the work vector is null or not aligned");
    }
    // SAFETY: `w` may be written for `count + results` doubles and overlaps nothing else. They are set before
    // the slice over them is made, so it holds numbers; nobody else uses them until we return.
    let numbers = unsafe {
        ptr::write_bytes(w, 0, count + results);
        slice::from_raw_parts_mut(w, count + results)
    };
    let (inputs, outputs) = numbers.split_at_mut(count);
    let mut rest = &mut *inputs;
    for (index, block) in layout.inputs.iter().enumerate() {
        let (to, after) = rest.split_at_mut(block.size);
        rest = after;
        if arg.is_null() || block.size == 0 {
            continue;
        }
        // SAFETY: `arg` is not null, so it has a pointer for every input. That is null or to `block.size`
        // doubles, outside of the slice `to`, which has this length.
        unsafe {
            let from = *arg.add(index);
            if !from.is_null() {
                ptr::copy_nonoverlapping(from, to.as_mut_ptr(), block.size);
            }
        }
    }
    // A function may not read all of its inputs: a state that is not finite has no answer nevertheless.
    if let Some((name, index, value)) = not_finite(layout, inputs) {
        return failed(&format!(
            "{}: {name}[{index}] is {value}: it must be finite",
            Cause::NotFinite.name()
        ));
    }
    // The functions do not panic; if one did, nothing would leave this one but its error code.
    let (given, wanted) = (&*inputs, AssertUnwindSafe(&mut *outputs));
    let answered = catch_unwind(move || {
        let AssertUnwindSafe(wanted) = { wanted };
        F::evaluate(given, wanted)
    });
    let error = match answered {
        Ok(Ok(())) if outputs.iter().all(|number| number.is_finite()) => None,
        Ok(Ok(())) => Some(StateError::NotFinite),
        Ok(Err(error)) => Some(error),
        Err(_) => return failed("a fault of the library: please report it"),
    };
    if let Some(error) = error {
        return failed(&format!("{}: {error}", error.kind()));
    }
    let mut rest = &*outputs;
    for (index, block) in layout.outputs.iter().enumerate() {
        let (from, after) = rest.split_at(block.size);
        rest = after;
        if res.is_null() || block.size == 0 {
            continue;
        }
        // SAFETY: as for inputs, with memory that may be written.
        unsafe {
            let to = *res.add(index);
            if !to.is_null() {
                ptr::copy_nonoverlapping(from.as_ptr(), to, block.size);
            }
        }
    }
    0
}

/// The first of the inputs that is no finite number: the block, its place there, and the number.
fn not_finite<'a>(layout: &'a Layout, inputs: &[f64]) -> Option<(Cow<'a, str>, usize, f64)> {
    let mut rest = inputs;
    layout.inputs.iter().find_map(|block| {
        let (numbers, after) = rest.split_at(block.size.min(rest.len()));
        rest = after;
        let place = numbers.iter().position(|number| !number.is_finite())?;
        Some((block.name().to_string_lossy(), place, numbers[place]))
    })
}

#[cfg(test)]
mod tests {
    use std::ffi::CStr;
    use std::ptr::{null, null_mut};

    use super::*;
    use crate::layout::Layout;

    /// Sum of three numbers and the last; refuses sums below zero, panics above 100.
    struct Sums;

    impl Function for Sums {
        fn layout() -> Layout {
            Layout::of_vectors(&[("a", 2), ("b", 1)], &[("sum", 1), ("last", 1)])
        }

        fn evaluate(inputs: &[f64], outputs: &mut [f64]) -> Result<(), StateError> {
            outputs[0] = inputs.iter().sum();
            outputs[1] = inputs[2];
            assert!(outputs[0] < 100.0, "a panic, for a test");
            if outputs[0] < 0.0 { Err(StateError::NotFinite) } else { Ok(()) }
        }
    }

    /// What is answered for pointers to these numbers, and the results after the call.
    fn called(a: Option<&[f64; 2]>, b: Option<&[f64; 1]>, wants_sum: bool) -> (c_int, [f64; 2]) {
        let layout = Sums::layout();
        let mut sizes: [Int; 4] = [0; 4];
        let [arg, res, iw, w] = &mut sizes;
        // SAFETY: four numbers that may be written to.
        assert_eq!(unsafe { work(&layout, [arg, res, iw, w]) }, 0);
        assert_eq!(sizes, [2, 2, 0, 5]);
        let mut lent = [f64::NAN; 5];
        let (mut sum, mut last) = (7.0, 7.0);
        let arg = [a.map_or(null(), |a| a.as_ptr()), b.map_or(null(), |b| b.as_ptr())];
        let res = [if wants_sum { &raw mut sum } else { null_mut() }, &raw mut last];
        // SAFETY: two pointers each, null or to as many numbers as the layout has, and five numbers of work.
        let code = unsafe { evaluate::<Sums>(&layout, arg.as_ptr(), res.as_ptr(), lent.as_mut_ptr()) };
        (code, [sum, last])
    }

    #[test]
    fn numbers_go_in_and_out() {
        assert_eq!(called(Some(&[1.0, 2.0]), Some(&[3.0]), true), (0, [6.0, 3.0]));
    }

    #[test]
    fn no_argument_means_zeros_and_no_result_that_it_is_not_wanted() {
        assert_eq!(called(None, Some(&[3.0]), true), (0, [3.0, 3.0]));
        assert_eq!(called(Some(&[1.0, 2.0]), None, false), (0, [7.0, 0.0]));
    }

    #[test]
    fn errors_panics_and_numbers_that_are_none_give_the_error_code_and_no_result() {
        for b in [-9.0, 1000.0, f64::NAN, f64::INFINITY] {
            assert_eq!(called(Some(&[1.0, 2.0]), Some(&[b]), true), (FAILED, [7.0, 7.0]));
            // SAFETY: a text that ends with a zero, kept until the next failure of this thread.
            let why = unsafe { CStr::from_ptr(last_error()) }.to_str().unwrap();
            let expected = match b {
                -9.0 => {
                    "not_finite: a number of the state, or a result, is infinite or not a number: it must be finite"
                }
                1000.0 => "a fault of the library",
                b if b.is_nan() => "not_finite: b[0] is NaN: it must be finite",
                _ => "not_finite: b[0] is inf: it must be finite",
            };
            assert!(why.starts_with(expected), "{why}");
        }
    }

    struct Unread;

    impl Function for Unread {
        fn layout() -> Layout {
            Layout::of_vectors(&[("a", 1)], &[("one", 1)])
        }

        fn evaluate(_: &[f64], outputs: &mut [f64]) -> Result<(), StateError> {
            outputs[0] = 1.0;
            Ok(())
        }
    }

    #[test]
    fn inputs_that_are_not_read_must_be_finite_too() {
        for (a, expected) in [(2.0, (0, 1.0)), (f64::NAN, (FAILED, 7.0)), (f64::INFINITY, (FAILED, 7.0))] {
            let (mut lent, mut one) = ([0.0; 2], 7.0);
            let (arg, res) = ([&raw const a], [&raw mut one]);
            // SAFETY: a pointer each, to one number, and two numbers of work.
            let code = unsafe {
                evaluate::<Unread>(&Unread::layout(), arg.as_ptr(), res.as_ptr(), lent.as_mut_ptr())
            };
            assert_eq!((code, one), expected);
        }
    }

    #[test]
    fn what_is_refused_has_no_size_and_no_values() {
        let layout = Layout { refused: Some("for a test".into()), ..Sums::layout() };
        let mut lent = [0.0; 5];
        // SAFETY: null pointers are allowed; five numbers of work.
        let codes = unsafe {
            (work(&layout, [null_mut(); 4]), evaluate::<Sums>(&layout, null(), null(), lent.as_mut_ptr()))
        };
        assert_eq!(codes, (FAILED, FAILED));
    }

    #[test]
    fn a_jacobian_has_a_block_for_each_result_and_input() {
        let layout = Sums::layout().jacobian();
        let names = |blocks: &[crate::Block]| -> Vec<String> {
            blocks.iter().map(|block| block.name().to_string_lossy().into_owned()).collect()
        };
        assert_eq!(names(&layout.inputs), ["a", "b", "out_sum", "out_last"]);
        assert_eq!(names(&layout.outputs), ["jac_sum_a", "jac_sum_b", "jac_last_a", "jac_last_b"]);
        assert_eq!(layout.inputs[2].sparsity(), [1, 1, 0, 0]);
        assert_eq!(layout.outputs[0].sparsity(), [1, 2, 1]);
        assert_eq!(layout.sizes(), (3, 6));
    }
}
