//! The surfaces of a contact as a motion uses them: friction in a mode, restitution at a speed, the duration
//! of bounces.

use hodograph::Surface;

use crate::interface::contact_law::{ContactLaw, Restitution, Sliding};

/// The greatest coefficient of friction: the cones of friction are solved with squares of it and of the forces.
pub const MOST_FRICTION: f64 = 1e100;

/// The surfaces of a contact: its coefficients and its law.
#[derive(Clone, Debug)]
pub(crate) struct Pair {
    pub surface: Surface<f64>,
    pub law: ContactLaw,
    /// whether the faces or edges are bounded
    pub ends: bool,
    /// the first contact of the same two shapes, where these have many contacts and a clearance
    pub first: Option<usize>,
}

/// The coefficients of friction of a contact in a state: the static and the sliding one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Friction {
    pub sticks: f64,
    pub slips: f64,
}

impl Friction {
    /// The same coefficient for both.
    pub fn same(mu: f64) -> Self {
        Self { sticks: mu, slips: mu }
    }

    /// No contact.
    pub const NONE: Self = Self { sticks: 0.0, slips: 0.0 };
}

impl Pair {
    /// The coefficient of friction at a speed of slip.
    pub fn sliding(&self, slip: f64) -> Result<f64, String> {
        let mu = self.surface.mu;
        match &self.law.sliding {
            Sliding::Constant => Ok(mu),
            Sliding::Stribeck { speed } => {
                Ok(mu + (self.law.mu_static.unwrap_or(mu) - mu) * (-slip / speed).exp())
            }
            Sliding::Function(function) => {
                let value = function(slip);
                if value.is_finite() && value >= 0.0 {
                    return Ok(value);
                }
                Err(format!(
                    "its function of sliding friction gives {value} at {slip} m/s: it must be finite and not negative"
                ))
            }
        }
    }

    /// The coefficients at a speed of slip.
    pub fn friction(&self, slip: f64) -> Result<Friction, String> {
        let slips = self.sliding(slip)?;
        let sticks = match (self.law.mu_static, &self.law.sliding) {
            (Some(mu), _) => mu,
            (None, Sliding::Function(_)) => self.sliding(0.0)?,
            (None, _) => self.surface.mu,
        };
        Ok(Friction { sticks, slips })
    }

    /// The coefficient of friction in impacts.
    pub fn mu_in_impacts(&self) -> f64 {
        self.law.mu_impact.unwrap_or(self.surface.mu)
    }

    /// Whether friction is the same in impacts and in lasting contact.
    pub fn is_the_same_in_impacts(&self) -> bool {
        let (mu, law) = (self.surface.mu, &self.law);
        let coefficients = [law.mu_static, law.mu_impact].iter().flatten().all(|other| *other == mu);
        let torques = [law.rolling, law.spinning].iter().flatten().any(|arm| *arm > 0.0);
        coefficients && !torques && matches!(law.sliding, Sliding::Constant)
    }

    /// The coefficient of restitution at a speed of approach.
    pub fn e(&self, approach: f64) -> Result<f64, String> {
        let e = self.law.restitution.at(self.surface.e, approach);
        if (0.0..=1.0).contains(&e) {
            return Ok(e);
        }
        Err(format!("its coefficient of restitution is {e} at {approach} m/s: it must lie between 0 and 1"))
    }

    /// The surface in an impact with this speed of approach.
    pub fn in_impact(&self, approach: f64) -> Result<Surface<f64>, String> {
        Ok(Surface { mu: self.mu_in_impacts(), e: self.e(approach)?, law: self.surface.law })
    }

    /// Whether the contact never rebounds.
    pub fn is_plastic(&self) -> bool {
        match &self.law.restitution {
            Restitution::Constant | Restitution::Threshold { .. } | Restitution::Power { .. } => {
                self.surface.e == 0.0
            }
            Restitution::Table(rows) => rows.iter().all(|row| row[1] == 0.0),
            Restitution::Loss { .. } | Restitution::Function(_) => false,
        }
    }

    /// The total time of the bounces that begin with this rebound after this approach, while the contact is
    /// pulled together with the acceleration `pull`: the sum of the flights, each of which begins with the
    /// rebound of the previous approach. `None` if the sum does not converge.
    pub fn bounces_for(&self, before: f64, rebound: f64, pull: f64) -> Option<f64> {
        if self.law.restitution == Restitution::Constant {
            return (rebound < before).then(|| 2.0 * rebound / (pull * (1.0 - rebound / before)));
        }
        // With friction the rebound is not e times the approach, but nearly proportional to it.
        let share = rebound / (before * self.e(before).ok().filter(|e| *e > 0.0)?);
        let (mut speed, mut sum) = (rebound, 0.0);
        for _ in 0..FLIGHTS {
            sum += speed;
            let next = speed * (share * self.e(speed).ok()?).min(1.0);
            if next <= ENDED * rebound {
                return Some(2.0 * sum / pull);
            }
            if next >= speed {
                return None;
            }
            speed = next;
        }
        Some(2.0 * sum / pull)
    }
}

