//! Laws of contact beyond a constant coefficient of friction and a constant coefficient of restitution.
//!
//! [`ContactLaw`] offers the most common measured laws as data, and functions for others. Parts that are not
//! set are those of the [`hodograph::Surface`]: a static coefficient equal to the sliding one, the same
//! friction in impacts, a constant e.
//!
//! Theory: docs/theory.md, sections 17.15 and 17.17.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use hodograph::StatedLaw;

/// A function of a speed, m/s.
pub type SpeedFunction = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// The laws of a contact beyond mu, e and law of its [`hodograph::Surface`].
///
/// ```
/// use hodograph::{Law, Surface};
/// use hodograph_simulation::{ContactLaw, Options, Restitution};
///
/// let law = ContactLaw {
///     mu_static: Some(0.45),
///     mu_impact: Some(0.2),
///     // e is 0.6 at 1 m/s, and falls with the quarter power of the approach speed
///     restitution: Restitution::Power { speed: 1.0, exponent: 0.25 },
///     ..ContactLaw::default()
/// };
/// let surface = Surface { mu: 0.3, e: 0.6, law: Law::Poisson };
/// let options = Options { surface: Some(surface), law: Some(law), ..Options::default() };
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactLaw {
    /// Static coefficient of friction, not less than the sliding one: a contact that sticks does so up to
    /// abs(lambda_tan) = mu_static lambda_n. `None`: that of the surface.
    pub mu_static: Option<f64>,
    /// Coefficient of friction in impacts, not negative. `None`: that of the surface.
    pub mu_impact: Option<f64>,
    /// Sliding friction as a function of the speed of slip.
    pub sliding: Sliding,
    /// The coefficient of restitution as a function of the speed of approach.
    pub restitution: Restitution,
    /// Lever arm of rolling friction, m, not negative: a torque of at most this times the normal force resists
    /// rotation about axes in the tangent plane. `None`: no such torque.
    pub rolling: Option<f64>,
    /// Lever arm of spinning friction, m, not negative: a torque of at most this times the normal force resists
    /// rotation about the normal. `None`: no such torque.
    pub spinning: Option<f64>,
}

impl ContactLaw {
    /// The law that a model states.
    ///
    /// # Errors
    ///
    /// A sentence, if there is no law with this name and number of arguments.
    pub fn stated(law: &StatedLaw<'_>) -> Result<Self, String> {
        let none = |what: &str, name: &str, forms: &str| {
            format!("there is no law of {what} `{name}` with such numbers: give {forms}")
        };
        let sliding = match law.sliding {
            None => Sliding::Constant,
            Some((name, numbers)) => {
                Sliding::named(name, numbers).ok_or_else(|| none("sliding friction", name, Sliding::FORMS))?
            }
        };
        let restitution = match law.restitution {
            None => Restitution::Constant,
            Some((name, numbers)) => Restitution::named(name, numbers)
                .ok_or_else(|| none("restitution", name, Restitution::FORMS))?,
        };
        Ok(Self {
            mu_static: law.mu_static,
            mu_impact: law.mu_impact,
            sliding,
            restitution,
            rolling: law.rolling,
            spinning: law.spinning,
        })
    }
}

/// Sliding friction as a function of the speed of slip s, m/s.
#[derive(Clone, Default)]
#[non_exhaustive]
pub enum Sliding {
    /// mu of the surface
    #[default]
    Constant,
    /// mu + (mu_static - mu) exp(-s / speed), after Stribeck: friction decreases continuously from the static
    /// coefficient. `speed` is positive, and `mu_static` is required.
    Stribeck {
        /// m/s
        speed: f64,
    },
    /// A smooth function of s, not negative. Its value at s = 0 must not exceed `mu_static`, and is the
    /// default of `mu_static`.
    Function(SpeedFunction),
}

