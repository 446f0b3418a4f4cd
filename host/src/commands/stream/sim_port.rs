//! `sim:`: the control in software behind the same seam as a serial port, in simulated time.

use std::time::{Duration, Instant};

use arcfeed_hil_sim::decider::Decider;
use arcfeed_hil_sim::decider::told::Told;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::rig::Rig;
use arcfeed_shared::units::Micros;

use super::super::outcome::Failure;
use super::super::simulate::control::control_settings;
use crate::job::JobFile;
use crate::port::{Machine, Port, PortError};
use crate::report::figures::{AlarmFigures, LinkFigures};

/// Longest time the axes take to rest after feed hold.
const REST_MAX: Micros = Micros::from_ms(10_000);

/// A control that has had nothing to execute for this long gets nothing more.
const STARVED_MAX_MS: u64 = 10_000;

/// A clock this far behind is set back: nobody wants to see a minute at once.
const LATE_MAX: Duration = Duration::from_millis(200);
/// Sleeping for less costs more than it gives.
const NAP_MIN: Duration = Duration::from_millis(2);

/// A rig, and a line to its control.
pub struct SimPort<D = Told> {
    rig: Rig<D>,
    line_bits_per_s: f64,
    bits_per_char: f64,
    /// Blocks taken up, and how long the control had starved until the last of them.
    fed: (usize, u64),
    /// When simulated time began, and its seconds per second; none: as fast as it goes.
    tempo: Option<(Instant, u32)>,
}

impl SimPort {
    /// A control that has just been started in DNC operation.
    pub fn new(file: &JobFile, fault: ControllerFault, speed: Option<u32>) -> Result<Self, Failure> {
        let rig = Rig::on_line(control_settings(file), &file.job, fault)
            .map_err(|error| Failure::Input(format!("override limits: {error:?}")))?;
        Ok(SimPort::of(rig, file, speed))
    }
}

impl<D: Decider> SimPort<D> {
    /// The line to the control of a rig.
    pub fn of(rig: Rig<D>, file: &JobFile, speed: Option<u32>) -> Self {
        SimPort {
            rig,
            line_bits_per_s: f64::from(file.serial.baudrate),
            bits_per_char: f64::from(file.serial.bits_per_char()),
            fed: (0, 0),
            tempo: speed.map(|speed| (Instant::now(), speed)),
        }
    }

    /// The rig.
    pub fn rig(&self) -> &Rig<D> {
        &self.rig
    }

    /// The rig, to act on.
    pub fn rig_mut(&mut self) -> &mut Rig<D> {
        &mut self.rig
    }

    /// Waits until wall time has come as far as simulated time.
    fn keep_tempo(&mut self) {
        let Some((began, speed)) = &mut self.tempo else { return };
        let due = *began + Duration::from_micros(self.rig.now().0) / *speed;
        let now = Instant::now();
        if now > due + LATE_MAX {
            *began += now - due;
        } else if due > now + NAP_MIN {
            std::thread::sleep(due - now);
        }
    }

    /// What went over the line.
    pub fn link_figures(&self) -> LinkFigures {
        let counters = self.rig.control().line_counters();
        let busy_s = counters.bytes as f64 * self.bits_per_char / self.line_bits_per_s;
        LinkFigures {
            bytes: counters.bytes,
            utilization: busy_s / self.rig.now().to_s(),
            xoff_count: counters.xoff_count,
            max_bytes_after_xoff: Some(counters.max_bytes_after_xoff),
            starved_ms: Some(self.rig.control().starved_ms()),
            retries: 0,
            line_errors: None,
        }
    }
}

impl<D: Decider> Port for SimPort<D> {
    fn now(&self) -> Micros {
        self.rig.now()
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        let port = self.rig.control_mut().port();
        let mut len = 0;
        for slot in buffer {
            let Some(byte) = port.poll_transmit() else { break };
            *slot = byte;
            len += 1;
        }
        Ok(len)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.rig.control_mut().port().on_bytes(bytes);
        // What is short of characters is not at its end.
        self.fed.1 = self.rig.control().starved_ms();
        Ok(bytes.len())
    }

    fn wait(&mut self, deadline: Micros) {
        // One step at least, and none beyond the first that answers: the sender must see an XOFF at once.
        loop {
            self.rig.step();
            self.keep_tempo();
            let control = self.rig.control();
            if self.fed.0 != control.executed().len() {
                self.fed = (control.executed().len(), control.starved_ms());
            }
            if self.rig.now() >= deadline || self.rig.is_done() || self.rig.control().has_to_say() {
                return;
            }
        }
    }

    fn control_is_done(&self) -> Option<bool> {
        Some(self.rig.is_done() || self.rig.control().starved_ms() - self.fed.1 > STARVED_MAX_MS)
    }

    fn blocks_executed(&self) -> Option<usize> {
        Some(self.rig.control().executed().len())
    }

    fn machine(&self) -> Machine {
        let control = self.rig.control();
        let alarm = control.alarm().map(|alarm| AlarmFigures::new(alarm.line, alarm.fault.column, alarm.fault.cause));
        Machine {
            override_percent: Some(control.override_percent()),
            chip_ratio: self.rig.meter().last_ratio(),
            alarm: alarm.map(|alarm| alarm.to_string()),
        }
    }

    fn feed_hold(&mut self) -> bool {
        self.rig.control_mut().hold();
        let latest = self.rig.now().after(REST_MAX);
        while !self.rig.control().is_at_rest() && self.rig.now() < latest {
            self.rig.step();
        }
        self.rig.control().is_at_rest()
    }
}
