//! `--port sim:`: the simulated control, with the controller in process, which gets its moves directly, or with a board
//! behind a link.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Instant;

use arcfeed_board_app::application::command_handler::Identity;
use arcfeed_board_app::application::control_task::Supply;
use arcfeed_board_app::application::messages::Queues;
use arcfeed_board_app::assembly::{Config, assemble};
use arcfeed_board_app::main_loop::Untapped;
use arcfeed_control::Control;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::{Request, Signals};
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::override_source::OverrideSource;
use arcfeed_hil_sim::override_source::board::Board;
use arcfeed_hil_sim::override_source::in_process::InProcess;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_link::message::codes::{ModeCode, ResetCode};

use super::super::outcome::Failure;
use super::super::simulate::assertions::Evidence;
use super::super::simulate::control::control_settings;
use super::super::simulate::listing::locators;
use super::super::simulate::observer::RunObserver;
use super::super::simulate::run_figures::measure;
use super::super::simulate::run_tables::TraceFiles;
use super::super::simulate::{add_baseline, has_scopes};
use super::board_session::{Arming, BoardSession};
use super::logbook::Logbook;
use super::preparation::PreparedProgram;
use super::send_loop::{End, send};
use super::sim_link::{BoardEnd, Pipe, SimLink};
use super::sim_port::SimPort;
use super::{Stream, run_page, write_executed};
use crate::adapt::{Known, adapt_with};
use crate::board::line::{BAUDRATE, BoardLine};
use crate::dnc::outbox::Outbox;
use crate::dnc::reports;
use crate::dnc::{Sender, State};
use crate::job::JobFile;
use crate::port::open::wrap;
use crate::port::url::{Base, PortUrl};
use crate::report::figures::ReportFigures;

/// Moves that the simulated board holds ahead, plus one.
const AHEAD: usize = 65;
/// Identification of the simulated board.
const IDENTITY: Identity = Identity { name: "sim:", version: [0, 1, 0], reset: ResetCode::Power, starts: 1 };
/// Session number of the link to the simulated board.
const SESSION: u32 = 1;

impl Stream {
    /// Sends to the simulated control.
    ///
    /// # Errors
    /// See [`Stream::run`].
    pub(super) fn to_simulator(
        &self,
        ready: &PreparedProgram,
        sender: Sender,
        logbook: Logbook,
    ) -> Result<(), Failure> {
        match &self.board {
            None => {
                let mut sim = SimPort::new(&ready.file, ControllerFault::None, self.tempo())?;
                sim.simulation_mut().set_planned_conditions(ready.foreseen.iter().cloned());
                self.send_simulated(ready, sender, (logbook, BoardSession::none()), &Rc::new(RefCell::new(sim)))
            }
            Some(url) if url.base == Base::Sim => self.with_board_in_software(url, ready, sender, logbook),
            Some(_) => Err(Failure::Usage(
                "--board: the machine in software has no line to that board; give --board sim: or another --port"
                    .into(),
            )),
        }
    }

    fn with_board_in_software(
        &self,
        board: &PortUrl,
        ready: &PreparedProgram,
        sender: Sender,
        logbook: Logbook,
    ) -> Result<(), Failure> {
        let file = &ready.file;
        let mut queues = Box::new(Queues::<AHEAD>::new());
        let config = Config { supply: Supply::Link, settings: Settings::default(), identity: IDENTITY, fault: None };
        let parts = assemble(&mut queues, config).map_err(|error| Failure::Input(format!("{error:?}")))?;
        let pipe = Rc::new(RefCell::new(Pipe::default()));
        let in_process = Board::new(
            InProcess::new(Untapped::new(parts.0, None), parts.1),
            BoardEnd(Rc::clone(&pipe)),
            ModeCode::Lockstep,
        );
        let mut simulation = Simulation::new(Control::on_line(control_settings(file)), &file.job, in_process);
        if has_scopes(file) {
            simulation.set_planned_conditions(ready.foreseen.iter().cloned());
        }
        let sim = Rc::new(RefCell::new(SimPort::of(simulation, file, self.tempo())));
        let line = wrap(board, Box::new(SimLink::new(Rc::clone(&sim), pipe)))?;
        let link = BoardLine::of_session(line, BAUDRATE, SESSION)?;
        let mut board_session = BoardSession::with(link, ready, sender.transmission(), Arming::Simulated)?;
        // The start of the simulation counts as arming: there is no panel.
        let mut is_pressed = false;
        board_session.arm(&mut || {
            is_pressed = !is_pressed;
            let pressed = if is_pressed { Signals::of_request(Request::Arm) } else { Signals::NONE };
            sim.borrow_mut().simulation_mut().source_mut().set_panel(pressed);
        })?;
        sim.borrow_mut().simulation_mut().source_mut().set_panel(Signals::NONE);
        self.send_simulated(ready, sender, (logbook, board_session), &sim)
    }