/// The coefficient of restitution as a function of the speed of approach v = -v_n, m/s. e is that of the surface.
#[derive(Clone, Default)]
#[non_exhaustive]
pub enum Restitution {
    /// e
    #[default]
    Constant,
    /// e from this speed on, 0 below it.
    Threshold {
        /// m/s, positive
        speed: f64,
    },
    /// min(1, e (v / speed)^-exponent): impacts that deform plastically lose more the faster they are (exponent 1/4
    /// after Johnson, *Contact Mechanics*, 1985). e is that at `speed`.
    Power {
        /// m/s, positive
        speed: f64,
        /// positive
        exponent: f64,
    },
    /// max(0, 1 - (1 - e) (v / speed)^exponent): slow impacts lose nothing (viscoelastic spheres: exponent 1/5, after
    /// Kuwabara and Kono 1987; damping after Hunt and Crossley 1975 to first order: exponent 1). e is that at `speed`.
    Loss {
        /// m/s, positive
        speed: f64,
        /// positive
        exponent: f64,
    },
    /// Pairs of speed (m/s, increasing) and e, interpolated linearly and constant outside; e of the surface
    /// is not used.
    Table(Vec<[f64; 2]>),
    /// A function of v with values in [0, 1]; e of the surface is not used.
    Function(SpeedFunction),
}

impl Restitution {
    /// e at a speed of approach; `e` is that of the surface. Functions may return any number, which is not
    /// checked here.
    pub fn at(&self, e: f64, approach: f64) -> f64 {
        let v = approach.max(0.0);
        match self {
            Self::Constant => e,
            Self::Threshold { speed } => {
                if v < *speed {
                    0.0
                } else {
                    e
                }
            }
            Self::Power { .. } if e == 0.0 => 0.0,
            Self::Power { speed, exponent } => (e * (v / speed).powf(-exponent)).min(1.0),
            Self::Loss { speed, exponent } => (1.0 - (1.0 - e) * (v / speed).powf(*exponent)).max(0.0),
            Self::Table(rows) => interpolated(rows, v),
            Self::Function(function) => function(v),
        }
    }
}

/// Linear interpolation between pairs with increasing first numbers.
fn interpolated(rows: &[[f64; 2]], v: f64) -> f64 {
    let place = rows.partition_point(|row| row[0] <= v);
    match (place.checked_sub(1).map(|before| rows[before]), rows.get(place)) {
        (None, None) => 0.0,
        (None, Some(first)) => first[1],
        (Some(last), None) => last[1],
        (Some([v0, e0]), Some([v1, e1])) => e0 + (e1 - e0) * ((v - v0) / (v1 - v0)),
    }
}

impl fmt::Debug for Restitution {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{self}")
    }
}

impl fmt::Debug for Sliding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{self}")
    }
}

/// In the notation that [`Restitution::from_str`] reads: `power(1, 0.25)`.
impl fmt::Display for Restitution {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant => write!(out, "constant"),
            Self::Threshold { speed } => write!(out, "threshold({speed})"),
            Self::Power { speed, exponent } => write!(out, "power({speed}, {exponent})"),
            Self::Loss { speed, exponent } => write!(out, "loss({speed}, {exponent})"),
            Self::Table(rows) => {
                let numbers: Vec<String> = rows.iter().flatten().map(f64::to_string).collect();
                write!(out, "table({})", numbers.join(", "))
            }
            Self::Function(_) => write!(out, "function"),
        }
    }
}

/// In the notation that [`Sliding::from_str`] reads: `stribeck(0.01)`.
impl fmt::Display for Sliding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant => write!(out, "constant"),
            Self::Stribeck { speed } => write!(out, "stribeck({speed})"),
            Self::Function(_) => write!(out, "function"),
        }
    }
}

/// Two functions are equal if they are the same object.
impl PartialEq for Restitution {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Function(one), Self::Function(other)) => Arc::ptr_eq(one, other),
            (Self::Function(_), _) | (_, Self::Function(_)) => false,
            _ => self.to_string() == other.to_string(),
        }
    }
}

impl PartialEq for Sliding {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Function(one), Self::Function(other)) => Arc::ptr_eq(one, other),
            (Self::Function(_), _) | (_, Self::Function(_)) => false,
            _ => self.to_string() == other.to_string(),
        }
    }
}

/// Splits a name and its numbers: `power(1, 0.25)`, or `constant`.
fn call(text: &str) -> Option<(&str, Vec<f64>)> {
    let text = text.trim();
    let Some((name, rest)) = text.split_once('(') else { return Some((text, Vec::new())) };
    let numbers = rest.strip_suffix(')')?.split(',').map(|number| number.trim().parse().ok());
    Some((name.trim(), numbers.collect::<Option<_>>()?))
}

