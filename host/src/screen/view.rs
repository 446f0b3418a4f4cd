//! Content of the screen, and the meaning of keys; no I/O.

use std::collections::VecDeque;
use std::sync::Arc;

use arcfeed_units::{LengthUnit, Micros};

use crate::dnc::transmission::Transmission;
use crate::dnc::{Sender, State};
use crate::port::Machine;

/// Most samples of the strip.
const STRIP_MAX: usize = 200;
/// Display time of each note, s.
const NOTE_S: f64 = 6.0;

/// Content of the terminal screen of `stream --tui`.
#[derive(Clone, Debug)]
pub struct View {
    /// Names of the program and the destination.
    pub title: String,
    /// Text of the program that is sent.
    pub program: Arc<Listing>,
    /// Unit of lengths that are shown.
    pub unit: LengthUnit,
    /// Index of the line that the control executes, if the control reports it.
    pub executed: Option<usize>,
    /// The executed line is a lower bound: it comes from the control's reports.
    pub is_least: bool,
    /// Index of the line being sent.
    pub sent: usize,
    /// Number of characters sent.
    pub characters: usize,
    /// State of the sender.
    pub state: State,
    /// The control accepts characters; `None` before its first DC1.
    pub is_taken: Option<bool>,
    /// Number of DC3 by which the control has stopped the sender.
    pub xoffs: u32,
    /// State of the machine (override, position, alarm), as far as the port reports it.
    pub machine: Machine,
    /// Latest samples for the bar chart, the oldest first: chip thickness in % of the target, or override in %.
    pub strip: VecDeque<u64>,
    /// The samples are chip thicknesses; otherwise overrides.
    pub has_chips: bool,
    /// Time since the port was opened, s.
    pub elapsed_s: f64,
    /// Estimated time until the end, s, at the programmed feeds or at the line's rate, whichever takes longer.
    pub left_s: f64,
    /// Number of damaged characters from the control since the line was opened; `None` if the port does not report it.
    pub damaged: Option<u64>,
    /// Path of the journal of this transmission; `None` without one.
    pub journal: Option<String>,
    /// State of the feed board, if one takes part.
    pub board: Option<&'static str>,
    /// Notes from before the start, shown one after the other.
    pub notes: Vec<String>,
    /// Latest warning, shown instead of the notes.
    pub warning: Option<String>,
    /// Command that the operator is asked to confirm; `None` if there is no question.
    pub question: Option<Command>,
    block_since: Micros,
    chars_per_s: f64,
}

/// Program text for the screen, prepared once.
#[derive(Debug)]
pub struct Listing {
    /// Each line's number in the program's file (0 for a line that arcfeed has added), and its text.
    pub lines: Vec<(usize, String)>,
    /// Offset of each line's end in the transmission, in characters.
    pub ends: Vec<usize>,
    blocks: Vec<usize>,
    /// Time from the start of each line to the end.
    left_s: Vec<f64>,
}

/// Command of the operator on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Pause the transmission.
    Hold,
    /// Continue.
    Resume,
    /// End the transmission after the present block.
    Abort,
}

/// Key that the operator has pressed, by its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Press {
    /// Keys space and h: pause.
    Hold,
    /// Key r: continue.
    Resume,
    /// Keys q and Ctrl-C: end the transmission.
    Abort,
    /// Key y: confirm the question.
    Yes,
    /// All other keys.
    Other,
}

impl Press {
    /// Command that the key gives, `None` if it gives none. Pausing needs no confirmation; a command that moves the
    /// machine or ends the transmission is first put as a `question`.
    pub fn decide(self, question: &mut Option<Command>, state: State) -> Option<Command> {
        match (question.take(), self) {
            (_, Press::Hold) => Some(Command::Hold),
            (Some(asked), Press::Yes) => Some(asked),
            // A second press confirms.
            (Some(Command::Abort), Press::Abort) => Some(Command::Abort),
            (_, Press::Abort) => {
                *question = Some(Command::Abort);
                None
            }
            (None, Press::Resume) if state == State::Held => {
                *question = Some(Command::Resume);
                None
            }
            _ => None,
        }
    }
}

impl Listing {
    /// Listing of a transmission; `times_s` are the execution times of its lines.
    pub fn new(sending: &Transmission, times_s: &[f64]) -> Self {
        let text =
            |index: usize| String::from_utf8_lossy(sending.line_text(index).unwrap_or_default().trim_ascii_end());
        let lines = sending.lines().iter().enumerate();
        let mut left_s: Vec<f64> = times_s.to_vec();
        left_s.push(0.0);
        for index in (0..times_s.len()).rev() {
            left_s[index] += left_s[index + 1];
        }
        Listing {
            lines: lines.map(|(index, line)| (line.source, text(index).into_owned())).collect(),
            ends: sending.lines().iter().map(|line| line.end).collect(),
            blocks: sending.block_lines(),
            left_s,
        }
    }

