//! Check of an NC program for a five-axis machine, before the first cut.
//!
//! The program gives the positions of the rotary axes, so that no branch has to be chosen. The check covers ranges,
//! poles, changes of branch, fast turns beside a pole, and feeds.

use arcfeed_kinematics::feed::AxisFeed;
use arcfeed_kinematics::forward::ToolPose;
use arcfeed_kinematics::inverse::Angles;
use arcfeed_kinematics::machine::{AxisName, Letter, Machine};
use arcfeed_kinematics::singularity::{RepairLimits, ToolEnd};
use arcfeed_kinematics::vector::wrapped_deg;
use arcfeed_nc::modal::{Feed, PER_MIN_SCALE};
use arcfeed_nc::segment::Path;
use arcfeed_units::MicroDeg;

use super::finding::{Finding, FindingKind};
use super::plan::{AxisPlan, Task};
use super::walk::{Move, walk};
use crate::program::Program;

/// Least number of places of a move at which the search for the one nearest to a pole begins.
const PLACES_MIN: f64 = 16.0;
/// Slack of a limit, for the last digit of an F and of the limit.
const SLACK_RATIO: f64 = 2e-3;
/// Steps of the search about the nearest place; each leaves two thirds of the interval.
const STEPS: usize = 40;

/// Checks a program without errors on a machine. The plan that it returns has findings and the total rotation of the
/// rotary axes, but no axis positions; the second value is the number of moves.
pub fn check_program(program: &Program, task: &Task) -> (AxisPlan, usize) {
    let moves = walk(program, &task.machine, &task.setup);
    let mut check_program =
        Checker { task, plan: AxisPlan::default(), reported_over: Vec::new(), reported_missing: Vec::new() };
    for step in &moves {
        check_program.ranges(step);
        if step.is_continuous {
            check_program.rotary(step);
        }
    }
    check_program.racing(&moves);
    check_program.plan.findings.extend(slowest(&task.machine, &moves));
    check_program.plan.findings.sort_by_key(|finding| finding.line);
    let turned = |axis: usize| {
        moves.iter().filter(|step| step.is_continuous).map(move |step| libm::fabs(step.turned_deg()[axis]))
    };
    check_program.plan.travel_deg = [[0, 1].map(|axis| turned(axis).fold(0.0, |sum, deg| sum + deg)); 2];
    (check_program.plan, moves.len())
}

struct Checker<'t> {
    task: &'t Task,
    plan: AxisPlan,
    reported_over: Vec<AxisName>,
    reported_missing: Vec<Letter>,
}

impl Checker<'_> {
    fn add(&mut self, line: usize, what: FindingKind) {
        self.plan.findings.push(Finding { line, what });
    }

    /// Finds axes that leave their ranges, each once, and axes that the machine lacks.
    fn ranges(&mut self, step: &Move) {
        let machine = &self.task.machine;
        for place in step.places(machine).iter().skip(1) {
            for axis in machine.over_limits(place) {
                if !self.reported_over.contains(&axis) {
                    self.reported_over.push(axis);
                    self.add(step.made.line, FindingKind::OverLimit(axis));
                }
            }
        }
        let turns =
            step.made.segment.start.rotary.iter().zip(&step.made.segment.end.rotary).map(|(from, to)| from != to);
        for (letter, _) in Letter::ALL.into_iter().zip(turns).filter(|(_, turns)| *turns) {
            let has = machine.rotary().iter().any(|axis| axis.letter == letter);
            if !has && !self.reported_missing.contains(&letter) {
                self.reported_missing.push(letter);
                self.add(step.made.line, FindingKind::NoAxis(letter));
            }
        }
    }

    /// Finds poles and changes of branch.
    fn rotary(&mut self, step: &Move) {
        let Task { machine, limits, .. } = self.task;
        let [from, to] = [0.0, 1.0].map(|part| step.rotary_at(part));
        if from == to {
            return;
        }
        let [first, _] = machine.rotary();
        if !in_cone(machine, from) && least_from_pole_deg(machine, step) <= machine.pole_cone_deg() {
            self.add(step.made.line, FindingKind::Passage { letter: first.letter });
        }
        let departure_deg = machine.axis_departure_deg(from, to, [from, to].map(|at| machine.axis_at(at)));
        let changes = matches!((branch(machine, from), branch(machine, to)), (Some(one), Some(other)) if one != other);
        if step.is_cut() && changes && departure_deg > limits.departure_deg {
            self.add(step.made.line, FindingKind::Reversal { from_deg: from, to_deg: to, departure_deg });
        }
    }

    /// Finds intervals of cutting moves on which the first rotary axis turns fast beside a pole.
    fn racing(&mut self, moves: &[Move]) {
        let Task { machine, limits, .. } = self.task;
        // No move is allowed: the tool is unknown.
        let nothing = RepairLimits { error_deg: -1.0, ..*limits };
        let is_beside = |step: &&Move| {
            let ends = [step.rotary_at(0.0), step.rotary_at(1.0)];
            step.is_cut() && step.is_continuous && !ends.iter().any(|at| in_cone(machine, *at))
        };
        let mut rest = moves;
        while !rest.is_empty() {
            let run: Vec<&Move> = rest.iter().take_while(is_beside).collect();
            let starts = run.first().map(|step| step.rotary_at(0.0));
            let course: Vec<[f64; 2]> = starts.into_iter().chain(run.iter().map(|step| step.rotary_at(1.0))).collect();
            let pose = |at: &[f64; 2]| ToolPose { tip_mm: [0.0; 3], axis: machine.axis_at(*at) };
            let mut poses: Vec<ToolPose> = course.iter().map(pose).collect();
            for found in machine.repair(&mut poses, &course, ToolEnd::Other, &nothing) {
                if !found.is_fault() {
                    continue;
                }
                let line = run.get(found.after.saturating_sub(1)).map_or(0, |step| step.made.line);
                self.add(line, FindingKind::Singularity { found, asked: false });
            }
            rest = rest.get(run.len().max(1)..).unwrap_or_default();
        }
    }
}

