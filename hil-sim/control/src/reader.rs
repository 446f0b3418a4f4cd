//! Blocks to actions, as the control reads them ahead.

use arcfeed_nc::alarm::{Alarm, Fault};
use arcfeed_nc::modal::{Modal, Pose};
use arcfeed_nc::settings::Tables;
use arcfeed_nc::word::is_mark;

use super::action::{Action, ReadBlock};
use super::plain::{Plain, PlainReader};
use super::restart::RestartList;
use super::settings::{ControlSettings, Switches};
use super::tape::ReceivedBlock;

/// Result of decoding and checking the next block from the tape.
#[derive(Clone, Debug, PartialEq)]
pub enum OpenedBlock {
    /// Text of a valid block.
    Text(Vec<u8>),
    /// Block that failed a check, as a block that stops the control with an alarm.
    Refused(Box<ReadBlock>),
}

/// Reader of the blocks of a program.
#[derive(Debug)]
pub struct BlockReader {
    reader: PlainReader,
    line: u32,
    has_begun: bool,
}

impl BlockReader {
    /// Reader at power-on, the axes at the machine's zero.
    pub fn new(settings: &ControlSettings) -> Self {
        BlockReader { reader: PlainReader::new(settings), line: 0, has_begun: false }
    }

    /// Sets the machine position from which the next block begins; the tool has no length then.
    pub fn stand_at(&mut self, machine: Pose) {
        self.reader.stand_at(machine);
    }

    /// Work offsets and tool lengths as last written by the program.
    pub fn tables(&mut self) -> &Tables {
        self.reader.reader().tables()
    }

    /// Begins to collect the functions (M, S, T) that a restart must show to the operator.
    pub fn list_for_restart(&mut self) {
        self.reader.list_for_restart();
    }

    /// Takes the collected functions of all blocks before the last one read.
    pub fn take_restart_list(&mut self) -> Option<RestartList> {
        self.reader.take_restart_list()
    }

    /// Modal state after the last block that was read.
    pub fn modal(&self) -> &Modal {
        self.reader.modal()
    }

    /// Number of lines read so far.
    pub fn line(&self) -> u32 {
        self.line
    }

    /// End of the last move that was read.
    pub fn end(&self) -> Pose {
        self.reader.end()
    }

    /// Reads a block and makes its action; `None` for `%`, empty and deleted blocks, which do nothing.
    pub fn read(&mut self, received: ReceivedBlock, switches: &Switches) -> Option<ReadBlock> {
        match self.open(received, switches)? {
            OpenedBlock::Text(text) => Some(self.understand(text, switches)),
            OpenedBlock::Refused(block) => Some(*block),
        }
    }

    /// Decodes and checks the next block from the tape, without executing it; `None` for `%`, empty and deleted blocks.
    pub fn open(&mut self, received: ReceivedBlock, switches: &Switches) -> Option<OpenedBlock> {
        self.line += 1;
        let (text, refused) = match received {
            ReceivedBlock::Label { has_mark } => {
                self.has_begun |= has_mark;
                return None;
            }
            ReceivedBlock::Block(text) => (text, None),
            ReceivedBlock::Refused { text, fault } => (text, Some(fault)),
        };
        if deleted_by(&text).is_some_and(|switch| switches.deletes(switch)) {
            return None;
        }
        let has_begun = self.has_begun;
        self.has_begun |= !text.is_empty() || refused.is_some();
        // The first mark begins the program, the next one ends it: a program that reaches it has no end of its own.
        let is_mark = is_mark(&text);
        let at_end = Fault::alarm(Alarm::EndOfRecord, 1);
        match refused.or((is_mark && has_begun).then_some(at_end)) {
            Some(fault) => Some(OpenedBlock::Refused(Box::new(ReadBlock::new(self.line, text, Action::Fault(fault))))),
            None => (!is_mark && !text.is_empty()).then_some(OpenedBlock::Text(text)),
        }
    }

