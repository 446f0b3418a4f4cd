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

/// Modal state of the control: everything that a block inherits from the blocks before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modal {
    /// Unit of lengths (G20, G21).
    pub unit: LengthUnit,
    /// Plane of arcs, canned cycles and cutter compensation (G17, G18, G19).
    pub plane: Plane,
    /// Whether axis words are absolute (G90) or increments (G91).
    pub absolute: bool,
    /// Reference of I, J and K: the start of the arc (G91.1) or the program's origin (G90.1); only some controls have
    /// a choice.
    pub arc_centers: ArcCenters,
    /// Kind of motion of a block with axis words (G0, G1, G2, G3).
    pub motion: MotionKind,
    /// Meaning of F: inverse time (G93), per minute (G94) or per revolution (G95).
    pub feed_mode: FeedMode,
    /// The last F, in nanometres per minute under G94 or per revolution under G95; `None` if none was given since the
    /// feed mode changed.
    pub feed: Option<Nm>,
    /// The last S, rev/min; `None` if the program has given none.
    pub spindle: Option<i64>,
    /// Tool in the spindle, and whether the spindle turns, by the T and M words so far.
    pub machining_state: MachiningState,
    /// Position of the tool centre and the rotary axes in path coordinates, which are relative to the machine's zero
    /// and do not change with offsets (see [`super::frame`]).
    pub position: Pose,
    /// The same position in program coordinates.
    pub program: Pose,
    /// Transformation from program to path coordinates.
    pub frame: CoordinateFrame,
    /// Index of the work coordinate system: 0 to 5 for G54 to G59, from 6 on for G54.1 P1 and so on.
    pub system: u16,
    /// Shift of the local coordinate system (G52).
    pub local: Pose,
    /// Shift that G92 has set.
    pub preset: Pose,
    /// Side on which cutter compensation offsets the tool (G41, G42); `None` under G40.
    pub compensation: Option<CompensationSide>,
    /// Whether no move in the plane has followed the last G40, G41 or G42, so that the next one begins or ends the
    /// offset.
    pub starts_up: bool,
    /// Sign of the tool length offset: 1 for G43, -1 for G44, 0 for G49.
    pub length_sign: i8,
    /// Number of the tool length offset (H word).
    pub length_offset: u16,
    /// Number of the cutter compensation offset (D word).
    pub radius_offset: u16,
    /// Canned cycle in force (G73 to G89); `None` under G80.
    pub cycle: Option<Cycle>,
    /// Whether a canned cycle returns to the level R (G99) instead of the initial level (G98).
    pub returns_to_r: bool,
    /// Last point in polar coordinates (G16); `None` under G15.
    pub polar: Option<Polar>,
    /// The G code of a tilted plane in force, in tenths, under which no move is modelled; 0 for none.
    pub unmodelled: u16,
    /// Whether tool centre point control (G43.4) is in force.
    pub follows_tool_center: bool,
    /// Whether G68 or G69 has rotated the plane, and no move has named both axes of the plane since then.
    pub rotation_pending: bool,
    /// Whether the last move ends in a chamfer or a rounded corner, so that the next move is needed to complete it.
    pub ends_in_corner: bool,
}

/// A canned cycle in force. Coordinates are the program's, except the initial level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cycle {
    /// G code of the cycle: 73 for G73.
    pub code: u8,
    /// Initial level: position along the plane's normal at which the cycle was first called, in path coordinates.
    pub initial: Nm,
    /// Level R, from which the tool moves at feed instead of rapid; `None` if not given yet.
    pub r: Option<Nm>,
    /// Bottom of the hole (Z word); `None` if not given yet.
    pub bottom: Option<Nm>,
    /// Q word: depth of one peck, or the shift that clears a boring tool.
    pub q: Nm,
    /// Dwell at the bottom of the hole (P word).
    pub dwell: Micros,
}

/// Effect of one block on the control: its motion and its other actions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Step {
    /// The single move of the block; `None` if it has none or several.
    pub motion: Option<Motion>,
    /// Chamfer or rounded corner (`,C`, `,R`) between the block's move and the next one. The move goes to the
    /// programmed corner point.
    pub corner: Option<Corner>,
    /// The moves of a block that makes several: a canned cycle, or a return to a reference point.
    pub series: Option<Series>,
    /// Dwell of the block (G4).
    pub dwell: Option<Micros>,
    /// Program stop or end of the block (M0, M1, M2, M30).
    pub stop: Option<ProgramStop>,
    /// S word of the block: spindle speed in rev/min, and column of the word.
    pub spindle: Option<(i64, u16)>,
    /// Reason why the block's motion is not a single plain move of the tool centre in the program's own coordinates;
    /// `None` if it is one.
    pub beyond_plain: Option<NotModelled>,
    /// Whether the block writes an offset (G10).
    pub sets_data: bool,
}

impl Modal {
    /// The state after power-on: G0, G17, G90, G94, at the origin, without F and S.
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

    /// Whether cutter compensation offsets the tool: G41 or G42 is in force, and a move in the plane has followed it.
    pub fn is_in_contour(&self) -> bool {
        self.compensation.is_some() && !self.starts_up
    }

    /// Tool in the spindle and spindle speed, as commanded so far.
    pub fn machining(&self) -> Machining {
        self.machining_state.with_speed(self.spindle)
    }

    /// Computes the transformation and the program position anew after a change of offsets; the tool does not move.
    pub fn update_frame(&mut self, tables: &Tables) {
        let shift = tables.origin(self.system).plus(self.preset).plus(self.local);
        self.frame = CoordinateFrame::new(shift, self.frame.scaling().copied(), self.frame.rotation().copied());
        self.program = self.frame.to_program(self.position);
    }

    /// Sets the position of the tool centre and the rotary axes, in path coordinates.
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

    /// Origin of the work coordinate system in path coordinates, with the shift of G92, but without those of G52 and
    /// G68: in general the origin of the workpiece's drawing.
    pub fn work_origin(&self) -> Pose {
        let shift = self.frame.shift();
        // Asked for every line, and few programs have a G52.
        if self.local == Pose::ORIGIN { shift } else { shift.minus(self.local) }
    }

    /// Tool length compensation in force: distance along Z from path to machine coordinates, positive under G43 for a
    /// positive offset.
    pub fn tool_length(&self, tables: &Tables) -> Nm {
        match i64::from(self.length_sign) {
            // No table is read for the lines of a program without G43 and G44.
            0 => Nm(0),
            sign => Nm(tables.length(self.length_offset).0.saturating_mul(sign)),
        }
    }

    /// Position of the axes in machine coordinates: that of the path, plus the tool length compensation along Z.
    pub fn machine(&self, tables: &Tables) -> Pose {
        let mut machine = self.position;
        let [_, _, z] = &mut machine.linear;
        z.0 = z.0.saturating_add(self.tool_length(tables).0);
        machine
    }
}
