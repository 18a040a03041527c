//! Planar bodies written by hand, for tests of the simulation.

pub mod counted;

use hodograph::generated::{
    Contact, Resolved, closed_contact, kept_contact, resolve, resolve_without_collision, slip_noise,
};
use hodograph::{
    Budgeted, ClosedContactError, CollisionError, CollisionOutcome, Component, ComponentKind, ContactMode,
    ContactOutcome, ContactState, Contacts, ImpactError, Law, Mechanism, ParameterError, ReducedMatrix,
    State, StateError, Surface,
};
use hodograph_simulation::{Event, EventKind, Options, Progress, Simulation};
use nalgebra::{Matrix3, Vector3};

/// What may touch a line: a point of the body, or the rim of a wheel about the mass centre.
#[derive(Clone, Copy, Debug)]
pub enum Part {
    Point(f64, f64),
    Rim(f64),
}

/// A contact with the line normal . p = offset; the normal is (sin, cos) of its tilt against z, so that tilt
/// 0 is the floor.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub part: Part,
    pub tilt: f64,
    pub offset: f64,
    /// speed of the line along its tangent
    pub belt: f64,
}

impl Line {
    pub fn floor(part: Part) -> Self {
        Self { part, tilt: 0.0, offset: 0.0, belt: 0.0 }
    }
}

/// A rigid body in the plane x, z with coordinates x, z, theta (from x towards z) and their rates as speeds.
#[derive(Clone, Debug)]
pub struct Body {
    pub mass: f64,
    pub inertia: f64,
    pub gravity: [f64; 2],
    /// stiffness of a spring along x to the origin, and a force along x
    pub spring: f64,
    pub lines: Vec<Line>,
}

impl Body {
    pub fn new(mass: f64, inertia: f64, lines: &[Line]) -> Self {
        Self { mass, inertia, gravity: [0.0, -9.81], spring: 0.0, lines: lines.to_vec() }
    }

    /// Normal and tangent as (x, z).
    fn axes(&self, contact: usize) -> ([f64; 2], [f64; 2]) {
        let (s, c) = self.lines[contact].tilt.sin_cos();
        ([s, c], [c, -s])
    }

    /// From the mass centre to the touching point, and whether it turns with the body.
    fn arm(&self, contact: usize, theta: f64) -> ([f64; 2], bool) {
        let (s, c) = theta.sin_cos();
        let (n, _) = self.axes(contact);
        match self.lines[contact].part {
            Part::Point(a, b) => ([a * c - b * s, a * s + b * c], true),
            Part::Rim(r) => ([-r * n[0], -r * n[1]], false),
        }
    }

    /// Rows n, t of V; the third is zero.
    fn rows(&self, contact: usize, q: &[f64]) -> [[f64; 3]; 2] {
        let (arm, _) = self.arm(contact, q[2]);
        let (n, t) = self.axes(contact);
        let row = |d: [f64; 2]| [d[0], d[1], d[1] * arm[0] - d[0] * arm[1]];
        [row(n), row(t)]
    }

    fn free(&self, q: &[f64], inputs: &[f64]) -> [f64; 3] {
        let force = inputs.first().copied().unwrap_or(0.0);
        [self.gravity[0] + (force - self.spring * q[0]) / self.mass, self.gravity[1], 0.0]
    }

    fn inverse(&self) -> [f64; 3] {
        [1.0 / self.mass, 1.0 / self.mass, 1.0 / self.inertia]
    }

    /// A contact as the solver takes it.
    fn touch(&self, contact: usize, state: &State<'_>) -> Result<Contact<f64>, StateError> {
        let ContactState { normal, first, second, velocity, reduced, .. } =
            self.contact_state(contact, state)?;
        let remainder = Vector3::new(0.0, -self.lines[contact].belt, 0.0);
        let prescribed_work = Vector3::zeros();
        Ok(Contact { normal, first, second, velocity, reduced, remainder, prescribed_work })
    }

    /// Adds M^-1 V^T times a force or an impulse.
    fn respond(
        &self,
        contact: usize,
        state: &State<'_>,
        load: &Vector3<f64>,
        to: &mut [f64],
    ) -> Result<(), StateError> {
        let mut response = [0.0; 9];
        self.response(contact, state, &mut response)?;
        for (rate, row) in to.iter_mut().zip(response.chunks(3)) {
            *rate += row[0] * load.x + row[1] * load.y;
        }
        Ok(())
    }

