//! Plan of finishing passes with its proof, its feeds, and the positions of the machine's axes.

use arcfeed_kinematics::branch_selection::PathStart;
use arcfeed_kinematics::forward::ToolPose;
use arcfeed_kinematics::linearise::Tolerance;
use arcfeed_kinematics::singularity::RepairLimits;
use arcfeed_kinematics::tip_feed::TipMove;
use arcfeed_plan::finish::access::{BladeAccess, FinishMove, MoveKind};
use arcfeed_plan::finish::feed::ContactFeed;
use arcfeed_plan::finish::mill::FinishPart as MillPart;
use arcfeed_plan::finish::obstacles::{FinishObstacle, obstacles};
use arcfeed_plan::finish::plan::{FinishPlan, Planner};
use arcfeed_plan::finish::proof::{FinishClearance, FinishProof};
use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::geometry::flaws::flaws;

use crate::part::finish::FinishPart;
use crate::post::cl::{Cl, ClPoint};
use crate::post::plan::{AxisPlan, Task};
use crate::program::Severity;

/// Largest deviation of the straight blocks of the program from the planned path: of the tip in mm, of the axis in degrees.
pub const TOLERANCE: Tolerance = Tolerance { tip_mm: 0.001, axis_deg: 0.02 };
/// Share of the axes' feed that is used: their words are rounded, on short moves by up to a hundredth.
const ROUNDING: f64 = 0.99;
/// Retraction at a change of branch, which these programs refuse.
const RETRACT_MM: f64 = 50.0;

/// Plan for one blade with everything derived from it.
pub struct FinishResult {
    /// Content of the part file.
    pub part: FinishPart,
    /// Path of the mill.
    pub plan: FinishPlan,
    /// Clearances of all parts of the mill over the whole path.
    pub clearances: Vec<FinishClearance>,
    /// CL points, with feeds that the machine's axes can follow.
    pub cl: Cl,
    /// Task for the post-processor: machine, placement, choice of the axis positions.
    pub task: Task,
    /// Positions of the machine's axes along the path.
    pub axes: AxisPlan,
    /// Target feed at the contact with the surface, mm/min.
    pub target_mm_per_min: f64,
    /// Number of moves whose feed the machine's axes limit.
    pub limited: usize,
    /// Time of the feed moves, min.
    pub minutes: f64,
}

impl FinishResult {
    /// Plans the finishing of the part, and evaluates the plan.
    ///
    /// # Errors
    /// The reason why there is no plan.
    pub fn of(part: FinishPart) -> Result<Self, String> {
        check_rotor(&part.blisk)?;
        let bodies = obstacles(&part.blisk, &part.fixtures);
        let machine = &part.machine.machine;
        let planner = Planner { blisk: &part.blisk, mill: &part.mill, machine, needs: &part.needs, bodies: &bodies };
        let plan = planner.plan().map_err(|why| why.to_string())?;
        let clearances = clearances(&plan, &planner.access());
        Ok(FinishResult::proven(part, plan, clearances))
    }

    /// Evaluates a plan whose clearances have been computed.
    pub fn proven(part: FinishPart, plan: FinishPlan, clearances: Vec<FinishClearance>) -> Self {
        let task = Task {
            machine: part.machine.machine,
            setup: part.setup,
            repair: None,
            start: PathStart::default(),
            limits: RepairLimits::default(),
            retract_mm: RETRACT_MM,
        };
        let target_mm_per_min = part.feeds.rev_per_min * part.feeds.per_tooth_mm * f64::from(part.mill.teeth);
        let mut cl = cl(&part, &plan, target_mm_per_min);
        let axes = AxisPlan::new(&cl, &task);
        let limited = limit_feeds(&mut cl, &axes, &task);
        let minutes = minutes(&cl);
        FinishResult { part, plan, clearances, cl, task, axes, target_mm_per_min, limited, minutes }
    }

    /// Reason why no files are written for this plan; `None` if they may be.
    pub fn refusal(&self) -> Option<String> {
        let open = self.clearances.iter().find(|found| !found.holds());
        if let Some(found) = open {
            let at = found.place.map_or(String::new(), |at| format!(", at ({:.2}, {:.2}, {:.2})", at.x, at.y, at.z));
            return Some(format!(
                "the {} keeps only {:.3} mm from the {} on move {}{at}, and {:.3} mm are needed",
                part_word(found.part),
                found.certified_mm,
                obstacle_word(found.obstacle),
                found.at + 1,
                found.needed_mm
            ));
        }
        let error = self.axes.findings.iter().find(|finding| finding.severity() == Severity::Error)?;
        Some(format!("{} cannot follow the path: move {}: {}", self.part.machine.name, error.line, error.what))
    }
}

