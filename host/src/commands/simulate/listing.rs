//! Lines of the program, assigned to the executed blocks of the run and of the original program.

use arcfeed_nc::text::Lines;

use super::block_lines::BlockLocator;
use super::block_pairs::BlockPairs;
use crate::adapt::Adapted;
use crate::adapt::write_back::WrittenProgram;
use crate::program::{Program, in_capitals};

/// Text of a program, with the line of each executed block.
#[derive(Clone, Debug, Default)]
pub struct ProgramListing {
    /// Lines of the program's file, each as written and as sent.
    pub lines: Vec<[Vec<u8>; 2]>,
    /// Line, counted from 1, of each executed block; first of the run, then of the original program. `None` for a block
    /// without a line.
    pub block_lines: [Vec<Option<usize>>; 2],
}

impl ProgramListing {
    /// Listing of a program. `sent` is the text in the control's memory, with the end of each program line in it;
    /// `executed` has the blocks of the run and of the original program.
    pub fn new(program: &Program, adapted: &Adapted, sent: &WrittenProgram, executed: [&[Vec<u8>]; 2]) -> Self {
        let file = program.file();
        let WrittenProgram { text: sent, line_ends: sent_ends } = sent;
        let is_planned = *sent == adapted.text;
        let [mut after, mut before] = locators(program, adapted, sent, sent_ends);
        let block_lines = [
            executed[0].iter().map(|block| after.line_of(block)).collect(),
            executed[1].iter().map(|block| before.line_of(block)).collect(),
        ];
        let text_of = |ends: &[usize], text: &[u8]| -> Vec<Vec<u8>> {
            let begins = std::iter::once(0).chain(ends.iter().copied());
            let lines = begins.zip(ends).map(|(begin, end)| text.get(begin..*end).unwrap_or_default());
            lines.map(|line| line.trim_ascii_end().to_vec()).collect()
        };
        let lines = text_of(&line_ends(file), file);
        let sent = match (is_planned, &program.places) {
            (true, None) => text_of(&adapted.line_ends, sent),
            // Blocks as executed are no lines of the file.
            (true, Some(_)) => lines.clone(),
            (false, _) => text_of(sent_ends, sent),
        };
        let lines = lines.into_iter().zip(sent).map(|(line, sent)| [line, sent]).collect();
        ProgramListing { lines, block_lines }
    }

    /// Correspondence of the run's blocks with those of the original program.
    pub fn pairs(&self) -> BlockPairs {
        BlockPairs::new(self.block_lines.each_ref().map(Vec::as_slice))
    }
}

/// Locators that find the line of each executed block, for the run and for the original program. `sent` is the text in
/// the control's memory, `sent_ends` the end of each program line in it.
pub fn locators(program: &Program, adapted: &Adapted, sent: &[u8], sent_ends: &[usize]) -> [BlockLocator; 2] {
    let file = program.file();
    let before = BlockLocator::new(in_capitals(file), &line_ends(file), |line| line);
    let after = if sent == adapted.text {
        BlockLocator::new(in_capitals(sent), &adapted.line_ends, |line| program.line_in_file(line))
    } else {
        // The control runs macros itself, so its blocks are lines of the file with the feeds written back.
        BlockLocator::new(in_capitals(sent), sent_ends, |line| line)
    };
    [after, before]
}

/// End of each line in a text.
fn line_ends(text: &[u8]) -> Vec<usize> {
    let lines = Lines::new(text).scan(0, |end, line| {
        *end += line.text.len() + line.ending.len();
        Some(*end)
    });
    lines.collect()
}
