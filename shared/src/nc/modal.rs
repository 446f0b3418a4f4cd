//! Blocks to motions: the modal state of the control and what one block does to it.
//!
//! Axis words without a decimal point count in least increments (0.001 mm, 0.0001 in), as a control set to the
//! conventional input does; F counts in whole millimetres or inches per minute (`F25` is 25 in/min under G20).
//! Coordinates are those of the program: work offsets and tool lengths shift the machine, not the chip.

use super::alarm::{Alarm, Fault, NotModelled};
use super::block::Block;
use super::number::Number;
use super::word::Word;
use crate::units::{LengthUnit, MICRODEG_PER_DEG, MicroDeg, Micros, Nm, US_PER_MS, US_PER_S};

/// Least increments of a rotary axis in a degree (0.001 deg).
const ROTARY_INCREMENTS_PER_DEG: i64 = 1_000;
/// Least increments in one unit of length: 0.001 mm, 0.0001 in.
const fn increments_per_unit(unit: LengthUnit) -> i64 {
    match unit {
        LengthUnit::Mm => 1_000,
        LengthUnit::Inch => 10_000,
    }
}
/// An inverse-time feed of 1/min in the integer this module keeps.
pub const PER_MIN_SCALE: i64 = 1_000_000;

/// The modal state that a block inherits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modal {
    /// G20 / G21.
    pub unit: LengthUnit,
    /// G17 / G18 / G19.
    pub plane: Plane,
    /// G90 / G91.
    pub absolute: bool,
    /// G0 / G1 / G2 / G3.
    pub motion: MotionKind,
    /// G93 / G94.
    pub feed_mode: FeedMode,
    /// The last F given under G94, if any; G93 forgets it.
    pub feed: Option<Nm>,
    /// Where the tool centre stands.
    pub position: Pose,
}

/// Group 01.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    /// G0.
    Rapid,
    /// G1.
    Line,
    /// G2, G3.
    Arc(Turn),
}

/// The sense of an arc, seen against the plane's normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// G2.
    Cw,
    /// G3.
    Ccw,
}

impl Turn {
    /// +1 for counter-clockwise, -1 for clockwise.
    pub const fn sign(self) -> i8 {
        match self {
            Turn::Cw => -1,
            Turn::Ccw => 1,
        }
    }
}

/// Group 02: the plane of arcs, as indices of its first and second axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// G17.
    Xy,
    /// G18.
    Zx,
    /// G19.
    Yz,
}

/// Group 05.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedMode {
    /// G94.
    PerMinute,
    /// G93: F is the number of times a minute that the block would fit.
    InverseTime,
}

/// Where the tool centre and the rotary axes stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pose {
    /// X, Y, Z.
    pub linear: [Nm; 3],
    /// A, B, C.
    pub rotary: [MicroDeg; 3],
}

/// A feed as programmed, exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feed {
    /// Nanometres per minute.
    PerMinute(Nm),
    /// Blocks per minute in [`PER_MIN_SCALE`]ths.
    InverseTime(i64),
    /// A cutting move for which no F was ever given.
    Missing,
}

/// A motion that a block asks for; its geometry is not checked yet (see [`crate::segment`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motion {
    /// How to get there.
    pub kind: MotionKind,
    /// The plane of an arc.
    pub plane: Plane,
    /// From.
    pub start: Pose,
    /// To.
    pub end: Pose,
    /// What says where the centre of an arc is.
    pub center: Center,
    /// Feed; [`Feed::Missing`] also for rapids.
    pub feed: Feed,
}

/// How the centre of an arc is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Center {
    /// I, J, K: relative to the start.
    Offset([Nm; 3]),
    /// R: the radius, negative for the way round of more than 180 degrees. I, J, K beside it count for nothing.
    Radius(Nm),
}

/// Where the program goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// M0: wait for the operator.
    Program,
    /// M1: wait if the switch is on.
    Optional,
    /// M2, M30.
    End,
}

/// What one block does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Step {
    /// The move.
    pub motion: Option<Motion>,
    /// G4.
    pub dwell: Option<Micros>,
    /// M0, M1, M2, M30.
    pub stop: Option<Stop>,
    /// S: spindle speed in rev/min and the column it stands at.
    pub spindle: Option<(i64, u16)>,
}

impl Plane {
    /// Indices into [`Pose::linear`] of the first and second axis and of the normal.
    pub const fn axes(self) -> (usize, usize, usize) {
        match self {
            Plane::Xy => (0, 1, 2),
            Plane::Zx => (2, 0, 1),
            Plane::Yz => (1, 2, 0),
        }
    }
}

