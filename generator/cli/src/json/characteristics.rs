//! Writes the characteristic quantities of a contact, and those of one collision, as JSON or as a table.

use std::fmt::Write;

use clap::ValueEnum;
use hodograph::{Characteristics as OfContact, Phases, ReducedMatrix, phi_bar};
use serde::ser::{Serialize, SerializeMap, Serializer};

/// The format of characteristics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Form {
    /// in the field `characteristics` of the answer
    Json,
    /// as a table, instead of the answer
    Table,
}

/// The option that requests them.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct CharacteristicsArgument {
    /// also c_n, c_t, c_s, mu_c, phi_c, mu_s, phi_hat, phi_bar and the quantities at the end of compression
    /// and of slip: in the answer, or as a table instead of the answer
    #[arg(
        id = "characteristics",
        long,
        value_enum,
        value_name = "FORM",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "json"
    )]
    pub form: Option<Form>,
}

/// A quantity; its value is `None` if the quantity does not exist.
#[derive(Clone, Debug)]
struct Row {
    name: &'static str,
    value: Option<f64>,
    unit: &'static str,
    /// the equation or the section of the paper
    source: &'static str,
}

/// Quantities by name, in the order in which the paper introduces them.
#[derive(Clone, Debug)]
pub struct Characteristics(Vec<Row>);

impl Characteristics {
    /// The quantities that depend on the reduced matrix alone: (41), (43), mu_s.
    pub fn of_contact(matrix: &ReducedMatrix<f64>) -> Self {
        let found = OfContact::of(matrix, 0.0);
        let c = |index: usize| found.sticking.map(|c| c[index]);
        Characteristics(Vec::new())
            .with("c_n", c(0), "kg", "(41a)")
            .with("c_t", c(1), "kg", "(41b)")
            .with("c_s", c(2), "kg", "(41c)")
            .with("mu_c", Some(found.mu_c), "1", "(43)")
            .with("phi_c", Some(found.phi_c), "rad", "(43)")
            .with("mu_s", found.mu_s, "1", "3.3")
    }

    /// Adds those that depend on friction: phi_hat with its rates, and phi_bar for slip (v_t, v_s).
    pub fn with_friction(self, matrix: &ReducedMatrix<f64>, mu: f64, [v_t, v_s]: [f64; 2]) -> Self {
        let renewal = OfContact::of(matrix, mu).renewal;
        let slips = v_t != 0.0 || v_s != 0.0;
        let stop = slips.then(|| phi_bar(matrix, mu, v_s.atan2(v_t))).flatten();
        self.with("phi_hat", renewal.map(|found| found.phi_hat), "rad", "3.3")
            .with("f_hat", renewal.map(|found| found.f_hat), "1/kg", "(31), (46c)")
            .with("g_hat", renewal.map(|found| found.g_hat), "1/kg", "(32), (46b)")
            .with("dh_hat", renewal.map(|found| found.dh_hat), "1/kg", "6.1")
            .with("phi_bar", stop, "rad", "3.2")
    }

    /// Adds those at the end of compression and at the end of slip.
    pub fn with_phases(self, phases: &Phases<f64>) -> Self {
        let (end, stop) = (phases.last_compression_end, phases.slip_end);
        self.with("I_nC", end.map(|at| at.impulse.x), "N s", "(49)")
            .with("E_nC", end.map(|at| at.normal_work), "J", "(52)")
            .with("I_nS", stop.map(|at| at.impulse.x), "N s", "6.2")
            .with("v_nS", stop.map(|at| at.velocity.x), "m/s", "6.2")
            .with("E_nS", stop.map(|at| at.normal_work), "J", "6.3.3")
    }

    fn with(
        mut self,
        name: &'static str,
        value: Option<f64>,
        unit: &'static str,
        source: &'static str,
    ) -> Self {
        // Replace negative zeros for readers.
        let value = value.filter(|value| value.is_finite()).map(|value| value + 0.0);
        self.0.push(Row { name, value, unit, source });
        self
    }

    /// A table for people: quantity, value, unit, equation or section of the paper.
    pub fn table(&self) -> String {
        let mut out = format!("{:10}{:>24}  {:6}{}\n", "quantity", "value", "unit", "paper");
        for Row { name, value, unit, source } in &self.0 {
            let value = value.map_or("none".to_owned(), |value| value.to_string());
            let _ = writeln!(out, "{name:10}{value:>24}  {unit:6}{source}");
        }
        out
    }
}

impl Serialize for Characteristics {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for row in &self.0 {
            map.serialize_entry(row.name, &row.value)?;
        }
        map.end()
    }
}
