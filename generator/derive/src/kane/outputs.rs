//! Writes all quantities of a derivation as nodes of a graph.

mod contact;
mod derivatives;
mod flow;
mod points;

use std::collections::{BTreeMap, HashMap};

use super::accelerations::Accelerations;
use super::articulated::Articulated;
use super::base_parameters::{self, Attachment, LumpedInertia, Masses};
use super::contacts::ContactForms;
use super::forces::{self, Wrenches};
use super::{bounds, energy, inertia, momentum};
use crate::algebra::{Direction, Export, Expr};
use crate::kinematics::linear_forms::{LinearScalar, Triple};
use crate::kinematics::solve::Solver;
use crate::kinematics::{GuardedValue, Kinematics};
use hodograph_program::program::differentiate::differentiate;
use hodograph_program::program::graph::{Graph, Input, Node};
use hodograph_program::program::ldl::{Factor, factorise};
use hodograph_program::program::{Derived, Guard, Inputs, Output, Quantity};

/// The graph under construction.
struct Writer<'k, 'm> {
    k: &'k mut Kinematics<'m>,
    graph: Graph,
    export: Export,
    outputs: Vec<Output<Node>>,
    guards: Vec<Guard<Node>>,
    independent: Vec<usize>,
    dependent: Vec<usize>,
    inertias: BTreeMap<Attachment, LumpedInertia>,
    /// upper bounds of the diagonal entries of the mass matrix for all configurations; empty if there are
    /// dependent speeds
    largest: Vec<Node>,
    /// the mass matrix factorised by articulated inertias, if the mechanism allows it
    articulated: Option<Articulated>,
    /// derivatives of the dependent coordinates with respect to independent ones
    followers: Vec<(Input, Vec<(Input, Node)>)>,
}

/// Derives and writes all quantities.
pub fn write(k: &mut Kinematics<'_>) -> Derived {
    let (mut independent, mut dependent) = (Vec::new(), Vec::new());
    for (slot, speed) in k.mechanism.speeds.iter().enumerate() {
        if speed.dependent { dependent.push(slot) } else { independent.push(slot) }
    }
    let inertias = base_parameters::lumped_inertias(k, Masses::Regrouped);
    let mut writer = Writer {
        k,
        graph: Graph::new(),
        export: Export::default(),
        outputs: Vec::new(),
        guards: Vec::new(),
        independent,
        dependent,
        inertias,
        largest: Vec::new(),
        articulated: None,
        followers: Vec::new(),
    };
    writer.kinematics();
    let (matrix, prescribed) = writer.mass_matrix();
    let factor = factorise(&mut writer.graph, &matrix);
    writer.guard_pivots(&factor);
    let contacts = writer.contact_forms();
    let acting = writer.articulate(&contacts);
    writer.dynamics(&factor, acting);
    let rates = writer.direction();
    writer.linearisation(&rates);
    writer.energies();
    writer.configuration();
    let structures = writer.contacts(&contacts, &factor, &prescribed);
    writer.contact_tangents(&rates);
    writer.points();
    writer.orientations();
    writer.accelerations_of_points();
    writer.free_accelerations();
    writer.guards();
    let samples = super::samples::samples(writer.k.mechanism);
    let mut apart = if rates.is_some() { writer.derivatives(&samples) } else { Vec::new() };
    // Separate derivations, so that their operations and numbers do not affect those of the equations of
    // motion.
    let (graph, outputs, guards) = (writer.graph.clone(), writer.outputs.split_off(0), writer.guards.clone());
    apart.extend(writer.momenta(&samples));
    Derived { graph, outputs, guards, structures, samples, apart, solve: None }
}

impl Writer<'_, '_> {
    fn node(&mut self, expr: &Expr) -> Node {
        self.export.node(&self.k.z, &mut self.graph, expr)
    }

