//! Triangle meshes of faces, of blades as solids, and of sectors of revolution.
//!
//! ```text
//! |S(m) - (S(a) + S(b)) / 2| <= e / 3         between two neighbours, along u and along v       (1)
//! |S00 - S10 - S01 + S11| / 4 <= e / 3        of a cell, for its diagonal                       (2)
//! dtheta <= 2 acos(1 - e / r)                 chords of a circle                                (3)
//! ```
//!
//! with the tolerance e. (1) is the sag of a chord, (2) how far a cell's middle lies from its diagonal. Solids are closed: every
//! edge is shared by two triangles whose corners are the same numbers, and face outwards.

use crate::vector::Point;

use super::blisk::Blade;
use super::blisk::{Blisk, Revolution};
use super::face::Face;
use super::flaws::BladeSide;

/// Three corners of a triangle, counter-clockwise as seen from outside.
pub type Triangle = [Point; 3];

/// Number of parts of (1) and (2) that share the tolerance.
const SHARES: f64 = 3.0;

/// Number of initial pieces of a face along each parameter.
const PIECES: usize = 4;

/// Most halvings of a piece.
const HALVINGS: u32 = 12;

/// Places along one parameter at which lines of the other are checked.
const PROBES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Edges of the two sides nearer than this count as one.
const SAME_EDGE_MM: f64 = 0.02;

/// Sector of a ring about the rotor's axis, for meshes of a part of the rotor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sector {
    /// First and last angle about the axis.
    pub angles_rad: [f64; 2],
    /// Lower and upper position along the axis.
    pub faces_mm: [f64; 2],
    /// Inner radius.
    pub inner_radius_mm: f64,
}

/// Mesh of a face within `tolerance_mm`; outwards is away from the blade.
pub fn face(face: &Face, tolerance_mm: f64) -> Vec<Triangle> {
    let [us, vs] = grid(&[face], tolerance_mm);
    let rows: Vec<Vec<Point>> = vs.iter().map(|v| us.iter().map(|u| face.point(*u, *v)).collect()).collect();
    let mut triangles = skin(&rows);
    let middle = (face.point(0.5, 0.5), face.normal(0.5, 0.5));
    let near = triangles.iter().min_by(|a, b| (a[0] - middle.0).norm().total_cmp(&(b[0] - middle.0).norm()));
    if near.is_some_and(|t| (t[1] - t[0]).cross(&(t[2] - t[0])).dot(&middle.1) < 0.0) {
        flip(&mut triangles);
    }
    triangles
}

/// Blade as a solid from its tip to `root_mm` below its lowest section, towards the axis.
pub fn blade(blade: &Blade, root_mm: f64, tolerance_mm: f64) -> Vec<Triangle> {
    let grid = grid(&[&blade.pressure, &blade.suction], tolerance_mm);
    blade_over(&grid, root_mm, |side, u, v| match side {
        BladeSide::Pressure => blade.pressure.point(u, v),
        BladeSide::Suction => blade.suction.point(u, v),
    })
}

/// Blade whose sides are displaced, as a solid: `point` of a side at (u, v). The grid is that of the blade without displacement within
/// `tolerance_mm`, with steps of `step_mm` at most. `beyond` are further places u of both sides, below 0 or above 1 and increasing: over an edge.
pub fn displaced_blade(
    blade: &Blade,
    root_mm: f64,
    [tolerance_mm, step_mm]: [f64; 2],
    beyond: &[f64],
    point: impl Fn(BladeSide, f64, f64) -> Point,
) -> Vec<Triangle> {
    let [us, vs] = grid(&[&blade.pressure, &blade.suction], tolerance_mm);
    let apart_mm = |from: [f64; 2], to: [f64; 2]| {
        let [from, to] = [from, to].map(|[u, v]| blade.pressure.point(u, v));
        (to - from).norm()
    };
    let greatest = |way: &dyn Fn(f64) -> f64| PROBES.into_iter().map(way).fold(0.0, f64::max);
    let us = divided(&us, |a, b| greatest(&|v| apart_mm([a, v], [b, v])) / step_mm);
    let vs = divided(&vs, |a, b| greatest(&|u| apart_mm([u, a], [u, b])) / step_mm);
    let before = beyond.iter().filter(|u| **u < 0.0).chain(&us);
    let us: Vec<f64> = before.chain(beyond.iter().filter(|u| **u > 1.0)).copied().collect();
    blade_over(&[us, vs], root_mm, point)
}

