//! Errors and warnings about a path on a five-axis machine, found before the first cut.

use std::fmt;

use arcfeed_kinematics::branch_change::{BranchChange, BranchChangeMoves};
use arcfeed_kinematics::forward::Axes;
use arcfeed_kinematics::inverse::Unreachable;
use arcfeed_kinematics::machine::{AxisName, Letter};
use arcfeed_kinematics::singularity::{RepairOutcome, Singularity};
use serde::Serialize;

use crate::program::Severity;

/// 100 %.
const PERCENT: f64 = 100.0;

/// Last digit shown of a position.
const SHOWN: f64 = 1e-3;

/// Error or warning about a point of a path on a five-axis machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Line of the CL data or the program, counted from 1.
    pub line: usize,
    /// Kind of the error or warning.
    pub what: FindingKind,
}

/// Kind of an error or warning about a path on a five-axis machine.
#[derive(Clone, Debug, PartialEq)]
pub enum FindingKind {
    /// No positions of the rotary axes give the direction of the tool, at this point and at the `more` points after it.
    Unreachable {
        /// Reason.
        why: Unreachable,
        /// Number of further points in succession that cannot be reached.
        more: usize,
    },
    /// An axis would leave its range.
    OverLimit(AxisName),
    /// The rotary axes change to the other of their two solutions (branch) on the move to the point.
    Change(BranchChange, Box<BranchChangeMoves>),
    /// The program turns an axis that the machine lacks.
    NoAxis(Letter),
    /// A move of the program leads the rotary axes to the other of their two solutions (branch).
    Reversal {
        /// Positions of the rotary axes before the move.
        from_deg: [f64; 2],
        /// Positions of the rotary axes after the move.
        to_deg: [f64; 2],
        /// Largest angle between the tool's axis and the arc that it should follow, degrees.
        departure_deg: f64,
    },
    /// On the move here the tool's axis comes so close to a rotary axis (pole) that this axis may turn fast.
    Passage {
        /// Letter of that rotary axis.
        letter: Letter,
    },
    /// At the point the tool's axis is so close to a rotary axis (pole) that this axis is held.
    Pole {
        /// Letter of that axis.
        letter: Letter,
    },
    /// The tool's axis leaves the arc that it should follow, because the move has no intermediate points.
    Coarse {
        /// Angle by which it leaves the arc, degrees.
        departure_deg: f64,
    },
    /// End of fast rotation beside a pole (incoherent movement).
    Singularity {
        /// Interval of the path with that movement.
        found: Singularity,
        /// A repair was requested; the outcome is in `found`.
        asked: bool,
    },
    /// The axes cannot follow the programmed feed on this move.
    Feed {
        /// Number of moves of this kind; this is the slowest of them.
        moves: usize,
        /// Feed per minute that the axes permit on this move.
        feed_per_min: f64,
        /// Unit of that feed, as text.
        unit: &'static str,
        /// Permitted feed divided by the programmed one.
        asked_ratio: f64,
        /// Axis that limits the feed.
        axis: AxisName,
    },
}

/// Error or warning as an entry of the JSON output.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    line: usize,
    severity: Severity,
    kind: &'static str,
    message: String,
}

impl Finding {
    /// Severity: with an error the program must not be run.
    pub fn severity(&self) -> Severity {
        match &self.what {
            FindingKind::Unreachable { .. } | FindingKind::NoAxis(_) | FindingKind::OverLimit(_) => Severity::Error,
            FindingKind::Change(..) | FindingKind::Reversal { .. } => Severity::Error,
            _ => Severity::Warning,
        }
    }

