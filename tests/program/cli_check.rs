//! Messages of `check`, and changes of `adapt` to the bytes of programs, as seen from a shell.
//!
//! Lines, columns and alarm numbers below are worked out by hand from the programs' text, counts by searching it. The
//! alarm numbers are Fanuc's (16i): 1 TH, 5 no data after address, 9 illegal address, 10 improper G code, 11 no feed,
//! 20 over tolerance of radius, 22 neither R nor I, J, K.

use std::process::Output;

use arcfeed_tests::{Scratch, root, run, shared_or_skip};
use serde_json::{Value, json};

const CORPUS: &str = "tests/corpus/cam-2003.nc";
const EXAMPLE: &str = "examples/ibr-slot";
const LISTING: &str = "data/published-listing-slots-2-4.nc";
/// F of the example's program, in/min.
const PROGRAMMED: f64 = 25.0;

/// Line, column, alarm number.
type Place = (u64, u64, Option<u64>);

/// Places at which the corpus deserves a warning: its title, its open comments, its first cutting move, its apostrophe.
const CORPUS_WARNINGS: [Place; 8] = [
    (2, 1, Some(5)),
    (8, 1, None),
    (9, 1, None),
    (10, 1, None),
    (13, 1, None),
    (16, 1, Some(11)),
    (23, 9, Some(1)),
    (25, 6, None),
];
/// Open comments that the text names only beside the first of them.
const CORPUS_GROUPED: &str = "; also at 9:1, 10:1 and 2 more\n";
/// Places at which a control stops. The number after O is missing in column 2.
const CORPUS_ALARMS: [Place; 3] = [(2, 2, Some(5)), (16, 1, Some(11)), (23, 9, Some(1))];

/// The example's program damaged in one place: the old text, the new one, the alarm, its line and its column.
const DAMAGES: [(&str, &str, u16, usize, usize); 5] = [
    // A letter O for a zero ends the number; where it stands no address belongs.
    ("I3.0952J-4.0056", "I3.0952J-4.0O56", 9, 22, 35),
    ("X-2.5752Y11.5549I4.0398J-3.0504", "X-2.5752Y11.5549", 22, 20, 1),
    // 0.0394 in: 1 mm.
    ("X-2.5752Y11.5549I", "X-2.5752Y11.5943I", 20, 20, 1),
    ("N146G2X", "N146G14X", 10, 20, 5),
    // The ends lie 1.45 in apart, the diameter is 1 in.
    ("X-2.5752Y11.5549I4.0398J-3.0504", "X-2.5752Y11.5549R0.5", 20, 20, 1),
];

fn text_of(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("arcfeed speaks UTF-8")
}

fn file_text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Exit code and JSON of a check.
fn check(arguments: &[&str]) -> (Option<i32>, Value) {
    let output = run(&[&["check", "--json"], arguments].concat());
    let report = serde_json::from_slice(&output.stdout).expect("one JSON object");
    (output.status.code(), report)
}

fn places(entries: &Value) -> Vec<Place> {
    let place = |entry: &Value| {
        let number = |field: &str| entry[field].as_u64();
        (number("line").expect("a line"), number("column").expect("a column"), number("alarm"))
    };
    entries.as_array().expect("a list").iter().map(place).collect()
}

/// Whether the text has the G word, not only the beginning of a longer one.
fn has_g(code: &str, word: &str) -> bool {
    code.match_indices(word).any(|(at, _)| !code[at + word.len()..].starts_with(|next: char| next.is_ascii_digit()))
}

/// The counts of a program whose lines are searched, not parsed.
fn counted(text: &str) -> Value {
    let [mut blocks, mut comments, mut arcs, mut helices, mut linear, mut rapids, mut rotary] = [0; 7];
    let mut is_rapid = true;
    for line in text.lines().filter(|line| !line.is_empty() && *line != "%") {
        let code = line.split('(').next().unwrap_or_default().trim_end();
        let has = |letter: char| code.contains(letter);
        blocks += 1;
        let is_comment = code.trim_start_matches(|c: char| c == 'N' || c.is_ascii_digit()).is_empty();
        comments += i32::from(is_comment || code.starts_with("OTH"));
        is_rapid = has_g(code, "G0") || is_rapid && !["G1", "G2", "G3"].iter().any(|word| has_g(code, word));
        let is_arc = has('I') && has('J');
        let is_move = ['X', 'Y', 'Z', 'B'].into_iter().any(has);
        arcs += i32::from(is_arc);
        helices += i32::from(is_arc && has('Z'));
        rapids += i32::from(is_move && is_rapid);
        linear += i32::from(is_move && !is_rapid && !is_arc);
        rotary += i32::from(has('B'));
    }
    json!({ "lines": text.lines().count(), "blocks": blocks, "comments": comments, "arcs": arcs, "helices": helices,
        "linear": linear, "rapids": rapids, "rotary": rotary })
}

