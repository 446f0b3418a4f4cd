//! Required properties of every feed law: [`suite`] evaluates a law in random scenes and checks
//!
//! * bounds: a demand is a positive, finite number or a refusal, never a panic, for ordinary numbers and for NaN,
//!   infinities, subnormal and huge ones;
//! * not a number: a number of the scene that is none is refused by name, [`NoDemand::BadInput`];
//! * monotony: more chip, no smaller demand;
//! * uniformity: a law that says it answers alike everywhere does;
//! * symmetry: the whole scene in a mirror, the sense of turn with it, or turned as a whole: the same demand;
//! * scale: all lengths in inches, or in mm: the same demand in inches, or in mm;
//! * continuity: no jump between neighbouring places but where the set of contacts changes.
//!
//! *How equal two demands must be.* A mirror changes no digit. Turning and scaling round every number anew, which is no
//! more than a stock grown by some half units and a chip changed by some: how fast a law's demand changes with either is
//! measured at the law ([`condition`]); where growing changes what is in contact there is no bound, and the case is left
//! out and counted.

use crate::geometry::{self, Point, unit};
use arcfeed_law::{FeedDemand, FeedLaw, NoDemand, Place};
use arcfeed_tests::of_full_set;
use core::fmt::Debug;
use fastrand::Rng;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

mod controller;
mod plain_scenes;
mod scenes;

#[cfg(test)]
mod turning_points;

/// Half a unit in the last place of f32, relative.
const HALF_ULP: f64 = 1.0 / (1 << 24) as f64;
/// Half units that may add up along a law's formulas; the cosine rule at a round blank a twentieth of the tool takes 36.
const ROUNDINGS: f64 = 64.0;
/// Relative growth of a stock, and relative change of a chip, for the sensitivity of the demand.
const PROBE: f64 = 1e-5;
/// A condition above this is no basis for a bound.
const ILL: f64 = 1e4;
/// Change between places one ten-thousandth of the path apart that is looked into, and what is left after halving the way
/// between them until f32 sees no difference, that is a jump.
const STEEP: f64 = 0.05;
const JUMP: f64 = 0.02;
const PLACES: u32 = 64;

/// View of a scene: rotation and mirror image.
#[derive(Clone, Copy, Debug)]
struct View {
    /// The chip over the scene's own.
    chip: f64,
    /// x to -x, the sense of turn with it.
    mirrored: bool,
    /// Direction of the rotated x axis.
    turned: Point,
    /// All lengths over the scene's own, the chip's, too.
    scale: f64,
    /// By how much the stock is grown, over the lengths of the scene.
    grown: f64,
}

const PLAIN: View = View { chip: 1.0, mirrored: false, turned: [1.0, 0.0], scale: 1.0, grown: 0.0 };

/// A law with everything around it.
trait Scene: Clone + Debug {
    fn seen(&self, view: &View) -> Self;
    /// All its numbers, to be made weird.
    fn numbers(&mut self) -> Vec<&mut f64>;
    /// None where the numbers are refused when the law is prepared.
    fn law(&self) -> Option<Box<dyn FeedLaw>>;
    fn place(&self, ratio: f64) -> Place;
    /// Contacts, in f64; the demand may jump where they change.
    fn contacts(&self, _ratio: f64) -> Vec<usize> {
        Vec::new()
    }

    fn demand(&self, view: &View, ratio: f64) -> Result<f64, NoDemand> {
        let scene = self.seen(view);
        let demand = scene.law().expect("ordinary numbers").demand(&scene.place(ratio))?;
        Ok(f64::from(demand.path_mm_per_tooth))
    }
}

/// Counts of the checked cases of a suite.
#[derive(Debug, Default)]
struct Tally {
    demands: u32,
    refusals: u32,
    left_out: u32,
    jumps_at_contacts: u32,
    /// Largest difference of turned and scaled scenes, half units over the condition.
    half_units: f64,
}

