//! Contacts at the edge of their friction.
//!
//! Where friction misses a cone by less than the certificate accepts, forces without slip are accepted although
//! they are not quite allowed. The motion is then one that slips against them, however slowly.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::Vector2;

use super::{
    Mode, Problem, Solution,
    certified::with_certificate,
    motion::settle,
    prescribed::{FITS, with_modes_near},
    problem::three,
};

/// The motion in which those contacts begin to slip that friction holds but for an excess that is above
/// rounding; `None` where it holds them.
pub(super) fn beyond(problem: &Problem<'_>, found: &Solution) -> Option<Solution> {
    let middle = with_modes_near(problem, &found.modes, Some(&found.force)).ok()?;
    if middle.margin >= -FITS {
        return None;
    }
    let modes: Vec<Mode> = found
        .modes
        .iter()
        .enumerate()
        .map(|(i, mode)| {
            let force = three(&middle.force, i);
            let friction = Vector2::new(force.y, force.z);
            let over = friction.norm() > problem.mu[i] * force.x;
            let slips = matches!(mode, Mode::Stick) && over && force.x > 0.0;
            if slips { Mode::Slide(-friction.normalize()) } else { *mode }
        })
        .collect();
    if modes == found.modes {
        return None;
    }
    let open: Vec<usize> = (0..modes.len()).filter(|&i| modes[i] != found.modes[i]).collect();
    let modes = settle(problem, modes.clone(), &open, middle.force).unwrap_or(modes);
    let slow = with_certificate(problem, &modes)?;
    let forward = modes.iter().enumerate().all(|(i, mode)| match mode {
        Mode::Slide(d) if problem.slip[i].is_none() => {
            let acceleration = three(&slow.acceleration, i);
            d.x * acceleration.y + d.y * acceleration.z > 0.0
        }
        _ => true,
    });
    forward.then_some(Solution { modes, ..slow })
}
