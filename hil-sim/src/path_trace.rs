//! Path of a run with the values along it, reduced to few points: a new point is stored when the block changes, when the path leaves a
//! straight line by more than a tolerance, or when a value has changed.
//!
//! A run of any length has a bounded number of points: if there are too many, those that follow the one before too
//! soon are merged into the next, and the largest chip load and feed stay.

use arcfeed_control::action::MoveContext;
use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::vector::{Vector, difference};
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{Micros, Nm, S_PER_MIN};

use crate::removal::placement::{UP, WorkpiecePlacement};
use crate::removal::trail::{AxisPosition, off_mm};
use crate::simulated_machine::{STEP, SimulatedMachine};

/// Most points of a run.
const POINTS_MAX: usize = 1 << 18;

/// Largest distance of the executed path from the straight line between two points.
const TOLERANCE_MM: f64 = 5e-3;

/// Relative change of feed or chip load that begins another interval.
const CHANGE_RATIO: f64 = 1e-2;

/// Longest interval.
const INTERVAL_MAX: Micros = Micros::from_ms(250);

/// Component of the axis at the end of an interval along that at its beginning: 1 degree.
const SAME_AXIS_RATIO: f64 = 0.999_847_7;

/// Positions that are compared with the straight line; if there are more, every second one is left out.
const COMPARED_MAX: usize = 32;

/// Point of the tool's path, with the values on the way from the preceding point to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracePoint {
    /// Machine time at the point.
    pub at: Micros,
    /// X, Y, Z of the tool's tip in the workpiece's coordinates.
    pub position_mm: [f64; 3],
    /// Unit vector from the tip towards the holder.
    pub axis: [f64; 3],
    /// Tool in the spindle.
    pub tool: ToolInSpindle,
    /// Number of blocks executed then, including the block in execution.
    pub block: u32,
    /// The move is a rapid.
    pub is_rapid: bool,
    /// Feed along the path, mm/min.
    pub feed_mm_per_min: f64,
    /// Measured chip load divided by its target; `None` without a measurement.
    pub chip_ratio: Option<f64>,
    /// Override that the control uses, %.
    pub percent: u8,
}

/// Tool path of a run, to be shown.
#[derive(Debug)]
pub struct PathTrace {
    points: Vec<TracePoint>,
    points_max: usize,
    /// Machine that turns the part or the tool, and the part on it.
    machine: Option<Machine>,
    placement: WorkpiecePlacement,
    /// Rotary axes a period ago, degrees.
    rotary_deg: Option<[f64; 3]>,
    /// Shortest time between two points.
    interval_min: Micros,
    /// Last period, with the values of its interval.
    open: Option<TracePoint>,
    /// Least feed in its interval: the point keeps the largest.
    least_mm_per_min: f64,
    /// Positions since the last point.
    passed: Vec<[f64; 3]>,
    /// Upper bound of their distances from the chord to the last of them.
    off_max_mm: f64,
}

impl Default for PathTrace {
    fn default() -> Self {
        PathTrace::new(POINTS_MAX)
    }
}

impl PathTrace {
    fn new(points_max: usize) -> Self {
        PathTrace {
            points: Vec::new(),
            points_max,
            machine: None,
            placement: WorkpiecePlacement::default(),
            rotary_deg: None,
            interval_min: Micros(0),
            open: None,
            least_mm_per_min: 0.0,
            passed: Vec::new(),
            off_max_mm: 0.0,
        }
    }

    /// Lets the trace follow the part on the tables of this machine, whose rotary axes turn it.
    pub fn follow(&mut self, machine: Option<Machine>) {
        self.machine = machine;
    }

    /// Records the millisecond that the simulation has just executed.
    pub fn observe(&mut self, simulation: &SimulatedMachine) {
        let (now, control) = (simulation.now(), simulation.control());
        let active = control.active().map(|(block, _)| block);
        // A pause between two moves belongs to the block before it.
        let Some(block) = active.or(self.open.map(|open| open.block)) else { return };
        let segment = simulation.segment().filter(|_| active.is_some());
        if self.open.is_none() {
            self.begin(now, block, segment);
        }
        let was_rapid = self.open.is_some_and(|open| open.is_rapid);
        let is_rapid = segment.map_or(was_rapid, |segment| segment.path == Path::Rapid);
        let (axes, context) = (control.actual_axes(), simulation.context());
        let (position_mm, axis) = self.pose(&axes, context, !is_rapid && segment.is_some());
        self.add(TracePoint {
            at: now,
            position_mm,
            axis,
            tool: context.machining.tool,
            block,
            is_rapid,
            feed_mm_per_min: if segment.is_some() { control.speed_mm_per_s() * S_PER_MIN } else { 0.0 },
            chip_ratio: simulation.meter().last_ratio().filter(|_| segment.is_some() && !is_rapid),
            percent: control.override_percent(),
        });
    }

