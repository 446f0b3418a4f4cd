//! Alarms of the control, and constructs that this crate does not interpret yet.
//!
//! Numbers and wording follow the program-error (PS) list of the Fanuc 16i/30i family; a sentence of ours gives the
//! remedy. Where the families differ, the 16i's meaning applies.

use core::fmt;

use super::macro_alarm::MacroAlarm;

/// Declares [`Alarm`] from its table: number, condition, remedy.
macro_rules! alarms {
    ($($name:ident = $number:literal: $when:literal, $remedy:literal;)*) => {
        /// A program alarm of the control.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Alarm {
            $(#[doc = concat!("PS", stringify!($number), ": ", $when, ".")] $name,)*
        }

        impl Alarm {
            /// All alarms, by number.
            pub const ALL: &'static [Alarm] = &[$(Alarm::$name),*];

            /// The number on the control's screen.
            pub const fn number(self) -> u16 {
                match self { $(Alarm::$name => $number,)* }
            }

            /// Condition under which the control raises the alarm.
            pub const fn when(self) -> &'static str {
                match self { $(Alarm::$name => $when,)* }
            }

            /// Advice how to remove the cause of the alarm.
            pub const fn remedy(self) -> &'static str {
                match self { $(Alarm::$name => $remedy,)* }
            }

            /// Condition and remedy in one sentence.
            pub const fn explanation(self) -> &'static str {
                match self { $(Alarm::$name => concat!($when, "; ", $remedy),)* }
            }
        }
    };
}

alarms! {
    Character = 1: "TH alarm: a character outside the control's code",
        "use capitals, digits and ( ) * + , - . / = only";
    BlockParity = 2: "TV alarm: a block with an odd number of characters",
        "let the sender add a blank, or switch the TV check off";
    TooManyDigits = 3: "more digits than a control accepts here", "shorten the number: 8 digits in all, fewer for S";
    AddressNotFound = 4: "a number or a sign at the beginning of a block without an address", "write its address letter before it";
    NoDataAfterAddress = 5: "an address letter without a number after it", "write the number behind the letter, or remove the letter";
    MinusSign = 6: "a minus sign where none is allowed", "remove it";
    DecimalPoint = 7: "a decimal point where none is allowed, or a second one", "remove it";
    IllegalAddress = 9: "this address is not allowed here", "remove it or write the letter that is meant";
    ImproperGCode = 10: "this control has no such G code", "correct it, or look up which code of this control does the same";
    NoFeed = 11: "a cutting move without a feed", "give F in this block or before it (G93: in every block)";
    RadiusTolerance = 20:
        "no such arc within parameter 3410: its ends differ in radius, or lie farther apart than 2 R",
        "correct the end point, R or I, J, K";
    NoRadius = 22: "an arc without R or I, J, K", "give its centre or radius";
    OffsetNumber = 30: "an offset number that the control does not have", "correct H, D or P (H and D to 400)";
    DataTarget = 31: "G10 without a P or L that says where the data belong", "write L2 P0 to P6, L20 P1 to P48, or L10 to L13 with P and R";
    NoIntersection = 33: "no intersection of the offset paths of this move and the next one under G41 or G42",
        "use a smaller tool, or give the corner an arc";
    ArcAtStartUp = 34: "an arc as the first move in the plane with or behind G41, G42 or G40", "make that move a line";
    PlaneUnderCompensation = 37: "another plane under G41 or G42", "select the plane before G41 or G42, or after G40";
    ArcEndInCenter = 38: "an arc under G41 or G42 that starts or ends in its centre", "correct its end or I, J, K";
    Interference = 41: "interference: the offset path of this move under G41 or G42 opposes the programmed move (overcutting)",
        "use a smaller tool, or a contour that the tool can follow: arcs not below its radius, no narrower step or slot";
    ReferenceInCycle = 44: "G27 to G30 in a canned cycle", "write G80 before it";
    NoPeck = 45: "G73 or G83 without a depth of cut", "give Q";
    ReferencePoint = 46: "G30 with a P other than 2, 3 and 4", "write P2, P3 or P4";
    NoMoveBehindCorner = 51: "no move of sufficient length in the plane behind a chamfer or rounded corner (,C and ,R)",
        "write the next move of the contour directly behind it, or a smaller corner";
    NoCutBehindCorner = 52: "the block behind a chamfer or rounded corner (,C and ,R) is not G1, G2 or G3",
        "write the next move of the contour directly behind it";
    TwoCorners = 53: "both ,C and ,R in a block", "write one of them";
    ShortCorner = 55: "a move that is shorter than its chamfer or rounded corner (,C and ,R)", "write a smaller corner or a longer move";
    SequenceNotFound = 60: "no block has the sequence number that was searched for", "search for one that the program has";
    ProgramNumber = 74: "program number 0, or sequence number 0, which a control may take for a program number",
        "count from 1";
    LineError = 85: "communication error: a character without its stop bits, or lost in the receiver",
        "check baud rate, stop bits and cable";
    NotReady = 86: "the sender's data set ready line is off: it was switched off or closed its port",
        "keep it open to the end";
    BufferOverflow = 87: "buffer overflow: more than 10 characters arrived after DC3", "the sender must stop sooner: use RTS/CTS or a lower baud rate";
    LookAheadFormat = 109: "G08 with anything but P0 and P1", "write P1 to switch it on, P0 to switch it off";
    RotationPlane = 144: "an arc outside the plane in which G68 turns", "select the plane of G68 or cancel it with G69";
    EndOfRecord = 5010: "the program ended without M02 or M30", "write M30 before its last %";
}

