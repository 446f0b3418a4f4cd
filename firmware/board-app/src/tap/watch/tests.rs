use super::*;
use arcfeed_nc::modal::{Feed, Plane, Turn};

fn pose(x: f64, y: f64, z: f64) -> Pose {
    Pose { linear: [x, y, z].map(Nm::from_mm), ..Pose::ORIGIN }
}

fn line(start: Pose, end: Pose) -> Segment {
    Segment { sequence: None, start, end, feed: Feed::Missing, path: Path::Line }
}

/// Arc about (100, 0) in XY with radius 10, from its west point to `to`, relative to the centre; `rise` is the final Z.
fn arc(turn: Turn, to: [f64; 2], rise: f64) -> Segment {
    let to = to.map(Nm::from_mm);
    let arc =
        Arc { plane: Plane::Xy, turn, center: [Nm::from_mm(100.0), Nm(0)], from: [Nm::from_mm(-10.0), Nm(0)], to };
    let end = pose(100.0 + to[0].to_mm(), to[1].to_mm(), rise);
    Segment { path: Path::Arc(arc), ..line(pose(90.0, 0.0, 0.0), end) }
}

fn is_near(segment: &Segment, at: [f64; 3], wanted: f32) {
    let [x, y, z] = at;
    let found = place(segment, &pose(x, y, z)).unwrap().distance_mm;
    assert!((found - wanted).abs() < 1e-3, "{at:?}: {found}, not {wanted}");
}

#[test]
fn the_distance_from_a_line_is_that_from_its_nearest_point() {
    let line = line(pose(1.0, 2.0, 3.0), pose(1.0, 2.0, 13.0));
    is_near(&line, [1.0, 2.0, 8.0], 0.0);
    is_near(&line, [4.0, 6.0, 8.0], 5.0);
    is_near(&line, [1.0, 2.0, 1.0], 2.0);
    is_near(&line, [1.0, 5.0, 17.0], 5.0);
    let nowhere = Segment { end: line.start, ..line };
    is_near(&nowhere, [1.0, 2.0, 4.0], 1.0);
}

#[test]
fn the_distance_from_an_arc_ends_with_it() {
    let north = arc(Turn::Cw, [10.0, 0.0], 0.0);
    is_near(&north, [100.0, 10.0, 0.0], 0.0);
    is_near(&north, [100.0, 13.0, 4.0], 5.0);
    is_near(&north, [92.0, 6.0, 0.0], 0.0);
    // South of it lies no path: the ends are nearest.
    is_near(&north, [110.0, -7.0, 0.0], 7.0);
    is_near(&north, [90.0, -2.0, 0.0], 2.0);
    is_near(&arc(Turn::Ccw, [10.0, 0.0], 0.0), [100.0, -10.0, 0.0], 0.0);
    is_near(&arc(Turn::Ccw, [-10.0, 0.0], 0.0), [100.0, 12.0, 0.0], 2.0);
}

#[test]
fn a_helix_rises_along_its_sweep() {
    let helix = arc(Turn::Cw, [10.0, 0.0], 8.0);
    is_near(&helix, [100.0, 10.0, 4.0], 0.0);
    is_near(&helix, [110.0, 0.0, 8.0], 0.0);
    is_near(&helix, [100.0, 10.0, 0.0], 4.0);
}

#[test]
fn an_arc_is_watched_in_its_own_plane() {
    let path = |plane| match arc(Turn::Cw, [10.0, 0.0], 0.0).path {
        Path::Arc(arc) => Path::Arc(Arc { plane, ..arc }),
        other => other,
    };
    let zx = Segment { path: path(Plane::Zx), ..line(pose(0.0, 0.0, 90.0), pose(0.0, 0.0, 110.0)) };
    is_near(&zx, [10.0, 0.0, 100.0], 0.0);
    is_near(&zx, [10.0, 3.0, 100.0], 3.0);
    let yz = Segment { path: path(Plane::Yz), ..line(pose(0.0, 90.0, 0.0), pose(0.0, 110.0, 0.0)) };
    is_near(&yz, [3.0, 100.0, 10.0], 3.0);
}

#[test]
fn a_rapid_has_no_path() {
    let rapid = Segment { path: Path::Rapid, ..line(pose(0.0, 0.0, 0.0), pose(1.0, 0.0, 0.0)) };
    assert_eq!(place(&rapid, &Pose::ORIGIN), None);
}

/// Distance of the axes from their expected place at the last of these angles from the start of a full circle, degrees.
fn off_on_circle(turn: Turn, degrees: &[i32]) -> f32 {
    let circle = arc(turn, [-10.0, 0.0], 0.0);
    let mut way = PathProgress::default();
    let sign = f64::from(turn.sign());
    let at = |degree: &i32| {
        let (sin, cos) = libm::sincos(f64::from(*degree).to_radians() * sign);
        pose(100.0 - 10.0 * cos, -10.0 * sin, 0.0)
    };
    degrees.iter().map(|degree| way.off_mm(&place(&circle, &at(degree)).unwrap())).last().unwrap()
}

#[test]
fn a_circle_is_gone_round_once_in_its_own_sense() {
    for turn in [Turn::Cw, Turn::Ccw] {
        let round: std::vec::Vec<i32> = (-1..=361).collect();
        assert!(off_on_circle(turn, &round) < 1e-3);
        let back: std::vec::Vec<i32> = (0..=90).map(|degree| -degree).collect();
        assert!((off_on_circle(turn, &back) - 15.708).abs() < 1e-2);
        assert!((off_on_circle(turn, &[0, 45, 90, 80]) - 1.745).abs() < 1e-2);
    }
}

#[test]
fn a_line_gone_back_is_another_move() {
    let line = line(pose(0.0, 0.0, 0.0), pose(10.0, 0.0, 0.0));
    let mut way = PathProgress::default();
    let off = |x: f64| way.off_mm(&place(&line, &pose(x, 0.0, 0.0)).unwrap());
    assert_eq!([0.0, 5.0, 4.0, 3.0, 4.5, 6.0, 10.0].map(off), [0.0, 0.0, 1.0, 2.0, 0.5, 0.0, 0.0]);
}

#[test]
fn a_gate_opens_where_its_stretch_ends_once_the_axes_have_gone() {
    let home = pose(0.0, 0.0, 0.0);
    let mut gate = Gate::new(None, home);
    assert!(!gate.passes(&home) && !gate.passes(&pose(0.0, 0.0, 0.09)) && !gate.passes(&home));
    assert!(!gate.passes(&pose(0.0, 0.0, 5.0)));
    assert!(!gate.passes(&pose(0.0, 0.0, 0.03)));
    assert!(gate.passes(&pose(0.0, 0.0, 0.02)));
}

#[test]
fn a_gate_by_way_of_a_place_does_not_open_before() {
    let (above, bottom) = (pose(5.0, 0.0, 2.0), pose(5.0, 0.0, -3.0));
    let mut gate = Gate::new(Some(bottom), above);
    let way = [pose(0.0, 0.0, 2.0), above, pose(5.0, 0.0, 0.0), bottom, pose(5.0, 0.0, 1.0)];
    assert!(way.iter().all(|position| !gate.passes(position)));
    assert!(gate.passes(&above));
}