impl Pair {
    /// Checks the law.
    ///
    /// # Errors
    ///
    /// A sentence: the condition that is violated.
    pub fn check(&self) -> Result<(), String> {
        let (surface, law) = (&self.surface, &self.law);
        let positive = |what: &str, value: f64| {
            let good = value.is_finite() && value > 0.0;
            if good { Ok(()) } else { Err(format!("{what} is {value}: it must be finite and positive")) }
        };
        let mus = [
            ("friction", Some(surface.mu)),
            ("static friction", law.mu_static),
            ("friction in impacts", law.mu_impact),
        ];
        if let Some((what, mu)) =
            mus.iter().find_map(|&(what, mu)| Some((what, mu.filter(|mu| *mu > MOST_FRICTION)?)))
        {
            return Err(format!(
                "the coefficient of {what} is {mu:e}: forces whose squares are numbers need at most {MOST_FRICTION:e}, and 1e6 holds as well"
            ));
        }
        for (what, value) in [("static friction", law.mu_static), ("friction in impacts", law.mu_impact)] {
            if let Some(mu) = value.filter(|mu| !(mu.is_finite() && *mu >= 0.0)) {
                return Err(format!("the coefficient of {what} is {mu}: it must be finite and not negative"));
            }
        }
        for (what, value) in [("rolling", law.rolling), ("spinning", law.spinning)] {
            if let Some(arm) = value.filter(|arm| !(arm.is_finite() && *arm >= 0.0)) {
                return Err(format!(
                    "the lever arm of {what} friction is {arm} m: it must be finite and not negative"
                ));
            }
        }
        if let Sliding::Stribeck { speed } = law.sliding {
            positive("the speed of sliding friction", speed)?;
            if law.mu_static.is_none() {
                return Err(
                    "sliding friction after Stribeck falls from the static coefficient: give that too"
                        .to_owned(),
                );
            }
        }
        let is_data = !matches!(law.sliding, Sliding::Function(_));
        let least = self.sliding(0.0)?.max(surface.mu * f64::from(u8::from(is_data)));
        if let Some(mu) = law.mu_static.filter(|mu| *mu < least) {
            return Err(format!(
                "the coefficient of static friction is {mu}, less than that of sliding friction, {least}: a contact that begins to slip would stick"
            ));
        }
        match &law.restitution {
            Restitution::Constant => {}
            Restitution::Threshold { speed } => positive("the speed of restitution", *speed)?,
            Restitution::Power { speed, exponent } | Restitution::Loss { speed, exponent } => {
                positive("the speed of restitution", *speed)?;
                positive("the exponent of restitution", *exponent)?;
            }
            Restitution::Table(rows) => {
                if rows.is_empty() {
                    return Err("the table of restitution is empty".to_owned());
                }
                let speeds = rows.iter().all(|row| row[0].is_finite() && row[0] >= 0.0);
                if !speeds || !rows.windows(2).all(|pair| pair[0][0] < pair[1][0]) {
                    return Err(
                        "the speeds in the table of restitution must be finite, not negative, and rise"
                            .to_owned(),
                    );
                }
                if let Some([speed, e]) = rows.iter().find(|row| !(0.0..=1.0).contains(&row[1])) {
                    return Err(format!(
                        "the coefficient of restitution at {speed} m/s is {e}: it must lie between 0 and 1"
                    ));
                }
            }
            Restitution::Function(_) => {
                self.e(1.0)?;
            }
        }
        Ok(())
    }
}

/// Largest number of flights, and the speed, relative to the first, below which the remaining flights are
/// neglected.
const FLIGHTS: usize = 100_000;
const ENDED: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of flights with constant e, computed independently.
    #[test]
    fn ladders_have_the_sum_of_their_series() {
        let surface = Surface { mu: 0.0, e: 0.7, law: hodograph::Law::Newton };
        let constant = Pair { surface, law: ContactLaw::default(), ends: false, first: None };
        let restitution = Restitution::Table(vec![[0.0, 0.7]]);
        let table = Pair {
            surface,
            law: ContactLaw { restitution, ..ContactLaw::default() },
            ends: false,
            first: None,
        };
        let (one, other) = (constant.bounces_for(2.0, 1.4, 9.81), table.bounces_for(2.0, 1.4, 9.81));
        assert!((one.unwrap() / other.unwrap() - 1.0).abs() < 1e-8);
    }
}
