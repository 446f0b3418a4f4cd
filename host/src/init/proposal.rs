//! Proposal for a job: the tools that mill arcs, and the cut rules that distinguish their movements.
//!
//! A cup mill turns about points on its own two circles: two large radii that recur, make up most of its arcs and have the
//! proportion of a ring, and whose arcs are less than half a turn and no rounded corners of a contour. Any other tool with arcs in G17 is taken for an
//! end mill, unless a comment says that it is something else.

use arcfeed_model::cut::{ContourSide, RULES_MAX, RotationCircle};
use arcfeed_model::job::TOOLS_MAX;
use arcfeed_model::tool::Edge;
use arcfeed_nc::modal::{Plane, Turn};

use super::answers::{Answers, Milling};
use super::groups::{Group, same_radius};
use super::survey::Survey;
use crate::program::{CommentedKind, ToolNote};

/// Least fraction of the arcs that the two radii of a ring make up.
const DOMINANT_RATIO: f64 = 0.6;
/// Inner over outer radius of a ring.
const RING_RATIO: std::ops::RangeInclusive<f64> = 0.5..=0.99;

/// Least outer radius of a ring, mm.
const OUTER_MIN_MM: f64 = 20.0;

/// Proposed tools and cut rules of a new job.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// Tools, in order of their numbers.
    pub tools: Vec<ProposedTool>,
    /// T numbers of tools with arcs that exceed the number of tools in a job.
    pub left_out: Vec<i64>,
    /// Comments of tools that mill arcs but are not taken for end mills because of the comment.
    pub excluded: Vec<ToolNote>,
}

/// Proposed tool with its cut rules.
#[derive(Clone, Debug, PartialEq)]
pub struct ProposedTool {
    /// T number; `None` if the program names no tools.
    pub number: Option<i64>,
    /// Kind of tool, as far as its arcs show it.
    pub kind: LikelyTool,
    /// Proposed cut rules, in the order in which they are written.
    pub cuts: Vec<ProposedCut>,
    /// Comments of the program about the tool.
    pub note: Option<ToolNote>,
}

/// Kind of tool that the arcs suggest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LikelyTool {
    /// Cup mill with its two radii, mm.
    CupMill {
        /// Radius of the outer circle, mm.
        outer_mm: f64,
        /// Radius of the inner circle, mm.
        inner_mm: f64,
    },
    /// End mill.
    EndMill,
}

/// Proposed cut rule.
#[derive(Clone, Debug, PartialEq)]
pub struct ProposedCut {
    /// Kind of movement, and the side on which the tool cuts.
    pub movement: Movement,
    /// Direction of the arcs: clockwise or counter-clockwise.
    pub turn: Turn,
    /// Indices of the groups of arcs to which the rule applies.
    pub groups: Vec<usize>,
}

/// Kind of movement to which a proposed rule applies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Movement {
    /// Turn of a cup mill about a point on one of its circles, and the circle that cuts according to the published order of movements.
    Rotation(RotationCircle, Edge),
    /// Motion of an end mill on this side of a contour.
    Contour(ContourSide),
}

/// Proposes tools and cut rules for the tools that mill arcs; if there are none, an end mill without rules.
pub fn propose(groups: &[Group], survey: &Survey, answers: &Answers) -> Proposal {
    let note_of = |tool: Option<i64>| survey.notes.iter().find(|note| Some(note.tool) == tool).cloned();
    let mut numbers: Vec<Option<i64>> = groups.iter().map(|group| group.tool).collect();
    numbers.dedup();
    // T0 M6 puts the tool away.
    numbers.retain(|number| *number != Some(0));
    let (mut tools, mut excluded): (Vec<ProposedTool>, Vec<ProposedTool>) = (Vec::new(), Vec::new());
    for number in numbers {
        let own: Vec<usize> = (0..groups.len()).filter(|index| groups[*index].tool == number).collect();
        let note = note_of(number);
        let ring = ring(groups, &own).filter(|_| !is_end_mill(note.as_ref(), answers, number));
        let tool = match ring {
            Some([inner_mm, outer_mm]) => {
                let kind = LikelyTool::CupMill { outer_mm, inner_mm };
                ProposedTool { number, kind, cuts: rotations(groups, &own, [inner_mm, outer_mm]), note }
            }
            None => {
                ProposedTool { number, kind: LikelyTool::EndMill, cuts: contours(groups, &own, answers.milling), note }
            }
        };
        let is_known = tool.kind != LikelyTool::EndMill || !is_other(tool.note.as_ref()) || is_named(answers, number);
        if !tool.cuts.is_empty() {
            if is_known { tools.push(tool) } else { excluded.push(tool) }
        }
    }
    take_only_mill(&mut tools, &mut excluded, answers);
    let excluded = excluded.into_iter().filter_map(|tool| tool.note).collect();
    let left_out = keep_what_fits(&mut tools, groups);
    if tools.is_empty() {
        let number = survey.tools.first().copied();
        tools.push(ProposedTool { number, kind: LikelyTool::EndMill, cuts: Vec::new(), note: note_of(number) });
    }
    Proposal { tools, left_out, excluded }
}

/// A diameter for no tool by number is that of the only tool with arcs, whatever the comments about the operation say.
fn take_only_mill(tools: &mut Vec<ProposedTool>, excluded: &mut Vec<ProposedTool>, answers: &Answers) {
    let is_stated = |tool: &ProposedTool| tool.note.as_ref().is_some_and(|note| note.data.kind.is_some());
    let has_common = answers.diameters.iter().any(|value| value.tool.is_none());
    if tools.is_empty() && has_common && excluded.len() == 1 && !is_stated(&excluded[0]) {
        tools.append(excluded);
    }
}

