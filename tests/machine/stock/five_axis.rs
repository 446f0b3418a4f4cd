//! A tool that turns while it moves, against the tool put at thousands of places on its way.

use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::solid::Block;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_kinematics::vector::{along_arc, unit};

use crate::stock::figures::MEMORY_MAX;

/// Places at which the tool is put.
const PLACES: u32 = 2_000;

/// Distance of a point outside an upright tool of this radius, height and corner; negative inside.
fn outside_mm([radius_mm, height_mm, corner_mm]: [f64; 3], r_mm: f64, z_mm: f64) -> f64 {
    let from_corner = [r_mm - (radius_mm - corner_mm), corner_mm - z_mm];
    let round = libm::hypot(from_corner[0].max(0.0), from_corner[1].max(0.0)) - corner_mm;
    let inside = from_corner[0].max(from_corner[1]).min(0.0);
    (round + inside).max(z_mm - height_mm)
}

#[test]
fn stock_after_a_turning_tool_lacks_exactly_the_swept_points() {
    let (measures, tolerance_mm) = ([2.0, 9.0, 0.5], 0.02);
    let tool = Tool::bull_nose([measures[0], measures[2]], measures[1], 1e-4).unwrap();
    let from = Pose { tip_mm: [-3.0, -2.0, 0.3], axis: [-0.3, 0.2, 0.9] };
    let to = Pose { tip_mm: [3.0, 1.5, -0.7], axis: [0.5, -0.4, 0.7] };
    let sweeps = Move::Straight { from, to }.sweeps(&tool, tolerance_mm).unwrap();
    let block = Block { lowest_mm: [-9.0, -9.0, -4.0], highest_mm: [9.0, 9.0, 8.0] };
    let mut stock = Stock::new(&block, 0.6, MEMORY_MAX).unwrap();
    let removed = stock.cut(&tool, &sweeps).unwrap();
    let (start, end) = (unit(from.axis).unwrap(), unit(to.axis).unwrap());
    let places: Vec<([f64; 3], [f64; 3])> = (0..=PLACES)
        .map(|place| f64::from(place) / f64::from(PLACES))
        .map(|s| {
            ([0, 1, 2].map(|i| from.tip_mm[i] + s * (to.tip_mm[i] - from.tip_mm[i])), along_arc(start, end, s).unwrap())
        })
        .collect();
    // The tool's own way between two places: 7.1 mm of the tip and 1.3 rad of 9.2 mm.
    let slack_mm = tolerance_mm + 1e-4 + 20.0 / f64::from(PLACES) / 2.0;
    let lattice = *stock.lattice();
    let [nx, ny, nz] = lattice.cells();
    let (mut gone, mut left, mut between) = (0, 0, 0);
    for node in (0..nx * ny * nz).map(|n| [n % nx, n / nx % ny, n / (nx * ny)]) {
        let point = [0, 1, 2].map(|axis| lattice.center_mm(axis, node[axis]));
        let deepest = places.iter().map(|(tip, axis)| {
            let q = [0, 1, 2].map(|i| point[i] - tip[i]);
            let z = (0..3).map(|i| q[i] * axis[i]).sum::<f64>();
            let square = (0..3).map(|i| q[i] * q[i]).sum::<f64>() - z * z;
            outside_mm(measures, libm::sqrt(square.max(0.0)), z)
        });
        let deepest_mm = deepest.fold(f64::INFINITY, f64::min);
        let is_there = [0, 1, 2].map(|axis| {
            let [column, row] = Lattice::across(axis).map(|across| node[across]);
            stock.grids()[axis].dexel(column, row).unwrap().contains(point[axis])
        });
        assert_eq!(is_there, [is_there[0]; 3], "{point:?}");
        match deepest_mm {
            deep if deep < -slack_mm => assert!(!is_there[0], "left at {point:?}, {deep} mm inside"),
            far if far > slack_mm => assert!(is_there[0], "gone at {point:?}, {far} mm outside"),
            _ => between += 1,
        }
        if is_there[0] { left += 1 } else { gone += 1 }
    }
    println!(
        "{} sweeps, {gone} nodes gone, {left} left, {between} within {slack_mm:.3} mm of the surface; {:.1} mm3",
        sweeps.len(),
        removed.mean_mm3()
    );
    assert!(gone > 1_000 && left > 5_000 && between < gone / 10);
}

#[test]
fn the_volume_settles_as_the_tolerance_falls() {
    let tool = Tool::cylinder(2.0, 9.0).unwrap();
    let from = Pose { tip_mm: [-3.0, -2.0, 0.3], axis: [-0.3, 0.2, 0.9] };
    let to = Pose { tip_mm: [3.0, 1.5, -0.7], axis: [0.5, -0.4, 0.7] };
    let volume_mm3 = |tolerance_mm: f64| {
        let block = Block { lowest_mm: [-9.0, -9.0, -4.0], highest_mm: [9.0, 9.0, 11.0] };
        let mut stock = Stock::new(&block, 0.3, MEMORY_MAX).unwrap();
        let sweeps = Move::Straight { from, to }.sweeps(&tool, tolerance_mm).unwrap();
        stock.cut(&tool, &sweeps).unwrap().mean_mm3()
    };
    let volumes = [0.2, 0.05, 0.0125, 0.003].map(volume_mm3);
    println!("{volumes:?} mm3 at tolerances of 0.2, 0.05, 0.0125 and 0.003 mm");
    // The surface of what is swept has about 380 mm2.
    assert!((volumes[1] - volumes[3]).abs() < 0.05 * 380.0 && (volumes[2] - volumes[3]).abs() < 0.0125 * 380.0);
}
