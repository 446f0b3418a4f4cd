//! A flexible workpiece: a strip held at one end and cut along its length, against the beam in closed form; its frequencies
//! against plate theory; and what is wrong with such a table.

use serde_json::Value;

use crate::cutting_loads::slot_job::{assert_plate, assert_refused, number, simulation_report};

/// A strip along X in front of the XZ plane, with a layer of stock on it, and what is in `[workpiece.flexible]` and `[cutting]`.
#[derive(Clone, Copy, Debug)]
struct Strip<'a> {
    thickness_mm: f64,
    stock_mm: f64,
    axial_depth_mm: f64,
    step_mm: f64,
    rev_per_min: f64,
    feed_mm_per_tooth: f64,
    /// None of a rigid one.
    flexible: Option<&'a str>,
    cutting: &'a str,
}

const LENGTH_MM: f64 = 60.0;
const HEIGHT_MM: f64 = 8.0;
const RADIUS_MM: f64 = 5.0;

impl Strip<'_> {
    fn job(&self) -> String {
        let Strip { thickness_mm, stock_mm, axial_depth_mm, step_mm, rev_per_min, .. } = *self;
        let body = |rest: &str| {
            format!(
                "[workpiece.flexible]\nblock = {{ from = [0, -{thickness_mm}, -{HEIGHT_MM}], to = [{LENGTH_MM}, 0, 0], \
                 cells = [12, 1, 2], clamped = \"x-\" }}\n{rest}"
            )
        };
        format!(
            "units = \"mm\"\nprogram = \"program.nc\"\n\
             [tool]\nkind = \"end-mill\"\ndiameter = {}\nteeth = 2\nheight = {HEIGHT_MM}\n\
             [workpiece]\nblock = {{ from = [0, -{thickness_mm}, -{HEIGHT_MM}], to = [{LENGTH_MM}, {stock_mm}, 0] }}\n\
             step = {step_mm}\n{}[cutting]\naxial_depth = {axial_depth_mm}\n{}\
             [spindle]\nrev_per_min = {rev_per_min}\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n",
            2.0 * RADIUS_MM,
            self.flexible.map(body).unwrap_or_default(),
            self.cutting
        )
    }

    /// Climb milling from the clamp to the free end, a block every 10 mm, its N the place of its end.
    fn simulation_report(&self, name: &str) -> Value {
        let feed = 2.0 * self.feed_mm_per_tooth * self.rev_per_min;
        let program = format!(
            "%\nG21G17G90G94\nN1G0X-8.Y{RADIUS_MM:.1}\nN2G0Z5.\nN3G1Z-{:.3}F2000.\nN10G1X10.F{feed:.3}\nN20X20.\nN30X30.\nN40X40.\n\
             N50X50.\nN60X60.\nN70X68.\nN80G0Z5.\nN90M30\n%\n",
            self.axial_depth_mm
        );
        simulation_report(name, &self.job(), &program)
    }
}

/// Whose edges push aside with 0.0625 N/mm while they are in, and hardly do more for thicker chips.
const PUSHED: Strip<'_> = Strip {
    thickness_mm: 3.0,
    stock_mm: 2.0,
    axial_depth_mm: HEIGHT_MM,
    step_mm: 0.1,
    rev_per_min: 3000.0,
    feed_mm_per_tooth: 0.04,
    flexible: Some("material = \"structural steel\"\nmodes = 3\ndamping = 0.7\n"),
    cutting: "cutting = [0.1, 0, 0]\nedge = [0, 0.0625, 0]\n",
};

