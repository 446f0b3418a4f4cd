//! Adaptation: from a program and a job to the feeds that are sent. It decides which law governs which block, evaluates
//! the law, and writes F words with which the override of 100 % is safe, or with which no override is needed.

pub mod places;

pub mod turning_points;

pub mod asked_cells;

pub mod profile;

pub mod range;

pub mod pieces;

pub mod points;

pub mod modes;

pub mod limit;

pub mod reason;

pub mod offset_moves;

mod rule_match;

mod descents;

mod known;

pub mod unused_rules;

pub mod rewrite;

pub mod spelling;

pub mod split;

mod corner_line;

mod planned_block;

pub mod held_feeds;

mod writer;

mod line_plan;

mod end_override;

mod feed_place;

pub mod write_back;

use arcfeed_model::job::{FeedPolicy, Job};
use arcfeed_nc::text::Lines;

use crate::program::{Program, ProgramLine, may_have_contours};
use end_override::OverrideEnds;
use known::KeptLines;
pub use known::Known;
pub use line_plan::LinePlan;
pub use planned_block::{BlockLaw, PlannedBlock};
pub use reason::PlanReason;
use rewrite::Leak;
pub use writer::PlannedLine;
use writer::Writer;

/// Adapted program: the plan of every block with a move, and the text that is sent.
#[derive(Clone, Debug)]
pub struct Adapted {
    /// Every block with a move, in order.
    pub blocks: Vec<PlannedBlock>,
    /// Text of the program with the adapted F words.
    pub text: Vec<u8>,
    /// Offset in `text` at which each line of the original program ends.
    pub line_ends: Vec<usize>,
}

/// Plans the feeds of a program that has no errors, by the job alone.
pub fn adapt(program: &Program, job: &Job) -> Adapted {
    adapt_with(program, job, Known::default())
}

/// Plans the feeds of a program that has no errors, with further input such as machine and engagement map.
pub fn adapt_with(program: &Program, job: &Job, known: Known<'_>) -> Adapted {
    let known = Known { places: program.places.as_deref(), ..known };
    let mut kept = KeptLines::default();
    loop {
        let mut adapted = Adapted { blocks: Vec::new(), text: Vec::new(), line_ends: Vec::new() };
        let line_end = Lines::new(program.bytes()).next().map_or(&b""[..], |line| line.ending);
        let mut writer = Writer::new(&program.control, line_end, job, known, &kept);
        if may_have_contours(program.bytes()) {
            writer.read_contours(&program.control, program.texts());
        }
        let mut ends = OverrideEnds::default();
        let leak = program.lines().try_for_each(|line| {
            ends.add(&line);
            writer.take(&line).map(|planned| adapted.add(&line, planned))
        });
        let leak = leak.err();
        let Some(Leak) = leak else {
            if !matches!(job.policy, FeedPolicy::RewriteOnly(_)) {
                ends.set(&mut adapted.blocks, job);
            }
            return adapted;
        };
        let last_governed = writer.last_governed;
        drop(writer);
        kept = kept.with(last_governed);
    }
}

impl Adapted {
    fn add(&mut self, line: &ProgramLine, planned: PlannedLine) {
        self.blocks.extend(planned.block);
        self.text.extend(planned.text);
        self.text.extend(&line.ending);
        self.line_ends.push(self.text.len());
    }
}
