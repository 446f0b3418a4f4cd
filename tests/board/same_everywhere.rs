//! The same bits on the host and on the chip under each law, and the same overrides as in the simulator.

use std::process::Command;
use std::sync::OnceLock;

use arcfeed::adapt::adapt;
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_bench::trace::{LAWS, TICKS};
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_nc::block::Reading;
use arcfeed_tests::root;

use arcfeed_tests::emulation::images::image;
use arcfeed_tests::emulation::log::messages;
use arcfeed_tests::emulation::qemu::run;

/// A debug build: the workspace's own tests have these crates optimised.
const DEBUG: [&str; 12] = [
    "--config",
    "profile.dev.package.arcfeed-units.opt-level=0",
    "--config",
    "profile.dev.package.arcfeed-nc.opt-level=0",
    "--config",
    "profile.dev.package.arcfeed-model.opt-level=0",
    "--config",
    "profile.dev.package.arcfeed-law.opt-level=0",
    "--config",
    "profile.dev.package.arcfeed-firmware.opt-level=0",
    "--config",
    "profile.dev.package.libm.opt-level=0",
];
const RELEASE: [&str; 1] = ["--release"];

/// The hashes of this machine, in a debug or a release build.
fn on_this_machine(profile: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO"));
    command.args(["run", "--quiet", "--package", "arcfeed-bench", "--bin", "trace-hash"]).args(profile);
    let output = command.current_dir(root()).output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The override at every tick of the example's run, as the simulator's controller put it out.
fn simulated_overrides() -> Vec<u8> {
    let path = root().join("examples/ibr-slot/job.toml");
    let file = JobFile::load(&path).expect("the example's job is sound");
    let program = Program::load(&file.program, file.job.unit, Reading::Lenient).expect("the example has a program");
    let text = [adapt(&program, &file.job).text, b"\n".to_vec()].concat();
    let settings = control_settings(&file);
    let simulation = Simulation::from_memory(settings, &text, &file.job, ControllerFault::None);
    let mut simulation = simulation.expect("the limits of the override make sense");
    let mut overrides = Vec::new();
    let mut left = settings.ladder_delay_steps + 1;
    let late = left;
    // An override takes effect at the step after the tick that put it out, and the scan of the ladder later.
    while left > 0 {
        left -= usize::from(simulation.is_done());
        simulation.step();
        overrides.push(simulation.control().override_percent());
    }
    overrides.split_off(late)
}

/// Result of the same cases on the chip, run once.
fn on_the_chip() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| run("trace-hash").text())
}

/// The number that follows a word on the line of a law.
fn count(line: &str, word: &str) -> u32 {
    let mut words = line.split_whitespace().skip_while(|other| *other != word);
    let number = words.nth(1).unwrap_or_else(|| panic!("no {word} in {line}"));
    number.parse().expect("a number")
}

#[test]
fn this_machine_and_chip_agree_to_the_bit_under_each_law() {
    let (debug, release, chip) = (on_this_machine(&DEBUG), on_this_machine(&RELEASE), on_the_chip());
    print!("{TICKS} ticks each, debug, release and chip:\n{debug}{release}{chip}");
    assert_eq!(debug.lines().count(), LAWS.len(), "{debug}");
    assert_eq!(debug, release);
    assert_eq!(debug, chip);
}

#[test]
fn the_ticks_that_agree_are_of_all_kinds() {
    const PLENTY: u32 = TICKS / 20;
    for line in on_the_chip().lines() {
        let (law, counts) = line.split_once(' ').expect("the law, then what it did");
        let many =
            |words: &[&str]| words.iter().for_each(|word| assert!(count(counts, word) > PLENTY, "{word}: {line}"));
        match law {
            "circumference" => many(&["governed", "refused", "half-plane", "filtered"]),
            "engaged-arc-one-edge" | "engaged-arc-both-edges" => {
                many(&["governed", "refused", "half-plane", "polygon", "disc", "filtered"]);
            }
            "contour" | "contour-floor" | "contour-inside-only" | "engagement" => {
                many(&["governed", "refused", "on-lines", "filtered"]);
            }
            // A table has a demand everywhere.
            "table" => many(&["governed", "on-lines", "filtered"]),
            "programmed" => assert_eq!(count(counts, "governed"), 0, "{line}"),
            _ => panic!("what is {law} to exercise?"),
        }
        assert!(law == "programmed" || count(counts, "missing") > 100, "{line}");
    }
}

#[test]
fn the_board_puts_out_what_the_simulated_controller_does_and_logs_it() {
    let run = run("example-run");
    let log = messages(&std::fs::read(image("example-run")).expect("the image is there"), &run.console);
    println!("{}", log.join("\n"));
    let simulated = simulated_overrides();
    assert_eq!(run.uart1.len(), simulated.len(), "an override for every tick");
    let differs = run.uart1.iter().zip(&simulated).position(|(board, simulated)| board != simulated);
    assert_eq!(differs, None, "first tick with another override");
    assert!(simulated.iter().max() > Some(&100), "the override never moves");
    let last = format!("over: {} ticks, 0 starved, 0 overrides dropped", simulated.len());
    assert!(log.iter().any(|line| line.ends_with(&last)), "no \"{last}\"");
}
