//! Evaluates all closed contacts of a mechanism in a state together: the matrix W, the free accelerations
//! beta, and the velocities.

use hodograph::{ComponentKind, Contacts, ReducedMatrix, State, StateError};
use nalgebra::{DMatrix, DVector, Matrix3, Vector2, Vector3};
use smallvec::SmallVec;

use crate::closed::angles::Angles;
use crate::closed::torques::WithTorques;
use crate::contact_problem::Problem;

/// Two contacts are coupled if their entry of W, relative to their own mobilities, is above this.
const COUPLED: f64 = 1e-12;

/// Lists of so many rows need no memory from the heap.
const FEW: usize = 12;

/// The impulses through which contacts are coupled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Along {
    /// along the normals
    Normal,
    /// along the normals and friction
    All,
}

/// The quantities of k closed contacts. Rows and columns are ordered by contact, then n, t, s along its
/// contact basis.
#[derive(Clone, Debug)]
pub(crate) struct ClosedContacts {
    /// Numbers of the contacts in the mechanism.
    pub contacts: Vec<usize>,
    /// W = V M^-1 V^T (3k x 3k).
    pub coupled: DMatrix<f64>,
    /// V^T (p x 3k).
    pub partials: DMatrix<f64>,
    /// M^-1 V^T (p x 3k).
    pub response: DMatrix<f64>,
    /// Velocities (3k).
    pub velocity: DVector<f64>,
    /// Free accelerations (3k).
    pub beta: DVector<f64>,
    /// Bounds of the rounding errors of the free accelerations (3k); zero unless they are requested.
    pub noise: DVector<f64>,
}

/// The relative rounding error of the terms of a free acceleration.
const ROUNDING: f64 = 32.0 * f64::EPSILON;
/// The error of a direction turns components into each other: a component has at least this part of the greatest of these
/// errors.
const DIRECTIONS: f64 = 1.0 / 32.0;
/// Accelerations below this part of the greatest one of any speed are none: repeated corrections leave as much.
const NOTHING: f64 = 1e-60;
/// Bodies that move side by side have relative accelerations of up to this many times that rounding error:
/// their normals have the relative error of positions over radii.
const IDLE: f64 = 128.0;

impl ClosedContacts {
    /// Storage for these contacts of a mechanism, with zeros.
    pub fn room(mechanism: WithTorques<'_>, contacts: &[usize]) -> Self {
        let (k, p) = (contacts.len(), mechanism.count(ComponentKind::Speed));
        Self {
            contacts: contacts.to_vec(),
            coupled: DMatrix::zeros(3 * k, 3 * k),
            partials: DMatrix::zeros(p, 3 * k),
            response: DMatrix::zeros(p, 3 * k),
            velocity: DVector::zeros(3 * k),
            beta: DVector::zeros(3 * k),
            noise: DVector::zeros(3 * k),
        }
    }

    /// Evaluates the contacts; without `accelerate` the free accelerations remain zero.
    pub fn new(
        mechanism: WithTorques<'_>,
        state: &State<'_>,
        contacts: &[usize],
        accelerate: bool,
    ) -> Result<Self, StateError> {
        let mut all = Self::room(mechanism, contacts);
        all.evaluate(mechanism, state, accelerate, None, &mut Vec::new())?;
        Ok(all)
    }

    /// Evaluates the contacts with their free accelerations, and the rates of the mechanism without contact
    /// forces: coordinates, then speeds. `numbers` is work space that is reused from call to call.
    pub fn with_rates(
        &mut self,
        mechanism: WithTorques<'_>,
        state: &State<'_>,
        angles: &Angles,
        rates: &mut [f64],
        numbers: &mut Vec<f64>,
    ) -> Result<(), StateError> {
        if self.contacts.is_empty() {
            let (q, u) = rates.split_at_mut(state.coordinates.len());
            mechanism.coordinate_rates(state, q)?;
            mechanism.accelerations(state, &mut u[..state.speeds.len()])?;
            return Ok(());
        }
        self.evaluate(mechanism, state, true, Some(&mut *rates), numbers)?;
        self.weigh(angles, state.speeds, &rates[state.coordinates.len()..], numbers);
        Ok(())
    }

