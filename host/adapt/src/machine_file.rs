//! A five-axis machine as a file (docs/kinematics.md).
//!
//! ```toml
//! name = "..."
//! tool = [0, 0, 1]          # from the tip to the holder, all axes at zero; this unless given
//! [[rotary]]                # two, in the order from the part to the tool
//! letter = "C"              # A, B or C: its address in the program
//! carries = "part"          # an axis of the table; "tool": of the head
//! direction = [0, 0, 1]     # positive turns the tool relative to the part about it, by the right-hand rule
//! point = [0, 0, 0]         # mm; a point on the axis, all axes at zero. Table: machine frame; head: from the gauge point
//! range = [-120, 30]        # degrees; turns for ever unless given
//! resolution = 0.001        # degrees
//! max_feed = 5400           # degrees per minute; no limit known unless given
//! acceleration = 500        # degrees/s^2 and
//! jerk = 5000               # degrees/s^3: of all axes or of none; the simulated control keeps to them (docs/drives.md)
//! [linear.X]                # and Y and Z: mm, mm per minute
//! range = [0, 710]
//! resolution = 0.001
//! max_feed = 20000
//! acceleration = 2000       # mm/s^2
//! jerk = 20000              # mm/s^3
//! [corners]                 # how far the control may cut them: mm, degrees; these unless given
//! linear = 0.01
//! rotary = 0.01
//! [servo]                   # without it the axes are where they are commanded to (docs/servo.md)
//! gain = 33                 # 1/s
//! feed_forward = 0          # 0 to 1; 0 unless given
//! in_position = 0.01        # mm, degrees; this unless given
//! spindle_range = [50, 6000] # rev/min; not compared with anything unless given; stands above the tables
//! [spindle]                 # without it the spindle turns as the job has it
//! run_up = 2000             # rev/min each second
//! run_down = 2000
//! arrival = 0.05            # of the commanded speed; this unless given
//! waits = false             # whether cutting feed waits for the speed to have arrived
//! ```

pub mod drives;

mod presets;

use std::path::Path;

use arcfeed_kinematics::machine::{AxisName, Carries, Letter, LinearAxis, Machine, MachineError, RotaryAxis};
use serde::Deserialize;
use toml::Spanned;

use crate::files;
use crate::key_values::{KeyValue, with_values};
use crate::place::place;
use crate::toml_reader;
use crate::toml_values::with_key;

use drives::{DriveError, DriveValues, Drives, Loops, SpindleRamps, Tolerance};

/// Five-axis machine as described by a file or a preset.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineFile {
    /// Name that the file states.
    pub name: String,
    /// Kinematic chain: rotary axes, ranges and resolutions of all axes.
    pub machine: Machine,
    /// Limits of the drives (speed, acceleration, jerk); `None` if the file does not have them.
    pub drives: Option<Drives>,
    /// Position control loops of the axes; `None` if the file does not describe them.
    pub servo: Option<Loops>,
    /// Acceleration and deceleration of the spindle; `None` if the file does not describe them.
    pub spindle: Option<SpindleRamps>,
    /// Lowest and highest spindle speed, rev/min; `None` if the file does not have them.
    pub spindle_range_rev_per_min: Option<[f64; 2]>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MachineTable {
    name: String,
    tool: Option<[f64; 3]>,
    spindle_range: Option<Spanned<[f64; 2]>>,
    rotary: [Spanned<RotaryTable>; 2],
    linear: LinearTables,
    #[serde(default)]
    corners: Tolerance,
    servo: Option<Spanned<Loops>>,
    spindle: Option<Spanned<SpindleRamps>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RotaryTable {
    letter: LetterWord,
    carries: CarriesWord,
    direction: [f64; 3],
    point: [f64; 3],
    range: Option<[f64; 2]>,
    resolution: f64,
    max_feed: Option<f64>,
    acceleration: Option<f64>,
    jerk: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "axes are named as in a program")]
