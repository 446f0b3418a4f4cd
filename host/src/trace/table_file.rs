//! File of a table, in the format that its suffix names.

use std::io::Result;
use std::path::Path;

use super::csv::CsvFile;
#[cfg(feature = "parquet")]
use super::parquet_file::ParquetFile;
use super::table::{Cell, Table};

/// Format of a trace file: CSV or Parquet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceFormat {
    /// Comma-separated values.
    Csv,
    /// Apache Parquet.
    #[cfg(feature = "parquet")]
    Parquet,
}

/// File of a table that grows. A file that is dropped unfinished leaves nothing behind.
#[derive(Debug)]
pub enum TableFile {
    /// Comma-separated values.
    Csv(CsvFile),
    /// Apache Parquet.
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetFile>),
}

impl TraceFormat {
    /// Format by the suffix of a file.
    ///
    /// # Errors
    /// The suffix names no format, or one that is not built in.
    pub fn of(path: &Path) -> std::result::Result<Self, String> {
        let suffix = path.extension().map(|suffix| suffix.to_string_lossy().to_lowercase());
        match suffix.as_deref() {
            Some("csv") => Ok(TraceFormat::Csv),
            #[cfg(feature = "parquet")]
            Some("parquet") => Ok(TraceFormat::Parquet),
            #[cfg(not(feature = "parquet"))]
            Some("parquet") => Err(format!(
                "{}, or give a name that ends in .csv",
                crate::features::not_built_in("Parquet files", "parquet")
            )),
            _ => Err(format!("{}: give a name that ends in .parquet or .csv", path.display())),
        }
    }
}

impl TraceFormat {
    /// Suffix of its files.
    pub const fn suffix(self) -> &'static str {
        match self {
            TraceFormat::Csv => "csv",
            #[cfg(feature = "parquet")]
            TraceFormat::Parquet => "parquet",
        }
    }
}

impl TableFile {
    /// New file without rows.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn begin(format: TraceFormat, path: &Path, table: &Table<'_>) -> Result<Self> {
        match format {
            TraceFormat::Csv => CsvFile::begin(path, table).map(TableFile::Csv),
            #[cfg(feature = "parquet")]
            TraceFormat::Parquet => Ok(TableFile::Parquet(Box::new(ParquetFile::begin(path, table)?))),
        }
    }

    /// Adds a row, whose cells are in the order of the columns.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, row: &[Cell<'_>]) -> Result<()> {
        match self {
            TableFile::Csv(file) => file.add(row),
            #[cfg(feature = "parquet")]
            TableFile::Parquet(file) => file.add(row),
        }
    }

    /// Writes the rest, and gives the finished file its name.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(self) -> Result<()> {
        match self {
            TableFile::Csv(file) => file.finish(),
            #[cfg(feature = "parquet")]
            TableFile::Parquet(file) => file.finish(),
        }
    }
}
