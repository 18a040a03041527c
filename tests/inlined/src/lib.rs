//! Collisions of the two sleds, of the planar double pendulum and of the arm, each as one routine, and two as
//! usual to compare with.
#![no_std]

/// The number type.
#[cfg(not(feature = "single"))]
pub type Number = f64;
/// The number type.
#[cfg(feature = "single")]
pub type Number = f32;

hodograph::mechanism!(
    "../../models/two_sleds.mech",
    specialise newton(bc_ac, law = Newton),
    specialise poisson(bc_ac, law = Poisson),
    specialise stronge(bc_ac, law = Stronge, budget = 8),
    specialise any_law(bc_ac),
);
hodograph::mechanism!("../../models/planar_double_pendulum.mech", specialise poisson(tip_wall, law = Poisson));
hodograph::mechanism!("../../models/arm_7dof.mech", specialise fixed(tool_plane, law = Newton, mu = 0.3, e = 0.5));

macro_rules! compiled {
    ($($name:ident: $module:ident $machine:ident $method:ident($($argument:ident: $of_type:ty),*);)*) => {$(
        #[allow(missing_docs)]
        pub fn $name(
            machine: &$module::$machine<Number>,
            q: &$module::Coordinates<Number>,
            u: &$module::Speeds<Number>,
            $($argument: $of_type),*
        ) -> Result<$module::Collision<Number>, hodograph::CollisionError<Number>> {
            machine.$method(q, u, $($argument),*)
        }
    )*};
}

compiled! {
    sleds_newton: two_sleds TwoSleds newton(mu: Number, e: Number);
    sleds_poisson: two_sleds TwoSleds poisson(mu: Number, e: Number);
    sleds_stronge: two_sleds TwoSleds stronge(mu: Number, e: Number);
    sleds_any_law: two_sleds TwoSleds any_law(mu: Number, e: Number, law: hodograph::Law);
    sleds_shared: two_sleds TwoSleds collide_bc_ac(surface: &hodograph::Surface<Number>);
    pendulum_poisson: planar_double_pendulum PlanarDoublePendulum poisson(mu: Number, e: Number);
    arm_fixed: arm_7dof Arm7dof fixed();
    arm_shared: arm_7dof Arm7dof collide_tool_plane(surface: &hodograph::Surface<Number>);
}
