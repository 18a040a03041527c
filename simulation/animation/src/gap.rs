//! The gap of a contact in a state.

use hodograph::{Contacts, State as Borrowed};

/// The gap of a contact; `None` if the model does not define it.
pub fn gap(mechanism: &dyn Contacts<f64>, contact: usize, state: &Borrowed<'_>) -> Option<f64> {
    mechanism.gap(contact, state).ok().flatten()
}
