//! Writes the quantities of contacts as nodes: bases, velocities, reduced matrices, and their directional
//! derivatives.

use std::collections::HashMap;

use super::Writer;
use crate::algebra::Expr;
use crate::kane::articulated::Articulated;
use crate::kane::contacts::{ContactForms, Rows, contact_forms};
use crate::kane::forces::Wrenches;
use crate::kinematics::partial_velocities::Along;
use hodograph_model::model::mechanism::Contact;
use hodograph_program::program::differentiate::differentiate;
use hodograph_program::program::graph::{Graph, Input, Node};
use hodograph_program::program::ldl::Factor;
use hodograph_program::program::{ContactQuantity, Quantity, Structure};

/// Rows and columns of the entries of a reduced matrix.
const UPPER: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// The response of a mechanism to unit impulses at a contact.
struct Responses {
    /// V M^-1 V', its upper half
    reduced: Vec<Node>,
    /// M^-1 V'
    columns: Vec<Vec<Node>>,
}

impl Writer<'_, '_> {
    /// The forms of all contacts, computed in the way that takes fewer operations.
    pub(super) fn contact_forms(&mut self) -> Vec<ContactForms> {
        let mechanism = self.k.mechanism;
        mechanism.contacts.iter().map(|contact| self.cheaper_forms(contact)).collect()
    }

    fn cheaper_forms(&mut self, contact: &Contact) -> ContactForms {
        let [(cost, usual), (other_cost, other)] = [Along::Result, Along::Home].map(|along| {
            let place = format!("contact `{}`", contact.name);
            let forms = self.k.within(place, |k| contact_forms(k, contact, along));
            let partials = forms.rows.partials.iter().flat_map(|row| row.values());
            let nodes = self.nodes(partials.chain(&forms.gap));
            (self.graph.cost(&nodes), forms)
        });
        // Zeros that are recognised determine the basis and closed forms.
        let vanishes = |forms: &ContactForms, row: usize, slot: usize| {
            forms.rows.partials[row].get(&slot).is_none_or(Expr::is_zero)
        };
        let mut all = (0..self.k.speeds.len()).flat_map(|slot| (0..3).map(move |row| (row, slot)));
        let sees_as_much = all.all(|(row, slot)| !vanishes(&usual, row, slot) || vanishes(&other, row, slot))
            && (0..3).all(|row| !usual.rows.remainder[row].is_zero() || other.rows.remainder[row].is_zero())
            && (!usual.planar || other.planar);
        if other_cost < cost && sees_as_much && usual.basis == other.basis { other } else { usual }
    }

    /// All quantities of all contacts except derivatives; returns the structures of their reduced matrices.
    pub(super) fn contacts(
        &mut self,
        forms: &[ContactForms],
        factor: &Factor,
        prescribed: &[Node],
    ) -> Vec<Structure> {
        let numbered = forms.iter().enumerate();
        numbered.map(|(number, forms)| self.contact(number as u32, forms, factor, prescribed)).collect()
    }

    /// V M^-1 V' and the columns of M^-1 V' by articulated inertias.
    fn responses(&mut self, articulated: &Articulated, forces: &[Wrenches; 3]) -> Option<Responses> {
        let mut loads = Vec::new();
        for wrenches in forces {
            loads.push(articulated.inwards(self.k, wrenches.clone(), None)?);
        }
        let reduced: Vec<Expr> =
            UPPER.iter().map(|&(i, j)| articulated.product(self.k, &loads[i], &loads[j])).collect();
        let reduced = self.nodes(&reduced);
        let mut columns = Vec::new();
        for loads in &loads {
            let column = articulated.outwards(self.k, loads, None);
            columns.push(self.nodes(&column));
        }
        Some(Responses { reduced, columns })
    }

