//! Example jobs, their blocks and the positions of their runs for the boards' images, which are built without the host program: the
//! files of [`FOLDER`] are what the simulated machine does now. `UPDATE_GOLDEN=1` writes them.
//!
//! Each job becomes a module `NAME.rs` with `job()` and `EXAMPLE`, and its program as sent, `NAME.nc`. `NAME.bin` has the position
//! feedback of every tick as the difference from the previous tick, three little-endian i16 in micrometres; the run starts at the origin.

use std::fmt::Write;
use std::fs;

use arcfeed::adapt::adapt;
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_control::machine;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_model::cut::{CutRule, Work};
use arcfeed_model::job::{Job, ToolSetup};
use arcfeed_model::knots::Knots;
use arcfeed_nc::block::Reading;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::segment::Segment;
use arcfeed_tests::root;
use arcfeed_units::Nm;

/// The files that the boards include.
const FOLDER: &str = "firmware/boards/recorded-runs";
/// Names of the examples in the images, and their jobs.
const JOBS: [(&str, &str); 3] = [
    ("ibr_slot", "ibr-slot/job.toml"),
    ("pocket_contour", "pocket/job-contour.toml"),
    ("pocket_engagement", "pocket/job-engagement.toml"),
];

/// Position feedback is in whole micrometres.
const NM_PER_UM: i64 = 1_000;

/// A move with its first tick.
struct Block {
    first_tick: usize,
    segment: Option<Segment>,
}

/// Runs a job in simulation. Its files: name and content.
fn files(name: &str, job: &str) -> [(String, Vec<u8>); 3] {
    let file = JobFile::load(&root().join("examples").join(job)).expect("the example's job is sound");
    let program = Program::load(&file.program, file.job.unit, Reading::Lenient).expect("the example has a program");
    let mut as_sent = adapt(&program, &file.job).text;
    as_sent.push(b'\n');
    let simulation = Simulation::from_memory(control_settings(&file), &as_sent, &file.job, ControllerFault::None);
    let (blocks, ticks) = record(simulation.expect("the limits of the override make sense"));
    let mut text = format!("/// `{name}`.\npub mod {name} {{\n    use super::*;\n");
    text += &program_source(name);
    text += &job_source(&file.job);
    text += &run_source(name, &file.job, &blocks, ticks.len());
    text += "}\n";
    [("rs", text.into_bytes()), ("nc", as_sent), ("bin", ticks)]
        .map(|(extension, content)| (format!("{name}.{extension}"), content))
}

/// Runs the machine to the end of the program.
fn record(mut simulation: Simulation) -> (Vec<Block>, Vec<u8>) {
    let (mut blocks, mut ticks) = (Vec::new(), Vec::new());
    let (mut last_um, mut last_count) = ([0_i64; 3], None);
    for tick in 0.. {
        simulation.step();
        let active = simulation.control().active();
        let count = active.map(|(count, _)| count);
        if tick == 0 || count != last_count {
            blocks.push(Block { first_tick: tick, segment: active.map(|(_, segment)| *segment) });
            last_count = count;
        }
        let um = machine::feedback(&simulation.control().position()).linear.map(|Nm(nm)| nm / NM_PER_UM);
        for (now, before) in um.iter().zip(last_um) {
            let change = i16::try_from(now - before).expect("no axis moves 32 mm in a millisecond");
            ticks.extend(change.to_le_bytes());
        }
        last_um = um;
        if simulation.is_done() {
            break;
        }
    }
    (blocks, ticks)
}

/// The sent program, for images that receive it over the line.
fn program_source(name: &str) -> String {
    let section = "#[unsafe(link_section = \".recorded_run\")]";
    format!(
        "    {section}\n    static TEXT: [u8; include_bytes!(\"{name}.nc\").len()] = *include_bytes!(\"{name}.nc\");\n    \
         /// Adapted program of the run.\n    pub const PROGRAM: &[u8] = &TEXT;\n"
    )
}

