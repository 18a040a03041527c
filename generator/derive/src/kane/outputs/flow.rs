//! Accelerations of points and free accelerations of contacts, by differentiating velocities along the
//! motion.

use std::collections::HashMap;

use super::Writer;
use hodograph_program::program::differentiate::differentiate;
use hodograph_program::program::graph::{Input, Node};
use hodograph_program::program::{ContactQuantity, PointQuantity, Quantity};

impl Writer<'_, '_> {
    /// The nodes of a quantity, if they exist.
    fn written(&self, quantity: Quantity) -> Option<Vec<Node>> {
        self.outputs.iter().find(|output| output.quantity == quantity).map(|output| output.values.clone())
    }

    /// The rates of time, coordinates and independent speeds, for given rates of the speeds. Named inputs are
    /// constant.
    fn motion(&mut self, accelerations: &[Node]) -> HashMap<Input, Node> {
        let one = self.graph.integer(1);
        let mut rates = HashMap::from([(Input::Time, one)]);
        let coordinates = self.written(Quantity::CoordinateRates).unwrap_or_default();
        rates.extend((0..).map(Input::Coordinate).zip(coordinates));
        rates.extend((0..).map(Input::Speed).zip(accelerations.iter().copied()));
        rates
    }

    /// Accelerations of all points for given rates of the independent speeds.
    pub(super) fn accelerations_of_points(&mut self) {
        let given: Vec<Node> =
            (0..self.independent.len()).map(|i| self.graph.input(Input::Acceleration(i as u32))).collect();
        let motion = self.motion(&given);
        let points = 1..self.k.mechanism.points.len() as u32;
        let moving = |point| Some((point, self.written(Quantity::Point(point, PointQuantity::Velocity))?));
        let moving: Vec<(u32, Vec<Node>)> = points.filter_map(moving).collect();
        let velocities: Vec<Node> =
            moving.iter().flat_map(|(_, velocity)| velocity.iter().copied()).collect();
        let accelerations = differentiate(&mut self.graph, &velocities, &motion);
        for ((point, _), acceleration) in moving.iter().zip(accelerations.chunks(3)) {
            self.put(Quantity::Point(*point, PointQuantity::Acceleration), 3, 1, acceleration.to_vec());
        }
    }

    /// Rates of the velocities, and of the relative rotations, of all contacts along the contact basis, without contact
    /// forces.
    pub(super) fn free_accelerations(&mut self) {
        let Some(accelerations) = self.written(Quantity::Accelerations) else { return };
        let motion = self.motion(&accelerations);
        for contact in 0..self.k.mechanism.contacts.len() as u32 {
            let of = |quantity| Quantity::Contact(contact, quantity);
            for (velocity, rate) in [
                (ContactQuantity::Velocity, ContactQuantity::FreeAcceleration),
                (ContactQuantity::AngularVelocity, ContactQuantity::FreeAngularAcceleration),
            ] {
                let Some(velocity) = self.written(of(velocity)) else { continue };
                let rates = differentiate(&mut self.graph, &velocity, &motion);
                self.put(of(rate), 3, 1, rates);
            }
        }
    }
}
