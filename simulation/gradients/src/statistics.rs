//! Statistics of errors of prediction: quantiles, means, shares, and Wilcoxon's signed-rank test.
//!
//! Theory: docs/theory.md, section 22.

use std::f64::consts::SQRT_2;

/// With more differences than this the distribution of the rank sum is taken as normal; exactly it costs the
/// cube of their number.
const MOST_EXACT: usize = 400;

/// The quantile of a part from 0 to 1, with linear interpolation between the sorted values (22.2); NaN of no
/// values.
pub fn quantile(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = part.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// The mean and its standard error (22.3); the error is NaN of less than two values.
pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, if values.len() > 1 { (square / n).sqrt() } else { f64::NAN })
}

/// Wilson's interval of a probability with which `hits` of `count` were seen, for a confidence of 95 % (22.4);
/// from 0 to 1 if nothing was seen.
pub fn wilson_interval(hits: usize, count: usize) -> [f64; 2] {
    if count == 0 {
        return [0.0, 1.0];
    }
    // the 97.5 % quantile of the normal distribution
    const Z: f64 = 1.959_963_984_540_054;
    let n = count as f64;
    let share = hits as f64 / n;
    let square = Z * Z / n;
    let middle = (share + square / 2.0) / (1.0 + square);
    let half = Z * (share * (1.0 - share) / n + square / (4.0 * n)).sqrt() / (1.0 + square);
    // the ends are exact where all or none were seen
    [
        if hits == 0 { 0.0 } else { (middle - half).max(0.0) },
        if hits == count { 1.0 } else { (middle + half).min(1.0) },
    ]
}

/// Wilcoxon's signed-rank test of paired differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedRanks {
    /// the number of differences that are not 0
    pub count: usize,
    /// the sum of the ranks of positive differences
    pub positive: f64,
    /// the sum of the ranks of negative differences
    pub negative: f64,
    /// the two-sided probability of a sum as far from its mean, if each difference could as well have the other
    /// sign; 1 if there are none
    pub p: f64,
    /// p is exact, by all signs; else from the normal distribution
    pub is_exact: bool,
}

/// Wilcoxon's signed-rank test: differences of 0 are left out, equal sizes have the mean of their ranks
/// (22.5).
pub fn signed_ranks(differences: &[f64]) -> SignedRanks {
    let mut sorted: Vec<f64> = differences.iter().copied().filter(|value| *value != 0.0).collect();
    sorted.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let count = sorted.len();
    // twice the ranks, which are whole numbers
    let mut doubled = vec![0_usize; count];
    let (mut from, mut ties) = (0, 0.0);
    while from < count {
        let same = sorted[from..].iter().take_while(|value| value.abs() == sorted[from].abs()).count();
        // the ranks from + 1 to from + same
        doubled[from..from + same].fill(2 * from + same + 1);
        let t = same as f64;
        ties += t * t * t - t;
        from += same;
    }
    let sum = |wanted: bool| -> usize {
        sorted.iter().zip(&doubled).filter(|(value, _)| (**value > 0.0) == wanted).map(|(_, rank)| rank).sum()
    };
    let (positive, negative) = (sum(true), sum(false));
    let is_exact = count <= MOST_EXACT;
    let p = match (count, is_exact) {
        (0, _) => 1.0,
        (_, true) => exact(&doubled, positive.min(negative)),
        _ => {
            let n = count as f64;
            let variance = n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - ties / 48.0;
            let off = positive as f64 / 2.0 - n * (n + 1.0) / 4.0;
            libm::erfc(off.abs() / variance.sqrt() / SQRT_2)
        }
    };
    SignedRanks { count, positive: positive as f64 / 2.0, negative: negative as f64 / 2.0, p, is_exact }
}

