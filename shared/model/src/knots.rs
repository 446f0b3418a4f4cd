//! Knots of the table law: feeds per tooth over the path travelled.
//!
//! A job holds them in one store; its rules hold ranges of it. A table in each rule would reserve 16 times 32 knots on
//! the chip's stack, although a job has only a few tables.

use heapless::Vec;

use arcfeed_units::{Mm, MmPerTooth};

/// Largest number of knots in one table.
pub const TABLE_KNOTS_MAX: usize = 32;
/// Largest number of knots in all tables of a job together.
pub const JOB_KNOTS_MAX: usize = 64;

/// Knot of a table: path from the segment's start, and the feed per tooth at the tool's centre there.
pub type Knot = (Mm, MmPerTooth);

/// Position of one rule's table in [`Knots`]: index of its first knot, and number of knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnotRange {
    first: u8,
    count: u8,
}

/// Feed tables of a job under the table law: the knots of all tables in one list, one table after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Knots {
    knots: Vec<Knot, JOB_KNOTS_MAX>,
}

impl KnotRange {
    /// Range of `count` knots that begins at index `first`.
    pub const fn new(first: u8, count: u8) -> Self {
        KnotRange { first, count }
    }

    /// Index of the first knot, from 0, and number of knots.
    pub const fn bounds(self) -> [u8; 2] {
        [self.first, self.count]
    }
}

impl Knots {
    /// Empty list of knots.
    pub const fn new() -> Self {
        Knots { knots: Vec::new() }
    }

    /// Appends a table and returns its position; `None` if [`JOB_KNOTS_MAX`] knots would be exceeded.
    pub fn add(&mut self, table: &[Knot]) -> Option<KnotRange> {
        let range = KnotRange { first: u8::try_from(self.knots.len()).ok()?, count: u8::try_from(table.len()).ok()? };
        self.knots.extend_from_slice(table).ok()?;
        Some(range)
    }

    /// All knots, table after table.
    pub fn all(&self) -> &[Knot] {
        &self.knots
    }

    /// Knots of the table at this position; empty if the range is not within the list.
    pub fn table(&self, KnotRange { first, count }: KnotRange) -> &[Knot] {
        let first = usize::from(first);
        self.knots.get(first..first + usize::from(count)).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_rule_gets_its_own_knots_back_until_there_is_no_room() {
        let table = |count: usize, feed: f32| std::vec![(Mm(0.0), MmPerTooth(feed)); count];
        let mut knots = Knots::default();
        let [one, other] = [(30, 0.1), (34, 0.2)].map(|(count, feed)| (table(count, feed), count));
        let ranges = [&one.0, &other.0].map(|table| knots.add(table).unwrap());
        assert_eq!(knots.add(&table(1, 0.3)), None);
        assert_eq!(ranges.map(|range| knots.table(range).to_vec()), [one.0, other.0]);
    }
}
