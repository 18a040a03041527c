//! The short form of a sweep, `--model two_sleds --vary mu=0:2:100 --sample 1e9`, as SQL: the numbers of
//! collisions of a model by their outcomes, for every point of a grid.

use std::fmt::Write;

use crate::failure::Failure;
use crate::models::Model;

/// `name=low:high:count`: the values of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Vary {
    name: String,
    low: f64,
    high: f64,
    count: i64,
}

/// `name=low:high`: uniformly distributed.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    name: String,
    low: f64,
    high: f64,
}

/// `name=value`.
#[derive(Clone, Debug, PartialEq)]
pub struct Set {
    name: String,
    value: String,
}

fn named(text: &str) -> Result<(String, &str), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=..")?;
    if name.is_empty() || !name.chars().all(|c| c.is_alphanumeric() || c == '_') {
        return Err(format!("`{name}` is no name"));
    }
    Ok((name.to_owned(), value))
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or(format!("`{text}` is not a number"))
}

impl std::str::FromStr for Vary {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, range) = named(text)?;
        let [low, high, count] = range.split(':').collect::<Vec<_>>()[..] else {
            return Err("expected NAME=LOW:HIGH:COUNT".to_owned());
        };
        let count = count.parse().ok().filter(|count| (1..=1_000_000).contains(count));
        let count = count.ok_or("COUNT must be a whole number from 1 to 1000000")?;
        Ok(Vary { name, low: number(low)?, high: number(high)?, count })
    }
}

impl std::str::FromStr for Draw {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, range) = named(text)?;
        let (low, high) = range.split_once(':').ok_or("expected NAME=LOW:HIGH")?;
        Ok(Draw { name, low: number(low)?, high: number(high)? })
    }
}

impl std::str::FromStr for Set {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = named(text)?;
        let value = match name.as_str() {
            "law" | "contact" => format!("'{}'", value.replace('\'', "''")),
            _ => format!("{:?}", number(value)?),
        };
        Ok(Set { name, value })
    }
}

/// A count of rows: `1000000`, `1e9`.
///
/// # Errors
///
/// The text is not a number of rows.
pub fn count(text: &str) -> Result<i64, String> {
    let number: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    if (1.0..=9e15).contains(&number) && number.fract() == 0.0 {
        Ok(number as i64)
    } else {
        Err("expected a whole number from 1 to 9e15, as 1e9".to_owned())
    }
}

/// A sweep in short form.
#[derive(Clone, Debug)]
pub struct Short<'a> {
    /// the model
    pub model: &'a Model,
    /// the grid
    pub vary: &'a [Vary],
    /// the random fields
    pub draw: &'a [Draw],
    /// the constant fields
    pub set: &'a [Set],
    /// number of collisions
    pub sample: i64,
    /// the seed
    pub seed: i64,
    /// `uniform` or `sobol`
    pub sampler: &'a str,
}

/// The counts in a row of the answer: name, and the condition for counting.
const COUNTS: [(&str, &str); 6] = [
    ("solved", "c['kind'] = 'ok'"),
    ("not_approaching", "c['kind'] = 'not_approaching'"),
    ("slides", "c['path'] = 'sliding'"),
    ("sticks", "c['path'] IN ('sticking', 'sliding, then sticking')"),
    ("renews", "c['path'] IN ('renewal', 'sliding, then renewal')"),
    ("gains_energy", "energy_gained(c) > 0.0"),
];

