//! Exponentials and logarithms that become part of their caller, with the bits of those beside them.
//!
//! The methods and constants are those of FreeBSD's library, which `libm` follows too, without its branches
//! for arguments that are rare: there the answer is `None`, and the caller takes the function of `libm`. What
//! is left has few branches. With k = x / ln 2, rounded, the exponential is 2^k e^r, where e^r - 1 is a
//! rational function of a polynomial in r^2; the logarithm of 2^k (1 + f) is k ln 2 + ln(1 + f), likewise of s
//! = f / (2 + f).
//!
//! Methods and constants: Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved. Developed at
//! SunPro, a Sun Microsystems, Inc. business. Permission to use, copy, modify, and distribute this software is
//! freely granted, provided that this notice is preserved.

/// The functions of a number type, from its constants and polynomials in the module that this stands in.
macro_rules! functions {
    ($real:ty, $bits:ty, $digits:literal, $bias:literal) => {
        /// 2^k, for exponents of normal numbers.
        #[inline(always)]
        fn power(k: i32) -> $real {
            <$real>::from_bits((($bias + k) as $bits) << $digits)
        }

        /// x / ln 2, rounded, for x of this `size`; 1 or -1 below `two`.
        #[inline(always)]
        fn turns(x: $real, size: $real, two: $real) -> i32 {
            if size < HALF_LN2 {
                0
            } else if size < two {
                if x < 0.0 { -1 } else { 1 }
            } else {
                (INVERSE_LN2 * x + if x < 0.0 { -0.5 } else { 0.5 }) as i32
            }
        }

        /// e^x, unless it is large or small beyond measure.
        #[inline(always)]
        pub fn exp(x: $real) -> Option<$real> {
            let size = x.abs();
            // Not where x is not a number.
            let near = size < exponential::FAR;
            if !near {
                return None;
            }
            let k = turns(x, size, exponential::TWO);
            let hi = x - k as $real * exponential::LN2[0];
            let lo = k as $real * exponential::LN2[1];
            let r = hi - lo;
            let square = r * r;
            let c = r - square * exponential::polynomial(square);
            let value = 1.0 + (r * c / (2.0 - c) - lo + hi);
            Some(if size < exponential::SMALL { 1.0 + x } else { value * power(k) })
        }

        /// e^x - 1, unless it is large beyond measure.
        #[inline(always)]
        pub fn exp_m1(x: $real) -> Option<$real> {
            let size = x.abs();
            let near = size < less_one::FAR;
            if !near {
                return if x < 0.0 { Some(-1.0) } else { None };
            }
            let k = turns(x, size, less_one::TWO);
            let hi = x - k as $real * LN2[0];
            let lo = k as $real * LN2[1];
            let r = hi - lo;
            let c = (hi - r) - lo;
            let half = 0.5 * r;
            let square = r * half;
            let r1 = 1.0 + square * less_one::polynomial(square);
            let t = 3.0 - r1 * half;
            let e = square * ((r1 - t) / (6.0 - r * t));
            let e = r * (e - c) - c - square;
            // e^r - 1 = r - e, and 2^k (e^r - 2^-k) without cancellation.
            Some(match k {
                0 => r - e,
                -1 => 0.5 * (r - e) - 0.5,
                1 if r < -0.25 => -2.0 * (e - (r + 0.5)),
                1 => 1.0 + 2.0 * (r - e),
                ..-1 => (r - e + 1.0) * power(k) - 1.0,
                2..less_one::MANY => (r - e + (1.0 - power(-k))) * power(k),
                _ => (r - (e + power(-k)) + 1.0) * power(k),
            })
        }

        /// The logarithm of 2^k (1 + f), where 2^k (1 + f) was rounded by c of itself.
        #[inline(always)]
        fn logarithm(k: i32, f: $real, c: $real) -> $real {
            let half = 0.5 * f * f;
            let s = f / (2.0 + f);
            let z = s * s;
            let r = polynomial(z, z * z);
            let k = k as $real;
            s * (half + r) + (k * LN2[1] + c) - half + f + k * LN2[0]
        }

        /// k and 1 + f with x = 2^k (1 + f) between sqrt(1/2) and sqrt(2), for normal x.
        #[inline(always)]
        fn parts(x: $real) -> (i32, $real) {
            let bits = x.to_bits() + (ONE - ROOT_HALF);
            let k = (bits >> $digits) as i32 - $bias;
            (k, <$real>::from_bits((bits & ((1 << $digits) - 1)) + ROOT_HALF))
        }

        /// ln x, for normal numbers.
        #[inline(always)]
        pub fn ln(x: $real) -> Option<$real> {
            let finite = x < <$real>::INFINITY;
            if !finite || x < <$real>::MIN_POSITIVE {
                return None;
            }
            let (k, one_f) = parts(x);
            Some(logarithm(k, one_f - 1.0, 0.0))
        }

        /// ln(1 + x), unless x is -1 or less, or so large that it is ln x.
        #[inline(always)]
        pub fn ln_1p(x: $real) -> Option<$real> {
            let near = x < one_more::FAR;
            if !near || x <= -1.0 {
                return None;
            }
            let (k, f, c) = if x < one_more::NEAR[1] && x > one_more::NEAR[0] {
                (0, x, 0.0)
            } else {
                let u = 1.0 + x;
                let (k, one_f) = parts(u);
                let lost = if k >= 2 { 1.0 - (u - x) } else { x - (u - 1.0) };
                (k, one_f - 1.0, lost / u)
            };
            let value = logarithm(k, f, c);
            Some(if x.abs() < one_more::SMALL { x } else { value })
        }
    };
}

