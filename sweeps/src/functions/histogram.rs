//! `histogram(x, low, high, bins)`: counts of x in `bins` equal bins, as a list of `bins + 2` integers: below
//! `low`, the bins, from `high` on. NULL and NaN are not counted. Counts of parts add up.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, AsArray, UInt64Array};
use datafusion::arrow::datatypes::{DataType, Field, FieldRef, Float64Type, Int64Type, UInt64Type};
use datafusion::common::{Result, ScalarValue, exec_err};
use datafusion::logical_expr::function::{AccumulatorArgs, StateFieldsArgs};
use datafusion::logical_expr::utils::{AggregateOrderSensitivity, format_state_name};
use datafusion::logical_expr::{Accumulator, AggregateUDFImpl, ReversedUDAF, Signature, Volatility};

/// The largest number of bins.
const MOST: i64 = 1_000_000;

/// The aggregate.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct Histogram {
    signature: Signature,
}

impl Default for Histogram {
    fn default() -> Self {
        let types = vec![DataType::Float64, DataType::Float64, DataType::Float64, DataType::Int64];
        Histogram { signature: Signature::exact(types, Volatility::Immutable) }
    }
}

fn list() -> DataType {
    DataType::List(Arc::new(Field::new_list_field(DataType::UInt64, true)))
}

#[derive(Debug, Default)]
struct Counts(Vec<u64>);

impl Counts {
    fn scalar(&self) -> ScalarValue {
        let counts: Vec<ScalarValue> = self.0.iter().map(|&count| ScalarValue::UInt64(Some(count))).collect();
        ScalarValue::List(ScalarValue::new_list_nullable(&counts, &DataType::UInt64))
    }
}

impl Accumulator for Counts {
    fn update_batch(&mut self, values: &[ArrayRef]) -> Result<()> {
        let [x, low, high, bins] = values else { return exec_err!("histogram takes x, low, high and bins") };
        let [x, low, high] = [x, low, high].map(|array| array.as_primitive::<Float64Type>());
        let bins = bins.as_primitive::<Int64Type>();
        if x.is_empty() {
            return Ok(());
        }
        let (low, high, bins) = (low.value(0), high.value(0), bins.value(0));
        if !(low < high && low.is_finite() && high.is_finite() && (1..=MOST).contains(&bins)) {
            return exec_err!(
                "histogram: low must be less than high, and bins between 1 and {MOST}; they are {low}, {high}, {bins}"
            );
        }
        self.0.resize(bins as usize + 2, 0);
        for number in x.iter().flatten().filter(|number| !number.is_nan()) {
            let place = if number < low {
                0
            } else if number >= high {
                bins as usize + 1
            } else {
                // rounding may lead to the next bin, but not past the last
                1 + (((number - low) / (high - low) * bins as f64) as usize).min(bins as usize - 1)
            };
            self.0[place] += 1;
        }
        Ok(())
    }

    fn merge_batch(&mut self, states: &[ArrayRef]) -> Result<()> {
        let Some(lists) = states.first() else { return Ok(()) };
        for counts in lists.as_list::<i32>().iter().flatten() {
            let counts: &UInt64Array = counts.as_primitive::<UInt64Type>();
            if self.0.len() < counts.len() {
                self.0.resize(counts.len(), 0);
            }
            self.0.iter_mut().zip(counts.values()).for_each(|(sum, count)| *sum += count);
        }
        Ok(())
    }

    fn evaluate(&mut self) -> Result<ScalarValue> {
        Ok(self.scalar())
    }

    fn state(&mut self) -> Result<Vec<ScalarValue>> {
        Ok(vec![self.scalar()])
    }

    fn size(&self) -> usize {
        size_of::<Self>() + 8 * self.0.capacity()
    }
}

impl AggregateUDFImpl for Histogram {
    fn name(&self) -> &str {
        "histogram"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(list())
    }

    fn accumulator(&self, _: AccumulatorArgs) -> Result<Box<dyn Accumulator>> {
        Ok(Box::new(Counts::default()))
    }

    fn state_fields(&self, args: StateFieldsArgs) -> Result<Vec<FieldRef>> {
        Ok(vec![Arc::new(Field::new(format_state_name(args.name, "counts"), list(), true))])
    }

    fn order_sensitivity(&self) -> AggregateOrderSensitivity {
        AggregateOrderSensitivity::Insensitive
    }

    fn reverse_expr(&self) -> ReversedUDAF {
        ReversedUDAF::Identical
    }
}