impl Short<'_> {
    /// The query, and the query that combines the answers of parts.
    ///
    /// # Errors
    ///
    /// A name is given twice, or the grid has more points than rows.
    pub fn sql(&self) -> Result<(String, String), Failure> {
        let points: i64 =
            self.vary.iter().map(|vary| vary.count).try_fold(1, i64::checked_mul).unwrap_or(i64::MAX);
        if points > self.sample {
            return Err(Failure::Input(format!(
                "--sample {} is less than the {points} points of the grid",
                self.sample
            )));
        }
        let mut fields: Vec<(String, String)> = Vec::new();
        let mut inner = String::new();
        let mut stride = 1;
        for Vary { name, low, high, count } in self.vary {
            let _ =
                write!(inner, ", linspace(i / {stride} % {count}, {low:?}, {high:?}, {count}) AS \"{name}\"");
            fields.push((name.clone(), format!("\"{name}\"")));
            stride *= count;
        }
        let free = self.free_speeds()?;
        let draw = if self.draw.is_empty() { &free } else { self.draw };
        for (dimension, Draw { name, low, high }) in draw.iter().enumerate() {
            let sample =
                format!("{low:?} + {:?} * {}(i, {dimension}, {})", high - low, self.sampler, self.seed);
            fields.push((name.clone(), sample));
        }
        fields.extend(self.set.iter().map(|set| (set.name.clone(), set.value.clone())));
        for (name, value) in [("mu", "0.5"), ("e", "0.5"), ("law", "'stronge'")] {
            if !fields.iter().any(|(known, _)| known == name) {
                fields.push((name.to_owned(), value.to_owned()));
            }
        }
        for (index, (name, _)) in fields.iter().enumerate() {
            if fields.iter().take(index).any(|(other, _)| other == name) {
                return Err(Failure::Input(format!("`{name}` is given twice")));
            }
        }
        let list =
            |of: &dyn Fn(&(String, String)) -> String| fields.iter().map(of).collect::<Vec<_>>().join(", ");
        let argument = list(&|(name, value)| format!("'{name}', {value}"));
        let keys: String = self.vary.iter().map(|vary| format!("\"{}\", ", vary.name)).collect();
        let group = self.grouped();
        let counts: String = COUNTS
            .iter()
            .map(|(name, which)| format!("  count(*) FILTER (WHERE {which}) AS {name},\n"))
            .collect();
        let sums: String = COUNTS.iter().map(|(name, _)| format!("  sum({name}) AS {name},\n")).collect();
        let extremes = [("least_work", "min"), ("greatest_work", "max")];
        let of = |column: &dyn Fn(&str) -> String| {
            extremes.map(|(name, function)| format!("  {function}({}) AS {name},\n", column(name))).concat()
        };
        let model = &self.model.name;
        let query = format!(
            "SELECT {keys}count(*) AS collisions,\n{counts}{}  checksum(outcome_hash(c)) AS checksum\nFROM (\n  SELECT {keys}{model}_collide(named_struct({argument})) AS c\n  FROM (SELECT i{inner} FROM rows({}))\n){group}",
            of(&|_| "c['contact_work']".to_owned()),
            self.sample
        );
        let merge = format!(
            "SELECT {keys}sum(collisions) AS collisions,\n{sums}{}  checksum(checksum) AS checksum\nFROM parts{group}",
            of(&str::to_owned)
        );
        Ok((query, merge))
    }

    fn grouped(&self) -> String {
        match self.vary {
            [] => String::new(),
            vary => {
                let names =
                    vary.iter().map(|vary| format!("\"{}\"", vary.name)).collect::<Vec<_>>().join(", ");
                format!("\nGROUP BY {names}\nORDER BY {names}")
            }
        }
    }

    /// The default random fields: every independent speed that is not given otherwise, from -1 to 1.
    fn free_speeds(&self) -> Result<Vec<Draw>, Failure> {
        use hodograph::{ComponentKind, Mechanism};
        let mechanism = self.model.mechanism().map_err(Failure::Input)?;
        let names = (0..Mechanism::count(mechanism, ComponentKind::Speed)).filter_map(|index| {
            Mechanism::component(mechanism, ComponentKind::Speed, index).map(|speed| speed.name.to_owned())
        });
        let given = |name: &String| {
            self.vary.iter().any(|vary| vary.name == *name) || self.set.iter().any(|set| set.name == *name)
        };
        Ok(names.filter(|name| !given(name)).map(|name| Draw { name, low: -1.0, high: 1.0 }).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functions::OK;

    #[test]
    fn counts_name_the_kind_and_the_paths_that_answers_have() {
        use hodograph::Path;
        assert!(COUNTS[0].1.contains(&format!("'{OK}'")));
        let paths = [
            Path::Sliding,
            Path::SlidingThenSticking,
            Path::SlidingThenRenewal,
            Path::Sticking,
            Path::Renewal,
        ];
        for path in paths {
            let quoted = format!("'{}'", crate::functions::path_name(path));
            assert_eq!(COUNTS.iter().filter(|(_, which)| which.contains(&quoted)).count(), 1, "{quoted}");
        }
    }

    #[test]
    fn wrong_arguments_are_refused() {
        assert!("mu=0:2:100".parse::<Vary>().is_ok());
        for wrong in ["mu", "mu=0:2", "mu=0:2:0", "mu=0:x:3", "m u=0:2:3", "=0:2:3"] {
            assert!(wrong.parse::<Vary>().is_err(), "{wrong}");
        }
        assert_eq!(count("1e9"), Ok(1_000_000_000));
        for wrong in ["0", "1.5", "-3", "many", "1e30"] {
            assert!(count(wrong).is_err(), "{wrong}");
        }
    }
}
