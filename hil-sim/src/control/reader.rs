//! Blocks to actions: what a line that has been read asks the control to do.

use arcfeed_shared::nc::alarm::{Alarm, Fault};
use arcfeed_shared::nc::block::{Block, Line};
use arcfeed_shared::nc::modal::Stop;
use arcfeed_shared::reader::Understood;
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::Micros;

/// One block, ready to execute.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadBlock {
    /// Its line in what was received, counted from 1; of a called program the line of the call.
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

/// What a line that has been understood asks for.
pub fn action(understood: &Understood) -> Action {
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
