//! Published numbers of the contour and the engagement law, and the engagement in corners by brute force.
//!
//! *Corner factors*: Sandvik Coromant, knowledge pages, milling, programming: the feed in an inside corner of 90 degrees
//! over that on the straight, by Dc/rad_m (tool diameter over contour radius) and ae/Dc.
//!
//! *Edge feed*: worked examples of public calculator pages.
//!
//! *Brute force*: a tool walks along wall, fillet and wall. A direction of its circle is engaged where the point is
//! material before the pass (nearer to the contour than ae) and no earlier position of the tool has reached it. The
//! engagement is the sum of the engaged angles, the corner's the largest on the way.

use arcfeed_law::contour::{Contour, ContourLimits};
use arcfeed_law::engagement::corner_factor;
use arcfeed_law::{FeedLaw, NoDemand, Place};
use arcfeed_model::cut::ContourSide;
use arcfeed_units::{Mm, MmPerTooth};
use core::f64::consts::{PI, TAU};

/// ae/Dc of the columns.
const DEPTHS: [f64; 10] = [0.05, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95];
/// Dc/rad_m and the factors.
const PUBLISHED: [(f64, [f64; 10]); 5] = [
    (2.00, [0.22, 0.34, 0.40, 0.45, 0.48, 0.53, 0.60, 0.67, 0.75, 0.86]),
    (1.60, [0.44, 0.42, 0.44, 0.49, 0.53, 0.56, 0.60, 0.67, 0.75, 0.86]),
    (1.20, [0.63, 0.64, 0.64, 0.62, 0.62, 0.65, 0.63, 0.71, 0.75, 0.86]),
    (0.80, [0.78, 0.79, 0.79, 0.80, 0.82, 0.83, 0.85, 0.87, 0.89, 0.94]),
    (0.40, [0.90, 0.90, 0.91, 0.92, 0.92, 0.93, 0.94, 0.95, 0.96, 0.98]),
];
/// Dc/rad_m and ae/Dc of the cells known as probable misprints.
const MISPRINTS: [(f64, f64); 4] = [(1.60, 0.25), (1.20, 0.35), (1.20, 0.45), (1.20, 0.65)];
/// Half a printed digit and what the last digit may have been rounded the other way.
const CELL: f64 = 0.010_1;

/// Feed at the edge, diameters of tool and feature, side, feed at the centre as printed.
const EXAMPLES: [(f64, f64, f64, ContourSide, &str); 4] = [
    (20.0, 0.5, 1.0, ContourSide::Inside, "10"),
    (40.0, 1.0, 8.0, ContourSide::Inside, "35.0"),
    (8.3, 0.370, 0.562, ContourSide::Inside, "2.8"),
    (8.3, 0.370, 0.562, ContourSide::Outside, "13.8"),
];

/// Tool radius of the factors; they are ratios.
const TOOL: f64 = 10.0;
/// Directions of the circle, places on each part of the path.
const DIRECTIONS: usize = 360;
const PLACES: usize = 48;
/// Relative error of the largest engagement between two steps of the walk.
const WALK: f64 = 1e-4;

type Point = [f64; 2];

fn law(depth: f64, dc_over_contour: f64, turn_rad: f64) -> Result<f64, NoDemand> {
    let (radius, depth) = (2.0 * TOOL / dc_over_contour, 2.0 * TOOL * depth);
    corner_factor(Mm(TOOL as f32), Mm(depth as f32), Mm(radius as f32), turn_rad as f32).map(f64::from)
}

