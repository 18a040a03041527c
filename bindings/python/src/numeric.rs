//! Quantities of a mechanism without derived equations, state by state.

use hodograph::{ComponentKind as Kind, Contacts, State, StateError};
use hodograph_generator::program::{ContactQuantity as C, PointQuantity as P, Quantity as Q};

/// The shape of a quantity; none of those that only derived equations determine.
pub fn shape(mechanism: &dyn Contacts<f64>, quantity: Q) -> Option<Vec<usize>> {
    let p = mechanism.count(Kind::Speed);
    Some(match quantity {
        Q::Accelerations | Q::Forcing | Q::InverseDynamics => vec![p],
        Q::MassMatrix => vec![p, p],
        Q::CoordinateRates => vec![mechanism.count(Kind::Coordinate)],
        Q::DependentSpeeds | Q::DependentAccelerations => vec![mechanism.count(Kind::DependentSpeed)],
        Q::KineticEnergy | Q::PotentialEnergy => vec![],
        Q::Orientation(_) => vec![3, 3],
        Q::Point(_, P::Jacobian) => vec![3, p],
        Q::Point(..) => vec![3],
        Q::Contact(_, C::Normal | C::First | C::Second | C::Velocity | C::FreeAcceleration) => vec![3],
        Q::Contact(_, C::Reduced) => vec![6],
        Q::Contact(_, C::Gap | C::Validity | C::Clearance) => vec![],
        Q::Contact(_, C::PartialVelocities) => vec![3, p],
        Q::Contact(_, C::Response) => vec![p, 3],
        _ => return None,
    })
}

/// The numbers of a quantity in a state, of which [`shape`] has the shape, by rows.
pub fn evaluate(
    mechanism: &dyn Contacts<f64>,
    quantity: Q,
    state: &State<'_>,
    accelerations: &[f64],
    numbers: &mut [f64],
) -> Result<(), StateError> {
    let one = |value: Option<f64>, what| value.ok_or(StateError::Undefined { what });
    let three: [f64; 3] = match quantity {
        Q::Accelerations => return mechanism.accelerations(state, numbers),
        Q::Forcing => return mechanism.forcing(state, numbers),
        Q::InverseDynamics => return mechanism.inverse_dynamics(state, accelerations, numbers),
        Q::MassMatrix => return mechanism.mass_matrix(state, numbers),
        Q::CoordinateRates => return mechanism.coordinate_rates(state, numbers),
        Q::DependentSpeeds => return mechanism.dependent_speeds(state, numbers),
        Q::DependentAccelerations => return mechanism.dependent_accelerations(state, numbers),
        Q::KineticEnergy => return fill(numbers, &[mechanism.kinetic_energy(state)?]),
        Q::PotentialEnergy => {
            return fill(numbers, &[one(mechanism.potential_energy(state)?, "potential energy")?]);
        }
        Q::Orientation(frame) => {
            // by rows
            let turned = mechanism.orientation(frame as usize, state)?.transpose();
            return fill(numbers, turned.as_slice());
        }
        Q::Point(point, P::Jacobian) => return mechanism.jacobian(point as usize, state, numbers),
        Q::Point(point, P::Position) => mechanism.position(point as usize, state)?.into(),
        Q::Point(point, P::Velocity) => mechanism.velocity(point as usize, state)?.into(),
        Q::Point(point, P::Acceleration) => {
            mechanism.acceleration(point as usize, state, accelerations)?.into()
        }
        Q::Contact(contact, of) => {
            let contact = contact as usize;
            match of {
                C::PartialVelocities => return mechanism.partial_velocities(contact, state, numbers),
                C::Response => return mechanism.response(contact, state, numbers),
                C::Gap => {
                    return fill(numbers, &[one(mechanism.gap(contact, state)?, "gap of this contact")?]);
                }
                C::Validity => {
                    let validity = mechanism.validity(contact, state)?;
                    return fill(numbers, &[one(validity, "validity of this contact")?]);
                }
                C::Clearance => return mechanism.clearances(&[contact], state, numbers),
                C::Velocity => mechanism.contact_velocity(contact, state)?.into(),
                C::FreeAcceleration => mechanism.free_acceleration(contact, state)?.into(),
                C::Normal => mechanism.contact_state(contact, state)?.normal.into(),
                C::First => mechanism.contact_state(contact, state)?.first.into(),
                C::Second => mechanism.contact_state(contact, state)?.second.into(),
                C::Reduced => {
                    let m = mechanism.contact_state(contact, state)?.reduced;
                    return fill(numbers, &<[f64; 6]>::from(m));
                }
                _ => return Err(StateError::Undefined { what: "quantity" }),
            }
        }
        _ => return Err(StateError::Undefined { what: "quantity" }),
    };
    fill(numbers, &three)
}

fn fill(numbers: &mut [f64], values: &[f64]) -> Result<(), StateError> {
    numbers.iter_mut().zip(values).for_each(|(number, value)| *number = *value);
    Ok(())
}
