//! The circumference law in f32 against a direct two-circle construction.
//!
//! The oracle solves Petean eqs 17-23 as geometry, in the frame with O at the origin, x along the centre's motion and
//! y towards A: after one tooth the edge shall pass through C = (r0 + k a) u, so O' lies on the circle about A with
//! radius rho and on the circle about C with radius r0. Of the two points the forward one with the smaller turn alpha
//! counts (eq. 24 leaves it open), and the path is rho alpha, the arc and not its chord (eq. 26). The construction is
//! written once, for any number type; f64 is checked against 50 digits, and whatever is ill-conditioned is judged by
//! 50 digits only.
//!
//! *Which problem a rounded direction poses.* A direction in f32 is no unit vector. Placing C literally by it would
//! move C by 6e-8 of r0, often more than the whole chip. What eq. 17 is about is how far O lies outside the circle
//! about C, the power C^2 - r0^2 = k a (2 r0 + k a). So the oracle takes the direction as it is and keeps that power:
//! the circle about C gets the squared radius r0^2 + (r0 + k a)^2 (|u|^2 - 1). For a unit vector that is r0^2, and the
//! difference that remains is the law's arithmetic alone. The error against the normalised direction, hence with the
//! rounding of the input, is measured beside it.
//!
//! *Which bound.* With p, h, w, D of the implementer's form, tau = w/(h + sqrt D): a relative error of p or w is
//! magnified by (1 - q)/(2 sqrt q (1 + sqrt q)), q = D/h^2, and that of p itself by its terms over their sum. [`Form`]
//! computes this factor; every case must stay below [`ROUNDINGS`] half units in the last place times it. The plain
//! limits are for clear cases (q and the cancellation of p both at least 0.05) and for the rest.

use arcfeed_firmware::law::circumference::{Circumference, Cut};
use arcfeed_firmware::law::{FeedLaw, NoWish, Wish};
use arcfeed_shared::cut::StockLine;
use arcfeed_shared::nc::modal::{Plane, Turn};
use arcfeed_shared::segment::Arc;
use arcfeed_shared::tool::Edge;
use arcfeed_shared::units::{Mm, MmPerTooth, Nm};
use core::f64::consts::{PI, TAU};
use core::ops::{Add, Div, Mul, Sub};
use dashu_float::FBig;
use dashu_float::ops::SquareRoot;
use dashu_float::round::mode::HalfEven;

/// Binary digits of the yardstick: 50 decimal ones and some to spare.
const BIG_BITS: usize = 176;
/// Below this D/h^2 the two solutions are about to merge and every rounding is magnified.
const GRAZING: f64 = 0.05;
/// Below this share p is a small difference of large terms.
const CANCELLING: f64 = 0.05;
/// Half a unit in the last place of f32, relative.
const HALF_ULP: f64 = 1.0 / (1 << 24) as f64;
/// Half units that may add up along the law's formula where nothing is magnified: some ten operations, of random sign.
const ROUNDINGS: f64 = 8.0;
/// The published tool, mm: R, r and the feed per tooth (Petean 5.2).
const PUBLISHED: [f64; 3] = [128.57607, 112.701324, 0.1016];

type Big = FBig<HalfEven, 2>;

/// What the construction needs of a number.
trait Real: Clone + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    fn of(x: f64) -> Self;
    fn root(&self) -> Self;
    fn angle(y: &Self, x: &Self) -> Self;
    fn near(&self) -> f64;
}

impl Real for f64 {
    fn of(x: f64) -> Self {
        x
    }
    fn root(&self) -> Self {
        libm::sqrt(*self)
    }
    fn angle(y: &Self, x: &Self) -> Self {
        libm::atan2(*y, *x)
    }
    fn near(&self) -> f64 {
        *self
    }
}

impl Real for Big {
    fn of(x: f64) -> Self {
        Big::try_from(x).expect("finite").with_precision(BIG_BITS).value()
    }
    fn root(&self) -> Self {
        self.sqrt()
    }
    fn angle(y: &Self, x: &Self) -> Self {
        y.atan2(x)
    }
    fn near(&self) -> f64 {
        self.to_f64().value()
    }
}

