//! The least program that uses a model: accelerations alone, or a collision with the feature `collide`. Its size is what that costs, and its
//! symbols show what is in it.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;

use hodograph_models::two_sleds::{Coordinates, Speeds, TwoSleds};

#[cfg(feature = "double")]
type Chosen = f64;
#[cfg(not(feature = "double"))]
type Chosen = f32;

fn program() {
    let sleds = TwoSleds::<Chosen>::default();
    let (q, u) = (black_box(Coordinates::default()), black_box(Speeds::default()));
    #[cfg(not(feature = "collide"))]
    black_box(sleds.accelerations(&q, &u)).ok();
    #[cfg(feature = "collide")]
    {
        let surface = hodograph::Surface { mu: 0.6, e: 0.8, law: hodograph::Law::Stronge };
        black_box(sleds.collide_bc_ac(&q, &u, &black_box(surface))).ok();
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    program();
}

#[cfg(target_os = "none")]
use firmware as _;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    loop {
        program();
    }
}