    /// Total number of characters.
    pub fn characters(&self) -> usize {
        self.ends.last().copied().unwrap_or(0)
    }

    fn left_s(&self, index: usize) -> f64 {
        self.left_s.get(index).copied().unwrap_or(0.0)
    }
}

impl View {
    /// View before the first character, on a line of `chars_per_s`.
    pub fn new(title: String, program: Listing, chars_per_s: f64) -> Self {
        View {
            title,
            unit: LengthUnit::Mm,
            left_s: program.left_s(0),
            program: Arc::new(program),
            executed: None,
            is_least: false,
            sent: 0,
            characters: 0,
            state: State::Waiting,
            is_taken: None,
            xoffs: 0,
            machine: Machine::default(),
            strip: VecDeque::new(),
            has_chips: false,
            elapsed_s: 0.0,
            damaged: None,
            journal: None,
            board: None,
            notes: Vec::new(),
            warning: None,
            question: None,
            block_since: Micros(0),
            chars_per_s,
        }
    }

    /// Updates the view; the control has started `executed` blocks, if it reports that.
    pub fn update(&mut self, now: Micros, sender: &Sender, executed: Option<usize>, machine: Machine) {
        let line_of = |count: usize| self.program.blocks.get(count.checked_sub(1)?).copied();
        let executed = executed.map(|count| line_of(count).unwrap_or(0));
        if executed != self.executed {
            (self.executed, self.block_since) = (executed, now);
        }
        (self.characters, _) = sender.progress();
        (self.sent, self.state, self.is_taken) = (sender.line(), sender.state(), sender.is_taken());
        self.xoffs = sender.counters().xoff_count;
        self.elapsed_s = now.to_s();
        self.left_s = self.time_left_s(now);
        self.machine = machine;
    }

    /// Adds the machine's present state to the samples of the bar chart.
    pub fn sample(&mut self) {
        let chip = self.machine.chip_ratio.map(|ratio| libm::round(1e2 * ratio) as u64);
        if chip.is_some() && !self.has_chips {
            // Chip thicknesses and overrides are not mixed in one strip.
            self.strip.clear();
            self.has_chips = true;
        }
        let percent = self.machine.override_percent.map(u64::from);
        let sample = if self.has_chips { Some(chip.unwrap_or(0)) } else { percent };
        self.strip.extend(sample);
        self.strip.drain(..self.strip.len().saturating_sub(STRIP_MAX));
    }

    fn time_left_s(&self, now: Micros) -> f64 {
        let line = self.center();
        let into_s = self.executed.map_or(0.0, |_| now.since(self.block_since).to_s());
        let block_s = self.program.left_s(line) - self.program.left_s(line + 1);
        let on_line_s = (self.program.characters() - self.characters) as f64 / self.chars_per_s;
        (self.program.left_s(line) - into_s.min(block_s)).max(on_line_s)
    }

    /// Index of the line in the middle of the listing.
    pub fn center(&self) -> usize {
        self.executed.unwrap_or(self.sent)
    }

    /// Number of characters sent that belong to blocks which the control has not started; `None` if the control does
    /// not report its progress.
    pub fn at_control(&self) -> Option<usize> {
        let end = self.program.ends.get(self.executed?)?;
        Some(self.characters.saturating_sub(*end))
    }

    /// X, Y, Z of the tool's tip, if the machine reports it.
    pub fn position(&self) -> Option<[f64; 3]> {
        self.machine.position_mm.map(|position| position.map(|mm| mm / self.unit.mm()))
    }

    /// Feed along the path per minute, if the machine reports it.
    pub fn feed(&self) -> Option<f64> {
        self.machine.feed_mm_per_min.map(|feed| feed / self.unit.mm())
    }

    /// Text to be shown: the latest warning, otherwise one of the notes in turn.
    pub fn note(&self) -> Option<&str> {
        let turn = (self.elapsed_s / NOTE_S) as usize % self.notes.len().max(1);
        self.warning.as_ref().or_else(|| self.notes.get(turn)).map(String::as_str)
    }

