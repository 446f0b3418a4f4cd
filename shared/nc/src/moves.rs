//! Interpretation of axis words as a move.

use super::alarm::{Alarm, Fault, NotModelled};
use super::block::Block;
use super::modal::{Center, Feed, FeedMode, Modal, Motion, MotionKind, PER_MIN_SCALE, Pose, Step};
use super::number::Number;
use super::scale::Scale;
use super::settings::{ArcCenters, Decimals};
use arcfeed_units::{LengthUnit, MicroDeg, Nm};

/// Increments per unit of length for a feed per revolution without a decimal point: 0.01 mm, 0.0001 in.
const fn revolution_increments(unit: LengthUnit) -> i64 {
    match unit {
        LengthUnit::Mm => 100,
        LengthUnit::Inch => 10_000,
    }
}

/// Target of a block's axis words in program coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// Target position.
    pub end: Pose,
    /// Bits 0 to 2: X to Z given; bits 3 to 5: A to C.
    pub named: u8,
    /// I, J, K.
    offset: [Nm; 3],
    has_offset: bool,
}

impl Modal {
    /// Applies F and returns the feed of the block's move. A G94 or G95 feed is modal, an inverse-time feed is not. F0
    /// counts as missing.
    #[inline]
    pub(super) fn apply_feed(&mut self, block: &Block) -> Feed {
        let word = block.word(b'F');
        if self.feed_mode == FeedMode::InverseTime {
            // After G93 the meaning of the earlier F differs between controls, until F is given again.
            self.feed = None;
            let times = word.map_or(0, |word| word.number.scaled(PER_MIN_SCALE));
            return if times == 0 { Feed::Missing } else { Feed::InverseTime(times) };
        }
        if let Some(word) = word {
            let feed = match self.feed_mode {
                FeedMode::PerRevolution if !word.number.has_point() => {
                    word.number.scaled(self.unit.nm() / revolution_increments(self.unit))
                }
                // Whole units, with and without a decimal point.
                _ => Scale::of_lengths(self.unit, Decimals::Calculator).of(word.number),
            };
            self.feed = Some(Nm(feed)).filter(|feed| feed.0 != 0);
        }
        let turns = if self.feed_mode == FeedMode::PerRevolution { self.spindle.unwrap_or(0) } else { 1 };
        match self.feed.map(|feed| Nm(feed.0.saturating_mul(turns))) {
            Some(feed) if feed.0 != 0 => Feed::PerMinute(feed),
            Some(_) | None => Feed::Missing,
        }
    }

    /// Reads X to Z, A to C and I to K.
    #[inline(always)]
    pub(super) fn target(&self, block: &Block, decimals: Decimals) -> Target {
        let mut target = Target { end: self.program, named: 0, offset: [Nm(0); 3], has_offset: false };
        let from = |axis: Option<i64>| if self.absolute { 0 } else { axis.unwrap_or(0) };
        let lengths = Scale::of_lengths(self.unit, decimals);
        for word in &block.words {
            match word.letter {
                letter @ b'X'..=b'Z' => {
                    let index = usize::from(letter - b'X');
                    let start = from(self.program.linear.get(index).map(|axis| axis.0));
                    if let Some(axis) = target.end.linear.get_mut(index) {
                        axis.0 = start.saturating_add(lengths.of(word.number));
                    }
                    target.named |= 1 << index;
                }
                letter @ b'I'..=b'K' => {
                    if let Some(axis) = target.offset.get_mut(usize::from(letter - b'I')) {
                        axis.0 = lengths.of(word.number);
                    }
                    target.has_offset = true;
                }
                letter @ b'A'..=b'C' => {
                    let index = usize::from(letter - b'A');
                    let start = from(self.program.rotary.get(index).map(|axis| axis.0));
                    if let Some(axis) = target.end.rotary.get_mut(index) {
                        axis.0 = start.saturating_add(rotary(word.number, decimals));
                    }
                    target.named |= 8 << index;
                }
                _ => {}
            }
        }
        if target.has_offset && self.arc_centers == ArcCenters::Absolute {
            self.measure_center_from_start(&mut target.offset);
        }
        target
    }

    /// G90.1: converts the centre's coordinates into distances from the start.
    #[cold]
    fn measure_center_from_start(&self, center: &mut [Nm; 3]) {
        for (center, start) in center.iter_mut().zip(&self.program.linear) {
            center.0 = center.0.saturating_sub(start.0);
        }
    }

    /// Whether G90.1 lacks a coordinate of the centre: there is none that it could stand for.
    fn lacks_center(&self, block: &Block) -> bool {
        let (first, second, _) = self.plane.axes();
        let is_missing = |index: usize| block.word(b'I' + index as u8).is_none();
        self.arc_centers == ArcCenters::Absolute && (is_missing(first) || is_missing(second))
    }

