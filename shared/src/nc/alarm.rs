//! What a control would stop with, and what this crate cannot read yet.
//!
//! Numbers and wording follow the program-error (PS) list of the Fanuc 16i/30i family; a sentence of ours says what
//! to do. Where the families differ the 16i's meaning is taken.

use core::fmt;

/// A program alarm of the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alarm {
    /// PS0001.
    Character,
    /// PS0002.
    BlockParity,
    /// PS0003.
    TooManyDigits,
    /// PS0005.
    NoDataAfterAddress,
    /// PS0006.
    MinusSign,
    /// PS0007.
    DecimalPoint,
    /// PS0009.
    IllegalAddress,
    /// PS0010.
    ImproperGCode,
    /// PS0011.
    NoFeed,
    /// PS0020.
    RadiusTolerance,
    /// PS0021.
    IllegalPlaneAxis,
    /// PS0022.
    NoRadius,
    /// PS0060.
    SequenceNotFound,
    /// PS0085.
    LineError,
    /// PS0086.
    NotReady,
    /// PS0087.
    BufferOverflow,
    /// PS0123.
    BranchInDnc,
    /// PS5010.
    EndOfRecord,
}

impl Alarm {
    /// The number on the control's screen.
    pub const fn number(self) -> u16 {
        match self {
            Alarm::Character => 1,
            Alarm::BlockParity => 2,
            Alarm::TooManyDigits => 3,
            Alarm::NoDataAfterAddress => 5,
            Alarm::MinusSign => 6,
            Alarm::DecimalPoint => 7,
            Alarm::IllegalAddress => 9,
            Alarm::ImproperGCode => 10,
            Alarm::NoFeed => 11,
            Alarm::RadiusTolerance => 20,
            Alarm::IllegalPlaneAxis => 21,
            Alarm::NoRadius => 22,
            Alarm::SequenceNotFound => 60,
            Alarm::LineError => 85,
            Alarm::NotReady => 86,
            Alarm::BufferOverflow => 87,
            Alarm::BranchInDnc => 123,
            Alarm::EndOfRecord => 5010,
        }
    }

    /// What it means and what to do, one sentence.
    pub const fn explanation(self) -> &'static str {
        match self {
            Alarm::Character => {
                "TH alarm: a character outside the control's code; use capitals, digits and ( ) * + , - . / = only"
            }
            Alarm::BlockParity => {
                "TV alarm: a block with an odd number of characters; let the sender add a blank, or switch the TV check off"
            }
            Alarm::TooManyDigits => "more digits than a control accepts (8); shorten the number",
            Alarm::NoDataAfterAddress => "an address letter without a number after it; write the number",
            Alarm::MinusSign => "a minus sign where none is allowed; remove it",
            Alarm::DecimalPoint => "a decimal point where none is allowed, or a second one; remove it",
            Alarm::IllegalAddress => "this address is not allowed here; remove it or write the letter that is meant",
            Alarm::ImproperGCode => "this control has no such G code; correct it",
            Alarm::NoFeed => "a cutting move without a feed; give F in this block or before it (G93: in every block)",
            Alarm::RadiusTolerance => {
                "no such arc within parameter 3410: its ends differ in radius, or lie farther apart than 2 R; correct the \
                 end point, R or I, J, K"
            }
            Alarm::IllegalPlaneAxis => "an axis outside the selected plane in an arc; select G17, G18 or G19",
            Alarm::NoRadius => "an arc without R or I, J, K; give its centre or radius",
            Alarm::SequenceNotFound => "no block has the sequence number that was searched for; give one that is there",
            Alarm::LineError => {
                "communication error: a character without its stop bits, or lost in the receiver; check baud rate, stop bits \
                 and cable"
            }
            Alarm::NotReady => {
                "the sender's data set ready line is off: it was switched off or closed its port; keep it open to the end"
            }
            Alarm::BufferOverflow => {
                "buffer overflow: more than 10 characters arrived after DC3; the sender must stop sooner"
            }
            Alarm::BranchInDnc => {
                "GOTO, WHILE, DO or END in a program that comes over the line; run it from the control's memory"
            }
            Alarm::EndOfRecord => "the program ended without M02 or M30; write M30 before its last %",
        }
    }
}

/// What a control may well accept but this version does not interpret.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotModelled {
    /// A G code of the control, in tenths (G43.4 is 434).
    GCode(u16),
    /// An M code that changes which block comes next (M98, M99).
    MCode(u16),
    /// Macro statements beyond `#variable=number`.
    Macro,
    /// An arc that also turns a rotary axis.
    RotaryArc,
    /// An arc given by R that ends where it starts in its plane, but not across it.
    ArcWithoutAngle,
    /// More words in a block than [`crate::nc::block::WORDS_MAX`].
    LongBlock,
}

/// Why a block cannot be executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The control would stop with this alarm.
    Alarm(Alarm),
    /// The control may accept it; arcfeed does not interpret it, and refuses rather than guesses.
    NotModelled(NotModelled),
}

/// A cause and where in its line it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What is wrong.
    pub cause: Cause,
    /// Column of the offending byte, counted from 1; 0 for the block as a whole.
    pub column: u16,
}

impl Fault {
    /// An alarm at `column`.
    pub const fn alarm(alarm: Alarm, column: u16) -> Self {
        Fault { cause: Cause::Alarm(alarm), column }
    }

    /// Something not modelled at `column`.
    pub const fn not_modelled(what: NotModelled, column: u16) -> Self {
        Fault { cause: Cause::NotModelled(what), column }
    }
}

impl fmt::Display for NotModelled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            NotModelled::GCode(tenths) if tenths % 10 == 0 => write!(f, "G{}", tenths / 10),
            NotModelled::GCode(tenths) => write!(f, "G{}.{}", tenths / 10, tenths % 10),
            NotModelled::MCode(code) => write!(f, "M{code}"),
            NotModelled::Macro => f.write_str("this macro statement"),
            NotModelled::RotaryArc => f.write_str("an arc that also turns a rotary axis"),
            NotModelled::ArcWithoutAngle => f.write_str("an arc given by R that only moves across its plane"),
            NotModelled::LongBlock => f.write_str("a block of more than 32 words"),
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Cause::Alarm(alarm) => write!(f, "PS{:04} {}", alarm.number(), alarm.explanation()),
            Cause::NotModelled(what) => {
                write!(f, "{what} is not interpreted by this version; the program is refused rather than guessed at")
            }
        }
    }
}

impl core::error::Error for Cause {}
