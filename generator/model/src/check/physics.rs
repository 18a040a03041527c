//! The checks that evaluate the mechanism at several arbitrary states near its initial values. What is wrong
//! at all of them is a mistake of the model; what is wrong at one may be a singular state, which is none.

use super::exact::{divisors, enclosures};
use super::states::Seen;
use super::{
    bodies, body_points, by_values, centres, configuration, contacts, coupled, empty_equations, finite, gaps,
    hollows, independent_constraints, loads, loops, motion, shapes, states, unit_vectors, vector_constraints,
};
use crate::diagnostics::{Diagnostic, codes};
use crate::model::Readable;
use crate::model::mechanism::{Equation, Mechanism, ShapeId};
use crate::numeric::{self, Failure, State, Views};
use crate::span::Span;

/// What is said where no part alone is not finite, but masses times lengths are.
const NOT_FINITE: &str = "masses times lengths are not finite at any state that was tried";
const IN_RANGE: &str =
    "give masses, lengths and forces in other units, or check their exponents: numbers end at 1.8e308";
/// Mechanisms of more parts than this are not looked at: it would take too long.
pub const MOST_PARTS: usize = 8000;

/// What shows in numbers.
#[derive(Default)]
pub struct Found {
    /// mistakes
    pub mistakes: Vec<Diagnostic>,
    /// gravity and springs whose force is not minus the gradient of their energy
    pub without_potential: Vec<usize>,
}

/// What numbers show of what could be read of the mechanism; `name` is where it is named.
pub fn physics(m: &Mechanism, readable: &Readable, name: Span) -> Found {
    let parts = parts(m);
    if parts > MOST_PARTS {
        let message = format!("a mechanism of {parts} parts is too large for numerical checks");
        let help = format!(
            "mistakes that only evaluation shows (impossible inertias, singular constraints, normals that are not unit vectors) are not \
             found in more than {MOST_PARTS} points, frames, definitions, bodies and contacts"
        );
        let mistakes = vec![Diagnostic::new(codes::UNCHECKED, name, message).help(help)];
        return Found { mistakes, ..Found::default() };
    }
    with_room(|| {
        let mut without_potential = Vec::new();
        let mistakes = look(m, readable, name, &mut without_potential);
        Found { mistakes, without_potential }
    })
}

/// Equations that say nothing.
pub fn empty_equations(m: &Mechanism) -> Vec<Diagnostic> {
    if parts(m) > MOST_PARTS {
        return Vec::new();
    }
    with_room(|| empty_equations::empty_equations(m))
}

/// The velocity constraints that determine the dependent speeds, where more are stated than are needed.
pub fn determining_constraints(m: &Mechanism, readable: &Readable) -> Option<Vec<Equation>> {
    if !readable.is_whole() || parts(m) > MOST_PARTS {
        return None;
    }
    with_room(|| independent_constraints::determining(m))
}

fn parts(m: &Mechanism) -> usize {
    m.points.len() + m.frames.len() + m.definitions.len() + m.bodies.len() + m.contacts.len()
}

/// Runs deeply recursive work on a thread with a large stack; a panic there gives the default value. A module of
/// WebAssembly has no threads: it gets its stack when it is linked, and a panic ends it.
pub(super) fn with_room<T: Default + Send>(look: impl FnOnce() -> T + Send) -> T {
    if cfg!(target_family = "wasm") {
        return look();
    }
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(64 << 20).spawn_scoped(scope, look);
        match thread.map(|thread| thread.join()) {
            Ok(Ok(found)) => found,
            // tests and the fuzzer must see a panic; a user's build must go on
            Ok(Err(panic)) if cfg!(debug_assertions) => std::panic::resume_unwind(panic),
            Ok(Err(_)) | Err(_) => T::default(),
        }
    })
}

