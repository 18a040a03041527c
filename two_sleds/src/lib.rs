//! The mechanism `TwoSleds` for C: see `include/two_sleds.h`.

#![cfg_attr(not(feature = "std"), no_std)]
#![allow(clippy::missing_safety_doc, clippy::useless_conversion)]

mod mechanism;

use hodograph::nalgebra::Matrix3;
use hodograph::{
    ClosedContactError, CollisionError, ContactError, ContactMode, ImpactError, Law, ParameterError, Path, StateError, Surface,
};
use mechanism::two_sleds as model;

#[cfg(not(feature = "std"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// The mechanism as C keeps it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CMechanism([f64; 70]);

type Mechanism = model::TwoSleds<f64>;
const _: () = assert!(size_of::<Mechanism>() <= size_of::<CMechanism>() && align_of::<Mechanism>() <= align_of::<CMechanism>());

/// Friction and restitution as C gives them.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CSurface {
    mu: f64,
    e: f64,
    law: i32,
}

/// the answer is there
pub const OK: i32 = 0;
/// a pointer is null
pub const NULL: i32 = 1;
/// a parameter is not finite, a mass is not positive, no body can have an inertia, or a divisor is zero
pub const PARAMETER: i32 = 2;
/// the state is singular
pub const SINGULAR: i32 = 3;
/// a number that went in, or the answer, is not finite
pub const NOT_FINITE: i32 = 4;
/// the quantity has no value in this state
pub const UNDEFINED: i32 = 5;
/// the surface names no hypothesis of restitution
pub const UNKNOWN_LAW: i32 = 6;
/// the coefficient of friction is negative
pub const NEGATIVE_FRICTION: i32 = 7;
/// the coefficient of restitution is not between 0 and 1
pub const RESTITUTION_OUT_OF_RANGE: i32 = 8;
/// the bodies do not approach each other: there is no collision
pub const NOT_APPROACHING: i32 = 9;
/// no mechanism has such a reduced matrix
pub const NOT_POSITIVE_SEMIDEFINITE: i32 = 10;
/// no impulse changes the normal velocity
pub const NO_NORMAL_MOBILITY: i32 = 11;
/// finite forces exist: there is no impact without collision
pub const NO_IMPACT: i32 = 12;
/// the outcome would break a law of mechanics by rounding
pub const INACCURATE: i32 = 13;
/// no finite force satisfies Coulomb's law: an impact without collision follows
pub const IMPACT_WITHOUT_COLLISION: i32 = 14;
/// the contact jams: the force grows without bound
pub const JAM: i32 = 15;
/// no mode of the contact fits
pub const NO_MODE: i32 = 16;
/// another error
pub const OTHER: i32 = 17;

fn state(error: &StateError) -> i32 {
    match error {
        StateError::Singular { .. } => SINGULAR,
        StateError::NotFinite => NOT_FINITE,
        StateError::Undefined { .. } => UNDEFINED,
        _ => OTHER,
    }
}

fn impact<T>(error: &ImpactError<T>) -> i32 {
    match error {
        ImpactError::NotFinite { .. } => NOT_FINITE,
        ImpactError::NegativeFriction { .. } => NEGATIVE_FRICTION,
        ImpactError::RestitutionOutOfRange { .. } => RESTITUTION_OUT_OF_RANGE,
        ImpactError::NotApproaching { .. } => NOT_APPROACHING,
        ImpactError::NotPositiveSemidefinite { .. } => NOT_POSITIVE_SEMIDEFINITE,
        ImpactError::NoNormalMobility { .. } => NO_NORMAL_MOBILITY,
        ImpactError::NoImpact { .. } => NO_IMPACT,
        ImpactError::Inaccurate { .. } => INACCURATE,
        _ => OTHER,
    }
}

trait Status {
    fn status(&self) -> i32;
}

impl Status for StateError {
    fn status(&self) -> i32 {
        state(self)
    }
}

