//! Walls and blades from closed surfaces against meshes of the same bodies by their formulas.

use std::f64::consts::{FRAC_PI_2, PI};

use arcfeed_blades::blade::Blade;
use arcfeed_dexel::mesh::Mesh as Surface;
use arcfeed_fe::body::Body;
use arcfeed_fe::clamped_block::{ClampedBlock, Face};
use arcfeed_fe::material::TITANIUM_6AL_4V;
use arcfeed_fe::mesh::{TetMesh, graded};
use arcfeed_fe::sheet::{Sheet, SheetError};

use crate::fe::surfaces::{TWISTED, closed, hollow};

/// Cells at the foot over those at the tip, as sheets have them.
const FOOT_RATIO: f64 = 0.2;

fn five_hz(mesh: TetMesh, held: Face) -> Vec<f64> {
    let clamped = held.nodes(&mesh);
    Body::new(mesh, &TITANIUM_6AL_4V).modes(&clamped, 5).expect("five modes").frequencies_hz()
}

const FOOT: Face = Face { axis: 2, is_upper: false };

fn blade_hz(blade: &Blade, cells: [usize; 3]) -> Vec<f64> {
    five_hz(blade.mesh(cells, FOOT_RATIO).expect("a blade"), FOOT)
}

/// Excess of a mesh of the surface over reference figures, %: frequencies, and volume.
fn off(surface: &Surface, cells: [usize; 3], truth_hz: &[f64]) -> (Vec<f64>, f64) {
    let mesh = Sheet { surface, thickness: 1, held: FOOT }.mesh(cells).expect("a blade");
    let percent = |ours: f64, truth: f64| 100.0 * (ours / truth - 1.0);
    let volume = percent(mesh.volume_mm3(), surface.volume_mm3());
    (five_hz(mesh, FOOT).iter().zip(truth_hz).map(|(ours, truth)| percent(*ours, *truth)).collect(), volume)
}

fn largest(off: &[f64]) -> f64 {
    off.iter().map(|off| off.abs()).fold(0.0, f64::max)
}

#[test]
fn a_box_is_the_block_that_it_is() {
    for (thickness, axis, is_upper, edges_mm) in
        [(1, 2, false, [30.0, 2.0, 40.0]), (1, 0, true, [30.0, 2.0, 40.0]), (0, 1, false, [1.5, 25.0, 20.0])]
    {
        let held = Face { axis, is_upper };
        let cells = [0, 1, 2].map(|axis: usize| if axis == thickness { 1 } else { 8 });
        let slab = ClampedBlock {
            lowest_mm: [1.0, -5.0, 3.0],
            highest_mm: [0, 1, 2].map(|k: usize| [1.0, -5.0, 3.0][k] + edges_mm[k]),
            held,
        };
        let at = |part: [f64; 3]| [0, 1, 2].map(|k: usize| slab.lowest_mm[k] + part[k] * edges_mm[k]);
        let surface = closed([5, 3, 7], at);
        let mesh = Sheet { surface: &surface, thickness, held }.mesh(cells).expect("a wall");
        let ours_hz = five_hz(mesh, held);
        let truths_hz = five_hz(slab.mesh(cells).expect("a block"), held);
        let worst = ours_hz.iter().zip(&truths_hz).map(|(ours, truth)| (ours / truth - 1.0).abs()).fold(0.0, f64::max);
        println!("{truths_hz:.2?} Hz: within {worst:.1e}");
        assert!(worst < 1e-7);
    }
}

#[test]
fn a_twisted_blade_has_the_frequencies_of_its_formula() {
    let surface = closed([96, 2, 128], |[s, n, height]| TWISTED.point_mm([s - 0.5, n - 0.5, height]));
    let fine_hz = blade_hz(&TWISTED, [24, 1, 32]);
    println!("24 x 1 x 32 by formula: {fine_hz:.2?} Hz");
    for (cells, most) in [([8, 1, 10], 2.1), ([16, 1, 12], 1.1)] {
        let same_hz = blade_hz(&TWISTED, cells);
        let (of_same, volume) = off(&surface, cells, &same_hz);
        let (of_fine, _) = off(&surface, cells, &fine_hz);
        println!(
            "{cells:?}: {of_same:+.3?} % of the same cells, {of_fine:+.3?} % of finer ones, volume {volume:+.3} %"
        );
        assert!(largest(&of_same) < 0.1 && largest(&of_fine) < most && volume.abs() < 0.1);
    }
}

