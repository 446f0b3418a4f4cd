//! Material that a run removed from its workpiece: figures (JSON of docs/json.md), and text for a person.

use std::fmt;

use arcfeed_units::LengthUnit;
use serde::Serialize;

use crate::job::workpiece::{AssumedStock, StockSource};
use crate::plural::counted;

/// Advice about a stock that is assumed.
const TRUE_STOCK: &str = "; give the true stock with --stock";

/// Cubic millimetres in a cubic centimetre.
const MM3_PER_CM3: f64 = 1e3;

/// Most blocks with material removed at rapid in the text.
const SHOWN: usize = 10;

/// Unit of volumes in reports: cubic inches or cubic centimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeUnit {
    /// `in3` or `cm3`.
    pub label: &'static str,
    /// `in3/min` or `cm3/min`.
    pub rate_label: &'static str,
    mm3: f64,
}

/// Material that a run has removed, and the stock model that was used.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaterialFigures {
    /// Stock that was assumed for a program without a job file; `None` with a job file.
    pub assumed_stock: Option<AssumedStock>,
    /// `cm3` or `in3`.
    pub volume_unit: &'static str,
    /// `cm3/min` or `in3/min`.
    pub rate_unit: &'static str,
    /// Material removed in the whole run.
    pub removal: RemovalFigures,
    /// Material removed by the original program.
    pub baseline: RemovalFigures,
    /// Part of the removed volume that was removed during rapids.
    pub at_rapid: f64,
    /// Volume that remains.
    pub left: f64,
    /// Distance of neighbouring dexel rays.
    pub step: f64,
    /// Largest distance between the simulated path of the tool and the executed one.
    pub path_tolerance: f64,
    /// Number of rays of all three families.
    pub rays: usize,
    /// Memory of the stock model at the end, in bytes.
    pub memory_bytes: usize,
    /// That memory divided by the volume of the stock before the run.
    pub bytes_per_mm3: f64,
    /// Material of each cut rule; the last entry has the blocks without a rule.
    pub rules: Vec<RuleFigures>,
    /// Results of each block that removed material.
    pub blocks: Vec<BlockFigures>,
    /// Blocks that cut, but whose removal could not be computed, by cause.
    pub left_out: Vec<LeftOutBlocks>,
    /// Deviation from the finished part, if the job has one.
    pub deviation: Option<DeviationFigures>,
}

/// Removed volume and removal rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RemovalFigures {
    /// Volume: the mean of the three families of rays.
    pub removed: f64,
    /// Difference between the volumes by the three families, a measure of the error.
    pub spread: f64,
    /// Time in which material was removed.
    pub cutting_time_s: f64,
    /// Mean removal rate over that time.
    pub rate_mean: f64,
    /// Largest removal rate, averaged over a quarter of a second and over a path of four ray distances.
    pub rate_max: f64,
}

/// Removed material of all blocks under one cut rule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RuleFigures {
    /// Rule, counted from 1; null for blocks without one.
    pub rule: Option<usize>,
    /// Material removed by these blocks.
    pub removal: RemovalFigures,
    /// Material removed by the original program.
    pub baseline: RemovalFigures,
}

/// Removed material of one block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BlockFigures {
    /// Number of blocks executed then, including this one.
    pub block: u32,
    /// N of the block.
    pub n: Option<i64>,
    /// Rule of the block, counted from 1.
    pub rule: Option<usize>,
    /// The results are those of the block's rapid moves.
    pub rapid: bool,
    /// Material removed by the block.
    pub removal: RemovalFigures,
    /// Material removed by the original program, if that has the same block.
    pub baseline: Option<RemovalFigures>,
}

/// Blocks that removed nothing in the model, because the position of the workpiece relative to the tool is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOutBlocks {
    /// Cause: `turning`, `other-position`, `no-machine`, `contour`; for loads also `tilted`, `backwards`.
    pub cause: &'static str,
    /// Number of blocks.
    pub blocks: usize,
    /// First of these blocks: number of blocks executed then, including it.
    pub first_block: u32,
    /// N of the first of them.
    pub first_n: Option<i64>,
}

/// Deviation of the remaining stock from the finished part, as heights above it; negative where too much was removed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DeviationFigures {
    /// Smallest deviation.
    pub min: f64,
    /// Largest deviation.
    pub max: f64,
    /// Root mean square of the deviations.
    pub rms: f64,
    /// Number of rays on which both bodies have a height.
    pub rays: usize,
    /// Deviation with the largest absolute value, of either sign.
    pub largest: f64,
    /// X of that deviation.
    pub x: f64,
    /// Y of that deviation.
    pub y: f64,
}

impl VolumeUnit {
    /// Units for a job in this length unit.
    pub fn of(unit: LengthUnit) -> Self {
        match unit {
            LengthUnit::Inch => {
                VolumeUnit { label: "in3", rate_label: "in3/min", mm3: unit.mm() * unit.mm() * unit.mm() }
            }
            LengthUnit::Mm => VolumeUnit { label: "cm3", rate_label: "cm3/min", mm3: MM3_PER_CM3 },
        }
    }

    /// Converts a volume, or a rate in mm3 per minute.
    pub fn of_mm3(&self, mm3: f64) -> f64 {
        mm3 / self.mm3
    }
}

impl MaterialFigures {
    /// Blocks that removed more than a cell between rays at rapid.
    pub fn rapids(&self, unit: LengthUnit) -> impl Iterator<Item = &BlockFigures> {
        let cell = VolumeUnit::of(unit).of_mm3((self.step * unit.mm()).powi(3));
        self.blocks.iter().filter(move |block| block.rapid && block.removal.removed > cell)
    }

