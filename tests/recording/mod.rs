//! The example job as it ran on the simulated machine with the controller that is given each block: positions and overrides.

use std::path::Path;
use std::sync::OnceLock;

use arcfeed::adapt::adapt;
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_control::machine;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_model::job::Job;
use arcfeed_nc::block::Reading;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;

use crate::root;

/// A run of the example.
#[derive(Debug)]
pub struct Recording {
    /// The example's job.
    pub job: Job,
    /// Moves in order.
    pub segments: Vec<Segment>,
    /// Position feedback and override at each tick, and how many moves had begun.
    pub ticks: Vec<(Pose, u8, usize)>,
}

impl Recording {
    /// Index of the cut rule of a move.
    pub fn rule(&self, segment: &Segment) -> Option<usize> {
        self.job.rule_for(segment, ToolInSpindle::Unstated).map(|(index, _)| index)
    }
}

/// The run of `examples/ibr-slot`.
pub fn ibr_slot() -> &'static Recording {
    static RUN: OnceLock<Recording> = OnceLock::new();
    RUN.get_or_init(|| record(&root().join("examples/ibr-slot/job.toml")))
}

/// The run of a job.
pub fn record(job: &Path) -> Recording {
    let file = JobFile::load(job).expect("the job is sound");
    let program = Program::load(&file.program, file.job.unit, Reading::Lenient).expect("the job has a program");
    let text = [adapt(&program, &file.job).text, b"\n".to_vec()].concat();
    let mut settings = control_settings(&file);
    // The override of a tick is in effect at the next one.
    settings.ladder_delay_steps = 0;
    let simulation = Simulation::from_memory(settings, &text, &file.job, ControllerFault::None);
    let mut simulation = simulation.expect("the limits of the override make sense");
    let (mut segments, mut positions, mut overrides, mut last) = (Vec::new(), Vec::new(), Vec::new(), None);
    while !simulation.is_done() {
        simulation.step();
        let active = simulation.control().active().map(|(count, segment)| (count, *segment));
        if let Some((count, segment)) = active.filter(|(count, _)| last != Some(*count)) {
            segments.push(segment);
            last = Some(count);
        }
        positions.push((machine::feedback(&simulation.control().position()), segments.len()));
        overrides.push(simulation.control().override_percent());
    }
    simulation.step();
    overrides.push(simulation.control().override_percent());
    let ticks = positions.into_iter().zip(overrides.split_off(1));
    Recording { job: file.job, segments, ticks: ticks.map(|((pose, begun), percent)| (pose, percent, begun)).collect() }
}
