//! Encoding of segments (moves) and of the tables along them as messages: engaged arcs, feeds.
//!
//! An arc is sent with its centre only: the board computes start and end relative to it and checks them as the control
//! does.

use arcfeed_model::engaged::{EngagedInterval, EngagedKnot};
use arcfeed_model::knots::Knot;
use arcfeed_nc::modal::{Center, Feed, Motion, MotionKind, Plane, Pose, Turn};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{MicroDeg, Mm, MmPerTooth, Nm};

use super::codes::{FeedCode, PathCode};
use super::fixed::Q40;
use super::table;

/// Largest coordinate, nm: 9 km, so that no difference of two overflows.
const AXIS_MAX: u64 = 1 << 53;

/// Reason why a segment (one move) or a table along it cannot be encoded, or a message with them cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveError {
    /// An arc has no centre or no radius, its ends do not lie on it, or its coordinates contradict each other.
    Arc,
    /// A coordinate, or the path or the feed at a knot, is too large, or an engaged arc is invalid.
    Range,
    /// A centre for a move that is not an arc, or a feed for one that has none.
    Surplus,
}

/// Encodes a segment (one move) as a message for the board. `count` is its number in the run; `rule` the index of its
/// cut rule, or `None` if no law governs the move.
///
/// # Errors
/// [`MoveError::Arc`] if centre, start and end of an arc do not agree to the nanometre; [`MoveError::Range`].
pub fn encode(segment: &Segment, count: u32, rule: Option<u8>) -> Result<table::Segment, MoveError> {
    let (feed_code, feed) = match segment.feed {
        Feed::PerMinute(Nm(feed)) => (FeedCode::PerMinute, feed),
        Feed::InverseTime(feed) => (FeedCode::InverseTime, feed),
        Feed::Missing => (FeedCode::Missing, 0),
    };
    let (path, center) = match &segment.path {
        Path::Rapid => (PathCode::Rapid, None),
        Path::Line => (PathCode::Line, None),
        Path::Arc(arc) => (path_code(arc.plane, arc.turn), Some(arc.center.map(|Nm(nm)| nm))),
    };
    let message = table::Segment {
        count,
        sequence: segment.sequence,
        start: segment.start.linear.map(|Nm(nm)| nm),
        end: segment.end.linear.map(|Nm(nm)| nm),
        start_rotary: rotary(&segment.start),
        end_rotary: rotary(&segment.end),
        feed_code,
        feed,
        path,
        center,
        rule,
        spindle: None,
        max_feed: None,
        end_percent: None,
    };
    if decode(&message)? == *segment { Ok(message) } else { Err(MoveError::Arc) }
}

/// Decodes a segment (one move) from a message and checks its geometry.
///
/// # Errors
/// See [`MoveError`].
pub fn decode(message: &table::Segment) -> Result<Segment, MoveError> {
    let start = pose(message.start, message.start_rotary)?;
    let end = pose(message.end, message.end_rotary)?;
    let feed = match (message.feed_code, message.feed) {
        (FeedCode::PerMinute, feed) => Feed::PerMinute(Nm(feed)),
        (FeedCode::InverseTime, feed) => Feed::InverseTime(feed),
        (FeedCode::Missing, 0) => Feed::Missing,
        (FeedCode::Missing, _) => return Err(MoveError::Surplus),
    };
    let (kind, plane) = kind(message.path);
    let center = match (kind, message.center) {
        (MotionKind::Arc(_), Some(center)) => Center::Offset(offset(plane, center, &start)?),
        (MotionKind::Arc(_), None) => return Err(MoveError::Arc),
        (MotionKind::Rapid | MotionKind::Line, None) => Center::Offset([Nm(0); 3]),
        (MotionKind::Rapid | MotionKind::Line, Some(_)) => return Err(MoveError::Surplus),
    };
    let motion = Motion { kind, plane, start, end, center, feed };
    Segment::from_motion(&motion, message.sequence).map_err(|_| MoveError::Arc)
}

/// Encodes one knot of the engaged arcs that belong to the segment sent next.
///
/// # Errors
/// [`MoveError::Range`].
pub fn encode_arcs(knot: &EngagedKnot) -> Result<table::SegmentArcs, MoveError> {
    let travelled = Q40::of(knot.travelled.0).ok_or(MoveError::Range)?;
    Ok(table::SegmentArcs { travelled, outer: knot.outer.units(), inner: knot.inner.units() })
}

