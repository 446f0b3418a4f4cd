//! Volumes removed by programs, compared with closed forms: areas of `tests/machine/stock/mrr_checks.csv` times a
//! depth.

use std::f64::consts::PI;

use crate::cutting_stock::scratch_job::{MILL, SLOT, ScratchJob};

const MM_PER_IN: f64 = 25.4;

/// Depth of the ring's cuts, in.
const LEVEL_IN: f64 = 0.0938;

/// Values of the file by their names; made outside of this project, with numpy and scipy.
fn published(check: &str) -> f64 {
    let lines = include_str!("../stock/mrr_checks.csv").lines();
    let rest = lines.map(|line| line.trim_start_matches('"')).find_map(|line| line.strip_prefix(check)).expect(check);
    rest.split(',').nth(1).expect("a value").parse().expect("a number")
}

/// Mean of the bounds that an independent program of the same model kept on a slot: 0.30 h/R on end, 0.10 (h/R)^1.5 lying.
fn slot_bound(step_ratio: f64) -> f64 {
    (0.30 * step_ratio + 0.20 * libm::pow(step_ratio, 1.5)) / 3.0
}

#[test]
fn a_slot_takes_twice_radius_times_length_and_its_plunge_a_disc() {
    let output = ScratchJob::new("slot", MILL, SLOT).run(&[]);
    let stadium_cm3 = published("same, full swept (stadium)") * 4.0 / 1e3;
    let off = output.material("/removal/removed") / stadium_cm3 - 1.0;
    let (plunge, slot) =
        (output.removed(3) / (PI * 25.0 * 4.0 / 1e3), output.removed(4) / (2.0 * 5.0 * 40.0 * 4.0 / 1e3));
    println!("slot of {stadium_cm3:.6} cm3: off by {off:+.1e}; plunge {:+.1e}, slot {:+.1e}", plunge - 1.0, slot - 1.0);
    assert!(off.abs() <= slot_bound(0.05) && (plunge - 1.0).abs() <= 6e-3 && (slot - 1.0).abs() <= 6e-3);
    let whole_cm3 = 60.0 * 20.0 * 12.0 / 1e3;
    assert!((output.material("/removal/removed") + output.material("/left") - whole_cm3).abs() < 1e-9);
    assert_eq!((output.complaints.as_str(), output.material("/at_rapid")), ("", 0.0));
}

#[test]
fn rates_are_section_times_feed() {
    let output = ScratchJob::new("rate", MILL, SLOT).run(&[]);
    let block = output.block(4).expect("the slot cuts");
    // 10 mm by 4 mm at 600 mm/min. A window is four steps long or more, so that a ray more or less is a quarter at most.
    let (mean, max) = (block["removal"]["rate_mean"].as_f64().unwrap(), block["removal"]["rate_max"].as_f64().unwrap());
    println!("mean {mean:.4}, largest {max:.4}, of 24 cm3/min");
    assert!((mean / 24.0 - 1.0).abs() < 6e-3 && (1.0..1.25).contains(&(max / 24.0)));
    let seconds = block["removal"]["cutting_time_s"].as_f64().unwrap();
    // A little longer, as it begins and ends at rest.
    assert!((4.0..4.02).contains(&seconds), "{seconds} s for 40 mm at 600 mm/min");
}

/// A ring that turns by an angle about the origin, its centre at the distance of one of its circles, a level deep.
fn ring(name: &str, radius_in: f64, angle_deg: f64, stock_from_in: [f64; 2], step: &str) -> f64 {
    let (sin, cos) = libm::sincos(angle_deg.to_radians());
    let program = format!(
        "%\nG20G17G90G94\nN1G0X{radius_in:.6}Y0.\nN2G0Z1.\nN3G1Z0.F60.\nN4G3X{:.6}Y{:.6}I-{radius_in:.6}J0.F25.\nN5G0Z1.\nN6M30\n%\n",
        radius_in * cos,
        radius_in * sin
    );
    let [x, y] = stock_from_in;
    let job = format!(
        "units = \"inch\"\nprogram = \"program.nc\"\n[tool]\nkind = \"cup-mill\"\nouter_radius = 5.06205\n\
         inner_radius = 4.43706\nactive_teeth = 10\nheight = 1\n[spindle]\nrev_per_min = 1000\n\
         [law]\nkind = \"programmed\"\nfeed_per_tooth = 0.004\n\
         [workpiece]\nblock = {{ from = [{x}, {y}, 0], to = [11, 11, {LEVEL_IN}] }}\nstep = {step}\n"
    );
    ScratchJob::new(name, &job, &program).run(&[]).removed(4)
}

#[test]
fn a_cup_mill_takes_what_the_closed_forms_say() {
    for (name, radius_in, angle_deg, from, check) in [
        ("r5", 4.43706, 5.0, [-2.0, -6.0], "cup interior pivot d=r phi=5 ADDED area (unbounded stock)"),
        ("R5", 5.06205, 5.0, [-2.0, -6.0], "cup exterior pivot d=R phi=5 ADDED area (unbounded stock)"),
        ("r20c4", 4.43706, 20.0, [4.0, -6.0], "cup interior pivot d=r halfplane n@0deg c=4.0 phi=20: ADDED area"),
        ("R20c4", 5.06205, 20.0, [4.0, -6.0], "cup exterior pivot d=R halfplane n@0deg c=4.0 phi=20: ADDED area"),
        ("r20c1", 4.43706, 20.0, [-6.0, 1.0], "cup interior pivot d=r halfplane n@90deg c=1.0 phi=20: ADDED area"),
    ] {
        let exact_in3 = published(check) * LEVEL_IN;
        let removed_in3 = ring(name, radius_in, angle_deg, from, "0.0469");
        let off = removed_in3 / exact_in3 - 1.0;
        println!("{check}: {exact_in3:.6} in3, off by {off:+.1e}");
        // docs/stock.md: at 1 mm between rays up to 9.6e-3 lying, 1.7e-2 on end, relative to single cuts.
        assert!(off.abs() <= 1.2e-2 * (0.0469 * MM_PER_IN), "{check}: {off}");
    }
}

#[test]
fn the_adapted_program_takes_the_same_in_less_time() {
    let output = arcfeed_tests::run(&["simulate", "examples/ibr-slot/job.toml", "--json"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
    let number = |run: &str, field: &str| report["material"][run][field].as_f64().expect("a number");
    let [after, before] = ["removal", "baseline"].map(|run| number(run, "removed"));
    println!(
        "{before:.4} in3 before, {after:.4} after; {:.1} s, {:.1} s",
        number("baseline", "cutting_time_s"),
        number("removal", "cutting_time_s")
    );
    assert!(after > 5.0 && (after / before - 1.0).abs() < 1e-3);
    assert!(number("removal", "rate_mean") > 1.2 * number("baseline", "rate_mean"));
    let left = report["material"]["left"].as_f64().expect("a number");
    // The block's Z is no whole number of steps; its cells stand for as much as they are.
    assert!((after + left - 6.5 * 4.0 * 1.7062).abs() < 0.02 * 6.5 * 4.0 * 1.7062, "{after} {left}");
}