    /// The finding as an entry of `--json`.
    pub fn entry(&self) -> Entry {
        let kind = match &self.what {
            FindingKind::Unreachable { .. } | FindingKind::NoAxis(_) => "unreachable",
            FindingKind::OverLimit(_) => "over-limit",
            FindingKind::Change(..) | FindingKind::Reversal { .. } => "branch-change",
            FindingKind::Pole { .. } | FindingKind::Passage { .. } => "pole",
            FindingKind::Coarse { .. } => "coarse",
            FindingKind::Singularity { .. } => "singularity",
            FindingKind::Feed { .. } => "feed",
        };
        Entry { line: self.line, severity: self.severity(), kind, message: self.what.to_string() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let level = if self.severity() == Severity::Error { "error" } else { "warning" };
        write!(f, "{}: {level}: {}", self.line, self.what)
    }
}

impl fmt::Display for FindingKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FindingKind::Unreachable { why, more } => {
                write!(f, "{why}; tilt the tool less, or clamp the part differently")?;
                if *more > 0 { write!(f, " (and {more} points after it)") } else { Ok(()) }
            }
            FindingKind::NoAxis(letter) => write!(f, "the machine has no axis {letter}"),
            FindingKind::OverLimit(axis @ AxisName::Rotary(_)) => {
                write!(f, "{axis} would leave its range; take the other branch, or another number of whole turns")
            }
            FindingKind::OverLimit(axis) => {
                write!(f, "{axis} would leave its range; move the part or take another tool length")
            }
            FindingKind::Change(change, way) => write_change(f, change, way),
            FindingKind::Reversal { from_deg: [from_0, from_1], to_deg: [to_0, to_1], departure_deg } => write!(
                f,
                "in this cut the rotary axes go from ({from_0:.3}, {from_1:.3}) to ({to_0:.3}, {to_1:.3}), to the other branch, and swing \
                 the tool by {departure_deg:.1} degrees; leave the part to reorient"
            ),
            FindingKind::Passage { letter } => {
                write!(
                    f,
                    "on the move here the tool axis comes to lie along {letter}: a pole, beside which that axis races"
                )
            }
            FindingKind::Pole { letter } => write!(f, "the tool axis lies along {letter}, which is held where it was"),
            FindingKind::Coarse { departure_deg } => {
                write!(
                    f,
                    "on the move here the tool axis leaves its arc by {departure_deg:.3} degrees; `post` adds points"
                )
            }
            FindingKind::Singularity { found, asked } => write_singularity(f, found, *asked),
            FindingKind::Feed { moves, feed_per_min, unit, asked_ratio, axis } => write!(
                f,
                "{axis} allows {feed_per_min:.1} {unit} here, {:.1} % of what is asked, the least of {moves} moves that ask for more \
                 than the axes do",
                asked_ratio * PERCENT
            ),
        }
    }
}

fn write_change(f: &mut fmt::Formatter<'_>, change: &BranchChange, way: &BranchChangeMoves) -> fmt::Result {
    let BranchChange { from_deg: [from_0, from_1], to_deg: [to_0, to_1], departure_deg, .. } = change;
    write!(
        f,
        "the rotary axes jump from ({from_0:.3}, {from_1:.3}) to ({to_0:.3}, {to_1:.3}) and would swing the tool by {departure_deg:.1} degrees"
    )?;
    match change.forced_by {
        Some((letter, _)) => write!(f, ", because {letter} comes to its end")?,
        None => f.write_str(", which is the shorter way")?,
    }
    f.write_str("; instead:")?;
    for (name, at) in [
        ("retract to", way.retract),
        ("clear", way.clear),
        ("reorient", way.reorient),
        ("return above", way.above),
        ("into the cut", way.back),
    ] {
        write_axes(f, name, &at)?;
    }
    Ok(())
}

fn write_axes(f: &mut fmt::Formatter<'_>, name: &str, axes: &Axes) -> fmt::Result {
    // Removes the sign of a value that rounds to 0.
    let plain = |value: f64| libm::round(value / SHOWN) * SHOWN + 0.0;
    let ([x, y, z], [first, second]) = (axes.linear_mm.map(plain), axes.rotary_deg.map(plain));
    write!(f, " {name} ({x:.3}, {y:.3}, {z:.3}; {first:.3}, {second:.3})")
}

fn write_singularity(f: &mut fmt::Formatter<'_>, found: &Singularity, asked: bool) -> fmt::Result {
    write!(
        f,
        "up to here the first rotary axis races beside the pole, {:.0} degrees a degree of the tool",
        found.gain_ratio
    )?;
    if found.is_incoherent() {
        write!(f, ", and turns {:.1} degrees there and back", found.reversal_deg / 2.0)?;
    }
    f.write_str("; ")?;
    let error = found.error_deg;
    match found.outcome {
        RepairOutcome::Refused if !asked => write!(f, "--repair would turn the tool axis by {error:.4} degrees"),
        RepairOutcome::Repaired => write!(f, "repaired by turning the tool axis by up to {error:.4} degrees"),
        RepairOutcome::Refused => {
            write!(f, "not repaired, as the tool is no ball end mill and would turn by {error:.4} degrees")
        }
        RepairOutcome::NoRoom => f.write_str("no repair, as the path begins or ends too close by"),
    }
}
