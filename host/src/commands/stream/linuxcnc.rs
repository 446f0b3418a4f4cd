//! `stream --port linuxcnc:`: writes the adapted program in LinuxCNC's dialect, runs it there, follows and measures it.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::mpsc::Receiver;
use std::time::Duration;

use arcfeed_nc::segment::Path as MovePath;
use arcfeed_units::{Micros, S_PER_MIN, US_PER_S};
use indicatif::{ProgressBar, ProgressDrawTarget};

use super::super::for_control::{TargetControl, check_for_linuxcnc, feed_source, prepared_path, write_for_linuxcnc};
use super::super::job_input::adapted;
use super::super::measure::measured_run::{MeasuredRun, MeasuredSample, blocks_by_line};
use super::super::outcome::{Failure, on_interrupt, refuse_inputs};
use super::super::simulate::assertions::Evidence;
use super::super::simulate::finish;
use super::super::simulate::move_log::{LoggedMove, MoveLog};
use super::Stream;
use super::board_session::{ARM, typed_lines};
use super::linuxcnc_trace::LinuxCncTrace;
use crate::adapt::PlannedBlock;
use crate::clock::Instant;
use crate::console::note;
use crate::linuxcnc::codes::FeedSource;
use crate::linuxcnc::session::{MachineSample, Ready, Session, SessionEvent, Status};
use crate::report::figures::RunReport;

/// Time between two looks at the keyboard.
const WAIT: Duration = Duration::from_millis(50);
/// Longest time for a pause to bring the axes to rest.
const PAUSE: Duration = Duration::from_secs(5);
const HOW_TO_ARM: &str = "the program is open in LinuxCNC, and the component has its moves. Look at the machine: the right tool, work \
                          offset and spindle. Then press Arm on the panel, or type arm and Enter here: the program starts at once";

/// End of a run.
enum RunEnd {
    /// The program has ended.
    Ended { is_on: bool },
    /// The operator stopped it here.
    Interrupted { at_rest: bool },
}

/// Run in progress.
struct LinuxCncRun<'a> {
    measured: MeasuredRun<'a>,
    blocks: HashMap<usize, &'a PlannedBlock>,
    /// Length of the machine's unit in the job's.
    unit_ratio: f64,
    ready: Option<Ready>,
    status: Option<Status>,
    samples: u64,
    missing: u64,
    last_line: usize,
    bar: ProgressBar,
    trace: Option<LinuxCncTrace<'a>>,
    /// Moves, and the line of each in the program, by the count of blocks.
    log: MoveLog,
    lines: Vec<usize>,
    /// Assertions need the samples.
    needs_samples: bool,
}

impl Stream {
    /// Runs the job's program on LinuxCNC.
    ///
    /// # Errors
    /// The job or the program is at fault, LinuxCNC does not run it to its end, or the operator stopped it.
    pub fn to_linuxcnc(&self) -> Result<(), Failure> {
        self.check_options()?;
        let (file, source, _) = self.input.load_text()?;
        let output = self.input.job.with_extension("linuxcnc.ngc");
        let output = std::path::absolute(&output).map_err(|error| Failure::Input(error.to_string()))?;
        let prepared = prepared_path(&output);
        let outputs = [Some(output.as_path()), Some(&prepared), self.trace.as_deref(), self.junit.as_deref()];
        refuse_inputs(&outputs, &file.inputs(&self.input.job))?;
        check_for_linuxcnc(&source, &file)?;
        let program = source.whole().map_err(Failure::Input)?;
        let planned = adapted(&program, &file);
        let blocks = blocks_by_line(&source, &file, &planned, false, Some(TargetControl::Linuxcnc))?;
        let has_component = feed_source(&file) == FeedSource::Component;
        let begin = |path: &PathBuf| LinuxCncTrace::begin(path, &source, has_component);
        let trace = self.trace.as_ref().map(begin).transpose()?;
        // A LinuxCNC that executes this very file keeps it as it is.
        let mut session = Session::begin(&output, has_component).map_err(Failure::Machine)?;
        write_for_linuxcnc(&output, &source, &file, planned.text.clone())?;
        session.send("open");
        let mut run = LinuxCncRun {
            measured: MeasuredRun::new(&file.job),
            blocks,
            unit_ratio: 1.0 / file.job.unit.mm(),
            ready: None,
            status: None,
            samples: 0,
            missing: 0,
            last_line: 0,
            bar: self.line_bar(),
            trace,
            log: MoveLog::default(),
            lines: Vec::new(),
            needs_samples: !self.assertions.is_empty(),
        };
        let started = Instant::now();
        let end = run.follow(session, has_component)?;
        let traced = run.trace.take().map_or(Ok(()), LinuxCncTrace::finish);
        let title = format!("{} to {}", file.program.display(), self.port.text);
        let ended = run.ended(&output, &end);
        let report = run.report();
        let printed = finish(&report, self.json, title);
        let evidence = Evidence {
            report: &report,
            log: &run.log,
            chips: run.measured.meter().moves(),
            spindle: None,
            line_of: &|count| Some(source.line_in_file(*run.lines.get((count as usize).checked_sub(1)?)?)),
            program: file.program.display().to_string(),
        };
        // A limit that is broken before the end of a run that fails anyway is broken all the same.
        self.judge(&evidence, ended.is_ok(), started).and(printed).and(traced).and(ended)
    }

