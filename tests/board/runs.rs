//! Runs of the example with one controller or another.

use arcfeed::adapt::adapt;
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_board_app::application::command_handler::Identity;
use arcfeed_board_app::application::control_task::Supply;
use arcfeed_board_app::application::messages::Queues;
use arcfeed_board_app::assembly::{Config, assemble};
use arcfeed_board_app::main_loop::Untapped;
use arcfeed_control::Control;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::{Request, Signals};
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::override_source::board::{AttachedDevices, Board, Wires};
use arcfeed_hil_sim::override_source::controller::InProcessController;
use arcfeed_hil_sim::override_source::in_process::InProcess;
use arcfeed_hil_sim::override_source::{MachineSignals, MoveStart, OverrideSource};
use arcfeed_hil_sim::simulated_machine::STEP;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_link::message::codes::{ModeCode, ResetCode, StateCode};
use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_nc::block::Reading;
use arcfeed_nc::segment::Segment;
use arcfeed_tests::emulation::host::Host;
use arcfeed_tests::root;

/// Orders ahead of the tick, less one: as in the image.
pub const AHEAD: usize = 32;
/// Periods in which a link must come up and a job be sent.
const PREPARING: u32 = 5_000;

/// The example's job, and its program as it is sent.
pub struct Example {
    pub file: JobFile,
    pub text: Vec<u8>,
}

/// Result of a run.
pub struct Outcome {
    /// Override at each period from cycle start on, %.
    pub overrides: Vec<u8>,
    /// Chips of each move, as the chip meter measured them.
    pub chips: Vec<MoveChips>,
}

/// Takes down the moves that the control begins.
#[derive(Default)]
struct Listener(Vec<Segment>);

impl OverrideSource for Listener {
    fn begin(&mut self, begun: Option<MoveStart<'_>>) {
        self.0.extend(begun.map(|begun| *begun.segment));
    }

    fn decide(&mut self, _shown: &MachineSignals) -> FeedOverride {
        FeedOverride::PROGRAMMED
    }
}

impl Example {
    pub fn load() -> Self {
        let path = root().join("examples/ibr-slot/job.toml");
        let file = JobFile::load(&path).expect("the example's job is sound");
        let program = Program::load(&file.program, file.job.unit, Reading::Lenient).expect("the example has a program");
        let text = [adapt(&program, &file.job).text, b"\n".to_vec()].concat();
        Example { file, text }
    }

    /// The example with its first eight arcs, two of each movement; those behind them are comments.
    #[must_use]
    pub fn of_eight_arcs(mut self) -> Self {
        let text = String::from_utf8(self.text).expect("the example is text");
        let is_later = |line: &str| ("N152".."N204").contains(&&line[..line.len().min(4)]);
        let lines = text.lines().map(|line| if is_later(line) { format!("({line})\n") } else { format!("{line}\n") });
        self.text = lines.collect::<String>().into_bytes();
        self
    }

    pub fn control(&self) -> Control {
        Control::from_memory(control_settings(&self.file), &self.text)
    }

    /// The moves of the program, in order.
    pub fn segments(&self) -> Vec<Segment> {
        let mut simulation = Simulation::new(self.control(), &self.file.job, Listener::default());
        finish(&mut simulation);
        simulation.source().0.clone()
    }

    /// The host at the far end of the link, with the whole job.
    pub fn host(&self) -> Host {
        Host::new(&self.file.job, &self.segments())
    }

    /// A machine whose override a board decides, with feed hold on.
    pub fn simulation<W: Wires, A: AttachedDevices>(
        &self,
        wires: W,
        attached: A,
        mode: ModeCode,
    ) -> Simulation<Board<W, A>> {
        let mut simulation = Simulation::new(self.control(), &self.file.job, Board::new(wires, attached, mode));
        simulation.control_mut().hold();
        simulation
    }

