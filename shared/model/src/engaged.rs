//! Engaged arcs of a cup mill's two cutting circles (directions in which their edges are in material) over the path
//! travelled: a table that is computed beforehand from the removed material.
//!
//! *Frame.* A direction from the tool's centre is an angle from the direction towards the rotation centre A (on a line: to
//! the left of the motion), positive towards the side on which the circle's edges advance: with the motion for the outer
//! circle, against it for the inner one. 90 degrees is straight ahead for either; the angles are those of the contact.
//! The engaged arc runs from `from` in the positive sense to `to`.
//!
//! *Between knots* both ends are linear in the path; before the first knot and after the last they are constant. Where
//! `from` is not less than `to` nothing is engaged: an arc that shrinks to an empty one ends where its two ends meet.
//!
//! Angles are whole multiples of 1/90 degree, so none is NaN. A table for both circles needs as much memory as eight
//! stock lines.

use heapless::Vec;

use crate::tool::Edge;
use arcfeed_units::Mm;
use arcfeed_units::fmath;

/// Largest number of knots in a table.
pub const ENGAGED_KNOTS_MAX: usize = 16;
/// Units of an angle in a degree.
const UNITS_PER_DEGREE: f64 = 90.0;
/// Full turn: the largest magnitude of an arc's ends, and the largest width of an arc.
const TURN_DEG: f64 = 360.0;
/// Full turn in units of 1/90 degree.
const TURN: u16 = (TURN_DEG * UNITS_PER_DEGREE) as u16;
/// One unit in radians.
const UNIT_RAD: f32 = (core::f64::consts::PI / (180.0 * UNITS_PER_DEGREE)) as f32;
/// Right angle in units, and the feed direction as a positive and as a negative angle.
const QUARTER: f32 = 8_100.0;
const AHEAD: [f32; 2] = [QUARTER, -3.0 * QUARTER];

/// Engaged arc of one cutting circle, as the table stores it: the directions from `from` to `to`, in the sense of
/// positive angles, in whole multiples of 1/90 degree. Empty if `from` is not less than `to`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EngagedInterval {
    from: i16,
    to: i16,
}

/// Engaged arc of one cutting circle, interpolated at a place of the path; never empty. The angles count as in
/// [`EngagedInterval`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EngagedSpan {
    from: f32,
    to: f32,
}

/// Engaged arcs of both cutting circles of a cup mill at one point of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EngagedKnot {
    /// Path from the segment's start.
    pub travelled: Mm,
    /// Engaged arc of the outer circle.
    pub outer: EngagedInterval,
    /// Engaged arc of the inner circle.
    pub inner: EngagedInterval,
}

/// Engaged arcs of a cup mill along one segment: knots by growing path, linear between them.
#[derive(Clone, Debug, PartialEq)]
pub struct EngagedTable {
    knots: Vec<EngagedKnot, ENGAGED_KNOTS_MAX>,
}

/// Reason why knots are rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EngagedError {
    /// There is no knot, or more than [`ENGAGED_KNOTS_MAX`].
    Count,
    /// The path of the knot with this index (from 0) is not larger than that of the knot before, or is not a finite
    /// number.
    Order(usize),
}

impl EngagedInterval {
    /// Empty interval: nothing is engaged.
    pub const EMPTY: Self = EngagedInterval { from: 0, to: 0 };

    /// Interval between two angles, rounded to 1/90 degree; `None` if one is beyond +-360 degrees or NaN, or if the
    /// arc is wider than 360 degrees.
    pub fn from_degrees(from_deg: f64, to_deg: f64) -> Option<Self> {
        let units = |degrees: f64| {
            let is_within = (-TURN_DEG..=TURN_DEG).contains(&degrees);
            is_within.then(|| libm::round(degrees * UNITS_PER_DEGREE) as i16)
        };
        let interval = EngagedInterval { from: units(from_deg)?, to: units(to_deg)? };
        (to_deg - from_deg <= TURN_DEG).then_some(interval)
    }

    /// First and last angle of the arc, degrees, as rounded.
    pub fn degrees(self) -> [f64; 2] {
        [self.from, self.to].map(|units| f64::from(units) / UNITS_PER_DEGREE)
    }

    /// First and last angle of the arc, in units of 1/90 degree.
    pub fn units(self) -> [i16; 2] {
        [self.from, self.to]
    }

    /// Interval from a first and a last angle as [`Self::units`] returns them; `None` as for [`Self::from_degrees`].
    pub fn from_units([from, to]: [i16; 2]) -> Option<Self> {
        let width = i32::from(to) - i32::from(from);
        let is_arc = [from, to].iter().all(|end| end.unsigned_abs() <= TURN) && width <= i32::from(TURN);
        is_arc.then_some(EngagedInterval { from, to })
    }

