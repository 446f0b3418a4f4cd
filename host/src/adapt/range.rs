//! What a law wants along a whole arc: the range of its wishes, and a feed that no point of the arc undercuts.

use arcfeed_firmware::law::{FeedLaw, NoWish};
use arcfeed_shared::segment::Arc;

/// Points along the arc at which the law is asked.
const POINTS: usize = 257;

/// The wishes of a law along an arc.
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
    /// Whether the law has a wish everywhere on the arc.
    pub covers_all: bool,
}

/// Asks the law along the arc; `None` if it has no finite wish anywhere.
pub fn along(law: &impl FeedLaw, arc: &Arc, teeth_per_min: f64) -> Option<WishRange> {
    let mut paths_mm = Vec::with_capacity(POINTS);
    let mut contacts_rad = Vec::with_capacity(POINTS);
    let mut covers_all = true;
    for point in 0..POINTS {
        let [x, y] = arc.direction_at(point as f64 / (POINTS - 1) as f64);
        match law.wish([x as f32, y as f32]) {
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
        safe_mm_per_min: teeth_per_min * (least - dip_between(&paths_mm)),
        ipt_mm_per_tooth: [least, most],
        contact_deg: [contacts_rad.first()?.to_degrees(), contacts_rad.last()?.to_degrees()],
        covers_all,
    })
}

/// How far a smooth curve may dip below the lower of two neighbouring points: an eighth of its second difference.
fn dip_between(values: &[f64]) -> f64 {
    let second = values.windows(3).map(|window| libm::fabs(window[0] - 2.0 * window[1] + window[2]));
    second.fold(0.0, f64::max) / 8.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_firmware::law::Wish;
    use arcfeed_shared::nc::modal::{Plane, Turn};
    use arcfeed_shared::units::Nm;

    const QUARTER: Arc = Arc {
        plane: Plane::Xy,
        turn: Turn::Ccw,
        center: [Nm(0); 2],
        from: [Nm(1_000_000), Nm(0)],
        to: [Nm(0), Nm(1_000_000)],
    };

    /// A valley of depth 1 whose bottom lies between two of the points asked.
    struct Valley;

    impl FeedLaw for Valley {
        fn wish(&self, [x, y]: [f32; 2]) -> Result<Wish, NoWish> {
            let from_bottom = libm::atan2f(y, x) - 0.782;
            Ok(Wish { path_mm_per_tooth: 1.0 + from_bottom * from_bottom, contact: [0.8, 0.6] })
        }
    }

    #[test]
    fn the_safe_feed_undercuts_what_lies_between_the_points() {
        let range = along(&Valley, &QUARTER, 100.0).unwrap();
        assert!(range.safe_mm_per_min <= 100.0 && range.safe_mm_per_min > 99.99, "{range:?}");
        assert!(range.covers_all);
    }

    struct Silent;

    impl FeedLaw for Silent {
        fn wish(&self, _: [f32; 2]) -> Result<Wish, NoWish> {
            Err(NoWish::NoContact)
        }
    }

    #[test]
    fn a_law_without_a_wish_has_no_range() {
        assert_eq!(along(&Silent, &QUARTER, 100.0), None);
    }
}
