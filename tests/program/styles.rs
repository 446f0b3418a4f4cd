//! Programs in the styles of posts and shops (`tests/corpus/styles`): read, or refused where a control would refuse them.
//!
//! `expected.txt` has a row for each program and its options: places of errors and of warnings as line, column and alarm
//! number, worked out by hand from the text and the list of alarms.

use std::path::Path;

use arcfeed::dnc::transmission::{Transmission, Wire};
use arcfeed::program::Program;
use arcfeed_nc::block::Reading;
use arcfeed_nc::segment::Segment;
use arcfeed_nc::settings::{Preset, Scope, Settings, Tables};
use arcfeed_nc::word::is_control_character;
use arcfeed_tests::{Scratch, root, run};
use arcfeed_units::LengthUnit;
use serde_json::Value;

const CORPUS: &str = "tests/corpus/styles";
/// Programs that only the control's memory runs, whose comments do not fit its buffer, or whose title is no comment.
const NOT_STREAMED: [&str; 6] = ["macros", "lower_macro", "m98", "lastnoend", "longcomment", "title3"];
const JOB: &str = "units = \"mm\"\nprogram = \"part.nc\"\n[tool]\nkind = \"end-mill\"\ndiameter = 10.0\nteeth = 2\n\
                   [law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n[spindle]\nrev_per_min = 5000\n[limits]\nmax_feed = 5000\n";

/// A row of the table.
struct Row {
    name: String,
    options: Vec<String>,
    errors: Vec<String>,
    warnings: Vec<String>,
}

impl Row {
    fn path(&self) -> String {
        root().join(CORPUS).join(format!("{}.nc", self.name)).display().to_string()
    }

    fn bytes(&self) -> Vec<u8> {
        std::fs::read(self.path()).unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }

    /// The program is read in the standard settings, without errors.
    fn is_plain(&self) -> bool {
        self.options.is_empty() && self.errors.is_empty() && !NOT_STREAMED.contains(&self.name.as_str())
    }
}

fn rows() -> Vec<Row> {
    let table = std::fs::read_to_string(root().join(CORPUS).join("expected.txt")).expect("the table");
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let row = |line: &str| {
        let [call, errors, warnings] = line.split('|').collect::<Vec<_>>().try_into().expect("three columns");
        let mut call = words(call).into_iter();
        Row {
            name: call.next().expect("a name"),
            options: call.collect(),
            errors: words(errors),
            warnings: words(warnings),
        }
    };
    table.lines().map(row).collect()
}

fn places(entries: &Value) -> Vec<String> {
    let place = |entry: &Value| {
        let alarm = entry["alarm"].as_u64().map_or("-".to_owned(), |alarm| alarm.to_string());
        format!("{}:{}:{alarm}", entry["line"], entry["column"])
    };
    let mut places: Vec<String> = entries.as_array().expect("a list").iter().map(place).collect();
    places.sort();
    places
}

fn sorted(mut places: Vec<String>) -> Vec<String> {
    places.sort();
    places
}

fn read(bytes: &[u8]) -> Program {
    let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
    let settings = Settings { scope: Scope::Everything, ..settings };
    Program::parse_with(Path::new("part.nc"), bytes, settings, Tables::default())
}

fn moves(program: &Program) -> Vec<Segment> {
    let sequence_apart = |segment: Segment| Segment { sequence: None, ..segment };
    program.executed_moves().into_iter().map(|step| sequence_apart(step.segment)).collect()
}

#[test]
fn each_program_is_read_or_refused_where_a_control_would() {
    for row in rows() {
        let path = row.path();
        let options: Vec<&str> = row.options.iter().map(String::as_str).collect();
        let output = run(&[&["check", "--json", &path], options.as_slice()].concat());
        let report: Value =
            serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{}: {error}", row.name));
        let found = (places(&report["errors"]), places(&report["warnings"]));
        assert_eq!(found, (sorted(row.errors), sorted(row.warnings)), "{} {options:?}: {report:#}", row.name);
        let remedies = report["errors"].as_array().expect("a list").iter().map(|entry| entry["message"].to_string());
        remedies.for_each(|message| assert!(message.contains("; "), "{}: no remedy in {message}", row.name));
    }
}

/// The code of a program through `change`; comments, titles and marks stay.
fn with_code(bytes: &[u8], change: impl Fn(u8, &mut Vec<u8>)) -> Vec<u8> {
    let mut changed = Vec::new();
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        let is_code = !line.starts_with(b"%") && !line.starts_with(b"<") && !line.starts_with(b"\xef");
        let mut in_comment = !is_code;
        for &byte in line {
            in_comment |= byte == b'(';
            if in_comment || byte == b'\n' || byte == b'\r' {
                changed.push(byte);
            } else {
                change(byte, &mut changed);
            }
            in_comment = !is_code || (in_comment && byte != b')');
        }
    }
    changed
}

