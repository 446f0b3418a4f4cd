//! `arcfeed adapt`: applies the feeds of a job to a program, and shows them.

use std::path::{Path, PathBuf};

use arcfeed_model::cut::{ContourSide, Moves, RotationCircle, Work};
use arcfeed_model::job::{FeedPolicy, Job, LawKind};
use arcfeed_model::tool::{Edge, Tool};
use arcfeed_nc::modal::Turn;
use arcfeed_nc::text::Lines;
use arcfeed_units::{LengthUnit, Nm};
use serde::Serialize;

use super::executed_blocks::check_expanded;
use super::for_control::{TargetControl, check_for_linuxcnc, prepared_path, write_for_linuxcnc};
use super::job_input::{JobInput, KeptMoves, UnknownMoves};
use super::outcome::{Failure, json_text, refuse_inputs, say, write_whole};
use crate::adapt::rewrite::Leak;
use crate::adapt::split::Whole;
use crate::adapt::write_back::write_back;
use crate::adapt::{Known, LinePlan, PlanReason, PlannedBlock};
use crate::job::plunge;
use crate::plural::counted;
use crate::program::Source;

/// Rewrite a program's feeds according to its job: per block the programmed feed, the law, the factor, the reason
///
/// In the modes safe-base and override-only F words change, and the override does the rest. In the mode rewrite-only arcs
/// are sent in pieces, each with an F of its own, and shown with the error that this leaves in the chip.
///
/// A program with macro statements or calls is adapted at its blocks as executed. Their feeds are written back into it
/// where all executions of a line have the same one; otherwise it is refused, and --expand writes the blocks instead.
#[derive(Debug, clap::Args)]
pub struct Adapt {
    /// Write the adapted program here
    #[arg(short, long, value_name = "OUT.nc")]
    output: Option<PathBuf>,
    /// Write a program with macro statements or calls as its blocks as executed, each with its own feed
    #[arg(long)]
    expand: bool,
    /// Control that the program is written for: linuxcnc writes its dialect, and macros and calls as with --expand
    /// (docs/linuxcnc.md)
    #[arg(long = "for", value_enum, value_name = "CONTROL", requires = "output", conflicts_with = "diff")]
    target: Option<TargetControl>,
    /// Simulate the program before and after, and write the report here, as one HTML file (docs/report.md)
    #[arg(long, value_name = "OUT.html")]
    report: Option<PathBuf>,
    /// Print the lines that change
    #[arg(long, conflicts_with = "json")]
    diff: bool,
    /// Print one JSON object a block with a move, one a line (docs/json.md)
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    input: JobInput,
}

/// Block with a move, as JSON, by name in alphabetical order; feeds per minute and lengths in the job's unit.
#[derive(Serialize)]
struct BlockFigures {
    chip_error_max: Option<f64>,
    chip_error_mean: Option<f64>,
    chip_error_min: Option<f64>,
    contact_deg_end: Option<f64>,
    contact_deg_start: Option<f64>,
    direction: Option<&'static str>,
    f_words: usize,
    factor_max: Option<f64>,
    factor_min: Option<f64>,
    feed_max: Option<f64>,
    feed_min: Option<f64>,
    feed_unit: &'static str,
    ipt_center_max: Option<f64>,
    ipt_center_min: Option<f64>,
    kind: &'static str,
    law: Option<&'static str>,
    not_divided: Option<&'static str>,
    limit_axis: Option<char>,
    limit_feed: Option<f64>,
    line: usize,
    n: Option<i64>,
    pieces: Option<usize>,
    programmed_feed: Option<f64>,
    reason: &'static str,
    rotation: Option<&'static str>,
    sent_feed: Option<f64>,
    side: Option<&'static str>,
    /// T number of the rule's tool.
    tool: Option<i64>,
}

