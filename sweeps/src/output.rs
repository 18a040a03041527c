//! Results as files. A file is written under a temporary name and renamed when it is complete, so that no
//! partial file has its name; and it contains its digest.

use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use datafusion::arrow::array::{Array, ArrayRef, AsArray, RecordBatch};
use datafusion::arrow::csv;
use datafusion::arrow::datatypes::{DataType, Field, Schema, SchemaRef};
use datafusion::parquet::arrow::ArrowWriter;
use datafusion::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use datafusion::parquet::basic::Compression;
use datafusion::parquet::file::metadata::KeyValue;
use datafusion::parquet::file::properties::WriterProperties;

use crate::failure::Failure;
use crate::functions::hash_rows;

const DIGEST: &str = "hodograph.digest";
const ROWS: &str = "hodograph.rows";

/// The digest of rows, independent of their order: their number, and the sum of their hashes modulo 2^64.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Digest {
    /// number of rows
    pub rows: u64,
    /// sum of hashes
    pub sum: u64,
}

impl Digest {
    /// Adds the rows of a batch.
    ///
    /// # Errors
    ///
    /// A column whose type has no hash.
    pub fn add(&mut self, batch: &RecordBatch) -> Result<(), Failure> {
        self.rows += batch.num_rows() as u64;
        let hashes = hash_rows(batch.columns(), batch.num_rows())?;
        self.sum = hashes.into_iter().fold(self.sum, u64::wrapping_add);
        Ok(())
    }

    fn of_metadata(entries: Option<&Vec<KeyValue>>) -> Option<Self> {
        let value = |key: &str| entries?.iter().find(|entry| entry.key == key)?.value.clone();
        Some(Digest { rows: value(ROWS)?.parse().ok()?, sum: u64::from_str_radix(&value(DIGEST)?, 16).ok()? })
    }
}

impl std::fmt::Display for Digest {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{:016x} of {} rows", self.sum, self.rows)
    }
}

/// The metadata on the origin of a file: names and texts.
pub type Origin = Vec<(String, String)>;

/// The origin of the rows of a sweep.
pub fn origin(sql: &str) -> Origin {
    let fused = if cfg!(target_feature = "fma") { "with" } else { "without" };
    let target = format!("{}, {fused} fused multiply-add", std::env::consts::ARCH);
    [("sql", sql), ("version", env!("CARGO_PKG_VERSION")), ("target", &target)]
        .map(|(key, value)| (format!("hodograph.{key}"), value.to_owned()))
        .to_vec()
}

enum Writer {
    Parquet(Box<ArrowWriter<File>>),
    Csv(Box<csv::Writer<File>>),
}

/// A file that is being written.
pub struct Sink {
    target: PathBuf,
    temporary: PathBuf,
    writer: Option<Writer>,
    file: File,
    origin: Origin,
    digest: Digest,
}

fn beside(path: &Path, end: &str) -> PathBuf {
    let mut name = path.file_name().map(OsString::from).unwrap_or_default();
    name.push(end);
    path.with_file_name(name)
}

/// Checks that a result can be written there: as `.parquet` or `.csv`, in an existing directory, as a new
/// file.
///
/// # Errors
///
/// The reason why it cannot.
pub fn check(path: &Path) -> Result<(), Failure> {
    let known = matches!(path.extension().and_then(|end| end.to_str()), Some("parquet" | "csv"));
    if !known {
        return Err(Failure::Input(format!(
            "--out {}: the name must end with .parquet or .csv",
            path.display()
        )));
    }
    if path.exists() && !path.is_file() {
        return Err(Failure::Input(format!("--out {}: this is no regular file", path.display())));
    }
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !parent.is_dir() {
        return Err(Failure::Input(format!(
            "--out {}: there is no directory {}",
            path.display(),
            parent.display()
        )));
    }
    Ok(())
}

impl Sink {
    /// Begins a file.
    ///
    /// # Errors
    ///
    /// The name ends neither in `.parquet` nor in `.csv`, or the file cannot be written.
    pub fn create(target: &Path, schema: &SchemaRef, origin: Origin) -> Result<Self, Failure> {
        check(target)?;
        let temporary = beside(target, ".partial");
        let failed = |error: &dyn std::fmt::Display| Failure::file(&temporary, "write", error);
        let file = File::create(&temporary).map_err(|error| failed(&error))?;
        let copy = file.try_clone().map_err(|error| failed(&error))?;
        let writer = if target.extension().is_some_and(|end| end == "csv") {
            Writer::Csv(Box::new(csv::WriterBuilder::new().with_header(true).build(copy)))
        } else {
            let properties =
                WriterProperties::builder().set_compression(Compression::ZSTD(Default::default())).build();
            let writer = ArrowWriter::try_new(copy, Arc::clone(schema), Some(properties))
                .map_err(|error| failed(&error))?;
            Writer::Parquet(Box::new(writer))
        };
        let target = target.to_owned();
        Ok(Sink { target, temporary, writer: Some(writer), file, origin, digest: Digest::default() })
    }

