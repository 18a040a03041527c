//! a * b + c, where the target does it in one operation.

/// Are a * b + c and its kin one operation, with one rounding, on this build's target? Without the standard library the operation cannot be
/// reached.
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
