//! Tables for people: columns of text, aligned by blanks.

/// Rows of cells under a head.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these heads.
    pub fn new<S: Into<String>>(heads: impl IntoIterator<Item = S>) -> Self {
        Table { rows: vec![heads.into_iter().map(Into::into).collect()] }
    }

    /// Adds a row.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// Whether there is nothing below the heads.
    pub fn is_empty(&self) -> bool {
        self.rows.len() < 2
    }

    /// The table as text, each line behind this indentation: the first column to the left, the others to the
    /// right, but those that hold a word, to the left.
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

/// A number to six digits, as short as it can be.
pub fn number(value: f64) -> String {
    let rounded = format!("{value:.5e}");
    let exponent = rounded.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    match exponent {
        None => format!("{value}"),
        _ if value == 0.0 => "0".to_owned(),
        Some(exponent @ -4..=5) => {
            let digits = usize::try_from(5 - exponent).unwrap_or(0);
            shortened(&format!("{value:.digits$}"), "")
        }
        Some(exponent) => match rounded.split_once('e') {
            Some((digits, _)) => shortened(digits, &format!("e{exponent}")),
            None => rounded,
        },
    }
}

/// Digits without zeros behind the point, and what follows them.
fn shortened(digits: &str, rest: &str) -> String {
    let short = match digits.contains('.') {
        true => digits.trim_end_matches('0').trim_end_matches('.'),
        false => digits,
    };
    match short {
        "-0" => format!("0{rest}"),
        short => format!("{short}{rest}"),
    }
}

/// A name with its unit, as `q1 [rad]`; without one where there is none.
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
    fn numbers_are_short_and_right_to_six_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (-2.5, "-2.5"),
            (0.1 + 0.2, "0.3"),
            (123456.7, "123457"),
            (1234567.0, "1.23457e6"),
            (1.0 / 3.0, "0.333333"),
            (1e-5, "1e-5"),
            (-1.234567e-9, "-1.23457e-9"),
            (6.02e23, "6.02e23"),
            (1e-300, "1e-300"),
        ] {
            let found = number(value);
            assert_eq!(found, text);
            let read: f64 = found.parse().unwrap();
            assert!((read - value).abs() <= 5.1e-6 * value.abs(), "{value}: {found}");
        }
    }

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
