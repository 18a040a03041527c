//! Links only without panics: see Cargo.toml. It is never run.
#![no_std]
#![no_main]

use core::hint::black_box;

use hodograph::nalgebra::{SMatrix, Vector2, Vector3};
use hodograph::structure::{Balanced, Diagonal, Isotropic, Structure, solve_structured};
use hodograph::{
    ClosedContactError, CollisionError, ContactError, ContactForce, ContactMode, Hodograph, Impact,
    ImpactDerivative, ImpactError, Law, ReducedMatrix, Saltation, StateError, Surface,
};
use no_panic::no_panic;

mod memory;

hodograph::mechanism!("../downstream/models/hopper.mech");
hodograph::mechanism!("../../models/two_sleds.mech", specialise strike(bc_ac, law = Stronge));
hodograph::mechanism!("../../models/arm_7dof.mech", specialise strike(tool_plane, law = Newton, mu = 0.3, e = 0.5));

use arm_7dof::Arm7dof;
use hopper::{
    ClosedContact, Collision, CollisionDerivative, Coordinates, Derivatives, Hopper, Inputs, Linearisation,
    Parameters, Speeds,
};
use two_sleds::TwoSleds;

#[no_panic]
#[inline(never)]
fn solve(
    m: &ReducedMatrix<f64>,
    v: &Vector3<f64>,
    surface: &Surface<f64>,
) -> Result<Impact<f64>, ImpactError<f64>> {
    hodograph::solve(m, v, surface)
}

#[no_panic]
#[inline(never)]
fn derivative(
    m: &ReducedMatrix<f64>,
    v: &Vector3<f64>,
    surface: &Surface<f64>,
) -> Result<ImpactDerivative<f64>, ImpactError<f64>> {
    hodograph::derivative(m, v, surface)
}

#[no_panic]
#[inline(never)]
fn closed<S: Structure>(
    m: &ReducedMatrix<f64>,
    v: &Vector3<f64>,
    surface: &Surface<f64>,
) -> Result<Impact<f64>, ImpactError<f64>> {
    solve_structured::<S, f64>(m, v, surface)
}

#[no_panic]
#[inline(never)]
fn course(m: &ReducedMatrix<f64>, v: &Vector3<f64>, surface: &Surface<f64>) -> Result<f64, ImpactError<f64>> {
    let hodograph = Hodograph::new(m, v, surface)?;
    Ok(hodograph.points(8).map(|moment| moment.slip()).sum())
}

#[no_panic]
#[inline(never)]
fn phi_bar(m: &ReducedMatrix<f64>, mu: f64, phi: f64) -> Option<f64> {
    hodograph::phi_bar(m, mu, phi)
}

#[no_panic]
#[inline(never)]
fn collide(
    hopper: &Hopper,
    q: &Coordinates,
    u: &Speeds,
    surface: &Surface<f64>,
) -> Result<Collision, CollisionError<f64>> {
    hopper.collide_foot_ground(q, u, surface)
}

#[no_panic]
#[inline(never)]
fn collide_derivative(
    hopper: &Hopper,
    q: &Coordinates,
    u: &Speeds,
    surface: &Surface<f64>,
) -> Result<CollisionDerivative, CollisionError<f64>> {
    hopper.collide_foot_ground_derivative(q, u, surface)
}

#[no_panic]
#[inline(never)]
fn saltation(
    hopper: &Hopper,
    q: &Coordinates,
    u: &Speeds,
    inputs: &Inputs,
    surface: &Surface<f64>,
) -> Result<Saltation<f64, 4>, CollisionError<f64>> {
    hopper.saltation_foot_ground(q, u, inputs, surface)
}

#[no_panic]
#[inline(never)]
fn collide_f32(
    hopper: &Hopper<f32>,
    q: &Coordinates<f32>,
    u: &Speeds<f32>,
    surface: &Surface<f32>,
) -> Result<Collision<f32>, CollisionError<f32>> {
    hopper.collide_foot_ground(q, u, surface)
}

#[no_panic]
#[inline(never)]
fn contact_mode(
    hopper: &Hopper,
    q: &Coordinates,
    u: &Speeds,
    inputs: &Inputs,
    surface: &Surface<f64>,
) -> Result<ClosedContact, ClosedContactError<f64>> {
    hopper.contact_mode_foot_ground(q, u, inputs, surface)
}

