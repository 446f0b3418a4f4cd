//! The circumference law in f32 against a direct two-circle construction.
//!
//! The oracle solves Petean eqs 17-23 as geometry, in the frame with O at the origin, x along the centre's motion and
//! y towards A: after one tooth the edge shall pass through C = (r0 + k a) u, so O' lies on the circle about A with
//! radius rho and on the circle about C with radius r0. Of the two points the forward one with the smaller turn alpha
//! counts (eq. 24 leaves it open), and the path is rho alpha, the arc and not its chord (eq. 26). It is written once
//! for any number type: f64 is checked against 50 digits, and whatever is ill-conditioned is judged by 50 digits only.
//!
//! *Which problem a rounded direction poses.* A direction in f32 is no unit vector. Placing C literally by it would
//! move C by 6e-8 of r0, often more than the whole chip. What eq. 17 is about is how far O lies outside the circle
//! about C: the power C^2 - r0^2 = k a (2 r0 + k a). So the oracle takes the direction as it is and keeps that power:
//! the circle about C gets the squared radius r0^2 + (r0 + k a)^2 (|u|^2 - 1). For a unit vector that is r0^2, and the
//! difference that remains is the law's arithmetic alone. The error against the normalised direction, hence with the
//! rounding of the input, is measured beside it.
//!
//! *Which bound.* With p, h, w, D of the implementer's form, tau = w/(h + sqrt D): a relative error of p or w is
//! magnified by (1 - q)/(2 sqrt q (1 + sqrt q)), q = D/h^2, and that of p itself by its terms over their sum. [`Form`]
//! computes this factor; no case may exceed it by more than [`ROUNDINGS`] half units in the last place. The plain
//! limits are for three zones: clear, p cancels, grazing.
//!
//! The law with its stock line is measured in `stock_fit`.

use arcfeed_law::NoDemand;
use arcfeed_law::step::Cut;
use arcfeed_model::tool::Edge;
use arcfeed_units::{Mm, MmPerTooth};
use core::iter::repeat_with;
use core::ops::{Add, Div, Mul, Sub};
use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use fastrand::Rng;

/// Binary digits of the yardstick: 50 decimal ones and some to spare.
const BIG_BITS: usize = 176;
/// Below this q the two solutions are about to merge and every rounding is magnified.
const GRAZING: f64 = 0.05;
/// Below this share of its terms p is a small difference of large numbers.
const CANCELLING: f64 = 0.05;
/// Half a unit in the last place of f32, relative.
const HALF_ULP: f64 = 1.0 / (1 << 24) as f64;
/// Half units that may add up where nothing is magnified: some ten operations, of random sign.
const ROUNDINGS: f64 = 8.0;
/// The published tool, mm: R, r and the feed per tooth (Petean 5.2).
const PUBLISHED: [f64; 3] = [128.57607, 112.701324, 0.1016];

type Big = FBig<HalfEven, 2>;

/// Operations on numbers that the construction needs.
trait Real: Clone + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    fn of(x: f64) -> Self;
    fn root(self) -> Self;
    fn angle(y: Self, x: Self) -> Self;
}

impl Real for f64 {
    fn of(x: f64) -> Self {
        x
    }
    fn root(self) -> Self {
        libm::sqrt(self)
    }
    fn angle(y: Self, x: Self) -> Self {
        libm::atan2(y, x)
    }
}

impl Real for Big {
    fn of(x: f64) -> Self {
        Big::try_from(x).expect("finite").with_precision(BIG_BITS).value()
    }
    fn root(self) -> Self {
        self.sqrt()
    }
    fn angle(y: Self, x: Self) -> Self {
        y.atan2(&x)
    }
}

/// One tooth's step: circles, chip and contact direction, in numbers that are exact in f32.
#[derive(Clone, Copy, Debug)]
struct Step {
    rho: f64,
    r0: f64,
    k: f64,
    a: f64,
    along: f64,
    towards: f64,
}

