//! Contacts on the boundary of their friction cones.
//!
//! If friction misses a cone by less than the certificate tolerates, forces without slip are accepted
//! although they are not quite allowed. The motion is then one in which these contacts slip, however slowly.
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

/// The motion in which contacts whose friction exceeds the cone by more than rounding begin to slip; `None`
/// if there are none.
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
