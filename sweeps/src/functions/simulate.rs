//! `<model>_simulate`: the outcomes of motions, one for each row.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, BooleanArray, Float64Array, Int64Array, StringArray, StructArray};
use datafusion::arrow::datatypes::{DataType, Field, Fields};
use hodograph::{ComponentKind, Contacts as _, Law, Mechanism, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::motion::{GivenSurface, surfaces};
use hodograph_simulation::{
    Batch as Many, Case, ContactLaw, ErrorKind, GivenLaw, Options, Outcome, SimulationError, simulate_many,
};

use super::answers::NULL;
use super::batch::{Batch, Row};
use super::places::Place;

/// The numbers of an answer; a time without rest is NULL.
const NUMBERS: [&str; 8] =
    ["time", "rest", "energy", "kinetic", "potential", "friction_work", "impact_work", "input_work"];

fn names(mechanism: &InterpretedMechanism, kind: ComponentKind) -> Vec<&str> {
    let component = |index| Mechanism::component(mechanism, kind, index).map(|component| component.name);
    (0..Mechanism::count(mechanism, kind)).filter_map(component).collect()
}

/// The fields of the answer: `kind` is `rest`, `moving`, or the reason why the motion ended early; `closed`
/// are the names of the contacts that are closed at the end, joined by `+`.
pub fn fields(mechanism: &InterpretedMechanism) -> Fields {
    let mut all = vec![Field::new("kind", DataType::Utf8, false), Field::new("closed", DataType::Utf8, true)];
    all.extend(NUMBERS.map(|name| Field::new(name, DataType::Float64, true)));
    all.extend(["collisions", "events"].map(|name| Field::new(name, DataType::Int64, true)));
    all.push(Field::new("several_modes", DataType::Boolean, true));
    for kind in [ComponentKind::Coordinate, ComponentKind::Speed] {
        let end = |name: &str| Field::new(format!("end_{name}"), DataType::Float64, true);
        all.extend(names(mechanism, kind).into_iter().map(end));
    }
    all.into()
}

/// An answer, or the reason why there is none.
type Answer = Result<Outcome, &'static str>;

/// The motions of a batch, one after the other: the engine has a batch for each core.
pub fn simulate(
    mechanism: &InterpretedMechanism,
    batch: &Batch,
    defaults: &[Vec<f64>; 4],
    fields: Fields,
) -> ArrayRef {
    let table = batch.table(defaults);
    let mut machine = mechanism.clone();
    let mut state = Row::new(defaults);
    let mut answers: Vec<Answer> = Vec::with_capacity(batch.rows);
    for (range, parameters) in batch.stretches(&defaults[3]) {
        let refused = machine.set_parameter_values(&parameters).err().map(|error| error.kind());
        for row in range {
            answers.push(match refused {
                _ if !batch.valid[row] => Err(NULL),
                Some(kind) => Err(kind),
                None => {
                    state.read(&table, row);
                    let case = |_| case(&machine, batch, row, &state.state());
                    let one = simulate_many(1, case, &Many::default()).into_iter().flatten().next();
                    one.ok_or("cancelled")
                }
            });
        }
    }
    columns(mechanism, &answers, fields)
}

/// The motion of a row.
fn case<'m>(
    machine: &'m InterpretedMechanism,
    batch: &Batch,
    row: usize,
    state: &State<'_>,
) -> Result<Case<&'m InterpretedMechanism>, SimulationError> {
    let refused = |kind| SimulationError { time: state.time, contact: None, kind };
    let wrong = |message: String| refused(ErrorKind::BadOption(message));
    let tolerance = batch.number(Place::Tolerance, row).unwrap_or(Options::default().relative_tolerance);
    Options::check_tolerance(tolerance).map_err(wrong)?;
    let law = batch.text(Place::Law, row);
    let law = law.map(Law::read).transpose().map_err(|error| refused(error.into()))?;
    let all = GivenSurface { mu: batch.number(Place::Mu, row), e: batch.number(Place::E, row), law };
    let all = all.check().map_err(|error| refused(error.into()))?;
    let mut given = GivenLaw {
        mu_static: batch.number(Place::MuStatic, row),
        mu_impact: batch.number(Place::MuImpact, row),
        rolling: batch.number(Place::Rolling, row),
        spinning: batch.number(Place::Spinning, row),
        ..GivenLaw::default()
    };
    for (place, part) in [(Place::Sliding, "sliding"), (Place::Restitution, "restitution")] {
        if let Some(text) = batch.text(place, row) {
            given.set(part, text).map_err(wrong)?;
        }
    }
    // Values that the columns do not give are those of the model.
    let (mut own, mut laws) = (Vec::new(), Vec::new());
    for contact in 0..machine.count(ComponentKind::Contact) {
        if let Some(stated) = machine.surface(contact) {
            own.push((contact, all.or(stated.into())));
        }
        let stated = ContactLaw::stated(&machine.stated_law(contact)).map_err(wrong)?;
        laws.push((contact, given.clone().or(stated.into()).law()));
    }
    let surfaces = surfaces(machine, state, all, &own)
        .map_err(|error| {
            let message = format!("{error}: give 'mu', 'e' and 'law'");
            refused(ErrorKind::Argument { cause: error.cause(), message })
        })?
        .of_contacts;
    let options = Options {
        relative_tolerance: tolerance,
        absolute_tolerance: tolerance,
        max_step: machine.greatest_step(false),
        surfaces,
        laws,
        ..Options::default()
    };
    Ok(Case {
        mechanism: machine,
        time: state.time,
        coordinates: state.coordinates.to_vec(),
        speeds: state.speeds.to_vec(),
        inputs: state.inputs.to_vec(),
        options,
        until: batch.number(Place::Until, row).unwrap_or(f64::NAN),
    })
}

