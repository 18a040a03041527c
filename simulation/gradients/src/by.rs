//! The variables with respect to which a motion is differentiated.

use std::fmt;

use hodograph::{ComponentKind, Mechanism};
use hodograph_interpreter::InterpretedMechanism;

/// A variable on which a motion depends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum By {
    /// a coordinate of the start state
    Coordinate(usize),
    /// an independent speed of the start state
    Speed(usize),
    /// a parameter of the model, by its index among those that are not `fixed`
    Parameter(usize),
    /// a named input, which is constant; of a table of samples all of its values together
    Input(usize),
    /// a value in a table of samples ([`hodograph_simulation::Drive::Table`])
    Sample {
        /// index of the named input
        input: usize,
        /// index of the row in the table
        row: usize,
    },
    /// mu of a contact, or of all contacts together
    Friction(Option<usize>),
    /// e of a contact, or of all contacts together
    Restitution(Option<usize>),
}

impl By {
    /// The variable with this name: `mu`, `e`, `mu.CONTACT`, `e.CONTACT`, the name of a coordinate, speed, parameter or
    /// input, or `INPUT[ROW]`, a sample of an input. If a coordinate or parameter of the model is called `mu` or `e`, the name means
    /// that.
    ///
    /// # Errors
    ///
    /// A sentence with the names that exist.
    pub fn named(mechanism: &InterpretedMechanism, name: &str) -> Result<Self, String> {
        type Kind = (ComponentKind, fn(usize) -> By);
        let kinds: [Kind; 4] = [
            (ComponentKind::Coordinate, By::Coordinate),
            (ComponentKind::Speed, By::Speed),
            (ComponentKind::Parameter, By::Parameter),
            (ComponentKind::Input, By::Input),
        ];
        let named = |(kind, by): Kind| mechanism.index(kind, name).map(by);
        if let Some(by) = kinds.into_iter().find_map(named) {
            return Ok(by);
        }
        let sample = || {
            let (input, row) = name.strip_suffix(']')?.split_once('[')?;
            let input = mechanism.index(ComponentKind::Input, input)?;
            Some(By::Sample { input, row: row.parse().ok()? })
        };
        if let Some(by) = sample() {
            return Ok(by);
        }
        let contact = |contact: &str| mechanism.index(ComponentKind::Contact, contact);
        let found = match name.split_once('.') {
            None if name == "mu" => Some(By::Friction(None)),
            None if name == "e" => Some(By::Restitution(None)),
            Some(("mu", of)) => contact(of).map(|contact| By::Friction(Some(contact))),
            Some(("e", of)) => contact(of).map(|contact| By::Restitution(Some(contact))),
            _ => None,
        };
        found.ok_or_else(|| {
            let all = kinds.iter().flat_map(|&(kind, _)| names(mechanism, kind));
            let contacts = names(mechanism, ComponentKind::Contact);
            let all: Vec<String> = all
                .chain(["mu".to_owned(), "e".to_owned()])
                .chain(contacts.into_iter().flat_map(|name| [format!("mu.{name}"), format!("e.{name}")]))
                .collect();
            format!("a motion has no derivative by `{name}`: there are {}", all.join(", "))
        })
    }

    /// The variable with this name that may be fitted, or through which a motion may be followed: a parameter, mu or e.
    ///
    /// # Errors
    ///
    /// A sentence with the names that may.
    pub fn adjustable(mechanism: &InterpretedMechanism, name: &str) -> Result<Self, String> {
        let found = By::named(mechanism, name).ok();
        let may = |by: &By| matches!(by, By::Parameter(_) | By::Friction(_) | By::Restitution(_));
        found.filter(may).ok_or_else(|| {
            let mut all = names(mechanism, ComponentKind::Parameter);
            let contacts = names(mechanism, ComponentKind::Contact);
            if !contacts.is_empty() {
                all.extend(["mu".to_owned(), "e".to_owned()]);
            }
            all.extend(contacts.into_iter().flat_map(|name| [format!("mu.{name}"), format!("e.{name}")]));
            let there = if all.is_empty() {
                "there are none".to_owned()
            } else {
                format!("there are {}", all.join(", "))
            };
            format!("`{name}` is no parameter that may change, nor mu or e of a contact: {there}")
        })
    }

    /// The name that [`By::named`] reads.
    pub fn name(self, mechanism: &InterpretedMechanism) -> String {
        let of = |kind, index| mechanism.component(kind, index).map_or("?", |component| component.name);
        match self {
            By::Coordinate(index) => of(ComponentKind::Coordinate, index).to_owned(),
            By::Speed(index) => of(ComponentKind::Speed, index).to_owned(),
            By::Parameter(index) => of(ComponentKind::Parameter, index).to_owned(),
            By::Input(index) => of(ComponentKind::Input, index).to_owned(),
            By::Sample { input, row } => format!("{}[{row}]", of(ComponentKind::Input, input)),
            By::Friction(None) => "mu".to_owned(),
            By::Restitution(None) => "e".to_owned(),
            By::Friction(Some(contact)) => format!("mu.{}", of(ComponentKind::Contact, contact)),
            By::Restitution(Some(contact)) => format!("e.{}", of(ComponentKind::Contact, contact)),
        }
    }

    /// Whether it is mu of this contact.
    pub(crate) fn is_friction_of(self, contact: usize) -> bool {
        matches!(self, By::Friction(of) if of.is_none_or(|of| of == contact))
    }

