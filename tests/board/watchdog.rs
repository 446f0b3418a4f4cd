//! A board whose main loop, tick or core stops: its watchdog releases the lines, then starts it anew, and it says why.
//!
//! The image is the tapped board with orders on a line that no image for use listens to. It runs free, by its timer, until it hangs;
//! what it does after its restart is looked at in lockstep, where nothing hangs on the clock of the wall.

use std::fs;
use std::time::{Duration, Instant};

use arcfeed_firmware::supervisor::signals::{Request, Signals};
use arcfeed_hil_sim::override_source::board::{Board, Wire, Wires};
use arcfeed_hil_sim::override_source::{MachineSignals, OverrideSource};
use arcfeed_link::message::Message;
use arcfeed_link::message::codes::{ModeCode, RefusalCode, RequestCode, ResetCode, StateCode};
use arcfeed_link::message::table::{AskInfo, Request as Asked, Setpoint};
use arcfeed_nc::modal::Pose;
use arcfeed_tests::emulation::host::Host;
use arcfeed_tests::emulation::images::image;
use arcfeed_tests::emulation::qemu::Emulator;
use arcfeed_units::{Micros, RevPerMin};

use crate::elf::Elf;
use crate::free::{Free, OBEYING};

/// Images that must not obey orders.
const FOR_USE: [&str; 2] = ["feedboard", "feedboard-tap"];
/// Commands to the image: stop the main loop, stop the tick, cause a core fault.
const MAIN_LOOP: u8 = b'm';
const TICK: u8 = b't';
const CORE: u8 = b'f';
/// Ticks from the last feeding to 0 % if the main loop stops right behind it, as in docs/board-safety.md.
const RELEASES_AFTER: u32 = 100;
/// It is fed behind each tick, but for one under way.
const FED_WITHIN: u32 = 2;
/// Setpoints until the override is at the dial, and between two samples.
const SETTLING: u32 = 2_100;
const SAMPLE_EVERY: u32 = 10;
/// *FV0 to *FV7 of 100 %.
const HUNDRED: u8 = 100;
/// While the board waits, the emulator's time is that of the wall, and what it shows last it shows for 100 ms at most: a machine with
/// much else to do may lose either, not every time.
const ATTEMPTS: u32 = 10;
/// After so long without a setpoint the board may have started anew.
const LONG_SILENCE: Duration = Duration::from_millis(500);
/// Longest time of a restart, wall clock.
const TIMEOUT: Duration = Duration::from_secs(60);

/// The machine's end of a board that runs free.
struct Machine(Free);

impl Machine {
    /// The next setpoint; `None` once the board has started anew.
    fn setpoint(&mut self) -> Option<Setpoint> {
        let began = Instant::now();
        loop {
            let mut byte = [0];
            if self.0.board.take_waiting(Wire::Machine, &mut byte).expect("the machine line is open") > 0 {
                if let Some(Message::Setpoint(setpoint)) = self.0.line.on_byte(byte[0]) {
                    return Some(setpoint);
                }
                continue;
            }
            std::thread::sleep(Duration::from_millis(1));
            if began.elapsed() < LONG_SILENCE {
                continue;
            }
            if self.0.starts() > 1 {
                return None;
            }
            assert!(began.elapsed() < TIMEOUT, "neither setpoints nor a restart: {:?}", self.0.log());
        }
    }

    /// Until the override is at the dial, with the last sample long read; `None` if the watchdog bit.
    fn settle(&mut self) -> Option<()> {
        self.0.show();
        let mut last = self.setpoint()?;
        for count in 1..SETTLING + 2 * SAMPLE_EVERY {
            last = self.setpoint()?;
            if count % SAMPLE_EVERY == 0 && count <= SETTLING {
                self.0.show();
            }
        }
        assert!(last.lines == HUNDRED || last.state == StateCode::Faulted, "{last:?}");
        Some(())
    }

    /// Gives the order, until the board shows that its lines are released; `None` if it starts anew before it has shown that.
    fn hang(&mut self, order: u8) -> Option<()> {
        self.settle()?;
        self.0.board.order(order);
        while self.setpoint()?.state != StateCode::Faulted {}
        let began = Instant::now();
        while self.0.starts() < 2 {
            assert!(began.elapsed() < TIMEOUT, "no restart: {:?}", self.0.log());
            std::thread::sleep(Duration::from_millis(200));
        }
        Some(())
    }
}

/// Orders a hang of a board at 100 %, which lets the lines go before it restarts; the board after its restart.
fn hang(order: u8) -> Machine {
    let bitten = |mut machine: Machine| machine.hang(order).is_some().then_some(machine);
    let machine = (0..ATTEMPTS).map(|_| Machine(Free::start())).find_map(bitten);
    machine.expect("a fed watchdog does not fire; when it fires the lines are shown released")
}

