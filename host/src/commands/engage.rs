//! `arcfeed engage`: computes the engaged arcs of a job's tool in its workpiece along each move, for the engaged-arc
//! law.

use std::collections::HashMap;
use std::ops::ControlFlow;
#[cfg(feature = "plan")]
use std::path::Path;
use std::path::PathBuf;

use arcfeed_control::ControlSettings;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::removal::engagement::{EngagedMove, EngagedSample, EngagementMeter, EngagementSettings};
use arcfeed_hil_sim::removal::sections::{EdgeCounts, SectionJoint, SectionSample, SectionSettings, SectionedMove};
use arcfeed_model::cut::CutRule;
use arcfeed_model::engaged::{EngagedKnot, EngagedTable};
use arcfeed_model::tool::Tool;
use arcfeed_nc::segment::Path as Way;
use arcfeed_units::Nm;
use serde::Serialize;

use super::job_input::made_of;
use super::outcome::{Failure, json_text, load_unmapped, refuse_inputs, say, write_whole};
use super::simulate::control::control_settings;
use super::simulate::in_memory_of;
use super::simulate::material_figures::left_out_figures;
use super::simulate::observer::run_observed;
use super::simulate::setup::Setup;
use crate::adapt::{PlanReason, PlannedBlock, adapt};
use crate::axial_law::Edges;
use crate::console::note;
use crate::engagement::knot_cover::{self, Sample};
use crate::engagement::sections::{MappedDescent, MappedDescents, MappedJoint, MappedSection};
use crate::engagement::{EngagementMap, MappedMove, key, key_at_any_position};
use crate::job::{JobFile, Plunge};
use crate::plural::counted;
use crate::program::Program;
use crate::report::material::LeftOutBlocks;

/// Find the engaged arcs of the tool along each move, for rules with stock = { map = FILE }
///
/// The original program runs once on the simulated machine through the job's workpiece. The result depends on its path
/// alone, so it applies to every feed. The map is written where the job's rules look for it; make it anew when program,
/// tool or workpiece change (docs/engagement.md).
#[derive(Debug, clap::Args)]
pub struct Engage {
    /// The job file
    job: PathBuf,
    /// Moves at other positions of the rotary axes cut like earlier moves with the same path: a part with equal slots
    #[arg(long)]
    alike: bool,
    /// Write the map here instead
    #[arg(short, long, value_name = "OUT.toml")]
    output: Option<PathBuf>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Result as JSON; degrees.
#[derive(Debug, Serialize)]
struct Report {
    map: String,
    moves: Vec<MoveFigures>,
    /// Descending moves with sections, and those of which nothing is known.
    descents: [usize; 2],
    left_out: Vec<LeftOutBlocks>,
}

#[derive(Debug, Serialize)]
struct MoveFigures {
    n: Option<i64>,
    line: usize,
    knots: usize,
    outer_deg: Option<[f64; 2]>,
    inner_deg: Option<[f64; 2]>,
}

impl Engage {
    /// Runs the command.
    ///
    /// # Errors
    /// The job or the program is at fault, no rule asks for a map, or it cannot be written.
    pub fn run(&self) -> Result<(), Failure> {
        self.write_map()?.print(self.json);
        Ok(())
    }