/// Construct that a control may accept but that this version does not interpret, so that it rejects the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotModelled {
    /// This G code, in tenths (G43.4 is 434).
    GCode(u16),
    /// A move while this G code, in tenths, is in force.
    MoveUnder(u16),
    /// After G68 or G69, a move in the plane that does not name both axes of the plane in absolute coordinates.
    AfterRotation,
    /// This M code, because it changes the order of the blocks (M98, M99).
    MCode(u16),
    /// A macro statement other than `#variable=number`.
    Macro,
    /// The system variable with this number: its value is not known here.
    Variable(u32),
    /// The variable with this number: only the control knows its value at this place.
    OutsideValue(u32),
    /// A macro statement that sets the offset with this variable number.
    OffsetStatement(u32),
    /// A `/` (block delete) whose switch decides on the order in which blocks are executed.
    SwitchedStatement,
    /// An arc that also turns a rotary axis.
    RotaryArc,
    /// An arc given by R that ends where it starts in its plane, but not across it.
    ArcWithoutAngle,
    /// A change from G41 to G42 or back, or to an offset radius of the other sign, without G40 before it.
    ChangeOfSide,
    /// A new offset radius, under G41 or G42, in the block of an arc.
    RadiusInArc,
    /// This G code, in tenths, between two moves that are offset under G41 or G42.
    InContour(u16),
    /// Under G41 or G42, a corner between two moves that are so many blocks apart that the control does not read both
    /// together.
    UnreadCorner,
    /// A restart of the program at a block whose moves are offset under G41 or G42.
    RestartInContour,
    /// G10 for an additional work coordinate system that is not stored here (beyond G54.1 P48).
    FarSystem,
    /// A chamfer or rounded corner (`,C` and `,R`) that does not join two plain moves in the plane. As the reason why
    /// a move is not plain: the move has a corner at one of its ends.
    Corner,
    /// A block of more than [`crate::block::WORDS_MAX`] words.
    LongBlock,
}

/// Reason why a block cannot be executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The control would stop with this alarm.
    Alarm(Alarm),
    /// The control would stop with this alarm of a custom macro or a call.
    Macro(MacroAlarm),
    /// A control may accept it, but arcfeed does not interpret it and rejects the program.
    NotModelled(NotModelled),
}

/// Reason why a block cannot be executed, and the column at which it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Reason why the block cannot be executed.
    pub cause: Cause,
    /// Column of the offending byte, counted from 1; 0 for the block as a whole.
    pub column: u16,
}

