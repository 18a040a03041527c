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

/// [`Law::Newton`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newton;

/// [`Law::Poisson`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Poisson;

/// [`Law::Stronge`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stronge;

impl KnownLaw for AnyLaw {
    const LAW: Option<Law> = None;
}

impl KnownLaw for Newton {
    const LAW: Option<Law> = Some(Law::Newton);
}

impl KnownLaw for Poisson {
    const LAW: Option<Law> = Some(Law::Poisson);
}

impl KnownLaw for Stronge {
    const LAW: Option<Law> = Some(Law::Stronge);
}
