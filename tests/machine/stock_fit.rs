//! The circumference law with a stock line, and the consistency check of Petean's table 5.4.
//!
//! *Table 5.4* prints the feed's range for each of the four movements, but neither spindle speed nor stock lines. With
//! n z = 10 000 teeth/min (assumed: 1000 rev/min, 10 active teeth) a printed feed is a step of the centre, hence a
//! contact: O' lies s = F/(n z) further along the arc, C on the circle about O with radius r0 + k a and on the one about
//! O' with radius r0 (eqs 17-24 backwards), and u points from O to C. The smaller feed belongs to the arc's start, the
//! larger one to its end; the line through both contacts is the fitted stock line. Two unknowns for two numbers: that
//! the lines exist checks consistency and validates nothing. Row 4's 40.0 in/min is n z a, the floor, and has no such
//! contact; 88 degrees is taken there.
//!
//! *The oracle* is a construction of its own in f64: the line's two intersections with the cutting circle, of the
//! admissible ones (0 < contact <= 90 degrees from the rotation centre towards the cutting side) the one with the
//! smaller step, and that step as the intersection of two circles. The direction is normalised first.
//!
//! *How far f32 may be off.* The line's distance from O is a difference of lengths up to rho and the line's distance
//! from A; an error e of it moves the contact by e/(r0 crossing) along the circle, where `crossing` is the sine of the
//! angle between line and circle, and that changes the step s = a/sin(contact) by cot(contact) of it: see
//! [`Contact::condition`].

use arcfeed_law::circumference::Circumference;
use arcfeed_law::{FeedDemand, FeedLaw, NoDemand, Place};
use arcfeed_model::stock::StockLine;
use arcfeed_model::tool::Edge;
use arcfeed_nc::modal::{Plane, Turn};
use arcfeed_nc::segment::Arc;
use arcfeed_units::{MM_PER_INCH, Mm, MmPerTooth, Nm};
use core::f64::consts::{FRAC_PI_2, TAU};
use fastrand::Rng;

/// R and r, inches (Petean 5.2).
const OUTER_IN: f64 = 5.06205;
const INNER_IN: f64 = 4.43706;
/// a, inches per tooth (Petean table 5.4).
const CHIP_IN: f64 = 0.004;
/// n z, assumed.
const TEETH_PER_MIN: f64 = 1e4;
/// The contact taken where the printed feed is the floor n z a.
const FLOOR_CONTACT_DEG: f64 = 88.0;
/// Resolution of the printed feeds, in/min.
const PRINTED: f64 = 0.1;

/// Half a unit in the last place of f32, relative.
const HALF_ULP: f64 = 1.0 / (1 << 24) as f64;
/// Half units that may add up along the law's formulas where nothing is magnified.
const ROUNDINGS: f64 = 4.0;
/// Above this `crossing` a line hits the circle firmly. At 10 degrees and this crossing the condition is about 200, the
/// largest error expected so some 1e-5; at a tangent there is no bound.
const FIRM: f64 = 0.1;
/// Limit for the sine or cosine of a contact, and for the depth of the line in the circle over r0. Closer to zero, the
/// rounded inputs may have another contact, or none.
const BRINK: f64 = 1e-5;

/// A movement of Petean's table 5.4 on its arc of the NC listing, inches.
struct Row {
    movement: u8,
    edge: Edge,
    turn: Turn,
    /// End of the block before, I and J, end of the block.
    start: [f64; 2],
    center_offset: [f64; 2],
    end: [f64; 2],
    /// Smallest and largest feed, in/min (table 5.4).
    feed: [f64; 2],
    /// Normal (degrees from +X) and offset (inches) of a stock line that gives these feeds. Rows 3 and 4 are what
    /// [`Row::fit`] gives. Row 1 is not: its feed is largest inside the arc, and this line puts 76.0 there and not at
    /// the end. Row 2 is the fit but for the rounding of the printed feeds.
    line: [f64; 2],
}