    /// A closed contact whose force `decide` finds.
    fn closed(
        &self,
        contact: usize,
        state: &State<'_>,
        accelerations: &mut [f64],
        decide: impl FnOnce(&Contact<f64>, &Vector3<f64>) -> Result<ContactOutcome<f64>, ClosedContactError<f64>>,
    ) -> Result<ContactOutcome<f64>, ClosedContactError<f64>> {
        let outcome = decide(&self.touch(contact, state)?, &self.free_acceleration(contact, state)?)?;
        self.accelerations(state, accelerations)?;
        self.respond(contact, state, &outcome.answer.force, accelerations)?;
        Ok(outcome)
    }

    /// An impact that `resolve` solves, and the speeds after it.
    fn struck(
        &self,
        contact: usize,
        state: &State<'_>,
        speeds: &mut [f64],
        resolve: impl FnOnce(&Contact<f64>) -> Result<Resolved<f64>, ImpactError<f64>>,
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        let touch = self.touch(contact, state)?;
        let hit = resolve(&touch)?;
        speeds.copy_from_slice(state.speeds);
        self.respond(contact, state, &hit.impulse, speeds)?;
        Ok(CollisionOutcome {
            normal: touch.normal,
            tangent: hit.tangent,
            binormal: hit.binormal,
            approach: hit.approach,
            reduced: hit.reduced,
            impulse_on_point: hit.impulse_on_point,
            energy_change: hit.energy_change,
            impact: hit.impact,
        })
    }
}

fn fill(to: &mut [f64], from: &[f64]) -> Result<(), StateError> {
    to.copy_from_slice(from);
    Ok(())
}

impl Mechanism<f64> for Body {
    fn name(&self) -> &str {
        "Body"
    }
    fn count(&self, kind: ComponentKind) -> usize {
        match kind {
            ComponentKind::Coordinate | ComponentKind::Speed => 3,
            ComponentKind::Input => 1,
            ComponentKind::Contact => self.lines.len(),
            _ => 0,
        }
    }
    fn component(&self, kind: ComponentKind, index: usize) -> Option<Component<'_>> {
        let names: &[&str] = match kind {
            ComponentKind::Coordinate => &["x", "z", "theta"],
            ComponentKind::Speed => &["vx", "vz", "omega"],
            ComponentKind::Input => &["F"],
            ComponentKind::Contact => &["c0", "c1", "c2", "c3"],
            _ => &[],
        };
        let units: &[&str] = match kind {
            ComponentKind::Coordinate => &["m", "m", "rad"],
            ComponentKind::Speed => &["m/s", "m/s", "rad/s"],
            ComponentKind::Input => &["N"],
            _ => &["1"; 4],
        };
        (index < self.count(kind)).then(|| Component { name: names[index], unit: units[index] })
    }
    fn dependent_coordinate(&self, _: usize) -> Option<usize> {
        None
    }
    fn parameter_values(&self, _: &mut [f64]) -> Result<(), StateError> {
        Ok(())
    }
    fn set_parameter_values(&mut self, _: &[f64]) -> Result<(), ParameterError> {
        Ok(())
    }
    fn initial_state(&self, q: &mut [f64], u: &mut [f64], inputs: &mut [f64]) -> Result<(), StateError> {
        q.fill(0.0);
        u.fill(0.0);
        inputs.fill(0.0);
        Ok(())
    }
    fn normalise(&self, _: &mut [f64]) -> Result<(), StateError> {
        Ok(())
    }
    fn coordinate_rates(&self, state: &State<'_>, rates: &mut [f64]) -> Result<(), StateError> {
        fill(rates, state.speeds)
    }
    fn accelerations(&self, state: &State<'_>, accelerations: &mut [f64]) -> Result<(), StateError> {
        fill(accelerations, &self.free(state.coordinates, state.inputs))
    }
    fn dependent_speeds(&self, _: &State<'_>, _: &mut [f64]) -> Result<(), StateError> {
        Ok(())
    }
    fn dependent_accelerations(&self, _: &State<'_>, _: &mut [f64]) -> Result<(), StateError> {
        Ok(())
    }
    fn mass_matrix(&self, _: &State<'_>, matrix: &mut [f64]) -> Result<(), StateError> {
        let (m, j) = (self.mass, self.inertia);
        fill(matrix, &[m, 0.0, 0.0, 0.0, m, 0.0, 0.0, 0.0, j])
    }
    fn forcing(&self, state: &State<'_>, forcing: &mut [f64]) -> Result<(), StateError> {
        let free = self.free(state.coordinates, state.inputs);
        fill(forcing, &[free[0] * self.mass, free[1] * self.mass, free[2] * self.inertia])
    }
    fn inverse_dynamics(&self, _: &State<'_>, _: &[f64], _: &mut [f64]) -> Result<(), StateError> {
        Ok(())
    }
    fn kinetic_energy(&self, state: &State<'_>) -> Result<f64, StateError> {
        let u = state.speeds;
        Ok(0.5 * self.mass * (u[0] * u[0] + u[1] * u[1]) + 0.5 * self.inertia * u[2] * u[2])
    }
    fn potential_energy(&self, state: &State<'_>) -> Result<Option<f64>, StateError> {
        let q = state.coordinates;
        let weight = -self.mass * (self.gravity[0] * q[0] + self.gravity[1] * q[1]);
        Ok(Some(weight + 0.5 * self.spring * q[0] * q[0]))
    }
    fn configuration(&self, _: &State<'_>, _: &mut [f64], _: &mut [f64]) -> Result<(), StateError> {
        Ok(())
    }
    fn position(&self, _: usize, _: &State<'_>) -> Result<Vector3<f64>, StateError> {
        Ok(Vector3::zeros())
    }
    fn velocity(&self, _: usize, _: &State<'_>) -> Result<Vector3<f64>, StateError> {
        Ok(Vector3::zeros())
    }
    fn acceleration(&self, _: usize, _: &State<'_>, _: &[f64]) -> Result<Vector3<f64>, StateError> {
        Ok(Vector3::zeros())
    }
    fn jacobian(&self, _: usize, _: &State<'_>, _: &mut [f64]) -> Result<(), StateError> {
        Ok(())
    }
    fn orientation(&self, _: usize, _: &State<'_>) -> Result<Matrix3<f64>, StateError> {
        Ok(Matrix3::identity())
    }
}

