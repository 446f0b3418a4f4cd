//! Extents of moves along each axis.

use arcfeed_nc::modal::{Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::{MicroDeg, Nm};

/// Calls `include` with an axis, and the lowest and highest coordinate that a move reaches there, relative to the origin: X, Y, Z in mm, A, B, C
/// in degrees. An axis may have several such ranges.
pub fn each_extreme(segment: &Segment, origin: &Pose, mut include: impl FnMut(usize, [f64; 2])) {
    let Segment { start, end, path, .. } = segment;
    let sorted = |[one, other]: [i64; 2]| [one.min(other), one.max(other)];
    let length_mm = |at: i64, origin: Nm| Nm(at - origin.0).to_mm();
    for index in 0..3 {
        let ends = [start, end].map(|pose| pose.linear[index].0);
        if ends[0] != ends[1] || matches!(path, Path::Arc(_)) {
            include(index, sorted(ends).map(|at| length_mm(at, origin.linear[index])));
        }
    }
    if start.rotary != end.rotary {
        for index in 0..3 {
            let ends = [start, end].map(|pose| pose.rotary[index].0);
            if ends[0] != ends[1] {
                include(3 + index, sorted(ends).map(|at| MicroDeg(at - origin.rotary[index].0).to_deg()));
            }
        }
    }
    if let Path::Arc(arc) = path {
        let (first, second, _) = arc.plane.axes();
        let (crossed, radius_mm) = (crossed_axes(arc), arc.radius_mm());
        for (quarter, _) in crossed.into_iter().enumerate().filter(|(_, is_crossed)| *is_crossed) {
            let (axis, center) = if quarter % 2 == 0 { (first, arc.center[0]) } else { (second, arc.center[1]) };
            let outwards_mm = if quarter < 2 { radius_mm } else { -radius_mm };
            include(axis, [length_mm(center.0, origin.linear[axis]) + outwards_mm; 2]);
        }
    }
}

/// Which of the directions +first, +second, -first, -second of its plane an arc passes between its ends. At its ends it
/// may name a direction too.
fn crossed_axes(arc: &Arc) -> [bool; 4] {
    let (from, to) = match arc.turn {
        Turn::Ccw => (arc.from, arc.to),
        Turn::Cw => (arc.to, arc.from),
    };
    let [x, y] = from.map(|nm| i128::from(nm.0));
    let [to_x, to_y] = to.map(|nm| i128::from(nm.0));
    let (first, last) = (quarter(from), quarter(to));
    let is_ahead = x * to_y - y * to_x > 0;
    // Counter-clockwise from the quarter of the start, up to the one of the end.
    let count = match (last + 4 - first) % 4 {
        0 if is_ahead => 0,
        0 => 4,
        count => count,
    };
    let mut crossed = [false; 4];
    (1..=count).for_each(|step| crossed[(first + step) % 4] = true);
    crossed
}

/// Quarter of the plane in which a direction lies, counter-clockwise, each with the direction at its beginning.
fn quarter([x, y]: [Nm; 2]) -> usize {
    match (x.0.signum(), y.0.signum()) {
        (1, 0 | 1) => 0,
        (0 | -1, 1) => 1,
        (-1, 0 | -1) => 2,
        _ => 3,
    }
}

#[cfg(test)]
mod tests {
    use arcfeed_nc::modal::{Feed, Plane};

    use super::*;

    #[test]
    fn the_extents_of_arcs_are_those_of_many_points_on_them() {
        const GRID: [i64; 5] = [-8, -3, 0, 3, 8];
        let places: Vec<[Nm; 2]> =
            GRID.iter().flat_map(|x| GRID.map(|y| [*x, y].map(|mm| Nm(mm * 1_000_000)))).collect();
        let places = places.iter().filter(|place| **place != [Nm(0); 2]);
        for (from, other) in places.clone().flat_map(|from| places.clone().map(move |other| (*from, *other))) {
            // The end on the circle of the start.
            let radius_mm = libm::hypot(from[0].to_mm(), from[1].to_mm());
            let scale = radius_mm / libm::hypot(other[0].to_mm(), other[1].to_mm());
            let to = other.map(|nm| Nm::from_mm(nm.to_mm() * scale));
            for turn in [Turn::Ccw, Turn::Cw] {
                let center = [Nm(1_000_000), Nm(-2_000_000)];
                let arc = Arc { plane: Plane::Xy, turn, center, from, to };
                let pose = |[x, y]: [Nm; 2]| {
                    let linear = [Nm(center[0].0 + x.0), Nm(center[1].0 + y.0), Nm(0)];
                    Pose { linear, ..Pose::ORIGIN }
                };
                let (start, end, path) = (pose(from), pose(to), Path::Arc(arc));
                let mut found = [[f64::MAX, f64::MIN]; 3];
                let segment = Segment { sequence: None, start, end, feed: Feed::Missing, path };
                each_extreme(&segment, &Pose::ORIGIN, |axis, reached| {
                    let [low, high] = found[axis];
                    found[axis] = [low.min(reached[0]), high.max(reached[1])];
                });
                for (axis, offset_mm) in [(0, 1.0), (1, -2.0)] {
                    let points = (0..=2_000)
                        .map(|step| offset_mm + radius_mm * arc.direction_at(f64::from(step) / 2_000.0)[axis]);
                    let [low, high] = points.fold([f64::MAX, f64::MIN], |[low, high], at| [low.min(at), high.max(at)]);
                    let [found_low, found_high] = found[axis];
                    assert!((found_low - low).abs() < 1e-4 && (found_high - high).abs() < 1e-4, "{arc:?}");
                }
            }
        }
    }
}