/// Functions of doubles.
pub mod double {
    /// The bits of 1, and of a number a little below sqrt(1/2).
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    const ROOT_HALF: u64 = 0x3fe6_a09e_0000_0000;
    /// A little more than ln 2 / 2.
    const HALF_LN2: f64 = f64::from_bits(0x3fd6_2e43_0000_0000);
    const INVERSE_LN2: f64 = core::f64::consts::LOG2_E;
    /// ln 2 in two parts.
    const LN2: [f64; 2] = [0.6931471803691238, 1.9082149292705877e-10];

    mod exponential {
        pub const LN2: [f64; 2] = super::LN2;
        /// The result is a normal number below this.
        pub const FAR: f64 = 708.0;
        /// 3 ln 2 / 2, about: k = 1 below it.
        pub const TWO: f64 = f64::from_bits(0x3ff0_a2b2_0000_0000);
        /// 2^-28: here 1 + x is more accurate.
        pub const SMALL: f64 = f64::from_bits(0x3e30_0001_0000_0000);

        #[inline(always)]
        pub fn polynomial(x: f64) -> f64 {
            let high = 6.613756321437934e-5 + x * (-1.6533902205465252e-6 + x * 4.1381367970572385e-8);
            0.16666666666666602 + x * (-0.0027777777777015593 + x * high)
        }
    }

    mod less_one {
        /// 56 ln 2, about.
        pub const FAR: f64 = f64::from_bits(0x4043_687a_0000_0000);
        pub const TWO: f64 = super::exponential::TWO;
        /// From this k on, 2^-k is less than the digits of e^r - 1 that are lost.
        pub const MANY: i32 = 20;

        #[inline(always)]
        pub fn polynomial(x: f64) -> f64 {
            let high = -7.93650757867488e-5 + x * (4.008217827329362e-6 + x * -2.0109921818362437e-7);
            -0.03333333333333313 + x * (0.0015873015872548146 + x * high)
        }
    }

    mod one_more {
        /// 2^53.
        pub const FAR: f64 = 9007199254740992.0;
        /// 2^-53.
        pub const SMALL: f64 = f64::from_bits(0x3ca0_0000_0000_0000);
        /// sqrt(1/2) - 1 and sqrt(2) - 1, about: between them k is 0.
        pub const NEAR: [f64; 2] =
            [-f64::from_bits(0x3fd2_bec5_0000_0000), f64::from_bits(0x3fda_827a_0000_0000)];
    }

    /// The polynomial of both logarithms in z = s^2, where w = z^2.
    #[inline(always)]
    fn polynomial(z: f64, w: f64) -> f64 {
        let even = w * (0.3999999999940942 + w * (0.22222198432149784 + w * 0.15313837699209373));
        let odd = 0.2857142874366239 + w * (0.1818357216161805 + w * 0.14798198605116586);
        z * (0.6666666666666735 + w * odd) + even
    }

    functions!(f64, u64, 52, 1023);
}

/// Functions of singles.
pub mod single {
    /// The bits of 1, and of a number a little below sqrt(1/2).
    const ONE: u32 = 0x3f80_0000;
    const ROOT_HALF: u32 = 0x3f35_04f3;
    /// A little more than ln 2 / 2.
    const HALF_LN2: f32 = f32::from_bits(0x3eb1_7219);
    const INVERSE_LN2: f32 = core::f32::consts::LOG2_E;
    /// ln 2 in two parts.
    const LN2: [f32; 2] = [0.6931381, 9.058001e-6];

    mod exponential {
        /// ln 2 in two parts, of which the first has more digits than it has elsewhere.
        pub const LN2: [f32; 2] = [0.69314575, 1.4286068e-6];
        /// The result is a normal number below this.
        pub const FAR: f32 = 87.0;
        /// 3 ln 2 / 2, about: k = 1 below it.
        pub const TWO: f32 = f32::from_bits(0x3f85_1593);
        /// 2^-14: here 1 + x is more accurate.
        pub const SMALL: f32 = f32::from_bits(0x3900_0001);

        #[inline(always)]
        pub fn polynomial(x: f32) -> f32 {
            0.16666625 + x * -0.0027667333
        }
    }

    mod less_one {
        /// 27 ln 2, about.
        pub const FAR: f32 = f32::from_bits(0x4195_b844);
        pub const TWO: f32 = f32::from_bits(0x3f85_1592);
        /// From this k on, 2^-k is less than the digits of e^r - 1 that are lost.
        pub const MANY: i32 = 23;

        #[inline(always)]
        pub fn polynomial(x: f32) -> f32 {
            -0.033333212 + x * 0.001580717
        }
    }

