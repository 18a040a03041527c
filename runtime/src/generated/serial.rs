//! Serialisation of generated structs with the feature `serde`: a map from field names, as the model spells
//! them, to numbers. Missing fields take their defaults; unknown fields are errors.

/// Implements serde's traits for a generated struct of numbers, or nothing.
#[cfg(not(feature = "serde"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __serialize_record {
    ($($anything:tt)*) => {};
}

/// Implements serde's traits for a generated struct of numbers, or nothing.
#[cfg(feature = "serde")]
#[doc(hidden)]
#[macro_export]
macro_rules! __serialize_record {
    ($name:ident $count:literal $($field:ident)*) => {
        impl<T: $crate::generated::serde::Serialize> $crate::generated::serde::Serialize for $name<T> {
            fn serialize<S: $crate::generated::serde::Serializer>(
                &self,
                serializer: S,
            ) -> ::core::result::Result<S::Ok, S::Error> {
                use $crate::generated::serde::ser::SerializeStruct;
                let mut record = serializer.serialize_struct(::core::stringify!($name), $count)?;
                $(record.serialize_field(::core::stringify!($field), &self.$field)?;)*
                record.end()
            }
        }

        impl<'de, T: $crate::Scalar + $crate::generated::serde::Deserialize<'de>> $crate::generated::serde::Deserialize<'de>
            for $name<T>
        {
            fn deserialize<D: $crate::generated::serde::Deserializer<'de>>(
                deserializer: D,
            ) -> ::core::result::Result<Self, D::Error> {
                const FIELDS: &[&str] = &[$(::core::stringify!($field)),*];
                struct Fields<T>(::core::marker::PhantomData<T>);
                impl<'de, T: $crate::Scalar + $crate::generated::serde::Deserialize<'de>>
                    $crate::generated::serde::de::Visitor<'de> for Fields<T>
                {
                    type Value = $name<T>;

                    fn expecting(&self, out: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                        out.write_str(::core::concat!("a map of numbers: ", ::core::stringify!($name)))
                    }

                    fn visit_seq<A: $crate::generated::serde::de::SeqAccess<'de>>(
                        self,
                        mut sequence: A,
                    ) -> ::core::result::Result<$name<T>, A::Error> {
                        let mut record = <$name<T> as ::core::default::Default>::default();
                        $(
                            match sequence.next_element()? {
                                ::core::option::Option::Some(value) => record.$field = value,
                                ::core::option::Option::None => return ::core::result::Result::Err(
                                    $crate::generated::serde::de::Error::missing_field(::core::stringify!($field)),
                                ),
                            }
                        )*
                        ::core::result::Result::Ok(record)
                    }

                    fn visit_map<A: $crate::generated::serde::de::MapAccess<'de>>(
                        self,
                        mut map: A,
                    ) -> ::core::result::Result<$name<T>, A::Error> {
                        let mut record = <$name<T> as ::core::default::Default>::default();
                        while let ::core::option::Option::Some($crate::generated::FieldIndex(index)) =
                            map.next_key_seed($crate::generated::FieldNames(FIELDS))?
                        {
                            let mut at = 0;
                            $(
                                if index == at {
                                    record.$field = map.next_value()?;
                                }
                                at += 1;
                            )*
                            let _ = at;
                        }
                        ::core::result::Result::Ok(record)
                    }
                }
                deserializer.deserialize_struct(
                    ::core::stringify!($name),
                    FIELDS,
                    Fields(::core::marker::PhantomData),
                )
            }
        }
    };
}

/// Implements `Serialize` for a generated struct of results, or nothing.
#[cfg(not(feature = "serde"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __serialize_outcome {
    ($($anything:tt)*) => {};
}

/// Implements `Serialize` for a generated struct of results, or nothing.
#[cfg(feature = "serde")]
#[doc(hidden)]
#[macro_export]
macro_rules! __serialize_outcome {
    ($name:ident $count:literal $($field:ident)*) => {
        impl<T: $crate::Scalar + $crate::generated::serde::Serialize> $crate::generated::serde::Serialize for $name<T> {
            fn serialize<S: $crate::generated::serde::Serializer>(
                &self,
                serializer: S,
            ) -> ::core::result::Result<S::Ok, S::Error> {
                use $crate::generated::serde::ser::SerializeStruct;
                let mut outcome = serializer.serialize_struct(::core::stringify!($name), $count)?;
                $(outcome.serialize_field(::core::stringify!($field), &self.$field)?;)*
                outcome.end()
            }
        }
    };
}

#[cfg(feature = "serde")]
mod fields {
    use core::fmt;

    use serde::de::{DeserializeSeed, Deserializer, Error, Visitor};

    /// The names of fields, to read one of them.
    pub struct FieldNames(pub &'static [&'static str]);

    /// Which of the names was read.
    pub struct FieldIndex(pub usize);

    impl<'de> DeserializeSeed<'de> for FieldNames {
        type Value = FieldIndex;

        fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<FieldIndex, D::Error> {
            deserializer.deserialize_identifier(self)
        }
    }

    impl Visitor<'_> for FieldNames {
        type Value = FieldIndex;

        fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
            out.write_str("the name of a field")
        }

        fn visit_str<E: Error>(self, name: &str) -> Result<FieldIndex, E> {
            let index = self.0.iter().position(|known| *known == name);
            index.map(FieldIndex).ok_or_else(|| E::unknown_field(name, self.0))
        }

        fn visit_u64<E: Error>(self, index: u64) -> Result<FieldIndex, E> {
            Ok(FieldIndex(index as usize))
        }
    }
}

#[cfg(feature = "serde")]
#[doc(hidden)]
pub use fields::{FieldIndex, FieldNames};
