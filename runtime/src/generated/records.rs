//! Implements arithmetic, names, units and text for the structs of numbers of a generated module, so that
//! they can be used in loops.

/// Implements for a record `+`, `-`, `*` and `/` by a number, `NAMES`, `UNITS`, `get`, `iter`, `Display`.
#[doc(hidden)]
#[macro_export]
macro_rules! __record {
    ($name:ident $count:literal $($field:ident $label:literal $unit:literal)*) => {
        impl<T> $name<T> {
            /// Names of the components, as the model spells them, in the order of the fields.
            pub const NAMES: [&'static str; $count] = [$($label),*];
            /// Units of the components, as the model declares them; `1` without one.
            pub const UNITS: [&'static str; $count] = [$($unit),*];
        }

        impl<T: $crate::Scalar> $name<T> {
            /// The component of this number; `None` past the last.
            #[inline]
            #[must_use]
            pub fn get(&self, index: usize) -> ::core::option::Option<T> {
                [$(self.$field),*].get(index).copied()
            }

            /// Names and components in the order of the fields.
            #[inline]
            pub fn iter(&self) -> impl ::core::iter::Iterator<Item = (&'static str, T)> {
                [$(($label, self.$field)),*].into_iter()
            }
        }

        impl<T: $crate::Scalar> ::core::ops::Add for $name<T> {
            type Output = Self;
            #[inline]
            fn add(self, other: Self) -> Self {
                Self { $($field: self.$field + other.$field),* }
            }
        }
        impl<T: $crate::Scalar> ::core::ops::Sub for $name<T> {
            type Output = Self;
            #[inline]
            fn sub(self, other: Self) -> Self {
                Self { $($field: self.$field - other.$field),* }
            }
        }
        impl<T: $crate::Scalar> ::core::ops::Neg for $name<T> {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                Self { $($field: -self.$field),* }
            }
        }
        impl<T: $crate::Scalar> ::core::ops::Mul<T> for $name<T> {
            type Output = Self;
            #[inline]
            fn mul(self, factor: T) -> Self {
                Self { $($field: self.$field * factor),* }
            }
        }
        impl<T: $crate::Scalar> ::core::ops::Div<T> for $name<T> {
            type Output = Self;
            #[inline]
            fn div(self, divisor: T) -> Self {
                Self { $($field: self.$field / divisor),* }
            }
        }
        impl ::core::ops::Mul<$name<f64>> for f64 {
            type Output = $name<f64>;
            #[inline]
            fn mul(self, record: $name<f64>) -> $name<f64> {
                record * self
            }
        }
        impl ::core::ops::Mul<$name<f32>> for f32 {
            type Output = $name<f32>;
            #[inline]
            fn mul(self, record: $name<f32>) -> $name<f32> {
                record * self
            }
        }
        impl<T: $crate::Scalar> ::core::ops::AddAssign for $name<T> {
            #[inline]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }
        impl<T: $crate::Scalar> ::core::ops::SubAssign for $name<T> {
            #[inline]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }
        impl<T: $crate::Scalar> ::core::ops::MulAssign<T> for $name<T> {
            #[inline]
            fn mul_assign(&mut self, factor: T) {
                *self = *self * factor;
            }
        }

        /// Names, numbers and units: `q1 = 0.3 rad, x = 2 m`. A precision (`{:.3}`) holds for every number.
        impl<T: ::core::fmt::Display> ::core::fmt::Display for $name<T> {
            fn fmt(&self, out: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                let components: [(&str, &T, &str); $count] = [$(($label, &self.$field, $unit)),*];
                for (index, (name, number, unit)) in components.into_iter().enumerate() {
                    let between = if index > 0 { ", " } else { "" };
                    ::core::write!(out, "{between}{name} = ")?;
                    ::core::fmt::Display::fmt(number, out)?;
                    if unit != "1" {
                        ::core::write!(out, " {unit}")?;
                    }
                }
                ::core::result::Result::Ok(())
            }
        }
    };
}
