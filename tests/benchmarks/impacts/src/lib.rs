//! The objects of the measurements: collisions, methods, errors of outcomes, and modes of closed contacts.

mod hostile;
pub mod modes;
mod ode;
pub mod times;

use std::hint::black_box;

use hodograph::methods::{Integration, MethodError, Partial, Solution, Summation, integrate, irs, sum};
use hodograph::{Impact, Law, ReducedMatrix, Surface, solve};
use nalgebra::Vector3;
use serde_json::Value;

/// What is compared of an answer.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// impulse (n, t, s)
    pub impulse: Vector3<f64>,
    /// velocity of separation (n, t, s)
    pub velocity: Vector3<f64>,
    /// work of the impulse
    pub contact_work: f64,
    /// work of its normal part
    pub normal_work: f64,
}

impl From<Impact<f64>> for Outcome {
    fn from(hit: Impact<f64>) -> Self {
        let Impact { impulse, velocity, contact_work, normal_work, .. } = hit;
        Self { impulse, velocity, contact_work, normal_work }
    }
}

/// One collision and, for the random ones, its answer to 25 digits.
pub struct Case {
    /// the reduced matrix
    pub matrix: ReducedMatrix<f64>,
    /// the velocity of approach
    pub approach: Vector3<f64>,
    /// friction and restitution
    pub surface: Surface<f64>,
    expect: Option<Outcome>,
    answer: [f64; 8],
}

/// The two sleds of the paper, mu = 0.6, 1.1, 1.6 under the three laws, e = 0.8. The exact solver answers
/// them to better than 1e-12.
pub fn nine() -> Vec<Case> {
    let matrix = ReducedMatrix::new(0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211);
    let approach = Vector3::new(-0.946108022, 1.06306701, 0.0);
    let mut cases = Vec::new();
    for mu in [0.6, 1.1, 1.6] {
        for &law in Law::ALL {
            let surface = Surface { mu, e: 0.8, law };
            let expect = solve(&matrix, &approach, &surface).ok().map(Outcome::from);
            cases.push(Case { matrix, approach, surface, expect, answer: [0.0; 8] });
        }
    }
    cases
}

/// The reference collisions, or those of one family.
pub fn reference(family: Option<&str>) -> Vec<Case> {
    let text = include_str!("../../../data/impact_cases.jsonl");
    let number = |value: &Value| {
        value.as_f64().or_else(|| value.as_str().and_then(|text| text.parse().ok())).unwrap_or(f64::NAN)
    };
    let mut cases = Vec::new();
    for line in text.lines() {
        let Ok(case) = serde_json::from_str::<Value>(line) else { continue };
        if family.is_some_and(|family| case["family"].as_str() != Some(family)) {
            continue;
        }
        let law = case["law"].as_str().and_then(Law::named).unwrap_or(Law::Stronge);
        let expect = &case["expect"];
        let three = |value: &Value| [0, 1, 2].map(|i| number(&value[i]));
        let ([a, b, c], [d, e, f]) = (three(&expect["impulse"]), three(&expect["v"]));
        cases.push(Case {
            matrix: ReducedMatrix::from([0, 1, 2, 3, 4, 5].map(|i| number(&case["m"][i]))),
            approach: Vector3::from(three(&case["v"])),
            surface: Surface { mu: number(&case["mu"]), e: number(&case["e"]), law },
            expect: None,
            answer: [a, b, c, d, e, f, number(&expect["dE"]), number(&expect["dEn"])],
        });
    }
    cases
}

impl Case {
    /// A collision whose answer nobody asks for.
    fn unanswered(matrix: ReducedMatrix<f64>, approach: Vector3<f64>, surface: Surface<f64>) -> Self {
        Self { matrix, approach, surface, expect: None, answer: [0.0; 8] }
    }

    /// The scaled error of an answer: impulse by its largest component, velocity by approach plus separation,
    /// works by impulse times velocity.
    pub fn error(&self, hit: &Outcome) -> f64 {
        let answer = self.expect.map_or(self.answer, |x| {
            let (i, v) = (x.impulse, x.velocity);
            [i.x, i.y, i.z, v.x, v.y, v.z, x.contact_work, x.normal_work]
        });
        let (impulse, velocity) =
            (Vector3::from_row_slice(&answer[..3]), Vector3::from_row_slice(&answer[3..6]));
        let (i, v) = (impulse.amax(), velocity.amax() + self.approach.amax());
        ((hit.impulse - impulse).amax() / i)
            .max((hit.velocity - velocity).amax() / v)
            .max((hit.contact_work - answer[6]).abs() / (i * v))
            .max((hit.normal_work - answer[7]).abs() / (i * v))
    }
}

/// What a method answers, if it does.
pub type Answer = Option<Outcome>;

/// A way to solve: its name in the table, that of its function, and the function, never inlined.
pub type Method = (&'static str, &'static str, fn(&Case) -> Answer);

macro_rules! methods {
    ($($label:literal, $name:ident: $body:expr;)*) => {
        $(#[inline(never)]
        fn $name(case: &Case) -> Answer {
            let (m, v, s) = black_box((&case.matrix, &case.approach, &case.surface));
            let solve: fn(&ReducedMatrix<f64>, &Vector3<f64>, &Surface<f64>) -> Answer = $body;
            black_box(solve(m, v, s))
        })*
        /// All methods.
        pub const METHODS: &[Method] = &[$(($label, stringify!($name), $name)),*];
    };
}

methods! {
    "exact", measured_exact: |m, v, s| solve(m, v, s).ok().map(Outcome::from);
    "sum, k = 1", measured_sum_1: |m, v, s| plain(sum(m, v, s, &Summation::new(1)));
    "sum, k = 5", measured_sum_05: |m, v, s| plain(sum(m, v, s, &Summation::new(5)));
    "sum, k = 50", measured_sum_50: |m, v, s| plain(sum(m, v, s, &Summation::new(50)));
    "i/rs, k = 1", measured_irs_1: |m, v, s| plain(irs(m, v, s, &Partial::Sum(Summation::new(1))));
    "i/rs, k = 5", measured_irs_05: |m, v, s| plain(irs(m, v, s, &Partial::Sum(Summation::new(5))));
    "i/rs, k = 50", measured_irs_50: |m, v, s| plain(irs(m, v, s, &Partial::Sum(Summation::new(50))));
    "integration, 1e-6", measured_integrate_06: |m, v, s| plain(integrate(m, v, s, &Integration::with_tolerance(1e-6)));
    "integration, 1e-10", measured_integrate_10: |m, v, s| plain(integrate(m, v, s, &Integration::with_tolerance(1e-10)));
    "i/rs, integrated, 1e-10", measured_partial_10: |m, v, s| {
        plain(irs(m, v, s, &Partial::Integrate(Integration::with_tolerance(1e-10))))
    };
    "`ode_solvers`, 1e-6", measured_crate_06: |m, v, s| ode::solve(m, v, s, 1e-6);
    "`ode_solvers`, 1e-10", measured_crate_10: |m, v, s| ode::solve(m, v, s, 1e-10);
}

fn plain(hit: Result<Solution, MethodError>) -> Answer {
    hit.ok().map(|found| Outcome::from(found.impact))
}

/// The set of collisions of a name: `nine`, `nine and the last again`, `random`, `all` or `hostile`.
pub fn set(name: &str) -> Vec<Case> {
    match name {
        "nine" => nine(),
        "nine and the last again" => nine().into_iter().chain(nine().pop()).collect(),
        "hostile" => hostile::hostile(),
        "random" => reference(Some("random")),
        _ => reference(None),
    }
}
