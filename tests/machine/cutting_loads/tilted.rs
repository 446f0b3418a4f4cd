//! Cuts under G43.4 with a tilted tool: the same cut, turned, has the same chips and forces, and those of closed forms.

use std::f64::consts::TAU;

use arcfeed_tests::of_full_set;
use fastrand::Rng;
use serde_json::Value;

use crate::cutting_loads::slot_job::{assert_near, block, number, ran, simulation_report};

/// Radius of the tool.
const RADIUS_MM: f64 = 5.0;
/// Distance of the second plunge from the first.
const ASIDE_MM: f64 = 4.0;

/// Positions of A and C.
#[derive(Clone, Copy, Debug)]
struct Tilt {
    a_deg: f64,
    c_deg: f64,
}

impl Tilt {
    /// Point of the tool's frame on the part: A turns about X, then C about Z.
    fn on_part(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = libm::sincos(self.a_deg.to_radians());
        let (y, z) = (y * cos - z * sin, y * sin + z * cos);
        let (sin, cos) = libm::sincos(self.c_deg.to_radians());
        [x * cos - y * sin, x * sin + y * cos, z]
    }

    fn words(self, point: [f64; 3]) -> String {
        let [x, y, z] = self.on_part(point);
        format!("X{x:.6}Y{y:.6}Z{z:.6}")
    }

    /// A bar along the tool, and its job.
    fn job(self, more: &str) -> String {
        let corner = |z: f64| {
            let [x, y, z] = self.on_part([1.3, -0.7, z]);
            format!("[{x:.9}, {y:.9}, {z:.9}]")
        };
        format!(
            "units = \"mm\"\nprogram = \"program.nc\"\n\
             [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 12\n\
             [workpiece]\nround = {{ from = {}, to = {}, radius = 19 }}\nstep = 0.25\n\
             [cutting]\ncutting = [600, 200, 100]\nedge = [10, 5, 2]\naxial_depth = 5\nlayers = 5\n{more}\
             [machine]\npreset = \"mikron-ucp710\"\n\
             [spindle]\nrev_per_min = 3000\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n",
            corner(-12.0),
            corner(0.0)
        )
    }

    /// A plunge, another one beside it, and a slot from its floor, with the rotary axes standing.
    fn program(self) -> String {
        let high = 4.0;
        let to = |x: f64, z: f64| self.words([x, 0.213, z]);
        format!(
            "%\nG21G17G90G94\nS3000M3\nN1G43.4H0\nN2G0Z60.\nG0A{:.3}C{:.3}\nG0{}\nN3G1{}F600.\nN4G0{}\nG0{}\n\
             N5G1{}F600.\nG4P200\nN6G1{}F500.\nN7G0{}\nM30\n%\n",
            self.a_deg,
            self.c_deg,
            to(0.0, high),
            to(0.0, -5.0),
            to(0.0, high),
            to(ASIDE_MM, high),
            to(ASIDE_MM, -5.0),
            to(12.0, -5.0),
            to(12.0, high),
        )
    }

    fn report(self, name: &str, more: &str) -> Value {
        simulation_report(name, &self.job(more), &self.program())
    }
}

const UPRIGHT: Tilt = Tilt { a_deg: 0.0, c_deg: 0.0 };

/// Largest values of a block with the difference that they may have. Where an edge of the side begins and ends its chip is
/// known to half a cell, so its largest torque depends on where the tool stands on the rays when it does: a cell of 0.125 mm at the
/// radius of 5 mm is 0.025 of the chip of one tooth, of which two cut.
const PLUNGE: [(&str, f64); 4] =
    [("/end_chip_max", 1e-6), ("/torque_max_n_m", 1e-6), ("/power_max_w", 1e-6), ("/thrust_max_n", 1e-6)];
const SLOT: [(&str, f64); 5] = [
    ("/chip_max/0", 1e-6),
    ("/force_max_n", 1e-5),
    ("/torque_max_n_m", 0.0125),
    ("/power_max_w", 0.0125),
    ("/thrust_max_n", 0.0125),
];

#[test]
fn the_same_cut_turned_by_any_angles_has_the_same_chips_forces_and_power() {
    let upright = UPRIGHT.report("upright", "");
    let mut random = Rng::with_seed(19);
    let mut worst = 0.0_f64;
    for number_of in 0..of_full_set(12, 3) {
        let tilt = Tilt {
            a_deg: -libm::round(1e3 * (5.0 + 80.0 * random.f64())) / 1e3,
            c_deg: libm::round(1e3 * (720.0 * random.f64() - 360.0)) / 1e3,
        };
        let turned = tilt.report(&format!("turned-{number_of}"), "");
        assert_eq!(turned["loads"]["left_out"].as_array().map(Vec::len), Some(0), "{tilt:?}");
        for (n, pointers) in [(3, &PLUNGE[..]), (5, &PLUNGE[..]), (6, &SLOT[..])] {
            for (pointer, tolerance) in pointers {
                let [found, expected] = [&turned, &upright].map(|report| number(block(report, n), pointer));
                worst = worst.max((found / expected - 1.0).abs() / tolerance);
                assert_near(&format!("{tilt:?} N{n} {pointer}"), found, expected, *tolerance);
            }
        }
    }
    println!("largest difference {worst:.2} of the one allowed");
}

