//! The models whose functions queries may call: the shipped ones, compiled in as text, and the user's own. A
//! model is checked and its derivation decoded when a query first names it.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use hodograph_generator::{artifact, check, files, format, rendering, source::Source};
use hodograph_interpreter::InterpretedMechanism;
use sha2::{Digest, Sha256};

/// A model file and its derivation.
#[derive(Debug)]
pub struct Model {
    /// the file's stem, as in the names of its functions
    pub name: String,
    /// the text of the model file
    pub model: String,
    /// the text of its derivation
    pub derivation: String,
    /// whether it is compiled in, so that every process of a cluster has it
    pub shipped: bool,
    loaded: OnceLock<Result<InterpretedMechanism, String>>,
}

impl Model {
    /// A model from the texts of its two files.
    pub fn new(name: &str, model: &str, derivation: &str, shipped: bool) -> Self {
        let (name, model, derivation) = (name.to_owned(), model.to_owned(), derivation.to_owned());
        Model { name, model, derivation, shipped, loaded: OnceLock::new() }
    }

    /// Reads a user's model file with the derivation beside it.
    ///
    /// # Errors
    ///
    /// The mistake in the file, its name or its derivation.
    pub fn read(path: &Path) -> Result<Self, String> {
        let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        let word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        if stem.is_empty() || !stem.chars().all(word) || stem.starts_with(|c: char| c.is_ascii_digit()) {
            return Err(format!(
                "{}: the names of SQL functions are formed from the file's name, which must be of lower-case letters, digits and `_`",
                path.display()
            ));
        }
        let text = |path: &Path, advice: &str| {
            files::text(path, artifact::MAX_BYTES)
                .map_err(|error| format!("cannot read {}: {error}{advice}", path.display()))
        };
        let source = files::model(path);
        let model = match source.expansion() {
            None => text(path, "")?,
            // the processes of a cluster have no folders, so the imports of the model are written out
            Some(_) => {
                let found = check::check(&source);
                if found.mechanism.is_none() {
                    return Err(rendering::render(&found.diagnostics, &source));
                }
                format::plain(&source)
            }
        };
        let advice = format!("; `hodograph derive {}` writes it", path.display());
        let derivation = text(&artifact::place::beside(path), &advice)?;
        let model = Model::new(stem, &model, &derivation, false);
        model.mechanism()?;
        Ok(model)
    }

    /// The mechanism, at the parameters of the file.
    ///
    /// # Errors
    ///
    /// The mistake in the model or its derivation.
    pub fn mechanism(&self) -> Result<&InterpretedMechanism, String> {
        self.loaded.get_or_init(|| self.load()).as_ref().map_err(Clone::clone)
    }

    fn load(&self) -> Result<InterpretedMechanism, String> {
        let source = Source::file(format!("{}.mech", self.name), self.model.as_str());
        let checked = check::check(&source);
        let Some(mechanism) = checked.mechanism else {
            return Err(rendering::render(&checked.diagnostics, &source));
        };
        let advice = format!("run `hodograph derive` on {}.mech", self.name);
        let program = artifact::load_text(&self.derivation, &source)
            .program()
            .map_err(|fault| format!("{}.derivation {fault}; {advice}", self.name))?;
        InterpretedMechanism::new(mechanism, program).map_err(|error| error.to_string())
    }

    /// The digest of both texts, by which processes check that they use the same model.
    pub fn digest(&self) -> [u8; 32] {
        Sha256::new()
            .chain_update(&self.model)
            .chain_update([0])
            .chain_update(&self.derivation)
            .finalize()
            .into()
    }
}

macro_rules! shipped {
    ($($name:literal)*) => {
        [$((
            $name,
            include_str!(concat!("../../models/", $name, ".mech")),
            include_str!(concat!("../../models/", $name, ".derivation")),
        )),*]
    };
}

/// The models of `models/`.
pub fn shipped() -> &'static [Arc<Model>] {
    static MODELS: OnceLock<Vec<Arc<Model>>> = OnceLock::new();
    MODELS.get_or_init(|| {
        let texts = shipped!(
            "arm_7dof" "ball_joint_body" "ball_on_turntable" "cart_5_link" "chaplygin_sleigh" "driven_rotary_pendulum" "five_bar"
            "four_bar" "free_box_corner" "free_box_quaternion" "planar_double_pendulum" "planar_triple_pendulum" "puma_560"
            "rattleback" "rolling_disc" "shaken_pendulum_moving_plate" "slender_rod_5dof" "slider_crank" "spherical_pendulum"
            "spring_damper_cart_rod" "stanford_arm" "two_sleds" "two_sleds_planar" "whipple_bicycle"
        );
        texts.into_iter().map(|(name, model, derivation)| Arc::new(Model::new(name, model, derivation, true))).collect()
    })
}