fn in_bounds(demand: Result<FeedDemand, NoDemand>) -> Result<(), String> {
    match demand {
        Ok(FeedDemand { path_mm_per_tooth: path, .. }) if !(path > 0.0 && path.is_finite()) => {
            Err(format!("bounds: a demand of {path}"))
        }
        _ => Ok(()),
    }
}

/// Every property, `cases` times; of each that is broken the first case.
fn suite<S: Scene>(name: &str, seed: u64, cases: u32, make: impl Fn(&mut Rng) -> S) -> Result<Tally, String> {
    let (mut random, mut tally) = (Rng::with_seed(seed), Tally::default());
    let mut broken = BTreeMap::new();
    for case in 0..cases {
        let scene = make(&mut random);
        let ratio = random.f64();
        let checks = catch_unwind(AssertUnwindSafe(|| {
            [
                weird(&scene, &mut random),
                bounds(&scene, ratio),
                not_a_number(&scene, ratio),
                monotone(&scene, ratio, &mut random),
                uniform(&scene, ratio),
                mirror(&scene, ratio),
                turned_and_scaled(&scene, ratio, &mut random, &mut tally),
                if case % 4 == 0 { continuous(&scene, &mut tally) } else { Ok(()) },
            ]
        }));
        let failed = checks.map_or_else(
            |_| vec!["bounds: it panics".to_owned()],
            |checks| checks.into_iter().filter_map(Result::err).collect(),
        );
        for why in failed {
            let property = why.split(':').next().unwrap_or_default().to_owned();
            let first = || (0, format!("{why}: case {case} at {ratio} of {scene:?}"));
            broken.entry(property).or_insert_with(first).0 += 1;
        }
    }
    println!("{name}: seed {seed}, {cases} scenes, {tally:?}");
    if broken.is_empty() {
        return Ok(tally);
    }
    let lines = broken.values().map(|(count, first)| format!("{count} times broken, first {first}"));
    Err(format!("{name}, seed {seed}:\n{}", lines.collect::<Vec<_>>().join("\n")))
}

fn bounds<S: Scene>(scene: &S, ratio: f64) -> Result<(), String> {
    in_bounds(scene.law().ok_or("bounds: ordinary numbers are refused")?.demand(&scene.place(ratio)))
}

const SIZES: [f64; 15] =
    [0.0, 1e-45, 1e-38, 1e-20, 6e-8, 1e-3, 0.5, 0.8, 1.0, 100.0, 1e6, 1e20, 3.4e38, f64::INFINITY, f64::NAN];

fn weird_number(random: &mut Rng) -> f64 {
    let size = SIZES[random.usize(..SIZES.len())];
    if random.bool() { size } else { -size }
}

/// One to three numbers of the scene weird, or of the place, or of both.
fn weird<S: Scene>(scene: &S, random: &mut Rng) -> Result<(), String> {
    for _ in 0..16 {
        let (mut scene, what) = (scene.clone(), random.u8(..3));
        let place = scene.place(random.f64());
        let mut numbers = scene.numbers();
        for _ in 0..if what == 0 { 0 } else { random.usize(1..=3) } {
            let count = numbers.len();
            *numbers[random.usize(..count)] = weird_number(random);
        }
        let Some(law) = scene.law() else { continue };
        let mut place = if random.bool() { place } else { scene.place(random.f64()) };
        let Place { center_mm: [cx, cy], motion: [vx, vy], towards: [tx, ty], travelled_mm } = &mut place;
        let numbers = [cx, cy, vx, vy, tx, ty, travelled_mm];
        let chosen = random.usize(..14);
        for (i, number) in numbers.into_iter().enumerate() {
            if what != 1 && (i == chosen || random.u8(..8) == 0) {
                *number = weird_number(random) as f32;
            }
        }
        in_bounds(law.demand(&place))
            .map_err(|broken| format!("{broken} for weird numbers, {place:?} of {scene:?}"))?;
    }
    Ok(())
}

