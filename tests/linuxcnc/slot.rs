//! The published slot on LinuxCNC: arcs of all four movements, as programmed, in pieces, and with the component.

use std::fs;
use std::path::Path;

use arcfeed_tests::{recording, root};
use libm::fabs;
use serde_json::Value;

use super::machine::Machine;
use super::run::{INCH_MM, Ran, Run, Sample};

/// Largest chip over its target, of all samples in the cut.
const OVER: f64 = 0.005;
/// Deviation from the feed of F and override from which on a sample is slow.
const SLOW: f64 = 0.02;
/// Largest distance from the programmed arcs, inches: end and centre are rounded to four decimals on both axes, 2 sqrt(2) 0.000 05.
const PATH_ERROR_IN: f64 = 0.000_142;
/// Acceleration of the axes, mm/s2, and the least share of it along the path. LinuxCNC halves it for moves that blend, and keeps a part
/// of that for the curvature of arcs.
const ACCELERATION: f64 = 2_000.0;
const ALONG_SHARE: f64 = 0.4;
/// Fastest fall of the override, of F per second, the share of it that the controller uses, and the time that it allows an override
/// input to respond.
const SLEW_DOWN: f64 = 40.0;
const SLEW_SHARE: f64 = 0.9;
const RESPONSE_S: f64 = 0.03;
/// Most runs until there is one in which LinuxCNC keeps up with this computer.
const ATTEMPTS: u32 = 3;
/// Step of the simulated control's override.
const STEP: f64 = 0.01;

/// Levels of the slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Levels {
    /// Every level.
    All,
    /// N142 to N152, with an arc of each movement, without the retract.
    Two,
}

/// Writes the slot, and the job of the example in this mode; answers the job's path.
pub fn job(machine: &Machine, mode: &str, levels: Levels) -> String {
    let folder = root().join("examples/ibr-slot");
    let program = fs::read_to_string(folder.join("ibr-slot.nc")).expect("the example");
    let number = |line: &str| line.strip_prefix('N')?.split_once(['G', 'M'])?.0.parse::<u32>().ok();
    let is_left_out = |number| (128..142).contains(&number) || (154..206).contains(&number) || number == 210;
    let is_kept = |line: &&str| levels == Levels::All || !number(line).is_some_and(is_left_out);
    let mut program = program.lines().filter(is_kept).collect::<Vec<_>>().join("\n");
    if levels == Levels::Two {
        // The level begins with a line in the feed mode of those before it.
        program = program.replace("N142G1", "N142G94F25.G1");
    }
    fs::write(machine.path("ibr-slot.nc"), program).expect("a file");
    let job = fs::read_to_string(folder.join("job.toml")).expect("the example");
    let path = machine.path(&format!("{mode}.toml"));
    // LinuxCNC follows its adaptive feed in the next servo period: as fast as the axes brake, (2) of docs/linuxcnc.md at 20 mm/s.
    let slew_down = format!("slew_down = {}", SLEW_DOWN * 1e2);
    let job = job.replace("safe-base", mode).replace("slew_down = 200", &slew_down);
    fs::write(&path, job).expect("a file");
    path
}

/// Figures of the slot in a mode, with or without the component's feed.
fn figures(machine: &Machine, mode: &str, levels: Levels) -> (Ran, Value) {
    let job = job(machine, mode, levels);
    machine.adapt(&job);
    let arms = mode == "safe-base";
    let ran = machine.run(&Run::whole(arms));
    let figures = machine.measure(&job, &ran.samples, INCH_MM);
    println!(
        "{mode}, component {arms}, levels {levels:?}: {} samples, none missing, {} in the cut; chip over target {}; all samples \
         {:+.4}; {:.1} s; path {:.6} in",
        ran.samples.len(),
        figures["chip_load"]["samples"],
        figures["movements"].as_array().expect("movements").iter().map(range).collect::<Vec<_>>().join(", "),
        number(&figures["chip_load"], "error_ratio_max_all"),
        number(&figures, "cycle_time_s"),
        number(&figures, "path_error"),
    );
    (ran, figures)
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key}: {value}"))
}

fn range(movement: &Value) -> String {
    let chip = &movement["chip_load"];
    let share = 1e2 * number(chip, "samples_thin") / number(chip, "samples");
    format!(
        "{}: {:+.4} .. {:+.4}, {share:.1} % thin",
        movement["rule"],
        number(chip, "error_ratio_min"),
        number(chip, "error_ratio_max")
    )
}

/// Samples of one arc that are slower than F times the override, and the largest distance of one from an end of the arc.
struct SlowSamples {
    count: usize,
    farthest_mm: f64,
    /// Highest feed of the arc, mm/s.
    feed_max: f64,
}

