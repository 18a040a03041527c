//! The functions that C calls. The only `unsafe` parts are slices over the caller's memory, its callback, and
//! the boxes behind its pointers; everything else is safe code on an [`Instance`].
//!
//! Names and arguments are those of `fmi3FunctionTypes.h`.

#![allow(non_snake_case, clippy::missing_safety_doc, clippy::too_many_arguments)]

use std::ffi::{CStr, CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::{null, null_mut};
use std::slice;

use hodograph::Contacts;

use crate::instance::{Instance, Kind, Refusal};
use crate::layout::Defaults;

/// `fmi3Status`.
pub type Status = i32;
const OK: Status = 0;
const ERROR: Status = 3;

/// `fmi3LogMessageCallback`.
pub type Log = Option<unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char)>;

/// A unit with the callback for its errors.
pub struct Unit {
    instance: Instance,
    environment: *mut c_void,
    log: Log,
}

impl Unit {
    fn tell(&self, message: &str) {
        tell(self.environment, self.log, message);
    }
}

fn tell(environment: *mut c_void, log: Log, message: &str) {
    // Messages contain no zero byte, except in names that the caller gave.
    let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
    if let Some(log) = log {
        // SAFETY: the importer's own function, called as the standard says: texts end with a zero and live through the call.
        unsafe { log(environment, ERROR, c"logStatusError".as_ptr(), text.as_ptr()) };
    }
}

/// Runs safe code on a unit; returns the status and reports an error. A panic, which would be a fault of this
/// library, is caught here.
///
/// # Safety
///
/// `unit` is null or a pointer from [`instantiate`], not freed, and not in use elsewhere.
unsafe fn on(unit: *mut c_void, work: impl FnOnce(&mut Instance) -> Result<(), Refusal>) -> Status {
    // SAFETY: by the condition of this function.
    let Some(unit) = (unsafe { unit.cast::<Unit>().as_mut() }) else { return ERROR };
    let instance = &mut unit.instance;
    match catch_unwind(AssertUnwindSafe(|| work(instance))) {
        Ok(Ok(())) => OK,
        Ok(Err(Refusal(message))) => {
            unit.tell(&message);
            ERROR
        }
        Err(_) => {
            unit.tell("a fault of the unit: please report it");
            ERROR
        }
    }
}

/// A slice over memory of the caller, empty if the pointer is null.
///
/// # Safety
///
/// `pointer` is null or points to this number of values, which nobody changes while the slice lives.
unsafe fn given<'a, T>(pointer: *const T, count: usize) -> &'a [T] {
    if pointer.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: by the condition of this function.
    unsafe { slice::from_raw_parts(pointer, count) }
}

/// A mutable slice over memory of the caller.
///
/// # Safety
///
/// `pointer` is null or points to this number of values, which nobody else uses while the slice lives.
unsafe fn wanted<'a, T>(pointer: *mut T, count: usize) -> &'a mut [T] {
    if pointer.is_null() || count == 0 {
        return &mut [];
    }
    // SAFETY: by the condition of this function.
    unsafe { slice::from_raw_parts_mut(pointer, count) }
}

/// Creates a unit; null if the token belongs to another unit, or the motion cannot start in the state of the
/// model.
///
/// # Safety
///
/// `token` is null or a text that ends with a zero byte; `log` is null or the importer's function.
pub unsafe fn instantiate(
    make: fn() -> Box<dyn Contacts<f64>>,
    defaults: Defaults,
    own: &str,
    kind: Kind,
    token: *const c_char,
    environment: *mut c_void,
    log: Log,
) -> *mut c_void {
    // SAFETY: by the condition of this function.
    let same = !token.is_null() && unsafe { CStr::from_ptr(token) }.to_bytes() == own.as_bytes();
    if !same {
        tell(environment, log, "the instantiation token is that of another unit");
        return null_mut();
    }
    let made = catch_unwind(|| Instance::new(make, defaults, kind));
    match made {
        Ok(Ok(instance)) => Box::into_raw(Box::new(Unit { instance, environment, log })).cast(),
        Ok(Err(Refusal(message))) => {
            tell(environment, log, &message);
            null_mut()
        }
        Err(_) => {
            tell(environment, log, "a fault of the unit: please report it");
            null_mut()
        }
    }
}