/// Thickness of a section with round edges, relative to its largest thickness.
fn round(blade: &Blade, s: f64, height: f64) -> f64 {
    let at = |[foot, tip]: [f64; 2]| foot + (tip - foot) * height;
    let radius = at(blade.thickness_mm) / 2.0 / at(blade.chord_mm);
    let beyond = (s.abs() - (0.5 - radius)).max(0.0) / radius;
    libm::sqrt((1.0 - beyond * beyond).max(0.0))
}

/// A point of a blade with round edges; `q`, -1 to 1 along the chord, is slow near them.
fn rounded_mm(blade: &Blade, [q, n, height]: [f64; 3]) -> [f64; 3] {
    let s = if q.abs() == 1.0 { q / 2.0 } else { libm::sin(FRAC_PI_2 * q) / 2.0 };
    blade.point_mm([s, n * round(blade, s, height), height])
}

#[test]
fn a_blade_with_round_edges_loses_little_with_them() {
    let blade = Blade { edge_ratio: 1.0, ..TWISTED };
    let surface = closed([200, 2, 64], |[q, n, height]| rounded_mm(&blade, [2.0 * q - 1.0, n - 0.5, height]));
    // By formula, with cells crowded at the edges, all but the last 0.05 of q, 0.05 % of the volume.
    let by_formula = |cells: [usize; 3]| {
        let place = |at: [f64; 3]| {
            let [q, n, height] = [0, 1, 2].map(|axis| at[axis] / cells[axis] as f64);
            rounded_mm(&blade, [0.95 * (2.0 * q - 1.0), n - 0.5, graded(height, cells[2], FOOT_RATIO)])
        };
        TetMesh::mapped(cells, |_| true, place).expect("a blade")
    };
    let fine_hz = five_hz(by_formula([24, 1, 24]), FOOT);
    println!("24 x 1 x 24 by formula: {fine_hz:.2?} Hz");
    let same_hz = five_hz(by_formula([16, 1, 12]), FOOT);
    println!("16 x 1 x 12 by formula: {same_hz:.2?} Hz");
    for (cells, most, volume_most) in [([8, 1, 10], 2.5, 1.6), ([16, 1, 12], 1.6, 0.6), ([24, 1, 24], 0.3, 0.6)] {
        let (offs, volume) = off(&surface, cells, &fine_hz);
        println!("{cells:?}: {offs:+.3?} %, volume {volume:+.3} %");
        assert!(largest(&offs) < most && volume.abs() < volume_most);
    }
}

#[test]
fn a_blade_with_pointed_edges_loses_little_with_them() {
    let of = |edge_ratio| Blade { edge_ratio, ..TWISTED };
    let surface = closed([128, 2, 96], |[s, n, height]| of(0.0).point_mm([s - 0.5, n - 0.5, height]));
    for cells in [[8, 1, 10], [16, 1, 12]] {
        // Nearly pointed, so that no element ends in a line.
        let (offs, volume) = off(&surface, cells, &blade_hz(&of(0.01), cells));
        println!("{cells:?}: {offs:+.3?} % of the same cells, volume {volume:+.3} %");
        assert!(largest(&offs) < 0.5 && volume.abs() < 0.15);
    }
}

fn moved(surface: &Surface, by_mm: [f64; 3]) -> Surface {
    let moved = |corner: [f64; 3]| [0, 1, 2].map(|axis: usize| corner[axis] + by_mm[axis]);
    let corners: Vec<_> = surface.corners_mm().map(|corners| corners.map(moved)).collect();
    Surface::from_corners(corners.into_iter()).expect("a closed surface")
}

fn joined(one: &Surface, other: &Surface) -> Surface {
    let corners: Vec<_> = one.corners_mm().chain(other.corners_mm()).collect();
    Surface::from_corners(corners.into_iter()).expect("a closed surface")
}