/// One tooth's step: circles, chip and contact direction.
#[derive(Clone, Copy, Debug)]
struct Step<T> {
    rho: T,
    r0: T,
    k: T,
    a: T,
    along: T,
    towards: T,
}

impl Step<f32> {
    fn exact<T: Real>(&self) -> Step<T> {
        let of = |x: f32| T::of(f64::from(x));
        let (along, towards) = (of(self.along), of(self.towards));
        Step { rho: of(self.rho), r0: of(self.r0), k: of(self.k), a: of(self.a), along, towards }
    }

    fn cut(&self) -> Cut {
        let edge = if self.k > 0.0 { Edge::Outer } else { Edge::Inner };
        Cut { path_radius: Mm(self.rho), edge_radius: Mm(self.r0), edge, feed_per_tooth: MmPerTooth(self.a) }
    }

    fn law(&self) -> Result<f64, NoWish> {
        self.cut().path_per_tooth(self.along, self.towards).map(|path| f64::from(path.0))
    }

    /// From METHODS' domain: r0 5-300 mm, rho 0.05-20 r0, a 0.001-1 mm, contact 2-178 degrees, either edge.
    fn sample(random: &mut Random) -> Self {
        let r0 = random.log_between(5.0, 300.0);
        let k = random.sign();
        let (sin, cos) = libm::sincos(random.between(2.0, 178.0).to_radians());
        let rho = r0 * random.log_between(0.05, 20.0);
        let a = random.log_between(1e-3, 1.0);
        let [rho, r0, k, a, along, towards] = [rho, r0, k, a, k * sin, cos].map(|x| x as f32);
        Step { rho, r0, k, a, along, towards }
    }
}

impl<T: Real> Step<T> {
    /// rho alpha by the two circles; None where they do not meet ahead of O.
    fn path(&self) -> Option<T> {
        let square = |x: &T| x.clone() * x.clone();
        let reach = self.r0.clone() + self.k.clone() * self.a.clone();
        let excess = square(&self.along) + square(&self.towards) - T::of(1.0);
        let edge_squared = square(&self.r0) + square(&reach) * excess;
        // C seen from A.
        let x = reach.clone() * self.along.clone();
        let y = reach * self.towards.clone() - self.rho.clone();
        let distance = (square(&x) + square(&y)).root();
        let foot = (square(&self.rho) - edge_squared + square(&distance)) / (T::of(2.0) * distance.clone());
        let half_squared = (self.rho.clone() - foot.clone()) * (self.rho.clone() + foot.clone());
        if half_squared < T::of(0.0) {
            return None;
        }
        let (half, ex, ey) = (half_squared.root(), x / distance.clone(), y / distance);
        let turn = |side: T| {
            let px = foot.clone() * ex.clone() - side.clone() * ey.clone();
            let py = foot.clone() * ey.clone() + side * ex.clone();
            T::angle(&px, &(T::of(0.0) - py))
        };
        let forward = |alpha: T| (alpha > T::of(0.0)).then(|| self.rho.clone() * alpha);
        let (one, other) = (forward(turn(half.clone())), forward(turn(T::of(0.0) - half)));
        match (one, other) {
            (Some(one), Some(other)) => Some(if one < other { one } else { other }),
            (one, other) => one.or(other),
        }
    }
}

/// How well conditioned the step is, by the implementer's form.
struct Form {
    /// q = D/h^2: 1 far from the limit, 0 where the chip is the thickest that can be reached, below: out of reach.
    reserve: f64,
    /// |p| over the sum of its terms.
    p_share: f64,
}

impl Form {
    fn of(step: &Step<f64>) -> Self {
        let reach = step.r0 + step.k * step.a;
        let w = step.a * (2.0 * step.r0 + step.k * step.a);
        let terms = [step.k, -step.k * reach * step.towards / step.rho, w / (4.0 * step.rho * step.rho)];
        let p: f64 = terms.iter().sum();
        let h = reach * step.k * step.along;
        let p_share = libm::fabs(p) / terms.map(libm::fabs).iter().sum::<f64>();
        Form { reserve: 1.0 - p * w / (h * h), p_share }
    }

