//! The list of all mechanisms of the package, for programs that do the same with each.

/// Gives all mechanisms of this package to a macro of the caller: `every_mechanism!(mine)` becomes `mine! {
/// "arm_7dof" arm_7dof Arm7dof, .. }`, with the name of the feature, the module and the type of each. The
/// list does not depend on the features that are on. What follows the macro's name is put before the list:
/// `every_mechanism!(mine, f64;)` becomes `mine! { f64; "arm_7dof" arm_7dof Arm7dof, .. }`.
#[cfg_attr(feature = "all", doc = "```")]
#[cfg_attr(not(feature = "all"), doc = "```ignore")]
/// use hodograph::{ComponentKind, Mechanism};
///
/// macro_rules! speeds {
///     ($($feature:literal $module:ident $mechanism:ident,)*) => {
///         [$(($feature, hodograph_models::$module::$mechanism::<f64>::default().count(ComponentKind::Speed))),*]
///     };
/// }
///
/// let speeds = hodograph_models::every_mechanism!(speeds);
/// assert!(speeds.contains(&("two_sleds", 4)));
/// ```
#[macro_export]
macro_rules! every_mechanism {
    ($callback:ident $(, $($before:tt)*)?) => {
        $callback! { $($($before)*)?
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
}