    fn write_map(&self) -> Result<Report, Failure> {
        let (file, program) = load_unmapped(&self.job)?;
        let Some(named) = &file.map_file else {
            let job = self.job.display();
            let message =
                format!("{job}: no rule asks for an engagement map; write stock = {{ map = \"FILE.toml\" }} in one");
            return Err(Failure::Input(message));
        };
        let output = self.output.as_ref().unwrap_or(named);
        // The map itself is made anew.
        let inputs = JobFile { map_file: None, ..file.clone() }.inputs(&self.job);
        refuse_inputs(&[Some(output)], &inputs)?;
        if file.job.tools.len() > 1 {
            let job = self.job.display();
            return Err(Failure::Input(format!(
                "{job}: an engagement map is made for one tool: give the job one [tool]"
            )));
        }
        let Some(setup) = Setup::of(&self.job, &file)? else {
            let job = self.job.display();
            return Err(Failure::Input(format!(
                "{job}: an engagement map is looked up in a [workpiece], and there is none"
            )));
        };
        let planned = adapt(&program, &file.job).blocks;
        let asked: Vec<&PlannedBlock> = planned.iter().filter(|block| has_map(block, &file)).collect();
        let has_repeats = self.alike && file.plunge.is_none();
        let count = if has_repeats { unrepeated(&planned, &asked) } else { asked.len() };
        let meter = run(&file, &program, &setup, count)?;
        let map = map(&program, &asked, meter.moves().get(..count).unwrap_or(meter.moves()), count, self.alike)?;
        let map = EngagementMap { descents: descents(&file, &setup, (&program, self.alike), &meter), ..map };
        let left_out = meter.left_out().iter();
        let left_out = left_out.map(|left_out| left_out_figures(left_out.reason, &left_out.first, left_out.blocks));
        let report = Report {
            map: output.display().to_string(),
            moves: map.moves.iter().map(MoveFigures::new).collect(),
            descents: [false, true].map(|is_unknown| {
                map.descents.moves.iter().filter(|moved| moved.sections.is_empty() == is_unknown).count()
            }),
            left_out: left_out.collect(),
        };
        write_whole(output, map.text(made_of(&file, program.bytes().to_vec())?).as_bytes())?;
        Ok(report)
    }
}

/// Writes the engagement map of a planned job, whose slots are all alike; returns its file and its number of moves.
///
/// # Errors
/// See [`Engage::run`].
#[cfg(feature = "plan")]
pub(super) fn write_map_of_equal_slots(job: &Path) -> Result<(String, usize), Failure> {
    let report = Engage { job: job.into(), alike: true, output: None, json: false }.write_map()?;
    Ok((report.map, report.moves.len()))
}

/// Number of moves with a map up to the last one at the rotary axes' positions of the first cut: where all positions are alike, the
/// others repeat them.
fn unrepeated(planned: &[PlannedBlock], asked: &[&PlannedBlock]) -> usize {
    let cut = planned.iter().map(|block| &block.segment).find(|segment| segment.path != Way::Rapid);
    let is_there = |block: &&PlannedBlock| cut.is_some_and(|cut| block.segment.end.rotary == cut.end.rotary);
    asked.iter().rposition(is_there).map_or(asked.len(), |last| last + 1)
}

/// Whether the move of a block is to have engaged arcs.
fn has_map(block: &PlannedBlock, file: &JobFile) -> bool {
    let rule = block.rule.and_then(|index| file.job.rules.get(index));
    block.reason != PlanReason::Special && rule.is_some_and(CutRule::expects_engagement_per_move)
}

/// Runs the original program through the workpiece, on drives without lag, until `count` moves with a map are made: the map is that of
/// the programmed path.
fn run(file: &JobFile, program: &Program, setup: &Setup<'_>, count: usize) -> Result<EngagementMeter, Failure> {
    let settings = ControlSettings { drives: None, servo: None, ..control_settings(file) };
    let (layers, depth_mm) = setup.layers();
    let mut meter = EngagementMeter::new(EngagementSettings {
        layers,
        tool: setup.settings.tool.clone(),
        depth_mm,
        ahead_mm: f64::from(file.job.tools.first().feed_per_tooth.0),
        every_mm: setup.workpiece.step_mm,
        rules: file.job.rules.iter().map(CutRule::expects_engagement_per_move).collect(),
        machine: file.machine.as_ref().map(|named| named.machine),
        sections: file.plunge.map(|plunge| sections(file, setup, plunge)),
        tilted: setup.tilted_for_plunges(file),
    });
    let mut simulation = in_memory_of(settings, file, program.bytes(), ControllerFault::LawOff)?;
    run_observed(&mut simulation, Some("looking"), |simulation| {
        meter.observe(simulation);
        Ok(if meter.moves().len() > count { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    meter.end();
    match simulation.control().alarm() {
        None => Ok(meter),
        Some(alarm) => Err(Failure::Machine(format!("{}:{}: the control stopped", program.path.display(), alarm.line))),
    }
}

/// Map of the result, by the moves of the program: `found` has the first `count` of those that are `asked` for.
fn map(
    program: &Program,
    asked: &[&PlannedBlock],
    found: &[EngagedMove],
    count: usize,
    positions_alike: bool,
) -> Result<EngagementMap, Failure> {
    let same = |block: &PlannedBlock, sequence: Option<i64>| block.segment.sequence == sequence;
    let is_whole =
        found.len() == count && asked.iter().zip(found).all(|(block, found)| same(block, found.block.sequence));
    if !is_whole {
        let (made, program) = (found.len(), program.path.display());
        return Err(Failure::Machine(format!("{program}: {made} of {count} moves with a map were made")));
    }
    let mut by_way = HashMap::new();
    let moves = asked.iter().enumerate().map(|(index, block)| {
        let own = found.get(index).and_then(table_of);
        let known = by_way.entry(key_at_any_position(&block.segment)).or_insert_with(|| own.clone());
        let table = if positions_alike { own.or_else(|| known.clone()) } else { own };
        let line = program.line_in_file(block.line);
        MappedMove { line, sequence: block.segment.sequence, key: key(&block.segment), table }
    });
    Ok(EngagementMap { moves: moves.collect(), ..EngagementMap::default() })
}

/// Settings of the sections of descending moves.
fn sections(file: &JobFile, setup: &Setup<'_>, plunge: Plunge) -> SectionSettings {
    let tool = &file.job.tools.first().tool;
    let radii = match tool {
        Tool::CupMill(cup) => [cup.inner_radius, cup.outer_radius],
        Tool::EndMill(mill) => [Nm(0), mill.radius],
    };
    let Edges { side, end } = Edges::of(tool);
    SectionSettings {
        edges: EdgeCounts { end: end as usize, side: side as usize },
        radii_mm: radii.map(Nm::to_mm),
        corner_mm: setup.workpiece.body.corner_mm,
        has_ramps: plunge.has_ramps,
    }
}

/// Descending moves of the map, by the moves of the program.
fn descents(
    file: &JobFile,
    setup: &Setup<'_>,
    (program, positions_alike): (&Program, bool),
    meter: &EngagementMeter,
) -> MappedDescents {
    let planned = adapt(program, &file.job).blocks;
    let mut found = meter.descents().iter();
    let mut by_way = HashMap::new();
    let moves = planned.iter().filter_map(|block| {
        let key = key(&block.segment);
        let moved = found.clone().position(|moved| self::key(&moved.segment) == key).and_then(|at| found.nth(at))?;
        // A move with the same path has other chips where it joins another move.
        let is_joined = moved.joints.map(|joint| joint.is_some());
        let known = *by_way.entry((key_at_any_position(&block.segment), is_joined)).or_insert(moved);
        let cut = if moved.samples.is_empty() && positions_alike { known } else { moved };
        Some(mapped((program.line_in_file(block.line), block.segment.sequence, key), cut))
    });
    MappedDescents { force: setup.force.unwrap_or_default(), moves: moves.collect() }
}

/// Entry of a move with the sections of this one.
fn mapped((line, sequence, key): (usize, Option<i64>, u64), cut: &SectionedMove) -> MappedDescent {
    let section = |sample: &SectionSample| MappedSection {
        at_mm: sample.at_mm,
        end_mm2: sample.end_mm2,
        side_mm2: sample.side_mm2,
    };
    let joint = |joint: SectionJoint| MappedJoint {
        end_mm2: joint.end_mm2,
        side_mm2: joint.side_mm2,
        sine_ratio: joint.sine_ratio,
        cosine_ratio: joint.cosine_ratio,
    };
    let joints = cut.joints.map(|found| found.map(joint));
    MappedDescent { line, sequence, key, sections: cut.samples.iter().map(section).collect(), joints }
}

fn table_of(found: &EngagedMove) -> Option<EngagedTable> {
    let samples = found.samples.iter();
    let samples =
        samples.map(|EngagedSample { at_mm, intervals_deg }| Sample { at_mm: *at_mm, intervals_deg: *intervals_deg });
    knot_cover::table(&samples.collect::<Vec<_>>())
}

impl Report {
    fn print(&self, json: bool) {
        if json {
            return say(format_args!("{}", json_text(self)));
        }
        say(format_args!("   line  N        knots   outer circle, deg   inner circle, deg"));
        let range = |deg: Option<[f64; 2]>| deg.map_or("-".into(), |[from, to]| format!("{from:.1} .. {to:.1}"));
        for MoveFigures { n, line, knots, outer_deg, inner_deg } in &self.moves {
            let n = n.map_or("-".into(), |n| format!("N{n}"));
            let (outer, inner) = (range(*outer_deg), range(*inner_deg));
            say(format_args!("{line:>7}  {n:<7}{knots:>7}{outer:>20}{inner:>20}"));
        }
        let unknown = self.moves.iter().filter(|found| found.knots == 0).count() + self.descents[1];
        for left_out in &self.left_out {
            note(format_args!(
                "warning: nothing is taken in {}: {}",
                counted(left_out.blocks, "block"),
                left_out.words()
            ));
        }
        if unknown > 0 {
            note(format_args!(
                "warning: nothing is known of {}, which keep their own feed (where they only repeat others at other positions \
                 of the rotary axes: --alike)",
                counted(unknown, "move")
            ));
        }
        let descents = match self.descents {
            [0, 0] => String::new(),
            [known, _] => format!(", {}", counted(known, "descending move")),
        };
        say(format_args!("{}: {}{descents}", self.map, counted(self.moves.len(), "move")));
    }
}

impl MoveFigures {
    fn new(found: &MappedMove) -> Self {
        let knots = found.table.as_ref().map_or(&[][..], EngagedTable::knots);
        let along = |arc: &dyn Fn(&EngagedKnot) -> [f64; 2]| {
            let arcs = knots.iter().map(arc).filter(|[from, to]| from < to);
            arcs.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
        };
        MoveFigures {
            n: found.sequence,
            line: found.line,
            knots: knots.len(),
            outer_deg: along(&|knot| knot.outer.degrees()),
            inner_deg: along(&|knot| knot.inner.degrees()),
        }
    }
}