    /// Relative error of the path for one of p, w and h.
    fn magnification(&self) -> f64 {
        let root = libm::sqrt(self.reserve);
        let merging = libm::fabs(1.0 - self.reserve) / (2.0 * root * (1.0 + root));
        1.0 + merging * (2.0 + 1.0 / self.p_share)
    }

    /// Whether rounding leaves no doubt on which side of D = 0 the step lies.
    fn is_decided(&self) -> bool {
        libm::fabs(self.reserve) > ROUNDINGS * HALF_ULP * (2.0 + 1.0 / self.p_share)
    }

    fn is_clear(&self) -> bool {
        self.reserve >= GRAZING && self.p_share >= CANCELLING
    }
}

impl Step<f64> {
    fn normalised(self) -> Self {
        let length = libm::hypot(self.along, self.towards);
        Step { along: self.along / length, towards: self.towards / length, ..self }
    }
}

/// Splitmix64.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        libm::exp(self.between(libm::log(low), libm::log(high)))
    }
    fn sign(&mut self) -> f64 {
        if self.bits() & 1 == 0 { 1.0 } else { -1.0 }
    }
}

/// Relative errors, and the case of the largest.
#[derive(Default)]
struct Errors {
    all: Vec<f64>,
    largest: f64,
    worst: String,
}

impl Errors {
    fn add(&mut self, found: f64, truth: f64, case: &dyn core::fmt::Debug) -> f64 {
        let error = libm::fabs(found / truth - 1.0);
        if error > self.largest {
            (self.largest, self.worst) = (error, format!("{case:?}"));
        }
        self.all.push(error);
        error
    }

    fn quantile(&mut self, share: f64) -> f64 {
        self.all.sort_by(f64::total_cmp);
        self.all.get((self.all.len() as f64 * share) as usize).copied().unwrap_or_default()
    }

    fn report(&mut self, what: &str) {
        let (count, median) = (self.all.len(), self.quantile(0.5));
        println!("{what}: {count} cases, median {median:.1e}, largest {:.1e}", self.largest);
        if count > 0 {
            println!("    largest at {}", self.worst);
        }
    }
}

/// What a campaign of [`Step`]s found.
#[derive(Default)]
struct Campaign {
    clear: Errors,
    cancelling: Errors,
    grazing: Errors,
    normalised: Errors,
    unreachable: u32,
    undecided: u32,
    /// Largest error, in half units in the last place times the case's magnification.
    roundings: f64,
}

impl Campaign {
    fn judge(&mut self, case: &Step<f32>) {
        let exact = case.exact::<f64>();
        let form = Form::of(&exact);
        let truth = if form.is_clear() { exact.path() } else { case.exact::<Big>().path().map(|path| path.near()) };
        match (case.law(), truth) {
            (Ok(found), Some(truth)) => self.measure(case, &form, found, truth),
            (Err(NoWish::ChipUnreachable), None) => self.unreachable += 1,
            (Ok(_) | Err(NoWish::ChipUnreachable), _) if !form.is_decided() => self.undecided += 1,
            (found, truth) => panic!("{found:?}, should be {truth:?}: {case:?}"),
        }
    }

    fn measure(&mut self, case: &Step<f32>, form: &Form, found: f64, truth: f64) {
        let zone = match form {
            form if form.is_clear() => &mut self.clear,
            form if form.reserve >= GRAZING => &mut self.cancelling,
            _ => &mut self.grazing,
        };
        let error = zone.add(found, truth, case);
        self.roundings = self.roundings.max(error / HALF_ULP / form.magnification());
        if form.is_clear() {
            self.normalised.add(found, case.exact::<f64>().normalised().path().unwrap_or_default(), case);
        }
    }