    /// Computes bounds of the rounding errors of the free accelerations. These are sums of the partial
    /// velocities times the accelerations of the speeds, and of velocities times the angular velocities of
    /// directions. `numbers` is work space.
    fn weigh(&mut self, angles: &Angles, speeds: &[f64], accelerations: &[f64], numbers: &mut Vec<f64>) {
        let turns = angles.speed(speeds);
        let p = speeds.len().max(1);
        numbers.clear();
        numbers.extend(speeds.iter().zip(accelerations).map(|(u, a)| a.abs() + turns * u.abs()));
        let least = NOTHING * numbers.iter().fold(0.0, |most: f64, size| most.max(*size));
        for (noise, column) in self.noise.iter_mut().zip(self.partials.as_slice().chunks_exact(p)) {
            let terms = column.iter().zip(&*numbers).map(|(v, size)| v.abs() * (size + least)).sum::<f64>();
            *noise = ROUNDING * terms;
        }
        for own in self.noise.as_mut_slice().chunks_exact_mut(3) {
            let turned = DIRECTIONS * own.iter().fold(0.0_f64, |most, noise| most.max(*noise));
            own.iter_mut().for_each(|noise| *noise = noise.max(turned));
        }
    }

    /// The same without the rates.
    pub fn loaded(
        mechanism: WithTorques<'_>,
        state: &State<'_>,
        angles: &Angles,
        contacts: &[usize],
    ) -> Result<Self, StateError> {
        let mut rates = vec![0.0; state.coordinates.len() + state.speeds.len()];
        let mut all = Self::room(mechanism, contacts);
        all.with_rates(mechanism, state, angles, &mut rates, &mut Vec::new())?;
        Ok(all)
    }

    /// Whether nothing presses these bodies together or moves them relative to each other: all free
    /// accelerations are below their rounding errors.
    pub fn is_idle(&self) -> bool {
        self.beta.iter().zip(self.noise.iter()).all(|(beta, noise)| beta.abs() <= IDLE * noise)
    }

    /// The normal acceleration of a contact that is no more than its rounding error, m/s^2.
    pub fn least_acceleration(&self, i: usize) -> f64 {
        IDLE * self.noise[3 * i]
    }

    /// The greatest force that changes no acceleration by more than its rounding error, N.
    pub fn least_force(&self) -> f64 {
        let least = |i: usize| {
            let own = (3 * i..3 * i + 3).map(|row| self.coupled[(row, row)]).sum::<f64>();
            let noise = (3 * i..3 * i + 3).map(|row| self.noise[row]).fold(0.0, f64::max);
            if own > 0.0 { IDLE * noise / own } else { 0.0 }
        };
        (0..self.len()).map(least).fold(0.0, f64::max)
    }

