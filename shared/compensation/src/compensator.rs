//! Cutter compensation (G41, G42): a state machine that offsets a contour move by move.
//!
//! ```text
//!           offset, line                     offset
//! Off ------------------------> Held   +-----------------+
//!  ^                             | ^ <-+                 |
//!  |  no offset, line            | +-----------------+   |
//!  +-----------------------------+                   |   |
//!  |                             | blocks, stop      |   offset, tangent
//!  |  no offset, line            v                   |
//!  +---------------------- AtNormal -----------------+
//! ```
//!
//! *Held*: a move in the plane waits for the next one. The control reads a number of blocks together; if those between
//! two moves in the plane are more, or one of them stops reading, the held move ends at a right angle to its path
//! (*AtNormal*), as the manuals describe (B-63664EN, page 170). A contour that continues from there at a corner would be
//! overcut by the control; it is rejected.
//!
//! Output is in order: each move that went in comes out once, after the moves around the corner at its beginning.

use arcfeed_nc::alarm::{Alarm, Fault, NotModelled};
use arcfeed_nc::motion::{Plane, Pose};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::settings::{COMPENSATION_BLOCKS_MAX, CompensationSettings, StartUp};
use arcfeed_units::Nm;

use crate::corner::{CornerPoints, POINTS_MAX, corner, is_outside, is_small, one};
use crate::element::Element;
use crate::offset_path::{ROUNDING_MM, around_corner, beside, offset_segment, straight};
use crate::vector::{Point, add, at, between, in_plane, minus, subtract, with_point};

/// Most moves without travel in the plane that wait behind a held one.
const WAITING_MAX: usize = COMPENSATION_BLOCKS_MAX as usize;
/// Most moves that one call returns.
const MOVES_MAX: usize = 2 * POINTS_MAX + WAITING_MAX + 2;
/// No offset.
const NONE: Point = [Nm(0); 2];

/// A programmed move, with the cutter compensation (G41, G42) in force on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourMove {
    /// Move as programmed.
    pub segment: Segment,
    /// Plane in which the tool is offset.
    pub plane: Plane,
    /// Distance of the tool centre from the contour, positive to its left seen in the direction of motion; 0 without
    /// compensation.
    pub offset: Nm,
}

/// A move of the tool centre under cutter compensation (G41, G42).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CenterMove {
    /// Added move around a corner of the contour, at the beginning of the programmed move that is returned next.
    Corner(Segment),
    /// Offset path of a programmed move.
    Main(Segment),
}

/// Moves of the tool centre, in the order in which the control makes them.
pub type CenterMoves = heapless::Vec<CenterMove, MOVES_MAX>;

/// Fault of a contour under cutter compensation: an alarm that the control raises, or a case that this model does not
/// cover. It says which of two moves has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompensationFault {
    /// The held move, which waited for the next one: neither it nor anything after it can be executed.
    Held(Fault),
    /// The move just given; the held move, which waited for it, is not affected.
    Given(Fault),
}

/// Computes the path of the tool centre under cutter compensation (G41, G42), move by move. It holds each move back
/// until the next one is known, because the corner between them decides where the move ends.
#[derive(Clone, Debug)]
pub struct Compensator {
    settings: CompensationSettings,
    held: Option<HeldMove>,
    /// Moves without travel in the plane, behind the held one.
    waiting: heapless::Vec<Segment, WAITING_MAX>,
    /// Blocks behind the held move.
    blocks: u8,
    /// Tool centre relative to the programmed point, after the last move that came out.
    vector: Point,
}

/// A move in the plane that waits for the next one.
#[derive(Clone, Debug)]
struct HeldMove {
    programmed: ContourMove,
    element: Element,
    is_start_up: bool,
    /// The tool centre before it, then the points of the corner at its beginning.
    centers: Centers,
}

/// Points of the tool centre.
type Centers = heapless::Vec<Point, POINTS_MAX>;

impl Compensator {
    /// Compensator without an offset, as before the first move of a contour.
    pub fn new(settings: CompensationSettings) -> Self {
        Compensator { settings, held: None, waiting: heapless::Vec::new(), blocks: 0, vector: NONE }
    }

    /// Whether the tool is offset, or on the move that begins or ends the offset.
    pub fn is_active(&self) -> bool {
        self.held.is_some() || self.vector != NONE
    }

    /// The move that waits for the next move, because its end depends on it; `None` if none waits.
    pub fn held(&self) -> Option<&ContourMove> {
        self.held.as_ref().map(|held| &held.programmed)
    }

    /// Position of the tool centre for a programmed position: shifted in the plane by the offset at the end of the
    /// last returned move.
    pub fn center(&self, position: Pose, plane: Plane) -> Pose {
        with_point(position, plane, add(in_plane(&position, plane), self.vector))
    }

