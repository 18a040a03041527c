//! Parts of the robot.

pub mod arm;