    fn evaluate(
        &mut self,
        mechanism: WithTorques<'_>,
        state: &State<'_>,
        accelerate: bool,
        rates: Option<&mut [f64]>,
        numbers: &mut Vec<f64>,
    ) -> Result<(), StateError> {
        let Self { contacts, coupled, partials, response, velocity, beta, .. } = self;
        let (k, p) = (contacts.len(), mechanism.count(ComponentKind::Speed));
        // Torques come last.
        let own = contacts.iter().take_while(|&&contact| mechanism.torque(contact).is_none()).count();
        numbers.resize(3 * p * own, 0.0);
        let answers = &mut numbers[..];
        let mut known = false;
        if let Some(rates) = rates {
            let (q, u) = rates.split_at_mut(state.coordinates.len());
            let mut values = hodograph::ClosedContacts {
                coordinate_rates: &mut *q,
                accelerations: &mut u[..p],
                // V by rows is V^T by columns.
                partial_velocities: &mut partials.as_mut_slice()[..3 * p * own],
                responses: &mut *answers,
                velocities: &mut velocity.as_mut_slice()[..3 * own],
                free_accelerations: &mut beta.as_mut_slice()[..3 * own],
            };
            match mechanism.closed_contacts(&contacts[..own], state, &mut values) {
                Ok(()) => known = true,
                // Of one that does not tell all of it.
                Err(StateError::Undefined { .. }) => {
                    mechanism.coordinate_rates(state, q)?;
                    mechanism.accelerations(state, &mut u[..p])?;
                }
                Err(error) => return Err(error),
            }
        }
        for (i, &contact) in contacts[..own].iter().enumerate() {
            let answer = &mut answers[3 * p * i..][..3 * p];
            if !known {
                let partials = &mut partials.as_mut_slice()[3 * p * i..][..3 * p];
                mechanism.partial_velocities(contact, state, partials)?;
                mechanism.response(contact, state, answer)?;
            }
            let (n, rest) = response.as_mut_slice()[3 * p * i..][..3 * p].split_at_mut(p);
            let (t, s) = rest.split_at_mut(p);
            for (row, ((n, t), s)) in answer.chunks_exact(3).zip(n.iter_mut().zip(t).zip(s)) {
                (*n, *t, *s) = (row[0], row[1], row[2]);
            }
            if known {
                continue;
            }
            velocity.rows_mut(3 * i, 3).copy_from(&mechanism.contact_velocity(contact, state)?);
            if accelerate {
                beta.rows_mut(3 * i, 3).copy_from(&free_acceleration(mechanism.mechanism, contact, state)?);
            }
        }
        for (i, &torque) in contacts.iter().enumerate().skip(own) {
            let Some(rows) = mechanism.rows(torque, state)? else { continue };
            for (speed, (partial, answer)) in rows.partials.iter().zip(&rows.responses).enumerate() {
                for axis in 0..3 {
                    partials[(speed, 3 * i + axis)] = partial[axis];
                    response[(speed, 3 * i + axis)] = answer[axis];
                }
            }
            velocity.rows_mut(3 * i, 3).copy_from(&rows.velocity);
            beta.rows_mut(3 * i, 3).copy_from(&rows.free);
        }
        for i in 0..k {
            let partial = three_columns(partials.as_slice(), p, i);
            for j in 0..=i {
                let products = products(partial, three_columns(response.as_slice(), p, j));
                for (a, row) in products.iter().enumerate() {
                    // symmetric up to rounding
                    for (b, both) in row.iter().enumerate().take(if i == j { a + 1 } else { 3 }) {
                        coupled[(3 * i + a, 3 * j + b)] = *both;
                        coupled[(3 * j + b, 3 * i + a)] = *both;
                    }
                }
            }
        }
        if own < k {
            mechanism.share_normal_forces(contacts, own, coupled, velocity, beta);
        }
        Ok(())
    }

    /// The indices of the contacts whose velocities are changed by impulses at these contacts, directly or
    /// through others. Bodies without connection to an impact are left unchanged.
    pub fn coupled_with(&self, struck: &[usize], along: Along) -> Vec<usize> {
        let axes = match along {
            Along::Normal => 1,
            Along::All => 3,
        };
        let entry = |a: usize, b: usize| self.coupled[(a, b)].abs();
        let size = |i: usize| (3 * i..3 * i + axes).map(|row| entry(row, row)).fold(0.0, f64::max);
        let mut found = vec![false; self.len()];
        let mut next = struck.to_vec();
        while let Some(place) = next.pop() {
            if std::mem::replace(&mut found[place], true) {
                continue;
            }
            let coupled = |&other: &usize| {
                let pairs = (0..axes).flat_map(|a| (0..axes).map(move |b| (3 * place + a, 3 * other + b)));
                let most = pairs.map(|(a, b)| entry(a, b)).fold(0.0, f64::max);
                most > COUPLED * (size(place) * size(other)).sqrt()
            };
            next.extend((0..self.len()).filter(coupled).filter(|other| !found[*other]));
        }
        (0..self.len()).filter(|&place| found[place]).collect()
    }

