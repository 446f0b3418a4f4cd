//! Loads of the cutting edges: results (JSON of docs/json.md), and text for a person.

use std::fmt;

use serde::Serialize;

use super::marks::MarksFigures;
use super::material::{LeftOutBlocks, short};
use crate::plural::counted;

/// Cutting loads of a run: forces, torque, power and chips. Lengths are in the job's unit, which `unit` names.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoadsFigures {
    #[serde(skip)]
    /// Unit of lengths.
    pub unit: &'static str,
    /// Loads of the whole run.
    pub load: LoadFigures,
    /// Loads of the original program.
    pub baseline: LoadFigures,
    /// Height of a layer, within which the chip of an edge counts as one.
    pub layer: f64,
    /// Rotation of the tool in one step of the computation, degrees.
    pub step_deg: f64,
    /// Loads of each cut rule; the last entry is for the blocks without a rule.
    pub rules: Vec<LoadRuleFigures>,
    /// Loads of each block with chips.
    pub blocks: Vec<LoadBlockFigures>,
    /// Vibration between tool and workpiece; `None` if both are rigid.
    pub vibration: Option<VibrationFigures>,
    /// Marks of the edges on walls; `None` if the run made no wall.
    pub marks: Option<MarksFigures>,
    /// Marks of the original program.
    pub baseline_marks: Option<MarksFigures>,
    /// Blocks that cut, but whose chips could not be computed, by cause.
    pub left_out: Vec<LeftOutBlocks>,
}

/// Vibration in a run, judged by how much the position of the tool relative to the workpiece changes from one tooth to
/// the next.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VibrationFigures {
    /// Largest change that does not count as vibration.
    pub floor: f64,
    /// Natural frequencies of a flexible workpiece, Hz, from the lowest.
    pub workpiece_hz: Vec<f64>,
    /// Number of blocks that were long enough to be judged.
    pub judged_blocks: usize,
    /// Largest of the mean changes over a window of teeth; `None` if no block was judged.
    pub metric_max: Option<f64>,
    /// The same for the original program.
    pub baseline_metric_max: Option<f64>,
    /// Blocks with vibration.
    pub unstable: Vec<UnstableFigures>,
    /// The same for the original program.
    pub baseline_unstable: Vec<UnstableFigures>,
}

/// Block in which the tool vibrated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct UnstableFigures {
    /// Number of blocks executed then, including this one.
    pub block: u32,
    /// N of the block.
    pub n: Option<i64>,
    /// Rule of the block, counted from 1.
    pub rule: Option<usize>,
    /// Kind of the changes: `uneven` (they repeat with every turn), `period-doubling` (with every second tooth) or
    /// `chatter` (they do not repeat).
    pub verdict: &'static str,
    /// Mean change from tooth to tooth in the worst window of the block.
    pub metric: f64,
}

/// Cutting loads over a part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadFigures {
    /// Time in which at least one edge had a chip, s.
    pub time_s: f64,
    /// Largest force square to the tool's axis, N.
    pub force_max_n: f64,
    /// Mean force square to the tool's axis over that time, N.
    pub force_mean_n: f64,
    /// Mean over whole turns of (largest - smallest) / mean of that force; `None` without a whole turn.
    pub force_variation_ratio: Option<f64>,
    /// Largest absolute value of the force along the tool's axis, N.
    pub thrust_max_n: f64,
    /// Mean force along the tool's axis, N; positive towards the tool's holder.
    pub thrust_mean_n: f64,
    /// Largest torque about the spindle's axis, N m.
    pub torque_max_n_m: f64,
    /// Mean torque over that time, N m.
    pub torque_mean_n_m: f64,
    /// Largest power of the spindle, W.
    pub power_max_w: f64,
    /// Mean power over that time, W.
    pub power_mean_w: f64,
    /// Numbers of passes of teeth through the material: of the outer teeth, and of the inner ones.
    pub chips: [u64; 2],
    /// Mean of the passes' largest chip thicknesses, outer and inner teeth; `None` without passes.
    pub chip_mean: [Option<f64>; 2],
    /// Largest chip thickness, outer and inner teeth; `None` without passes.
    pub chip_max: [Option<f64>; 2],
    /// Largest mean chip thickness along an edge on the tool's end; `None` without one.
    pub end_chip_max: Option<f64>,
}

/// Cutting loads of all blocks under one cut rule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadRuleFigures {
    /// Rule, counted from 1; null for blocks without one.
    pub rule: Option<usize>,
    /// Loads of these blocks.
    pub load: LoadFigures,
    /// Loads of the original program.
    pub baseline: LoadFigures,
}

/// Cutting loads of one block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadBlockFigures {
    /// Number of blocks executed then, including this one.
    pub block: u32,
    /// N of the block.
    pub n: Option<i64>,
    /// Rule of the block, counted from 1.
    pub rule: Option<usize>,
    /// Loads of the block.
    pub load: LoadFigures,
    /// Loads of the same block of the original program; `None` if that does not have it.
    pub baseline: Option<LoadFigures>,
}

