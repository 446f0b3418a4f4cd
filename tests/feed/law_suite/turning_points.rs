//! A law asked around its turning points and knots only, and everywhere: the same feeds.

use super::scenes::CircumferenceScene;
use crate::geometry::{between, dot, log_between};
use arcfeed::adapt::asked_cells::{AskedCells, CELLS};
use arcfeed::adapt::places::MovePlaces;
use arcfeed::adapt::profile::Profile;
use arcfeed::adapt::range::DemandRange;
use arcfeed_law::circumference::Circumference;
use arcfeed_law::table::Table;
use arcfeed_law::{FeedDemand, FeedLaw, NoDemand, Place, SegmentLaw};
use arcfeed_nc::modal::{Feed, Pose};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_tests::of_full_set;
use arcfeed_units::{Mm, MmPerTooth, Nm};
use core::cell::Cell;
use core::f64::consts::{PI, TAU};
use fastrand::Rng;

/// How much the demand's own roundings make of two ranges, in parts of a feed.
const ROUNDING: f64 = 2e-6;

/// Largest step of the demand from one place in f32 to the next where contact ends, in parts of a feed.
const ONE_STEP: f64 = 3e-5;

/// Arcs of all lengths, radii as rings have them and others, lines that pass A, that touch the circle, that are met near either end
/// of what the law holds for.
fn sample(random: &mut Rng) -> CircumferenceScene {
    let mut scene = CircumferenceScene::sample(random);
    if random.bool() {
        scene.path_radius = scene.edge_radius * (1.0 + between(random, -1e-3, 1e-3));
    }
    if random.bool() {
        scene.chip = scene.edge_radius * log_between(random, 1e-5, 0.2);
    }
    scene.sweep_rad = log_between(random, 1e-4, TAU);
    let angle = match random.u8(..6) {
        0 => between(random, 0.0, TAU),
        1 => 0.5 * PI + between(random, -0.02, 0.02),
        2 => log_between(random, 1e-4, 0.1),
        _ => between(random, 0.0, 0.5 * PI),
    };
    scene.offset = dot(scene.normal, scene.contact_point(random.f64(), angle));
    scene
}

/// The arc as a move, with its law; none where its ends come out alike.
fn arc_and_law(scene: &CircumferenceScene) -> Option<(Segment, SegmentLaw)> {
    let arc = scene.arc();
    if arc.from == arc.to {
        return None;
    }
    let (radius, chip) = (Mm(scene.edge_radius as f32), MmPerTooth(scene.chip as f32));
    let law = Circumference::for_arc(&arc, radius, scene.edge, &scene.stock(), chip);
    let (start, end, feed) = (Pose::ORIGIN, Pose::ORIGIN, Feed::Missing);
    Some((Segment { sequence: None, start, end, feed, path: Path::Arc(arc) }, SegmentLaw::Circumference(law)))
}

/// The demands around the turning points and everywhere, and in how many cells the law is asked for the first; none where it
/// is asked in all of them.
fn ranges(law: &SegmentLaw, segment: &Segment) -> Option<([Option<DemandRange>; 2], usize)> {
    let places = MovePlaces::of(segment);
    let mut knots_mm = Vec::new();
    law.knots_mm(&mut |mm| knots_mm.push(f64::from(mm)));
    let few = AskedCells::deciding(law, &places, &knots_mm);
    let range = |cells: &AskedCells| DemandRange::of(&Profile::ask(law, &places, &knots_mm, cells), 1.0);
    (few.count() < CELLS).then(|| ([range(&few), range(&AskedCells::all())], few.count()))
}

/// How far two ranges are apart, in parts of their feeds; infinite where they are not the same otherwise.
fn apart(ranges: &[Option<DemandRange>; 2]) -> f64 {
    let (few, all) = match ranges {
        [Some(few), Some(all)] if (few.covers_all, few.contact_deg) == (all.covers_all, all.contact_deg) => (few, all),
        [None, None] => return 0.0,
        _ => return f64::INFINITY,
    };
    let feeds = |range: &DemandRange| [range.feed_min_mm_per_min, range.feed_max_mm_per_min, range.safe_mm_per_min];
    let errors = feeds(few).into_iter().zip(feeds(all)).map(|(few, all)| libm::fabs(few / all - 1.0));
    errors.fold(0.0, f64::max)
}