/// Checks that the blades of a rotor have no flaw because of which they cannot be planned.
///
/// # Errors
/// Describes its flaws.
pub fn check_rotor(blisk: &Blisk) -> Result<(), String> {
    let said: Vec<String> = flaws(blisk, 0.0).iter().map(ToString::to_string).collect();
    if said.is_empty() { Ok(()) } else { Err(format!("this rotor cannot be planned: {}", said.join("; "))) }
}

/// Clearances of the whole mill over the whole path, from above all obstacles and back; move k leads to the CL point of line k + 1.
pub fn clearances(plan: &FinishPlan, access: &BladeAccess<'_>) -> Vec<FinishClearance> {
    let BladeAccess { mill, bodies, needs, .. } = access;
    let proof = FinishProof { mill, bodies, margins: needs.margins, departure_rad: TOLERANCE.axis_deg.to_radians() };
    proof.clearances(&access.whole(&plan.path))
}

/// CL points; their lines are the numbers of the moves.
fn cl(part: &FinishPart, plan: &FinishPlan, target_mm_per_min: f64) -> Cl {
    let feeds = &part.feeds;
    let contact = ContactFeed {
        target_mm_per_min,
        max_raise_ratio: feeds.max_raise_ratio,
        max_mm_per_min: feeds.max_raise_ratio * target_mm_per_min,
    };
    let feed = |before: Option<&FinishMove>, step: &FinishMove| match (
        step.kind,
        before.and_then(|from| from.point),
        step.point,
    ) {
        (MoveKind::Rapid, ..) => None,
        (MoveKind::Cut, Some(from), Some(to)) => Some(contact.tip_mm_per_min(&part.mill, &from, &to)),
        (MoveKind::Cut | MoveKind::Link, ..) => Some(feeds.approach_mm_per_min.min(target_mm_per_min)),
    };
    let point = |(at, step): (usize, &FinishMove)| ClPoint {
        line: at + 1,
        pose: ToolPose { tip_mm: step.location.tip.into(), axis: step.location.axis.into() },
        feed_mm_per_min: feed(at.checked_sub(1).and_then(|before| plan.path.get(before)), step),
    };
    Cl { name: Some(part.name.clone()), points: plan.path.iter().enumerate().map(point).collect(), passed_over: 0 }
}

/// Lowers each feed to what the machine's axes follow; the number of lowered ones.
fn limit_feeds(cl: &mut Cl, axes: &AxisPlan, task: &Task) -> usize {
    let mut limited = 0;
    for (pair, point) in axes.stops.windows(2).zip(cl.points.iter_mut().skip(1)) {
        let [from, to] = [&pair[0], &pair[1]];
        let tip_mm = [from, to].map(|stop| stop.pose.tip_mm);
        let of = TipMove { tip_mm, rotary_deg: [from, to].map(|stop| stop.axes.rotary_deg) };
        let (Some(feed), Some(allowed)) = (point.feed_mm_per_min, task.machine.tip_feed(&of, &task.setup)) else {
            continue;
        };
        let allowed = allowed.feed_mm_per_min * ROUNDING;
        if allowed < feed {
            point.feed_mm_per_min = Some((libm::floor(allowed * 1e3) / 1e3).max(1e-3));
            limited += 1;
        }
    }
    limited
}

/// Time of the feed moves.
fn minutes(cl: &Cl) -> f64 {
    let of = |pair: &[ClPoint]| {
        let way = |k: usize| pair[1].pose.tip_mm[k] - pair[0].pose.tip_mm[k];
        Some(libm::sqrt((0..3).map(|k| way(k) * way(k)).sum::<f64>()) / pair[1].feed_mm_per_min?)
    };
    cl.points.windows(2).filter_map(of).sum()
}

/// Name of the part of the mill in messages and JSON.
pub fn part_word(part: MillPart) -> &'static str {
    match part {
        MillPart::End => "end",
        MillPart::Flutes => "flutes",
        MillPart::Neck => "neck",
        MillPart::Holder => "holder",
    }
}

/// Name of the obstacle in messages and JSON.
pub fn obstacle_word(obstacle: FinishObstacle) -> &'static str {
    match obstacle {
        FinishObstacle::Blade => "blade",
        FinishObstacle::Stock => "stock",
        FinishObstacle::Neighbours => "neighbours",
        FinishObstacle::Hub => "hub",
        FinishObstacle::Fixture => "fixture",
    }
}