    /// Arc at this fraction of the path between two knots; `None` where it is empty.
    fn between(self, other: Self, ratio: f32) -> Option<EngagedSpan> {
        let part = |a: i16, b: i16| f32::from(a) + (f32::from(b) - f32::from(a)) * ratio;
        let span = EngagedSpan { from: part(self.from, other.from), to: part(self.to, other.to) };
        (span.from < span.to).then_some(span)
    }
}

impl EngagedSpan {
    /// First and last angle of the arc, degrees.
    pub fn degrees(&self) -> [f32; 2] {
        [self.from, self.to].map(|units| units / UNITS_PER_DEGREE as f32)
    }

    /// Whether the arc contains the direction straight ahead, in which the edges advance: +90 or -270 degrees.
    pub fn is_engaged_ahead(&self) -> bool {
        AHEAD.iter().any(|ahead| (self.from..=self.to).contains(ahead))
    }

    /// Unit vectors from the tool's centre to the first and to the last direction of the arc. Components: along the
    /// direction in which the edges advance (k v: with the motion for the outer circle, against it for the inner one),
    /// and towards the rotation centre.
    pub fn ends(&self) -> [[f32; 2]; 2] {
        [self.from, self.to].map(direction)
    }
}

/// Sine and cosine of an angle in units; exact at whole right angles.
fn direction(units: f32) -> [f32; 2] {
    let quarters = fmath::ceil(units / QUARTER - 0.5);
    let [cos, sin] = fmath::cos_sin_of_octant((units - quarters * QUARTER) * UNIT_RAD);
    match (quarters as i32).rem_euclid(4) {
        0 => [sin, cos],
        1 => [cos, -sin],
        2 => [-sin, -cos],
        _ => [-cos, sin],
    }
}

impl EngagedKnot {
    fn of(&self, edge: Edge) -> EngagedInterval {
        match edge {
            Edge::Outer => self.outer,
            Edge::Inner => self.inner,
        }
    }
}

impl EngagedTable {
    /// Table of these knots, which must be in the order of the path.
    ///
    /// # Errors
    /// See [`EngagedError`].
    pub fn new(knots: &[EngagedKnot]) -> Result<Self, EngagedError> {
        let (first, others) = knots.split_first().ok_or(EngagedError::Count)?;
        let mut table = EngagedTable::with_first(*first)?;
        others.iter().try_for_each(|knot| table.push(*knot))?;
        Ok(table)
    }

    /// A table of one knot, to which [`Self::push`] adds the others.
    ///
    /// # Errors
    /// [`EngagedError::Order`] if its path is not a finite number.
    pub fn with_first(knot: EngagedKnot) -> Result<Self, EngagedError> {
        let mut table = EngagedTable { knots: Vec::new() };
        table.push(knot)?;
        Ok(table)
    }

    /// Appends a knot. The table does not change if the knot is rejected.
    ///
    /// # Errors
    /// See [`EngagedError`].
    pub fn push(&mut self, knot: EngagedKnot) -> Result<(), EngagedError> {
        let last = self.knots.last().map_or(f32::NEG_INFINITY, |last| last.travelled.0);
        if !(knot.travelled.0 > last && knot.travelled.0.is_finite()) {
            return Err(EngagedError::Order(self.knots.len()));
        }
        self.knots.push(knot).map_err(|_| EngagedError::Count)
    }

    /// The knots, in the order of the path.
    pub fn knots(&self) -> &[EngagedKnot] {
        &self.knots
    }