fn slow_samples(samples: &[&Sample], f_mm_per_s: f64) -> SlowSamples {
    let along = lengths(samples.iter().map(|sample| sample.position_mm));
    let total = along.last().copied().unwrap_or(0.0);
    let mut slow = SlowSamples { count: 0, farthest_mm: 0.0, feed_max: 0.0 };
    for (sample, along) in samples.iter().zip(along) {
        let feed = f_mm_per_s * sample.ratio;
        slow.feed_max = slow.feed_max.max(feed);
        if sample.velocity_mm_per_s < (1.0 - SLOW) * feed {
            slow.count += 1;
            slow.farthest_mm = slow.farthest_mm.max(along.min(total - along));
        }
    }
    slow
}

/// Length of the path up to each position.
fn lengths(positions: impl Iterator<Item = [f64; 3]>) -> Vec<f64> {
    let (mut along, mut last) = (0.0, None);
    let lengths = positions.map(|at: [f64; 3]| {
        let from = last.replace(at).unwrap_or(at);
        along += libm::sqrt(at.iter().zip(from).map(|(a, b)| (a - b) * (a - b)).sum());
        along
    });
    lengths.collect()
}

/// Lines of the program with an arc, each with its F in mm/s.
fn arcs(program: &str) -> Vec<(i64, f64)> {
    let (mut feed, mut arcs) = (0.0, Vec::new());
    for (index, line) in program.lines().enumerate().filter(|(_, line)| !line.starts_with('(')) {
        if let Some((_, rest)) = line.split_once('F') {
            let end = rest.find(|letter: char| !letter.is_ascii_digit() && letter != '.').unwrap_or(rest.len());
            feed = rest[..end].parse::<f64>().expect("a number") * INCH_MM / 60.0;
        }
        if line.contains("G2X") || line.contains("G3X") {
            arcs.push((index as i64 + 1, feed));
        }
    }
    arcs
}

/// Checks that everything below the law's feed is acceleration from and to the ends of arcs, where the tool turns back.
///
/// # Errors
/// Elsewhere the axes were slower than the override that LinuxCNC reports.
fn check_slow_samples(machine: &Machine, ran: &Ran) -> Result<(), String> {
    let program = fs::read_to_string(machine.path("program.ngc")).expect("the program");
    let (mut count, mut farthest) = (0, 0.0_f64);
    for (line, feed) in arcs(&program) {
        let of_line: Vec<&Sample> = ran.samples.iter().filter(|sample| sample.line == line).collect();
        let slow = slow_samples(&of_line, feed);
        let longest_mm = slow.feed_max * slow.feed_max / (2.0 * ALONG_SHARE * ACCELERATION);
        if slow.farthest_mm > longest_mm {
            let (slow_mm, states) = (slow.farthest_mm, ran.states());
            return Err(format!("line {line}: slow {slow_mm} mm from its ends, of {longest_mm}; component {states:?}"));
        }
        (count, farthest) = (count + slow.count, farthest.max(slow.farthest_mm));
    }
    println!(
        "{count} samples slower than F times the override by more than 2 %, all within {farthest:.3} mm of a joint"
    );
    Ok(())
}

/// A run that keeps the target and the path, and its figures.
fn safe_figures(machine: &Machine, mode: &str) -> (Ran, Value) {
    let (ran, after) = figures(machine, mode, Levels::All);
    let chip = &after["chip_load"];
    assert!(number(chip, "error_ratio_max_all") <= OVER, "{mode}: {chip}");
    assert!(number(chip, "error_ratio_max_all") >= -OVER, "{mode}: the target is reached: {chip}");
    assert!(number(chip, "samples") > 15_000.0, "{mode}: {chip}");
    assert!(number(&after, "path_error") < PATH_ERROR_IN, "{mode}: {after}");
    (ran, after)
}

/// A run in which LinuxCNC kept up with this computer, with its figures. The part of LinuxCNC that executes the dial does not run in real
/// time: beside other tests it was seen late by 2 s, twice in a row, and the axes ran at half of the feed. Safe, but not what is measured here.
fn timely_figures(machine: &Machine, mode: &str) -> (Ran, Value) {
    let mut attempts = 1;
    loop {
        let (ran, after) = safe_figures(machine, mode);
        let Err(late) = check_slow_samples(machine, &ran) else { return (ran, after) };
        assert!(attempts < ATTEMPTS, "{mode}: {late}");
        println!("LATE (loudly): {mode}: {late}; LinuxCNC did not keep up with this computer, once more");
        attempts += 1;
    }
}

/// Time on arcs at less than 98 % of the override before its fall, seconds: (1) of docs/linuxcnc.md, for each arc with the highest
/// override of its second half.
fn fall_s(machine: &Machine, samples: &[Sample]) -> f64 {
    let program = fs::read_to_string(machine.path("program.ngc")).expect("the program");
    let of_arc = |(line, _): (i64, f64)| {
        let ratios: Vec<f64> = samples.iter().filter(|sample| sample.line == line).map(|sample| sample.ratio).collect();
        let most = ratios[ratios.len() / 2..].iter().copied().fold(1.0, f64::max);
        let falls = (1.0 - SLOW) * most > 1.0;
        if falls { most * RESPONSE_S + ((1.0 - SLOW) * most - 1.0) / (SLEW_SHARE * SLEW_DOWN) } else { 0.0 }
    };
    arcs(&program).into_iter().map(of_arc).sum()
}