#[test]
fn a_strip_is_left_as_thick_as_a_beam_is_bent_by_the_force() {
    let report = PUSHED.simulation_report("pushed");
    let marks = report["loads"]["marks"]["blocks"].as_array().expect("a list");
    let (young_mpa, shear_mpa) = (210e3, 210e3 / 2.6);
    let area_mm2 = HEIGHT_MM * PUSHED.thickness_mm;
    let inertia_mm4 = area_mm2 * PUSHED.thickness_mm * PUSHED.thickness_mm / 12.0;
    let force_n = 0.0625 * HEIGHT_MM;
    for n in [30, 40, 50] {
        let found_mm = number(marks.iter().find(|block| block["n"] == n).expect("a wall"), "/max");
        // The last ray before the block's end.
        let x_mm = f64::from(n) - PUSHED.step_mm / 2.0;
        // At 702 Hz and 0.7 of critical damping the strip follows a force by 2 zeta omega / omega_1 of a turn later: that of an edge that was so far ahead of
        // the wall it makes, and looked so far away from it.
        let lag_rad = 2.0 * 0.7 * PUSHED.rev_per_min / 60.0 / 702.0;
        let (sin, cos) = libm::sincos(lag_rad);
        let pushed_mm = x_mm + RADIUS_MM * sin;
        let bent_mm = x_mm * x_mm * (3.0 * pushed_mm - x_mm) / (6.0 * young_mpa * inertia_mm4)
            + x_mm / (5.0 / 6.0 * shear_mpa * area_mm2);
        let truth_mm = force_n * cos * bent_mm;
        let off = found_mm / truth_mm - 1.0;
        println!("{n} mm from the clamp: {found_mm:.6} mm, a beam's {truth_mm:.6}: {off:+.1e}");
        // The mesh's own K^-1 has 98.4 % of a beam's bend at the tip, three modes 99.5 % of that. Cusps of 4e-5 mm stand on the wall.
        assert!((-0.03..0.0).contains(&off));
    }
}

#[test]
fn it_chatters_where_its_first_mode_says() {
    // A limit of depth goes with the inverse of phi^2, phi the first mode of a clamped beam, 1 at its tip: 0.115 at 30, 0.298 at 40, 0.594 at 50 mm
    // from the clamp. One limit at the tip, from 3 x 0.115 to 0.594 mm, is to explain what each of three depths does.
    let phi_square = |x_mm: f64| {
        let (root, ratio) = (1.875_104, 0.734_096);
        let at = root * x_mm / LENGTH_MM;
        let shape = libm::cosh(at) - libm::cos(at) - ratio * (libm::sinh(at) - libm::sin(at));
        shape * shape / 4.0
    };
    let (mut above_mm, mut below_mm) = (0.0_f64, f64::INFINITY);
    for (depth_mm, unsteady) in [(0.3, &[][..]), (1.0, &[50, 60]), (3.0, &[40, 50, 60])] {
        let strip = Strip {
            thickness_mm: 6.0,
            stock_mm: 1.0,
            axial_depth_mm: depth_mm,
            step_mm: 0.25,
            rev_per_min: 5000.0,
            feed_mm_per_tooth: 0.05,
            flexible: Some("material = \"structural steel\"\nmodes = 2\ndamping = 0.03\n"),
            cutting: "cutting = [600, 200, 0]\nedge = [0, 0, 0]\n",
        };
        let report = strip.simulation_report("chatters");
        let blocks = report["loads"]["vibration"]["unstable"].as_array().expect("a list").iter();
        let found: Vec<i64> = blocks.map(|block| block["n"].as_i64().expect("a number")).collect();
        println!("{depth_mm} mm: not steady {found:?}");
        assert_eq!(found, unsteady);
        let first_mm = unsteady.first().map_or(LENGTH_MM + 10.0, |n| *n as f64);
        above_mm = above_mm.max(depth_mm * phi_square(first_mm - 10.0));
        below_mm = below_mm.min(depth_mm * if unsteady.is_empty() { f64::INFINITY } else { phi_square(first_mm) });
    }
    println!("a limit at the tip from {above_mm:.3} to {below_mm:.3} mm");
    assert!(above_mm < below_mm);
}

#[test]
fn a_strip_too_stiff_to_move_is_a_rigid_one() {
    // As fast as a strip of steel and 4000 times as stiff, under forces a thousand-millionth of the usual ones; steps of 3 degrees are short enough for it.
    let stiff = "young = 8.4e8\npoisson = 0.3\ndensity = 3.14e7\nmodes = 1\ndamping = 0.03\n";
    let strip = Strip {
        step_mm: 0.25,
        rev_per_min: 12_000.0,
        flexible: Some(stiff),
        cutting: "cutting = [600e-9, 200e-9, 0]\nedge = [20e-9, 10e-9, 0]\n",
        ..PUSHED
    };
    let given = strip.simulation_report("stiff");
    let rigid = Strip { flexible: None, ..strip }.simulation_report("rigid");
    let fields =
        ["load/force_max_n", "load/force_mean_n", "load/torque_mean_n_m", "load/chip_mean/0", "marks/max", "marks/rms"];
    for field in fields {
        let [given, rigid] = [&given, &rigid].map(|report| number(report, &format!("/loads/{field}")));
        println!("{field}: {given} {rigid}");
        // Marks are differences of places some 60 mm away, in f64.
        let rounding = if field.starts_with("marks") { 1e-12 } else { 0.0 };
        assert!((given - rigid).abs() < 1e-9 * rigid + rounding, "{field}");
    }
    assert!(rigid["loads"]["vibration"].is_null() && given["loads"]["vibration"]["unstable"] == serde_json::json!([]));
}

