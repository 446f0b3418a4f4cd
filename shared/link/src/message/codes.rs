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
    /// Unit of reports.
    UnitCode {
        /// Inches.
        Inch = 0,
        /// Millimetres.
        Mm = 1,
    }
    /// Way in which the target feed reaches the control.
    PolicyCode {
        /// The smallest feed is sent, the override raises it.
        SafeBase = 0,
        /// The programmed feed is sent.
        OverrideOnly = 1,
    }
    /// Kind of cutter.
    ToolCode {
        /// A ring with an outer and an inner radius.
        CupMill = 0,
        /// A disc with an outer radius.
        EndMill = 1,
    }
    /// Tool axis.
    AxisCode {
        /// X.
        X = 0,
        /// Y.
        Y = 1,
        /// Z.
        Z = 2,
    }
    /// The feed law.
    LawCode {
        /// Constant feed per tooth on a ring's circumference.
        Circumference = 0,
        /// The thickest chip over the whole engaged arc.
        EngagedArc = 1,
        /// Constant feed per tooth at the contour.
        Contour = 2,
        /// Constant chip thickness of an end mill.
        Engagement = 3,
        /// Feed per tooth from a table.
        Table = 4,
        /// The program's own feed.
        Programmed = 5,
    }
    /// Moves to which a rule applies.
    MovesCode {
        /// G2 about a point on the inner circle.
        InteriorCw = 0,
        /// G3 about a point on the inner circle.
        InteriorCcw = 1,
        /// G2 about a point on the outer circle.
        ExteriorCw = 2,
        /// G3 about a point on the outer circle.
        ExteriorCcw = 3,
        /// Any G2.
        ArcsCw = 4,
        /// Any G3.
        ArcsCcw = 5,
        /// G1.
        Lines = 6,
    }
    /// Cutting edge.
    WorkCode {
        /// A ring's outer circle.
        RingOuter = 0,
        /// A ring's inner circle.
        RingInner = 1,
        /// An end mill inside a concave arc.
        MillInside = 2,
        /// An end mill outside a convex arc.
        MillOutside = 3,
        /// An end mill in a slot.
        MillSlot = 4,
    }
    /// Description of a ring's stock.
    StockCode {
        /// None: the rule of an end mill.
        None = 0,
        /// `stock_parts` lines.
        Convex = 1,
        /// One disc.
        Disc = 2,
        /// `stock_parts` knots of engaged arcs.
        Engaged = 3,
        /// Given with each segment, by the `SegmentArcs` before it.
        Along = 4,
    }
    /// The shape of a segment.
    PathCode {
        /// Positioning.
        Rapid = 0,
        /// Straight.
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
    /// Unit of a segment's feed.
    FeedCode {
        /// Nanometres per minute.
        PerMinute = 0,
        /// Millionths of a block per minute.
        InverseTime = 1,
        /// No feed was given; `feed` is 0.
        Missing = 2,
    }
    /// Request of a person.
    RequestCode {
        /// Give the override to the laws.
        Arm = 0,
        /// Give the override back to the operator.
        Disarm = 1,
    }
    /// A setting of the board.
    SettingCode {
        /// Age at which a position is stale, us.
        PositionStale = 0,
        /// Age at which the position is lost, us.
        PositionLost = 1,
        /// Time for which the last value is kept after a loss of the position, us.
        PositionKeep = 2,
        /// Age at which the host's last frame is stale, us.
        LinkStale = 3,
        /// Age at which the link is lost, us.
        LinkLost = 4,
        /// Time for which the last value is kept after a loss of the link, us.
        LinkKeep = 5,
        /// Number of consecutive invalid samples or frames that is a loss.
        LostFrames = 6,
        /// Time for which all inputs must be fresh before arming after a loss, us.
        Resync = 7,
        /// Longest tick, us; a longer one raises the override no further.
        LongestTick = 8,
        /// Dial value below which the operator takes over, %.
        DialBelow = 9,
        /// Drop of the dial above which the operator takes over, percentage points.
        DialDrop = 10,
        /// Period of the reports, us.
        ReportEvery = 11,
    }
    /// State of the supervisor; docs/safety.md#states.
    StateCode {
        /// Not armed since the start.
        Idle = 0,
        /// The laws act as soon as a segment begins.
        Armed = 1,
        /// The laws set the override.
        Running = 2,
        /// The axes are at standstill.
        Holding = 3,
        /// Position or link is lost.
        Fallback = 4,
        /// 0 % until a person resets the fault.
        Faulted = 5,
        /// The control does not let the override act.
        Inhibited = 6,
        /// The operator or a condition of the control has taken the override.
        Disarmed = 7,
    }
    /// Alarm level.
    AlarmCode {
        /// No alarm.
        None = 0,
        /// Active while its condition lasts.
        Passing = 1,
        /// Active until a person acts.
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
        /// The payload is not a message that the board accepts.
        Message = 0,
        /// The laws have the override and segments are in execution.
        Busy = 1,
        /// Parameters without `Begin`, or of another set.
        NoSet = 2,
        /// `Commit` has another count or checksum than the received messages.
        Checksum = 3,
        /// A message of the set is missing or duplicated, or engaged arcs of a segment are missing because they were
        /// rejected.
        Incomplete = 4,
        /// Invalid value.
        Value = 5,
        /// No set of parameters has been accepted yet.
        NoParameters = 6,
        /// No room for another segment, or for another knot of engaged arcs.
        Full = 7,
        /// Segment, rule or knot out of order.
        Order = 8,
        /// The request is stale: it was made before the last fallback.
        Outdated = 9,
        /// Arming: a fault is active or was not reset.
        Faulted = 10,
        /// Arming: position or link is not fresh, or has not been for long enough.
        NotFresh = 11,
        /// Arming: the operator's dial.
        Operator = 12,
        /// Arming: a condition of the control.
        Condition = 13,
    }
    /// Clock of the simulated machine.
    ModeCode {
        /// Real time: the byte counts are meaningless.
        Free = 0,
        /// Lockstep: the machine waits for the board's answer.
        Lockstep = 1,
    }
}
