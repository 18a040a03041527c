//! Stored figures of other generators and libraries.

use serde_json::Value;

use crate::tools::{Failure, Folders};

/// `tests/data/peers/instructions.json`.
pub struct Peers(Value);

/// A peer's figure.
pub struct Best {
    /// whose
    pub name: String,
    /// instructions per evaluation
    pub instructions: f64,
}

/// Reads them.
pub fn read(folders: &Folders) -> Result<Peers, Failure> {
    let text = std::fs::read_to_string(folders.root.join("tests/data/peers/instructions.json"))?;
    serde_json::from_str(&text).map(Peers).map_err(|error| Failure::new(error.to_string()))
}

impl Peers {
    /// The least figure for a routine of a mechanism.
    pub fn best(&self, mechanism: &str, routine: &str) -> Option<Best> {
        let figures = self.0["instructions"][mechanism][routine].as_object()?;
        let figures = figures
            .iter()
            .filter_map(|(name, value)| Some(Best { name: name.clone(), instructions: value.as_f64()? }));
        figures.min_by(|a, b| a.instructions.total_cmp(&b.instructions))
    }
}