/// Decodes one knot of engaged arcs. `travelled` is the path from the segment's start, mm; the arcs are first and last
/// direction, in units of 1/90 degree.
///
/// # Errors
/// [`MoveError::Range`].
pub fn decode_arcs(travelled: Q40, [outer, inner]: [[i16; 2]; 2]) -> Result<EngagedKnot, MoveError> {
    let interval = |units| EngagedInterval::from_units(units).ok_or(MoveError::Range);
    Ok(EngagedKnot { travelled: Mm(travelled.value()), outer: interval(outer)?, inner: interval(inner)? })
}

/// Encodes one knot of the feeds that govern the segment sent next.
///
/// # Errors
/// [`MoveError::Range`].
pub fn encode_feed((travelled, feed): &Knot) -> Result<table::SegmentFeed, MoveError> {
    let fixed = |number: f32| Q40::of(number).ok_or(MoveError::Range);
    Ok(table::SegmentFeed { travelled: fixed(travelled.0)?, feed_per_tooth: fixed(feed.0)? })
}

/// Decodes one knot of the feeds of a segment.
pub fn decode_feed(message: &table::SegmentFeed) -> Knot {
    (Mm(message.travelled.value()), MmPerTooth(message.feed_per_tooth.value()))
}

/// Positions of all axes: X, Y, Z in nanometres, and A, B, C in microdegrees, 0 if they are absent.
///
/// # Errors
/// [`MoveError::Range`].
pub fn pose(linear: [i64; 3], rotary: Option<[i64; 3]>) -> Result<Pose, MoveError> {
    let rotary = rotary.unwrap_or_default();
    let is_near = linear.iter().chain(&rotary).all(|at| at.unsigned_abs() <= AXIS_MAX);
    is_near.then_some(Pose { linear: linear.map(Nm), rotary: rotary.map(MicroDeg) }).ok_or(MoveError::Range)
}

/// A, B, C of a position, microdegrees; `None` if all are 0.
pub fn rotary(pose: &Pose) -> Option<[i64; 3]> {
    let rotary = pose.rotary.map(|MicroDeg(at)| at);
    (rotary != [0; 3]).then_some(rotary)
}

/// Vector from the start to the centre, in the axes of the plane.
fn offset(plane: Plane, center: [i64; 2], start: &Pose) -> Result<[Nm; 3], MoveError> {
    if center.iter().any(|at| at.unsigned_abs() > AXIS_MAX) {
        return Err(MoveError::Range);
    }
    let mut offset = [Nm(0); 3];
    let (first, second, _) = plane.axes();
    for (axis, at) in [first, second].into_iter().zip(center) {
        let from = start.linear.get(axis).copied().unwrap_or_default();
        if let Some(slot) = offset.get_mut(axis) {
            *slot = Nm(at.saturating_sub(from.0));
        }
    }
    Ok(offset)
}

const fn path_code(plane: Plane, turn: Turn) -> PathCode {
    match (plane, turn) {
        (Plane::Xy, Turn::Cw) => PathCode::CwXy,
        (Plane::Xy, Turn::Ccw) => PathCode::CcwXy,
        (Plane::Zx, Turn::Cw) => PathCode::CwZx,
        (Plane::Zx, Turn::Ccw) => PathCode::CcwZx,
        (Plane::Yz, Turn::Cw) => PathCode::CwYz,
        (Plane::Yz, Turn::Ccw) => PathCode::CcwYz,
    }
}

