//! A sender, the tap and the simulated machine; the tap's segments are followed by the position alone.

use std::collections::VecDeque;

use arcfeed::adapt::adapt;
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_board_app::tap::settings::TapSettings;
use arcfeed_board_app::tap::status::{TapCounters, TapState};
use arcfeed_board_app::tap::{Tap, TapSegment};
use arcfeed_control::code::{DC1, DC3, TapeCode, without_parity};
use arcfeed_control::line::{LineSettings, SenderParity};
use arcfeed_control::{Control, ControlSettings};
use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller;
use arcfeed_firmware::queue::Follower;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_hil_sim::override_source::{MachineSignals, MoveStart, OverrideSource};
use arcfeed_hil_sim::simulated_machine::STEP;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_model::job::Job;
use arcfeed_nc::block::Reading;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::reader::Reader;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_tests::root;
use arcfeed_units::{LengthUnit, Micros, Nm};

/// Segments that the tick has at hand.
const AT_HAND: usize = 8;
/// A control without text for so long gets none any more.
const STARVED_MAX_MS: u64 = 500;
/// Largest distance of the tool from its path, the tap's setting.
pub const OFF_PATH_MM: f64 = 0.5;
/// No run takes longer, ms of machine time.
const RUN_MAX: usize = 1_000_000;

/// An example's job and its program, adapted.
pub fn example(job: &str) -> (JobFile, Vec<u8>) {
    let file = JobFile::load(&root().join(job)).expect("the job is sound");
    let program = Program::load(&file.program, file.job.unit, Reading::Lenient).expect("the example has a program");
    let text = adapt(&program, &file.job).text;
    (file, text)
}

/// The control of a job on a line of eight bits: what the sender puts out is what arrives.
pub fn control(file: &JobFile, code: Option<TapeCode>) -> ControlSettings {
    let settings = control_settings(file);
    let mut line = LineSettings { sender: SenderParity::None, ..settings.line };
    line.tape.code = code;
    ControlSettings { line, ..settings }
}

/// A program as a sender puts it on such a line.
pub fn encoded(text: &[u8], code: TapeCode) -> Vec<u8> {
    text.iter().filter_map(|byte| code.encode(*byte)).collect()
}

/// Times in which laws acted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures {
    /// Ticks on which a law had the override, and those on which the control made another move.
    pub governed: u32,
    pub strange: u32,
    /// Most of the latter in a row on which the axes were off the path that the law was for.
    pub off_path_in_row: u32,
    off_path_row: u32,
}

/// The tap, and what a board does with what it hands out.
#[derive(Debug)]
pub struct Board<const ROOM: usize> {
    pub tap: Tap<ROOM>,
    job: Job,
    supervisor: Supervisor,
    memory: Memory,
    follower: Follower,
    queue: VecDeque<ActiveSegment>,
    /// Count of the segment that the axes are on.
    in_work: u32,
    executed: u32,
    /// The moves of the program as the tap hears it, for the tests' own check, and the one that the control makes.
    pub heard: Vec<Segment>,
    begun: Option<Segment>,
    pub figures: Figures,
}

impl<const ROOM: usize> Board<ROOM> {
    pub fn new(settings: TapSettings, job: &Job) -> Self {
        Board {
            tap: Tap::new(settings).expect("sound settings"),
            job: job.clone(),
            supervisor: Supervisor::new(job, Settings::default()).expect("sound limits"),
            memory: Memory::armed(),
            follower: Follower::default(),
            queue: VecDeque::new(),
            in_work: 0,
            executed: 0,
            heard: Vec::new(),
            begun: None,
            figures: Figures::default(),
        }
    }

    fn take_what_is_handed_out(&mut self) {
        if self.tap.must_clear() {
            self.queue.clear();
            self.follower.restart();
        }
        while self.queue.len() < AT_HAND {
            let Some(TapSegment { count, segment }) = self.tap.next(&self.job) else { break };
            if self.queue.is_empty() {
                self.in_work = count;
            }
            self.queue.push_back(segment);
        }
    }

    fn follow(&mut self, measured: &controller::Measurement) {
        let Some(front) = self.queue.front() else { return };
        if self.follower.follow(self.supervisor.controller(), front, measured) {
            self.queue.pop_front();
            self.in_work = self.in_work.wrapping_add(1);
            self.executed += 1;
        }
    }

    /// Checks that the law that has the override is that of the control's move; if not, measures the distance of its
    /// path.
    fn check(&mut self, is_governed: bool, position: &Pose) {
        let figures = &mut self.figures;
        figures.governed += u32::from(is_governed);
        let Some(believed) = self.heard.get(self.in_work as usize).filter(|_| is_governed) else {
            figures.off_path_row = 0;
            return;
        };
        let is_same = self.begun.is_some_and(|begun| (begun.end, begun.path) == (believed.end, believed.path));
        figures.strange += u32::from(!is_same);
        let is_off = !is_same && distance_mm(believed, position) > OFF_PATH_MM;
        figures.off_path_row = if is_off { figures.off_path_row + 1 } else { 0 };
        figures.off_path_in_row = figures.off_path_in_row.max(figures.off_path_row);
    }
}

impl<const ROOM: usize> OverrideSource for Board<ROOM> {
    /// Kept for the tests' own check, not for the board.
    fn begin(&mut self, begun: Option<MoveStart<'_>>) {
        self.begun = begun.map(|begun| *begun.segment);
    }