impl Step {
    fn rounded(self) -> Self {
        let [rho, r0, k, a] = [self.rho, self.r0, self.k, self.a].map(|x| f64::from(x as f32));
        let [along, towards] = [self.along, self.towards].map(|x| f64::from(x as f32));
        Step { rho, r0, k, a, along, towards }
    }

    /// From METHODS' domain: r0 5-300 mm, rho 0.05-20 r0, a 0.001-1 mm, contact 2-178 degrees, either edge.
    fn sample(random: &mut Rng) -> Self {
        let (r0, k) = (log_between(random, 5.0, 300.0), if random.bool() { 1.0 } else { -1.0 });
        let (sin, cos) = libm::sincos(between(random, 2.0, 178.0).to_radians());
        let (rho, a) = (r0 * log_between(random, 0.05, 20.0), log_between(random, 1e-3, 1.0));
        Step { rho, r0, k, a, along: k * sin, towards: cos }.rounded()
    }

    /// One of the four movements of the published tool, contact 10-88 degrees.
    fn sample_on_published_tool(random: &mut Rng) -> Self {
        let [outer, inner, a] = PUBLISHED;
        let (sin, cos) = libm::sincos(between(random, 10.0, 88.0).to_radians());
        let rho = if random.bool() { outer } else { inner };
        let (k, r0) = if random.bool() { (1.0, outer) } else { (-1.0, inner) };
        Step { rho, r0, k, a, along: k * sin, towards: cos }.rounded()
    }

    fn law(&self) -> Result<f64, NoDemand> {
        let edge = if self.k > 0.0 { Edge::Outer } else { Edge::Inner };
        let [rho, r0, a] = [self.rho, self.r0, self.a].map(|x| x as f32);
        let cut = Cut { path_radius: Mm(rho), edge_radius: Mm(r0), edge, feed_per_tooth: MmPerTooth(a) };
        cut.path_per_tooth(self.along as f32, self.towards as f32).map(|path| f64::from(path.0))
    }

    /// rho alpha by the two circles; None where they do not meet. Needs an advancing edge.
    fn path<T: Real>(&self) -> Option<T> {
        let square = |x: &T| x.clone() * x.clone();
        let [rho, r0, k, a] = [self.rho, self.r0, self.k, self.a].map(T::of);
        let [along, towards] = [self.along, self.towards].map(T::of);
        let reach = r0.clone() + k * a;
        let excess = square(&along) + square(&towards) - T::of(1.0);
        let edge_squared = square(&r0) + square(&reach) * excess;
        // C as seen from A, with the way from O to A downwards.
        let (x, y) = (reach.clone() * along, rho.clone() - reach * towards);
        let distance = (square(&x) + square(&y)).root();
        let foot = (square(&rho) - edge_squared + square(&distance)) / (T::of(2.0) * distance);
        let half_squared = (rho.clone() - foot.clone()) * (rho.clone() + foot.clone());
        if half_squared < T::of(0.0) {
            return None;
        }
        // The two points lie at `middle` -+ `spread` from O; one of them ahead, if only one the latter.
        let (middle, spread) = (T::angle(x, y), T::angle(half_squared.root(), foot));
        Some(rho * if middle > spread { middle - spread } else { middle + spread })
    }

    fn normalised(&self) -> Self {
        let length = libm::hypot(self.along, self.towards);
        Step { along: self.along / length, towards: self.towards / length, ..*self }
    }
}

/// Condition of a step, by the implementer's formula.
struct Form {
    /// q = D/h^2: 1 far from the limit, 0 at the thickest chip that can be reached, less beyond.
    q: f64,
    /// |p| over the sum of its terms.
    p_share: f64,
}

impl Form {
    fn of(step: &Step) -> Self {
        let reach = step.r0 + step.k * step.a;
        let w = step.a * (2.0 * step.r0 + step.k * step.a);
        let terms = [step.k, -step.k * reach * step.towards / step.rho, w / (4.0 * step.rho * step.rho)];
        let p: f64 = terms.iter().sum();
        let h = reach * step.k * step.along;
        let p_share = libm::fabs(p) / terms.map(libm::fabs).iter().sum::<f64>();
        Form { q: 1.0 - p * w / (h * h), p_share }
    }

