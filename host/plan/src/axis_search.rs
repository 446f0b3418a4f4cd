//! Search for the directions of the tool in which a path removes most from a slot: on a grid, then about the best places of it in ever
//! smaller steps.
//!
//! If the ring does not pass over the whole depth, the lowest parts of the sides are left out until it does.

use crate::cup_mill::free_width::{DirectionGrid, FreeWidth, LEAN_MAX_RAD, LEAN_STEP_RAD, leans};
use crate::cup_mill::plan::{PreparedSlot, ValuedPlan};
use crate::cup_mill::side::EIGHTHS;
use crate::cutter::CupMill;
use crate::parallel;

/// One combination of start edge, tool direction and depth that the search has tried, with its plan.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Index of the edges from which the path starts: 0 for the leading, 1 for the trailing edges.
    pub edge: usize,
    /// Direction of the tool, with the free width on both sides of the ring between the blades.
    pub free_width: FreeWidth,
    /// Number of the eighths of the blades' height, from the hub up, beside which the ring does not pass; they stay uncut.
    pub uncut_eighths: usize,
    /// Plan, with the fraction of the slot that it removes.
    pub valued: ValuedPlan,
    /// Lean and tilt, as coordinates of the search.
    at: [f64; 2],
}

impl Candidate {
    fn share_ratio(&self) -> f64 {
        self.valued.share_ratio
    }
}

/// Number of places of the grid about which the search goes on.
const STARTS: usize = 4;
/// Least step about a place.
const STEP_MIN_RAD: f64 = LEAN_STEP_RAD / 16.0;
/// Most steps from a place of the grid.
const ROUNDS_MAX: usize = 9;
/// Least distance of places about which the search goes on, in steps of the grid.
const APART_STEPS: f64 = 1.5;
/// Places that are nearer are the same.
const SAME_RAD: f64 = 1e-9;
/// Steps about a place.
const AROUND: [[f64; 2]; 8] =
    [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]];

/// Search for the best direction of the tool, over all directions and both start edges.
pub struct AxisSearch<'s> {
    /// The slot prepared for paths from its leading and from its trailing edges.
    pub prepared: &'s [PreparedSlot; 2],
    /// Cutter.
    pub cutter: &'s CupMill,
    /// First step about the best places of the grid; it is halved while nothing better is found.
    pub step_rad: f64,
    /// Function that returns a plan with the fraction that it removes, by index of the start edges, tool direction and the uncut eighths of the
    /// blades' height (from the hub up); `None` if there is no plan.
    pub value: &'s (dyn Fn(usize, FreeWidth, usize) -> Option<ValuedPlan> + Sync),
}

impl AxisSearch<'_> {
    /// Best directions, at a minimum distance from each other.
    pub fn best(&self) -> Vec<Candidate> {
        // Every second place, as on a chessboard.
        let grid = || leans().step_by(2);
        let places: Vec<(usize, [f64; 2])> = (0..2).flat_map(|edge| grid().map(move |at| (edge, at))).collect();
        let found = parallel::filter_map(&places, &|(edge, at)| self.candidate(*edge, *at));
        let starts = apart(found, STARTS);
        apart(parallel::map(&starts, &|start| self.refined(start.clone())), STARTS)
    }

    /// Directions that another search has found, by the values of this one, and first what is found about the best of them.
    pub fn near(&self, starts: &[Candidate]) -> Vec<Candidate> {
        let valued = |start: &Candidate| {
            let valued = (self.value)(start.edge, start.free_width, start.uncut_eighths)?;
            Some(Candidate { valued, ..start.clone() })
        };
        let mut valued = apart(parallel::filter_map(starts, &valued), STARTS);
        let refined = valued.first().map(|best| self.refined(best.clone()));
        valued.splice(0..0, refined);
        valued
    }

    /// Direction at a place, with as little of the sides left out as possible.
    fn candidate(&self, edge: usize, at: [f64; 2]) -> Option<Candidate> {
        let prepared = &self.prepared[edge];
        let direction = DirectionGrid::new(prepared.walls(0))?.direction(at);
        let free_width = |uncut_eighths: usize| {
            prepared.walls(uncut_eighths).free_width(self.cutter, &direction).filter(|width| width.per_side_mm > 0.0)
        };
        let (mut short, mut passed) = (0, EIGHTHS - 1);
        let mut found = free_width(0).map(|width| (width, 0));
        if found.is_none() {
            found = Some((free_width(passed)?, passed));
            while passed - short > 1 {
                let middle = (short + passed) / 2;
                match free_width(middle) {
                    Some(width) => (found, passed) = (Some((width, middle)), middle),
                    None => short = middle,
                }
            }
        }
        let (free_width, uncut_eighths) = found?;
        let valued = (self.value)(edge, free_width, uncut_eighths)?;
        Some(Candidate { edge, free_width, uncut_eighths, valued, at })
    }

    fn refined(&self, start: Candidate) -> Candidate {
        // None of these is better than the best one.
        let mut tried = vec![start.at];
        let mut best = start;
        let mut step = self.step_rad;
        for _ in 0..ROUNDS_MAX {
            let places =
                AROUND.map(|by| [0, 1].map(|k: usize| (best.at[k] + by[k] * step).clamp(-LEAN_MAX_RAD, LEAN_MAX_RAD)));
            let is_new = |at: &[f64; 2]| !tried.iter().any(|other| distance_rad(at, other) < SAME_RAD);
            let places: Vec<[f64; 2]> = places.into_iter().filter(is_new).collect();
            let around = parallel::filter_map(&places, &|at| self.candidate(best.edge, *at));
            tried.extend(places);
            let nearest = around.into_iter().max_by(|a, b| a.share_ratio().total_cmp(&b.share_ratio()));
            match nearest.filter(|near| near.share_ratio() > best.share_ratio()) {
                Some(better) => best = better,
                None if step <= STEP_MIN_RAD => break,
                None => step /= 2.0,
            }
        }
        best
    }
}

/// Largest of the differences in lean and tilt.
fn distance_rad(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The `count` best candidates that are not near to better ones.
fn apart(mut candidates: Vec<Candidate>, count: usize) -> Vec<Candidate> {
    candidates.sort_by(|a, b| b.share_ratio().total_cmp(&a.share_ratio()));
    let mut kept: Vec<Candidate> = Vec::new();
    for one in candidates {
        let is_near = |other: &Candidate| {
            one.edge == other.edge && distance_rad(&one.at, &other.at) < APART_STEPS * LEAN_STEP_RAD
        };
        if kept.len() < count && !kept.iter().any(is_near) {
            kept.push(one);
        }
    }
    kept
}
