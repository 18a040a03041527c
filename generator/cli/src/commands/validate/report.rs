//! What `validate` answers: errors of all motions and their sums.

use std::collections::BTreeMap;

use hodograph_gradients::statistics::{mean_and_error, quantile, signed_ranks, wilson_interval};
use serde::Serialize;

use crate::table::{Table, number};

/// The columns of the table of errors.
pub const HEADS: [&str; 11] =
    ["error", "motions", "mean", "its error", "least", "10 %", "25 %", "median", "75 %", "90 %", "greatest"];

/// The parts of which quantiles are given.
const PARTS: [f64; 7] = [0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0];

/// The errors of one motion.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Motion {
    pub name: String,
    /// of the prediction; absent where it fails
    pub error: Option<f64>,
    /// of the prediction that nothing moves
    pub at_rest: f64,
    /// whether its end is as near as `--within` says
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right: Option<bool>,
    /// the same of the other prediction
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against_right: Option<bool>,
    /// of a replica with nothing but measurement errors
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<f64>,
    /// with the best values of this motion
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor: Option<f64>,
    /// why it cannot be predicted
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

/// Mean and quantiles of errors.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    pub count: usize,
    pub mean: f64,
    /// of the mean
    pub standard_error: Option<f64>,
    /// by the part of the motions with smaller errors
    pub quantiles: BTreeMap<String, f64>,
}

impl Summary {
    /// Of some errors; nothing of none.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Summary> {
        let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
        if values.is_empty() {
            return None;
        }
        let (mean, error) = mean_and_error(&values);
        let quantiles = PARTS.iter().map(|part| (part.to_string(), quantile(&values, *part))).collect();
        let standard_error = Some(error).filter(|error| error.is_finite());
        Some(Summary { count: values.len(), mean, standard_error, quantiles })
    }

    fn cells(&self, name: &str) -> Vec<String> {
        let error = self.standard_error.map_or("-".to_owned(), number);
        let mut cells = vec![name.to_owned(), self.count.to_string(), number(self.mean), error];
        cells.extend(PARTS.iter().map(|part| number(self.quantiles[&part.to_string()])));
        cells
    }
}

/// The share of motions whose end is near.
#[derive(Clone, Debug, Serialize)]
pub struct Share {
    pub right: usize,
    pub count: usize,
    pub share: f64,
    /// Wilson's, 95 %
    pub interval: [f64; 2],
}

impl Share {
    /// Of some ends; nothing of none.
    pub fn of(ends: impl Iterator<Item = bool>) -> Option<Share> {
        let ends: Vec<bool> = ends.collect();
        let (right, count) = (ends.iter().filter(|right| **right).count(), ends.len());
        let share = right as f64 / count as f64;
        (count > 0).then(|| Share { right, count, share, interval: wilson_interval(right, count) })
    }

    fn text(&self) -> String {
        let [low, high] = self.interval;
        format!("{} of {} ({:.3}; 95 %: {low:.3} to {high:.3})", self.right, self.count, self.share)
    }
}

/// Paired differences: the error of this prediction less that of the other.
#[derive(Clone, Debug, Serialize)]
pub struct Paired {
    pub count: usize,
    pub mean: f64,
    pub standard_error: Option<f64>,
    pub median: f64,
    /// motions that this prediction has nearer, and farther
    pub nearer: usize,
    pub farther: usize,
    /// Wilcoxon's signed-rank test, two-sided
    pub p: f64,
    /// p is counted over all signs; else from the normal distribution
    pub p_is_exact: bool,
}

impl Paired {
    /// Of the motions that both predict.
    pub fn of(motions: &[Motion]) -> Option<Paired> {
        let both = motions.iter().filter_map(|motion| Some(motion.error? - motion.against?));
        let differences: Vec<f64> = both.filter(|value| value.is_finite()).collect();
        if differences.is_empty() {
            return None;
        }
        let (mean, error) = mean_and_error(&differences);
        let ranks = signed_ranks(&differences);
        Some(Paired {
            count: differences.len(),
            mean,
            standard_error: Some(error).filter(|error| error.is_finite()),
            median: quantile(&differences, 0.5),
            nearer: differences.iter().filter(|value| **value < 0.0).count(),
            farther: differences.iter().filter(|value| **value > 0.0).count(),
            p: ranks.p,
            p_is_exact: ranks.is_exact,
        })
    }
}

/// The change of the errors with a coarser tolerance.
#[derive(Clone, Debug, Serialize)]
pub struct Convergence {
    pub tolerance: f64,
    pub median_change: f64,
    pub greatest_change: f64,
    /// where that is
    pub trajectory: String,
}

/// All of it.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    pub model: String,
    pub data: String,
    pub values: BTreeMap<String, f64>,
    /// what differences are divided by
    pub units: BTreeMap<String, f64>,
    /// motions of the data to which the values were fitted: their errors say less
    pub fitted_on: Vec<String>,
    pub error: Option<Summary>,
    pub at_rest: Option<Summary>,
    pub right: Option<Share>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<Summary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against_right: Option<Share>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub difference: Option<Paired>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<Summary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor: Option<Summary>,
    pub convergence: Vec<Convergence>,
    pub trajectories: Vec<Motion>,
}

impl Report {
    /// The rows of the table of errors: what, and its sums.
    pub fn rows(&self) -> Vec<(&'static str, &Summary)> {
        let rows = [
            ("this prediction", &self.error),
            ("the other", &self.against),
            ("nothing moves", &self.at_rest),
            ("noise alone", &self.noise),
            ("best values of each", &self.floor),
        ];
        rows.into_iter().filter_map(|(name, summary)| Some((name, summary.as_ref()?))).collect()
    }

    /// What is said below the table, a line each.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(share) = &self.right {
            notes.push(format!("right ends: {}", share.text()));
        }
        if let Some(share) = &self.against_right {
            notes.push(format!("right ends of the other: {}", share.text()));
        }
        if let Some(paired) = &self.difference {
            let error = paired.standard_error.map_or("-".to_owned(), number);
            notes.push(format!(
                "this less the other: {} with a standard error of {error}, median {}; nearer in {}, farther in {} of {}; Wilcoxon's p {:.2e} ({})",
                number(paired.mean),
                number(paired.median),
                paired.nearer,
                paired.farther,
                paired.count,
                paired.p,
                if paired.p_is_exact { "exact" } else { "normal" },
            ));
        }
        for one in &self.convergence {
            notes.push(format!(
                "with the tolerance {:e} errors change by {} (median), {} at most ({})",
                one.tolerance,
                number(one.median_change),
                number(one.greatest_change),
                one.trajectory
            ));
        }
        let failed: Vec<&Motion> = self.trajectories.iter().filter(|one| one.failed.is_some()).collect();
        for one in failed.iter().take(5) {
            notes.push(format!("{} is not predicted: {}", one.name, one.failed.as_deref().unwrap_or("")));
        }
        if failed.len() > 5 {
            notes.push(format!("and {} more are not", failed.len() - 5));
        }
        if !self.fitted_on.is_empty() {
            let count = self.fitted_on.len();
            notes
                .push(format!("{count} of these motions are named as those to which the values were fitted"));
        }
        notes
    }

    /// As text.
    pub fn tables(&self) -> String {
        let mut table = Table::new(HEADS);
        for (name, summary) in self.rows() {
            table.row(summary.cells(name));
        }
        format!("\n{}\n{}\n", table.text("  "), self.notes().join("\n"))
    }
}