impl Fault {
    /// Fault with an alarm of the control; `column` counts from 1, 0 is the whole block.
    pub const fn alarm(alarm: Alarm, column: u16) -> Self {
        Fault { cause: Cause::Alarm(alarm), column }
    }

    /// Fault with an alarm of a custom macro or a call; `column` counts from 1, 0 is the whole block.
    pub const fn in_macro(alarm: MacroAlarm, column: u16) -> Self {
        Fault { cause: Cause::Macro(alarm), column }
    }

    /// Fault with a construct that is not interpreted; `column` counts from 1, 0 is the whole block.
    pub const fn not_modelled(what: NotModelled, column: u16) -> Self {
        Fault { cause: Cause::NotModelled(what), column }
    }
}

impl NotModelled {
    /// Advice how to write the program without the construct.
    pub const fn remedy(self) -> &'static str {
        match self {
            NotModelled::GCode(tenths) | NotModelled::MoveUnder(tenths) => g_remedy(tenths),
            NotModelled::AfterRotation => "name both axes of the plane in this block, under G90",
            NotModelled::MCode(96) => "write the program without interrupts",
            NotModelled::MCode(97) => {
                "with P it calls blocks of the same program on a Haas: write them as a program of its own, and call it with M98 P"
            }
            NotModelled::MCode(_) | NotModelled::Macro => "write the program out without calls and macro statements",
            NotModelled::Variable(number) => variable_remedy(number),
            NotModelled::OutsideValue(number) => value_remedy(number),
            NotModelled::OffsetStatement(_) => "write G10",
            NotModelled::SwitchedStatement => "remove it, or the block",
            NotModelled::ChangeOfSide => "write G40 and a line between the two sides",
            NotModelled::RadiusInArc => "write D or G10 in a line before the arc",
            NotModelled::InContour(_) => "write it before G41 or G42, or after G40 and its line",
            NotModelled::UnreadCorner => "put these blocks before the contour or behind it",
            NotModelled::RestartInContour => "restart at a block before G41 or G42",
            NotModelled::RotaryArc => "turn the rotary axis in a block of its own, or post the arc as lines",
            NotModelled::ArcWithoutAngle => "give the centre with I, J, K",
            NotModelled::FarSystem => "enter the offset at the control, or use G54.1 P1 to P48",
            NotModelled::Corner => "write the corner as a block of its own",
            NotModelled::LongBlock => "divide the block",
        }
    }
}

/// Remedy for a system variable that is not interpreted.
const fn variable_remedy(number: u32) -> &'static str {
    match number {
        1_000..=1_199 => "signals of the machine: write the value in place of the variable",
        5_061..=5_066 => {
            "positions at which G31 stopped: measure in a program of its own, and write the value in place of the variable"
        }
        5_081..=5_086 => "the tool length in force: read #2001 to #2200 by H, with the lengths in a settings file",
        5_400..=5_413 => {
            "the tool's number, lengths and diameter on LinuxCNC: read #4120 for T, #2001 to #2200 for the length by H, #13001 to #13400 \
             for the radius by D, with lengths and radii in a settings file"
        }
        _ => "write the value in place of the variable",
    }
}

/// Remedy for the reading of a variable whose value only the control knows.
const fn value_remedy(number: u32) -> &'static str {
    match number {
        2_001..=2_400 | 10_001..=11_400 => {
            "give the tool lengths in a settings file ([length]), or assign it before it is read"
        }
        12_001..=13_400 => "give the radii of the tools in a settings file ([radius]), or assign it before it is read",
        2_500..=2_899 | 5_201..=5_326 | 7_001..=7_946 | 14_001..=19_999 => {
            "give the work offsets in a settings file ([work]), or assign it before it is read"
        }
        3_001..=3_012 => "it is the control's clock: remove the statement",
        5_001..=5_046 => "write a move to a stated X, Y and Z before it is read",
        _ => "assign it before it is read",
    }
}

