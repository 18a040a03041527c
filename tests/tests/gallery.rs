//! The table of `docs/gallery.md` is that of the shipped models, and the page shows every one of them.
//!
//! `HODOGRAPH_UPDATE=1 cargo test -p hodograph-tests --test all gallery::` writes the table anew.

use crate::common::random::{Sample, samples};
use crate::common::{Model, models, root};
use hodograph_generator::program::{ContactQuantity as C, Quantity as Q};
use nalgebra::Matrix3;

const BEGIN: &str = "<!-- table -->\n";
const END: &str = "<!-- end of table -->\n";

#[test]
fn the_table_is_fresh() {
    let path = root().join("docs/gallery.md");
    let page = std::fs::read_to_string(&path).expect("docs/gallery.md");
    let (before, rest) = page.split_once(BEGIN).expect("the beginning of the table");
    let (old, after) = rest.split_once(END).expect("the end of the table");
    let rows: Vec<Row> = models().iter().map(Row::of).collect();
    if crate::common::expectations::are_written_anew() {
        let table: String = rows.iter().map(Row::line).collect();
        std::fs::write(&path, format!("{before}{BEGIN}{HEAD}{table}{END}{after}")).expect("written");
        return;
    }
    let advice = "run `HODOGRAPH_UPDATE=1 cargo test -p hodograph-tests --test all gallery::`";
    let fresh: String = rows.iter().map(Row::line).collect();
    assert_eq!(old.strip_prefix(HEAD).unwrap_or_default(), fresh, "docs/gallery.md is stale: {advice}");
}

#[test]
fn every_model_is_shown() {
    let page = std::fs::read_to_string(root().join("docs/gallery.md")).expect("docs/gallery.md");
    for model in models() {
        let name = &model.name;
        assert!(page.contains(&format!("\n## {name}\n")), "docs/gallery.md does not describe {name}");
        let sketch = root().join("docs/gallery").join(format!("{name}.svg"));
        assert!(sketch.exists(), "{name} has no sketch");
        assert!(
            page.contains(&format!("gallery/{name}.svg")),
            "docs/gallery.md does not show the sketch of {name}"
        );
    }
}

const HEAD: &str = "\
| mechanism | coordinates | speeds | dependent | constraints | contacts: rank | lines | agreement |
| --- | --- | --- | --- | --- | --- | --- | --- |
";

struct Row {
    name: String,
    coordinates: usize,
    speeds: usize,
    dependent: usize,
    constraints: String,
    ranks: String,
    lines: usize,
    agreement: f64,
}

impl Row {
    fn of(model: &Model) -> Row {
        let m = &model.mechanism;
        let samples = samples(model, 4);
        let ranks: Vec<String> = m
            .contacts
            .iter()
            .enumerate()
            .map(|(index, contact)| format!("{}: {}", contact.name, rank(model, index as u32, &samples)))
            .collect();
        let code = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
        let dependent = m.speeds.len() - model.freedom();
        let closed = m.coordinates.iter().filter(|coordinate| coordinate.dependent).count();
        let constraints = match (dependent, closed) {
            (0, 0) => "-".to_string(),
            (velocity, 0) => format!("{velocity} of velocity"),
            (velocity, closed) => format!("{velocity} of velocity, {closed} of configuration"),
        };
        Row {
            name: model.name.clone(),
            coordinates: m.coordinates.len(),
            speeds: model.freedom(),
            dependent,
            constraints,
            ranks: ranks.join(", "),
            lines: model.text.lines().filter(code).count(),
            agreement: agreement(model, &samples),
        }
    }

    fn facts(&self) -> String {
        let Row { name, coordinates, speeds, dependent, constraints, ranks, lines, .. } = self;
        format!(
            "| [{name}](#{name}) | {coordinates} | {speeds} | {dependent} | {constraints} | {ranks} | {lines}"
        )
    }

    fn line(&self) -> String {
        format!("{} | {:.0e} |\n", self.facts(), self.agreement)
    }
}

/// Rank of the reduced matrix, the largest at some states.
fn rank(model: &Model, contact: u32, samples: &[Sample]) -> usize {
    let of = |sample: &Sample| {
        let reduced = model.get(&sample.inputs, Q::Contact(contact, C::Reduced)).values;
        let [nn, nt, ns, tt, ts, ss] = reduced[..] else { panic!("six entries") };
        let values = Matrix3::new(nn, nt, ns, nt, tt, ts, ns, ts, ss).symmetric_eigenvalues();
        values.iter().filter(|value| **value > 1e-9 * values.max()).count()
    };
    samples.iter().map(of).max().unwrap_or(0)
}

/// Largest difference between the derived program and the numeric evaluation, over the largest entry of each
/// quantity.
fn agreement(model: &Model, samples: &[Sample]) -> f64 {
    let mut worst = 0.0_f64;
    for sample in samples {
        let mut compare = |quantity: Q, theirs: &[f64]| {
            worst = worst.max(crate::common::difference(&model.get(&sample.inputs, quantity).values, theirs));
        };
        compare(Q::MassMatrix, &sample.numeric.mass_matrix.concat());
        compare(Q::Forcing, &sample.numeric.forcing);
        compare(Q::CoordinateRates, &sample.numeric.rates);
        compare(Q::KineticEnergy, &[sample.numeric.kinetic_energy]);
    }
    // A power of ten well above the rounding of either road, so that the table is the same on every machine.
    10f64.powf((3.0 * worst).max(1e-14).log10().ceil())
}