    /// Writes rows.
    ///
    /// # Errors
    ///
    /// The disk is full, or a type has no digest.
    pub fn write(&mut self, batch: &RecordBatch) -> Result<(), Failure> {
        self.digest.add(batch)?;
        let target = &self.target;
        match &mut self.writer {
            Some(Writer::Parquet(writer)) => {
                writer.write(batch).map_err(|error| Failure::file(target, "write", error))?;
                // the buffer is bounded by bytes as well as by rows
                if writer.in_progress_size() > 64 << 20 {
                    writer.flush().map_err(|error| Failure::file(target, "write", error))?;
                }
                Ok(())
            }
            Some(Writer::Csv(writer)) => {
                writer.write(&flat(batch)?).map_err(|error| Failure::file(target, "write", error))
            }
            None => Ok(()),
        }
    }

    /// Completes the file and renames it.
    ///
    /// # Errors
    ///
    /// The disk is full.
    pub fn finish(mut self) -> Result<Digest, Failure> {
        let target = self.target.clone();
        let failed = |error: &dyn std::fmt::Display| Failure::file(&target, "write", error);
        let mut entries = std::mem::take(&mut self.origin);
        entries.push((ROWS.to_owned(), self.digest.rows.to_string()));
        entries.push((DIGEST.to_owned(), format!("{:016x}", self.digest.sum)));
        match self.writer.take() {
            Some(Writer::Parquet(mut writer)) => {
                for (key, value) in entries {
                    writer.append_key_value_metadata(KeyValue::new(key, value));
                }
                writer.close().map_err(|error| failed(&error))?;
            }
            Some(Writer::Csv(writer)) => {
                drop(writer);
                let lines: String = entries
                    .iter()
                    .map(|(key, value)| format!("{key}: {}\n", value.replace('\n', " ")))
                    .collect();
                crate::output::text(&beside(&target, ".digest"), &lines)?;
            }
            None => {}
        }
        let placed = self.file.sync_all().and_then(|()| std::fs::rename(&self.temporary, &target));
        placed.map_err(|error| {
            // A digest without its file would be useless; a Parquet file contains its own.
            let _ = std::fs::remove_file(beside(&target, ".digest"));
            failed(&error)
        })?;
        // the file is complete now, so dropping must not remove it
        self.temporary = PathBuf::new();
        Ok(self.digest)
    }
}

impl Drop for Sink {
    fn drop(&mut self) {
        if !self.temporary.as_os_str().is_empty() {
            self.writer = None;
            // errors cannot be handled here
            let _ = std::fs::remove_file(&self.temporary);
        }
    }
}

/// Writes a small text, completely or not at all.
///
/// # Errors
///
/// The disk is full.
pub fn text(path: &Path, text: &str) -> Result<(), Failure> {
    let temporary = beside(path, ".partial");
    let write = || {
        std::fs::write(&temporary, text)?;
        File::open(&temporary)?.sync_all()?;
        std::fs::rename(&temporary, path)
    };
    write().map_err(|error| {
        let _ = std::fs::remove_file(&temporary);
        Failure::file(path, "write", error)
    })
}

/// The rows with the fields of structs as separate columns, `c_kind` for the field `kind` of `c`; lists as
/// text.
///
/// # Errors
///
/// The engine's.
pub fn flat(batch: &RecordBatch) -> Result<RecordBatch, Failure> {
    let mut fields = Vec::new();
    let mut columns: Vec<ArrayRef> = Vec::new();
    for (field, column) in batch.schema().fields().iter().zip(batch.columns()) {
        spread(field.name(), column, &mut fields, &mut columns)?;
    }
    let schema = Arc::new(Schema::new(fields));
    RecordBatch::try_new(schema, columns).map_err(|error| Failure::Engine(error.to_string()))
}

fn spread(
    name: &str,
    column: &ArrayRef,
    fields: &mut Vec<Field>,
    columns: &mut Vec<ArrayRef>,
) -> Result<(), Failure> {
    match column.data_type() {
        DataType::Struct(inner) => {
            for (field, column) in inner.iter().zip(column.as_struct().columns()) {
                spread(&format!("{name}_{}", field.name()), column, fields, columns)?;
            }
        }
        DataType::List(_) => {
            let text = datafusion::arrow::compute::cast(column, &DataType::Utf8)
                .map_err(|error| Failure::Engine(error.to_string()))?;
            fields.push(Field::new(name, DataType::Utf8, true));
            columns.push(text);
        }
        other => {
            fields.push(Field::new(name, other.clone(), true));
            columns.push(Arc::clone(column));
        }
    }
    Ok(())
}

/// The digest that a Parquet file contains, if any, and that of its rows.
///
/// # Errors
///
/// The file cannot be read.
pub fn digests(path: &Path) -> Result<(Option<Digest>, Digest), Failure> {
    let (stated, reader) = open(path)?;
    let mut found = Digest::default();
    for batch in reader.build().map_err(|error| Failure::file(path, "read", error))? {
        found.add(&batch.map_err(|error| Failure::file(path, "read", error))?)?;
    }
    Ok((stated, found))
}

/// The digest that a Parquet file contains, without reading its rows.
///
/// # Errors
///
/// The file cannot be read.
pub fn stated(path: &Path) -> Result<Option<Digest>, Failure> {
    open(path).map(|(stated, _)| stated)
}

fn open(path: &Path) -> Result<(Option<Digest>, ParquetRecordBatchReaderBuilder<File>), Failure> {
    let file = File::open(path).map_err(|error| Failure::file(path, "read", error))?;
    let reader =
        ParquetRecordBatchReaderBuilder::try_new(file).map_err(|error| Failure::file(path, "read", error))?;
    let stated = Digest::of_metadata(reader.metadata().file_metadata().key_value_metadata());
    Ok((stated, reader))
}
