//! Elementary functions by `libm`, not by the system: the same bits on every machine, with the standard
//! library and without.

pub mod inlined;

/// Functions of doubles, to about a unit in the last place.
pub mod double {
    pub use libm::{acos, asin, atan, atan2, exp, expm1 as exp_m1, hypot, log as ln, log1p as ln_1p, tan};
}

/// Functions of singles, to about a unit in the last place. Those that are not used in routines may compute
/// in doubles.
pub mod single {
    pub use libm::{
        acosf as acos, asinf as asin, atan2f as atan2, atanf as atan, coshf as cosh, expf as exp,
        expm1f as exp_m1, log1pf as ln_1p, logf as ln, sinhf as sinh, tanhf as tanh,
    };

    /// Tangent, in single precision alone: the quotient of sine and cosine, to 2.5 units in the last place.
    pub fn tan(a: f32) -> f32 {
        let (sine, cosine) = crate::trigonometry::single::sin_cos(a);
        sine / cosine
    }
}
