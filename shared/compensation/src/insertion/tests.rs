//! Inserted corners against closed forms and the conditions that define them.

use arcfeed_nc::alarm::Alarm;
use arcfeed_nc::motion::{Feed, Pose};
use arcfeed_units::Nm;

use super::*;
use crate::vector::in_plane;

type Points = [[f64; 2]; 2];

fn pose([x, y]: [f64; 2]) -> Pose {
    Pose { linear: [Nm::from_mm(x), Nm::from_mm(y), Nm(0)], ..Pose::ORIGIN }
}

fn line([from, to]: Points) -> Segment {
    let feed = Feed::PerMinute(Nm::from_mm(100.0));
    Segment { sequence: None, start: pose(from), end: pose(to), feed, path: Path::Line }
}

fn arc([from, to]: Points, center: [f64; 2], turn: Turn) -> Segment {
    let of = |point: [f64; 2]| minus(point, center).map(Nm::from_mm);
    let arc = Arc { plane: Plane::Xy, turn, center: center.map(Nm::from_mm), from: of(from), to: of(to) };
    Segment { path: Path::Arc(arc), ..line([from, to]) }
}

fn insert(first: &Segment, second: &Segment, corner: Corner) -> Result<InsertedCorner, Alarm> {
    InsertedCorner::new(first, second, Plane::Xy, corner)
}

fn point(pose: &Pose) -> Vector {
    in_plane(pose, Plane::Xy).map(Nm::to_mm)
}

/// A sequence of numbers in [0, 1).
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 53) as f64
}

#[test]
fn between_two_lines_a_corner_begins_at_the_length_of_the_closed_form() {
    let (mut seed, mut worst) = (1, 0.0_f64);
    for _ in 0..500 {
        let [first, turned] = [
            random(&mut seed) * 6.3,
            (0.05 + 2.9 * random(&mut seed)) * if random(&mut seed) < 0.5 { -1.0 } else { 1.0 },
        ];
        let direction = |angle: f64| [libm::cos(angle), libm::sin(angle)];
        let (t1, t2) = (direction(first), direction(first + turned));
        let size = Nm::from_mm(0.1 + 3.0 * random(&mut seed)).to_mm();
        let reach = size * libm::tan(turned.abs() / 2.0);
        let corner = [7.0, -3.0];
        let [a, b] =
            [line([minus(corner, scaled(t1, 300.0)), corner]), line([corner, plus(corner, scaled(t2, 300.0))])];
        for (kind, reach) in [(Corner::Rounding(Nm::from_mm(size)), reach), (Corner::Chamfer(Nm::from_mm(size)), size)]
        {
            let found = insert(&a, &b, kind).unwrap();
            let wanted = [minus(corner, scaled(t1, reach)), plus(corner, scaled(t2, reach))];
            for (point, wanted) in [point(&found.first.end), point(&found.second.start)].into_iter().zip(wanted) {
                worst = worst.max(length(minus(point, wanted)));
            }
            let between = found.between.unwrap();
            assert_eq!((between.start, between.end), (found.first.end, found.second.start));
            if let (Path::Arc(arc), Corner::Rounding(_)) = (&between.path, kind) {
                // The arc turns as far as the path, to the same side.
                assert!((arc.sweep_rad() - turned.abs()).abs() < 1e-5 / size, "{arc:?}");
                assert_eq!(arc.turn.sign() > 0, turned > 0.0);
                worst = worst.max((arc.radius_mm() - size).abs());
            }
        }
    }
    println!("1000 corners between lines: worst {worst:e} mm");
    assert!(worst < 3e-6, "{worst}");
}

/// Worst violation of the conditions of a rounding: both ends on their paths, the directions there continued by the arc.
fn violation(first: &Segment, second: &Segment, found: &InsertedCorner, size: f64) -> f64 {
    let Some(Segment { path: Path::Arc(rounding), start, end, .. }) = &found.between else { panic!("{found:?}") };
    let center = rounding.center.map(Nm::to_mm);
    let mut worst = (rounding.radius_mm() - size).abs();
    for (path, at) in [(first, point(start)), (second, point(end))] {
        let radial = minus(at, center);
        let along = scaled(to_left(unit(radial)), f64::from(rounding.turn.sign()));
        let (off, tangent) = match &path.path {
            Path::Arc(arc) => {
                let from_center = minus(at, arc.center.map(Nm::to_mm));
                let tangent = scaled(to_left(unit(from_center)), f64::from(arc.turn.sign()));
                (length(from_center) - arc.radius_mm(), tangent)
            }
            _ => {
                let tangent = unit(minus(point(&path.end), point(&path.start)));
                (cross(minus(at, point(&path.start)), tangent), tangent)
            }
        };
        assert!(dot(along, tangent) > 0.0, "the arc runs with the path");
        // An error of the direction, as a length at the radius.
        worst = worst.max(off.abs()).max(cross(along, tangent).abs() * size);
    }
    worst
}

