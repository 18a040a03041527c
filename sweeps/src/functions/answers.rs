//! Columns of answers: a struct of named fields for each row. `kind` is `ok`, or the reason why the other
//! fields are NULL.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, Float64Array, Int32Array, StringBuilder, StructArray};
use datafusion::arrow::buffer::NullBuffer;
use datafusion::arrow::datatypes::{DataType, Field, Fields};
use hodograph::Path;

/// The kind of a row that has an answer.
pub const OK: &str = "ok";
/// The kind of a row with a NULL among its arguments.
pub const NULL: &str = "null";

/// The name of the phases of a collision, as `sliding, then sticking`.
pub fn path_name(path: Path) -> &'static str {
    match path {
        Path::Sliding => "sliding",
        Path::SlidingThenSticking => "sliding, then sticking",
        Path::SlidingThenRenewal => "sliding, then renewal",
        Path::Sticking => "sticking",
        Path::Renewal => "renewal",
    }
}

/// The fields of an answer: `kind`, for collisions `path` and `compressions`, then the numbers.
pub fn fields(collision: bool, numbers: &[String]) -> Fields {
    let mut fields = vec![Field::new("kind", DataType::Utf8, false)];
    if collision {
        fields.push(Field::new("path", DataType::Utf8, true));
        fields.push(Field::new("compressions", DataType::Int32, true));
    }
    fields.extend(numbers.iter().map(|name| Field::new(name, DataType::Float64, true)));
    fields.into()
}

/// A builder of answers, row by row.
pub struct Answers {
    kinds: StringBuilder,
    valid: Vec<bool>,
    course: Option<(StringBuilder, Vec<i32>)>,
    numbers: Vec<Vec<f64>>,
}

impl Answers {
    /// A builder for this number of rows, each with this number of values.
    pub fn new(collision: bool, numbers: usize, rows: usize) -> Self {
        Answers {
            kinds: StringBuilder::with_capacity(rows, 4 * rows),
            valid: Vec::with_capacity(rows),
            course: collision
                .then(|| (StringBuilder::with_capacity(rows, 12 * rows), Vec::with_capacity(rows))),
            numbers: vec![Vec::with_capacity(rows); numbers],
        }
    }

    /// Appends a row with the numbers of these lists; missing ones are 0.
    pub fn answer(&mut self, course: Option<(Path, u32)>, lists: &[&[f64]]) {
        self.kinds.append_value(OK);
        self.valid.push(true);
        if let Some((paths, compressions)) = &mut self.course {
            let (path, count) = course.unwrap_or((Path::Sliding, 0));
            paths.append_value(path_name(path));
            compressions.push(count as i32);
        }
        let mut columns = self.numbers.iter_mut();
        for list in lists {
            list.iter().zip(&mut columns).for_each(|(&number, column)| column.push(number));
        }
        columns.for_each(|column| column.push(0.0));
    }

    /// Appends a row without an answer.
    pub fn refuse(&mut self, kind: &str) {
        self.kinds.append_value(kind);
        self.valid.push(false);
        if let Some((paths, compressions)) = &mut self.course {
            paths.append_null();
            compressions.push(0);
        }
        self.numbers.iter_mut().for_each(|column| column.push(0.0));
    }

    /// The column of structs.
    pub fn finish(mut self, fields: Fields) -> ArrayRef {
        let nulls = Some(NullBuffer::from(self.valid));
        let mut columns: Vec<ArrayRef> = vec![Arc::new(self.kinds.finish())];
        if let Some((mut paths, compressions)) = self.course {
            columns.push(Arc::new(paths.finish()));
            columns.push(Arc::new(Int32Array::new(compressions.into(), nulls.clone())));
        }
        for column in self.numbers {
            columns.push(Arc::new(Float64Array::new(column.into(), nulls.clone())));
        }
        Arc::new(StructArray::new(fields, columns, None))
    }
}