const ROWS: [Row; 4] = [
    Row {
        // NC listing N142, N144.
        movement: 1,
        edge: Edge::Outer,
        turn: Turn::Ccw,
        start: [-2.967, 11.3933],
        center_offset: [3.2165, -3.0564],
        end: [-3.6044, 10.5358],
        feed: [74.6, 76.0],
        line: [54.187, 4.2391],
    },
    Row {
        // N144, N146.
        movement: 2,
        edge: Edge::Outer,
        turn: Turn::Cw,
        start: [-3.6044, 10.5358],
        center_offset: [4.0397, -3.0504],
        end: [-2.5752, 11.5549],
        feed: [41.0, 48.0],
        line: [48.104, 10.4502],
    },
    Row {
        // N148, N150.
        movement: 3,
        edge: Edge::Inner,
        turn: Turn::Ccw,
        start: [-2.6598, 11.491],
        center_offset: [3.0951, -4.0056],
        end: [-3.6045, 10.5358],
        feed: [60.5, 62.0],
        line: [81.715, 10.7843],
    },
    Row {
        // N150, N152.
        movement: 4,
        edge: Edge::Inner,
        turn: Turn::Cw,
        start: [-3.6045, 10.5358],
        center_offset: [3.854, -2.1988],
        end: [-3.0241, 11.3322],
        feed: [40.0, 50.6],
        line: [97.563, 7.2959],
    },
];

/// An arc, the circle that cuts on it and the line where the stock ends.
#[derive(Clone, Copy, Debug)]
struct Scene {
    arc: Arc,
    edge: Edge,
    r0: f64,
    a: f64,
    stock: StockLine,
}

/// The moving frame: O, v and the direction from O to A.
struct Frame {
    position: [f64; 2],
    along: [f64; 2],
    towards: [f64; 2],
}

/// An admissible contact.
#[derive(Clone, Copy, Debug)]
struct Contact {
    path_mm: f64,
    angle: f64,
    crossing: f64,
    /// Lengths whose rounding moves the line against the circle, over r0.
    lengths: f64,
}

impl Contact {
    /// Relative error of the path due to rounding of each length, each component and each step of the formulas.
    fn condition(&self) -> f64 {
        let (sin, cos) = libm::sincos(self.angle);
        1.0 + 1.0 / sin + (1.0 + self.lengths / self.crossing) * cos / sin
    }
}

impl Frame {
    /// On the circle about O at `angle` from A towards the side of `side` along v.
    fn at(&self, radius: f64, side: f64, angle: f64) -> [f64; 2] {
        let (sin, cos) = libm::sincos(angle);
        [0, 1].map(|i| self.position[i] + radius * (side * sin * self.along[i] + cos * self.towards[i]))
    }
}

impl Scene {
    fn k(&self) -> f64 {
        f64::from(self.edge.advance())
    }

    fn law(&self, direction: [f32; 2]) -> Result<FeedDemand, NoDemand> {
        let (r0, a) = (Mm(self.r0 as f32), MmPerTooth(self.a as f32));
        let turn_ratio = f32::from(self.arc.turn.sign());
        let place = Place::on_arc(direction, turn_ratio, self.arc.radius_mm() as f32, 0.0);
        Circumference::for_arc(&self.arc, r0, self.edge, &self.stock, a).demand(&place)
    }

    fn frame(&self, direction: [f64; 2]) -> Frame {
        let [x, y] = direction.map(|x| x / libm::hypot(direction[0], direction[1]));
        let (rho, center) = (self.arc.radius_mm(), self.arc.center.map(Nm::to_mm));
        let along = if self.arc.turn == Turn::Ccw { [-y, x] } else { [y, -x] };
        Frame { position: [center[0] + rho * x, center[1] + rho * y], along, towards: [-x, -y] }
    }

    /// Both intersections of line and circle, as sine and cosine of the contact angle, and the half chord over r0.
    fn intersections(&self, frame: &Frame) -> Option<([[f64; 2]; 2], f64)> {
        let (normal, k) = (self.stock.normal, self.k());
        let distance = (self.stock.offset_mm - dot(normal, frame.position)) / self.r0;
        let crossing = libm::sqrt(1.0 - distance * distance);
        let contact = |half: f64| {
            let u = [distance * normal[0] - half * normal[1], distance * normal[1] + half * normal[0]];
            [k * dot(u, frame.along), dot(u, frame.towards)]
        };
        (crossing > 0.0).then(|| ([contact(crossing), contact(-crossing)], crossing))
    }

    fn oracle(&self, direction: [f64; 2]) -> Result<Contact, NoDemand> {
        let (contacts, crossing) = self.intersections(&self.frame(direction)).ok_or(NoDemand::NoContact)?;
        let line_from_center = self.stock.offset_mm - dot(self.stock.normal, self.arc.center.map(Nm::to_mm));
        let lengths = (self.arc.radius_mm() + libm::fabs(line_from_center)) / self.r0;
        let admissible = contacts.into_iter().filter(|[sin, cos]| *sin > 0.0 && *cos >= 0.0);
        let paths = admissible.map(|[sin, cos]| (self.path_mm(sin, cos), libm::atan2(sin, cos)));
        let (path, angle) =
            paths.min_by(|one, other| step(one.0).total_cmp(&step(other.0))).ok_or(NoDemand::OutsideValidity)?;
        Ok(Contact { path_mm: path.ok_or(NoDemand::ChipUnreachable)?, angle, crossing, lengths })
    }

