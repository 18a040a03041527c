//! The C functions by which CasADi finds a function, its shape and its Jacobian.

/// Offers a generated module to `casadi.external` under a name: the module's type, with the arguments that
/// its methods have. See the [documentation of the crate](crate).
#[macro_export]
macro_rules! external {
    ($name:literal => $($module:ident)::+ ($q:ident, $u:ident $(, $inputs:ident)?)) => {
        const _: () = {
            use $crate::hodograph::{Mechanism, State, StateError};
            use $crate::{InverseDynamics, InverseDynamicsJacobian, Rates, RatesJacobian};

            type Module = $($module)::+ <f64>;

            /// The module at the parameters of the model.
            fn module() -> &'static Module {
                static MODULE: ::std::sync::OnceLock<Module> = ::std::sync::OnceLock::new();
                MODULE.get_or_init(Module::default)
            }

            const WRONG: StateError = StateError::Undefined { what: "a slice of this length" };

            /// Numbers as the struct of the module that has as many.
            fn named<const N: usize, S: From<[f64; N]>>(numbers: &[f64]) -> Result<S, StateError> {
                Ok(S::from(<[f64; N]>::try_from(numbers).map_err(|_| WRONG)?))
            }

            /// Writes blocks one after the other.
            fn write(blocks: &[&[f64]], mut to: &mut [f64]) -> Result<(), StateError> {
                for block in blocks {
                    let (first, rest) = to.split_at_mut_checked(block.len()).ok_or(WRONG)?;
                    first.copy_from_slice(block);
                    to = rest;
                }
                if to.is_empty() { Ok(()) } else { Err(WRONG) }
            }

            struct Door;

            impl $crate::Dynamics for Door {
                fn mechanism() -> &'static dyn Mechanism<f64> {
                    module()
                }

                fn coordinate_rates_derivatives(state: &State<'_>, matrix: &mut [f64]) -> Result<(), StateError> {
                    let found = module().coordinate_rates_derivatives(&named(state.coordinates)?, &named(state.speeds)?)?;
                    write(&[found.as_slice()], matrix)
                }

                fn accelerations_derivatives(state: &State<'_>, matrix: &mut [f64]) -> Result<(), StateError> {
                    let $q = named(state.coordinates)?;
                    let $u = named(state.speeds)?;
                    $(let $inputs = named(state.inputs)?;)?
                    let found = module().accelerations_derivatives(&$q, &$u $(, &$inputs)?)?;
                    write(&[found.by_coordinates.as_slice(), found.by_speeds.as_slice(), found.by_inputs.as_slice()], matrix)
                }

                fn inverse_dynamics_derivatives(
                    state: &State<'_>,
                    acceleration: &[f64],
                    matrix: &mut [f64],
                ) -> Result<(), StateError> {
                    let $q = named(state.coordinates)?;
                    let $u = named(state.speeds)?;
                    $(let $inputs = named(state.inputs)?;)?
                    let found =
                        module().inverse_dynamics_derivatives(&$q, &$u, &named(acceleration)? $(, &$inputs)?)?;
                    write(&[found.by_coordinates.as_slice(), found.by_speeds.as_slice(), found.by_inputs.as_slice()], matrix)
                }
            }

            #[allow(unsafe_code)]
            // SAFETY of the attribute: see the documentation of `symbols!`.
            #[unsafe(export_name = concat!($name, "_last_error"))]
            extern "C" fn last_error() -> *const ::std::ffi::c_char {
                $crate::last_error()
            }

            $crate::symbols!(Rates<Door>, [$name]);
            $crate::symbols!(RatesJacobian<Door>, ["jac_", $name]);
            $crate::symbols!(InverseDynamics<Door>, [$name, "_inverse_dynamics"]);
            $crate::symbols!(InverseDynamicsJacobian<Door>, ["jac_", $name, "_inverse_dynamics"]);
        };
    };
}

/// The symbols of one function.
///
/// They are `unsafe` because another library may have symbols of these names; CasADi looks for them in this
/// one alone, where the linker sees to it that there are no two.
#[doc(hidden)]
#[macro_export]
macro_rules! symbols {
    ($function:ty, [$($name:literal),+]) => {
        #[allow(unsafe_code)]
        const _: () = {
            use ::std::ffi::{c_char, c_int};
            use ::std::ptr::null;
            use $crate::{Block, Function, Int, Layout};

            fn layout() -> &'static Layout {
                static LAYOUT: ::std::sync::OnceLock<Layout> = ::std::sync::OnceLock::new();
                LAYOUT.get_or_init(<$function as Function>::layout)
            }

            fn get(blocks: &'static [Block], index: Int) -> Option<&'static Block> {
                blocks.get(usize::try_from(index).ok()?)
            }

            // SAFETY of the attributes below: see the documentation of the macro. Pointers that are returned are into `layout()`, which lives as long
            // as the library.
            #[unsafe(export_name = concat!($($name,)+ "_n_in"))]
            extern "C" fn n_in() -> Int {
                layout().inputs.len() as Int
            }

            #[unsafe(export_name = concat!($($name,)+ "_n_out"))]
            extern "C" fn n_out() -> Int {
                layout().outputs.len() as Int
            }

            #[unsafe(export_name = concat!($($name,)+ "_name_in"))]
            extern "C" fn name_in(index: Int) -> *const c_char {
                get(&layout().inputs, index).map_or(null(), |block| block.name().as_ptr())
            }

            #[unsafe(export_name = concat!($($name,)+ "_name_out"))]
            extern "C" fn name_out(index: Int) -> *const c_char {
                get(&layout().outputs, index).map_or(null(), |block| block.name().as_ptr())
            }

            #[unsafe(export_name = concat!($($name,)+ "_sparsity_in"))]
            extern "C" fn sparsity_in(index: Int) -> *const Int {
                get(&layout().inputs, index).map_or(null(), |block| block.sparsity().as_ptr())
            }

            #[unsafe(export_name = concat!($($name,)+ "_sparsity_out"))]
            extern "C" fn sparsity_out(index: Int) -> *const Int {
                get(&layout().outputs, index).map_or(null(), |block| block.sparsity().as_ptr())
            }

            /// # Safety
            ///
            /// That of CasADi's interface: each pointer is null or may be written to.
            #[unsafe(export_name = concat!($($name,)+ "_work"))]
            unsafe extern "C" fn work(arg: *mut Int, res: *mut Int, iw: *mut Int, w: *mut Int) -> c_int {
                // SAFETY: what our caller promises is what is asked for.
                unsafe { $crate::work(layout(), [arg, res, iw, w]) }
            }

            /// # Safety
            ///
            /// That of CasADi's interface, as [`hodograph_casadi::evaluate`] states it.
            #[unsafe(export_name = concat!($($name,)+ ""))]
            unsafe extern "C" fn evaluate(
                arg: *mut *const f64,
                res: *mut *mut f64,
                _iw: *mut Int,
                w: *mut f64,
                _memory: c_int,
            ) -> c_int {
                // SAFETY: what our caller promises is what is asked for.
                unsafe { $crate::evaluate::<$function>(layout(), arg, res, w) }
            }
        };
    };
}
