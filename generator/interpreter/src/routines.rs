//! The prepared routines of a mechanism: each is prepared at its first call.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock, PoisonError, RwLock};

use hodograph_model::model::mechanism::Mechanism;
use hodograph_program::interpret::{Constants, Prepared};
use hodograph_program::program::Program;
use hodograph_program::program::quantity::table::{POINT, WHOLE};
use hodograph_program::program::{ContactQuantity, PointQuantity, Quantity};

/// What is asked of a contact.
const CONTACT: [OfContact; 13] = [
    OfContact::State,
    OfContact::One(ContactQuantity::Gap),
    OfContact::One(ContactQuantity::Validity),
    OfContact::One(ContactQuantity::Velocity),
    OfContact::One(ContactQuantity::FreeAcceleration),
    OfContact::One(ContactQuantity::PartialVelocities),
    OfContact::One(ContactQuantity::Response),
    OfContact::One(ContactQuantity::AngularVelocity),
    OfContact::One(ContactQuantity::FreeAngularAcceleration),
    OfContact::One(ContactQuantity::PartialAngularVelocities),
    OfContact::One(ContactQuantity::AngularResponse),
    OfContact::Collision,
    OfContact::Closed,
];

/// What is asked of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfContact {
    /// basis, velocity, reduced matrix, gap
    State,
    /// what a collision is computed from
    Collision,
    /// what the mode of a closed contact is computed from
    Closed,
    /// one quantity
    One(ContactQuantity),
}

/// The state of a contact, in this order: the gap comes last, because it may be missing.
pub const STATE: [ContactQuantity; 6] = [
    ContactQuantity::Normal,
    ContactQuantity::First,
    ContactQuantity::Second,
    ContactQuantity::Velocity,
    ContactQuantity::Reduced,
    ContactQuantity::Gap,
];

/// What a collision is computed from, in this order.
pub const COLLISION: [ContactQuantity; 8] = [
    ContactQuantity::Normal,
    ContactQuantity::First,
    ContactQuantity::Second,
    ContactQuantity::Velocity,
    ContactQuantity::Reduced,
    ContactQuantity::Response,
    ContactQuantity::Remainder,
    ContactQuantity::PrescribedWork,
];

/// What the mode of a closed contact is computed from beside that, in this order; the accelerations follow.
pub const CLOSED: [ContactQuantity; 2] =
    [ContactQuantity::FreeAcceleration, ContactQuantity::PartialVelocities];

/// What is asked of a mechanism.
#[derive(Clone, Copy, Debug)]
pub enum Request {
    /// a quantity of the whole mechanism
    Whole(Quantity),
    /// a quantity of a point
    Point(usize, PointQuantity),
    /// the orientation of a frame
    Frame(usize),
    /// something of a contact
    Contact(usize, OfContact),
}

impl Request {
    /// What is asked for, in order.
    pub fn quantities(self) -> Vec<Quantity> {
        match self {
            Request::Whole(quantity) => vec![quantity],
            Request::Point(point, quantity) => vec![Quantity::Point(point as u32, quantity)],
            Request::Frame(frame) => vec![Quantity::Orientation(frame as u32)],
            Request::Contact(contact, what) => {
                let of = |quantity: ContactQuantity| Quantity::Contact(contact as u32, quantity);
                match what {
                    OfContact::State => STATE.map(of).to_vec(),
                    // A collision gives the dependent speeds after it, too: where these are singular, it has
                    // no outcome.
                    OfContact::Collision => {
                        let mut all = COLLISION.map(of).to_vec();
                        all.extend([of(ContactQuantity::DependentResponse), Quantity::DependentSpeeds]);
                        all
                    }
                    // Last what only must not be singular: the generated module gives the rates of the
                    // dependent speeds, too.
                    OfContact::Closed => {
                        let mut all = COLLISION.map(of).to_vec();
                        all.extend(CLOSED.map(of));
                        all.push(Quantity::Accelerations);
                        all.extend([of(ContactQuantity::DependentResponse), Quantity::DependentSpeeds]);
                        all.push(Quantity::DependentAccelerations);
                        all
                    }
                    OfContact::One(quantity) => vec![of(quantity)],
                }
            }
        }
    }
}

/// What forces of closed contacts follow from: of the mechanism, then of each contact, in these orders.
pub const TOGETHER: [Quantity; 2] = [Quantity::CoordinateRates, Quantity::Accelerations];
/// See [`TOGETHER`].
pub const OF_EACH: [ContactQuantity; 4] = [
    ContactQuantity::PartialVelocities,
    ContactQuantity::Response,
    ContactQuantity::Velocity,
    ContactQuantity::FreeAcceleration,
];

/// How far all contacts are from being closed: what is asked of each that has it, in this order.
pub const NEAR: [ContactQuantity; 2] = [ContactQuantity::Gap, ContactQuantity::Validity];

/// What is asked of several contacts in one pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum OfSeveral {
    /// [`TOGETHER`], then [`OF_EACH`]
    Closed,
    /// [`NEAR`]
    Near,
    /// the velocities
    Moving,
    /// the clearances of pairs of shapes
    Clear,
}

