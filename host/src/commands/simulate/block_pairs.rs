//! Correspondence of the executed blocks of a run with those of the original program.
//!
//! A line that is sent in pieces has several blocks in the run and one in the original program. Blocks of one place are
//! counted together.

use std::collections::BTreeMap;

/// Place of an executed block for comparison: the corresponding block of the original program's run, or the block
/// itself if there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BlockPlace {
    /// The block corresponds to one of the original program: number of blocks that the original program's run had executed then, including
    /// it.
    Original(u32),
    /// The original program has no such block: number of blocks that this run has executed, including it.
    Own(u32),
}

/// For each block of a run, the corresponding block of the original program's run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockPairs(Vec<BlockPlace>);

impl BlockPairs {
    /// Pairs of a run and the original program's run, by the program's line of each executed block; `None` for a block that
    /// is not a line of the program.
    ///
    /// Runs with as many blocks as each other have the same blocks. Otherwise blocks in succession from one line are its
    /// pieces.
    pub fn new([run, original]: [&[Option<usize>]; 2]) -> Self {
        if run.len() == original.len() {
            return BlockPairs((1..).take(run.len()).map(BlockPlace::Original).collect());
        }
        let mut of_line: BTreeMap<usize, u32> = BTreeMap::new();
        for (count, line) in (1..).zip(original).filter_map(|(count, line)| Some((count, (*line)?))) {
            of_line.entry(line).or_insert(count);
        }
        let place = |(count, line): (u32, &Option<usize>)| {
            let original = line.and_then(|line| of_line.get(&line));
            original.map_or(BlockPlace::Own(count), |count| BlockPlace::Original(*count))
        };
        BlockPairs((1..).zip(run).map(place).collect())
    }

    /// Place of a block, given by the number of blocks executed up to and including it.
    pub fn place(&self, count: u32) -> BlockPlace {
        let index = (count as usize).checked_sub(1);
        index.and_then(|index| self.0.get(index)).copied().unwrap_or(BlockPlace::Own(count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_a_line_have_the_place_of_its_block() {
        let run = [Some(3), Some(4), Some(4), Some(4), None, Some(6)];
        let pairs = BlockPairs::new([&run, &[Some(3), Some(4), Some(5), Some(6)]]);
        let places: Vec<BlockPlace> = (1..=7).map(|count| pairs.place(count)).collect();
        let [own, original] = [BlockPlace::Own, BlockPlace::Original];
        assert_eq!(places, [original(1), original(2), original(2), original(2), own(5), original(4), own(7)]);
    }

    #[test]
    fn runs_of_as_many_blocks_have_the_same_blocks() {
        let pairs = BlockPairs::new([&[None, Some(3), None], &[Some(7), None, None]]);
        assert_eq!([1, 2, 3].map(|count| pairs.place(count)), [1, 2, 3].map(BlockPlace::Original));
    }
}
