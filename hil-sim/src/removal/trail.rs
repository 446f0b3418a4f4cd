//! Executed path of the axes as chords, each within a tolerance of all sampled positions.
//!
//! Positions are compared in six coordinates; a rotation counts by the path of the tool's farthest point. A chord ends
//! where a position is farther from it than the tolerance, after a quarter of a second, and where the block changes, so
//! that the material removed along it belongs to one block and a short time.
//!
//! A chord that has been compared with all positions may turn by an angle before the comparison must be repeated: with
//! positions at distance r_k from its beginning, at distance d_k from it, and the tolerance t,
//!
//! ```text
//! angle <= min over k of (t - d_k) / r_k        (1)
//! ```
//!
//! Source: (1) path of a point at r_k under a rotation.

use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{Micros, Nm};

use crate::simulated_machine::SimulatedMachine;
use arcfeed_control::action::MoveContext;
use arcfeed_control::drives::limits::AXES;

/// Longest time of a path section: the resolution of the removal rate.
pub const SECTION_TIME_MAX: Micros = Micros::from_ms(250);

/// Path in a period below which the axes count as standing still.
const STILL_MM: f64 = 1e-9;

/// Largest rotation of a chord: its tool axis takes the shortest path between both ends.
const TURN_MAX_DEG: f64 = 1.0;

/// Position of the tool's tip in machine coordinates: X, Y, Z in mm; A, B, C in degrees.
pub type AxisPosition = [f64; AXES];

/// Reference to a block of the program that has been executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockRef {
    /// Count of blocks executed, this one included.
    pub count: u32,
    /// N of the block; `None` without one.
    pub sequence: Option<i64>,
    /// Index of the job's cut rule for the block; `None` without one.
    pub rule: Option<usize>,
    /// Whether the move is a rapid.
    pub is_rapid: bool,
}

impl BlockRef {
    /// Block in execution, and its move.
    pub(super) fn in_execution(simulation: &SimulatedMachine) -> Option<(Self, &Segment)> {
        simulation.control().active().map(|(count, segment)| {
            let is_rapid = segment.path == Path::Rapid;
            (BlockRef { count, sequence: segment.sequence, rule: simulation.rule(), is_rapid }, segment)
        })
    }
}

/// Sample of the axes at the end of a period.
#[derive(Clone, Copy, Debug)]
pub struct AxisSample {
    /// End of the period.
    pub at: Micros,
    /// Axes in machine coordinates: X, Y, Z in mm, A, B, C in degrees.
    pub axes: [f64; AXES],
    /// Block in execution.
    pub block: BlockRef,
    /// Context of the move in execution.
    pub context: MoveContext,
}

/// Path section: part of the executed path of one block, as chords, up to a quarter of a second.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSection {
    /// Block of the section.
    pub block: BlockRef,
    /// Context of the block's move.
    pub context: MoveContext,
    /// Beginning of the section.
    pub from: Micros,
    /// End of the section.
    pub to: Micros,
    /// Ends of the chords, two or more, in order.
    pub positions: Vec<AxisPosition>,
}

/// Divides the executed path of the axes into path sections.
#[derive(Clone, Debug)]
pub struct Trail {
    tolerance_mm: f64,
    mm_per_deg: f64,
    /// End of the last period.
    last: Option<(Micros, [f64; AXES])>,
    open: Option<PathSection>,
    /// Positions since the last chord's beginning.
    passed: Vec<AxisPosition>,
    checked: Option<Checked>,
}

/// A chord that has been compared with all positions on it.
#[derive(Clone, Copy, Debug)]
struct Checked {
    /// Vector from its beginning, mm.
    path_mm: AxisPosition,
    length_mm: f64,
    /// Remaining angle (1).
    angle_rad: f64,
}

impl Trail {
    /// Empty path. Chords stay within `tolerance_mm`; no point of the tool is farther than `reach_mm` from its tip.
    pub fn new(tolerance_mm: f64, reach_mm: f64) -> Self {
        Trail {
            tolerance_mm,
            mm_per_deg: reach_mm.to_radians(),
            last: None,
            open: None,
            passed: Vec::new(),
            checked: None,
        }
    }