#[test]
fn small_letters_blanks_and_marks_of_editors_change_no_move() {
    let mut compared = 0;
    for row in rows().into_iter().filter(|row| row.is_plain() && !row.name.starts_with("bom")) {
        let bytes = row.bytes();
        let wanted = moves(&read(&bytes));
        let small = with_code(&bytes, |byte, text| text.push(byte.to_ascii_lowercase()));
        let spaced = with_code(&bytes, |byte, text| text.extend([byte, b' ']));
        let marked = [b"\xef\xbb\xbf".as_slice(), &bytes, b"\x1a"].concat();
        for (what, text) in [("small letters", small), ("blanks", spaced), ("marks", marked)] {
            let program = read(&text);
            assert!(!program.has_errors(), "{} with {what}: {:?}", row.name, program.diagnostics);
            assert_eq!(moves(&program), wanted, "{} with {what}", row.name);
        }
        compared += wanted.len();
    }
    assert!(compared > 100, "{compared} moves");
}

#[test]
fn sent_text_has_the_moves_of_the_program_in_characters_of_the_code() {
    let wire = Wire { encode: |byte| byte.is_ascii().then_some(byte), filters: true, tv_check: true };
    let mut sent_programs = 0;
    for row in rows().into_iter().filter(Row::is_plain) {
        let bytes = row.bytes();
        let sent = Transmission::new(&bytes, |_| 1, &wire).unwrap_or_else(|faults| panic!("{}: {faults:?}", row.name));
        let text = sent.text();
        let is_end = |byte: u8| matches!(byte, b'\n' | b'\r');
        assert!(text.iter().all(|&byte| is_control_character(byte) || is_end(byte)), "{}", row.name);
        assert_eq!(text.first(), Some(&b'%'), "{}", row.name);
        assert_eq!(moves(&read(text)), moves(&read(&bytes)), "{}", row.name);
        sent_programs += 1;
    }
    assert!(sent_programs > 25, "{sent_programs} programs");
}

#[test]
fn programs_as_found_run_on_the_simulated_control() {
    let scratch = Scratch::new("styles");
    let job = scratch.write("job.toml", JOB);
    for name in ["fusion_fanuc", "mastercam", "lower", "bom", "utf8", "semi", "blanks", "nopct", "safe", "chains"] {
        let row = rows().into_iter().find(|row| row.name == name).expect("a row");
        scratch.write("part.nc", row.bytes());
        for command in [&["stream", &job, "--json"][..], &["simulate", &job, "--json"]] {
            let output = run(command);
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(0), "{command:?} {name}: {stderr}");
        }
    }
}

#[test]
fn an_adapted_program_keeps_its_small_letters() {
    let scratch = Scratch::new("small-letters");
    let job = scratch.write("job.toml", JOB);
    let row = rows().into_iter().find(|row| row.name == "lower").expect("a row");
    scratch.write("part.nc", row.bytes());
    let out = scratch.path("out.nc");
    assert_eq!(run(&["adapt", &job, "-o", &out]).status.code(), Some(0));
    assert_eq!(std::fs::read(&out).expect("the output"), row.bytes());
}

#[test]
fn a_job_carries_the_conventions_that_init_was_given() {
    let scratch = Scratch::new("init-control");
    let row = rows().into_iter().find(|row| row.name == "calc").expect("a row");
    scratch.write("part.nc", row.bytes());
    let settings = scratch.write("machine.toml", "unit = \"mm\"\n[length]\n1 = 100.0\n");
    let (program, job) = (scratch.path("part.nc"), scratch.path("job.toml"));
    let call =
        ["init", &program, "-o", &job, "--control", "fanuc-31i", "--decimals", "calculator", "--settings", &settings];
    assert_eq!(run(&call).status.code(), Some(0));
    let text = std::fs::read_to_string(&job).expect("a job");
    let control = "[control]\npreset = \"fanuc-31i\"\ndecimals = \"calculator\"\nsettings = \"machine.toml\"\n";
    assert!(text.contains(control), "{text}");
    let file = JOB.to_owned() + control;
    let job = scratch.write("whole.toml", &file);
    assert_eq!(run(&["check", &job]).status.code(), Some(0));
    let job = scratch.write("plain.toml", JOB);
    let output = run(&["adapt", &job]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && stderr.contains("fit only with calculator decimals"), "{stderr}");
}

#[test]
fn centres_as_coordinates_are_a_setting() {
    let scratch = Scratch::new("arc-centres");
    let text = "%\nO1\nG21G90G54\nG0X10.Y10.\nG1F100.X20.\nG90.1G2X30.Y20.I20.J20.\nG91.1G2X20.Y10.I-10.J0\nM30\n%\n";
    scratch.write("part.nc", text);
    let with = |key: &str| {
        let job = scratch.write("job.toml", format!("{JOB}[control]\n{key}\n"));
        let output = run(&["check", &job, "--json"]);
        let report: Value = serde_json::from_slice(&output.stdout).expect("an object");
        places(&report["errors"])
    };
    assert_eq!(with(""), ["6:1:10", "7:1:10"]);
    assert!(with("arc_centers = \"incremental\"").is_empty());
    assert!(with("arc_centers = \"absolute\"").is_empty());
}
