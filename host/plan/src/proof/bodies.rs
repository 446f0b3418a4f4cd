//! What the tool can meet, as triangles, all corners on the surfaces.
//!
//! A flat triangle with corners on a surface S(u, v), du wide and dv high, stays within
//!
//! ```text
//! e <= (|S_uu| du^2 + 2 |S_uv| du dv + |S_vv| dv^2) / 8                       (1)
//! ```
//!
//! of it, by the remainder of the linear interpolation (D. Filip, R. Magedson, R. Markot, *Surface algorithms using bounds on derivatives*,
//! Computer Aided Geometric Design 3 (1986), 295-311). The derivatives are sampled here, with a margin, not bounded.

use crate::geometry::blisk::{Blank, Blisk, Revolution};
use crate::geometry::face::{Face, Jet};
use crate::vector::{Point, Vector};

use super::spheres::Triangle;

/// Where the derivatives are looked at, across.
const SAMPLES: u32 = 8;
/// By how much they may be larger in between.
const MARGIN: f64 = 1.2;
/// Shares of the chord error for the three terms of (1).
const SHARES: [f64; 3] = [0.5, 0.2, 0.3];
/// No curve needs finer pieces.
const FINEST: f64 = 1.0 / 4096.0;

/// Both sides of the first blade, closed at its tip and along its edges; the hub closes it below. Part frame.
pub fn blade(blisk: &Blisk, chord_mm: f64) -> Vec<Triangle> {
    let faces = [&blisk.pressure, &blisk.suction];
    let [us, vs] = cuts(faces, chord_mm / MARGIN);
    let grid = |face: &Face| -> Vec<Vec<Point>> {
        vs.iter().map(|v| us.iter().map(|u| face.point(*u, *v)).collect()).collect()
    };
    let grids = faces.map(grid);
    let column = |at: usize| grids.iter().map(|grid| grid.iter().map(|row| row[at]).collect()).collect();
    let tip: Vec<Vec<Point>> = grids.iter().filter_map(|grid| grid.last().cloned()).collect();
    let [pressure, suction] = grids.each_ref();
    [tip, column(0), column(us.len() - 1)].iter().chain([pressure, suction]).flat_map(|rows| between(rows)).collect()
}

/// A surface of revolution all about the rotor's axis. Part frame.
pub fn revolved(surface: &Revolution, chord_mm: f64) -> Vec<Triangle> {
    let largest_mm = surface.profile_mm.iter().map(|[_, radius_mm]| *radius_mm).fold(0.0, f64::max);
    let half_rad = libm::acos((1.0 - chord_mm / largest_mm.max(chord_mm)).max(-1.0));
    let pieces = libm::ceil(core::f64::consts::PI / half_rad).max(3.0) as u32;
    let row = |[z, radius_mm]: &[f64; 2]| -> Vec<Point> {
        let angle = |k: u32| core::f64::consts::TAU * f64::from(k % pieces) / f64::from(pieces);
        (0..=pieces).map(|k| Point::new(radius_mm * libm::cos(angle(k)), radius_mm * libm::sin(angle(k)), *z)).collect()
    };
    between(&surface.profile_mm.iter().map(row).collect::<Vec<_>>())
}

/// The blank's round side and its faces. Part frame.
pub fn blank(blank: &Blank, chord_mm: f64) -> Vec<Triangle> {
    let [low_mm, high_mm] = blank.faces_mm;
    let radius_mm = blank.radius_mm;
    let profile_mm = vec![[low_mm, 0.0], [low_mm, radius_mm], [high_mm, radius_mm], [high_mm, 0.0]];
    revolved(&Revolution { profile_mm }, chord_mm)
}

/// A box between opposite corners, along the axes of its frame.
pub fn cuboid(corners: &[Point; 2]) -> Vec<Triangle> {
    let corner = |x: usize, y: usize, z: usize| Point::new(corners[x].x, corners[y].y, corners[z].z);
    let around = |z: usize| [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)].map(|(x, y)| corner(x, y, z)).to_vec();
    let lid = |z: usize| [vec![corner(0, 0, z), corner(1, 0, z)], vec![corner(0, 1, z), corner(1, 1, z)]];
    [between(&[around(0), around(1)]), between(&lid(0)), between(&lid(1))].concat()
}

/// Two triangles between neighbours of neighbouring rows.
fn between(rows: &[Vec<Point>]) -> Vec<Triangle> {
    let strips = rows.windows(2).flat_map(|pair| pair[0].windows(2).zip(pair[1].windows(2)));
    strips.flat_map(|(low, high)| [[low[0], low[1], high[1]], [low[0], high[1], high[0]]]).collect()
}

/// Parameters of a grid, u and v, which fits both faces.
fn cuts(faces: [&Face; 2], chord_mm: f64) -> [Vec<f64>; 2] {
    let over = |at: &dyn Fn(&Face, f64) -> Jet, term: fn(&Jet) -> Vector| {
        let samples = (0..=SAMPLES).map(|k| f64::from(k) / f64::from(SAMPLES));
        let places = samples.flat_map(|other| faces.map(|face| term(&at(face, other)).norm()));
        places.fold(0.0, f64::max)
    };
    let us = bisected(SHARES[0] * chord_mm, |u| over(&|face, v| face.jet(u, v), |jet| jet.uu));
    let mut vs = bisected(SHARES[1] * chord_mm, |v| over(&|face, u| face.jet(u, v), |jet| jet.vv));
    let twist_mm = vs.iter().map(|v| over(&|face, u| face.jet(u, *v), |jet| jet.uv)).fold(0.0, f64::max);
    while widest(&us) * widest(&vs) * twist_mm / 4.0 > SHARES[2] * chord_mm {
        let middles: Vec<f64> = vs.windows(2).flat_map(|pair| [pair[0], (pair[0] + pair[1]) / 2.0]).collect();
        vs = middles.into_iter().chain([1.0]).collect();
    }
    [us, vs]
}

fn widest(cuts: &[f64]) -> f64 {
    cuts.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
}

/// Cuts of the unit interval: halved until `second`, the second derivative, lets each piece be straight to within `chord_mm`.
fn bisected(chord_mm: f64, second: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut cuts = vec![0.0];
    let at = |k: u32| f64::from(k) / f64::from(SAMPLES);
    // From the last to the first.
    let mut open: Vec<[f64; 2]> = (0..SAMPLES).rev().map(|k| [at(k), at(k + 1)]).collect();
    while let Some([from, to]) = open.pop() {
        let middle = (from + to) / 2.0;
        let width = to - from;
        let largest = second(from).max(second(middle)).max(second(to));
        if width > FINEST && largest * width * width / 8.0 > chord_mm {
            open.extend([[middle, to], [from, middle]]);
        } else {
            cuts.push(to);
        }
    }
    cuts
}