    /// Adds a sample; returns the section that it completes.
    pub fn add(&mut self, sample: &AxisSample) -> Option<PathSection> {
        let (before, axes) = self.last.replace((sample.at, sample.axes))?;
        let (from, to) = (at_tip(&axes, &sample.context), at_tip(&sample.axes, &sample.context));
        if self.distance_mm(&from, &to) <= STILL_MM {
            return self.end();
        }
        let is_over = self.open.as_ref().is_some_and(|open| {
            open.block != sample.block || open.context != sample.context || before.since(open.from) >= SECTION_TIME_MAX
        });
        let over = if is_over { self.end() } else { None };
        let is_on_chord = self.is_on_chord(&to);
        let open = self.open.get_or_insert_with(|| PathSection {
            block: sample.block,
            context: sample.context,
            from: before,
            to: before,
            positions: vec![from],
        });
        if !is_on_chord {
            open.positions.extend(self.passed.last());
            self.passed.clear();
            self.checked = None;
        }
        open.to = sample.at;
        self.passed.push(to);
        over
    }

    /// Completes the section in progress; `None` without one.
    pub fn end(&mut self) -> Option<PathSection> {
        let mut over = self.open.take()?;
        over.positions.extend(self.passed.last());
        self.passed.clear();
        self.checked = None;
        Some(over)
    }

    /// Whether a chord to this position would be near enough to all positions on it.
    fn is_on_chord(&mut self, to: &AxisPosition) -> bool {
        let Some(from) = self.open.as_ref().and_then(|open| open.positions.last().copied()) else { return true };
        if (3..AXES).any(|axis| (to[axis] - from[axis]).abs() > TURN_MAX_DEG) {
            return false;
        }
        let path_mm = self.path_mm(&from, to);
        let length_mm = length(&path_mm);
        if let Some(checked) = &mut self.checked {
            let along = dot(&checked.path_mm, &path_mm) / (checked.length_mm * length_mm);
            let off_mm = length_mm * libm::sqrt((1.0 - along * along).max(0.0));
            let turn_max_mm = (checked.angle_rad * length_mm * along).min(self.tolerance_mm);
            if length_mm >= checked.length_mm && off_mm <= turn_max_mm {
                checked.angle_rad = checked.angle_rad.min((self.tolerance_mm - off_mm) / length_mm); // (1)
                return true;
            }
        }
        let mut angle_rad = f64::INFINITY;
        for position in &self.passed {
            let arm_mm = self.path_mm(&from, position);
            angle_rad = angle_rad.min((self.tolerance_mm - off_mm(&arm_mm, &path_mm)) / length(&arm_mm)); // (1)
        }
        self.checked = Some(Checked { path_mm, length_mm, angle_rad });
        angle_rad >= 0.0
    }

    fn distance_mm(&self, from: &AxisPosition, to: &AxisPosition) -> f64 {
        length(&self.path_mm(from, to))
    }

    fn path_mm(&self, from: &AxisPosition, to: &AxisPosition) -> AxisPosition {
        std::array::from_fn(|axis| (to[axis] - from[axis]) * if axis < 3 { 1.0 } else { self.mm_per_deg })
    }
}

impl PathSection {
    /// Length of the tip's path, mm.
    pub fn path_mm(&self) -> f64 {
        let chord = |pair: &[AxisPosition]| {
            libm::sqrt((0..3).map(|axis| (pair[1][axis] - pair[0][axis]) * (pair[1][axis] - pair[0][axis])).sum())
        };
        self.positions.windows(2).map(chord).sum()
    }

    /// Largest rotation of any rotary axis within the section, degrees.
    pub fn turn_deg(&self) -> f64 {
        let turn = |position: &AxisPosition| {
            (3..AXES).map(|axis| (position[axis] - self.positions[0][axis]).abs()).fold(0.0, f64::max)
        };
        self.positions.iter().map(turn).fold(0.0, f64::max)
    }
}

fn dot<const N: usize>(v: &[f64; N], w: &[f64; N]) -> f64 {
    v.iter().zip(w).map(|(a, b)| a * b).sum()
}

