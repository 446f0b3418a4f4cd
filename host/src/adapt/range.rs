//! What a law wants along a whole move: the range of its wishes, and a feed that no point of the arc undercuts.

use arcfeed_firmware::law::{FeedLaw, NoWish, Place};
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::Nm;

/// Points along the move at which the law is asked.
const POINTS: usize = 257;

/// The wishes of a law along a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WishRange {
    /// Least wanted feed at the points asked.
    pub feed_min_mm_per_min: f64,
    /// Largest.
    pub feed_max_mm_per_min: f64,
    /// A feed not above any wish, between the points either.
    pub safe_mm_per_min: f64,
    /// Least and largest feed per tooth at the centre.
    pub ipt_mm_per_tooth: [f64; 2],
    /// Contact angle at the first and the last point with a wish.
    pub contact_deg: [f64; 2],
    /// Whether the law has a wish everywhere on the move.
    pub covers_all: bool,
}

/// Asks the law along the move; `None` if it has no finite wish anywhere.
pub fn along(law: &impl FeedLaw, segment: &Segment, teeth_per_min: f64) -> Option<WishRange> {
    let mut paths_mm = Vec::with_capacity(POINTS);
    let mut contacts_rad = Vec::with_capacity(POINTS);
    let mut covers_all = true;
    for point in 0..POINTS {
        match law.wish(&place_at(segment, point as f64 / (POINTS - 1) as f64)) {
            Ok(wish) => {
                paths_mm.push(f64::from(wish.path_mm_per_tooth));
                contacts_rad.push(f64::from(wish.contact_rad()));
            }
            // No feed is too high there: nothing that the least could be.
            Err(NoWish::ChipUnreachable) => {}
            Err(_) => covers_all = false,
        }
    }
    let least = paths_mm.iter().copied().reduce(f64::min)?;
    let most = paths_mm.iter().copied().reduce(f64::max)?;
    Some(WishRange {
        feed_min_mm_per_min: teeth_per_min * least,
        feed_max_mm_per_min: teeth_per_min * most,
        safe_mm_per_min: teeth_per_min * floor_of(&paths_mm),
        ipt_mm_per_tooth: [least, most],
        contact_deg: [contacts_rad.first()?.to_degrees(), contacts_rad.last()?.to_degrees()],
        covers_all,
    })
}

fn place_at(segment: &Segment, ratio: f64) -> Place {
    let travelled_mm = (segment.feed_length_mm() * ratio) as f32;
    match segment.arc() {
        Some(arc) => {
            let direction = arc.direction_at(ratio).map(|component| component as f32);
            Place::on_arc(direction, f32::from(arc.turn.sign()), arc.radius_mm() as f32, travelled_mm)
        }
        None => {
            let [x, y, _] = segment.start.linear.map(Nm::to_mm);
            let [to_x, to_y, _] = segment.end.linear.map(Nm::to_mm);
            let part = |from: f64, to: f64| ((to - from) / segment.length_mm()) as f32;
            Place::on_line([part(x, to_x), part(y, to_y)], travelled_mm)
        }
    }
}

/// A bound that a curve through these points does not undercut, smooth or bent at the knots of a table. Between two
/// neighbours a smooth one dips below the lower by at most an eighth of the second difference there; one that is straight
/// but for a knot in between, by at most the half: the knot leaves f and 1 - f of its bend in the two differences, and
/// dips f (1 - f) of it below the chord.
fn floor_of(values: &[f64]) -> f64 {
    let bend = |middle: usize| match middle.checked_sub(1).and_then(|first| values.get(first..middle + 2)) {
        Some([a, b, c]) => libm::fabs(a - 2.0 * b + c),
        _ => 0.0,
    };
    let intervals = values.windows(2).enumerate();
    let floors = intervals.map(|(at, ends)| ends[0].min(ends[1]) - bend(at).max(bend(at + 1)) / 2.0);
    floors.fold(values.iter().copied().fold(f64::INFINITY, f64::min), f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_firmware::law::Wish;
    use arcfeed_shared::nc::modal::{Feed, Plane, Pose, Turn};
    use arcfeed_shared::segment::{Arc, Path};

    fn quarter() -> Segment {
        let (center, from, to) = ([Nm(0); 2], [Nm(1_000_000), Nm(0)], [Nm(0), Nm(1_000_000)]);
        let path = Path::Arc(Arc { plane: Plane::Xy, turn: Turn::Ccw, center, from, to });
        Segment { sequence: None, start: Pose::default(), end: Pose::default(), feed: Feed::Missing, path }
    }

    /// A valley of depth 1 whose bottom lies between two of the points asked.
    struct Valley;

    impl FeedLaw for Valley {
        fn wish(&self, place: &Place) -> Result<Wish, NoWish> {
            let [x, y] = place.center_mm;
            let from_bottom = libm::atan2f(y, x) - 0.782;
            Ok(Wish { path_mm_per_tooth: 1.0 + from_bottom * from_bottom, contact: [1.0, 0.0] })
        }
    }

    #[test]
    fn the_safe_feed_undercuts_what_lies_between_the_points() {
        let range = along(&Valley, &quarter(), 100.0).unwrap();
        assert!(range.safe_mm_per_min <= 100.0 && range.safe_mm_per_min > 99.99, "{range:?}");
        assert!(range.covers_all);
    }

    /// A table's lowest knot, anywhere between two of the points asked.
    struct Knot(f32);

    impl FeedLaw for Knot {
        fn wish(&self, place: &Place) -> Result<Wish, NoWish> {
            let from_knot = (place.travelled_mm - self.0).abs();
            Ok(Wish { path_mm_per_tooth: 1.0 + 9.0 * from_knot, contact: [1.0, 0.0] })
        }
    }

    #[test]
    fn the_safe_feed_undercuts_a_knot_between_the_points() {
        for part in [0.0, 0.05, 0.25, 0.5, 0.75, 0.95_f32] {
            let knot = (100.0 + part) * core::f32::consts::FRAC_PI_2 / 256.0;
            let range = along(&Knot(knot), &quarter(), 100.0).unwrap();
            assert!(range.safe_mm_per_min <= 100.000_1 && range.safe_mm_per_min > 94.4, "{part}: {range:?}");
        }
    }

    struct Silent;

    impl FeedLaw for Silent {
        fn wish(&self, _: &Place) -> Result<Wish, NoWish> {
            Err(NoWish::NoContact)
        }
    }

    #[test]
    fn a_law_without_a_wish_has_no_range() {
        assert_eq!(along(&Silent, &quarter(), 100.0), None);
    }
}
