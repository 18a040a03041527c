//! `solve(nn, nt, ns, tt, ts, ss, vn, vt, vs, mu, e, law)`: a collision by itself.

use std::sync::Arc;

use datafusion::arrow::array::{Array, Float64Array};
use datafusion::arrow::datatypes::{DataType, Field, FieldRef, Fields};
use datafusion::common::cast::{as_float64_array, as_string_array};
use datafusion::common::{Result, plan_err};
use datafusion::logical_expr::{
    ColumnarValue, ReturnFieldArgs, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility,
};
use hodograph::{Law, Surface};
use hodograph_interpreter::columns::{Column, Impacts};

use super::answers::{Answers, NULL, fields};

/// The arguments, in order.
pub const ARGUMENTS: [&str; 12] = ["nn", "nt", "ns", "tt", "ts", "ss", "vn", "vt", "vs", "mu", "e", "law"];

const NUMBERS: [&str; 8] = [
    "impulse_n",
    "impulse_t",
    "impulse_s",
    "separation_n",
    "separation_t",
    "separation_s",
    "contact_work",
    "normal_work",
];

/// The function.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct Solve {
    signature: Signature,
}

impl Default for Solve {
    fn default() -> Self {
        Solve { signature: Signature::user_defined(Volatility::Immutable) }
    }
}

fn answer() -> Fields {
    fields(true, &NUMBERS.map(str::to_owned))
}

impl ScalarUDFImpl for Solve {
    fn name(&self) -> &str {
        "solve"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn coerce_types(&self, types: &[DataType]) -> Result<Vec<DataType>> {
        if types.len() != ARGUMENTS.len() {
            return plan_err!(
                "solve takes 12 arguments, {}; {} are given",
                ARGUMENTS.join(", "),
                types.len()
            );
        }
        let mut wanted = vec![DataType::Float64; 11];
        wanted.push(DataType::Utf8);
        for ((given, wanted), name) in types.iter().zip(&wanted).zip(ARGUMENTS) {
            let fits = match wanted {
                DataType::Utf8 => super::is_text(given),
                _ => super::is_number(given),
            };
            if !fits {
                let noun = if name == "law" { "text" } else { "a number" };
                return plan_err!("solve: the argument {name} is {given}, it must be {noun}");
            }
        }
        Ok(wanted)
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(DataType::Struct(answer()))
    }

    fn return_field_from_args(&self, _: ReturnFieldArgs) -> Result<FieldRef> {
        Ok(Arc::new(Field::new(self.name(), DataType::Struct(answer()), false)))
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let rows = args.number_rows;
        let arrays = ColumnarValue::values_to_arrays(&args.args)?;
        let arrays: Vec<_> =
            arrays.iter().map(|array| super::of_length(array, rows)).collect::<Result<_>>()?;
        let Some((laws, numbers)) = arrays.split_last() else { return plan_err!("solve takes 12 arguments") };
        let laws = as_string_array(laws)?;
        let numbers: Vec<&Float64Array> =
            numbers.iter().map(|array| as_float64_array(array)).collect::<Result<_>>()?;
        let column = |index: usize| Column::new(numbers[index].values());
        let impacts = Impacts { matrix: [0, 1, 2, 3, 4, 5].map(column), velocity: [6, 7, 8].map(column) };
        let (mu, e) = (column(9), column(10));
        let mut answers = Answers::new(true, NUMBERS.len(), rows);
        let asked = |row: usize| {
            if laws.is_null(row) || numbers.iter().any(|numbers| numbers.is_null(row)) {
                return Err(NULL);
            }
            let law = Law::named(laws.value(row)).ok_or(super::UNKNOWN_LAW)?;
            Ok(Surface { mu: mu.get(row), e: e.get(row), law })
        };
        let asked: Vec<_> = (0..rows).map(asked).collect();
        let nowhere = Surface { mu: f64::NAN, e: f64::NAN, law: Law::Newton };
        let surface = |row: usize| asked.get(row).and_then(|row| row.ok()).unwrap_or(nowhere);
        let mut row = 0;
        // rows with invalid arguments get their error in order
        for alike in asked.chunk_by(|a, b| a.is_ok() && b.is_ok()) {
            let range = row..row + alike.len();
            row = range.end;
            if let Some(Err(kind)) = alike.first() {
                answers.refuse(kind);
                continue;
            }
            impacts.solve(&surface, range, &mut |_, impact| match impact {
                Ok(impact) => {
                    let works = [impact.contact_work, impact.normal_work];
                    let lists = [impact.impulse.as_slice(), impact.velocity.as_slice(), &works];
                    answers.answer(Some((impact.path, impact.compressions)), &lists);
                }
                Err(error) => answers.refuse(error.kind()),
            });
        }
        Ok(ColumnarValue::Array(answers.finish(answer())))
    }
}