/// Reports that a function is not offered.
///
/// # Safety
///
/// As for every call on a unit: `unit` is null or a pointer from [`instantiate`], not freed, and not in use
/// elsewhere.
pub unsafe fn not_offered(unit: *mut c_void, name: &str) -> Status {
    // SAFETY: by the condition of this function.
    unsafe { on(unit, |_| Err(Refusal(format!("{name} is not offered by this unit")))) }
}

pub fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

pub unsafe fn fmi3SetDebugLogging(
    unit: *mut c_void,
    _on: bool,
    _count: usize,
    _categories: *const *const c_char,
) -> Status {
    // Errors are always reported, and nothing else is.
    // SAFETY: the importer's unit.
    unsafe { on(unit, |_| Ok(())) }
}

pub unsafe fn fmi3FreeInstance(unit: *mut c_void) {
    if !unit.is_null() {
        // SAFETY: the importer gives back what `instantiate` made, and does not use it any more.
        drop(unsafe { Box::from_raw(unit.cast::<Unit>()) });
    }
}

pub unsafe fn fmi3EnterInitializationMode(
    unit: *mut c_void,
    _has_tolerance: bool,
    _tolerance: f64,
    start: f64,
    _has_stop: bool,
    _stop: f64,
) -> Status {
    // The tolerance of the importer, often 1e-4, is ignored, since it would silently change results: the
    // tolerance of the unit is one of its parameters.
    // SAFETY: the importer's unit.
    unsafe { on(unit, |instance| instance.enter_initialization(start)) }
}

/// Functions without arguments.
macro_rules! plain {
    ($($name:ident => $method:ident;)*) => {
        $(pub unsafe fn $name(unit: *mut c_void) -> Status {
            // SAFETY: the importer's unit.
            unsafe { on(unit, |instance| instance.$method().map(drop)) }
        })*
    };
}

plain! {
    fmi3ExitInitializationMode => exit_initialization;
    fmi3EnterEventMode => enter_event_mode;
    fmi3EnterContinuousTimeMode => enter_continuous_time;
    fmi3Terminate => terminate;
}

pub unsafe fn fmi3Reset(unit: *mut c_void) -> Status {
    // SAFETY: the importer's unit.
    unsafe {
        on(unit, |instance| {
            instance.reset();
            Ok(())
        })
    }
}

pub unsafe fn fmi3EvaluateDiscreteStates(unit: *mut c_void) -> Status {
    // Outputs are computed from the state when they are read.
    // SAFETY: the importer's unit.
    unsafe { on(unit, |_| Ok(())) }
}

/// Getters and setters of a type.
macro_rules! values {
    ($($get:ident $set:ident $type:ty => $read:ident $write:ident;)*) => {
        $(pub unsafe fn $get(
            unit: *mut c_void,
            references: *const u32,
            count: usize,
            values: *mut $type,
            room: usize,
        ) -> Status {
            // SAFETY: the importer's unit and arrays, as long as it says.
            unsafe { on(unit, |instance| instance.$read(given(references, count), wanted(values, room))) }
        }

        pub unsafe fn $set(
            unit: *mut c_void,
            references: *const u32,
            count: usize,
            values: *const $type,
            room: usize,
        ) -> Status {
            // SAFETY: the importer's unit and arrays, as long as it says.
            unsafe { on(unit, |instance| instance.$write(given(references, count), given(values, room))) }
        })*
    };
}

values! {
    fmi3GetFloat64 fmi3SetFloat64 f64 => floats set_floats;
    fmi3GetInt64 fmi3SetInt64 i64 => integers set_integers;
}