fn unit(angle: f64) -> Point {
    let (sin, cos) = libm::sincos(angle);
    [cos, sin]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// An inside corner about the origin, which is the fillet's centre. The tool comes along the lower wall in +x, turns left
/// by `turn` and goes on along the other wall.
#[derive(Clone, Copy, Debug)]
struct Corner {
    contour_radius: f64,
    depth: f64,
    turn: f64,
}

/// A place on the path: on the first line by the way left, on the arc by the angle, on the second line by the way gone.
#[derive(Clone, Copy, Debug)]
enum At {
    Before(f64),
    On(f64),
    After(f64),
}

impl Corner {
    fn path_radius(&self) -> f64 {
        self.contour_radius - TOOL
    }

    /// Directions from the fillet's centre to where it begins and ends.
    fn limits(&self) -> [Point; 2] {
        [unit(-PI / 2.0), unit(self.turn - PI / 2.0)]
    }

    /// Angle of a point's direction from the centre, measured into the fillet's sector.
    fn angle(&self, point: Point) -> f64 {
        (libm::atan2(point[1], point[0]) + PI / 2.0).rem_euclid(TAU)
    }

    /// Distance of a point from the contour; negative beyond it.
    fn contour_distance(&self, point: Point) -> f64 {
        let walls = self.limits().map(|normal| self.contour_radius - dot(point, normal));
        let fillet = self.contour_radius - libm::hypot(point[0], point[1]);
        let wall = walls[0].min(walls[1]);
        if self.angle(point) <= self.turn { wall.min(fillet) } else { wall }
    }

    fn center(&self, at: At) -> Point {
        let (q, [first, last]) = (self.path_radius(), self.limits());
        match at {
            At::Before(left) => [q * first[0] - left, q * first[1]],
            At::On(angle) => unit(angle - PI / 2.0).map(|x| q * x),
            At::After(gone) => [q * last[0] - gone * last[1], q * last[1] + gone * last[0]],
        }
    }

    /// Distance of a point from the path as far as the tool has come.
    fn path_distance(&self, point: Point, at: At) -> f64 {
        let (q, [first, last]) = (self.path_radius(), self.limits());
        let line = |normal: Point, from: f64, to: f64| {
            let along = [-normal[1], normal[0]];
            let nearest = dot(point, along).clamp(from, to);
            libm::hypot(dot(point, along) - nearest, dot(point, normal) - q)
        };
        let before = line(first, f64::NEG_INFINITY, if let At::Before(left) = at { -left } else { 0.0 });
        let swept = match at {
            At::Before(_) => return before,
            At::On(angle) => angle,
            At::After(_) => self.turn,
        };
        // If the point's own direction is not in the sector, an end of the arc is nearest.
        let on_arc = if self.angle(point) <= swept {
            libm::fabs(libm::hypot(point[0], point[1]) - q)
        } else {
            let to = |angle: f64| {
                let [x, y] = self.center(At::On(angle));
                libm::hypot(point[0] - x, point[1] - y)
            };
            to(0.0).min(to(swept))
        };
        let after = if let At::After(gone) = at { line(last, 0.0, gone) } else { f64::INFINITY };
        before.min(on_arc).min(after)
    }

    /// Engaged angle at a place.
    fn engagement(&self, at: At) -> f64 {
        let center = self.center(at);
        let is_engaged = |angle: f64| {
            let u = unit(angle);
            let point = [center[0] + TOOL * u[0], center[1] + TOOL * u[1]];
            let distance = self.contour_distance(point);
            // The tool touches the contour, and its own circle is as far from its centre as the tool is wide.
            (-1e-6..self.depth).contains(&distance) && self.path_distance(point, at) >= TOOL - 1e-9
        };
        let angle = |i: usize| TAU * (i as f64 + 0.5) / DIRECTIONS as f64;
        let engaged: Vec<bool> = (0..DIRECTIONS).map(|i| is_engaged(angle(i))).collect();
        let mut sum = 0.0;
        for i in 0..DIRECTIONS {
            let (here, next) = (engaged[i], engaged[(i + 1) % DIRECTIONS]);
            let (mut low, mut high) = (angle(i), angle(i) + TAU / DIRECTIONS as f64);
            for _ in 0..if here == next { 0 } else { 40 } {
                let middle = (low + high) / 2.0;
                if is_engaged(middle) == here { low = middle } else { high = middle }
            }
            sum += match (here, next) {
                (true, true) => TAU / DIRECTIONS as f64,
                (true, false) => low - angle(i),
                (false, true) => angle(i) + TAU / DIRECTIONS as f64 - high,
                (false, false) => 0.0,
            };
        }
        sum
    }

    /// Straight engagement over the largest on the way.
    fn factor(&self) -> f64 {
        let part = |i: usize| i as f64 / PLACES as f64;
        // With the other wall, at a flat angle to this one, out of reach.
        let far = 1e3 * TOOL;
        let before = (0..PLACES).map(|i| At::Before(TOOL * part(i)));
        let on = (0..=PLACES).map(|i| At::On(self.turn * part(i)));
        let after = (0..PLACES).map(|i| At::After(TOOL * part(i)));
        let largest = before.chain(on).chain(after).map(|at| self.engagement(at)).fold(0.0, f64::max);
        self.engagement(At::Before(far)) / largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_tests::shared_or_skip;

    #[test]
    fn of_the_fifty_published_corner_factors_46_are_met_and_the_others_are_the_known_misprints() {
        let mut missed = Vec::new();
        let mut largest = 0.0_f64;
        for (ratio, factors) in PUBLISHED {
            let found = DEPTHS.map(|depth| law(depth, ratio, PI / 2.0).expect("a tool that fits"));
            println!("Dc/rad_m {ratio:.2}: {found:.3?}");
            for ((depth, printed), found) in DEPTHS.into_iter().zip(factors).zip(found) {
                if libm::fabs(found - printed) > CELL {
                    println!(
                        "    ae/Dc {depth}: printed {printed}, geometry {found:.4}, differ by {:+.4}",
                        printed - found
                    );
                    missed.push((ratio, depth));
                } else {
                    largest = largest.max(libm::fabs(found - printed));
                }
            }
        }
        println!("{} of 50 within {CELL}, the largest difference of them {largest:.4}", 50 - missed.len());
        assert_eq!(missed, MISPRINTS);
    }

    #[test]
    fn the_contour_law_gives_the_worked_examples_to_the_printed_digit() {
        let free = ContourLimits { inside_only: false, floor_ratio: 0.0 };
        let place = Place::on_arc([1.0, 0.0], 1.0, 1.0, 0.0);
        for (feed, tool, feature, side, printed) in EXAMPLES {
            let q = if side == ContourSide::Inside { (feature - tool) / 2.0 } else { (feature + tool) / 2.0 };
            let law = Contour::new(Mm(q as f32), Mm((tool / 2.0) as f32), side, MmPerTooth(feed as f32), free);
            let found = law.demand(&place).expect("the tool fits").path_mm_per_tooth;
            let digits = printed.split_once('.').map_or(0, |(_, digits)| digits.len());
            println!("{feed} at the edge of {tool} in {feature}, {side:?}: {found}, printed {printed}");
            assert_eq!(format!("{found:.digits$}"), printed);
        }
    }

    #[test]
    fn contour_and_engagement_law_are_two_quantities() {
        let limits = ContourLimits { inside_only: true, floor_ratio: 0.0 };
        let place = Place::on_arc([1.0, 0.0], 1.0, 1.0, 0.0);
        let radius = 2.0 * TOOL / 0.8;
        let law_of_contour =
            Contour::new(Mm((radius - TOOL) as f32), Mm(TOOL as f32), ContourSide::Inside, MmPerTooth(1.0), limits);
        let contour = law_of_contour.demand(&place).expect("the tool fits").path_mm_per_tooth;
        let engagement = DEPTHS.map(|depth| law(depth, 0.8, PI / 2.0).expect("the tool fits"));
        println!("Dc/rad_m = 0.8: contour {contour}, engagement {engagement:.3?}");
        assert!(libm::fabs(f64::from(contour) - 0.6) < 1e-6);
        assert!(
            engagement.is_sorted()
                && libm::fabs(engagement[0] - 0.78) < CELL
                && libm::fabs(engagement[9] - 0.94) < CELL
        );
    }

    #[test]
    fn walking_through_the_corner_meets_the_closed_form() {
        // The second class has no previous pass with a fillet of its own: the offset walls meet at a point.
        let mut classes = [("ae < rad_m", Vec::new()), ("ae >= rad_m", Vec::new())];
        for turn_deg in [5.0_f64, 15.0, 30.0, 60.0, 90.0, 120.0, 150.0] {
            for ratio in [2.0, 1.8, 1.6, 1.4, 1.2, 1.0, 0.8, 0.6, 0.4, 0.2] {
                for depth in DEPTHS {
                    let turn = turn_deg.to_radians();
                    let corner = Corner { contour_radius: 2.0 * TOOL / ratio, depth: 2.0 * TOOL * depth, turn };
                    let (found, truth) = (law(depth, ratio, turn).expect("a tool that fits"), corner.factor());
                    let case =
                        format!("{turn_deg} deg, Dc/rad_m {ratio}, ae/Dc {depth}: {found:.5}, walked {truth:.5}");
                    let class = usize::from(corner.depth >= corner.contour_radius);
                    classes[class].1.push((libm::fabs(found / truth - 1.0), case));
                }
            }
        }
        for (name, cases) in &mut classes {
            cases.sort_by(|one, other| one.0.total_cmp(&other.0));
            let ((median, _), (largest, worst)) = (&cases[cases.len() / 2], &cases[cases.len() - 1]);
            println!("{name}: {} corners, median {median:.1e}, largest {largest:.1e} at {worst}", cases.len());
            assert!(*largest < WALK, "{worst}");
        }
    }

    #[test]
    fn the_numbers_here_are_those_of_the_shared_files() {
        let Some(path) = shared_or_skip("data/corner-engagement-factors.csv", "published_factors") else { return };
        let lines = |path| std::fs::read_to_string(path).expect("the file can be read");
        let text = lines(path);
        let numbers = |line: &str| line.split(',').map(|cell| cell.parse().expect("a number")).collect::<Vec<f64>>();
        let rows: Vec<Vec<f64>> =
            text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).map(numbers).collect();
        let carried = PUBLISHED.map(|(ratio, factors)| [vec![ratio], factors.to_vec()].concat());
        assert_eq!(rows, carried);
        let Some(path) = shared_or_skip("data/edge-feed-examples.csv", "published_factors") else { return };
        let carried = EXAMPLES.map(|(feed, tool, feature, side, printed)| {
            (vec![feed, tool, feature], format!("{side:?}").to_lowercase(), printed.to_owned())
        });
        let text = lines(path);
        let rows: Vec<_> = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).collect();
        let read = |line: &&str| {
            let cells: Vec<&str> = line.split(',').collect();
            (numbers(&cells[..3].join(",")), cells[3].to_owned(), cells[4].to_owned())
        };
        assert_eq!(rows.iter().map(read).collect::<Vec<_>>(), carried);
    }
}
