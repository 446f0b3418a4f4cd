//! Loads of the edges: figures (JSON of docs/json.md), and text for a person.

use std::fmt;

use serde::Serialize;

use super::marks::MarksFigures;
use super::material::{LeftOutBlocks, short};
use crate::plural::counted;

/// Cutting loads of a run: forces, torque, power and chips.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoadsFigures {
    #[serde(skip)]
    /// Unit of lengths.
    pub unit: &'static str,
    /// Loads of the whole run.
    pub load: LoadFigures,
    /// Loads of the original program.
    pub baseline: LoadFigures,
    /// Height of a layer, within which one chip is computed along the tool's axis.
    pub layer: f64,
    /// Rotation of the tool per step.
    pub step_deg: f64,
    /// Loads of each cut rule; the last entry has the blocks without a rule.
    pub rules: Vec<LoadRuleFigures>,
    /// Blocks with chips.
    pub blocks: Vec<LoadBlockFigures>,
    /// Vibration between tool and workpiece; `None` if both are rigid.
    pub vibration: Option<VibrationFigures>,
    /// Marks of the edges on walls; `None` if they made no wall.
    pub marks: Option<MarksFigures>,
    /// Marks of the original program.
    pub baseline_marks: Option<MarksFigures>,
    /// Blocks that cut, but whose chips are not computed.
    pub left_out: Vec<LeftOutBlocks>,
}

/// Vibration in a run: change of the tool's position against the workpiece from tooth to tooth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VibrationFigures {
    /// Largest change that counts as none.
    pub floor: f64,
    /// Natural frequencies of a flexible workpiece, from the lowest.
    pub workpiece_hz: Vec<f64>,
    /// Blocks that were long enough to judge.
    pub judged_blocks: usize,
    /// Largest mean change of a window of teeth.
    pub metric_max: Option<f64>,
    /// The same for the original program.
    pub baseline_metric_max: Option<f64>,
    /// Blocks in which a tooth meets the tool at another position than the tooth before.
    pub unstable: Vec<UnstableFigures>,
    /// The same for the original program.
    pub baseline_unstable: Vec<UnstableFigures>,
}

/// A block in which the tool vibrated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct UnstableFigures {
    /// Blocks executed, up to and including this one.
    pub block: u32,
    /// N of the block.
    pub n: Option<i64>,
    /// Rule of the block, counted from 1.
    pub rule: Option<usize>,
    /// `uneven`: repeats every turn; `period-doubling`: every other tooth; `chatter`: not at all.
    pub verdict: &'static str,
    /// Mean change from tooth to tooth in its worst window.
    pub metric: f64,
}

/// Cutting loads over a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadFigures {
    /// Time in which an edge had a chip.
    pub time_s: f64,
    /// Largest force across the tool's axis.
    pub force_max_n: f64,
    /// Mean force across the tool's axis over that time.
    pub force_mean_n: f64,
    /// Mean over whole turns of (largest - least) / mean.
    pub force_variation_ratio: Option<f64>,
    /// Largest amount of the force along the tool's axis.
    pub thrust_max_n: f64,
    /// Mean force along the tool's axis, positive into the tool's holder.
    pub thrust_mean_n: f64,
    /// Largest torque about the spindle's axis.
    pub torque_max_n_m: f64,
    /// Mean torque.
    pub torque_mean_n_m: f64,
    /// Largest power of the spindle.
    pub power_max_w: f64,
    /// Mean power.
    pub power_mean_w: f64,
    /// Passes of outer teeth and of inner ones.
    pub chips: [u64; 2],
    /// Mean of their largest chip thicknesses.
    pub chip_mean: [Option<f64>; 2],
    /// Largest chip thickness.
    pub chip_max: [Option<f64>; 2],
    /// Largest mean thickness along an edge on the tool's end.
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
    /// Blocks executed, up to and including this one.
    pub block: u32,
    /// N of the block.
    pub n: Option<i64>,
    /// Rule of the block, counted from 1.
    pub rule: Option<usize>,
    /// Loads of the block.
    pub load: LoadFigures,
    /// Loads of the original program, if that has the same block.
    pub baseline: Option<LoadFigures>,
}

impl LoadFigures {
    /// Largest chip thickness of both sides.
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

    /// Rows of the table: a name, then the loads before and after.
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
