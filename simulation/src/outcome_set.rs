//! What many motions from one state that differ by draws only tell of the set of all of them: where they end, what is
//! probable to be missing, and ranges with a confidence (docs/theory.md, section 17.19).

use crate::{Options, Outcome};

/// Ends of motions are alike up to this many absolute tolerances, and this part of each number.
const TOLERANCES: f64 = 1e3;
const ALIKE: f64 = 1e-6;

/// An end that some of the motions have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct End {
    /// how many of the motions end so
    pub count: usize,
    /// the row of the first of them
    pub row: usize,
}

/// The least and the greatest value of a quantity at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// its least value
    pub least: f64,
    /// its greatest value
    pub greatest: f64,
}

impl Range {
    /// Whether a value is within the range.
    pub fn holds(&self, value: f64) -> bool {
        (self.least..=self.greatest).contains(&value)
    }
}

/// The ends of motions that were drawn from a set ([`crate::ImpactsAtOnce::Sampled`]).
#[derive(Clone, Debug, PartialEq)]
pub struct OutcomeSet {
    /// number of motions without an error
    pub motions: usize,
    /// number of motions that ended with an error; what follows is without them
    pub failed: usize,
    /// the different ends, the most frequent first: they differ in what closes, in whether they rest, or by more than
    /// the tolerances in a coordinate or speed
    pub ends: Vec<End>,
    /// the ranges of the coordinates at the end
    pub coordinates: Vec<Range>,
    /// the ranges of the speeds at the end
    pub speeds: Vec<Range>,
}

impl OutcomeSet {
    /// The set of these outcomes; `options` are those of their motions.
    pub fn of(outcomes: &[Outcome], options: &Options) -> Self {
        let (mut ends, mut motions) = (Vec::<End>::new(), 0);
        let (mut coordinates, mut speeds) = (Vec::new(), Vec::new());
        for (row, outcome) in outcomes.iter().enumerate().filter(|(_, outcome)| outcome.error.is_none()) {
            motions += 1;
            widen(&mut coordinates, &outcome.coordinates);
            widen(&mut speeds, &outcome.speeds);
            match ends.iter_mut().find(|end| alike(&outcomes[end.row], outcome, options)) {
                Some(end) => end.count += 1,
                None => ends.push(End { count: 1, row }),
            }
        }
        // the first of equals stays first
        ends.sort_by_key(|end| std::cmp::Reverse(end.count));
        Self { motions, failed: outcomes.len() - motions, ends, coordinates, speeds }
    }

    /// An estimate of the probability that another motion ends as none of these did (Good and Turing): the part of the
    /// motions whose end no other one has.
    pub fn unseen(&self) -> f64 {
        let alone = self.ends.iter().filter(|end| end.count == 1).count();
        if self.motions == 0 { 1.0 } else { alone as f64 / self.motions as f64 }
    }

    /// The probability that a range of this set holds at least, with this confidence, whatever the distribution
    /// (Wilks): p with 1 - n p^(n - 1) + (n - 1) p^n equal to the confidence, for n motions.
    pub fn content(&self, confidence: f64) -> f64 {
        let n = self.motions as f64;
        let reached = |p: f64| 1.0 - n * p.powf(n - 1.0) + (n - 1.0) * p.powf(n);
        if self.motions < 2 {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if reached(middle) >= confidence { low = middle } else { high = middle }
        }
        low
    }
}

fn widen(ranges: &mut Vec<Range>, values: &[f64]) {
    if ranges.is_empty() {
        ranges.extend(values.iter().map(|&value| Range { least: value, greatest: value }));
    }
    for (range, &value) in ranges.iter_mut().zip(values) {
        *range = Range { least: range.least.min(value), greatest: range.greatest.max(value) };
    }
}

/// Whether two motions end alike.
fn alike(one: &Outcome, other: &Outcome, options: &Options) -> bool {
    let near = |a: &[f64], b: &[f64]| {
        let within = |a: f64, b: f64| TOLERANCES * options.absolute_tolerance + ALIKE * a.abs().max(b.abs());
        a.len() == b.len() && a.iter().zip(b).all(|(&a, &b)| (a - b).abs() <= within(a, b))
    };
    one.closed == other.closed
        && one.kind() == other.kind()
        && near(&one.coordinates, &other.coordinates)
        && near(&one.speeds, &other.speeds)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ending(x: f64, closed: &[usize]) -> Outcome {
        Outcome { coordinates: vec![x], speeds: vec![0.0], closed: closed.to_vec(), ..Outcome::default() }
    }

    #[test]
    fn ends_that_differ_by_rounding_are_one() {
        let ends: Vec<Outcome> = [(1.0, &[0][..]), (2.0, &[0]), (2.0 + 1e-9, &[0]), (2.0, &[1]), (2.0, &[0])]
            .iter()
            .map(|&(x, closed)| ending(x, closed))
            .collect();
        let set = OutcomeSet::of(&ends, &Options::default());
        assert_eq!(set.ends, [End { count: 3, row: 1 }, End { count: 1, row: 0 }, End { count: 1, row: 3 }]);
        assert_eq!(set.unseen(), 0.4);
        assert!(set.coordinates[0].holds(1.5) && !set.coordinates[0].holds(2.1));
    }

    /// Of n numbers that are uniform in [0, 1] the range holds p or more in the share of cases that is stated.
    #[test]
    fn ranges_hold_what_they_promise() {
        let mut state = 7;
        let mut uniform = || (crate::random::next_random(&mut state) >> 11) as f64 / (1_u64 << 53) as f64;
        for n in [2, 5, 20, 93] {
            let mut holds = 0;
            for _ in 0..1000 {
                let ends: Vec<Outcome> = (0..n).map(|_| ending(uniform(), &[])).collect();
                let set = OutcomeSet::of(&ends, &Options::default());
                let Range { least, greatest } = set.coordinates[0];
                holds += usize::from(greatest - least >= set.content(0.95));
            }
            let share = holds as f64 / 1000.0;
            assert!((share - 0.95).abs() < 0.03, "{n}: {share}");
        }
        // 93 motions for 95 % with 95 % confidence: the number in textbooks
        let ends: Vec<Outcome> = (0..93).map(|i| ending(f64::from(i), &[])).collect();
        let content = OutcomeSet::of(&ends, &Options::default()).content(0.95);
        assert!((0.95..0.951).contains(&content), "{content}");
    }
}
