//! Laws on the straight moves of a tip under G43.4: within what the job's machine can follow, and only where one is named.

use arcfeed::adapt::{Known, adapt_with};
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::commands::simulate::foreseen;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_tests::{Scratch, root, run};
use arcfeed_units::Nm;
use serde_json::Value;

/// The tip goes up by 20 mm at radius 100 while C turns by 30 degrees, then by 90 while X and Y of the machine go round.
const PROGRAM: &str =
    "%\nG21G90G94G17\nG0X100.Y0Z50.A0C0\nG43.4H1\nG1X100.Y0Z40.F1000.\nZ60.C30.\nZ80.C120.\nZ100.\nG49\nM30\n%\n";
const JOB: &str = "units = 'mm'\nprogram = 'tip.nc'\ntool = { kind = 'end-mill', diameter = 10, teeth = 2 }\n\
                   spindle = { rev_per_min = 3000, set_by = 'operator' }\nlimits = { max_feed = 90000, max_raise = 100 }\nlaw = { kind = 'table', feed_per_tooth = 0.3 }\n\
                   override = { mode = 'MODE', slew_up = 1000 }\n[[cut]]\nmoves = 'lines'\nside = 'outside'\nradial_depth = 5\ntable = [[0, 0.3]]\n";
const MACHINE: &str = "[machine]\npreset = 'mikron-ucp710'\nmax_feed = { x = 3000, y = 8000, c = 2400 }\n";
/// By hand: C, 2400 deg/min over 30 degrees in 20 mm; X, at its fastest where C stands at 90: r times the radians of 90 degrees.
const BY_C: f64 = 2_400.0 * 20.0 / 30.0;
const BY_X: f64 = 3_000.0 * 20.0 / (100.0 * std::f64::consts::FRAC_PI_2);

fn job(scratch: &Scratch, mode: &str, machine: &str) -> String {
    scratch.write("tip.nc", PROGRAM);
    scratch.write("job.toml", JOB.replace("MODE", mode) + machine)
}

fn blocks(job: &str) -> Vec<Value> {
    let output = run(&["adapt", job, "--json"]);
    let text = String::from_utf8(output.stdout).expect("text");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

#[test]
fn the_plan_sends_what_the_axes_can_follow_and_names_the_one_that_sets_it() {
    let scratch = Scratch::new("governing-plan");
    for mode in ["safe-base", "rewrite-only"] {
        assert_planned(&blocks(&job(&scratch, mode, MACHINE)));
    }
    let copied =
        std::fs::read_to_string(root().join("host/adapt/machines/mikron-ucp710.toml")).expect("an example machine");
    std::fs::create_dir_all(scratch.path("machines")).expect("a scratch folder");
    scratch.write("machines/mikron.toml", copied);
    let by_file = MACHINE.replace("preset = 'mikron-ucp710'", "file = 'machines/mikron.toml'");
    assert_planned(&blocks(&job(&scratch, "safe-base", &by_file)));
    let said = run(&["adapt", &job(&scratch, "safe-base", MACHINE)]);
    assert!(String::from_utf8_lossy(&said.stdout).contains("axis, limited by C to 1600.00"));
    // Without its kinematics the motion of X and Y is unknown.
    let unnamed = blocks(&job(&scratch, "safe-base", "[machine]\nmax_feed = { x = 5000 }\n"));
    assert!(unnamed.iter().skip(1).all(|block| block["reason"] == "special" && block["sent_feed"] == 1_000.0));
}

fn assert_planned(planned: &[Value]) {
    for (line, axis, closed, reason) in [(6, "C", BY_C, "axis"), (7, "X", BY_X, "axis"), (8, "Z", 20_000.0, "law")] {
        let block = planned.iter().find(|block| block["line"] == line).expect("a block");
        let (limit, sent) =
            (block["limit_feed"].as_f64().expect("a limit"), block["sent_feed"].as_f64().expect("a feed"));
        println!("line {line}: {limit:.2} mm/min by {}, closed form {closed:.2}, sent {sent}", block["limit_axis"]);
        assert_eq!((&block["limit_axis"], &block["reason"]), (&axis.into(), &reason.into()));
        assert!(limit <= closed && limit > closed * (1.0 - 1.1e-3) && sent <= limit, "{block}");
    }
}

/// The overrides put out while each move is in work, by the tip's height at its end.
fn overrides(job: &str) -> Vec<(Nm, u8)> {
    let file = JobFile::load(job.as_ref()).expect("a job");
    let bytes = std::fs::read(&file.program).expect("a program");
    let program = Program::parse_with(&file.program, &bytes, file.nc, file.tables);
    let adapted = adapt_with(&program, &file.job, Known::of(&file));
    let simulation = Simulation::from_memory(control_settings(&file), &adapted.text, &file.job, ControllerFault::None);
    let mut simulation = simulation.expect("the limits make sense");
    simulation.set_planned_conditions(foreseen(&program, &adapted, &file));
    let mut found = Vec::new();
    while !simulation.is_done() {
        simulation.step();
        let top = simulation.control().active().map(|(_, segment)| segment.end.linear[2]);
        found.extend(top.map(|top| (top, simulation.override_output().percent)));
    }
    found
}

#[test]
fn the_controller_asks_for_no_more_than_the_axes_can_follow() {
    let scratch = Scratch::new("governing-run");
    let found = overrides(&job(&scratch, "override-only", MACHINE));
    let of = |top_mm: f64| -> Vec<u8> {
        found.iter().filter(|(top, _)| *top == Nm::from_mm(top_mm)).map(|(_, percent)| *percent).collect()
    };
    // The law wants 1800 mm/min at F1000.
    let most = |top_mm: f64| of(top_mm).into_iter().max().expect("ticks");
    println!("{} %, {} %, {} %", most(60.0), most(80.0), most(100.0));
    assert_eq!([most(60.0), most(100.0)], [(BY_C / 10.0) as u8, 180]);
    // The override of the move before is left at once: 38.2 %, in whole steps.
    assert!(
        of(80.0).iter().all(|percent| f64::from(*percent) <= BY_X / 10.0) && of(80.0).contains(&38),
        "{:?}",
        of(80.0)
    );
    let unnamed = overrides(&job(&scratch, "override-only", ""));
    assert!(unnamed.iter().filter(|(top, _)| top.0 > Nm::from_mm(50.0).0).all(|(_, percent)| *percent == 100));
}

#[test]
fn stream_has_the_overrides_of_simulate_and_a_board_does_not_govern_tip_moves() {
    let scratch = Scratch::new("governing-stream");
    let job = job(&scratch, "override-only", MACHINE);
    let journal = scratch.path("journal");
    let report = |arguments: &[&str]| -> Value {
        let output = run(&[arguments, &["--json"]].concat());
        serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)))
    };
    let simulated = report(&["simulate", &job]);
    let streamed = report(&["stream", &job, "--journal", &journal]);
    let boarded = report(&["stream", &job, "--board", "sim:", "--journal", &journal]);
    println!(
        "{} s, {} s, with a board {} s",
        simulated["cycle_time_s"], streamed["cycle_time_s"], boarded["cycle_time_s"]
    );
    assert_eq!(simulated["override"]["min"], 38);
    assert_eq!(
        [&simulated["override"], &simulated["cycle_time_s"]],
        [&streamed["override"], &streamed["cycle_time_s"]]
    );
    assert_eq!(boarded["override"], Value::Null);
}