    mod one_more {
        /// 2^24.
        pub const FAR: f32 = 16777216.0;
        /// 2^-24.
        pub const SMALL: f32 = f32::from_bits(0x3380_0000);
        /// sqrt(1/2) - 1 and sqrt(2) - 1, about: between them k is 0.
        pub const NEAR: [f32; 2] = [-f32::from_bits(0x3e95_f61a), f32::from_bits(0x3ed4_13d0)];
    }

    /// The polynomial of both logarithms in z = s^2, where w = z^2.
    #[inline(always)]
    fn polynomial(z: f32, w: f32) -> f32 {
        let even = w * (0.40000972 + w * 0.24279079);
        z * (0.6666666 + w * 0.28498787) + even
    }

    functions!(f32, u32, 23, 127);
}

#[cfg(test)]
mod tests {
    use super::super::{double as all_doubles, single as all_singles};
    use super::{double, single};
    use std::vec::Vec;

    /// A function here, and that of `libm`.
    type Pair<T> = (fn(T) -> Option<T>, fn(T) -> T);

    /// The bits of the functions of `libm`, wherever there is an answer; how often there is.
    fn doubles(x: f64) -> u32 {
        let functions: [Pair<f64>; 4] = [
            (double::exp, all_doubles::exp),
            (double::exp_m1, all_doubles::exp_m1),
            (double::ln, all_doubles::ln),
            (double::ln_1p, all_doubles::ln_1p),
        ];
        let mut answers = 0;
        for (index, (here, there)) in functions.into_iter().enumerate() {
            let Some(value) = here(x) else { continue };
            assert_eq!(value.to_bits(), there(x).to_bits(), "function {index} at {x:e}");
            answers += 1;
        }
        answers
    }

    fn singles(x: f32) -> u32 {
        let functions: [Pair<f32>; 4] = [
            (single::exp, all_singles::exp),
            (single::exp_m1, all_singles::exp_m1),
            (single::ln, all_singles::ln),
            (single::ln_1p, all_singles::ln_1p),
        ];
        let mut answers = 0;
        for (index, (here, there)) in functions.into_iter().enumerate() {
            let Some(value) = here(x) else { continue };
            assert_eq!(value.to_bits(), there(x).to_bits(), "function {index} at {x:e}");
            answers += 1;
        }
        answers
    }

    /// Every double whose high word ends in a change of branch, and neighbours; all exponents; random ones.
    #[test]
    fn doubles_have_the_bits_of_libm() {
        let edges: [u32; 16] = [
            0x3fd62e42, 0x3fd62e43, 0x3ff0a2b1, 0x3ff0a2b2, 0x3e300000, 0x3e300001, 0x4043687a, 0x3c900000,
            0x3fda827a, 0x3fd2bec4, 0x3fd2bec5, 0x3ca00000, 0x3fe6a09e, 0x40862000, 0x43400000, 0x3ff00000,
        ];
        let mut random = hodograph_random::Random::new(7);
        let mut answers = 0;
        for sign in [0, 1 << 63] {
            for edge in edges {
                for low in [0, 1, u64::from(u32::MAX) - 1, u64::from(u32::MAX)] {
                    answers += doubles(f64::from_bits(sign | u64::from(edge) << 32 | low));
                }
                (0..500).for_each(|_| {
                    answers += doubles(f64::from_bits(sign | u64::from(edge) << 32 | random.bits() >> 32));
                });
            }
            for exponent in 0..2048_u64 {
                (0..100).for_each(|_| {
                    answers += doubles(f64::from_bits(sign | exponent << 52 | random.bits() >> 12));
                });
            }
        }
        for _ in 0..1_000_000 {
            let share = random.number();
            answers += doubles(share * 3.0) + doubles(share * 50.0) + doubles(share * 720.0);
        }
        assert!(answers > 7_000_000, "{answers}");
    }

    /// One single in 997, and those around every change of a branch.
    #[test]
    fn singles_have_the_bits_of_libm() {
        let edges: [u32; 14] = [
            0x42aeac50, 0x3eb17218, 0x3f851592, 0x39000000, 0x4195b844, 0x33000000, 0x3ed413d0, 0x3e95f619,
            0x33800000, 0x3f3504f3, 0x3f800000, 0x4b800000, 0x7f800000, 0x00800000,
        ];
        let near = |edge: u32| (edge - 300..edge + 300).flat_map(|bits| [bits, bits | 1 << 31]);
        let all: Vec<u32> = edges.into_iter().flat_map(near).chain((0..u32::MAX).step_by(997)).collect();
        let answers: u32 = all.into_iter().map(|bits| singles(f32::from_bits(bits))).sum();
        assert!(answers > 8_000_000, "{answers}");
    }

    #[test]
    #[ignore = "all singles; `cargo test --release -p hodograph-arithmetic -- --ignored`"]
    fn all_singles_have_the_bits_of_libm() {
        let answers: u64 = (0..=u32::MAX).map(|bits| u64::from(singles(f32::from_bits(bits)))).sum();
        assert!(answers > 1 << 33, "{answers}");
    }
}
