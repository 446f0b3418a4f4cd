//! Positions of the machine's axes for CL data: choice between the two solutions of the rotary axes (branches), repairs
//! near poles, and all errors and warnings.

use arcfeed_kinematics::branch_change::Transition;
use arcfeed_kinematics::branch_selection::PathStart;
use arcfeed_kinematics::deviation::PathPoint;
use arcfeed_kinematics::feed::AxisFeed;
use arcfeed_kinematics::forward::{Axes, Setup, ToolPose};
use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::singularity::{RepairLimits, Singularity, ToolEnd};
use arcfeed_kinematics::vector::{difference, length};

use super::cl::Cl;
use super::finding::{Finding, FindingKind};

/// Input of an axis plan: machine, placement of part and tool, limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// Machine kinematics.
    pub machine: Machine,
    /// Placement of part and tool on the machine.
    pub setup: Setup,
    /// Shape of the tool's cutting end, if fast rotation beside a pole is to be repaired; otherwise `None`.
    pub repair: Option<ToolEnd>,
    /// Positions of the rotary axes at the start of the path.
    pub start: PathStart,
    /// Limits above which rotation beside a pole is to be repaired.
    pub limits: RepairLimits,
    /// Distance by which the tool is retracted from the part at a change of branch, mm.
    pub retract_mm: f64,
}

/// Path as positions of the machine's axes, with the errors and warnings found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisPlan {
    /// Positions of all axes at each point; empty if a point cannot be reached.
    pub stops: Vec<PathPoint>,
    /// Errors and warnings, in the order of the lines.
    pub findings: Vec<Finding>,
    /// Total rotation of both rotary axes, degrees: before the repairs, and after them.
    pub travel_deg: [[f64; 2]; 2],
}

impl AxisPlan {
    /// Chooses the positions of the axes for CL data. If points cannot be reached, the result has errors and no
    /// positions.
    pub fn new(cl: &Cl, task: &Task) -> Self {
        let Task { machine, limits, .. } = task;
        let mut poses: Vec<ToolPose> = cl.points.iter().map(|point| point.pose).collect();
        let mut plan = AxisPlan::default();
        let Some(mut course) = plan.select_branches(cl, task, &poses) else { return plan };
        plan.travel_deg = [travel(&course); 2];
        // Without a tool no repair may move the tip.
        let nothing = RepairLimits { error_deg: -1.0, ..*limits };
        let (end, allowed) = task.repair.map_or((ToolEnd::Other, &nothing), |end| (end, limits));
        let found = machine.repair(&mut poses, &course, end, allowed);
        plan.add_singularities(cl, &found, task.repair.is_some());
        if poses.iter().zip(&cl.points).any(|(pose, point)| *pose != point.pose) {
            let Some(again) = plan.select_branches(cl, task, &poses) else { return plan };
            course = again;
            plan.travel_deg[1] = travel(&course);
        }
        plan.stops = poses.iter().zip(&course).map(|(pose, at)| stop(task, pose, *at)).collect();
        plan.check(cl, task, &poses, &course);
        plan.findings.sort_by_key(|finding| finding.line);
        plan
    }

    /// Rotary positions of all points; adds every point out of reach to the findings.
    fn select_branches(&mut self, cl: &Cl, task: &Task, poses: &[ToolPose]) -> Option<Vec<[f64; 2]>> {
        match task.machine.select_branches(poses, task.start) {
            Ok(course) => Some(course),
            Err(whole) => {
                let refusal = |pose: &ToolPose| task.machine.select_branches(std::slice::from_ref(pose), None).err();
                let mut open = false;
                for (point, pose) in cl.points.iter().zip(poses) {
                    match (refusal(pose), self.findings.last_mut()) {
                        (Some(_), Some(Finding { what: FindingKind::Unreachable { more, .. }, .. })) if open => {
                            *more += 1;
                        }
                        (Some(refused), _) => {
                            let what = FindingKind::Unreachable { why: refused.why, more: 0 };
                            self.findings.push(Finding { line: point.line, what });
                            open = true;
                        }
                        (None, _) => open = false,
                    }
                }
                if self.findings.is_empty() {
                    // Each point is within reach, but not from this start.
                    let line = cl.points.get(whole.point).map_or(0, |point| point.line);
                    self.findings.push(Finding { line, what: FindingKind::Unreachable { why: whole.why, more: 0 } });
                }
                None
            }
        }
    }

