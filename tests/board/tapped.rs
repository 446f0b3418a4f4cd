//! The example through the tap: a sender that knows of no board, the board on the DNC line, the control.

use std::collections::VecDeque;

use arcfeed::commands::simulate::control::control_settings;
use arcfeed_board_app::application::command_handler::Identity;
use arcfeed_board_app::application::control_task::Supply;
use arcfeed_board_app::application::messages::Queues;
use arcfeed_board_app::assembly::{Config, assemble};
use arcfeed_board_app::main_loop::MainLoop;
use arcfeed_board_app::tap::Tap;
use arcfeed_board_app::tap::settings::TapSettings;
use arcfeed_control::code::{DC1, DC3, TapeCode, without_parity};
use arcfeed_control::line::{LineCounters, LineSettings, SenderParity};
use arcfeed_control::{Control, ControlSettings};
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::{Request, Signals};
use arcfeed_hil_sim::override_source::board::{AttachedDevices, Board, Traffic, Wire, Wires};
use arcfeed_hil_sim::override_source::in_process::InProcess;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_link::message::codes::{ModeCode, ResetCode, StateCode};
use arcfeed_link::message::page::{self, Page, TappedLine};
use arcfeed_tests::emulation::qemu::{Clock, Emulator};
use arcfeed_units::Micros;

use crate::runs::{AHEAD, Example, Outcome, chip_range};

/// Characters between the sender and the machine, as in the image.
const ROOM: usize = 4_096;
/// Periods until the override of a board just switched on is at the dial, and for how long a button is held.
const SETTLING: u32 = 2_100;
const HELD: u32 = 20;
/// No run takes longer, ms of machine time.
const RUN_MAX: u32 = 200_000;

/// A sender of a program.
pub trait Sender {
    /// The next characters, so many or all that are left: a line that is free waits for them.
    fn take(&mut self, most: usize) -> Vec<u8>;

    /// Receives characters from the control.
    fn hear(&mut self, bytes: &[u8]);
}

/// Characters that the control received, and the result of the run.
pub struct Passage {
    pub outcome: Outcome,
    pub text: Vec<u8>,
    pub line: LineCounters,
}

/// Both ends of the tapped line.
struct Cable<S> {
    /// Not plugged in before the board is armed.
    sender: Option<S>,
    may_send: bool,
    /// Characters that the line takes now.
    room: usize,
    /// Characters from the control, and characters that have arrived for it.
    from_control: Vec<u8>,
    to_control: Vec<u8>,
    passed: Vec<u8>,
}

/// A sender in this process, with characters at hand at any time.
impl Sender for VecDeque<u8> {
    fn take(&mut self, most: usize) -> Vec<u8> {
        self.drain(..most.min(self.len())).collect()
    }

    fn hear(&mut self, _bytes: &[u8]) {}
}

impl<S: Sender> AttachedDevices for Cable<S> {
    fn send(&mut self, _at: Micros, traffic: &mut Traffic) {
        if let Some(sender) = self.sender.as_mut().filter(|_| self.may_send && self.room > 0) {
            traffic.sender.extend(sender.take(self.room));
        }
        traffic.control.append(&mut self.from_control);
    }

    fn receive(&mut self, _at: Micros, wire: Wire, bytes: &[u8]) {
        match wire {
            Wire::Control => self.to_control.extend(bytes),
            Wire::Sender => {
                self.sender.iter_mut().for_each(|sender| sender.hear(bytes));
                for byte in bytes {
                    self.may_send = match without_parity(*byte) {
                        DC1 => true,
                        DC3 => false,
                        _ => self.may_send,
                    };
                }
            }
            Wire::Link | Wire::Machine => assert!(bytes.is_empty() || wire == Wire::Link),
        }
    }
}

/// The control on a line of eight bits: what the sender puts out is what arrives.
fn control(example: &Example) -> ControlSettings {
    let settings = control_settings(&example.file);
    let mut line = LineSettings { sender: SenderParity::None, ..settings.line };
    line.tape.code = Some(TapeCode::Ascii);
    ControlSettings { line, ..settings }
}

fn tap_settings(example: &Example) -> TapSettings {
    TapSettings { code: Some(TapeCode::Ascii), ..TapSettings::new(example.file.job.unit) }
}

/// Sends the example through a board.
pub fn run<W: Wires, S: Sender>(example: &Example, wires: W, sender: S) -> Passage {
    let cable =
        Cable { sender: None, may_send: false, room: 0, from_control: vec![], to_control: vec![], passed: vec![] };
    let board = Board::new(wires, cable, ModeCode::Lockstep);
    let mut simulation = Simulation::new(Control::on_line(control(example)), &example.file.job, board);
    for period in 0..SETTLING + HELD {
        let pressed = if period < SETTLING { Signals::NONE } else { Signals::of_request(Request::Arm) };
        simulation.source_mut().set_panel(pressed);
        step(&mut simulation);
    }
    simulation.source_mut().set_panel(Signals::NONE);
    assert_eq!((simulation.source().state(), simulation.override_output().percent), (Some(StateCode::Armed), 100));
    simulation.source_mut().attached_mut().sender = Some(sender);
    let mut overrides = Vec::new();
    while !simulation.is_done() {
        step(&mut simulation);
        overrides.push(simulation.override_output().percent);
        assert!(overrides.len() < RUN_MAX as usize, "the program never ends");
    }
    let outcome = Outcome { overrides, chips: simulation.meter().moves().to_vec() };
    let line = simulation.control().line_counters();
    Passage { outcome, text: simulation.into_source().into_attached().passed, line }
}

