//! Serialises `rows(n)` and models for the processes of a cluster: a table of rows as two numbers, a shipped
//! model as its digest, a user's model as its two texts. So every process computes with the same model, or
//! reports that it has another one.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use ballista_core::serde::{BallistaLogicalExtensionCodec, BallistaPhysicalExtensionCodec};
use datafusion::arrow::datatypes::SchemaRef;
use datafusion::catalog::TableProvider;
use datafusion::common::{Result, TableReference, exec_err, plan_err};
use datafusion::datasource::file_format::FileFormatFactory;
use datafusion::execution::TaskContext;
use datafusion::logical_expr::{Extension, LogicalPlan, ScalarUDF};
use datafusion::physical_plan::ExecutionPlan;
use datafusion_proto::logical_plan::LogicalExtensionCodec;
use datafusion_proto::physical_plan::{PhysicalExtensionCodec, PhysicalProtoConverterExtension};

use crate::functions::{ModelFunction, Routine, of_model};
use crate::models::{Model, shipped};
use crate::rows::{Range, RowsExec, RowsTable};

const ROWS: &[u8] = b"hodograph rows 1 ";
const SHIPPED: u8 = 0;
const OWN: u8 = 1;

fn encode_range(range: Range, column: bool, buf: &mut Vec<u8>) {
    buf.extend_from_slice(ROWS);
    buf.extend(range.first.to_le_bytes());
    buf.extend(range.end.to_le_bytes());
    buf.push(u8::from(column));
}

fn decode_range(buf: &[u8]) -> Option<(Range, bool)> {
    let numbers = buf.strip_prefix(ROWS)?;
    let (first, rest) = numbers.split_first_chunk::<8>()?;
    let (end, rest) = rest.split_first_chunk::<8>()?;
    let [column] = rest else { return None };
    Some((Range { first: i64::from_le_bytes(*first), end: i64::from_le_bytes(*end) }, *column != 0))
}

/// A model function as bytes; other functions are found by name.
fn encode_function(function: &ScalarUDF, buf: &mut Vec<u8>) {
    let Some(function) = of_model(function) else { return };
    let model = &function.model;
    buf.push(if model.shipped { SHIPPED } else { OWN });
    buf.extend(model.digest());
    if !model.shipped {
        buf.extend((model.model.len() as u64).to_le_bytes());
        buf.extend(model.model.as_bytes());
        buf.extend(model.derivation.as_bytes());
    }
}

/// The models that were received with plans, by name and digest, so that each is decoded once.
type Arrived = Mutex<HashMap<(String, [u8; 32]), Arc<Model>>>;

fn arrived() -> &'static Arrived {
    static ARRIVED: OnceLock<Arrived> = OnceLock::new();
    ARRIVED.get_or_init(Mutex::default)
}

fn own_model(name: &str, digest: &[u8; 32], texts: &[u8]) -> Option<Arc<Model>> {
    let mut arrived = arrived().lock().unwrap_or_else(PoisonError::into_inner);
    let key = (name.to_owned(), *digest);
    if let Some(model) = arrived.get(&key) {
        return Some(Arc::clone(model));
    }
    let (length, texts) = texts.split_first_chunk::<8>()?;
    let (model, derivation) = texts.split_at_checked(u64::from_le_bytes(*length) as usize)?;
    let model = Model::new(name, str::from_utf8(model).ok()?, str::from_utf8(derivation).ok()?, false);
    if model.digest() != *digest {
        return None;
    }
    let model = Arc::new(model);
    arrived.insert(key, Arc::clone(&model));
    Some(model)
}

fn decode_function(name: &str, buf: &[u8]) -> Result<Arc<ScalarUDF>> {
    let known = Routine::ALL.iter().find_map(|&routine| {
        let model = name.strip_suffix(routine.name())?.strip_suffix('_')?;
        Some((model, routine))
    });
    let (Some((model, routine)), Some((&tag, rest))) = (known, buf.split_first()) else {
        return plan_err!("there is no function {name} in this process");
    };
    let Some((digest, texts)) = rest.split_first_chunk::<32>() else {
        return plan_err!("the model of {name} did not arrive whole");
    };
    let found = match tag {
        SHIPPED => shipped().iter().find(|known| known.name == model && known.digest() == *digest).cloned(),
        _ => own_model(model, digest, texts),
    };
    match found {
        Some(model) => Ok(Arc::new(ScalarUDF::from(ModelFunction::new(model, routine)))),
        None => exec_err!(
            "this process has another version of the model `{model}` than the one who asks: run the same build of hodograph-sweep everywhere"
        ),
    }
}

/// The codec of logical plans.
#[derive(Debug, Default)]
pub struct Logical(BallistaLogicalExtensionCodec);

impl LogicalExtensionCodec for Logical {
    fn try_decode(&self, buf: &[u8], inputs: &[LogicalPlan], ctx: &TaskContext) -> Result<Extension> {
        self.0.try_decode(buf, inputs, ctx)
    }

