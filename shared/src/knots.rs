//! The knots of the table law: feeds per tooth over the path travelled.
//!
//! A job holds them in one store that its rules point into: a table in each rule would make room for 16 times 32
//! knots on the chip's stack, where a job has a handful of tables.

use heapless::Vec;

use crate::units::{Mm, MmPerTooth};

/// Most knots of one table.
pub const TABLE_KNOTS_MAX: usize = 32;
/// Most knots of all tables of a job.
pub const JOB_KNOTS_MAX: usize = 64;

/// At this path from the segment's start, this feed per tooth at the centre.
pub type Knot = (Mm, MmPerTooth);

/// Which of a store's knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnotRange {
    first: u8,
    count: u8,
}

/// All knots of a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Knots {
    knots: Vec<Knot, JOB_KNOTS_MAX>,
}

impl KnotRange {
    /// So many knots from this one on.
    pub const fn new(first: u8, count: u8) -> Self {
        KnotRange { first, count }
    }

    /// The first, and how many.
    pub const fn bounds(self) -> [u8; 2] {
        [self.first, self.count]
    }
}

impl Knots {
    /// None.
    pub const fn new() -> Self {
        Knots { knots: Vec::new() }
    }

    /// Takes a table in; `None` where there is no room for it.
    pub fn add(&mut self, table: &[Knot]) -> Option<KnotRange> {
        let range = KnotRange { first: u8::try_from(self.knots.len()).ok()?, count: u8::try_from(table.len()).ok()? };
        self.knots.extend_from_slice(table).ok()?;
        Some(range)
    }

    /// All of them, table after table.
    pub fn all(&self) -> &[Knot] {
        &self.knots
    }

    /// A table; none that is not there.
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