impl Adapt {
    /// Runs the command.
    ///
    /// # Errors
    /// The job or the program is at fault, or the output cannot be written.
    pub fn run(&self) -> Result<(), Failure> {
        let (file, source, may_leak) = self.input.load_text()?;
        let prepared = self.output.as_deref().filter(|_| self.target.is_some()).map(prepared_path);
        let outputs = [&self.output, &prepared, &self.report].map(Option::as_deref);
        refuse_inputs(&outputs, &file.inputs(&self.input.job))?;
        let places = source.places.as_deref();
        let expands = self.expand || self.target.is_some();
        if expands {
            check_expanded(&source.path, places)?;
        }
        if self.target.is_some() {
            check_for_linuxcnc(&source, &file)?;
        }
        let plan = LinePlan::new(&source, may_leak, &file.job, Known::of(&file));
        let table = (!self.json && !self.diff && self.output.is_none()).then(|| Table::begin(&file.job));
        let (mut table, mut unknown, mut number) = (table, UnknownMoves::default(), 0);
        let (mut kept, writes_back) = (KeptMoves::new(source.places.clone()), places.is_some() && !expands);
        let keeps = self.output.is_some() || (self.diff && writes_back);
        let (mut text, mut line_ends) = (Vec::with_capacity(if keeps { source.bytes.len() } else { 0 }), Vec::new());
        let done = plan.each(|line, mut planned| {
            number += 1;
            if let Some(block) = &mut planned.block {
                kept.add(block, line);
                block.line = source.line_in_file(block.line);
                unknown.add(block, &file);
                if self.json {
                    let figures = BlockFigures::new(block, &file.job);
                    say(format_args!("{}", json_text(&figures)));
                }
                table.iter_mut().for_each(|table| table.add(block));
            }
            if self.diff && !writes_back {
                print_diff(&source.path, source.line_in_file(number), &line.text, &planned.text);
            }
            if keeps {
                text.extend_from_slice(&planned.text);
                text.extend_from_slice(&line.ending);
                line_ends.extend(writes_back.then_some(text.len()));
            }
        });
        done.map_err(|Leak| {
            let path = source.path.display();
            Failure::Input(format!(
                "{path}: a governed feed would stay in force for other blocks: a defect of arcfeed; nothing is written"
            ))
        })?;
        kept.warn(&source.path);
        kept.explain(&source.path, &file);
        unknown.warn(&source.path, &file);
        table.iter().for_each(Table::end);
        if keeps && writes_back {
            text = self.written_back(&source, &text, &line_ends)?;
        }
        match (&self.output, self.target) {
            (Some(output), Some(TargetControl::Linuxcnc)) => write_for_linuxcnc(output, &source, &file, text)?,
            (Some(output), None) => write_whole(output, &text)?,
            (None, _) => {}
        }
        Ok(())
    }

    /// Path of the report, if one is requested, and the input that is simulated for it.
    pub fn report(&self) -> Option<(&JobInput, &Path)> {
        self.report.as_deref().map(|path| (&self.input, path))
    }

    /// The program with the feeds written back; prints the lines of the file that change, if that is requested.
    fn written_back(&self, source: &Source, text: &[u8], line_ends: &[usize]) -> Result<Vec<u8>, Failure> {
        let written = write_back(source, text, line_ends).map_err(Failure::Input)?;
        let file = source.places.iter().filter(|_| self.diff).flat_map(|places| Lines::new(&places.file));
        for (index, (old, new)) in file.zip(written.lines()).enumerate() {
            print_diff(&source.path, index + 1, old.text, new.strip_suffix(old.ending).unwrap_or(new));
        }
        Ok(written.text)
    }
}

fn print_diff(path: &Path, number: usize, old: &[u8], sent: &[u8]) {
    if old != sent {
        let new = sent.split(|&byte| byte == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line));
        let new: Vec<String> = new.map(|line| format!("\n+ {}", line.escape_ascii())).collect();
        say(format_args!("{}:{number}\n- {}{}", path.display(), old.escape_ascii(), new.concat()));
    }
}

