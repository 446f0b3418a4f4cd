//! `adapt --for linuxcnc` against LinuxCNC's own interpreter: its `rs274` reads every adapted program of the everyday corpus
//! and of the examples, and makes the moves of the adapted Fanuc program; what is refused names its remedy.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use arcfeed_nc::settings::Decimals;
use arcfeed_tests::{Scratch, root, run, skip_loudly};
use arcfeed_units::{LengthUnit, MM_PER_INCH};

#[path = "../rs274/canonical.rs"]
mod canonical;

use canonical::theirs;

use crate::moves_rs274::moves::{self, Move, moving, off_mm, ours};

const CORPUS: &str = "tests/corpus/everyday";
/// Half of the last decimal that rs274 prints in inches, and our nanometre, for a sum of two.
const PRINTED_MM: f64 = 2.0 * 0.000_05 * MM_PER_INCH;

/// Whether `rs274` can be run; says so if not.
fn has_rs274(test: &str) -> bool {
    let found = Command::new("rs274").arg("-h").output().is_ok();
    if !found {
        skip_loudly(test, "there is no rs274 of LinuxCNC (Debian's package linuxcnc-uspace)");
    }
    found
}

/// Moves without the level above a hole: where G98 comes behind holes under G99, LinuxCNC rises to the initial level on the
/// way to the next hole, and a Fanuc stays at the level R. Nothing else is left out: a rapid straight down after another.
fn without_levels(moves: &[Move]) -> Vec<Move> {
    let goes_down = |pair: &[Move]| {
        let [Move { kind: 0, end_mm: [x, y, z], .. }, Move { kind: 0, end_mm: to, .. }] = pair else { return false };
        (x - to[0]).abs() + (y - to[1]).abs() < PRINTED_MM && to[2] < *z
    };
    let ends = moves.windows(2).map(goes_down).chain([false]);
    moves.iter().zip(ends).filter(|(_, goes_down)| !goes_down).map(|(step, _)| *step).collect()
}

/// Moves without those up and down to the same bottom: where the depth is a multiple of Q, its sum of inches may miss the bottom by a
/// rounding, and it goes there once more.
fn without_empty_pecks(moves: Vec<Move>) -> Vec<Move> {
    let mut kept: Vec<Move> = Vec::new();
    for step in moves {
        if let [.., Move { kind: 1, end_mm: bottom, .. }, Move { kind: 0, end_mm: above, .. }] = kept[..]
            && step.kind == 1
            && step.end_mm == bottom
            && above[..2] == bottom[..2]
        {
            kept.pop();
        } else {
            kept.push(step);
        }
    }
    kept
}

/// Verdict on one job: refused by arcfeed, or the moves that both make.
fn verdict(scratch: &Scratch, input: &[&str], (decimals, unit): (Decimals, LengthUnit)) -> String {
    let [fanuc, linuxcnc] = ["fanuc.nc", "linuxcnc.ngc"].map(|name| scratch.path(name));
    for file in [&fanuc, &linuxcnc] {
        let _was_not_there = std::fs::remove_file(file);
    }
    let output = run(&[&["adapt", "-o", &linuxcnc, "--for", "linuxcnc"], input].concat());
    if !output.status.success() {
        let stderr = String::from_utf8_lossy(&output.stderr);
        let errors: Vec<&str> = stderr.lines().filter(|line| line.contains("error")).collect();
        let first = errors.first().or(stderr.lines().collect::<Vec<_>>().last()).map_or("", |line| line);
        assert!(!Path::new(&linuxcnc).exists(), "nothing half-written");
        let place = first.split_once(".nc:").or(first.split_once(".ngc:")).or(first.split_once(".tap:"));
        return format!("refused {}", place.map_or(first, |(_, rest)| rest));
    }
    assert!(run(&[&["adapt", "-o", &fanuc, "--expand"], input].concat()).status.success(), "{input:?}");
    let [fanuc, linuxcnc] = [fanuc, linuxcnc].map(|file| std::fs::read(file).expect("an adapted program"));
    let theirs = match theirs("rs274", &linuxcnc, 0.0) {
        Ok(theirs) => theirs,
        Err(error) => return format!("rs274 refuses: {error}"),
    };
    let ours = ours(&fanuc, decimals, unit).expect("our own program");
    let [theirs, ours] = [theirs, ours].map(|moves| without_empty_pecks(without_levels(&moving(&moves))));
    for (index, (a, b)) in theirs.iter().zip(&ours).enumerate() {
        if a.kind != b.kind || off_mm(a, b) > PRINTED_MM {
            return format!("move {index} differs: rs274 {a:?}, arcfeed {b:?}");
        }
    }
    if theirs.len() != ours.len() {
        return format!("rs274 makes {} moves, arcfeed {}", theirs.len(), ours.len());
    }
    format!("{} moves", ours.len())
}

