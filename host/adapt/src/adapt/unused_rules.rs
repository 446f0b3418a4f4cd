//! Warnings of cut rules that no move can ever match.

use std::path::Path;
use std::sync::Arc;

use arcfeed_model::cut::CutRule;
use arcfeed_model::job::Job;
use arcfeed_nc::segment::Segment;

use crate::job::JobFile;
use crate::job::rule_scope;
use crate::program::{CornerMoves, ExecutedPlaces, ProgramLine};

/// Warnings `file:line:column: warning: ...` for cut rules that never apply: rules whose moves an earlier rule takes,
/// and rules that no move of the program (its path, and the use of the rules) matches.
pub fn unused_rules(path: &Path, file: &JobFile, program: Option<(&Path, &RuleUse)>) -> Vec<String> {
    let met = program.map(|(program, used)| (program.display(), &used.met));
    let why = |index: usize| {
        if let Some(earlier) = (0..index).find(|earlier| covers(file, *earlier, index)) {
            let line = file.rule_places.get(earlier).map_or(0, |[line, _]| *line);
            return Some(format!(
                "this rule is never used: the one in line {line} takes all of its moves; put this one before it, or narrow that \
                 one with n, z, lines or plane"
            ));
        }
        let (program, met) = met.as_ref()?;
        match met.get(index)? {
            Met::Never => Some(format!(
                "no move of {program} fits this rule: compare its direction, n, z, lines and plane, and the tool's number and radii, with the program"
            )),
            Met::Behind => Some(format!("this rule is never used: earlier rules take all of its moves of {program}")),
            Met::First => None,
        }
    };
    let warning = |index: usize| {
        let [line, column] = file.rule_places.get(index).copied().unwrap_or([1, 1]);
        let why = why(index)?;
        Some(format!("{}:{line}:{column}: warning: {why} (in `cut.{}`)", path.display(), index + 1))
    };
    (0..file.job.rules.len()).filter_map(warning).collect()
}

/// Use of a rule by the moves of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Met {
    /// No move fits it.
    Never,
    /// All moves that match the rule also match an earlier rule.
    Behind,
    /// A move matches the rule and no earlier one.
    First,
}

/// Record of which cut rules of a job are used by the moves of a program.
#[derive(Clone, Debug)]
pub struct RuleUse {
    met: Vec<Met>,
    /// Number of lines so far.
    lines: usize,
    places: Option<Arc<ExecutedPlaces>>,
    corners: CornerMoves,
}

impl RuleUse {
    /// Record before the first line. `places` are the places of the executed blocks in the program's file, if they
    /// differ from its lines.
    pub fn new(job: &Job, places: Option<Arc<ExecutedPlaces>>) -> Self {
        RuleUse { met: vec![Met::Never; job.rules.len()], lines: 0, places, corners: CornerMoves::default() }
    }

    /// Records the rules that the move of the next line matches; `tool` is the index in the job of the tool in the
    /// spindle.
    pub fn add(&mut self, line: &ProgramLine, file: &JobFile, tool: Option<usize>) {
        self.lines += 1;
        let corners = line.meaning.as_ref().map(|meaning| self.corners.pass(0, meaning)).unwrap_or_default();
        let inserted = corners.into_iter().flatten().filter_map(|(_, corner)| corner.inserted);
        let Some(tool) = tool else { return };
        for segment in line.segment().into_iter().chain(inserted) {
            self.add_move(&segment, file, tool);
        }
    }

    fn add_move(&mut self, segment: &Segment, file: &JobFile, tool: usize) {
        let JobFile { job, rule_scopes, .. } = file;
        let line = self.places.as_ref().map_or(Some(self.lines), |places| places.own_line(self.lines));
        let fits = |index: usize, rule: &CutRule| {
            usize::from(rule.tool) == tool
                && rule.fits(segment, &job.tool_of(rule).tool)
                && rule_scope::admits(rule_scopes, index, line, segment)
        };
        let fitting = job.rules.iter().zip(&mut self.met).enumerate().filter(|(index, (rule, _))| fits(*index, rule));
        for (place, (_, (_, met))) in fitting.enumerate() {
            *met = (*met).max(if place == 0 { Met::First } else { Met::Behind });
        }
    }
}

/// Whether every move that a rule fits is one that an earlier rule fits.
fn covers(file: &JobFile, earlier: usize, rule: usize) -> bool {
    let scopes = [earlier, rule].map(|index| file.rule_scopes.get(index).copied().unwrap_or_default());
    let [earlier, rule] = [earlier, rule].map(|index| &file.job.rules[index]);
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
        && scopes[0].covers(&scopes[1])
}