#[test]
fn roundings_with_arcs_touch_both_paths() {
    let (mut seed, mut worst, mut count, mut refused) = (5, 0.0_f64, [0_u32; 3], 0);
    for case in 0..900 {
        let mut arm = |is_first: bool, is_arc: bool| {
            let angle = random(&mut seed) * 6.3;
            let t = [libm::cos(angle), libm::sin(angle)];
            if !is_arc {
                return line(if is_first { [scaled(t, -60.0), [0.0; 2]] } else { [[0.0; 2], scaled(t, 60.0)] });
            }
            let (radius, turn) =
                (10.0 + 30.0 * random(&mut seed), if random(&mut seed) < 0.5 { Turn::Cw } else { Turn::Ccw });
            let center = scaled(to_left(t), f64::from(turn.sign()) * radius);
            let swept = 2.0 * f64::from(turn.sign()) * if is_first { -1.0 } else { 1.0 };
            let (sin, cos) = libm::sincos(swept);
            let [x, y] = scaled(center, -1.0);
            let far = plus(center, [cos * x - sin * y, sin * x + cos * y]);
            arc(if is_first { [far, [0.0; 2]] } else { [[0.0; 2], far] }, center, turn)
        };
        let kind = case % 3;
        let (first, second) = (arm(true, kind != 0), arm(false, kind != 1));
        let size = 0.2 + 4.0 * (case as f64 / 900.0);
        match insert(&first, &second, Corner::Rounding(Nm::from_mm(size))) {
            Ok(found) if found.between.is_some() => {
                count[kind] += 1;
                worst = worst.max(violation(&first, &second, &found, size));
                let shorter = |whole: &Segment, part: &Segment| part.length_mm() < whole.length_mm();
                assert!(shorter(&first, &found.first) && shorter(&second, &found.second), "{found:?}");
            }
            Ok(_) => {}
            Err(_) => refused += 1,
        }
    }
    println!("{count:?} roundings with arcs: worst {worst:e} mm, {refused} refused");
    assert!(worst < 1e-5 && count.iter().all(|count| *count > 200) && refused < 200, "{worst} {count:?} {refused}");
}

#[test]
fn a_chamfer_on_an_arc_ends_at_its_distance_from_the_corner() {
    let first = arc([[-10.0, -10.0], [0.0, 0.0]], [0.0, -10.0], Turn::Cw);
    let second = line([[0.0, 0.0], [0.0, 20.0]]);
    let found = insert(&first, &second, Corner::Chamfer(Nm::from_mm(2.0))).unwrap();
    let end = point(&found.first.end);
    assert!((length(end) - 2.0).abs() < 1e-6 && (length(minus(end, [0.0, -10.0])) - 10.0).abs() < 1e-6, "{end:?}");
    assert_eq!(point(&found.second.start), [0.0, 2.0]);
}

#[test]
fn moves_that_are_too_short_are_alarms_and_straight_joints_have_no_corner() {
    let [long, short] = [line([[-9.0, 0.0], [0.0, 0.0]]), line([[0.0, 0.0], [0.0, 2.0]])];
    let rounding = |mm| Corner::Rounding(Nm::from_mm(mm));
    assert_eq!(insert(&long, &short, rounding(3.0)), Err(Alarm::NoMoveBehindCorner));
    assert_eq!(insert(&line([[-2.0, 0.0], [0.0, 0.0]]), &short, rounding(3.0)), Err(Alarm::ShortCorner));
    assert_eq!(insert(&long, &line([[0.0, 0.0], [-5.0, 0.0]]), rounding(1.0)), Err(Alarm::ShortCorner));
    let ahead = insert(&long, &line([[0.0, 0.0], [9.0, 0.1]]), rounding(1.0)).unwrap();
    assert_eq!((ahead.between, ahead.first), (None, long));
    let exact = insert(&long, &short, rounding(2.0)).unwrap();
    assert_eq!((exact.second.length_mm(), exact.second.path), (0.0, Path::Line));
}

#[test]
fn the_rest_of_an_arc_of_no_length_is_no_whole_turn() {
    let quarter = arc([[0.0, 0.0], [10.0, 10.0]], [0.0, 10.0], Turn::Ccw);
    let chamfer = Corner::Chamfer(Nm::from_mm(libm::sqrt(200.0)));
    let found = insert(&line([[0.0, 30.0], [0.0, 0.0]]), &quarter, chamfer).unwrap();
    assert!(found.second.length_mm() < 1e-5, "{found:?}");
}