    /// Tip and axis in the workpiece's coordinates: with rotary axes on the part as it is at its first cut.
    fn pose(&mut self, axes: &AxisPosition, context: &MoveContext, cuts: bool) -> ([f64; 3], [f64; 3]) {
        let rotary_deg = [axes[3], axes[4], axes[5]];
        let stands = self.rotary_deg.replace(rotary_deg) == Some(rotary_deg);
        if let Some(machine) = &self.machine {
            let mut tip = *axes;
            tip[2] -= context.tool.to_mm();
            if cuts {
                self.placement.locate_at(&tip, context, stands);
            }
            if let Some(pose) = self.placement.pose(&tip, context, machine) {
                return (pose.tip_mm, pose.axis);
            }
        }
        let origin = context.origin.linear.map(Nm::to_mm);
        ([0, 1, 2].map(|axis: usize| axes[axis] - origin[axis]), UP)
    }

    /// Completes the path at the end of the run.
    pub fn end(&mut self) {
        self.close();
    }

    /// Last millisecond observed, on the part; `None` before the first move, and without a machine.
    pub fn on_part(&self) -> Option<&TracePoint> {
        self.open.as_ref().filter(|_| self.machine.is_some())
    }

    /// Points in the order of time; complete after [`PathTrace::end`].
    pub fn points(&self) -> &[TracePoint] {
        &self.points
    }

    /// Begins where the first move does.
    fn begin(&mut self, now: Micros, block: u32, segment: Option<&Segment>) {
        let position_mm = segment.map_or([0.0; 3], |segment| segment.start.linear.map(Nm::to_mm));
        let at = Micros(now.0.saturating_sub(STEP.0));
        let (feed_mm_per_min, chip_ratio, percent) = (0.0, None, 100);
        let (axis, tool, is_rapid) = (UP, ToolInSpindle::Unstated, true);
        self.push(TracePoint { at, position_mm, axis, tool, block, is_rapid, feed_mm_per_min, chip_ratio, percent });
    }

    fn add(&mut self, next: TracePoint) {
        if let Some(open) = self.open
            && self.continues(&open, &next)
        {
            self.least_mm_per_min = self.least_mm_per_min.min(next.feed_mm_per_min);
            self.open = Some(merged(&open, next));
        } else {
            self.close();
            self.least_mm_per_min = next.feed_mm_per_min;
            self.open = Some(next);
        }
        self.passed.push(next.position_mm);
        if self.passed.len() > COMPARED_MAX {
            let mut index = 0;
            self.passed.retain(|_| {
                index += 1;
                index % 2 == 1
            });
        }
    }

    /// Whether the interval may go on to this period.
    fn continues(&mut self, open: &TracePoint, next: &TracePoint) -> bool {
        let is_near = |a: f64, b: f64| (a - b).abs() <= CHANGE_RATIO * a.abs().max(b.abs());
        let chips_agree = match (open.chip_ratio, next.chip_ratio) {
            (Some(open), Some(next)) => is_near(open, next),
            (open, next) => open.is_some() == next.is_some(),
        };
        let Some(from) = self.points.last().copied() else { return false };
        (open.block, open.is_rapid, open.tool) == (next.block, next.is_rapid, next.tool)
            && from.axis.iter().zip(next.axis).map(|(a, b)| a * b).sum::<f64>() >= SAME_AXIS_RATIO
            && is_near(open.feed_mm_per_min, next.feed_mm_per_min)
            && is_near(self.least_mm_per_min, next.feed_mm_per_min)
            && chips_agree
            && open.percent.abs_diff(next.percent) <= 1
            && next.at.since(from.at) <= INTERVAL_MAX
            && self.is_straight(from.position_mm, next.position_mm)
    }