#[test]
fn a_tilted_plunge_and_one_beside_it_have_the_torque_of_closed_forms() {
    let tilt = Tilt { a_deg: -37.25, c_deg: 118.4 };
    let report = tilt.report("crescent", "");
    let chip_mm = 0.05;
    let force_n_per_mm = 600.0 * chip_mm + 10.0;
    let whole_n_m = 4.0 * force_n_per_mm * RADIUS_MM * RADIUS_MM / 2e3;
    assert_near("whole disc, N m", number(block(&report, 3), "/torque_max_n_m"), whole_n_m, 1e-6);
    assert_near("end chip, mm", number(block(&report, 3), "/end_chip_max"), chip_mm, 1e-6);
    // The edge in a direction leaves the earlier disc at this radius.
    let moment_mm2 = |angle_rad: f64| {
        let (sin, cos) = libm::sincos(angle_rad);
        let from_mm = -ASIDE_MM * cos + libm::sqrt(RADIUS_MM * RADIUS_MM - ASIDE_MM * ASIDE_MM * sin * sin);
        ((RADIUS_MM * RADIUS_MM - from_mm * from_mm) / 2.0).max(0.0)
    };
    let sum_mm2 = |turned_rad: f64| (0..4).map(|tooth| moment_mm2(turned_rad + f64::from(tooth) * TAU / 4.0)).sum();
    let most_mm2 = (0..30).map(|step| sum_mm2(f64::from(step) * TAU / 120.0)).fold(0.0, f64::max);
    let crescent_n_m = force_n_per_mm * most_mm2 / 1e3;
    assert_near("beside it, N m", number(block(&report, 5), "/torque_max_n_m"), crescent_n_m, 0.02);
}

#[test]
fn a_tool_whose_axis_turns_in_the_cut_has_no_chips_and_is_named() {
    let tilt = Tilt { a_deg: -20.0, c_deg: 90.0 };
    let program = tilt.program().replace("N6G1", "N6G1A-25.");
    let (code, report, complaints) = ran("turns", &tilt.job(""), &program);
    let report: Value = serde_json::from_str(&report).expect("one object");
    println!("{complaints}");
    assert!(code == Some(0) && complaints.contains("the tool's axis turns on the part"), "{complaints}");
    assert_eq!(report["loads"]["left_out"][0]["cause"], "axis-turns");
    assert_eq!(report["loads"]["left_out"][0]["first_n"], 6);
}

#[test]
fn a_tilted_tool_with_modes_has_a_verdict_on_its_chatter() {
    let modes = "modes = [{ frequency = 900, damping = 0.03, stiffness = 8000, direction = [1, 0, 0] }]\n";
    let verdict = |tilt: Tilt, name: &str| {
        let vibration = tilt.report(name, modes)["loads"]["vibration"].clone();
        let unsteady: Vec<(Value, Value)> = vibration["unstable"]
            .as_array()
            .expect("a list")
            .iter()
            .map(|block| (block["n"].clone(), block["verdict"].clone()))
            .collect();
        (number(&vibration, "/metric_max"), unsteady)
    };
    let (upright, turned) = (verdict(UPRIGHT, "modes"), verdict(Tilt { a_deg: -61.0, c_deg: -33.0 }, "modes-turned"));
    println!("{upright:?} {turned:?}");
    assert!(turned.1 == upright.1 && turned.1.contains(&(6.into(), "chatter".into())), "{turned:?}");
    assert_near("change from tooth to tooth, mm", turned.0, upright.0, 0.05);
}

#[test]
fn a_tilted_tool_has_no_chips_in_a_flexible_workpiece_and_is_named() {
    let flexible = "[workpiece.flexible]\nblock = { from = [-10, -10, -12], to = [20, 10, -6], cells = [4, 2, 1], clamped = \"x-\" }\n\
                    material = \"Ti-6Al-4V\"\nmodes = 2\ndamping = 0.03\n";
    let job = format!(
        "units = \"mm\"\nprogram = \"program.nc\"\n\
         [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 30\n\
         [workpiece]\nblock = {{ from = [-10, -10, -12], to = [20, 10, 0] }}\nstep = 1\n{flexible}\
         [cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 4\n\
         [machine]\npreset = \"mikron-ucp710\"\n\
         [spindle]\nrev_per_min = 3000\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n"
    );
    let program =
        "%\nG21G17G90G94\nS3000M3\nN1G0X0.Y0.\nN2G0Z5.\nN3G43.4H0\nN4G0A-20.C90.\nN5G1Z-1.F400.\nN6G0Z5.\nM30\n%\n";
    let (code, report, complaints) = ran("tilted-flexible", &job, program);
    println!("{complaints}");
    let report: Value = serde_json::from_str(&report).expect("one object");
    assert!(
        code == Some(0) && complaints.contains("no chips and forces in 1 block: the tool is tilted"),
        "{complaints}"
    );
    assert_eq!(report["loads"]["left_out"][0]["cause"], "tilted");
}