/// Ticks from the last feed to the release of the lines, as the board reported after its restart.
fn ticks_to_release(order: u8) -> u32 {
    let log = hang(order).0.log();
    let line = log.iter().find(|line| line.contains("the watchdog bit"));
    let line = line.unwrap_or_else(|| panic!("it does not say why it started: {log:?}"));
    println!("{line}");
    line.split_whitespace().find_map(|word| word.parse().ok()).expect("a number of ticks")
}

fn shown(ms: u64) -> MachineSignals {
    let (position, spindle) = (Pose::ORIGIN, RevPerMin(1_000.0));
    MachineSignals { at: Micros::from_ms(ms), position, spindle, operator_percent: 100, signals: Signals::NONE }
}

/// Lets periods pass with a panel pressed; the state behind them, and the highest override in them.
fn pass(board: &mut Board<Emulator, Host>, at_ms: &mut u64, panel: Signals, periods: u64) -> (StateCode, u8) {
    board.set_panel(panel);
    let percents = (0..periods).map(|period| board.decide(&shown(*at_ms + period)).percent);
    let highest = percents.max().expect("a period");
    *at_ms += periods;
    assert_eq!(board.failure(), None);
    (board.state().expect("a setpoint"), highest)
}

#[test]
fn a_main_loop_that_hangs_lets_the_lines_go_in_time_and_the_board_restarts() {
    let ticks = ticks_to_release(MAIN_LOOP);
    assert_eq!(ticks, RELEASES_AFTER);
}

#[test]
fn a_tick_that_stops_is_not_fed_for_by_the_main_loop() {
    let ticks = ticks_to_release(TICK);
    assert!(ticks <= FED_WITHIN, "no tick came: {ticks}");
}

#[test]
fn a_fault_of_the_core_lets_the_lines_go_at_once() {
    let ticks = ticks_to_release(CORE);
    assert!(ticks <= FED_WITHIN, "{ticks} ticks");
}

#[test]
fn a_start_by_the_watchdog_is_reported_and_nothing_is_armed_before_a_person_has_reset_and_armed() {
    let host = Host::saying([AskInfo {}.into()]);
    let (mut board, mut at_ms) = (Board::new(hang(MAIN_LOOP).0.board, host, ModeCode::Lockstep), 1);
    let [none, arm, reset] = [Signals::NONE, Signals::of_request(Request::Arm), Signals::of_request(Request::Reset)];
    assert_eq!(pass(&mut board, &mut at_ms, none, 3_000), (StateCode::Faulted, 0));
    let epoch = board.attached().report.expect("a report").epoch;
    board.attached_mut().say_later(Asked { what: RequestCode::Arm, epoch });
    assert_eq!(pass(&mut board, &mut at_ms, none, 500), (StateCode::Faulted, 0));
    let heard = &board.attached().heard;
    let info = heard.iter().find_map(|message| match message {
        Message::Info(info) => Some(*info),
        _ => None,
    });
    let info = info.unwrap_or_else(|| panic!("no info: {heard:?}"));
    assert_eq!((info.reset, info.starts), (ResetCode::Watchdog, 2));
    let is_refused =
        |message: &Message| matches!(message, Message::Refused(refused) if refused.why == RefusalCode::Faulted);
    assert!(heard.iter().any(is_refused), "the host cannot arm it: {heard:?}");
    assert_eq!(pass(&mut board, &mut at_ms, arm, 500), (StateCode::Faulted, 0));
    assert_eq!(pass(&mut board, &mut at_ms, none, 500), (StateCode::Faulted, 0));
    assert_eq!(pass(&mut board, &mut at_ms, reset, 20).0, StateCode::Idle);
    assert_eq!(pass(&mut board, &mut at_ms, none, 3_000), (StateCode::Idle, 100), "a reset arms nothing");
    assert_eq!(pass(&mut board, &mut at_ms, arm, 20), (StateCode::Armed, 100));
}

#[test]
fn a_power_on_start_is_reported() {
    let board = Free::start().board;
    let (mut board, mut at_ms) = (Board::new(board, Host::saying([AskInfo {}.into()]), ModeCode::Lockstep), 1);
    assert_eq!(pass(&mut board, &mut at_ms, Signals::NONE, 500).0, StateCode::Idle);
    let is_power = |message: &Message| matches!(message, Message::Info(info) if info.reset == ResetCode::Power);
    assert!(board.attached().heard.iter().any(is_power));
}

/// The handler of UART 4's receiver, and that of a line that nothing uses.
fn handlers(name: &str) -> [u32; 2] {
    const UART4_RX: usize = 16 + 20;
    const UNUSED: usize = 16 + 31;
    let file = fs::read(image(name)).expect("the image is there");
    let table = Elf::parse(&file).content(&file, ".vector_table");
    [UART4_RX, UNUSED].map(|entry| u32::from_le_bytes(table[4 * entry..][..4].try_into().expect("a word")))
}

#[test]
fn no_image_for_use_has_a_handler_that_takes_orders() {
    for name in FOR_USE {
        let [orders, unused] = handlers(name);
        assert_eq!(orders, unused, "{name}: both are the handler of what is not used");
    }
    let [orders, unused] = handlers(OBEYING);
    assert_ne!(orders, unused);
}