    fn magnification(&self) -> f64 {
        let root = libm::sqrt(self.q);
        1.0 + libm::fabs(1.0 - self.q) / (2.0 * root * (1.0 + root)) * (2.0 + 1.0 / self.p_share)
    }

    /// Whether the side of D = 0 is certain in spite of rounding.
    fn is_decided(&self) -> bool {
        libm::fabs(self.q) > ROUNDINGS * HALF_ULP * (2.0 + 1.0 / self.p_share)
    }

    fn is_clear(&self) -> bool {
        self.q >= GRAZING && self.p_share >= CANCELLING
    }
}

fn between(random: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.f64()
}

fn log_between(random: &mut Rng, low: f64, high: f64) -> f64 {
    libm::exp(between(random, libm::log(low), libm::log(high)))
}

/// Relative errors, and the case of the largest.
#[derive(Default)]
struct Errors {
    all: Vec<f64>,
    largest: f64,
    worst: Option<Step>,
}

impl Errors {
    fn add(&mut self, found: f64, truth: f64, case: &Step) -> f64 {
        let error = libm::fabs(found / truth - 1.0);
        if error > self.largest {
            (self.largest, self.worst) = (error, Some(*case));
        }
        self.all.push(error);
        error
    }

    fn report(&mut self, what: &str) -> f64 {
        self.all.sort_by(f64::total_cmp);
        let median = self.all.get(self.all.len() / 2).copied().unwrap_or_default();
        println!("{what}: {} cases, median {median:.1e}, largest {:.1e}", self.all.len(), self.largest);
        println!("    largest at {:?}", self.worst);
        median
    }
}

/// Findings for a set of steps.
#[derive(Default)]
struct Verdict {
    clear: Errors,
    cancelling: Errors,
    grazing: Errors,
    normalised: Errors,
    unreachable_ratio: f64,
    undecided: u32,
    /// Largest error over the case's magnification, half units in the last place.
    roundings: f64,
}

fn judge(cases: u32, sample: impl FnMut() -> Step) -> Verdict {
    let mut verdict = Verdict::default();
    for case in repeat_with(sample).take(cases as usize) {
        let form = Form::of(&case);
        let truth =
            if form.is_clear() { case.path::<f64>() } else { case.path::<Big>().map(|path| path.to_f64().value()) };
        match (case.law(), truth) {
            (Ok(found), Some(truth)) => verdict.measure(&case, &form, [found, truth]),
            (Err(NoDemand::ChipUnreachable), None) => verdict.unreachable_ratio += 1.0 / f64::from(cases),
            (Ok(_) | Err(NoDemand::ChipUnreachable), _) if !form.is_decided() => verdict.undecided += 1,
            (found, truth) => panic!("{found:?}, should be {truth:?}: {case:?}"),
        }
    }
    verdict.clear.report("clear");
    verdict.normalised.report("clear, against the normalised direction");
    verdict.cancelling.report("p cancels");
    verdict.grazing.report("grazing");
    let (share, undecided) = (100.0 * verdict.unreachable_ratio, verdict.undecided);
    println!("out of reach {share:.2} %, undecided {undecided}, half units at most {:.1}", verdict.roundings);
    verdict
}