struct LinearTables {
    X: Spanned<LinearTable>,
    Y: Spanned<LinearTable>,
    Z: Spanned<LinearTable>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LinearTable {
    range: Option<[f64; 2]>,
    resolution: f64,
    max_feed: Option<f64>,
    acceleration: Option<f64>,
    jerk: Option<f64>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
enum LetterWord {
    A,
    B,
    C,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum CarriesWord {
    Part,
    Tool,
}

impl MachineFile {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// Describes the fault as `file:line:column: message`, or the file cannot be read.
    pub fn load(path: &Path) -> Result<Self, String> {
        Self::load_with(path, &[])
    }

    /// Reads and checks a file in which `values` replace its own values.
    ///
    /// # Errors
    /// As [`MachineFile::load`].
    pub fn load_with(path: &Path, values: &[KeyValue]) -> Result<Self, String> {
        let shown = path.display();
        let text = files::read_to_string(path).map_err(|error| format!("{shown}: {error}"))?;
        let text = with_values(&text, values).map_err(|error| format!("{shown}: {error}"))?;
        Self::parse(&text).map_err(|error| format!("{shown}:{error}"))
    }

    /// Checks a machine given as text.
    ///
    /// # Errors
    /// Describes the fault as `line:column: message`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let at = |offset: usize, message: String| {
            let [line, column] = place(text, offset);
            format!("{line}:{column}: {}", with_key(text, offset, &message))
        };
        let table: MachineTable = toml_reader::read(text).map_err(|(offset, message)| at(offset, message))?;
        let LinearTables { X, Y, Z } = &table.linear;
        let linear = [X, Y, Z].map(|axis| linear_axis(axis.as_ref()));
        let rotary = table.rotary.each_ref().map(|axis| rotary_axis(axis.as_ref()));
        let machine = Machine::new(rotary, linear, table.tool.unwrap_or([0.0, 0.0, 1.0]));
        let machine = machine.map_err(|error| at(table.offset_of(&error), error.to_string()))?;
        let drives = Drives::new(table.drive_values(), table.corners)
            .map_err(|error| at(table.offset_of_drive(error), error.to_string()))?;
        let possible = |is_possible: bool, offset: usize, what: &str| {
            if is_possible { Ok(()) } else { Err(at(offset, what.into())) }
        };
        if let Some(servo) = &table.servo {
            let what = "`gain` and `in_position` must be above zero, `feed_forward` from 0 to 1";
            possible(servo.as_ref().are_possible(), servo.span().start, what)?;
        }
        if let Some(spindle) = &table.spindle {
            let what = "`run_up`, `run_down` and `arrival` must be above zero";
            possible(spindle.as_ref().are_possible(), spindle.span().start, what)?;
        }
        if let Some(range) = &table.spindle_range {
            let [low, high] = *range.as_ref();
            let what = "`spindle_range` must be [least, largest] speed in rev/min, not below zero";
            possible(0.0 <= low && low < high, range.span().start, what)?;
        }
        let spindle_range_rev_per_min = table.spindle_range.map(Spanned::into_inner);
        let (servo, spindle) = (table.servo.map(Spanned::into_inner), table.spindle.map(Spanned::into_inner));
        Ok(MachineFile { name: table.name, machine, drives, servo, spindle, spindle_range_rev_per_min })
    }
}

impl MachineTable {
    /// Drive values of X, Y, Z and the rotary axes.
    fn drive_values(&self) -> [DriveValues; 5] {
        let LinearTables { X, Y, Z } = &self.linear;
        let [x, y, z] = [X, Y, Z].map(|axis| axis.as_ref()).map(|axis| [axis.max_feed, axis.acceleration, axis.jerk]);
        let [first, second] =
            self.rotary.each_ref().map(|axis| axis.as_ref()).map(|axis| [axis.max_feed, axis.acceleration, axis.jerk]);
        [x, y, z, first, second]
    }

    /// Byte offset of the axis with the faulty drive.
    fn offset_of_drive(&self, error: DriveError) -> usize {
        let LinearTables { X, Y, Z } = &self.linear;
        match error {
            DriveError::Axis(axis @ 0..3) => [X, Y, Z][axis].span().start,
            DriveError::Axis(3) => self.rotary[0].span().start,
            DriveError::Axis(_) => self.rotary[1].span().start,
            DriveError::Tolerance => 0,
        }
    }

