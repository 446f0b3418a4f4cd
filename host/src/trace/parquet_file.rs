//! Table as Apache Parquet.
//!
//! Rows are collected in columns and written as a row group when there are enough. Only the groups' metadata stay in memory. Numbers are
//! split into byte streams, which Snappy compresses well where values change slowly; all other columns have a dictionary.
//! The key `arcfeed` of the file's metadata has the schema with units ([`Table::metadata`]).

use std::io::{Error, Result};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, Type, TypePtr};

use super::table::{Cell, Kind, Table, TableColumn};
use crate::output::PendingFile;

/// Rows of a group: about 14 MB of a table with 27 columns.
const GROUP_ROWS: usize = 1 << 16;

/// Key of the schema in the file's metadata.
const METADATA_KEY: &str = "arcfeed";

/// Parquet file that is written row by row.
#[derive(Debug)]
pub struct ParquetFile {
    writer: SerializedFileWriter<PendingFile>,
    columns: Vec<ColumnValues>,
    rows: usize,
}

/// Values of a column in the group that is being collected.
#[derive(Debug)]
struct ColumnValues {
    values: Values,
    /// For each row 1, or 0 where the value is missing.
    levels: Vec<i16>,
}

/// Present values.
#[derive(Debug)]
enum Values {
    Integers(Vec<i64>),
    Numbers(Vec<f64>),
    Words(Vec<ByteArray>),
    Flags(Vec<bool>),
}

impl ParquetFile {
    /// New file without rows.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn begin(path: &Path, table: &Table<'_>) -> Result<Self> {
        let mut properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            // The writer keeps statistics and indexes in memory up to the end of the file: those of pages would be most of them.
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_offset_index_disabled(true)
            .set_created_by(format!("arcfeed {}", env!("CARGO_PKG_VERSION")))
            .set_key_value_metadata(Some(vec![KeyValue::new(METADATA_KEY.to_owned(), table.metadata())]));
        for column in table.columns.iter().filter(|column| column.kind == Kind::Number) {
            let path = ColumnPath::from(column.name);
            properties = properties.set_column_dictionary_enabled(path.clone(), false);
            properties = properties.set_column_encoding(path, Encoding::BYTE_STREAM_SPLIT);
        }
        let file = PendingFile::begin(path)?;
        let schema = schema(table).map_err(io_error)?;
        let writer = SerializedFileWriter::new(file, schema, Arc::new(properties.build())).map_err(io_error)?;
        let columns = table.columns.iter().map(|column| ColumnValues::new(column.kind)).collect();
        Ok(ParquetFile { writer, columns, rows: 0 })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A group of rows cannot be written.
    pub fn add(&mut self, row: &[Cell<'_>]) -> Result<()> {
        self.columns.iter_mut().zip(row).for_each(|(column, cell)| column.add(cell));
        self.rows += 1;
        if self.rows == GROUP_ROWS { self.flush() } else { Ok(()) }
    }

    /// Writes the rest, and gives the finished file its name.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn finish(mut self) -> Result<()> {
        self.flush()?;
        self.writer.into_inner().map_err(io_error)?.finish()
    }

    /// Writes the collected rows as a group.
    fn flush(&mut self) -> Result<()> {
        if std::mem::take(&mut self.rows) == 0 {
            return Ok(());
        }
        let mut group = self.writer.next_row_group().map_err(io_error)?;
        for column in &mut self.columns {
            let writer = group.next_column().map_err(io_error)?;
            writer.map_or(Ok(()), |writer| column.write(writer)).map_err(io_error)?;
        }
        group.close().map(drop).map_err(io_error)
    }
}

impl ColumnValues {
    fn new(kind: Kind) -> Self {
        let values = match kind {
            Kind::Integer => Values::Integers(Vec::new()),
            Kind::Number => Values::Numbers(Vec::new()),
            Kind::Text => Values::Words(Vec::new()),
            Kind::Flag => Values::Flags(Vec::new()),
        };
        ColumnValues { values, levels: Vec::new() }
    }

    /// Adds a value of the column's kind; any other is missing.
    fn add(&mut self, cell: &Cell<'_>) {
        let is_present = match (&mut self.values, cell) {
            (Values::Integers(values), Cell::Integer(value)) => push(values, *value),
            (Values::Numbers(values), Cell::Number(value)) => push(values, *value),
            (Values::Words(values), Cell::Text(value)) => push(values, ByteArray::from(*value)),
            (Values::Flags(values), Cell::Flag(value)) => push(values, *value),
            _ => false,
        };
        self.levels.push(is_present.into());
    }

    fn write(&mut self, writer: SerializedColumnWriter<'_>) -> parquet::errors::Result<()> {
        match &mut self.values {
            Values::Integers(values) => write_values::<Int64Type>(writer, values, &self.levels),
            Values::Numbers(values) => write_values::<DoubleType>(writer, values, &self.levels),
            Values::Words(values) => write_values::<ByteArrayType>(writer, values, &self.levels),
            Values::Flags(values) => write_values::<BoolType>(writer, values, &self.levels),
        }?;
        self.levels.clear();
        Ok(())
    }
}

fn push<T>(values: &mut Vec<T>, value: T) -> bool {
    values.push(value);
    true
}

fn write_values<T: DataType>(
    mut writer: SerializedColumnWriter<'_>,
    values: &mut Vec<T::T>,
    levels: &[i16],
) -> parquet::errors::Result<()> {
    writer.typed::<T>().write_batch(values, Some(levels), None)?;
    values.clear();
    writer.close()
}

fn schema(table: &Table<'_>) -> parquet::errors::Result<TypePtr> {
    let fields =
        table.columns.iter().map(|column| field(column).map(Arc::new)).collect::<parquet::errors::Result<_>>()?;
    Type::group_type_builder(table.name).with_fields(fields).build().map(Arc::new)
}

fn field(column: &TableColumn<'_>) -> parquet::errors::Result<Type> {
    let (physical, logical) = match column.kind {
        Kind::Integer => (PhysicalType::INT64, None),
        Kind::Number => (PhysicalType::DOUBLE, None),
        Kind::Text => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
        Kind::Flag => (PhysicalType::BOOLEAN, None),
    };
    let builder = Type::primitive_type_builder(column.name, physical);
    builder.with_repetition(Repetition::OPTIONAL).with_logical_type(logical).build()
}

/// Error of the file system behind an error of the writer.
fn io_error(error: ParquetError) -> Error {
    match error {
        ParquetError::External(inner) => match inner.downcast::<Error>() {
            Ok(error) => *error,
            Err(other) => Error::other(other),
        },
        other => Error::other(other),
    }
}