    /// Whether it is e of this contact.
    pub(crate) fn is_restitution_of(self, contact: usize) -> bool {
        matches!(self, By::Restitution(of) if of.is_none_or(|of| of == contact))
    }
}

fn names(mechanism: &InterpretedMechanism, kind: ComponentKind) -> Vec<String> {
    let component = |index| mechanism.component(kind, index);
    (0..mechanism.count(kind)).filter_map(component).map(|component| component.name.to_owned()).collect()
}

/// Why a motion has no derivative from some time on.
#[derive(Clone, Debug, PartialEq)]
pub struct Undefined {
    /// the time, s
    pub time: f64,
    /// index of the contact, if the reason concerns one
    pub contact: Option<usize>,
    /// the reason
    pub reason: Reason,
}

/// Why a motion is not differentiable, or not differentiated here.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// A gap closes with zero normal velocity: neighbouring motions miss the surface, or hit it with a
    /// velocity that is proportional to the root of the change.
    Grazing,
    /// Several contacts collide, or several slips end, at the same time: in neighbouring motions they do so
    /// in different orders.
    AtOnce,
    /// The outcome of a collision is not differentiable; with the reason of the solver.
    Impact(hodograph::NonSmoothness),
    /// More than one mode of the contacts is possible, or a sliding contact may lift off or suffer an impact
    /// without collision.
    SeveralModes,
    /// A sliding contact comes to a jam by itself and suffers an impact without collision: up to there its force grows
    /// without bound.
    Jam,
    /// The function that ends a mode vanishes together with its rate.
    Tangency,
    /// Slip ends while its direction still turns.
    SlipTurns,
    /// The forces of the closed contacts are not unique.
    ForcesNotUnique,
    /// In the start state a contact is closed, and a change of this variable opens it, makes the bodies
    /// overlap or begins slip.
    StartInContact(By),
    /// A contact bounced at the start time.
    StartInCollision,
    /// The bounces of several contacts end together, and the gaps that are left have derivatives that matter: the order of the
    /// bounces changes with the variables, the more so the lower they are.
    Settling,
    /// A contact with e = 0 stays closed after a collision, and with any larger e it bounces.
    Plastic,
    /// The forces of the model jump at this time, s.
    ForceJump {
        /// s
        time: f64,
    },
    /// The modes changed by a cause whose time does not follow from the state.
    ModesChanged,
    /// The mechanism cannot be evaluated.
    State(hodograph::StateError),
    /// The motion that was integrated again differs from the original one by this much, relative to the
    /// state; infinite if its integration took too many steps.
    Inaccurate(f64),
}

/// The reason why there is no derivative, and its contact.
pub(crate) type NonDifferentiable = (Option<usize>, Reason);

impl Reason {
    pub(crate) fn is_jump(&self) -> bool {
        matches!(self, Self::ForceJump { .. })
    }

    /// From which time on this is the reason: `begun` unless it names its own, s.
    pub(crate) fn from(self, begun: f64) -> (f64, Self) {
        match self {
            Self::ForceJump { time } => (time, self),
            _ => (begun, self),
        }
    }
}

impl fmt::Display for Undefined {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "no derivative from t = {} s on: ", self.time)?;
        match &self.reason {
            Reason::Grazing => write!(
                out,
                "a gap closes with no speed (grazing): neighbouring motions miss it, or the derivative grows like an inverse root"
            ),
            Reason::AtOnce => write!(
                out,
                "several contacts strike, or several slips end, at one time: neighbouring motions do so in another order"
            ),
            Reason::Impact(why) => write!(out, "the outcome of a collision is not differentiable ({why:?})"),
            Reason::SeveralModes => write!(out, "more than one mode of the contacts is possible"),
            Reason::Jam => write!(
                out,
                "a sliding contact comes to a jam by itself: up to there its force grows without bound"
            ),
            Reason::Tangency => {
                write!(out, "what ends the mode of a contact vanishes together with its rate")
            }
            Reason::SlipTurns => write!(out, "slip ends while its direction still turns"),
            Reason::ForcesNotUnique => write!(out, "the forces of the closed contacts are not unique"),
            Reason::StartInContact(_) => write!(
                out,
                "the start state is in contact, and by one of the variables the contact opens, overlaps or slips: start apart, or leave \
                 that variable out"
            ),
            Reason::StartInCollision => {
                write!(out, "a contact collides at the start: begin a little before the collision")
            }
            Reason::Settling => {
                write!(
                    out,
                    "the bounces of several contacts end together, and the order of the last ones depends on the variables without bound: ask for derivatives before this time, or begin from a start whose corners strike in a steadier order"
                )
            }
            Reason::Plastic => write!(
                out,
                "with e = 0 the contact stays closed after its collision, and with any larger e it bounces: take a small e, or leave e out"
            ),
            Reason::ForceJump { .. } => write!(
                out,
                "forces of the model jump here, as `sign` does, or a spring whose length passes through zero: make them continuous, or ask for derivatives before this time"
            ),
            Reason::ModesChanged => write!(
                out,
                "the modes of the contacts changed by something whose time does not follow from the state"
            ),
            Reason::State(error) => error.fmt(out),
            Reason::Inaccurate(by) if by.is_infinite() => {
                write!(out, "the derivatives were not integrated in as many steps as are allowed")
            }
            Reason::Inaccurate(by) => {
                write!(out, "integrated anew the motion differs by {by:e} of its size: tighten the tolerance")
            }
        }
    }
}

impl std::error::Error for Undefined {}
