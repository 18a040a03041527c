//! The least program that uses a model: nothing without the feature of a model; accelerations with it, and
//! what the other features name. Its size is what that costs, and its symbols show what is in it.

#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unused_imports, dead_code, reason = "without any model")]

use core::hint::black_box;

use firmware::models;
use hodograph::{Law, Surface};

#[cfg(feature = "double")]
type Chosen = f64;
#[cfg(not(feature = "double"))]
type Chosen = f32;
#[cfg(all(feature = "both", feature = "double"))]
type Other = f32;
#[cfg(all(feature = "both", not(feature = "double")))]
type Other = f64;

/// Friction and restitution known at run time only; the law too, unless a feature names one.
fn surface<T>(mu: T, e: T) -> Surface<T> {
    let law = if cfg!(feature = "newton") {
        Law::Newton
    } else if cfg!(feature = "poisson") {
        Law::Poisson
    } else if cfg!(feature = "stronge") {
        Law::Stronge
    } else {
        black_box(Law::Stronge)
    };
    Surface { mu: black_box(mu), e: black_box(e), law }
}

/// What a program that uses a mechanism calls.
macro_rules! uses {
    ($name:ident: $feature:literal $module:ident $type:ident $collide:ident $mode:ident $($second:ident)?) => {
        #[cfg(feature = $feature)]
        fn $name() {
            use models::$module::{Coordinates, Speeds, $type};
            let mechanism = $type::<Chosen>::default();
            let (q, u) = (black_box(Coordinates::default()), black_box(Speeds::default()));
            black_box(mechanism.accelerations(&q, &u)).ok();
            #[cfg(feature = "collide")]
            black_box(mechanism.$collide(&q, &u, &surface(0.6, 0.8))).ok();
            #[cfg(feature = "mode")]
            black_box(mechanism.$mode(&q, &u, &surface(0.6, 0.8))).ok();
            $(
                #[cfg(feature = "second")]
                black_box(mechanism.$second(&q, &u, &surface(0.6, 0.8))).ok();
            )?
            #[cfg(feature = "both")]
            {
                let mechanism = $type::<Other>::default();
                let (q, u) = (black_box(Coordinates::default()), black_box(Speeds::default()));
                black_box(mechanism.accelerations(&q, &u)).ok();
                black_box(mechanism.$collide(&q, &u, &surface(0.6, 0.8))).ok();
            }
        }
    };
}

uses!(sleds: "two_sleds" two_sleds TwoSleds collide_bc_ac contact_mode_bc_ac);
uses!(pendulum: "planar_double_pendulum" planar_double_pendulum PlanarDoublePendulum collide_tip_wall contact_mode_tip_wall);
uses!(disc: "rolling_disc" rolling_disc RollingDisc collide_rim_wall contact_mode_rim_wall collide_rim_slanted);
uses!(arm: "arm_7dof" arm_7dof Arm7dof collide_tool_plane contact_mode_tool_plane);

/// The same mechanism made a module here, with its collision as one routine in place of the usual one.
macro_rules! one_routine {
    ($name:ident: $feature:literal $module:ident $type:ident $file:literal $contact:ident) => {
        #[cfg(all(feature = "one_routine", feature = $feature))]
        mod $name {
            hodograph::mechanism!($file, specialise strike($contact, law = Stronge));

            pub fn collides() {
                use core::hint::black_box;
                use $module::{Coordinates, Speeds, $type};
                let mechanism = $type::<super::Chosen>::default();
                let (q, u) = (black_box(Coordinates::default()), black_box(Speeds::default()));
                black_box(mechanism.strike(&q, &u, black_box(0.6), black_box(0.8))).ok();
            }
        }
    };
}

one_routine!(one_of_sleds: "two_sleds" two_sleds TwoSleds "../../models/two_sleds.mech" bc_ac);
one_routine!(one_of_pendulum: "planar_double_pendulum" planar_double_pendulum PlanarDoublePendulum "../../models/planar_double_pendulum.mech" tip_wall);
one_routine!(one_of_arm: "arm_7dof" arm_7dof Arm7dof "../../models/arm_7dof.mech" tool_plane);

fn program() {
    #[cfg(all(feature = "one_routine", feature = "two_sleds"))]
    one_of_sleds::collides();
    #[cfg(all(feature = "one_routine", feature = "planar_double_pendulum"))]
    one_of_pendulum::collides();
    #[cfg(all(feature = "one_routine", feature = "arm_7dof"))]
    one_of_arm::collides();
    #[cfg(feature = "two_sleds")]
    sleds();
    #[cfg(feature = "planar_double_pendulum")]
    pendulum();
    #[cfg(feature = "rolling_disc")]
    disc();
    #[cfg(feature = "arm_7dof")]
    arm();
}

#[cfg(not(target_os = "none"))]
fn main() {
    program();
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    loop {
        program();
    }
}
