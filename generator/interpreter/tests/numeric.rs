//! A mechanism without its derivation has the numbers of the one that has it: two computations of everything
//! that a simulation asks, at random states of all models.

use std::path::PathBuf;

use hodograph::nalgebra::{DMatrix, Matrix3, Vector3};
use hodograph::{ClosedContacts, ComponentKind, ContactMode, Contacts, Law, Mechanism, State, Surface};
use hodograph_interpreter::{InterpretedMechanism, NumericMechanism};

const STATES: usize = 3;
/// Relative to the largest number of what is compared, or 1.
const BOUND: f64 = 1e-9;

fn models() -> Vec<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let all = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut all: Vec<PathBuf> = all.filter(|path| path.extension().is_some_and(|e| e == "mech")).collect();
    all.sort();
    all
}

/// Numbers between -1 and 1 that are the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

#[track_caller]
fn close(what: &str, a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len(), "{what}");
    let size = a.iter().chain(b).fold(1.0_f64, |size, x| size.max(x.abs()));
    let off = a.iter().zip(b).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
    assert!(off <= BOUND * size, "{what}: off by {off:e}: {a:?} and {b:?}");
}

/// A vector of so many numbers that a routine writes.
fn written<E: std::fmt::Debug>(count: usize, write: impl FnOnce(&mut [f64]) -> Result<(), E>) -> Vec<f64> {
    let mut numbers = vec![0.0; count];
    write(&mut numbers).unwrap();
    numbers
}

#[test]
fn all_quantities_agree_with_those_of_derivations() {
    for path in models() {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let derived = InterpretedMechanism::read(&path).unwrap();
        let numeric = NumericMechanism::new(derived.model().clone()).unwrap();
        let (n, p) = (derived.count(ComponentKind::Coordinate), derived.count(ComponentKind::Speed));
        let mut random = Random(20_12);
        let start = written(n, |q| {
            derived.initial_state(q, &mut vec![0.0; p], &mut vec![0.0; derived.count(ComponentKind::Input)])
        });
        let mut seen = 0;
        for _ in 0..20 * STATES {
            let mut coordinates: Vec<f64> = start.iter().map(|q| q + 0.2 * random.next()).collect();
            let speeds: Vec<f64> = (0..p).map(|_| random.next()).collect();
            let inputs: Vec<f64> = (0..derived.count(ComponentKind::Input)).map(|_| random.next()).collect();
            derived.normalise(&mut coordinates).unwrap();
            if !closed(&derived, &mut coordinates, &inputs, &speeds) {
                continue;
            }
            let state = State { time: 0.3, coordinates: &coordinates, speeds: &speeds, inputs: &inputs };
            if derived.accelerations(&state, &mut vec![0.0; p]).is_err() {
                continue;
            }
            mechanisms_agree(&name, &derived, &numeric, &state);
            contacts_agree(&name, &derived, &numeric, &state);
            seen += 1;
            if seen == STATES {
                break;
            }
        }
        assert!(seen > 0, "{name}: no state");
    }
}

/// Closes the loops by Newton's method.
fn closed(mechanism: &dyn Mechanism, coordinates: &mut [f64], inputs: &[f64], speeds: &[f64]) -> bool {
    let c = mechanism.count(ComponentKind::DependentCoordinate);
    for _ in 0..if c == 0 { 0 } else { 30 } {
        let (mut residual, mut jacobian) = (vec![0.0; c], vec![0.0; c * c]);
        let state = State { time: 0.3, coordinates, speeds, inputs };
        if mechanism.configuration(&state, &mut residual, &mut jacobian).is_err() {
            return false;
        }
        let residual = hodograph::nalgebra::DVector::from_vec(residual);
        if residual.norm() < 1e-13 {
            return true;
        }
        let Some(step) = DMatrix::from_row_slice(c, c, &jacobian).lu().solve(&residual) else { return false };
        for index in 0..c {
            coordinates[mechanism.dependent_coordinate(index).unwrap()] -= step[index];
        }
    }
    c == 0
}

