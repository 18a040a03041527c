//! `<model>_collide`, `<model>_accelerations`, `<model>_energy` and `<model>_simulate`: the routines of a mechanism
//! on columns of states.

use std::hash::{Hash, Hasher};
use std::sync::{Arc, OnceLock};

use datafusion::arrow::array::Array;
use datafusion::arrow::datatypes::{DataType, Field, FieldRef, Fields};
use datafusion::common::tree_node::{TreeNode, TreeNodeRecursion};
use datafusion::common::{Result, exec_datafusion_err, plan_datafusion_err, plan_err};
use datafusion::logical_expr::{
    ColumnarValue, Expr, LogicalPlan, ReturnFieldArgs, ScalarFunctionArgs, ScalarUDF, ScalarUDFImpl,
    Signature, Volatility,
};
use hodograph::{CollisionError, CollisionOutcome, ComponentKind, Contacts, Law, Mechanism, Surface};
use hodograph_generator::program::Quantity;
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::columns::{Collisions, Columns};

use super::answers::{Answers, NULL, fields};
use super::batch::{Batch, Row};
use super::places::{self, Place};
use super::simulate;
use crate::models::Model;

/// The kinds of functions of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Routine {
    /// the collision of a contact
    Collide,
    /// rates of the independent speeds without contact forces
    Accelerations,
    /// kinetic and potential energy
    Energy,
    /// the outcome of a motion
    Simulate,
}

impl Routine {
    /// Every routine.
    pub const ALL: [Self; 4] = [Self::Collide, Self::Accelerations, Self::Energy, Self::Simulate];

    /// The end of the function's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Collide => "collide",
            Self::Accelerations => "accelerations",
            Self::Energy => "energy",
            Self::Simulate => "simulate",
        }
    }
}

const COLLISION: [&str; 12] = [
    "approach_n",
    "approach_t",
    "approach_s",
    "impulse_n",
    "impulse_t",
    "impulse_s",
    "separation_n",
    "separation_t",
    "separation_s",
    "contact_work",
    "normal_work",
    "energy_change",
];

/// A function of a model.
#[derive(Debug)]
pub struct ModelFunction {
    /// the model
    pub model: Arc<Model>,
    routine: Routine,
    name: String,
    signature: Signature,
    prepared: OnceLock<Prepared>,
}

/// The data that all batches share.
#[derive(Debug)]
struct Prepared {
    known: Vec<(String, Place)>,
    /// defaults of fields that are not given: coordinates, speeds, inputs, parameters
    defaults: [Vec<f64>; 4],
    contacts: Vec<String>,
    /// a routine for each contact; `None` if the contact has no collision
    collisions: Vec<Option<Collisions>>,
    columns: Columns,
}

impl PartialEq for ModelFunction {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
            && (Arc::ptr_eq(&self.model, &other.model) || self.model.digest() == other.model.digest())
    }
}

impl Eq for ModelFunction {}

impl Hash for ModelFunction {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}

impl ModelFunction {
    /// A function of this model.
    pub fn new(model: Arc<Model>, routine: Routine) -> Self {
        let name = format!("{}_{}", model.name, routine.name());
        let signature = Signature::any(1, Volatility::Immutable);
        ModelFunction { model, routine, name, signature, prepared: OnceLock::new() }
    }

    fn mechanism(&self) -> Result<&InterpretedMechanism> {
        self.model.mechanism().map_err(|error| plan_datafusion_err!("{error}"))
    }

    fn prepared(&self) -> Result<&Prepared> {
        let mechanism = self.mechanism()?;
        Ok(self.prepared.get_or_init(|| Prepared::new(mechanism, self.routine)))
    }

    fn collides(&self) -> bool {
        self.routine == Routine::Collide
    }