    /// Petean eqs 17-23: rho alpha, the points where circle (A, rho) and circle (C, r0) meet at alpha = middle -+ spread.
    fn path_mm(&self, sin: f64, cos: f64) -> Option<f64> {
        let (rho, reach) = (self.arc.radius_mm(), self.r0 + self.k() * self.a);
        let (x, y) = (reach * self.k() * sin, rho - reach * cos);
        let distance = libm::hypot(x, y);
        let foot = (rho * rho - self.r0 * self.r0 + distance * distance) / (2.0 * distance);
        let half_squared = (rho - foot) * (rho + foot);
        let (middle, spread) = (libm::atan2(x, y), libm::atan2(libm::sqrt(half_squared), foot));
        (half_squared >= 0.0).then_some(rho * if middle > spread { middle - spread } else { middle + spread })
    }
}

fn radius_mm(edge: Edge) -> f64 {
    MM_PER_INCH * if edge == Edge::Outer { OUTER_IN } else { INNER_IN }
}

fn step(path: Option<f64>) -> f64 {
    path.unwrap_or(f64::INFINITY)
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Scene {
    /// The published tool on a random arc with one of the four movements; half of the stock lines run through a
    /// contact at 10 to 88 degrees from the middle of the arc, half anywhere near.
    fn sample(random: &mut Rng) -> Self {
        let mut between = |low: f64, high: f64| low + (high - low) * random.f64();
        let angles = [0; 2].map(|_| between(0.0, TAU));
        let center = [0; 2].map(|_| Nm::from_mm(between(-300.0, 300.0)));
        let (normal, offset_mm, contact) = (between(0.0, 360.0), between(-600.0, 600.0), between(10.0, 88.0));
        let edge = if random.bool() { Edge::Outer } else { Edge::Inner };
        let (r0, rho) = (radius_mm(edge), if random.bool() { OUTER_IN } else { INNER_IN } * MM_PER_INCH);
        let turn = if random.bool() { Turn::Ccw } else { Turn::Cw };
        let [from, to] = angles.map(|angle| [libm::cos(angle), libm::sin(angle)].map(|x| Nm::from_mm(rho * x)));
        let stock = StockLine::from_angle(normal, offset_mm);
        let arc = Arc { plane: Plane::Xy, turn, center, from, to };
        let scene = Scene { arc, edge, r0, a: CHIP_IN * MM_PER_INCH, stock };
        if random.bool() {
            return scene;
        }
        let point = scene.frame(arc.direction_at(0.5)).at(r0, scene.k(), contact.to_radians());
        Scene { stock: StockLine { offset_mm: dot(stock.normal, point), ..stock }, ..scene }
    }

    /// Whether rounding of the inputs decides the contact.
    fn is_on_the_brink(&self, direction: [f64; 2]) -> bool {
        let frame = self.frame(direction);
        let touch = libm::fabs(self.stock.offset_mm - dot(self.stock.normal, frame.position)) / self.r0 - 1.0;
        let Some(([one, other], _)) = self.intersections(&frame) else { return touch < BRINK };
        let twins = libm::fabs(one[0] - other[0]) < BRINK;
        twins || -touch < BRINK || [one, other].iter().flatten().any(|x| libm::fabs(*x) < BRINK)
    }
}

impl Row {
    fn scene(&self) -> Scene {
        let nm = |point: [f64; 2]| point.map(|inches| Nm::from_mm(inches * MM_PER_INCH));
        let ([from, offset, to], edge) = ([self.start, self.center_offset, self.end].map(nm), self.edge);
        let center = [0, 1].map(|i| Nm(from[i].0 + offset[i].0));
        let [from, to] = [from, to].map(|point| [0, 1].map(|i| Nm(point[i].0 - center[i].0)));
        let arc = Arc { plane: Plane::Xy, turn: self.turn, center, from, to };
        let stock = StockLine::from_angle(self.line[0], self.line[1] * MM_PER_INCH);
        Scene { arc, edge, r0: radius_mm(edge), a: CHIP_IN * MM_PER_INCH, stock }
    }

    /// The contact that asks for `feed` (in/min): from O, both O' and C are known.
    fn contact_angle(&self, feed: f64) -> f64 {
        let scene = self.scene();
        let reach = scene.r0 + scene.k() * scene.a;
        let half_turn = feed / TEETH_PER_MIN * MM_PER_INCH / scene.arc.radius_mm() / 2.0;
        let chord = 2.0 * scene.arc.radius_mm() * libm::sin(half_turn);
        let ahead = (reach * reach - scene.r0 * scene.r0 + chord * chord) / (2.0 * chord * reach);
        if libm::fabs(ahead) > 1.0 {
            return FLOOR_CONTACT_DEG.to_radians();
        }
        scene.k() * (FRAC_PI_2 - half_turn - libm::acos(ahead))
    }

    /// Normal (degrees) and offset (inches) of the line through the contacts at the arc's start and end.
    fn fit(&self, feed: [f64; 2]) -> [f64; 2] {
        let scene = self.scene();
        let [start, end] = [0, 1].map(|i| {
            let frame = scene.frame(scene.arc.direction_at([0.0, 1.0][i]));
            frame.at(scene.r0, scene.k(), self.contact_angle(feed[i]))
        });
        let (x, y) = (end[1] - start[1], start[0] - end[0]);
        let offset = dot([x, y], start) / libm::hypot(x, y) / MM_PER_INCH;
        let sign = if offset > 0.0 { 1.0 } else { -1.0 };
        [libm::atan2(sign * y, sign * x).to_degrees(), sign * offset]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn the_whole_law_finds_the_contact_and_the_step() {
        let mut random = Rng::with_seed(1);
        let (mut firm, mut touching, mut refused) = (Vec::new(), Vec::new(), BTreeMap::new());
        let (mut path_half_units, mut angle_half_units) = (0.0_f64, 0.0_f64);
        for _ in 0..200_000 {
            let scene = Scene::sample(&mut random);
            let direction = scene.arc.direction_at(0.5).map(|x| x as f32);
            let exact = direction.map(f64::from);
            match (scene.law(direction), scene.oracle(exact)) {
                _ if scene.is_on_the_brink(exact) => *refused.entry("on the brink".to_owned()).or_insert(0) += 1,
                (Ok(demand), Ok(truth)) => {
                    let angle_error = libm::fabs(f64::from(demand.contact_rad()) - truth.angle) / HALF_ULP;
                    angle_half_units = angle_half_units.max(angle_error / (2.0 + truth.lengths / truth.crossing));
                    if truth.angle < 10_f64.to_radians() {
                        continue;
                    }
                    let error = libm::fabs(f64::from(demand.path_mm_per_tooth) / truth.path_mm - 1.0);
                    path_half_units = path_half_units.max(error / HALF_ULP / truth.condition());
                    if truth.crossing < FIRM { &mut touching } else { &mut firm }.push(error);
                }
                (Err(found), Err(truth)) if found == truth => *refused.entry(format!("{found:?}")).or_insert(0) += 1,
                (found, truth) => panic!("{found:?}, should be {truth:?}: {scene:?}"),
            }
        }
        let [firm_largest, _] = [("line and circle cross firmly", &mut firm), ("line nearly a tangent", &mut touching)]
            .map(|(what, errors)| {
                errors.sort_by(f64::total_cmp);
                let (median, largest) = (errors[errors.len() / 2], errors[errors.len() - 1]);
                println!("{what}: {} cases, median {median:.1e}, largest {largest:.1e}", errors.len());
                largest
            });
        println!(
            "half units over the condition: path {path_half_units:.1}, contact {angle_half_units:.1}; no demand: {refused:?}"
        );
        assert!(firm_largest <= 2e-5 && firm[firm.len() / 2] <= 1e-7);
        assert!(path_half_units <= ROUNDINGS && angle_half_units <= ROUNDINGS);
    }

    #[test]
    fn a_contact_out_of_range_and_no_contact_are_distinguished() {
        let good = ROWS[0].scene();
        let direction = good.arc.direction_at(0.5).map(|x| x as f32);
        assert!(good.law(direction).is_ok());
        let frame = good.frame(good.arc.direction_at(0.5));
        let through = |angle: f64, normal: [f64; 2]| {
            let offset_mm = dot(normal, frame.at(good.r0, 1.0, angle));
            Scene { stock: StockLine { normal, offset_mm, rise_ratio: 0.0 }, ..good }.law(direction)
        };
        // A line through the circle at 100 and 170 degrees, one behind O, one that passes the circle by.
        let middle = frame.at(1.0, 1.0, 135_f64.to_radians());
        let normal = [0, 1].map(|i| middle[i] - frame.position[i]);
        assert_eq!(through(100_f64.to_radians(), normal), Err(NoDemand::OutsideValidity));
        assert_eq!(through((-80_f64).to_radians(), frame.along), Err(NoDemand::OutsideValidity));
        let far = StockLine { offset_mm: good.stock.offset_mm + 3.0 * good.r0, ..good.stock };
        assert_eq!(Scene { stock: far, ..good }.law(direction), Err(NoDemand::NoContact));
    }

    #[test]
    fn nonsense_is_refused_as_bad_input() {
        let good = ROWS[0].scene();
        let direction = good.arc.direction_at(0.5).map(|x| x as f32);
        let stock = |normal, offset_mm| Scene { stock: StockLine { normal, offset_mm, rise_ratio: 0.0 }, ..good };
        let arc = Arc { from: [Nm(0); 2], ..good.arc };
        let mut scenes = vec![Scene { arc, ..good }, stock([f64::NAN, 0.0], 100.0), stock([0.0, f64::NAN], 100.0)];
        scenes.push(stock([1.0, 0.0], f64::NAN));
        scenes.extend([f64::NAN, 0.0, -1.0].map(|r0| Scene { r0, ..good }));
        scenes.extend([f64::NAN, 0.0, -1.0].map(|a| Scene { a, ..good }));
        let wrong: Vec<String> = scenes
            .iter()
            .filter(|scene| scene.law(direction) != Err(NoDemand::BadInput))
            .map(|scene| format!("{:?} for {scene:?}", scene.law(direction)))
            .collect();
        assert!(wrong.is_empty(), "{wrong:#?}");
        assert_eq!(good.law([f32::NAN, 0.6]), Err(NoDemand::BadInput));
        assert_eq!(good.law([0.6, f32::NAN]), Err(NoDemand::BadInput));
    }

    #[test]
    fn whatever_the_numbers_a_demand_is_positive_and_finite_or_refused() {
        let sizes =
            [0.0, 1e-45, 1e-38, 1e-20, 6e-8, 1e-3, 0.6, 0.8, 1.0, 100.0, 1e6, 1e20, 3.4e38, f64::INFINITY, f64::NAN];
        let values: Vec<f64> = sizes.iter().flat_map(|size| [*size, -size]).collect();
        let pairs: Vec<[f64; 2]> = values.iter().flat_map(|x| values.iter().map(|y| [*x, *y])).collect();
        let (mut random, mut demands, mut wrong) = (Rng::with_seed(2), 0, Vec::new());
        for _ in 0..1_000_000 {
            let mut value = || values[random.usize(..values.len())];
            let (r0, a, normal, offset_mm) = (value(), value(), [value(), value()], value());
            let [from, center] = [[value(), value()], [value(), value()]].map(|point| point.map(Nm::from_mm));
            let direction = pairs[random.usize(..pairs.len())].map(|x| x as f32);
            let ordinary = Scene::sample(&mut random);
            let stock = StockLine { normal, offset_mm, rise_ratio: 0.0 };
            let weird = Arc { from, center, ..ordinary.arc };
            // One, two or three ordinary parts, or refusals would be all there is.
            let scene = match random.u8(..4) {
                0 => Scene { arc: weird, r0, a, stock, ..ordinary },
                1 => Scene { r0, a, ..ordinary },
                2 => Scene { stock, ..ordinary },
                _ => Scene { arc: weird, ..ordinary },
            };
            let Ok(demand) = scene.law(direction) else { continue };
            demands += 1;
            let (path, contact) = (demand.path_mm_per_tooth, demand.contact_rad());
            if !(path > 0.0 && path.is_finite() && (0.0..=FRAC_PI_2 as f32).contains(&contact)) {
                wrong.push((demand, direction, scene));
            }
        }
        println!("of the weird scenes {demands} have a demand, {} a wrong one", wrong.len());
        assert!(wrong.is_empty(), "{:#?}", wrong.iter().step_by(1 + wrong.len() / 4).collect::<Vec<_>>());
    }

    #[test]
    fn the_lines_reproduce_the_printed_feeds_over_the_whole_arc() {
        for row in &ROWS {
            let scene = row.scene();
            let mut feeds = [Vec::new(), Vec::new()];
            let mut contacts = Vec::new();
            for i in 0..=1_000 {
                let direction = scene.arc.direction_at(f64::from(i) / 1e3).map(|x| x as f32);
                let (demand, truth) = (scene.law(direction).unwrap(), scene.oracle(direction.map(f64::from)).unwrap());
                let paths = [f64::from(demand.path_mm_per_tooth), truth.path_mm];
                assert!(libm::fabs(paths[0] / paths[1] - 1.0) <= ROUNDINGS * HALF_ULP * truth.condition());
                for (feeds, path_mm) in feeds.iter_mut().zip(paths) {
                    feeds.push(path_mm / MM_PER_INCH * TEETH_PER_MIN);
                }
                contacts.push(truth.angle.to_degrees());
            }
            println!("movement {}: contact {:.1} to {:.1} deg", row.movement, contacts[0], contacts[1_000]);
            for (what, feeds) in ["law", "f64"].into_iter().zip(feeds) {
                let [low, high] = [f64::min, f64::max].map(|pick| feeds.iter().copied().reduce(pick).unwrap());
                println!("    {what}: {:.2} to {:.2}, least {low:.2}, most {high:.2} in/min", feeds[0], feeds[1_000]);
                assert!(libm::fabs(low - row.feed[0]) <= PRINTED && libm::fabs(high - row.feed[1]) <= PRINTED);
            }
        }
    }

    #[test]
    fn the_printed_feeds_determine_a_line_only_loosely() {
        for row in &ROWS {
            let [normal, offset] = row.fit(row.feed);
            println!("movement {}: fitted {normal:.3} deg, {offset:.4} in; used {:?}", row.movement, row.line);
            let stock = StockLine::from_angle(normal, offset * MM_PER_INCH);
            let fitted = Scene { stock, ..row.scene() };
            let feeds =
                (0..=1_000).map(|i| fitted.oracle(fitted.arc.direction_at(f64::from(i) / 1e3)).unwrap().path_mm);
            let most = feeds.reduce(f64::max).unwrap() / MM_PER_INCH * TEETH_PER_MIN;
            println!("    with the fitted line at most {most:.2} in/min");
            assert!(libm::fabs(most - row.feed[1]) <= PRINTED);
            let half = PRINTED / 2.0;
            let moved = [[-half, -half], [-half, half], [half, -half], [half, half]]
                .map(|[low, high]| row.fit([row.feed[0] + low, row.feed[1] + high]));
            let span = |i: usize| {
                let [low, high] =
                    [f64::min, f64::max].map(|pick| moved.iter().map(|line| line[i]).reduce(pick).unwrap());
                (low - [normal, offset][i], high - [normal, offset][i])
            };
            let ((normal_low, normal_high), (offset_low, offset_high)) = (span(0), span(1));
            println!(
                "    with feeds {half} in/min off: normal {normal_low:+.3} {normal_high:+.3} deg, offset {offset_low:+.4} {offset_high:+.4} in"
            );
            assert!((0.3..1.1).contains(&(normal_high - normal_low)) && offset_high - offset_low < 0.06);
        }
    }

    #[test]
    fn the_fit_regenerates_the_lines_of_movements_3_and_4() {
        for row in &ROWS[2..] {
            let [normal, offset] = row.fit(row.feed);
            assert!(libm::fabs(normal - row.line[0]) <= 0.000_5 && libm::fabs(offset - row.line[1]) <= 0.000_05);
        }
    }

    #[test]
    fn the_engaged_arc_lies_on_the_side_of_the_rotation_centre_only_with_the_right_normal() {
        for row in &ROWS {
            let scene = row.scene();
            let sides = [0.0, 1.0].map(|ratio| {
                let direction = scene.arc.direction_at(ratio);
                let (frame, contact) = (scene.frame(direction), scene.oracle(direction).unwrap());
                let (both, _) = scene.intersections(&frame).unwrap();
                let [one, other] = both.map(|[sin, cos]| libm::atan2(sin, cos).to_degrees());
                println!("movement {}: the line meets the circle at {one:.1} and {other:.1} deg", row.movement);
                scene.stock.distance_mm(frame.at(scene.r0, scene.k(), contact.angle - 1e-3)) > 0.0
            });
            let sign = if sides[0] { "n.p <= offset: normal as given" } else { "n.p >= offset: normal reversed" };
            println!("    on the side of A the material is {sign}");
            assert_eq!(sides, [row.movement != 1; 2]);
        }
    }
}