    fn try_encode(&self, node: &Extension, buf: &mut Vec<u8>) -> Result<()> {
        self.0.try_encode(node, buf)
    }

    fn try_decode_table_provider(
        &self,
        buf: &[u8],
        table: &TableReference,
        schema: SchemaRef,
        ctx: &TaskContext,
    ) -> Result<Arc<dyn TableProvider>> {
        match decode_range(buf) {
            Some((range, _)) => Ok(Arc::new(RowsTable(range))),
            None => self.0.try_decode_table_provider(buf, table, schema, ctx),
        }
    }

    fn try_encode_table_provider(
        &self,
        table: &TableReference,
        node: Arc<dyn TableProvider>,
        buf: &mut Vec<u8>,
    ) -> Result<()> {
        let any: &dyn std::any::Any = node.as_ref();
        match any.downcast_ref::<RowsTable>() {
            Some(rows) => {
                encode_range(rows.0, true, buf);
                Ok(())
            }
            None => self.0.try_encode_table_provider(table, node, buf),
        }
    }

    fn try_decode_file_format(&self, buf: &[u8], ctx: &TaskContext) -> Result<Arc<dyn FileFormatFactory>> {
        self.0.try_decode_file_format(buf, ctx)
    }

    fn try_encode_file_format(&self, buf: &mut Vec<u8>, node: Arc<dyn FileFormatFactory>) -> Result<()> {
        self.0.try_encode_file_format(buf, node)
    }

    fn try_decode_udf(&self, name: &str, buf: &[u8]) -> Result<Arc<ScalarUDF>> {
        decode_function(name, buf)
    }

    fn try_encode_udf(&self, node: &ScalarUDF, buf: &mut Vec<u8>) -> Result<()> {
        encode_function(node, buf);
        Ok(())
    }
}

/// The codec of physical plans.
#[derive(Debug, Default)]
pub struct Physical(BallistaPhysicalExtensionCodec);

impl PhysicalExtensionCodec for Physical {
    fn try_decode(
        &self,
        buf: &[u8],
        inputs: &[Arc<dyn ExecutionPlan>],
        ctx: &TaskContext,
        converter: &dyn PhysicalProtoConverterExtension,
    ) -> Result<Arc<dyn ExecutionPlan>> {
        match (decode_range(buf), inputs) {
            (Some((_, column)), [ranges]) => Ok(Arc::new(RowsExec::new(Arc::clone(ranges), column))),
            _ => self.0.try_decode(buf, inputs, ctx, converter),
        }
    }

    fn try_encode(
        &self,
        node: Arc<dyn ExecutionPlan>,
        buf: &mut Vec<u8>,
        converter: &dyn PhysicalProtoConverterExtension,
    ) -> Result<()> {
        match node.downcast_ref::<RowsExec>() {
            Some(rows) => {
                // its rows are in its input
                encode_range(Range { first: 0, end: 0 }, rows.column, buf);
                Ok(())
            }
            None => self.0.try_encode(node, buf, converter),
        }
    }

    fn try_decode_udf(&self, name: &str, buf: &[u8]) -> Result<Arc<ScalarUDF>> {
        decode_function(name, buf)
    }

    fn try_encode_udf(&self, node: &ScalarUDF, buf: &mut Vec<u8>) -> Result<()> {
        encode_function(node, buf);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_arrives_as_it_left() {
        let range = Range { first: 3, end: i64::MAX };
        let mut bytes = Vec::new();
        encode_range(range, false, &mut bytes);
        assert_eq!(decode_range(&bytes), Some((range, false)));
        assert_eq!(decode_range(&bytes[..bytes.len() - 1]), None);
    }

    #[test]
    fn a_model_of_another_text_is_refused() {
        let own = |text: &str| {
            ScalarUDF::from(ModelFunction::new(Arc::new(Model::new("own", text, "", false)), Routine::Energy))
        };
        let mut bytes = Vec::new();
        encode_function(&own("mechanism Own;"), &mut bytes);
        assert!(decode_function("own_energy", &bytes).is_ok());
        let mut other = Vec::new();
        encode_function(&own("mechanism Other;"), &mut other);
        // the digest of one model with the texts of another
        let mixed: Vec<u8> = other[..33].iter().chain(&bytes[33..]).copied().collect();
        assert!(decode_function("own_energy", &mixed).is_err());
        let Some(sleds) = shipped().iter().find(|model| model.name == "two_sleds") else {
            panic!("not shipped")
        };
        let mut bytes = Vec::new();
        encode_function(
            &ScalarUDF::from(ModelFunction::new(Arc::clone(sleds), Routine::Collide)),
            &mut bytes,
        );
        assert!(decode_function("two_sleds_collide", &bytes).is_ok());
        bytes[5] ^= 1;
        let error = decode_function("two_sleds_collide", &bytes).err().map(|error| error.to_string());
        assert!(error.is_some_and(|error| error.contains("another version")));
    }
}