fn mechanisms_agree(name: &str, a: &dyn Mechanism, b: &dyn Mechanism, state: &State<'_>) {
    let (n, p) = (a.count(ComponentKind::Coordinate), a.count(ComponentKind::Speed));
    let (c, d) = (a.count(ComponentKind::DependentCoordinate), a.count(ComponentKind::DependentSpeed));
    for kind in [
        ComponentKind::Parameter,
        ComponentKind::Coordinate,
        ComponentKind::Speed,
        ComponentKind::Point,
        ComponentKind::Frame,
        ComponentKind::Contact,
    ] {
        assert_eq!(a.count(kind), b.count(kind), "{name}");
        assert_eq!(a.component(kind, 0), b.component(kind, 0), "{name}");
    }
    let both = |what: &str, count: usize, of: &dyn Fn(&dyn Mechanism, &mut [f64])| {
        let [x, y] = [a, b].map(|m| {
            let mut numbers = vec![0.0; count];
            of(m, &mut numbers);
            numbers
        });
        close(&format!("{name}: {what}"), &x, &y);
    };
    both("rates", n, &|m, out| m.coordinate_rates(state, out).unwrap());
    both("accelerations", p, &|m, out| m.accelerations(state, out).unwrap());
    both("dependent speeds", d, &|m, out| m.dependent_speeds(state, out).unwrap());
    both("dependent accelerations", d, &|m, out| m.dependent_accelerations(state, out).unwrap());
    both("mass matrix", p * p, &|m, out| m.mass_matrix(state, out).unwrap());
    both("forcing", p, &|m, out| m.forcing(state, out).unwrap());
    let rates: Vec<f64> = (0..p).map(|i| 0.3 + i as f64).collect();
    both("inverse dynamics", p, &|m, out| m.inverse_dynamics(state, &rates, out).unwrap());
    both("energies", 2, &|m, out| {
        out[0] = m.kinetic_energy(state).unwrap();
        out[1] = m.potential_energy(state).unwrap().unwrap_or(7e7);
    });
    // Rows may be chosen otherwise: both find the loops closed, and determine the dependent coordinates.
    for m in [a, b] {
        let (mut residual, mut jacobian) = (vec![0.0; c], vec![0.0; c * c]);
        m.configuration(state, &mut residual, &mut jacobian).unwrap();
        assert!(residual.iter().all(|r| r.abs() < 1e-9), "{name}: {residual:?}");
        assert!(DMatrix::from_row_slice(c, c, &jacobian).lu().is_invertible(), "{name}");
    }
    for point in 0..a.count(ComponentKind::Point) {
        let position = |m: &dyn Mechanism| m.position(point, state).ok();
        match (position(a), position(b)) {
            (Some(x), Some(y)) => close(&format!("{name}: position {point}"), x.as_slice(), y.as_slice()),
            (None, None) => {}
            // A derivation leaves out what nothing asks for.
            (None, Some(_)) | (Some(_), None) => panic!("{name}: only one has the position of {point}"),
        }
        both("velocity", 3, &|m, out| out.copy_from_slice(m.velocity(point, state).unwrap().as_slice()));
        both("jacobian", 3 * p, &|m, out| m.jacobian(point, state, out).unwrap());
        both("acceleration", 3, &|m, out| {
            out.copy_from_slice(m.acceleration(point, state, &rates).unwrap().as_slice());
        });
    }
    for frame in 0..a.count(ComponentKind::Frame) {
        let turned = |m: &dyn Mechanism| m.orientation(frame, state).ok();
        match (turned(a), turned(b)) {
            (Some(x), Some(y)) => close(&format!("{name}: frame {frame}"), x.as_slice(), y.as_slice()),
            (None, None) => {}
            _ => panic!("{name}: only one has the orientation of frame {frame}"),
        }
    }
}

/// A vector along the basis of a contact, along N.
fn along(basis: [Vector3<f64>; 3], v: &Vector3<f64>) -> Vector3<f64> {
    basis[0] * v.x + basis[1] * v.y + basis[2] * v.z
}

