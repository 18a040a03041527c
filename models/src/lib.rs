//! Ready-made mechanisms: a module for every model file of this package. Each is documented from its model.
#![no_std]

hodograph::mechanism!("arm_7dof.mech");
hodograph::mechanism!("ball_joint_body.mech");
hodograph::mechanism!("cart_5_link.mech");
hodograph::mechanism!("chaplygin_sleigh.mech");
hodograph::mechanism!("driven_rotary_pendulum.mech");
hodograph::mechanism!("five_bar.mech");
hodograph::mechanism!("four_bar.mech");
hodograph::mechanism!("free_box_corner.mech");
hodograph::mechanism!("planar_double_pendulum.mech");
hodograph::mechanism!("planar_triple_pendulum.mech");
hodograph::mechanism!("puma_560.mech");
hodograph::mechanism!("rattleback.mech");
hodograph::mechanism!("rolling_disc.mech");
hodograph::mechanism!("shaken_pendulum_moving_plate.mech");
hodograph::mechanism!("slender_rod_5dof.mech");
hodograph::mechanism!("slider_crank.mech");
hodograph::mechanism!("spherical_pendulum.mech");
hodograph::mechanism!("spring_damper_cart_rod.mech");
hodograph::mechanism!("stanford_arm.mech");
hodograph::mechanism!("two_sleds.mech");
hodograph::mechanism!("two_sleds_planar.mech");
hodograph::mechanism!("whipple_bicycle.mech");