impl Modal {
    /// The state after power-on: G0, G17, G90, G94, at the origin, no feed.
    pub fn at_power_on(unit: LengthUnit) -> Self {
        Modal {
            unit,
            plane: Plane::Xy,
            absolute: true,
            motion: MotionKind::Rapid,
            feed_mode: FeedMode::PerMinute,
            feed: None,
            position: Pose::default(),
        }
    }

    /// The state after `block` and what the block does; `self` stays as it was, so a refused block leaves no trace.
    ///
    /// # Errors
    /// The first alarm the control would raise, or what this version does not interpret.
    pub fn interpret(&self, block: &Block) -> Result<(Modal, Step), Fault> {
        let mut next = *self;
        let mut dwells = false;
        for word in block.words.iter().filter(|word| word.letter == b'G') {
            dwells |= next.apply_g(word)?;
        }
        let mut step = Step::default();
        for word in &block.words {
            match word.letter {
                b'M' => step.stop = m_code(word)?.or(step.stop),
                b'S' => step.spindle = Some((word.number.scaled(1), word.column)),
                b'F' if word.number.scaled(PER_MIN_SCALE) < 0 => {
                    return Err(Fault::alarm(Alarm::MinusSign, word.column + 1));
                }
                _ => {}
            }
        }
        if dwells {
            step.dwell = Some(dwell_time(block)?);
            return Ok((next, step));
        }
        let feed = next.take_feed(block);
        if let Some(motion) = next.motion_of(block, feed)? {
            next.position = motion.end;
            step.motion = Some(motion);
        }
        Ok((next, step))
    }

    /// Applies one G word; true if the block is a dwell.
    fn apply_g(&mut self, word: &Word) -> Result<bool, Fault> {
        let improper = Fault::alarm(Alarm::ImproperGCode, word.column);
        let tenths = word.number.as_tenths().ok_or(improper)?;
        match tenths {
            0 => self.motion = MotionKind::Rapid,
            10 => self.motion = MotionKind::Line,
            20 => self.motion = MotionKind::Arc(Turn::Cw),
            30 => self.motion = MotionKind::Arc(Turn::Ccw),
            40 => return Ok(true),
            170 => self.plane = Plane::Xy,
            180 => self.plane = Plane::Zx,
            190 => self.plane = Plane::Yz,
            200 => self.unit = LengthUnit::Inch,
            210 => self.unit = LengthUnit::Mm,
            900 => self.absolute = true,
            910 => self.absolute = false,
            930 => self.feed_mode = FeedMode::InverseTime,
            940 => self.feed_mode = FeedMode::PerMinute,
            // Compensation off, work offsets, exact stop and cutting mode, canned cycle off, return level: none of
            // them moves the path within the program's own coordinates.
            400 | 430 | 490 | 540..=590 | 610 | 640 | 800 | 980 | 990 if tenths % 10 == 0 => {}
            _ if is_fanuc_g(tenths) => {
                let code = u16::try_from(tenths).map_err(|_| improper)?;
                return Err(Fault::not_modelled(NotModelled::GCode(code), word.column));
            }
            _ => return Err(improper),
        }
        Ok(false)
    }

    /// The feed this block moves with; a G94 feed is remembered, an inverse time is not.
    fn take_feed(&mut self, block: &Block) -> Feed {
        let word = block.word(b'F');
        match self.feed_mode {
            FeedMode::PerMinute => {
                if let Some(word) = word {
                    self.feed = Some(Nm(word.number.scaled(self.unit.nm())));
                }
                self.feed.map_or(Feed::Missing, Feed::PerMinute)
            }
            FeedMode::InverseTime => {
                // What F means after G93 until it is given again differs from control to control.
                self.feed = None;
                word.map_or(Feed::Missing, |word| Feed::InverseTime(word.number.scaled(PER_MIN_SCALE)))
            }
        }
    }

    /// The move that the block's axis words ask for, if there are any.
    fn motion_of(&self, block: &Block, feed: Feed) -> Result<Option<Motion>, Fault> {
        let mut end = self.position;
        let mut offset = [Nm(0); 3];
        let (mut moves, mut has_offset) = (false, false);
        for word in &block.words {
            let linear = Nm(self.length(word.number));
            match word.letter {
                letter @ b'X'..=b'Z' => {
                    set(&mut end.linear, letter - b'X', |old| Nm(self.target(old.0, linear.0)));
                    moves = true;
                }
                letter @ b'A'..=b'C' => {
                    let angle = rotary(word.number);
                    set(&mut end.rotary, letter - b'A', |old| MicroDeg(self.target(old.0, angle)));
                    moves = true;
                }
                letter @ b'I'..=b'K' => {
                    set(&mut offset, letter - b'I', |_| linear);
                    has_offset = true;
                }
                _ => {}
            }
        }
        let is_arc = matches!(self.motion, MotionKind::Arc(_));
        let radius = block.word(b'R').filter(|_| is_arc).map(|word| Nm(self.length(word.number)));
        if is_arc && moves && !has_offset && radius.is_none() {
            return Err(Fault::alarm(Alarm::NoRadius, 0));
        }
        let is_move = match radius {
            // An arc of no angle.
            Some(_) => end != self.position,
            // I, J, K without an axis word is a full circle under G2 and G3, and nothing otherwise.
            None => moves || (is_arc && has_offset),
        };
        Ok(is_move.then_some(Motion {
            kind: self.motion,
            plane: self.plane,
            start: self.position,
            end,
            center: radius.map_or(Center::Offset(offset), Center::Radius),
            feed: if self.motion == MotionKind::Rapid { Feed::Missing } else { feed },
        }))
    }