impl LoadFigures {
    /// Largest chip thickness of outer and inner teeth; `None` without chips.
    pub fn thickest(&self) -> Option<f64> {
        self.chip_max.into_iter().flatten().reduce(f64::max)
    }

    /// Cells of a table row: force, variation, thrust, torque, power, chip.
    pub fn cells(&self) -> [String; 6] {
        let percent = |ratio: f64| format!("{:.0}", 1e2 * ratio);
        [
            format!("{:.0}", self.force_max_n),
            self.force_variation_ratio.map_or("-".into(), percent),
            format!("{:.0}", self.thrust_max_n),
            format!("{:.1}", self.torque_max_n_m),
            format!("{:.2}", self.power_max_w / 1e3),
            self.thickest().map_or("-".into(), short),
        ]
    }
}

impl LoadsFigures {
    /// Heads of the columns of [`LoadFigures::cells`].
    pub fn columns(&self) -> [String; 6] {
        let chip = format!("chip, {}", self.unit);
        ["force, N", "varies, %", "thrust, N", "torque, N m", "power, kW", &chip].map(String::from)
    }

    /// Rows of a table: name of the cut rule, then the loads of the original program and of the run.
    pub fn rows(&self) -> Vec<(String, [LoadFigures; 2])> {
        let name = |rule: Option<usize>| rule.map_or("other blocks".into(), |rule| format!("movement {rule}"));
        let mut rows: Vec<_> = self.rules.iter().map(|rule| (name(rule.rule), [rule.baseline, rule.load])).collect();
        rows.push(("all".into(), [self.baseline, self.load]));
        rows
    }

    /// Range of the marks on walls and place of the largest, as text for a person; `None` without walls.
    pub fn marks_words(&self) -> Option<String> {
        let side = |marks: &Option<MarksFigures>| marks.as_ref().map_or("no walls".into(), MarksFigures::range);
        let MarksFigures { largest, .. } = self.marks.as_ref()?;
        let unstable = self.vibration.iter().flat_map(|vibration| &vibration.unstable);
        let verdict = unstable.filter(|block| block.block == largest.block).map(|block| block.verdict).next();
        Some(format!(
            "marks on walls, {}: before {}; after {}; {}{}",
            self.unit,
            side(&self.baseline_marks),
            side(&self.marks),
            largest.words(),
            verdict.map_or(String::new(), |verdict| format!(" ({verdict})"))
        ))
    }

    /// Warnings, one sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let own =
            self.left_out.iter().filter(|left_out| ["tilted", "axis-turns", "backwards"].contains(&left_out.cause));
        own.map(|left_out| {
            format!("no chips and forces in {}: {}", counted(left_out.blocks, "block"), left_out.words())
        })
        .collect()
    }
}

impl fmt::Display for LoadsFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  edges in the workpiece, largest values; before, then after:")?;
        write!(f, "    {:<24}", "")?;
        self.columns().iter().try_for_each(|column| write!(f, "{column:>22}"))?;
        writeln!(f)?;
        for (name, [before, after]) in self.rows() {
            write!(f, "    {name:<24}")?;
            let pairs = before.cells().into_iter().zip(after.cells());
            pairs.into_iter().try_for_each(|(before, after)| write!(f, "{before:>11}{after:>11}"))?;
            writeln!(f)?;
        }
        if let Some(vibration) = &self.vibration {
            let hz: Vec<String> = vibration.workpiece_hz.iter().map(|hz| short(*hz)).collect();
            if !hz.is_empty() {
                writeln!(f, "    workpiece vibrates at {} Hz", hz.join(", "))?;
            }
            writeln!(f, "    {}", vibration.words(self.unit))?;
        }
        self.marks_words().map_or(Ok(()), |words| writeln!(f, "    {words}"))
    }
}

impl VibrationFigures {
    /// Text about the vibration for a person.
    pub fn words(&self, unit: &str) -> String {
        let side = |metric: Option<f64>, unstable: &[UnstableFigures]| {
            let changes = metric.map_or("too short to judge".into(), |metric| format!("up to {}", short(metric)));
            match unstable.iter().max_by(|a, b| a.metric.total_cmp(&b.metric)) {
                None => changes,
                Some(worst) => format!("{changes} ({} in {}, worst)", worst.verdict, worst.name()),
            }
        };
        format!(
            "place of the tool from tooth to tooth, {unit}: before {}; after {}; stable up to {}",
            side(self.baseline_metric_max, &self.baseline_unstable),
            side(self.metric_max, &self.unstable),
            short(self.floor)
        )
    }
}

impl UnstableFigures {
    /// Name of the block for a person.
    pub fn name(&self) -> String {
        self.n.map_or_else(|| format!("block {}", self.block), |n| format!("N{n}"))
    }
}
