//! A mechanism that counts how many distances of contacts are computed, and may hide its pairs of shapes.

use std::cell::Cell;

use hodograph::nalgebra::{Matrix3, Vector3};
use hodograph::{
    Budgeted, ClosedContactError, ClosedContacts, CollisionError, CollisionOutcome, Component, ComponentKind,
    ContactMode, ContactOutcome, ContactState, Contacts, Distance, Mechanism, ParameterError,
    RelativeRotation, State, StateError, StatedLaw, Surface,
};

/// All that another mechanism does.
pub struct Counted<'m> {
    pub of: &'m dyn Contacts<f64>,
    /// whether it tells its pairs
    pub tells_pairs: bool,
    /// gaps that were computed
    pub gaps: Cell<usize>,
    /// clearances that were computed
    pub clearances: Cell<usize>,
}

impl<'m> Counted<'m> {
    pub fn new(of: &'m dyn Contacts<f64>, tells_pairs: bool) -> Self {
        Counted { of, tells_pairs, gaps: Cell::new(0), clearances: Cell::new(0) }
    }
}

fn add(to: &Cell<usize>, count: usize) {
    to.set(to.get() + count);
}

/// Methods that are those of the other mechanism.
macro_rules! same {
    ($(fn $name:ident($($argument:ident: $kind:ty),*) -> $result:ty;)*) => {
        $(fn $name(&self, $($argument: $kind),*) -> $result {
            self.of.$name($($argument),*)
        })*
    };
}

type Done = Result<(), StateError>;

impl Mechanism<f64> for Counted<'_> {
    fn name(&self) -> &str {
        self.of.name()
    }
    fn component(&self, kind: ComponentKind, index: usize) -> Option<Component<'_>> {
        self.of.component(kind, index)
    }
    fn set_parameter_values(&mut self, _: &[f64]) -> Result<(), ParameterError> {
        unimplemented!("no test changes them")
    }
    same! {
        fn count(kind: ComponentKind) -> usize;
        fn dependent_coordinate(index: usize) -> Option<usize>;
        fn parameter_values(parameters: &mut [f64]) -> Done;
        fn initial_state(coordinates: &mut [f64], speeds: &mut [f64], inputs: &mut [f64]) -> Done;
        fn normalise(coordinates: &mut [f64]) -> Done;
        fn coordinate_rates(state: &State<'_>, rates: &mut [f64]) -> Done;
        fn accelerations(state: &State<'_>, accelerations: &mut [f64]) -> Done;
        fn dependent_speeds(state: &State<'_>, speeds: &mut [f64]) -> Done;
        fn dependent_accelerations(state: &State<'_>, accelerations: &mut [f64]) -> Done;
        fn mass_matrix(state: &State<'_>, matrix: &mut [f64]) -> Done;
        fn forcing(state: &State<'_>, forcing: &mut [f64]) -> Done;
        fn inverse_dynamics(state: &State<'_>, accelerations: &[f64], forces: &mut [f64]) -> Done;
        fn kinetic_energy(state: &State<'_>) -> Result<f64, StateError>;
        fn potential_energy(state: &State<'_>) -> Result<Option<f64>, StateError>;
        fn configuration(state: &State<'_>, residual: &mut [f64], jacobian: &mut [f64]) -> Done;
        fn position(point: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError>;
        fn velocity(point: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError>;
        fn acceleration(point: usize, state: &State<'_>, rates: &[f64]) -> Result<Vector3<f64>, StateError>;
        fn jacobian(point: usize, state: &State<'_>, jacobian: &mut [f64]) -> Done;
        fn orientation(frame: usize, state: &State<'_>) -> Result<Matrix3<f64>, StateError>;
    }
}

type Collided = Result<CollisionOutcome<f64>, CollisionError<f64>>;
type Decided = Result<ContactOutcome<f64>, ClosedContactError<f64>>;

impl Contacts<f64> for Counted<'_> {
    fn gap(&self, contact: usize, state: &State<'_>) -> Result<Option<f64>, StateError> {
        add(&self.gaps, 1);
        self.of.gap(contact, state)
    }
    fn gaps(&self, contacts: &[usize], state: &State<'_>, distances: &mut [Distance]) -> Done {
        add(&self.gaps, contacts.len());
        self.of.gaps(contacts, state, distances)
    }
    fn pair(&self, contact: usize) -> Option<usize> {
        self.of.pair(contact).filter(|_| self.tells_pairs)
    }
    fn clearances(&self, pairs: &[usize], state: &State<'_>, clearances: &mut [f64]) -> Done {
        add(&self.clearances, pairs.len());
        self.of.clearances(pairs, state, clearances)
    }
    fn stated_law(&self, contact: usize) -> StatedLaw<'_> {
        self.of.stated_law(contact)
    }
    same! {
        fn contact_state(contact: usize, state: &State<'_>) -> Result<ContactState<f64>, StateError>;
        fn validity(contact: usize, state: &State<'_>) -> Result<Option<f64>, StateError>;
        fn surface(contact: usize) -> Option<Surface<f64>>;
        fn contact_velocity(contact: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError>;
        fn contact_velocities(contacts: &[usize], state: &State<'_>, velocities: &mut [Vector3<f64>]) -> Done;
        fn free_acceleration(contact: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError>;
        fn partial_velocities(contact: usize, state: &State<'_>, partial_velocities: &mut [f64]) -> Done;
        fn response(contact: usize, state: &State<'_>, response: &mut [f64]) -> Done;
        fn relative_rotation(
            contact: usize, state: &State<'_>, values: &mut RelativeRotation<'_>
        ) -> Result<bool, StateError>;
        fn collide(contact: usize, state: &State<'_>, surface: &Surface<f64>, speeds: &mut [f64]) -> Collided;
        fn collide_with_budget(
            contact: usize, state: &State<'_>, surface: &Budgeted<f64>, speeds: &mut [f64]
        ) -> Collided;
        fn impact_without_collision(
            contact: usize, state: &State<'_>, surface: &Surface<f64>, speeds: &mut [f64]
        ) -> Collided;
        fn contact_mode(
            contact: usize, state: &State<'_>, surface: &Surface<f64>, accelerations: &mut [f64]
        ) -> Decided;
        fn contact_force(
            contact: usize, mode: ContactMode, state: &State<'_>, surface: &Surface<f64>, rates: &mut [f64]
        ) -> Decided;
        fn closed_contacts(contacts: &[usize], state: &State<'_>, values: &mut ClosedContacts<'_>) -> Done;
    }
}
