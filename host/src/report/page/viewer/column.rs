//! Column of numbers of the viewer's data: whole multiples of a quantum, as differences, byte by byte.
//!
//! Neighbours in a run are similar, so their differences have few different bytes, and bytes of the same weight stand
//! together: both make the compressed file several times smaller.

use serde::Serialize;

/// Value that stands for "no value".
const NONE: i32 = i32::MIN;

/// Named column of numbers in the viewer's data.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Description of the column, without its values.
    pub head: ColumnHead,
    values: Vec<i32>,
}

/// Description of a column in the header of the data.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ColumnHead {
    /// Key of the column.
    pub name: &'static str,
    /// Unit as text; empty for a number without one.
    pub unit: &'static str,
    /// Step of which all stored values are whole multiples (quantum).
    pub quantum: f64,
}

impl Column {
    /// Column of values, each rounded to a multiple of the quantum.
    pub fn new(head: ColumnHead, values: impl IntoIterator<Item = Option<f64>>) -> Self {
        // A float becomes the nearest integer that there is; the least one means "no value".
        let stored = |value: f64| ((value / head.quantum).round() as i32).max(NONE + 1);
        let values = values.into_iter().map(|value| value.filter(|value| value.is_finite()).map_or(NONE, stored));
        Column { head, values: values.collect() }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether the column has no row.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Whether no row has a value.
    pub fn has_no_value(&self) -> bool {
        self.values.iter().all(|value| *value == NONE)
    }

    /// Appends the differences of the values: first all lowest bytes, at last all highest ones.
    pub fn write(&self, bytes: &mut Vec<u8>) {
        let previous = std::iter::once(0).chain(self.values.iter().copied());
        let differences: Vec<[u8; 4]> =
            self.values.iter().zip(previous).map(|(value, before)| value.wrapping_sub(before).to_le_bytes()).collect();
        for plane in 0..4 {
            bytes.extend(differences.iter().map(|difference| difference[plane]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: ColumnHead = ColumnHead { name: "x", unit: "mm", quantum: 0.5 };

    #[test]
    fn differences_are_stored_by_the_weight_of_their_bytes() {
        let column = Column::new(HEAD, [Some(0.5), Some(129.0), Some(128.4), None]);
        let mut bytes = Vec::new();
        column.write(&mut bytes);
        // 1, 258, 257 and no value: differences 1, 257, -1 and 0x7FFF_FEFF.
        let planes = [[0x01, 0x01, 0xFF, 0xFF], [0x00, 0x01, 0xFF, 0xFE], [0x00, 0x00, 0xFF, 0xFF], [0, 0, 0xFF, 0x7F]];
        assert_eq!(bytes, planes.concat());
    }

    #[test]
    fn nan_has_no_value_and_too_large_numbers_are_limited() {
        let column = Column::new(HEAD, [Some(f64::NAN), Some(f64::INFINITY), Some(-1e30), Some(1e30)]);
        assert_eq!(column.values, [NONE, NONE, NONE + 1, i32::MAX]);
        assert!(!column.has_no_value() && Column::new(HEAD, [None, None]).has_no_value());
    }
}
