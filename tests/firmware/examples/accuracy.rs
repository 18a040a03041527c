//! What singles lose against doubles: accelerations and collisions of every shipped model at random states,
//! and the reference collisions by family. The states are singles, so that both types begin with the same
//! numbers; parameters are rounded. Runs on this machine only; docs/singles.md is what it prints.

use std::collections::BTreeMap;

use firmware::hard;
use firmware::random::Random;
use hodograph::nalgebra::Vector3;
use hodograph::{ComponentKind, Contacts, Law, ReducedMatrix, State, Surface, solve};

const STATES: usize = 1000;
/// Singles are said to suffice where no error is larger.
const ENOUGH: f64 = 1e-3;

const INTRODUCTION: &str = "\
# What singles lose against doubles

Printed by

```sh
cargo run --release --manifest-path tests/firmware/Cargo.toml --features std --example accuracy >docs/singles.md
```

Both types begin with the same numbers: states are singles; parameters, matrices and velocities of the reference collisions are rounded to singles, so that where an outcome hangs on their last digits the difference counts here too.
An error is the largest difference of a component over the largest component: of the impulse, of the accelerations, of the speeds after a collision (or before, if these are larger).
Every model at 1000 random states, 'refused' counts collisions with an outcome in one type alone. Singles have 1.2e-7 as relative spacing; they are said to suffice
where no call errs by more than 1e-3 and none is refused in one type alone.
";

/// Relative errors, and calls that are refused in one type only.
#[derive(Default)]
struct Errors {
    found: Vec<f64>,
    refused: usize,
}

impl Errors {
    /// Over the largest entry, or over `least` where all are smaller.
    fn compare(&mut self, single: Option<Vec<f32>>, double: Option<Vec<f64>>, least: f64) {
        match (single, double) {
            (Some(single), Some(double)) => {
                let size = double.iter().fold(least, |size, x| size.max(x.abs()));
                let differences = single.iter().zip(&double).map(|(x, y)| (f64::from(*x) - y).abs());
                self.found.push(differences.fold(0.0, f64::max) / size);
            }
            (None, None) => {}
            _ => self.refused += 1,
        }
    }

    fn row(&mut self, name: &str) -> String {
        self.found.sort_by(f64::total_cmp);
        let at = |share: f64| {
            self.found.get((share * (self.found.len() as f64 - 1.0)) as usize).copied().unwrap_or(f64::NAN)
        };
        format!(
            "| {name} | {} | {:.0e} | {:.0e} | {:.0e} | {} | {} |",
            self.found.len(),
            at(0.5),
            at(0.95),
            at(1.0),
            self.refused,
            if at(1.0) <= ENOUGH && self.refused == 0 { "yes" } else { "**no**" }
        )
    }
}

fn heading(what: &str) {
    println!(
        "\n| {what} | compared | median | 95 % | largest | refused in one type | suffice |\n| --- | ---: | ---: | ---: | ---: | ---: | --- |"
    );
}

fn model(single: &dyn Contacts<f32>, double: &dyn Contacts<f64>) -> [String; 2] {
    let [n, p, inputs] = [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input]
        .map(|kind| single.count(kind));
    let (mut q0, mut u0, mut w0) = (vec![0f32; n], vec![0f32; p], vec![0f32; inputs]);
    single.initial_state(&mut q0, &mut u0, &mut w0).expect("the slices have its lengths");
    let mut random = Random::new(n as u64);
    let (mut accelerations, mut collisions) = (Errors::default(), Errors::default());
    for number in 0..STATES {
        let mut near = |from: &[f32], size: f64| -> Vec<f32> {
            from.iter().map(|x| x + (size * random.number()) as f32).collect()
        };
        let (mut q, mut u, w) = (near(&q0, 0.5), near(&u0, 2.0), near(&w0, 1.0));
        let _ = single.normalise(&mut q);
        let wide = |slice: &[f32]| slice.iter().copied().map(f64::from).collect::<Vec<_>>();
        let time = random.number();
        let at = State { time: time as f32, coordinates: &q, speeds: &u, inputs: &w };
        if single.contact_velocity(0, &at).is_ok_and(|velocity| velocity.x > 0.0) {
            u.iter_mut().for_each(|u| *u = -*u);
        }
        let at = State { time: time as f32, coordinates: &q, speeds: &u, inputs: &w };
        let (q, u, w) = (wide(&q), wide(&u), wide(&w));
        let exact = State { time, coordinates: &q, speeds: &u, inputs: &w };
        let (mut out, mut expected) = (vec![0f32; p], vec![0f64; p]);
        let found = single.accelerations(&at, &mut out).ok().map(|()| out.clone());
        let known = double.accelerations(&exact, &mut expected).ok().map(|()| expected.clone());
        accelerations.compare(found, known, f64::MIN_POSITIVE);
        let (mu, e) = (0.75 + 0.75 * random.number(), 0.5 + 0.5 * random.number());
        let law = [Law::Newton, Law::Poisson, Law::Stronge][number % 3];
        let surface = Surface { mu: mu as f32, e: e as f32, law };
        let found = single.collide(0, &at, &surface, &mut out).ok().map(|_| out.clone());
        let surface = Surface { mu: f64::from(surface.mu), e: f64::from(surface.e), law };
        let known = double.collide(0, &exact, &surface, &mut expected).ok().map(|_| expected.clone());
        // Speeds after may be zero: the error is one of the speeds before too.
        let before = u.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        collisions.compare(found, known, before);
    }
    [accelerations.row(single.name()), collisions.row(single.name())]
}