#[no_panic]
#[inline(never)]
fn contact_mode_f32(
    hopper: &Hopper<f32>,
    q: &Coordinates<f32>,
    u: &Speeds<f32>,
    inputs: &Inputs<f32>,
    surface: &Surface<f32>,
) -> Result<ClosedContact<f32>, ClosedContactError<f32>> {
    hopper.contact_mode_foot_ground(q, u, inputs, surface)
}

#[no_panic]
#[inline(never)]
fn contact_force(
    hopper: &Hopper,
    q: &Coordinates,
    u: &Speeds,
    inputs: &Inputs,
    mode: ContactMode,
    surface: &Surface<f64>,
) -> Result<ClosedContact, ClosedContactError<f64>> {
    hopper.contact_force_foot_ground(q, u, inputs, mode, surface)
}

#[no_panic]
#[inline(never)]
fn impact_without_collision(
    hopper: &Hopper,
    q: &Coordinates,
    u: &Speeds,
    surface: &Surface<f64>,
) -> Result<Collision, CollisionError<f64>> {
    hopper.impact_without_collision_foot_ground(q, u, surface)
}

#[no_panic]
#[inline(never)]
fn mode_after(
    m: &ReducedMatrix<f64>,
    beta: &Vector3<f64>,
    slip: &Vector2<f64>,
    mu: f64,
    before: &Vector3<f64>,
) -> Result<ContactForce<f64>, ContactError<f64>> {
    hodograph::contact_mode_after(m, beta, slip, mu, before)
}

#[no_panic]
#[inline(never)]
fn accelerations(
    hopper: &Hopper,
    q: &Coordinates,
    u: &Speeds,
    inputs: &Inputs,
) -> Result<Speeds, StateError> {
    hopper.accelerations(q, u, inputs)
}

#[no_panic]
#[inline(never)]
fn accelerations_derivatives(
    hopper: &Hopper,
    q: &Coordinates,
    u: &Speeds,
    inputs: &Inputs,
) -> Result<Derivatives<f64>, StateError> {
    hopper.accelerations_derivatives(q, u, inputs)
}

#[no_panic]
#[inline(never)]
fn inverse_dynamics_derivatives(
    hopper: &Hopper,
    q: &Coordinates,
    u: &Speeds,
    inputs: &Inputs,
) -> Result<Derivatives<f64>, StateError> {
    hopper.inverse_dynamics_derivatives(q, u, u, inputs)
}

#[no_panic]
#[inline(never)]
fn linearise(
    hopper: &Hopper,
    q: &Coordinates,
    u: &Speeds,
    inputs: &Inputs,
) -> Result<Linearisation<f64>, StateError> {
    hopper.linearise(q, u, inputs)
}

#[no_panic]
#[inline(never)]
fn mass_matrix(hopper: &Hopper, q: &Coordinates) -> Result<SMatrix<f64, 2, 2>, StateError> {
    hopper.mass_matrix(q)
}

#[no_panic]
#[inline(never)]
fn new(parameters: Parameters) -> Option<Hopper> {
    Hopper::new(parameters).ok()
}

/// A spatial mechanism: its constructor, accelerations, collisions and modes of contact.
macro_rules! spatial {
    ($called:ident: $module:ident $machine:ident $collide:ident $without:ident $mode:ident $strike:ident($($known:expr),*)) => {
        mod $called {
            use super::*;
            use $module::{Collision, Coordinates, Parameters, Speeds};

            type Collided = Result<Collision, CollisionError<f64>>;

            #[no_panic]
            #[inline(never)]
            fn new(parameters: Parameters) -> Option<$machine> {
                $machine::new(parameters).ok()
            }

            #[no_panic]
            #[inline(never)]
            fn accelerations(m: &$machine, q: &Coordinates, u: &Speeds) -> Result<Speeds, StateError> {
                m.accelerations(q, u)
            }

            #[no_panic]
            #[inline(never)]
            fn collide(m: &$machine, q: &Coordinates, u: &Speeds, surface: &Surface<f64>) -> Collided {
                m.$collide(q, u, surface)
            }

            #[no_panic]
            #[inline(never)]
            fn collide_f32(
                m: &$machine<f32>,
                q: &Coordinates<f32>,
                u: &Speeds<f32>,
                surface: &Surface<f32>,
            ) -> Result<Collision<f32>, CollisionError<f32>> {
                m.$collide(q, u, surface)
            }

            #[no_panic]
            #[inline(never)]
            fn strike(m: &$machine, q: &Coordinates, u: &Speeds) -> Collided {
                m.$strike(q, u, $($known),*)
            }

            #[no_panic]
            #[inline(never)]
            fn without(m: &$machine, q: &Coordinates, u: &Speeds, surface: &Surface<f64>) -> Collided {
                m.$without(q, u, surface)
            }

            #[no_panic]
            #[inline(never)]
            fn mode(
                m: &$machine,
                q: &Coordinates,
                u: &Speeds,
                surface: &Surface<f64>,
            ) -> Result<$module::ClosedContact, ClosedContactError<f64>> {
                m.$mode(q, u, surface)
            }

            pub fn all(surface: &Surface<f64>) {
                let (q, u) = (black_box(Coordinates::default()), black_box(Speeds::default()));
                if let Some(m) = new(black_box(Parameters::default())) {
                    black_box(accelerations(&m, &q, &u).is_ok());
                    black_box(collide(&m, &q, &u, surface).is_ok());
                    black_box(strike(&m, &q, &u).is_ok());
                    black_box(without(&m, &q, &u, surface).is_ok());
                    black_box(mode(&m, &q, &u, surface).is_ok());
                }
                let (q, u) = (black_box(Coordinates::default()), black_box(Speeds::default()));
                let surface = black_box(Surface { mu: 0.6, e: 0.2, law: Law::Stronge });
                black_box(collide_f32(&black_box($machine::default()), &q, &u, &surface).is_ok());
            }
        }
    };
}