fn look(
    m: &Mechanism,
    readable: &Readable,
    name: Span,
    without_potential: &mut Vec<usize>,
) -> Vec<Diagnostic> {
    if let Some(rest) = without_unread_contacts(m, readable) {
        let readable = Readable { contacts: vec![true; rest.contacts.len()], ..readable.clone() };
        return look(&rest, &readable, name, without_potential);
    }
    let arbitrary = states::arbitrary(m);
    let stated = |list: &[State], dependent| -> Vec<State> {
        list.iter().map(|state| states::stated(m, state, dependent)).collect()
    };
    // what holds whatever the dependent coordinates are
    let alone = stated(&arbitrary, false);
    let mut out = unit_vectors::unit_vectors(m, readable, &alone);
    // without proper axes nothing turns as it should
    let upright = out.is_empty();
    let initial = alone.last().map_or(Vec::new(), |state| bodies::bodies(m, state, readable, upright));
    out.extend(initial);
    if !upright || !readable.motion {
        out.extend(unit_vectors::normals(m, &alone));
        return out;
    }
    if !readable.is_whole() {
        // how it moves does not depend on what has mass
        out.extend(motion_alone(&without_unread_bodies(m, readable), name));
        out.extend(unit_vectors::normals(m, &alone));
        return out;
    }
    let sound = out.is_empty();
    if let Some(found) = configuration::undetermined(m, &arbitrary) {
        out.push(found);
        out.extend(unit_vectors::normals(m, &alone));
        return out;
    }
    let closed = Closed::of(m, arbitrary);
    let (seen, failures) = closed.seen(m);
    // a force that is defined for some values only may be so far from the initial ones
    let singular = seen.is_empty() && failures.iter().all(|(_, _, failure)| *failure == numeric::SINGULAR);
    let far = Closed::of(m, if singular { states::far(m) } else { Vec::new() });
    let (seen, failures) = match far.seen(m).0 {
        found if found.is_empty() || not_finite(m, &failures, &far).is_some() => (seen, failures),
        found => (found, Vec::new()),
    };
    // or soon after the start only
    let early = Closed::of(m, if seen.is_empty() { states::early(m) } else { Vec::new() });
    let (seen, failures) = match early.seen(m).0 {
        found if found.is_empty() => (seen, failures),
        found => (found, Vec::new()),
    };
    if seen.is_empty() {
        out.extend(undetermined(m).or_else(|| nowhere(m, &failures, name)));
        out.extend(unit_vectors::normals(m, &alone));
        return out;
    }
    let of_shapes = shapes::shapes(m, alone.last(), &seen);
    if let Some(rest) = without_contacts_of(m, &of_shapes) {
        let readable = Readable { contacts: vec![true; rest.contacts.len()], ..readable.clone() };
        let rest = look(&rest, &readable, name, without_potential);
        return of_shapes.into_iter().map(|(_, found)| found).chain(rest).collect();
    }
    // numbers show such a divisor as rounding
    if sound && let Some(found) = divisors::vanishing(m) {
        out.push(found);
        return out;
    }
    let views: Vec<&Views<'_>> = seen.iter().map(|seen| &seen.views).collect();
    if finite::never_finite(m, &views, &[]).is_some() {
        let (far, early) = (Closed::of(m, states::far(m)), Closed::of(m, states::early(m)));
        let early = early.views(m);
        let views: Vec<&Views<'_>> = views.iter().copied().chain(&early).collect();
        if let Some(found) = finite::never_finite(m, &views, &far.views(m)) {
            out.push(found);
            return out;
        }
    }
    let met: Vec<State> = seen.iter().map(|seen| seen.state.clone()).collect();
    out.extend(unit_vectors::normals(m, &stated(&met, true)));
    if let Some(found) = contradiction(m, &failures) {
        out.push(found);
        return out;
    }
    if sound {
        out.extend(motion::changing_inertias(m, &seen));
        out.extend(motion::inertia_of_speeds(m, &seen));
    }
    out.extend(body_points::strangers(m, &seen));
    let of_centres = centres::centres(m, &seen, &out);
    out.extend(of_centres);
    // where inertias turn in their frames, a wrong angle is the cause mostly, which is told there
    if !out.iter().any(|found| found.code == codes::INERTIA && sound) {
        out.extend(of_the_motion(m, &seen));
    }
    let of_contacts = contacts::contacts(m, &seen, &out);
    out.extend(of_contacts);
    // the following checks rely on the stated velocities
    let of_one_part = [codes::MASS, codes::INERTIA, codes::NORMAL, codes::CONTACT, codes::CONTACT_STILL];
    if !out.iter().any(|found| found.hides_meaning() && !of_one_part.contains(&found.code)) {
        out.extend(gaps::gaps(m, &seen, &out));
        out.extend(loads::loads(m, &seen));
        *without_potential = loads::without_potential(m, &seen);
        out.extend(loops::open_at_the_start(m));
        let flawless = !out.iter().any(Diagnostic::hides_meaning);
        out.extend(finite::at_the_start(m, flawless));
        out.extend(hollows::narrow(m));
        if flawless {
            out.extend(by_values::by_values(m, &met));
        }
    }
    out
}

