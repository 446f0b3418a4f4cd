//! Path of a run with the measured chip load of each move.

use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_model::job::Job;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::Nm;

use super::chip_quantity::ChipQuantity;
use super::move_log::{DrawnMove, MoveLog};
use crate::report::page::load_plot::{LoadPlot, PlotBlock};

/// Largest angle between two points of an arc.
const POINT_RAD: f64 = 0.05;

/// Plot of the cutting moves, seen along Z; the colour of each shows its largest measured chip divided by the target.
pub fn plot(job: &Job, log: &MoveLog, chips: &[MoveChips]) -> LoadPlot {
    let unit = job.unit;
    let block = |drawn: &DrawnMove| {
        let DrawnMove { block, segment, is_governed } = drawn;
        // A piece of an arc belongs to the move that its first piece began.
        let before = chips.partition_point(|chips| chips.block <= *block);
        let own = before.checked_sub(1).and_then(|index| chips.get(index)).filter(|_| *is_governed);
        let measured = own.filter(|chips| chips.any_contact.samples > 0);
        PlotBlock {
            name: segment.sequence.map_or_else(|| format!("block {block}"), |n| format!("N{n}")),
            verdict: None,
            chip_ratio: measured.map(|chips| chips.any_contact.max_ratio),
            lines: vec![points(segment).into_iter().map(|point| point.map(|mm| mm / unit.mm())).collect()],
        }
    };
    let cutting = log.drawn.iter().filter(|drawn| drawn.segment.path != Path::Rapid);
    LoadPlot { blocks: cutting.map(block).collect(), quantity: ChipQuantity::of(job).words(), has_vibration: false }
}

/// X and Y of a move, mm.
fn points(segment: &Segment) -> Vec<[f64; 2]> {
    let at = |[x, y, _]: [Nm; 3]| [x, y].map(Nm::to_mm);
    let ends = [at(segment.start.linear), at(segment.end.linear)];
    let Some(arc) = segment.arc().filter(|arc| arc.plane.axes() == (0, 1, 2)) else { return ends.into() };
    let steps = (arc.sweep_rad() / POINT_RAD).ceil().max(1.0) as usize;
    let (angles, [x, y], radius_mm) = (arc.angles(), arc.center.map(Nm::to_mm), arc.radius_mm());
    let point = |step: usize| {
        let [cos, sin] = angles.direction_at(step as f64 / steps as f64);
        [x + radius_mm * cos, y + radius_mm * sin]
    };
    (0..=steps).map(point).collect()
}
