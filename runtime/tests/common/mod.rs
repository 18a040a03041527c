//! The reference collisions, read from `tests/data`.

pub mod double_double;
pub mod random;
pub mod second_road;

use hodograph::{Impact, Law, ReducedMatrix, Surface};
use nalgebra::Vector3;
use serde_json::Value;

/// One reference collision and its answer.
pub struct Case {
    pub line: String,
    pub family: String,
    pub matrix: ReducedMatrix<f64>,
    pub approach: Vector3<f64>,
    pub surface: Surface<f64>,
    pub impulse: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub contact_work: f64,
    pub normal_work: f64,
    pub path: String,
    pub compressions: Option<u64>,
    pub condition: f64,
}

/// A JSON number, or the decimal text of one.
fn number(value: &Value) -> f64 {
    value.as_f64().or_else(|| value.as_str().and_then(|s| s.parse().ok())).expect("a number")
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| number(&value[i]))
}

fn top(v: &Vector3<f64>) -> f64 {
    v.amax()
}

impl Case {
    fn read(line: &str) -> Self {
        let case: Value = serde_json::from_str(line).expect("JSON");
        let expect = &case["expect"];
        let law = case["law"].as_str().and_then(Law::named).expect("the name of a law");
        Self {
            line: line.to_owned(),
            family: case["family"].as_str().expect("family").to_owned(),
            matrix: ReducedMatrix::from(numbers::<6>(&case["m"])),
            approach: Vector3::from(numbers::<3>(&case["v"])),
            surface: Surface { mu: number(&case["mu"]), e: number(&case["e"]), law },
            impulse: Vector3::from(numbers::<3>(&expect["impulse"])),
            velocity: Vector3::from(numbers::<3>(&expect["v"])),
            contact_work: number(&expect["dE"]),
            normal_work: number(&expect["dEn"]),
            path: expect["phase"].as_str().expect("phase").to_owned(),
            compressions: expect["compressions"].as_u64(),
            condition: case["cond"].as_f64().unwrap_or(1.0),
        }
    }

    /// The largest error: of the impulse over its largest component, of the velocity over approach plus
    /// separation, of the works over impulse times velocity.
    pub fn error(&self, hit: &Impact<f64>) -> f64 {
        let impulse = if top(&self.impulse) > 0.0 { top(&self.impulse) } else { 1.0 };
        let velocity = top(&self.velocity) + top(&self.approach);
        (top(&(hit.impulse - self.impulse)) / impulse)
            .max(top(&(hit.velocity - self.velocity)) / velocity)
            .max((hit.contact_work - self.contact_work).abs() / (impulse * velocity))
            .max((hit.normal_work - self.normal_work).abs() / (impulse * velocity))
    }

    /// What the error may be.
    pub fn bound(&self) -> f64 {
        (32.0 * self.condition * 2.2e-16).max(1e-12)
    }
}

/// All reference collisions.
pub fn reference_cases() -> Vec<Case> {
    include_str!("../../../tests/data/impact_cases.jsonl").lines().map(Case::read).collect()
}

/// The paper's example (section 5), with s = n x t.
pub fn two_sleds(mu: f64, law: Law) -> (ReducedMatrix<f64>, Vector3<f64>, Surface<f64>) {
    let matrix = ReducedMatrix::new(0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211);
    (matrix, Vector3::new(-0.946108022, 1.06306701, 0.0), Surface { mu, e: 0.8, law })
}
