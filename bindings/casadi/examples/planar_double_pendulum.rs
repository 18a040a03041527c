//! The double pendulum whose twenty states have the same bits through every door.

hodograph::mechanism!("../../models/planar_double_pendulum.mech");

hodograph_casadi::external!("planar_double_pendulum" => planar_double_pendulum::PlanarDoublePendulum(q, u));