fn in_cone(machine: &Machine, rotary_deg: [f64; 2]) -> bool {
    machine.is_in_pole_cone(machine.axis_at(rotary_deg))
}

/// Branch of the two angle pairs for a direction in which the axes stand; `None` if there is only one.
fn branch(machine: &Machine, rotary_deg: [f64; 2]) -> Option<bool> {
    let Angles::Two([one, other]) = machine.angles(machine.axis_at(rotary_deg)) else { return None };
    let off = |angles: [f64; 2]| libm::fabs(wrapped_deg(angles[1] - rotary_deg[1]));
    Some(off(one) <= off(other))
}

/// Least angle between tool axis and pole on a move.
fn least_from_pole_deg(machine: &Machine, step: &Move) -> f64 {
    let from_pole = |part: f64| machine.from_pole_deg(machine.axis_at(step.rotary_at(part)));
    let [first, second] = step.turned_deg().map(libm::fabs);
    let places = libm::ceil(first.max(second)).max(PLACES_MIN);
    let nearest = (0..=places as u32).map(|place| f64::from(place) / places);
    let nearest = nearest.min_by(|one, other| from_pole(*one).total_cmp(&from_pole(*other))).unwrap_or(0.0);
    let (mut low, mut high) = ((nearest - 1.0 / places).max(0.0), (nearest + 1.0 / places).min(1.0));
    for _ in 0..STEPS {
        let third = (high - low) / 3.0;
        if from_pole(low + third) < from_pole(high - third) { high -= third } else { low += third }
    }
    from_pole(0.5 * (low + high)).min(from_pole(nearest))
}

/// The move that the axes slow down most.
fn slowest(machine: &Machine, moves: &[Move]) -> Option<Finding> {
    let cuts = moves.iter().filter(|step| step.is_cut() && step.is_continuous);
    let mut slowed = Vec::new();
    for step in cuts {
        let Some((allowed, way, unit)) = allowed(machine, step) else { continue };
        let asked = match step.made.segment.feed {
            Feed::PerMinute(feed) => feed.to_mm(),
            Feed::InverseTime(times) => times as f64 / PER_MIN_SCALE as f64 * way,
            Feed::Missing => continue,
        };
        if allowed.feed_mm_per_min < asked * (1.0 - SLACK_RATIO) {
            slowed.push((step.made.line, allowed, allowed.feed_mm_per_min / asked, unit));
        }
    }
    let (line, AxisFeed { feed_mm_per_min, axis }, asked_ratio, unit) =
        *slowed.iter().min_by(|one, other| one.2.total_cmp(&other.2))?;
    let what = FindingKind::Feed { moves: slowed.len(), feed_per_min: feed_mm_per_min, unit, asked_ratio, axis };
    Some(Finding { line, what })
}

/// Largest feed on a move, the length that it refers to, and the unit of both: degrees if only rotary axes turn.
fn allowed(machine: &Machine, step: &Move) -> Option<(AxisFeed, f64, &'static str)> {
    let way_mm = step.made.segment.feed_length_mm();
    if way_mm > 0.0 {
        let feed = match step.of_tip() {
            Some(tip) => machine.tip_feed(&tip, &step.setup)?,
            None => along_places(machine, step, way_mm)?,
        };
        return Some((feed, way_mm, "mm/min"));
    }
    let Path::Line = step.made.segment.path else { return None };
    let turns = step.made.segment.start.rotary.iter().zip(&step.made.segment.end.rotary);
    let turned = turns.map(|(from, to)| MicroDeg(to.0.saturating_sub(from.0)).to_deg());
    let way_deg = libm::sqrt(turned.map(|deg| deg * deg).sum());
    let places = step.places(machine);
    Some((machine.axis_feed(places.first()?, places.last()?, way_deg)?, way_deg, "deg/min"))
}

/// Least of the allowed feeds at the places of a move.
fn along_places(machine: &Machine, step: &Move, way_mm: f64) -> Option<AxisFeed> {
    let places = step.places(machine);
    let part_mm = way_mm / (places.len() - 1) as f64;
    let pairs = places.windows(2).filter_map(|pair| machine.axis_feed(pair.first()?, pair.last()?, part_mm));
    pairs.min_by(|one, other| one.feed_mm_per_min.total_cmp(&other.feed_mm_per_min))
}
