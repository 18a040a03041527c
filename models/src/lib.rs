//! Ready-made mechanisms: one module per model file, with the equations of motion and the collisions of the
//! contacts.
//!
//! The documentation of a module comes from the comments of its model, `models/<module>.mech`;
//! `docs/gallery.md` shows all mechanisms. Their equations have been derived and checked in, so that this
//! package builds without the algebra engine. It is `no_std` without the default feature `std`.
//!
//! Each module has a feature of its name; the default feature `all` has all of them. A program that uses one
//! builds one:
//!
//! ```toml
//! hodograph-models = { version = "0.1", default-features = false, features = ["two_sleds"] }
//! ```
#![cfg_attr(feature = "two_sleds", doc = "```")]
#![cfg_attr(not(feature = "two_sleds"), doc = "```ignore")]
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

mod every;

#[allow(unused_imports, reason = "without any model")]
use hodograph::mechanism;

#[cfg(feature = "arm_7dof")]
mechanism!("arm_7dof.mech");
#[cfg(feature = "ball_joint_body")]
mechanism!("ball_joint_body.mech");
#[cfg(feature = "ball_on_turntable")]
mechanism!("ball_on_turntable.mech");
#[cfg(feature = "cart_5_link")]
mechanism!("cart_5_link.mech");
#[cfg(feature = "chaplygin_sleigh")]
mechanism!("chaplygin_sleigh.mech");
#[cfg(feature = "driven_rotary_pendulum")]
mechanism!("driven_rotary_pendulum.mech");
#[cfg(feature = "five_bar")]
mechanism!("five_bar.mech");
#[cfg(feature = "four_bar")]
mechanism!("four_bar.mech");
#[cfg(feature = "free_box_corner")]
mechanism!("free_box_corner.mech");
#[cfg(feature = "free_box_quaternion")]
mechanism!("free_box_quaternion.mech");
#[cfg(feature = "planar_double_pendulum")]
mechanism!("planar_double_pendulum.mech");
#[cfg(feature = "planar_triple_pendulum")]
mechanism!("planar_triple_pendulum.mech");
#[cfg(feature = "puma_560")]
mechanism!("puma_560.mech");
#[cfg(feature = "rattleback")]
mechanism!("rattleback.mech");
#[cfg(feature = "rolling_disc")]
mechanism!("rolling_disc.mech");
#[cfg(feature = "shaken_pendulum_moving_plate")]
mechanism!("shaken_pendulum_moving_plate.mech");
#[cfg(feature = "slender_rod_5dof")]
mechanism!("slender_rod_5dof.mech");
#[cfg(feature = "slider_crank")]
mechanism!("slider_crank.mech");
#[cfg(feature = "spherical_pendulum")]
mechanism!("spherical_pendulum.mech");
#[cfg(feature = "spring_damper_cart_rod")]
mechanism!("spring_damper_cart_rod.mech");
#[cfg(feature = "stanford_arm")]
mechanism!("stanford_arm.mech");
#[cfg(feature = "two_sleds")]
mechanism!("two_sleds.mech");
#[cfg(feature = "two_sleds_planar")]
mechanism!("two_sleds_planar.mech");
#[cfg(feature = "whipple_bicycle")]
mechanism!("whipple_bicycle.mech");

/// The README's examples compile and run.
#[cfg(all(doctest, feature = "all"))]
#[doc = include_str!("../../README.md")]
struct Readme;
