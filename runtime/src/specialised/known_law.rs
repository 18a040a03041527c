//! Types that say under which law of restitution collisions end.

use crate::Law;

/// What is known of the law of restitution while compiling.
pub trait KnownLaw: Copy + core::fmt::Debug + PartialEq + Send + Sync + 'static {
    /// The law; `None`: that of the surface.
    const LAW: Option<Law>;
}

/// The law is that of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnyLaw;

/// The law of this number ([`Law::number`]). A number without a law does not compile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneLaw<const NUMBER: u8>;

impl KnownLaw for AnyLaw {
    const LAW: Option<Law> = None;
}

impl<const NUMBER: u8> KnownLaw for OneLaw<NUMBER> {
    const LAW: Option<Law> = Some(Law::ALL[NUMBER as usize]);
}