    fn report(&mut self, cases: u32) {
        self.clear.report("clear");
        self.normalised.report("clear, against the normalised direction");
        self.cancelling.report("p cancels");
        self.grazing.report("grazing");
        let share = 100.0 * f64::from(self.unreachable) / f64::from(cases);
        println!("out of reach: {} cases, {share:.2} %; undecided at D = 0: {}", self.unreachable, self.undecided);
        println!("at most {:.1} half units in the last place times the magnification", self.roundings);
    }
}

#[test]
fn the_law_in_f32_agrees_with_two_circles() {
    const CASES: u32 = 200_000;
    let (mut random, mut campaign) = (Random(1), Campaign::default());
    (0..CASES).for_each(|_| campaign.judge(&Step::sample(&mut random)));
    campaign.report(CASES);
    assert!(campaign.clear.largest <= 1e-6);
    assert!(campaign.normalised.largest <= 1e-6);
    assert!(campaign.cancelling.largest <= 2e-5);
    assert!(campaign.grazing.largest <= 2e-5);
    assert!(campaign.roundings <= ROUNDINGS);
    assert!((0.02..0.04).contains(&(f64::from(campaign.unreachable) / f64::from(CASES))));
}

#[test]
fn near_the_thickest_chip_the_error_stays_within_its_condition() {
    const CASES: u32 = 20_000;
    let (mut random, mut campaign) = (Random(2), Campaign::default());
    let mut left = CASES;
    while left > 0 {
        let case = Step::sample(&mut random);
        // The chip at which D is about zero, to first order in a/r0.
        let limit = case.r0 * case.along * case.along / (2.0 * case.k * (1.0 - case.r0 * case.towards / case.rho));
        let case = Step { a: limit * random.between(0.95, 1.02) as f32, ..case };
        if (1e-3..=1.0).contains(&case.a) {
            campaign.judge(&case);
            left -= 1;
        }
    }
    campaign.report(CASES);
    assert!(campaign.roundings <= ROUNDINGS);
    assert!(campaign.grazing.all.len() > 1_000 && campaign.unreachable > 1_000);
}

#[test]
fn the_oracle_in_f64_agrees_with_fifty_digits() {
    let mut random = Random(3);
    let mut clear = Errors::default();
    for case in core::iter::repeat_with(|| Step::sample(&mut random)).take(3_000) {
        let (exact, big) = (case.exact::<f64>(), case.exact::<Big>().path());
        match (exact.path(), big) {
            (Some(found), Some(truth)) if Form::of(&exact).is_clear() => {
                clear.add(found, truth.near(), &case);
            }
            (found, truth) => assert_eq!(found.is_some(), truth.is_some(), "{case:?}"),
        }
    }
    clear.report("f64 against 50 digits");
    assert!(clear.largest < HALF_ULP);
}

/// Petean eqs 17-26 in f32. Eq. 25 prints the coordinates of C, here they are those of O'; eq. 24's choice is the
/// forward point with the smaller turn.
fn published_route(step: &Step<f32>) -> [f32; 2] {
    let square = |x: f32| x * x;
    let reach = step.r0 + step.k * step.a;
    let (x1, y1, r1) = (0.0_f32, step.rho, step.rho);
    let (x2, y2, r2) = (reach * step.along, reach * step.towards, step.r0);
    let (dx, dy) = (x1 - x2, y1 - y2);
    let squared = square(dx) + square(dy);
    let root = libm::sqrtf(-(squared - square(r1 - r2)) * (squared - square(r1 + r2)));
    let point = |root: f32| {
        let x = -dx * (square(r1) - square(r2) - square(x1) + square(x2)) + (x1 + x2) * square(dy) + dy * root;
        let y = -dy * (square(r1) - square(r2) - square(y1) + square(y2)) + (y1 + y2) * square(dx) - dx * root;
        [x, y].map(|coordinate| coordinate / (2.0 * squared))
    };
    let chord = |[x, y]: [f32; 2]| libm::sqrtf(square(x) + square(y));
    let (one, other) = (point(root), point(-root));
    let s = if one[0] > 0.0 && (other[0] <= 0.0 || chord(one) < chord(other)) { chord(one) } else { chord(other) };
    [s, step.rho * libm::acosf(1.0 - s * s / (2.0 * step.rho * step.rho))]
}