    fn contact(
        &mut self,
        number: u32,
        forms: &ContactForms,
        factor: &Factor,
        prescribed: &[Node],
    ) -> Structure {
        let of = |quantity| Quantity::Contact(number, quantity);
        for (quantity, axis) in [ContactQuantity::Normal, ContactQuantity::First, ContactQuantity::Second]
            .into_iter()
            .zip(&forms.basis)
        {
            let nodes = self.nodes(axis);
            self.put(of(quantity), 3, 1, nodes);
        }
        let p = self.independent.len();
        let velocity = (ContactQuantity::Velocity, ContactQuantity::PartialVelocities);
        let (partials, remainder) = self.contact_velocity(number, &forms.rows, velocity);
        self.put(of(ContactQuantity::Remainder), 3, 1, remainder);
        if let Some(turning) = &forms.turning {
            self.contact_turning(number, turning, factor);
        }
        let (structure, Responses { reduced, columns }) = self.contact_responses(forms, factor, &partials);
        self.put(of(ContactQuantity::Reduced), 6, 1, reduced);
        let response: Vec<Node> = (0..p).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
        self.put(of(ContactQuantity::Response), p, 3, response);
        let dependent = self.dependent_responses(&columns);
        self.put(of(ContactQuantity::DependentResponse), self.dependent.len(), 3, dependent);
        if let Some(gap) = &forms.gap {
            let nodes = self.nodes([gap]);
            self.put(of(ContactQuantity::Gap), 1, 1, nodes);
        }
        if let Some(validity) = &forms.validity {
            let nodes = self.nodes([validity]);
            self.put(of(ContactQuantity::Validity), 1, 1, nodes);
        }
        if let Some(clearance) = &forms.clearance {
            let nodes = self.nodes([clearance]);
            self.put(of(ContactQuantity::Clearance), 1, 1, nodes);
        }
        let work: Vec<Node> = columns
            .iter()
            .map(|column| {
                let terms: Vec<Node> =
                    column.iter().zip(prescribed).map(|(&c, &m)| self.graph.product([c, m])).collect();
                self.graph.sum(terms)
            })
            .collect();
        self.put(of(ContactQuantity::PrescribedWork), 3, 1, work);
        structure
    }

    /// A relative velocity, which is `named` so with its partial velocities, of its partial velocities by slot and its
    /// remainder; returns those by independent speeds, row by row, and this.
    fn contact_velocity(
        &mut self,
        number: u32,
        rows: &Rows,
        named: (ContactQuantity, ContactQuantity),
    ) -> (Vec<Vec<Node>>, Vec<Node>) {
        let of = |quantity| Quantity::Contact(number, quantity);
        let p = self.independent.len();
        let partials: Vec<Vec<Node>> = rows
            .partials
            .iter()
            .map(|row| {
                let row: Vec<Expr> = self
                    .independent
                    .iter()
                    .map(|slot| row.get(slot).cloned().unwrap_or_else(Expr::zero))
                    .collect();
                self.nodes(&row)
            })
            .collect();
        let remainder = self.nodes(&rows.remainder);
        let mut velocity = Vec::new();
        for (row, &rest) in partials.iter().zip(&remainder) {
            let mut terms = vec![rest];
            for (i, &partial) in row.iter().enumerate() {
                let speed = self.graph.input(Input::Speed(i as u32));
                terms.push(self.graph.product([partial, speed]));
            }
            velocity.push(self.graph.sum(terms));
        }
        self.put(of(named.0), 3, 1, velocity);
        self.put(of(named.1), 3, p, partials.concat());
        (partials, remainder)
    }

    /// The relative rotation of the bodies, and how the mechanism responds to torques between them.
    fn contact_turning(&mut self, number: u32, rows: &Rows, factor: &Factor) {
        let named = (ContactQuantity::AngularVelocity, ContactQuantity::PartialAngularVelocities);
        let (partials, _) = self.contact_velocity(number, rows, named);
        let columns: Vec<Vec<Node>> = partials
            .iter()
            .map(|row| {
                let half = factor.half_solve(&mut self.graph, row);
                factor.finish(&mut self.graph, &half)
            })
            .collect();
        let p = self.independent.len();
        let response = (0..p).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
        self.put(Quantity::Contact(number, ContactQuantity::AngularResponse), p, 3, response);
    }