impl OfSeveral {
    /// What is asked of each contact, in order.
    pub fn of_each(self) -> &'static [ContactQuantity] {
        match self {
            OfSeveral::Closed => &OF_EACH,
            OfSeveral::Near => &NEAR,
            OfSeveral::Moving => &[ContactQuantity::Velocity],
            OfSeveral::Clear => &[ContactQuantity::Clearance],
        }
    }

    /// What is asked of contacts, in order.
    fn quantities(self, contacts: &[usize]) -> Vec<Quantity> {
        let whole: &[Quantity] = if self == OfSeveral::Closed { &TOGETHER } else { &[] };
        let of =
            |&contact: &usize| self.of_each().iter().map(move |&of| Quantity::Contact(contact as u32, of));
        whole.iter().copied().chain(contacts.iter().flat_map(of)).collect()
    }
}

/// What is asked of which contacts.
type Asked = (OfSeveral, Vec<usize>);

/// The routines of sets of contacts.
#[derive(Debug, Default)]
struct Sets(RwLock<BTreeMap<Asked, Arc<Prepared>>>);

/// So many sets are kept: those of pairs of shapes, and more than are often closed in one motion.
const MOST_SETS: usize = 512;

impl Clone for Sets {
    fn clone(&self) -> Self {
        Sets(RwLock::new(self.0.read().unwrap_or_else(PoisonError::into_inner).clone()))
    }
}

/// A cell for each request that a mechanism permits.
#[derive(Clone, Debug)]
pub struct Routines {
    points: usize,
    frames: usize,
    cells: Vec<OnceLock<Prepared>>,
    sets: Sets,
}

impl Routines {
    /// Nothing is prepared yet.
    pub fn new(model: &Mechanism) -> Self {
        let (points, frames) = (model.points.len(), model.frames.len());
        let count = WHOLE.len() + POINT.len() * points + frames + CONTACT.len() * model.contacts.len();
        let cells = (0..count).map(|_| OnceLock::new()).collect();
        Routines { points, frames, cells, sets: Sets::default() }
    }

    /// The routine of a request.
    pub fn get(&self, request: Request, program: &Program, constants: &Constants) -> &Prepared {
        self.cells[self.place(request)]
            .get_or_init(|| Prepared::new(program, constants, &request.quantities()))
    }

    /// The routine of a set of contacts.
    pub fn together(
        &self,
        what: OfSeveral,
        contacts: &[usize],
        program: &Program,
        constants: &Constants,
    ) -> Arc<Prepared> {
        let key = (what, contacts.to_vec());
        let known = self.sets.0.read().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
        known.unwrap_or_else(|| {
            let prepared = Arc::new(Prepared::new(program, constants, &what.quantities(contacts)));
            let mut sets = self.sets.0.write().unwrap_or_else(PoisonError::into_inner);
            if sets.len() >= MOST_SETS {
                sets.clear();
            }
            sets.insert(key, Arc::clone(&prepared));
            prepared
        })
    }

    /// Goes over to other parameters.
    pub fn refresh(&mut self, constants: &Constants) {
        self.sets = Sets::default();
        self.cells.iter_mut().filter_map(OnceLock::get_mut).for_each(|prepared| prepared.refresh(constants));
    }

    fn place(&self, request: Request) -> usize {
        let of_points = WHOLE.len();
        let of_frames = of_points + POINT.len() * self.points;
        let of_contacts = of_frames + self.frames;
        match request {
            Request::Whole(quantity) => row(WHOLE, quantity),
            Request::Point(point, quantity) => of_points + POINT.len() * point + row(POINT, quantity),
            Request::Frame(frame) => of_frames + frame,
            Request::Contact(contact, what) => {
                let place = CONTACT.iter().position(|known| *known == what).unwrap_or(0);
                of_contacts + CONTACT.len() * contact + place
            }
        }
    }
}

/// The place of a quantity in a table.
fn row<K: PartialEq, D>(table: &[(K, D)], quantity: K) -> usize {
    table.iter().position(|(known, _)| *known == quantity).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every request that is made has a cell of its own: `place` must not fall back on the first.
    #[test]
    fn requests_have_cells_of_their_own() {
        let routines = Routines { points: 3, frames: 2, cells: Vec::new(), sets: Sets::default() };
        let mut requests: Vec<Request> =
            WHOLE.iter().map(|(quantity, _)| Request::Whole(*quantity)).collect();
        let of_point = |point| POINT.iter().map(move |(quantity, _)| Request::Point(point, *quantity));
        requests.extend((0..3).flat_map(of_point));
        requests.extend((0..2).map(Request::Frame));
        requests.extend((0..2).flat_map(|contact| CONTACT.map(|what| Request::Contact(contact, what))));
        let places: Vec<usize> = requests.iter().map(|&request| routines.place(request)).collect();
        assert_eq!(places, (0..requests.len()).collect::<Vec<_>>());
    }
}