/// Bases may be chosen otherwise: what is compared does not depend on them.
fn contacts_agree(name: &str, a: &dyn Contacts<f64>, b: &dyn Contacts<f64>, state: &State<'_>) {
    let (n, p) = (a.count(ComponentKind::Coordinate), a.count(ComponentKind::Speed));
    for contact in 0..a.count(ComponentKind::Contact) {
        let name = format!("{name}, contact {contact}");
        let [x, y] = [a, b].map(|m| m.contact_state(contact, state).unwrap());
        let bases = [&x, &y].map(|s| [s.normal, s.first, s.second]);
        for basis in bases {
            let columns = Matrix3::from_columns(&basis);
            close(&name, (columns.transpose() * columns).as_slice(), Matrix3::identity().as_slice());
            assert!(columns.determinant() > 0.0, "{name}: a left-handed basis");
        }
        close(&name, x.normal.as_slice(), y.normal.as_slice());
        close(&name, &[x.gap.unwrap_or(0.0)], &[y.gap.unwrap_or(0.0)]);
        close(
            &name,
            &[a.gap(contact, state).unwrap().unwrap_or(0.0)],
            &[b.gap(contact, state).unwrap().unwrap_or(0.0)],
        );
        close(&name, along(bases[0], &x.velocity).as_slice(), along(bases[1], &y.velocity).as_slice());
        close(&name, &[x.reduced.nn], &[y.reduced.nn]);
        close(&name, &[x.reduced.tt + x.reduced.ss], &[y.reduced.tt + y.reduced.ss]);
        // Rates of components along bases that turn differ: that of the normal one does not.
        let beta = |m: &dyn Contacts<f64>| m.free_acceleration(contact, state).unwrap().x;
        close(&name, &[beta(a)], &[beta(b)]);
        let all = [(a, bases[0]), (b, bases[1])].map(|(m, basis)| {
            let (mut response, mut partial) = (vec![0.0; 3 * p], vec![0.0; 3 * p]);
            m.response(contact, state, &mut response).unwrap();
            m.partial_velocities(contact, state, &mut partial).unwrap();
            let of = |i: usize| Vector3::new(response[3 * i], response[3 * i + 1], response[3 * i + 2]);
            let turned: Vec<f64> = (0..p).flat_map(|i| <[f64; 3]>::from(along(basis, &of(i)))).collect();
            let of = |i: usize| Vector3::new(partial[i], partial[p + i], partial[2 * p + i]);
            let partial: Vec<f64> = (0..p).flat_map(|i| <[f64; 3]>::from(along(basis, &of(i)))).collect();
            [turned, partial].concat()
        });
        close(&format!("{name}: response"), &all[0], &all[1]);
        for law in [Law::Newton, Law::Stronge] {
            let surface = Surface { mu: 0.4, e: 0.6, law };
            let [s, t] = [a, b].map(|m| {
                let mut speeds = vec![0.0; p];
                m.collide(contact, state, &surface, &mut speeds).map(|hit| (hit, speeds))
            });
            match (s, t) {
                (Ok((s, u)), Ok((t, v))) => {
                    close(
                        &format!("{name}: impulse"),
                        s.impulse_on_point.as_slice(),
                        t.impulse_on_point.as_slice(),
                    );
                    close(&format!("{name}: speeds"), &u, &v);
                    close(&format!("{name}: energy"), &[s.energy_change], &[t.energy_change]);
                }
                (Err(s), Err(t)) => assert_eq!(s.kind(), t.kind(), "{name}"),
                (s, t) => panic!("{name}: {:?} and {:?}", s.map(|_| ()), t.map(|_| ())),
            }
        }
        let surface = Surface { mu: 0.4, e: 0.6, law: Law::Stronge };
        let [s, t] = [a, b].map(|m| {
            let mut rates = vec![0.0; p];
            let kept = m.contact_force(contact, ContactMode::Stick, state, &surface, &mut rates);
            let kept = kept.map(|outcome| outcome.force_on_point);
            m.contact_mode(contact, state, &surface, &mut rates).map(|outcome| (outcome, rates, kept))
        });
        match (s, t) {
            (Ok((s, u, kept)), Ok((t, v, also))) => {
                close(&format!("{name}: force"), s.force_on_point.as_slice(), t.force_on_point.as_slice());
                close(&format!("{name}: rates"), &u, &v);
                // Where the matrix is singular, rounding may say that nothing holds the contact.
                if let (Ok(kept), Ok(also)) = (kept, also) {
                    close(&format!("{name}: kept force"), kept.as_slice(), also.as_slice());
                }
            }
            (Err(s), Err(t)) => assert_eq!(s.kind(), t.kind(), "{name}"),
            (s, t) => panic!("{name}: {:?} and {:?}", s.map(|_| ()), t.map(|_| ())),
        }
    }
    // In one pass the same as one by one.
    let k = a.count(ComponentKind::Contact);
    let contacts: Vec<usize> = (0..k).collect();
    let mut numbers = [n, p, 3 * k * p, 3 * k * p, 3 * k, 3 * k].map(|count| vec![0.0; count]);
    let [rates, accelerations, partial, responses, velocities, free] = &mut numbers;
    let mut values = ClosedContacts {
        coordinate_rates: rates,
        accelerations,
        partial_velocities: partial,
        responses,
        velocities,
        free_accelerations: free,
    };
    b.closed_contacts(&contacts, state, &mut values).unwrap();
    for contact in contacts {
        let single = b.contact_velocity(contact, state).unwrap();
        assert_eq!(&numbers[4][3 * contact..3 * contact + 3], single.as_slice(), "{name}");
        let single = written(3 * p, |out| b.response(contact, state, out));
        assert_eq!(&numbers[3][3 * p * contact..3 * p * (contact + 1)], single, "{name}");
    }
}

#[test]
fn wrong_parameters_states_and_numbers_are_refused() {
    let path = models().into_iter().find(|path| path.ends_with("planar_double_pendulum.mech")).unwrap();
    let derived = InterpretedMechanism::read(&path).unwrap();
    let mut numeric = NumericMechanism::new(derived.model().clone()).unwrap();
    let count = numeric.count(ComponentKind::Parameter);
    assert!(numeric.set_parameter_values(&vec![1.0; count + 1]).is_err());
    let before = written(count, |out| numeric.parameter_values(out));
    assert!(numeric.set_parameter_values(&vec![-1.0; count]).is_err());
    assert_eq!(written(count, |out| numeric.parameter_values(out)), before);
    let none = State { time: 0.0, coordinates: &[], speeds: &[], inputs: &[] };
    assert_eq!(numeric.kinetic_energy(&none).unwrap_err().kind(), "wrong_length");
    assert_eq!(numeric.gap(99, &none).unwrap_err().kind(), "unknown_name");
    let wild = State { time: 0.0, coordinates: &[f64::NAN; 2], speeds: &[0.0; 2], inputs: &[] };
    assert!(numeric.accelerations(&wild, &mut [0.0; 2]).is_err());
    assert!(numeric.position(1, &wild).is_err());
}