    /// Discards the held move and the offset.
    pub fn reset(&mut self) {
        *self = Compensator::new(self.settings);
    }

    /// Accepts the next programmed move; returns the moves of the tool centre that are complete now.
    ///
    /// # Errors
    /// Alarms PS0033, PS0034, PS0038 and PS0041, and cases that this model does not compensate.
    pub fn add(&mut self, given: &ContourMove) -> Result<CenterMoves, CompensationFault> {
        let mut moves = CenterMoves::new();
        match Element::of(&given.segment, given.plane) {
            None => self.add_beside_plane(given, &mut moves)?,
            Some(element) if given.offset == Nm(0) => self.cancel(given, &element, &mut moves)?,
            Some(element) => self.follow(given, element, &mut moves)?,
        }
        Ok(moves)
    }

    /// Accepts a block without a move. If the control does not read more blocks ahead, the held move ends at a right
    /// angle to its path and is returned.
    ///
    /// # Errors
    /// PS0041 (interference) of the held move.
    pub fn add_block(&mut self) -> Result<CenterMoves, CompensationFault> {
        let mut moves = CenterMoves::new();
        self.count_block(&mut moves)?;
        Ok(moves)
    }

    /// Ends the held move at a right angle to its path and returns it, because the control now reads no further block.
    ///
    /// # Errors
    /// PS0041 (interference) of the held move.
    pub fn end_held(&mut self) -> Result<CenterMoves, CompensationFault> {
        let mut moves = CenterMoves::new();
        self.release_at_normal(&mut moves)?;
        Ok(moves)
    }

    /// Accepts a move that does not travel in the plane of compensation.
    fn add_beside_plane(&mut self, given: &ContourMove, moves: &mut CenterMoves) -> Result<(), CompensationFault> {
        // After G40, and before a move of no length, the held move ends at its normal.
        if given.offset == Nm(0) || given.segment.start == given.segment.end {
            self.release_at_normal(moves)?;
        }
        if self.held.is_none() {
            put(moves, CenterMove::Main(beside(&given.segment, given.plane, self.vector)));
            return Ok(());
        }
        let _full = self.waiting.push(given.segment);
        self.count_block(moves)
    }

    fn count_block(&mut self, moves: &mut CenterMoves) -> Result<(), CompensationFault> {
        self.blocks = self.blocks.saturating_add(1);
        let across = self.settings.blocks.min(COMPENSATION_BLOCKS_MAX).saturating_sub(2);
        if self.blocks > across { self.release_at_normal(moves) } else { Ok(()) }
    }

    /// Accepts a move in the plane without compensation.
    fn cancel(
        &mut self,
        given: &ContourMove,
        element: &Element,
        moves: &mut CenterMoves,
    ) -> Result<(), CompensationFault> {
        if !self.is_active() {
            put(moves, CenterMove::Main(given.segment));
            return Ok(());
        }
        if element.arc.is_some() {
            return Err(given_fault(Alarm::ArcAtStartUp));
        }
        let points = self.held.as_ref().map(|held| self.points_to_cancel(held, element)).transpose()?;
        let centers = self.release(element.from, points.as_ref(), moves)?;
        let start = put_corner(&given.segment, given.plane, &centers, moves);
        put(moves, CenterMove::Main(straight(&given.segment, given.plane, start, element.to)));
        self.vector = NONE;
        Ok(())
    }

    /// Accepts a move along the contour, or towards it.
    fn follow(
        &mut self,
        given: &ContourMove,
        element: Element,
        moves: &mut CenterMoves,
    ) -> Result<(), CompensationFault> {
        check_fit(given, &element)?;
        let is_start_up = !self.is_active();
        if is_start_up && element.arc.is_some() {
            return Err(given_fault(Alarm::ArcAtStartUp));
        }
        let points = match &self.held {
            Some(held) => {
                check_change(&held.programmed, given, &element)?;
                Some(self.points_to_follow(held, &element)?)
            }
            None => {
                let normal = element.normal_at_start(given.offset);
                if !is_start_up && !is_small(minus(normal, between(NONE, self.vector))) {
                    let fault = Fault::not_modelled(NotModelled::UnreadCorner, 0);
                    return Err(CompensationFault::Given(fault));
                }
                None
            }
        };
        let centers = self.release(element.from, points.as_ref(), moves)?;
        self.held = Some(HeldMove { programmed: *given, element, is_start_up, centers });
        Ok(())
    }

    /// Points of the corner between the held move and one that cancels compensation.
    fn points_to_cancel(&self, held: &HeldMove, next: &Element) -> Result<CornerPoints, CompensationFault> {
        if self.goes_around(held, next) {
            return held.corner(next);
        }
        Ok(one(held.element.normal_at_end(held.programmed.offset)))
    }

