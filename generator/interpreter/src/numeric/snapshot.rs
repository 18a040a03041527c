//! Everything that is known of a mechanism in one state.

use hodograph::ReducedMatrix;
use hodograph::StateError;
use hodograph::generated::Contact;
use hodograph::nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix3xX, MatrixXx3, Vector3};
use hodograph_model::model::mechanism::Mechanism;
use hodograph_model::numeric::{ContactEvaluation, Evaluation, State, evaluate};

use super::failure::state_error;

/// How the tangential axes of a contact follow from its normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// the second axis is that of N, to which the normal is always perpendicular
    Across(usize),
    /// smooth but for a normal along -N.z (Duff et al. 2017)
    Smooth,
}

/// States at which the bases of contacts are chosen.
const STATES: usize = 3;

/// The bases of the contacts: of the axes of N to which the normal is perpendicular in several states, one
/// along which nothing moves, else the last, so that a planar mechanism has planar contacts.
pub fn bases(model: &Mechanism, parameters: &[f64]) -> Vec<Basis> {
    let start = State { parameters: parameters.to_vec(), ..State::of(model) };
    let moved = |k: usize| {
        let by = |(i, x): (usize, &f64)| x + 0.3 * k as f64 * (1.7 * (i + 3 * k) as f64).sin();
        State {
            coordinates: start.coordinates.iter().enumerate().map(by).collect(),
            speeds: start.speeds.iter().enumerate().map(by).collect(),
            ..start.clone()
        }
    };
    let seen: Vec<Evaluation> = (0..STATES).filter_map(|k| evaluate(model, &moved(k)).ok()).collect();
    let of_contact = |contact: usize| {
        let all = || seen.iter().filter_map(move |state| state.contacts.get(contact));
        let across = |i: &usize| all().count() > 0 && all().all(|contact| contact.normal[*i] == 0.0);
        let still = |i: &usize| {
            let none = |v: &[f64; 3]| v[*i] == 0.0;
            all().all(|contact| contact.partial_velocities.iter().all(none) && none(&contact.remainder))
        };
        let candidates: Vec<usize> = (0..3).filter(across).collect();
        let chosen = candidates.iter().copied().find(still).or(candidates.last().copied());
        chosen.map_or(Basis::Smooth, Basis::Across)
    };
    (0..model.contacts.len()).map(of_contact).collect()
}

impl Basis {
    /// The tangential axes that go with a normal, right-handed, and their rates.
    fn axes(self, normal: Vector3<f64>, rate: Vector3<f64>) -> [[Vector3<f64>; 2]; 2] {
        if let Basis::Across(axis) = self {
            let second = Vector3::ith(axis, 1.0);
            return [[second.cross(&normal), second], [second.cross(&rate), Vector3::zeros()]];
        }
        let [x, y, z] = normal.into();
        let [dx, dy, dz] = rate.into();
        let sign = if z < 0.0 { -1.0 } else { 1.0 };
        let a = -1.0 / (sign + z);
        let da = a * a * dz;
        let (b, db) = (x * y * a, dx * y * a + x * dy * a + x * y * da);
        let first = Vector3::new(1.0 + sign * x * x * a, sign * b, -sign * x);
        let second = Vector3::new(b, sign + y * y * a, -y);
        let first_rate = Vector3::new(sign * (2.0 * x * dx * a + x * x * da), sign * db, -sign * dx);
        let second_rate = Vector3::new(db, 2.0 * y * dy * a + y * y * da, -dy);
        [[first, second], [first_rate, second_rate]]
    }
}

/// A contact in a state.
#[derive(Debug)]
pub struct Known {
    /// basis, velocity, reduced matrix and prescribed motion
    pub contact: Contact<f64>,
    /// partial velocities along the basis (3 x p)
    pub partial_velocities: Matrix3xX<f64>,
    /// M^-1 V^T (p x 3)
    pub response: MatrixXx3<f64>,
    /// beta: rate of the velocity along the basis without contact forces
    pub free: Vector3<f64>,
}

/// A mechanism in a state.
#[derive(Debug)]
pub struct Snapshot {
    state: State,
    /// what the numeric evaluation found
    pub values: Evaluation,
    /// u' without contact forces
    pub accelerations: DVector<f64>,
    /// the contacts
    pub contacts: Vec<Known>,
}

impl Snapshot {
    /// Evaluates a state.
    pub fn of(model: &Mechanism, state: State, bases: &[Basis]) -> Result<Self, StateError> {
        let values = evaluate(model, &state).map_err(state_error)?;
        let p = state.speeds.len();
        let matrix = DMatrix::from_fn(p, p, |i, j| values.mass_matrix[i][j]);
        let factors =
            matrix.cholesky().ok_or(StateError::Singular { what: "the mass matrix is singular" })?;
        let accelerations = factors.solve(&DVector::from_column_slice(&values.forcing));
        if !accelerations.iter().all(|x| x.is_finite()) {
            return Err(StateError::NotFinite);
        }
        let momentum = DVector::from_column_slice(&values.prescribed_momentum);
        let contacts = values.contacts.iter().zip(bases);
        let contacts =
            contacts.map(|(contact, basis)| known(contact, *basis, &factors, &accelerations, &momentum));
        Ok(Snapshot { contacts: contacts.collect(), state, values, accelerations })
    }

    /// Whether it is of this state, bit by bit.
    pub fn is_of(&self, state: &State) -> bool {
        let same = |a: &[f64], b: &[f64]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
        };
        self.state.time.to_bits() == state.time.to_bits()
            && same(&self.state.coordinates, &state.coordinates)
            && same(&self.state.speeds, &state.speeds)
            && same(&self.state.inputs, &state.inputs)
            && same(&self.state.parameters, &state.parameters)
    }
}

fn known(
    contact: &ContactEvaluation,
    basis: Basis,
    factors: &Cholesky<f64, Dyn>,
    accelerations: &DVector<f64>,
    momentum: &DVector<f64>,
) -> Known {
    let (normal, normal_rate) = (Vector3::from(contact.normal), Vector3::from(contact.normal_rate));
    let [[first, second], [first_rate, second_rate]] = basis.axes(normal, normal_rate);
    let along = |v: [f64; 3]| Vector3::from([normal, first, second].map(|axis| axis.dot(&Vector3::from(v))));
    let columns: Vec<Vector3<f64>> = contact.partial_velocities.iter().map(|v| along(*v)).collect();
    let partial = Matrix3xX::from_columns(&columns);
    let response = factors.solve(&partial.transpose());
    let m = &partial * &response;
    let velocity = Vector3::from(contact.velocity);
    let turning = Vector3::from([normal_rate, first_rate, second_rate].map(|rate| rate.dot(&velocity)));
    Known {
        contact: Contact {
            normal,
            first,
            second,
            velocity: along(contact.velocity),
            reduced: ReducedMatrix::new(
                m[(0, 0)],
                0.5 * (m[(0, 1)] + m[(1, 0)]),
                0.5 * (m[(0, 2)] + m[(2, 0)]),
                m[(1, 1)],
                0.5 * (m[(1, 2)] + m[(2, 1)]),
                m[(2, 2)],
            ),
            remainder: along(contact.remainder),
            prescribed_work: response.transpose() * momentum,
        },
        free: along(contact.acceleration) + turning + &partial * accelerations,
        partial_velocities: partial,
        response,
    }
}
