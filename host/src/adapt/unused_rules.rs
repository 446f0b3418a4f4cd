//! Cut rules that no move can ever meet, as warnings of their job file.

use std::path::Path;

use arcfeed_model::cut::CutRule;
use arcfeed_model::job::Job;
use arcfeed_nc::segment::Segment;

use crate::job::JobFile;
use crate::program::{CornerMoves, ProgramLine};

/// Warnings `file:line:column: warning: ...`: rules behind one that takes all of their moves, and with a program, given as its
/// path and what its moves meet, those that none of its moves meets.
pub fn unused_rules(path: &Path, file: &JobFile, program: Option<(&Path, &RuleUse)>) -> Vec<String> {
    let rules = &file.job.rules;
    let met = program.map(|(program, used)| (program.display(), &used.met));
    let why = |index: usize, rule: &CutRule| {
        if let Some(earlier) = rules.iter().take(index).position(|earlier| covers(earlier, rule)) {
            let line = file.rule_places.get(earlier).map_or(0, |[line, _]| *line);
            return Some(format!(
                "this rule is never used: the one in line {line} takes all of its moves; put this one before it, or narrow that \
                 one with n or z"
            ));
        }
        let (program, met) = met.as_ref()?;
        match met.get(index)? {
            Met::Never => Some(format!(
                "no move of {program} fits this rule: compare its direction, n and z, and the tool's number and radii, with the program"
            )),
            Met::Behind => Some(format!("this rule is never used: earlier rules take all of its moves of {program}")),
            Met::First => None,
        }
    };
    let warning = |(index, rule): (usize, &CutRule)| {
        let [line, column] = file.rule_places.get(index).copied().unwrap_or([1, 1]);
        let why = why(index, rule)?;
        Some(format!("{}:{line}:{column}: warning: {why} (in `cut.{}`)", path.display(), index + 1))
    };
    rules.iter().enumerate().filter_map(warning).collect()
}

/// Use of a rule by the moves of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Met {
    /// No move fits it.
    Never,
    /// Those that fit it fit an earlier rule too.
    Behind,
    /// It is the first that fits one.
    First,
}

/// Use of each rule of a job by the moves of a program.
#[derive(Clone, Debug)]
pub struct RuleUse {
    met: Vec<Met>,
    corners: CornerMoves,
}

impl RuleUse {
    /// Before the first line.
    pub fn new(job: &Job) -> Self {
        RuleUse { met: vec![Met::Never; job.rules.len()], corners: CornerMoves::default() }
    }

    /// The next line, with its tool's place among the job's.
    pub fn add(&mut self, line: &ProgramLine, job: &Job, tool: Option<usize>) {
        let corners = line.meaning.as_ref().map(|meaning| self.corners.pass(0, meaning)).unwrap_or_default();
        let inserted = corners.into_iter().flatten().filter_map(|(_, corner)| corner.inserted);
        let Some(tool) = tool else { return };
        for segment in line.segment().into_iter().chain(inserted) {
            self.add_move(&segment, job, tool);
        }
    }

    fn add_move(&mut self, segment: &Segment, job: &Job, tool: usize) {
        let fits = |rule: &CutRule| usize::from(rule.tool) == tool && rule.fits(segment, &job.tool_of(rule).tool);
        let fitting = job.rules.iter().zip(&mut self.met).filter(|(rule, _)| fits(rule));
        for (place, (_, met)) in fitting.enumerate() {
            *met = (*met).max(if place == 0 { Met::First } else { Met::Behind });
        }
    }
}

/// Whether every move that `rule` fits is one that `earlier` fits.
fn covers(earlier: &CutRule, rule: &CutRule) -> bool {
    let is_within = |inner: (i64, i64), outer: (i64, i64)| outer.0 <= inner.0 && inner.1 <= outer.1;
    let levels = |rule: &CutRule| rule.level.map(|(low, high)| (low.0, high.0));
    let covers_range = |outer: Option<(i64, i64)>, inner: Option<(i64, i64)>| match (outer, inner) {
        (None, _) => true,
        (Some(_), None) => false,
        (Some(outer), Some(inner)) => is_within(inner, outer),
    };
    (earlier.tool, earlier.moves) == (rule.tool, rule.moves)
        && covers_range(earlier.sequence, rule.sequence)
        && covers_range(levels(earlier), levels(rule))
}
