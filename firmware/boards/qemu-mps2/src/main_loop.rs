//! The feed board: link, tapped line and machine line in the main loop, the tick in a timer's interrupt.
//!
//! ```text
//! UART 0 <-> HostLink -- commands, notices -> ControlTask <- TIMER0
//!                 <------ status --------
//! UART 1  -> samples --> | tick side | -> setpoints -> UART 1      (*FV0 to *FV7: the emulator has no pins)
//! UART 2 <-> UART 3: the tapped line
//! ```
//!
//! The first byte on any line decides the mode. If it is a sample in lockstep, the board runs one tick for each sample
//! and the timer is stopped. Otherwise the timer ticks every millisecond, independently of the lines.

use core::mem::MaybeUninit;

use crate::handed::Once;
use crate::interrupts::{Interrupt, Priority, enable};
use crate::serial::Lines;
use crate::stack::Painted;
use crate::tick::{Costs, MainSide, PERIOD, costs, prepare};
use crate::watchdog::Watchdog;
use crate::{flash, log, reset_cause, timer};
use arcfeed_board_app::application::command_handler::{CommandHandler, Identity};
use arcfeed_board_app::application::control_task::Supply;
use arcfeed_board_app::application::messages::Queues;
use arcfeed_board_app::assembly::{Config, assemble};
use arcfeed_board_app::lockstep::{BoardLine, BoardLines as _, Lockstep, forward};
use arcfeed_board_app::main_loop::MainLoop;
use arcfeed_board_app::tap::Tap;
use arcfeed_board_app::tap::status::{TapLossReason, TapState};
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::BoardFault;
use arcfeed_link::frame::ENCODED_MAX;
use arcfeed_link::message::Message;
use arcfeed_link::message::codes::{ModeCode, ResetCode, StateCode};
use arcfeed_link::message::moves::pose;
use arcfeed_link::message::table::Setpoint;
use arcfeed_link::plain::PlainLine;
use arcfeed_units::Micros;
use cortex_m::peripheral::NVIC;

/// Length of the command queue, plus one.
const AHEAD: usize = 32;
/// Ticks between two log lines with figures.
const FIGURES_EVERY: u32 = 1_000;
/// Number of bytes read from the link at a time.
const PART: usize = 64;

/// Setpoint if there is none: all lines released.
const NOTHING: Setpoint = Setpoint { at: 0, lines: 0, state: StateCode::Faulted, link_bytes: 0, tap_bytes: 0 };

/// The main program of the emulated board: the link to the host, the tap on the DNC line, and the line to the simulated machine. Its tap has
/// room for `N` characters.
pub struct Main<const N: usize> {
    front: MainLoop<'static, N>,
    lines: Lines,
    tick: MainSide,
    painted: Painted,
    figures_at: u32,
    tap_state: TapState,
}

