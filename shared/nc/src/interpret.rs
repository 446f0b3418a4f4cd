//! Interpretation of a block: G words first, then functions, then the move.

use super::address;
use super::alarm::{Alarm, Fault, NotModelled};
use super::block::{Block, CORNERS, letters};
use super::codes::OneShot;
use super::modal::{Feed, FeedMode, Modal, Motion, MotionKind, Pose, ProgramStop, Step};
use super::rollback::Rollback;
use super::series::Series;
use super::settings::{Settings, Tables};
use super::word::Word;

pub use super::oneshot::set_data;

/// Letters of functions, which take effect before the move.
const FUNCTIONS: u32 = letters(b"DHMST");

impl Modal {
    /// Modal state after the block, and what the block makes the control do. `self` is the state before and stays as
    /// it is.
    ///
    /// # Errors
    /// The first alarm that the control would raise, or the construct that this version does not interpret.
    pub fn interpret(&self, block: &Block, settings: &Settings, tables: &Tables) -> Result<(Modal, Step), Fault> {
        let (mut next, mut step) = (*self, Step::default());
        let mut rollback = Rollback::new(self, block);
        next.advance(block, (settings, tables), &mut step, &mut rollback)?;
        Ok((next, step))
    }

    /// [`Modal::interpret`] in place. After a fault the caller restores the state from `rollback`, and the step is
    /// meaningless. `rollback` holds this state.
    pub(crate) fn advance(
        &mut self,
        block: &Block,
        (settings, tables): (&Settings, &Tables),
        step: &mut Step,
        rollback: &mut Rollback,
    ) -> Result<(), Fault> {
        step.clear();
        let system = self.system;
        address::check(block)?;
        let one_shot = self.apply_codes(block, rollback)?;
        if block.may_have(FUNCTIONS) {
            self.apply_functions(block, one_shot, step)?;
        }
        if self.system != system {
            self.update_frame(tables);
        }
        match one_shot {
            OneShot::No => self.interpret_motion(block, settings, step)?,
            OneShot::AdditionalSystem => {
                self.select_additional(block, (settings, tables))?;
                self.interpret_motion(block, settings, step)?;
            }
            _ => {
                if one_shot != OneShot::Data && block.word(b'F').is_some() {
                    let _of_no_move = self.apply_feed(block);
                }
                self.execute_one_shot(one_shot, block, (settings, tables), step)?;
            }
        }
        // The tool begins this move beside its programmed start.
        let is_start_up = self.starts_up;
        let is_cancel = is_start_up && self.compensation.is_none();
        if self.starts_up
            && let Some(motion) = &step.motion
        {
            self.check_start_up(motion)?;
        }
        if step.motion.is_some() || step.series.is_some() {
            let cancel = is_cancel.then_some(NotModelled::MoveUnder(400));
            step.beyond_plain = cancel.or_else(|| self.beyond_plain(step, one_shot));
        }
        if self.ends_in_corner || block.may_have(CORNERS) {
            self.apply_corner(block, settings.decimals, is_start_up, step)?;
        }
        Ok(())
    }

    /// Applies the G codes of a block; returns its last one-shot code.
    fn apply_codes(&mut self, block: &Block, rollback: &mut Rollback) -> Result<OneShot, Fault> {
        let mut one_shot = OneShot::No;
        for word in block.words.iter().filter(|word| word.letter == b'G') {
            if let Some(kind) = MotionKind::of_code(word.number.as_whole()) {
                self.set_motion(kind);
                continue;
            }
            rollback.keep_whole(self);
            match self.apply_g(word)? {
                OneShot::No => {}
                found => one_shot = found,
            }
        }
        if one_shot == OneShot::No && self.names_additional_system(block) {
            return Ok(OneShot::AdditionalSystem);
        }
        Ok(one_shot)
    }

    /// Whether P belongs to a G54 of the block: G54 P is G54.1 P. In a canned cycle P is a dwell.
    fn names_additional_system(&self, block: &Block) -> bool {
        let is_g54 = |word: &Word| word.letter == b'G' && word.number.as_tenths() == Some(540);
        self.cycle.is_none() && block.may_have(letters(b"P")) && block.words.iter().any(is_g54)
    }