    /// Checks that no option for a line is set.
    fn check_options(&self) -> Result<(), Failure> {
        let options = [
            ("--board", self.board.is_some()),
            ("--baudrate, --bytesize, --parity, --stopbits, --rtscts", self.line.is_any()),
            ("--keep-comments", self.keep_comments),
            ("--journal", self.journal.is_some()),
            ("--resume", self.resume.is_wanted()),
            ("--tui", self.tui),
            ("--web", self.web.is_some()),
            ("--log", self.log.is_some()),
            ("--speed", self.speed.is_some()),
            ("--executed", self.executed.is_some()),
        ];
        match options.iter().find(|(_, is_set)| *is_set) {
            Some((option, _)) => Err(Failure::Usage(format!(
                "{option}: LinuxCNC reads the program as a file, not over a line; drop the option"
            ))),
            None if self.report.is_some() => Err(Failure::Usage(
                "--report: only for sim:; with linuxcnc: --json, --trace and --assert have the figures of the run"
                    .into(),
            )),
            None => Ok(()),
        }
    }

    fn line_bar(&self) -> ProgressBar {
        let target = if self.json { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        ProgressBar::with_draw_target(Some(0), target)
    }
}

impl LinuxCncRun<'_> {
    /// Runs the open program, once the component is armed if it has the feed.
    fn follow(&mut self, mut session: Session, has_component: bool) -> Result<RunEnd, Failure> {
        let interrupted = on_interrupt();
        let person: Option<Receiver<String>> = has_component.then(typed_lines);
        let (mut has_begun, mut paused_at) = (false, None::<Instant>);
        loop {
            match session.event(WAIT).map_err(Failure::Machine)? {
                Some(SessionEvent::Fault(message)) => return Err(Failure::Machine(message)),
                Some(SessionEvent::Note(message)) => self.say(&message),
                Some(SessionEvent::Idle {}) | None => {}
                Some(SessionEvent::Ready(ready)) => self.begin(ready, has_component)?,
                Some(SessionEvent::Sample(sample)) => self.add(&sample)?,
                Some(SessionEvent::Status(status)) => {
                    self.bar.set_position(status.line as u64);
                    if !has_begun && (!has_component || status.armed) {
                        session.send("run");
                        has_begun = true;
                    }
                    self.status = Some(status);
                }
                Some(SessionEvent::Ended(ended)) => {
                    self.missing = ended.missing;
                    return Ok(RunEnd::Ended { is_on: ended.is_on });
                }
            }
            for line in person.iter().flat_map(Receiver::try_iter) {
                match line.trim() {
                    ARM if !has_begun => session.send("arm"),
                    "" => {}
                    other => self.say(&format!("`{other}` means nothing here")),
                }
            }
            if !interrupted.load(Ordering::Relaxed) {
                continue;
            }
            if !has_begun {
                return Err(Failure::Stopped(
                    "stopped by the operator: the program is open in LinuxCNC, and was not started".into(),
                ));
            }
            let at_rest = self.status.as_ref().is_some_and(|status| status.paused && status.at_rest);
            match paused_at {
                None => {
                    session.send("pause");
                    paused_at = Some(Instant::now());
                }
                Some(at) if at_rest || at.elapsed() > PAUSE => return Ok(RunEnd::Interrupted { at_rest }),
                Some(_) => {}
            }
        }
    }