    /// A run by the controller notified of each block.
    pub fn by_controller(&self) -> Outcome {
        let controller =
            InProcessController::new(&self.file.job, ControllerFault::None, STEP.into()).expect("the job is sound");
        finish(&mut Simulation::new(self.control(), &self.file.job, controller))
    }

    /// A run by the board application in this process, which logs these frames behind so many ticks each.
    pub fn by_application(&self, log: Vec<(u32, Vec<u8>)>) -> (Outcome, Host) {
        let mut queues = Queues::<AHEAD>::new();
        let identity = Identity { name: "in process", version: [0, 1, 0], reset: ResetCode::Power, starts: 1 };
        let config = Config { supply: Supply::Link, settings: Settings::default(), identity, fault: None };
        let (host_link, task) = assemble(&mut queues, config).expect("the settings are sound");
        let (outcome, host, _) = self.by_board(InProcess::new(Untapped::new(host_link, None), task).with_log(log));
        (outcome, host)
    }

    /// A run by a board at the end of these lines.
    pub fn by_board<W: Wires>(&self, wires: W) -> (Outcome, Host, W) {
        let mut simulation = self.simulation(wires, self.host(), ModeCode::Lockstep);
        prepare(&mut simulation);
        simulation.control_mut().cycle_start();
        let outcome = finish(&mut simulation);
        assert_eq!(simulation.source().failure(), None);
        let (wires, host) = simulation.into_source().into_parts();
        (outcome, host, wires)
    }
}

/// Steps until the board has a job and segments ahead; then a person arms, and the override rises to the dial. `between` is called
/// between steps.
///
/// # Errors
/// It is not armed in the end, or the board is gone.
pub fn try_prepare<W: Wires>(
    simulation: &mut Simulation<Board<W, Host>>,
    mut between: impl FnMut(&Host),
) -> Result<(), String> {
    let mut armed = false;
    for _ in 0..PREPARING {
        simulation.step();
        let board = simulation.source();
        if let Some(broken) = board.failure() {
            return Err(format!("{broken:?}"));
        }
        between(board.attached());
        let is_armed = board.state().is_some_and(|state| matches!(state, StateCode::Armed | StateCode::Inhibited));
        let is_full = board.attached().report.is_some_and(|report| report.in_work.is_some() && report.room == 0);
        if armed && is_armed && simulation.override_output() == FeedOverride::PROGRAMMED {
            simulation.source_mut().set_panel(Signals::NONE);
            return Ok(());
        }
        if is_full && !armed {
            simulation.source_mut().set_panel(Signals::of_request(Request::Arm));
            armed = true;
        }
    }
    Err(format!("not armed: {:?}, {:?}", simulation.source().state(), simulation.source().attached().report))
}

/// As [`try_prepare`], where nothing can come between.
pub fn prepare<W: Wires>(simulation: &mut Simulation<Board<W, Host>>) {
    try_prepare(simulation, |_| {}).unwrap_or_else(|reason| panic!("{reason}"));
}

/// Steps to the end of the program.
pub fn finish<D: OverrideSource>(simulation: &mut Simulation<D>) -> Outcome {
    let mut overrides = Vec::new();
    while !simulation.is_done() {
        simulation.step();
        overrides.push(simulation.override_output().percent);
    }
    Outcome { overrides, chips: simulation.meter().moves().to_vec() }
}

/// Least and largest chip over target, over all moves with a contact.
pub fn chip_range(chips: &[MoveChips]) -> [f64; 2] {
    let contacts = || chips.iter().map(|chips| &chips.contact).filter(|contact| contact.samples > 0);
    let min = contacts().map(|contact| contact.min_ratio).fold(f64::INFINITY, f64::min);
    [min, contacts().map(|contact| contact.max_ratio).fold(0.0, f64::max)]
}

impl Outcome {
    /// FNV-1a over the overrides.
    pub fn hash(&self) -> u32 {
        self.overrides.iter().fold(0x811C_9DC5, |hash, percent| (hash ^ u32::from(*percent)).wrapping_mul(0x0100_0193))
    }
}