impl Status for ParameterError {
    fn status(&self) -> i32 {
        PARAMETER
    }
}

impl<T> Status for CollisionError<T> {
    fn status(&self) -> i32 {
        match self {
            CollisionError::State(error) => state(error),
            CollisionError::Impact(error) => impact(error),
            _ => OTHER,
        }
    }
}

impl<T> Status for ClosedContactError<T> {
    fn status(&self) -> i32 {
        match self {
            ClosedContactError::State(error) => state(error),
            ClosedContactError::Contact(ContactError::ImpactWithoutCollision { .. }) => IMPACT_WITHOUT_COLLISION,
            ClosedContactError::Contact(ContactError::Jam { .. }) => JAM,
            ClosedContactError::Contact(ContactError::NoMode { .. }) => NO_MODE,
            ClosedContactError::Contact(ContactError::Input(error)) => impact(error),
            _ => OTHER,
        }
    }
}

fn surface_of<T: Copy>(mu: T, e: T, law: i32) -> Option<Surface<T>> {
    let law = match law {
        0 => Law::Newton,
        1 => Law::Poisson,
        2 => Law::Stronge,
        _ => return None,
    };
    Some(Surface { mu, e, law })
}

#[allow(unreachable_patterns)]
fn path(path: Path) -> i32 {
    match path {
        Path::Sliding => 0,
        Path::SlidingThenSticking => 1,
        Path::SlidingThenRenewal => 2,
        Path::Sticking => 3,
        Path::Renewal => 4,
        _ => -1,
    }
}

#[allow(unreachable_patterns)]
fn mode(mode: ContactMode) -> i32 {
    match mode {
        ContactMode::Separate => 0,
        ContactMode::Slide => 1,
        ContactMode::Stick => 2,
        ContactMode::BeginSlip => 3,
        _ => -1,
    }
}

/// Collision as C has it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CCollision {
    speeds: [f64; 4],
    impulse: [f64; 3],
    impulse_on_point: [f64; 3],
    impulse_on_struck: [f64; 3],
    normal: [f64; 3],
    tangent: [f64; 3],
    binormal: [f64; 3],
    approach: [f64; 3],
    separation: [f64; 3],
    reduced: [[f64; 3]; 3],
    energy_change: f64,
    path: i32,
}

impl From<model::Collision<f64>> for CCollision {
    fn from(value: model::Collision<f64>) -> Self {
        CCollision {
            speeds: value.speeds.into(),
            impulse: value.impulse.into(),
            impulse_on_point: value.impulse_on_point.into(),
            impulse_on_struck: value.impulse_on_struck.into(),
            normal: value.normal.into(),
            tangent: value.tangent.into(),
            binormal: value.binormal.into(),
            approach: value.approach.into(),
            separation: value.separation.into(),
            reduced: Matrix3::from(value.reduced).transpose().into(),
            energy_change: value.energy_change,
            path: path(value.path),
        }
    }
}

/// ClosedContact as C has it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CClosedContact {
    mode: i32,
    accelerations: [f64; 4],
    force: [f64; 3],
    force_on_point: [f64; 3],
    force_on_struck: [f64; 3],
    contact_acceleration: [f64; 3],
    direction: [f64; 3],
}

impl From<model::ClosedContact<f64>> for CClosedContact {
    fn from(value: model::ClosedContact<f64>) -> Self {
        CClosedContact {
            mode: mode(value.mode),
            accelerations: value.accelerations.into(),
            force: value.force.into(),
            force_on_point: value.force_on_point.into(),
            force_on_struck: value.force_on_struck.into(),
            contact_acceleration: value.contact_acceleration.into(),
            direction: value.direction.map_or([0.0; 3], Into::into),
        }
    }
}

/// Linearisation as C has it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CLinearisation {
    a: [[f64; 10]; 10],
}

impl From<model::Linearisation<f64>> for CLinearisation {
    fn from(value: model::Linearisation<f64>) -> Self {
        CLinearisation {
            a: value.a.transpose().into(),
        }
    }
}