    /// The fields of the answer.
    ///
    /// # Errors
    ///
    /// The mistake in the model.
    pub fn answer(&self) -> Result<Fields> {
        let mechanism = self.mechanism()?;
        if self.routine == Routine::Simulate {
            return Ok(simulate::fields(mechanism));
        }
        let speeds = (0..Mechanism::count(mechanism, ComponentKind::Speed))
            .filter_map(|index| Mechanism::component(mechanism, ComponentKind::Speed, index))
            .map(|speed| speed.name.to_owned());
        let numbers: Vec<String> = match self.routine {
            Routine::Collide => COLLISION
                .map(str::to_owned)
                .into_iter()
                .chain(speeds.map(|name| format!("after_{name}")))
                .collect(),
            Routine::Accelerations => speeds.map(|name| format!("rate_{name}")).collect(),
            Routine::Energy => vec!["kinetic".to_owned(), "potential".to_owned()],
            Routine::Simulate => Vec::new(),
        };
        Ok(fields(self.collides(), &numbers))
    }

    /// The names of all fields that the argument may have.
    ///
    /// # Errors
    ///
    /// The mistake in the model.
    pub fn known(&self) -> Result<Vec<(String, Place)>> {
        Ok(self.prepared()?.known.clone())
    }

    fn places(&self, given: &DataType) -> Result<Vec<Place>> {
        let DataType::Struct(given) = given else {
            return plan_err!(
                "{} takes one struct of named fields, as {}(named_struct('{}', 1.0, ..)); {given} is given",
                self.name,
                self.name,
                self.prepared()?.known.iter().map(|(name, _)| name.as_str()).next().unwrap_or("time")
            );
        };
        if self.routine == Routine::Simulate {
            return places::resolve_motion(&self.name, &self.prepared()?.known, given);
        }
        let places =
            places::resolve(&self.name, self.mechanism()?, &self.prepared()?.known, self.collides(), given)?;
        let contacts = &self.prepared()?.contacts;
        if self.collides() && contacts.is_empty() {
            return plan_err!("{}: the model has no contacts", self.name);
        }
        if self.collides() && contacts.len() > 1 && !places.contains(&Place::Contact) {
            return plan_err!(
                "{} needs the field `contact`: the model has the contacts {}",
                self.name,
                contacts.join(", ")
            );
        }
        Ok(places)
    }

    /// Checks the contact of a call if it is known when the query is planned: a literal name must be one of
    /// the model. Names that come with the rows are checked row by row.
    ///
    /// # Errors
    ///
    /// A name that the model does not have.
    pub fn check_contact(&self, arguments: &[Expr]) -> Result<()> {
        let [Expr::ScalarFunction(made)] = arguments else { return Ok(()) };
        if !self.collides() || made.func.name() != "named_struct" {
            return Ok(());
        }
        for pair in made.args.chunks_exact(2) {
            let [Some("contact"), Some(contact)] = [literal(&pair[0]), literal(&pair[1])] else { continue };
            let contacts = &self.prepared()?.contacts;
            if !contacts.iter().any(|known| known == contact) {
                return plan_err!(
                    "{}: there is no contact `{contact}`: there are: {}",
                    self.name,
                    contacts.join(", ")
                );
            }
        }
        Ok(())
    }
}

/// The text of an expression that is a string literal.
fn literal(expression: &Expr) -> Option<&str> {
    match expression {
        Expr::Literal(value, _) => value.try_as_str().flatten(),
        _ => None,
    }
}

/// Refuses a plan that names a contact which its model does not have.
///
/// # Errors
///
/// Such a name, or a mistake in a model.
pub fn check_contacts(plan: &LogicalPlan) -> Result<()> {
    plan.apply_with_subqueries(|node| {
        node.apply_expressions(|expression| {
            expression.apply(|part| {
                if let Expr::ScalarFunction(call) = part
                    && let Some(function) = of_model(&call.func)
                {
                    function.check_contact(&call.args)?;
                }
                Ok(TreeNodeRecursion::Continue)
            })
        })
    })?;
    Ok(())
}

/// The model function of an SQL function, if it is one.
pub fn of_model(function: &ScalarUDF) -> Option<&ModelFunction> {
    let any: &dyn std::any::Any = function.inner().as_ref();
    any.downcast_ref()
}

