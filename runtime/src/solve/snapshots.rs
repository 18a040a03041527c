//! Converts the states that the solver recorded into snapshots in the units of the input.
//!
//! Theory: docs/theory.md, section 1.2.

use nalgebra::{Vector2, Vector3};

use super::{
    contact::Contact,
    restitution::{Restitution, State},
};
use crate::{
    Motion, Path, Phases, Snapshot,
    scalar::{Real, constant},
};

/// The units of the solver, where m_nn = 1 and v_n1 = -1, in those of the input.
pub(crate) struct Units<'a, T: Real> {
    pub approach: &'a Vector3<T>,
    /// The units of impulse (`scale`) and of velocity (`speed`).
    pub scale: T,
    pub speed: T,
    pub contact: &'a Contact<T>,
}

impl<T: Real> Units<'_, T> {
    /// The snapshot of a state with its tangential velocity.
    #[inline(always)]
    pub fn snapshot(&self, state: &State<T>, tangential: &Vector2<T>, motion: Motion) -> Snapshot<T> {
        let impulse = Vector3::new(state.normal, state.tangential.x, state.tangential.y) * self.scale;
        let velocity = Vector3::new(state.velocity, tangential.x, tangential.y) * self.speed;
        Snapshot {
            impulse,
            velocity,
            contact_work: impulse.dot(&(velocity + self.approach)) * constant(0.5),
            normal_work: state.work * self.scale * self.speed,
            motion,
        }
    }

    /// The snapshot of an end of compression.
    #[inline(always)]
    fn compression(&self, state: &State<T>, slip_end: Option<&State<T>>, path: Path) -> Snapshot<T> {
        let after = path.last();
        let slides = match slip_end {
            Some(end) => state.normal < end.normal,
            None => path == Path::Sliding,
        };
        if slides {
            self.snapshot(state, &self.tangential(state), Motion::Sliding)
        } else if after == Motion::Renewal {
            self.snapshot(state, &self.tangential(state), after)
        } else {
            self.snapshot(state, &Vector2::zeros(), after)
        }
    }

    /// The tangential velocity that the impulses give: (21), (22).
    #[inline(always)]
    fn tangential(&self, state: &State<T>) -> Vector2<T> {
        let c = self.contact;
        let i = &state.tangential;
        Vector2::new(self.approach.y, self.approach.z) / self.speed
            + c.b * state.normal
            + Vector2::new(c.tt * i.x + c.ts * i.y, c.ts * i.x + c.ss * i.y)
    }
}

/// The snapshots of the states that the solver recorded.
#[inline(always)]
pub(super) fn phases<T: Real>(
    units: &Units<'_, T>,
    restitution: &Restitution<T>,
    slip_end: Option<State<T>>,
    path: Path,
) -> Phases<T> {
    if T::INLINED {
        phases_here(units, restitution, slip_end, path)
    } else {
        phases_apart(units, restitution, slip_end, path)
    }
}

#[inline(never)]
fn phases_apart<T: Real>(
    units: &Units<'_, T>,
    restitution: &Restitution<T>,
    slip_end: Option<State<T>>,
    path: Path,
) -> Phases<T> {
    phases_here(units, restitution, slip_end, path)
}

#[inline(always)]
fn phases_here<T: Real>(
    units: &Units<'_, T>,
    restitution: &Restitution<T>,
    slip_end: Option<State<T>>,
    path: Path,
) -> Phases<T> {
    let after = path.last();
    let compression = |state: &Option<State<T>>| match state {
        Some(state) => Some(units.compression(state, slip_end.as_ref(), path)),
        None => None,
    };
    let compression_end = compression(&restitution.first);
    let last_compression_end =
        if restitution.compressions == 1 { compression_end } else { compression(&restitution.latest) };
    Phases {
        compression_end,
        last_compression_end,
        slip_end: slip_end.map(|state| units.snapshot(&state, &Vector2::zeros(), after)),
    }
}