/// The states at which loops are closed, with their numbers among those that were tried, and why there are
/// none at others.
struct Closed {
    states: Vec<(usize, State)>,
    failures: Vec<Failed>,
}

/// The number of a state, the state, and why there are no numbers there.
type Failed = (usize, State, Failure);

impl Closed {
    fn of(m: &Mechanism, arbitrary: Vec<State>) -> Self {
        let mut closed = Closed { states: Vec::new(), failures: Vec::new() };
        for (i, mut state) in arbitrary.into_iter().enumerate() {
            match numeric::assemble(m, &mut state) {
                Ok(()) => closed.states.push((i, state)),
                Err(failure) => closed.failures.push((i, state, failure)),
            }
        }
        closed
    }

    /// The views of its states, where they have any.
    fn views<'m>(&'m self, m: &'m Mechanism) -> Vec<Views<'m>> {
        self.states.iter().filter_map(|(_, state)| Views::at(m, state).ok()).collect()
    }

    fn seen<'m>(&'m self, m: &'m Mechanism) -> (Vec<Seen<'m>>, Vec<Failed>) {
        let (mut seen, mut failures) = (Vec::new(), self.failures.clone());
        for (i, state) in &self.states {
            let numbers =
                Views::at(m, state).and_then(|views| Ok((numeric::evaluate_views(m, &views)?, views)));
            match numbers {
                Ok((at, views)) => seen.push(Seen { number: *i, state, at, views }),
                Err(failure) => failures.push((*i, state.clone(), failure)),
            }
        }
        (seen, failures)
    }
}

/// What is finite neither at the states that failed nor at others.
fn not_finite(m: &Mechanism, failures: &[Failed], far: &Closed) -> Option<Diagnostic> {
    let early = Closed::of(m, states::early(m));
    let near = failures.iter().filter_map(|(_, state, _)| Views::at(m, state).ok());
    let near: Vec<Views<'_>> = near.chain(early.views(m)).collect();
    finite::never_finite(m, &near.iter().collect::<Vec<_>>(), &far.views(m))
}

/// What shows at open loops too, where they cannot be closed: equations that determine too little.
fn undetermined(m: &Mechanism) -> Option<Diagnostic> {
    let states = states::arbitrary(m).into_iter().enumerate().collect();
    let open = Closed { states, failures: Vec::new() };
    let (seen, failures) = open.seen(m);
    let too_little =
        |f: &Failure| matches!(f, Failure::RatesUndetermined(_) | Failure::SpeedsUndetermined(_));
    let (_, state, failure) = failures.iter().find(|(_, _, failure)| too_little(failure))?;
    if seen.is_empty() { motion::nowhere(m, state, failure) } else { None }
}

/// What is wrong with the motion of a mechanism of whose bodies and contacts nothing is said.
fn motion_alone(m: &Mechanism, name: Span) -> Vec<Diagnostic> {
    let closed = Closed::of(m, states::arbitrary(m));
    let (seen, failures) = closed.seen(m);
    let failed = if seen.is_empty() { nowhere(m, &failures, name) } else { contradiction(m, &failures) };
    failed.map_or_else(|| of_the_motion(m, &seen), |failed| vec![failed])
}