    /// Byte offset of the axis that an error is about.
    fn offset_of(&self, error: &MachineError) -> usize {
        let [first, second] = &self.rotary;
        let LinearTables { X, Y, Z } = &self.linear;
        match *error {
            MachineError::Range(AxisName::Linear(at)) | MachineError::NotPositive(AxisName::Linear(at)) => {
                [X, Y, Z].get(at).map_or(0, |axis| axis.span().start)
            }
            MachineError::Range(AxisName::Rotary(letter))
            | MachineError::NotPositive(AxisName::Rotary(letter))
            | MachineError::TooWide(letter) => {
                let is_first = rotary_axis(first.as_ref()).letter == letter;
                if is_first { first.span().start } else { second.span().start }
            }
            MachineError::NoDirection if first.as_ref().direction.iter().any(|part| *part != 0.0) => {
                second.span().start
            }
            MachineError::NoDirection => first.span().start,
            MachineError::Parallel { .. } | MachineError::Order | MachineError::SameLetter(_) => second.span().start,
        }
    }
}

fn rotary_axis(table: &RotaryTable) -> RotaryAxis {
    RotaryAxis {
        letter: match table.letter {
            LetterWord::A => Letter::A,
            LetterWord::B => Letter::B,
            LetterWord::C => Letter::C,
        },
        carries: match table.carries {
            CarriesWord::Part => Carries::Part,
            CarriesWord::Tool => Carries::Tool,
        },
        direction: table.direction,
        point_mm: table.point,
        range_deg: table.range,
        resolution_deg: table.resolution,
        speed_deg_per_min: table.max_feed,
    }
}

fn linear_axis(table: &LinearTable) -> LinearAxis {
    LinearAxis { range_mm: table.range, resolution_mm: table.resolution, speed_mm_per_min: table.max_feed }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINEAR: &str =
        "[linear]\nX = { resolution = 0.001 }\nY = { resolution = 0.001 }\nZ = { resolution = 0.001 }\n";

    fn rotary(letter: char, direction: &str, more: &str) -> String {
        format!(
            "[[rotary]]\nletter = '{letter}'\ncarries = 'part'\ndirection = {direction}\npoint = [0, 0, 0]\n\
             resolution = 0.001\n{more}\n"
        )
    }

    #[test]
    fn what_makes_no_machine_is_said() {
        let [c, a] = [rotary('C', "[0, 0, 1]", ""), rotary('A', "[1, 0, 0]", "")];
        assert!(MachineFile::parse(&format!("name = 'm'\n{c}{a}{LINEAR}")).is_ok());
        for (axes, expected) in [
            (c.clone(), "2:1: invalid length 1"),
            (format!("{a}{c}"), "parallel"),
            (format!("{c}{}", rotary('C', "[1, 0, 0]", "")), "both rotary axes are called C"),
            (format!("{c}{}", rotary('A', "[0, 0, 0]", "")), "no length"),
            (format!("{c}{}", rotary('A', "[1, 0, 0]", "range = [5, -95]")), "9:1: the range of A"),
            (format!("{c}{}", rotary('A', "[1, 0, 0]", "range = [-9999, 9999]")), "wider than 16 turns"),
            (format!("{c}{}", rotary('A', "[1, 0, 0]", "max_feed = 0")), "A must be above zero"),
            (format!("{c}{}", rotary('A', "[1, 0, 0]", "colour = 1")), "15:1: unknown field `colour`"),
            (format!("{}{a}", c.replace("part", "tool")), "table before head"),
            (format!("{c}{a}[servo]\ngain = 0\n"), "16:1: `gain` and `in_position` must be above zero"),
            (format!("{c}{a}[spindle]\nrun_up = 0\nrun_down = 1\n"), "16:1: `run_up`, `run_down` and `arrival`"),
            (format!("spindle_range = [6000, 50]\n{c}{a}"), "2:17: `spindle_range` must be [least, largest]"),
            (format!("{c}{}", rotary('A', "[1, 0, 0]", "max_feed = 5\njerk = 9")), "each needs `max_feed`"),
        ] {
            let error = MachineFile::parse(&format!("name = 'm'\n{axes}{LINEAR}")).unwrap_err();
            assert!(error.contains(expected), "{error}");
        }
    }
}
