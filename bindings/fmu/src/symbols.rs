//! The symbols of a unit: the functions of the standard by their names.

/// Generates the functions of FMI 3.0 for a generated module in a shared library. Arguments: the type of the
/// mechanism without the scalar, the token of its `modelDescription.xml`, and the data that the module does
/// not contain ([`crate::Defaults`]).
#[macro_export]
macro_rules! export {
    ($mechanism:ident in $module:path, token = $token:expr, defaults = $defaults:expr) => {
        const _: () = {
            use std::ffi::{c_char, c_void};

            use $module as module;

            fn make() -> Box<dyn $crate::Contacts> {
                Box::new(module::$mechanism::<f64>::default())
            }

            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi3InstantiateModelExchange(
                _name: *const c_char,
                token: *const c_char,
                _resources: *const c_char,
                _visible: bool,
                _logging: bool,
                environment: *mut c_void,
                log: $crate::abi::Log,
            ) -> *mut c_void {
                let kind = $crate::Kind::ModelExchange;
                // SAFETY: by the standard.
                unsafe { $crate::abi::instantiate(make, $defaults, $token, kind, token, environment, log) }
            }

            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi3InstantiateCoSimulation(
                _name: *const c_char,
                token: *const c_char,
                _resources: *const c_char,
                _visible: bool,
                _logging: bool,
                _event_mode_used: bool,
                _early_return_allowed: bool,
                _intermediate: *const u32,
                _intermediate_count: usize,
                environment: *mut c_void,
                log: $crate::abi::Log,
                _intermediate_update: *const c_void,
            ) -> *mut c_void {
                let kind = $crate::Kind::CoSimulation;
                // SAFETY: by the standard.
                unsafe { $crate::abi::instantiate(make, $defaults, $token, kind, token, environment, log) }
            }

            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi3InstantiateScheduledExecution(
                _name: *const c_char,
                _token: *const c_char,
                _resources: *const c_char,
                _visible: bool,
                _logging: bool,
                _environment: *mut c_void,
                _log: $crate::abi::Log,
                _clock_update: *const c_void,
                _lock: *const c_void,
                _unlock: *const c_void,
            ) -> *mut c_void {
                $crate::abi::none()
            }

            #[unsafe(no_mangle)]
            extern "C" fn fmi3GetVersion() -> *const c_char {
                $crate::abi::fmi3GetVersion()
            }

            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi3FreeInstance(unit: *mut c_void) {
                // SAFETY: by the standard.
                unsafe { $crate::abi::fmi3FreeInstance(unit) }
            }

            $crate::forwarded! {
                fmi3SetDebugLogging(on: bool, count: usize, categories: *const *const c_char);
                fmi3EnterInitializationMode(has_tolerance: bool, tolerance: f64, start: f64, has_stop: bool, stop: f64);
                fmi3ExitInitializationMode();
                fmi3EnterEventMode();
                fmi3EnterContinuousTimeMode();
                fmi3Terminate();
                fmi3Reset();
                fmi3EvaluateDiscreteStates();
                fmi3GetFloat64(references: *const u32, count: usize, values: *mut f64, room: usize);
                fmi3SetFloat64(references: *const u32, count: usize, values: *const f64, room: usize);
                fmi3GetInt64(references: *const u32, count: usize, values: *mut i64, room: usize);
                fmi3SetInt64(references: *const u32, count: usize, values: *const i64, room: usize);
                fmi3UpdateDiscreteStates(
                    again: *mut bool,
                    terminates: *mut bool,
                    nominals: *mut bool,
                    states: *mut bool,
                    has_next: *mut bool,
                    next: *mut f64
                );
                fmi3CompletedIntegratorStep(no_return: bool, event: *mut bool, terminate: *mut bool);
                fmi3SetTime(time: f64);
                fmi3SetContinuousStates(states: *const f64, count: usize);
                fmi3GetContinuousStates(values: *mut f64, count: usize);
                fmi3GetContinuousStateDerivatives(values: *mut f64, count: usize);
                fmi3GetEventIndicators(values: *mut f64, count: usize);
                fmi3GetNominalsOfContinuousStates(values: *mut f64, count: usize);
                fmi3GetNumberOfEventIndicators(count: *mut usize);
                fmi3GetNumberOfContinuousStates(count: *mut usize);
                fmi3DoStep(
                    from: f64,
                    step: f64,
                    no_set: bool,
                    event: *mut bool,
                    terminate: *mut bool,
                    early: *mut bool,
                    last: *mut f64
                );
                fmi3GetDirectionalDerivative(
                    unknowns: *const u32,
                    unknown_count: usize,
                    knowns: *const u32,
                    known_count: usize,
                    seed: *const f64,
                    seed_count: usize,
                    sensitivity: *mut f64,
                    sensitivity_count: usize
                );
                fmi3GetFMUState(state: *mut *mut c_void);
                fmi3SetFMUState(state: *mut c_void);
                fmi3FreeFMUState(state: *mut *mut c_void);
                fmi3SerializedFMUStateSize(state: *mut c_void, size: *mut usize);
                fmi3SerializeFMUState(state: *mut c_void, bytes: *mut u8, size: usize);
                fmi3DeserializeFMUState(bytes: *const u8, size: usize, state: *mut *mut c_void);
            }

            // No variable has these types, and units have neither clocks nor arrays of structural parameters
            // nor event mode in co-simulation.
            $crate::not_offered! {
                fmi3GetFloat32(references: *const u32, count: usize, values: *mut f32, room: usize);
                fmi3SetFloat32(references: *const u32, count: usize, values: *const f32, room: usize);
                fmi3GetInt8(references: *const u32, count: usize, values: *mut i8, room: usize);
                fmi3SetInt8(references: *const u32, count: usize, values: *const i8, room: usize);
                fmi3GetUInt8(references: *const u32, count: usize, values: *mut u8, room: usize);
                fmi3SetUInt8(references: *const u32, count: usize, values: *const u8, room: usize);
                fmi3GetInt16(references: *const u32, count: usize, values: *mut i16, room: usize);
                fmi3SetInt16(references: *const u32, count: usize, values: *const i16, room: usize);
                fmi3GetUInt16(references: *const u32, count: usize, values: *mut u16, room: usize);
                fmi3SetUInt16(references: *const u32, count: usize, values: *const u16, room: usize);
                fmi3GetInt32(references: *const u32, count: usize, values: *mut i32, room: usize);
                fmi3SetInt32(references: *const u32, count: usize, values: *const i32, room: usize);
                fmi3GetUInt32(references: *const u32, count: usize, values: *mut u32, room: usize);
                fmi3SetUInt32(references: *const u32, count: usize, values: *const u32, room: usize);
                fmi3GetUInt64(references: *const u32, count: usize, values: *mut u64, room: usize);
                fmi3SetUInt64(references: *const u32, count: usize, values: *const u64, room: usize);
                fmi3GetBoolean(references: *const u32, count: usize, values: *mut bool, room: usize);
                fmi3SetBoolean(references: *const u32, count: usize, values: *const bool, room: usize);
                fmi3GetString(references: *const u32, count: usize, values: *mut *const c_char, room: usize);
                fmi3SetString(references: *const u32, count: usize, values: *const *const c_char, room: usize);
                fmi3GetBinary(
                    references: *const u32,
                    count: usize,
                    sizes: *mut usize,
                    values: *mut *const u8,
                    room: usize
                );
                fmi3SetBinary(
                    references: *const u32,
                    count: usize,
                    sizes: *const usize,
                    values: *const *const u8,
                    room: usize
                );
                fmi3GetClock(references: *const u32, count: usize, values: *mut bool);
                fmi3SetClock(references: *const u32, count: usize, values: *const bool);
                fmi3GetNumberOfVariableDependencies(reference: u32, count: *mut usize);
                fmi3GetVariableDependencies(
                    dependent: u32,
                    elements: *mut usize,
                    independents: *mut u32,
                    independent_elements: *mut usize,
                    kinds: *mut i32,
                    count: usize
                );
                fmi3GetAdjointDerivative(
                    unknowns: *const u32,
                    unknown_count: usize,
                    knowns: *const u32,
                    known_count: usize,
                    seed: *const f64,
                    seed_count: usize,
                    sensitivity: *mut f64,
                    sensitivity_count: usize
                );
                fmi3EnterConfigurationMode();
                fmi3ExitConfigurationMode();
                fmi3EnterStepMode();
                fmi3GetIntervalDecimal(references: *const u32, count: usize, intervals: *mut f64, qualifiers: *mut i32);
                fmi3GetIntervalFraction(
                    references: *const u32,
                    count: usize,
                    counters: *mut u64,
                    resolutions: *mut u64,
                    qualifiers: *mut i32
                );
                fmi3GetShiftDecimal(references: *const u32, count: usize, shifts: *mut f64);
                fmi3GetShiftFraction(references: *const u32, count: usize, counters: *mut u64, resolutions: *mut u64);
                fmi3SetIntervalDecimal(references: *const u32, count: usize, intervals: *const f64);
                fmi3SetIntervalFraction(
                    references: *const u32,
                    count: usize,
                    counters: *const u64,
                    resolutions: *const u64
                );
                fmi3SetShiftDecimal(references: *const u32, count: usize, shifts: *const f64);
                fmi3SetShiftFraction(
                    references: *const u32,
                    count: usize,
                    counters: *const u64,
                    resolutions: *const u64
                );
                fmi3GetOutputDerivatives(
                    references: *const u32,
                    count: usize,
                    orders: *const i32,
                    values: *mut f64,
                    room: usize
                );
                fmi3ActivateModelPartition(clock: u32, time: f64);
            }
        };
    };
}

/// Functions of `abi` by their names in C.
#[doc(hidden)]
#[macro_export]
macro_rules! forwarded {
    ($($name:ident($($argument:ident: $type:ty),*);)*) => {
        $(#[unsafe(no_mangle)]
        unsafe extern "C" fn $name(unit: *mut c_void $(, $argument: $type)*) -> i32 {
            // SAFETY: by the standard.
            unsafe { $crate::abi::$name(unit $(, $argument)*) }
        })*
    };
}

/// Functions that a unit must have, but that return an error.
#[doc(hidden)]
#[macro_export]
macro_rules! not_offered {
    ($($name:ident($($argument:ident: $type:ty),*);)*) => {
        $(#[unsafe(no_mangle)]
        #[allow(unused_variables)]
        unsafe extern "C" fn $name(unit: *mut c_void $(, $argument: $type)*) -> i32 {
            // SAFETY: by the standard.
            unsafe { $crate::abi::not_offered(unit, stringify!($name)) }
        })*
    };
}
