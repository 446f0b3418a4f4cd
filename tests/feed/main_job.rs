//! The main job: a published cup-mill program in, constant chip load out of the simulated machine; and the proof that
//! the measurement notices when it is not.

use arcfeed::adapt::adapt;
use arcfeed::commands::simulate::run_figures::measure;
use arcfeed::commands::simulate::run_in_memory;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed::report::chip_load::ChipLoadFigures;
use arcfeed::report::figures::{MovementFigures, RunReport};
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_nc::block::Reading;
use arcfeed_tests::root;

/// Largest excess of a chip over its target, in any sample, relative.
const THICK_RATIO: f64 = 0.005;
/// Largest fraction of the steady samples that may be thinner than -2 % (1 % is the control's step, rounded down): the
/// override falls before the end of an arc if the next block begins with less.
const THIN_SHARE: f64 = 0.06;

fn job() -> (JobFile, Program) {
    let path = root().join("examples/ibr-slot/job.toml");
    let file = JobFile::load(&path).expect("the example's job is sound");
    let program = Program::load(&file.program, file.job.unit, Reading::Lenient).expect("the example has a program");
    (file, program)
}

/// Runs the adapted program on a machine whose controller has a fault.
fn run(fault: ControllerFault) -> RunReport {
    let (file, program) = job();
    let text = adapt(&program, &file.job).text;
    measure(&run_in_memory(&file, &text, fault).expect("the program ends"), &file.job)
}

/// Runs the program as it is, without a controller.
fn run_unadapted() -> RunReport {
    let (file, program) = job();
    measure(&run_in_memory(&file, program.bytes(), ControllerFault::LawOff).expect("the program ends"), &file.job)
}

fn chip_load(movement: &MovementFigures) -> ChipLoadFigures {
    movement.chip_load.expect("every movement is measured")
}

/// Whether each movement's chips are within their bounds; prints their range.
fn kept(report: &RunReport) -> Vec<bool> {
    let is_kept = |movement: &MovementFigures| {
        let ChipLoadFigures { error_ratio_min, error_ratio_max_all, samples_thin, samples, .. } = chip_load(movement);
        let thin = samples_thin as f64 / samples as f64;
        let [least, most, share] = [error_ratio_min, error_ratio_max_all, thin].map(|ratio| 1e2 * ratio);
        println!("movement {}: {least:+.2} .. {most:+.2} %, {share:.1} % thin", movement.rule);
        error_ratio_max_all <= THICK_RATIO && thin <= THIN_SHARE
    };
    report.movements.iter().map(is_kept).collect()
}

#[test]
fn the_measured_feed_per_tooth_stays_at_its_target_on_every_movement() {
    let report = run(ControllerFault::None);
    assert_eq!(kept(&report), [true; 4]);
    assert!(report.alarms.is_empty());
}

#[test]
fn the_override_is_at_work_where_the_feed_must_vary() {
    let report = run(ControllerFault::None);
    for (movement, least) in report.movements.iter().zip([0, 10, 0, 4]) {
        println!("movement {}: changes per arc {:?}", movement.rule, movement.changes_per_arc);
        assert_eq!(movement.changes_per_arc.len(), 5);
        assert!(movement.changes_per_arc.iter().all(|changes| *changes >= least));
    }
    let top = |rule: usize| report.movements[rule].r#override.map(|figures| figures.max);
    // Table 5.4: 48.0 over 41.0 and 50.6 over 40.0, so 117 and 125 at the arcs' ends, where the block behind allows 100.
    assert_eq!((top(1), top(3)), (Some(116), Some(118)));
}

#[test]
fn the_unadapted_program_thins_the_chips_by_a_half_and_spreads_them() {
    let report = run_unadapted();
    let figures = report.chip_load.expect("the arcs are measured");
    let [min, max, target] = [figures.min, figures.max, figures.target].map(|value| value.expect("one target"));
    println!("unadapted: {min:.5} .. {max:.5} {}, target {target:.5}", report.unit);
    assert!(max / min > 1.8, "{figures:?}");
    assert_eq!(kept(&report), [false; 4]);
    // F25 is 25 in/min: 0.0025 in a tooth at the centre, and no chip is thicker than that.
    assert!((max - 0.0025).abs() < 2e-5);
}

#[test]
fn most_samples_count_and_the_others_are_accounted_for() {
    let figures = run(ControllerFault::None).chip_load.expect("the arcs are measured");
    let left_out = figures.left_out;
    assert_eq!(left_out.not_steady + left_out.block_end + left_out.no_contact, figures.samples_left_out);
    assert_eq!(left_out.no_contact, 0);
    assert!(figures.samples_left_out * 10 < figures.samples, "{figures:?}");
}

#[test]
fn without_the_law_the_measurement_falls_outside() {
    assert_eq!(kept(&run(ControllerFault::LawOff)), [true, false, false, false]);
}

#[test]
fn a_law_fed_a_wrong_radius_is_found_out() {
    assert_eq!(kept(&run(ControllerFault::RadiusScale(1.05))), [false; 4]);
}

#[test]
fn a_frozen_controller_is_found_out() {
    let ticks_to_the_middle = 30_000;
    assert_eq!(kept(&run(ControllerFault::FrozenAfter(ticks_to_the_middle))), [false; 4]);
}

#[test]
fn the_program_of_the_example_is_made_of_its_sourced_figures() {
    let folder = root().join("examples/ibr-slot");
    let (_, program) = job();
    let mut points = Vec::new();
    for line in std::fs::read_to_string(folder.join("figures.csv")).expect("the figures lie there").lines().skip(5) {
        let cells: Vec<&str> = line.split(',').collect();
        let point = |x: &str, y: &str| (x.to_owned(), y.to_owned());
        if !cells[3].is_empty() {
            points.push(point(cells[3], cells[4]));
        }
        points.push(point(cells[6], cells[7]));
    }
    let text = String::from_utf8(program.bytes().to_vec()).expect("the program is text");
    for (x, y) in &points {
        assert!(text.contains(&format!("X{x}Y{y}")), "limit point {x}, {y}");
    }
    assert_eq!(points.len(), 25);
}
