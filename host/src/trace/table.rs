//! Table: its columns, and the cells of a row.

use serde::Serialize;

/// Version of all tables' columns: it grows when a column changes its meaning, its unit or its name, or is removed.
pub const SCHEMA: u32 = 1;

/// Type of a column's values. Every value may be missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Whole number of 64 bits.
    Integer,
    /// Number of double precision.
    Number,
    /// Word.
    Text,
    /// True or false.
    Flag,
}

/// Column of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TableColumn {
    /// Name, which ends in the unit if there is one.
    pub name: &'static str,
    /// Unit; empty without one.
    pub unit: &'static str,
    /// Type of the values.
    pub kind: Kind,
    /// Meaning.
    pub about: &'static str,
}

/// Table of a trace: name, meaning and columns.
#[derive(Debug)]
pub struct Table {
    /// Name in the metadata.
    pub name: &'static str,
    /// Addition to the name of the file.
    pub suffix: &'static str,
    /// Columns in their order.
    pub columns: &'static [TableColumn],
}

/// Value in a cell of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// No value.
    Empty,
    /// Whole number.
    Integer(i64),
    /// Finite number.
    Number(f64),
    /// Word.
    Text(&'static str),
    /// True or false.
    Flag(bool),
}

impl TableColumn {
    /// Column of whole numbers without a unit.
    pub const fn integer(name: &'static str, about: &'static str) -> Self {
        TableColumn { name, unit: "", kind: Kind::Integer, about }
    }

    /// Column of numbers in a unit.
    pub const fn number(name: &'static str, unit: &'static str, about: &'static str) -> Self {
        TableColumn { name, unit, kind: Kind::Number, about }
    }

    /// Column of whole percentages.
    pub const fn percent(name: &'static str, about: &'static str) -> Self {
        TableColumn { name, unit: "%", kind: Kind::Integer, about }
    }

    /// Column of words.
    pub const fn text(name: &'static str, about: &'static str) -> Self {
        TableColumn { name, unit: "", kind: Kind::Text, about }
    }

    /// Column of flags.
    pub const fn flag(name: &'static str, about: &'static str) -> Self {
        TableColumn { name, unit: "", kind: Kind::Flag, about }
    }
}

impl Table {
    /// Description of the table as JSON, for the metadata of a file.
    pub fn metadata(&self) -> String {
        let Table { name, columns, .. } = self;
        serde_json::json!({ "schema": SCHEMA, "table": name, "columns": columns }).to_string()
    }
}

impl<T> From<Option<T>> for Cell
where
    Cell: From<T>,
{
    fn from(value: Option<T>) -> Self {
        value.map_or(Cell::Empty, Cell::from)
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        if value.is_finite() { Cell::Number(value) } else { Cell::Empty }
    }
}

impl From<i64> for Cell {
    fn from(value: i64) -> Self {
        Cell::Integer(value)
    }
}

impl From<u32> for Cell {
    fn from(value: u32) -> Self {
        Cell::Integer(value.into())
    }
}

impl From<&'static str> for Cell {
    fn from(value: &'static str) -> Self {
        Cell::Text(value)
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Cell::Flag(value)
    }
}
