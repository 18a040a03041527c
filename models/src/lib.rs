//! Ready-made mechanisms: one module per model file, with the equations of motion and the collisions of the contacts.
//!
//! The documentation of a module comes from the comments of its model, `models/<module>.mech`; `docs/gallery.md` shows all mechanisms. Their equations
//! have been derived and checked in, so that this package builds without the algebra engine. It is `no_std` without the default feature `std`.
//!
//! ```
//! use hodograph::{Law, Surface};
//! use hodograph_models::two_sleds::{Coordinates, Speeds, TwoSleds};
//!
//! let sleds = TwoSleds::<f64>::default();
//! let (q, u) = (Coordinates::default(), Speeds::default());
//! let hit = sleds.collide_bc_ac(&q, &u, &Surface { mu: 0.6, e: 0.8, law: Law::Stronge })?;
//! assert!((hit.separation.x - 0.51153).abs() < 1e-5);
//! # Ok::<(), hodograph::CollisionError<f64>>(())
//! ```
#![no_std]

use hodograph::mechanism;

mechanism!("arm_7dof.mech");
mechanism!("ball_joint_body.mech");
mechanism!("ball_on_turntable.mech");
mechanism!("cart_5_link.mech");
mechanism!("chaplygin_sleigh.mech");
mechanism!("driven_rotary_pendulum.mech");
mechanism!("five_bar.mech");
mechanism!("four_bar.mech");
mechanism!("free_box_corner.mech");
mechanism!("free_box_quaternion.mech");
mechanism!("planar_double_pendulum.mech");
mechanism!("planar_triple_pendulum.mech");
mechanism!("puma_560.mech");
mechanism!("rattleback.mech");
mechanism!("rolling_disc.mech");
mechanism!("shaken_pendulum_moving_plate.mech");
mechanism!("slender_rod_5dof.mech");
mechanism!("slider_crank.mech");
mechanism!("spherical_pendulum.mech");
mechanism!("spring_damper_cart_rod.mech");
mechanism!("stanford_arm.mech");
mechanism!("two_sleds.mech");
mechanism!("two_sleds_planar.mech");
mechanism!("whipple_bicycle.mech");

/// The README's examples compile and run.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