    fn nodes<'a>(&mut self, exprs: impl IntoIterator<Item = &'a Expr>) -> Vec<Node> {
        exprs.into_iter().map(|expr| self.node(expr)).collect()
    }

    fn put(&mut self, quantity: Quantity, rows: usize, columns: usize, nodes: Vec<Node>) {
        if !nodes.is_empty() {
            self.outputs.push(Output { quantity, rows, columns, values: nodes });
        }
    }

    fn kinematics(&mut self) {
        let rates: Vec<Expr> = self.k.rates.clone().iter().map(|rate| self.k.value(rate)).collect();
        let nodes = self.nodes(&rates);
        self.put(Quantity::CoordinateRates, nodes.len(), 1, nodes);
        let dependent: Vec<Expr> = self.dependent.iter().map(|&slot| self.k.speed(slot)).collect();
        let nodes = self.nodes(&dependent);
        self.put(Quantity::DependentSpeeds, nodes.len(), 1, nodes);
        let mut residuals = Vec::new();
        for equation in &self.k.mechanism.constraints {
            for form in self.k.equation_forms(&equation.sides) {
                let form: LinearScalar = form;
                residuals.push(self.k.value(&form));
            }
        }
        let nodes = self.nodes(&residuals);
        self.put(Quantity::ConstraintResidual, nodes.len(), 1, nodes);
    }

    /// The mass matrix in independent speeds, and its coupling with prescribed motion.
    fn mass_matrix(&mut self) -> (Vec<Vec<Node>>, Vec<Node>) {
        let full = inertia::full_mass_matrix(self.k, &self.inertias);
        let remainder = self.k.speeds.len();
        let entry = |r: usize, s: usize| full.get(&(r.min(s), r.max(s))).cloned().unwrap_or_else(Expr::zero);
        let (independent, dependent) = (self.independent.clone(), self.dependent.clone());
        // rows of the dependent speeds, after substitution of their own dependence: M_d = M_di + M_dd A (and
        // prescribed motion)
        let mut rows: BTreeMap<(usize, usize), Expr> = BTreeMap::new();
        for &d in &dependent {
            for &s in independent.iter().chain([&remainder]) {
                let mut sum = entry(d, s);
                for &e in &dependent {
                    let by = if s == remainder {
                        self.k.dependent.get(&e).map_or_else(Expr::zero, |form| form.rest.clone())
                    } else {
                        self.k.dependence(e, s)
                    };
                    sum = sum.add(&entry(d, e).mul(&by));
                }
                let sum = self.k.z.name(sum);
                rows.insert((d, s), sum);
            }
        }
        let mut reduced = |r: usize, s: usize| {
            let mut sum = entry(r, s);
            for &d in &dependent {
                // A' M_d
                sum = sum.add(&self.k.dependence(d, r).mul(&rows[&(d, s)]));
                // M_id A
                let by = if s == remainder {
                    self.k.dependent.get(&d).map_or_else(Expr::zero, |form| form.rest.clone())
                } else {
                    self.k.dependence(d, s)
                };
                sum = sum.add(&entry(r, d).mul(&by));
            }
            let sum = self.k.z.simplify(&sum);
            self.k.z.name(sum)
        };
        let mut matrix = vec![vec![Expr::zero(); independent.len()]; independent.len()];
        for (i, &r) in independent.iter().enumerate() {
            for (j, &s) in independent.iter().enumerate().take(i + 1) {
                let value = reduced(r, s);
                matrix[i][j] = value.clone();
                matrix[j][i] = value;
            }
        }
        let prescribed: Vec<Expr> = independent.iter().map(|&r| reduced(r, remainder)).collect();
        if dependent.is_empty() {
            let largest = bounds::diagonal(self.k, &self.inertias);
            self.largest = self.nodes(&largest);
        }
        let matrix: Vec<Vec<Node>> = matrix.iter().map(|row| self.nodes(row)).collect();
        let prescribed = self.nodes(&prescribed);
        let all = matrix.iter().flatten().copied().collect();
        self.put(Quantity::MassMatrix, independent.len(), independent.len(), all);
        (matrix, prescribed)
    }

    fn guard_pivots(&mut self, factor: &Factor) {
        let pivots = self.pivots(&self.graph, factor, &self.largest);
        self.guards.extend(pivots);
    }

    /// The pivots of a factor of the mass matrix, which must not vanish relative to the `largest` values of
    /// its diagonal.
    fn pivots(&self, graph: &Graph, factor: &Factor, largest: &[Node]) -> Vec<Guard<Node>> {
        let open = factor.pivots.iter().filter(|(value, ..)| graph.as_number(*value).is_none());
        let guard = |&(value, scale, row): &(Node, Node, usize)| {
            let speed = &self.k.mechanism.speeds[self.independent[row]].name;
            let message = format!("the mass matrix is singular: nothing resists a change of {speed}");
            Guard { value, scale: Some(largest.get(row).copied().unwrap_or(scale)), message }
        };
        open.map(guard).collect()
    }

    /// Generalised forces in independent speeds for given derivatives of all speeds.
    fn reduced_forces(&mut self, derivatives: Vec<Expr>) -> Vec<Node> {
        let forces = forces::generalised_forces(self.k, &self.inertias, derivatives);
        let mut result = Vec::new();
        for &r in &self.independent.clone() {
            let mut sum = forces[r].clone();
            for &d in &self.dependent {
                sum = sum.add(&self.k.dependence(d, r).mul(&forces[d]));
            }
            result.push(sum);
        }
        self.nodes(&result)
    }

    /// Derivatives of all speeds if those of the independent ones vanish.
    fn bias(&self) -> Vec<Expr> {
        let of = |slot| self.k.dependent_bias.get(&slot).cloned().unwrap_or_else(Expr::zero);
        (0..self.k.speeds.len()).map(of).collect()
    }

    /// The parts of accelerations that depend on speeds alone, relation by relation.
    fn apart(&mut self) -> Accelerations {
        let ground = forces::ground(self.k);
        Accelerations::apart(self.k.speeds.len(), ground)
    }

    /// Sets up articulated inertias for all forces of the mechanism and its contacts, if the mechanism allows
    /// it; returns the forces.
    fn articulate(&mut self, contacts: &[ContactForms]) -> Wrenches {
        let mut apart = self.apart();
        let inertias = base_parameters::lumped_inertias(self.k, Masses::InBody);
        let acting = forces::wrenches(self.k, &inertias, &mut apart);
        let all = || contacts.iter().flat_map(|forms| forms.forces.iter().flatten()).chain([&acting]);
        let points = all().flat_map(|wrenches| wrenches.forces.keys().copied()).collect();
        let frames = all().flat_map(|wrenches| wrenches.torques.keys().copied()).collect();
        self.articulated = Articulated::new(self.k, &inertias, points, frames);
        acting
    }

    /// Adds guards for the articulated inertias that are used.
    fn guard_articulated(&mut self, articulated: &Articulated) {
        for (pivot, slot) in articulated.pivots() {
            let value = self.node(&pivot);
            if self.graph.as_number(value).is_none() && !self.guards.iter().any(|guard| guard.value == value)
            {
                let speed = &self.k.mechanism.speeds[slot].name;
                let message = format!("the mass matrix is singular: nothing resists a change of {speed}");
                let row = self.independent.iter().position(|&independent| independent == slot);
                let scale = row.and_then(|row| self.largest.get(row).copied());
                self.guards.push(Guard { value, scale, message });
            }
        }
    }

    /// Accelerations of the independent speeds by articulated inertias.
    fn accelerations(&mut self, articulated: &Articulated, acting: Wrenches) -> Option<Vec<Node>> {
        let mut apart = self.apart();
        let loads = articulated.inwards(self.k, acting, Some(&mut apart))?;
        let accelerations = articulated.outwards(self.k, &loads, Some(&mut apart));
        Some(self.nodes(&accelerations))
    }

    fn dynamics(&mut self, factor: &Factor, acting: Wrenches) {
        let at_rest = self.bias();
        let forcing = self.reduced_forces(at_rest.clone());
        self.put(Quantity::Forcing, forcing.len(), 1, forcing.clone());

        let half = factor.half_solve(&mut self.graph, &forcing);
        let mut accelerations = factor.finish(&mut self.graph, &half);
        if let Some(articulated) = self.articulated.take() {
            // Even if it takes more operations: the factorised mass matrix loses digits if outer joints yield
            // to inner ones.
            if let Some(nodes) = self.accelerations(&articulated, acting) {
                accelerations = nodes;
                self.guard_articulated(&articulated);
            }
            self.articulated = Some(articulated);
        }
        self.put(Quantity::Accelerations, accelerations.len(), 1, accelerations.clone());
        let mut dependent = Vec::new();
        for &d in &self.dependent.clone() {
            let mut terms = vec![self.node(&at_rest[d])];
            for (i, &r) in self.independent.clone().iter().enumerate() {
                let by = self.k.dependence(d, r);
                let by = self.node(&by);
                terms.push(self.graph.product([by, accelerations[i]]));
            }
            dependent.push(self.graph.sum(terms));
        }
        self.put(Quantity::DependentAccelerations, dependent.len(), 1, dependent);

        // The same forces for given accelerations, with the opposite sign.
        let given: Vec<Expr> =
            (0..self.independent.len()).map(|i| self.k.z.input(Input::Acceleration(i as u32))).collect();
        let mut derivatives = at_rest;
        for (i, &slot) in self.independent.iter().enumerate() {
            derivatives[slot] = given[i].clone();
        }
        for &slot in &self.dependent {
            let mut sum = derivatives[slot].clone();
            for (i, &r) in self.independent.iter().enumerate() {
                sum = sum.add(&self.k.dependence(slot, r).mul(&given[i]));
            }
            derivatives[slot] = self.k.z.name(sum);
        }
        let forces = self.reduced_forces(derivatives);
        let required = forces.into_iter().map(|force| self.graph.neg(force)).collect::<Vec<_>>();
        self.put(Quantity::InverseDynamics, required.len(), 1, required);
    }

    /// A direction in the independent states and inputs: the derivative of each input along it. `None` if
    /// dependent coordinates cannot be determined.
    fn direction(&mut self) -> Option<HashMap<Input, Node>> {
        let mechanism = self.k.mechanism;
        let followers = self.dependent_coordinate_rates()?;
        let mut rates = HashMap::new();
        let mut number = 0;
        let mut next = |writer: &mut Self| {
            number += 1;
            writer.graph.input(Input::Tangent(number - 1))
        };
        for (i, coordinate) in mechanism.coordinates.iter().enumerate() {
            if !coordinate.dependent {
                let node = next(self);
                rates.insert(Input::Coordinate(i as u32), node);
            }
        }
        for i in 0..self.independent.len() {
            let node = next(self);
            rates.insert(Input::Speed(i as u32), node);
        }
        for i in 0..mechanism.inputs.len() {
            let node = next(self);
            rates.insert(Input::Input(i as u32), node);
        }
        for (coordinate, form) in followers {
            let (mut terms, mut leaders) = (Vec::new(), Vec::new());
            for (leader, coefficient) in form.terms {
                let coefficient = self.node(&coefficient);
                let leader = Input::Coordinate(leader as u32);
                leaders.push((leader, coefficient));
                terms.push(self.graph.product([coefficient, rates[&leader]]));
            }
            self.followers.push((Input::Coordinate(coordinate as u32), leaders));
            let sum = self.graph.sum(terms);
            rates.insert(Input::Coordinate(coordinate as u32), sum);
        }
        Some(rates)
    }

    /// The derivative of all rates along a direction.
    fn linearisation(&mut self, rates: &Option<HashMap<Input, Node>>) {
        let mechanism = self.k.mechanism;
        let Some(rates) = rates else { return };
        let found = |quantity| self.outputs.iter().find(move |output| output.quantity == quantity);
        let (Some(of_coordinates), Some(of_speeds)) =
            (found(Quantity::CoordinateRates), found(Quantity::Accelerations))
        else {
            return;
        };
        let independent = of_coordinates.values.iter().zip(&mechanism.coordinates);
        let mut nodes: Vec<Node> =
            independent.filter(|(_, coordinate)| !coordinate.dependent).map(|(&node, _)| node).collect();
        nodes.extend(&of_speeds.values);
        let tangent = differentiate(&mut self.graph, &nodes, rates);
        self.put(Quantity::StateTangent, tangent.len(), 1, tangent);
    }

    /// Derivatives of dependent coordinates with respect to independent ones, as forms in the indices of
    /// coordinates. `None` if the configuration equations cannot be solved for them.
    fn dependent_coordinate_rates(&mut self) -> Option<BTreeMap<usize, LinearScalar>> {
        let mechanism = self.k.mechanism;
        let dependent: Vec<usize> =
            (0..mechanism.coordinates.len()).filter(|&i| mechanism.coordinates[i].dependent).collect();
        let mut equations = Vec::new();
        for equation in &mechanism.configuration {
            for residual in self.k.equation_forms(&equation.sides) {
                let mut form = LinearScalar::constant(Expr::zero());
                for i in 0..mechanism.coordinates.len() {
                    let mut along = Direction::along(self.k.coordinates[i]);
                    let partial = self.k.z.differentiate(&residual.rest, &mut along);
                    form = form.add(&LinearScalar::unknown(i).scale(&self.k.z.name(partial)));
                }
                equations.push(form);
            }
        }
        let solver = Solver::new(&mut self.k.z, &mut self.k.samples, &equations, &dependent).ok()?;
        let z = &mut self.k.z;
        let solved = solver.solve(&equations, |c| z.name(c));
        let forms: Vec<(String, LinearScalar)> =
            solved.iter().map(|(&i, form)| (mechanism.coordinates[i].name.clone(), form.clone())).collect();
        for determinant in &solver.determinants {
            self.k.guard_determinant(determinant, &forms, |names| {
                format!("the configuration equations cannot be solved for {names}")
            });
        }
        Some(solved)
    }

    fn energies(&mut self) {
        let kinetic = energy::kinetic_energy(self.k);
        let nodes = self.nodes([&kinetic]);
        self.put(Quantity::KineticEnergy, 1, 1, nodes);
        if let Some(potential) = energy::potential_energy(self.k) {
            let nodes = self.nodes([&potential]);
            self.put(Quantity::PotentialEnergy, 1, 1, nodes);
        }
    }

    /// Momenta, and position and velocity of the mass centre, as a separate derivation; the angular momentum about
    /// the mass centre, which is formed of other vectors, as one more.
    fn momenta(&mut self, samples: &[Inputs]) -> Vec<Derived> {
        let before = self.k.guards.len();
        let all = momentum::momenta(self.k);
        let all = self.separate(all, before, samples);
        let central = momentum::central_angular_momentum(self.k);
        let central = central.map(|spin| (Quantity::CentralAngularMomentum, spin));
        let central = self.separate(central, before, samples);
        all.into_iter().chain(central).collect()
    }

    /// A separate derivation of some vectors, with the guards that came after so many others; `None` of none.
    fn separate(
        &mut self,
        vectors: impl IntoIterator<Item = (Quantity, Triple)>,
        before: usize,
        samples: &[Inputs],
    ) -> Option<Derived> {
        for (quantity, components) in vectors {
            let nodes = self.nodes(&components);
            self.put(quantity, 3, 1, nodes);
        }
        let others = self.guards.len();
        let added: Vec<GuardedValue> = self.k.guards.iter().skip(before).cloned().collect();
        for guard in added {
            self.guard(guard);
        }
        let outputs = self.outputs.split_off(0);
        let guards = self.guards.clone();
        self.guards.truncate(others);
        (!outputs.is_empty()).then(|| Derived {
            graph: self.graph.clone(),
            outputs,
            guards,
            structures: Vec::new(),
            samples: samples.to_vec(),
            apart: Vec::new(),
            solve: None,
        })
    }

    fn configuration(&mut self) {
        let mut residuals = Vec::new();
        for equation in &self.k.mechanism.configuration {
            for form in self.k.equation_forms(&equation.sides) {
                residuals.push(form.rest);
            }
        }
        let dependent: Vec<usize> = (0..self.k.mechanism.coordinates.len())
            .filter(|&i| self.k.mechanism.coordinates[i].dependent)
            .collect();
        let mut jacobian = Vec::new();
        for residual in &residuals {
            for &i in &dependent {
                let symbol = self.k.coordinates[i];
                jacobian.push(self.k.z.differentiate(residual, &mut Direction::along(symbol)));
            }
        }
        let rows = residuals.len();
        let nodes = self.nodes(&residuals);
        self.put(Quantity::ConfigurationResidual, rows, 1, nodes);
        let nodes = self.nodes(&jacobian);
        self.put(Quantity::ConfigurationJacobian, rows, dependent.len(), nodes);
    }

    fn guards(&mut self) {
        for guard in self.k.guards.clone() {
            self.guard(guard);
        }
    }

    fn guard(&mut self, guard: GuardedValue) {
        let value = self.node(&guard.value);
        let scale = Some(self.node(&guard.scale));
        if self.graph.as_number(value).is_none() {
            self.guards.push(Guard { value, scale, message: guard.message });
        }
    }
}
