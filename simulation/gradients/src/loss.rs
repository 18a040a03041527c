//! What a difference between measurement and motion costs a fit.
//!
//! Theory: docs/theory.md, section 21.

/// What a difference costs, in its unit: a motion that ends on another face than the measured one is off by hundreds of
/// errors, and squares let a few of these decide all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Loss {
    /// its square
    #[default]
    Square,
    /// its square up to this size; beyond it grows in proportion to the difference (Huber)
    Huber(f64),
    /// its square up to this size, and no more beyond it
    Cap(f64),
}

impl Loss {
    /// The number whose square the difference costs, and its derivative with respect to the difference.
    pub fn root(self, difference: f64) -> (f64, f64) {
        let (size, sign) = (difference.abs(), difference.signum());
        match self {
            Self::Huber(most) if size > most => {
                let root = (most * (2.0 * size - most)).sqrt();
                (sign * root, most / root)
            }
            Self::Cap(most) if size > most => (sign * most, 0.0),
            _ => (difference, 1.0),
        }
    }

    /// The size from which on a difference costs less than its square.
    pub fn size(self) -> f64 {
        match self {
            Self::Square => f64::INFINITY,
            Self::Huber(most) | Self::Cap(most) => most,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_continuous_and_have_their_derivatives() {
        for loss in [Loss::Square, Loss::Huber(2.0), Loss::Cap(2.0)] {
            for difference in [-7.0, -1.9, 0.0, 0.3, 1.9, 2.1, 40.0] {
                let (root, slope) = loss.root(difference);
                let h = 1e-6;
                let by = (loss.root(difference + h).0 - loss.root(difference - h).0) / (2.0 * h);
                assert!((slope - by).abs() < 1e-8, "{loss:?} {difference}: {slope} {by}");
                assert!(root.abs() <= difference.abs() + 1e-15);
            }
            let at = |difference: f64| loss.root(difference).0;
            assert!((at(2.0 + 1e-12) - at(2.0)).abs() < 1e-11 && (at(-2.0 - 1e-12) + 2.0).abs() < 1e-11);
        }
        // Huber's loss beyond 2: 2 (2 r - 2)
        assert_eq!(Loss::Huber(2.0).root(9.0).0, 32.0_f64.sqrt());
        assert_eq!(Loss::Cap(2.0).root(-9.0), (-2.0, 0.0));
    }
}