    /// The problem of their forces, for these coefficients of friction and directions of slip.
    pub fn problem<'a>(&'a self, mu: &'a [f64], slip: &'a [Option<Vector2<f64>>]) -> Problem<'a> {
        Problem { w: &self.coupled, beta: &self.beta, mu, slip, noise: Some(&self.noise) }
    }

    /// Number of contacts.
    pub fn len(&self) -> usize {
        self.contacts.len()
    }

    /// The reduced matrix of a contact.
    pub fn reduced(&self, i: usize) -> ReducedMatrix<f64> {
        let block: Matrix3<f64> = self.coupled.fixed_view::<3, 3>(3 * i, 3 * i).into_owned();
        ReducedMatrix::from(block)
    }

    /// The three components of a contact in a vector of all contacts.
    pub fn three(all: &DVector<f64>, i: usize) -> Vector3<f64> {
        all.fixed_rows::<3>(3 * i).into_owned()
    }

    /// The slip of a contact.
    pub fn slip(&self, i: usize) -> Vector2<f64> {
        Vector2::new(self.velocity[3 * i + 1], self.velocity[3 * i + 2])
    }

    /// A bound of the rounding error of the velocity of a contact: the sum of the magnitudes of its terms.
    pub fn velocity_size(&self, i: usize, speeds: &[f64]) -> f64 {
        (0..3).map(|row| self.row_size(3 * i + row, speeds)).fold(0.0, f64::max)
    }

    /// A bound of the rounding error of the normal velocity of a contact, independent of its slip.
    pub fn normal_size(&self, i: usize, speeds: &[f64]) -> f64 {
        self.row_size(3 * i, speeds)
    }

    fn row_size(&self, row: usize, speeds: &[f64]) -> f64 {
        let p = speeds.len();
        self.partials.as_slice()[row * p..][..p].iter().zip(speeds).map(|(v, u)| (v * u).abs()).sum()
    }

    /// The change of speeds with the least kinetic energy that makes these rows of the velocity zero.
    pub fn without(&self, rows: &[usize], velocity: &DVector<f64>) -> DVector<f64> {
        // Nothing moves across a plane of motion, and no impulse there changes anything.
        let moves = |&row: &usize| self.coupled[(row, row)] > 0.0;
        let rows: SmallVec<[usize; FEW]> = rows.iter().copied().filter(moves).collect();
        if rows.is_empty() {
            return DVector::zeros(self.response.nrows());
        }
        let m = rows.len();
        let matrix = DMatrix::from_fn(m, m, |i, j| self.coupled[(rows[i], rows[j])]);
        let right = DVector::from_fn(m, |i, _| -velocity[rows[i]]);
        let impulse = least_squares(&matrix, &right);
        let mut change = DVector::zeros(self.response.nrows());
        for (&row, &size) in rows.iter().zip(impulse.iter()) {
            change += self.response.column(row) * size;
        }
        change
    }
}

/// The three columns of a contact, each with `p` numbers.
fn three_columns(columns: &[f64], p: usize, i: usize) -> [&[f64]; 3] {
    let (n, rest) = columns[3 * p * i..][..3 * p].split_at(p);
    let (t, s) = rest.split_at(p);
    [n, t, s]
}

/// The nine products of these columns with those.
fn products(left: [&[f64]; 3], right: [&[f64]; 3]) -> [[f64; 3]; 3] {
    let p = left[0].len();
    let ([l0, l1, l2], [r0, r1, r2]) = (left.map(|column| &column[..p]), right.map(|column| &column[..p]));
    let mut sums = [[0.0; 3]; 3];
    for i in 0..p {
        let (l, r) = ([l0[i], l1[i], l2[i]], [r0[i], r1[i], r2[i]]);
        for (row, l) in sums.iter_mut().zip(l) {
            row.iter_mut().zip(r).for_each(|(sum, r)| *sum += l * r);
        }
    }
    sums
}

/// beta of a contact. If the mechanism does not provide it, it is the derivative of the contact velocity
/// along the motion by finite differences of order six, accurate to some twelve digits.
pub(crate) fn free_acceleration(
    mechanism: &dyn Contacts<f64>,
    contact: usize,
    state: &State<'_>,
) -> Result<Vector3<f64>, StateError> {
    match mechanism.free_acceleration(contact, state) {
        Err(StateError::Undefined { .. }) => {}
        answer => return answer,
    }
    let (mut q_rates, mut u_rates) = (vec![0.0; state.coordinates.len()], vec![0.0; state.speeds.len()]);
    mechanism.coordinate_rates(state, &mut q_rates)?;
    mechanism.accelerations(state, &mut u_rates)?;
    let moved = |numbers: &[f64], rates: &[f64], s: f64| -> Vec<f64> {
        numbers.iter().zip(rates).map(|(number, rate)| number + s * rate).collect()
    };
    let mut beta = Vector3::zeros();
    for (steps, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
        for side in [1.0, -1.0] {
            let s = side * steps * DIFFERENCE;
            let (q, u) = (moved(state.coordinates, &q_rates, s), moved(state.speeds, &u_rates, s));
            let there = State { time: state.time + s, coordinates: &q, speeds: &u, inputs: state.inputs };
            beta += mechanism.contact_velocity(contact, &there)? * (side * weight / (60.0 * DIFFERENCE));
        }
    }
    Ok(beta)
}

