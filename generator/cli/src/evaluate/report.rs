//! Writes the result of `eval`.

use hodograph_generator::program::Quantity;
use nalgebra::Vector3;
use serde::ser::{Serialize, SerializeMap, Serializer};

use super::contact::{self, Contact};
use super::{Machine, Numbers};
use crate::json::Failure;
use crate::json::characteristics::Characteristics;
use crate::json::state::State;

/// Values with their names, in order.
#[derive(Clone, Debug)]
pub struct Named<'a, T>(pub Vec<(&'a str, T)>);

impl<T: Serialize> Serialize for Named<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

/// Numbers with the names of quantities of a model.
pub fn named<'a>(
    quantities: impl IntoIterator<Item = &'a hodograph_generator::model::mechanism::Variable>,
    numbers: impl IntoIterator<Item = f64>,
) -> Named<'a, f64> {
    Named(quantities.into_iter().map(|quantity| quantity.name.as_str()).zip(numbers).collect())
}

/// The answer of `eval`.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Report<'a> {
    pub(super) speeds: Vec<&'a str>,
    pub(super) q: Named<'a, f64>,
    pub(super) mass_matrix: Vec<Vec<f64>>,
    pub(super) forcing: Vec<f64>,
    pub(super) udot: Named<'a, f64>,
    pub(super) qdot: Named<'a, f64>,
    pub(super) dependent: Named<'a, f64>,
    pub(super) kinetic_energy: f64,
    /// quantities that are offered by name, in the order of the table of quantities
    #[serde(flatten)]
    pub(super) named: Named<'a, Vec<f64>>,
    pub(super) contacts: Named<'a, ContactReport>,
}

#[derive(Clone, Debug, serde::Serialize)]
pub struct ContactReport {
    pub(super) gap: Option<f64>,
    pub(super) normal: [f64; 3],
    pub(super) tangent: [f64; 3],
    pub(super) binormal: [f64; 3],
    velocity: [f64; 3],
    #[serde(rename = "V")]
    partials: [Vec<f64>; 3],
    remainder: [f64; 3],
    pub(super) reduced: [f64; 6],
    pub(super) v: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    characteristics: Option<Characteristics>,
}

impl ContactReport {
    /// The characteristic quantities of the contact, including those that depend on friction if mu is given.
    fn found(&self, mu: Option<f64>) -> Characteristics {
        let matrix = self.reduced.into();
        let found = Characteristics::of_contact(&matrix);
        let [_, v_t, v_s] = self.v;
        match mu {
            Some(mu) => found.with_friction(&matrix, mu, [v_t, v_s]),
            None => found,
        }
    }
}

impl Report<'_> {
    /// Adds the characteristic quantities of all contacts.
    pub fn characterise(&mut self, mu: Option<f64>) {
        for (_, contact) in &mut self.contacts.0 {
            contact.characteristics = Some(contact.found(mu));
        }
    }

    /// The characteristic quantities as tables, one for each contact.
    pub fn characteristics(&self, mu: Option<f64>) -> String {
        let table =
            |(name, contact): &(&str, ContactReport)| format!("{name}\n{}", contact.found(mu).table());
        self.contacts.0.iter().map(table).collect::<Vec<_>>().join("\n")
    }
}

impl From<Contact> for ContactReport {
    fn from(contact: Contact) -> Self {
        // Replace negative zeros for readers.
        let plain = |vector: Vector3<f64>| vector.map(|number| number + 0.0).into();
        let [normal, tangent, binormal] = contact.axes.map(plain);
        ContactReport {
            gap: contact.gap,
            normal,
            tangent,
            binormal,
            velocity: plain(contact.velocity),
            partials: contact.partials.map(|row| row.into_iter().map(|number| number + 0.0).collect()),
            remainder: plain(contact.remainder),
            reduced: <[f64; 6]>::from(contact.reduced).map(|number| number + 0.0),
            v: plain(contact.slip),
            characteristics: None,
        }
    }
}

/// The quantities that do not belong to a contact.
const QUANTITIES: [Quantity; 7] = [
    Quantity::MassMatrix,
    Quantity::Forcing,
    Quantity::Accelerations,
    Quantity::DependentAccelerations,
    Quantity::CoordinateRates,
    Quantity::DependentSpeeds,
    Quantity::KineticEnergy,
];

/// Evaluates the model in a state.
///
/// # Errors
///
/// `singular_state`.
pub fn report<'a>(machine: &'a Machine, state: &State) -> Result<Report<'a>, Failure> {
    let mechanism = &machine.mechanism;
    let of_contacts = (0..mechanism.contacts.len())
        .flat_map(|index| contact::QUANTITIES.map(|quantity| Quantity::Contact(index as u32, quantity)));
    let wanted: Vec<Quantity> = QUANTITIES.into_iter().chain(Quantity::named()).chain(of_contacts).collect();
    let numbers: Numbers = machine.evaluate(state, &wanted)?;
    let (independent, dependent) = mechanism.speeds.split_at(state.speeds.len());
    // Zeros have no sign for readers.
    let plain = |list: &[f64]| list.iter().map(|number| number + 0.0).collect::<Vec<f64>>();
    let get = |quantity| plain(numbers.get(quantity));
    let udot = get(Quantity::Accelerations).into_iter().chain(get(Quantity::DependentAccelerations));
    Ok(Report {
        speeds: independent.iter().map(|speed| speed.name.as_str()).collect(),
        q: named(&mechanism.coordinates, plain(&state.coordinates)),
        mass_matrix: numbers.rows(Quantity::MassMatrix).into_iter().map(plain).collect(),
        forcing: get(Quantity::Forcing),
        udot: named(&mechanism.speeds, udot),
        qdot: named(&mechanism.coordinates, get(Quantity::CoordinateRates)),
        dependent: named(dependent, get(Quantity::DependentSpeeds)),
        kinetic_energy: get(Quantity::KineticEnergy).first().copied().unwrap_or(0.0),
        named: Named(
            Quantity::named()
                .map(|quantity| (quantity.description().word, get(quantity)))
                .filter(|(_, numbers)| !numbers.is_empty())
                .collect(),
        ),
        contacts: Named(
            mechanism
                .contacts
                .iter()
                .enumerate()
                .map(|(index, contact)| {
                    (contact.name.as_str(), Contact::new(&numbers, index, &state.speeds).into())
                })
                .collect(),
        ),
    })
}