#[test]
fn turning_points_of_the_circumference_law_give_the_same_demand_as_all_cells() {
    let mut random = Rng::with_seed(17);
    let (mut worst, mut asked, mut arcs) = (0.0_f64, 0, 0);
    for case in 0..of_full_set(50_000, 1_500) {
        let scene = sample(&mut random);
        let Some((segment, law)) = arc_and_law(&scene) else { continue };
        let Some((ranges, count)) = ranges(&law, &segment) else { continue };
        let error = apart(&ranges);
        assert!(error < ROUNDING, "case {case}: {ranges:?} in {count} cells, {scene:?}");
        worst = worst.max(error);
        if ranges[1].is_some() {
            (asked, arcs) = (asked + count, arcs + 1);
        }
    }
    println!("{arcs} arcs, {} of {CELLS} cells each; apart by {worst:e}", asked / arcs);
    assert!(asked < arcs * CELLS / 4, "{asked} cells of {arcs} arcs");
}

/// A law that counts its evaluations.
struct Counted<'a> {
    law: &'a SegmentLaw,
    evaluations: Cell<usize>,
}

impl FeedLaw for Counted<'_> {
    fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand> {
        self.evaluations.set(self.evaluations.get() + 1);
        self.law.demand(place)
    }
}

/// Where contact ends the demand rises steeply, in steps of f32 that are no dips. One such step is the most by which a place may lie below the bound.
#[test]
fn the_least_demand_is_a_bound_and_found_by_few_evaluations_also_where_contact_ends() {
    let mut random = Rng::with_seed(19);
    let (mut closest, mut furthest) = (f64::INFINITY, 0.0_f64);
    let (mut arcs, mut evaluations, mut most) = (0, 0, 0);
    for case in 0..of_full_set(5_000, 400) {
        let scene = sample(&mut random);
        let Some((segment, law)) = arc_and_law(&scene) else { continue };
        let places = MovePlaces::of(&segment);
        let counted = Counted { law: &law, evaluations: Cell::new(0) };
        let asked = AskedCells::deciding(&law, &places, &[]);
        let Some(least) = Profile::ask(&counted, &places, &[], &asked).least() else { continue };
        let steps = 5_000;
        let demands = (0..=steps).filter_map(|step| law.demand(&places.at(f64::from(step) / f64::from(steps))).ok());
        let lowest = demands.map(|demand| f64::from(demand.path_mm_per_tooth)).fold(f64::INFINITY, f64::min);
        assert!(least > 0.0 && least <= lowest * (1.0 + ONE_STEP), "case {case}: {least} above {lowest}, {scene:?}");
        (closest, furthest) = (closest.min(lowest / least - 1.0), furthest.max(lowest / least - 1.0));
        let count = counted.evaluations.get() - asked.count();
        (arcs, evaluations, most) = (arcs + 1, evaluations + count, most.max(count));
    }
    println!(
        "{arcs} arcs: {} evaluations beside the cells' ends, at most {most}; lowest over bound {closest:e} .. {furthest:e}",
        evaluations / arcs
    );
    assert!(evaluations < 2_000 * arcs && most < 40_000, "{evaluations} of {arcs} arcs, at most {most}");
}

#[test]
fn knots_of_a_table_give_the_same_demand_as_all_cells() {
    let mut random = Rng::with_seed(18);
    for case in 0..of_full_set(50_000, 2_000) {
        let length_mm = log_between(&mut random, 0.1, 500.0);
        let mut at_mm = -0.1 * length_mm;
        let mut knot = || {
            at_mm += length_mm * log_between(&mut random, 1e-3, 1.0);
            (Mm(at_mm as f32), MmPerTooth(log_between(&mut random, 0.01, 1.0) as f32))
        };
        let knots: Vec<_> = (0..6).map(|_| knot()).collect();
        let law = SegmentLaw::Table(Table::new(&knots).expect("a table"));
        let mut end = Pose::ORIGIN;
        end.linear[0] = Nm::from_mm(length_mm);
        let segment = Segment { sequence: None, start: Pose::ORIGIN, end, feed: Feed::Missing, path: Path::Line };
        let Some((ranges, count)) = ranges(&law, &segment) else { continue };
        assert!(apart(&ranges) < ROUNDING, "case {case}: {ranges:?} in {count} cells, {length_mm} {knots:?}");
    }
}