/// Solid over a grid of parameters.
fn blade_over([us, vs]: &[Vec<f64>; 2], root_mm: f64, point: impl Fn(BladeSide, f64, f64) -> Point) -> Vec<Triangle> {
    let sides = [BladeSide::Pressure, BladeSide::Suction].map(|side| {
        let row = |v: &f64| us.iter().map(|u| point(side, *u, *v)).collect::<Vec<_>>();
        let mut rows: Vec<Vec<Point>> = vs.iter().map(row).collect();
        rows.insert(0, rows[0].iter().map(|point| below(point, root_mm)).collect());
        rows
    });
    solid_of(sides)
}

/// Parameters with each interval divided into equal parts; their number is rounded up.
fn divided(at: &[f64], parts: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let between = at.windows(2).flat_map(|pair| {
        let count = libm::ceil(parts(pair[0], pair[1])).max(1.0) as usize;
        (1..=count).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / count as f64).collect::<Vec<_>>()
    });
    at.first().copied().into_iter().chain(between).collect()
}

/// Solid between two sides, given row by row from below.
fn solid_of([pressure, mut suction]: [Vec<Vec<Point>>; 2]) -> Vec<Triangle> {
    let last = pressure[0].len() - 1;
    for edge in [0, last] {
        let is_one = pressure.iter().zip(&suction).all(|(p, s)| (p[edge] - s[edge]).norm() < SAME_EDGE_MM);
        for (p, s) in pressure.iter().zip(&mut suction).filter(|_| is_one) {
            s[edge] = p[edge];
        }
    }
    let around =
        |(p, s): (&Vec<Point>, &Vec<Point>)| p.iter().chain(s.iter().rev()).chain(p.first()).copied().collect();
    let rings: Vec<Vec<Point>> = pressure.iter().zip(&suction).map(around).collect();
    let mut triangles = skin(&rings);
    let top = pressure.len() - 1;
    triangles.extend(skin(&[suction[0].clone(), pressure[0].clone()]));
    triangles.extend(skin(&[pressure[top].clone(), suction[top].clone()]));
    outwards(triangles)
}

/// Blank between two angles and down to a radius.
pub fn blank(blisk: &Blisk, sector: &Sector, tolerance_mm: f64) -> Vec<Triangle> {
    let outer = Revolution { profile_mm: sector.faces_mm.map(|z| [z, blisk.blank.radius_mm]).to_vec() };
    revolved(&outer, sector, tolerance_mm)
}

/// Solids of the finished part in a sector: the rest of the ring below the gas path, and the blades from the first to
/// the last index. The blades reach into the ring, so a reader must count overlapping solids.
pub fn finished(blisk: &Blisk, sector: &Sector, blades: [i32; 2], tolerance_mm: f64) -> Vec<Triangle> {
    let mut triangles = revolved(&blisk.hub, sector, tolerance_mm);
    for index in blades[0]..=blades[1] {
        let of_one = blisk.blade(index);
        let foot_mm = |u: f64| blisk.hub.height_mm(&of_one.pressure.point(u, 0.0)).max(0.0);
        let root_mm = (PROBES.map(foot_mm).into_iter().fold(0.0, f64::max) + tolerance_mm) * 2.0;
        triangles.extend(blade(&of_one, root_mm, tolerance_mm));
    }
    triangles
}

/// Ring below a surface of revolution, in a sector.
pub fn revolved(outer: &Revolution, sector: &Sector, tolerance_mm: f64) -> Vec<Triangle> {
    let profile = outer.between(sector.faces_mm);
    let largest_mm = profile.iter().map(|place| place[1]).fold(0.0, f64::max);
    let [from, to] = sector.angles_rad;
    let step = 2.0 * libm::acos(1.0 - (tolerance_mm / largest_mm).min(1.0)); // (3)
    let steps = libm::ceil((to - from) / step).max(1.0);
    let ring = |index: f64| {
        let (sin, cos) = libm::sincos(from + (to - from) * index / steps);
        let at = |[z, radius]: [f64; 2]| Point::new(radius * cos, radius * sin, z);
        let above = profile.iter().map(|place| at(*place));
        let below = profile.iter().rev().map(|place| at([place[0], sector.inner_radius_mm]));
        (above.collect::<Vec<_>>(), below.collect::<Vec<_>>())
    };
    let rings: Vec<_> = (0..=steps as usize).map(|index| ring(index as f64)).collect();
    let closed = |(above, below): &(Vec<Point>, Vec<Point>)| {
        above.iter().chain(below).chain(above.first()).copied().collect::<Vec<_>>()
    };
    let mut triangles = skin(&rings.iter().map(closed).collect::<Vec<_>>());
    let cap = |(above, below): &(Vec<Point>, Vec<Point>)| [above.clone(), below.iter().rev().copied().collect()];
    if let (Some(first), Some(last)) = (rings.first(), rings.last()) {
        let [above, below] = cap(first);
        triangles.extend(skin(&[below, above]));
        triangles.extend(skin(&cap(last)));
    }
    outwards(triangles)
}

