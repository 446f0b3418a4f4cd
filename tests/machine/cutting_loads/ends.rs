//! Plunges and ramps through the whole command: what the edges on the tool's end find there, against closed forms.

use std::f64::consts::TAU;

use arcfeed_tests::{Scratch, root, run};

use crate::cutting_loads::slot_job::{assert_near, block, number, simulation_report};

/// Four teeth of 10 mm, 3000 rev/min.
fn job(cutting: &str) -> String {
    format!(
        "units = \"mm\"\nprogram = \"program.nc\"\n\
         [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 8\n\
         [workpiece]\nblock = {{ from = [-8, -8, -9], to = [40, 8, 0] }}\nstep = 0.25\n\
         [cutting]\n{cutting}\
         [spindle]\nrev_per_min = 3000\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n"
    )
}

const LINEAR: &str = "cutting = [600, 200, 0]\nedge = [0, 0, 0]\naxial_depth = 4\n";

/// Relative; a floor that is evenly high is measured to the last digits.
const NEAR: f64 = 1e-9;

#[test]
fn a_plunge_has_torque_power_and_thrust_in_closed_form() {
    // 0.05 mm a tooth.
    let program = "%\nG21G17G90G94\nN1G0X.013Y.021\nN2G0Z5.\nN3G1Z-4.F600.\nN4G0Z5.\nN5M30\n%\n";
    let report = simulation_report("plunge", &job(LINEAR), program);
    let load = block(&report, 3);
    let torque_n_m = 4.0 * 600.0 * 0.05 * 12.5e-3;
    assert_near("end chip, mm", number(load, "/end_chip_max"), 0.05, NEAR);
    assert_near("largest torque, N m", number(load, "/torque_max_n_m"), torque_n_m, NEAR);
    assert_near("largest power, W", number(load, "/power_max_w"), TAU * 50.0 * torque_n_m, NEAR);
    assert_near("largest thrust, N", number(load, "/thrust_max_n"), 4.0 * 200.0 * 0.05 * 5.0, NEAR);
    // All of the hole but what the rapid back leaves standing on its floor, up to 0.05 mm of 4.
    let work = number(load, "/torque_mean_n_m") * number(load, "/time_s") * TAU * 50.0 * 1e3;
    assert_near("work, N mm", work, 600.0 * TAU / 2.0 * 25.0 * 4.0, 0.05 / 4.0);
    assert!(
        number(load, "/force_max_n") < 1.0 && load["force_variation_ratio"].is_null() && load["chip_max"][0].is_null()
    );
}

#[test]
fn a_ramp_has_the_chips_of_side_and_end_and_the_work_of_its_volume() {
    // 3 in 30; 4 teeth of 0.1 mm.
    let program = "%\nG21G17G90G94\nN1G0X.013Y.021\nN2G0Z.05\nN3G1Z0.F600.\nN4G1X30.013Z-3.F1200.\nN5G0Z5.\nN6M30\n%\n";
    let report = simulation_report("ramp", &job(LINEAR), program);
    let load = block(&report, 4);
    let sin = 0.1 / libm::sqrt(1.01);
    assert_near("side chip, mm", number(load, "/chip_max/0"), 0.1 * libm::sqrt(1.0 - sin * sin), 3e-3);
    // Near the axis a place is passed later by the tool's way over its distance: to half a cell, in the mean along the edge, and two steps of 30.
    let later = 0.1 / 5.0 / (TAU / 4.0) * libm::log(5.0 / 0.125) + 2.0 / 30.0;
    assert_near("end chip, mm", number(load, "/end_chip_max"), 0.1 * sin * (1.0 + later / 2.0), later / 2.0);
    // A quarter of a turn, 5 ms, goes by from tooth to tooth, in whatever time the tip comes down by 3 mm.
    let impulse_n_s = number(load, "/thrust_mean_n") * number(load, "/time_s");
    assert_near("thrust times time, N s", impulse_n_s, 4.0 * 200.0 * 5.0 * 3.0 * 0.005, 2e-3);
    let work = number(load, "/torque_mean_n_m") * number(load, "/time_s") * TAU * 50.0 * 1e3;
    // The side takes a slot 10 mm wide, half a chip nearer to the axis than its edge is, the end a disc 3 mm deep.
    let farther = 1.0 + TAU / 8.0 * 0.1 / 10.0;
    assert_near("work, N mm", work, 600.0 * (10.0 * 30.0 * 1.5 * farther + TAU / 2.0 * 25.0 * 3.0), 4e-3);
}

#[test]
fn layers_do_not_show_in_a_ramp() {
    let program = "%\nG21G17G90G94\nN1G0X.013Y.021\nN2G0Z.05\nN3G1Z0.F600.\nN4G1X30.013Z-3.F1200.\nN5G0Z5.\nN6M30\n%\n";
    let of = |layers: usize| simulation_report("layers", &job(&format!("{LINEAR}layers = {layers}\n")), program);
    let [one, ten] = [of(1), of(10)];
    for (pointer, tolerance) in [("/force_max_n", NEAR), ("/torque_max_n_m", NEAR), ("/torque_mean_n_m", 1e-4)] {
        assert_near(pointer, number(block(&ten, 4), pointer), number(block(&one, 4), pointer), tolerance);
    }
}

#[test]
fn a_spindle_that_turns_backwards_is_reported_to_have_no_chips() {
    let scratch = Scratch::new("loads-backwards");
    scratch.write("program.nc", "%\nG21G17G90G94\nS3000M4\nN1G0X0.Y0.\nN2G0Z5.\nN3G1Z-4.F400.\nN4G1X10.\nN5M30\n%\n");
    let machine = std::fs::read_to_string(root().join("host/adapt/machines/mikron-ucp710.toml")).expect("a machine");
    scratch.write("machine.toml", format!("{machine}[spindle]\nrun_up = 30000\nrun_down = 30000\nwaits = true\n"));
    let job = scratch.write("job.toml", format!("{}[machine]\nfile = \"machine.toml\"\n", job(LINEAR)));
    let output = run(&["simulate", &job, "--json"]);
    let complaints = String::from_utf8_lossy(&output.stderr);
    println!("{complaints}");
    assert!(complaints.contains("no chips and forces in 2 blocks: the spindle turns backwards"));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert_eq!(report["loads"]["left_out"][0]["cause"], "backwards");
    assert_eq!(report["loads"]["blocks"].as_array().map(Vec::len), Some(0));
}