impl<const N: usize> Main<N> {
    /// Starts the board. With a tap, which is created when a handler for its parameters exists, the segments come from
    /// the tapped line. `None` if the settings are invalid or if it was called before.
    pub fn start(tapped: Option<fn(&mut CommandHandler<'_>) -> Option<&'static mut Tap<N>>>) -> Option<Self> {
        // Initialised at the start: initial values in the image would need as much flash as RAM.
        static QUEUES: Once<MaybeUninit<Queues<AHEAD>>> = Once::new(MaybeUninit::uninit());
        let painted = Painted::far_below_here();
        let (starts, reset) =
            (flash::count_start(), reset_cause::take_watchdog().map_or(ResetCode::Power, watchdog_reset));
        defmt::info!("feedboard: start {=u32}, a tick every {=u32} us", starts, PERIOD.0);
        let fault = (reset == ResetCode::Watchdog).then_some(BoardFault::Watchdog);
        let identity = Identity { name: "feedboard", version: [0, 1, 0], reset, starts };
        let supply = if tapped.is_some() { Supply::Tap } else { Supply::Link };
        let config = Config { supply, settings: Settings::default(), identity, fault };
        let (lines, queues) = (Lines::start()?, QUEUES.take()?.write(Queues::new()));
        let (mut host_link, task) = assemble(queues, config).ok()?;
        let tap = match tapped {
            Some(tap) => Some(tap(host_link.handler_mut())?),
            None => None,
        };
        let tick = prepare(task)?;
        Some(Main {
            front: MainLoop::new(host_link, tap),
            lines,
            tick,
            painted,
            figures_at: FIGURES_EVERY,
            tap_state: TapState::Listening,
        })
    }

    /// Runs the board forever, with the watchdog from the start.
    pub fn run(self) -> ! {
        self.run_measured(|| false)
    }

    /// Runs the board forever. As long as `is_measured` returns true, no watchdog starts and the board does not sleep; it is only true in a
    /// test image. It is asked before the watchdog is fed, and again behind that.
    pub fn run_measured(mut self, is_measured: fn() -> bool) -> ! {
        let mut lockstep = Lockstep::new();
        // SAFETY: the tick's data are initialised.
        unsafe { enable(Interrupt::Timer0, Priority::First) };
        loop {
            match lockstep.mode(&mut self.lines) {
                Some(ModeCode::Lockstep) => self.keep_step(lockstep),
                Some(ModeCode::Free) => self.run_free(is_measured),
                None if self.lines.waiting(BoardLine::Link) > 0 => self.run_free(is_measured),
                None => self.lines.sleep(),
            }
        }
    }

    /// One tick for each sample. The machine waits for the board, however long it takes: no watchdog.
    fn keep_step(mut self, mut lockstep: Lockstep) -> ! {
        loop {
            let Main { front, lines, tick, .. } = &mut self;
            let is_done = lockstep.poll(front, lines, &mut |_, sample| {
                let _room = tick.heard.enqueue(Some(*sample));
                NVIC::pend(Interrupt::Timer0);
                cortex_m::asm::isb();
                // The tick is done: nothing goes before it.
                tick.setpoints.dequeue().unwrap_or(Setpoint { at: sample.at, ..NOTHING })
            });
            if is_done {
                self.log();
            } else {
                self.lines.sleep();
            }
        }
    }

    /// A tick every millisecond.
    fn run_free(mut self, is_measured: fn() -> bool) -> ! {
        cortex_m::interrupt::free(|_| {
            let _count = forward(&mut self.front, &mut self.lines, Micros(0));
            // SAFETY: interrupts are held back.
            unsafe { self.lines.bridge() };
        });
        // SAFETY: the tick's data are initialised.
        unsafe { timer::start(PERIOD.0) };
        let mut watchdog = None;
        let (mut machine, mut now) = (PlainLine::new(), Micros(0));
        loop {
            self.hear_machine(&mut machine);
            self.hear_link(now);
            self.hear_tapped(now);
            if let Some(setpoint) = self.last_setpoint() {
                now = Micros(setpoint.at);
                self.show(&mut machine, now, setpoint);
            }
            self.front.run(now);
            self.speak_link(now);
            self.log();
            let ticks = costs().ticks;
            if ticks > 0 && !is_measured() {
                // Behind the first tick: nothing was put out before it. SAFETY: the image has the handler of the board's last act.
                watchdog.get_or_insert_with(|| unsafe { Watchdog::start() }).feed_after_tick(ticks);
            }
            // The next tick wakes it, if nothing else does. The emulator's clock jumps over a sleep, at times past the tick: a board that is
            // measured does not sleep.
            if !is_measured() {
                cortex_m::asm::wfi();
            }
        }
    }

    /// As everything that is heard: what waits, and not what comes meanwhile. A line that never rests must not hold the loop.
    fn hear_machine(&mut self, machine: &mut PlainLine) {
        for _ in 0..self.lines.waiting(BoardLine::Machine) {
            let Some(byte) = self.lines.receive(BoardLine::Machine) else { return };
            let invalid = machine.invalid();
            let heard = match machine.on_byte(byte) {
                Some(Message::Sample(sample)) => Some(sample),
                _ if machine.invalid() != invalid => None,
                _ => continue,
            };
            let position = heard.and_then(|sample| pose(sample.linear?, sample.rotary).ok());
            if let Some(position) = position {
                self.front.on_position(&position);
            }
            // With no room, the tick has plenty to go on.
            let _room = self.tick.heard.enqueue(heard);
        }
    }

    fn hear_link(&mut self, now: Micros) {
        let mut part = heapless::Vec::<u8, PART>::new();
        for _ in 0..self.lines.waiting(BoardLine::Link) {
            let Some(byte) = self.lines.receive(BoardLine::Link) else { break };
            let _room = part.push(byte);
            if part.is_full() {
                self.front.on_link_bytes(now, &part);
                part.clear();
            }
        }
        self.front.on_link_bytes(now, &part);
    }

    /// Processes the tapped bytes, which the receive handlers have already forwarded.
    fn hear_tapped(&mut self, now: Micros) {
        for _ in 0..self.lines.waiting(BoardLine::Sender) {
            let Some(byte) = self.lines.receive(BoardLine::Sender) else { break };
            let _passed = self.front.from_sender(now, byte);
        }
        if self.lines.sender.take_gap() {
            self.front.on_line_error();
        }
        for _ in 0..self.lines.waiting(BoardLine::Control) {
            let Some(byte) = self.lines.receive(BoardLine::Control) else { break };
            let _passed = self.front.from_control(now, byte);
        }
        // The tap only counts the control's characters.
        let _gap = self.lines.control.take_gap();
    }

    fn speak_link(&mut self, now: Micros) {
        let mut frame = [0; ENCODED_MAX];
        while self.lines.link.room() >= ENCODED_MAX {
            let length = self.front.poll_link(now, &mut frame);
            match frame.get(..length) {
                Some(frame) if !frame.is_empty() => self.lines.send(BoardLine::Link, frame),
                _ => return,
            };
        }
    }

    fn last_setpoint(&mut self) -> Option<Setpoint> {
        core::iter::from_fn(|| self.tick.setpoints.dequeue()).last()
    }

    /// Only the latest setpoint counts: what finds no room is not missed.
    fn show(&mut self, machine: &mut PlainLine, now: Micros, setpoint: Setpoint) {
        let mut frame = [0; ENCODED_MAX];
        if self.lines.machine.room() >= ENCODED_MAX {
            let length = machine.encode(now, &Message::Setpoint(setpoint), &mut frame);
            let _sent = frame.get(..length).map(|frame| self.lines.send(BoardLine::Machine, frame));
        }
    }

    /// Logs what has changed or is due, and hands the log on behind all else.
    fn log(&mut self) {
        self.log_tap();
        self.log_figures();
        // SAFETY: this is the main loop; no code of the host link logs.
        unsafe { log::hand_on(|bytes| self.front.host_link_mut().log(bytes)) };
    }

    fn log_tap(&mut self) {
        let Some(state) = self.front.tap().map(Tap::state).filter(|state| *state != self.tap_state) else { return };
        self.tap_state = state;
        defmt::info!("tap: {=str}", words(state));
    }

    fn log_figures(&mut self) {
        let Costs { ticks, worst, late: [earliest, latest] } = costs();
        if ticks < self.figures_at {
            return;
        }
        self.figures_at = ticks.saturating_add(FIGURES_EVERY);
        let stack = self.painted.above() + self.painted.used();
        defmt::info!(
            "{=u32} ticks, worst {=u32} instructions, late {=u32} to {=u32}, lost {=u32} bytes, stack {=usize} bytes",
            ticks,
            worst,
            earliest,
            latest,
            self.lines.lost(),
            stack
        );
        // SAFETY: this is the main loop.
        let dropped = unsafe { log::dropped() };
        if let Some(instructions) = self.lines.passed_in() {
            defmt::info!("characters passed on in {=u32} instructions", instructions);
        }
        if dropped > 0 {
            defmt::info!("{=u32} messages found no room in the log", dropped);
        }
    }
}

/// A state of the tap, in the log's words.
fn words(state: TapState) -> &'static str {
    match state {
        TapState::Listening => "listening",
        TapState::InStep => "in step",
        TapState::Passing => "passing over",
        TapState::Lost(TapLossReason::Damaged) => "lost, a damaged block",
        TapState::Lost(TapLossReason::LongBlock) => "lost, a block too long",
        TapState::Lost(TapLossReason::TooFarAhead) => "lost, the sender too far ahead",
        TapState::Lost(TapLossReason::NotUnderstood(_)) => "lost, a block not understood",
        TapState::Lost(TapLossReason::OutOfSight) => "lost, a block that depends on the control",
        TapState::Lost(TapLossReason::OffPath) => "lost, the axes off the path",
    }
}

/// Says in the log how the last start ended.
fn watchdog_reset(ticks_since_fed: u32) -> ResetCode {
    defmt::error!("the watchdog bit, {=u32} ticks after it was fed: 0 % until a person resets", ticks_since_fed);
    ResetCode::Watchdog
}
