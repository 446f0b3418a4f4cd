//! Largest turn from whose end a straight line leads clear to the next level.
//!
//! The line joins two limit points. Between the levels the limit may bulge inwards: the ring on its way down may cut
//! material that it clears at both ends. A shorter turn on the upper level helps; one no longer than that on the lower
//! level is always clear, for then the line goes straight down, and the ring clears from above what it clears below.
//! With the worst place of the line, at a fraction s of it from above, p deep:
//!
//! ```text
//! turn <- turn - p / (L (1 - s))                                              (1)
//! ```
//!
//! L is the arm of the turn, so that (1) moves the ring back by p there; but never by more than half of the excess over
//! the lower turn.

use crate::vector::{Flat, Point};

use super::patch::Patch;
use super::turn::TurningTool;

/// Fractions of the line that are checked.
const PLACES: [f64; 7] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875];
/// Depth that counts as clear, mm: the line is a chord of the turn, and a side through the pivot would allow none.
const CLEAR_MM: f64 = 0.01;
/// Last step of the search for the deepest place, in distances between samples: the depth it returns is good to its square.
const FINEST: f64 = 1e-3;
/// Number of shortenings after which the lower level's turn is used.
const ROUNDS_MAX: usize = 8;
/// Stride through the samples: every second one in both directions is enough to find the worst place of the line.
const STRIDE: usize = 2;

/// Lower end of the line from one level to the next: the position in which the tool begins that level.
#[derive(Clone, Copy, Debug)]
pub struct LowerEnd {
    /// Centre of the tool, seen along its axis.
    pub centre: Flat,
    /// Height of the tool's bottom, mm.
    pub bottom_mm: f64,
    /// Angle of the turn about the pivot at that position, rad.
    pub turn_rad: f64,
}

/// Largest angle of a turn, rad, at most `turn_rad`, from whose end a straight line leads down to `below` without touching `walls`.
pub fn shortened_rad(turning: &TurningTool<'_>, turn_rad: f64, below: &LowerEnd, walls: &[&Patch]) -> f64 {
    let arm_mm = (turning.centre - turning.pivot).norm();
    let mut turn_rad = turn_rad;
    for _ in 0..ROUNDS_MAX {
        if turn_rad <= below.turn_rad {
            break;
        }
        let line = Line { turning, from: turning.centre_after(turn_rad), below };
        let (share, deep_mm) = line.worst(walls);
        if deep_mm <= CLEAR_MM {
            return turn_rad;
        }
        let back_rad = deep_mm / (arm_mm * (1.0 - share)); // (1)
        turn_rad = (turn_rad - back_rad).max((turn_rad + below.turn_rad) / 2.0);
    }
    turn_rad.min(below.turn_rad)
}

struct Line<'l> {
    turning: &'l TurningTool<'l>,
    from: Flat,
    below: &'l LowerEnd,
}

impl Line<'_> {
    /// Fraction of the line at which the ring is deepest in a wall, and that depth.
    fn worst(&self, walls: &[&Patch]) -> (f64, f64) {
        let mut worst = (PLACES[0], f64::NEG_INFINITY);
        for wall in walls {
            // A wall none of whose samples is nearer is nowhere touched; no sample is farther from one of these than the mesh.
            let near_mm = CLEAR_MM + wall.mesh_mm();
            let may_be_near = |point: &&Point| self.least_gap_mm(point) <= near_mm + wall.mesh_mm();
            let points: Vec<&Point> = wall.thinned(STRIDE).filter(may_be_near).collect();
            if points.is_empty() {
                continue;
            }
            let roughly = PLACES.map(|share| {
                let gaps = points.iter().map(|point| self.gap_mm(share, point));
                (share, gaps.fold(f64::INFINITY, f64::min))
            });
            let (share, _) = roughly.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((PLACES[0], 0.0));
            let least = wall.least_to(FINEST, near_mm, |point| self.gap_mm(share, point));
            if let Some(least) = least.filter(|least| -least.value > worst.1) {
                worst = (share, -least.value);
            }
        }
        worst
    }

    /// Lower limit of the ring's distance from a point, on the whole line: from the ring's straight walls, or its bottom.
    fn least_gap_mm(&self, point: &Point) -> f64 {
        let cutter = self.turning.cutter;
        let half = (self.below.centre - self.from) / 2.0;
        let (off_mm, reach_mm) = ((point.xy() - (self.from + half)).norm(), half.norm());
        let aside_mm = (off_mm - cutter.outer_radius_mm).max(cutter.inner_radius_mm - off_mm) - reach_mm;
        aside_mm.max(self.below.bottom_mm.min(self.turning.bottom_mm) - point.z)
    }

    fn gap_mm(&self, share: f64, point: &Point) -> f64 {
        let centre = self.from + (self.below.centre - self.from) * share;
        let bottom_mm = self.turning.bottom_mm + (self.below.bottom_mm - self.turning.bottom_mm) * share;
        self.turning.cutter.ring_distance_mm((point.xy() - centre).norm(), point.z - bottom_mm)
    }
}