    fn length(&self, number: Number) -> i64 {
        if number.has_point {
            number.scaled(self.unit.nm())
        } else {
            number.scaled(self.unit.nm() / increments_per_unit(self.unit))
        }
    }

    fn target(&self, from: i64, value: i64) -> i64 {
        if self.absolute { value } else { from.saturating_add(value) }
    }
}

fn set<T: Copy>(axes: &mut [T; 3], index: u8, value: impl FnOnce(T) -> T) {
    if let Some(axis) = axes.get_mut(usize::from(index)) {
        *axis = value(*axis);
    }
}

fn rotary(number: Number) -> i64 {
    if number.has_point {
        number.scaled(MICRODEG_PER_DEG)
    } else {
        number.scaled(MICRODEG_PER_DEG / ROTARY_INCREMENTS_PER_DEG)
    }
}

/// G4: P counts milliseconds, X seconds.
fn dwell_time(block: &Block) -> Result<Micros, Fault> {
    let (word, scale) = match (block.word(b'P'), block.word(b'X')) {
        (Some(word), _) => (word, US_PER_MS),
        (None, Some(word)) => (word, US_PER_S),
        (None, None) => return Ok(Micros(0)),
    };
    let span = word.number.scaled(scale as i64);
    u64::try_from(span).map(Micros).map_err(|_| Fault::alarm(Alarm::MinusSign, word.column + 1))
}

fn m_code(word: &Word) -> Result<Option<Stop>, Fault> {
    let fault = Fault::alarm(Alarm::DecimalPoint, word.column);
    Ok(match word.number.as_whole().ok_or(fault)? {
        0 => Some(Stop::Program),
        1 => Some(Stop::Optional),
        2 | 30 => Some(Stop::End),
        code @ (98 | 99) => {
            return Err(Fault::not_modelled(NotModelled::MCode(code as u16), word.column));
        }
        _ => None,
    })
}

