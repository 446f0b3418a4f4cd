//! Alarms of custom macros and subprogram calls.
//!
//! Numbers as in the program-error list of the Fanuc 16i. Where the 30i words an alarm differently, the 16i's meaning
//! applies (076: no P, 078: no such program).

/// An alarm of a custom macro or a subprogram call, or a limit of this interpreter that a control does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MacroAlarm {
    /// PS0076: a call without P.
    NoProgramNumber,
    /// PS0077: subprogram calls nested too deep.
    SubprogramNesting,
    /// PS0078: no program, or no block to return to, has this number.
    ProgramNotFound,
    /// PS0111: the result is too large for a variable.
    Overflow,
    /// PS0112: division by zero.
    DivisionByZero,
    /// PS0113: no such function or statement.
    ImproperFunction,
    /// PS0114: the text is not an expression.
    ExpressionFormat,
    /// PS0115: no variable has this number, or it cannot have this value.
    VariableNumber,
    /// PS0116: the variable can only be read.
    WriteProtected,
    /// PS0118: more than five levels of brackets.
    BracketNesting,
    /// PS0119: the function has no result for this argument.
    IllegalArgument,
    /// PS0122: macro calls nested more than four deep.
    MacroNesting,
    /// PS0123: GOTO, WHILE or DO in the main program in DNC operation.
    NotInDnc,
    /// PS0124: DO and END do not belong together one to one.
    EndMissing,
    /// PS0125: the text is not a macro statement.
    StatementFormat,
    /// PS0126: the number after DO or END is not 1, 2 or 3.
    LoopNumber,
    /// PS0127: NC words and a macro statement in one block.
    MixedStatements,
    /// PS0128: no block of the program has this sequence number.
    SequenceNumber,
    /// PS0129: this letter cannot be an argument of a macro call.
    ArgumentAddress,
    /// 3000 + n: the program has raised it itself with `#3000 = n`.
    User(u16),
    /// Limit of this interpreter: too many statements between two moves, or too many blocks or too much time in all,
    /// so that the program may be in an endless loop.
    Endless,
    /// Limit of this interpreter: the called programs together are larger than the caller allows.
    TooLarge,
}

impl MacroAlarm {
    /// Number of the alarm on the control's screen; `None` for a limit of this interpreter.
    pub const fn number(self) -> Option<u16> {
        Some(match self {
            MacroAlarm::NoProgramNumber => 76,
            MacroAlarm::SubprogramNesting => 77,
            MacroAlarm::ProgramNotFound => 78,
            MacroAlarm::Overflow => 111,
            MacroAlarm::DivisionByZero => 112,
            MacroAlarm::ImproperFunction => 113,
            MacroAlarm::ExpressionFormat => 114,
            MacroAlarm::VariableNumber => 115,
            MacroAlarm::WriteProtected => 116,
            MacroAlarm::BracketNesting => 118,
            MacroAlarm::IllegalArgument => 119,
            MacroAlarm::MacroNesting => 122,
            MacroAlarm::NotInDnc => 123,
            MacroAlarm::EndMissing => 124,
            MacroAlarm::StatementFormat => 125,
            MacroAlarm::LoopNumber => 126,
            MacroAlarm::MixedStatements => 127,
            MacroAlarm::SequenceNumber => 128,
            MacroAlarm::ArgumentAddress => 129,
            MacroAlarm::User(number) => 3_000_u16.saturating_add(number),
            MacroAlarm::Endless | MacroAlarm::TooLarge => return None,
        })
    }

    /// Meaning and remedy in one sentence.
    pub const fn explanation(self) -> &'static str {
        match self {
            MacroAlarm::NoProgramNumber => "M98, G65 or G66 without P; give the program's number",
            MacroAlarm::SubprogramNesting => "subprogram calls nested too deep; a program that calls itself never ends",
            MacroAlarm::ProgramNotFound => {
                "no program, or no block N to return to, of this number; correct P, give the folder of the subprograms (--library), or write an empty one there: O with its number, and M99"
            }
            MacroAlarm::Overflow => "the result is beyond what a variable holds (10^47); check the formula",
            MacroAlarm::DivisionByZero => "division by zero; test the divisor before",
            MacroAlarm::ImproperFunction => "no such function or statement; correct its name",
            MacroAlarm::ExpressionFormat => "this is no expression; check operators, brackets and variables",
            MacroAlarm::VariableNumber => {
                "no variable has this number, or it cannot take this value; correct number or value"
            }
            MacroAlarm::WriteProtected => "this variable can only be read; use another one",
            MacroAlarm::BracketNesting => "more than five levels of brackets; split the expression",
            MacroAlarm::IllegalArgument => "the function has no result for this argument; test the argument before",
            MacroAlarm::MacroNesting => "macro calls nested more than four deep; call with fewer levels",
            MacroAlarm::NotInDnc => {
                "GOTO, WHILE and DO cannot be used in a main program in DNC operation: only subprograms are in memory; run the program from memory, or write it out"
            }
            MacroAlarm::EndMissing => {
                "DO and END do not belong together one to one; write END with the number of its DO"
            }
            MacroAlarm::StatementFormat => "this is no macro statement; correct its form",
            MacroAlarm::LoopNumber => "the number behind DO and END must be 1, 2 or 3",
            MacroAlarm::MixedStatements => "NC words and a macro statement in one block; write two blocks",
            MacroAlarm::SequenceNumber => "no block with this sequence number in the program; correct the number",
            MacroAlarm::ArgumentAddress => "this address cannot be an argument of a macro call; use another letter",
            MacroAlarm::User(_) => "the program stopped itself with #3000; its comment gives the reason",
            MacroAlarm::Endless => {
                "the program does not come to its end: the bound of statements without a move, of blocks or of time is reached; look for a loop without an end"
            }
            MacroAlarm::TooLarge => {
                "the called programs are larger than the limit for programs in memory; shorten them"
            }
        }
    }
}