fn step<W: Wires, S: Sender>(simulation: &mut Simulation<Board<W, Cable<S>>>) {
    let on_wire = simulation.control_mut().port().on_wire();
    let said: Vec<u8> = std::iter::from_fn(|| simulation.control_mut().port().poll_transmit()).collect();
    let cable = simulation.source_mut().attached_mut();
    cable.from_control.extend(said);
    // One character on the line, one behind it, one on its way through the board.
    cable.room = 3_usize.saturating_sub(on_wire);
    simulation.step();
    assert_eq!(simulation.source().failure(), None);
    let cable = simulation.source_mut().attached_mut();
    let arrived = std::mem::take(&mut cable.to_control);
    cable.passed.extend(&arrived);
    simulation.control_mut().port().on_bytes(&arrived);
}

/// A board in this process with the image's tap, and a sender in this process.
pub fn in_process(example: &Example) -> Passage {
    let mut queues = Queues::<AHEAD>::new();
    let identity = Identity { name: "in process", version: [0, 1, 0], reset: ResetCode::Power, starts: 1 };
    let config = Config { supply: Supply::Tap, settings: Settings::default(), identity, fault: None };
    let (mut host_link, task) = assemble(&mut queues, config).expect("the settings are sound");
    host_link.handler_mut().load_page(&page_of(example), 1).expect("the job is sound");
    let mut tap = Tap::<ROOM>::new(tap_settings(example)).expect("the settings are sound");
    run(example, InProcess::new(MainLoop::new(host_link, Some(&mut tap)), task), at_hand(example))
}

/// The chip's board, with the example's job in its flash.
pub fn tapped_chip(example: &Example) -> Emulator {
    chip_with_page("feedboard-tap", Clock::Lockstep, &page_of(example))
}

/// A tapped board's image with this page of flash.
pub fn chip_with_page(image: &str, clock: Clock, page: &[u8]) -> Emulator {
    Emulator::with_flash(image, clock, &[("parameters.flash", page)])
}

/// The example's job as it lies in flash.
pub fn page_of(example: &Example) -> Page {
    let tapped = TappedLine { code: Some(TapeCode::Ascii), ..TappedLine::default() };
    page::write(&example.file.job, tapped).expect("a board takes the job")
}

fn at_hand(example: &Example) -> VecDeque<u8> {
    example.text.iter().copied().collect()
}

/// Asserts that the chip decided what the board in this process did, the senders whoever they were.
pub fn assert_same(chip: &Passage, in_process: &Passage, example: &Example) {
    let Passage { outcome: chip_outcome, text, line } = chip;
    println!(
        "{} periods, trace {:08x} on the chip, {:08x} in process; {line:?}",
        chip_outcome.overrides.len(),
        chip_outcome.hash(),
        in_process.outcome.hash()
    );
    assert_eq!(*text, example.text, "byte for byte");
    let mut pairs = chip_outcome.overrides.iter().zip(&in_process.outcome.overrides);
    assert_eq!(pairs.position(|(chip, in_process)| chip != in_process), None, "first period with another override");
    assert_eq!(chip_outcome.overrides.len(), in_process.outcome.overrides.len());
    assert_eq!(chip_outcome.chips, in_process.outcome.chips, "the meter saw the same chips");
    assert_eq!(*line, in_process.line);
}

#[test]
fn through_the_tap_the_chip_decides_bit_for_bit_what_the_board_in_process_does() {
    let example = Example::load();
    let chip = run(&example, tapped_chip(&example), at_hand(&example));
    assert_same(&chip, &in_process(&example), &example);
}

#[test]
fn through_the_tap_the_chips_are_those_of_a_controller_notified_of_each_block() {
    let example = Example::load();
    let (controller, Passage { outcome: tapped, text, .. }) = (example.by_controller(), in_process(&example));
    let (controller_range, range) = (chip_range(&controller.chips), chip_range(&tapped.chips));
    println!("chip over target: notified {controller_range:.5?}, through the tap {range:.5?}");
    assert_eq!(text, example.text, "byte for byte");
    assert_eq!(controller.chips.len(), tapped.chips.len());
    assert!(controller_range.iter().zip(range).all(|(controller, tapped)| (controller - tapped).abs() < 0.01));
}

#[test]
fn without_parameters_a_tapped_chip_adapts_nothing_and_with_broken_ones_it_is_at_0_percent() {
    let example = Example::load();
    let mut page = page_of(&example);
    page[40] ^= 1;
    let erased = [0xFF; 64];
    for (what, page, state, percent) in
        [("never written", &erased[..], StateCode::Armed, 100), ("a bit flipped", &page[..], StateCode::Faulted, 0)]
    {
        let board = Board::new(chip_with_page("feedboard-tap", Clock::Lockstep, page), (), ModeCode::Lockstep);
        let mut simulation = Simulation::new(Control::on_line(control(&example)), &example.file.job, board);
        for period in 0..SETTLING + HELD {
            let pressed = if period < SETTLING { Signals::NONE } else { Signals::of_request(Request::Arm) };
            simulation.source_mut().set_panel(pressed);
            simulation.step();
            assert_eq!(simulation.source().failure(), None);
        }
        assert_eq!(
            (simulation.source().state(), simulation.override_output().percent),
            (Some(state), percent),
            "{what}"
        );
    }
}
