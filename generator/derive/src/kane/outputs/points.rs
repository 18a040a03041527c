//! Writes positions, velocities and Jacobians of points, and orientations of frames, as nodes.

use std::collections::HashSet;

use super::Writer;
use crate::algebra::Expr;
use crate::kane::contacts::point_jacobian;
use crate::kinematics::axes::{AxesTree, unit};
use crate::kinematics::partial_velocities::Along;
use hodograph_model::model::mechanism::{FrameId, Place, PointId};
use hodograph_program::program::graph::Node;
use hodograph_program::program::{PointQuantity, Quantity};

impl Writer<'_, '_> {
    /// Positions, velocities and Jacobians of all points; of the places of a contact that is one of many, positions.
    pub(super) fn points(&mut self) {
        let contacts = &self.k.mechanism.contacts;
        let many: HashSet<PointId> =
            contacts.iter().filter(|contact| contact.is_one_of_many()).map(|contact| contact.point).collect();
        for id in 1..self.k.mechanism.points.len() {
            let of = |quantity| Quantity::Point(id as u32, quantity);
            let point = PointId(id);
            let located = self.k.connected(point, PointId::O)
                && !matches!(self.k.mechanism.points[id].place, Place::Velocity(_));
            if located {
                let position = self.k.position(point, PointId::O);
                let position = self.k.express(&position, AxesTree::N);
                let nodes = self.nodes(&position);
                self.put(of(PointQuantity::Position), 3, 1, nodes);
            }
            if many.contains(&point) {
                continue;
            }
            let (axes, velocity) = self.k.velocity_value(point);
            let velocity = self.k.tree.convert(&mut self.k.z, &velocity, axes, AxesTree::N);
            let nodes = self.nodes(&velocity);
            self.put(of(PointQuantity::Velocity), 3, 1, nodes);
            let nodes = self.point_jacobian(point);
            self.put(of(PointQuantity::Jacobian), 3, self.independent.len(), nodes);
        }
    }

    /// The partial velocities of a point along N, row by row, computed in the way that takes fewer
    /// operations.
    fn point_jacobian(&mut self, point: PointId) -> Vec<Node> {
        let [usual, other] = [Along::Result, Along::Home].map(|along| {
            let form = point_jacobian(self.k, point, along);
            let places = (0..3).flat_map(|i| self.independent.iter().map(move |slot| (i, slot)));
            let entry = |(i, slot): (usize, &usize)| {
                form.terms.get(slot).map_or_else(Expr::zero, |partial| partial[i].clone())
            };
            let entries: Vec<Expr> = places.map(entry).collect();
            self.nodes(&entries)
        });
        if self.graph.cost(&other) < self.graph.cost(&usual) { other } else { usual }
    }

    /// Orientations of all frames.
    pub(super) fn orientations(&mut self) {
        for id in 1..self.k.mechanism.frames.len() {
            let Some(axes) = self.k.frame_axes[FrameId(id).0] else { continue };
            let columns: Vec<_> =
                (0..3).map(|i| self.k.tree.convert(&mut self.k.z, &unit(i), axes, AxesTree::N)).collect();
            let rows: Vec<Expr> =
                (0..3).flat_map(|i| columns.iter().map(move |column| column[i].clone())).collect();
            let nodes = self.nodes(&rows);
            self.put(Quantity::Orientation(id as u32), 3, 3, nodes);
        }
    }
}