/// Constraints that repeat others, and configuration equations that they do not keep.
fn of_the_motion(m: &Mechanism, seen: &[Seen<'_>]) -> Vec<Diagnostic> {
    let mut out = vector_constraints::inseparable(m, seen);
    if out.is_empty() {
        out.extend(vector_constraints::repeated(m, seen));
        out.extend(coupled::too_many_at_once(m, seen));
        out.extend(configuration::not_kept(m, seen));
    }
    out
}

/// A contradiction that does not show at every state: where a coordinate is 0, for instance, what contradicts
/// may agree. One state alone may be near a singular one.
fn contradiction(m: &Mechanism, failures: &[Failed]) -> Option<Diagnostic> {
    // far from the start loops may close in another way, which constraints need not fit
    let shows = |(i, _, failure): &&Failed| match failure {
        Failure::MotionInconsistent(..) => true,
        Failure::ConstraintsInconsistent(_) => m.configuration.is_empty() || *i >= states::NEAR,
        _ => false,
    };
    let mut shown = failures.iter().filter(shows);
    let (_, state, failure) = shown.next()?;
    shown.next()?;
    motion::nowhere(m, state, failure)
}

/// The mechanism without bodies that could not be read, and without contacts, which refer to bodies.
fn without_unread_bodies(m: &Mechanism, readable: &Readable) -> Mechanism {
    let mut rest = m.clone();
    let mut at = readable.bodies.iter();
    rest.bodies.retain(|_| at.next().copied().unwrap_or(false));
    rest.contacts.clear();
    rest
}

/// The mechanism with the contacts that could be read, if there are others: nothing rests on a contact.
fn without_unread_contacts(m: &Mechanism, readable: &Readable) -> Option<Mechanism> {
    if readable.contacts.iter().all(|readable| *readable) {
        return None;
    }
    let mut rest = m.clone();
    let mut at = readable.contacts.iter();
    rest.contacts.retain(|_| at.next().copied().unwrap_or(false));
    Some(rest)
}

/// The mechanism without the shapes in which something is wrong and their contacts, if there are any.
fn without_contacts_of(m: &Mechanism, wrong: &[(ShapeId, Diagnostic)]) -> Option<Mechanism> {
    if wrong.is_empty() {
        return None;
    }
    let mut rest = m.clone();
    let has = |shapes: [ShapeId; 2]| wrong.iter().any(|(id, _)| shapes.contains(id));
    rest.contacts.retain(|contact| !contact.shapes.is_some_and(has));
    rest.contacts.iter_mut().for_each(|contact| contact.shapes = None);
    rest.shapes.clear();
    Some(rest)
}

/// What is said where the mechanism has no numbers at any state.
fn nowhere(m: &Mechanism, failures: &[Failed], name: Span) -> Option<Diagnostic> {
    // the first state is the most general one
    if let Some((_, state, failure)) = failures.iter().find(|(_, _, f)| !matches!(f, Failure::NotClosed(_))) {
        return motion::nowhere(m, state, failure).or_else(|| {
            let singular = *failure == numeric::SINGULAR;
            let span = m.bodies.first().map_or(name, |body| body.span);
            let all = || Diagnostic::new(codes::NUMBER_RANGE, span, NOT_FINITE).help(IN_RANGE);
            not_finite(m, failures, &Closed::of(m, states::far(m))).or_else(|| singular.then(all))
        });
    }
    if let Some(found) = enclosures::unsolvable(m) {
        return Some(found);
    }
    let message = "the configuration equations have no solution near the values of the model";
    let span = m.configuration.first().map_or(Span::default(), |equation| equation.span);
    let help = "check the lengths, and the guesses of the dependent coordinates; until they fit, what shows in numbers is not looked at";
    Some(Diagnostic::new(codes::NOT_CLOSED, span, message).help(help))
}
