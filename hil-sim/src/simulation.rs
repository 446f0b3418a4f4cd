//! Simulation of a run: a machine and the source of its override.

use std::ops::{Deref, DerefMut};

use arcfeed_control::{Control, ControlSettings};
use arcfeed_firmware::supervisor::settings::SettingsError;
use arcfeed_model::job::Job;

use crate::faults::ControllerFault;
use crate::override_source::OverrideSource;
use crate::override_source::controller::InProcessController;
use crate::simulated_machine::{STEP, SimulatedMachine};

/// Deterministic simulation: a machine, and a source that sets its override in each period. Dereferences to the machine.
#[derive(Debug)]
pub struct Simulation<D = InProcessController> {
    machine: SimulatedMachine,
    source: D,
}

impl Simulation {
    /// Simulation of a control that reads from its DNC line, with the controller of the job.
    ///
    /// # Errors
    /// The bounds of the override are invalid.
    pub fn on_line(settings: ControlSettings, job: &Job, fault: ControllerFault) -> Result<Self, SettingsError> {
        Ok(Simulation::new(Control::on_line(settings), job, InProcessController::new(job, fault, STEP.into())?))
    }

    /// Simulation of a control with the program in its memory, with the controller of the job.
    ///
    /// # Errors
    /// The bounds of the override are invalid.
    pub fn from_memory(
        settings: ControlSettings,
        program: &[u8],
        job: &Job,
        fault: ControllerFault,
    ) -> Result<Self, SettingsError> {
        Ok(Simulation::new(
            Control::from_memory(settings, program),
            job,
            InProcessController::new(job, fault, STEP.into())?,
        ))
    }
}

impl<D: OverrideSource> Simulation<D> {
    /// Simulation of a control whose override comes from `source`.
    pub fn new(control: Control, job: &Job, source: D) -> Self {
        Simulation { machine: SimulatedMachine::new(control, job), source }
    }

    /// Simulates one period: the control moves the axes, the machine reports, the meter measures, the override source
    /// decides.
    pub fn step(&mut self) {
        self.machine.step(&mut self.source);
    }

    /// The override source.
    pub fn source(&self) -> &D {
        &self.source
    }

    /// The override source, mutable.
    pub fn source_mut(&mut self) -> &mut D {
        &mut self.source
    }

    /// The override source, at the end.
    pub fn into_source(self) -> D {
        self.source
    }
}

impl<D> Deref for Simulation<D> {
    type Target = SimulatedMachine;

    fn deref(&self) -> &SimulatedMachine {
        &self.machine
    }
}

impl<D> DerefMut for Simulation<D> {
    fn deref_mut(&mut self) -> &mut SimulatedMachine {
        &mut self.machine
    }
}
