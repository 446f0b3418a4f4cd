//! How one control is set: what differs from machine to machine and is not in the program.
//!
//! The presets hold what the manuals call standard; each value can be changed. Work offsets, tool lengths and reference
//! points are zero until they are told.

use super::motion::Pose;
use crate::units::{LengthUnit, Nm};

/// Additional work coordinate systems (G54.1 P1 to P48).
pub const ADDITIONAL_SYSTEMS: usize = 48;
/// Work coordinate systems: G54 to G59, then the additional ones.
pub const SYSTEMS: usize = 6 + ADDITIONAL_SYSTEMS;
/// Highest tool offset number.
pub const OFFSETS: usize = 400;

/// How a line is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// What a control would refuse in titles and comments is only noticed.
    #[default]
    Lenient,
    /// Exactly as the control.
    Strict,
}

/// What an axis word without a decimal point counts in (parameter 3401, bit 0).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decimals {
    /// Least increments: 0.001 mm, 0.0001 in, 0.001 degrees.
    #[default]
    LeastIncrement,
    /// Whole units, as a pocket calculator takes it: mm, inches, degrees, seconds.
    Calculator,
}

/// What the reader's user can carry out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scope {
    /// At most one move a block, along the tool centre's path, in the program's own coordinates; anything else is refused
    /// by name.
    #[default]
    PlainMoves,
    /// Everything the dialect has: series of moves, shifted and turned coordinates, contours under G41 and G42.
    Everything,
}

/// The settings of a control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// In effect at power-on.
    pub unit: LengthUnit,
    /// Lenient or strict.
    pub reading: Reading,
    /// See [`Decimals`].
    pub decimals: Decimals,
    /// See [`Scope`].
    pub scope: Scope,
    /// Most digits of N.
    pub sequence_digits: u8,
    /// Most digits of O.
    pub program_digits: u8,
    /// Block-delete switches that are on: bit n for `/n`.
    pub delete_switches: u16,
    /// G73: the way back after each cut (parameter 5114).
    pub peck_return: Nm,
    /// G83: how far above the last depth rapid turns to feed (parameter 5115).
    pub peck_clearance: Nm,
    /// Machine coordinates of the reference points, first to fourth (parameters 1240 to 1243).
    pub reference: [Pose; 4],
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
    /// Cutter compensation by D, geometry and wear, from D1. Nothing here moves by them: the control offsets contours.
    pub radii: [[Nm; 2]; OFFSETS],
}

/// A number of this control, as on its name plate.
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
        let (sequence_digits, program_digits) = match preset {
            Preset::Fanuc16i | Preset::Fanuc0i => (5, 4),
            Preset::Fanuc31i => (8, 8),
        };
        let nowhere = Pose::ORIGIN;
        Settings {
            unit,
            reading,
            decimals: Decimals::LeastIncrement,
            scope: Scope::PlainMoves,
            sequence_digits,
            program_digits,
            delete_switches: 0,
            peck_return: Nm(1_000_000),
            peck_clearance: Nm(1_000_000),
            reference: [nowhere; 4],
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

    /// The length compensation of an H number; nothing for H0 and those the control does not have.
    pub fn length(&self, offset: u16) -> Nm {
        let entry = usize::from(offset).checked_sub(1).and_then(|index| self.lengths.get(index));
        entry.map_or(Nm(0), |[geometry, wear]| Nm(geometry.0.saturating_add(wear.0)))
    }
}
