//! The times of samples of a motion.

/// Two samples are not closer to each other than this part of the time between samples.
const TOGETHER: f64 = 1e-6;

/// The times `start + k step`, k = 1, 2, .., before `until`, and `until`, s. A last step that rounding made
/// too short to be one is not told twice. `step` must be positive and the times finite.
pub fn sample_times(start: f64, step: f64, until: f64) -> impl Iterator<Item = f64> {
    let last = until - TOGETHER * step;
    let before = (1_u64..).map(move |count| start + count as f64 * step).take_while(move |time| *time < last);
    before.chain([until])
}

#[cfg(test)]
mod tests {
    use super::sample_times;

    #[test]
    fn no_time_comes_twice() {
        for hundredths in 1..1000_u32 {
            let until = f64::from(hundredths) / 100.0;
            let times: Vec<f64> = sample_times(0.0, 0.01, until).collect();
            assert_eq!((times.len(), times.last()), (hundredths as usize, Some(&until)), "{until}");
        }
        assert_eq!(sample_times(0.0, 0.3, 2.7).count(), 9);
        assert_eq!(sample_times(1.0, 0.4, 2.0).collect::<Vec<_>>(), [1.4, 1.8, 2.0]);
    }

    #[test]
    fn short_motions_have_their_end() {
        assert_eq!(sample_times(3.0, 0.1, 3.0).collect::<Vec<_>>(), [3.0]);
        assert_eq!(sample_times(0.0, 1.0, 1e-9).collect::<Vec<_>>(), [1e-9]);
    }
}
