//! Lines to actions: what the control reads ahead of its execution.

use arcfeed_shared::nc::alarm::{Alarm, Fault};
use arcfeed_shared::nc::block::{Line, Reading, parse_line};
use arcfeed_shared::nc::modal::{Feed, Modal, Stop};
use arcfeed_shared::segment::{Path, Segment};
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
    /// A move.
    Move(Segment),
    /// G4.
    Dwell(Micros),
    /// M0, M1, M2, M30.
    Stop(Stop),
    /// The control stops here with an alarm.
    Fault(Fault),
}

/// The reader's state.
#[derive(Debug)]
pub struct Reader {
    modal: Modal,
    line: u32,
}

impl Reader {
    /// At power-on.
    pub fn new(unit: LengthUnit) -> Self {
        Reader { modal: Modal::at_power_on(unit), line: 0 }
    }

    /// Lines read so far.
    pub fn line(&self) -> u32 {
        self.line
    }

    /// Reads a line; `None` for `%` and empty lines, which are no blocks.
    pub fn read(&mut self, text: Vec<u8>) -> Option<ReadBlock> {
        self.line += 1;
        let action = match parse_line(&text, Reading::Lenient) {
            Ok(parsed) => match parsed.line {
                Line::ProgramMark => return None,
                Line::Title => Action::Nothing,
                Line::Block(block) => match self.interpret(&block) {
                    Ok(action) => action,
                    Err(fault) => Action::Fault(fault),
                },
            },
            Err(fault) => Action::Fault(fault),
        };
        (!text.is_empty()).then_some(ReadBlock { line: self.line, text, action })
    }

    fn interpret(&mut self, block: &arcfeed_shared::nc::block::Block) -> Result<Action, Fault> {
        let (next, step) = self.modal.interpret(block)?;
        let action = if let Some(stop) = step.stop {
            Action::Stop(stop)
        } else if let Some(span) = step.dwell {
            Action::Dwell(span)
        } else if let Some(motion) = step.motion {
            let segment = Segment::from_motion(&motion, block.sequence)?;
            if segment.path != Path::Rapid && segment.feed == Feed::Missing {
                return Err(Fault::alarm(Alarm::NoFeed, 0));
            }
            Action::Move(segment)
        } else if block.words.iter().any(|word| matches!(word.letter, b'M' | b'S' | b'T')) {
            Action::Auxiliary
        } else {
            Action::Nothing
        };
        self.modal = next;
        Ok(action)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn actions(program: &str) -> Vec<Action> {
        let mut reader = Reader::new(LengthUnit::Inch);
        program.lines().filter_map(|line| reader.read(line.into())).map(|block| block.action).collect()
    }

    #[test]
    fn marks_and_empty_lines_are_no_blocks() {
        assert_eq!(actions("%\n\nOTITLE\n(NOTE)\nG20\n%"), vec![Action::Nothing; 3]);
    }

    #[test]
    fn a_cutting_move_without_feed_stops_the_control() {
        assert_eq!(actions("G1X1."), [Action::Fault(Fault::alarm(Alarm::NoFeed, 0))]);
        assert!(matches!(actions("G0X1.").as_slice(), [Action::Move(_)]));
    }

    #[test]
    fn auxiliary_functions_are_told_from_modal_words() {
        assert_eq!(
            actions("M8\nT1\nS1000M3\nG64"),
            [Action::Auxiliary, Action::Auxiliary, Action::Auxiliary, Action::Nothing]
        );
    }
}