/// Volume enclosed by the triangles.
pub fn volume_mm3(triangles: &[Triangle]) -> f64 {
    triangles.iter().map(|[a, b, c]| a.coords.dot(&b.coords.cross(&c.coords)) / 6.0).sum()
}

/// Triangles between rows of equal length; cells without area are left out.
fn skin(rows: &[Vec<Point>]) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for pair in rows.windows(2) {
        for (lower, upper) in pair[0].windows(2).zip(pair[1].windows(2)) {
            let halves = [[lower[0], lower[1], upper[1]], [lower[0], upper[1], upper[0]]];
            triangles.extend(halves.into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
        }
    }
    triangles
}

fn outwards(mut triangles: Vec<Triangle>) -> Vec<Triangle> {
    if volume_mm3(&triangles) < 0.0 {
        flip(&mut triangles);
    }
    triangles
}

fn flip(triangles: &mut [Triangle]) {
    triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
}

/// The same place moved towards the axis.
fn below(point: &Point, depth_mm: f64) -> Point {
    let share = 1.0 - depth_mm / libm::hypot(point.x, point.y);
    Point::new(point.x * share, point.y * share, point.z)
}

/// Parameters along u and v that suit all faces.
fn grid(faces: &[&Face], tolerance_mm: f64) -> [Vec<f64>; 2] {
    let part_mm = tolerance_mm / SHARES;
    let sag = |along_u: bool, a: f64, b: f64| {
        let at = |face: &Face, t: f64, probe: f64| if along_u { face.point(t, probe) } else { face.point(probe, t) };
        let one = |face: &Face, probe: f64| {
            let ends = [a, b].map(|t| at(face, t, probe));
            (at(face, (a + b) / 2.0, probe) - nalgebra::center(&ends[0], &ends[1])).norm()
        };
        let all = faces.iter().flat_map(|face| PROBES.map(|probe| one(face, probe)));
        all.fold(0.0, f64::max)
    };
    let us = halved(|a, b| sag(true, a, b) > part_mm); // (1)
    let mut vs = halved(|a, b| sag(false, a, b) > part_mm); // (1)
    while vs.len() < 1 << HALVINGS && faces.iter().any(|face| twist_mm(face, &us, &vs) > part_mm) {
        let middles = vs.windows(2).flat_map(|pair| [pair[0], (pair[0] + pair[1]) / 2.0]);
        vs = middles.chain([1.0]).collect();
    }
    [us, vs]
}

/// Parameters from 0 to 1; pieces that are too coarse are halved.
fn halved(is_coarse: impl Fn(f64, f64) -> bool) -> Vec<f64> {
    let mut found = vec![0.0];
    let mut open: Vec<(f64, f64, u32)> =
        (0..PIECES).rev().map(|i| (i as f64 / PIECES as f64, (i + 1) as f64 / PIECES as f64, 0)).collect();
    while let Some((a, b, depth)) = open.pop() {
        if depth < HALVINGS && is_coarse(a, b) {
            let middle = (a + b) / 2.0;
            open.extend([(middle, b, depth + 1), (a, middle, depth + 1)]);
        } else {
            found.push(b);
        }
    }
    found
}

/// Value of (2) in the worst cell.
fn twist_mm(face: &Face, us: &[f64], vs: &[f64]) -> f64 {
    let of_cell = |u: &[f64], v: &[f64]| {
        let [[a, b], [c, d]] = [v[0], v[1]].map(|v| [u[0], u[1]].map(|u| face.point(u, v)));
        ((a - b) - (c - d)).norm() / 4.0
    };
    let cells = vs.windows(2).flat_map(|v| us.windows(2).map(move |u| of_cell(u, v)));
    cells.fold(0.0, f64::max)
}
