//! The emitted modules of all shipped models behind one interface.

use hodograph::{Path, Surface};
use hodograph_generator::interpret::Inputs;

/// An emitted module. Matrices are by rows.
pub trait Emitted {
    /// name of the module
    fn name(&self) -> &'static str;
    /// M
    fn mass_matrix(&self, at: &Inputs) -> Vec<f64>;
    /// forcing
    fn forcing(&self, at: &Inputs) -> Vec<f64>;
    /// u'
    fn accelerations(&self, at: &Inputs) -> Vec<f64>;
    /// q'
    fn coordinate_rates(&self, at: &Inputs) -> Vec<f64>;
    /// dependent speeds, if there are any
    fn dependent_speeds(&self, at: &Inputs) -> Vec<f64>;
    /// kinetic energy
    fn kinetic_energy(&self, at: &Inputs) -> f64;
    /// reduced matrix of a contact: nn, n1, n2, 11, 12, 22
    fn reduced_matrix(&self, contact: usize, at: &Inputs) -> [f64; 6];
    /// partial velocities of a contact
    fn partial_velocities(&self, contact: usize, at: &Inputs) -> Vec<f64>;
    /// relative velocity of a contact, in its basis
    fn contact_velocity(&self, contact: usize, at: &Inputs) -> [f64; 3];
    /// a collision; the error is its message
    fn collide(&self, contact: usize, at: &Inputs, surface: &Surface<f64>) -> Result<Hit, String>;
}

/// A solved collision.
#[derive(Clone, Debug)]
pub struct Hit {
    /// independent speeds after it
    pub speeds: Vec<f64>,
    /// impulse along n, t, s
    pub impulse: [f64; 3],
    /// velocity of approach along n, t, s
    pub approach: [f64; 3],
    /// velocity of separation along n, t, s
    pub separation: [f64; 3],
    /// reduced matrix along n, t, s: nn, nt, ns, tt, ts, ss
    pub reduced: [f64; 6],
    /// change of kinetic energy
    pub energy_change: f64,
    /// work of the contact impulse
    pub contact_work: f64,
    /// work of the normal impulse
    pub normal_work: f64,
    /// phases
    pub path: Path,
}

/// A list as an array.
fn array<const N: usize>(list: &[f64]) -> [f64; N] {
    list.try_into().expect("as many numbers as fields")
}

macro_rules! call {
    (plain $m:expr, $f:ident, $at:expr, $loads:tt, $($a:expr),*) => { $m.$f($($a),*) };
    (time $m:expr, $f:ident, $at:expr, $loads:tt, $($a:expr),*) => { $m.$f($at.time, $($a),*) };
    (inputs $m:expr, $f:ident, $at:expr, loads, $($a:expr),*) => { $m.$f($($a,)* &array(&$at.inputs).into()) };
    (inputs $m:expr, $f:ident, $at:expr, no, $($a:expr),*) => { $m.$f($($a),*) };
}