    /// Engaged arc of a cutting circle at this distance from the segment's start; `None` where nothing is engaged.
    /// Before the first knot and after the last the arc is that of the knot.
    pub fn arc_at(&self, travelled_mm: f32, edge: Edge) -> Option<EngagedSpan> {
        let next = self.knots.partition_point(|knot| knot.travelled.0 <= travelled_mm);
        let before = next.checked_sub(1).and_then(|index| self.knots.get(index));
        match (before, self.knots.get(next)) {
            (Some(a), Some(b)) => {
                let ratio = (travelled_mm - a.travelled.0) / (b.travelled.0 - a.travelled.0);
                a.of(edge).between(b.of(edge), ratio)
            }
            (Some(only), None) | (None, Some(only)) => only.of(edge).between(only.of(edge), 0.0),
            (None, None) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knot(travelled: f32, [from, to]: [f64; 2]) -> EngagedKnot {
        let inner = EngagedInterval::from_degrees(from, to).unwrap();
        EngagedKnot { travelled: Mm(travelled), outer: EngagedInterval::EMPTY, inner }
    }

    fn degrees(table: &EngagedTable, travelled: f32) -> Option<[f32; 2]> {
        table.arc_at(travelled, Edge::Inner).map(|span| [span.from / 90.0, span.to / 90.0])
    }

    #[test]
    fn both_ends_are_linear_between_knots_and_level_beyond() {
        let table = EngagedTable::new(&[knot(10.0, [20.0, 60.0]), knot(30.0, [40.0, 140.0])]).unwrap();
        assert_eq!(degrees(&table, 0.0), Some([20.0, 60.0]));
        assert_eq!(degrees(&table, 20.0), Some([30.0, 100.0]));
        assert_eq!(degrees(&table, 99.0), Some([40.0, 140.0]));
        assert_eq!(table.arc_at(20.0, Edge::Outer), None);
    }

    #[test]
    fn an_arc_is_gone_where_its_ends_meet() {
        let table = EngagedTable::new(&[knot(0.0, [0.0, 40.0]), knot(4.0, [80.0, 40.0])]).unwrap();
        assert_eq!(degrees(&table, 1.0), Some([20.0, 40.0]));
        assert!(degrees(&table, 2.0).is_none() && degrees(&table, 3.0).is_none());
    }

    #[test]
    fn directions_are_those_of_f64_all_the_way_round() {
        for units in (-32_400..=32_400).map(|units: i16| f32::from(units) + 0.25) {
            let (sin, cos) = libm::sincos(f64::from(units / 90.0).to_radians());
            let [advance, towards] = direction(units);
            assert!((f64::from(advance) - sin).abs() < 3e-7 && (f64::from(towards) - cos).abs() < 3e-7, "{units}");
        }
        assert_eq!([QUARTER, -QUARTER, 0.0].map(direction), [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]]);
    }

    #[test]
    fn straight_ahead_is_90_degrees_either_way_round() {
        for (from, to, holds) in
            [(0.0, 89.0, false), (0.0, 90.0, true), (91.0, 180.0, false), (-300.0, -250.0, true), (-360.0, 0.0, true)]
        {
            let table = EngagedTable::new(&[knot(0.0, [from, to])]).unwrap();
            assert_eq!(table.arc_at(0.0, Edge::Inner).unwrap().is_engaged_ahead(), holds, "{from} {to}");
        }
    }

    #[test]
    fn the_whole_circle_is_an_arc_and_more_is_none() {
        assert_eq!(EngagedInterval::from_degrees(-360.0, 0.0).unwrap().degrees(), [-360.0, 0.0]);
        for [from, to] in [[-1.0, 359.5], [0.0, 360.1], [-361.0, -300.0], [f64::NAN, 1.0], [1.0, f64::NAN]] {
            assert_eq!(EngagedInterval::from_degrees(from, to), None, "{from} {to}");
        }
    }

    #[test]
    fn units_are_an_arc_where_their_degrees_are() {
        let units = |from: i16, to: i16| EngagedInterval::from_units([from, to]);
        for (from, to) in [(0, 0), (-32_400, 0), (0, 32_400), (32_400, -32_400), (-9_000, 8_100)] {
            let [from_deg, to_deg] = [from, to].map(|units| f64::from(units) / 90.0);
            assert_eq!(units(from, to), EngagedInterval::from_degrees(from_deg, to_deg));
            assert_eq!(units(from, to).unwrap().units(), [from, to]);
        }
        for (from, to) in [(0, 32_401), (-32_401, -32_400), (i16::MIN, 0), (-1, 32_400), (-32_400, 1)] {
            assert_eq!(units(from, to), None, "{from} {to}");
        }
    }

    #[test]
    fn knots_come_one_by_one_and_a_refused_one_changes_nothing() {
        let all: std::vec::Vec<EngagedKnot> = (0..16).map(|i| knot(i as f32, [0.0, 1.0])).collect();
        let mut table = EngagedTable::with_first(all[0]).unwrap();
        all[1..].iter().for_each(|knot| table.push(*knot).unwrap());
        assert_eq!(table, EngagedTable::new(&all).unwrap());
        assert_eq!(table.push(knot(15.0, [0.0, 1.0])), Err(EngagedError::Order(16)));
        assert_eq!(table.push(knot(99.0, [0.0, 1.0])), Err(EngagedError::Count));
        assert_eq!(table.knots(), all);
    }

    #[test]
    fn senseless_knots_are_refused_by_number() {
        let same = [knot(1.0, [0.0, 1.0]); 2];
        assert_eq!(EngagedTable::new(&same), Err(EngagedError::Order(1)));
        assert_eq!(EngagedTable::new(&[knot(f32::NAN, [0.0, 1.0])]), Err(EngagedError::Order(0)));
        assert_eq!(EngagedTable::new(&[]), Err(EngagedError::Count));
        let many: std::vec::Vec<EngagedKnot> = (0..17).map(|i| knot(i as f32, [0.0, 1.0])).collect();
        assert_eq!(EngagedTable::new(&many), Err(EngagedError::Count));
    }
}
