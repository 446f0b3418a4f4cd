//! Thickness distribution of NACA 65-010.
//!
//! ```text
//! t(x) between stations x_j < x < x_j+1: linear in sqrt(x)                       (1)
//! ```
//!
//! A round nose has t ~ sqrt(x), which (1) keeps up to the first station. Source: I. H. Abbott, A. E. von Doenhoff, L. S. Stivers,
//! *Summary of Airfoil Data*, NACA Report 824, 1945, basic thickness form 65-010.

/// Stations and half thickness there, percent of the chord.
const HALF_PERCENT: [[f64; 2]; 26] = [
    [0.0, 0.0],
    [0.5, 0.772],
    [0.75, 0.932],
    [1.25, 1.169],
    [2.5, 1.574],
    [5.0, 2.177],
    [7.5, 2.647],
    [10.0, 3.040],
    [15.0, 3.666],
    [20.0, 4.143],
    [25.0, 4.503],
    [30.0, 4.760],
    [35.0, 4.924],
    [40.0, 4.996],
    [45.0, 4.963],
    [50.0, 4.812],
    [55.0, 4.530],
    [60.0, 4.146],
    [65.0, 3.682],
    [70.0, 3.156],
    [75.0, 2.584],
    [80.0, 1.987],
    [85.0, 1.385],
    [90.0, 0.810],
    [95.0, 0.306],
    [100.0, 0.0],
];

/// Greatest thickness of the table over its chord.
const TABLE_RATIO: f64 = 0.1;

const PERCENT: f64 = 100.0;

/// Half thickness at `station_ratio` (0 at the leading, 1 at the trailing edge), over the chord, of a profile with the
/// thickness `thickness_ratio`.
pub fn half_thickness_ratio(station_ratio: f64, thickness_ratio: f64) -> f64 {
    let station = (station_ratio * PERCENT).clamp(0.0, PERCENT);
    let next = HALF_PERCENT.iter().position(|row| row[0] >= station).unwrap_or(HALF_PERCENT.len() - 1).max(1);
    let [[from, lower], [to, upper]] = [HALF_PERCENT[next - 1], HALF_PERCENT[next]];
    let share = (libm::sqrt(station) - libm::sqrt(from)) / (libm::sqrt(to) - libm::sqrt(from)); // (1)
    (lower + (upper - lower) * share) / PERCENT * thickness_ratio / TABLE_RATIO
}
