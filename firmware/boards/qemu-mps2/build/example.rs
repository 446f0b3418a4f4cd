//! A job, its blocks and the positions of its run, written as Rust and as a table for the images.
//!
//! `example.rs`: `job()`, `RULES`, `BLOCKS`. `ticks.bin`: the position feedback of every tick as the difference to the
//! tick before, three little-endian i16 of micrometres; the run starts at the origin.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use arcfeed::adapt::adapt;
use arcfeed::commands::simulate::control_settings;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::machine;
use arcfeed_hil_sim::rig::Rig;
use arcfeed_shared::cut::{self, CutRule, Moves, Work};
use arcfeed_shared::job::Job;
use arcfeed_shared::knots::Knots;
use arcfeed_shared::nc::block::Reading;
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::Nm;

/// Position feedback comes in whole micrometres.
const NM_PER_UM: i64 = 1_000;

/// A move and when it begins.
struct Block {
    first_tick: usize,
    segment: Option<Segment>,
}

/// Runs the job and writes what the images take from it.
pub fn write(job: &Path, out: &Path) {
    let file = JobFile::load(job).expect("the example's job is sound");
    let program = Program::load(&file.program, file.job.unit, Reading::Lenient).expect("the example has a program");
    let mut text = adapt(&program, &file.job).text;
    text.push(b'\n');
    let rig = Rig::from_memory(control_settings(&file), &text, &file.job, ControllerFault::None);
    let (blocks, ticks) = record(rig.expect("the limits of the override make sense"));
    fs::write(out.join("ticks.bin"), ticks).expect("the table is written");
    fs::write(out.join("example.rs"), source(&file.job, &blocks)).expect("the job is written");
}

/// Steps the machine to the end of the program.
fn record(mut rig: Rig) -> (Vec<Block>, Vec<u8>) {
    let (mut blocks, mut ticks) = (Vec::new(), Vec::new());
    let (mut last_um, mut last_count) = ([0_i64; 3], None);
    for tick in 0.. {
        rig.step();
        let active = rig.control().active();
        let count = active.map(|(count, _)| count);
        if tick == 0 || count != last_count {
            blocks.push(Block { first_tick: tick, segment: active.map(|(_, segment)| *segment) });
            last_count = count;
        }
        let um = machine::feedback(&rig.control().position()).linear.map(|Nm(nm)| nm / NM_PER_UM);
        for (now, before) in um.iter().zip(last_um) {
            let change = i16::try_from(now - before).expect("no axis moves 32 mm in a millisecond");
            ticks.extend(change.to_le_bytes());
        }
        last_um = um;
        if rig.is_done() {
            break;
        }
    }
    (blocks, ticks)
}

/// The job and its blocks as Rust: what `Debug` prints of these types is what one would write.
fn source(job: &Job, blocks: &[Block]) -> String {
    let Job { unit, tool, spindle, law, feed_per_tooth, policy, limits, rules, knots } = job;
    assert_eq!(*knots, Knots::new(), "the example's law needs no table");
    let mut text = String::new();
    let mut line = |line: String| writeln!(text, "{line}").expect("strings take every line");
    line("/// The job, its rules still to be added.\npub const fn job() -> Job {".into());
    line(format!("    Job {{ unit: {unit:?}, tool: Tool::{tool:?}, spindle: {spindle:?}, law: LawKind::{law:?},"));
    line(format!("        feed_per_tooth: {feed_per_tooth:?}, policy: {policy:?}, limits: {limits:?},"));
    line("        rules: heapless::Vec::new(), knots: Knots::new() }\n}".into());
    // In place: a list of rules that is handed over may lie on the stack twice.
    line("/// Adds its rules.\n#[inline(never)]\npub fn add_rules(job: &mut Job) {".into());
    rules.iter().for_each(|rule| line(rule_source(rule)));
    line("}".into());
    line("/// The blocks of the run.".into());
    line("#[unsafe(link_section = \".recorded_run\")]".into());
    line(format!("pub static BLOCKS: [Block; {}] = [", blocks.len()));
    for Block { first_tick, segment } in blocks {
        let found = segment.as_ref().and_then(|segment| cut::find(rules, segment, tool));
        let rule = found.map(|(index, _)| index);
        line(format!("    Block {{ first_tick: {first_tick}, rule: {rule:?}, segment: {segment:?} }},"));
    }
    line("];".into());
    text
}

fn rule_source(rule: &CutRule) -> String {
    let CutRule { moves: Moves::Rotations(rotation, turn), work: Work::Ring(edge, stock), .. } = rule else {
        panic!("the example's tool is a cup mill")
    };
    let line = stock.line().expect("the example's stock is a line");
    let CutRule { feed_per_tooth, table, sequence, level, .. } = rule;
    format!(
        "    let _room = job.rules.push(CutRule {{ moves: Moves::Rotations({rotation:?}, {turn:?}), work: Work::Ring({edge:?}, \
         Stock::half_plane({line:?})), feed_per_tooth: {feed_per_tooth:?}, table: {table:?}, sequence: {sequence:?}, level: {level:?} }});"
    )
}
