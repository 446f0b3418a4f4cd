//! Path of the mill along the contact points of a repair: rough layers from the highest, then the finish, each from the tip to the root.
//!
//! All layers share the tool axes of the finish. Each run of contact points has its approach and its way out along the mill's axis.
//!
//! Source: Feng et al. leave cutter location and axis to another method; ours is that of finishing passes.

use super::passes::RepairContact;
use super::plan::RepairPlan;
use crate::finish::access::{BladeAccess, FinishInfeasible};
use crate::finish::axis::AxisProgram;
use crate::finish::contact::Contact;
use crate::finish::passes::{PassPoint, is_climb, sampled};
use crate::finish::plan::FinishPlan;
use crate::vector::Vector;

/// Lines of the finish on which the tool axes are examined, each at the heights of the finish and of the highest layer.
const SAMPLED: usize = 4;

/// Plan of the mill's path.
///
/// # Errors
/// No tool axis is admissible at one place, or the mill does not leave the part along its axis.
pub fn tool_path(plan: &RepairPlan, access: &BladeAccess<'_>) -> Result<FinishPlan, FinishInfeasible> {
    let is_forward = runs_forward(plan, access);
    let program = access.axes(&examined(plan, access, is_forward), false)?;
    let axes: Vec<Vec<Vector>> = plan.whole.iter().map(|line| along(line, &program, access, is_forward)).collect();
    let layers = plan.layers.iter().map(|(_, runs)| runs).chain([&plan.finish]);
    let mut passes: Vec<Vec<PassPoint>> = Vec::new();
    for runs in layers {
        let pass = |run: &Vec<RepairContact>| {
            let (contacts, axes) = (frames(run, access, is_forward), axes_of(plan, &axes, run, is_forward));
            sampled(&contacts, &axes, access.mill, &access.needs.sampling)
        };
        passes.extend(runs.iter().rev().map(pass));
    }
    let path = access.path(&passes, false)?;
    Ok(FinishPlan { passes, path, span: [plan.regions.allowance.from_u, 1.0] })
}

/// Contacts with the feed direction of the path of the corner's centre.
fn frames(run: &[RepairContact], access: &BladeAccess<'_>, is_forward: bool) -> Vec<Contact> {
    let corner_mm = access.mill.corner_radius_mm;
    let centre = |at: usize| run[at].point + run[at].normal * corner_mm;
    let sign = if is_forward { 1.0 } else { -1.0 };
    let frame = |at: usize| {
        let way = centre((at + 1).min(run.len() - 1)) - centre(at.saturating_sub(1));
        Contact::new(run[at].point, &run[at].normal, &(way * sign))
    };
    let mut contacts: Vec<Contact> = (0..run.len()).filter_map(frame).collect();
    if !is_forward {
        contacts.reverse();
    }
    contacts
}

/// Whether runs go from the leading to the trailing edge, for the wanted side of the material. Lines follow one another towards the root.
fn runs_forward(plan: &RepairPlan, access: &BladeAccess<'_>) -> bool {
    let contacts = frames(&plan.whole[plan.whole.len() / 2], access, true);
    let Some(contact) = contacts.get(contacts.len() / 2) else { return true };
    is_climb(contact, &access.outward, &-access.outward) == access.needs.is_climb
}

fn examined(plan: &RepairPlan, access: &BladeAccess<'_>, is_forward: bool) -> Vec<Vec<Contact>> {
    let last = plan.whole.len() - 1;
    let highest_mm = plan.layers.first().map(|(height_mm, _)| *height_mm);
    let lines = (0..SAMPLED).map(|k| &plan.whole[k * last / (SAMPLED - 1)]);
    lines
        .flat_map(|line| {
            let raised = highest_mm.map(|height_mm| {
                let raise = |at: &RepairContact| {
                    let point = at.point + at.normal * (height_mm - at.left_mm).max(0.0);
                    RepairContact { point, ..*at }
                };
                line.iter().map(raise).collect::<Vec<_>>()
            });
            let both = [Some(line.clone()), raised].into_iter().flatten();
            both.map(|line| frames(&line, access, is_forward)).collect::<Vec<_>>()
        })
        .collect()
}

/// Tool axes at the contact points of a line, in its own order.
fn along(line: &[RepairContact], program: &AxisProgram, access: &BladeAccess<'_>, is_forward: bool) -> Vec<Vector> {
    let mut axes = program.axes(&frames(line, access, is_forward), access.mill.corner_radius_mm);
    if !is_forward {
        axes.reverse();
    }
    axes
}

/// Tool axes of a run: those of the finish at the same places, in the order of the motion.
fn axes_of(plan: &RepairPlan, axes: &[Vec<Vector>], run: &[RepairContact], is_forward: bool) -> Vec<Vector> {
    let line = plan.lines.us.partition_point(|u| *u < run[0].at[0]);
    let first = plan.whole[line].partition_point(|at| at.at[1] < run[0].at[1]);
    let mut found = axes[line][first..first + run.len()].to_vec();
    if !is_forward {
        found.reverse();
    }
    found
}