    /// Warnings, one sentence each.
    pub fn warnings(&self, unit: LengthUnit) -> Vec<String> {
        let name = |block: u32, n: Option<i64>| n.map_or(format!("block {block}"), |n| format!("N{n}"));
        let at_rapid = self.rapids(unit).map(|block| {
            let BlockFigures { block, n, removal, .. } = block;
            let is_assumed = self.assumed_stock.is_some_and(|stock| stock.source != StockSource::Option);
            let of_stock = if is_assumed { " from the assumed stock" } else { "" };
            let block = name(*block, *n);
            format!("{block}: {} {} taken at rapid{of_stock}", short(removal.removed), self.volume_unit)
        });
        let mut warnings: Vec<String> = at_rapid.take(SHOWN).collect();
        if let more @ 1.. = self.rapids(unit).count().saturating_sub(SHOWN) {
            warnings.push(format!("{} more at rapid", counted(more, "block")));
        }
        warnings.extend(self.left_out.iter().map(|left_out| {
            let LeftOutBlocks { blocks, first_block, first_n, .. } = left_out;
            let first = name(*first_block, *first_n);
            let which = if *blocks == 1 { first } else { format!("{blocks} blocks from {first} on") };
            format!("{which} took no material: {}", left_out.words())
        }));
        warnings
    }
}

impl LeftOutBlocks {
    /// Cause in words for a person.
    pub fn words(&self) -> &'static str {
        match self.cause {
            "turning" => "rotary axes turn without G43.4: the path of the tool on the part is unknown",
            "other-position" => {
                "the rotary axes stand elsewhere than for the first cut, in whose coordinates the workpiece is; \
                 there material needs a [machine] whose rotary axes both turn the part, and chips are not computed"
            }
            "no-machine" => "under G43.4, and the job names no machine",
            "machine-position" => {
                "they go to a machine position (G28, G30, G53) or come from there, and how far that is from the workpiece is unknown: \
                 give the work offset in a settings file (--settings)"
            }
            "other-tool" => "the shape of the tool in the spindle is not given",
            "tilted" => "the tool is tilted, and a flexible workpiece or an engagement map needs an upright tool",
            "axis-turns" => "the tool's axis turns on the part, and chips are computed at a fixed axis only",
            "backwards" => "the spindle turns backwards (M4), and the edges are those of a tool for M3",
            _ => "under G41 or G42 with a D of no radius: the simulated control executes the contour as written",
        }
    }
}

/// Sentence about a stock without a job file: where it comes from, its extents, what to do about it.
fn stock_words(stock: &AssumedStock) -> String {
    let [x, y, z] = [0, 1, 2].map(|axis| [stock.from[axis], stock.to[axis]].map(short).join(" .. "));
    let (origin, advice) = match stock.source {
        StockSource::Option => ("stock as --stock gives it".to_owned(), ""),
        StockSource::Comment { line } => (format!("stock ASSUMED, as the comment in line {line} gives it"), TRUE_STOCK),
        StockSource::Extents => {
            ("stock ASSUMED, the cutting moves and the tool's radius about them".to_owned(), TRUE_STOCK)
        }
    };
    format!("{origin}: X {x}, Y {y}, Z {z}; the tool ASSUMED flat, cutting over that height{advice}")
}

impl fmt::Display for MaterialFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MaterialFigures { volume_unit, rate_unit, removal, left, .. } = self;
        if let Some(assumed) = &self.assumed_stock {
            writeln!(f, "  {}", stock_words(assumed))?;
        }
        writeln!(
            f,
            "  workpiece: {} {volume_unit} removed (its rays agree within {}), {} left",
            short(removal.removed),
            short(removal.spread),
            short(*left)
        )?;
        let columns = ["removed", "before, mean", "max", "after, mean", "max"];
        write!(f, "    {:<24}", format!("removal rate, {rate_unit}"))?;
        columns.iter().try_for_each(|column| write!(f, "{column:>14}"))?;
        writeln!(f)?;
        for RuleFigures { rule, removal, baseline } in &self.rules {
            write!(f, "    {:<24}", rule.map_or("other blocks".into(), |rule| format!("movement {rule}")))?;
            write_rates(f, removal, baseline)?;
        }
        write!(f, "    {:<24}", "all")?;
        write_rates(f, removal, &self.baseline)?;
        let (mib, per_mm3) = (self.memory_bytes as f64 / f64::from(1 << 20), self.bytes_per_mm3);
        writeln!(f, "    {} rays, {mib:.1} MiB, {per_mm3:.1} bytes/mm3", self.rays)?;
        if let Some(DeviationFigures { min, max, rms, largest, x, y, .. }) = &self.deviation {
            writeln!(f, "    from the target: {min:+.4} .. {max:+.4}, rms {rms:.4}; {largest:+.4} at X{x:.3} Y{y:.3}")?;
        }
        Ok(())
    }
}

fn write_rates(f: &mut fmt::Formatter<'_>, after: &RemovalFigures, before: &RemovalFigures) -> fmt::Result {
    let rates = [after.removed, before.rate_mean, before.rate_max, after.rate_mean, after.rate_max];
    rates.iter().try_for_each(|rate| write!(f, "{:>14}", short(*rate)))?;
    writeln!(f)
}

/// Number with four digits, or all digits before the point.
pub fn short(value: f64) -> String {
    let digits = match value.abs() {
        0.0 => 0,
        size => (3 - size.log10().floor() as i32).clamp(0, 9),
    };
    format!("{value:.*}", digits as usize)
}
