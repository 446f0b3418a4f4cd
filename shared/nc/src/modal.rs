//! The modal state of the control, and the effect of a block ([`Modal::interpret`], in `nc/interpret.rs`).
//!
//! F is in whole millimetres or inches per minute (`F25` is 25 in/min under G20). [`super::settings::Decimals`] gives
//! the unit of axis words without a decimal point.

pub use super::motion::{
    Center, CompensationSide, Corner, Feed, FeedMode, Motion, MotionKind, PER_MIN_SCALE, Plane, Pose, ProgramStop, Turn,
};

use super::alarm::NotModelled;
use super::frame::{CoordinateFrame, CoordinateRotation};
use super::machining::{Machining, MachiningState};
pub use super::series::Polar;
use super::series::Series;
use super::settings::{ArcCenters, Tables};
use arcfeed_units::{LengthUnit, Micros, Nm};

/// The modal state that a block inherits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modal {
    /// G20 / G21.
    pub unit: LengthUnit,
    /// G17 / G18 / G19.
    pub plane: Plane,
    /// G90 / G91.
    pub absolute: bool,
    /// G90.1 / G91.1, on a control that has them.
    pub arc_centers: ArcCenters,
    /// G0 / G1 / G2 / G3.
    pub motion: MotionKind,
    /// G93 / G94 / G95.
    pub feed_mode: FeedMode,
    /// The last F given under G94 (per minute) or G95 (per revolution), if any; a change of the feed mode clears it.
    pub feed: Option<Nm>,
    /// The last S, rev/min.
    pub spindle: Option<i64>,
    /// State of T and M: the tool in the spindle, and whether the spindle turns.
    pub machining_state: MachiningState,
    /// Position of the tool centre in path coordinates (see [`super::frame`]).
    pub position: Pose,
    /// The same position in program coordinates.
    pub program: Pose,
    /// Transformation from program to path coordinates.
    pub frame: CoordinateFrame,
    /// G54 to G59 (0 to 5), G54.1 P1 on (6 on).
    pub system: u16,
    /// G52.
    pub local: Pose,
    /// G92.
    pub preset: Pose,
    /// G41 / G42.
    pub compensation: Option<CompensationSide>,
    /// G41, G42 or G40 was given after the last move in the plane.
    pub starts_up: bool,
    /// G43 (1), G44 (-1), G49 (0).
    pub length_sign: i8,
    /// Number of the tool length offset (H).
    pub length_offset: u16,
    /// Number of the cutter compensation offset (D).
    pub radius_offset: u16,
    /// G73 to G89.
    pub cycle: Option<Cycle>,
    /// G99.
    pub returns_to_r: bool,
    /// G16: polar coordinates of the last point.
    pub polar: Option<Polar>,
    /// The G code of a tilted plane in force, in tenths, under which no move is modelled; 0 for none.
    pub unmodelled: u16,
    /// G43.4 in force.
    pub follows_tool_center: bool,
    /// G68 or G69 has rotated the plane, and no move has named both its axes since then.
    pub rotation_pending: bool,
    /// The last move ends in a chamfer or a rounded corner, which needs the next move.
    pub ends_in_corner: bool,
}

/// A canned cycle in force; coordinates are the program's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cycle {
    /// 73 for G73.
    pub code: u8,
    /// Initial level, in path coordinates.
    pub initial: Nm,
    /// Point R of a canned cycle.
    pub r: Option<Nm>,
    /// Bottom of the hole (Z).
    pub bottom: Option<Nm>,
    /// Depth of a peck, or shift (Q).
    pub q: Nm,
    /// Dwell at the bottom (P).
    pub dwell: Micros,
}

/// Effect of a block: its motion and other actions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Step {
    /// The move.
    pub motion: Option<Motion>,
    /// Corner between the move and the next one. The move is programmed up to the corner's point.
    pub corner: Option<Corner>,
    /// The moves of a block that makes several.
    pub series: Option<Series>,
    /// G4.
    pub dwell: Option<Micros>,
    /// M0, M1, M2, M30.
    pub stop: Option<ProgramStop>,
    /// S: spindle speed in rev/min and the column of the word.
    pub spindle: Option<(i64, u16)>,
    /// Reason why this is not a single plain move of the tool centre in the program's own coordinates; `None` if it
    /// is.
    pub beyond_plain: Option<NotModelled>,
    /// G10 writes an offset.
    pub sets_data: bool,
}

impl Modal {
    /// The state after power-on: G0, G17, G90, G94, at the origin, no feed.
    pub fn at_power_on(unit: LengthUnit) -> Self {
        Modal {
            unit,
            plane: Plane::Xy,
            absolute: true,
            arc_centers: ArcCenters::FromStart,
            motion: MotionKind::Rapid,
            feed_mode: FeedMode::PerMinute,
            feed: None,
            spindle: None,
            machining_state: MachiningState::default(),
            position: Pose::ORIGIN,
            program: Pose::ORIGIN,
            frame: CoordinateFrame::default(),
            system: 0,
            local: Pose::ORIGIN,
            preset: Pose::ORIGIN,
            compensation: None,
            starts_up: false,
            length_sign: 0,
            length_offset: 0,
            radius_offset: 0,
            cycle: None,
            returns_to_r: false,
            polar: None,
            unmodelled: 0,
            follows_tool_center: false,
            rotation_pending: false,
            ends_in_corner: false,
        }
    }

    /// Whether moves are offset: G41 or G42 with a move in the plane since.
    pub fn is_in_contour(&self) -> bool {
        self.compensation.is_some() && !self.starts_up
    }

    /// Tool and spindle as commanded so far.
    pub fn machining(&self) -> Machining {
        self.machining_state.with_speed(self.spindle)
    }

    /// Updates the frame and the program position from the offsets; the tool does not move.
    pub fn update_frame(&mut self, tables: &Tables) {
        let shift = tables.origin(self.system).plus(self.preset).plus(self.local);
        self.frame = CoordinateFrame::new(shift, self.frame.scaling().copied(), self.frame.rotation().copied());
        self.program = self.frame.to_program(self.position);
    }

    /// Sets the position of the tool in path coordinates.
    pub fn set_position(&mut self, position: Pose) {
        self.position = position;
        self.program = self.frame.to_program(position);
    }

    pub(super) fn rotate(&mut self, rotation: Option<CoordinateRotation>) {
        if self.frame.rotation() == rotation.as_ref() {
            return;
        }
        self.frame = CoordinateFrame::new(self.frame.shift(), self.frame.scaling().copied(), rotation);
        self.program = self.frame.to_program(self.position);
        self.rotation_pending = true;
    }

    /// Origin of the workpiece's drawing in path coordinates: that of the work coordinate system, shifted by G92 but
    /// not by G52 and G68.
    pub fn work_origin(&self, tables: &Tables) -> Pose {
        tables.origin(self.system).plus(self.preset)
    }

    /// Tool length compensation: offset of Z in machine coordinates.
    pub fn tool_length(&self, tables: &Tables) -> Nm {
        Nm(tables.length(self.length_offset).0.saturating_mul(i64::from(self.length_sign)))
    }

    /// Position of the axes in machine coordinates: the path's point plus the tool length along Z.
    pub fn machine(&self, tables: &Tables) -> Pose {
        let mut machine = self.position;
        let [_, _, z] = &mut machine.linear;
        z.0 = z.0.saturating_add(self.tool_length(tables).0);
        machine
    }
}