fn length<const N: usize>(v: &[f64; N]) -> f64 {
    libm::sqrt(dot(v, v))
}

/// Distance of the end of a vector from a chord that begins with it.
pub(crate) fn off_mm<const N: usize>(arm_mm: &[f64; N], path_mm: &[f64; N]) -> f64 {
    let square = dot(path_mm, path_mm);
    let part = if square > 0.0 { (dot(arm_mm, path_mm) / square).clamp(0.0, 1.0) } else { 0.0 };
    let off: [f64; N] = std::array::from_fn(|axis| arm_mm[axis] - part * path_mm[axis]);
    length(&off)
}

/// Position of the tool's tip for these axes, with the tool of a move.
pub(super) fn at_tip(axes: &[f64; AXES], context: &MoveContext) -> AxisPosition {
    let mut position = *axes;
    position[2] -= Nm::to_mm(context.tool);
    position
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(ms: u64, x: f64, y: f64, count: u32) -> AxisSample {
        let block = BlockRef { count, sequence: None, rule: None, is_rapid: false };
        AxisSample { at: Micros::from_ms(ms), axes: [x, y, 0.0, 0.0, 0.0, 0.0], block, context: MoveContext::default() }
    }

    fn sections(ways: impl IntoIterator<Item = AxisSample>) -> Vec<PathSection> {
        let mut trail = Trail::new(0.01, 10.0);
        let mut over: Vec<PathSection> = ways.into_iter().filter_map(|sample| trail.add(&sample)).collect();
        over.extend(trail.end());
        over
    }

    #[test]
    fn a_line_is_one_chord_for_a_quarter_of_a_second() {
        let over = sections((0..=600).map(|ms| sample(ms, ms as f64 * 0.01, 0.0, 1)));
        let spans: Vec<(u64, u64, usize)> = over.iter().map(|s| (s.from.0, s.to.0, s.positions.len())).collect();
        assert_eq!(spans, [(0, 250_000, 2), (250_000, 500_000, 2), (500_000, 600_000, 2)]);
    }

    #[test]
    fn chords_of_an_arc_pass_within_the_tolerance_and_meet() {
        let way = |ms: u64| (20.0 * libm::cos(ms as f64 * 1e-3), 20.0 * libm::sin(ms as f64 * 1e-3));
        let over = sections((0..=1000).map(|ms| sample(ms, way(ms).0, way(ms).1, 1)));
        for pair in over.iter().flat_map(|section| section.positions.windows(2)) {
            let middle = libm::hypot((pair[0][0] + pair[1][0]) / 2.0, (pair[0][1] + pair[1][1]) / 2.0);
            assert!((0.0..=0.0101).contains(&(20.0 - middle)), "{middle}");
        }
        for pair in over.windows(2) {
            assert_eq!(pair[0].positions.last(), pair[1].positions.first());
        }
        let chords: usize = over.iter().map(|section| section.positions.len() - 1).sum();
        // sqrt(8 * 0.01 / 20) rad a chord.
        assert!((16..=20).contains(&chords), "{chords}");
    }

    #[test]
    fn a_section_ends_with_its_block_and_where_the_axes_stop() {
        let over = sections([
            sample(0, 0.0, 0.0, 1),
            sample(1, 1.0, 0.0, 1),
            sample(2, 2.0, 0.0, 2),
            sample(3, 2.0, 0.0, 2),
            sample(4, 3.0, 0.0, 2),
            sample(5, 3.0, 1.0, 2),
        ]);
        let ways: Vec<(u32, u64, u64, usize)> =
            over.iter().map(|s| (s.block.count, s.from.0 / 1000, s.to.0 / 1000, s.positions.len())).collect();
        assert_eq!(ways, [(1, 0, 1, 2), (2, 1, 2, 2), (2, 3, 5, 3)]);
        let (path_mm, turn_deg) = (over[2].path_mm(), over[2].turn_deg());
        assert!((path_mm - 2.0).abs() < 1e-12 && turn_deg == 0.0);
    }
}
