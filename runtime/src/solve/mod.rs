//! The impact solver. `collision` solves one collision; the other files hold its parts, in units where m_nn =
//! 1 and v_n1 = -1.
//!
//! Theory: docs/theory.md, section 1.

mod collision;
mod contact;
mod event;
mod event_location;
mod gauss16;
mod grazing;
mod input;
mod invariant_directions;
mod lanes;
mod lobatto5;
mod perturbation;
mod range;
mod reach;
mod restitution;
mod sensitivity;
mod sliding;
mod sliding_arc;
mod snapshots;
mod stop_series;
mod straight;
mod target;
mod taylor;
mod terminal;
#[cfg(feature = "lanes")]
mod together;
mod verification;
mod without_collision;

#[cfg(feature = "lanes")]
pub(crate) use self::together::solve_together;
pub use self::{collision::solve, without_collision::impact_without_collision};
pub(crate) use self::{
    collision::{collide, slips, solve_real},
    contact::Contact,
    event::Event,
    input::{check, checked},
    range::{AnyArc, slide, slide_rarely},
    restitution::{LinearArc, Restitution, State},
    snapshots::Units,
    straight::{Slide, Slides, straight},
    target::Watched,
    terminal::Terminal,
    without_collision::without_collision,
};
