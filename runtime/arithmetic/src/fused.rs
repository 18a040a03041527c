//! a * b + c in one operation with one rounding, on targets that have the instruction.

/// Whether a * b + c, a * b - c and c - a * b are one operation with one rounding in this build. Without the standard library the operation is not
/// available.
pub const FUSED: bool = cfg!(all(
    feature = "std",
    any(target_feature = "fma", all(target_arch = "aarch64", target_feature = "neon"))
));

/// a * b + c, with one rounding where the target has the instruction (and never by a library call).
#[inline(always)]
pub fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    #[cfg(feature = "std")]
    if FUSED {
        return a.mul_add(b, c);
    }
    a * b + c
}
