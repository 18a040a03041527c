//! Pairs of shapes that stay apart during a step: none of their contacts is looked at (docs/theory.md, section 17.20).
//!
//! A clearance is a bound from below on how far two shapes are apart. It is examined over a step like a gap; where it
//! stays positive, no contact of the pair can touch. No step ends at its zero: a pair that comes near within a step is
//! examined in this very step.

use hodograph::{Distance, State, StateError};

use crate::closed::phase::{Leaving, Phase};
use crate::events::event_location::{Functions, Slopes, Values, first_crossing};
use crate::integration::stepper::Step;
use crate::state::transition::Transition;

/// A pair counts as apart while its clearance is above this part of the length of the problem: far more than the
/// rounding of a gap may be, and than the height below which contacts are near their faces.
const CLEAR: f64 = 1e-5;

impl Transition<'_> {
    /// The pairs of shapes, by their first contacts, that stay apart during a step in which angles turn by `turns` beyond
    /// what nine points resolve.
    pub(crate) fn stay_apart(&self, step: &Step, turns: f64) -> Vec<usize> {
        let mut pairs = self.open_pairs();
        if pairs.is_empty() {
            return pairs;
        }
        let Some(first) = self.clear_by(&pairs, step, 0.0) else { return Vec::new() };
        let mut clear = first.iter().map(|&by| by > 0.0);
        pairs.retain(|_| clear.next().unwrap_or(false));
        while !pairs.is_empty() {
            let noise = vec![0.0; pairs.len()];
            let found = first_crossing(
                &mut Functions {
                    count: pairs.len(),
                    noise: &noise,
                    near: &|_| None,
                    values: &mut |fraction, functions| {
                        let asked: Vec<usize> = functions.iter().map(|&one| pairs[one]).collect();
                        self.clear_by(&asked, step, fraction)
                    },
                    slopes: &mut |_| Slopes::from_elem(None, pairs.len()),
                },
                turns,
            );
            match found {
                Ok(None) => break,
                Ok(Some(crossing)) => {
                    pairs.remove(crossing.function);
                }
                Err(_) => pairs.clear(),
            }
        }
        pairs
    }

    /// The distances of these contacts in a state, of those that are of a pair of shapes which is not apart there, or of none.
    pub(crate) fn distances_nearby(
        &self,
        contacts: impl Iterator<Item = usize>,
        state: &State<'_>,
    ) -> Result<Vec<(usize, Distance)>, StateError> {
        let contacts: Vec<usize> = contacts.collect();
        let mut pairs: Vec<usize> = contacts.iter().filter_map(|&one| self.first_of_pair(one)).collect();
        pairs.dedup();
        let mut clearances = vec![0.0; pairs.len()];
        if !pairs.is_empty() {
            self.mechanism.clearances(&pairs, state, &mut clearances)?;
        }
        let least = CLEAR * self.front.scales.length;
        let apart: Vec<usize> =
            pairs.into_iter().zip(clearances).filter(|(_, by)| *by > least).map(|(first, _)| first).collect();
        let is_near = |&one: &usize| self.first_of_pair(one).is_none_or(|first| !apart.contains(&first));
        let near: Vec<usize> = contacts.into_iter().filter(is_near).collect();
        let mut distances = vec![Distance::default(); near.len()];
        self.mechanism.gaps(&near, state, &mut distances)?;
        Ok(near.into_iter().zip(distances).collect())
    }

    /// The pairs of shapes of which every contact is open and was found to be apart.
    fn open_pairs(&self) -> Vec<usize> {
        let mut pairs: Vec<usize> = Vec::new();
        let mut near: Vec<usize> = Vec::new();
        for (contact, phase) in self.front.phases.iter().enumerate() {
            let Some(first) = self.first_of_pair(contact) else { continue };
            if *phase != Phase::Open(Leaving::Apart) {
                near.push(first);
            } else if pairs.last() != Some(&first) {
                pairs.push(first);
            }
        }
        pairs.retain(|first| !near.contains(first));
        pairs
    }

    /// The first contact of the same two shapes, where these have a clearance.
    pub(crate) fn first_of_pair(&self, contact: usize) -> Option<usize> {
        self.pair(contact)?.first
    }

    /// By how much the clearances of pairs are above what counts as apart, at a fraction of a step; `None` where they
    /// cannot be told.
    fn clear_by(&self, pairs: &[usize], step: &Step, fraction: f64) -> Option<Values> {
        let y = step.at(fraction);
        let motion = self.motion(&[]);
        let time = step.t + fraction * step.h;
        let (coordinates, speeds) = motion.split(&y);
        let inputs = motion.inputs(time, &y).ok()?;
        let state = State { time, coordinates, speeds, inputs: &inputs };
        let mut clearances = Values::from_elem(0.0, pairs.len());
        self.mechanism.clearances(pairs, &state, &mut clearances).ok()?;
        clearances.iter_mut().for_each(|clearance| *clearance -= CLEAR * self.front.scales.length);
        clearances.iter().all(|clearance| clearance.is_finite()).then_some(clearances)
    }
}