/// The example, job and program, in a folder of its own; the program through `change`.
fn example(name: &str, change: impl Fn(String) -> String) -> Scratch {
    let scratch = Scratch::new(name);
    scratch.write("job.toml", file_text(&format!("{EXAMPLE}/job.toml")));
    scratch.write("ibr-slot.nc", change(file_text(&format!("{EXAMPLE}/ibr-slot.nc"))));
    scratch
}

/// Adapts the job in a folder; answers what was written.
fn adapted(scratch: &Scratch) -> String {
    let output = run(&["adapt", &scratch.path("job.toml"), "-o", &scratch.path("out.nc")]);
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    file_text(&scratch.path("out.nc"))
}

/// A line without its F words, and their numbers.
fn split_feeds(line: &str) -> (String, Vec<f64>) {
    let is_number = |c: char| c.is_ascii_digit() || c == '.';
    let (code, comment) = line.split_at(line.find('(').unwrap_or(line.len()));
    let mut parts = code.split('F');
    let mut rest = parts.next().unwrap_or_default().to_owned();
    let mut feeds = Vec::new();
    for part in parts {
        let (number, after) = part.split_at(part.find(|c| !is_number(c)).unwrap_or(part.len()));
        feeds.push(number.parse().unwrap_or_else(|_| panic!("F{part} in {line}")));
        rest.push_str(after);
    }
    (rest + comment, feeds)
}

/// The feed in effect at each line, and whether it is one per minute. In inverse time every block has its own.
fn feeds_in_effect(program: &str) -> Vec<(Option<f64>, bool)> {
    let (mut feed, mut per_minute) = (None, true);
    let at_line = |line: &str| {
        let (code, feeds) = split_feeds(line);
        if has_g(&code, "G93") || has_g(&code, "G94") {
            per_minute = has_g(&code, "G94");
            feed = None;
        }
        feed = feeds.last().copied().or(feed.filter(|_| per_minute));
        (feed, per_minute)
    };
    program.lines().map(at_line).collect()
}

fn assert_refused(output: &Output, start: &str) {
    let stderr = text_of(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.lines().any(|line| line.starts_with(start)), "no line `{start}` in:\n{stderr}");
}

#[test]
fn a_program_as_cam_systems_write_them_gets_warnings_at_their_places_and_no_error() {
    let (code, report) = check(&[CORPUS]);
    assert_eq!((code, places(&report["errors"])), (Some(0), vec![]));
    assert_eq!(places(&report["warnings"]), CORPUS_WARNINGS);
    let output = run(&["check", CORPUS]);
    let stdout = text_of(&output.stdout);
    for (line, column, alarm) in CORPUS_WARNINGS.iter().filter(|(line, ..)| ![9, 10, 13, 25].contains(line)) {
        let number = alarm.map_or(String::new(), |alarm| format!(" PS{alarm:04}"));
        let start = format!("{CORPUS}:{line}:{column}: warning{number}: ");
        assert!(stdout.lines().any(|line| line.starts_with(&start)), "no line `{start}` in:\n{stdout}");
    }
    assert!(stdout.contains(CORPUS_GROUPED), "{stdout}");
    assert_eq!((output.status.code(), text_of(&output.stderr)), (Some(0), String::new()));
}

#[test]
fn strict_reading_raises_the_alarms_of_the_control_but_none_for_an_open_comment() {
    let (code, report) = check(&[CORPUS, "--strict"]);
    assert_eq!((code, places(&report["errors"])), (Some(1), CORPUS_ALARMS.to_vec()));
    let stderr = text_of(&run(&["check", CORPUS, "--strict"]).stderr);
    let errors: Vec<&str> = stderr.lines().filter(|line| line.contains(": error")).collect();
    assert_eq!(errors.len(), CORPUS_ALARMS.len(), "{stderr}");
    for (found, (line, column, alarm)) in errors.iter().zip(CORPUS_ALARMS) {
        let start = format!("{CORPUS}:{line}:{column}: error PS{:04}: ", alarm.unwrap_or_default());
        assert!(found.starts_with(&start), "{found} where {start} is wanted");
    }
}

