//! The juggler itself, where the controller is tried in firmware: no standard library, no allocation. It
//! flies by Runge-Kutta steps of one period and bounces by the generated collision. `hodograph_simulation` is
//! a second road to the same motion.

use hodograph::{CollisionError, Mechanism, Scalar, StateError, Surface};

use super::juggler::{Coordinates, Inputs, Juggler, Speeds};

/// A juggler in motion.
#[derive(Clone, Debug)]
pub struct Plant<T: Scalar> {
    /// the mechanism with its true parameters
    pub juggler: Juggler<T>,
    /// the true surface
    pub surface: Surface<T>,
    /// coordinates now
    pub coordinates: Coordinates<T>,
    /// speeds now
    pub speeds: Speeds<T>,
}

/// Coordinates and speeds, or their rates.
type Both<T> = ([T; 10], [T; 9]);

impl<T: Scalar> Plant<T> {
    /// Lets so many seconds pass with these inputs.
    pub fn advance(&mut self, inputs: &Inputs<T>, period: T) -> Result<(), CollisionError<T>> {
        let zero = T::zero();
        let mut rest = period;
        // A ball that bounces twice within a period lies on the paddle: it is let through, and comes back
        // with the next bounce.
        for _ in 0..4 {
            let end = self.after(inputs, rest)?;
            let open = self.juggler.gap_bounce(&self.coordinates)? >= zero;
            if !(open && self.juggler.gap_bounce(&end.0)? < zero) {
                (self.coordinates, self.speeds) = end;
                break;
            }
            // Bisection keeps the gap open at `early`: the time of the bounce but for rounding.
            let (mut early, mut late) = (zero, rest);
            for _ in 0..48 {
                let middle = (early + late) * hodograph::nalgebra::convert(0.5);
                if self.juggler.gap_bounce(&self.after(inputs, middle)?.0)? < zero {
                    late = middle;
                } else {
                    early = middle;
                }
            }
            (self.coordinates, self.speeds) = self.after(inputs, early)?;
            if self.juggler.contact_velocity_bounce(&self.coordinates, &self.speeds)?[0] < zero {
                self.speeds =
                    self.juggler.collide_bounce(&self.coordinates, &self.speeds, &self.surface)?.speeds;
            }
            rest -= early;
        }
        Ok(())
    }

    /// The state after some time of flight: one step of the classical Runge-Kutta method.
    fn after(&self, inputs: &Inputs<T>, time: T) -> Result<(Coordinates<T>, Speeds<T>), StateError> {
        let start: Both<T> = (self.coordinates.into(), self.speeds.into());
        let number = hodograph::nalgebra::convert::<f64, T>;
        let half = time * number(0.5);
        let k1 = self.rates(&start, inputs)?;
        let k2 = self.rates(&along(&start, &k1, half), inputs)?;
        let k3 = self.rates(&along(&start, &k2, half), inputs)?;
        let k4 = self.rates(&along(&start, &k3, time), inputs)?;
        let mut end = start;
        for (k, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
            end = along(&end, &k, time * number(weight) / number(6.0));
        }
        self.juggler.normalise(&mut end.0)?;
        Ok((end.0.into(), end.1.into()))
    }

    fn rates(&self, at: &Both<T>, inputs: &Inputs<T>) -> Result<Both<T>, StateError> {
        let (q, u) = (at.0.into(), at.1.into());
        Ok((
            self.juggler.coordinate_rates(&q, &u)?.into(),
            self.juggler.accelerations(&q, &u, inputs)?.into(),
        ))
    }
}

/// A state, and its rates for some time.
fn along<T: Scalar>(from: &Both<T>, rates: &Both<T>, time: T) -> Both<T> {
    let (mut q, mut u) = *from;
    q.iter_mut().zip(&rates.0).for_each(|(q, rate)| *q += *rate * time);
    u.iter_mut().zip(&rates.1).for_each(|(u, rate)| *u += *rate * time);
    (q, u)
}