/// Step of the differences, s.
const DIFFERENCE: f64 = 1e-3;

/// A pivot below this ratio to the greatest one counts as zero. Within a step the contacts of an
/// overdetermined support lie in a plane only up to the error of the step; the pivots that would vanish
/// exactly in the plane must count as zero, too.
const SINGULAR: f64 = 1e-7;

/// The least-norm solution x of min |A x - b|.
pub(crate) fn least_squares(matrix: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    if matrix.is_square() { solve(matrix, right).0 } else { least(matrix, right).0 }
}

/// The least-norm solution x of min |A x - b|, and whether the minimiser is unique.
pub(crate) fn solve(matrix: &DMatrix<f64>, right: &DVector<f64>) -> (DVector<f64>, bool) {
    let n = right.len();
    if n == 0 {
        return (DVector::zeros(0), true);
    }
    if n == 1 {
        let entry = matrix[(0, 0)];
        return if entry == 0.0 { (DVector::zeros(1), false) } else { (right / entry, true) };
    }
    let lu = matrix.clone().full_piv_lu();
    let diagonal = lu.u().diagonal().abs();
    if diagonal.min() > 10.0 * SINGULAR * diagonal.max()
        && let Some(mut x) = lu.solve(right)
    {
        // One refinement.
        if let Some(more) = lu.solve(&(right - matrix * &x)) {
            x += more;
        }
        return (x, true);
    }
    let (x, unique) = least(matrix, right);
    // One refinement.
    let (more, _) = least(matrix, &(right - matrix * &x));
    (x + more, unique)
}

/// The least-norm solution of a singular system up to its rank: A P = Q R with pivots, and the least-norm
/// solution of R' x = Q' b, where R' are the rows of R up to the rank. (A singular value decomposition by
/// shifts may lose half the digits next to a zero.)
fn least(matrix: &DMatrix<f64>, right: &DVector<f64>) -> (DVector<f64>, bool) {
    let n = matrix.ncols();
    let qr = matrix.clone().col_piv_qr();
    let r = qr.r();
    let greatest = r[(0, 0)].abs();
    let rank = (0..r.nrows().min(n)).take_while(|&i| r[(i, i)].abs() > SINGULAR * greatest).count();
    if rank == 0 {
        return (DVector::zeros(n), false);
    }
    let rows = r.rows(0, rank).into_owned();
    let projected = (qr.q().transpose() * right).rows(0, rank).into_owned();
    // The least-norm solution of rows x = projected lies in the span of the rows: rows^T = Q2 R2, x = Q2
    // R2^-T projected.
    let second = rows.transpose().qr();
    let mut x = match second.r().transpose().solve_lower_triangular(&projected) {
        Some(inner) => second.q() * inner,
        None => DVector::zeros(n),
    };
    qr.p().inv_permute_rows(&mut x);
    (x, rank == n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four sliding corners: the matrix has rank three, and the equations are consistent.
    #[test]
    fn singular_systems_are_solved_to_rounding() {
        for k in 0..200 {
            let angle = 0.03 * f64::from(k);
            let corners = [[-1.0, -0.5], [1.0, -0.5], [-1.0, 0.5], [1.0, 0.5]];
            let arm = DMatrix::from_fn(3, 4, |row, i| match row {
                0 => 1.0,
                1 => 2.0 * corners[i][1] + 0.3 * (angle * (i as f64 + 1.0)).sin(),
                _ => 1.5 * corners[i][0] + 0.2 * (angle * (i as f64 + 2.0)).cos(),
            });
            let plane = DMatrix::from_fn(4, 3, |i, row| [1.0, corners[i][1], corners[i][0]][row]);
            let matrix = &plane * arm;
            let right = DVector::from_element(4, 9.81);
            let (x, unique) = solve(&matrix, &right);
            assert!(!unique);
            assert!((&matrix * &x - right).amax() < 1e-13, "{k}");
            // The least-norm solution has no component in the null space.
            let svd = matrix.clone().transpose() * &matrix;
            let null = svd.symmetric_eigen();
            let (least, _) = null.eigenvalues.argmin();
            assert!(null.eigenvectors.column(least).dot(&x).abs() < 1e-6, "{k}");
        }
    }
}