    /// State of the sender, in words.
    pub fn words(&self) -> &'static str {
        match self.state {
            State::Waiting => "waiting for DC1: start DNC operation at the control",
            State::Sending => "sending",
            State::Stopped => "the control's buffer is full",
            State::Held => "HELD: sending stopped, the axes NOT: FEED HOLD at the machine stops them",
            State::Sent => "all sent; the control executes what it has",
            State::Aborted => "aborted",
            State::Failed(_) => "given up",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dnc::pace::Pace;
    use crate::dnc::sender::LineUse;
    use crate::dnc::transmission::Wire;

    fn decide(presses: &[Press], state: State) -> Vec<Command> {
        let mut question = None;
        presses.iter().filter_map(|press| press.decide(&mut question, state)).collect()
    }

    #[test]
    fn a_hold_needs_one_key_and_all_else_two() {
        use Press::{Abort, Hold, Other, Resume, Yes};
        for (presses, state, wanted) in [
            (&[Hold][..], State::Sending, &[Command::Hold][..]),
            (&[Yes], State::Sending, &[]),
            (&[Abort, Other, Yes], State::Sending, &[]),
            (&[Abort, Yes, Yes], State::Sending, &[Command::Abort]),
            (&[Abort, Abort], State::Sending, &[Command::Abort]),
            (&[Abort, Hold, Yes], State::Sending, &[Command::Hold]),
            (&[Resume, Yes], State::Held, &[Command::Resume]),
            (&[Resume, Resume], State::Held, &[]),
            (&[Resume, Yes], State::Sending, &[]),
            (&[Resume, Abort, Yes], State::Held, &[Command::Abort]),
        ] {
            assert_eq!(decide(presses, state), wanted, "{presses:?}");
        }
    }

    #[test]
    fn time_left_is_the_machines_or_the_lines_whichever_is_longer() {
        let wire = Wire { encode: Some, filters: false, tv_check: false };
        let sending = Transmission::new(b"%\nG1X1.\nG1X2.\nM30\n%\n", |at| at, &wire).unwrap();
        let listing = || Listing::new(&sending, &[0.0, 3.0, 5.0, 0.0, 0.0]);
        let pace = Pace::new(11, 9_600, None);
        let line = LineUse { pace, xonxoff: false, eight_bits: false, start_timeout: None, xoff_timeout: None };
        let sender = Sender::new(sending.clone(), line);
        let mut view = View::new(String::new(), listing(), 100.0);
        view.update(Micros(0), &sender, Some(1), Machine::default());
        assert_eq!((view.executed, view.left_s), (Some(1), 8.0));
        view.update(Micros::from_ms(2_000), &sender, Some(1), Machine::default());
        assert_eq!((view.left_s, view.at_control()), (6.0, Some(0)));
        // A block takes longer than predicted: those behind it still need their time.
        view.update(Micros::from_ms(9_000), &sender, Some(1), Machine::default());
        assert_eq!(view.left_s, 5.0);
        let mut slow = View::new(String::new(), listing(), 1.0);
        slow.update(Micros(0), &sender, None, Machine::default());
        assert_eq!((slow.executed, slow.left_s), (None, 20.0));
    }

    #[test]
    fn notes_take_turns_until_there_is_a_warning() {
        let wire = Wire { encode: Some, filters: false, tv_check: false };
        let sending = Transmission::new(b"%\nM30\n%\n", |at| at, &wire).unwrap();
        let mut view = View::new(String::new(), Listing::new(&sending, &[0.0; 3]), 100.0);
        assert_eq!(view.note(), None);
        view.notes = vec!["slow".into(), "slower".into()];
        let shown = [0.0, 5.9, 6.0, 12.0].map(|elapsed_s| {
            view.elapsed_s = elapsed_s;
            view.note().map(str::to_owned).unwrap_or_default()
        });
        assert_eq!(shown, ["slow", "slow", "slower", "slow"]);
        view.warning = Some("damaged".into());
        assert_eq!(view.note(), Some("damaged"));
    }

    #[test]
    fn chips_and_overrides_are_not_mixed_on_one_strip() {
        let wire = Wire { encode: Some, filters: false, tv_check: false };
        let sending = Transmission::new(b"%\nM30\n%\n", |at| at, &wire).unwrap();
        let pace = Pace::new(11, 9_600, None);
        let line = LineUse { pace, xonxoff: false, eight_bits: false, start_timeout: None, xoff_timeout: None };
        let mut view = View::new(String::new(), Listing::new(&sending, &[0.0; 3]), 100.0);
        let sender = Sender::new(sending, line);
        for chip_ratio in [None, Some(0.5), None, Some(0.996)] {
            let machine = Machine { override_percent: Some(120), chip_ratio, ..Machine::default() };
            view.update(Micros(0), &sender, Some(0), machine);
            view.sample();
        }
        assert_eq!((view.strip, view.has_chips), (VecDeque::from([50, 0, 100]), true));
    }
}
