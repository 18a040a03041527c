//! The parts of a [`ContactLaw`] that options give; parts that one source leaves open can be taken from
//! another.

use crate::interface::contact_law::{ContactLaw, Restitution, Sliding};

/// Parts of a [`ContactLaw`]; a part that is not given is `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GivenLaw {
    /// static coefficient of friction
    pub mu_static: Option<f64>,
    /// coefficient of friction in impacts
    pub mu_impact: Option<f64>,
    /// sliding friction as a function of the speed of slip
    pub sliding: Option<Sliding>,
    /// restitution as a function of the speed of approach
    pub restitution: Option<Restitution>,
    /// lever arm of rolling friction, m
    pub rolling: Option<f64>,
    /// lever arm of spinning friction, m
    pub spinning: Option<f64>,
}

impl GivenLaw {
    /// The names of the parts.
    pub const PARTS: [&'static str; 6] =
        ["mu_static", "mu_impact", "sliding", "restitution", "rolling", "spinning"];

    /// Takes the parts that are not given here from `other`.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            mu_static: self.mu_static.or(other.mu_static),
            mu_impact: self.mu_impact.or(other.mu_impact),
            sliding: self.sliding.or(other.sliding),
            restitution: self.restitution.or(other.restitution),
            rolling: self.rolling.or(other.rolling),
            spinning: self.spinning.or(other.spinning),
        }
    }

    /// Sets a part by its name, from its text: `mu_static` from `0.4`, `restitution` from `power(1, 0.25)`.
    ///
    /// # Errors
    ///
    /// A sentence: there is no such part, or the text is not valid for it.
    pub fn set(&mut self, part: &str, text: &str) -> Result<(), String> {
        let number = || text.trim().parse::<f64>().map_err(|_| format!("{part} is `{text}`: give a number"));
        match part {
            "mu_static" => self.mu_static = Some(number()?),
            "mu_impact" => self.mu_impact = Some(number()?),
            "sliding" => self.sliding = Some(text.parse()?),
            "restitution" => self.restitution = Some(text.parse()?),
            "rolling" => self.rolling = Some(number()?),
            "spinning" => self.spinning = Some(number()?),
            _ => return Err(format!("a surface has no `{part}`: its parts are {}", Self::PARTS.join(", "))),
        }
        Ok(())
    }

    /// The given parts, by name and text.
    pub fn parts(&self) -> Vec<(&'static str, String)> {
        let texts = [
            self.mu_static.map(|mu| mu.to_string()),
            self.mu_impact.map(|mu| mu.to_string()),
            self.sliding.as_ref().map(Sliding::to_string),
            self.restitution.as_ref().map(Restitution::to_string),
            self.rolling.map(|arm| arm.to_string()),
            self.spinning.map(|arm| arm.to_string()),
        ];
        Self::PARTS.into_iter().zip(texts).filter_map(|(part, text)| Some((part, text?))).collect()
    }

    /// The law; parts that are not given are those of the surface.
    pub fn law(self) -> ContactLaw {
        ContactLaw {
            mu_static: self.mu_static,
            mu_impact: self.mu_impact,
            sliding: self.sliding.unwrap_or_default(),
            restitution: self.restitution.unwrap_or_default(),
            rolling: self.rolling,
            spinning: self.spinning,
        }
    }
}

/// The parts of a law; constant parts count as not given.
impl From<ContactLaw> for GivenLaw {
    fn from(law: ContactLaw) -> Self {
        let ContactLaw { mu_static, mu_impact, sliding, restitution, rolling, spinning } = law;
        Self {
            mu_static,
            mu_impact,
            sliding: Some(sliding).filter(|sliding| *sliding != Sliding::Constant),
            restitution: Some(restitution).filter(|restitution| *restitution != Restitution::Constant),
            rolling,
            spinning,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_set_by_name_and_one_completes_the_other() {
        let mut given = GivenLaw::default();
        given.set("mu_static", "0.4").unwrap();
        given.set("restitution", "power(1, 0.25)").unwrap();
        assert!(given.set("mu_static", "much").unwrap_err().contains("give a number"));
        assert!(given.set("rolling_mu", "0.01").unwrap_err().contains("mu_static, mu_impact"));
        given.set("rolling", "0.01").unwrap();
        let mut other = GivenLaw::default();
        other.set("mu_static", "0.9").unwrap();
        other.set("sliding", "stribeck(0.1)").unwrap();
        let both = given.clone().or(other);
        let texts: Vec<String> = both.parts().iter().map(|(part, text)| format!("{part}={text}")).collect();
        assert_eq!(
            texts,
            ["mu_static=0.4", "sliding=stribeck(0.1)", "restitution=power(1, 0.25)", "rolling=0.01"]
        );
        assert_eq!(GivenLaw::from(both.clone().law()), both);
    }
}
