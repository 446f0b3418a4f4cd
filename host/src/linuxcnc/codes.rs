//! G and M codes of a Fanuc on LinuxCNC: which are the same there, which mean nothing, which are refused.
//!
//! Source: LinuxCNC's documents on G codes and M codes; every rule is confirmed by its `rs274` in `tests/program/linuxcnc.rs`.

/// Source of the feed while LinuxCNC runs the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedSource {
    /// Only the F words of the program.
    Words,
    /// In addition the component `arcfeed`, through LinuxCNC's adaptive feed.
    Component,
}

/// Modal group of a G code on LinuxCNC; two codes of one group cannot be in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CodeGroup {
    /// One of the groups of state (plane, unit, absolute or incremental and the like), by a number that is used only here.
    State(u8),
    /// G0 to G3.
    Motion,
    /// Canned cycles.
    Cycle,
    /// Canned cycles that tap.
    Tapping,
    /// G80.
    CycleEnd,
    /// Codes that act only in their block and use its axis words themselves.
    OneShot,
    /// G53.
    Machine,
    /// G61, G62 and G64.
    Path,
    /// Polar coordinates, scaling, mirror image and rotation, and their ends.
    Transformation,
}

/// Rule for translating a G code to LinuxCNC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GRule {
    /// The code is the same on LinuxCNC.
    Keep(CodeGroup),
    /// The code has no effect on LinuxCNC; it is removed, with the words P and Q of its block.
    Drop,
    /// The code has no effect on LinuxCNC if the block has no axis words.
    DropAlone,
    /// The code is refused, with this remedy.
    Refuse(&'static str),
}

/// Remedy for taps without M29.
pub const TAPPING: &str = "LinuxCNC taps with the spindle (G33.1); write M29 before the cycle if the machine can";
const OFFSET: &str = "set the offset in LinuxCNC's tool table or with G10 L2 P1 to P6";
const POINTS: &str = "LinuxCNC has no such transformation; post the program without it";
const BORING: &str = "LinuxCNC has no such cycle; post its moves";

/// Rule for a G code, given as ten times its number (G54.1 is 541).
pub fn g_rule(tenths: i64) -> GRule {
    use GRule::{Drop, DropAlone, Keep, Refuse};
    match tenths {
        0 | 10 | 20 | 30 => Keep(CodeGroup::Motion),
        40 | 280 | 300 | 520 | 920 | 921 | 100 => Keep(CodeGroup::OneShot),
        50 | 51 | 80 | 110 | 131 | 230 | 670 => Drop,
        150 | 160 | 500 | 501 | 510 | 511 | 680 | 690 => Keep(CodeGroup::Transformation),
        90 => Refuse("LinuxCNC stops exactly under G61.1 only; write G61.1 before the block and G64 behind it"),
        170 | 180 | 190 => Keep(CodeGroup::State(0)),
        200 | 210 => Keep(CodeGroup::State(1)),
        220 => DropAlone,
        400 | 410 | 420 => Keep(CodeGroup::State(2)),
        430 | 490 => Keep(CodeGroup::State(3)),
        440 => Refuse("write G43, and the length with the other sign in LinuxCNC's tool table"),
        430..=439 => Refuse("LinuxCNC has no tool centre point control; post the moves of the axes"),
        682..=684 => Refuse(POINTS),
        530 => Keep(CodeGroup::Machine),
        540 | 541 | 550 | 560 | 570 | 580 | 590 => Keep(CodeGroup::State(4)),
        610 | 620 | 640 => Keep(CodeGroup::Path),
        630 => Refuse(TAPPING),
        740 | 840 => Keep(CodeGroup::Tapping),
        730 | 810 | 820 | 830 | 850 | 860 | 890 => Keep(CodeGroup::Cycle),
        760 | 870 | 880 => Refuse(BORING),
        800 => Keep(CodeGroup::CycleEnd),
        900 | 910 => Keep(CodeGroup::State(5)),
        901 | 911 => Keep(CodeGroup::State(6)),
        930 | 940 | 950 => Keep(CodeGroup::State(7)),
        970 => Keep(CodeGroup::State(8)),
        980 | 990 => Keep(CodeGroup::State(9)),
        _ => Refuse("LinuxCNC has no such G code; remove it, or post the program for LinuxCNC"),
    }
}

/// Remedy for G10, whose tables are LinuxCNC's own.
pub const OFFSET_REMEDY: &str = OFFSET;

/// Modal group of an M code on LinuxCNC.
///
/// # Errors
/// LinuxCNC does not have it: the remedy.
pub fn m_group(code: i64) -> Result<u8, &'static str> {
    match code {
        0 | 1 | 2 | 30 => Ok(0),
        3..=5 => Ok(1),
        6 => Ok(2),
        7..=9 => Ok(3),
        19 => Ok(4),
        48 | 49 => Ok(5),
        _ => Err("LinuxCNC has no such M code; remove it, or write one of its M100 to M199 after the adaptation"),
    }
}
