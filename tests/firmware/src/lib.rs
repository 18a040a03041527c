//! What the programs share: numbers that are told by their bits, random states, and the surroundings: a board or this machine.

#![cfg_attr(target_os = "none", no_std)]

pub mod bits;
pub mod board;
pub mod hard;
pub mod juggling;
pub mod random;

#[doc(hidden)]
pub use hodograph_models as models;

/// Calls a function with a writer, and each shipped mechanism whose feature is on, in numbers of a type.
#[macro_export]
macro_rules! shipped {
    ($call:ident, $number:ty, $output:expr) => {
        $crate::shipped! { @ $call, $number, $output,
            "arm_7dof" arm_7dof Arm7dof,
            "ball_joint_body" ball_joint_body BallJointBody,
            "ball_on_turntable" ball_on_turntable BallOnTurntable,
            "cart_5_link" cart_5_link Cart5Link,
            "chaplygin_sleigh" chaplygin_sleigh ChaplyginSleigh,
            "driven_rotary_pendulum" driven_rotary_pendulum DrivenRotaryPendulum,
            "five_bar" five_bar FiveBar,
            "four_bar" four_bar FourBar,
            "free_box_corner" free_box_corner FreeBoxCorner,
            "free_box_quaternion" free_box_quaternion FreeBoxQuaternion,
            "planar_double_pendulum" planar_double_pendulum PlanarDoublePendulum,
            "planar_triple_pendulum" planar_triple_pendulum PlanarTriplePendulum,
            "puma_560" puma_560 Puma560,
            "rattleback" rattleback Rattleback,
            "rolling_disc" rolling_disc RollingDisc,
            "shaken_pendulum_moving_plate" shaken_pendulum_moving_plate ShakenPendulumMovingPlate,
            "slender_rod_5dof" slender_rod_5dof SlenderRod5dof,
            "slider_crank" slider_crank SliderCrank,
            "spherical_pendulum" spherical_pendulum SphericalPendulum,
            "spring_damper_cart_rod" spring_damper_cart_rod SpringDamperCartRod,
            "stanford_arm" stanford_arm StanfordArm,
            "two_sleds" two_sleds TwoSleds,
            "two_sleds_planar" two_sleds_planar TwoSledsPlanar,
            "whipple_bicycle" whipple_bicycle WhippleBicycle,
        }
    };
    (@ $call:ident, $number:ty, $output:expr, $($feature:literal $module:ident $type:ident,)*) => {
        $(#[cfg(feature = $feature)]
        $call::<$number>($output, &$crate::models::$module::$type::<$number>::default());)*
    };
}
