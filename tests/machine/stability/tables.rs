//! The boundary at every speed of six tables: stable a twentieth below it, chatter a twentieth above.
//!
//! Tables: critical depths of the linear theory by collocation of the monodromy operator. Those of A and C, checked by
//! semi-discretisation and by time-domain growth, stand in `lobes.py`'s as well, by which B was made. The parameter sets are those
//! of published benchmarks, see `tests/machine/dynamics/sets.rs`; B has four modes along two axes.

use arcfeed_modal::dynamics::modal::Mode;
use arcfeed_tests::of_full_set;
use nalgebra::Vector3;

use crate::cutting_forces::rows::rows;
use crate::stability::milling::{BRIEFLY, LONG, Milling};

/// Tolerance of the critical depth, relative.
const BAND: f64 = 0.05;
/// Beside a cusp of the lobes the depth changes by more than this from one speed of the table to the next, or the kind of chatter does.
const STEEP: f64 = 1.5;

/// Critical depths of a parameter set.
pub struct Table {
    pub name: &'static str,
    pub csv: &'static str,
    pub milling: Milling,
}

/// Set A, along one axis.
pub fn mode_a(along: Vector3<f64>) -> Mode {
    mode(922.0, 0.011, 1340.049648, along)
}

fn mode(frequency_hz: f64, damping_ratio: f64, stiffness_n_per_mm: f64, along: Vector3<f64>) -> Mode {
    Mode::from_stiffness(frequency_hz, damping_ratio, stiffness_n_per_mm, &along).expect("a mode")
}

pub fn tables() -> [Table; 6] {
    let c = |along| mode(900.0, 0.03, 9000.0, along);
    let one = |immersion| Milling {
        modes: vec![mode_a(Vector3::x())],
        teeth: 2,
        specific_mpa: [600.0, 200.0],
        immersion,
        is_up: false,
        seen: BRIEFLY,
    };
    let two = Milling { modes: vec![mode_a(Vector3::x()), mode_a(Vector3::y())], ..one(1.0) };
    let up = Milling {
        modes: vec![c(Vector3::x()), c(Vector3::y())],
        teeth: 3,
        specific_mpa: [1879.385, 684.040],
        immersion: 0.5,
        is_up: true,
        seen: BRIEFLY,
    };
    let b = Milling {
        modes: vec![
            mode(456.78, 0.111705, 7933.1, Vector3::x()),
            mode(1448.89, 0.017037, 14691.8, Vector3::x()),
            mode(516.52, 0.024580, 9374.6, Vector3::y()),
            mode(1408.45, 0.031358, 12406.4, Vector3::y()),
        ],
        specific_mpa: [1319.4, 788.8],
        seen: LONG,
        ..one(0.5)
    };
    [
        Table { name: "A1, slot", csv: include_str!("sld_A1_down_aD1.00.csv"), milling: one(1.0) },
        Table { name: "A1, half down", csv: include_str!("sld_A1_down_aD0.50.csv"), milling: one(0.5) },
        Table { name: "A1, tenth down", csv: include_str!("sld_A1_down_aD0.10.csv"), milling: one(0.1) },
        Table { name: "A2, slot", csv: include_str!("sld_A2_down_aD1.00.csv"), milling: two },
        Table { name: "B, half down", csv: include_str!("sld_B_down_aD0.50.csv"), milling: b },
        Table { name: "C, half up", csv: include_str!("sld_C_up_aD0.50.csv"), milling: up },
    ]
}

/// Rows of a table that are not beside a cusp, and those that are: speed and critical depth.
fn split(csv: &'static str) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let rows = rows(csv);
    let depth = |at: usize| rows[at].number("alim_ref_mm");
    let is_like = |at: usize, other: usize| {
        let ratio = depth(at) / depth(other);
        ratio.max(1.0 / ratio) <= STEEP && rows[at].text("bifurcation") == rows[other].text("bifurcation")
    };
    let plain = |at: &usize| (*at == 0 || is_like(*at, at - 1)) && (at + 1 == rows.len() || is_like(*at, at + 1));
    let row = |at: usize| [rows[at].number("rpm"), depth(at)];
    let (plain, steep): (Vec<usize>, Vec<usize>) = (0..rows.len()).partition(plain);
    (plain.into_iter().map(row).collect(), steep.into_iter().map(row).collect())
}

/// The rows at which the boundary is not within the band.
fn missed(milling: &Milling, rows: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let is_kept = |[speed, depth]: &[f64; 2]| {
        !milling.chatters(*speed, depth * (1.0 - BAND)) && milling.chatters(*speed, depth * (1.0 + BAND))
    };
    rows.iter().filter(|row| !is_kept(row)).copied().collect()
}

#[test]
fn the_boundary_of_stability_is_that_of_the_linear_theory() {
    let is_soak = of_full_set(true, false);
    for Table { name, csv, milling } in tables() {
        let (plain, steep) = split(csv);
        let every = if is_soak { 1 } else { plain.len() / 3 };
        let asked: Vec<[f64; 2]> = plain.iter().skip(every / 2).step_by(every).copied().collect();
        let missed_plain = missed(&milling, &asked);
        println!("{name}: {} of {} rows within {BAND}", asked.len() - missed_plain.len(), asked.len());
        if is_soak {
            println!("  beside cusps, missed of {}: {:?}", steep.len(), missed(&milling, &steep));
        }
        assert_eq!(missed_plain, Vec::<[f64; 2]>::new(), "{name}");
    }
}