#[test]
fn blocks_arcs_lines_and_rotary_moves_are_counted() {
    for program in [CORPUS, "examples/ibr-slot/ibr-slot.nc"] {
        let counts = counted(&file_text(program));
        println!("{program}: {counts}");
        assert_eq!(check(&[program]).1["counts"], counts, "{program}");
    }
}

#[test]
fn the_published_program_has_no_error_and_stops_a_strict_control_five_times() {
    let test = "the published program has no error and stops a strict control five times";
    let Some(listing) = shared_or_skip(LISTING, test) else { return };
    let listing = listing.to_str().expect("the folder is named in ASCII");
    let (code, report) = check(&[listing]);
    assert_eq!((code, places(&report["errors"])), (Some(0), vec![]));
    let counts = counted(&file_text(listing));
    println!("{counts}, {} warnings", places(&report["warnings"]).len());
    assert_eq!(report["counts"], counts);
    let (code, report) = check(&[listing, "--strict"]);
    let alarms = places(&report["errors"]).into_iter().map(|(line, _, alarm)| (line, alarm));
    let wanted = [(2, 5), (57, 11), (181, 1), (183, 1), (185, 1)].map(|(line, alarm)| (line, Some(alarm)));
    assert_eq!((code, alarms.collect::<Vec<_>>()), (Some(1), wanted.to_vec()));
}

#[test]
fn each_damage_is_named_with_its_place_and_nothing_else_is() {
    let mut unwanted = Vec::new();
    for (old, new, alarm, line, column) in DAMAGES {
        let scratch = example(&format!("damage-{alarm}"), |text| text.replacen(old, new, 1));
        let program = scratch.path("ibr-slot.nc");
        let output = run(&["check", &program]);
        let wanted = format!("{program}:{line}:{column}: error PS{alarm:04}: ");
        assert_refused(&output, &wanted);
        let said = text_of(&output.stderr) + &text_of(&output.stdout);
        let complaints = said.lines().filter(|line| line.contains(": error") || line.contains(": warning"));
        unwanted.extend(complaints.filter(|line| !line.starts_with(&wanted)).map(str::to_owned));
    }
    assert!(unwanted.is_empty(), "{unwanted:#?}");
}

#[test]
fn a_file_that_is_not_there_is_named_and_the_exit_code_is_1() {
    let scratch = Scratch::new("nothing-there");
    let missing = scratch.path("missing.nc");
    assert_refused(&run(&["check", &missing]), &missing);
    let missing_job = scratch.path("missing.toml");
    assert_refused(&run(&["adapt", &missing_job]), &missing_job);
    let job = file_text(&format!("{EXAMPLE}/job.toml")).replace("ibr-slot.nc", "missing.nc");
    assert_refused(&run(&["adapt", &scratch.write("job.toml", job)]), &missing);
}

#[test]
fn invalid_command_lines_are_usage_errors() {
    let job = &format!("{EXAMPLE}/job.toml");
    let wrong: [&[&str]; 6] = [
        &["check", CORPUS, "--strictly"],
        &["check"],
        &["mill", job],
        &["adapt", job, "--json", "--diff"],
        &[],
        &["serve", job],
    ];
    for arguments in wrong {
        let output = run(arguments);
        assert_eq!((output.status.code(), text_of(&output.stdout).as_str()), (Some(2), ""), "{arguments:?}");
        assert!(text_of(&output.stderr).contains("Usage"), "{arguments:?}");
    }
}

#[test]
fn a_broken_program_is_not_adapted_and_leaves_no_file() {
    let (old, new, ..) = DAMAGES[1];
    let scratch = example("broken", |text| text.replacen(old, new, 1));
    let (job, out) = (scratch.path("job.toml"), scratch.path("out.nc"));
    assert_refused(
        &run(&["adapt", &job, "-o", &out]),
        &format!("{}:20:1: error PS0022: ", scratch.path("ibr-slot.nc")),
    );
    assert_eq!(scratch.files(), ["ibr-slot.nc", "job.toml"]);
    scratch.write("out.nc", "an older file");
    assert_eq!(run(&["adapt", &job, "-o", &out]).status.code(), Some(1));
    assert_eq!((file_text(&out).as_str(), scratch.files().len()), ("an older file", 3));
}

#[test]
fn a_program_without_a_label_gets_a_warning_about_lines() {
    let scratch = Scratch::new("label");
    let program = scratch.write("p.nc", "G21G0X1.\nM30\n%\nrest of a mail\n");
    let output = run(&["check", &program]);
    let said = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success(), "{said}");
    assert!(said.contains(&format!("{program}:1:1: warning: no % before the first block")), "{said}");
    assert!(said.contains(&format!("{program}:4:1: warning: behind the closing %")), "{said}");
}