    /// Whether the way is straight to this position, too.
    fn is_straight(&mut self, from_mm: Vector, next_mm: Vector) -> bool {
        let chord_mm = difference(next_mm, from_mm);
        let off = |passed: &Vector| off_mm(&difference(*passed, from_mm), &chord_mm);
        // Of two chords with one beginning, no point of the one is farther from the other than its end is.
        self.off_max_mm += self.passed.last().map_or(0.0, off);
        if self.off_max_mm > TOLERANCE_MM {
            self.off_max_mm = self.passed.iter().map(off).fold(0.0, f64::max);
        }
        self.off_max_mm <= TOLERANCE_MM
    }

    fn close(&mut self) {
        self.passed.clear();
        self.off_max_mm = 0.0;
        if let Some(open) = self.open.take() {
            self.push(open);
        }
    }

    fn push(&mut self, point: TracePoint) {
        self.points.push(point);
        merge_last(&mut self.points, self.interval_min);
        if self.points.len() >= self.points_max {
            let whole = point.at.since(self.points.first().map_or(point.at, |first| first.at));
            self.interval_min = Micros((2 * whole.0).div_ceil(self.points_max as u64));
            let mut kept = Vec::with_capacity(self.points_max);
            for point in self.points.drain(..) {
                kept.push(point);
                merge_last(&mut kept, self.interval_min);
            }
            self.points = kept;
        }
    }
}

/// Merges the last but one point into the last one if it follows the one before it too soon.
fn merge_last(points: &mut Vec<TracePoint>, interval_min: Micros) {
    let [.., before, short, last] = points.as_slice() else { return };
    if short.at.since(before.at) < interval_min {
        let last = merged(short, *last);
        points.truncate(points.len() - 2);
        points.push(last);
    }
}

