//! Blocks to actions: what the control reads ahead of its execution.
//!
//! In DNC operation the control has no program to jump in: GOTO, WHILE, DO and END are alarm PS0123 there.

use arcfeed_shared::nc::alarm::{Alarm, Fault};
use arcfeed_shared::nc::block::{Block, Line, Parsed, Reading};
use arcfeed_shared::nc::macros::code::{Code, Cursor, Head};
use arcfeed_shared::nc::modal::{Modal, Pose, Stop};
use arcfeed_shared::reader::{Reader, Understood};
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::{LengthUnit, Micros};

use super::settings::Switches;
use super::tape::Received;

/// One block, ready to execute.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadBlock {
    /// Its line in what was received, counted from 1; of a program of the library the line of the call.
    pub line: u32,
    /// Its bytes, without the line end; where it has expressions, with their values in their place.
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

impl Action {
    /// Whether nothing behind this block is read before it is executed.
    pub fn stops_reading(&self) -> bool {
        matches!(self, Action::Stop(_) | Action::Move(_, Some(_)) | Action::Fault(_))
    }
}

impl ReadBlock {
    /// Whether a control in single block waits after it: not after one with nothing but a comment.
    pub fn is_halt_of_single_block(&self) -> bool {
        let code = self.text.split(|&byte| byte == b'(').next().unwrap_or_default();
        self.action != Action::Nothing || !code.trim_ascii().is_empty()
    }
}

/// The blocks of a program as they come in.
#[derive(Debug)]
pub struct BlockReader {
    reader: Reader,
    in_dnc: bool,
    line: u32,
    has_begun: bool,
    end: Pose,
}

impl BlockReader {
    /// At power-on, the axes at the origin; `in_dnc`: the program comes over the line.
    pub fn new(unit: LengthUnit, reading: Reading, in_dnc: bool) -> Self {
        BlockReader { reader: Reader::new(unit, reading), in_dnc, line: 0, has_begun: false, end: Pose::default() }
    }

    /// The axes stand here.
    pub fn stand_at(&mut self, pose: Pose) {
        self.reader.stand_at(pose);
        self.end = pose;
    }

    /// The modal state behind the last block that was read.
    pub fn modal(&self) -> &Modal {
        self.reader.modal()
    }

    /// Lines read so far.
    pub fn line(&self) -> u32 {
        self.line
    }

    /// Where the last move that was read ends.
    pub fn end(&self) -> Pose {
        self.end
    }

    /// Reads a block; `None` for `%`, empty and deleted ones, which do nothing.
    pub fn read(&mut self, received: Received, switches: &Switches) -> Option<ReadBlock> {
        self.line += 1;
        let (text, refused) = match received {
            Received::Label { has_mark } => {
                self.has_begun |= has_mark;
                return None;
            }
            Received::Block(text) => (text, None),
            Received::Refused { text, fault } => (text, Some(fault)),
        };
        if deleted_by(&text).is_some_and(|switch| switches.deletes(switch)) {
            return None;
        }
        let is_empty = text.is_empty() && refused.is_none();
        let action = match refused.or(self.refused_in_dnc(&text)) {
            Some(fault) => Action::Fault(fault),
            None => self.understand(&text)?,
        };
        self.has_begun |= !is_empty;
        if let Action::Move(segment, _) = &action {
            self.end = segment.end;
        }
        (!is_empty).then_some(ReadBlock { line: self.line, text, action })
    }

    /// Passes over a block, for a search: whether it was the end of the program.
    pub fn pass(&mut self, received: &Received) -> bool {
        self.line += 1;
        let has_begun = self.has_begun;
        match received {
            Received::Label { has_mark } => self.has_begun |= has_mark,
            Received::Block(text) | Received::Refused { text, .. } => {
                self.has_begun |= !text.is_empty();
                return has_begun && text.first() == Some(&b'%');
            }
        }
        false
    }

    /// Reads a block that [`BlockReader::pass`] has passed over.
    pub fn read_again(&mut self, received: Received, switches: &Switches) -> Option<ReadBlock> {
        self.line -= 1;
        self.read(received, switches)
    }

    fn refused_in_dnc(&self, text: &[u8]) -> Option<Fault> {
        (self.in_dnc && branches(text)).then_some(Fault::alarm(Alarm::BranchInDnc, 0))
    }

    /// `None` for the mark that begins the program.
    fn understand(&mut self, text: &[u8]) -> Option<Action> {
        Some(match self.reader.read(text) {
            // The first mark begins the program, the next one ends it: a program that has not stopped before has no end.
            Ok(Understood { parsed: Parsed { line: Line::ProgramMark, .. }, .. }) if self.has_begun => {
                Action::Fault(Fault::alarm(Alarm::EndOfRecord, 1))
            }
            Ok(Understood { parsed: Parsed { line: Line::ProgramMark, .. }, .. }) => {
                self.has_begun = true;
                return None;
            }
            Ok(understood) => action(&understood),
            Err(fault) => Action::Fault(fault),
        })
    }
}

