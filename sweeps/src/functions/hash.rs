//! `outcome_hash(..)`: a 64-bit hash of the values of a row, the same on every machine. Numbers are hashed by
//! their bits, text by its bytes, structs by their fields in order; names of fields are ignored.

use std::sync::Arc;

use datafusion::arrow::array::{Array, ArrayRef, AsArray, UInt64Array};
use datafusion::arrow::buffer::NullBuffer;
use datafusion::arrow::compute::cast;
use datafusion::arrow::datatypes::{DataType, Float64Type, Int64Type, UInt64Type};
use datafusion::common::{Result, plan_err};
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility};

const NULL: u64 = 0x6e75_6c6c;

/// A bijection of 64-bit numbers that spreads every bit (the finalizer of SplitMix64).
#[inline]
pub fn mix(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[inline]
fn absorb(hash: &mut u64, bits: u64) {
    *hash = mix(hash.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ bits);
}

fn absorb_text(hash: &mut u64, text: &str) {
    absorb(hash, text.len() as u64);
    for bytes in text.as_bytes().chunks(8) {
        let mut word = [0; 8];
        word.iter_mut().zip(bytes).for_each(|(to, &byte)| *to = byte);
        absorb(hash, u64::from_le_bytes(word));
    }
}

/// Whether values of this type can be hashed.
fn hashable(data_type: &DataType) -> bool {
    match data_type {
        DataType::Struct(fields) => fields.iter().all(|field| hashable(field.data_type())),
        DataType::List(field) => hashable(field.data_type()),
        DataType::Null | DataType::Boolean | DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => {
            true
        }
        other => other.is_integer() || other.is_floating(),
    }
}

/// Each hash with the value of its row, or with NULL.
fn each(hashes: &mut [u64], nulls: Option<NullBuffer>, value: impl Fn(&mut u64, usize)) {
    match nulls {
        None => hashes.iter_mut().enumerate().for_each(|(row, hash)| value(hash, row)),
        Some(nulls) => hashes
            .iter_mut()
            .zip(&nulls)
            .enumerate()
            .for_each(|(row, (hash, valid))| if valid { value(hash, row) } else { absorb(hash, NULL) }),
    }
}

fn absorb_array(hashes: &mut [u64], array: &ArrayRef) -> Result<()> {
    let nulls = array.logical_nulls();
    let valid = |row: usize| nulls.as_ref().is_none_or(|nulls| nulls.is_valid(row));
    match array.data_type() {
        DataType::Null => each(hashes, nulls, |_, _| {}),
        DataType::Struct(_) => {
            each(hashes, nulls, |hash, _| absorb(hash, 1));
            for column in array.as_struct().columns() {
                absorb_array(hashes, column)?;
            }
        }
        DataType::List(_) => {
            let lists = array.as_list::<i32>();
            for (row, hash) in hashes.iter_mut().enumerate() {
                if !valid(row) {
                    absorb(hash, NULL);
                    continue;
                }
                let items = lists.value(row);
                let mut each_item = vec![0; items.len()];
                absorb_array(&mut each_item, &items)?;
                absorb(hash, items.len() as u64);
                each_item.iter().for_each(|&item| absorb(hash, item));
            }
        }
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => {
            let text = cast(array, &DataType::Utf8)?;
            let text = text.as_string::<i32>();
            each(hashes, nulls, |hash, row| absorb_text(hash, text.value(row)));
        }
        DataType::Boolean => {
            let values = array.as_boolean();
            each(hashes, nulls, |hash, row| absorb(hash, u64::from(values.value(row))));
        }
        DataType::UInt64 => {
            let values = array.as_primitive::<UInt64Type>().values();
            each(hashes, nulls, |hash, row| absorb(hash, values[row]));
        }
        other if other.is_integer() => {
            let values = cast(array, &DataType::Int64)?;
            let values = values.as_primitive::<Int64Type>().values();
            each(hashes, nulls, |hash, row| absorb(hash, values[row] as u64));
        }
        other if other.is_floating() => {
            let values = cast(array, &DataType::Float64)?;
            let values = values.as_primitive::<Float64Type>().values();
            each(hashes, nulls, |hash, row| absorb(hash, values[row].to_bits()));
        }
        other => return plan_err!("outcome_hash does not take {other}"),
    }
    Ok(())
}

/// The hashes of rows.
///
/// # Errors
///
/// A column whose type has no hash.
pub fn hash_rows(columns: &[ArrayRef], rows: usize) -> Result<Vec<u64>> {
    let mut hashes = vec![0; rows];
    for column in columns {
        absorb_array(&mut hashes, &super::of_length(column, rows)?)?;
    }
    Ok(hashes)
}

/// The function.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct OutcomeHash {
    signature: Signature,
}

impl Default for OutcomeHash {
    fn default() -> Self {
        OutcomeHash { signature: Signature::variadic_any(Volatility::Immutable) }
    }
}

impl ScalarUDFImpl for OutcomeHash {
    fn name(&self) -> &str {
        "outcome_hash"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, types: &[DataType]) -> Result<DataType> {
        match types.iter().find(|given| !hashable(given)) {
            Some(given) => {
                plan_err!("outcome_hash takes numbers, text, booleans and structs of them; {given} is given")
            }
            None => Ok(DataType::UInt64),
        }
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let columns = ColumnarValue::values_to_arrays(&args.args)?;
        let hashes = hash_rows(&columns, args.number_rows)?;
        Ok(ColumnarValue::Array(Arc::new(UInt64Array::from(hashes))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use datafusion::arrow::array::{Float64Array, StringArray, StringViewArray};

    fn hashes(columns: &[ArrayRef]) -> Vec<u64> {
        hash_rows(columns, columns[0].len()).unwrap()
    }

    #[test]
    fn bits_count_and_the_way_text_is_stored_does_not() {
        let numbers: ArrayRef = Arc::new(Float64Array::from(vec![Some(0.0), Some(-0.0), None, Some(1.0)]));
        let found = hashes(&[numbers]);
        assert!((0..4).all(|a| (0..a).all(|b| found[a] != found[b])), "{found:?}");
        let text: ArrayRef = Arc::new(StringArray::from(vec!["sliding", "sliding, then sticking"]));
        let view: ArrayRef = Arc::new(StringViewArray::from(vec!["sliding", "sliding, then sticking"]));
        assert_eq!(hashes(&[text]), hashes(&[view]));
    }

    #[test]
    fn the_order_of_columns_counts() {
        let [a, b]: [ArrayRef; 2] =
            [1.0, 2.0].map(|number| Arc::new(Float64Array::from(vec![number])) as ArrayRef);
        assert_ne!(hashes(&[a.clone(), b.clone()]), hashes(&[b, a]));
    }
}
