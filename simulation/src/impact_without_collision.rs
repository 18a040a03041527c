//! Impacts without collision: a sliding contact that no finite force can hold (Painleve's paradox).

use hodograph::{CollisionOutcome, Kind, ReducedMatrix, State, Surface, impact_without_collision};
use nalgebra::{Vector2, Vector3};

use crate::forces::JAM;
use crate::impacts::MOST;
use crate::motion::Failure;
use crate::transition::Transition;
use crate::{EventKind, Reason, SimulationError, Struck};

impl Transition<'_> {
    /// A sliding contact that no finite force holds suffers an impact with zero speed of approach; all that
    /// touch answer.
    pub(crate) fn impact_without_collision(&mut self, contact: usize) -> Result<(), SimulationError> {
        let was = self.front.phases.clone();
        self.front.crowd += 1;
        if self.front.crowd > MOST {
            return Err(self.error(Some(contact), self.without_end(MOST)));
        }
        let touching = self.touching(Some(contact))?;
        let (n, p) = (self.mechanism.count(Kind::Coordinate), self.mechanism.count(Kind::Speed));
        let before = self.front.y[n..n + p].to_vec();
        let (outcome, after) = self.without_collision(contact, &before)?;
        self.front.resting = false;
        self.front.y[n..n + p].copy_from_slice(&after);
        self.front.energy.impacts += outcome.energy_change;
        let struck = Struck { outcome, speeds_before: before, last_bounce: false, spread: None };
        self.push(Some(contact), EventKind::ImpactWithoutCollision(Box::new(struck)));
        match self.approaching(&touching, &after, Some(1.0))?.first() {
            Some(&(other, _)) => self.strike(other),
            None => self.part_or_stay(&touching, &after, &was),
        }
    }

    /// The outcome along n, t, s with t along the slip, and the speeds after.
    fn without_collision(
        &self,
        contact: usize,
        speeds: &[f64],
    ) -> Result<(CollisionOutcome<f64>, Vec<f64>), SimulationError> {
        let n = self.mechanism.count(Kind::Coordinate);
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        let fault = |error| self.failure(Failure::State(error));
        let here = self.mechanism.contact_state(contact, &state).map_err(fault)?;
        let speed = here.velocity.y.hypot(here.velocity.z);
        let (cos, sin) = (here.velocity.y / speed, here.velocity.z / speed);
        let reduced = here.reduced.turned(cos, sin);
        // Friction is that of the slip that jams, not that of impacts.
        let surface =
            Surface { mu: self.friction(contact, speed)?.slips, ..self.surface_in_impact(contact, 0.0)? };
        let surface = jammed(&reduced, surface);
        let impact = impact_without_collision(&reduced, &Vector2::new(speed, 0.0), &surface)
            .map_err(|error| self.error(Some(contact), Reason::Collision(error.into())))?;
        let (i, j) = (impact.impulse.y, impact.impulse.z);
        let impulse = [impact.impulse.x, i * cos - j * sin, i * sin + j * cos];
        let mut response = vec![0.0; 3 * speeds.len()];
        self.mechanism.response(contact, &state, &mut response).map_err(fault)?;
        let mut after = speeds.to_vec();
        for (speed, row) in after.iter_mut().zip(response.chunks_exact(3)) {
            *speed += row.iter().zip(&impulse).map(|(response, impulse)| response * impulse).sum::<f64>();
        }
        let outcome = CollisionOutcome {
            normal: here.normal,
            tangent: here.first * cos + here.second * sin,
            binormal: here.second * cos - here.first * sin,
            approach: Vector3::new(0.0, speed, 0.0),
            reduced,
            impulse_on_point: here.normal * impulse[0] + here.first * impulse[1] + here.second * impulse[2],
            energy_change: impact.contact_work,
            impact,
        };
        Ok((outcome, after))
    }
}

/// The surface of an impact without collision, t along the slip: where f = m_nn - mu m_nt is not yet zero,
/// but so small that the contact jams, with the friction that makes it as small and negative. It is larger by
/// less than `2 JAM` times m_nn / m_nt.
fn jammed(reduced: &ReducedMatrix<f64>, surface: Surface<f64>) -> Surface<f64> {
    let f = reduced.nn - surface.mu * reduced.nt;
    let least = JAM * reduced.nn;
    // the event is found where f = least, up to the rounding of its search
    if f >= 0.0 && f <= 1.5 * least {
        Surface { mu: (reduced.nn + least) / reduced.nt, ..surface }
    } else {
        surface
    }
}
