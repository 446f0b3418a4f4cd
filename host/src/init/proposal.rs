//! Proposal from the arcs: the likely tool, and the cut rules that distinguish its movements.
//!
//! A cup mill turns about points on its own two circles: two radii that recur, make up most of its arcs and have the
//! proportion of a ring, and whose arcs are not rounded corners of a contour. Anything else is taken for an end mill.

use arcfeed_model::cut::{RULES_MAX, RotationCircle};
use arcfeed_model::tool::Edge;
use arcfeed_nc::modal::Turn;
use arcfeed_units::Nm;

use super::groups::{Group, are_apart, same_radius};

/// Least fraction of the arcs that the two radii of a ring make up.
const DOMINANT_RATIO: f64 = 0.6;
/// Inner over outer radius of a ring.
const RING_RATIO: std::ops::RangeInclusive<f64> = 0.5..=0.99;

/// Proposed start of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The tool's number, where the program names tools.
    pub number: Option<i64>,
    /// Likely tool.
    pub tool: LikelyTool,
    /// Rules, in the order in which they are to be written.
    pub cuts: Vec<ProposedCut>,
}

/// A tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LikelyTool {
    /// Cup mill with its two radii, mm.
    CupMill {
        /// Larger radius.
        outer_mm: f64,
        /// Smaller radius.
        inner_mm: f64,
    },
    /// End mill of unknown diameter.
    EndMill,
}

/// A cut rule.
#[derive(Clone, Debug, PartialEq)]
pub struct ProposedCut {
    /// Point about which a ring turns.
    pub rotation: Option<RotationCircle>,
    /// The sense.
    pub turn: Turn,
    /// Cutting circle, where the published order of movements applies.
    pub edge: Option<Edge>,
    /// Arcs of the rule, as indices of the groups.
    pub groups: Vec<usize>,
    /// First and last N, if that distinguishes the rule from other arcs.
    pub sequence: Option<[i64; 2]>,
    /// Lowest and highest Z, if only that does.
    pub depth: Option<[Nm; 2]>,
    /// Arcs of other groups match the rule as well.
    pub is_ambiguous: bool,
}

/// Proposes a job for the tool that has the most arcs.
pub fn propose(groups: &[Group]) -> Proposal {
    let arcs_of =
        |tool: Option<i64>| groups.iter().filter(|group| group.tool == tool).map(|group| group.arcs).sum::<usize>();
    // Among tools with the same number of arcs, the first.
    let number = groups.iter().rev().map(|group| group.tool).max_by_key(|tool| arcs_of(*tool)).flatten();
    let own: Vec<usize> = (0..groups.len()).filter(|index| groups[*index].tool == number).collect();
    match ring(groups, &own) {
        Some([inner_mm, outer_mm]) => {
            let tool = LikelyTool::CupMill { outer_mm, inner_mm };
            Proposal { number, tool, cuts: rotations(groups, &own, [inner_mm, outer_mm]) }
        }
        None => Proposal { number, tool: LikelyTool::EndMill, cuts: contours(groups, &own) },
    }
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
    (recur && dominate && !are_corners && RING_RATIO.contains(&(inner / outer))).then_some([inner, outer])
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
        let mine: Vec<usize> = own.iter().copied().filter(|index| is_it(&groups[*index])).collect();
        let others: Vec<&Group> = (0..groups.len())
            .filter(|index| !mine.contains(index))
            .map(|index| &groups[index])
            .filter(|group| is_it(group))
            .collect();
        ProposedCut { rotation: Some(rotation), edge: Some(edge), ..restricted_cut(groups, mine, &others, turn) }
    });
    cuts.filter(|cut| !cut.groups.is_empty()).collect()
}

/// Rules of an end mill: one for each radius and sense if they can be distinguished, else one for each sense.
fn contours(groups: &[Group], own: &[usize]) -> Vec<ProposedCut> {
    let of_turn = |turn: Turn| own.iter().copied().filter(move |index| groups[*index].turn == turn).collect::<Vec<_>>();
    let mut cuts = Vec::new();
    for turn in [Turn::Ccw, Turn::Cw] {
        let others = |mine: &[usize]| -> Vec<&Group> {
            let is_other = |index: &usize| !mine.contains(index) && groups[*index].turn == turn;
            (0..groups.len()).filter(is_other).map(|index| &groups[index]).collect()
        };
        let each = of_turn(turn).into_iter().map(|index| restricted_cut(groups, vec![index], &others(&[index]), turn));
        let each: Vec<ProposedCut> = each.collect();
        if each.len() <= RULES_MAX / 2 && each.iter().all(|cut| !cut.is_ambiguous) {
            cuts.extend(each);
        } else {
            let all = of_turn(turn);
            let others = others(&all);
            cuts.push(restricted_cut(groups, all, &others, turn));
        }
    }
    cuts.retain(|cut| !cut.groups.is_empty());
    cuts
}

/// Rule for these groups, restricted as far as needed and possible by N or else by Z.
fn restricted_cut(groups: &[Group], mine: Vec<usize>, others: &[&Group], turn: Turn) -> ProposedCut {
    let numbered = |index: &usize| groups[*index].sequence.filter(|_| groups[*index].unnumbered == 0);
    let sequences: Option<Vec<[i64; 2]>> = mine.iter().map(numbered).collect();
    let sequence = sequences.and_then(|all| Some([all.iter().map(|n| n[0]).min()?, all.iter().map(|n| n[1]).max()?]));
    let depths = || mine.iter().map(|index| groups[*index].depth());
    let depth = depths().map(|z| z[0]).min().zip(depths().map(|z| z[1]).max()).map(|(low, high)| [low, high]);
    let by_number = sequence.filter(|[first, last]| {
        // A block without N does not match a rule that requires one.
        others.iter().all(|other| other.sequence.is_none_or(|[from, to]| are_apart(&(*first..=*last), &(from..=to))))
    });
    let by_depth = depth.filter(|[low, high]| {
        others.iter().map(|other| other.depth()).all(|[from, to]| are_apart(&(*low..=*high), &(from..=to)))
    });
    let is_needed = !others.is_empty();
    ProposedCut {
        rotation: None,
        turn,
        edge: None,
        groups: mine,
        sequence: by_number.filter(|_| is_needed),
        depth: by_depth.filter(|_| is_needed && by_number.is_none()),
        is_ambiguous: is_needed && by_number.is_none() && by_depth.is_none(),
    }
}