/// The job that `init` proposes, answered as in `everyday.rs`, with the feeds in F words.
fn job(scratch: &Scratch, row: &str) -> Option<(String, (Decimals, LengthUnit))> {
    let fields: Vec<&str> = row.split(';').collect();
    let [name, control, unit, decimals, ..] = fields[..] else { panic!("{row}") };
    let program = scratch.write(name, std::fs::read(root().join(CORPUS).join(name)).expect("a program"));
    let job = Path::new(&program).with_extension("toml").display().to_string();
    let arguments =
        ["init", &program, "-o", &job, "--mode", "rewrite-only", "--control", control, "--decimals", decimals];
    if !run(&arguments).status.success() {
        return None;
    }
    let text = std::fs::read_to_string(&job).expect("a job");
    // A program without G20 and G21 leaves the unit to the machine, which the index knows.
    let units = ["?", "mm", "inch"].map(|word| format!("units = \"{word}\""));
    let text = units.iter().fold(text, |text, line| text.replacen(line, &format!("units = \"{unit}\""), 1));
    let text =
        text.replace("diameter = \"?\"", "diameter = \"10 mm\"").replace("rev_per_min = \"?\"", "rev_per_min = 1000");
    std::fs::write(&job, text).expect("it was just written");
    let decimals = if decimals == "calculator" { Decimals::Calculator } else { Decimals::LeastIncrement };
    let unit = if unit == "mm" { LengthUnit::Mm } else { LengthUnit::Inch };
    Some((job, (decimals, unit)))
}

#[test]
fn linuxcnc_makes_the_moves_of_every_everyday_program_that_is_not_refused() {
    if !has_rs274("linuxcnc_makes_the_moves_of_every_everyday_program_that_is_not_refused") {
        return;
    }
    let scratch = Scratch::new("linuxcnc-everyday");
    let index = std::fs::read_to_string(root().join(CORPUS).join("index.csv")).expect("the index");
    let mut table = String::new();
    for row in index.lines().skip(1).filter(|row| row.split(';').nth(4) == Some("yes")) {
        let name = row.split(';').next().unwrap_or_default();
        let Some((job, settings)) = job(&scratch, row) else { continue };
        writeln!(table, "{name:<34}{}", verdict(&scratch, &[&job], settings)).expect("a string takes every line");
    }
    println!("{table}");
    let good = table.lines().filter(|line| line.ends_with(" moves")).count();
    println!("{good} of {} programs are written for LinuxCNC", table.lines().count());
    assert!(!table.contains("rs274"), "another program for LinuxCNC than for the Fanuc");
    let expected = root().join(CORPUS).join("linuxcnc.txt");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&expected, &table).expect("the corpus can be written");
    }
    assert_eq!(table, std::fs::read_to_string(&expected).expect("the expected table"));
}

#[test]
fn linuxcnc_makes_the_moves_of_the_examples() {
    if !has_rs274("linuxcnc_makes_the_moves_of_the_examples") {
        return;
    }
    let scratch = Scratch::new("linuxcnc-examples");
    for (folder, file) in [("ibr-slot", "job.toml"), ("pocket", "job-contour.toml"), ("pocket", "job-engagement.toml")]
    {
        let folder = root().join("examples").join(folder);
        let text = std::fs::read_to_string(folder.join(file)).expect("a job");
        let program =
            text.lines().find_map(|line| line.strip_prefix("program = \"")?.strip_suffix('"')).expect("a program");
        scratch.write(program, std::fs::read(folder.join(program)).expect("a program"));
        let text = match text.contains("[override]") {
            true => text.replace("safe-base", "rewrite-only"),
            false => text + "\n[override]\nmode = \"rewrite-only\"\n",
        };
        let job = scratch.write(file, text);
        let verdict = verdict(&scratch, &[&job], (Decimals::LeastIncrement, LengthUnit::Mm));
        println!("{file}: {verdict}");
        assert!(verdict.ends_with(" moves"), "{verdict}");
    }
}

/// Refusal of `adapt --for linuxcnc` for a block in a small program.
fn refusal(scratch: &Scratch, block: &str) -> String {
    let program =
        format!("%\nO1\nG21G17G90G94\nT1M6\nS1000M3\nG0X0.Y0.Z5.\nG1Z-1.F100.\nG3X10.Y10.I0.J10.\n{block}\nM30\n%\n");
    let program = scratch.write("p.nc", program);
    let out = scratch.path("out.ngc");
    let output = run(&["adapt", &program, "--tool", "6", "--for", "linuxcnc", "-o", &out]);
    assert_eq!(output.status.code(), Some(1), "{block}");
    assert!(!Path::new(&out).exists(), "{block}");
    String::from_utf8_lossy(&output.stderr).replace(&program, "p.nc")
}