/// A comment says that it is no end mill.
fn is_other(note: Option<&ToolNote>) -> bool {
    note.is_some_and(|note| match note.data.kind {
        Some(kind) => kind == CommentedKind::Other,
        None => note.operation.is_some(),
    })
}

/// A comment or an answer says that it is an end mill.
fn is_end_mill(note: Option<&ToolNote>, answers: &Answers, number: Option<i64>) -> bool {
    Answers::of(&answers.diameters, number).is_some()
        || note.is_some_and(|note| note.data.kind == Some(CommentedKind::EndMill))
}

/// A diameter is given for this very tool.
fn is_named(answers: &Answers, number: Option<i64>) -> bool {
    answers.diameters.iter().any(|value| value.tool.is_some() && value.tool == number)
}

/// Keeps the tools with the most arcs, as many as a job has room for; returns the numbers of the others.
fn keep_what_fits(tools: &mut Vec<ProposedTool>, groups: &[Group]) -> Vec<i64> {
    let arcs = |tool: &ProposedTool| -> usize {
        tool.cuts.iter().flat_map(|cut| &cut.groups).map(|index| groups[*index].arcs).sum()
    };
    let mut left_out = Vec::new();
    while tools.len() > TOOLS_MAX || tools.iter().map(|tool| tool.cuts.len()).sum::<usize>() > RULES_MAX {
        let Some(least) = (0..tools.len()).min_by_key(|index| arcs(&tools[*index])) else { break };
        left_out.extend(tools.remove(least).number);
    }
    left_out
}

/// Inner and outer radius, if these arcs are a ring's.
fn ring(groups: &[Group], own: &[usize]) -> Option<[f64; 2]> {
    // Radius, arcs, corners; both senses together.
    let mut radii: Vec<(f64, usize, usize)> = Vec::new();
    for group in own.iter().map(|index| &groups[*index]) {
        match radii.iter_mut().find(|(radius, ..)| same_radius(*radius, group.radius_mm)) {
            Some((radius, arcs, corners)) => {
                let (before, more) = (*arcs as f64, group.arcs as f64);
                *radius = (*radius * before + group.radius_mm * more) / (before + more);
                *arcs += group.arcs;
                *corners += group.corners;
            }
            None => radii.push((group.radius_mm, group.arcs, group.corners)),
        }
    }
    let all: usize = radii.iter().map(|(_, arcs, _)| arcs).sum();
    radii.sort_by_key(|(_, arcs, _)| std::cmp::Reverse(*arcs));
    let [(a, a_arcs, a_corners), (b, b_arcs, b_corners), ..] = radii[..] else { return None };
    let third = radii.get(2).map_or(0, |(_, arcs, _)| *arcs);
    let arcs = a_arcs + b_arcs;
    let recur = b_arcs >= 2 && b_arcs > third;
    let dominate = arcs as f64 >= DOMINANT_RATIO * all as f64;
    let are_corners = 2 * (a_corners + b_corners) >= arcs;
    let (inner, outer) = (a.min(b), a.max(b));
    let is_ring = |radius: f64| same_radius(radius, inner) || same_radius(radius, outer);
    let mut of_ring = own.iter().map(|index| &groups[*index]).filter(|group| is_ring(group.radius_mm));
    let are_partial = of_ring.all(|group| group.sweep_rad[1] < std::f64::consts::PI);
    let is_shaped = outer >= OUTER_MIN_MM && RING_RATIO.contains(&(inner / outer));
    (recur && dominate && !are_corners && are_partial && is_shaped).then_some([inner, outer])
}

/// Movements of a ring, in the published order with the circles that cut there.
fn rotations(groups: &[Group], own: &[usize], [inner_mm, outer_mm]: [f64; 2]) -> Vec<ProposedCut> {
    let movements = [
        (RotationCircle::Interior, Turn::Ccw, Edge::Outer),
        (RotationCircle::Exterior, Turn::Cw, Edge::Outer),
        (RotationCircle::Exterior, Turn::Ccw, Edge::Inner),
        (RotationCircle::Interior, Turn::Cw, Edge::Inner),
    ];
    let cuts = movements.into_iter().map(|(rotation, turn, edge)| {
        let radius_mm = if rotation == RotationCircle::Interior { inner_mm } else { outer_mm };
        let is_it = |group: &Group| group.turn == turn && same_radius(radius_mm, group.radius_mm);
        let groups = own.iter().copied().filter(|index| is_it(&groups[*index])).collect();
        ProposedCut { movement: Movement::Rotation(rotation, edge), turn, groups }
    });
    cuts.filter(|cut| !cut.groups.is_empty()).collect()
}

/// Rules of an end mill, one for each sense, by the side on which it mills.
fn contours(groups: &[Group], own: &[usize], milling: Milling) -> Vec<ProposedCut> {
    let cuts = [Turn::Ccw, Turn::Cw].map(|turn| {
        let side = match (turn, milling) {
            (Turn::Ccw, Milling::Climb) | (Turn::Cw, Milling::Conventional) => ContourSide::Inside,
            (Turn::Cw, Milling::Climb) | (Turn::Ccw, Milling::Conventional) => ContourSide::Outside,
        };
        let is_it = |group: &Group| group.turn == turn && group.plane == Plane::Xy && group.helices < group.arcs;
        let groups = own.iter().copied().filter(|index| is_it(&groups[*index])).collect();
        ProposedCut { movement: Movement::Contour(side), turn, groups }
    });
    cuts.into_iter().filter(|cut| !cut.groups.is_empty()).collect()
}
