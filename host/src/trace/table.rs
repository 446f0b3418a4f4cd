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
    /// Text of one word.
    Text,
    /// True or false.
    Flag,
}

/// Column of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TableColumn<'a> {
    /// Name, which ends in the unit if there is one.
    pub name: &'a str,
    /// Unit; empty without one.
    pub unit: &'a str,
    /// Type of the values.
    pub kind: Kind,
    /// Meaning, as a sentence for the metadata.
    pub about: &'a str,
}

/// Table of a trace: name, meaning and columns.
#[derive(Debug)]
pub struct Table<'a> {
    /// Name in the metadata.
    pub name: &'a str,
    /// Suffix that the table adds to the name of the file.
    pub suffix: &'static str,
    /// Columns in their order.
    pub columns: &'a [TableColumn<'a>],
}

/// Value in a cell of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// No value.
    Empty,
    /// Whole number.
    Integer(i64),
    /// Finite number.
    Number(f64),
    /// Word.
    Text(&'a str),
    /// True or false.
    Flag(bool),
}

impl<'a> TableColumn<'a> {
    /// Column of whole numbers without a unit.
    pub const fn integer(name: &'a str, about: &'a str) -> Self {
        TableColumn { name, unit: "", kind: Kind::Integer, about }
    }

    /// Column of numbers in a unit.
    pub const fn number(name: &'a str, unit: &'a str, about: &'a str) -> Self {
        TableColumn { name, unit, kind: Kind::Number, about }
    }

    /// Column of whole percentages.
    pub const fn percent(name: &'a str, about: &'a str) -> Self {
        TableColumn { name, unit: "%", kind: Kind::Integer, about }
    }

    /// Column of words.
    pub const fn text(name: &'a str, about: &'a str) -> Self {
        TableColumn { name, unit: "", kind: Kind::Text, about }
    }

    /// Column of flags.
    pub const fn flag(name: &'a str, about: &'a str) -> Self {
        TableColumn { name, unit: "", kind: Kind::Flag, about }
    }
}

impl Table<'_> {
    /// Description of the table as JSON, for the metadata of a file.
    pub fn metadata(&self) -> String {
        let Table { name, columns, .. } = self;
        serde_json::json!({ "schema": SCHEMA, "table": name, "columns": columns }).to_string()
    }
}

impl<'a, T> From<Option<T>> for Cell<'a>
where
    Cell<'a>: From<T>,
{
    fn from(value: Option<T>) -> Self {
        value.map_or(Cell::Empty, Cell::from)
    }
}

impl From<f64> for Cell<'_> {
    fn from(value: f64) -> Self {
        if value.is_finite() { Cell::Number(value) } else { Cell::Empty }
    }
}

impl From<i64> for Cell<'_> {
    fn from(value: i64) -> Self {
        Cell::Integer(value)
    }
}

impl From<u32> for Cell<'_> {
    fn from(value: u32) -> Self {
        Cell::Integer(value.into())
    }
}

impl<'a> From<&'a str> for Cell<'a> {
    fn from(value: &'a str) -> Self {
        Cell::Text(value)
    }
}

impl From<bool> for Cell<'_> {
    fn from(value: bool) -> Self {
        Cell::Flag(value)
    }
}