/// Override along a path: share of its length, feed over F.
type Curve = Vec<(f64, f64)>;

fn curve(points: &[([f64; 3], f64)]) -> Curve {
    let along = lengths(points.iter().map(|(at, _)| *at));
    let total = along.last().copied().unwrap_or(0.0);
    along.iter().zip(points).map(|(along, (_, ratio))| (along / total, *ratio)).collect()
}

/// Compares the override of each arc with that of the same arc on the simulated control, at the same share of its length.
fn compare_with_simulation(machine: &Machine, samples: &[Sample]) {
    let simulated = recording::record(Path::new(&machine.path("safe-base.toml")));
    let program = fs::read_to_string(machine.path("program.ngc")).expect("the program");
    let arcs = arcs(&program);
    let is_arc = |index: &usize| simulated.segments[*index].arc().is_some();
    let simulated_arcs: Vec<usize> = (0..simulated.segments.len()).filter(is_arc).collect();
    assert_eq!(arcs.len(), simulated_arcs.len(), "the same arcs");
    let mut differences = Vec::new();
    for ((line, _), index) in arcs.into_iter().zip(simulated_arcs) {
        let ticks = simulated.ticks.iter().filter(|(.., begun)| *begun == index + 1);
        let points: Vec<_> =
            ticks.map(|(pose, percent, _)| (pose.linear.map(|nm| nm.to_mm()), f64::from(*percent) / 1e2)).collect();
        let simulated_curve = curve(&points);
        let points: Vec<_> = samples
            .iter()
            .filter(|sample| sample.line == line)
            .map(|sample| (sample.position_mm, sample.ratio))
            .collect();
        for (share, ratio) in curve(&points) {
            let at = simulated_curve.partition_point(|(other, _)| *other < share).min(simulated_curve.len() - 1);
            differences.push((ratio - simulated_curve[at].1, line, share));
        }
    }
    differences.sort_by(|a, b| fabs(a.0).total_cmp(&fabs(b.0)));
    let near = differences[differences.len() * 99 / 100].0;
    for (difference, line, share) in differences.iter().rev().step_by(50).take(5).copied() {
        println!(
            "override on LinuxCNC minus simulated {difference:+.4} at {:.2} % of the arc in line {line}",
            1e2 * share
        );
    }
    println!(
        "override on LinuxCNC minus simulated: {} samples, 99 % of them within {:.4}",
        differences.len(),
        fabs(near)
    );
    assert!(fabs(near) <= 2.0 * STEP, "a step, and its rounding down: {near}");
}

/// Prints the time of our function in the servo thread beside LinuxCNC's own, from single readings.
fn print_times(ran: &Ran) {
    let report = ran.reports.iter().find(|report| report.get("times").is_some()).expect("times");
    for (name, times) in report["times"].as_object().expect("an object") {
        let mut clocks: Vec<u64> =
            times.as_array().expect("readings").iter().filter_map(|time| time.as_str()?.parse().ok()).collect();
        clocks.sort_unstable();
        let most = clocks.last().copied().unwrap_or(0);
        let median = clocks.get(clocks.len() / 2).copied().unwrap_or(0);
        println!("time of {name}: median {median} clocks, worst {most}, of {} readings", clocks.len());
    }
}

#[test]
fn linuxcnc_cuts_the_slot_at_its_target_with_f_words_and_with_the_component() {
    let Some(machine) = Machine::or_skip("linuxcnc-slot") else { return };
    let (_, before) = figures(&machine, "override-only", Levels::All);
    let mut shares_thin = Vec::new();
    for mode in ["rewrite-only", "safe-base"] {
        let (ran, after) = timely_figures(&machine, mode);
        let chip = &after["chip_load"];
        shares_thin.push(number(chip, "samples_thin") / number(chip, "samples"));
        print_times(&ran);
        if mode == "safe-base" {
            compare_with_simulation(&machine, &ran.samples);
            let fall_s = fall_s(&machine, &ran.samples);
            let thin_s = 1e-3 * number(chip, "samples_thin");
            println!(
                "below the target by more than 2 %: {thin_s:.3} s, in the fall of the override by (1) {fall_s:.3} s"
            );
            assert!(thin_s <= fall_s, "nothing else is thin: {thin_s} s of {fall_s} s");
        }
    }
    println!("share of the samples below the target by more than 2 %: {shares_thin:?}");
    assert!(shares_thin[1] < 0.02, "{shares_thin:?}");
    let most = number(&before["chip_load"], "error_ratio_max_all");
    assert!(most < -0.3, "the meter notices the programmed feed: {most}");
}