    fn add_singularities(&mut self, cl: &Cl, found: &[Singularity], asked: bool) {
        // An even movement is only changed on request, and only reported then.
        let reported = found.iter().filter(|interval| asked || interval.is_fault());
        let singularities = reported.filter_map(|interval| {
            let point = cl.points.get(interval.after)?;
            Some(Finding { line: point.line, what: FindingKind::Singularity { found: *interval, asked } })
        });
        self.findings.extend(singularities);
    }

    /// Checks ranges, poles, moves and feeds.
    fn check(&mut self, cl: &Cl, task: &Task, poses: &[ToolPose], course: &[[f64; 2]]) {
        let Task { machine, setup, limits, retract_mm, .. } = task;
        let [first, _] = machine.rotary();
        let mut reported_over = Vec::new();
        for (point, stop) in cl.points.iter().zip(&self.stops) {
            for axis in machine.over_limits(&stop.axes) {
                // An axis that stays outside its range is reported once.
                if !reported_over.contains(&axis) {
                    reported_over.push(axis);
                    self.findings.push(Finding { line: point.line, what: FindingKind::OverLimit(axis) });
                }
            }
            if machine.is_in_pole_cone(stop.pose.axis) {
                self.findings.push(Finding { line: point.line, what: FindingKind::Pole { letter: first.letter } });
            }
        }
        let passages = machine.transitions(poses, course, limits.departure_deg);
        for ((point, passage), pair) in cl.points.iter().skip(1).zip(passages).zip(poses.windows(2)) {
            let what = match (passage, pair) {
                (Transition::Coarse { departure_deg }, _) => FindingKind::Coarse { departure_deg },
                (Transition::Change(change), [last, next]) => FindingKind::Change(
                    change,
                    Box::new(machine.branch_change_moves(&change, [last, next], setup, *retract_mm)),
                ),
                _ => continue,
            };
            self.findings.push(Finding { line: point.line, what });
        }
        let changed: Vec<usize> = self.changes().map(|finding| finding.line).collect();
        self.findings.extend(slowest(cl, task, &self.stops, &changed));
    }

    /// Findings that are changes of branch.
    pub fn changes(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| matches!(finding.what, FindingKind::Change(..)))
    }
}

/// Positions of all axes for a position of the tool, if the rotary axes have these positions, degrees.
pub fn stop(task: &Task, pose: &ToolPose, rotary_deg: [f64; 2]) -> PathPoint {
    let linear_mm = task.machine.linear_for(pose.tip_mm, rotary_deg, &task.setup);
    PathPoint { pose: *pose, axes: Axes { linear_mm, rotary_deg } }
}

/// The move that the axes slow down most, except changes of branch.
fn slowest(cl: &Cl, task: &Task, stops: &[PathPoint], changed: &[usize]) -> Option<Finding> {
    let mut slowed = Vec::new();
    for (pair, point) in stops.windows(2).zip(cl.points.iter().skip(1)) {
        let ([from, to], Some(asked)) = (pair, point.feed_mm_per_min) else { continue };
        if changed.contains(&point.line) {
            continue;
        }
        let way_mm = length(difference(to.pose.tip_mm, from.pose.tip_mm));
        slowed.extend(
            task.machine
                .axis_feed(&from.axes, &to.axes, way_mm)
                .filter(|found| found.feed_mm_per_min < asked)
                .map(|found| (point.line, found, found.feed_mm_per_min / asked)),
        );
    }
    let least = slowed.iter().min_by(|(.., one), (.., other)| one.total_cmp(other));
    let (line, AxisFeed { feed_mm_per_min, axis }, asked_ratio) = *least?;
    let (moves, feed_per_min, unit) = (slowed.len(), feed_mm_per_min, "mm/min");
    Some(Finding { line, what: FindingKind::Feed { moves, feed_per_min, unit, asked_ratio, axis } })
}

fn travel(course: &[[f64; 2]]) -> [f64; 2] {
    let turned = |axis: fn(&[f64; 2]) -> f64| {
        let moves = course.windows(2).map(|pair| if let [from, to] = pair { axis(to) - axis(from) } else { 0.0 });
        moves.map(libm::fabs).sum()
    };
    [turned(|place| place[0]), turned(|place| place[1])]
}
