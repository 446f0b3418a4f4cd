//! Settings of a control: the properties of a machine that are not in the program.
//!
//! The presets hold the standard values of the manuals; each value can be changed. Work offsets, tool lengths and
//! reference points are zero until they are set.

use super::motion::Pose;
use arcfeed_units::{LengthUnit, Nm};

/// Additional work coordinate systems with an origin in the tables (G54.1 P1 to P48).
pub const ADDITIONAL_SYSTEMS: usize = 48;
/// Work coordinate systems: G54 to G59, then the additional ones.
pub const SYSTEMS: usize = 6 + ADDITIONAL_SYSTEMS;
/// Highest tool offset number.
pub const OFFSETS: usize = 400;
/// Fewest blocks that a control reads together for cutter compensation.
pub const COMPENSATION_BLOCKS_MIN: u8 = 3;
/// Most blocks that a control reads together for cutter compensation.
pub const COMPENSATION_BLOCKS_MAX: u8 = 8;

/// Strictness of the reader towards deviations from the dialect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// Reports deviations in titles and comments as notices, although a control would reject them.
    #[default]
    Lenient,
    /// Raises the same alarms as the control.
    Strict,
}

/// Unit of an axis word without a decimal point (parameter 3401, bit 0).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decimals {
    /// Least increments: 0.001 mm, 0.0001 in, 0.001 degrees.
    #[default]
    LeastIncrement,
    /// Whole units ("calculator type" input): mm, inches, degrees, seconds.
    Calculator,
}

/// Path at the start and the end of cutter compensation at an outer corner (parameter 5003, bit 0, SUP).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StartUp {
    /// The tool goes straight to, or leaves from, the normal of the contour's block.
    #[default]
    A,
    /// The tool goes around the corner as within the contour.
    B,
}

/// Meaning of the radius of a D that the program assumes: tool radius or wear (in CAM systems the type of
/// compensation).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CompensationType {
    /// Radius of the tool: the program has the contour of the part.
    #[default]
    Control,
    /// Wear: the program has the path of the tool centre.
    Wear,
}

/// Settings of cutter compensation (G41, G42).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CompensationSettings {
    /// Start-up and cancel.
    pub start_up: StartUp,
    /// Blocks that the control reads together (parameter 19625 of a 31i): at most [`COMPENSATION_BLOCKS_MAX`]. Two of them
    /// move in the plane, the others may lie between them.
    pub blocks: u8,
    /// Meaning of the radius of a D.
    pub of_program: CompensationType,
    /// Least feed on arcs inside a contour over F, % (parameter 1710); `None`: the control does not reduce the feed there.
    pub inside_arc_least_percent: Option<u8>,
}

/// Reference of I, J and K.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArcCenters {
    /// The start of the arc, as on every control of the presets; they do not have G90.1 and G91.1.
    #[default]
    FromStart,
    /// The start of the arc (G91.1), until a G90.1.
    Incremental,
    /// The program's origin (G90.1), until a G91.1.
    Absolute,
}

/// Set of blocks that the user of the reader can execute.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scope {
    /// At most one move per block, along the tool centre's path, in the program's own coordinates; anything else is
    /// rejected with its name.
    #[default]
    PlainMoves,
    /// The whole dialect: series of moves, shifted and rotated coordinates, contours under G41 and G42.
    Everything,
}

/// Settings of a control that affect how it reads a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Unit at power-on.
    pub unit: LengthUnit,
    /// Strictness of the reader.
    pub reading: Reading,
    /// Unit of axis words without a decimal point.
    pub decimals: Decimals,
    /// Reference of I, J and K at power-on.
    pub arc_centers: ArcCenters,
    /// Set of accepted blocks.
    pub scope: Scope,
    /// Maximum number of digits of N.
    pub sequence_digits: u8,
    /// Maximum number of digits of O.
    pub program_digits: u8,
    /// Number of additional work coordinate systems. Those after [`ADDITIONAL_SYSTEMS`] have no origin of their own here:
    /// it is zero, and G10 for them is refused.
    pub additional_systems: u16,
    /// Block-delete switches that are on: bit n for `/n`.
    pub delete_switches: u16,
    /// G73: retraction after each peck (parameter 5114).
    pub peck_return: Nm,
    /// G83: height above the last depth at which rapid changes to feed (parameter 5115).
    pub peck_clearance: Nm,
    /// Machine coordinates of the reference points, first to fourth (parameters 1240 to 1243).
    pub reference: [Pose; 4],
    /// Cutter compensation.
    pub compensation: CompensationSettings,
}

