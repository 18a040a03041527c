//! Converts a unit to bytes and back, to save and serialise its state.

use std::sync::Arc;

use hodograph_simulation::Saved;
use serde::{Deserialize, Serialize};

use crate::instance::{Instance, Kind, Mode, Refusal, refused};
use crate::settings::{Now, Settings};

/// The content of a saved state.
#[derive(Serialize, Deserialize)]
struct Image {
    kind: Kind,
    mode: Mode,
    settings: Settings,
    now: Now,
    events: u64,
    moves: Option<Saved>,
}

impl Instance {
    /// Everything on which the future of the unit depends, as bytes.
    ///
    /// # Errors
    ///
    /// There is not enough memory.
    pub fn image(&self) -> Result<Vec<u8>, Refusal> {
        let image = Image {
            kind: self.kind,
            mode: self.mode,
            settings: self.settings.clone(),
            now: self.now.clone(),
            events: self.events,
            moves: self.running.as_ref().map(|running| running.simulation().save()),
        };
        postcard::to_allocvec(&image).map_err(|error| Refusal(error.to_string()))
    }

    /// Restores a state of the same unit.
    ///
    /// # Errors
    ///
    /// The bytes are not a state of this unit; the unit is then unchanged.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), Refusal> {
        const OTHER: &str = "these bytes are not a state of this unit";
        let image: Image = postcard::from_bytes(bytes).map_err(|_| Refusal(OTHER.to_owned()))?;
        let sizes = |now: &Now| (now.coordinates.len(), now.speeds.len(), now.inputs.len());
        let contacts = |settings: &Settings| -> Vec<usize> {
            settings.surfaces.iter().map(|surface| surface.0).collect()
        };
        let fits = image.kind == self.kind
            && sizes(&image.now) == sizes(&self.now)
            && sizes(&image.settings.start) == sizes(&self.now)
            && image.settings.parameters.len() == self.settings.parameters.len()
            && contacts(&image.settings) == contacts(&self.settings);
        if !fits {
            return refused(OTHER);
        }
        let mut other = Self {
            layout: Arc::clone(&self.layout),
            mode: image.mode,
            settings: image.settings,
            now: image.now.clone(),
            running: None,
            events: 0,
            ..*self
        };
        if let Some(saved) = image.moves {
            let fits = other.running()?.with(|simulation| simulation.restore(saved));
            if !fits {
                return refused(OTHER);
            }
        }
        (other.now, other.events) = (image.now, image.events);
        *self = other;
        Ok(())
    }
}
