//! Marks that the teeth leave on walls, as results and as a map; parts of the path with vibration; chip thickness along
//! the path.

use std::collections::BTreeMap;

use arcfeed_hil_sim::removal::envelope::CuttingSolid;
use arcfeed_hil_sim::removal::loads::LoadMeter;
use arcfeed_hil_sim::removal::marks::{WallMark, marks};
use arcfeed_hil_sim::removal::trail::BlockRef;
use arcfeed_milling::cutting::layers::Layers;
use arcfeed_model::job::Job;
use arcfeed_units::LengthUnit;

use super::chip_quantity::ChipQuantity;
use crate::report::loads::LoadsFigures;
use crate::report::marks::{BlockMarksFigures, LargestFigures, LayerFigures, MarksFigures, RangeFigures};
use crate::report::page::load_plot::{LoadPlot, PlotBlock};
use crate::report::page::map::Map;

/// Cells of the map along its longer side: walls are one cell wide.
const CELLS: f64 = 200.0;

/// Reference from which the marks of the teeth on walls are measured.
#[derive(Clone, Debug)]
pub struct MarkReference {
    /// Layers of the blank before the run.
    pub blank: Layers,
    /// Solid that the edges sweep without runout.
    pub turned: CuttingSolid,
}

impl MarkReference {
    /// Marks that a run has left on walls; empty if a tilted tool has cut, because its layers are not those of the
    /// blank.
    pub fn marks(&self, meter: &LoadMeter) -> Vec<WallMark> {
        if meter.is_tilted() {
            return Vec::new();
        }
        marks(&self.blank, meter.process().engagement().layers(), meter.tip_path(), &self.turned)
    }
}

/// Results for the marks of a run; `None` without marks.
pub fn figures(unit: LengthUnit, meter: &LoadMeter, marks: &[WallMark]) -> Option<MarksFigures> {
    let in_unit = |mm: f64| mm / unit.mm();
    let worst = marks.iter().max_by(|a, b| a.off_mm.abs().total_cmp(&b.off_mm.abs()))?;
    let z = |layer: usize| in_unit(meter.process().engagement().layers().middle_mm(layer));
    let (mut layers, mut blocks) = (BTreeMap::<usize, Vec<f64>>::new(), BTreeMap::<u32, (BlockRef, Vec<f64>)>::new());
    for mark in marks {
        let off = in_unit(mark.off_mm);
        layers.entry(mark.layer).or_default().push(off);
        blocks.entry(mark.block.count).or_insert((mark.block, Vec::new())).1.push(off);
    }
    let range = |offs: &[f64]| RangeFigures::of(offs.iter().copied());
    let of_layer = |(layer, offs): (&usize, &Vec<f64>)| Some(LayerFigures { z: z(*layer), range: range(offs)? });
    let of_block = |(block, (of, offs)): (&u32, &(BlockRef, Vec<f64>))| {
        let rule = of.rule.map(|rule| rule + 1);
        Some(BlockMarksFigures { block: *block, n: of.sequence, rule, range: range(offs)? })
    };
    let [x, y] = [worst.point_mm.x, worst.point_mm.y].map(in_unit);
    let BlockRef { count, sequence, rule, .. } = worst.block;
    Some(MarksFigures {
        range: RangeFigures::of(marks.iter().map(|mark| in_unit(mark.off_mm)))?,
        largest: LargestFigures {
            distance: in_unit(worst.off_mm),
            x,
            y,
            z: z(worst.layer),
            block: count,
            n: sequence,
            rule: rule.map(|rule| rule + 1),
        },
        layers: layers.iter().filter_map(of_layer).collect(),
        blocks: blocks.iter().filter_map(of_block).collect(),
    })
}

/// Map of the marks, seen along Z; where several lie above each other, the largest counts. `None` without marks.
pub fn map(unit: LengthUnit, meter: &LoadMeter, marks: &[WallMark]) -> Option<Map> {
    let in_unit = |mm: f64| mm / unit.mm();
    let [lowest_mm, highest_mm] = meter.process().engagement().layers().extent_mm()?;
    let size_mm = [0, 1].map(|axis: usize| highest_mm[axis] - lowest_mm[axis]);
    let step_mm = size_mm[0].max(size_mm[1]) / CELLS;
    let cells = size_mm.map(|mm| libm::ceil(mm / step_mm).max(1.0) as usize);
    let mut values = vec![None; cells[0] * cells[1]];
    let (mut largest, mut place_mm) = (0.0_f64, [0.0; 2]);
    for mark in marks {
        let cell = |axis: usize| {
            let at = (mark.point_mm[axis] - lowest_mm[axis]) / step_mm;
            (at as usize).min(cells[axis] - 1)
        };
        let value: &mut Option<f64> = &mut values[cell(1) * cells[0] + cell(0)];
        *value = value.filter(|off| off.abs() >= in_unit(mark.off_mm).abs()).or(Some(in_unit(mark.off_mm)));
        if mark.off_mm.abs() > largest.abs() {
            (largest, place_mm) = (mark.off_mm, [mark.point_mm.x, mark.point_mm.y]);
        }
    }
    Some(Map {
        columns: cells[0],
        values,
        lowest: lowest_mm.map(in_unit),
        step: in_unit(step_mm),
        unit: unit.label(),
        largest: Some((in_unit(largest), place_mm.map(in_unit))),
    })
}

/// Plot of the tool's path through the workpiece, coloured by load, block by block.
pub fn course(unit: LengthUnit, job: &Job, meter: &LoadMeter, loads: &LoadsFigures) -> LoadPlot {
    let in_unit = |mm: f64| mm / unit.mm();
    let unstable = |count: u32| {
        let blocks = loads.vibration.iter().flat_map(|vibration| &vibration.unstable);
        blocks.filter(|block| block.block == count).map(|block| block.verdict).next()
    };
    let chip_ratio = |of: &BlockRef| {
        let wanted = of.rule.and_then(|rule| job.rules.get(rule)).map(|rule| job.feed_per_tooth_of(rule));
        let wanted = in_unit(f64::from(wanted.unwrap_or(job.tools.first().feed_per_tooth).0));
        let block = loads.blocks.iter().find(|block| block.block == of.count)?;
        Some(block.load.thickest()? / wanted)
    };
    let mut blocks: Vec<PlotBlock> = Vec::new();
    let mut before: Option<BlockRef> = None;
    for segment in meter.tip_path().segments().iter().filter(|segment| !segment.block.is_rapid) {
        let [from, to] = [segment.from_mm, segment.to_mm].map(|tip_mm| [in_unit(tip_mm[0]), in_unit(tip_mm[1])]);
        if before.replace(segment.block) != Some(segment.block) {
            let name =
                segment.block.sequence.map_or_else(|| format!("block {}", segment.block.count), |n| format!("N{n}"));
            let (verdict, chip_ratio) = (unstable(segment.block.count), chip_ratio(&segment.block));
            blocks.push(PlotBlock { name, verdict, chip_ratio, lines: Vec::new() });
        }
        let Some(block) = blocks.last_mut() else { continue };
        match block.lines.last_mut() {
            Some(line) if line.last() == Some(&from) => line.push(to),
            _ => block.lines.push(vec![from, to]),
        }
    }
    LoadPlot { blocks, quantity: ChipQuantity::ChipLoad.words(), has_vibration: true }
}
