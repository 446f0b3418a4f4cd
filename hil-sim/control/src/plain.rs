//! Plain blocks to actions in machine coordinates, by the interpreter of `shared` with all of its dialect.
//!
//! The interpreter gives the path of the tool tip; the axes are in machine coordinates, with the tool length added to
//! Z. Each move begins where the axes are: a length offset that begins without a move of Z moves nothing, and the next
//! move makes up for it. Moves under G41 and G42 are the contour here; `contour_queue.rs` offsets them. Under G43.4 the
//! model executes the path of the tool tip.

use arcfeed_compensation::contour::ContourCommand;
use arcfeed_nc::alarm::{Alarm, Fault, NotModelled};
use arcfeed_nc::block::Block;
use arcfeed_nc::modal::{Modal, Plane, Pose};
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::settings::CompensationType;
use arcfeed_units::Nm;

use super::action::{Action, MoveContext, ProgrammedPath, WorkpiecePlace};
use super::restart::RestartList;
use super::settings::ControlSettings;
use super::unplaced::UnplacedAxes;

/// Result of reading a plain block (one without macro statements).
#[derive(Clone, Debug, PartialEq)]
pub struct Plain {
    /// Action of the block.
    pub action: Action,
    /// Context of the block's moves.
    pub context: MoveContext,
    /// Cutter compensation that the block commands.
    pub contour: ContourCommand,
}

/// Reader of plain blocks (without macro statements), which keeps the modal state.
#[derive(Debug)]
pub struct PlainReader {
    reader: Reader,
    end: Pose,
    taps: bool,
    sets_data: bool,
    /// Programs have the path of the tool centre under G41 and G42, too.
    is_center_path: bool,
    restart: Option<RestartList>,
    unplaced: UnplacedAxes,
}

impl PlainReader {
    /// Reader at power-on, the axes at the machine's zero.
    pub fn new(settings: &ControlSettings) -> Self {
        let reader = Reader::with(settings.nc, settings.tables);
        let is_center_path = settings.nc.compensation.of_program == CompensationType::Wear;
        let unplaced = UnplacedAxes::default();
        PlainReader {
            reader,
            end: Pose::ORIGIN,
            taps: false,
            sets_data: false,
            is_center_path,
            restart: None,
            unplaced,
        }
    }

    /// Modal state after the last block read.
    pub fn modal(&self) -> &Modal {
        self.reader.modal()
    }

    /// Interpreter of the program's text, to read or change its settings.
    pub fn reader(&mut self) -> &mut Reader {
        &mut self.reader
    }

    /// Whether the last block read has written offsets (G10).
    pub fn has_set_data(&self) -> bool {
        self.sets_data
    }

    /// Machine position at the end of the blocks read, as the program gives it.
    pub fn machine(&self) -> Pose {
        self.reader.machine()
    }

    /// Machine position at the end of the last move that was read.
    pub fn end(&self) -> Pose {
        self.end
    }

    /// Sets the machine position from which the next block begins; the tool has no length then.
    pub fn stand_at(&mut self, machine: Pose) {
        self.reader.set_position(machine);
        self.end = machine;
    }

    /// Begins to collect the functions (M, S, T) that a restart must show to the operator.
    pub fn list_for_restart(&mut self) {
        self.restart = Some(RestartList::default());
    }

    /// Takes the collected functions of all blocks before the last one read.
    pub fn take_restart_list(&mut self) -> Option<RestartList> {
        self.restart.take()
    }

    /// Reads a block, and makes its action in machine coordinates.
    ///
    /// # Errors
    /// As [`Reader::read`]; PS0011 for a cutting move without a feed; a tool length that begins in an arc along Z.
    pub fn read(&mut self, text: &[u8]) -> Result<Plain, Fault> {
        if let Some(list) = &mut self.restart {
            list.begin_block(self.reader.modal());
        }
        self.sets_data = false;
        let continues = self.reader.modal().is_in_contour();
        let understood = self.reader.read(text)?;
        self.sets_data = understood.step.sets_data;
        self.note(&understood.parsed.block);
        let contour =
            ContourCommand { continues, ..ContourCommand::of(&understood, self.reader.modal(), self.reader.tables()) };
        let place = self.unplaced.pass(&understood, &self.reader);
        let context = MoveContext { place, ..self.context(&understood, &contour) };
        let mut action = action(&understood);
        if let Action::Move(segment, _) = &mut action {
            *segment = self.in_machine(segment, context.tool)?;
            self.end = segment.end;
        }
        if let Action::Series(..) = &action {
            self.end = self.reader.machine();
        }
        Ok(Plain { action, context, contour })
    }

    fn note(&mut self, block: &Block) {
        if let Some(list) = &mut self.restart {
            list.add(block);
        }
        for word in block.words.iter().filter(|word| word.letter == b'G') {
            match word.number.as_whole() {
                Some(63) => self.taps = true,
                Some(61 | 62 | 64) => self.taps = false,
                _ => {}
            }
        }
    }

    fn context(&self, understood: &InterpretedLine, contour: &ContourCommand) -> MoveContext {
        let modal = self.reader.modal();
        let tool = modal.tool_length(self.reader.tables());
        let origin = modal.work_origin().plus(along_z(tool));
        let is_special = !understood.step.is_plain() || self.taps;
        let programmed_path = match modal.compensation {
            Some(_) if contour.offset == Nm(0) && !self.is_center_path => ProgrammedPath::Contour,
            _ if modal.follows_tool_center => ProgrammedPath::Tip,
            _ => ProgrammedPath::Axes,
        };
        MoveContext {
            origin,
            tool,
            is_special,
            is_tapping: self.taps,
            programmed_path,
            machining: modal.machining(),
            place: WorkpiecePlace::Known,
            feed_cut_ppm: 0,
        }
    }

    fn in_machine(&self, segment: &Segment, tool: Nm) -> Result<Segment, Fault> {
        let moved = segment.shifted(along_z(tool));
        let is_along_z = moved.arc().is_some_and(|arc| arc.plane != Plane::Xy);
        if is_along_z && moved.start != self.end {
            return Err(Fault::not_modelled(NotModelled::MoveUnder(430), 0));
        }
        Ok(Segment { start: self.end, ..moved })
    }
}

/// Position with `length` as Z, and zero in all other axes.
pub fn along_z(length: Nm) -> Pose {
    Pose { linear: [Nm(0), Nm(0), length], ..Pose::ORIGIN }
}

/// Action of a block that has been read, in program coordinates.
fn action(understood: &InterpretedLine) -> Action {
    let InterpretedLine { parsed, step, segment, .. } = understood;
    let has_function = |block: &Block| block.words.iter().any(|word| matches!(word.letter, b'M' | b'S' | b'T'));
    if understood.lacks_feed() {
        return Action::Fault(Fault::alarm(Alarm::NoFeed, 0));
    }
    match (step.stop, step.dwell, segment) {
        (stop, _, Some(segment)) => Action::Move(*segment, stop),
        (stop, ..) if let Some(series) = step.series => Action::Series(Box::new(series), stop),
        (Some(stop), ..) => Action::Stop(stop),
        (None, Some(span), ..) => Action::Dwell(span),
        (None, None, None) if has_function(&parsed.block) => Action::Auxiliary,
        (None, None, None) => Action::Nothing,
    }
}