impl Contacts<f64> for Body {
    fn contact_state(&self, contact: usize, state: &State<'_>) -> Result<ContactState<f64>, StateError> {
        let [n, t] = self.rows(contact, state.coordinates);
        let inverse = self.inverse();
        let product = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|i| a[i] * b[i] * inverse[i]).sum::<f64>();
        let (normal, tangent) = self.axes(contact);
        let normal = Vector3::new(normal[0], 0.0, normal[1]);
        let first = Vector3::new(tangent[0], 0.0, tangent[1]);
        Ok(ContactState {
            gap: self.gap(contact, state)?,
            normal,
            first,
            second: normal.cross(&first),
            velocity: self.contact_velocity(contact, state)?,
            reduced: ReducedMatrix::new(product(&n, &n), product(&n, &t), 0.0, product(&t, &t), 0.0, 0.0),
        })
    }
    fn gap(&self, contact: usize, state: &State<'_>) -> Result<Option<f64>, StateError> {
        let q = state.coordinates;
        let (arm, _) = self.arm(contact, q[2]);
        let (n, _) = self.axes(contact);
        Ok(Some((q[0] + arm[0]) * n[0] + (q[1] + arm[1]) * n[1] - self.lines[contact].offset))
    }
    fn contact_velocity(&self, contact: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        let [n, t] = self.rows(contact, state.coordinates);
        let along = |row: [f64; 3]| (0..3).map(|i| row[i] * state.speeds[i]).sum::<f64>();
        Ok(Vector3::new(along(n), along(t) - self.lines[contact].belt, 0.0))
    }
    fn free_acceleration(&self, contact: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        let [n, t] = self.rows(contact, state.coordinates);
        let free = self.free(state.coordinates, state.inputs);
        let along = |row: [f64; 3]| (0..3).map(|i| row[i] * free[i]).sum::<f64>();
        let (arm, turns) = self.arm(contact, state.coordinates[2]);
        let (normal, tangent) = self.axes(contact);
        let square = if turns { state.speeds[2].powi(2) } else { 0.0 };
        let central = |d: [f64; 2]| -square * (d[0] * arm[0] + d[1] * arm[1]);
        Ok(Vector3::new(along(n) + central(normal), along(t) + central(tangent), 0.0))
    }
    fn partial_velocities(
        &self,
        contact: usize,
        state: &State<'_>,
        rows: &mut [f64],
    ) -> Result<(), StateError> {
        let [n, t] = self.rows(contact, state.coordinates);
        fill(rows, &[n[0], n[1], n[2], t[0], t[1], t[2], 0.0, 0.0, 0.0])
    }
    fn response(&self, contact: usize, state: &State<'_>, rows: &mut [f64]) -> Result<(), StateError> {
        let [n, t] = self.rows(contact, state.coordinates);
        let i = self.inverse();
        fill(
            rows,
            &[n[0] * i[0], t[0] * i[0], 0.0, n[1] * i[1], t[1] * i[1], 0.0, n[2] * i[2], t[2] * i[2], 0.0],
        )
    }
    fn collide(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Surface<f64>,
        speeds: &mut [f64],
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        self.struck(contact, state, speeds, |contact| resolve(contact, surface))
    }
    fn collide_with_budget(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Budgeted<f64>,
        speeds: &mut [f64],
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        self.struck(contact, state, speeds, |contact| resolve(contact, surface))
    }
    fn impact_without_collision(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Surface<f64>,
        speeds: &mut [f64],
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        self.struck(contact, state, speeds, |contact| resolve_without_collision(contact, surface))
    }
    fn contact_mode(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Surface<f64>,
        accelerations: &mut [f64],
    ) -> Result<ContactOutcome<f64>, ClosedContactError<f64>> {
        let mut partial = [0.0; 9];
        self.partial_velocities(contact, state, &mut partial)?;
        self.closed(contact, state, accelerations, |touch, free| {
            let noise = slip_noise(&partial, state.speeds, &touch.remainder);
            closed_contact(touch, free, noise, surface.mu)
        })
    }
    fn contact_force(
        &self,
        contact: usize,
        mode: ContactMode,
        state: &State<'_>,
        surface: &Surface<f64>,
        accelerations: &mut [f64],
    ) -> Result<ContactOutcome<f64>, ClosedContactError<f64>> {
        self.closed(contact, state, accelerations, |touch, free| kept_contact(mode, touch, free, surface.mu))
    }
}

