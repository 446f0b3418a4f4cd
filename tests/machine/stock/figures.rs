//! The published figures of this folder, and what the tests do with them.

use std::f64::consts::PI;

use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::section::Sweep;
use arcfeed_dexel::solid::Block;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;

/// Memory that no test needs.
pub const MEMORY_MAX: usize = 1 << 30;

/// Upright.
pub const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// Swept areas, closed forms by quadrature, checked by a grid of 0.006 in: the values of `mrr_checks.csv` by their names.
/// Made outside of this project, with numpy and scipy.
pub fn published(check: &str) -> f64 {
    let lines = include_str!("mrr_checks.csv").lines();
    let rest = lines.map(|line| line.trim_start_matches('"')).find_map(|line| line.strip_prefix(check)).expect(check);
    let value = rest.split(',').nth(1).expect("a value");
    value.parse().expect("a number")
}

/// A block of one cell's height about z = 0: its volumes over that height are areas.
pub fn sheet(low_mm: [f64; 2], high_mm: [f64; 2], step_mm: f64) -> Stock {
    let half = step_mm / 2.0;
    let block = Block { lowest_mm: [low_mm[0], low_mm[1], -half], highest_mm: [high_mm[0], high_mm[1], half] };
    Stock::new(&block, step_mm, MEMORY_MAX).expect("a sheet")
}

/// Area that a cut removes from a sheet, by the rays along x, y and z, mm2.
pub fn area_mm2(sheet: &mut Stock, tool: &Tool, sweeps: &[Sweep]) -> [f64; 3] {
    let height_mm = sheet.lattice().step_mm();
    sheet.cut(tool, sweeps).expect("memory").by_axis.map(|volume_mm3| volume_mm3 / height_mm)
}

/// An upright tool whose tip is below a sheet.
pub fn upright(x_mm: f64, y_mm: f64) -> Pose {
    Pose { tip_mm: [x_mm, y_mm, -50.0], axis: UP }
}

/// A turn of an upright tool about (x, y).
pub fn turn(from: Pose, center_mm: [f64; 2], angle_deg: f64) -> Move {
    let center_mm = [center_mm[0], center_mm[1], 0.0];
    Move::Turn { from, center_mm, normal: UP, angle_rad: angle_deg * PI / 180.0, rise_mm: 0.0 }
}

/// The order of convergence from errors at steps each half of the one before, by least squares of their logarithms.
pub fn order(errors: &[f64]) -> f64 {
    let n = errors.len() as f64;
    let mean_x = (n - 1.0) / 2.0;
    let logs: Vec<f64> = errors.iter().map(|error| libm::log2(*error)).collect();
    let mean_y = logs.iter().sum::<f64>() / n;
    let both = logs.iter().enumerate().map(|(x, y)| (x as f64 - mean_x) * (y - mean_y)).sum::<f64>();
    let square = (0..errors.len()).map(|x| (x as f64 - mean_x).powi(2)).sum::<f64>();
    -both / square
}

/// Root of the mean square.
pub fn rms(errors: &[f64]) -> f64 {
    libm::sqrt(errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64)
}
