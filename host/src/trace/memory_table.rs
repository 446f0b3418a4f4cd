//! Table in memory, column by column, for a caller that runs a command as a function.
//!
//! The columns are laid out as Apache Arrow has them, so that the Python package hands them over without a copy. A row of
//! the samples takes about 250 bytes.

use super::table::{Cell, Kind, Table, TableColumn};

/// Table of a run in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct MemoryTable {
    /// Name of the file that `--trace run` would write, without a suffix.
    pub name: String,
    /// Schema with units ([`Table::metadata`]).
    pub metadata: String,
    /// Columns of the same length.
    pub columns: Vec<MemoryColumn>,
}

/// Column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct MemoryColumn {
    /// Name of the column.
    pub name: String,
    /// Values of all rows; where a value is missing, a meaningless one stands in its place.
    pub values: MemoryValues,
    /// For each row whether the value is present.
    pub is_present: Vec<bool>,
}

/// Values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum MemoryValues {
    /// Whole numbers.
    Integers(Vec<i64>),
    /// Numbers.
    Numbers(Vec<f64>),
    /// Words: all letters one after the other in UTF-8, and the offset of each word with that of the end.
    Words {
        /// Letters.
        letters: Vec<u8>,
        /// Offsets, one more than there are words.
        offsets: Vec<i64>,
    },
    /// Flags.
    Flags(Vec<bool>),
}

impl MemoryTable {
    /// Table without rows.
    pub fn new(name: String, table: &Table<'_>) -> Self {
        let column = |column: &TableColumn<'_>| MemoryColumn {
            name: column.name.to_owned(),
            values: MemoryValues::new(column.kind),
            is_present: Vec::new(),
        };
        MemoryTable { name, metadata: table.metadata(), columns: table.columns.iter().map(column).collect() }
    }

    /// Adds a row, whose cells are in the order of the columns.
    pub fn add(&mut self, row: &[Cell<'_>]) {
        self.columns.iter_mut().zip(row).for_each(|(column, cell)| column.is_present.push(column.values.add(cell)));
    }
}

impl MemoryValues {
    fn new(kind: Kind) -> Self {
        match kind {
            Kind::Integer => MemoryValues::Integers(Vec::new()),
            Kind::Number => MemoryValues::Numbers(Vec::new()),
            Kind::Text => MemoryValues::Words { letters: Vec::new(), offsets: vec![0] },
            Kind::Flag => MemoryValues::Flags(Vec::new()),
        }
    }

    /// Adds a value of the column's kind, or a placeholder for any other; whether it is such a value.
    fn add(&mut self, cell: &Cell<'_>) -> bool {
        match (self, cell) {
            (MemoryValues::Integers(values), Cell::Integer(value)) => values.push(*value),
            (MemoryValues::Numbers(values), Cell::Number(value)) => values.push(*value),
            (MemoryValues::Words { letters, offsets }, Cell::Text(value)) => {
                letters.extend(value.as_bytes());
                offsets.push(letters.len() as i64);
            }
            (MemoryValues::Flags(values), Cell::Flag(value)) => values.push(*value),
            (values, _) => {
                values.add_placeholder();
                return false;
            }
        }
        true
    }

    fn add_placeholder(&mut self) {
        match self {
            MemoryValues::Integers(values) => values.push(0),
            MemoryValues::Numbers(values) => values.push(f64::NAN),
            MemoryValues::Words { letters, offsets } => offsets.push(letters.len() as i64),
            MemoryValues::Flags(values) => values.push(false),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_has_a_value_for_every_row_and_marks_those_that_are_missing() {
        let columns = [
            TableColumn::integer("i", ""),
            TableColumn::number("x", "", ""),
            TableColumn::text("t", ""),
            TableColumn::flag("f", ""),
        ];
        let mut table = MemoryTable::new("run".into(), &Table { name: "t", suffix: "", columns: &columns });
        table.add(&[Cell::Integer(7), Cell::Number(0.5), Cell::Text("é"), Cell::Flag(true)]);
        table.add(&[Cell::Empty; 4]);
        table.add(&[Cell::Integer(-1), Cell::Number(2.0), Cell::Text("law"), Cell::Flag(false)]);
        assert!(table.columns.iter().all(|column| column.is_present == [true, false, true]));
        let [i, x, t, f] = &table.columns[..] else { panic!("four columns") };
        assert_eq!(i.values, MemoryValues::Integers(vec![7, 0, -1]));
        assert!(matches!(&x.values, MemoryValues::Numbers(x) if x[0] == 0.5 && x[1].is_nan() && x[2] == 2.0));
        assert_eq!(t.values, MemoryValues::Words { letters: "élaw".into(), offsets: vec![0, 2, 2, 5] });
        assert_eq!(f.values, MemoryValues::Flags(vec![true, false, false]));
    }
}