    fn begin(&mut self, ready: Ready, has_component: bool) -> Result<(), Failure> {
        self.unit_ratio *= ready.mm_per_unit;
        if self.needs_samples && !ready.no_samples.is_empty() {
            return Err(Failure::Machine(format!(
                "--assert: LinuxCNC gives no samples: {}; the program is open, and was not started",
                ready.no_samples
            )));
        }
        if !ready.no_samples.is_empty() {
            self.say(&format!("note: chips are not measured: LinuxCNC gives no samples: {}", ready.no_samples));
        }
        if has_component {
            self.say(HOW_TO_ARM);
        }
        self.bar.set_length(self.blocks.keys().max().map_or(0, |line| *line as u64));
        self.ready = Some(ready);
        Ok(())
    }

    fn add(&mut self, sample: &MachineSample) -> Result<(), Failure> {
        let Some(ready) = &self.ready else { return Ok(()) };
        self.samples += 1;
        self.last_line = self.last_line.max(sample.line);
        let measured = MeasuredSample {
            time_s: sample.number as f64 * ready.period_s,
            position: sample.position.map(|value| value * self.unit_ratio),
            line: sample.line,
            feed: Some(sample.speed * S_PER_MIN * self.unit_ratio),
            spindle: Some(sample.spindle),
            override_ratio: Some(sample.ratio),
        };
        self.measured.add(measured, self.blocks.get(&sample.line).copied());
        let traced = self.trace.as_mut().map_or(Ok(()), |trace| trace.add(sample, ready, &self.measured));
        let feed_mm_per_min = sample.speed * S_PER_MIN * ready.mm_per_unit;
        self.log_move(measured.time_s, feed_mm_per_min);
        traced
    }

    /// Adds a servo period to the log of moves.
    fn log_move(&mut self, time_s: f64, feed_mm_per_min: f64) {
        let (count, Some(block)) = (self.measured.count(), self.measured.block()) else { return };
        if self.log.moves.last().is_none_or(|last| last.block != count) {
            self.log.moves.push(LoggedMove {
                block: count,
                sequence: block.segment.sequence,
                is_rapid: block.segment.path == MovePath::Rapid,
                is_governed: block.demand.is_some(),
                began: Micros((time_s * US_PER_S as f64).round() as u64),
                feed_max_mm_per_min: 0.0,
            });
            self.lines.resize(count as usize, block.line);
        }
        if let Some(last) = self.log.moves.last_mut().filter(|last| !last.is_rapid) {
            last.feed_max_mm_per_min = last.feed_max_mm_per_min.max(feed_mm_per_min);
        }
    }

    fn report(&mut self) -> RunReport {
        if self.samples > 0 {
            let Self { samples, missing, .. } = self;
            note(format_args!("{samples} samples of servo periods, {missing} missing"));
        }
        self.measured.end()
    }

    /// Result of the run, in words.
    fn ended(&self, program: &Path, end: &RunEnd) -> Result<(), Failure> {
        self.bar.finish_and_clear();
        let line = self.status.as_ref().map_or(0, |status| status.line).max(self.last_line);
        let place = format!("{}:{line}:1", PathBuf::from(program).display());
        let last = self.blocks.keys().max().copied().unwrap_or(0);
        match end {
            RunEnd::Interrupted { at_rest: true } => Err(Failure::Stopped(format!(
                "{place}: stopped by the operator: the program is paused, axes at rest. Resume or stop it in LinuxCNC"
            ))),
            RunEnd::Interrupted { at_rest: false } => Err(Failure::Stopped(format!(
                "{place}: stopped by the operator, and LinuxCNC has not paused the program: stop it there"
            ))),
            RunEnd::Ended { is_on: false } => Err(Failure::Machine(format!(
                "{place}: the machine was switched off while the program ran; LinuxCNC's screen has the reason"
            ))),
            RunEnd::Ended { is_on: true } if line < last => Err(Failure::Machine(format!(
                "{place}: the program was stopped before its last move in line {last}; LinuxCNC's screen has the reason"
            ))),
            RunEnd::Ended { is_on: true } => Ok(()),
        }
    }

    fn say(&self, message: &str) {
        self.bar.suspend(|| note(format_args!("{message}")));
    }
}
