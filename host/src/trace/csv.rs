//! Table as CSV (RFC 4180): a header with the columns' names, numbers in their shortest form that reads back exactly, an
//! empty field for a missing value.

use std::io::{BufWriter, Result, Write};
use std::path::Path;

use super::table::{Cell, Table};
use crate::output::PendingFile;

/// CSV file that is written row by row.
#[derive(Debug)]
pub struct CsvFile(BufWriter<PendingFile>);

impl CsvFile {
    /// File with the header of a table.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn begin(path: &Path, table: &Table<'_>) -> Result<Self> {
        let mut file = BufWriter::new(PendingFile::begin(path)?);
        let names: Vec<&str> = table.columns.iter().map(|column| column.name).collect();
        writeln!(file, "{}", names.join(","))?;
        Ok(CsvFile(file))
    }

    /// Writes a row.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn add(&mut self, row: &[Cell<'_>]) -> Result<()> {
        for (index, cell) in row.iter().enumerate() {
            if index > 0 {
                self.0.write_all(b",")?;
            }
            match cell {
                Cell::Empty => {}
                Cell::Integer(value) => write!(self.0, "{value}")?,
                Cell::Number(value) => write!(self.0, "{value}")?,
                Cell::Text(value) if value.contains([',', '"', '\n', '\r']) => {
                    write!(self.0, "\"{}\"", value.replace('"', "\"\""))?;
                }
                Cell::Text(value) => self.0.write_all(value.as_bytes())?,
                Cell::Flag(value) => write!(self.0, "{value}")?,
            }
        }
        self.0.write_all(b"\n")
    }

    /// Gives the finished file its name.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn finish(self) -> Result<()> {
        self.0.into_inner()?.finish()
    }
}