    /// Applies D, H, M, S and T.
    fn apply_functions(&mut self, block: &Block, one_shot: OneShot, step: &mut Step) -> Result<(), Fault> {
        self.machining_state.apply(block);
        for word in &block.words {
            match word.letter {
                b'M' => step.stop = m_code(word, block)?.or(step.stop),
                b'S' => {
                    let speed = word.number.scaled(1);
                    (step.spindle, self.spindle) = (Some((speed, word.column)), Some(speed));
                }
                b'H' if one_shot != OneShot::Data => self.length_offset = word.number.scaled(1) as u16,
                b'D' => self.radius_offset = word.number.scaled(1) as u16,
                _ => {}
            }
        }
        Ok(())
    }

    /// Interprets a move along the path, or a block of a cycle.
    fn interpret_motion(&mut self, block: &Block, settings: &Settings, step: &mut Step) -> Result<(), Fault> {
        let feed = self.apply_feed(block);
        if let Some(cycle) = self.cycle {
            step.series = self.drill(cycle, block, settings, feed)?;
            return Ok(());
        }
        let mut target = self.target(block, settings.decimals);
        if self.polar.is_some() {
            self.resolve_polar(block, &mut target, settings.decimals);
        }
        self.move_to(block, &target, (feed, settings.decimals), step)
    }

    /// Checks the first move in the plane after G41, G42 or G40. It applies or removes the contour's offset and must
    /// not be an arc.
    fn check_start_up(&mut self, motion: &Motion) -> Result<(), Fault> {
        let (first, second, _) = motion.plane.axes();
        let moves = |axis: usize| motion.start.linear.get(axis) != motion.end.linear.get(axis);
        if matches!(motion.kind, MotionKind::Arc(_)) {
            return Err(Fault::alarm(Alarm::ArcAtStartUp, 0));
        }
        self.starts_up = !moves(first) && !moves(second);
        Ok(())
    }

    /// Reason why an executor of plain moves must reject this move.
    fn beyond_plain(&self, step: &Step, one_shot: OneShot) -> Option<NotModelled> {
        let under = |code| Some(NotModelled::MoveUnder(code));
        match (&step.series, one_shot) {
            (Some(Series::Drill(drill)), _) => return Some(NotModelled::GCode(u16::from(drill.code) * 10)),
            (Some(Series::Reference(_)), OneShot::Reference(code)) => {
                return Some(NotModelled::GCode(u16::from(code) * 10));
            }
            (_, OneShot::Machine) => return Some(NotModelled::GCode(530)),
            _ => {}
        }
        match self.compensation {
            Some(super::modal::CompensationSide::Left) => return under(410),
            Some(super::modal::CompensationSide::Right) => return under(420),
            None => {}
        }
        if self.follows_tool_center {
            return under(434);
        }
        if self.feed_mode == FeedMode::PerRevolution && step.motion.is_some_and(|motion| is_cut(&motion)) {
            return under(950);
        }
        if self.frame.is_plain() {
            return None;
        }
        if let Some(scaling) = self.frame.scaling() {
            return under(scaling.code);
        }
        under(match (self.frame.rotation(), self.preset, self.local) {
            (Some(_), ..) => 680,
            (None, Pose::ORIGIN, Pose::ORIGIN) => 540 + 10 * self.system.min(5),
            (None, Pose::ORIGIN, _) => 520,
            (None, ..) => 920,
        })
    }
}

fn is_cut(motion: &Motion) -> bool {
    motion.kind != MotionKind::Rapid
}

fn m_code(word: &Word, block: &Block) -> Result<Option<ProgramStop>, Fault> {
    let fault = Fault::alarm(Alarm::DecimalPoint, word.column);
    Ok(match word.number.as_whole().ok_or(fault)? {
        0 => Some(ProgramStop::Program),
        1 => Some(ProgramStop::Optional),
        2 | 30 => Some(ProgramStop::End),
        // M96 P enables a signal that calls a program in the middle of any block; M97 P is a call on a Haas.
        code @ (96..=99) if code >= 98 || block.word(b'P').is_some() => {
            return Err(Fault::not_modelled(NotModelled::MCode(code as u16), word.column));
        }
        _ => None,
    })
}

impl Step {
    /// Whether the block's move is a plain path of the tool centre in any coordinates, which can be evaluated without
    /// its neighbours. Not plain are canned cycles, moves under G41, G42, G43.4 or G95, the first one after G40, and
    /// moves with a chamfer or rounded corner at one of their ends.
    pub fn is_plain(&self) -> bool {
        match self.beyond_plain {
            None => true,
            Some(NotModelled::MoveUnder(code)) => !matches!(code, 400 | 410 | 420 | 434 | 950),
            Some(_) => false,
        }
    }