/// Offsets that a program can read and, with G10, write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tables {
    /// Shift of all work coordinate systems (G10 L2 P0).
    pub external: Pose,
    /// G54 to G59, then G54.1 P1 on: the system's origin in machine coordinates.
    pub systems: [Pose; SYSTEMS],
    /// Length compensation by H, geometry and wear, from H1.
    pub lengths: [[Nm; 2]; OFFSETS],
    /// Cutter compensation by D, geometry and wear, from D1. It does not shift moves here: `arcfeed-compensation`
    /// offsets contours.
    pub radii: [[Nm; 2]; OFFSETS],
}

/// Series of the control, for its standard settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Series 16i/18i/21i-M.
    Fanuc16i,
    /// Series 0i-M.
    Fanuc0i,
    /// Series 30i/31i/32i.
    Fanuc31i,
}

impl Settings {
    /// Standard settings of a control.
    pub const fn preset(preset: Preset, unit: LengthUnit, reading: Reading) -> Self {
        let (sequence_digits, program_digits, additional_systems) = match preset {
            Preset::Fanuc16i | Preset::Fanuc0i => (5, 4, ADDITIONAL_SYSTEMS as u16),
            Preset::Fanuc31i => (8, 8, 300),
        };
        let nowhere = Pose::ORIGIN;
        Settings {
            unit,
            reading,
            decimals: Decimals::LeastIncrement,
            arc_centers: ArcCenters::FromStart,
            scope: Scope::PlainMoves,
            sequence_digits,
            program_digits,
            additional_systems,
            delete_switches: 0,
            peck_return: Nm(1_000_000),
            peck_clearance: Nm(1_000_000),
            reference: [nowhere; 4],
            compensation: CompensationSettings {
                start_up: StartUp::A,
                blocks: COMPENSATION_BLOCKS_MIN,
                of_program: CompensationType::Control,
                inside_arc_least_percent: None,
            },
        }
    }

    /// Whether the block-delete switch of `/n` is on.
    pub const fn deletes(&self, switch: u8) -> bool {
        self.delete_switches >> switch & 1 == 1
    }
}

impl Default for Tables {
    fn default() -> Self {
        Tables {
            external: Pose::ORIGIN,
            systems: [Pose::ORIGIN; SYSTEMS],
            lengths: [[Nm(0); 2]; OFFSETS],
            radii: [[Nm(0); 2]; OFFSETS],
        }
    }
}

impl Tables {
    /// The origin of a work coordinate system in machine coordinates.
    pub fn origin(&self, system: u16) -> Pose {
        self.systems.get(usize::from(system)).map_or(self.external, |origin| origin.plus(self.external))
    }

    /// Length compensation of an H number; 0 for H0 and for numbers that the control does not have.
    pub fn length(&self, offset: u16) -> Nm {
        sum(&self.lengths, offset)
    }

    /// Cutter compensation of a D number; 0 for D0 and for numbers that the control does not have.
    pub fn radius(&self, offset: u16) -> Nm {
        sum(&self.radii, offset)
    }
}

/// Geometry and wear of an offset number.
fn sum(offsets: &[[Nm; 2]; OFFSETS], number: u16) -> Nm {
    let entry = usize::from(number).checked_sub(1).and_then(|index| offsets.get(index));
    entry.map_or(Nm(0), |[geometry, wear]| Nm(geometry.0.saturating_add(wear.0)))
}
