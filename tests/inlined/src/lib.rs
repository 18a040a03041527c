//! Collisions as one routine each: of the two sleds, of the planar double pendulum, of the arm, and of a
//! mechanism for each other structure of the reduced matrix. Some as usual to compare with.
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
hodograph::mechanism!(
    "../models/crossing_rails.mech",
    specialise isotropic(upper_lower, law = Stronge),
    specialise isotropic_any_law(upper_lower),
);
hodograph::mechanism!(
    "../models/gantry.mech",
    specialise diagonal(tool_table, law = Newton),
    specialise diagonal_any_law(tool_table),
);
hodograph::mechanism!(
    "../models/askew_gantry.mech",
    specialise balanced(tool_table, law = Poisson),
    specialise balanced_any_law(tool_table),
);

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
    rails_isotropic: crossing_rails CrossingRails isotropic(mu: Number, e: Number);
    rails_any_law: crossing_rails CrossingRails isotropic_any_law(mu: Number, e: Number, law: hodograph::Law);
    rails_shared: crossing_rails CrossingRails collide_upper_lower(surface: &hodograph::Surface<Number>);
    gantry_diagonal: gantry Gantry diagonal(mu: Number, e: Number);
    gantry_any_law: gantry Gantry diagonal_any_law(mu: Number, e: Number, law: hodograph::Law);
    gantry_shared: gantry Gantry collide_tool_table(surface: &hodograph::Surface<Number>);
    askew_balanced: askew_gantry AskewGantry balanced(mu: Number, e: Number);
    askew_any_law: askew_gantry AskewGantry balanced_any_law(mu: Number, e: Number, law: hodograph::Law);
    askew_shared: askew_gantry AskewGantry collide_tool_table(surface: &hodograph::Surface<Number>);
    arm_shared: arm_7dof Arm7dof collide_tool_plane(surface: &hodograph::Surface<Number>);
}