/// The impulse of a collision in singles, its numbers rounded, beside that in doubles.
fn compare_collision(
    errors: &mut Errors,
    matrix: &ReducedMatrix<f64>,
    v: &Vector3<f64>,
    surface: &Surface<f64>,
) {
    let entries: [f64; 6] = (*matrix).into();
    let single = Surface { mu: surface.mu as f32, e: surface.e as f32, law: surface.law };
    let found = solve(&ReducedMatrix::from(entries.map(|x| x as f32)), &v.map(|x| x as f32), &single);
    let known = solve(matrix, v, surface);
    errors.compare(
        found.ok().map(|hit| hit.impulse.as_slice().to_vec()),
        known.ok().map(|hit| hit.impulse.as_slice().to_vec()),
        f64::MIN_POSITIVE,
    );
}

/// The families of `hard`, on contacts of no mechanism.
const HARD: [&str; hard::FAMILIES as usize] = [
    "ordinary",
    "friction of 0.01 to 10",
    "friction of 10 to 10 000",
    "friction next to mu_c, to 1e-7",
    "slip of 1e-12 to 0.01 times the ordinary",
    "slip of 10 to 1e6 times the ordinary",
    "slip next to an invariant direction, to 1e-12",
    "ordinary, others",
];

fn hard_collisions() {
    heading("hard collisions, impulse");
    let mut random = Random::new(32);
    for (family, name) in HARD.iter().enumerate() {
        let mut errors = Errors::default();
        for _ in 0..STATES {
            let (matrix, ordinary) = hard::contact(&mut random);
            let (v, surface) = hard::case(&mut random, family as u32, &matrix, &ordinary);
            compare_collision(&mut errors, &matrix, &v, &surface);
        }
        println!("{}", errors.row(name));
    }
}

fn main() {
    print!("{INTRODUCTION}");
    type Case = ([f64; 6], [f64; 3], f64, f64, Law);
    let cases: &[(&str, Case)] = &include!(concat!(env!("OUT_DIR"), "/families.rs"));
    let mut families: BTreeMap<&str, Errors> = BTreeMap::new();
    for (family, (m, v, mu, e, law)) in cases {
        let surface = Surface { mu: *mu, e: *e, law: *law };
        let errors = families.entry(family).or_default();
        compare_collision(errors, &ReducedMatrix::from(*m), &Vector3::from(*v), &surface);
    }
    heading("reference collisions, impulse");
    families.iter_mut().for_each(|(family, errors)| println!("{}", errors.row(family)));
    hard_collisions();
    let rows: Vec<[String; 2]> = models();
    for (what, k) in [("accelerations", 0), ("collisions, speeds after", 1)] {
        heading(what);
        rows.iter().for_each(|row| println!("{}", row[k]));
    }
}

macro_rules! models {
    ($($name:literal $module:ident $type:ident,)*) => {
        fn models() -> Vec<[String; 2]> {
            vec![$(model(
                &hodograph_models::$module::$type::<f32>::default(),
                &hodograph_models::$module::$type::<f64>::default(),
            ),)*]
        }
    };
}

hodograph_models::every_mechanism!(models);
