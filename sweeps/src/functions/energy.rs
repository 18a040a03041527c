//! `energy_gained(c)`: the energy that a collision gained, from the struct of its answer; rounding of the work is no
//! gain.

use std::sync::Arc;

use datafusion::arrow::array::{Array, ArrayRef, AsArray, Float64Array};
use datafusion::arrow::datatypes::{DataType, Fields, Float64Type};
use datafusion::common::{Result, plan_err};
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility};
use hodograph::nalgebra::Vector3;

/// The fields of the struct, three each: the impulse, the velocities of separation and of approach. The last
/// three may be arguments of their own: the answer of `solve` does not repeat them.
const NEEDED: [&str; 9] = [
    "impulse_n",
    "impulse_t",
    "impulse_s",
    "separation_n",
    "separation_t",
    "separation_s",
    "approach_n",
    "approach_t",
    "approach_s",
];

/// The function.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct EnergyGained {
    signature: Signature,
}

impl Default for EnergyGained {
    fn default() -> Self {
        EnergyGained { signature: Signature::user_defined(Volatility::Immutable) }
    }
}

fn names(given: &Fields, approach: bool) -> Result<()> {
    let needed = NEEDED.iter().take(if approach { 6 } else { 9 });
    for name in needed {
        let found = given.iter().find(|field| field.name() == name);
        if found.is_none_or(|field| *field.data_type() != DataType::Float64) {
            return plan_err!(
                "energy_gained takes the answer of a collision, as energy_gained(two_sleds_collide(..)) or energy_gained(solve(..), vn, vt, vs); \
                 what is given has no number `{name}`"
            );
        }
    }
    Ok(())
}

impl ScalarUDFImpl for EnergyGained {
    fn name(&self) -> &str {
        "energy_gained"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn coerce_types(&self, types: &[DataType]) -> Result<Vec<DataType>> {
        let (DataType::Struct(given), rest) = (match types {
            [first, rest @ ..] if rest.is_empty() || rest.len() == 3 => (first, rest),
            _ => {
                return plan_err!(
                    "energy_gained takes the answer of a collision, or that of solve and vn, vt, vs"
                );
            }
        }) else {
            return plan_err!("energy_gained takes the answer of a collision; {} is given", types[0]);
        };
        names(given, !rest.is_empty())?;
        if let Some(other) = rest.iter().find(|given| !super::is_number(given)) {
            return plan_err!("energy_gained: a velocity of approach is {other}, it must be a number");
        }
        Ok(types.iter().take(1).cloned().chain(rest.iter().map(|_| DataType::Float64)).collect())
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(DataType::Float64)
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let rows = args.number_rows;
        let arrays = ColumnarValue::values_to_arrays(&args.args)?;
        let arrays: Vec<ArrayRef> =
            arrays.iter().map(|array| super::of_length(array, rows)).collect::<Result<_>>()?;
        let [collision, approach @ ..] = &arrays[..] else {
            return plan_err!("energy_gained takes the answer of a collision");
        };
        let collision = collision.as_struct();
        names(collision.fields(), !approach.is_empty())?;
        let own = NEEDED.iter().filter_map(|name| collision.column_by_name(name));
        let columns: Vec<ArrayRef> =
            own.take(if approach.is_empty() { 9 } else { 6 }).chain(approach).map(Arc::clone).collect();
        let columns: Vec<&Float64Array> =
            columns.iter().map(|column| column.as_primitive::<Float64Type>()).collect();
        let gained = (0..rows).map(|row| {
            if collision.is_null(row) || columns.iter().any(|column| column.is_null(row)) {
                return None;
            }
            let three = |first: usize| Vector3::from_fn(|index, _| columns[first + index].value(row));
            Some(hodograph::energy_gained(&three(0), &three(6), &three(3)).unwrap_or(0.0))
        });
        Ok(ColumnarValue::Array(Arc::new(gained.collect::<Float64Array>())))
    }
}