/// Errors of the published route: of its chord and of its path.
fn published_errors(what: &str, mut sample: impl FnMut() -> Step<f32>) -> [Errors; 2] {
    let [mut chord, mut path] = [(); 2].map(|()| Errors::default());
    for case in core::iter::repeat_with(&mut sample).take(100_000) {
        let (Some(truth), rho) = (case.exact::<f64>().path(), f64::from(case.rho)) else { continue };
        let [chord_found, path_found] = published_route(&case).map(f64::from);
        chord.add(chord_found, 2.0 * rho * libm::sin(truth / (2.0 * rho)), &case);
        path.add(path_found, truth, &case);
    }
    chord.report(&format!("{what}, eqs 19-25"));
    path.report(&format!("{what}, with eq. 26"));
    println!("    90 % of the paths within {:.1e}", path.quantile(0.9));
    [chord, path]
}

#[test]
fn the_published_route_in_f32_is_thousands_of_times_worse() {
    let mut random = Random(4);
    let [_, mut path] = published_errors("published route, whole domain", || Step::sample(&mut random));
    let mut random = Random(5);
    let [outer, inner, a] = PUBLISHED.map(|x| x as f32);
    let [_, mut on_tool] = published_errors("published route, published tool", || {
        let (sin, cos) = libm::sincos(random.between(10.0, 88.0).to_radians());
        let rho = if random.sign() > 0.0 { outer } else { inner };
        let (k, r0) = if random.sign() > 0.0 { (1.0, outer) } else { (-1.0, inner) };
        Step { rho, r0, k, a, along: k * sin as f32, towards: cos as f32 }
    });
    for errors in [&mut path, &mut on_tool] {
        assert!(errors.quantile(0.5) > 1e-3);
    }
}

/// The law of one arc, with its own geometry in f64.
#[derive(Clone, Copy, Debug)]
struct Scene {
    arc: Arc,
    edge: Edge,
    r0: f32,
    stock: StockLine,
}

/// The admissible contact.
#[derive(Clone, Copy, Debug)]
struct Contact {
    path: f64,
    angle: f64,
    /// Half the chord the line cuts off the circle, over r0: 0 where the line only touches it.
    crossing: f64,
    magnification: f64,
}

/// The oracle's answer and how far it is from turning into another one.
type Answer = (Result<Contact, NoWish>, f64);

impl Scene {
    /// The published tool on a random arc with one of the four movements; half of the stock lines run through a
    /// contact at 10 to 88 degrees from the middle of the arc, half anywhere near.
    fn sample(random: &mut Random) -> Self {
        let [outer, inner, _] = PUBLISHED;
        let rho = if random.sign() > 0.0 { outer } else { inner };
        let (edge, k, r0) = if random.sign() > 0.0 { (Edge::Outer, 1.0, outer) } else { (Edge::Inner, -1.0, inner) };
        let turn = if random.sign() > 0.0 { Turn::Ccw } else { Turn::Cw };
        let point = |angle: f64| [libm::cos(angle), libm::sin(angle)].map(|x| Nm::from_mm(rho * x));
        let [from, to] = [0; 2].map(|_| point(random.between(-PI, PI)));
        let center = [0; 2].map(|_| Nm::from_mm(random.between(-300.0, 300.0)));
        let arc = Arc { plane: Plane::Xy, turn, center, from, to };
        let normal_deg = random.between(-180.0, 180.0);
        let stock = StockLine::from_angle(normal_deg, random.between(-600.0, 600.0));
        let scene = Scene { arc, edge, r0: r0 as f32, stock };
        if random.sign() > 0.0 {
            return scene;
        }
        let (position, along, towards) = scene.frame(arc.direction_at(0.5));
        let (sin, cos) = libm::sincos(random.between(10.0, 88.0).to_radians());
        let contact = [0, 1].map(|i| position[i] + r0 * (k * sin * along[i] + cos * towards[i]));
        Scene { stock: StockLine { offset_mm: dot(stock.normal, contact), ..stock }, ..scene }
    }

