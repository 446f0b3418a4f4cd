//! Line of the program for each executed block.

use std::ops::Range;

use arcfeed_nc::text::Lines;

/// Assigns to each executed block its line of the program. It keeps its place in the text that was sent.
///
/// The control executes each block as received, so it is the next line of the text with the same bytes.
#[derive(Clone, Debug, Default)]
pub struct BlockLocator {
    text: Vec<u8>,
    /// Line of the program, from 1, and place in the text.
    blocks: Vec<(usize, Range<usize>)>,
    next: usize,
}

impl BlockLocator {
    /// Locator at the beginning of a text. `line_ends` has the end of each program line in it; `line_of` is the line of
    /// the file for a line of the program.
    pub fn new(text: Vec<u8>, line_ends: &[usize], line_of: impl Fn(usize) -> usize) -> Self {
        let mut blocks = Vec::new();
        let begins = std::iter::once(0).chain(line_ends.iter().copied());
        for (line, (mut begin, end)) in (1..).zip(begins.zip(line_ends)) {
            for sent in Lines::new(text.get(begin..*end).unwrap_or_default()) {
                blocks.push((line_of(line), begin..begin + sent.text.len()));
                begin += sent.text.len() + sent.ending.len();
            }
        }
        BlockLocator { text, blocks, next: 0 }
    }

    /// Line of the program's file for the next executed block, counted from 1; `None` if the block is not in the text.
    pub fn line_of(&mut self, block: &[u8]) -> Option<usize> {
        let ahead = self.blocks.get(self.next..).unwrap_or_default();
        let is_it = |(_, place): &(usize, Range<usize>)| self.text[place.clone()].trim_ascii() == block.trim_ascii();
        let found = ahead.iter().position(is_it)?;
        self.next += found + 1;
        Some(ahead[found].0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pieces_of_a_line_belong_to_it_and_comments_are_no_blocks() {
        let text = b"%\n(A)\nN1G1X1.\nG2X2.R9.F1.\nG2X3.R9.F2.\nN1G1X1.\n".to_vec();
        // The fourth line of the program is sent in two pieces.
        let line_ends = vec![2, 6, 14, 38, 46];
        let mut locator = BlockLocator::new(text, &line_ends, |line| 10 * line);
        let lines =
            ["N1G1X1.", "G2X2.R9.F1.", "G2X3.R9.F2.", "G99", "N1G1X1."].map(|block| locator.line_of(block.as_bytes()));
        assert_eq!(lines, [Some(30), Some(40), Some(40), None, Some(50)]);
    }
}
