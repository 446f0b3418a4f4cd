//! The feed controller in this process, notified of each move by the simulated control.

use arcfeed_board_app::application::report::state_code;
use arcfeed_firmware::active::{ActiveSegment, Conditions};
use arcfeed_firmware::board::{Board, Task};
use arcfeed_firmware::controller;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::input::{Input, Work};
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::{Settings, SettingsError};
use arcfeed_model::job::{FeedPolicy, Job};
use arcfeed_model::tool::Tool;
use arcfeed_units::{Micros, Nm, Span};

use super::{Decision, MachineSignals, MoveStart, OverrideSource};
use crate::faults::ControllerFault;

/// Feed controller that runs in this process as the source of the override, with an optional fault for tests.
#[derive(Debug)]
pub struct InProcessController {
    supervisor: Option<Supervisor>,
    task: Task,
    io: BoardIo,
    /// The job with the tool that the controller assumes.
    believed: Job,
    fault: ControllerFault,
    period: Span,
    decision: Option<Decision>,
}

/// Inputs and outputs of the controller: the segment in execution, the inputs, the override output.
#[derive(Debug)]
struct BoardIo {
    segment: Option<(u32, ActiveSegment)>,
    input: Input,
    output: FeedOverride,
}

impl Board for BoardIo {
    fn work(&self) -> Work<'_> {
        self.segment.as_ref().map(|(count, segment)| (*count, segment))
    }

    fn measure(&mut self) {}

    fn input(&self) -> &Input {
        &self.input
    }

    fn set_override(&mut self, feed_override: FeedOverride) {
        self.output = feed_override;
    }
}

impl InProcessController {
    /// Controller for a job, with the tick `period`; it is armed already. `fault` is made part of it.
    ///
    /// # Errors
    /// The job's limits of the override are invalid.
    pub fn new(job: &Job, fault: ControllerFault, period: Span) -> Result<Self, SettingsError> {
        // A job that rewrites the program needs no override, and the machine may have none.
        let has_override = !matches!(job.policy, FeedPolicy::RewriteOnly(_));
        let is_on = has_override && fault != ControllerFault::LawOff;
        let supervisor = is_on.then(|| Supervisor::new(job, Settings::default())).transpose()?;
        let measured = controller::Measurement { position: None, spindle: job.tools.first().spindle, dt: period };
        Ok(InProcessController {
            supervisor,
            task: Task::from(Memory::armed()),
            io: BoardIo { segment: None, input: Input::of(measured), output: FeedOverride::PROGRAMMED },
            believed: believed(job, fault),
            fault,
            period,
            decision: None,
        })
    }
}

impl OverrideSource for InProcessController {
    fn begin(&mut self, begun: Option<MoveStart<'_>>) {
        let job = &self.believed;
        self.io.segment = begun.map(|MoveStart { count, segment, rule, along, spindle, limit, end_percent }| {
            let own = Conditions::with_table(segment, (rule, along), job);
            let conditions = Conditions { spindle, limit: limit.or(own.limit), end_percent, ..own };
            (count, ActiveSegment::with_conditions(segment, &conditions, job))
        });
    }

    fn decide(&mut self, shown: &MachineSignals) -> FeedOverride {
        let input = &mut self.io.input;
        let from = |ticks: u64| Micros(ticks * u64::from(self.period.0));
        let age = |ticks: u64| Span(u32::try_from(shown.at.since(from(ticks)).0).unwrap_or(u32::MAX));
        (input.position.age, input.link.age) = match self.fault {
            ControllerFault::PositionLostAfter(ticks) => (age(ticks), Span(0)),
            ControllerFault::HostLostAfter(ticks) => (Span(0), age(ticks)),
            _ => (Span(0), Span(0)),
        };
        input.measured.position = (input.position.age == Span(0)).then_some(shown.position);
        input.measured.spindle = shown.spindle;
        input.operator_percent = shown.operator_percent;
        input.signals = shown.signals;
        let is_frozen = matches!(self.fault, ControllerFault::FrozenAfter(ticks) if shown.at >= from(ticks));
        if let Some(supervisor) = self.supervisor.as_ref().filter(|_| !is_frozen) {
            let output = self.task.run(supervisor, &mut self.io);
            self.decision = Some(Decision { state: state_code(&output.state), reason: Some(output.reason) });
        }
        self.io.output
    }

    fn decision(&self) -> Option<Decision> {
        self.decision
    }
}

/// The job with the first tool as the controller assumes it.
fn believed(job: &Job, fault: ControllerFault) -> Job {
    let mut job = job.clone();
    if let (ControllerFault::RadiusScale(scale), Tool::CupMill(mill)) = (fault, &mut job.tools.first_mut().tool) {
        let scaled = |radius: Nm| Nm::from_mm(radius.to_mm() * scale);
        mill.outer_radius = scaled(mill.outer_radius);
        mill.inner_radius = scaled(mill.inner_radius);
    }
    job
}