#[test]
fn what_linuxcnc_cannot_execute_is_refused_by_name_with_its_place_and_a_remedy() {
    let scratch = Scratch::new("linuxcnc-refusals");
    for (block, place, found) in [
        ("M10", "p.nc:9:1:", "M10"),
        ("G9G1X1.", "p.nc:9:1:", "G9"),
        ("G54.1P4", "p.nc:9:1:", "G54.1"),
        ("G68.2X0Y0Z0I10.J0K0", "p.nc:9:1:", "G68.2"),
        ("G68X0Y0R10.\nG28X1.Y1.", "p.nc:10:1:", "G28"),
        ("G51.1X0\nG81Y1.Z-1.R1.K2", "p.nc:10:1:", "G81"),
        ("G0Z5.\nG84X1.Y1.Z-1.R1.F100.", "p.nc:10:1:", "G84"),
        ("G10L10P1R5.", "p.nc:9:1:", "G10"),
        ("M8M7", "p.nc:9:3:", "M7"),
        ("/2M8", "p.nc:9:1:", "/2"),
        ("N10/M8", "p.nc:9:4:", "/"),
        ("G91G53G0Z0.", "p.nc:9:4:", "G53"),
        ("G0G43Z9.H1\nH2", "p.nc:10:1:", "H2"),
        ("G30P3Z0.", "p.nc:9:1:", "G30"),
    ] {
        let message = refusal(&scratch, block);
        assert!(message.contains(place) && message.contains(&format!("(found `{found}`)")), "{block}: {message}");
        assert!(message.contains("not for LinuxCNC: "), "{block}: {message}");
    }
}

/// Pitch: F/S under G94, F under G95. A Fanuc returns to R with the spindle, then to the initial level under G98.
#[test]
fn taps_move_with_the_spindle_to_r_and_cycles_have_the_words_that_they_inherit() {
    let scratch = Scratch::new("linuxcnc-taps");
    let program = "%\nO1\nG21G17G90G94\nT1M6\nG0X0.Y0.Z20.\nM29S400\nG98G84X10.Y5.Z-12.R3.F500.\nX20.\nG80\n\
                   M29S500\nG95\nG99G74X30.Z-8.R2.F1.5\nG0Z20.\nG94\nS900M3\nG99G81Z-3.R1.F100.K0\nX1.Y2.\nG80\nM30\n%\n";
    let (program, out) = (scratch.write("p.nc", program), scratch.path("out.ngc"));
    let output = run(&["adapt", &program, "--tool", "6", "--for", "linuxcnc", "-o", &out]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(&out).expect("the program");
    let blocks: Vec<&str> = text.lines().map(str::trim).skip_while(|line| *line != "S400").collect();
    let expected = [
        "S400",
        "G98F500.",
        "M3",
        "G0 X10. Y5.",
        "G0 Z3.",
        "G33.1 Z-12. K1.25",
        "G0 Z20.",
        "",
        "G0 X20. Y5.",
        "G0 Z3.",
        "G33.1 Z-12. K1.25",
        "G0 Z20.",
        "M5 G80",
        "S500",
        "G95",
        "G99F1.5",
        "M4",
        "G0 X30. Y5.",
        "G0 Z2.",
        "G33.1 Z-8. K1.5",
        "M5 G0Z20.",
        "G94",
        "S900M3",
        "G99F100.",
        "G81 Z-3. R1. X1.Y2.",
        "G80",
        "M30",
        "%",
    ];
    assert_eq!(blocks, expected, "{text}");
}

/// CRC-32 as in zlib, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

#[test]
fn a_job_that_needs_the_override_writes_its_moves_beside_the_program() {
    let job = root().join("examples/ibr-slot/job.toml").display().to_string();
    let scratch = Scratch::new("linuxcnc-mode");
    let output = run(&["adapt", &job, "--for", "linuxcnc", "-o", &scratch.path("out.ngc")]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(scratch.files(), ["out.ngc", "out.ngc.arcfeed"]);
    let [program, prepared] =
        ["out.ngc", "out.ngc.arcfeed"].map(|file| std::fs::read(scratch.path(file)).expect("it is written"));
    assert!(String::from_utf8_lossy(&program).contains("\nM52 P1\n"), "adaptive feed is on");
    let number = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|byte| prepared[at + byte]));
    assert_eq!(prepared[..4], *b"AFPR");
    assert_eq!((number(8), number(12)), (crc32(&program), program.len() as u32));
}