/// Later point with the values of both: the larger feed and chip load. A rapid has no feed, and does not hide a cut.
fn merged(before: &TracePoint, next: TracePoint) -> TracePoint {
    let largest = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::max);
    TracePoint {
        is_rapid: before.is_rapid && next.is_rapid,
        feed_mm_per_min: match (before.is_rapid, next.is_rapid) {
            (true, false) => next.feed_mm_per_min,
            (false, true) => before.feed_mm_per_min,
            _ => before.feed_mm_per_min.max(next.feed_mm_per_min),
        },
        chip_ratio: largest(before.chip_ratio, next.chip_ratio),
        ..next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(ms: u64, position_mm: [f64; 3], block: u32) -> TracePoint {
        let (feed_mm_per_min, chip_ratio, percent) = (600.0, Some(1.0), 100);
        let at = Micros::from_ms(ms);
        let (axis, tool) = (UP, ToolInSpindle::Unstated);
        TracePoint { at, position_mm, axis, tool, block, is_rapid: false, feed_mm_per_min, chip_ratio, percent }
    }

    fn trace(points_max: usize, points: impl Iterator<Item = TracePoint>) -> Vec<TracePoint> {
        let mut trace = PathTrace::new(points_max);
        points.for_each(|point| trace.add(point));
        trace.end();
        trace.points
    }

    #[test]
    fn a_circle_stays_within_the_tolerance_and_has_few_points() {
        let radius_mm = 20.0;
        let at = |ms: u64| {
            let angle = ms as f64 * 1e-3;
            [radius_mm * libm::cos(angle), radius_mm * libm::sin(angle), 0.0]
        };
        let points = trace(1 << 18, (0..6_283).map(|ms| point(ms, at(ms), 1)));
        let sagitta_mm = |pair: &[TracePoint]| {
            let [a, b] = [pair[0].position_mm, pair[1].position_mm];
            radius_mm - libm::hypot((a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0)
        };
        let largest_mm = points.windows(2).map(sagitta_mm).fold(0.0, f64::max);
        // Chords of the sagitta 0.005 mm: 2 acos(1 - s / r) each.
        let least = std::f64::consts::TAU / (2.0 * libm::acos(1.0 - TOLERANCE_MM / radius_mm));
        let found = format!("{} points for {least:.0}, sagitta {largest_mm:.4} mm", points.len());
        assert!(largest_mm <= TOLERANCE_MM + 1e-9 && (points.len() as f64) < 1.1 * least + 3.0, "{found}");
    }

    #[test]
    fn chords_end_where_a_comparison_of_all_positions_ends_them() {
        let mut at = [0.0; 3];
        let way = (0..5_000).map(|k| {
            let k = f64::from(k);
            let (sin, cos) = libm::sincos(3.0 * libm::sin(2e-3 * k) + 0.4 * libm::sin(3e-2 * k));
            at = [at[0] + 0.05 * cos, at[1] + 0.05 * sin, at[2] + 0.02 * libm::sin(1e-2 * k)];
            at
        });
        let way: Vec<Vector> = way.collect();
        let (mut ends, mut from) = (vec![way[0]], 0);
        for next in 2..way.len() {
            let chord_mm = difference(way[next], way[from]);
            let off = |passed: &Vector| off_mm(&difference(*passed, way[from]), &chord_mm);
            if way[from + 1..next].iter().any(|passed| off(passed) > TOLERANCE_MM) {
                ends.push(way[next - 1]);
                from = next - 1;
            }
        }
        ends.push(way[way.len() - 1]);
        let found = trace(1 << 18, (0..).zip(&way).map(|(ms, at)| point(ms, *at, 1)));
        let found: Vec<Vector> = found.iter().map(|point| point.position_mm).collect();
        assert!(found == ends && found.len() > 100, "{} chords, {} by comparison", found.len(), ends.len());
    }

    #[test]
    fn a_change_of_the_block_and_the_largest_values_are_kept() {
        let mut periods: Vec<TracePoint> =
            (0..100).map(|ms| point(ms, [ms as f64, 0.0, 0.0], 1 + ms as u32 / 50)).collect();
        periods[70].chip_ratio = Some(2.5);
        let points = trace(1 << 18, periods.into_iter());
        let ends: Vec<(u64, u32)> = points.iter().map(|point| (point.at.0 / 1_000, point.block)).collect();
        assert_eq!(ends, [(0, 1), (49, 1), (69, 2), (70, 2), (99, 2)]);
        assert_eq!(points.iter().filter_map(|point| point.chip_ratio).fold(0.0, f64::max), 2.5);
    }

    /// Each millisecond differs from the one before by half of what begins another interval.
    #[test]
    fn the_feed_of_a_point_is_that_of_its_whole_interval_also_on_a_slow_ramp() {
        let feed = |ms: u64| 300.0 * libm::pow(1.005, ms as f64);
        let period = |ms: u64| TracePoint { feed_mm_per_min: feed(ms), ..point(ms, [ms as f64, 0.0, 0.0], 1) };
        let points = trace(1 << 18, (0..200).map(period));
        for pair in points.windows(2) {
            let first = feed(pair[0].at.0 / 1_000 + 1);
            assert!(pair[1].feed_mm_per_min <= 1.0102 * first, "{} after {first}", pair[1].feed_mm_per_min);
        }
    }

    #[test]
    fn a_run_of_any_length_has_a_bounded_number_of_points_and_its_largest_chip() {
        // Another block and another feed each millisecond.
        let period = |ms: u64| TracePoint {
            chip_ratio: Some(if ms == 77_777 { 3.0 } else { 1.0 }),
            ..point(ms, [0.0, ms as f64, (ms % 7) as f64], ms as u32)
        };
        let points = trace(1_000, (0..100_000).map(period));
        assert!((400..1_000).contains(&points.len()), "{} points", points.len());
        assert_eq!(points.last().map(|point| point.at), Some(Micros::from_ms(99_999)));
        assert!(points.windows(2).all(|pair| pair[0].at < pair[1].at));
        assert_eq!(points.iter().filter_map(|point| point.chip_ratio).fold(0.0, f64::max), 3.0);
    }

    #[test]
    fn a_cut_merged_with_a_rapid_keeps_its_feed_and_stays_a_cut() {
        let cut = point(1, [0.0; 3], 1);
        let rapid = TracePoint { is_rapid: true, feed_mm_per_min: 2e4, chip_ratio: None, ..point(2, [1.0; 3], 2) };
        for (before, next) in [(rapid, cut), (cut, rapid)] {
            let merged = merged(&before, next);
            assert_eq!((merged.is_rapid, merged.feed_mm_per_min, merged.chip_ratio), (false, 600.0, Some(1.0)));
        }
        assert!(merged(&rapid, rapid).is_rapid);
    }
}