    fn decide(&mut self, shown: &MachineSignals) -> FeedOverride {
        let board = self;
        let measured =
            controller::Measurement { position: Some(shown.position), spindle: shown.spindle, dt: STEP.into() };
        let input = Input { operator_percent: shown.operator_percent, signals: shown.signals, ..Input::of(measured) };
        board.follow(&measured);
        let in_work = board.queue.front().map(|_| board.in_work);
        board.tap.follow(in_work, board.executed, &shown.position);
        board.take_what_is_handed_out();
        let work = board.follower.in_work(board.queue.front());
        let output = board.supervisor.tick(&mut board.memory, work, &input);
        board.check(output.ipt_center.is_some(), &shown.position);
        output.feed_override
    }
}

/// A sender that knows nothing of a board: it waits for DC1, sends, and stops at DC3.
#[derive(Debug)]
pub struct Sender {
    frames: Vec<u8>,
    at: usize,
    may_send: bool,
}

impl Sender {
    pub fn new(frames: Vec<u8>) -> Self {
        Sender { frames, at: 0, may_send: false }
    }

    pub fn on_byte(&mut self, byte: u8) {
        match without_parity(byte) {
            DC1 => self.may_send = true,
            DC3 => self.may_send = false,
            _ => {}
        }
    }

    /// The next character, if it may send.
    pub fn poll(&mut self) -> Option<u8> {
        let byte = self.frames.get(self.at).copied().filter(|_| self.may_send)?;
        self.at += 1;
        Some(byte)
    }

    /// Sends something else from its beginning.
    pub fn start_with(&mut self, frames: Vec<u8>) {
        *self = Sender::new(frames);
    }
}

/// All of it.
pub struct Bench<const ROOM: usize = 4_096> {
    pub simulation: Simulation<Board<ROOM>>,
    pub sender: Sender,
    /// When the sender begins: the board has seen the axes at rest by then.
    pub begins: Micros,
    /// Change of each character between the tap and the control.
    pub between: Box<dyn FnMut(usize, u8) -> Vec<u8>>,
    passed: usize,
}

/// Results of a run.
#[derive(Clone, Copy, Debug)]
pub struct Ended {
    pub state: TapState,
    pub counters: TapCounters,
    pub figures: Figures,
}

impl Bench {
    pub fn new(control_settings: ControlSettings, settings: TapSettings, job: &Job, frames: Vec<u8>) -> Self {
        Bench::with_room(control_settings, settings, job, frames)
    }
}

impl<const ROOM: usize> Bench<ROOM> {
    pub fn with_room(control_settings: ControlSettings, settings: TapSettings, job: &Job, frames: Vec<u8>) -> Self {
        let simulation = Simulation::new(Control::on_line(control_settings), job, Board::new(settings, job));
        Bench {
            simulation,
            sender: Sender::new(frames),
            begins: Micros::from_ms(50),
            between: Box::new(|_, byte| vec![byte]),
            passed: 0,
        }
    }

    /// One step of everything.
    pub fn step(&mut self) {
        let now = self.simulation.now();
        while let Some(byte) = self.simulation.control_mut().port().poll_transmit() {
            let passed_on = self.simulation.source_mut().tap.from_control(now, byte);
            self.sender.on_byte(passed_on);
        }
        // As a sender's hardware: one character on the line, one behind it.
        while now >= self.begins && self.simulation.control_mut().port().on_wire() < 2 {
            let Some(byte) = self.sender.poll() else { break };
            let passed_on = self.simulation.source_mut().tap.from_sender(now, byte);
            let arriving = (self.between)(self.passed, passed_on);
            self.passed += 1;
            self.simulation.control_mut().port().on_bytes(&arriving);
        }
        self.simulation.step();
    }

    /// Runs until the control has ended.
    pub fn run(&mut self) -> Ended {
        for _ in 0..RUN_MAX {
            self.step();
            if self.simulation.is_done() || self.simulation.control().starved_ms() > STARVED_MAX_MS {
                break;
            }
        }
        self.ended()
    }

    pub fn ended(&self) -> Ended {
        let board = self.simulation.source();
        Ended { state: board.tap.state(), counters: *board.tap.counters(), figures: board.figures }
    }
}

/// The moves of a program, read by themselves; up to the first block that cannot be.
pub fn moves(text: &[u8], unit: LengthUnit) -> Vec<Segment> {
    let mut reader = Reader::new(unit, Reading::Lenient);
    let blocks = text.split(|byte| *byte == b'\n').filter(|line| line.first() != Some(&b'%'));
    let read = blocks.map_while(|line| reader.read(line.trim_ascii_end()).ok());
    read.filter_map(|understood| understood.segment).collect()
}

/// Distance from the path of a move, mm: the least over many places on it.
pub fn distance_mm(segment: &Segment, position: &Pose) -> f64 {
    const PLACES: u32 = 2_000;
    let at = position.linear.map(Nm::to_mm);
    let [start, end] = [&segment.start, &segment.end].map(|place| place.linear.map(Nm::to_mm));
    let place = |ratio: f64| -> [f64; 3] {
        let mut place: [f64; 3] = std::array::from_fn(|axis| start[axis] + ratio * (end[axis] - start[axis]));
        if let Path::Arc(arc) = &segment.path {
            let (first, second, _) = arc.plane.axes();
            let direction = arc.direction_at(ratio);
            for (index, axis) in [first, second].into_iter().enumerate() {
                place[axis] = arc.center[index].to_mm() + arc.radius_mm() * direction[index];
            }
        }
        place
    };
    let distance = |place: [f64; 3]| {
        let [x, y, z] = std::array::from_fn(|axis| place[axis] - at[axis]);
        libm::hypot(libm::hypot(x, y), z)
    };
    (0..=PLACES).map(|count| distance(place(f64::from(count) / f64::from(PLACES)))).fold(f64::INFINITY, f64::min)
}