/// Whether a 16i/30i milling control knows this G code (in tenths): what is left over is PS0010.
fn is_fanuc_g(tenths: i64) -> bool {
    let whole = tenths / 10;
    match tenths % 10 {
        0 => matches!(whole, 0..=5 | 7..=13 | 15..=23 | 25..=33 | 37..=69 | 73..=76 | 80..=99),
        _ => {
            matches!(tenths, 51 | 61 | 71 | 121 | 131 | 401 | 411 | 421 | 434 | 435 | 501 | 511 | 541 | 682..=684 | 691)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::alarm::Cause;
    use super::super::block::{Line, Reading, parse_line};
    use super::*;

    fn run(lines: &[&str]) -> Result<(Modal, Step), Fault> {
        let mut state = (Modal::at_power_on(LengthUnit::Inch), Step::default());
        for line in lines {
            let Line::Block(block) = parse_line(line.as_bytes(), Reading::Lenient)?.line else {
                continue;
            };
            state = state.0.interpret(&block)?;
        }
        Ok(state)
    }

    fn motion(lines: &[&str]) -> Motion {
        run(lines).unwrap().1.motion.unwrap()
    }

    fn inch(value: f64) -> Nm {
        Nm::from_mm(value * LengthUnit::Inch.mm())
    }

    #[test]
    fn the_published_approach_is_an_inverse_time_move_with_a_rotary_axis() {
        let motion = motion(&["G20G17", "N124G1Z-26.7876", "N126G93X-3.6044Y10.5358Z-27.2876B103.946F50."]);
        assert_eq!(motion.kind, MotionKind::Line);
        assert_eq!(motion.feed, Feed::InverseTime(50 * PER_MIN_SCALE));
        assert_eq!(motion.start.linear[2], inch(-26.7876));
        assert_eq!(motion.end.linear[0], inch(-3.6044));
        assert_eq!(motion.end.rotary[1], MicroDeg(103_946_000));
    }

    #[test]
    fn the_published_arc_after_it_is_back_at_feed_per_minute() {
        let motion = motion(&["G20G1G93X-3.6044Y10.5358F50.", "N128G94G2X-2.7807Y11.5782I3.8539J-2.1989F25."]);
        assert_eq!(motion.kind, MotionKind::Arc(Turn::Cw));
        assert_eq!(motion.feed, Feed::PerMinute(inch(25.0)));
        assert_eq!(motion.center, Center::Offset([inch(3.8539), inch(-2.1989), Nm(0)]));
    }

    #[test]
    fn after_inverse_time_a_feed_per_minute_must_be_given_again() {
        assert_eq!(motion(&["G1G94X1.F25.", "G93X2.F50.", "G94X3."]).feed, Feed::Missing);
        assert_eq!(motion(&["G1G94X1.F25.", "G93X2.F50.", "G94X3.F30."]).feed, Feed::PerMinute(inch(30.0)));
    }

    #[test]
    fn a_cutting_move_that_never_got_a_feed_says_so() {
        assert_eq!(motion(&["N124G1Z-26.7876"]).feed, Feed::Missing);
        assert_eq!(motion(&["G1X1.F25.", "G93X2."]).feed, Feed::Missing);
    }

    #[test]
    fn without_a_point_axis_words_count_in_least_increments_and_f_in_whole_units() {
        let motion = motion(&["G1X10000B90000F25"]);
        assert_eq!(motion.end.linear[0], inch(1.0));
        assert_eq!(motion.end.rotary[1], MicroDeg(90_000_000));
        assert_eq!(motion.feed, Feed::PerMinute(inch(25.0)));
    }

    #[test]
    fn incremental_moves_add_up() {
        assert_eq!(motion(&["G21G91G0X1.", "X2.5"]).end.linear[0], Nm::from_mm(3.5));
    }

    #[test]
    fn a_full_circle_needs_no_axis_word() {
        let motion = motion(&["G1X1.F25.", "G2I-1."]);
        assert_eq!(motion.end, motion.start);
        assert_eq!(run(&["G1I-1."]).unwrap().1.motion, None);
    }

    #[test]
    fn a_radius_wins_over_a_centre_and_means_nothing_on_a_line() {
        assert_eq!(motion(&["G2X1.I5.R2.5"]).center, Center::Radius(inch(2.5)));
        assert_eq!(motion(&["G2X1.R-25000"]).center, Center::Radius(inch(-2.5)));
        assert_eq!(motion(&["G1X1.R2.5F1."]).center, Center::Offset([Nm(0); 3]));
    }

    #[test]
    fn a_radius_back_to_the_start_moves_nothing() {
        for block in ["G2R1.", "G2X1.Y0R1.", "G3X1.I5.R-1."] {
            let (state, step) = run(&["G1X1.F1.", block]).unwrap();
            assert_eq!((step.motion, state.position.linear[0]), (None, inch(1.0)), "{block}");
        }
    }

    #[test]
    fn a_dwell_moves_nothing() {
        let (_, step) = run(&["G4X1.5"]).unwrap();
        assert_eq!((step.dwell, step.motion), (Some(Micros(1_500_000)), None));
        assert_eq!(run(&["G4P250"]).unwrap().1.dwell, Some(Micros(250_000)));
    }

    #[test]
    fn what_the_control_refuses_is_an_alarm_at_its_column() {
        for (line, fault) in [
            ("G2X1.Y1.", Fault::alarm(Alarm::NoRadius, 0)),
            ("G1G14X1.", Fault::alarm(Alarm::ImproperGCode, 3)),
            ("G1.25", Fault::alarm(Alarm::ImproperGCode, 1)),
            ("G1X1.F-5.", Fault::alarm(Alarm::MinusSign, 7)),
            ("M3.5", Fault::alarm(Alarm::DecimalPoint, 1)),
        ] {
            assert_eq!(run(&[line]), Err(fault), "{line}");
        }
    }

    #[test]
    fn what_the_control_knows_and_this_version_does_not_is_refused_by_name() {
        for (line, what) in [
            ("G41D1", NotModelled::GCode(410)),
            ("G43.4H1", NotModelled::GCode(434)),
            ("M98P1000", NotModelled::MCode(98)),
        ] {
            let fault = run(&[line]).unwrap_err();
            assert_eq!(fault.cause, Cause::NotModelled(what), "{line}");
        }
    }

    #[test]
    fn a_refused_block_leaves_the_state_as_it_was() {
        let (before, _) = run(&["G1X1.F25."]).unwrap();
        let Line::Block(block) = parse_line(b"G91G2X5.", Reading::Lenient).unwrap().line else { unreachable!() };
        let kept = before;
        assert!(before.interpret(&block).is_err());
        assert_eq!(before, kept);
    }
}
