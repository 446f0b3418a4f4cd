//! State of a transmission for the live page, in the job's unit; no I/O.

use serde::Serialize;

use crate::dnc::State;
use crate::screen::view::View;

/// State of a transmission at one moment, as JSON. Fields that are unknown are `None` (null).
#[derive(Clone, Debug, Serialize)]
pub struct Snapshot {
    /// Number of this snapshot, counted from 1.
    pub number: u64,
    /// The transmission has ended; nothing follows.
    pub is_over: bool,
    /// State of the sender: `waiting`, `sending`, `stopped`, `held`, `sent`, `aborted`, `failed`.
    pub state: &'static str,
    /// The same, for a person.
    pub words: &'static str,
    /// Time since the line was opened, s.
    pub elapsed_s: f64,
    /// Time until the end, s.
    pub left_s: f64,
    /// Line of the program's file that the control executes.
    pub line: Option<usize>,
    /// The executed line is a lower bound: it comes from the control's reports.
    pub is_least: bool,
    /// Line of the program's file that is being sent.
    pub sent_line: Option<usize>,
    /// Text of the executed block, or of the block being sent if the executed one is unknown.
    pub block: String,
    /// Number of characters sent.
    pub characters: usize,
    /// Number of characters of the whole transmission.
    pub total: usize,
    /// Number of characters sent that belong to blocks which the control has not started.
    pub at_control: Option<usize>,
    /// The control accepts characters.
    pub is_taken: Option<bool>,
    /// Number of DC3 by which the control has stopped the sender.
    pub stops: u32,
    /// Number of damaged characters from the control.
    pub damaged: Option<u64>,
    /// X, Y, Z of the tool's tip in the program's coordinates.
    pub position: Option<[f64; 3]>,
    /// Position of the tool's tip on the part as it was at its first cut, for a job with a machine.
    pub tip: Option<[f64; 3]>,
    /// Direction of the tool's axis there, from the tip to the holder.
    pub axis: Option<[f64; 3]>,
    /// Feed along the path, per minute.
    pub feed: Option<f64>,
    /// Override in effect, %.
    pub override_percent: Option<u8>,
    /// Measured chip load of the last tooth divided by its target.
    pub chip_ratio: Option<f64>,
    /// Alarm of the control.
    pub alarm: Option<String>,
    /// Path of the journal of this transmission.
    pub journal: Option<String>,
    /// State of the feed board.
    pub board: Option<&'static str>,
    /// Latest warning, otherwise the notes from before the start, one after the other.
    pub note: Option<String>,
}

impl Snapshot {
    /// State that a view shows.
    pub fn new(view: &View) -> Self {
        let lines = &view.program.lines;
        let source = |index: usize| lines.get(index).map(|(source, _)| *source).filter(|source| *source > 0);
        let machine = &view.machine;
        Snapshot {
            number: 0,
            is_over: false,
            state: name(view.state),
            words: view.words(),
            elapsed_s: view.elapsed_s,
            left_s: view.left_s,
            line: view.executed.and_then(source),
            is_least: view.is_least,
            sent_line: source(view.sent),
            block: lines.get(view.center()).map_or(String::new(), |(_, text)| text.clone()),
            characters: view.characters,
            total: view.program.characters(),
            at_control: view.at_control(),
            is_taken: view.is_taken,
            stops: view.xoffs,
            damaged: view.damaged,
            position: view.position(),
            tip: machine.on_part.map(|tool| tool.tip_mm.map(|mm| mm / view.unit.mm())),
            axis: machine.on_part.map(|tool| tool.axis),
            feed: view.feed(),
            override_percent: machine.override_percent,
            chip_ratio: machine.chip_ratio,
            alarm: machine.alarm.clone(),
            journal: view.journal.clone(),
            board: view.board,
            note: view.note().map(str::to_owned),
        }
    }
}

/// Name of a state in the page's data.
fn name(state: State) -> &'static str {
    match state {
        State::Waiting => "waiting",
        State::Sending => "sending",
        State::Stopped => "stopped",
        State::Held => "held",
        State::Sent => "sent",
        State::Aborted => "aborted",
        State::Failed(_) => "failed",
    }
}