    /// Clears field by field: an assignment would write the whole capacity of a series.
    pub(crate) fn clear(&mut self) {
        let Step { motion, corner, series, dwell, stop, spindle, beyond_plain, sets_data } = self;
        (*motion, *corner, *series, *dwell, *stop) = (None, None, None, None, None);
        (*spindle, *beyond_plain, *sets_data) = (None, None, false);
    }

    /// Feed of the block's cutting move or canned cycle; `None` if it has neither.
    pub fn cutting_feed(&self) -> Option<Feed> {
        match (&self.motion, &self.series) {
            (Some(motion), _) => Some(motion.feed).filter(|_| is_cut(motion)),
            (None, Some(Series::Drill(drill))) => Some(drill.feed),
            (None, Some(Series::Reference(_)) | None) => None,
        }
    }

    /// Whether this is a cutting move for which the program has given no feed (PS0011).
    pub fn lacks_feed(&self) -> bool {
        self.cutting_feed() == Some(Feed::Missing)
    }
}

#[cfg(test)]
mod tests {
    use super::super::alarm::Cause;
    use super::super::block::{Reading, parse_line};
    use super::super::modal::{Center, PER_MIN_SCALE, Turn};
    use super::super::settings::Preset;
    use super::*;
    use arcfeed_units::{LengthUnit, MicroDeg, Micros, Nm};