#[test]
fn the_fastest_mode_that_swings_by_more_than_a_twentieth_of_the_feed_sets_the_step() {
    // 702, 1841 and 4371 Hz; a force of 1 N, and one of 1000 N.
    for (edge, mode) in [("0.0625", 0), ("62.5", 2)] {
        let job = PUSHED.job().replace("edge = [0, 0.0625, 0]", &format!("edge = [0, {edge}, 0]"));
        let report = simulation_report("step", &job, "%\nG21G17G90G94\nN1G0X-80.Y0.\nN2G1Z5.F2000.\nN3M30\n%\n");
        let hz = number(&report, &format!("/loads/vibration/workpiece_hz/{mode}"));
        let steps = 360.0 * PUSHED.rev_per_min / 60.0 / hz / number(&report, "/loads/step_deg");
        println!("{edge} N/mm: {steps:.2} steps a period of {hz:.0} Hz");
        // A whole number of steps goes from tooth to tooth.
        assert!((25.0..25.5).contains(&steps));
    }
}

#[test]
fn a_plate_held_at_any_face_has_the_frequencies_of_the_table() {
    for (name, cells, clamped) in [("foot", "[12, 1, 16]", "z-"), ("side", "[16, 1, 12]", "x+")] {
        let job = PUSHED.job().replace(
            "from = [0, -3, -8], to = [60, 0, 0], cells = [12, 1, 2], clamped = \"x-\"",
            &format!("from = [0, 0, -100], to = [100, 2, 0], cells = {cells}, clamped = \"{clamped}\""),
        );
        let job = job.replace("modes = 3", "modes = 5");
        assert!(job.contains(cells) && job.contains("modes = 5"));
        let report = simulation_report(
            &format!("plate-{name}"),
            &job,
            "%\nG21G17G90G94\nN1G0X-80.Y0.\nN2G1Z5.F2000.\nN3M30\n%\n",
        );
        assert_plate(clamped, &report);
    }
}

#[test]
fn every_mistake_has_a_place_and_says_what_to_do() {
    let job = PUSHED.job();
    let mistakes = [
        ("to = [60, 0, 0], cells", "to = [60, -3, 0], cells", ":12:9: `from` must be below `to` in X, Y and Z"),
        (
            "from = [0, -3, -8], to = [60, 0, 0], cells",
            "from = [0, 3, -8], to = [60, 6, 0], cells",
            ":11:1: the flexible part has nothing in common with the workpiece",
        ),
        ("[12, 1, 2]", "[12, 0, 2]", ":12:56: cells along X, Y and Z: 1 or more each"),
        ("[12, 1, 2]", "[100, 10, 10]", ":12:56: cells along X, Y and Z: 1 or more each"),
        ("\"x-\"", "\"left\"", ":12:78: no such face; write \"x-\", "),
        (
            "\"structural steel\"",
            "\"steel\"",
            ":13:12: how stiff `steel` is is not known; write one of \"Ti-6Al-4V\", ",
        ),
        ("material = \"structural steel\"\n", "", ":11:1: say what it is made of"),
        ("material = \"structural steel\"\n", "young = 2e5\npoisson = 0.5\ndensity = 1\n", ":14:11: poisson must be"),
        (
            "material = \"structural steel\"\n",
            "young = 0\npoisson = 0.3\ndensity = 1\n",
            ":13:9: young, N/mm2, must be",
        ),
        ("modes = 3", "modes = 101", ":14:9: modes must be 1 to 100"),
        ("damping = 0.7", "damping = 1", ":15:11: damping, a part of the critical one"),
        (
            "[cutting]\naxial_depth = 8\ncutting = [0.1, 0, 0]\nedge = [0, 0.0625, 0]\n",
            "",
            ":11:1: [workpiece.flexible] needs [cutting]",
        ),
    ];
    assert_refused("held", &job, &mistakes);
}
