//! Numbers that depend only on the index of the row: `uniform(row, dimension, seed)`, `normal(row, dimension,
//! seed)`, `sobol(row, dimension, seed)` and `linspace(index, low, high, count)`. Every part of a sweep gets
//! the same numbers, on any machine and in any order.

use std::sync::Arc;

use datafusion::arrow::array::{Array, ArrayRef, AsArray, Float64Array};
use datafusion::arrow::datatypes::{DataType, Float64Type, Int64Type};
use datafusion::common::{Result, plan_err};
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility};

use super::hash::mix;

/// Number of rows of one scrambled Sobol sequence; the next rows have another seed.
const SEQUENCE: u64 = 1 << 16;

/// Philox 4x32-10 of Salmon et al., *Parallel random numbers: as easy as 1, 2, 3* (2011).
pub fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..10 {
        // Written out, as are the conversions below: `map` of an array would be a call for each of them.
        let (a, b) = (0xd251_1f53 * u64::from(counter[0]), 0xcd9e_8d57 * u64::from(counter[2]));
        counter = [
            (b >> 32) as u32 ^ counter[1] ^ key[0],
            b as u32,
            (a >> 32) as u32 ^ counter[3] ^ key[1],
            a as u32,
        ];
        key = [key[0].wrapping_add(0x9e37_79b9), key[1].wrapping_add(0xbb67_ae85)];
    }
    counter
}

/// The number in [0, 1) of 53 of these bits.
#[inline]
fn number(high: u32, low: u32) -> f64 {
    let bits = (u64::from(high) << 32 | u64::from(low)) >> 11;
    bits as f64 / (1_u64 << 53) as f64
}

/// Two numbers in [0, 1) with 53 bits each.
fn pair(row: i64, dimension: i64, seed: i64) -> [f64; 2] {
    let [row, dimension] = [row as u64, dimension as u64];
    let counter = [row as u32, (row >> 32) as u32, dimension as u32, (dimension >> 32) as u32];
    let [a, b, c, d] = philox(counter, [seed as u32, (seed as u64 >> 32) as u32]);
    [number(a, b), number(c, d)]
}

/// A point of a scrambled Sobol sequence, in [0, 1).
fn sobol(row: i64, dimension: u32, seed: i64) -> f64 {
    let row = row as u64;
    let scramble = mix(mix(seed as u64).wrapping_add(row / SEQUENCE));
    f64::from(sobol_burley::sample((row % SEQUENCE) as u32, dimension, scramble as u32))
}

/// A number of the standard normal distribution (Box and Muller), with functions that give the same bits on
/// every machine.
fn normal(row: i64, dimension: i64, seed: i64) -> f64 {
    let [radius, angle] = pair(row, dimension, seed);
    libm::sqrt(-2.0 * libm::log(1.0 - radius)) * libm::cos(core::f64::consts::TAU * angle)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Kind {
    Uniform,
    Normal,
    Sobol,
}

/// A sampler of (row, dimension, seed).
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct Sampler {
    kind: Kind,
    signature: Signature,
}

impl Sampler {
    /// Every sampler.
    pub fn all() -> [Self; 3] {
        let signature = || Signature::exact(vec![DataType::Int64; 3], Volatility::Immutable);
        [Kind::Uniform, Kind::Normal, Kind::Sobol].map(|kind| Sampler { kind, signature: signature() })
    }
}

impl ScalarUDFImpl for Sampler {
    fn name(&self) -> &str {
        match self.kind {
            Kind::Uniform => "uniform",
            Kind::Normal => "normal",
            Kind::Sobol => "sobol",
        }
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(DataType::Float64)
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let arrays = columns(&args)?;
        let [rows, dimensions, seeds] = arrays.as_slice() else {
            return plan_err!("{} takes row, dimension, seed", self.name());
        };
        let [rows, dimensions, seeds] =
            [rows, dimensions, seeds].map(|array| array.as_primitive::<Int64Type>());
        let most = i64::from(sobol_burley::NUM_DIMENSIONS);
        if self.kind == Kind::Uniform && arrays.iter().all(|array| array.null_count() == 0) {
            let each = rows.values().iter().zip(dimensions.values()).zip(seeds.values());
            let numbers = each.map(|((row, dimension), seed)| pair(*row, *dimension, *seed)[0]);
            return Ok(ColumnarValue::Array(Arc::new(Float64Array::from_iter_values(numbers))));
        }
        let number = |index: usize| {
            if rows.is_null(index) || dimensions.is_null(index) || seeds.is_null(index) {
                return Ok(None);
            }
            let (row, dimension, seed) = (rows.value(index), dimensions.value(index), seeds.value(index));
            Ok(Some(match self.kind {
                Kind::Uniform => pair(row, dimension, seed)[0],
                Kind::Normal => normal(row, dimension, seed),
                Kind::Sobol if (0..most).contains(&dimension) => sobol(row, dimension as u32, seed),
                Kind::Sobol => {
                    return plan_err!("sobol has the dimensions 0 to {}; {dimension} is asked for", most - 1);
                }
            }))
        };
        let numbers = (0..args.number_rows).map(number).collect::<Result<Float64Array>>()?;
        Ok(ColumnarValue::Array(Arc::new(numbers)))
    }
}

/// `linspace(index, low, high, count)`: the number with this index of `count` numbers from `low` to `high`,
/// both included.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct Linspace {
    signature: Signature,
}

