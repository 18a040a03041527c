//! The juggler of the simulation's examples: its controller, the machine itself and the trial.

hodograph::mechanism!("../../simulation/models/juggler.mech");

#[path = "../../../simulation/examples/juggling/control.rs"]
pub mod control;
#[path = "../../../simulation/examples/juggling/plant.rs"]
pub mod plant;
#[path = "../../../simulation/examples/juggling/trial.rs"]
pub mod trial;
