//! Load of the spindle compared with its limits: results (JSON of docs/json.md), and warnings for a person.

use serde::Serialize;

use super::material::short;
use crate::plural::counted;

/// Most blocks that a warning names.
const SHOWN: usize = 5;

/// Load of the spindle in a run, against its limits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpindleFigures {
    /// Origin of the load: `cutting` (simulated forces) or `estimate` (removal rate times specific cutting force).
    pub source: &'static str,
    /// Specific cutting force that the estimate uses where the job's own target applies, N/mm2; `None` with simulated
    /// forces.
    pub specific_force_n_per_mm2: Option<f64>,
    /// Power, W.
    pub power: SpindleLoadFigures,
    /// Torque, N m; null for an estimate.
    pub torque: Option<SpindleLoadFigures>,
}

/// Largest power or torque of a run, compared with the job's limit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpindleLoadFigures {
    /// Limit in the job, if there is one.
    pub limit: Option<f64>,
    /// Largest value.
    pub max: f64,
    /// Largest value of the original program.
    pub baseline_max: f64,
    /// Blocks above the limit, with their largest values.
    pub above: Vec<BlockValue>,
    /// Blocks of the original program above the limit.
    pub baseline_above: Vec<BlockValue>,
}

/// Largest value of a quantity in a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BlockValue {
    /// Number of blocks executed then, including this one.
    pub block: u32,
    /// N of the block.
    pub n: Option<i64>,
    /// Value.
    pub value: f64,
}

impl BlockValue {
    /// Name of the block for a person.
    pub fn name(&self) -> String {
        self.n.map_or_else(|| format!("block {}", self.block), |n| format!("N{n}"))
    }
}

impl SpindleLoadFigures {
    /// Figures of the blocks of a run, and of the original program.
    pub fn new(limit: Option<f64>, [after, before]: [&[BlockValue]; 2]) -> Self {
        let max = |blocks: &[BlockValue]| blocks.iter().map(|block| block.value).fold(0.0, f64::max);
        let above = |blocks: &[BlockValue]| {
            let above = blocks.iter().filter(|block| limit.is_some_and(|limit| block.value > limit));
            above.copied().collect()
        };
        SpindleLoadFigures {
            limit,
            max: max(after),
            baseline_max: max(before),
            above: above(after),
            baseline_above: above(before),
        }
    }

    fn warnings(&self, quantity: &str, unit: &str, per_unit: f64) -> Vec<String> {
        let Some(limit) = self.limit else { return Vec::new() };
        let written = |value: f64| format!("{} {unit}", short(value / per_unit));
        let sides = [("before", &self.baseline_above), ("after", &self.above)];
        let sides = sides.into_iter().filter(|(_, blocks)| !blocks.is_empty());
        let warning = sides.map(|(side, blocks)| {
            let shown = blocks.iter().take(SHOWN);
            let mut named: Vec<String> =
                shown.map(|block| format!("{} ({})", block.name(), written(block.value))).collect();
            if let more @ 1.. = blocks.len().saturating_sub(SHOWN) {
                named.push(format!("{more} more"));
            }
            let limit = written(limit);
            format!(
                "{side}: {quantity} above the spindle's {limit} in {}: {}",
                counted(blocks.len(), "block"),
                named.join(", ")
            )
        });
        warning.collect()
    }
}

impl SpindleFigures {
    /// Warnings, one sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.power.warnings("power", "kW", 1e3);
        warnings.extend(self.torque.iter().flat_map(|torque| torque.warnings("torque", "N m", 1.0)));
        warnings
    }

    /// Summary of the spindle's load in one line.
    pub fn words(&self) -> String {
        let kilowatts = |watts: f64| short(watts / 1e3);
        let limit = self.power.limit.map_or(String::new(), |limit| format!(", limit {}", kilowatts(limit)));
        let how = match self.specific_force_n_per_mm2 {
            Some(force) => format!("estimated with {force:.0} N/mm2"),
            None => "simulated".into(),
        };
        let [before, after] = [self.power.baseline_max, self.power.max].map(kilowatts);
        format!("spindle power, largest, kW, {how}: before {before}; after {after}{limit}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(block: u32, value: f64) -> BlockValue {
        BlockValue { block, n: Some(10 * i64::from(block)), value }
    }

    #[test]
    fn a_warning_names_the_first_blocks_above_the_limit_and_counts_the_others() {
        let after: Vec<BlockValue> = (1..=7).map(|count| block(count, 12e3)).collect();
        let figures = SpindleLoadFigures::new(Some(11e3), [&after, &[block(1, 11e3)]]);
        let words = "after: power above the spindle's 11.00 kW in 7 blocks: N10 (12.00 kW), N20 (12.00 kW), N30 (12.00 kW), \
                     N40 (12.00 kW), N50 (12.00 kW), 2 more";
        assert_eq!(figures.warnings("power", "kW", 1e3), [words]);
    }

    #[test]
    fn without_a_limit_nothing_is_above_it() {
        let figures = SpindleLoadFigures::new(None, [&[block(1, 1e9)], &[]]);
        assert!(figures.above.is_empty() && figures.warnings("power", "kW", 1e3).is_empty());
    }
}
