//! `sim:`: the control in software behind the same seam as a serial port, in simulated time.

use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::rig::Rig;
use arcfeed_shared::units::Micros;

use super::super::outcome::Failure;
use super::super::simulate::control_settings;
use crate::job::JobFile;
use crate::port::{Port, PortError};
use crate::report::figures::LinkFigures;

/// Longest time the axes take to rest after feed hold.
const REST_MAX: Micros = Micros::from_ms(10_000);

/// A control that has had nothing to execute for this long gets nothing more.
const STARVED_MAX_MS: u64 = 10_000;

/// A rig, and a line to its control.
pub struct SimPort {
    rig: Rig,
    line_bits_per_s: f64,
    bits_per_char: f64,
    /// Blocks taken up, and how long the control had starved until the last of them.
    fed: (usize, u64),
}

impl SimPort {
    /// A control that has just been started in DNC operation.
    pub fn new(file: &JobFile, fault: ControllerFault) -> Result<Self, Failure> {
        let rig = Rig::on_line(control_settings(file), &file.job, fault)
            .map_err(|error| Failure::Input(format!("override limits: {error:?}")))?;
        Ok(SimPort {
            rig,
            line_bits_per_s: f64::from(file.serial.baudrate),
            bits_per_char: f64::from(file.serial.bits_per_char()),
            fed: (0, 0),
        })
    }

    /// The rig.
    pub fn rig(&self) -> &Rig {
        &self.rig
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
        }
    }
}

impl Port for SimPort {
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
        Ok(bytes.len())
    }

    fn wait(&mut self, deadline: Micros) {
        // One step at least, and none beyond the first that answers: the sender must see an XOFF at once.
        loop {
            self.rig.step();
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

    fn feed_hold(&mut self) -> bool {
        self.rig.control_mut().hold();
        let latest = self.rig.now().after(REST_MAX);
        while !self.rig.control().is_at_rest() && self.rig.now() < latest {
            self.rig.step();
        }
        self.rig.control().is_at_rest()
    }
}
