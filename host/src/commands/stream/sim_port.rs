//! `sim:`: the serial line to the simulated control as a port, in simulated time.

use std::time::{Duration, Instant};

use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::override_source::OverrideSource;
use arcfeed_hil_sim::override_source::controller::InProcessController;
use arcfeed_hil_sim::path_trace::PathTrace;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_units::{Micros, Nm, S_PER_MIN};

use super::super::outcome::Failure;
use super::super::simulate::control::control_settings;
use super::super::simulate::observer::RunObserver;
use crate::job::JobFile;
use crate::port::{Machine, Port, PortError, ToolOnPart};
use crate::report::figures::{AlarmFigures, LinkFigures};

/// Longest time until the axes rest after feed hold.
const REST_MAX: Micros = Micros::from_ms(10_000);

/// Time without anything to execute after which a control gets nothing more.
const STARVED_MAX_MS: u64 = 10_000;

/// Lag after which the clock is set back, so that the simulation does not catch up in a rush.
const LATE_MAX: Duration = Duration::from_millis(200);
/// Shortest sleep: a shorter one costs more than it saves.
const NAP_MIN: Duration = Duration::from_millis(2);

/// Simulated machine, as a port with a line to its control (`sim:`).
pub struct SimPort<D = InProcessController> {
    simulation: Simulation<D>,
    line_bits_per_s: f64,
    bits_per_char: f64,
    /// Blocks started, and how long the control had starved until the last of them.
    fed: (usize, u64),
    /// Start of simulated time, and its seconds per second; `None`: as fast as possible.
    tempo: Option<(Instant, u32)>,
    /// Observer of the run, for a report or a trace.
    observer: Option<RunObserver>,
}

impl SimPort {
    /// Simulated control that has just been started in DNC operation.
    pub fn new(file: &JobFile, fault: ControllerFault, speed: Option<u32>) -> Result<Self, Failure> {
        let simulation = Simulation::on_line(control_settings(file), &file.job, fault)
            .map_err(|error| Failure::Input(format!("override limits: {error:?}")))?;
        Ok(SimPort::of(simulation, file, speed))
    }
}

impl<D: OverrideSource> SimPort<D> {
    /// Line to the control of a simulation.
    pub fn of(simulation: Simulation<D>, file: &JobFile, speed: Option<u32>) -> Self {
        SimPort {
            simulation,
            line_bits_per_s: f64::from(file.serial.baudrate),
            bits_per_char: f64::from(file.serial.bits_per_char()),
            fed: (0, 0),
            tempo: speed.map(|speed| (Instant::now(), speed)),
            observer: None,
        }
    }

    /// Lets this observer record the run from now on.
    pub fn observe(&mut self, observer: RunObserver) {
        self.observer = Some(observer);
    }

    /// Removes the observer, with what it has recorded; `None` if there is none.
    pub fn take_observer(&mut self) -> Option<RunObserver> {
        let mut observer = self.observer.take()?;
        observer.path.iter_mut().for_each(PathTrace::end);
        Some(observer)
    }

    fn step(&mut self) {
        self.simulation.step();
        if let Some(observer) = &mut self.observer {
            observer.record(&self.simulation);
        }
    }

    /// The simulation behind the port.
    pub fn simulation(&self) -> &Simulation<D> {
        &self.simulation
    }

    /// The simulation behind the port, mutable.
    pub fn simulation_mut(&mut self) -> &mut Simulation<D> {
        &mut self.simulation
    }

    /// Waits until wall time has reached simulated time.
    fn keep_tempo(&mut self) {
        let Some((began, speed)) = &mut self.tempo else { return };
        let due = *began + Duration::from_micros(self.simulation.now().0) / *speed;
        let now = Instant::now();
        if now > due + LATE_MAX {
            *began += now - due;
        } else if due > now + NAP_MIN {
            std::thread::sleep(due - now);
        }
    }

    /// Statistics of the simulated serial line.
    pub fn link_figures(&self) -> LinkFigures {
        let counters = self.simulation.control().line_counters();
        let busy_s = counters.bytes as f64 * self.bits_per_char / self.line_bits_per_s;
        LinkFigures {
            bytes: counters.bytes,
            utilization: busy_s / self.simulation.now().to_s(),
            xoff_count: counters.xoff_count,
            max_bytes_after_xoff: Some(counters.max_bytes_after_xoff),
            starved_ms: Some(self.simulation.control().starved_ms()),
            retries: 0,
            line_errors: None,
        }
    }
}

impl<D: OverrideSource> Port for SimPort<D> {
    fn now(&self) -> Micros {
        self.simulation.now()
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        let port = self.simulation.control_mut().port();
        let mut len = 0;
        for slot in buffer {
            let Some(byte) = port.poll_transmit() else { break };
            *slot = byte;
            len += 1;
        }
        Ok(len)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.simulation.control_mut().port().on_bytes(bytes);
        // A control that starves for characters is not at its end.
        self.fed.1 = self.simulation.control().starved_ms();
        Ok(bytes.len())
    }

    fn wait(&mut self, deadline: Micros) {
        // At least one step, and none after the first with output: the sender must see an XOFF at once.
        loop {
            self.step();
            self.keep_tempo();
            let control = self.simulation.control();
            if self.fed.0 != control.executed().len() {
                self.fed = (control.executed().len(), control.starved_ms());
            }
            if self.simulation.now() >= deadline || self.simulation.is_done() || self.simulation.control().has_output()
            {
                return;
            }
        }
    }

    fn control_is_done(&self) -> Option<bool> {
        Some(self.simulation.is_done() || self.simulation.control().starved_ms() - self.fed.1 > STARVED_MAX_MS)
    }

    fn blocks_executed(&self) -> Option<usize> {
        Some(self.simulation.control().executed().len())
    }

    fn machine(&self) -> Machine {
        let control = self.simulation.control();
        let origin = self.simulation.context().origin.linear.map(Nm::to_mm);
        let [x, y, z, ..] = control.actual_axes();
        let last = self.observer.as_ref().and_then(|observer| observer.path.as_ref()?.on_part());
        let on_part = last.map(|last| ToolOnPart { tip_mm: last.position_mm, axis: last.axis });
        let alarm = control.alarm().map(|alarm| AlarmFigures::new(alarm.line, alarm.fault.column, alarm.fault.cause));
        Machine {
            override_percent: Some(control.override_percent()),
            chip_ratio: self.simulation.meter().last_ratio(),
            alarm: alarm.map(|alarm| alarm.to_string()),
            position_mm: Some([x - origin[0], y - origin[1], z - origin[2]]),
            on_part,
            feed_mm_per_min: Some(control.speed_mm_per_s() * S_PER_MIN),
        }
    }

    fn feed_hold(&mut self) -> bool {
        self.simulation.control_mut().hold();
        let latest = self.simulation.now().after(REST_MAX);
        while !self.simulation.control().is_at_rest() && self.simulation.now() < latest {
            self.step();
        }
        self.simulation.control().is_at_rest()
    }
}
