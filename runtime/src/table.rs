//! One table for each enum that crosses to other languages: names, documentation and numbers.

/// Gives an enum `ALL`, `NAMES`, `name`, `about`, `number` and `numbered`. A variant without a row does not compile.
macro_rules! table {
    ($of:ident $($variant:ident $name:literal $about:literal,)*) => {
        impl $of {
            /// Every value, in the order of the variants.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];
            /// Their names.
            pub const NAMES: &'static [&'static str] = &[$($name),*];

            /// A stable lower-case name.
            #[inline]
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// What it means, in a few words.
            #[must_use]
            pub const fn about(self) -> &'static str {
                match self {
                    $(Self::$variant => $about,)*
                }
            }

            /// Its place in [`Self::ALL`]: what languages without such enums have in its stead.
            #[inline]
            #[must_use]
            pub const fn number(self) -> u8 {
                self as u8
            }

            /// The value of that number.
            #[inline]
            #[must_use]
            pub fn numbered(number: i32) -> Option<Self> {
                Self::ALL.get(usize::try_from(number).ok()?).copied()
            }
        }

        #[cfg(test)]
        #[test]
        fn numbers_are_places() {
            for (place, value) in $of::ALL.iter().enumerate() {
                assert_eq!((usize::from(value.number()), $of::NAMES[place]), (place, value.name()));
                assert_eq!($of::numbered(place as i32), Some(*value));
            }
            assert_eq!($of::numbered(-1).or($of::numbered($of::ALL.len() as i32)), None);
        }
    };
}

pub(crate) use table;