#[test]
fn shapes_that_are_no_wall_or_blade_are_refused_with_their_place() {
    let refused = |surface: &Surface, cells: [usize; 3]| {
        let error = Sheet { surface, thickness: 1, held: FOOT }.mesh(cells).expect_err("no sheet");
        println!("{error}");
        error
    };
    let wall = closed([1; 3], |[x, y, z]| [30.0 * x, 3.0 * y, 40.0 * z]);
    let cavity = closed([1; 3], |[x, y, z]| [10.0 + 10.0 * x, 1.0 + y, 5.0 + 10.0 * z]);
    let SheetError::NoSides { axis: 1, at_mm: [x_mm, y_mm, z_mm], count: 2 } =
        refused(&hollow(&wall, &cavity), [8, 1, 8])
    else {
        panic!("a cavity")
    };
    assert!((10.0..20.0).contains(&x_mm) && y_mm == 1.5 && (5.0..15.0).contains(&z_mm));
    // Two walls, one behind the other.
    let both = joined(&wall, &moved(&wall, [50.0, 0.0, 0.0]));
    assert!(matches!(refused(&both, [8, 1, 8]), SheetError::NoSides { count: 0, .. }));
    // A wall on a base ten times as thick.
    let base = closed([1; 3], |[x, y, z]| [30.0 * x, 30.0 * y, 40.0 * z]);
    let on_base = joined(&wall, &moved(&base, [0.0, -10.0, -40.0]));
    let SheetError::Unlike { axis: 2, at_mm: [from_mm, to_mm] } = refused(&on_base, [8, 1, 8]) else {
        panic!("a base")
    };
    assert!(from_mm < 0.0 && to_mm >= 0.0);
    // Twisted by two right angles.
    let spun = Blade { stagger_rad: [0.0, 3.0], ..TWISTED };
    let surface = closed([8, 2, 64], |[s, n, height]| spun.point_mm([s - 0.5, n - 0.5, height]));
    assert!(matches!(refused(&surface, [8, 1, 8]), SheetError::NoSides { .. }));
    // More waves along the span than cells.
    let waves = closed([4, 2, 200], |[x, y, z]| [30.0 * x, (y - 0.5) * (3.0 + 0.9 * libm::cos(40.0 * z)), 40.0 * z]);
    assert!(matches!(refused(&waves, [4, 1, 4]), SheetError::Volume { .. }));
    // A right angle and a half in one cell.
    let spun = Blade { stagger_rad: [-1.3, 1.3], thickness_mm: [9.0; 2], edge_ratio: 0.1, ..TWISTED };
    let surface = closed([8, 2, 64], |[s, n, height]| spun.point_mm([s - 0.5, n - 0.5, height]));
    assert!(matches!(refused(&surface, [4, 1, 1]), SheetError::Folded { .. }));
}

/// A section with a round nose and a sharp tail (four digits, NACA Report 460, the tail closed), the chord from 0 to 1: thickness a tenth, a parabola as its middle line.
fn airfoil(q: f64, n: f64) -> [f64; 2] {
    let x = (1.0 - libm::cos(PI * q)) / 2.0;
    let tail = x * (0.1260 + x * (0.3516 - x * (0.2843 - 0.1036 * x)));
    let half = if x == 1.0 { 0.0 } else { 0.5 * (0.2969 * libm::sqrt(x) - tail) };
    [x, 0.4 * x * (1.0 - x) + (2.0 * n - 1.0) * half]
}

#[test]
fn a_coarse_surface_of_an_airfoil_is_meshed_with_any_cells() {
    // Also with a chord nearly along Y.
    for turned_rad in [[-0.3, 0.9], [1.2, 1.3]] {
        let surface = closed([40, 2, 30], |[q, n, height]| {
            let [x_mm, y_mm] = airfoil(q, n).map(|along| 30.0 * along);
            let (sin, cos) = libm::sincos(turned_rad[0] + (turned_rad[1] - turned_rad[0]) * height);
            [(x_mm - 12.0) * cos - y_mm * sin, (x_mm - 12.0) * sin + y_mm * cos, 45.0 * height]
        });
        for cells in [[8, 1, 6], [16, 1, 12], [12, 2, 8], [20, 1, 20]] {
            let mesh = Sheet { surface: &surface, thickness: 1, held: FOOT }.mesh(cells).expect("a blade");
            let volume = 100.0 * (mesh.volume_mm3() / surface.volume_mm3() - 1.0);
            println!("{turned_rad:?} {cells:?}: volume {volume:+.3} %");
            assert!(volume.abs() < 0.6);
        }
    }
}

#[test]
fn a_blade_is_the_same_whichever_axes_it_lies_along() {
    let lying = |way: usize| {
        let surface = closed([48, 2, 64], |[s, n, height]| {
            let mut point_mm = TWISTED.point_mm([s - 0.5, n - 0.5, height]);
            point_mm.rotate_right(way);
            point_mm
        });
        let (mut cells, held) = ([8, 1, 8], Face { axis: (2 + way) % 3, is_upper: false });
        cells.rotate_right(way);
        five_hz(Sheet { surface: &surface, thickness: (1 + way) % 3, held }.mesh(cells).expect("a blade"), held)
    };
    let upright_hz = lying(0);
    for way in [1, 2] {
        let worst = lying(way).iter().zip(&upright_hz).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        println!("turned {way} times: within {worst:.1e}");
        assert!(worst < 1e-8);
    }
}
