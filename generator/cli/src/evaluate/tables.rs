//! Writes the results of `eval` and `collide` as tables.

use hodograph_generator::model::mechanism::{Mechanism, Variable};
use hodograph_generator::program::Quantity;
use hodograph_generator::program::quantity::Description;

use super::collision::Collision;
use super::report::{ContactReport, Named, Report};
use crate::table::{Table, number, with_unit};

/// A unit per second.
fn rate(unit: &str) -> String {
    match unit {
        "" | "1" => "1/s".to_owned(),
        unit if unit.ends_with("/s") => format!("{unit}^2"),
        unit => format!("{unit}/s"),
    }
}

fn value(named: &Named<'_, f64>, name: &str) -> String {
    named.0.iter().find(|(other, _)| *other == name).map_or(String::new(), |(_, value)| number(*value))
}

/// A row with a name and numbers.
fn row(name: &str, numbers: &[f64]) -> Vec<String> {
    [name.to_owned()].into_iter().chain(numbers.iter().map(|&value| number(value))).collect()
}

impl Report<'_> {
    /// The tables of `eval`; `speeds` are the independent ones.
    pub fn tables(&self, model: &Mechanism, (time, speeds): (f64, &[f64])) -> String {
        let mut out = format!("{}, t = {} s\n\n", model.name, number(time));
        let mut table = Table::new(["coordinate", "value", "rate", ""]);
        for Variable { name, unit, .. } in &model.coordinates {
            table.row([with_unit(name, unit), value(&self.q, name), value(&self.qdot, name), rate(unit)]);
        }
        out += &table.text("  ");
        let mut table = Table::new(["speed", "value", "rate", ""]);
        for (index, Variable { name, unit, dependent, .. }) in model.speeds.iter().enumerate() {
            let now = match speeds.get(index) {
                Some(&speed) => number(speed),
                None => value(&self.dependent, name),
            };
            let note = if *dependent { format!("{}, dependent", rate(unit)) } else { rate(unit) };
            table.row([with_unit(name, unit), now, value(&self.udot, name), note]);
        }
        out += &format!("\n{}", table.text("  "));
        let heads = ["mass matrix"].into_iter().chain(self.speeds.iter().copied()).chain(["forcing"]);
        let mut table = Table::new(heads);
        for ((name, entries), forcing) in self.speeds.iter().zip(&self.mass_matrix).zip(&self.forcing) {
            let entries: Vec<f64> = entries.iter().chain([forcing]).copied().collect();
            table.row(row(name, &entries));
        }
        out += &format!("\n{}\n  kinetic energy {} J\n", table.text("  "), number(self.kinetic_energy));
        let mut table = Table::new(["along N", "x", "y", "z"]);
        for quantity in Quantity::named() {
            let Description { word, unit, .. } = quantity.description();
            let Some((_, numbers)) = self.named.0.iter().find(|(name, _)| name == word) else { continue };
            table.row(row(&with_unit(&word.replace('_', " "), unit), numbers));
        }
        if !self.named.0.is_empty() {
            out += &format!("\n{}", table.text("  "));
        }
        for (name, contact) in &self.contacts.0 {
            out += &format!("\ncontact {name}\n\n{}", contact.table());
        }
        out
    }
}

impl ContactReport {
    fn table(&self) -> String {
        let gap = self.gap.map_or("not stated in the model".to_owned(), |gap| format!("{} m", number(gap)));
        let mut axes = Table::new(["axes, along N", "x", "y", "z"]);
        axes.row(row("normal n", &self.normal));
        axes.row(row("tangent t", &self.tangent));
        axes.row(row("binormal s", &self.binormal));
        let mut along = Table::new(["along", "n", "t", "s"]);
        let [nn, nt, ns, tt, ts, ss] = self.reduced;
        along.row(row("velocity [m/s]", &self.v));
        along.row(row("reduced matrix n [1/kg]", &[nn, nt, ns]));
        along.row(row("reduced matrix t", &[nt, tt, ts]));
        along.row(row("reduced matrix s", &[ns, ts, ss]));
        let approach = match self.v[0] {
            v if v < 0.0 => "the bodies approach",
            _ => "the bodies do not approach",
        };
        format!("  gap: {gap}; {approach}\n\n{}\n{}", axes.text("  "), along.text("  "))
    }
}

impl Collision<'_> {
    /// The tables of `collide`; `before` holds all known speeds before the collision.
    pub fn tables(&self, title: &str, model: &Mechanism, before: &[f64]) -> String {
        let answer = &self.answer;
        let mut along = Table::new(["along", "n", "t", "s"]);
        along.row(row("impulse [N s]", &answer.impulse));
        along.row(row("separation [m/s]", &answer.v));
        let mut speeds = Table::new(["speed", "before", "after"]);
        for (index, Variable { name, unit, .. }) in model.speeds.iter().enumerate() {
            let before = before.get(index).map_or(String::new(), |&speed| number(speed));
            speeds.row([with_unit(name, unit), before, value(&self.u_after, name)]);
        }
        let sensitive = match answer.sensitivity.is_empty() {
            true => String::new(),
            false => format!("\n  sensitive to small changes: {}\n", answer.sensitivity.join(", ")),
        };
        let times = if answer.compressions == 1 { "time" } else { "times" };
        format!(
            "{title}\n\n  phases: {}; compression ended {} {times}\n\n{}\n{}\n  work of the contact {} J, of its normal component {} J; \
             kinetic energy {} J\n{sensitive}",
            answer.path.join(", then "),
            answer.compressions,
            along.text("  "),
            speeds.text("  "),
            signed(answer.contact_work),
            signed(answer.normal_work),
            signed(self.kinetic_energy_change),
        )
    }
}

/// A change, always with a sign.
fn signed(value: f64) -> String {
    let text = number(value);
    if value > 0.0 { format!("+{text}") } else { text }
}
