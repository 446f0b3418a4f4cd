//! What a board is told of a program: its moves in order, and with which line of what is sent each of them comes.
//!
//! The moves are those of the text as it goes over the DNC line, feeds and a restart's own blocks included. Those of canned
//! cycles and reference returns are told one by one, without a rule: the board follows them by their ends.

use std::path::Path;

use arcfeed_shared::job::Job;
use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::nc::series::Act;
use arcfeed_shared::segment::Segment;
use arcfeed_shared::wire::message::moves::{MoveError, encode};
use arcfeed_shared::wire::message::table;

use crate::adapt::{PlanReason, adapt};
use crate::dnc::restore::PowerOn;
use crate::dnc::transmission::Transmission;
use crate::program::{Program, ProgramLine};

/// The moves of a transmission.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// Counted from 0.
    moves: Vec<table::Segment>,
    /// Index of the line that each belongs to.
    lines: Vec<usize>,
}

/// A move that no board can be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanError {
    /// Line of the program's file, counted from 1; 0 for one of ours.
    pub source: usize,
    /// Why.
    pub why: Untold,
}

/// Why a move cannot be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Untold {
    /// Its numbers.
    #[error("this move cannot be told to a board: {0:?}")]
    Move(MoveError),
    /// A move left out would put every law behind it on the wrong one.
    #[error("this block is not understood, and a board must be told every move; send without --board")]
    NotUnderstood,
}

impl Plan {
    /// The moves of what is sent to a control that stands as at power-on.
    ///
    /// # Errors
    /// The first move that cannot be told.
    pub fn new(sending: &Transmission, power_on: &PowerOn, job: &Job) -> Result<Self, PlanError> {
        // A control that reports where it is moves nothing by it; nor is there a reader of such blocks here.
        let lines = (0..sending.lines().len()).map(|index| match sending.is_of_report(index) {
            true => b"\n",
            false => sending.line_text(index).unwrap_or_default(),
        });
        let text = lines.collect::<Vec<_>>().concat();
        let program = Program::parse_with(Path::new(""), &text, power_on.settings, power_on.tables);
        let adapted = adapt(&program, job);
        let mut blocks = adapted.blocks.iter().peekable();
        let mut plan = Plan::default();
        for (index, line) in program.lines.iter().enumerate() {
            let source = sending.lines().get(index).map_or(0, |line| line.source);
            if line.meaning.is_none() {
                return Err(PlanError { source, why: Untold::NotUnderstood });
            }
            let mut add = |segment: &Segment, rule: Option<usize>| {
                let count = plan.moves.len() as u32;
                let rule = rule.and_then(|rule| u8::try_from(rule).ok());
                let told = encode(segment, count, rule).map_err(|why| PlanError { source, why: Untold::Move(why) })?;
                plan.moves.push(told);
                plan.lines.push(index);
                Ok(())
            };
            if let Some(block) = blocks.next_if(|block| block.line == index + 1) {
                add(&block.segment, block.rule.filter(|_| block.reason != PlanReason::Special))?;
            }
            for segment in series(line) {
                add(&segment, None)?;
            }
        }
        Ok(plan)
    }

    /// The moves.
    pub fn moves(&self) -> &[table::Segment] {
        &self.moves
    }

    /// How many moves are over once the control has taken up so many blocks: those of all lines before the last of them.
    pub fn over(&self, blocks: usize, sending: &Transmission) -> usize {
        let in_work = sending.line_of_block(blocks).unwrap_or(0);
        self.lines.partition_point(|line| *line < in_work)
    }

    /// Index of the line that a move belongs to, counted from 0.
    pub fn line_of(&self, count: usize) -> Option<usize> {
        self.lines.get(count).copied()
    }

    /// How far the text may go out once so many moves are the board's: to the line of the next one.
    pub fn permitted(&self, delivered: usize, sending: &Transmission) -> usize {
        self.lines.get(delivered).map_or(usize::MAX, |line| sending.start_of(*line))
    }
}

/// The moves of a block that makes several, seen from the workpiece's origin.
fn series(line: &ProgramLine) -> Vec<Segment> {
    let Some(meaning) = &line.meaning else { return Vec::new() };
    let Some(series) = &meaning.step.series else { return Vec::new() };
    let motions = series.acts().filter_map(|act| match act {
        Act::Move(motion) => Segment::from_motion(&motion, meaning.parsed.block.sequence).ok(),
        Act::Dwell(_) | Act::Spindle(_) => None,
    });
    motions.map(|segment| segment.shifted(Pose::ORIGIN.minus(line.origin))).collect()
}
