//! All messages: kind, way, name, fields. `docs/protocol.md#messages` has the same table, and a test compares them.

use super::codes::{
    AlarmCode, AxisCode, FeedCode, LawCode, ModeCode, MovesCode, PathCode, PolicyCode, RefusalCode, RequestCode,
    ResetCode, SettingCode, StateCode, StockCode, ToolCode, UnitCode, WorkCode,
};
use super::field::{Chunk, DecodeError, EncodeError, Field, Reader, Writer};
use super::fixed::{Q40, Q46, Q62};
use super::schema::{Entry, FieldEntry, MessageClass};

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

        /// One message of host or board.
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
                class: MessageClass::$class,
                meaning: $doc,
                fields: $name::FIELDS,
            },)+
        ];

        impl Message {
            /// Number of the message on the wire.
            pub const fn kind(&self) -> u8 {
                match self {
                    $(Message::$name(_) => $kind,)+
                }
            }

            /// Writes the payload of the message into a buffer; returns its length. [`super::field::PAYLOAD_MAX`]
            /// bytes are always enough.
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

            /// Decodes a message of this kind from its payload.
            ///
            /// # Errors
            /// The kind is unknown, or the payload is not a message of this kind.
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
    /// Begins a set of parameters; discards a staged one.
    0x10 Down Begin {
        /// Number of the set, chosen by the host; not 0.
        set: u32,
    }
    /// Basic settings of the job.
    0x11 Down Basics {
        /// Unit of reports.
        unit: UnitCode,
        /// Way in which the target feed reaches the control.
        policy: PolicyCode,
    }
    /// A tool; tools are sent in order, each before its law and its rules.
    0x12 Down Tool {
        /// T number.
        number: Option<u32>,
        /// Tool axis in the program's coordinates.
        axis: AxisCode,
        /// Spindle speed, rev/min.
        spindle: Q40,
        /// Whether the operator sets the spindle speed if the program does not.
        operator_speed: bool,
        /// Target feed per tooth, mm.
        feed_per_tooth: Q40,
        /// Kind of tool.
        shape: ToolCode,
        /// Outer radius, nm.
        outer_radius: i64,
        /// Inner radius, nm; 0 for an end mill.
        inner_radius: i64,
        /// Number of teeth that cut.
        teeth: u16,
    }
    /// Feed law of the last tool.
    0x13 Down Law {
        /// Kind of law.
        law: LawCode,
        /// Engaged arc: both edges; contour: inside arcs only; otherwise false.
        option: bool,
        /// Contour: smallest fraction of the feed; otherwise 0.
        floor: Q40,
    }
    /// Bounds of the override.
    0x14 Down Limits {
        /// Smallest override, %.
        min_percent: u8,
        /// Largest override, %.
        max_percent: u8,
        /// Step of the control, %.
        step_percent: u8,
        /// Fastest rise, %/s.
        slew_up: Q40,
        /// Fastest fall, %/s.
        slew_down: Q40,
    }
    /// Feed limits of the axes; optional.
    0x15 Down Axes {
        /// Maximum feed of X, Y, Z, mm/min.
        linear: [Option<Q40>; 3],
        /// Maximum feed of A, B, C, deg/min.
        rotary: [Option<Q40>; 3],
    }
    /// Clamp of the feed by arc radius; optional.
    0x16 Down ArcClamp {
        /// Maximum feed V at the radius R, mm/min.
        feed: Q40,
        /// Radius R, mm.
        radius: Q40,
        /// Lower limit of the clamped feed, mm/min.
        floor: Q40,
    }
    /// A cut rule of the last tool; rules are sent in order.
    0x17 Down Rule {
        /// Index of the rule.
        index: u8,
        /// Moves to which the rule applies.
        moves: MovesCode,
        /// Cutting edge.
        work: WorkCode,
        /// Radial depth of an end mill's cut, nm; 0 for a ring.
        radial_depth: i64,
        /// Description of the stock.
        stock: StockCode,
        /// Number of messages that describe the stock; they follow immediately.
        stock_parts: u8,
        /// Target feed per tooth if it is not the tool's, mm.
        feed_per_tooth: Option<Q40>,
        /// First knot of its table in the job, and number of knots.
        table: Option<[u8; 2]>,
        /// First and last N.
        sequence: Option<[i64; 2]>,
        /// Lowest and highest Z at the start of a move, nm.
        level: Option<[i64; 2]>,
    }
    /// A stock line of the last rule.
    0x18 Down StockLine {
        /// Unit normal, out of the material.
        normal: [Q62; 2],
        /// Distance from the origin along the normal at height 0, mm.
        offset: Q46,
        /// Growth of the offset per millimetre of height.
        rise: Q46,
    }
    /// Round blank of the last rule.
    0x19 Down StockDisc {
        /// Centre, mm.
        center: [Q46; 2],
        /// Radius, mm.
        radius: Q46,
    }
    /// A knot of engaged arcs of the last rule.
    0x1A Down EngagedArcs {
        /// Path from the segment's start, mm.
        travelled: Q40,
        /// Arc of the outer circle: from and to, 1/90 degree.
        outer: [i16; 2],
        /// Arc of the inner circle.
        inner: [i16; 2],
    }
    /// A knot of the job's tables; knots are sent in order.
    0x1B Down Knot {
        /// Path from the segment's start, mm.
        travelled: Q40,
        /// Feed per tooth at the centre, mm.
        feed_per_tooth: Q40,
    }
    /// Upper limit of governed feeds.
    0x1D Down Ceiling {
        /// Maximum governed feed, mm/min.
        max_feed: Option<Q40>,
        /// Largest raise of a programmed feed, as a ratio.
        max_raise: Q40,
    }
    /// Ends a set of parameters.
    0x1C Down Commit {
        /// As in `Begin`.
        set: u32,
        /// Number of messages between `Begin` and this one.
        messages: u16,
        /// CRC-32C over kind and payload of each of them.
        checksum: u32,
    }
    /// A move that the control is going to execute.
    0x20 Down Segment {
        /// Number of the segment: one more than the previous; free for the first of a run.
        count: u32,
        /// Sequence number N of its block.
        sequence: Option<i64>,
        /// X, Y, Z at the start, nm.
        start: [i64; 3],
        /// X, Y, Z at the end, nm.
        end: [i64; 3],
        /// A, B, C at the start, microdegrees; absent if all are 0.
        start_rotary: Option<[i64; 3]>,
        /// A, B, C at the end, microdegrees; absent if all are 0.
        end_rotary: Option<[i64; 3]>,
        /// Unit of the feed.
        feed_code: FeedCode,
        /// Feed in that unit.
        feed: i64,
        /// Shape of the path.
        path: PathCode,
        /// Rotation centre in the plane, nm; arcs only.
        center: Option<[i64; 2]>,
        /// Index of the governing cut rule; absent if no law governs the move.
        rule: Option<u8>,
        /// Commanded spindle speed if it is not the tool's, rev/min.
        spindle: Option<Q40>,
        /// Upper limit of the feed by the job's ceiling, nm/min.
        max_feed: Option<i64>,
        /// Largest override at the end if that is not 100, %.
        end_percent: Option<u8>,
    }
    /// Discards all segments that are not done and ends the run: the next count is free.
    0x21 Down Clear {}
    /// Request of a person.
    0x22 Down Request {
        /// Requested action.
        what: RequestCode,
        /// Epoch of the report that the person has seen.
        epoch: u16,
    }
    /// Asks for `Info`.
    0x23 Down AskInfo {}
    /// Asks for one `Setting`.
    0x24 Down AskSetting {
        /// Setting.
        setting: SettingCode,
    }
    /// Sets a setting; answered by `Setting` or `Refused`.
    0x25 Down SetSetting {
        /// Setting.
        setting: SettingCode,
        /// Value in the setting's unit.
        value: u32,
    }
    /// A knot of engaged arcs of the next segment; knots are sent in order.
    0x26 Down SegmentArcs {
        /// Path from the segment's start, mm.
        travelled: Q40,
        /// Arc of the outer circle: from and to, 1/90 degree.
        outer: [i16; 2],
        /// Arc of the inner circle.
        inner: [i16; 2],
    }
    /// Description of the board.
    0x40 Up Info {
        /// Version of the firmware.
        version: [u8; 3],
        /// Cause of the last start.
        reset: ResetCode,
        /// Number of starts, as far as the board knows.
        starts: u32,
        /// Number of segments that the board can hold.
        capacity: u16,
        /// Set of parameters in force; 0 for none.
        set: u32,
        /// Name of the board.
        name: Chunk,
    }
    /// A set of parameters has come into force.
    0x41 Up Accepted {
        /// Number of the set.
        set: u32,
    }
    /// The board has rejected a message.
    0x42 Up Refused {
        /// Kind of the rejected message.
        kind: u8,
        /// Set, count, setting or epoch of the rejected message; 0 if it has none.
        reference: u32,
        /// Reason.
        why: RefusalCode,
    }
    /// Current value of a setting.
    0x43 Up Setting {
        /// Setting.
        setting: SettingCode,
        /// Value in the setting's unit.
        value: u32,
    }
    /// Part of the log, as defmt encodes it.
    0x44 Up Log {
        /// Bytes that follow those of the previous `Log`.
        bytes: Chunk,
    }
    /// State of the board.
    0x50 Latest Report {
        /// Time by the board's clock, us.
        at: u64,
        /// State of the supervisor.
        state: StateCode,
        /// Reason of the override: a number of docs/outputs.md.
        cause: u8,
        /// Alarm level.
        alarm: AlarmCode,
        /// Override at the output, %.
        override_percent: u8,
        /// Number of fallbacks, including the start.
        epoch: u16,
        /// Number of segments executed since the start; wraps around.
        executed: u32,
        /// Count of the segment in execution.
        in_work: Option<u32>,
        /// Free slots for segments.
        room: u16,
        /// Set of parameters in force; 0 for none.
        set: u32,
        /// Feed per tooth at the centre that the law demands, nm; all ones for none.
        ipt_center: u32,
        /// Feed of the machine under the override, um/min; all ones for none.
        feed: u32,
        /// Excess of the chip over its target at the lower limit of the override, %.
        chip_excess_percent: u8,
    }
    /// Signals of the machine.
    0x60 Machine Sample {
        /// Time by the machine's clock, us.
        at: u64,
        /// Clock of the machine.
        mode: ModeCode,
        /// X, Y, Z in the workpiece's coordinates, nm; absent if there is no new position.
        linear: Option<[i64; 3]>,
        /// A, B, C, microdegrees; absent if all are 0.
        rotary: Option<[i64; 3]>,
        /// Spindle speed, rev/min.
        spindle: Q40,
        /// Operator's dial, %.
        operator_percent: u8,
        /// Conditions and buttons, one bit each.
        signals: u32,
        /// Bytes sent on the link before this message; wraps around.
        link_bytes: u32,
        /// Bytes sent on the tapped line before this message, both directions together; wraps around.
        tap_bytes: u32,
    }
    /// Outputs of the board.
    0x61 Machine Setpoint {
        /// `at` of the answered sample.
        at: u64,
        /// Lines *FV0 to *FV7 that are low, one bit each.
        lines: u8,
        /// State of the supervisor.
        state: StateCode,
        /// Bytes sent on the link before this message; wraps around.
        link_bytes: u32,
        /// Bytes sent on the tapped line before this message, both directions together; wraps around.
        tap_bytes: u32,
    }
}