impl Prepared {
    fn new(mechanism: &InterpretedMechanism, routine: Routine) -> Self {
        let count = |kind| Mechanism::count(mechanism, kind);
        let zeros = |kind| vec![0.0; count(kind)];
        let [mut q, mut u, mut inputs, mut parameters] =
            [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input, ComponentKind::Parameter]
                .map(zeros);
        // the slices have the lengths asked for
        let _ = mechanism.initial_state(&mut q, &mut u, &mut inputs);
        let _ = mechanism.parameter_values(&mut parameters);
        let contacts = (0..count(ComponentKind::Contact))
            .filter_map(|index| Mechanism::component(mechanism, ComponentKind::Contact, index));
        Prepared {
            known: match routine {
                Routine::Simulate => places::known_of_motions(mechanism),
                _ => places::known(mechanism, routine == Routine::Collide),
            },
            defaults: [q, u, inputs, parameters],
            contacts: contacts.map(|contact| contact.name.to_owned()).collect(),
            collisions: (0..count(ComponentKind::Contact))
                .map(|contact| mechanism.collisions(contact).ok())
                .collect(),
            columns: mechanism.columns(&quantities(routine)),
        }
    }
}

fn quantities(routine: Routine) -> Vec<Quantity> {
    match routine {
        Routine::Collide | Routine::Simulate => Vec::new(),
        Routine::Accelerations => vec![Quantity::Accelerations],
        Routine::Energy => vec![Quantity::KineticEnergy, Quantity::PotentialEnergy],
    }
}

type Solved<'a> = Result<(CollisionOutcome<f64>, &'a [f64]), CollisionError<f64>>;

fn push(answers: &mut Answers, solved: Solved<'_>) {
    match solved {
        Ok((outcome, speeds)) => {
            let impact = &outcome.impact;
            let works = [impact.contact_work, impact.normal_work, outcome.energy_change];
            let (approach, impulse) = (outcome.approach.as_slice(), impact.impulse.as_slice());
            let lists = [approach, impulse, impact.velocity.as_slice(), &works, speeds];
            answers.answer(Some((impact.path, impact.compressions)), &lists);
        }
        Err(error) => answers.refuse(error.kind()),
    }
}

impl ModelFunction {
    fn collide(&self, batch: &Batch, prepared: &Prepared, answers: &mut Answers) -> Result<()> {
        let (table, mechanism) = (batch.table(&prepared.defaults), self.mechanism()?);
        let surfaces = batch.surfaces();
        let stated: Vec<_> = (0..prepared.contacts.len()).map(|contact| mechanism.surface(contact)).collect();
        // rows with invalid arguments get their error in order
        let asked = |row: usize| -> Result<(usize, Surface<f64>), &'static str> {
            if !batch.valid[row] {
                return Err(NULL);
            }
            let contact = batch.contact(&prepared.contacts, row)?;
            Ok((contact, surfaces.of(row, stated.get(contact).copied().flatten())?))
        };
        let asked: Vec<_> = (0..batch.rows).map(asked).collect();
        let nowhere = Surface { mu: f64::NAN, e: f64::NAN, law: Law::Newton };
        let surface =
            |row: usize| asked.get(row).and_then(|row| row.ok()).map_or(nowhere, |(_, surface)| surface);
        let mut row = 0;
        for rows in asked.chunk_by(|a, b| a.map(|(contact, _)| contact) == b.map(|(contact, _)| contact)) {
            let range = row..row + rows.len();
            row = range.end;
            match rows.first() {
                Some(Err(kind)) => range.for_each(|_| answers.refuse(kind)),
                Some(Ok((contact, _))) => match prepared.collisions.get(*contact) {
                    Some(Some(collisions)) => {
                        collisions.solve(&table, &surface, range, &mut |_, solved| push(answers, solved));
                    }
                    _ => range.for_each(|_| answers.refuse("undefined")),
                },
                None => {}
            }
        }
        Ok(())
    }

    /// Collisions where parameters differ from row to row.
    fn collide_with_parameters(
        &self,
        batch: &Batch,
        prepared: &Prepared,
        answers: &mut Answers,
    ) -> Result<()> {
        let (table, surfaces) = (batch.table(&prepared.defaults), batch.surfaces());
        let mut machine = self.mechanism()?.clone();
        let mut state = Row::new(&prepared.defaults);
        let mut speeds = vec![0.0; prepared.defaults[1].len()];
        for (range, parameters) in batch.stretches(&prepared.defaults[3]) {
            let refused = machine.set_parameter_values(&parameters).err();
            for row in range {
                let asked = batch.contact(&prepared.contacts, row);
                match (&refused, batch.valid[row], asked) {
                    (_, false, _) => answers.refuse(NULL),
                    (Some(error), ..) => answers.refuse(error.kind()),
                    (_, _, Err(kind)) => answers.refuse(kind),
                    (None, true, Ok(contact)) => match surfaces.of(row, machine.surface(contact)) {
                        Err(kind) => answers.refuse(kind),
                        Ok(surface) => {
                            state.read(&table, row);
                            let solved = machine.collide(contact, &state.state(), &surface, &mut speeds);
                            push(answers, solved.map(|outcome| (outcome, speeds.as_slice())));
                        }
                    },
                }
            }
        }
        Ok(())
    }

    /// Quantities without a contact.
    fn evaluate(&self, batch: &Batch, prepared: &Prepared, answers: &mut Answers) -> Result<()> {
        let table = batch.table(&prepared.defaults);
        let mechanism = self.mechanism()?;
        let width = if self.routine == Routine::Energy { 2 } else { prepared.defaults[1].len() };
        let own = batch.places.iter().any(|place| matches!(place, Place::Parameter(_)));
        let mut machine = mechanism.clone();
        let stretches =
            if own { batch.stretches(&prepared.defaults[3]) } else { vec![(0..batch.rows, Vec::new())] };
        for (range, parameters) in stretches {
            if own && let Err(error) = machine.set_parameter_values(&parameters) {
                range.for_each(|row| answers.refuse(if batch.valid[row] { error.kind() } else { NULL }));
                continue;
            }
            let fresh;
            let columns = if own {
                fresh = machine.columns(&quantities(self.routine));
                &fresh
            } else {
                &prepared.columns
            };
            let mut numbers = vec![0.0; width];
            columns.for_each_block(&table, range, |block| {
                for (lane, failure) in block.failures().iter().enumerate() {
                    if !batch.valid[block.first + lane] {
                        answers.refuse(NULL);
                        continue;
                    }
                    if let Some(failed) = failure {
                        answers.refuse(mechanism.state_error(*failed).kind());
                        continue;
                    }
                    numbers.fill(0.0);
                    for (result, number) in numbers.iter_mut().enumerate().take(columns.len()) {
                        *number = block.column(result).get(lane).copied().unwrap_or(0.0);
                    }
                    if numbers.iter().all(|number| number.is_finite()) {
                        answers.answer(None, &[&numbers]);
                    } else {
                        answers.refuse("not_finite");
                    }
                }
            });
        }
        Ok(())
    }
}