impl Restitution {
    /// The law with this name and these numbers; `None` if there is none.
    pub fn named(name: &str, numbers: &[f64]) -> Option<Self> {
        Some(match (name, numbers) {
            ("constant", []) => Self::Constant,
            ("threshold", [speed]) => Self::Threshold { speed: *speed },
            ("power", [speed, exponent]) => Self::Power { speed: *speed, exponent: *exponent },
            ("loss", [speed, exponent]) => Self::Loss { speed: *speed, exponent: *exponent },
            ("table", rows) if !rows.is_empty() && rows.len() % 2 == 0 => {
                Self::Table(rows.chunks_exact(2).map(|row| [row[0], row[1]]).collect())
            }
            _ => return None,
        })
    }

    /// The syntax of the laws.
    pub const FORMS: &'static str = "constant, threshold(SPEED), power(SPEED, EXPONENT), loss(SPEED, EXPONENT) or table(SPEED, E, SPEED, E, ..)";
}

impl FromStr for Restitution {
    type Err = String;

    /// Reads `constant`, `threshold(SPEED)`, `power(SPEED, EXPONENT)`, `loss(SPEED, EXPONENT)` and
    /// `table(SPEED, E, SPEED, E, ..)`. The simulation checks the numbers.
    fn from_str(text: &str) -> Result<Self, String> {
        call(text)
            .and_then(|(name, numbers)| Self::named(name, &numbers))
            .ok_or_else(|| format!("there is no law of restitution `{text}`: give {}", Self::FORMS))
    }
}

impl Sliding {
    /// The law with this name and these numbers; `None` if there is none.
    pub fn named(name: &str, numbers: &[f64]) -> Option<Self> {
        Some(match (name, numbers) {
            ("constant", []) => Self::Constant,
            ("stribeck", [speed]) => Self::Stribeck { speed: *speed },
            _ => return None,
        })
    }

    /// The syntax of the laws.
    pub const FORMS: &'static str = "constant or stribeck(SPEED)";
}

impl FromStr for Sliding {
    type Err = String;

    /// Reads `constant` and `stribeck(SPEED)`.
    fn from_str(text: &str) -> Result<Self, String> {
        call(text)
            .and_then(|(name, numbers)| Self::named(name, &numbers))
            .ok_or_else(|| format!("there is no law of sliding friction `{text}`: give {}", Self::FORMS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laws_are_written_as_they_are_read() {
        for text in ["constant", "threshold(0.01)", "power(1, 0.25)", "loss(2, 0.2)", "table(0, 0.9, 1, 0.5)"]
        {
            assert_eq!(text.parse::<Restitution>().unwrap().to_string(), text);
        }
        assert_eq!(" stribeck( 0.01 ) ".parse::<Sliding>().unwrap().to_string(), "stribeck(0.01)");
        for text in ["power", "power(1)", "power(1, x)", "power(1, 2", "table(1)", "table()", "nothing", ""] {
            let told = text.parse::<Restitution>().unwrap_err();
            assert!(told.contains("table(SPEED, E"), "{told}");
        }
    }

    #[test]
    fn restitution_at_known_speeds() {
        let at = |text: &str, v: f64| text.parse::<Restitution>().unwrap().at(0.5, v);
        assert_eq!([at("threshold(0.1)", 0.09), at("threshold(0.1)", 0.1)], [0.0, 0.5]);
        assert!((at("power(1, 0.25)", 16.0) - 0.25).abs() < 1e-15);
        assert_eq!([at("power(1, 0.25)", 1e-9), at("power(1, 0.25)", 0.0)], [1.0, 1.0]);
        assert!((at("loss(1, 0.2)", 1.0 / 32.0) - 0.75).abs() < 1e-15);
        assert_eq!(at("loss(1, 1)", 3.0), 0.0);
        let table = "table(1, 0.8, 3, 0.4)";
        assert_eq!([at(table, 0.5), at(table, 5.0)], [0.8, 0.4]);
        assert!((at(table, 2.5) - 0.5).abs() < 1e-15);
    }
}
