//! Memory that commands need for long programs: `check` and `adapt` for the text alone, the others for no more lines than they
//! say; a file beyond every bound is refused unread.
#![cfg(target_os = "linux")]

use std::fmt::Write;
use std::fs::File;
use std::time::Duration;

use arcfeed_tests::{Ended, Scratch, of_full_set, root, run_with_memory};

use crate::report_page::scale::{JOB as ROWS_JOB, rows};

/// Lines of a program that needs hardly more memory than arcfeed itself, whose own memory depends on the profile.
const FEW_LINES: usize = 1_000;

/// Rounding of memory to pages, and what differs from run to run.
const NOISE_KB: u64 = 1_000;

/// Largest memory for a file that is refused: the longest file that is read whole, 80 MiB, and what goes with it.
const REFUSED_KB: u64 = 85_000;

/// Groups of rows of the traces of two runs, and what their encoders need: 30 MB, and 1.1 MB an hour of each run for the metadata.
const TRACES_KB: u64 = 40_000;

/// Lines of a program that commands take which keep something of each.
const LINES_MAX: usize = 1 << 20;

/// Largest memory for a line in `simulate --report`.
const LINE_BYTES_MAX: u64 = 1_200;

fn line_count() -> usize {
    of_full_set(2_000_000, 60_000)
}

/// The example's first arcs again and again, under its rules, between one beginning and one end.
pub fn program(lines: usize) -> String {
    let example = std::fs::read_to_string(root().join("examples/ibr-slot/ibr-slot.nc")).expect("the example");
    let all: Vec<&str> = example.lines().collect();
    let place = |number: &str| all.iter().position(|line| line.starts_with(number)).expect("a block of it");
    let (arcs, end) = (&all[place("N142")..=place("N146")], all.len() - 4);
    let mut text = all[..place("N142")].join("\n") + "\n";
    let repeated = arcs.iter().cycle().take(lines - place("N142") - (all.len() - end));
    repeated.for_each(|line| writeln!(text, "{line}").expect("a string takes it"));
    text + &all[end..].join("\n") + "\n"
}

/// The example's job, with this program.
pub fn job(scratch: &Scratch, program: &str) -> String {
    let job = std::fs::read_to_string(root().join("examples/ibr-slot/job.toml")).expect("the example");
    scratch.write("job.toml", job.replace("program = \"ibr-slot.nc\"", &format!("program = \"{program}\"")))
}

fn measure(scratch: &Scratch, arguments: &[&str]) -> (Ended, u64) {
    let (ended, kb) = run_with_memory(scratch, "run", arguments, Duration::from_secs(1_200));
    println!("{}: {kb} kB", arguments[0]);
    (ended, kb)
}

/// Memory of `check` for a few lines.
fn base_kb(scratch: &Scratch) -> u64 {
    let path = scratch.write("short.nc", program(FEW_LINES));
    let (ended, kb) = measure(scratch, &["check", &path]);
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    kb
}

#[test]
fn check_and_adapt_need_memory_for_the_text_alone() {
    let scratch = Scratch::new("memory");
    let (lines, text) = (line_count(), program(line_count()));
    let text_kb = text.len() as u64 / 1_000;
    let path = scratch.write("long.nc", &text);
    let base_kb = base_kb(&scratch);
    let (ended, kb) = measure(&scratch, &["check", &path]);
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    assert!(ended.out.contains(&format!("{lines} lines")), "{}", ended.out);
    assert!(kb < base_kb + text_kb + NOISE_KB, "{kb} kB for {text_kb} kB of text, {base_kb} kB for {FEW_LINES} lines");
    let output = scratch.path("out.nc");
    let (_, base_kb) = measure(&scratch, &["adapt", &job(&scratch, "short.nc"), "-o", &output]);
    let (ended, kb) = measure(&scratch, &["adapt", &job(&scratch, "long.nc"), "-o", &output]);
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    let adapted = std::fs::read_to_string(&output).expect("the adapted program");
    assert!(adapted.lines().count() == lines && adapted.len() > text.len());
    // 200 bytes a line.
    assert!(kb < base_kb + lines as u64 / 5, "{kb} kB, {base_kb} kB for {FEW_LINES} lines");
}

#[test]
fn a_program_of_many_faults_needs_no_more() {
    let scratch = Scratch::new("memory-faults");
    let path = scratch.write("bad.nc", "G21\n".to_owned() + &"G1X1.Q\n".repeat(line_count()));
    let (ended, kb) = measure(&scratch, &["check", "--json", &path]);
    assert_eq!(ended.code, Some(1));
    let report: serde_json::Value = serde_json::from_str(&ended.out).expect("one object");
    assert_eq!(
        report["errors"].as_array().expect("a list").len() as u64 + number(&report["not_listed"]),
        found(&ended.err)
    );
    let base_kb = base_kb(&scratch);
    assert!(kb < base_kb + 20_000 + 8 * line_count() as u64 / 1_000, "{kb} kB, {base_kb} kB for {FEW_LINES} lines");
}