/// Table of the blocks that a cut rule matches.
struct Table<'a> {
    job: &'a Job,
    in_pieces: bool,
    moves: usize,
    governed: usize,
    pieces: usize,
    f_words: usize,
}

impl<'a> Table<'a> {
    fn begin(job: &'a Job) -> Self {
        let (unit, in_pieces) = (job.unit.label(), matches!(job.policy, FeedPolicy::RewriteOnly(_)));
        say(format_args!(
            "   line  N        programmed        sent     wanted {unit}/min     factor          contact  {}reason",
            if in_pieces { "pieces  F    chip error, %       " } else { "" }
        ));
        Table { job, in_pieces, moves: 0, governed: 0, pieces: 0, f_words: 0 }
    }

    fn add(&mut self, block: &PlannedBlock) {
        self.moves += 1;
        self.f_words += block.f_words;
        if block.governed_feed().is_some() {
            self.governed += 1;
            self.pieces += block.pieces.len().max(1);
        }
        if block.rule.is_none() && !block.is_descent && block.governed_feed().is_none() {
            return;
        }
        let figures = BlockFigures::new(block, self.job);
        let number = |value: Option<f64>, decimals| value.map_or("-".into(), |value| format!("{value:.decimals$}"));
        let range = |low, high, decimals| format!("{} .. {}", number(low, decimals), number(high, decimals));
        say(format_args!(
            "{:>7}  {:<7}{:>12}{:>12}{:>18}{:>15}{:>15}  {}{}{}{}",
            block.line,
            block.segment.sequence.map_or("-".into(), |n| format!("N{n}")),
            number(figures.programmed_feed, 2),
            number(figures.sent_feed, 2),
            range(figures.feed_min, figures.feed_max, 1),
            range(figures.factor_min, figures.factor_max, 2),
            range(figures.contact_deg_start, figures.contact_deg_end, 1),
            if self.in_pieces { pieces_column(&figures) } else { String::new() },
            figures.reason,
            limited_by(block, &figures),
            figures.not_divided.map_or(String::new(), |why| format!(", not divided: {why}"))
        ));
    }

    fn end(&self) {
        let Table { job, in_pieces, moves, governed, pieces, f_words } = self;
        let limits = &job.limits;
        let how = if *in_pieces {
            let (pieces, words) = (counted(*pieces, "piece"), counted(*f_words, "F word"));
            format!("They are sent in {pieces}; the moves of the program have {words}. Override 100 %.")
        } else {
            format!("Override {} .. {} %.", limits.min_percent, limits.max_percent)
        };
        say(format_args!("{governed} of {moves} moves are governed by the law; the others keep their own feed. {how}"));
    }
}

/// Axis that cannot follow the law, and the feed that it allows.
fn limited_by(block: &PlannedBlock, figures: &BlockFigures) -> String {
    match (block.reason, figures.limit_axis, figures.limit_feed) {
        (PlanReason::Axis, Some(axis), Some(feed)) => format!(", limited by {axis} to {feed:.2}"),
        _ => String::new(),
    }
}

/// Number of pieces, F words, and the least, mean and largest error of the chip.
fn pieces_column(figures: &BlockFigures) -> String {
    let percent = |ratio: Option<f64>| ratio.map_or("-".into(), |ratio| format!("{:+.2}", 1e2 * ratio));
    let errors = [figures.chip_error_min, figures.chip_error_mean, figures.chip_error_max].map(percent);
    let pieces = figures.pieces.map_or("-".into(), |pieces| pieces.to_string());
    format!("{pieces:>6}{:>3}{:>7}{:>7}{:>7}   ", figures.f_words, errors[0], errors[1], errors[2])
}

