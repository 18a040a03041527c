//! Where the hypotheses of restitution end a collision (section 4 of the paper), for the paper's methods.

use super::{
    MethodError,
    equations::{I_N, NORMAL_WORK, Problem, S, State, Terminal, V_N},
};
use crate::{ImpactError, Law, Surface};

/// The event between two states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Event {
    /// Compression ends: v_n rises through zero (47).
    Rest,
    /// The bodies approach again: v_n falls through zero.
    Approach,
    /// The law ends the collision.
    End,
}

/// The law with its target, and the events recorded so far.
#[derive(Clone, Copy)]
pub(super) struct Ending {
    law: Law,
    /// The index of the law's quantity in a state.
    watch: usize,
    e: f64,
    /// v_n2 (48), I_n2 (51) or Delta E_n2 (54); holds during restitution.
    target: f64,
    least_work: f64,
    pub compressions: u32,
    approaching: bool,
    /// Where the first and the latest compression ended, and where slip stopped.
    pub first: Option<State>,
    pub latest: Option<State>,
    pub slip_end: Option<State>,
}

impl Ending {
    pub fn new(surface: &Surface<f64>) -> Self {
        Self {
            law: surface.law,
            watch: Self::watch(surface.law),
            e: surface.e,
            target: surface.e,
            least_work: 0.0,
            compressions: 0,
            approaching: true,
            first: None,
            latest: None,
            slip_end: None,
        }
    }

    /// Records the end of slip, if there was any slip.
    pub fn slip_stopped(&mut self, problem: &Problem, at: State) -> State {
        self.slip_end = (problem.start()[S] > 0.0).then_some(at);
        at
    }

    /// The index of the law's quantity in a state.
    const fn watch(law: Law) -> usize {
        match law {
            Law::Newton => V_N,
            Law::Poisson => I_N,
            Law::Stronge => NORMAL_WORK,
        }
    }

    #[inline(always)]
    fn watched(&self, state: &State) -> f64 {
        // The remainder does nothing; the compiler sees by it that the index is inside.
        state[self.watch % state.len()]
    }

    /// The event between the present state and a later one, if there is any. An `End` may lie before an
    /// `Approach`.
    #[inline]
    pub fn between(&self, to: &State) -> Option<Event> {
        if self.approaching {
            (to[V_N] >= 0.0).then_some(Event::Rest)
        } else if to[V_N] < 0.0 {
            Some(Event::Approach)
        } else {
            self.is_over(to).then_some(Event::End)
        }
    }

    /// Whether there is no event between the present state and a later one.
    #[inline(always)]
    pub fn is_quiet(&self, to: &State) -> bool {
        if self.approaching { to[V_N] < 0.0 } else { to[V_N] >= 0.0 && !self.is_over(to) }
    }

    /// Whether the quantity of the law has reached its target.
    #[inline]
    pub fn is_over(&self, at: &State) -> bool {
        self.watched(at) >= self.target
    }

    /// A function that rises through zero at the event.
    pub fn height(&self, event: Event, state: &State) -> f64 {
        match event {
            Event::Rest => state[V_N],
            Event::Approach => -state[V_N],
            Event::End => self.watched(state) - self.target,
        }
    }

    /// The rate of [`Self::height`], from the rates of the state.
    pub fn slope(&self, event: Event, rates: &State) -> f64 {
        match event {
            Event::Rest => rates[V_N],
            Event::Approach => -rates[V_N],
            Event::End => self.watched(rates),
        }
    }

    /// Records an event at its state; true if the collision is over.
    pub fn note(&mut self, event: Event, at: &mut State) -> bool {
        match event {
            Event::Rest => {
                at[V_N] = 0.0;
                self.approaching = false;
                self.compressions += 1;
                self.first.get_or_insert(*at);
                self.latest = Some(*at);
                self.least_work = self.least_work.min(at[NORMAL_WORK]);
                match self.law {
                    Law::Newton => {}
                    Law::Poisson => self.target = (1.0 + self.e) * at[I_N],
                    Law::Stronge => self.target = (1.0 - self.e * self.e) * self.least_work,
                }
                self.e <= 0.0
            }
            Event::Approach => {
                at[V_N] = 0.0;
                self.approaching = true;
                false
            }
            Event::End => {
                if self.law == Law::Newton {
                    at[V_N] = self.target;
                }
                true
            }
        }
    }

    /// Follows the terminal arc to its end in closed form: (57)-(60), with (61) and (62) for Stronge's
    /// hypothesis.
    ///
    /// `slack` is how far from zero v_n may be where slip and normal velocity stop together.
    pub fn close(
        &mut self,
        problem: &Problem,
        arc: &Terminal,
        mut at: State,
        slack: f64,
    ) -> Result<State, MethodError> {
        self.settle(arc, &mut at, slack);
        let wedged =
            |at: &State, law| ImpactError::Wedged { normal_velocity: problem.velocity(at[V_N]), law }.into();
        if self.approaching {
            if arc.v_n <= 0.0 && at[V_N] < 0.0 {
                return Err(wedged(&at, self.law));
            }
            let to_rest = if at[V_N] < 0.0 { -at[V_N] / arc.v_n } else { 0.0 };
            at = arc.after(problem.mu, &at, to_rest);
            if self.note(Event::Rest, &mut at) {
                return Ok(at);
            }
        }
        let missing = self.target - self.watched(&at);
        if missing <= 0.0 {
            return if self.e <= 0.0 || self.law != Law::Newton || at[V_N] >= 0.0 {
                Ok(at)
            } else {
                Err(wedged(&at, self.law))
            };
        }
        if arc.v_n <= 0.0 && (self.law == Law::Newton || (self.law == Law::Stronge && at[V_N] <= 0.0)) {
            return Err(wedged(&at, self.law));
        }
        let more = match self.law {
            Law::Newton => missing / arc.v_n,
            Law::Poisson => missing,
            // (61): v_n2^2 = v_n^2 + 2 (1 / c_n) (Delta E_n2 - Delta E_n), and the impulse without
            // cancellation.
            Law::Stronge => 2.0 * missing / (at[V_N] + (at[V_N] * at[V_N] + 2.0 * arc.v_n * missing).sqrt()),
        };
        at = arc.after(problem.mu, &at, more);
        self.note(Event::End, &mut at);
        Ok(at)
    }

    /// Where slip and normal velocity vanish together and neither changes again, the error of the method must
    /// not decide which vanished first.
    pub fn settle(&mut self, arc: &Terminal, at: &mut State, slack: f64) {
        if arc.v_n <= 0.0 && at[V_N].abs() <= slack {
            at[V_N] = 0.0;
        }
    }
}
