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
    /// Begins a set of messages that describe a job; a set that is not complete is discarded.
    0x10 Down Begin {
        /// Number of the set, chosen by the host; not 0.
        set: u32,
    }
    /// Unit and feed mode of the job.
    0x11 Down Basics {
        /// Unit of lengths in which the program starts and in which reports are written.
        unit: UnitCode,
        /// Way in which the target feed reaches the control: by F words or by the override.
        policy: PolicyCode,
    }
    /// A tool of the job; tools are sent in order, each before its law and its cut rules.
    0x12 Down Tool {
        /// T number; absent if the program does not load the tool.
        number: Option<u32>,
        /// Axis of the program's coordinates that is parallel to the tool.
        axis: AxisCode,
        /// Spindle speed if the program states none, rev/min.
        spindle: Q40,
        /// Whether the operator sets the spindle speed if the program does not.
        operator_speed: bool,
        /// Target feed per tooth, mm.
        feed_per_tooth: Q40,
        /// Kind of cutter.
        shape: ToolCode,
        /// Radius of the outer cutting circle, nm.
        outer_radius: i64,
        /// Radius of the inner cutting circle, nm; 0 for an end mill.
        inner_radius: i64,
        /// Number of teeth that cut on one circle.
        teeth: u16,
    }
    /// Feed law of the tool that was sent last.
    0x13 Down Law {
        /// Kind of law.
        law: LawCode,
        /// Engaged-arc law: whether both cutting circles count; contour law: whether only inside arcs change the feed; otherwise false.
        option: bool,
        /// Contour law: smallest feed of the centre as a fraction of the feed at the contour; otherwise 0.
        floor: Q40,
    }
    /// Range, step and slew rates of the override.
    0x14 Down Limits {
        /// Smallest override, %.
        min_percent: u8,
        /// Largest override, %.
        max_percent: u8,
        /// Step in which the control accepts the override, %.
        step_percent: u8,
        /// Fastest rise, percentage points per second.
        slew_up: Q40,
        /// Fastest fall, percentage points per second.
        slew_down: Q40,
    }
    /// Maximum feeds of the machine's axes; optional.
    0x15 Down Axes {
        /// Maximum feeds of X, Y, Z, mm/min; absent: not known.
        linear: [Option<Q40>; 3],
        /// Maximum feeds of A, B, C, deg/min; absent: not known.
        rotary: [Option<Q40>; 3],
    }
    /// The control's limit of the feed on arcs by their radius; optional.
    0x16 Down ArcClamp {
        /// Maximum feed V at the radius R, mm/min.
        feed: Q40,
        /// Radius R, mm.
        radius: Q40,
        /// Lower limit of the clamped feed, mm/min.
        floor: Q40,
    }
    /// A cut rule of the tool that was sent last: moves to which its law applies, and the stock there. Rules are sent in order.
    0x17 Down Rule {
        /// Index of the rule in the job, from 0.
        index: u8,
        /// Moves to which the rule applies.
        moves: MovesCode,
        /// Cutting circle, or side of the contour.
        work: WorkCode,
        /// Radial depth of an end mill's cut, nm; 0 for other work.
        radial_depth: i64,
        /// Form in which the stock is described.
        stock: StockCode,
        /// Number of messages that describe the stock; they follow immediately.
        stock_parts: u8,
        /// Target feed per tooth if it is not the tool's, mm.
        feed_per_tooth: Option<Q40>,
        /// For the table law: index of the first knot among all knots of the job, and number of knots.
        table: Option<[u8; 2]>,
        /// First and last sequence number N to which the rule applies; absent: all.
        sequence: Option<[i64; 2]>,
        /// Lowest and highest Z at the start of a move to which the rule applies, nm; absent: all.
        level: Option<[i64; 2]>,
    }
    /// A straight limit of the stock of the rule that was sent last.
    0x18 Down StockLine {
        /// Unit normal, pointing out of the material.
        normal: [Q62; 2],
        /// Distance of the line from the origin along the normal at height 0, mm.
        offset: Q46,
        /// Growth of the offset per millimetre of height.
        rise: Q46,
    }
    /// A round blank, the stock of the rule that was sent last.
    0x19 Down StockDisc {
        /// Centre, mm.
        center: [Q46; 2],
        /// Radius, mm.
        radius: Q46,
    }
    /// Directions in which the edges are in material at one place of the path; stock of the rule that was sent last.
    0x1A Down EngagedArcs {
        /// Path from the segment's start, mm.
        travelled: Q40,
        /// Engaged arc of the outer circle: first and last direction, 1/90 degree.
        outer: [i16; 2],
        /// Engaged arc of the inner circle, likewise.
        inner: [i16; 2],
    }
    /// A knot of a table of feeds per tooth over the path; the knots of all rules are sent in order.
    0x1B Down Knot {
        /// Path from the segment's start, mm.
        travelled: Q40,
        /// Feed per tooth at the tool's centre, mm.
        feed_per_tooth: Q40,
    }
    /// Upper limit, set by the job, of the feed on moves that a law governs.
    0x1D Down Ceiling {
        /// Largest feed along the path, mm/min; absent: no such limit.
        max_feed: Option<Q40>,
        /// Largest feed as a multiple of the programmed feed.
        max_raise: Q40,
    }
    /// Ends a set of messages that describe a job, which takes effect if it is complete and valid.
    0x1C Down Commit {
        /// Number of the set, as in `Begin`.
        set: u32,
        /// Number of messages between `Begin` and this one.
        messages: u16,
        /// CRC-32C over kind and payload of each of them.
        checksum: u32,
    }
    /// A move that the control is going to execute.
    0x20 Down Segment {
        /// Number of the segment: one more than that of the previous one; any number for the first of a run.
        count: u32,
        /// Sequence number N of its block; absent without one.
        sequence: Option<i64>,
        /// X, Y, Z at the start, nm.
        start: [i64; 3],
        /// X, Y, Z at the end, nm.
        end: [i64; 3],
        /// A, B, C at the start, microdegrees; absent if all are 0.
        start_rotary: Option<[i64; 3]>,
        /// A, B, C at the end, microdegrees; absent if all are 0.
        end_rotary: Option<[i64; 3]>,
        /// Unit of the field `feed`.
        feed_code: FeedCode,
        /// Feed in the unit of `feed_code`.
        feed: i64,
        /// Shape of the path, for an arc with plane and sense.
        path: PathCode,
        /// Rotation centre of an arc on the two axes of its plane, nm; absent for other moves.
        center: Option<[i64; 2]>,
        /// Index of the cut rule whose law governs the move; absent if no law does.
        rule: Option<u8>,
        /// Commanded spindle speed if it is not the tool's, rev/min.
        spindle: Option<Q40>,
        /// Upper limit of the feed by the job's ceiling, nm/min.
        max_feed: Option<i64>,
        /// Largest override at the end of the move, %, with which the next move may begin; absent: 100.
        end_percent: Option<u8>,
    }
    /// Discards all segments that have not ended, and ends the run: the next segment may have any number.
    0x21 Down Clear {}
    /// Request of a person to arm or disarm the laws.
    0x22 Down Request {
        /// Requested action.
        what: RequestCode,
        /// Epoch in the report that the person has seen; a request with an older one is stale.
        epoch: u16,
    }
    /// Asks for the message `Info`.
    0x23 Down AskInfo {}
    /// Asks for the message `Setting` about one setting.
    0x24 Down AskSetting {
        /// The setting.
        setting: SettingCode,
    }
    /// Changes a setting of the board; answered by `Setting` or `Refused`.
    0x25 Down SetSetting {
        /// The setting.
        setting: SettingCode,
        /// New value, in the unit of the setting.
        value: u32,
    }
    /// Directions in which the edges are in material at one place of the next segment; sent in the order of the path.
    0x26 Down SegmentArcs {
        /// Path from the segment's start, mm.
        travelled: Q40,
        /// Engaged arc of the outer circle: first and last direction, 1/90 degree.
        outer: [i16; 2],
        /// Engaged arc of the inner circle, likewise.
        inner: [i16; 2],
    }
    /// Feed per tooth at one place of the next segment, which no rule governs; sent in the order of the path.
    0x27 Down SegmentFeed {
        /// Path from the segment's start, mm.
        travelled: Q40,
        /// Feed per tooth at the tool's centre, mm.
        feed_per_tooth: Q40,
    }
    /// Description of the board.
    0x40 Up Info {
        /// Version of the firmware.
        version: [u8; 3],
        /// Cause of the last start.
        reset: ResetCode,
        /// Number of starts, as far as the board has counted them.
        starts: u32,
        /// Number of segments that the board can hold.
        capacity: u16,
        /// Number of the set of messages whose job is in force; 0 for none.
        set: u32,
        /// Name of the board.
        name: Chunk,
    }
    /// The job of a set of messages is in force.
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
        /// Reason why it was rejected.
        why: RefusalCode,
    }
    /// Present value of a setting of the board.
    0x43 Up Setting {
        /// The setting.
        setting: SettingCode,
        /// Value, in the unit of the setting.
        value: u32,
    }
    /// Part of the log of the board, as defmt encodes it.
    0x44 Up Log {
        /// Bytes of the log, which follow those of the previous `Log`.
        bytes: Chunk,
    }
    /// Status of the board, sent at fixed intervals.
    0x50 Latest Report {
        /// Time by the board's clock, us.
        at: u64,
        /// State of the supervisor, which decides whether the laws may set the override.
        state: StateCode,
        /// Reason of the override: a number of docs/outputs.md.
        cause: u8,
        /// Alarm level.
        alarm: AlarmCode,
        /// Override at the output, %.
        override_percent: u8,
        /// Epoch: number of changes to fallback, disarmed or faulted, plus one for the start; wraps around.
        epoch: u16,
        /// Number of segments that have ended since the start; wraps around.
        executed: u32,
        /// Number of the segment in execution; absent if none is.
        in_work: Option<u32>,
        /// Number of segments that the board can accept at present.
        room: u16,
        /// Number of the set of messages whose job is in force; 0 for none.
        set: u32,
        /// Feed per tooth at the tool's centre that the law demands, nm; all ones without a demand.
        ipt_center: u32,
        /// Feed of the machine at this override, um/min; all ones if the override does not act on a feed.
        feed: u32,
        /// Amount by which the chip exceeds its target because the override must not be lower, %.
        chip_excess_percent: u8,
    }
    /// Measured values and signals that the machine sends to the board at each period.
    0x60 Machine Sample {
        /// Time by the machine's clock, us.
        at: u64,
        /// Whether the machine runs in real time or in lockstep with the board.
        mode: ModeCode,
        /// X, Y, Z in the workpiece's coordinates, nm; absent if there is no new position.
        linear: Option<[i64; 3]>,
        /// A, B, C, microdegrees; absent if all are 0.
        rotary: Option<[i64; 3]>,
        /// Measured spindle speed, rev/min.
        spindle: Q40,
        /// Position of the operator's override dial, %.
        operator_percent: u8,
        /// Conditions of the control and pressed buttons, one bit each.
        signals: u32,
        /// Bytes sent on the link before this message; wraps around.
        link_bytes: u32,
        /// Bytes sent on the tapped line before this message, both directions together; wraps around.
        tap_bytes: u32,
    }
    /// Outputs of the board, in answer to a sample of the machine.
    0x61 Machine Setpoint {
        /// Field `at` of the answered sample.
        at: u64,
        /// Override lines *FV0 to *FV7 that are low: bit i for line i.
        lines: u8,
        /// State of the supervisor.
        state: StateCode,
        /// Bytes sent on the link before this message; wraps around.
        link_bytes: u32,
        /// Bytes sent on the tapped line before this message, both directions together; wraps around.
        tap_bytes: u32,
    }
}