    /// Points of the corner between the held move and the next one of the contour.
    fn points_to_follow(&self, held: &HeldMove, next: &Element) -> Result<CornerPoints, CompensationFault> {
        if held.is_start_up && !self.goes_around(held, next) {
            return Ok(one(next.normal_at_start(held.programmed.offset)));
        }
        held.corner(next)
    }

    /// Whether the tool goes around the corner at which compensation begins or ends.
    fn goes_around(&self, held: &HeldMove, next: &Element) -> bool {
        let offset_mm = held.programmed.offset.to_mm();
        let (before, behind) = (held.element.end(offset_mm), next.start(offset_mm));
        self.settings.start_up == StartUp::B && is_outside(&before, &behind, offset_mm)
    }

    fn release_at_normal(&mut self, moves: &mut CenterMoves) -> Result<(), CompensationFault> {
        if let Some(held) = &self.held {
            let (corner, normal) = (held.element.to, one(held.element.normal_at_end(held.programmed.offset)));
            self.release(corner, Some(&normal), moves)?;
        }
        Ok(())
    }

    /// Ends the held move, and the moves that wait behind it, at the first of `points` from the programmed point
    /// `corner`. Returns the points of the tool centre: where it is, and the way around the corner.
    fn release(
        &mut self,
        corner: Point,
        points: Option<&CornerPoints>,
        moves: &mut CenterMoves,
    ) -> Result<Centers, CompensationFault> {
        self.blocks = 0;
        let mut centers = Centers::new();
        for point in points.into_iter().flatten() {
            let _full = centers.push(at(corner, *point));
        }
        let (Some(held), Some(end)) = (self.held.take(), centers.first()) else {
            let _full = centers.push(add(corner, self.vector));
            return Ok(centers);
        };
        let ContourMove { segment, plane, .. } = held.programmed;
        let start = put_corner(&segment, plane, &held.centers, moves);
        let main = match offset_segment(&segment, plane, start, *end) {
            _ if held.is_start_up => straight(&segment, plane, start, *end),
            main => main.map_err(held_fault)?,
        };
        put(moves, CenterMove::Main(main));
        self.vector = subtract(*end, corner);
        for segment in &self.waiting {
            put(moves, CenterMove::Main(beside(segment, plane, self.vector)));
        }
        self.waiting.clear();
        Ok(centers)
    }
}

impl HeldMove {
    fn corner(&self, next: &Element) -> Result<CornerPoints, CompensationFault> {
        let offset_mm = self.programmed.offset.to_mm();
        let points = corner(&self.element.end(offset_mm), &next.start(offset_mm), offset_mm);
        points.ok_or(held_fault(Alarm::NoIntersection))
    }
}

/// Checks that the tool fits an arc.
fn check_fit(given: &ContourMove, element: &Element) -> Result<(), CompensationFault> {
    let alarm = match element.radii_mm(given.offset.to_mm()) {
        Some((0.0, _)) => Alarm::ArcEndInCenter,
        Some((_, offset_radius_mm)) if offset_radius_mm < -ROUNDING_MM => Alarm::Interference,
        Some(_) | None => return Ok(()),
    };
    Err(given_fault(alarm))
}

/// Checks that the offset of the next move can follow that of the move before.
fn check_change(before: &ContourMove, given: &ContourMove, element: &Element) -> Result<(), CompensationFault> {
    let what = if (before.offset < Nm(0)) != (given.offset < Nm(0)) {
        NotModelled::ChangeOfSide
    } else if before.offset != given.offset && element.arc.is_some() {
        NotModelled::RadiusInArc
    } else {
        return Ok(());
    };
    Err(CompensationFault::Given(Fault::not_modelled(what, 0)))
}

/// Adds the moves around the corner at the beginning of a move; returns the point where they end.
fn put_corner(segment: &Segment, plane: Plane, centers: &Centers, moves: &mut CenterMoves) -> Point {
    let pairs = centers.iter().zip(centers.iter().skip(1));
    for (from, to) in pairs {
        put(moves, CenterMove::Corner(around_corner(segment, plane, *from, *to)));
    }
    centers.last().copied().unwrap_or(NONE)
}

fn held_fault(alarm: Alarm) -> CompensationFault {
    CompensationFault::Held(Fault::alarm(alarm, 0))
}

fn given_fault(alarm: Alarm) -> CompensationFault {
    CompensationFault::Given(Fault::alarm(alarm, 0))
}

fn put(moves: &mut CenterMoves, center_move: CenterMove) {
    let _full = moves.push(center_move);
}

#[cfg(test)]
mod tests;
