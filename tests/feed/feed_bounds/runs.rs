//! A job and its program through the host and the simulated machine.

use std::collections::HashSet;
use std::fmt;

use arcfeed::adapt::{Adapted, Known, PlannedBlock, adapt_with};
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::commands::simulate::foreseen;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_control::{ControlSettings, Switches};
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulated_machine::STEP;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_model::job::{Job, LawKind};
use arcfeed_model::tool::Tool;
use arcfeed_nc::segment::Path;
use arcfeed_tests::Scratch;
use arcfeed_units::{Nm, S_PER_MIN};

use crate::feed_bounds::jobs::RandomJob;
use crate::feed_bounds::programs::RandomProgram;
use crate::feed_bounds::truth::{self, Moment, distance, in_plane};

/// Largest error of a path length by rounding its two ends to nanometres.
const GRID_MM: f64 = 2e-6;
/// Longest checked time of a run, ms.
const RUN_MAX_MS: u32 = 30_000;

/// Without motion for so long at the end a program hangs, ms.
const STANDSTILL_MS: u32 = 3_000;

/// Number of checked runs, moves and times.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures {
    pub programs: u32,
    blocks: u32,
    pub governed_ms: u32,
    ungoverned_ms: u32,
    metered: u64,
    thickest_metered: f64,
}

impl Figures {
    pub fn add(&mut self, other: &Figures) {
        self.programs += other.programs;
        self.blocks += other.blocks;
        self.governed_ms += other.governed_ms;
        self.ungoverned_ms += other.ungoverned_ms;
        self.metered += other.metered;
        self.thickest_metered = self.thickest_metered.max(other.thickest_metered);
    }
}

impl Figures {
    /// Counts the measured chips of these moves; `at_floor` is the chip of a move at the floor of its law.
    ///
    /// # Errors
    /// The first move with a chip that is too thick.
    fn add_chips<'m>(
        &mut self,
        moves: impl Iterator<Item = &'m MoveChips>,
        at_floor: impl Fn(i64) -> Option<f64>,
    ) -> Result<(), String> {
        for MoveChips { sequence, any_contact, .. } in moves.filter(|chips| chips.any_contact.samples > 0) {
            self.metered += any_contact.samples;
            self.thickest_metered = self.thickest_metered.max(any_contact.max_ratio);
            let floor = sequence.and_then(&at_floor).unwrap_or(0.0);
            let excess = truth::excess_of_meter(any_contact.max_ratio, floor);
            excess.map_or(Ok(()), |excess| Err(format!("{sequence:?}: {excess}")))?;
        }
        Ok(())
    }
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Figures { programs, blocks, governed_ms, ungoverned_ms, metered, thickest_metered } = self;
        write!(
            f,
            "{programs} programs, {blocks} feed moves, {governed_ms} ms governed, {ungoverned_ms} ms as programmed"
        )?;
        write!(f, ", {metered} chips on the meter, thickest {thickest_metered:.4} of its target")
    }
}

/// Position in a run: the count of its block, the move's N, the tool.
#[derive(Clone, Copy, Debug)]
struct At {
    count: u32,
    sequence: usize,
    tool: [f64; 3],
}

/// Governance of a move.
#[derive(Clone, Copy, Debug)]
struct Governing {
    by_plan: bool,
    by_controller: bool,
}