/// Options with one surface for all contacts.
pub fn surface(mu: f64, e: f64, law: Law) -> Options {
    Options { surface: Some(Surface { mu, e, law }), ..Options::default() }
}

/// A simulation of a body from coordinates and speeds.
pub fn start<'a>(body: &'a dyn Contacts<f64>, q: &[f64], u: &[f64], options: Options) -> Simulation<'a> {
    let inputs = vec![0.0; body.count(ComponentKind::Input)];
    let state = State { time: 0.0, coordinates: q, speeds: u, inputs: &inputs };
    Simulation::new(body, &state, options).unwrap_or_else(|error| panic!("{error}"))
}

/// All events up to a time.
pub fn run(simulation: &mut Simulation<'_>, until: f64) -> Vec<Event> {
    let mut events = Vec::new();
    loop {
        match simulation.advance(until) {
            Ok(Progress::Event(event)) => events.push(event),
            Ok(Progress::Reached) => return events,
            Err(error) => panic!("{error} after {:?}", names(&events)),
        }
    }
}

/// What happened, in short.
pub fn names(events: &[Event]) -> Vec<String> {
    events
        .iter()
        .map(|event| format!("{} {:.9} {:?}", event.kind.name(), event.time, event.contact))
        .collect()
}

/// The first event of that name.
pub fn first<'a>(events: &'a [Event], name: &str) -> &'a Event {
    events
        .iter()
        .find(|event| event.kind.name() == name)
        .unwrap_or_else(|| panic!("no {name} in {:?}", names(events)))
}

/// Whether bodies collided, at one contact or at several at once.
fn collided(event: &Event) -> bool {
    matches!(event.kind, EventKind::Collision(_) | EventKind::SimultaneousCollision(_))
}

/// The first collision, and the speeds before it.
pub fn first_collision(events: &[Event]) -> (&Event, &[f64]) {
    let event = events
        .iter()
        .find(|event| collided(event))
        .unwrap_or_else(|| panic!("no collision in {:?}", names(events)));
    let before = match &event.kind {
        EventKind::Collision(struck) => &struck.speeds_before,
        EventKind::SimultaneousCollision(struck) => &struck.speeds_before,
        _ => unreachable!(),
    };
    (event, before)
}

/// Times of the collisions.
pub fn collisions(events: &[Event]) -> Vec<f64> {
    events.iter().filter(|event| collided(event)).map(|event| event.time).collect()
}