macro_rules! modules {
    ($($module:ident $type:ident $kind:ident $dependent:ident {
        $($index:literal $reduced:ident $partial:ident $velocity:ident $collide:ident),*
    })*) => {
        $(
            #[allow(non_camel_case_types)]
            struct $module;

            impl $module {
                fn at(at: &Inputs) -> (
                    hodograph_models::$module::$type<f64>,
                    hodograph_models::$module::Coordinates<f64>,
                    hodograph_models::$module::Speeds<f64>,
                ) {
                    let parameters = array(&at.parameters).into();
                    let machine = hodograph_models::$module::$type::new(parameters).expect("good parameters");
                    (machine, array(&at.coordinates).into(), array(&at.speeds).into())
                }
            }

            impl Emitted for $module {
                fn name(&self) -> &'static str {
                    stringify!($module)
                }
                fn mass_matrix(&self, at: &Inputs) -> Vec<f64> {
                    let (m, q, _) = Self::at(at);
                    call!($kind m, mass_matrix, at, no, &q).unwrap().transpose().as_slice().to_vec()
                }
                fn forcing(&self, at: &Inputs) -> Vec<f64> {
                    let (m, q, u) = Self::at(at);
                    call!($kind m, forcing, at, loads, &q, &u).unwrap().as_slice().to_vec()
                }
                fn accelerations(&self, at: &Inputs) -> Vec<f64> {
                    let (m, q, u) = Self::at(at);
                    let rates = call!($kind m, accelerations, at, loads, &q, &u).unwrap();
                    <[f64; _]>::from(rates).to_vec()
                }
                fn coordinate_rates(&self, at: &Inputs) -> Vec<f64> {
                    let (m, q, u) = Self::at(at);
                    <[f64; _]>::from(call!($kind m, coordinate_rates, at, no, &q, &u).unwrap()).to_vec()
                }
                fn dependent_speeds(&self, at: &Inputs) -> Vec<f64> {
                    dependent!($dependent Self $kind at)
                }
                fn kinetic_energy(&self, at: &Inputs) -> f64 {
                    let (m, q, u) = Self::at(at);
                    call!($kind m, kinetic_energy, at, no, &q, &u).unwrap()
                }
                fn reduced_matrix(&self, contact: usize, at: &Inputs) -> [f64; 6] {
                    let (m, q, _) = Self::at(at);
                    match contact {
                        $($index => call!($kind m, $reduced, at, no, &q).unwrap().into(),)*
                        _ => panic!("no contact {contact}"),
                    }
                }
                fn partial_velocities(&self, contact: usize, at: &Inputs) -> Vec<f64> {
                    let (m, q, _) = Self::at(at);
                    match contact {
                        $($index => call!($kind m, $partial, at, no, &q).unwrap().transpose().as_slice().to_vec(),)*
                        _ => panic!("no contact {contact}"),
                    }
                }
                fn contact_velocity(&self, contact: usize, at: &Inputs) -> [f64; 3] {
                    let (m, q, u) = Self::at(at);
                    match contact {
                        $($index => call!($kind m, $velocity, at, no, &q, &u).unwrap().into(),)*
                        _ => panic!("no contact {contact}"),
                    }
                }
                fn collide(&self, contact: usize, at: &Inputs, surface: &Surface<f64>) -> Result<Hit, String> {
                    let (m, q, u) = Self::at(at);
                    match contact {
                        $($index => {
                            let hit = call!($kind m, $collide, at, no, &q, &u, surface).map_err(|e| e.to_string())?;
                            Ok(Hit {
                                speeds: <[f64; _]>::from(hit.speeds).to_vec(),
                                impulse: hit.impulse.into(),
                                approach: hit.approach.into(),
                                separation: hit.separation.into(),
                                reduced: hit.reduced.into(),
                                energy_change: hit.energy_change,
                                contact_work: hit.impact.contact_work,
                                normal_work: hit.impact.normal_work,
                                path: hit.path,
                            })
                        })*
                        _ => panic!("no contact {contact}"),
                    }
                }
            }
        )*

        /// All of them.
        pub fn emitted() -> Vec<Box<dyn Emitted>> {
            vec![$(Box::new($module)),*]
        }
    };
}

macro_rules! dependent {
    (independent $self:ident $kind:ident $at:ident) => {{
        let _ = $at;
        Vec::new()
    }};
    (dependent $self:ident $kind:ident $at:ident) => {{
        let (m, q, u) = $self::at($at);
        <[f64; _]>::from(call!($kind m, dependent_speeds, $at, no, &q, &u).unwrap()).to_vec()
    }};
}