spatial!(sleds: two_sleds TwoSleds collide_bc_ac impact_without_collision_bc_ac contact_mode_bc_ac strike(black_box(0.6), black_box(0.8)));
spatial!(arm: arm_7dof Arm7dof collide_tool_plane impact_without_collision_tool_plane contact_mode_tool_plane strike());

#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    let surface = black_box(Surface { mu: 0.6, e: 0.2, law: Law::Stronge });
    let (q, u) = (black_box(Coordinates::default()), black_box(Speeds { u1: -2.0, u2: 0.1 }));
    if let Some(hopper) = new(black_box(Parameters::default())) {
        black_box(collide(&hopper, &q, &u, &surface).is_ok());
        black_box(collide_derivative(&hopper, &q, &u, &surface).is_ok());
        black_box(saltation(&hopper, &q, &u, &Inputs::default(), &surface).is_ok());
        black_box(accelerations(&hopper, &q, &u, &Inputs::default()).is_ok());
        black_box(accelerations_derivatives(&hopper, &q, &u, &Inputs::default()).is_ok());
        black_box(inverse_dynamics_derivatives(&hopper, &q, &u, &Inputs::default()).is_ok());
        black_box(linearise(&hopper, &q, &u, &Inputs::default()).is_ok());
        black_box(mass_matrix(&hopper, &q).is_ok());
        black_box(contact_mode(&hopper, &q, &u, &Inputs::default(), &surface).is_ok());
        black_box(
            contact_force(&hopper, &q, &u, &Inputs::default(), black_box(ContactMode::Stick), &surface)
                .is_ok(),
        );
        black_box(impact_without_collision(&hopper, &q, &u, &surface).is_ok());
    }
    sleds::all(&surface);
    arm::all(&surface);
    let surface = black_box(Surface { mu: 0.6, e: 0.2, law: Law::Poisson });
    let (q, u) = (black_box(Coordinates::default()), black_box(Speeds { u1: -2.0, u2: 0.1 }));
    black_box(collide_f32(&black_box(Hopper::default()), &q, &u, &surface).is_ok());
    black_box(contact_mode_f32(&black_box(Hopper::default()), &q, &u, &Inputs::default(), &surface).is_ok());
    let m = black_box(ReducedMatrix::new(1.0, 0.1, 0.2, 1.0, 0.1, 1.0));
    let surface = black_box(Surface { mu: 0.6, e: 0.2, law: Law::Newton });
    black_box(solve(&m, &black_box(Vector3::new(-1.0, 0.5, 0.1)), &surface).is_ok());
    let v = black_box(Vector3::new(-1.0, 0.5, 0.1));
    black_box(derivative(&m, &v, &surface).is_ok());
    black_box(mode_after(&m, &v, &black_box(v.yz()), surface.mu, &black_box(v)).is_ok());
    black_box(closed::<Balanced>(&m, &v, &surface).is_ok());
    black_box(closed::<Diagonal>(&m, &v, &surface).is_ok());
    black_box(closed::<Isotropic>(&m, &v, &surface).is_ok());
    black_box(course(&m, &black_box(Vector3::new(-1.0, 0.5, 0.1)), &surface).is_ok());
    black_box(phi_bar(&m, surface.mu, black_box(0.3)).is_some());
    loop {}
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