pub unsafe fn fmi3UpdateDiscreteStates(
    unit: *mut c_void,
    again: *mut bool,
    terminates: *mut bool,
    nominals_changed: *mut bool,
    states_changed: *mut bool,
    has_next: *mut bool,
    next: *mut f64,
) -> Status {
    let work = |instance: &mut Instance| {
        let updated = instance.update_discrete_states()?;
        // SAFETY: each pointer of the importer is null or to one value.
        unsafe {
            wanted(again, 1).fill(false);
            wanted(terminates, 1).fill(updated.terminates);
            wanted(nominals_changed, 1).fill(false);
            wanted(states_changed, 1).fill(updated.states_changed);
            wanted(has_next, 1).fill(updated.next_time.is_some());
            wanted(next, 1).fill(updated.next_time.unwrap_or(0.0));
        }
        Ok(())
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3CompletedIntegratorStep(
    unit: *mut c_void,
    _no_return: bool,
    enter_event_mode: *mut bool,
    terminate: *mut bool,
) -> Status {
    let work = |instance: &mut Instance| {
        instance.step_completed()?;
        // SAFETY: each pointer of the importer is null or to one value.
        unsafe {
            wanted(enter_event_mode, 1).fill(false);
            wanted(terminate, 1).fill(false);
        }
        Ok(())
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3SetTime(unit: *mut c_void, time: f64) -> Status {
    // SAFETY: the importer's unit.
    unsafe { on(unit, |instance| instance.set_time(time)) }
}

pub unsafe fn fmi3SetContinuousStates(unit: *mut c_void, states: *const f64, count: usize) -> Status {
    // SAFETY: the importer's unit and array.
    unsafe { on(unit, |instance| instance.set_states(given(states, count))) }
}

/// Arrays of a fixed length.
macro_rules! arrays {
    ($($name:ident => $method:ident;)*) => {
        $(pub unsafe fn $name(unit: *mut c_void, values: *mut f64, count: usize) -> Status {
            // SAFETY: the importer's unit and array.
            unsafe { on(unit, |instance| instance.$method(wanted(values, count))) }
        })*
    };
}

arrays! {
    fmi3GetContinuousStates => states;
    fmi3GetContinuousStateDerivatives => rates;
    fmi3GetEventIndicators => indicators;
}

pub unsafe fn fmi3GetNominalsOfContinuousStates(unit: *mut c_void, values: *mut f64, count: usize) -> Status {
    let work = |instance: &mut Instance| {
        let [_, coordinates, speeds, _] = &instance.layout().start;
        if count != coordinates.len() + speeds.len() {
            return Err(Refusal(format!("there are {} states", coordinates.len() + speeds.len())));
        }
        // SAFETY: the importer's array, as long as it says.
        unsafe { wanted(values, count).fill(1.0) };
        Ok(())
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3GetNumberOfEventIndicators(unit: *mut c_void, count: *mut usize) -> Status {
    let work = |instance: &mut Instance| {
        // SAFETY: the importer's number.
        unsafe { wanted(count, 1).fill(instance.layout().indicators.len()) };
        Ok(())
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3GetNumberOfContinuousStates(unit: *mut c_void, count: *mut usize) -> Status {
    let work = |instance: &mut Instance| {
        let [_, coordinates, speeds, _] = &instance.layout().start;
        // SAFETY: the importer's number.
        unsafe { wanted(count, 1).fill(coordinates.len() + speeds.len()) };
        Ok(())
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3DoStep(
    unit: *mut c_void,
    from: f64,
    step: f64,
    _no_set: bool,
    event_handling: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last_time: *mut f64,
) -> Status {
    let work = |instance: &mut Instance| {
        let done = instance.do_step(from, step);
        // SAFETY: each pointer of the importer is null or to one value.
        unsafe {
            wanted(event_handling, 1).fill(false);
            wanted(terminate, 1).fill(false);
            wanted(early_return, 1).fill(false);
            wanted(last_time, 1).fill(instance.time());
        }
        done
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3GetDirectionalDerivative(
    unit: *mut c_void,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    sensitivity: *mut f64,
    sensitivity_count: usize,
) -> Status {
    let work = |instance: &mut Instance| {
        // SAFETY: the importer's arrays, as long as it says.
        let (unknowns, knowns, seed, sensitivity) = unsafe {
            (
                given(unknowns, unknown_count),
                given(knowns, known_count),
                given(seed, seed_count),
                wanted(sensitivity, sensitivity_count),
            )
        };
        instance.directional_derivative(unknowns, knowns, seed, sensitivity)
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

/// A saved state as bytes.
type Image = Vec<u8>;

pub unsafe fn fmi3GetFMUState(unit: *mut c_void, state: *mut *mut c_void) -> Status {
    let work = |instance: &mut Instance| {
        let image = instance.image()?;
        // SAFETY: the importer's pointer, null or to a pointer that is null or of a state that this unit made.
        unsafe {
            let Some(place) = state.as_mut() else {
                return Err(Refusal("there is no place for the state".into()));
            };
            match place.cast::<Image>().as_mut() {
                Some(old) => *old = image,
                None => *place = Box::into_raw(Box::new(image)).cast(),
            }
        }
        Ok(())
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3SetFMUState(unit: *mut c_void, state: *mut c_void) -> Status {
    let work = |instance: &mut Instance| {
        // SAFETY: null, or a state that `fmi3GetFMUState` or `fmi3DeserializeFMUState` made.
        match unsafe { state.cast::<Image>().as_ref() } {
            Some(image) => instance.restore(image),
            None => Err(Refusal("the state is null".into())),
        }
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3FreeFMUState(unit: *mut c_void, state: *mut *mut c_void) -> Status {
    let work = |_: &mut Instance| {
        // SAFETY: null, or to a pointer that is null or of a state that we made, which is not used any more.
        unsafe {
            if let Some(place) = state.as_mut()
                && !place.is_null()
            {
                drop(Box::from_raw(place.cast::<Image>()));
                *place = null_mut();
            }
        }
        Ok(())
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3SerializedFMUStateSize(unit: *mut c_void, state: *mut c_void, size: *mut usize) -> Status {
    let work = |_: &mut Instance| {
        // SAFETY: null, or a state that we made; the importer's number.
        match unsafe { state.cast::<Image>().as_ref() } {
            Some(image) => {
                // SAFETY: the importer's number.
                unsafe { wanted(size, 1).fill(image.len()) };
                Ok(())
            }
            None => Err(Refusal("the state is null".into())),
        }
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3SerializeFMUState(
    unit: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> Status {
    let work = |_: &mut Instance| {
        // SAFETY: null, or a state that we made; the importer's bytes.
        let (image, bytes) = unsafe { (state.cast::<Image>().as_ref(), wanted(bytes, size)) };
        match image {
            Some(image) if image.len() == bytes.len() => {
                bytes.copy_from_slice(image);
                Ok(())
            }
            Some(image) => Err(Refusal(format!("the state has {} bytes, not {}", image.len(), bytes.len()))),
            None => Err(Refusal("the state is null".into())),
        }
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

pub unsafe fn fmi3DeserializeFMUState(
    unit: *mut c_void,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> Status {
    let work = |_: &mut Instance| {
        // SAFETY: the importer's bytes; a pointer to one that is null or of a state that we made.
        unsafe {
            let image = given(bytes, size).to_vec();
            let Some(place) = state.as_mut() else {
                return Err(Refusal("there is no place for the state".into()));
            };
            match place.cast::<Image>().as_mut() {
                Some(old) => *old = image,
                None => *place = Box::into_raw(Box::new(image)).cast(),
            }
        }
        Ok(())
    };
    // SAFETY: the importer's unit.
    unsafe { on(unit, work) }
}

/// A null instance.
pub fn none() -> *mut c_void {
    null::<c_void>().cast_mut()
}
