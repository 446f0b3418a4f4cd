//! The structures of the reference runs. A1 and A2: the benchmark of Insperger and Stepan, along x or along x and y. C: a
//! text-book's family. Their values stand in public programs that cite those; the papers themselves were not at hand.

use std::f64::consts::{FRAC_PI_2, PI};

use arcfeed_modal::dynamics::modal::Mode;
use arcfeed_modal::dynamics::transition::Rule;
use arcfeed_modal::dynamics::vibration::Stepping;
use nalgebra::Vector3;

use crate::dynamics::regenerative::Milling;

pub const EXACT: Stepping = Stepping { rule: Rule::Exact, tolerance_mm: 1e-9, iterations_max: 20 };
pub const NEWMARK: Stepping = Stepping { rule: Rule::Newmark, ..EXACT };

/// One mode of set A.
pub fn mode_a(direction: Vector3<f64>) -> Mode {
    Mode::from_stiffness(922.0, 0.011, 1340.049648, &direction).unwrap()
}

fn set_a(modes: Vec<Mode>, spindle_rev_per_min: f64, depth_mm: f64, engaged_rad: [f64; 2]) -> Milling {
    Milling {
        modes,
        teeth: 2,
        specific_mpa: [600.0, 200.0],
        engaged_rad,
        spindle_rev_per_min,
        depth_mm,
        feed_mm_per_tooth: 0.1,
    }
}

fn set_c(spindle_rev_per_min: f64, depth_mm: f64) -> Milling {
    let modes = [Vector3::x(), Vector3::y()].map(|along| Mode::from_stiffness(900.0, 0.03, 9000.0, &along).unwrap());
    Milling {
        modes: modes.to_vec(),
        teeth: 3,
        specific_mpa: [2000.0 * libm::sin(70_f64.to_radians()), 2000.0 * libm::cos(70_f64.to_radians())],
        engaged_rad: [0.0, FRAC_PI_2],
        spindle_rev_per_min,
        depth_mm,
        feed_mm_per_tooth: 0.1,
    }
}

/// By its name in the tables.
pub fn run_of(name: &str) -> Milling {
    let slot = [0.0, PI];
    let down = |ratio: f64| [libm::acos(2.0 * ratio - 1.0), PI];
    let (x, y) = (mode_a(Vector3::x()), mode_a(Vector3::y()));
    match name {
        "A1_slot_5000_w0.20_stable" => set_a(vec![x], 5000.0, 0.2, slot),
        "A1_slot_5000_w0.35_stable" => set_a(vec![x], 5000.0, 0.35, slot),
        "A1_slot_5000_w0.50_unstable" => set_a(vec![x], 5000.0, 0.5, slot),
        "A1_aD0.05down_18000_w2.00_flip" => set_a(vec![x], 18000.0, 2.0, down(0.05)),
        "A2_aD0.50down_15000_w0.20_stable" => set_a(vec![x, y], 15000.0, 0.2, down(0.5)),
        "A2_aD0.50down_15000_w0.40_unstable" => set_a(vec![x, y], 15000.0, 0.4, down(0.5)),
        "C_aD0.50up_9000_w2.00_stable" => set_c(9000.0, 2.0),
        "C_aD0.50up_8500_w3.00_unstable" => set_c(8500.0, 3.0),
        other => panic!("no run {other}"),
    }
}
