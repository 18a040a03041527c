//! The shipped models with their derivations, and the reference data.

pub mod emitted;
pub mod expectations;
pub mod random;
pub mod rates;

use std::path::{Path, PathBuf};

use hodograph_generator::artifact;
use hodograph_generator::check::check;
use hodograph_generator::files;
use hodograph_generator::interpret::{Array, Evaluator};
use hodograph_generator::model::mechanism::{Mechanism, Variable};
use hodograph_generator::program::Inputs;
use hodograph_generator::program::Program;
use hodograph_generator::program::Quantity;
use serde_json::Value;

/// A shipped model with its derivation.
pub struct Model {
    /// stem of the file
    pub name: String,
    /// the text
    pub text: String,
    /// the meaning
    pub mechanism: Mechanism,
    /// the equations
    pub program: Program,
}

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All shipped models, by name.
pub fn models() -> Vec<Model> {
    models_in("")
}

/// The models of `models/shapes`, by name.
pub fn models_of_shapes() -> Vec<Model> {
    models_in("shapes/")
}

fn models_in(within: &str) -> Vec<Model> {
    let folder = root().join("models").join(within);
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("a folder of models")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "mech"))
        .map(|path| format!("{within}{}", path.file_stem().expect("a stem").to_string_lossy()))
        .collect();
    names.sort();
    names.iter().map(|name| Model::load(name)).collect()
}

impl Model {
    /// A model and its derivation, which must be that of this text.
    pub fn load(name: &str) -> Model {
        let path = root().join("models").join(name).with_extension("mech");
        let source = files::model(&path);
        let mechanism = check(&source).mechanism.unwrap_or_else(|| panic!("{name} is not accepted"));
        let derivation = std::fs::read_to_string(path.with_extension("derivation"))
            .unwrap_or_else(|error| panic!("{name} has no derivation: {error}"));
        let artifact = artifact::decode(&derivation).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(
            artifact.model,
            artifact::model_hash(&source),
            "the derivation of {name} is stale: run `cargo run -p hodograph-cli -- derive models/`"
        );
        let text = source.text().unwrap_or_default().to_string();
        Model { name: name.to_string(), text, mechanism, program: artifact.program }
    }

    /// Number of independent speeds.
    pub fn freedom(&self) -> usize {
        self.mechanism.speeds.iter().filter(|speed| !speed.dependent).count()
    }

    /// The state and parameters that the model states.
    pub fn initial(&self) -> Inputs {
        let m = &self.mechanism;
        let values = |list: &[Variable]| -> Vec<f64> {
            list.iter().map(|quantity| quantity.value.unwrap_or(0.0)).collect()
        };
        Inputs {
            parameters: values(&m.parameters),
            time: 0.0,
            coordinates: values(&m.coordinates),
            speeds: values(&m.speeds)[..self.freedom()].to_vec(),
            inputs: values(&m.inputs),
            accelerations: Vec::new(),
            tangent: Vec::new(),
        }
    }

    /// A quantity, empty where the mechanism has none.
    pub fn get(&self, inputs: &Inputs, quantity: Quantity) -> Array {
        match self.program.output(quantity) {
            None => Array { quantity, rows: 0, columns: 0, values: Vec::new() },
            Some(_) => Evaluator::new(&self.program)
                .evaluate(inputs, &[quantity])
                .unwrap_or_else(|failure| panic!("{}: {quantity:?}: {failure}", self.name))
                .remove(0),
        }
    }
}

/// A file of reference data.
pub struct Reference {
    /// name of the mechanism
    pub name: String,
    /// its content
    pub json: Value,
}

/// All reference data on states of mechanisms.
pub fn references() -> Vec<Reference> {
    let mut references = Vec::new();
    for folder in ["reference", "independent"] {
        let folder = root().join("tests/data").join(folder);
        let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
            .expect("reference data")
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
            .collect();
        paths.sort();
        for path in paths {
            let text = std::fs::read_to_string(&path).expect("text");
            let json: Value =
                serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            references.push(Reference { name: json["name"].as_str().expect("a name").to_string(), json });
        }
    }
    references
}

impl Reference {
    /// Inputs of a program at one of its states.
    pub fn inputs(&self, model: &Model, state: &Value) -> Inputs {
        let named = |list: &[Variable], values: &Value| -> Vec<f64> {
            list.iter().map(|quantity| number(&values[&quantity.name])).collect()
        };
        let listed = |names: &Value, values: &Value, list: &[Variable]| -> Vec<f64> {
            let names: Vec<&str> =
                names.as_array().expect("names").iter().filter_map(Value::as_str).collect();
            let expected: Vec<&str> = list.iter().map(|quantity| quantity.name.as_str()).collect();
            assert_eq!(names, expected, "{}", self.name);
            numbers(values)
        };
        let m = &model.mechanism;
        let (independent, dependent) = m.speeds.split_at(model.freedom());
        assert_eq!(listed(&self.json["u_dep"], &state["u_dep"], dependent).len(), dependent.len());
        Inputs {
            parameters: named(&m.parameters, &self.json["params"]),
            time: number(&state["t"]),
            coordinates: listed(&self.json["q"], &state["q"], &m.coordinates),
            speeds: listed(&self.json["u_ind"], &state["u_ind"], independent),
            inputs: named(&m.inputs, &self.json["inputs"]),
            accelerations: Vec::new(),
            tangent: Vec::new(),
        }
    }

    /// Its states.
    pub fn states(&self) -> &[Value] {
        self.json["states"].as_array().expect("states")
    }
}

/// A number of reference data.
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Numbers of reference data, nested lists by rows.
pub fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        other => vec![number(other)],
    }
}

/// Largest difference over the largest entry; where all entries are zero, the largest difference.
pub fn difference(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let top = theirs.iter().fold(0.0_f64, |top, x| top.max(x.abs()));
    let scale = if top > 1e-20 { top } else { 1.0 };
    ours.iter().zip(theirs).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / scale
}