/// Derivatives as C has it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CDerivatives {
    value: [f64; 4],
    by_coordinates: [[f64; 6]; 4],
    by_speeds: [[f64; 4]; 4],
}

impl From<model::Derivatives<f64>> for CDerivatives {
    fn from(value: model::Derivatives<f64>) -> Self {
        CDerivatives {
            value: value.value.into(),
            by_coordinates: value.by_coordinates.transpose().into(),
            by_speeds: value.by_speeds.transpose().into(),
        }
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_new(parameters: *const [f64; 8], answer: *mut CMechanism) -> i32 {
    if parameters.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says.
    match Mechanism::new(unsafe { parameters.read() }.into()) {
        Ok(mechanism) => {
            // SAFETY: as above; the memory is large enough and aligned, which was asserted.
            unsafe { answer.cast::<Mechanism>().write(mechanism) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_default_parameters(answer: *mut [f64; 8]) -> i32 {
    if answer.is_null() {
        return NULL;
    }
    // SAFETY: not null, and the caller's to write to.
    unsafe { answer.write(model::Parameters::<f64>::default().into()) };
    OK
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_default_coordinates(answer: *mut [f64; 6]) -> i32 {
    if answer.is_null() {
        return NULL;
    }
    // SAFETY: not null, and the caller's to write to.
    unsafe { answer.write(model::Coordinates::<f64>::default().into()) };
    OK
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_default_speeds(answer: *mut [f64; 4]) -> i32 {
    if answer.is_null() {
        return NULL;
    }
    // SAFETY: not null, and the caller's to write to.
    unsafe { answer.write(model::Speeds::<f64>::default().into()) };
    OK
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_coordinate_rates(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 6],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.coordinate_rates(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_constraint_residual(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 2],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.constraint_residual(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_mass_matrix(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 4]; 4],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.mass_matrix(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_forcing(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 4],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.forcing(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_accelerations(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 4],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.accelerations(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_inverse_dynamics(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    acceleration: *const [f64; 4],
    answer: *mut [f64; 4],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || acceleration.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let acceleration = model::Speeds::from(unsafe { acceleration.read() });
    match mechanism.inverse_dynamics(&q, &u, &acceleration) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_kinetic_energy(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut f64,
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.kinetic_energy(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_potential_energy(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut f64,
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.potential_energy(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_position_a0(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.position_a0(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_velocity_a0(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.velocity_a0(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_jacobian_a0(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 4]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.jacobian_a0(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_position_b0(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.position_b0(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_velocity_b0(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.velocity_b0(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_jacobian_b0(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 4]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.jacobian_b0(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_position_as(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.position_as(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_velocity_as(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.velocity_as(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_jacobian_as(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 4]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.jacobian_as(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_position_bs(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.position_bs(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_velocity_bs(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.velocity_bs(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_jacobian_bs(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 4]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.jacobian_bs(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_position_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.position_ac(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_velocity_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.velocity_ac(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_jacobian_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 4]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.jacobian_ac(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_position_bc(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.position_bc(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_velocity_bc(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.velocity_bc(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_jacobian_bc(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 4]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.jacobian_bc(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_orientation_abar(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 3]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.orientation_abar(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_orientation_bbar(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 3]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.orientation_bbar(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_orientation_a(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 3]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.orientation_a(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_orientation_b(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 3]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.orientation_b(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_orientation_ak(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 3]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.orientation_ak(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_orientation_bk(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 3]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.orientation_bk(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_acceleration_a0(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    acceleration: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || acceleration.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let acceleration = model::Speeds::from(unsafe { acceleration.read() });
    match mechanism.acceleration_a0(&q, &u, &acceleration) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_acceleration_b0(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    acceleration: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || acceleration.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let acceleration = model::Speeds::from(unsafe { acceleration.read() });
    match mechanism.acceleration_b0(&q, &u, &acceleration) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_acceleration_as(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    acceleration: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || acceleration.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let acceleration = model::Speeds::from(unsafe { acceleration.read() });
    match mechanism.acceleration_as(&q, &u, &acceleration) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_acceleration_bs(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    acceleration: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || acceleration.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let acceleration = model::Speeds::from(unsafe { acceleration.read() });
    match mechanism.acceleration_bs(&q, &u, &acceleration) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_acceleration_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    acceleration: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || acceleration.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let acceleration = model::Speeds::from(unsafe { acceleration.read() });
    match mechanism.acceleration_ac(&q, &u, &acceleration) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_acceleration_bc(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    acceleration: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || acceleration.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let acceleration = model::Speeds::from(unsafe { acceleration.read() });
    match mechanism.acceleration_bc(&q, &u, &acceleration) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_coordinate_rates_derivatives(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [[f64; 10]; 6],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.coordinate_rates_derivatives(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_inverse_dynamics_derivatives(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    acceleration: *const [f64; 4],
    answer: *mut CDerivatives,
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || acceleration.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let acceleration = model::Speeds::from(unsafe { acceleration.read() });
    match mechanism.inverse_dynamics_derivatives(&q, &u, &acceleration) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(CDerivatives::from(value)) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_accelerations_derivatives(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut CDerivatives,
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.accelerations_derivatives(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(CDerivatives::from(value)) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_linearise(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut CLinearisation,
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.linearise(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(CLinearisation::from(value)) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_contact_velocity_bc_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.contact_velocity_bc_ac(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_partial_velocities_bc_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 4]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.partial_velocities_bc_ac(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_response_bc_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 3]; 4],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.response_bc_ac(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_free_acceleration_bc_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    match mechanism.free_acceleration_bc_ac(&q, &u) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_remainder_velocity_bc_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [f64; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.remainder_velocity_bc_ac(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_contact_basis_bc_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 3]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.contact_basis_bc_ac(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(value.transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_reduced_matrix_bc_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    answer: *mut [[f64; 3]; 3],
) -> i32 {
    if mechanism.is_null() || q.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    match mechanism.reduced_matrix_bc_ac(&q) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(Matrix3::from(value).transpose().into()) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_collide_bc_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    surface: *const CSurface,
    answer: *mut CCollision,
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || surface.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let CSurface { mu, e, law } = unsafe { surface.read() };
    let Some(surface) = surface_of(mu, e, law) else { return UNKNOWN_LAW };
    match mechanism.collide_bc_ac(&q, &u, &surface) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(CCollision::from(value)) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_impact_without_collision_bc_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    surface: *const CSurface,
    answer: *mut CCollision,
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || surface.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let CSurface { mu, e, law } = unsafe { surface.read() };
    let Some(surface) = surface_of(mu, e, law) else { return UNKNOWN_LAW };
    match mechanism.impact_without_collision_bc_ac(&q, &u, &surface) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(CCollision::from(value)) };
            OK
        }
        Err(error) => error.status(),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn two_sleds_contact_mode_bc_ac(
    mechanism: *const CMechanism,
    q: *const [f64; 6],
    u: *const [f64; 4],
    surface: *const CSurface,
    answer: *mut CClosedContact,
) -> i32 {
    if mechanism.is_null() || q.is_null() || u.is_null() || surface.is_null() || answer.is_null() {
        return NULL;
    }
    // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.
    let mechanism = unsafe { &*mechanism.cast::<Mechanism>() };
    let q = model::Coordinates::from(unsafe { q.read() });
    let u = model::Speeds::from(unsafe { u.read() });
    let CSurface { mu, e, law } = unsafe { surface.read() };
    let Some(surface) = surface_of(mu, e, law) else { return UNKNOWN_LAW };
    match mechanism.contact_mode_bc_ac(&q, &u, &surface) {
        Ok(value) => {
            // SAFETY: as above.
            unsafe { answer.write(CClosedContact::from(value)) };
            OK
        }
        Err(error) => error.status(),
    }
}