/// The sequence number at the head of a block.
pub fn sequence_of(text: &[u8]) -> Option<u32> {
    let code = text.trim_ascii_start();
    let code = code.strip_prefix(b"/").unwrap_or(code).trim_ascii_start();
    let digits = code.strip_prefix(b"N")?;
    let len = digits.iter().take_while(|byte| byte.is_ascii_digit()).count();
    core::str::from_utf8(&digits[..len]).ok()?.parse().ok()
}

/// The switch of a block that begins with `/` or `/n`.
fn deleted_by(text: &[u8]) -> Option<u8> {
    let after = text.trim_ascii_start().strip_prefix(b"/")?;
    Some(after.first().filter(|byte| matches!(byte, b'1'..=b'9')).map_or(1, |digit| digit - b'0'))
}

/// Whether a block goes on somewhere else in its program: GOTO, also behind IF, WHILE, DO, END.
fn branches(text: &[u8]) -> bool {
    let code = Code::new(text);
    let mut statement = code.cursor();
    Head::read(&mut statement);
    if statement.eat_keyword(b"IF") {
        skip_brackets(&mut statement);
        statement.eat(b"THEN");
    }
    let jumps = [b"GOTO".as_slice(), b"WHILE", b"END"].iter().any(|keyword| statement.eat_keyword(keyword));
    jumps || statement.letters() == b"DO"
}

/// Skips from `[` to behind the `]` that belongs to it.
fn skip_brackets(statement: &mut Cursor<'_>) {
    let mut depth = 0_u32;
    while let Some(byte) = statement.peek() {
        match byte {
            b'[' => depth += 1,
            b']' => depth = depth.saturating_sub(1),
            _ if depth == 0 => return,
            _ => {}
        }
        statement.skip(1);
    }
}

/// What a line that has been understood asks for.
pub fn action(understood: &Understood) -> Action {
    let Understood { parsed, step, segment } = understood;
    let has_function = |block: &Block| block.words.iter().any(|word| matches!(word.letter, b'M' | b'S' | b'T'));
    match (step.stop, step.dwell, segment) {
        (_, _, Some(_)) if understood.lacks_feed() => Action::Fault(Fault::alarm(Alarm::NoFeed, 0)),
        (stop, _, Some(segment)) => Action::Move(*segment, stop),
        (Some(stop), ..) => Action::Stop(stop),
        (None, Some(span), ..) => Action::Dwell(span),
        (None, None, None) if has_function(&parsed.block) => Action::Auxiliary,
        (None, None, None) => Action::Nothing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blocks(program: &str, in_dnc: bool, switches: &Switches) -> Vec<ReadBlock> {
        let mut reader = BlockReader::new(LengthUnit::Inch, Reading::Lenient, in_dnc);
        program.lines().filter_map(|line| reader.read(Received::Block(line.into()), switches)).collect()
    }

    fn actions(program: &str) -> Vec<Action> {
        blocks(program, false, &Switches::default()).into_iter().map(|block| block.action).collect()
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

    #[test]
    fn a_deleted_block_leaves_no_trace_also_in_the_modal_state() {
        let switches = Switches { block_delete: 1, ..Switches::default() };
        let program = "G1X1.F10.\n/G0X5.\n/2X6.\nX7.";
        let texts: Vec<Vec<u8>> = blocks(program, false, &switches).into_iter().map(|block| block.text).collect();
        assert_eq!(texts, [b"G1X1.F10.".as_slice(), b"/2X6.", b"X7."]);
        assert_eq!(blocks(program, false, &Switches::default()).len(), 4);
    }

    #[test]
    fn jumps_are_refused_where_there_is_nothing_to_jump_in() {
        let refused = Action::Fault(Fault::alarm(Alarm::BranchInDnc, 0));
        for line in ["GOTO10", "N20 IF[#[1]EQ2](A)GOTO10", "IF[1EQ1]THEN GO5", "N5WHILE[#1LT9]DO1", "DO1", "END1"] {
            assert_eq!(blocks(line, true, &Switches::default())[0].action, refused, "{line}");
            assert_ne!(blocks(line, false, &Switches::default())[0].action, refused, "{line}");
        }
        assert_ne!(blocks("IF[#1EQ2]THEN#2=1", true, &Switches::default())[0].action, refused);
        assert_eq!(blocks("(GOTO10)", true, &Switches::default())[0].action, Action::Nothing);
    }

    #[test]
    fn sequence_numbers_stand_at_the_head() {
        for (text, number) in [("N10G1", Some(10)), ("/ N007", Some(7)), ("G1N5", None), ("N", None), ("(N1)", None)] {
            assert_eq!(sequence_of(text.as_bytes()), number, "{text}");
        }
    }
}
