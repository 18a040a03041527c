//! Converts the final state of a collision to an outcome in the units of the input.

use nalgebra::Vector3;

use super::{
    Solution,
    equations::{I_N, I_S, I_T, NORMAL_WORK, PHI, Problem, S, State, V_N, WORK},
    law::Ending,
};
use crate::{Impact, Motion, Path, Phases, Sensitivity, Snapshot};

impl Problem {
    /// The outcome in the units of the input, after so many steps.
    pub fn outcome(
        &self,
        approach: &Vector3<f64>,
        (end, path): (&State, Path),
        ending: &Ending,
        steps: u32,
    ) -> Solution {
        let after = path.last();
        let compression = |state: State| {
            let slides = ending.slip_end.is_none_or(|end| state[I_N] < end[I_N]) && self.slip > 0.0;
            self.snapshot(&state, if slides { Motion::Sliding } else { after })
        };
        let Snapshot { impulse, velocity, contact_work, normal_work, .. } = self.snapshot(end, after);
        let compression_end = ending.first.map(compression);
        let last_compression_end =
            if ending.compressions == 1 { compression_end } else { ending.latest.map(compression) };
        let impact = Impact {
            approach: *approach,
            impulse,
            velocity,
            contact_work,
            normal_work,
            path,
            compressions: ending.compressions,
            phases: Phases {
                compression_end,
                last_compression_end,
                slip_end: ending.slip_end.map(|mut state| {
                    state[S] = 0.0;
                    self.snapshot(&state, after)
                }),
            },
            sensitivity: Sensitivity::default(),
        };
        Solution { impact, steps }
    }

    fn snapshot(&self, at: &State, motion: Motion) -> Snapshot<f64> {
        // Without slip its direction means nothing.
        let (sin, cos) = if at[S] == 0.0 { (0.0, 0.0) } else { at[PHI].sin_cos() };
        let scale = self.speed / self.nn;
        Snapshot {
            impulse: Vector3::new(at[I_N], at[I_T], at[I_S]) * scale,
            velocity: Vector3::new(at[V_N], at[S] * cos, at[S] * sin) * self.speed,
            contact_work: at[WORK] * scale * self.speed,
            normal_work: at[NORMAL_WORK] * scale * self.speed,
            motion,
        }
    }
}