impl ScalarUDFImpl for ModelFunction {
    fn name(&self) -> &str {
        &self.name
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(DataType::Struct(self.answer()?))
    }

    fn return_field_from_args(&self, args: ReturnFieldArgs) -> Result<FieldRef> {
        if let Some(argument) = args.arg_fields.first() {
            self.places(argument.data_type())?;
        }
        Ok(Arc::new(Field::new(&self.name, DataType::Struct(self.answer()?), false)))
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let Some(argument) = args.args.first() else { return plan_err!("{} takes one struct", self.name) };
        let argument = argument.to_array(args.number_rows)?;
        let places = self.places(argument.data_type())?;
        let prepared = self.prepared()?;
        let fields = self.answer()?;
        let own = places.iter().any(|place| matches!(place, Place::Parameter(_)));
        let batch = Batch::new(&argument, places)?;
        if self.routine == Routine::Simulate {
            let answer = simulate::simulate(self.mechanism()?, &batch, &prepared.defaults, fields);
            return Ok(ColumnarValue::Array(answer));
        }
        let texts = if self.collides() { 3 } else { 1 };
        let mut answers = Answers::new(self.collides(), fields.len() - texts, batch.rows);
        match self.routine {
            Routine::Collide if own => self.collide_with_parameters(&batch, prepared, &mut answers)?,
            Routine::Collide => self.collide(&batch, prepared, &mut answers)?,
            _ => self.evaluate(&batch, prepared, &mut answers)?,
        }
        let answer = answers.finish(fields);
        if answer.len() != batch.rows {
            return Err(exec_datafusion_err!(
                "{}: {} answers for {} rows",
                self.name,
                answer.len(),
                batch.rows
            ));
        }
        Ok(ColumnarValue::Array(answer))
    }
}