impl BlockFigures {
    fn new(block: &PlannedBlock, job: &Job) -> Self {
        let unit_mm = job.unit.mm();
        let feed = |feed: Nm| feed.0 as f64 / job.unit.nm() as f64;
        let rule = block.cut_rule(job);
        let rule = rule.as_deref();
        let demand = block.demand.as_ref();
        // A table has no contact.
        let setup = rule.map(|rule| job.tool_of(rule));
        let has_contact =
            setup.is_some_and(|setup| matches!(setup.tool, Tool::CupMill(_)) && setup.law != LawKind::Table);
        let contact = demand.filter(|_| has_contact);
        let programmed = block.programmed();
        let factor = |wanted_mm: f64| programmed.map(|feed| wanted_mm / feed.to_mm());
        BlockFigures {
            n: block.segment.sequence,
            line: block.line,
            kind: block.kind(),
            direction: block.segment.arc().map(|arc| direction_word(arc.turn)),
            rotation: rule.and_then(|rule| rotation_word(rule.moves)),
            side: rule.map(|rule| side_word(&rule.work)),
            tool: setup.and_then(|setup| setup.number),
            law: setup.map(|setup| law_word(setup.law)).or(block.is_descent.then_some(plunge::LAW)),
            programmed_feed: programmed.map(feed),
            sent_feed: block.sent.map(feed),
            feed_min: demand.map(|demand| demand.feed_min_mm_per_min / unit_mm),
            feed_max: demand.map(|demand| demand.feed_max_mm_per_min / unit_mm),
            feed_unit: feed_unit(job.unit),
            ipt_center_min: demand.map(|demand| demand.ipt_mm_per_tooth[0] / unit_mm),
            ipt_center_max: demand.map(|demand| demand.ipt_mm_per_tooth[1] / unit_mm),
            contact_deg_start: contact.map(|demand| demand.contact_deg[0]),
            contact_deg_end: contact.map(|demand| demand.contact_deg[1]),
            factor_min: demand.and_then(|demand| factor(demand.feed_min_mm_per_min)),
            factor_max: demand.and_then(|demand| factor(demand.feed_max_mm_per_min)),
            reason: block.reason.label(),
            pieces: (!block.pieces.is_empty()).then_some(block.pieces.len()),
            not_divided: block.whole.map(Whole::label),
            chip_error_min: block.chip_error.map(|error| error.min),
            chip_error_mean: block.chip_error.map(|error| error.mean),
            chip_error_max: block.chip_error.map(|error| error.max),
            f_words: block.f_words,
            limit_feed: block.limit.map(|limit| limit.feed_mm_per_min / unit_mm),
            limit_axis: block.limit.and_then(|limit| limit.axis),
        }
    }
}

fn feed_unit(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Inch => "in/min",
        LengthUnit::Mm => "mm/min",
    }
}

/// Value of `rotation` in job files for these moves.
pub fn rotation_word(moves: Moves) -> Option<&'static str> {
    match moves {
        Moves::Rotations(RotationCircle::Interior, _) => Some("interior"),
        Moves::Rotations(RotationCircle::Exterior, _) => Some("exterior"),
        Moves::Arcs(_) | Moves::Lines => None,
    }
}

/// Value of `direction` in job files for this sense.
pub fn direction_word(turn: Turn) -> &'static str {
    match turn {
        Turn::Cw => "cw",
        Turn::Ccw => "ccw",
    }
}

/// Value of `side` in job files for this work.
pub fn side_word(work: &Work) -> &'static str {
    match work {
        Work::Ring(Edge::Outer, _) => "outer",
        Work::Ring(Edge::Inner, _) => "inner",
        Work::Mill { side: ContourSide::Inside, .. } => "inside",
        Work::Mill { side: ContourSide::Outside, .. } => "outside",
        Work::Mill { side: ContourSide::Slot, .. } => "slot",
    }
}

fn law_word(law: LawKind) -> &'static str {
    match law {
        LawKind::Circumference => "circumference",
        LawKind::EngagedArc { .. } => "engaged-arc",
        LawKind::Contour { .. } => "contour",
        LawKind::Engagement => "engagement",
        LawKind::Table => "table",
        LawKind::Programmed => "programmed",
    }
}