    fn interpret(modal: &Modal, block: &Block) -> Result<(Modal, Step), Fault> {
        let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Inch, Reading::Lenient);
        modal.interpret(block, &settings, &Tables::default())
    }

    fn run(lines: &[&str]) -> Result<(Modal, Step), Fault> {
        let mut state = (Modal::at_power_on(LengthUnit::Inch), Step::default());
        for line in lines {
            let block = parse_line(line.as_bytes(), Reading::Lenient)?.block;
            state = interpret(&state.0, &block)?;
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
    fn a_feed_beside_a_dwell_or_a_reference_point_is_kept() {
        for line in ["G4P1F30.", "G28Z0F30.", "G53Z0F30.", "G92X0F30."] {
            assert_eq!(motion(&["F25.", line, "G1X1."]).feed, Feed::PerMinute(inch(30.0)), "{line}");
        }
    }

    #[test]
    fn a_dwell_moves_nothing() {
        let (_, step) = run(&["G4X1.5"]).unwrap();
        assert_eq!((step.dwell, step.motion), (Some(Micros(1_500_000)), None));
        assert_eq!(run(&["G4P250"]).unwrap().1.dwell, Some(Micros(250_000)));
    }

    #[test]
    fn g54_with_a_p_is_an_additional_system() {
        let system = |lines: &[&str]| run(lines).map(|(state, _)| state.system);
        for (block, wanted) in [("G54P1", 6), ("G54P48X1.", 53), ("G54X1.", 0), ("G54.1P3", 8), ("G54G4P100", 0)] {
            assert_eq!(system(&[block]), Ok(wanted), "{block}");
        }
        assert_eq!(system(&["G81X1.R1.Z-1.F1.", "G54P2X2."]), Ok(0));
        assert_eq!(system(&["G54P49"]), Err(Fault::alarm(Alarm::OffsetNumber, 4)));
        let settings = Settings::preset(Preset::Fanuc31i, LengthUnit::Inch, Reading::Lenient);
        let block = parse_line(b"G54.1P300", Reading::Lenient).unwrap().block;
        let read = Modal::at_power_on(LengthUnit::Inch).interpret(&block, &settings, &Tables::default());
        assert_eq!(read.unwrap().0.system, 305);
    }

    #[test]
    fn an_absolute_centre_is_the_same_arc_as_its_distance_from_the_start() {
        use super::super::settings::ArcCenters;
        let arc = |centers: ArcCenters, lines: &[&str]| {
            let mut state = Modal { arc_centers: centers, ..Modal::at_power_on(LengthUnit::Inch) };
            let mut found = Err(Fault::alarm(Alarm::NoRadius, 0));
            for line in lines {
                found = interpret(&state, &parse_line(line.as_bytes(), Reading::Lenient).unwrap().block);
                state = found.as_ref().map_or(state, |(next, _)| *next);
            }
            found.map(|(_, step)| step.motion)
        };
        let start = "G1X3.Y1.F1.";
        let wanted = arc(ArcCenters::FromStart, &[start, "G2X4.Y2.I0J1."]);
        assert!(wanted.is_ok());
        assert_eq!(arc(ArcCenters::Absolute, &[start, "G2X4.Y2.I3.J2."]), wanted);
        assert_eq!(arc(ArcCenters::Incremental, &[start, "G90.1", "G2X4.Y2.I3.J2."]), wanted);
        assert_eq!(arc(ArcCenters::Absolute, &[start, "G91.1", "G2X4.Y2.I0J1."]), wanted);
        assert_eq!(arc(ArcCenters::Absolute, &[start, "G2X4.Y2.I3."]), Err(Fault::alarm(Alarm::NoRadius, 0)));
        assert_eq!(arc(ArcCenters::FromStart, &["G90.1"]), Err(Fault::alarm(Alarm::ImproperGCode, 1)));
    }

    #[test]
    fn a_return_without_an_intermediate_point_needs_no_second_axis_after_a_rotation() {
        let turned = ["G0X1.Y1.", "G68X0Y0R30.", "X2.Y2.", "G69"];
        let (state, step) = run(&[&turned[..], &["G91G28Y0"]].concat()).unwrap();
        let (before, _) = run(&turned).unwrap();
        let Some(Series::Reference([start, between, end])) = step.series else { panic!("{step:?}") };
        assert_eq!((start, between), (before.position, before.position));
        assert_eq!((end.linear[0], end.linear[1]), (before.position.linear[0], Nm(0)));
        assert!(state.rotation_pending);
        assert!(run(&[&turned[..], &["G91G28Y1."]].concat()).is_err());
    }

    #[test]
    fn high_precision_control_changes_no_path_and_other_p_are_refused() {
        for block in ["G5P10000", "G05P0"] {
            assert!(run(&[block]).is_ok(), "{block}");
        }
        for block in ["G5P2", "G5P10001", "G5"] {
            assert_eq!(run(&[block]), Err(Fault::not_modelled(NotModelled::GCode(50), 0)), "{block}");
        }
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
            ("G31X1.", NotModelled::GCode(310)),
            ("G88X1.", NotModelled::GCode(880)),
            ("G51\nG0X1.", NotModelled::GCode(510)),
            ("G51.1X0\nG51P2000", NotModelled::GCode(510)),
            ("G51I2000\nG2X1.I.5", NotModelled::MoveUnder(510)),
            ("G51.1Z0\nG81X1.R1.Z-1.F1.", NotModelled::MoveUnder(511)),
            ("G51.1X0\nG76X1.R1.Z-1.Q.1F1.", NotModelled::MoveUnder(511)),
            ("G51P500\nG92X0", NotModelled::MoveUnder(510)),
            ("G68.2X1.I5.\nG0X1.", NotModelled::MoveUnder(682)),
            ("G0X1.Y1.\nG68R30.\nG0X2.", NotModelled::AfterRotation),
            ("M98P1000", NotModelled::MCode(98)),
            ("M96P9001", NotModelled::MCode(96)),
            ("M97P100", NotModelled::MCode(97)),
        ] {
            let fault = run(&line.lines().collect::<Vec<_>>()).unwrap_err();
            assert_eq!(fault.cause, Cause::NotModelled(what), "{line}");
        }
    }

    #[test]
    fn an_arc_can_neither_bring_an_offset_in_nor_take_it_out() {
        let last = |lines: &[&str]| run(lines).map(|_| ());
        let fault = Err(Fault::alarm(Alarm::ArcAtStartUp, 0));
        let arc = "G2X1.Y1.I1.";
        for before in
            [&["G41D1", arc][..], &["G41D1", "G1Z-1.F1.", arc], &["G42D1X1.", "G40", "G2X0I-.5"], &["G41G2X1.Y1.I1."]]
        {
            assert_eq!(last(&[&["G1F1."], before].concat()), fault, "{before:?}");
        }
        for before in
            [&["G41D1", "G1X0Y-1.", "G2Y1.J1."][..], &["G41D1", "G40", arc], &["G41D1X-1.", "X0", "G42G2X1.Y1.I1."]]
        {
            assert_ne!(last(&[&["G1F1."], before].concat()), fault, "{before:?}");
        }
        assert_eq!(last(&["M96", "M97"]), Ok(()));
    }

    #[test]
    fn a_refused_block_leaves_the_state_as_it_was() {
        let (before, _) = run(&["G1X1.F25."]).unwrap();
        let block = parse_line(b"G91G2X5.", Reading::Lenient).unwrap().block;
        let kept = before;
        assert!(interpret(&before, &block).is_err());
        assert_eq!(before, kept);
    }
}
