//! Enumerations in messages: one byte each; bytes that are not listed are invalid.

use super::field::{DecodeError, EncodeError, Field, Reader, Writer};
use super::schema::FieldType;

/// Declares enumerations with their bytes; the schema contains both.
macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident { $($(#[$value_doc:meta])* $value:ident = $code:literal,)+ })+) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
            #[repr(u8)]
            pub enum $name {
                $($(#[$value_doc])* $value = $code,)+
            }

            impl $name {
                /// All values.
                pub const ALL: &[$name] = &[$($name::$value),+];

                /// The value with this code on the wire; `None` if the code is unknown.
                pub fn of_code(code: u8) -> Option<Self> {
                    match code {
                        $($code => Some($name::$value),)+
                        _ => None,
                    }
                }
            }

            impl Field for $name {
                const TYPE: FieldType = FieldType::plain(concat!(
                    stringify!($name), $(" ", stringify!($code), " ", stringify!($value)),+
                ));

                fn put(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
                    (*self as u8).put(writer)
                }

                fn take(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
                    let code = u8::take(reader)?;
                    $name::of_code(code).ok_or(DecodeError::Code(code))
                }
            }
        )+
    };
}

codes! {
    /// Unit of length in which the program starts and in which reports are written.
    UnitCode {
        /// Inches.
        Inch = 0,
        /// Millimetres.
        Mm = 1,
    }
    /// Way in which the target feed reaches the control: by F words or by the override.
    PolicyCode {
        /// Blocks are sent with the smallest feed that the law demands on them; the override raises it.
        SafeBase = 0,
        /// Blocks are sent with their programmed feed; only the override varies the feed.
        OverrideOnly = 1,
    }
    /// Kind of cutter.
    ToolCode {
        /// A cup mill: a ring with an outer and an inner cutting radius.
        CupMill = 0,
        /// An end mill: a disc with an outer cutting radius.
        EndMill = 1,
    }
    /// Axis of the program's coordinates that is parallel to the tool.
    AxisCode {
        /// X.
        X = 0,
        /// Y.
        Y = 1,
        /// Z.
        Z = 2,
    }
    /// Feed law of a tool.
    LawCode {
        /// Constant feed per tooth on the circumference of a cup mill, at the contact with the stock line.
        Circumference = 0,
        /// The thickest chip anywhere on the engaged arc is kept at the target.
        EngagedArc = 1,
        /// Constant feed per tooth along the finished contour.
        Contour = 2,
        /// Constant chip thickness of an end mill.
        Engagement = 3,
        /// Feed per tooth at the tool's centre, from a table over the path.
        Table = 4,
        /// No law: the program's own feed.
        Programmed = 5,
    }
    /// Moves to which a cut rule applies.
    MovesCode {
        /// G2 about a point on the inner circle of a cup mill.
        InteriorCw = 0,
        /// G3 about a point on the inner circle of a cup mill.
        InteriorCcw = 1,
        /// G2 about a point on the outer circle of a cup mill.
        ExteriorCw = 2,
        /// G3 about a point on the outer circle of a cup mill.
        ExteriorCcw = 3,
        /// Any G2.
        ArcsCw = 4,
        /// Any G3.
        ArcsCcw = 5,
        /// G1.
        Lines = 6,
    }
    /// Cutting circle of the tool, or side of the contour on which an end mill runs.
    WorkCode {
        /// The outer cutting circle.
        RingOuter = 0,
        /// The inner cutting circle of a cup mill.
        RingInner = 1,
        /// An end mill runs inside a concave arc.
        MillInside = 2,
        /// An end mill runs outside a convex arc.
        MillOutside = 3,
        /// An end mill cuts both walls of a slot.
        MillSlot = 4,
    }
    /// Form in which the stock of a cut rule is described.
    StockCode {
        /// No stock: the rule is one of an end mill along a contour.
        None = 0,
        /// Lines that limit the stock; `stock_parts` messages follow.
        Convex = 1,
        /// A round blank; one message follows.
        Disc = 2,
        /// Directions in which the edges are in material, at knots of the path; `stock_parts` messages follow.
        Engaged = 3,
        /// Those directions come with each segment, in `SegmentArcs` messages before it.
        Along = 4,
    }
    /// Shape of a segment; for an arc also its plane and sense.
    PathCode {
        /// Rapid traverse.
        Rapid = 0,
        /// Straight cutting move.
        Line = 1,
        /// G17 G2.
        CwXy = 2,
        /// G17 G3.
        CcwXy = 3,
        /// G18 G2.
        CwZx = 4,
        /// G18 G3.
        CcwZx = 5,
        /// G19 G2.
        CwYz = 6,
        /// G19 G3.
        CcwYz = 7,
    }
    /// Unit of the number in a segment's field `feed`.
    FeedCode {
        /// Nanometres per minute.
        PerMinute = 0,
        /// Inverse time feed (G93): millionths of a block per minute.
        InverseTime = 1,
        /// No feed was given; `feed` is 0.
        Missing = 2,
    }
    /// Request of a person, by a button or by the host.
    RequestCode {
        /// Give the override to the laws.
        Arm = 0,
        /// Give the override back to the operator.
        Disarm = 1,
    }
    /// A setting of the board that the host can read and change.
    SettingCode {
        /// Age, us, from which a position of the machine is stale.
        PositionStale = 0,
        /// Age, us, from which the position counts as lost.
        PositionLost = 1,
        /// Age, us, of the last sample up to which the override keeps its last value after the position was lost;
        /// then it goes to 100 %, or to the dial's value if that is lower.
        PositionKeep = 2,
        /// Age, us, of the host's last frame from which the link is stale.
        LinkStale = 3,
        /// Age, us, of the host's last frame from which the link counts as lost.
        LinkLost = 4,
        /// Age, us, of the host's last frame up to which the override keeps its last value after the link was lost;
        /// then it goes to 100 %, or to the dial's value if that is lower.
        LinkKeep = 5,
        /// Number of consecutive invalid samples or frames that counts as a loss.
        LostFrames = 6,
        /// Time, us, for which position and link must have been fresh after a loss before the laws can be armed again.
        Resync = 7,
        /// Longest expected tick, us; a longer one raises the override only as much as this one would.
        LongestTick = 8,
        /// Position of the operator's dial, %, below which the operator takes the override from the laws.
        DialBelow = 9,
        /// Drop of the operator's dial, percentage points, above which the operator takes the override from the laws.
        DialDrop = 10,
        /// Period, us, of the board's status reports.
        ReportEvery = 11,
    }
    /// State of the supervisor, which decides whether the feed laws may have the override; docs/safety.md#states.
    StateCode {
        /// Not armed since the start: the override has not been given to the laws.
        Idle = 0,
        /// Armed: the laws set the override as soon as a segment begins.
        Armed = 1,
        /// The laws set the override.
        Running = 2,
        /// Feed hold is active, or the override is 0 %: the override does not rise.
        Holding = 3,
        /// Position or link is lost: the last override for a time, then 100 %, or the dial's value if that is lower.
        Fallback = 4,
        /// A fault of the board: 0 % until a person resets it.
        Faulted = 5,
        /// The control does not let the override act (threading, tapping).
        Inhibited = 6,
        /// The operator, or a condition of the control, has taken the override from the laws.
        Disarmed = 7,
    }
    /// Alarm level of the board.
    AlarmCode {
        /// No alarm.
        None = 0,
        /// Alarm that ends with its condition.
        Passing = 1,
        /// Alarm that stays until a person acts.
        Latched = 2,
    }
    /// Cause of the board's start.
    ResetCode {
        /// Power-on or reset pin.
        Power = 0,
        /// Watchdog.
        Watchdog = 1,
        /// Failure of supply or clock.
        Hardware = 2,
        /// Software reset.
        Software = 3,
    }
    /// Reason why the board rejected a message.
    RefusalCode {
        /// The payload does not have the form of a message that the board accepts.
        Message = 0,
        /// The message cannot take effect while the laws have the override and a segment is in execution.
        Busy = 1,
        /// A message of a set of parameters without a `Begin` before it, or with the number of another set.
        NoSet = 2,
        /// Count or checksum in `Commit` differ from those of the received messages.
        Checksum = 3,
        /// A message of the set is missing or duplicated, or engaged arcs of a segment are missing because they were
        /// rejected.
        Incomplete = 4,
        /// A value is outside its range.
        Value = 5,
        /// No set of parameters has been accepted yet, which the message needs.
        NoParameters = 6,
        /// The board has no free place for another segment, or for another knot of engaged arcs.
        Full = 7,
        /// A segment, rule or knot does not follow the one before it.
        Order = 8,
        /// The request is stale: it refers to a report from before the last fallback.
        Outdated = 9,
        /// Arming was refused: a fault of the board is active, or was not reset.
        Faulted = 10,
        /// Arming was refused: position or link is not fresh, or has not been fresh for long enough.
        NotFresh = 11,
        /// Arming was refused: the operator's dial is too low or was turned down.
        Operator = 12,
        /// Arming was refused: a condition of the control forbids it (cutter compensation, override switched off).
        Condition = 13,
    }
    /// Clock of the simulated machine that sends samples to the board.
    ModeCode {
        /// Real time: the byte counts are meaningless.
        Free = 0,
        /// Lockstep: the machine waits for the board's answer.
        Lockstep = 1,
    }
}