    fn law(&self, direction: [f32; 2]) -> Result<Wish, NoWish> {
        let a = MmPerTooth(PUBLISHED[2] as f32);
        Circumference::for_arc(&self.arc, Mm(self.r0), self.edge, &self.stock, a).wish(direction)
    }

    /// O, v and the direction from O to A.
    fn frame(&self, direction: [f64; 2]) -> ([f64; 2], [f64; 2], [f64; 2]) {
        let [x, y] = direction.map(|x| x / libm::hypot(direction[0], direction[1]));
        let rho = self.arc.radius_mm();
        let [cx, cy] = self.arc.center.map(Nm::to_mm);
        let along = if self.arc.turn == Turn::Ccw { [-y, x] } else { [y, -x] };
        ([cx + rho * x, cy + rho * y], along, [-x, -y])
    }

    fn answer(&self, direction: [f32; 2]) -> Answer {
        let (position, along, towards) = self.frame(direction.map(f64::from));
        let normal = self.stock.normal;
        let (r0, k) = (f64::from(self.r0), f64::from(self.edge.advance()));
        let distance = self.stock.offset_mm - dot(normal, position);
        let mut margin = libm::fabs(libm::fabs(distance) / r0 - 1.0);
        if libm::fabs(distance) > r0 {
            return (Err(NoWish::NoContact), margin);
        }
        let half = libm::sqrt(r0 * r0 - distance * distance);
        let contacts = [half, -half].map(|half| {
            let u = [distance * normal[0] - half * normal[1], distance * normal[1] + half * normal[0]].map(|x| x / r0);
            let (sin, cos) = (k * dot(u, along), dot(u, towards));
            margin = margin.min(libm::fabs(sin)).min(libm::fabs(cos));
            (sin > 0.0 && cos >= 0.0).then(|| self.contact(k * sin, cos, half))
        });
        let paths = contacts.map(|contact| contact.flatten().map_or(f64::INFINITY, |contact| contact.path));
        if paths[0].is_finite() && paths[1].is_finite() {
            margin = margin.min(libm::fabs(paths[0] / paths[1] - 1.0));
        }
        let thicker = if paths[0] < paths[1] { contacts[0].or(contacts[1]) } else { contacts[1].or(contacts[0]) };
        let outcome = thicker.ok_or(NoWish::OutsideValidity).and_then(|c| c.ok_or(NoWish::ChipUnreachable));
        (outcome, margin)
    }

    fn contact(&self, along: f64, towards: f64, half: f64) -> Option<Contact> {
        let (rho, r0, k) = (self.arc.radius_mm(), f64::from(self.r0), f64::from(self.edge.advance()));
        let step = Step { rho, r0, k, a: f64::from(PUBLISHED[2] as f32), along, towards };
        let (path, angle, crossing) = (step.path()?, libm::atan2(k * along, towards), libm::fabs(half) / r0);
        Some(Contact { path, angle, crossing, magnification: Form::of(&step).magnification() })
    }

