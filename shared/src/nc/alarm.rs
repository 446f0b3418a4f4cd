//! What a control would stop with, and what this crate cannot read yet.
//!
//! Numbers and wording follow the program-error (PS) list of the Fanuc 16i/30i family; a sentence of ours says what
//! to do. Where the families differ the 16i's meaning is taken.

use core::fmt;

use super::macro_alarm::MacroAlarm;

/// A program alarm of the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alarm {
    /// PS0001.
    Character,
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
    /// PS0087.
    BufferOverflow,
    /// PS5010.
    EndOfRecord,
}

impl Alarm {
    /// The number on the control's screen.
    pub const fn number(self) -> u16 {
        match self {
            Alarm::Character => 1,
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
            Alarm::BufferOverflow => 87,
            Alarm::EndOfRecord => 5010,
        }
    }

    /// What it means and what to do, one sentence.
    pub const fn explanation(self) -> &'static str {
        match self {
            Alarm::Character => {
                "TH alarm: a character outside the control's code; use capitals, digits and ( ) * + , - . / = only"
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
            Alarm::BufferOverflow => {
                "buffer overflow: more than 10 characters arrived after DC3; the sender must stop sooner"
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
    /// A system variable of the control whose value is not known here.
    Variable(u32),
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
    /// The control would stop with this alarm of a custom macro or a call.
    Macro(MacroAlarm),
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

    /// A macro alarm at `column`.
    pub const fn in_macro(alarm: MacroAlarm, column: u16) -> Self {
        Fault { cause: Cause::Macro(alarm), column }
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
            NotModelled::Variable(number) => write!(f, "#{number}"),
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
            Cause::Macro(alarm) => match alarm.number() {
                Some(number) => write!(f, "PS{number:04} {}", alarm.explanation()),
                None => f.write_str(alarm.explanation()),
            },
            Cause::NotModelled(what) => {
                write!(f, "{what} is not interpreted by this version; the program is refused rather than guessed at")
            }
        }
    }
}

impl core::error::Error for Cause {}