/// Runs a program to its end; `name` is that of its scratch folder. `None` for one that stops the control in either state of
/// the block-delete switch: no command adapts it.
///
/// # Errors
/// The first moment that is too fast.
pub fn run(name: &str, job: &RandomJob, random_program: &RandomProgram) -> Result<Option<Figures>, String> {
    let scratch = Scratch::new(name);
    scratch.write("program.nc", random_program.text());
    let file = JobFile::load(scratch.write("job.toml", job.toml()).as_ref()).map_err(|error| format!("{error:?}"))?;
    let program = Program::parse_with(&file.program, random_program.text().as_bytes(), file.nc, file.tables);
    if program.has_errors() {
        return Ok(None);
    }
    let adapted = adapt_with(&program, &file.job, Known::of(&file));
    let governed = governed(&adapted);
    let complaint = |at: &str, excess: &str| format!("{at}: {excess}\n{}", String::from_utf8_lossy(&adapted.text));
    let settings = control_settings(&file);
    let switches = Switches { block_delete: u16::from(job.is_deleting), ..settings.switches };
    let simulation = Simulation::from_memory(
        ControlSettings { switches, ..settings },
        &adapted.text,
        &file.job,
        ControllerFault::None,
    );
    let mut simulation = simulation.map_err(|error| format!("{error:?}"))?;
    simulation.set_planned_conditions(foreseen(&program, &adapted, &file));
    let mut figures =
        Figures { programs: 1, blocks: random_program.moves.iter().flatten().count() as u32, ..Figures::default() };
    let mut last: Option<At> = None;
    let mut moved_ms = 0;
    for ms in 0..RUN_MAX_MS {
        if simulation.is_done() {
            break;
        }
        simulation.step();
        let now = place(&simulation, last.as_ref());
        if let (Some(last), Some(now)) = (last, now)
            && last.count == now.count
        {
            let is_governed = governed.contains(&now.sequence);
            moved_ms = if last.tool == now.tool { moved_ms } else { ms };
            figures.governed_ms += u32::from(is_governed);
            figures.ungoverned_ms += u32::from(!is_governed);
            let governing = Governing {
                by_plan: is_governed,
                by_controller: job.mode != "rewrite-only" && simulation.rule().is_some(),
            };
            let excess = look(job, random_program, [&last, &now], &governing);
            excess.map_or(Ok(()), |excess| {
                let At { sequence, tool, .. } = now;
                Err(complaint(&format!("N{sequence} at {tool:.3?}"), &excess))
            })?;
        }
        last = now;
    }
    let moves = simulation.meter().moves().iter().filter(|chips| is_bounded(chips, &file.job, job.mode, &governed));
    let at_floor = |sequence: i64| {
        let of = random_program.moves.get(usize::try_from(sequence - 1).ok()?)?.as_ref()?;
        of.tool.and_then(|place| job.tool(place)).map(|tool| truth::chip_at_floor(tool, of))
    };
    figures.add_chips(moves, at_floor).map_err(|excess| complaint("on the meter", &excess))?;
    match simulation.control().alarm() {
        Some(alarm) => Err(format!("alarm at line {}: {}", alarm.line, alarm.fault.cause)),
        None if !simulation.is_done() && moved_ms + STANDSTILL_MS < RUN_MAX_MS => Err("it stands still".into()),
        None => Ok(Some(figures)),
    }
}

/// Whether the law bounds the measured chips of a move. An end mill's table has feeds of its own, and if the program's F is
/// sent, the job's least override may hold the feed up.
fn is_bounded(chips: &MoveChips, job: &Job, mode: &str, governed: &HashSet<usize>) -> bool {
    let setup = job.tool_of(&job.rules[chips.rule]);
    match (setup.tool, setup.law) {
        (Tool::CupMill(_), _) => true,
        (Tool::EndMill(_), LawKind::Table | LawKind::Programmed) => false,
        (Tool::EndMill(_), _) => {
            mode != "override-only" && chips.sequence.is_some_and(|n| governed.contains(&(n as usize)))
        }
    }
}

/// N of each block that the plan governs.
fn governed(adapted: &Adapted) -> HashSet<usize> {
    let is_governed = |block: &&PlannedBlock| block.rule.is_some() && block.demand.is_some();
    let sequences = adapted.blocks.iter().filter(is_governed).filter_map(|block| block.segment.sequence);
    sequences.map(|sequence| sequence as usize).collect()
}

/// Position on the feed move in work.
fn place(simulation: &Simulation, last: Option<&At>) -> Option<At> {
    let (count, segment) = simulation.control().active()?;
    if segment.path == Path::Rapid {
        return None;
    }
    let position = simulation.control().actual_position().minus(simulation.context().origin);
    // A piece of a block has no N of its own.
    let sequence = segment.sequence.map_or_else(|| last.map_or(0, |last| last.sequence), |n| n as usize);
    Some(At { count, sequence, tool: position.linear.map(Nm::to_mm) })
}

/// Violation within a millisecond of a move.
fn look(
    job: &RandomJob,
    random_program: &RandomProgram,
    [last, now]: [&At; 2],
    governing: &Governing,
) -> Option<String> {
    let Some(Some(of)) = now.sequence.checked_sub(1).and_then(|index| random_program.moves.get(index)) else {
        return Some("the program has no such move".into());
    };
    let path_mm = match of.arc {
        None => distance(last.tool, now.tool),
        Some(arc) => {
            let [from, to] = [last, now].map(|at| in_plane(at.tool, arc.plane));
            libm::hypot(to[0] - from[0], to[1] - from[1])
        }
    };
    let feed_per_min = (path_mm - GRID_MM).max(0.0) / STEP.to_s() * S_PER_MIN;
    let moment = Moment { at: last.tool, feed_per_min };
    let as_programmed = truth::excess_as_programmed(of, &moment);
    let tool = of.tool.and_then(|place| job.tool(place)).filter(|tool| truth::may_govern(tool, of));
    match (governing.by_plan, tool) {
        (true, None) => Some("a law governs what it does not describe".into()),
        (true, Some(tool)) => truth::excess(tool, of, &moment, job.mode == "override-only"),
        // With the switch in the other state, the controller may know a move again that the plan leaves alone.
        (false, Some(tool)) if governing.by_controller && as_programmed.is_some() => {
            truth::excess(tool, of, &moment, true)
        }
        (false, _) => as_programmed,
    }
}
