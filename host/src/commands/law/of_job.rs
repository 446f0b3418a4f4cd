//! Case of a law taken from a block of a job's program.

use std::path::Path;

use arcfeed_law::contour::ContourLimits;
use arcfeed_model::cut::Work;
use arcfeed_model::job::{Job, LawKind};
use arcfeed_model::tool::Tool;
use arcfeed_nc::motion::Turn;
use arcfeed_units::{LengthUnit, Nm};

use super::super::job_input::load_text;
use super::super::outcome::Failure;
use super::case::{Case, Contact, Contour, Rotation};
use crate::adapt::{Known, LinePlan, PlannedBlock};

/// Case of the block on `line` (counted from 1), at the fraction `at` (0 to 1) of its arc, and the unit of the job.
///
/// # Errors
/// The job or the program is at fault, the line has no such block, or another law or none governs it.
pub fn case(job: &Path, line: usize, at: f64) -> Result<(Case, LengthUnit), Failure> {
    if !(0.0..=1.0).contains(&at) {
        return Err(Failure::Usage(format!("--at {at}: write 0 for the start of the arc to 1 for its end")));
    }
    let (file, source, may_leak) = load_text(job)?;
    let plan = LinePlan::new(&source, may_leak, &file.job, Known::of(&file));
    let mut found = None;
    let leak = plan.each(|_, planned| {
        let block = planned.block.filter(|block| source.line_in_file(block.line) == line);
        found = found.take().or(block);
    });
    let refused = |why: &str| Failure::Input(format!("{}:{line}:1: {why}", source.path.display()));
    let Some(block) = found.filter(|_| leak.is_ok()) else {
        return Err(refused("there is no move in this line"));
    };
    let case = block_case(&block, &file.job, at).map_err(|why| refused(&why))?;
    Ok((case, file.job.unit))
}

fn block_case(block: &PlannedBlock, job: &Job, at: f64) -> Result<Case, String> {
    let rule = block.cut_rule(job).ok_or("no cut rule of the job matches this block")?;
    let setup = job.tool_of(&rule);
    let arc = block.segment.arc().ok_or("this block is no arc: its feed is the same on the whole move")?;
    let (rho_mm, teeth_per_min) = (arc.radius_mm(), block.teeth_per_min);
    let feed_per_tooth_mm = f64::from(job.feed_per_tooth_of(&rule).0);
    match (&setup.tool, &rule.work, setup.law) {
        (Tool::CupMill(mill), Work::Ring(edge, stock), LawKind::Circumference) => {
            let line = stock.line().ok_or("the rule of this block has no stock line")?;
            let line = line.at_height(block.segment.height().to_mm());
            let [nx, ny] = line.normal;
            let contact = Contact::Line {
                normal_deg: libm::atan2(ny, nx).to_degrees(),
                offset_mm: line.distance_mm(arc.center.map(Nm::to_mm)),
                position: arc.direction_at(at),
                is_clockwise: arc.turn == Turn::Cw,
            };
            let radius_mm = mill.radius(*edge).to_mm();
            let edge = *edge;
            Ok(Case::Circumference(Rotation { rho_mm, radius_mm, edge, feed_per_tooth_mm, contact, teeth_per_min }))
        }
        (Tool::EndMill(mill), Work::Mill { side, .. }, LawKind::Contour { inside_only, floor_ratio }) => {
            let radius_mm = mill.radius.to_mm();
            let (side, limits) = (*side, ContourLimits { inside_only, floor_ratio });
            Ok(Case::Contour(Contour { rho_mm, radius_mm, side, feed_per_tooth_mm, limits, teeth_per_min }))
        }
        _ => Err("the law of this block is neither circumference nor contour".into()),
    }
}