/// The job as Rust source, from the `Debug` output of its types.
fn job_source(job: &Job) -> String {
    let Job { unit, tools, policy, limits, ceiling, machine, rules, knots } = job;
    assert_eq!(tools.len(), 1, "the images are for jobs with one tool");
    assert_eq!(*knots, Knots::new(), "the example's law needs no table");
    let mut text = String::from("    /// The job, its rules still to be added.\n    pub const fn job() -> Job {\n");
    let ToolSetup { tool, number, axis, spindle, speed_source, law, feed_per_tooth, follows_program } = tools.first();
    text += &format!("        Job {{ unit: {unit:?}, ceiling: {ceiling:?}, tools: Tools::one(ToolSetup {{\n");
    text += &format!(
        "            tool: Tool::{tool:?}, number: {number:?}, axis: ToolAxis::{axis:?}, spindle: {spindle:?},\n"
    );
    text += &format!("            speed_source: SpeedSource::{speed_source:?}, law: LawKind::{law:?},\n");
    text += &format!("            feed_per_tooth: {feed_per_tooth:?}, follows_program: {follows_program} }}),\n");
    text += &format!("            policy: {policy:?}, limits: {limits:?}, machine: {machine:?},\n");
    text += "            rules: heapless::Vec::new(), knots: Knots::new() }\n    }\n";
    // In place: a list of rules that is returned by value may be on the stack twice.
    text += "    /// Adds its rules.\n    #[inline(never)]\n    pub fn add_rules(job: &mut Job) {\n";
    text.extend(rules.iter().map(rule_source));
    text +=
        "    }\n    /// The job with its rules, for stacks that have room for it.\n    pub fn whole_job() -> Job {\n";
    text + "        let mut job = job();\n        add_rules(&mut job);\n        job\n    }\n"
}

/// The blocks and the table of ticks as Rust source. Both are in a section of their own: they replace the program and
/// the encoders and are not part of the controller's memory.
fn run_source(name: &str, job: &Job, blocks: &[Block], bytes: usize) -> String {
    let mut text = String::new();
    let mut line = |line: String| writeln!(text, "    {line}").expect("strings take every line");
    let section = "#[unsafe(link_section = \".recorded_run\")]";
    line(format!("{section}\n    static BLOCKS: [Block; {}] = [", blocks.len()));
    for Block { first_tick, segment } in blocks {
        let found = segment.as_ref().and_then(|segment| job.rule_for(segment, ToolInSpindle::Unstated));
        let rule = found.map(|(index, _)| index);
        line(format!("    Block {{ first_tick: {first_tick}, rule: {rule:?}, segment: {segment:?} }},"));
    }
    line(format!("];\n    {section}\n    static TICKS: [u8; {bytes}] = *include_bytes!(\"{name}.bin\");"));
    line("/// Its run.\n    pub const EXAMPLE: Example = Example { blocks: &BLOCKS, ticks: &TICKS };".into());
    text
}

fn rule_source(rule: &CutRule) -> String {
    let CutRule { tool, moves, work, feed_per_tooth, table, sequence, level } = rule;
    let work = match work {
        Work::Ring(edge, stock) => {
            let line = stock.line().expect("the example's stock is a line");
            format!("Ring({edge:?}, Stock::half_plane({line:?}))")
        }
        Work::Mill { .. } => format!("{work:?}"),
    };
    format!(
        "        let _room = job.rules.push(CutRule {{ tool: {tool}, moves: Moves::{moves:?}, work: Work::{work}, \
         feed_per_tooth: {feed_per_tooth:?}, table: {table:?}, sequence: {sequence:?}, level: {level:?} }});\n"
    )
}

#[test]
fn the_recorded_runs_of_the_images_are_those_of_the_examples() {
    let folder = root().join(FOLDER);
    let files = JOBS.map(|(name, job)| files(name, job));
    for (name, content) in files.iter().flatten() {
        let path = folder.join(name);
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            fs::write(&path, content).expect("the file is written");
        }
        let written = fs::read(&path).unwrap_or_default();
        assert!(
            written == *content,
            "{FOLDER}/{name} is older than the example or the simulation: UPDATE_GOLDEN=1 rewrites it"
        );
    }
    let count = fs::read_dir(folder).expect("the folder is there").count();
    assert_eq!(count, files.as_flattened().len(), "files of {FOLDER} that nothing writes");
}