// module, type, what its methods take besides q and u, whether there are dependent speeds, and its contacts
modules! {
    arm_7dof Arm7dof plain independent {
        0 reduced_matrix_tool_plane partial_velocities_tool_plane contact_velocity_tool_plane collide_tool_plane
    }
    ball_joint_body BallJointBody plain independent {
        0 reduced_matrix_tip partial_velocities_tip contact_velocity_tip collide_tip
    }
    cart_5_link Cart5Link plain independent {
        0 reduced_matrix_tip_wall partial_velocities_tip_wall contact_velocity_tip_wall collide_tip_wall
    }
    chaplygin_sleigh ChaplyginSleigh plain dependent {
        0 reduced_matrix_post partial_velocities_post contact_velocity_post collide_post,
        1 reduced_matrix_slanted partial_velocities_slanted contact_velocity_slanted collide_slanted
    }
    driven_rotary_pendulum DrivenRotaryPendulum time independent {
        0 reduced_matrix_tip_wall partial_velocities_tip_wall contact_velocity_tip_wall collide_tip_wall
    }
    five_bar FiveBar plain dependent {
        0 reduced_matrix_tip_table partial_velocities_tip_table contact_velocity_tip_table collide_tip_table
    }
    four_bar FourBar plain dependent {
        0 reduced_matrix_coupler_wall partial_velocities_coupler_wall contact_velocity_coupler_wall collide_coupler_wall
    }
    free_box_corner FreeBoxCorner plain independent {
        0 reduced_matrix_corner partial_velocities_corner contact_velocity_corner collide_corner
    }
    free_box_quaternion FreeBoxQuaternion plain independent {
        0 reduced_matrix_corner partial_velocities_corner contact_velocity_corner collide_corner
    }
    planar_double_pendulum PlanarDoublePendulum plain independent {
        0 reduced_matrix_tip_wall partial_velocities_tip_wall contact_velocity_tip_wall collide_tip_wall
    }
    planar_triple_pendulum PlanarTriplePendulum plain independent {
        0 reduced_matrix_tip_wall partial_velocities_tip_wall contact_velocity_tip_wall collide_tip_wall
    }
    puma_560 Puma560 inputs independent {
        0 reduced_matrix_flange_table partial_velocities_flange_table contact_velocity_flange_table collide_flange_table
    }
    rattleback Rattleback plain dependent {
        0 reduced_matrix_tip_shelf partial_velocities_tip_shelf contact_velocity_tip_shelf collide_tip_shelf
    }
    rolling_disc RollingDisc plain dependent {
        0 reduced_matrix_rim_wall partial_velocities_rim_wall contact_velocity_rim_wall collide_rim_wall,
        1 reduced_matrix_rim_slanted partial_velocities_rim_slanted contact_velocity_rim_slanted collide_rim_slanted
    }
    shaken_pendulum_moving_plate ShakenPendulumMovingPlate time independent {
        0 reduced_matrix_tip_plate partial_velocities_tip_plate contact_velocity_tip_plate collide_tip_plate
    }
    slender_rod_5dof SlenderRod5dof plain independent {
        0 reduced_matrix_end partial_velocities_end contact_velocity_end collide_end
    }
    slider_crank SliderCrank plain dependent {
        0 reduced_matrix_rod_floor partial_velocities_rod_floor contact_velocity_rod_floor collide_rod_floor,
        1 reduced_matrix_slider_wall partial_velocities_slider_wall contact_velocity_slider_wall collide_slider_wall
    }
    spherical_pendulum SphericalPendulum plain independent {
        0 reduced_matrix_tip partial_velocities_tip contact_velocity_tip collide_tip
    }
    spring_damper_cart_rod SpringDamperCartRod plain independent {
        0 reduced_matrix_tip_floor partial_velocities_tip_floor contact_velocity_tip_floor collide_tip_floor
    }
    stanford_arm StanfordArm inputs independent {
        0 reduced_matrix_hand_table partial_velocities_hand_table contact_velocity_hand_table collide_hand_table
    }
    two_sleds TwoSleds plain dependent {
        0 reduced_matrix_bc_ac partial_velocities_bc_ac contact_velocity_bc_ac collide_bc_ac
    }
    two_sleds_planar TwoSledsPlanar plain dependent {
        0 reduced_matrix_bc_ac partial_velocities_bc_ac contact_velocity_bc_ac collide_bc_ac
    }
    whipple_bicycle WhippleBicycle plain dependent {
        0 reduced_matrix_handlebar_wall partial_velocities_handlebar_wall contact_velocity_handlebar_wall collide_handlebar_wall,
        1 reduced_matrix_kerb partial_velocities_kerb contact_velocity_kerb collide_kerb
    }
}