impl Verdict {
    fn measure(&mut self, case: &Step, form: &Form, [found, truth]: [f64; 2]) {
        let zone = match form {
            form if form.q < GRAZING => &mut self.grazing,
            form if form.is_clear() => &mut self.clear,
            _ => &mut self.cancelling,
        };
        self.roundings = self.roundings.max(zone.add(found, truth, case) / HALF_ULP / form.magnification());
        if form.is_clear() {
            self.normalised.add(found, case.normalised().path().expect("clear of D = 0"), case);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_law_in_f32_agrees_with_two_circles() {
        let mut random = Rng::with_seed(1);
        let verdict = judge(200_000, || Step::sample(&mut random));
        assert!(verdict.clear.largest <= 1e-6 && verdict.normalised.largest <= 1e-6);
        // Seldom, some cases in a million, a cancelling p costs a digit.
        assert!(verdict.cancelling.largest <= 4e-6 && verdict.grazing.largest <= 2e-5);
        assert!(verdict.roundings <= ROUNDINGS);
        assert!((0.02..0.04).contains(&verdict.unreachable_ratio));
    }

    #[test]
    fn near_the_thickest_chip_the_error_stays_within_its_condition() {
        let mut random = Rng::with_seed(2);
        // The chip at which D is about zero, to first order in a/r0, give or take.
        let mut candidates = repeat_with(|| {
            let case = Step::sample(&mut random);
            let limit = case.r0 * case.along * case.along / (2.0 * case.k * (1.0 - case.r0 * case.towards / case.rho));
            Step { a: limit * between(&mut random, 0.95, 1.02), ..case }.rounded()
        });
        let verdict = judge(20_000, || candidates.find(|case| (1e-3..=1.0).contains(&case.a)).expect("endless"));
        assert!(verdict.roundings <= ROUNDINGS);
        assert!(verdict.grazing.all.len() > 5_000 && verdict.unreachable_ratio > 0.2);
    }

    #[test]
    fn the_oracle_in_f64_agrees_with_fifty_digits() {
        let (mut random, mut errors) = (Rng::with_seed(3), Errors::default());
        for case in repeat_with(|| Step::sample(&mut random)).take(3_000).filter(|case| Form::of(case).is_clear()) {
            let truth = case.path::<Big>().expect("clear of D = 0").to_f64().value();
            errors.add(case.path().expect("clear of D = 0"), truth, &case);
        }
        errors.report("f64 against 50 digits");
        assert!(errors.largest < HALF_ULP);
    }

    /// Petean eqs 17-26 in f32: chord and path. Eq. 25 prints the coordinates of C, here they are those of O'; eq. 24's
    /// choice is the forward point with the smaller turn.
    fn published_route(step: &Step) -> [f64; 2] {
        let square = |x: f32| x * x;
        let [rho, r0, reach] = [step.rho, step.r0, step.r0 + step.k * step.a].map(|x| x as f32);
        let (x1, y1, r1) = (0.0_f32, rho, rho);
        let (x2, y2, r2) = (reach * step.along as f32, reach * step.towards as f32, r0);
        let (dx, dy) = (x1 - x2, y1 - y2);
        let squared = square(dx) + square(dy);
        let root = libm::sqrtf(-(squared - square(r1 - r2)) * (squared - square(r1 + r2))); // (23)
        let [one, other] = [root, -root].map(|root| {
            let x = -dx * (square(r1) - square(r2) - square(x1) + square(x2)) + (x1 + x2) * square(dy) + dy * root;
            let y = -dy * (square(r1) - square(r2) - square(y1) + square(y2)) + (y1 + y2) * square(dx) - dx * root;
            let [x, y] = [x, y].map(|coordinate| coordinate / (2.0 * squared)); // (19) to (22)
            (x > 0.0, libm::sqrtf(square(x) + square(y))) // (25)
        });
        let s = if one.0 && !(other.0 && other.1 < one.1) { one.1 } else { other.1 }; // (24)
        [s, rho * libm::acosf(1.0 - s * s / (2.0 * rho * rho))].map(f64::from) // (26)
    }

    #[test]
    fn the_published_route_in_f32_is_thousands_of_times_worse() {
        for (what, sample) in
            [("whole domain", Step::sample as fn(&mut Rng) -> Step), ("published tool", Step::sample_on_published_tool)]
        {
            let (mut random, mut chords, mut paths) = (Rng::with_seed(4), Errors::default(), Errors::default());
            for case in repeat_with(|| sample(&mut random)).take(100_000) {
                let Some(truth) = case.path::<f64>() else { continue };
                let [chord, path] = published_route(&case);
                chords.add(chord, 2.0 * case.rho * libm::sin(truth / (2.0 * case.rho)), &case);
                paths.add(path, truth, &case);
            }
            chords.report(&format!("published route on the {what}, chord (eqs 19-25)"));
            assert!(paths.report(&format!("published route on the {what}, path (eq. 26)")) > 1e-3);
        }
    }

    const RING: Step = Step { rho: 112.7, r0: 128.6, k: 1.0, a: 0.1, along: 0.6, towards: 0.8 };

    #[test]
    fn a_step_from_nonsense_is_refused_as_bad_input() {
        for good in [RING, Step { k: -1.0, along: -0.6, ..RING }] {
            assert!(good.law().is_ok());
            for bad in [f64::NAN, 0.0, -0.0, -1.0, f64::NEG_INFINITY] {
                for case in [Step { rho: bad, ..good }, Step { r0: bad, ..good }, Step { a: bad, ..good }] {
                    assert_eq!(case.law(), Err(NoDemand::BadInput), "{case:?}");
                }
            }
            assert_eq!(Step { along: f64::NAN, ..good }.law(), Err(NoDemand::BadInput));
            assert_eq!(Step { towards: f64::NAN, ..good }.law(), Err(NoDemand::BadInput));
        }
    }

    #[test]
    fn an_edge_that_does_not_advance_is_outside_the_laws_validity() {
        for (k, along) in [(1.0, -0.6), (1.0, 0.0), (1.0, -0.0), (-1.0, 0.6), (-1.0, 0.0), (-1.0, -0.0)] {
            assert_eq!(Step { k, along, ..RING }.law(), Err(NoDemand::OutsideValidity));
        }
    }

    #[test]
    fn no_chip_is_thick_enough_to_turn_a_receding_inner_edge_into_an_advancing_one() {
        for a in [0.9, 1.1, 1.5, 1.9, 2.1, 10.0].map(|ratio| ratio * RING.r0) {
            let case = Step { k: -1.0, along: 0.6, a, ..RING }.rounded();
            assert!(case.law().is_err(), "{:?}: {case:?}", case.law());
        }
    }

    #[test]
    fn a_chip_too_thick_for_any_step_is_out_of_reach() {
        let (sin, cos) = libm::sincos(177_f64.to_radians());
        let at_the_back = Step { a: 1.0, along: sin, towards: cos, ..RING }.rounded();
        for case in [at_the_back, Step { a: 200.0, ..RING }.rounded(), Step { a: 1e6, ..RING }.rounded()] {
            assert_eq!(case.path::<Big>(), None);
            assert_eq!(case.law(), Err(NoDemand::ChipUnreachable), "{case:?}");
        }
    }

    #[test]
    fn whatever_the_numbers_a_step_is_positive_and_finite_or_refused() {
        let (tiny, huge) = (f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX));
        let sizes = [0.0, 1e-45, tiny, 1e-20, 6e-8, 1e-3, 0.5, 1.0, 100.0, 1e6, 1e20, huge, f64::INFINITY, f64::NAN];
        let values: Vec<f64> = sizes.iter().flat_map(|size| [*size, -size]).collect();
        let (mut demands, mut wrong) = (0, Vec::new());
        for (rho, r0, a) in sizes.iter().flat_map(|x| sizes.iter().flat_map(move |y| sizes.map(|z| (*x, *y, z)))) {
            for (along, towards) in values.iter().flat_map(|x| values.iter().map(|y| (*x, *y))) {
                for k in [1.0, -1.0] {
                    let case = Step { rho, r0, k, a, along, towards };
                    let Ok(path) = case.law() else { continue };
                    demands += 1;
                    if !(path > 0.0 && path.is_finite()) {
                        wrong.push((path, case));
                    }
                }
            }
        }
        println!("of the weird steps {demands} have a demand, {} a wrong one", wrong.len());
        assert!(wrong.is_empty(), "{:#?}", wrong.iter().step_by(1 + wrong.len() / 8).collect::<Vec<_>>());
    }
}
