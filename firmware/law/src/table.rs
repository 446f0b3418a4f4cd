//! Table law: a precomputed feed per tooth, piecewise linear in the path travelled.
//!
//! For cases that the host can simulate but no formula covers: engagement from the removed material, a measured force.
//!
//! Source: docs/laws.md#table.

use arcfeed_model::knots::{Knot, TABLE_KNOTS_MAX};
use heapless::Vec;

use super::{FeedDemand, FeedLaw, NoDemand, Place};

/// Table law prepared for one segment: feed per tooth at the tool's centre at knots along the path, linear between
/// them.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    knots: Vec<Knot, TABLE_KNOTS_MAX>,
}

/// Reason why knots of a feed table are rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableError {
    /// There is no knot, or more than [`TABLE_KNOTS_MAX`].
    Count,
    /// The path of the knot with this index (from 0) is not larger than that of the knot before, or is not a finite
    /// number.
    Order(usize),
    /// The feed per tooth of the knot with this index (from 0) is not a positive number.
    Feed(usize),
}

impl Table {
    /// Table of these knots, which must be in the order of the path.
    ///
    /// # Errors
    /// See [`TableError`].
    pub fn new(knots: &[Knot]) -> Result<Self, TableError> {
        let (first, others) = knots.split_first().ok_or(TableError::Count)?;
        let mut table = Table::with_first(*first)?;
        others.iter().try_for_each(|knot| table.push(*knot))?;
        Ok(table)
    }

    /// A table of one knot, to which [`Self::push`] adds the others.
    ///
    /// # Errors
    /// As of [`Self::push`].
    pub fn with_first(knot: Knot) -> Result<Self, TableError> {
        let mut table = Table { knots: Vec::new() };
        table.push(knot)?;
        Ok(table)
    }

    /// Appends a knot. The table does not change if the knot is rejected.
    ///
    /// # Errors
    /// See [`TableError`].
    pub fn push(&mut self, (travelled, feed): Knot) -> Result<(), TableError> {
        let last = self.knots.last().map_or(f32::NEG_INFINITY, |(last, _)| last.0);
        if !(travelled.0 > last && travelled.0.is_finite()) {
            return Err(TableError::Order(self.knots.len()));
        }
        if !(feed.0 > 0.0 && feed.0.is_finite()) {
            return Err(TableError::Feed(self.knots.len()));
        }
        self.knots.push((travelled, feed)).map_err(|_| TableError::Count)
    }

    /// The knots, in the order of the path.
    pub fn knots(&self) -> &[Knot] {
        &self.knots
    }

    /// Calls `take` with the position of each knot: path from the segment's start, mm.
    pub fn knots_mm(&self, take: &mut dyn FnMut(f32)) {
        self.knots.iter().for_each(|(travelled, _)| take(travelled.0));
    }
}

impl FeedLaw for Table {
    /// Constant before the first knot and after the last one.
    fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand> {
        let at_mm = place.travelled_mm;
        if at_mm.is_nan() {
            return Err(NoDemand::BadInput);
        }
        let next = self.knots.partition_point(|(travelled, _)| travelled.0 <= at_mm);
        let before = next.checked_sub(1).and_then(|index| self.knots.get(index));
        let path_mm_per_tooth = match (before, self.knots.get(next)) {
            (Some((from, a)), Some((to, b))) => a.0 + (b.0 - a.0) * ((at_mm - from.0) / (to.0 - from.0)),
            (Some((_, only)), None) | (None, Some((_, only))) => only.0,
            (None, None) => return Err(NoDemand::BadInput),
        };
        Ok(FeedDemand { path_mm_per_tooth, contact: [1.0, 0.0] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_units::{Mm, MmPerTooth};

    fn at(table: &Table, travelled_mm: f32) -> Result<f32, NoDemand> {
        let place = Place { center_mm: [0.0; 2], motion: [1.0, 0.0], towards: [0.0, 1.0], travelled_mm };
        table.demand(&place).map(|demand| demand.path_mm_per_tooth)
    }

    #[test]
    fn it_is_linear_between_knots_and_level_beyond() {
        let table = Table::new(&[(Mm(1.0), MmPerTooth(0.1)), (Mm(3.0), MmPerTooth(0.2))]).unwrap();
        let feeds = [0.0, 1.0, 2.0, 3.0, 9.0].map(|mm| at(&table, mm).unwrap());
        assert_eq!(feeds, [0.1, 0.1, 0.15, 0.2, 0.2]);
        assert_eq!(at(&table, f32::NAN), Err(NoDemand::BadInput));
    }

    #[test]
    fn senseless_knots_are_refused_by_number() {
        let knot = |mm, feed| (Mm(mm), MmPerTooth(feed));
        assert_eq!(Table::new(&[]), Err(TableError::Count));
        assert_eq!(Table::new(&[knot(1.0, 0.1); 2]), Err(TableError::Order(1)));
        assert_eq!(Table::new(&[knot(f32::NAN, 0.1)]), Err(TableError::Order(0)));
        assert_eq!(Table::new(&[knot(0.0, 0.1), knot(1.0, 0.0)]), Err(TableError::Feed(1)));
        let many: std::vec::Vec<Knot> = (0..33).map(|i| knot(i as f32, 0.1)).collect();
        assert_eq!(Table::new(&many), Err(TableError::Count));
    }
}
