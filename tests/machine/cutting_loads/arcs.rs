//! A cup mill that turns about a point of its ring: chips that its edges find in the block against the geometric meter, which
//! knows nothing of the block but the line of the rule, and what the law makes of forces.

use std::sync::LazyLock;

use serde_json::Value;

use crate::cutting_loads::slot_job::{number, simulation_report};

const INNER_IN: f64 = 4.43706;
/// The block's edge, and the rule's line; square to Y.
const EDGE_IN: f64 = 4.5;

/// Report of the turn.
static REPORT: LazyLock<Value> = LazyLock::new(turn);

/// The ring sinks into the block, then turns by 12 degrees about the origin, on its inner circle.
fn turn() -> Value {
    let (sin, cos) = libm::sincos(12.0_f64.to_radians());
    let program = format!(
        "%\nG20G17G90G94\nN1G0X{INNER_IN}Y0.\nN2G0Z1.\nN3G1Z0.F60.\nN4G3X{:.6}Y{:.6}I-{INNER_IN}J0.F25.\nN5G0Z1.\nN6M30\n%\n",
        INNER_IN * cos,
        INNER_IN * sin
    );
    let job = format!(
        "units = \"inch\"\nprogram = \"program.nc\"\n[tool]\nkind = \"cup-mill\"\nouter_radius = 5.06205\n\
         inner_radius = {INNER_IN}\nactive_teeth = 10\nheight = 1\n[spindle]\nrev_per_min = 1000\nset_by = \"operator\"\n\
         [limits]\nmax_feed = \"90000 mm\"\nmax_raise = 100\n[law]\nkind = \"circumference\"\nfeed_per_tooth = 0.004\n\
         [[cut]]\nrotation = \"interior\"\ndirection = \"ccw\"\nside = \"outer\"\n\
         stock = {{ normal_deg = 90, offset = {EDGE_IN} }}\n\
         [workpiece]\nblock = {{ from = [-2, -6, 0], to = [11, {EDGE_IN}, 0.09] }}\nstep = 0.03\n\
         [cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 0.09\n"
    );
    simulation_report("arc", &job, &program)
}

#[test]
fn chips_are_those_of_the_geometric_meter_where_the_stock_is_the_same() {
    let report = &*REPORT;
    let movement = &report["movements"][0];
    for (circle, name) in ["outer", "inner"].iter().enumerate() {
        let found = number(report, &format!("/loads/rules/0/load/chip_max/{circle}"));
        let meter = 0.004 * number(movement, &format!("/thickest_ratio/{circle}"));
        let off = found / meter - 1.0;
        println!("{name} edges: {found:.6} in, by the meter {meter:.6}: {off:+.1e}");
        assert!(off.abs() <= 5e-3);
    }
}

#[test]
fn the_adapted_program_loads_the_tool_more_by_what_its_chips_are_thicker() {
    let report = &*REPORT;
    let of = |run: &str, field: &str| number(report, &format!("/loads/rules/0/{run}/{field}"));
    let thicker = of("load", "chip_mean/0") / of("baseline", "chip_mean/0");
    let stronger = of("load", "torque_mean_n_m") / of("baseline", "torque_mean_n_m");
    // Kienzle's force grows with the power 1 - mc of the chip.
    let expected = libm::pow(thicker, 1.0 - 0.22);
    println!("chips {thicker:.4} times as thick, torque {stronger:.4} times, {expected:.4} by hand");
    assert!(thicker > 1.2 && (stronger / expected - 1.0).abs() < 5e-3);
    assert!(number(report, "/cycle_time_s") < number(report, "/baseline_cycle_time_s"));
}
