//! Cuts into a wheel that the machine turns: their loads are the same wherever it stands, and their energy is that of the material
//! that the slots before them have left.

use std::f64::consts::PI;
use std::fmt::Write;

use crate::cutting_loads::slot_job::{assert_near, block, number, simulation_report};

/// Tangential force per area of a chip: also the energy per volume, because no edge rubs.
const CUTTING_N_PER_MM2: f64 = 1000.0;
const CHIP_MM: f64 = 0.1;
const RADIUS_MM: f64 = 5.0;
const WHEEL_RADIUS_MM: f64 = 40.0;
/// Half of the wheel's width.
const HALF_MM: f64 = 6.0;
/// Height of a layer, and number of them in a level.
const LAYER_MM: f64 = 0.5;
const LAYERS: i32 = 5;
const JOB: &str = "units = \"mm\"\nprogram = \"program.nc\"\n\
    [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 20\n\
    [workpiece]\nround = { from = [0, -6, 0], to = [0, 6, 0], radius = 40 }\nstep = 0.3\nindexed = true\n\
    [cutting]\ncutting = [1000, 300, 100]\nedge = [0, 0, 0]\naxial_depth = 2.5\nlayers = 5\n\
    [machine]\npreset = \"mitsui-seiki-hu80a-5x\"\n\
    [spindle]\nrev_per_min = 3000\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.1\n";
/// Positions of B with two levels each. The third slot overlaps the second one; the last is in the floor of the first.
const CUTS: [(f64, [f64; 2]); 5] =
    [(0.0, [37.5, 35.0]), (217.3, [37.5, 35.0]), (229.3, [37.5, 35.0]), (80.0, [37.5, 35.0]), (0.0, [32.5, 30.0])];
/// Radius of the tip's path across the rim, and Y of its ends.
const PATH_RADIUS_MM: f64 = 60.0;
const PATH_END_MM: f64 = 12.5;

/// Distance of the path's centre from the plane of Y and Z.
fn center_mm() -> f64 {
    libm::sqrt(PATH_RADIUS_MM * PATH_RADIUS_MM - PATH_END_MM * PATH_END_MM)
}

/// Slots across the rim, on arcs there and back; blocks N10, N11, N20, N21 and so on cut.
fn program() -> String {
    let (end, beside) = (PATH_END_MM, center_mm());
    let mut text = String::from("%\nG21G17G90G94\nS3000M3\nG0Z60.\n");
    for (cut, (b_deg, [upper, lower])) in CUTS.iter().enumerate() {
        let n = 10 * (cut + 1);
        let _ = write!(
            text,
            "G0B{b_deg:.3}\nG0X0.Y-{end}\nG0Z{upper:.3}\nN{n}G3X0.Y{end}I-{beside:.6}J{end}F1200.\n\
             G0Z{lower:.3}\nN{}G2X0.Y-{end}I-{beside:.6}J-{end}\nG0Z60.\n",
            n + 1
        );
    }
    text + "M30\n%\n"
}

/// Level of a slot: the position of B, and the height of its floor.
type Level = (f64, f64);

/// Whether a level's mill passes a point of the wheel, in the coordinates of the mill at another position of B.
fn is_passed([x, y, z]: [f64; 3], at_deg: f64, (b_deg, floor_mm): Level) -> bool {
    let (sin, cos) = libm::sincos((at_deg - b_deg).to_radians());
    let (x, z) = (x * cos + z * sin, z * cos - x * sin);
    z > floor_mm && (libm::hypot(x + center_mm(), y) - PATH_RADIUS_MM).abs() < RADIUS_MM
}

/// Volume that a level removes after earlier ones, counted in cells. As in `simulate`, layers are as their middles.
fn volume_mm3(level: Level, earlier: &[Level]) -> f64 {
    let (cell_mm, (b_deg, floor_mm)) = (0.05, level);
    let middle = |from_mm: f64, cell: i32| from_mm + (f64::from(cell) + 0.5) * cell_mm;
    let is_near = |other: &&Level| libm::cos((b_deg - other.0).to_radians()) > 0.5;
    let earlier: Vec<Level> = earlier.iter().filter(is_near).copied().collect();
    let mut cells = 0;
    for layer in 0..LAYERS {
        let z = floor_mm + (f64::from(layer) + 0.5) * LAYER_MM;
        for (column, row) in (0..340).flat_map(|column| (0..240).map(move |row| (column, row))) {
            let point = [middle(-7.0, column), middle(-HALF_MM, row), z];
            let is_cut = libm::hypot(point[0], z) < WHEEL_RADIUS_MM
                && is_passed(point, b_deg, level)
                && !earlier.iter().any(|other| is_passed(point, b_deg, *other));
            cells += i32::from(is_cut);
        }
    }
    f64::from(cells) * cell_mm * cell_mm * LAYER_MM
}

#[test]
fn cuts_all_round_a_wheel_have_the_same_loads_and_the_energy_of_what_is_left_there() {
    let report = simulation_report("indexed", JOB, &program());
    let load = |n: i64, pointer: &str| number(block(&report, n), pointer);
    // A chip between two trochoids is thicker than f sin(phi) by f^2 cos^2(phi) / 2 R.
    let j_per_mm3 = CUTTING_N_PER_MM2 * (1.0 + PI * CHIP_MM / 8.0 / RADIUS_MM) / 1e3;
    let mut earlier: Vec<Level> = Vec::new();
    for (cut, (b_deg, floors_mm)) in (1..).zip(CUTS) {
        for (n, floor_mm) in (10 * cut..).zip(floors_mm) {
            let expected_j = j_per_mm3 * volume_mm3((b_deg, floor_mm), &earlier);
            assert_near(&format!("N{n}, J"), load(n, "/power_mean_w") * load(n, "/time_s"), expected_j, 5e-3);
            earlier.push((b_deg, floor_mm));
        }
    }
    for (n, first) in [(20, 10), (21, 11), (40, 10), (41, 11)] {
        for (pointer, tolerance) in [("/chip_max/0", 1e-4), ("/force_max_n", 5e-3), ("/power_mean_w", 1e-3)] {
            assert_near(&format!("N{n}{pointer}"), load(n, pointer), load(first, pointer), tolerance);
        }
    }
    for (n, first) in [(30, 10), (31, 11)] {
        assert!(load(n, "/power_mean_w") < 0.95 * load(first, "/power_mean_w"), "less is left beside a slot");
    }
    assert_eq!(report["loads"]["left_out"].as_array().map(Vec::len), Some(0));
}
