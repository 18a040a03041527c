//! Collisions of the two sleds, of the planar double pendulum and of the arm, each as one routine.
#![no_std]

/// The number type: doubles on this machine, singles on a processor that has these only.
#[cfg(target_pointer_width = "64")]
pub type Number = f64;
#[cfg(not(target_pointer_width = "64"))]
pub type Number = f32;

type Answer<C> = Result<C, hodograph::CollisionError<Number>>;

hodograph::mechanism!("../../models/two_sleds.mech", specialise strike(bc_ac, law = Stronge));
hodograph::mechanism!("../../models/planar_double_pendulum.mech", specialise strike(tip_wall, law = Poisson));
hodograph::mechanism!("../../models/arm_7dof.mech", specialise strike(tool_plane, law = Newton, mu = 0.3, e = 0.5));

pub fn sleds(
    m: &two_sleds::TwoSleds<Number>,
    q: &two_sleds::Coordinates<Number>,
    u: &two_sleds::Speeds<Number>,
    mu: Number,
    e: Number,
) -> Answer<two_sleds::Collision<Number>> {
    m.strike(q, u, mu, e)
}

pub fn pendulum(
    m: &planar_double_pendulum::PlanarDoublePendulum<Number>,
    q: &planar_double_pendulum::Coordinates<Number>,
    u: &planar_double_pendulum::Speeds<Number>,
    mu: Number,
    e: Number,
) -> Answer<planar_double_pendulum::Collision<Number>> {
    m.strike(q, u, mu, e)
}

pub fn arm(
    m: &arm_7dof::Arm7dof<Number>,
    q: &arm_7dof::Coordinates<Number>,
    u: &arm_7dof::Speeds<Number>,
) -> Answer<arm_7dof::Collision<Number>> {
    m.strike(q, u)
}