/// Twice the probability that the sum of the ranks whose sign is positive is at most `least`, all signs being
/// equally probable.
fn exact(ranks: &[usize], least: usize) -> f64 {
    // probabilities of the sums up to `least`
    let mut of_sum = vec![0.0; least + 1];
    of_sum[0] = 1.0;
    for &rank in ranks {
        for sum in (0..=least).rev() {
            let other = if sum >= rank { of_sum[sum - rank] } else { 0.0 };
            of_sum[sum] = 0.5 * (of_sum[sum] + other);
        }
    }
    (2.0 * of_sum.iter().sum::<f64>()).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{found} instead of {expected}");
    }

    /// As numpy 2 and scipy 1.17.1 have them: `numpy.quantile(x, q)`, `numpy.mean(x)`, `scipy.stats.sem(x)`.
    #[test]
    fn quantiles_and_means_are_those_of_numpy() {
        let x = [3.1, 0.2, 5.5, 1.7, 2.2, 9.4, 0.9];
        let parts = [0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0];
        let expected = [0.2, 0.62, 1.3, 2.2, 4.3, 7.06, 9.4];
        parts.iter().zip(expected).for_each(|(part, expected)| near(quantile(&x, *part), expected));
        let (mean, error) = mean_and_error(&x);
        near(mean, 3.285_714_285_714_285_6);
        near(error, 1.207_403_465_810_704_2);
        assert!(quantile(&[], 0.5).is_nan() && mean_and_error(&[1.0]).1.is_nan());
        near(quantile(&[4.0], 0.9), 4.0);
        // of the numbers 1 to n the variance is n (n + 1)/12
        let numbers: Vec<f64> = (1..=24).map(f64::from).collect();
        near(mean_and_error(&numbers).1, (25.0_f64 / 12.0).sqrt());
    }

    /// As `scipy.stats.binomtest(k, n).proportion_ci(method="wilson")`; and each end solves Wilson's equation,
    /// (share - p)^2 = z^2 p (1 - p)/n.
    #[test]
    fn wilsons_interval_is_that_of_scipy() {
        let expected = [
            (17, 20, [0.639_581_135_259_243_1, 0.947_631_254_103_783_5]),
            (0, 10, [0.0, 0.277_532_799_862_889_26]),
            (495, 495, [0.992_299_239_061_292_8, 1.0]),
        ];
        for (hits, count, expected) in expected {
            let found = wilson_interval(hits, count);
            found.iter().zip(expected).for_each(|(found, expected)| near(*found, expected));
            let (share, n) = (hits as f64 / count as f64, count as f64);
            for end in found {
                let z = 1.959_963_984_540_054_f64;
                near((share - end).powi(2), z * z * end * (1.0 - end) / n);
            }
        }
        assert_eq!(wilson_interval(0, 0), [0.0, 1.0]);
    }

    /// All signs, one by one.
    fn by_enumeration(differences: &[f64]) -> f64 {
        let d: Vec<f64> = differences.iter().copied().filter(|d| *d != 0.0).collect();
        let rank = |one: f64| {
            let below = d.iter().filter(|other| other.abs() < one.abs()).count() as f64;
            let same = d.iter().filter(|other| other.abs() == one.abs()).count() as f64;
            below + (same + 1.0) / 2.0
        };
        let ranks: Vec<f64> = d.iter().map(|d| rank(*d)).collect();
        let middle = ranks.iter().sum::<f64>() / 2.0;
        let off = |sum: f64| (sum - middle).abs();
        let seen = off(ranks.iter().zip(&d).filter(|(_, d)| **d > 0.0).map(|(rank, _)| rank).sum());
        let all = 1_u32 << d.len();
        let as_far = (0..all).filter(|signs| {
            let sum =
                ranks.iter().enumerate().filter(|(i, _)| signs >> i & 1 == 1).map(|(_, rank)| rank).sum();
            off(sum) >= seen - 1e-9
        });
        as_far.count() as f64 / f64::from(all)
    }

    #[test]
    fn the_probability_is_that_of_all_signs() {
        let cases: [&[f64]; 8] = [
            &[0.31, -0.12, 0.55, 0.08, -0.44, 0.27, 0.90, -0.03, 0.61, 0.19, -0.25, 0.72],
            &[1.0, 1.0, -1.0, 2.0, 2.0, 2.0, -3.0, 4.0, 5.0, -5.0, 6.0, 0.0, 0.0, 7.0],
            &[1.0, 2.0, 3.0, 4.0, 5.0],
            &[-1.0, -2.0, -3.0, 4.0],
            &[1.0, -1.0],
            &[2.0],
            &[1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0],
            &[0.5, -0.25, 0.125, -4.0, 8.0, 16.0, -0.75],
        ];
        for case in cases {
            let found = signed_ranks(case);
            near(found.p, by_enumeration(case));
            let n = found.count as f64;
            near(found.positive + found.negative, n * (n + 1.0) / 2.0);
            assert!(found.is_exact);
        }
        // five of five: 2/2^5
        near(signed_ranks(cases[2]).p, 1.0 / 16.0);
        assert_eq!(signed_ranks(&[0.0, 0.0]).p, 1.0);
        // the other sign has the same p
        let turned: Vec<f64> = cases[0].iter().map(|d| -d).collect();
        assert_eq!(signed_ranks(&turned).p, signed_ranks(cases[0]).p);
    }

    /// As `scipy.stats.wilcoxon` 1.17.1: `mode="exact"` for few, `mode="approx", correction=False` for many.
    #[test]
    fn the_test_is_that_of_scipy() {
        let few = signed_ranks(&[0.31, -0.12, 0.55, 0.08, -0.44, 0.27, 0.90, -0.03, 0.61, 0.19, -0.25, 0.72]);
        assert_eq!((few.positive, few.negative), (61.0, 17.0));
        near(few.p, 0.092_285_156_25);
        let wave = |i: usize| (i as f64 * 1.7).sin() + 0.25 * (i as f64 * 0.9).cos() + 0.2;
        let sixty: Vec<f64> = (1..=60).map(wave).collect();
        let found = signed_ranks(&sixty);
        assert_eq!(found.negative, 635.0);
        assert!((found.p - 0.039_006_112_779_123_47).abs() < 1e-13, "{found:?}");
    }

    /// Beyond the bound the normal distribution, with a variance of sum r^2/4, which ties change; at the bound the
    /// exact distribution is near.
    #[test]
    fn many_differences_are_judged_by_the_normal_distribution() {
        let wave = |i: usize| ((i as f64 * 1.7).sin() + 0.25 * (i as f64 * 0.9).cos() + 0.06) * 50.0;
        let all: Vec<f64> = (1..=MOST_EXACT + 40).map(|i| wave(i).round()).collect();
        let many = signed_ranks(&all);
        assert!(!many.is_exact && many.count < all.len(), "{many:?}");
        let few = signed_ranks(&all[..MOST_EXACT]);
        assert!(few.is_exact);
        for (found, within) in [(many, 1e-10), (few, 1e-3)] {
            let d: Vec<f64> = all.iter().copied().filter(|d| *d != 0.0).take(found.count).collect();
            let rank = |one: f64| {
                let below = d.iter().filter(|other| other.abs() < one.abs()).count() as f64;
                let same = d.iter().filter(|other| other.abs() == one.abs()).count() as f64;
                below + (same + 1.0) / 2.0
            };
            let variance: f64 = d.iter().map(|d| rank(*d).powi(2)).sum::<f64>() / 4.0;
            let mean: f64 = d.iter().map(|d| rank(*d)).sum::<f64>() / 2.0;
            let z = (found.positive - mean) / variance.sqrt();
            let p = libm::erfc(z.abs() / SQRT_2);
            assert!((found.p - p).abs() < within * p, "{found:?} {p}");
        }
    }
}