const fn kind(path: PathCode) -> (MotionKind, Plane) {
    match path {
        PathCode::Rapid => (MotionKind::Rapid, Plane::Xy),
        PathCode::Line => (MotionKind::Line, Plane::Xy),
        PathCode::CwXy => (MotionKind::Arc(Turn::Cw), Plane::Xy),
        PathCode::CcwXy => (MotionKind::Arc(Turn::Ccw), Plane::Xy),
        PathCode::CwZx => (MotionKind::Arc(Turn::Cw), Plane::Zx),
        PathCode::CcwZx => (MotionKind::Arc(Turn::Ccw), Plane::Zx),
        PathCode::CwYz => (MotionKind::Arc(Turn::Cw), Plane::Yz),
        PathCode::CcwYz => (MotionKind::Arc(Turn::Ccw), Plane::Yz),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quarter(plane: Plane, turn: Turn) -> Segment {
        let (first, second, normal) = plane.axes();
        let (mut start, mut end) = (Pose::default(), Pose::default());
        start.linear[first] = Nm(10_000_003);
        end.linear[second] = Nm(10_000_001);
        end.linear[normal] = Nm(-7);
        let mut offset = [Nm(0); 3];
        offset[first] = Nm(-10_000_003);
        let motion = Motion {
            kind: MotionKind::Arc(turn),
            plane,
            start,
            end,
            center: Center::Offset(offset),
            feed: Feed::PerMinute(Nm(25_400_000)),
        };
        Segment::from_motion(&motion, Some(144))
            .unwrap()
            .shifted(Pose { linear: [Nm(5), Nm(-9), Nm(1)], ..Pose::ORIGIN })
    }

    #[test]
    fn arcs_of_all_planes_and_senses_come_back_as_they_were() {
        for plane in [Plane::Xy, Plane::Zx, Plane::Yz] {
            for turn in [Turn::Cw, Turn::Ccw] {
                let segment = quarter(plane, turn);
                let message = encode(&segment, 7, Some(3)).unwrap();
                assert_eq!((decode(&message), message.count, message.rule), (Ok(segment), 7, Some(3)));
            }
        }
    }

    #[test]
    fn lines_rapids_and_every_feed_come_back_as_they_were() {
        let mut end = Pose { linear: [Nm(1), Nm(i64::from(i32::MIN)), Nm(3)], ..Pose::default() };
        end.rotary[1] = MicroDeg(-90_000_000);
        for path in [Path::Rapid, Path::Line] {
            for feed in [Feed::Missing, Feed::PerMinute(Nm(1)), Feed::InverseTime(5)] {
                let segment = Segment { sequence: None, start: Pose::default(), end, feed, path };
                assert_eq!(decode(&encode(&segment, 0, None).unwrap()), Ok(segment));
            }
        }
    }

    #[test]
    fn engaged_arcs_come_back_as_they_were_and_are_refused_where_they_are_none() {
        let arc = |from, to| EngagedInterval::from_degrees(from, to).unwrap();
        for knot in [
            EngagedKnot { travelled: Mm(0.0), outer: EngagedInterval::EMPTY, inner: arc(-360.0, 0.0) },
            EngagedKnot { travelled: Mm(0.1), outer: arc(-33.3, 120.011), inner: EngagedInterval::EMPTY },
            EngagedKnot { travelled: Mm(8e6), outer: arc(0.0, 360.0), inner: arc(90.0, -90.0) },
        ] {
            let table::SegmentArcs { travelled, outer, inner } = encode_arcs(&knot).unwrap();
            assert_eq!(decode_arcs(travelled, [outer, inner]), Ok(knot));
        }
        let far = EngagedKnot { travelled: Mm(9e6), outer: EngagedInterval::EMPTY, inner: EngagedInterval::EMPTY };
        assert_eq!(encode_arcs(&far), Err(MoveError::Range));
        for arcs in [[[0, 32_401], [0, 0]], [[0, 0], [-1, 32_400]]] {
            assert_eq!(decode_arcs(Q40(0), arcs), Err(MoveError::Range), "{arcs:?}");
        }
    }

    #[test]
    fn feeds_come_back_to_the_last_bit_and_are_refused_where_they_are_too_large() {
        for (travelled, feed) in [(0.0, 0.05), (0.1, 1.0e-5), (8e6, 0.123_456_78), (31.25, 2.0_f32.powi(-17))] {
            let knot = (Mm(travelled), MmPerTooth(feed));
            assert_eq!(decode_feed(&encode_feed(&knot).unwrap()), knot);
        }
        for (travelled, feed) in [(9e6, 0.1), (0.0, 9e6), (f32::NAN, 0.1), (0.0, f32::INFINITY)] {
            assert_eq!(encode_feed(&(Mm(travelled), MmPerTooth(feed))), Err(MoveError::Range));
        }
    }

    #[test]
    fn what_is_no_segment_is_refused_by_name() {
        let good = encode(&quarter(Plane::Xy, Turn::Cw), 1, None).unwrap();
        for (bad, why) in [
            (table::Segment { center: None, ..good }, MoveError::Arc),
            (table::Segment { center: Some([good.start[0], good.start[1]]), ..good }, MoveError::Arc),
            (table::Segment { center: Some([31_000, 0]), ..good }, MoveError::Arc),
            (table::Segment { path: PathCode::Line, ..good }, MoveError::Surplus),
            (table::Segment { feed_code: FeedCode::Missing, ..good }, MoveError::Surplus),
            (table::Segment { end: [i64::MIN, 0, 0], ..good }, MoveError::Range),
            (table::Segment { center: Some([i64::MAX, 0]), ..good }, MoveError::Range),
            (table::Segment { end_rotary: Some([1, 0, 0]), ..good }, MoveError::Arc),
        ] {
            assert_eq!(decode(&bad), Err(why), "{bad:?}");
        }
        let mut torn = quarter(Plane::Xy, Turn::Cw);
        if let Path::Arc(arc) = &mut torn.path {
            arc.from[0].0 += 1;
        }
        assert_eq!(encode(&torn, 1, None), Err(MoveError::Arc));
    }
}