/// The column of structs.
fn columns(mechanism: &InterpretedMechanism, answers: &[Answer], fields: Fields) -> ArrayRef {
    // A motion that did not start has no state.
    let begun =
        |answer: &Answer| answer.as_ref().ok().filter(|outcome| !outcome.coordinates.is_empty()).cloned();
    let begun: Vec<Option<Outcome>> = answers.iter().map(begun).collect();
    let kind = |answer: &Answer| match answer {
        Ok(outcome) => outcome.kind(),
        Err(kind) => kind,
    };
    let contacts = names(mechanism, ComponentKind::Contact);
    let closed = |outcome: &Outcome| -> String {
        let names: Vec<&str> =
            outcome.closed.iter().filter_map(|&contact| contacts.get(contact).copied()).collect();
        names.join("+")
    };
    let number = |of: &dyn Fn(&Outcome) -> Option<f64>| -> ArrayRef {
        Arc::new(Float64Array::from_iter(begun.iter().map(|outcome| outcome.as_ref().and_then(of))))
    };
    let count = |of: fn(&Outcome) -> usize| -> ArrayRef {
        Arc::new(Int64Array::from_iter(begun.iter().map(|outcome| outcome.as_ref().map(|o| of(o) as i64))))
    };
    let mut columns: Vec<ArrayRef> = vec![
        Arc::new(StringArray::from_iter_values(answers.iter().map(kind))),
        Arc::new(StringArray::from_iter(begun.iter().map(|outcome| outcome.as_ref().map(closed)))),
        number(&|outcome| Some(outcome.time)),
        number(&|outcome| outcome.rest),
        number(&|outcome| outcome.energy.total()),
        number(&|outcome| Some(outcome.energy.kinetic)),
        number(&|outcome| outcome.energy.potential),
        number(&|outcome| Some(outcome.energy.friction)),
        number(&|outcome| Some(outcome.energy.impacts)),
        number(&|outcome| Some(outcome.energy.inputs)),
        count(|outcome| outcome.collisions),
        count(|outcome| outcome.events),
        Arc::new(BooleanArray::from_iter(
            begun.iter().map(|outcome| outcome.as_ref().map(|outcome| outcome.several_modes)),
        )),
    ];
    for index in 0..Mechanism::count(mechanism, ComponentKind::Coordinate) {
        columns.push(number(&|outcome| outcome.coordinates.get(index).copied()));
    }
    for index in 0..Mechanism::count(mechanism, ComponentKind::Speed) {
        columns.push(number(&|outcome| outcome.speeds.get(index).copied()));
    }
    Arc::new(StructArray::new(fields, columns, None))
}