/// A law that does not use a number says what it says without; else NaN is refused by name.
fn not_a_number<S: Scene>(scene: &S, ratio: f64) -> Result<(), String> {
    let place = scene.place(ratio);
    let demand = |scene: &S| scene.law().map(|law| law.demand(&place).map(|demand| demand.path_mm_per_tooth));
    let plain = demand(scene);
    for i in 0..scene.clone().numbers().len() {
        let mut corrupted = scene.clone();
        *corrupted.numbers()[i] = f64::NAN;
        match demand(&corrupted) {
            None | Some(Err(NoDemand::BadInput)) => {}
            found if found == plain => {}
            found => return Err(format!("not a number: {found:?} where number {i} is none")),
        }
    }
    Ok(())
}

fn monotone<S: Scene>(scene: &S, ratio: f64, random: &mut Rng) -> Result<(), String> {
    let more = 1.0 + geometry::log_between(random, 1e-6, 1.0);
    let demand = |chip| scene.demand(&View { chip, ..PLAIN }, ratio);
    match (demand(1.0), demand(more)) {
        // Two roundings of the same demand.
        (Ok(less), Ok(bigger)) if bigger < less * (1.0 - 4.0 * HALF_ULP) => {
            Err(format!("monotony: {more} times the chip takes the demand from {less} to {bigger}"))
        }
        _ => Ok(()),
    }
}

/// A law that says so answers alike at every place.
fn uniform<S: Scene>(scene: &S, ratio: f64) -> Result<(), String> {
    let law = scene.law().ok_or("uniform: ordinary numbers are refused")?;
    let (here, at_start) = (law.demand(&scene.place(ratio)), law.demand(&scene.place(0.0)));
    if !law.is_uniform() || here == at_start { Ok(()) } else { Err(format!("uniform: {at_start:?} becomes {here:?}")) }
}

fn mirror<S: Scene>(scene: &S, ratio: f64) -> Result<(), String> {
    let (plain, mirrored) = (scene.demand(&PLAIN, ratio), scene.demand(&View { mirrored: true, ..PLAIN }, ratio));
    let same = match (plain, mirrored) {
        (Ok(one), Ok(other)) => libm::fabs(other / one - 1.0) <= 4.0 * HALF_ULP,
        (one, other) => one == other,
    };
    if same { Ok(()) } else { Err(format!("mirror: {plain:?} becomes {mirrored:?}")) }
}

/// Sensitivity of the demand to the stock and to the chip, at least 1; none where growth changes the contacts.
fn condition<S: Scene>(scene: &S, ratio: f64) -> Option<f64> {
    let demand = |view: &View| scene.demand(view, ratio).ok();
    let plain = demand(&PLAIN)?;
    let mut fastest = 0.0_f64;
    for probe in [-PROBE, PROBE] {
        let grown = demand(&View { grown: probe, ..PLAIN })?;
        let thicker = demand(&View { chip: 1.0 + probe, ..PLAIN })?;
        fastest = fastest.max(libm::fabs(grown / plain - 1.0) / PROBE + libm::fabs(thicker / plain - 1.0) / PROBE);
    }
    (fastest < ILL).then_some(1.0 + fastest)
}

fn turned_and_scaled<S: Scene>(scene: &S, ratio: f64, random: &mut Rng, tally: &mut Tally) -> Result<(), String> {
    let Ok(plain) = scene.demand(&PLAIN, ratio) else {
        tally.refusals += 1;
        return Ok(());
    };
    let Some(condition) = condition(scene, ratio) else {
        tally.left_out += 1;
        return Ok(());
    };
    tally.demands += 1;
    let turned = View { turned: unit(geometry::between(random, 0.0, core::f64::consts::TAU)), ..PLAIN };
    let larger = View { scale: 25.4, ..PLAIN };
    let smaller = View { scale: 1.0 / 25.4, ..PLAIN };
    for (what, view) in [("rotation", turned), ("scale", larger), ("scale", smaller)] {
        let found = scene.demand(&view, ratio).map(|demand| demand / view.scale);
        let error = found.map_or(f64::INFINITY, |found| libm::fabs(found / plain - 1.0));
        let half_units = error / HALF_ULP / condition;
        if half_units > ROUNDINGS {
            return Err(format!("{what}: {plain} becomes {found:?}, {half_units:.1} half units, seen as {view:?}"));
        }
        tally.half_units = tally.half_units.max(half_units);
    }
    Ok(())
}

