//! Choices in messages: one byte each, and no byte that is not listed.

use super::field::{DecodeError, EncodeError, Field, Reader, Writer};
use super::schema::FieldType;

/// Enumerations with their bytes; the schema names both.
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
                /// All of them.
                pub const ALL: &[$name] = &[$($name::$value),+];

                /// The choice of a byte.
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
    /// The unit that reports speak.
    UnitCode {
        /// Inches.
        Inch = 0,
        /// Millimetres.
        Mm = 1,
    }
    /// How the wanted feed reaches the control.
    PolicyCode {
        /// The least feed is sent, the override raises it.
        SafeBase = 0,
        /// The program's own feed is sent.
        OverrideOnly = 1,
    }
    /// The cutter.
    ToolCode {
        /// A ring with an outer and an inner radius.
        CupMill = 0,
        /// A disc with an outer radius.
        EndMill = 1,
    }
    /// The tool's axis.
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
        /// Computed beforehand.
        Table = 4,
        /// The program's own feed.
        Programmed = 5,
    }
    /// Which moves a rule speaks of.
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
    /// What cuts.
    WorkCode {
        /// A ring's outer circle.
        RingOuter = 0,
        /// A ring's inner circle.
        RingInner = 1,
        /// An end mill inside a concave arc.
        MillInside = 2,
        /// An end mill outside a convex arc.
        MillOutside = 3,
        /// An end mill with both walls at once.
        MillSlot = 4,
    }
    /// How a ring's stock is described.
    StockCode {
        /// Not at all: an end mill's rule.
        None = 0,
        /// By `stock_parts` lines.
        Convex = 1,
        /// By one disc.
        Disc = 2,
        /// By `stock_parts` knots of engaged arcs.
        Engaged = 3,
        /// With each segment, by the `SegmentArcs` before it.
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
    /// What the feed of a segment counts.
    FeedCode {
        /// Nanometres per minute.
        PerMinute = 0,
        /// Millionths of a block per minute.
        InverseTime = 1,
        /// None was ever given; `feed` is 0.
        Missing = 2,
    }
    /// What a person asks for.
    RequestCode {
        /// Let the laws have the override.
        Arm = 0,
        /// Give it back to the operator.
        Disarm = 1,
    }
    /// One setting of the board.
    SettingCode {
        /// us: an older position is stale.
        PositionStale = 0,
        /// us: so long without a position is a loss.
        PositionLost = 1,
        /// us: how long the last value stays after a loss of the position.
        PositionKeep = 2,
        /// us: an older word of the host is stale.
        LinkStale = 3,
        /// us: so long without a word of the host is a loss.
        LinkLost = 4,
        /// us: how long the last value stays after a loss of the link.
        LinkKeep = 5,
        /// Invalid samples or frames in a row that are a loss.
        LostFrames = 6,
        /// us: how long all must be fresh before arming after a loss.
        Resync = 7,
        /// us: a longer tick raises the override no further.
        LongestTick = 8,
        /// %: a dial below takes over.
        DialBelow = 9,
        /// Points of per cent: a dial turned down by more takes over.
        DialDrop = 10,
        /// us: from one report to the next.
        ReportEvery = 11,
    }
    /// Who has the override; docs/safety.md#states.
    StateCode {
        /// Never armed.
        Idle = 0,
        /// A law may act as soon as a segment begins.
        Armed = 1,
        /// The laws decide.
        Running = 2,
        /// The axes stand.
        Holding = 3,
        /// Position or link lost.
        Fallback = 4,
        /// 0 % until a person resets.
        Faulted = 5,
        /// Nothing for the override to act on.
        Inhibited = 6,
        /// The operator or a condition took the override.
        Disarmed = 7,
    }
    /// Whether somebody should look.
    AlarmCode {
        /// No.
        None = 0,
        /// While its condition lasts.
        Passing = 1,
        /// Until a person acts.
        Latched = 2,
    }
    /// Why the board started.
    ResetCode {
        /// Power-on or its reset pin.
        Power = 0,
        /// Its watchdog bit.
        Watchdog = 1,
        /// Supply or clock failed.
        Hardware = 2,
        /// It was asked to.
        Software = 3,
    }
    /// Why the board did not do what a message asked for.
    RefusalCode {
        /// The payload is no message that it takes.
        Message = 0,
        /// The laws have the override and segments are in work.
        Busy = 1,
        /// A parameter without `Begin`, or of another set.
        NoSet = 2,
        /// `Commit` counts or checks other messages than came.
        Checksum = 3,
        /// The set lacks a message, or has one twice; a segment lacks engaged arcs, which were refused.
        Incomplete = 4,
        /// A value makes no sense.
        Value = 5,
        /// No parameters have been accepted yet.
        NoParameters = 6,
        /// There is no room for another segment, or for another place of engaged arcs.
        Full = 7,
        /// Not the segment, or the place of engaged arcs, that comes next.
        Order = 8,
        /// The request speaks of a time before the override was last taken away.
        Outdated = 9,
        /// Arming: a fault is there, or was not reset.
        Faulted = 10,
        /// Arming: position or link is not fresh, or not for long enough.
        NotFresh = 11,
        /// Arming: the operator's dial.
        Operator = 12,
        /// Arming: a condition of the control.
        Condition = 13,
    }
    /// Who says when the machine moves on.
    ModeCode {
        /// Time: the counts of bytes are of no meaning.
        Free = 0,
        /// The board's answer.
        Lockstep = 1,
    }
}
