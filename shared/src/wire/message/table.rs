//! All messages: kind, way, name, fields. `docs/protocol.md#messages` has the same table, and a test compares them.

use super::codes::{
    AlarmCode, AxisCode, FeedCode, LawCode, ModeCode, MovesCode, PathCode, PolicyCode, RefusalCode, RequestCode,
    ResetCode, SettingCode, StateCode, StockCode, ToolCode, UnitCode, WorkCode,
};
use super::field::{Chunk, DecodeError, EncodeError, Field, Reader, Writer};
use super::fixed::{Q40, Q46, Q62};
use super::schema::{Class, Entry, FieldEntry};

/// Types, codecs and schema of messages from one table.
macro_rules! messages {
    ($(#[doc = $doc:literal] $kind:literal $class:ident $name:ident {
        $(#[doc = $field_doc:literal] $field:ident: $type:ty,)*
    })+) => {
        $(
            #[doc = $doc]
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub struct $name {
                $(#[doc = $field_doc] pub $field: $type,)*
            }

            impl $name {
                const FIELDS: &[FieldEntry] = &[$(FieldEntry {
                    name: stringify!($field),
                    field_type: <$type as Field>::TYPE,
                    meaning: $field_doc,
                }),*];

                fn put(&self, _writer: &mut Writer<'_>) -> Result<(), EncodeError> {
                    $(self.$field.put(_writer)?;)*
                    Ok(())
                }

                fn take(_reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
                    Ok($name { $($field: <$type as Field>::take(_reader)?,)* })
                }
            }

            impl From<$name> for Message {
                fn from(message: $name) -> Self {
                    Message::$name(message)
                }
            }
        )+

        /// One message.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and few are held at a time")]
        pub enum Message {
            $(#[doc = $doc] $name($name),)+
        }

        /// All messages, in the order of the document.
        pub const SCHEMA: &[Entry] = &[
            $(Entry {
                kind: $kind,
                name: stringify!($name),
                class: Class::$class,
                meaning: $doc,
                fields: $name::FIELDS,
            },)+
        ];

        impl Message {
            /// Its number on the wire.
            pub const fn kind(&self) -> u8 {
                match self {
                    $(Message::$name(_) => $kind,)+
                }
            }

            /// Puts its payload into a buffer; its length. [`super::field::PAYLOAD_MAX`] bytes are always enough.
            ///
            /// # Errors
            /// The buffer is too short.
            pub fn encode(&self, buffer: &mut [u8]) -> Result<usize, EncodeError> {
                let mut writer = Writer::new(buffer);
                match self {
                    $(Message::$name(message) => message.put(&mut writer)?,)+
                }
                Ok(writer.written())
            }

            /// Reads a payload.
            ///
            /// # Errors
            /// What makes it no message of this kind.
            pub fn decode(kind: u8, payload: &[u8]) -> Result<Self, DecodeError> {
                let mut reader = Reader::new(payload);
                let message = match kind {
                    $($kind => Message::$name($name::take(&mut reader)?),)+
                    other => return Err(DecodeError::Kind(other)),
                };
                reader.end().map(|()| message)
            }
        }
    };
}

messages! {
    /// A set of parameters begins; what was staged is forgotten.
    0x10 Down Begin {
        /// The host's number of the set, not 0.
        set: u32,
    }
    /// What every job has.
    0x11 Down Basics {
        /// The unit that reports speak.
        unit: UnitCode,
        /// How the wanted feed reaches the control.
        policy: PolicyCode,
    }
    /// A tool; they come in their order, each before its law and its rules.
    0x12 Down Tool {
        /// T number.
        number: Option<u32>,
        /// Its axis in the program's coordinates.
        axis: AxisCode,
        /// Spindle speed, rev/min.
        spindle: Q40,
        /// Whether the operator sets the spindle's speed where the program does not.
        operator_speed: bool,
        /// Wanted feed per tooth, mm.
        feed_per_tooth: Q40,
        /// Its kind.
        shape: ToolCode,
        /// nm.
        outer_radius: i64,
        /// nm; 0 for an end mill.
        inner_radius: i64,
        /// Teeth that cut.
        teeth: u16,
    }
    /// The feed law of the tool before.
    0x13 Down Law {
        /// Which.
        law: LawCode,
        /// Engaged arc: both edges; contour: inside arcs only; otherwise false.
        option: bool,
        /// Contour: least part of the feed; otherwise 0.
        floor: Q40,
    }
    /// Bounds of the override.
    0x14 Down Limits {
        /// Least, %.
        min_percent: u8,
        /// Largest, %.
        max_percent: u8,
        /// The control's step, %.
        step_percent: u8,
        /// Fastest rise, %/s.
        slew_up: Q40,
        /// Fastest fall, %/s.
        slew_down: Q40,
    }
    /// The machine's axes; may be left out.
    0x15 Down Axes {
        /// Fastest X, Y, Z, mm/min.
        linear: [Option<Q40>; 3],
        /// Fastest A, B, C, deg/min.
        rotary: [Option<Q40>; 3],
    }
    /// The control's clamp of the feed on arcs; may be left out.
    0x16 Down ArcClamp {
        /// V, mm/min.
        feed: Q40,
        /// R, mm.
        radius: Q40,
        /// mm/min.
        floor: Q40,
    }
    /// One cut rule of the tool before; they come in their order.
    0x17 Down Rule {
        /// Its place among the rules.
        index: u8,
        /// Which moves.
        moves: MovesCode,
        /// What cuts.
        work: WorkCode,
        /// Radial depth of an end mill's cut, nm; 0 for a ring.
        radial_depth: i64,
        /// How the stock is described.
        stock: StockCode,
        /// How many messages describe it; they follow at once.
        stock_parts: u8,
        /// Wanted feed per tooth where it is not the tool's, mm.
        feed_per_tooth: Option<Q40>,
        /// First knot of its table among the job's, and how many.
        table: Option<[u8; 2]>,
        /// First and last N.
        sequence: Option<[i64; 2]>,
        /// Lowest and highest Z at the start of a move, nm.
        level: Option<[i64; 2]>,
    }
    /// A line of the stock of the rule before.
    0x18 Down StockLine {
        /// Unit normal, out of the material.
        normal: [Q62; 2],
        /// Distance from the origin along it at height 0, mm.
        offset: Q46,
        /// Growth of the offset per millimetre of height.
        rise: Q46,
    }
    /// The round blank of the rule before.
    0x19 Down StockDisc {
        /// mm.
        center: [Q46; 2],
        /// mm.
        radius: Q46,
    }
    /// Engaged arcs at one place of the rule before.
    0x1A Down EngagedArcs {
        /// Path from the segment's start, mm.
        travelled: Q40,
        /// Of the outer circle: from and to, 1/90 degree.
        outer: [i16; 2],
        /// Of the inner circle.
        inner: [i16; 2],
    }
    /// One knot of the job's tables; they come in their order.
    0x1B Down Knot {
        /// Path from the segment's start, mm.
        travelled: Q40,
        /// Feed per tooth at the centre, mm.
        feed_per_tooth: Q40,
    }
    /// What no governed feed exceeds.
    0x1D Down Ceiling {
        /// Fastest governed feed, mm/min.
        max_feed: Option<Q40>,
        /// Largest raise of a programmed feed, as a ratio.
        max_raise: Q40,
    }
    /// The set is whole.
    0x1C Down Commit {
        /// As in `Begin`.
        set: u32,
        /// Messages between `Begin` and this.
        messages: u16,
        /// CRC-32C over kind and payload of each of them.
        checksum: u32,
    }
    /// A move that the control will make.
    0x20 Down Segment {
        /// One more than the one before; the first of a run is free.
        count: u32,
        /// N of its block.
        sequence: Option<i64>,
        /// X, Y, Z at its start, nm.
        start: [i64; 3],
        /// X, Y, Z at its end, nm.
        end: [i64; 3],
        /// A, B, C at its start, microdegrees; absent if all are 0.
        start_rotary: Option<[i64; 3]>,
        /// A, B, C at its end, microdegrees; absent if all are 0.
        end_rotary: Option<[i64; 3]>,
        /// What its feed counts.
        feed_code: FeedCode,
        /// The feed.
        feed: i64,
        /// Its shape.
        path: PathCode,
        /// Rotation centre in the plane, nm; of arcs only.
        center: Option<[i64; 2]>,
        /// The cut rule whose law governs it.
        rule: Option<u8>,
        /// Commanded spindle speed where it is not the tool's, rev/min.
        spindle: Option<Q40>,
        /// The fastest feed on it by the job's ceiling, nm/min.
        max_feed: Option<i64>,
        /// Largest override at its end where that is not 100, %.
        end_percent: Option<u8>,
    }
    /// All segments that are not done are forgotten, and a run is over: the next count is free.
    0x21 Down Clear {}
    /// What a person asks for.
    0x22 Down Request {
        /// What.
        what: RequestCode,
        /// `epoch` of the report that the person saw.
        epoch: u16,
    }
    /// Asks for `Info`.
    0x23 Down AskInfo {}
    /// Asks for one `Setting`.
    0x24 Down AskSetting {
        /// Which.
        setting: SettingCode,
    }
    /// Sets one; answered by `Setting` or `Refused`.
    0x25 Down SetSetting {
        /// Which.
        setting: SettingCode,
        /// In the setting's unit.
        value: u32,
    }
    /// Engaged arcs at one place of the segment that comes next; they come in their order.
    0x26 Down SegmentArcs {
        /// Path from the segment's start, mm.
        travelled: Q40,
        /// Of the outer circle: from and to, 1/90 degree.
        outer: [i16; 2],
        /// Of the inner circle.
        inner: [i16; 2],
    }
    /// What the board is.
    0x40 Up Info {
        /// Version of its firmware.
        version: [u8; 3],
        /// Why it started.
        reset: ResetCode,
        /// How often it started, as far as it knows.
        starts: u32,
        /// Segments that it holds ahead.
        capacity: u16,
        /// Set of parameters in force; 0 for none.
        set: u32,
        /// Its name.
        name: Chunk,
    }
    /// A set of parameters is in force.
    0x41 Up Accepted {
        /// Which.
        set: u32,
    }
    /// The board did not do it.
    0x42 Up Refused {
        /// Kind of the message.
        kind: u8,
        /// Its set, count, setting or epoch; 0 if it has none.
        reference: u32,
        /// Why.
        why: RefusalCode,
    }
    /// One setting as it is.
    0x43 Up Setting {
        /// Which.
        setting: SettingCode,
        /// In the setting's unit.
        value: u32,
    }
    /// Part of the log, as defmt encodes it.
    0x44 Up Log {
        /// The bytes that follow those of the log before.
        bytes: Chunk,
    }
    /// How things stand.
    0x50 Latest Report {
        /// When, by the board's clock, us.
        at: u64,
        /// Who has the override.
        state: StateCode,
        /// Why it is what it is: a number of docs/outputs.md.
        cause: u8,
        /// Whether somebody should look.
        alarm: AlarmCode,
        /// The override put out, %.
        override_percent: u8,
        /// How often the override was taken away, the start among it.
        epoch: u16,
        /// Segments done since the start; wraps.
        executed: u32,
        /// Count of the segment in work.
        in_work: Option<u32>,
        /// Room for segments.
        room: u16,
        /// Set of parameters in force; 0 for none.
        set: u32,
        /// Feed per tooth at the centre that the law wants, nm; all ones for none.
        ipt_center: u32,
        /// Feed that the machine makes of the override, um/min; all ones for none.
        feed: u32,
        /// At the floor: by how much the chip exceeds its target, %.
        chip_excess_percent: u8,
    }
    /// What the machine shows.
    0x60 Machine Sample {
        /// When, by the machine's clock, us.
        at: u64,
        /// Who says when the machine moves on.
        mode: ModeCode,
        /// X, Y, Z in the workpiece's coordinates, nm; absent if there is no new one.
        linear: Option<[i64; 3]>,
        /// A, B, C, microdegrees; absent if all are 0.
        rotary: Option<[i64; 3]>,
        /// Spindle speed, rev/min.
        spindle: Q40,
        /// The operator's dial, %.
        operator_percent: u8,
        /// Conditions and buttons, a bit each.
        signals: u32,
        /// Bytes put on the link before this; wraps.
        link_bytes: u32,
        /// Bytes put on the tapped line before this, both ways together; wraps.
        tap_bytes: u32,
    }
    /// What the board puts out.
    0x61 Machine Setpoint {
        /// `at` of the sample that it answers.
        at: u64,
        /// Lines *FV0 to *FV7 that are low, a bit each.
        lines: u8,
        /// Who has the override.
        state: StateCode,
        /// Bytes put on the link before this; wraps.
        link_bytes: u32,
        /// Bytes put on the tapped line before this, both ways together; wraps.
        tap_bytes: u32,
    }
}