fn continuous<S: Scene>(scene: &S, tally: &mut Tally) -> Result<(), String> {
    let law = scene.law().ok_or("bounds: ordinary numbers are refused")?;
    let demand = |ratio: f64| law.demand(&scene.place(ratio)).ok().map(|demand| f64::from(demand.path_mm_per_tooth));
    let apart = |one: Option<f64>, other: Option<f64>| match (one, other) {
        (Some(one), Some(other)) => libm::fabs(other - one) / one.min(other),
        _ => 0.0,
    };
    for i in 0..PLACES {
        let [mut low, mut high] = [i, i + 1].map(|i| f64::from(i) / f64::from(PLACES));
        if apart(demand(low), demand(high)) < STEEP {
            continue;
        }
        // Halves the way, always keeping the half with the larger change, down to what f32 resolves.
        for _ in 0..22 {
            let middle = (low + high) / 2.0;
            let in_first_half = apart(demand(low), demand(middle)) >= apart(demand(middle), demand(high));
            if in_first_half { high = middle } else { low = middle }
        }
        let left = apart(demand(low), demand(high));
        if left > JUMP {
            // Some contacts come and go again soon, some are too small for the samples at first.
            let same = |span: f64| scene.contacts(low - span) == scene.contacts(high + span);
            if (0..12).all(|i| same(1e-6 * libm::pow(2.0, f64::from(i)))) {
                return Err(format!("continuity: a jump by {left} between {low} and {high}"));
            }
            tally.jumps_at_contacts += 1;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::plain_scenes::{ContourScene, EngagementScene, TableScene};
    use super::scenes::{CircumferenceScene, EngagedTableScene};
    use super::*;
    use crate::geometry::RingScene;

    fn passes<S: Scene>(name: &str, cases: u32, make: impl Fn(&mut Rng) -> S) {
        let tally = suite(name, 4, cases, make).unwrap_or_else(|broken| panic!("{broken}"));
        assert!(tally.demands > cases / 5, "too few demands for a result: {tally:?}");
    }

    #[test]
    fn the_circumference_law_passes() {
        passes("circumference", of_full_set(100_000, 20_000), CircumferenceScene::sample);
    }

    #[test]
    fn the_engaged_arc_law_passes() {
        passes("engaged arc", of_full_set(60_000, 10_000), RingScene::sample);
    }

    #[test]
    fn the_engaged_arc_law_on_tables_passes() {
        passes("engaged arc, tables", of_full_set(60_000, 10_000), EngagedTableScene::sample);
    }

    #[test]
    fn the_contour_law_passes() {
        passes("contour", of_full_set(40_000, 10_000), ContourScene::sample);
    }

    #[test]
    fn the_engagement_law_passes() {
        passes("engagement", of_full_set(100_000, 20_000), EngagementScene::sample);
    }

    #[test]
    fn the_table_law_passes() {
        passes("table", 5_000, TableScene::sample);
    }

    /// The contact moves up to 90 degrees with a stock line along the motion, whose other end recedes.
    #[test]
    fn the_circumference_law_goes_on_up_to_90_degrees_of_contact_and_ends_there() {
        let mut random = Rng::with_seed(5);
        for _ in 0..1_000 {
            let mut scene = CircumferenceScene::sample(&mut random);
            scene.start_rad = 0.0;
            scene.normal = [-1.0, 0.0];
            let mut at = |degrees: f64| {
                scene.offset = geometry::dot(scene.normal, scene.contact_point(0.0, degrees.to_radians()));
                scene.demand(&PLAIN, 0.0)
            };
            let demands: Vec<f64> = (0..=1_000)
                .map(|i| at(89.0 + f64::from(i) * 0.000_999).expect("contacts below 90 degrees are admissible"))
                .collect();
            let steps = demands.windows(2).map(|pair| libm::fabs(pair[1] / pair[0] - 1.0));
            assert!(steps.fold(0.0, f64::max) < 2e-5, "{scene:?}");
            for beyond in [90.001, 90.1, 95.0, 120.0] {
                assert_eq!(at(beyond), Err(NoDemand::OutsideValidity), "{beyond}");
            }
        }
    }

    /// A law corrupted by `how`, which gets the demand and where it was asked for.
    #[derive(Clone)]
    struct Corrupted {
        scene: ContourScene,
        how: fn(&ContourScene, &Place, f32) -> f32,
    }

    impl Debug for Corrupted {
        fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
            self.scene.fmt(f)
        }
    }

    impl FeedLaw for Corrupted {
        fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand> {
            let demand = self.scene.law().expect("never refused").demand(place)?;
            Ok(FeedDemand { path_mm_per_tooth: (self.how)(&self.scene, place, demand.path_mm_per_tooth), ..demand })
        }

        fn is_uniform(&self) -> bool {
            true
        }
    }

    impl Scene for Corrupted {
        fn seen(&self, view: &View) -> Self {
            Corrupted { scene: self.scene.seen(view), ..*self }
        }
        fn numbers(&mut self) -> Vec<&mut f64> {
            self.scene.numbers()
        }
        fn law(&self) -> Option<Box<dyn FeedLaw>> {
            Some(Box::new(self.clone()))
        }
        fn place(&self, ratio: f64) -> Place {
            self.scene.place(ratio)
        }
    }

    #[test]
    fn a_bad_law_fails_at_the_property_it_breaks() {
        type How = fn(&ContourScene, &Place, f32) -> f32;
        let bad: [(&str, How); 7] = [
            ("bounds", |_, place, demand| if place.travelled_mm > 0.99 { f32::NAN } else { demand }),
            ("bounds", |_, place, demand| if place.travelled_mm > 0.99 { -demand } else { demand }),
            (
                "bounds: it panics",
                |_, place, demand| if place.travelled_mm.is_nan() { panic!("corrupted") } else { demand },
            ),
            ("monotony", |scene, _, demand| if scene.chip > 0.1 { 0.1 * demand } else { demand }),
            ("uniform", |_, place, demand| (1.0 + 1e-4 * place.travelled_mm) * demand),
            ("scale", |_, _, demand| demand + 0.000_1),
            ("continuity", |_, place, demand| if place.travelled_mm > 0.5 { 1.1 * demand } else { demand }),
        ];
        for (property, how) in bad {
            let make = |random: &mut Rng| Corrupted { scene: ContourScene::sample(random), how };
            let broken = suite("corrupted", 6, 2_000, make).expect_err("a corrupted law");
            println!("{property}: {}", broken.lines().count() - 1);
            assert!(broken.contains(&format!("first {property}")), "{property}: {broken}");
        }
    }

    /// The engaged-arc law that prefers left to right.
    #[derive(Clone, Debug)]
    struct Handed(RingScene);

    struct HandedLaw(Box<dyn FeedLaw>);

    impl FeedLaw for HandedLaw {
        fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand> {
            let demand = self.0.demand(place)?;
            let factor = if place.center_mm[0] > 0.0 { 1.001 } else { 1.0 };
            Ok(FeedDemand { path_mm_per_tooth: factor * demand.path_mm_per_tooth, ..demand })
        }
    }

    impl Scene for Handed {
        fn seen(&self, view: &View) -> Self {
            Handed(Scene::seen(&self.0, view))
        }
        fn numbers(&mut self) -> Vec<&mut f64> {
            self.0.numbers()
        }
        fn law(&self) -> Option<Box<dyn FeedLaw>> {
            Some(Box::new(HandedLaw(Scene::law(&self.0)?)))
        }
        fn place(&self, ratio: f64) -> Place {
            Scene::place(&self.0, ratio)
        }
    }

    #[test]
    fn a_law_with_a_preferred_hand_fails_in_the_mirror() {
        let broken = suite("handed", 7, 2_000, |random| Handed(RingScene::sample(random))).expect_err("a handed law");
        assert!(broken.contains("first mirror"), "{broken}");
    }
}
