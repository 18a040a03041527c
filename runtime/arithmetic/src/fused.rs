//! a * b + c, in one operation where that is wanted and the target has it.

/// Whether a * b + c, a * b - c and c - a * b are one operation with one rounding in this build: only with
/// the feature `fused`, and where the target has the operation: without the feature every target computes the
/// same bits.
pub const FUSED: bool = cfg!(all(
    feature = "fused",
    any(target_feature = "fma", all(target_arch = "aarch64", target_feature = "neon"))
));

/// a * b + c, with one rounding where [`FUSED`] says so (and never by a library call).
#[inline(always)]
pub fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    #[cfg(feature = "fused")]
    if FUSED {
        return a.mul_add(b, c);
    }
    a * b + c
}