    /// The reduced matrix with its structure and the responses, by the factorised mass matrix or by
    /// articulated inertias: whichever takes clearly fewer operations.
    fn contact_responses(
        &mut self,
        forms: &ContactForms,
        factor: &Factor,
        partials: &[Vec<Node>],
    ) -> (Structure, Responses) {
        let halves: Vec<Vec<Node>> =
            partials.iter().map(|row| factor.half_solve(&mut self.graph, row)).collect();
        let mut reduced: Vec<Node> =
            UPPER.iter().map(|&(i, j)| factor.product(&mut self.graph, &halves[i], &halves[j])).collect();
        let zero = |i: usize| self.graph.is_zero(reduced[i]);
        let structure = match (zero(1), zero(2), zero(4)) {
            _ if forms.planar => Structure::Planar,
            (.., true) if reduced[3] == reduced[5] => Structure::Isotropic,
            (true, true, true) => Structure::Diagonal,
            (true, true, false) => Structure::Balanced,
            _ => Structure::General,
        };
        let mut columns: Vec<Vec<Node>> =
            halves.iter().map(|half| factor.finish(&mut self.graph, half)).collect();
        if let Some(articulated) = self.articulated.take() {
            let shared = partials.concat();
            let cost = |graph: &Graph, reduced: &[Node]| graph.cost(&[&shared, reduced].concat());
            // The count is approximate: only a clear difference counts.
            if let Some(forces) = &forms.forces
                && let Some(other) = self.responses(&articulated, forces)
                && 10 * cost(&self.graph, &other.reduced) < 9 * cost(&self.graph, &reduced)
            {
                // Entries that are identically 0 are exactly 0.
                let kept = reduced.iter().zip(&other.reduced);
                reduced = kept
                    .map(|(&by_factor, &other)| if self.graph.is_zero(by_factor) { by_factor } else { other })
                    .collect();
                columns = other.columns;
                self.guard_articulated(&articulated);
            }
            self.articulated = Some(articulated);
        }
        (structure, Responses { reduced, columns })
    }

    /// How the dependent speeds respond, as the independent ones do by these columns.
    fn dependent_responses(&mut self, columns: &[Vec<Node>]) -> Vec<Node> {
        let mut dependent = Vec::new();
        for &d in &self.dependent.clone() {
            for column in columns {
                let mut terms = Vec::new();
                for (i, &r) in self.independent.clone().iter().enumerate() {
                    let by = self.k.dependence(d, r);
                    let by = self.node(&by);
                    terms.push(self.graph.product([by, column[i]]));
                }
                dependent.push(self.graph.sum(terms));
            }
        }
        dependent
    }

    /// The derivative of the quantities of a collision along a direction. If time occurs explicitly, it would
    /// be incomplete.
    pub(super) fn contact_tangents(&mut self, rates: &Option<HashMap<Input, Node>>) {
        let Some(rates) = rates else { return };
        let contacts = self.k.mechanism.contacts.iter().zip(0..);
        let alone = contacts.filter(|(contact, _)| !contact.is_one_of_many());
        for number in alone.map(|(_, number)| number).collect::<Vec<u32>>() {
            let found = |quantity| {
                let quantity = Quantity::Contact(number, quantity);
                self.outputs
                    .iter()
                    .find(|output| output.quantity == quantity)
                    .map(|output| output.values.clone())
            };
            let needed =
                [ContactQuantity::Velocity, ContactQuantity::Reduced, ContactQuantity::Response].map(found);
            let [Some(velocity), Some(reduced), Some(response)] = needed else { continue };
            let gap = found(ContactQuantity::Gap).unwrap_or_default();
            let nodes = [velocity, reduced, response, gap].concat();
            let loops = self.outputs.iter().find(|output| output.quantity == Quantity::ConfigurationResidual);
            let watched =
                [nodes.clone(), loops.map(|output| output.values.clone()).unwrap_or_default()].concat();
            let clock = HashMap::from([(Input::Time, self.graph.integer(1))]);
            let by_time = differentiate(&mut self.graph, &watched, &clock);
            if by_time.iter().all(|&node| self.graph.is_zero(node)) {
                let tangent = differentiate(&mut self.graph, &nodes, rates);
                self.put(Quantity::Contact(number, ContactQuantity::Tangent), tangent.len(), 1, tangent);
            }
        }
    }
}