fn number(value: &serde_json::Value) -> u64 {
    value.as_u64().expect("a number")
}

/// Errors and the warning of the lost label, as the last line on stderr has them.
fn found(err: &str) -> u64 {
    let errors = err.split(": ").nth(1).and_then(|rest| rest.split(' ').next()?.parse::<u64>().ok());
    errors.unwrap_or_else(|| panic!("no count: {err}"))
}

#[test]
fn simulate_needs_about_a_kilobyte_for_each_line_with_its_report() {
    let scratch = Scratch::new("memory-simulate");
    let sizes = [20_000, of_full_set(1_000_000, 80_000)];
    let memory_kb = sizes.map(|lines| {
        scratch.write("program.nc", rows(lines));
        let job = scratch.write("job.toml", format!("program = \"program.nc\"\n{ROWS_JOB}"));
        let report = scratch.path("report.html");
        let (ended, kb) = measure(&scratch, &["simulate", &job, "--json", "--report", &report]);
        assert_eq!(ended.code, Some(0), "{}", ended.err);
        kb
    });
    let [bytes, lines] = [1_000 * (memory_kb[1] - memory_kb[0]), (sizes[1] - sizes[0]) as u64];
    println!("{} bytes a line", bytes / lines);
    assert!(bytes / lines < LINE_BYTES_MAX && memory_kb[1] < 2_500_000, "{memory_kb:?} kB for {sizes:?} lines");
}

#[test]
fn a_file_of_a_gigabyte_is_refused_by_every_command() {
    let scratch = Scratch::new("memory-gigabyte");
    let path = scratch.path("huge.nc");
    File::create(&path).and_then(|file| file.set_len(1 << 30)).expect("a file with nothing in it");
    let (job, base_kb) = (job(&scratch, "huge.nc"), base_kb(&scratch));
    for arguments in [
        &["check", &path][..],
        &["check", &job],
        &["adapt", &job],
        &["simulate", &job],
        &["engage", &job],
        &["stream", &job, "--port", "loop://"],
        &["init", &path],
        &["check", "--machine", "mikron-ucp710", &path],
        &["check", "/dev/zero"],
    ] {
        let (ended, kb) = measure(&scratch, arguments);
        assert_eq!(ended.code, Some(1), "{arguments:?}: {}", ended.err);
        let size = if arguments[1] == "/dev/zero" { "83886081 bytes" } else { "1073741824 bytes" };
        for words in [size, "83886080 (80 MiB)", "split it"] {
            assert!(ended.err.contains(words), "{arguments:?}: {}", ended.err);
        }
        assert!(kb <= base_kb + REFUSED_KB, "{arguments:?}: {kb} kB, {base_kb} kB for {FEW_LINES} lines");
    }
}

#[test]
fn commands_that_keep_a_program_whole_say_how_many_lines_they_take() {
    let scratch = Scratch::new("memory-lines");
    let path = scratch.write("long.nc", program(LINES_MAX + 1));
    let (job, base_kb) = (job(&scratch, "long.nc"), base_kb(&scratch));
    for arguments in [&["simulate", &job][..], &["stream", &job, "--port", "loop://"], &["init", &path]] {
        let (ended, kb) = measure(&scratch, arguments);
        assert_eq!(ended.code, Some(1), "{arguments:?}: {}", ended.err);
        for words in ["long.nc: 1048577 lines", "at most 1048576", "split it"] {
            assert!(ended.err.contains(words), "{arguments:?}: {}", ended.err);
        }
        assert!(kb <= base_kb + REFUSED_KB, "{arguments:?}: {kb} kB, {base_kb} kB for {FEW_LINES} lines");
    }
}

#[test]
fn a_trace_needs_the_same_memory_for_a_run_of_any_length() {
    let scratch = Scratch::new("memory-trace");
    let options = ["--tool", "10", "--teeth", "4", "--feed-per-tooth", "0.05"];
    for minutes in of_full_set([60, 240], [4, 12]) {
        // One move: a longer run has no more blocks.
        let program = format!("%\nO1\nG21G17G90G94\nS9000M3\nG0X0.Y0.Z0.\nG1X{minutes}.F1.\nM30\n%\n");
        let program = scratch.write("slow.nc", program);
        let plain = [&["simulate", &program][..], &options].concat();
        let (without, without_kb) = measure(&scratch, &plain);
        let trace = scratch.path("slow.parquet");
        let (with, with_kb) = measure(&scratch, &[&plain[..], &["--trace", &trace]].concat());
        assert_eq!((without.code, with.code), (Some(0), Some(0)), "{}{}", without.err, with.err);
        let bytes = std::fs::metadata(&trace).expect("the table").len();
        println!("{minutes} min, {} rows: {bytes} bytes, {} kB for two traces", minutes * 60_000, with_kb - without_kb);
        assert!(with_kb < without_kb + TRACES_KB, "{with_kb} kB, without a trace {without_kb} kB");
    }
}
