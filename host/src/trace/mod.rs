//! Traces: time series and events of a run as tables for data analysis (docs/traces.md).
//!
//! A table has a row for each entry, and typed columns whose names carry their units. Rows are written as they come, so
//! a trace of any length needs the memory of one group of rows.

pub mod table;

pub mod tables;

mod csv;

#[cfg(feature = "parquet")]
mod parquet_file;

mod table_file;

mod memory_table;

pub use memory_table::{MemoryColumn, MemoryTable, MemoryValues};
pub use table_file::{TableFile, TraceFormat};
