//! Settings of a control: the properties of a machine that are not in the program.
//!
//! The presets hold the standard values of the manuals; each value can be changed. Work offsets, tool lengths and
//! reference points are zero until they are set.

use super::motion::Pose;
use arcfeed_units::{LengthUnit, Nm};

/// Number of additional work coordinate systems whose origins are stored (G54.1 P1 to P48).
pub const ADDITIONAL_SYSTEMS: usize = 48;
/// Number of work coordinate systems whose origins are stored: G54 to G59, then the additional ones.
pub const SYSTEMS: usize = 6 + ADDITIONAL_SYSTEMS;
/// Highest number of a tool offset (H or D).
pub const OFFSETS: usize = 400;
/// Smallest number of blocks that a control reads together for cutter compensation.
pub const COMPENSATION_BLOCKS_MIN: u8 = 3;
/// Largest number of blocks that a control reads together for cutter compensation.
pub const COMPENSATION_BLOCKS_MAX: u8 = 8;

/// Treatment of deviations from the control's NC language.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// Accepts certain deviations, such as CAM titles and small letters, and reports them as notices, although a
    /// control may reject them.
    #[default]
    Lenient,
    /// Raises the same alarms as the control for every deviation.
    Strict,
}

/// Unit in which an axis word without a decimal point counts (parameter 3401, bit 0).
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
    /// Type A: the tool goes straight to the point at a right angle to the start of the contour's first move, and
    /// leaves straight from the one at the end of its last move.
    #[default]
    A,
    /// Type B: the tool goes around the corner as it does within the contour.
    B,
}

/// Meaning of the radius behind a D word to the program: the tool's radius, or only its wear (in CAM systems the type
/// of compensation).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CompensationType {
    /// The tool's radius: the program contains the contour of the part.
    #[default]
    Control,
    /// The wear: the program contains the path of the centre of an unworn tool.
    Wear,
}

/// Settings of cutter compensation (G41, G42).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CompensationSettings {
    /// Path of the tool at the start and the end of the compensation.
    pub start_up: StartUp,
    /// Number of blocks that the control reads together (parameter 19625 of a 31i), from [`COMPENSATION_BLOCKS_MIN`]
    /// to [`COMPENSATION_BLOCKS_MAX`]. Two of them move in the plane; the others may stand between them.
    pub blocks: u8,
    /// Meaning of the radius behind a D word to the program.
    pub of_program: CompensationType,
    /// Smallest factor, %, by which the control reduces F on arcs inside a contour (parameter 1710); `None` if the
    /// control does not reduce F there.
    pub inside_arc_least_percent: Option<u8>,
}

/// Point from which I, J and K of an arc count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArcCenters {
    /// The start of the arc, always; as on every control of the presets, which do not have G90.1 and G91.1.
    #[default]
    FromStart,
    /// The start of the arc (G91.1 is in force), until a G90.1.
    Incremental,
    /// The program's origin (G90.1 is in force), until a G91.1.
    Absolute,
}

/// Blocks that the program using this reader can execute; others are rejected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scope {
    /// At most one move in a block, along the tool centre's path, in the program's own coordinates. Anything else is
    /// rejected with its name.
    #[default]
    PlainMoves,
    /// The whole dialect: series of moves, shifted and rotated coordinates, contours under G41 and G42.
    Everything,
}

/// Properties of a control that decide how it reads a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Unit of lengths at power-on.
    pub unit: LengthUnit,
    /// Treatment of deviations from the control's NC language.
    pub reading: Reading,
    /// Unit in which an axis word without a decimal point counts.
    pub decimals: Decimals,
    /// Point from which I, J and K count at power-on.
    pub arc_centers: ArcCenters,
    /// Blocks that are accepted.
    pub scope: Scope,
    /// Largest number of digits of a sequence number N.
    pub sequence_digits: u8,
    /// Largest number of digits of a program number O.
    pub program_digits: u8,
    /// Number of additional work coordinate systems. Those after [`ADDITIONAL_SYSTEMS`] have no origin of their own here:
    /// it is zero, and G10 for them is refused.
    pub additional_systems: u16,
    /// Block-delete switches: bit n is 1 if that of `/n` is on.
    pub delete_switches: u16,
    /// G73: retraction after each peck (parameter 5114).
    pub peck_return: Nm,
    /// G83: height above the last depth at which rapid changes to feed (parameter 5115).
    pub peck_clearance: Nm,
    /// Positions of the first to fourth reference point in machine coordinates (parameters 1240 to 1243).
    pub reference: [Pose; 4],
    /// Cutter compensation.
    pub compensation: CompensationSettings,
}

/// Offsets of the control, which a program can read and, with G10, write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tables {
    /// Shift of all work coordinate systems (external offset, G10 L2 P0).
    pub external: Pose,
    /// Origins of the work coordinate systems in machine coordinates: G54 to G59, then G54.1 P1 and so on.
    pub systems: [Pose; SYSTEMS],
    /// Tool length offsets from H1 on, each as geometry and wear.
    pub lengths: [[Nm; 2]; OFFSETS],
    /// Cutter compensation offsets from D1 on, each as geometry and wear. The reader does not offset moves by them:
    /// the crate `arcfeed-compensation` does.
    pub radii: [[Nm; 2]; OFFSETS],
}

/// Series of the control, by which its standard settings are chosen.
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
    /// Origin of a work coordinate system in machine coordinates, with the external offset; `system` counts from 0 for
    /// G54.
    pub fn origin(&self, system: u16) -> Pose {
        self.systems.get(usize::from(system)).map_or(self.external, |origin| origin.plus(self.external))
    }

    /// Tool length offset of an H number, geometry plus wear; 0 for H0 and for numbers that the control does not have.
    pub fn length(&self, offset: u16) -> Nm {
        sum(&self.lengths, offset)
    }

    /// Cutter compensation offset of a D number, geometry plus wear; 0 for D0 and for numbers that the control does
    /// not have.
    pub fn radius(&self, offset: u16) -> Nm {
        sum(&self.radii, offset)
    }
}

/// Geometry and wear of an offset number.
fn sum(offsets: &[[Nm; 2]; OFFSETS], number: u16) -> Nm {
    let entry = usize::from(number).checked_sub(1).and_then(|index| offsets.get(index));
    entry.map_or(Nm(0), |[geometry, wear]| Nm(geometry.0.saturating_add(wear.0)))
}