    /// Skips a block during a search; returns whether it was the end of the program.
    pub fn skip(&mut self, received: &ReceivedBlock) -> bool {
        self.line += 1;
        let has_begun = self.has_begun;
        match received {
            ReceivedBlock::Label { has_mark } => self.has_begun |= has_mark,
            ReceivedBlock::Block(text) | ReceivedBlock::Refused { text, .. } => {
                self.has_begun |= !text.is_empty();
                return has_begun && is_mark(text);
            }
        }
        false
    }

    /// Undoes the line count of [`BlockReader::skip`], so that the same block is read next.
    pub fn unread(&mut self) {
        self.line -= 1;
    }

    fn understand(&mut self, text: Vec<u8>, switches: &Switches) -> ReadBlock {
        // Bit n - 1 of the panel is bit n of the reader.
        self.reader.reader().set_delete_switches(switches.block_delete << 1);
        match self.reader.read(&text) {
            Ok(Plain { action, context, contour }) => ReadBlock { line: self.line, text, action, context, contour },
            Err(fault) => ReadBlock::new(self.line, text, Action::Fault(fault)),
        }
    }
}

/// Sequence number (N) at the beginning of a block; `None` without one.
pub fn sequence_of(text: &[u8]) -> Option<u32> {
    let code = text.trim_ascii_start();
    let code = match code.strip_prefix(b"/") {
        Some([b'1'..=b'9', code @ ..] | code) => code.trim_ascii_start(),
        None => code,
    };
    let digits = code.strip_prefix(b"N")?;
    let len = digits.iter().take_while(|byte| byte.is_ascii_digit()).count();
    core::str::from_utf8(&digits[..len]).ok()?.parse().ok()
}

/// Number of the block delete switch of a block that begins with `/` or `/n`.
fn deleted_by(text: &[u8]) -> Option<u8> {
    let after = text.trim_ascii_start().strip_prefix(b"/")?;
    Some(after.first().filter(|byte| matches!(byte, b'1'..=b'9')).map_or(1, |digit| digit - b'0'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_nc::modal::ProgramStop;
    use arcfeed_units::LengthUnit;

    fn blocks(program: &str, switches: &Switches) -> Vec<ReadBlock> {
        let mut reader = BlockReader::new(&ControlSettings::fanuc_16i(LengthUnit::Inch));
        program.lines().filter_map(|line| reader.read(ReceivedBlock::Block(line.into()), switches)).collect()
    }

    fn actions(program: &str) -> Vec<Action> {
        blocks(program, &Switches::default()).into_iter().map(|block| block.action).collect()
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
        assert!(matches!(actions("G0X1.M30").as_slice(), [Action::Move(_, Some(ProgramStop::End))]));
    }

    #[test]
    fn auxiliary_functions_are_distinguished_from_modal_words() {
        assert_eq!(
            actions("M8\nT1\nS1000M3\nG64"),
            [Action::Auxiliary, Action::Auxiliary, Action::Auxiliary, Action::Nothing]
        );
    }

    #[test]
    fn a_deleted_block_leaves_no_trace_also_in_the_modal_state() {
        let switches = Switches { block_delete: 1, ..Switches::default() };
        let program = "G1X1.F10.\n/G0X5.\n/2X6.\nX7.";
        let texts: Vec<Vec<u8>> = blocks(program, &switches).into_iter().map(|block| block.text).collect();
        assert_eq!(texts, [b"G1X1.F10.".as_slice(), b"/2X6.", b"X7."]);
        assert_eq!(blocks(program, &Switches::default()).len(), 4);
    }

    #[test]
    fn sequence_numbers_stand_at_the_head() {
        for (text, number) in
            [("N10G1", Some(10)), ("/ N007", Some(7)), ("/3N8", Some(8)), ("G1N5", None), ("N", None), ("(N1)", None)]
        {
            assert_eq!(sequence_of(text.as_bytes()), number, "{text}");
        }
    }
}
