//! Range of a law's demand along a whole move, and a feed that is not above the demand anywhere on it.

use arcfeed_law::FeedDemand;

use super::profile::{Answer, Profile};

/// Range of the feeds that a law demands along a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DemandRange {
    /// Smallest demanded feed of the tool centre among the evaluated points, mm/min.
    pub feed_min_mm_per_min: f64,
    /// Largest demanded feed among the evaluated points, mm/min.
    pub feed_max_mm_per_min: f64,
    /// Feed that is not above the demand at any point of the move, also between the evaluated points, mm/min.
    pub safe_mm_per_min: f64,
    /// Smallest and largest demanded feed per tooth of the tool centre, mm.
    pub ipt_mm_per_tooth: [f64; 2],
    /// Contact angle at the first and at the last point with a demand, degrees.
    pub contact_deg: [f64; 2],
    /// The law has a demand, or permits any feed, at every evaluated point of the move.
    pub covers_all: bool,
}

impl DemandRange {
    /// Range of the results in `profile`, for `teeth_per_min` teeth that pass in a minute; `None` if none of them is a
    /// finite demand.
    pub fn of(profile: &Profile, teeth_per_min: f64) -> Option<Self> {
        let demands = || {
            profile.answers.iter().filter_map(|(_, answer)| match answer {
                Answer::Demand(demand) => Some(demand),
                Answer::Anything | Answer::Nothing => None,
            })
        };
        let paths_mm = || demands().map(|demand| f64::from(demand.path_mm_per_tooth));
        let least = paths_mm().reduce(f64::min)?;
        let most = paths_mm().reduce(f64::max)?;
        let contact_deg = |demand: &FeedDemand| f64::from(demand.contact_rad()).to_degrees();
        Some(DemandRange {
            feed_min_mm_per_min: teeth_per_min * least,
            feed_max_mm_per_min: teeth_per_min * most,
            safe_mm_per_min: teeth_per_min * profile.least()?,
            ipt_mm_per_tooth: [least, most],
            contact_deg: [contact_deg(demands().next()?), contact_deg(demands().next_back()?)],
            covers_all: !profile.answers.iter().any(|(_, answer)| *answer == Answer::Nothing),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::asked_cells::AskedCells;
    use super::super::places::MovePlaces;
    use super::*;
    use arcfeed_law::{FeedLaw, NoDemand, Place};
    use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
    use arcfeed_nc::segment::{Arc, Path, Segment};
    use arcfeed_units::Nm;

    fn along(law: &impl FeedLaw, segment: &Segment, teeth_per_min: f64) -> Option<DemandRange> {
        DemandRange::of(&Profile::ask(law, &MovePlaces::of(segment), &[], &AskedCells::all()), teeth_per_min)
    }

    fn quarter() -> Segment {
        let (center, from, to) = ([Nm(0); 2], [Nm(1_000_000), Nm(0)], [Nm(0), Nm(1_000_000)]);
        let path = Path::Arc(Arc { plane: Plane::Xy, turn: Turn::Ccw, center, from, to });
        Segment { sequence: None, start: Pose::default(), end: Pose::default(), feed: Feed::Missing, path }
    }

    /// A valley of depth 1 whose bottom lies between two of the points asked.
    struct Valley;

    impl FeedLaw for Valley {
        fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand> {
            let [x, y] = place.center_mm;
            let from_bottom = libm::atan2f(y, x) - 0.782;
            Ok(FeedDemand { path_mm_per_tooth: 1.0 + from_bottom * from_bottom, contact: [1.0, 0.0] })
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
        fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand> {
            let from_knot = (place.travelled_mm - self.0).abs();
            Ok(FeedDemand { path_mm_per_tooth: 1.0 + 9.0 * from_knot, contact: [1.0, 0.0] })
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

    /// A law that jumps, as where another edge takes over.
    struct Jump;

    impl FeedLaw for Jump {
        fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand> {
            let path_mm_per_tooth = if place.travelled_mm < 0.7777 { 40.0 } else { 1.0 };
            Ok(FeedDemand { path_mm_per_tooth, contact: [1.0, 0.0] })
        }
    }

    #[test]
    fn a_jump_costs_next_to_nothing() {
        let range = along(&Jump, &quarter(), 100.0).unwrap();
        assert!(range.safe_mm_per_min <= 100.0 && range.safe_mm_per_min > 99.9, "{range:?}");
    }

    struct Silent;

    impl FeedLaw for Silent {
        fn demand(&self, _: &Place) -> Result<FeedDemand, NoDemand> {
            Err(NoDemand::NoContact)
        }
    }

    #[test]
    fn a_law_without_a_demand_has_no_range() {
        assert_eq!(along(&Silent, &quarter(), 100.0), None);
    }
}