/// Remedy for a G code, in tenths, that is not interpreted.
const fn g_remedy(tenths: u16) -> &'static str {
    match tenths {
        50 => "G5 P0 and G5 P10000 are read; write the moves that another P calls",
        51 => "G5.1 Q0 and G5.1 Q1 are read; write one of them",
        100 => "enter tool life and parameters at the control, not by G10",
        270 => "remove the check of the reference point; G28 goes there",
        310 => "measure in a program of its own",
        330 => "cut the thread with G84, or with helices G2 or G3",
        434 | 435 => "post the program for the rotary axes, or check it with --machine",
        500 | 510 | 511 | 680 => "post the moves in the coordinates that they have after it",
        531 | 682 | 683 | 684 => "post the program without a tilted plane, in the machine's axes",
        660 | 661 => "call the macro with G65 at each place",
        880 => "use G82, G85 or G86: in G88 the operator retracts the tool by hand",
        _ => "post the program without it",
    }
}

impl fmt::Display for NotModelled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            NotModelled::GCode(tenths) => write_g(f, tenths),
            NotModelled::MoveUnder(tenths) => {
                f.write_str("a move under ")?;
                write_g(f, tenths)
            }
            NotModelled::AfterRotation => {
                f.write_str("a move behind G68 or G69 without both axes of the plane in absolute terms")
            }
            NotModelled::MCode(code) => write!(f, "M{code}"),
            NotModelled::Macro => f.write_str("this macro statement"),
            NotModelled::Variable(number) => write!(f, "#{number}"),
            NotModelled::OutsideValue(number) => {
                write!(f, "the value of #{number} here is known to the control only")
            }
            NotModelled::OffsetStatement(number) => {
                write!(f, "#{number} sets an offset, which the blocks as executed cannot")
            }
            NotModelled::SwitchedStatement => f.write_str("a / before a macro statement, a call, a program number or the end of the program, or under a modal call"),
            NotModelled::RotaryArc => f.write_str("an arc that also turns a rotary axis"),
            NotModelled::ArcWithoutAngle => f.write_str("an arc given by R that only moves across its plane"),
            NotModelled::ChangeOfSide => f.write_str("a change of side under G41 or G42 without G40 before it"),
            NotModelled::RadiusInArc => f.write_str("another radius (D, G10) in the block of an arc under G41 or G42"),
            NotModelled::InContour(tenths) => {
                write_g(f, tenths)?;
                f.write_str(" within a contour under G41 or G42")
            }
            NotModelled::UnreadCorner => f.write_str(
                "a corner under G41 or G42 behind more blocks without a move in the plane, or a stop, than the control \
                 reads across (it would cut too much or too little there)",
            ),
            NotModelled::RestartInContour => f.write_str("a restart within a contour under G41 or G42"),
            NotModelled::FarSystem => f.write_str("G10 L20 for a system after G54.1 P48"),
            NotModelled::Corner => f.write_str(
                "a chamfer or rounded corner (`,C` or `,R`) other than between two moves G1, G2 or G3 that stay in the plane",
            ),
            NotModelled::LongBlock => f.write_str("a block of more than 32 words"),
        }
    }
}

fn write_g(f: &mut fmt::Formatter<'_>, tenths: u16) -> fmt::Result {
    match tenths % 10 {
        0 => write!(f, "G{}", tenths / 10),
        tenth => write!(f, "G{}.{tenth}", tenths / 10),
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Cause::Alarm(alarm) => write!(f, "PS{:04} {}", alarm.number(), alarm.explanation()),
            Cause::Macro(alarm) => match alarm.number() {
                Some(number) => write!(f, "PS{number:04} {}", alarm.explanation()),
                None => f.write_str(alarm.explanation()),
            },
            Cause::NotModelled(
                what
                @ (NotModelled::OutsideValue(_) | NotModelled::OffsetStatement(_) | NotModelled::SwitchedStatement),
            ) => write!(f, "{what}; {}", what.remedy()),
            Cause::NotModelled(what) => {
                write!(f, "{what} is not interpreted by arcfeed; {}", what.remedy())
            }
        }
    }
}

impl core::error::Error for Cause {}
