//! Conditions of moves that the simulated machine cannot know by itself, taken from the plan of the program.

use std::collections::BTreeSet;
use std::iter;

use arcfeed_hil_sim::planned_conditions::PlannedConditions;
use arcfeed_law::move_table::MoveTable;
use arcfeed_model::engaged::EngagedTable;
use arcfeed_model::job::FeedPolicy;
use arcfeed_model::machine::FeedLimit;
use arcfeed_units::PERCENT;

use crate::adapt::limit::is_tip_line;
use crate::adapt::{Adapted, PlannedBlock};
use crate::job::JobFile;
use crate::program::Program;

/// Conditions of moves that the simulated machine cannot know by itself, taken from the plan: moves under G43.4, and
/// moves that a cut rule matches, with their engagement and their largest feed; all moves, if some have feeds of their own: a move is
/// recognised by its path, and another one on the same path must not get these feeds.
pub fn foreseen(program: &Program, adapted: &Adapted, file: &JobFile) -> Vec<PlannedConditions> {
    foreseen_where(program, adapted, file, |_| true)
}

/// Conditions of moves for a run of the original program: only for the moves whose chip meter needs them. Where arcs are written in
/// pieces, for all moves: without its conditions, an arc about the centre of the arc before it would count as a piece of that.
pub fn foreseen_before(program: &Program, adapted: &Adapted, file: &JobFile) -> Vec<PlannedConditions> {
    let needs_all = has_scopes(file) || matches!(file.job.policy, FeedPolicy::RewriteOnly(_));
    foreseen_where(program, adapted, file, |block| {
        needs_all || engaged(block).is_some() || block.contour.is_some() || block.is_cut_off
    })
}

/// The same for chosen moves.
fn foreseen_where(
    program: &Program,
    adapted: &Adapted,
    file: &JobFile,
    choose: impl Fn(&PlannedBlock) -> bool,
) -> Vec<PlannedConditions> {
    let tip_lines: BTreeSet<usize> =
        (1..).zip(program.lines()).filter(|(_, line)| is_tip_line(line)).map(|(number, _)| number).collect();
    let is_of_tip = |block: &PlannedBlock| tip_lines.contains(&block.line);
    let has_feeds = adapted.blocks.iter().any(|block| block.along.as_deref().and_then(MoveTable::feeds).is_some());
    let takes_all = has_scopes(file) || has_feeds;
    let is_known = |block: &&PlannedBlock| {
        takes_all || block.rule.is_some() || is_of_tip(block) || block.end_percent != PERCENT as u8
    };
    let moves =
        adapted.blocks.iter().flat_map(|block| iter::once(block).chain(block.inserted.as_deref())).filter(is_known);
    let known = moves.filter(|block| choose(block)).map(|block| PlannedConditions {
        segment: block.segment,
        rule: block.rule.filter(|_| block.demand.is_some()),
        along: block.along.clone(),
        limit: block.limit.map(FeedLimit::from),
        end_percent: block.end_percent,
        side: block.contour.and_then(|place| place.side),
        target: block.target(&file.job),
    });
    known.collect()
}

fn engaged(block: &PlannedBlock) -> Option<&EngagedTable> {
    block.along.as_deref().and_then(MoveTable::engaged)
}

/// Whether a cut rule of the job is restricted to lines of the file or to a plane, which a simulated machine does not
/// know.
pub fn has_scopes(file: &JobFile) -> bool {
    file.rule_scopes.iter().any(|scope| scope.key().is_some())
}