#[test]
fn a_program_is_governed_at_its_own_spindle_speed_and_not_at_all_without_one() {
    let least = |name: &str, spindle: &str| -> Vec<f64> {
        let scratch = example(name, |text| text.replacen("N30S1000M3", spindle, 1));
        let output = run(&["adapt", &scratch.path("job.toml"), "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
        let text = text_of(&output.stdout);
        let blocks = text.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
        blocks.filter_map(|block| block["feed_min"].as_f64()).collect()
    };
    let (job, slower) = (least("spindle-job", "N30S1000M3"), least("spindle-slower", "N30S900M3"));
    assert_eq!((job.len(), slower.len()), (20, 20));
    assert!(job.iter().zip(&slower).all(|(job, slower)| (slower / job - 0.9).abs() < 1e-6), "{slower:?}");
    for (name, spindle) in [("spindle-off", "N30S1000M5"), ("spindle-0", "N30S0M3"), ("spindle-none", "N30M9")] {
        assert_eq!(least(name, spindle), [0.0; 0], "{spindle}");
    }
}

#[test]
fn the_blocks_of_another_tool_keep_their_feed() {
    let scratch = example("other-tool", |text| text.replacen("N30S1000M3", "T2M6\nN30S1000M3", 1));
    let output = run(&["adapt", &scratch.path("job.toml"), "--json"]);
    let text = text_of(&output.stdout);
    let blocks: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(blocks.iter().filter(|block| block["reason"] == "other-tool").count(), 20);
    assert!(
        blocks.iter().all(|block| block["feed_min"].is_null())
            && text_of(&output.stderr).contains("no values are given for the tool in the spindle")
    );
}

#[test]
fn every_byte_but_those_of_f_words_survives() {
    let scratch = example("bytes", |text| text);
    let (program, adapted) = (file_text(&scratch.path("ibr-slot.nc")), adapted(&scratch));
    assert_eq!(scratch.files(), ["ibr-slot.nc", "job.toml", "out.nc"]);
    let bare = |text: &str| -> Vec<String> { text.split('\n').map(|line| split_feeds(line).0).collect() };
    assert_eq!(bare(&adapted), bare(&program));
    assert!(adapted != program && adapted.split('\n').all(|line| split_feeds(line).1.len() <= 1));
    let changed: Vec<usize> =
        (1..).zip(adapted.lines().zip(program.lines())).filter(|(_, (new, old))| new != old).map(|(n, _)| n).collect();
    let diff = text_of(&run(&["adapt", &scratch.path("job.toml"), "--diff"]).stdout);
    let shown = diff.lines().filter_map(|line| line.strip_prefix(&format!("{}:", scratch.path("ibr-slot.nc"))));
    assert_eq!(shown.map(|line| line.parse().expect("a line number")).collect::<Vec<usize>>(), changed);
}

#[test]
fn blocks_without_a_law_run_at_their_own_feed_and_the_others_at_the_least_wanted() {
    let scratch = example("modal-feed", |text| text);
    let in_effect = feeds_in_effect(&adapted(&scratch));
    let own = feeds_in_effect(&file_text(&scratch.path("ibr-slot.nc")));
    let json = text_of(&run(&["adapt", &scratch.path("job.toml"), "--json"]).stdout);
    let (mut governed, mut free) = (0, 0);
    for block in json.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON")) {
        let line = block["line"].as_u64().expect("a line") as usize - 1;
        if block["law"].is_null() {
            assert_eq!(in_effect[line], own[line], "{block}");
            free += usize::from(block["kind"] != "rapid" && in_effect[line] == (Some(PROGRAMMED), true));
        } else {
            let (feed, wanted) = (in_effect[line].0.expect("a feed"), block["feed_min"].as_f64().expect("a feed"));
            assert!(feed <= wanted && feed > wanted - 0.0101, "{feed} in effect: {block}");
            governed += 1;
        }
    }
    // 13 levels: 26 arcs, 20 of them governed; the 12 lines between levels and the retract keep F25.
    assert_eq!((governed, free), (20, 6 + 12 + 1));
}

#[test]
fn line_ends_stay_as_they_are() {
    let with_lf = adapted(&example("lf", |text| text));
    assert!(!with_lf.contains('\r'));
    let with_crlf = adapted(&example("crlf", |text| text.replace('\n', "\r\n")));
    assert_eq!(with_crlf, with_lf.replace('\n', "\r\n"));
    let without_last = adapted(&example("no-last-end", |text| text.trim_end().to_owned()));
    assert_eq!(without_last, with_lf.trim_end());
}