impl Default for Linspace {
    fn default() -> Self {
        let types = vec![DataType::Int64, DataType::Float64, DataType::Float64, DataType::Int64];
        Linspace { signature: Signature::exact(types, Volatility::Immutable) }
    }
}

impl ScalarUDFImpl for Linspace {
    fn name(&self) -> &str {
        "linspace"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(DataType::Float64)
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let arrays = columns(&args)?;
        let [indices, lows, highs, counts] = arrays.as_slice() else {
            return plan_err!("linspace takes index, low, high, count");
        };
        let [indices, counts] = [indices, counts].map(|array| array.as_primitive::<Int64Type>());
        let [lows, highs] = [lows, highs].map(|array| array.as_primitive::<Float64Type>());
        let number = |row: usize| {
            let null = indices.is_null(row) || counts.is_null(row) || lows.is_null(row) || highs.is_null(row);
            (!null).then(|| {
                let (low, high) = (lows.value(row), highs.value(row));
                match counts.value(row) {
                    ..=1 => low,
                    count if indices.value(row) == count - 1 => high,
                    count => low + (high - low) * (indices.value(row) as f64 / (count - 1) as f64),
                }
            })
        };
        Ok(ColumnarValue::Array(Arc::new((0..args.number_rows).map(number).collect::<Float64Array>())))
    }
}

fn columns(args: &ScalarFunctionArgs) -> Result<Vec<ArrayRef>> {
    let arrays = ColumnarValue::values_to_arrays(&args.args)?;
    arrays.iter().map(|array| super::of_length(array, args.number_rows)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The known answers that the authors publish with the generator.
    #[test]
    fn philox_gives_the_published_numbers() {
        assert_eq!(philox([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(
            philox([u32::MAX; 4], [u32::MAX; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        let (counter, key) =
            ([0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344], [0xa409_3822, 0x299f_31d0]);
        assert_eq!(philox(counter, key), [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]);
    }

    #[test]
    fn samples_have_the_mean_and_spread_of_their_distribution() {
        let rows = 0..100_000_i64;
        let count = rows.end as f64;
        let moments = |of: &dyn Fn(i64) -> f64| {
            let mean = rows.clone().map(of).sum::<f64>() / count;
            (mean, rows.clone().map(|row| (of(row) - mean).powi(2)).sum::<f64>() / count)
        };
        let near = |(mean, spread): (f64, f64), wanted: (f64, f64), bound: f64| {
            assert!((mean - wanted.0).abs() < bound && (spread - wanted.1).abs() < bound, "{mean} {spread}");
        };
        near(moments(&|row| pair(row, 3, 7)[0]), (0.5, 1.0 / 12.0), 0.005);
        near(moments(&|row| normal(row, 3, 7)), (0.0, 1.0), 0.02);
        near(moments(&|row| sobol(row, 3, 7)), (0.5, 1.0 / 12.0), 1e-4);
    }

    /// Each of 256 equal intervals contains its share of points, in every sequence.
    #[test]
    fn sobol_points_fill_every_interval_alike() {
        for first in [0, SEQUENCE as i64, 5 * SEQUENCE as i64] {
            let mut counts = [0; 256];
            (first..first + 1024).for_each(|row| counts[(sobol(row, 2, 1) * 256.0) as usize] += 1);
            assert!(counts.iter().all(|&count| count == 4), "{counts:?}");
        }
        assert_ne!(sobol(0, 0, 1), sobol(SEQUENCE as i64, 0, 1));
    }
}
