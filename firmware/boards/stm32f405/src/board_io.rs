//! A tick of the board: reads the inputs, lets the guard decide, sets the outputs.

use arcfeed_firmware::controller;
use arcfeed_firmware::input::contacts::Contacts;
use arcfeed_firmware::input::dial::DialState;
use arcfeed_firmware::input::position::{Position, Readings};
use arcfeed_firmware::input::tacho::{Tacho, Turning};
use arcfeed_firmware::output::OverrideOutput;
use arcfeed_firmware::output::latched::Latched;
use arcfeed_firmware::output::port_lines::PortLines;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::report::Alarm;
use arcfeed_firmware::supervisor::signals::{BoardFault, Signals};
use arcfeed_units::Span;
use stm32f4::stm32f405::GPIOB;

use crate::clock;
use crate::dial::DialConverter;
use crate::encoders::Encoders;
use crate::guard::Guard;
use crate::lines::{CycleDelay, FvPort, StatusPins, let_go};
use crate::machine;
use crate::panel::{AT_START, ENCODERS_SOUND, Panel, PanelState};
use crate::spindle::SpindleTimer;

/// Period of the tick; a late tick is a fault, so the period is exact.
const TICK: Span = Span::from_ms(1);
/// Ticks between two changes of the heartbeat.
const HEARTBEAT_TICKS: u32 = 100;

/// Input peripherals of the board.
#[derive(Debug)]
pub struct Sensors {
    /// Timers that count the encoders of X, Y and Z.
    pub encoders: Encoders,
    /// Timer that measures the pulses of the spindle's tacho.
    pub spindle: SpindleTimer,
    /// Converter of the operator's override dial.
    pub dial: DialConverter,
    /// Port B, with the buttons and the control's signals.
    pub contacts: GPIOB,
}

/// Output pins of the board.
#[derive(Debug)]
pub struct Outputs {
    /// Override lines *FV0 to *FV7, which stay released after a failure.
    pub lines: Latched<PortLines<FvPort, CycleDelay>>,
    /// Pins of the outputs ready and heartbeat.
    pub status: StatusPins,
}

/// State of the input processing.
#[derive(Debug, Default)]
struct Readers {
    position: Position,
    turning: Turning,
    knob: DialState,
    panel: Panel,
}

/// Hardware and controller of the board, as the control tick uses them.
pub struct BoardIo {
    sensors: Sensors,
    outputs: Outputs,
    readers: Readers,
    contacts: Contacts,
    tacho: Tacho,
    guard: Guard<'static>,
    /// A fault of the start or of a late tick; reported once, the guard latches it.
    once: Option<BoardFault>,
    ticks: u32,
}

impl BoardIo {
    /// Board with this hardware; `at_start` is a fault found at the start, which it reports at its first tick.
    pub fn new(
        (sensors, outputs): (Sensors, Outputs),
        tacho: Tacho,
        guard: Guard<'static>,
        at_start: Option<BoardFault>,
    ) -> Self {
        let contacts = Contacts::at(AT_START);
        BoardIo { sensors, outputs, readers: Readers::default(), contacts, tacho, guard, once: at_start, ticks: 0 }
    }

    /// Number of the current run of the program; it changes when the program is started again.
    pub fn run(&self) -> u32 {
        self.guard.run()
    }

    /// Runs one control tick: reads the inputs, decides, sets the outputs.
    pub fn tick(&mut self) {
        let levels = self.sensors.contacts.idr().read().bits() as u16;
        let said = self.readers.panel.read(self.contacts.follow(!levels));
        // Not debounced: a short error of a receiver may have lost counts.
        let is_sound = !levels & ENCODERS_SOUND != 0;
        let readings = is_sound.then(|| self.sensors.encoders.read());
        let restart = said.zero_now && !self.guard.is_engaged() && self.readers.position.set_zero(readings);
        if restart {
            self.guard.restart();
        }
        let input = self.know(readings, said);
        let decided = self.guard.tick(&input);
        // The latch keeps a failure; the next tick reports it.
        let _ = self.outputs.lines.put(decided.feed_override);
        if clock::has_failed() {
            // The interrupt of the failure may have preceded the write.
            let_go();
        }
        self.ticks = self.ticks.wrapping_add(1);
        self.outputs.status.set_ready(decided.alarm != Alarm::Latched);
        self.outputs.status.set_heartbeat(self.ticks / HEARTBEAT_TICKS % 2 == 1);
    }

    /// Records that a tick came too late: the next tick reports a fault of the board, because its time base is wrong.
    pub fn report_late(&mut self) {
        self.once = Some(BoardFault::Hardware);
    }

    /// Evaluates the sensors.
    fn know(&mut self, readings: Readings, said: PanelState) -> Input {
        let Readers { position, turning, knob, .. } = &mut self.readers;
        let pose = position.follow(&machine::ENCODERS, readings, TICK);
        let spindle = self.tacho.follow(turning, self.sensors.spindle.read());
        let dial = machine::DIAL.follow(knob, self.sensors.dial.read());
        if said.reset_now {
            // A person at the machine has reset the fault; if its cause persists, the next write fails again.
            self.outputs.lines.reset();
        }
        let is_broken = clock::has_failed() || dial.is_err() || self.outputs.lines.fault().is_some();
        let fault = self.once.take().or(is_broken.then_some(BoardFault::Hardware));
        Input {
            position: position.freshness(),
            operator_percent: dial.unwrap_or(0),
            signals: said.signals.with(fault.map_or(Signals::NONE, Signals::of_fault)),
            // All blocks are on the board: the link is always fresh.
            ..Input::of(controller::Measurement { position: pose, spindle, dt: TICK })
        }
    }
}