    /// Resolves polar coordinates (G16): the plane's first axis is a radius and its second an angle. The radius counts from
    /// the program's origin, or under G91 from the tool's position, also in later blocks that give an angle alone.
    pub(super) fn resolve_polar(&mut self, block: &Block, target: &mut Target, decimals: Decimals) {
        let Some(polar) = &mut self.polar else { return };
        let (first, second, _) = self.plane.axes();
        let (radius, angle) = (axis_number(block, first), axis_number(block, second));
        if radius.is_none() && angle.is_none() {
            return;
        }
        let absolute = self.absolute;
        if let Some(number) = angle {
            let value = rotary(number, decimals);
            polar.angle = MicroDeg(if absolute { value } else { polar.angle.0.saturating_add(value) });
        }
        let mut polar = *polar;
        if let Some(number) = radius {
            let here = |index: usize| self.program.linear.get(index).copied().unwrap_or_default();
            polar.radius = Nm(self.length(number, decimals));
            polar.pole = if absolute { [Nm(0); 2] } else { [first, second].map(here) };
        }
        self.polar = Some(polar);
        polar.place(&mut target.end, self.plane);
    }

    /// Moves to the target, if this is a move.
    pub(super) fn move_to(
        &mut self,
        block: &Block,
        target: &Target,
        ways: (Feed, Decimals),
        step: &mut Step,
    ) -> Result<(), Fault> {
        let (feed, decimals) = ways;
        let (moves, has_offset) = (target.named != 0, target.has_offset);
        let is_arc = matches!(self.motion, MotionKind::Arc(_));
        let radius = block.word(b'R').filter(|_| is_arc).map(|word| Nm(self.length(word.number, decimals)));
        let has_center = has_offset && !(is_arc && self.lacks_center(block));
        if is_arc && (moves || has_offset) && !has_center && radius.is_none() {
            return Err(Fault::alarm(Alarm::NoRadius, 0));
        }
        let is_move = match radius {
            // The arc has no angle.
            Some(_) => target.end != self.program,
            // I, J, K without an axis word is a full circle under G2 and G3, and nothing otherwise.
            None => moves || (is_arc && has_offset),
        };
        if !is_move {
            return Ok(());
        }
        self.check_move(target)?;
        let is_turned = self.frame.rotation().is_some_and(|rotation| rotation.plane != self.plane);
        if is_arc && is_turned {
            return Err(Fault::alarm(Alarm::RotationPlane, 0));
        }
        let (kind, radius) = match self.motion {
            MotionKind::Arc(turn) => {
                let (length, turn) = self.scale_arc(radius.unwrap_or_default(), turn)?;
                (MotionKind::Arc(turn), radius.map(|_| length))
            }
            straight => (straight, None),
        };
        let motion = step.motion.insert(Motion {
            kind,
            plane: self.plane,
            start: self.position,
            end: target.end,
            center: Center::Offset(target.offset),
            feed: if self.motion == MotionKind::Rapid { Feed::Missing } else { feed },
        });
        if !self.frame.is_plain() {
            motion.end = self.keep_unnamed(self.frame.to_path(target.end), target.named);
            motion.center = Center::Offset(self.frame.vector(target.offset));
        }
        if let Some(radius) = radius {
            motion.center = Center::Radius(radius);
        }
        (self.position, self.program) = (motion.end, target.end);
        if self.rotation_pending {
            self.rotation_pending = target.named & self.in_plane() != self.in_plane();
        }
        Ok(())
    }

    /// Checks that the modal state allows a move to be interpreted.
    pub(super) fn check_move(&self, target: &Target) -> Result<(), Fault> {
        if self.unmodelled != 0 {
            return Err(Fault::not_modelled(NotModelled::MoveUnder(self.unmodelled), 0));
        }
        if self.rotation_pending {
            let named = target.named & self.in_plane();
            if named != 0 && (named != self.in_plane() || !self.absolute) {
                return Err(Fault::not_modelled(NotModelled::AfterRotation, 0));
            }
        }
        Ok(())
    }

    /// The plane's axes, as in [`Target::named`].
    fn in_plane(&self) -> u8 {
        let (first, second, _) = self.plane.axes();
        1 << first | 1 << second
    }

    /// A length word, nm.
    #[inline]
    pub(super) fn length(&self, number: Number, decimals: Decimals) -> i64 {
        Scale::of_lengths(self.unit, decimals).of(number)
    }
}

/// An angle word, microdegrees.
pub(super) fn rotary(number: Number, decimals: Decimals) -> i64 {
    Scale::of_angles(decimals).of(number)
}

/// Number of a linear axis in a block.
#[inline(never)]
fn axis_number(block: &Block, index: usize) -> Option<Number> {
    block.word(b'X' + index as u8).map(|word| word.number)
}
