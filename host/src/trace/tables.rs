//! Tables of a run: a row each millisecond, a row for each pass of a tooth, a row for each block.
//!
//! Units are the same in every trace, whatever the job's: mm, degrees, s, min, N, N m, W.

use super::table::{Table, TableColumn};

/// Number of columns of [`SAMPLES`].
pub const SAMPLE_COLUMNS: usize = 27;

/// Number of columns of [`TEETH`].
pub const TOOTH_COLUMNS: usize = 13;

/// Number of columns of [`BLOCKS`].
pub const BLOCK_COLUMNS: usize = 30;

const BLOCK: TableColumn<'_> = TableColumn::integer("block", "blocks executed, up to and including this one");
const N: TableColumn<'_> = TableColumn::integer("n", "N of the block");
const LINE: TableColumn<'_> = TableColumn::integer("line", "line of the program's file, from 1");
const RULE: TableColumn<'_> = TableColumn::integer("rule", "cut rule of the job that governs the move, from 1");
const IS_RAPID: TableColumn<'_> = TableColumn::flag("is_rapid", "the move is a rapid");
const TARGET: TableColumn<'_> = TableColumn::number("target_chip_mm", "mm", "target of the measured quantity");

/// Table of samples: state of the run at the end of each millisecond.
pub const SAMPLES: Table<'_> = Table {
    name: "samples",
    suffix: "",
    columns: &[
        TableColumn::number("time_s", "s", "simulated time since power-on of the control"),
        BLOCK,
        N,
        LINE,
        RULE,
        IS_RAPID,
        TableColumn::number("x_commanded_mm", "mm", "commanded X in the program's coordinates"),
        TableColumn::number("y_commanded_mm", "mm", "commanded Y"),
        TableColumn::number("z_commanded_mm", "mm", "commanded Z"),
        TableColumn::number("a_commanded_deg", "deg", "commanded A"),
        TableColumn::number("b_commanded_deg", "deg", "commanded B"),
        TableColumn::number("c_commanded_deg", "deg", "commanded C"),
        TableColumn::number("x_mm", "mm", "actual X: behind the commanded one if the machine's drives lag"),
        TableColumn::number("y_mm", "mm", "actual Y"),
        TableColumn::number("z_mm", "mm", "actual Z"),
        TableColumn::number("a_deg", "deg", "actual A"),
        TableColumn::number("b_deg", "deg", "actual B"),
        TableColumn::number("c_deg", "deg", "actual C"),
        TableColumn::number("feed_mm_per_min", "mm/min", "speed along the commanded path"),
        TableColumn::number("wanted_feed_mm_per_min", "mm/min", "F times override; 0 at rapid and at rest"),
        TableColumn::percent("override_percent", "feed override that the control applies"),
        TableColumn::text("state", "state of the feed controller"),
        TableColumn::text("reason", "reason of the override that the feed controller puts out"),
        TableColumn::number("spindle_rev_per_min", "rev/min", "speed of the spindle"),
        TARGET,
        TableColumn::number("chip_mm", "mm", "measured quantity of the tooth that this millisecond completes"),
        TableColumn::flag("is_steady", "this tooth was cut at the commanded feed all along"),
    ],
};

/// Table of tooth passes: one row for each way of a tooth through the material.
pub const TEETH: Table<'_> = Table {
    name: "teeth",
    suffix: "-teeth",
    columns: &[
        TableColumn::number("time_s", "s", "time of the thickest chip"),
        BLOCK,
        N,
        LINE,
        RULE,
        TableColumn::integer("tooth", "tooth, from 1"),
        TableColumn::text("edge", "circle on which the tooth cuts: outer, inner"),
        TableColumn::number("chip_mm", "mm", "thickest chip of the pass"),
        TableColumn::number("force_n", "N", "largest force of all teeth across the tool's axis during the pass"),
        TableColumn::number("torque_n_m", "N m", "largest torque of all teeth during the pass"),
        TableColumn::number("x_mm", "mm", "X of the tool's tip at the thickest chip, in the workpiece's coordinates"),
        TableColumn::number("y_mm", "mm", "Y of the tip"),
        TableColumn::number("z_mm", "mm", "Z of the tip"),
    ],
};

/// Table of blocks: one row for each block that moves axes, with its results.
pub const BLOCKS: Table<'_> = Table {
    name: "blocks",
    suffix: "-blocks",
    columns: &[
        BLOCK,
        N,
        LINE,
        RULE,
        IS_RAPID,
        TableColumn::number("begin_s", "s", "time at which the first millisecond of the block begins"),
        TableColumn::number("end_s", "s", "time at which its last millisecond ends"),
        TableColumn::number("feed_max_mm_per_min", "mm/min", "largest speed along the commanded path"),
        TableColumn::percent("override_min_percent", "smallest override"),
        TableColumn::percent("override_max_percent", "largest override"),
        TableColumn::integer("override_changes", "number of changes of the override in the block"),
        TARGET,
        TableColumn::number("chip_min_mm", "mm", "smallest measured quantity of the steady samples"),
        TableColumn::number("chip_max_mm", "mm", "largest measured quantity of the steady samples"),
        TableColumn::number("chip_max_all_mm", "mm", "largest measured quantity of all samples"),
        TableColumn::number(
            "chip_rms_error_ratio",
            "1",
            "root mean square of (measured - target) / target, steady samples",
        ),
        TableColumn::integer("samples", "steady samples"),
        TableColumn::integer("samples_thin", "steady samples more than 2 % below the target"),
        TableColumn::integer("samples_not_steady", "samples left out: not at the commanded feed all along"),
        TableColumn::integer("samples_block_end", "samples left out: the block ended within the tooth's cut"),
        TableColumn::integer("samples_no_contact", "samples left out: no admissible contact"),
        TableColumn::number("removed_mm3", "mm3", "volume of material removed"),
        TableColumn::number("cutting_s", "s", "time during which an edge had a chip"),
        TableColumn::number("force_max_n", "N", "largest force across the tool's axis"),
        TableColumn::number("force_mean_n", "N", "its mean over the time of cutting"),
        TableColumn::number("torque_max_n_m", "N m", "largest torque"),
        TableColumn::number("torque_mean_n_m", "N m", "its mean over the time of cutting"),
        TableColumn::number("power_max_w", "W", "largest power of the spindle"),
        TableColumn::number("power_mean_w", "W", "its mean over the time of cutting"),
        TableColumn::number("tooth_chip_max_mm", "mm", "thickest chip of a tooth on the tool's side"),
    ],
};

const _: () = {
    assert!(SAMPLES.columns.len() == SAMPLE_COLUMNS);
    assert!(TEETH.columns.len() == TOOTH_COLUMNS);
    assert!(BLOCKS.columns.len() == BLOCK_COLUMNS);
};