    fn send_simulated<D: OverrideSource>(
        &self,
        ready: &PreparedProgram,
        mut sender: Sender,
        (logbook, board_session): (Logbook, BoardSession<'_>),
        sim: &Rc<RefCell<SimPort<D>>>,
    ) -> Result<(), Failure> {
        let (file, started) = (&ready.file, Instant::now());
        let outbox = Outbox::new(file.serial.write_timeout());
        let has_page = self.report.is_some() || self.web.is_some();
        if has_page || self.trace.is_some() || !self.assertions.is_empty() {
            sim.borrow_mut().observe(self.observer(ready, has_page)?);
        }
        let mut line = wrap(&self.port, Box::new(Rc::clone(sim)))?;
        let services = self.services(ready, (&*line, &sender), (logbook, board_session))?;
        let (end, heard) = send(&mut *line, &mut sender, outbox, services)?;
        drop(line);
        let mut observer = sim.borrow_mut().take_observer();
        let sim = sim.borrow();
        let simulation = sim.simulation();
        let mut report = measure(simulation, &file.job);
        report.blocks_sent = Some(sender.blocks_sent());
        report.link = Some(sim.link_figures());
        report.reports = ReportFigures::of(&heard);
        report.print_output.retain(|line| report.reports.is_none() || !line.starts_with(reports::NAME));
        report.real_time_factor = Some(simulation.now().to_s() / started.elapsed().as_secs_f64());
        let waits_for_more = matches!(end, End::Complete) && !simulation.is_done();
        let is_whole = matches!(end, End::Complete) && simulation.is_done() && report.alarms.is_empty();
        let evidence = observer.as_ref().map(|observer| Evidence {
            report: &report,
            log: &observer.log,
            chips: simulation.meter().moves(),
            spindle: None,
            line_of: &|_| None,
            program: file.program.display().to_string(),
        });
        let asserted = evidence.map_or(Ok(()), |evidence| self.judge(&evidence, is_whole, started));
        // The report of the transmission is printed even if this fails.
        let traced = observer.as_mut().map_or(Ok(()), |observer| observer.finish_tables(simulation));
        let written =
            self.executed.as_ref().map_or(Ok(()), |path| write_executed(path, simulation.control().executed()));
        let mut before = observer_of(file, self.report.is_some());
        let compared =
            add_baseline(&mut report, file, &ready.program, &ready.foreseen_before, &mut before).and_then(|baseline| {
                let shown = self.report.as_ref().zip(observer);
                shown.map_or(Ok(()), |(path, after)| {
                    run_page::write(path, ready, &report, (&after, simulation), (&before, &baseline))
                })
            });
        let finished = self.finish(ready, &report, &sender, &end);
        // A limit that is broken before the end of a run that fails anyway is broken all the same.
        asserted.and(finished).and(written).and(traced).and(compared)?;
        if waits_for_more {
            return Err(Failure::Machine(match sender.state() {
                State::Sent => "the control executed all it got and waits for more: its M02 or M30 is missing".into(),
                _ => {
                    "the control has nothing left to execute, and its DC1 has not come: it was lost on the line".into()
                }
            }));
        }
        Ok(())
    }

    /// Observer of the run, with the tables of `--trace`; `has_page` says whether a page shows the run.
    fn observer(&self, ready: &PreparedProgram, has_page: bool) -> Result<RunObserver, Failure> {
        let mut observer = observer_of(&ready.file, has_page);
        if let Some(path) = &self.trace {
            let PreparedProgram { file, program, .. } = ready;
            let adapted = adapt_with(program, &file.job, Known::of(file));
            let [lines, _] = locators(program, &adapted, &adapted.text, &adapted.line_ends);
            observer.write_tables(&TraceFiles::of(path)?, Some(lines))?;
        }
        Ok(observer)
    }

    /// Simulated seconds per second; `None`: as fast as possible.
    fn tempo(&self) -> Option<u32> {
        self.speed.or((self.tui || self.web.is_some()).then_some(1))
    }
}

/// Observer of a run, without tables; `has_page` says whether a page shows the run.
fn observer_of(file: &JobFile, has_page: bool) -> RunObserver {
    let mut observer = RunObserver::default();
    if has_page {
        observer.record_for_page(file);
    }
    observer
}