    /// The line hit's share of the error: an error of the line's distance, which is a difference of lengths up to
    /// rho and the line's distance from A, moves the contact along the circle by 1/crossing of it.
    fn lever(&self, contact: &Contact) -> f64 {
        let line = self.stock.offset_mm - dot(self.stock.normal, self.arc.center.map(Nm::to_mm));
        1.0 + (self.arc.radius_mm() + libm::fabs(line)) / (f64::from(self.r0) * contact.crossing)
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[test]
fn the_whole_law_finds_the_contact_and_the_step() {
    let mut random = Random(6);
    let (mut firm, mut touching, mut flat) = (Errors::default(), Errors::default(), Errors::default());
    let (mut roundings, mut angle_roundings, mut skipped) = (0.0_f64, 0.0_f64, 0);
    let (mut worst_angle, mut counts) = (0.0_f64, std::collections::BTreeMap::new());
    for _ in 0..200_000 {
        let scene = Scene::sample(&mut random);
        let direction = scene.arc.direction_at(0.5).map(|x| x as f32);
        match (scene.law(direction), scene.answer(direction)) {
            (_, (_, margin)) if margin < 1e-5 => skipped += 1,
            (Ok(wish), (Ok(truth), _)) => {
                let (lever, sin) = (scene.lever(&truth), libm::sin(truth.angle));
                let condition = truth.magnification * (1.0 + 1.0 / sin + lever * libm::cos(truth.angle) / sin);
                let zone = if truth.angle < 10_f64.to_radians() {
                    &mut flat
                } else if truth.crossing < 0.1 {
                    &mut touching
                } else {
                    &mut firm
                };
                let error = zone.add(f64::from(wish.path_mm_per_tooth), truth.path, &(scene, truth));
                let r = error / HALF_ULP / condition;
                if r > roundings {
                    roundings = r;
                    println!("R {r} {error:e} {truth:?} lever {lever}");
                }
                let ae = libm::fabs(f64::from(wish.contact_rad) - truth.angle);
                angle_roundings = angle_roundings.max(ae / HALF_ULP / (1.0 + lever));
                worst_angle = worst_angle.max(ae);
            }
            (Err(found), (Err(truth), _)) if found == truth => *counts.entry(format!("{found:?}")).or_insert(0) += 1,
            (found, truth) => println!("{found:?}, should be {truth:?}: {scene:?}"),
        }
    }
    firm.report("firm");
    touching.report("touching");
    flat.report("flat");
    println!("{roundings} {angle_roundings} {worst_angle} skipped {skipped} {counts:?}");
}

const A_CUT: Cut =
    Cut { path_radius: Mm(112.7), edge_radius: Mm(128.6), edge: Edge::Outer, feed_per_tooth: MmPerTooth(0.1) };

#[test]
fn a_step_from_nonsense_is_refused_as_bad_input() {
    for bad in [f32::NAN, 0.0, -0.0, -1.0, f32::NEG_INFINITY] {
        for edge in [Edge::Outer, Edge::Inner] {
            let good = Cut { edge, ..A_CUT };
            let along = 0.6 * f32::from(edge.advance());
            let cuts = [
                Cut { path_radius: Mm(bad), ..good },
                Cut { edge_radius: Mm(bad), ..good },
                Cut { feed_per_tooth: MmPerTooth(bad), ..good },
            ];
            for cut in cuts {
                assert_eq!(cut.path_per_tooth(along, 0.8), Err(NoWish::BadInput), "{cut:?}");
            }
            assert!(good.path_per_tooth(along, 0.8).is_ok());
            assert_eq!(good.path_per_tooth(f32::NAN, 0.8), Err(NoWish::BadInput));
            assert_eq!(good.path_per_tooth(along, f32::NAN), Err(NoWish::BadInput));
        }
    }
}

#[test]
fn a_receding_edge_and_a_chip_beyond_reach_are_told_apart() {
    let inner = Cut { edge: Edge::Inner, ..A_CUT };
    for (cut, along) in [(A_CUT, -0.6), (A_CUT, 0.0), (inner, 0.6), (inner, 0.0)] {
        assert_eq!(cut.path_per_tooth(along, 0.8), Err(NoWish::OutsideValidity));
    }
    // At 3 degrees behind the tool no step of the outer edge reaches 1 mm deeper.
    let (sin, cos) = libm::sincosf(3_f32.to_radians());
    let thick = Cut { feed_per_tooth: MmPerTooth(1.0), ..A_CUT };
    assert_eq!(thick.path_per_tooth(sin, -cos), Err(NoWish::ChipUnreachable));
    for a in [128.6, 128.7, 200.0, 257.2, 300.0, 1e6, f32::MAX, f32::INFINITY] {
        for cut in [A_CUT, inner] {
            let cut = Cut { feed_per_tooth: MmPerTooth(a), ..cut };
            println!("a {a} {:?} {:?}", cut.edge, cut.path_per_tooth(0.6 * f32::from(cut.edge.advance()), 0.8));
        }
    }
}
