//! Python class `Table`: a table of a simulated run in memory, passed to other libraries through the Arrow C data interface.

use std::collections::HashMap;
use std::sync::Arc;

use arcfeed::trace::{MemoryColumn, MemoryTable, MemoryValues};
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    ArrayRef, BooleanArray, Float64Array, Int64Array, LargeStringArray, RecordBatch, RecordBatchIterator,
};
use arrow_buffer::{BooleanBuffer, Buffer, NullBuffer, OffsetBuffer, ScalarBuffer};
use arrow_schema::{ArrowError, Field, Schema};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

/// Key of the schema with units, as in Parquet files.
const METADATA_KEY: &str = "arcfeed";

/// Table of a simulated run. `pandas.DataFrame.from_arrow`, `polars.DataFrame`, `pyarrow.table` and DuckDB read it where it
/// lies, without a copy. docs/traces.md has its columns.
#[pyclass(frozen, module = "arcfeed")]
pub struct Table(RecordBatch);

#[pymethods]
impl Table {
    /// Names of the columns.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.0.schema().fields().iter().map(|field| field.name().clone()).collect()
    }

    fn __len__(&self) -> usize {
        self.0.num_rows()
    }

    /// Stream of the Arrow C data interface; the caller gets the types of the table, whatever it requests.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        let reader = RecordBatchIterator::new([Ok(self.0.clone())], self.0.schema());
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(reader)), c"arrow_array_stream")
    }
}

impl Table {
    /// Table for Python that takes over the memory of these columns; fails if they do not fit together.
    pub fn new(table: MemoryTable) -> PyResult<Self> {
        let metadata = HashMap::from([(METADATA_KEY.to_owned(), table.metadata)]);
        let columns = table.columns.into_iter().map(|column| {
            let name = column.name.clone();
            array(column).map(|array| (Field::new(name, array.data_type().clone(), true), array))
        });
        let columns = columns.collect::<Result<Vec<_>, _>>().map_err(defect)?;
        let (fields, arrays): (Vec<Field>, Vec<ArrayRef>) = columns.into_iter().unzip();
        let schema = Arc::new(Schema::new_with_metadata(fields, metadata));
        RecordBatch::try_new(schema, arrays).map(Table).map_err(defect)
    }
}

/// Array of Arrow with the values of a column; only flags, here and for missing values, become bits.
fn array(column: MemoryColumn) -> Result<ArrayRef, ArrowError> {
    let nulls = Some(NullBuffer::from(column.is_present));
    Ok(match column.values {
        MemoryValues::Integers(values) => Arc::new(Int64Array::try_new(ScalarBuffer::from(values), nulls)?),
        MemoryValues::Numbers(values) => Arc::new(Float64Array::try_new(ScalarBuffer::from(values), nulls)?),
        MemoryValues::Words { letters, offsets } => {
            let offsets = OffsetBuffer::new(ScalarBuffer::from(offsets));
            Arc::new(LargeStringArray::try_new(offsets, Buffer::from_vec(letters), nulls)?)
        }
        MemoryValues::Flags(values) => Arc::new(BooleanArray::new(BooleanBuffer::from(values), nulls)),
    })
}

fn defect(error: ArrowError) -> PyErr {
    PyRuntimeError::new_err(format!("a defect of arcfeed: {error}"))
}
