//! Tables for people: columns of aligned text.

pub use hodograph_animation::number;

/// Rows of cells under a header.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headers.
    pub fn new<S: Into<String>>(heads: impl IntoIterator<Item = S>) -> Self {
        Table { rows: vec![heads.into_iter().map(Into::into).collect()] }
    }

    /// Adds a row.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// Whether there are no rows below the header.
    pub fn is_empty(&self) -> bool {
        self.rows.len() < 2
    }

    /// The table as text, each line with this indentation. The first column and columns with words are
    /// left-aligned, the others right-aligned.
    pub fn text(&self, indentation: &str) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let cells = |column: usize| self.rows.iter().filter_map(move |row| row.get(column));
        let width = |column| cells(column).map(|cell| cell.chars().count()).max().unwrap_or(0);
        let words = |column| {
            let below = self.rows.iter().skip(1).filter_map(|row| row.get(column));
            column == 0 || below.clone().any(|cell: &String| !cell.is_empty() && !is_number(cell))
        };
        let shape: Vec<(usize, bool)> = (0..columns).map(|column| (width(column), words(column))).collect();
        let mut out = String::new();
        for row in &self.rows {
            let cells = row.iter().zip(&shape).map(|(cell, &(width, words))| match words {
                true => format!("{cell:width$}"),
                false => format!("{cell:>width$}"),
            });
            let line = format!("{indentation}{}", cells.collect::<Vec<_>>().join("  "));
            out.push_str(line.trim_end());
            out.push('\n');
        }
        out
    }
}

fn is_number(cell: &str) -> bool {
    cell.parse::<f64>().is_ok() || cell == "-"
}

/// A name with its unit, such as `q1 [rad]`; without one if the unit is empty.
pub fn with_unit(name: &str, unit: &str) -> String {
    match unit {
        "" | "1" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(["t [s]", "event", "energy"]);
        table.row(["0.5", "collision", "-1.25"]);
        table.row(["0.75", "rest", "-"]);
        assert_eq!(
            table.text("  "),
            "  t [s]  event      energy\n  0.5    collision   -1.25\n  0.75   rest            -\n"
        );
    }
}
