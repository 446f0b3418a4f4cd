//! Lines to actions: what the control reads ahead of its execution.

use arcfeed_shared::nc::alarm::{Alarm, Fault};
use arcfeed_shared::nc::block::{Block, Line, Parsed, Reading};
use arcfeed_shared::nc::modal::Stop;
use arcfeed_shared::reader::{Reader, Understood};
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::{LengthUnit, Micros};

/// One block, ready to execute.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadBlock {
    /// Its line in what was received, counted from 1.
    pub line: u32,
    /// Its bytes, without the line end.
    pub text: Vec<u8>,
    /// What it does.
    pub action: Action,
}

/// What a block does.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// A comment, a title, modal words: no time, and moves flow through it.
    Nothing,
    /// An M, S or T function: no time here, but moves before it come to rest.
    Auxiliary,
    /// A move, and where the program goes on after it.
    Move(Segment, Option<Stop>),
    /// G4.
    Dwell(Micros),
    /// M0, M1, M2, M30.
    Stop(Stop),
    /// The control stops here with an alarm.
    Fault(Fault),
}

/// The blocks of a program as they come in.
#[derive(Debug)]
pub struct BlockReader {
    reader: Reader,
    line: u32,
    has_begun: bool,
}

impl BlockReader {
    /// At power-on.
    pub fn new(unit: LengthUnit) -> Self {
        BlockReader { reader: Reader::new(unit, Reading::Lenient), line: 0, has_begun: false }
    }

    /// Lines read so far.
    pub fn line(&self) -> u32 {
        self.line
    }

    /// Reads a line; `None` for `%` and empty lines, which are no blocks.
    pub fn read(&mut self, text: Vec<u8>) -> Option<ReadBlock> {
        self.line += 1;
        let action = match self.reader.read(&text) {
            // The first mark begins the program, the next one ends it: a program that has not stopped before has no end.
            Ok(Understood { parsed: Parsed { line: Line::ProgramMark, .. }, .. }) if self.has_begun => {
                Action::Fault(Fault::alarm(Alarm::EndOfRecord, 1))
            }
            Ok(Understood { parsed: Parsed { line: Line::ProgramMark, .. }, .. }) => return None,
            Ok(understood) => action(&understood),
            Err(fault) => Action::Fault(fault),
        };
        self.has_begun |= !text.is_empty();
        (!text.is_empty()).then_some(ReadBlock { line: self.line, text, action })
    }
}

fn action(understood: &Understood) -> Action {
    let Understood { parsed, step, segment } = understood;
    let has_function = |block: &Block| block.words.iter().any(|word| matches!(word.letter, b'M' | b'S' | b'T'));
    match (step.stop, step.dwell, segment, &parsed.line) {
        (_, _, Some(_), _) if understood.lacks_feed() => Action::Fault(Fault::alarm(Alarm::NoFeed, 0)),
        (stop, _, Some(segment), _) => Action::Move(*segment, stop),
        (Some(stop), ..) => Action::Stop(stop),
        (None, Some(span), ..) => Action::Dwell(span),
        (None, None, None, Line::Block(block)) if has_function(block) => Action::Auxiliary,
        (None, None, None, _) => Action::Nothing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn actions(program: &str) -> Vec<Action> {
        let mut reader = BlockReader::new(LengthUnit::Inch);
        program.lines().filter_map(|line| reader.read(line.into())).map(|block| block.action).collect()
    }

    #[test]
    fn marks_and_empty_lines_are_no_blocks() {
        assert_eq!(actions("%\n\nOTITLE\n(NOTE)\nG20\n"), vec![Action::Nothing; 3]);
    }

    #[test]
    fn the_mark_behind_a_program_that_has_no_end_is_an_alarm() {
        assert_eq!(actions("%\nG20\n%").last(), Some(&Action::Fault(Fault::alarm(Alarm::EndOfRecord, 1))));
    }

    #[test]
    fn a_cutting_move_without_feed_stops_the_control() {
        assert_eq!(actions("G1X1."), [Action::Fault(Fault::alarm(Alarm::NoFeed, 0))]);
        assert!(matches!(actions("G0X1.").as_slice(), [Action::Move(..)]));
    }

    #[test]
    fn a_program_may_end_in_the_block_of_its_last_move() {
        assert!(matches!(actions("G0X1.M30").as_slice(), [Action::Move(_, Some(Stop::End))]));
    }

    #[test]
    fn auxiliary_functions_are_told_from_modal_words() {
        assert_eq!(
            actions("M8\nT1\nS1000M3\nG64"),
            [Action::Auxiliary, Action::Auxiliary, Action::Auxiliary, Action::Nothing]
        );
    }
}
