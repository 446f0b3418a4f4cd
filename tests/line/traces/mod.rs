//! Tables of a run (`--trace`): the figures of the summary made anew from them by another program, both formats alike, whole
//! or not at all.
#![cfg(unix)]

use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::Output;

use arcfeed::trace::table::Kind;
use arcfeed::trace::tables::{BLOCKS, SAMPLES, TEETH};
use arcfeed_tests::python::python_with;
use arcfeed_tests::{Running, Scratch, root, run, skip_loudly, wait_for};
use serde_json::Value;

const JOB: &str = "examples/ibr-slot/job.toml";

/// Largest difference between a chip of the table and the same chip from its positions: the machine reports whole nanometres.
const REPORTED_MM: f64 = 3e-6;

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Words of the lines that `figures.py` prints.
fn figures(modules: &str, arguments: &[&str], test: &str) -> Option<Vec<String>> {
    let Some(mut script) = python_with(modules) else {
        skip_loudly(test, &format!("no Python with {modules} (`cargo xtask test` installs it)"));
        return None;
    };
    let output =
        script.arg(root().join("tests/line/traces/figures.py")).args(arguments).output().expect("Python starts");
    assert!(output.status.success(), "{}", text(&output.stderr));
    Some(text(&output.stdout).lines().map(one_blank).collect())
}

fn one_blank(line: &str) -> String {
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn simulated(trace: &str) -> Output {
    let output = run(&["simulate", JOB, "--trace", trace]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    output
}

/// Lines of the summary that the script prints too are equal word by word; the other figures are within their bounds.
fn assert_recomputed(summary: &Output, lines: &[String]) {
    let printed: Vec<String> = text(&summary.stdout).lines().map(one_blank).collect();
    for line in &lines[..5] {
        assert!(printed.contains(line), "not in the summary: {line}\n{printed:#?}");
    }
    let count_and_mm = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let (count, at_most) =
            (words[0].parse::<u32>().expect("a count"), words.iter().rev().nth(3).expect("a figure"));
        (count, at_most.parse::<f64>().expect("a length"))
    };
    let ((chips, anew_mm), (blocks, block_mm)) = (count_and_mm(&lines[5]), count_and_mm(&lines[6]));
    println!("{lines:#?}");
    assert!(chips > 10_000 && anew_mm < REPORTED_MM, "{}", lines[5]);
    assert!(blocks == 20 && block_mm < 1e-12, "{}", lines[6]);
}

#[test]
fn the_summary_is_computed_anew_from_csv() {
    let scratch = Scratch::new("trace-csv");
    let trace = scratch.path("run.csv");
    let summary = simulated(&trace);
    let test = "the_summary_is_computed_anew_from_csv";
    let Some(lines) = figures("csv", &[&trace], test) else { return };
    assert_recomputed(&summary, &lines);
}

#[test]
fn the_summary_is_computed_anew_from_parquet_and_both_formats_have_the_same_values() {
    let scratch = Scratch::new("trace-parquet");
    let (parquet, csv) = (scratch.path("run.parquet"), scratch.path("run.csv"));
    let summary = simulated(&parquet);
    simulated(&csv);
    let test = "the_summary_is_computed_anew_from_parquet_and_both_formats_have_the_same_values";
    let Some(lines) = figures("duckdb", &[&parquet], test) else { return };
    assert_recomputed(&summary, &lines);
    let with_unit = SAMPLES.columns.iter().filter(|column| !column.unit.is_empty()).count();
    assert_eq!(lines.last(), Some(&format!("schema 1, {with_unit} columns with a unit")));
    for suffix in ["", "-blocks", "-original", "-original-blocks"] {
        let paths = ["parquet", "csv"].map(|kind| scratch.path(&format!("run{suffix}.{kind}")));
        let size = std::fs::metadata(&paths[0]).expect("the table").len();
        let equal = figures("duckdb", &[&paths[0], &paths[1]], test).expect("the same Python");
        println!("run{suffix}.parquet: {size} bytes, {}", equal[0]);
    }
}

/// Rows of a CSV file by the names of its columns.
fn rows(path: &str) -> Vec<Vec<(String, String)>> {
    let table = std::fs::read_to_string(path).expect("the table");
    let mut lines = table.lines().map(|line| line.split(',').map(str::to_owned));
    let names: Vec<String> = lines.next().expect("a header").collect();
    lines.map(|line| names.iter().cloned().zip(line).collect()).collect()
}

fn number(row: &[(String, String)], name: &str) -> f64 {
    let (_, value) = row.iter().find(|(other, _)| other == name).unwrap_or_else(|| panic!("no {name}"));
    value.parse().unwrap_or_else(|_| panic!("{name} is `{value}`"))
}

#[test]
fn passes_of_the_teeth_and_loads_of_the_blocks_have_the_sums_of_the_report() {
    let scratch = Scratch::new("trace-teeth");
    let trace = scratch.path("run.csv");
    let output = run(&["simulate", "examples/ibr-slot/job-cutting.toml", "--json", "--trace", &trace]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    for (run, loads) in [("run", &report["loads"]["load"]), ("run-original", &report["loads"]["baseline"])] {
        let (teeth, blocks) =
            (rows(&scratch.path(&format!("{run}-teeth.csv"))), rows(&scratch.path(&format!("{run}-blocks.csv"))));
        for (index, edge) in ["outer", "inner"].into_iter().enumerate() {
            let passes = teeth.iter().filter(|row| row.contains(&("edge".to_owned(), edge.to_owned())));
            let chips: Vec<f64> = passes.map(|row| number(row, "chip_mm")).collect();
            let (largest, mean) =
                (chips.iter().copied().fold(0.0, f64::max), chips.iter().sum::<f64>() / chips.len() as f64);
            let near = |found_mm: f64, name: &str| {
                let wanted_mm = loads[name][index].as_f64().expect("a chip") * 25.4;
                assert!((found_mm - wanted_mm).abs() < 1e-9, "{run} {edge} {name}: {found_mm} for {wanted_mm}");
            };
            assert_eq!(Some(chips.len() as u64), loads["chips"][index].as_u64(), "{run} {edge}");
            near(largest, "chip_max");
            near(mean, "chip_mean");
        }
        let most =
            |rows: &[Vec<(String, String)>], name: &str| rows.iter().map(|row| number(row, name)).fold(0.0, f64::max);
        let cut: Vec<_> = blocks
            .iter()
            .filter(|row| row.iter().any(|(name, value)| name == "cutting_s" && !value.is_empty()))
            .cloned()
            .collect();
        for (name, wanted) in [("force_max_n", "force_max_n"), ("torque_max_n_m", "torque_max_n_m")] {
            assert_eq!(Some(most(&cut, name)), loads[wanted].as_f64(), "{run} {name}");
        }
        let time_s: f64 = cut.iter().map(|row| number(row, "cutting_s")).sum();
        assert!((time_s - loads["time_s"].as_f64().expect("a time")).abs() < 1e-9, "{run}: {time_s}");
        // The largest force of a run is in the pass of some tooth.
        assert!(most(&teeth, "force_n") <= most(&cut, "force_max_n") && most(&teeth, "force_n") > 0.0);
        println!("{run}: {} passes, {} blocks with chips", teeth.len(), cut.len());
    }
}

#[test]
fn the_blocks_of_a_sent_program_have_its_lines() {
    let scratch = Scratch::new("trace-stream");
    let sent = scratch.path("sent.csv");
    let output = run(&["stream", JOB, "--port", "sim:", "--trace", &sent]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let program = std::fs::read_to_string(root().join("examples/ibr-slot/ibr-slot.nc")).expect("the program");
    let blocks = rows(&scratch.path("sent-blocks.csv"));
    for row in &blocks {
        let (n, line) = (&row[1].1, number(row, "line") as usize);
        let text = program.lines().nth(line - 1).expect("a line");
        assert!(n.is_empty() || text.starts_with(&format!("N{n}")), "line {line} is no N{n}: {text}");
    }
    assert!(blocks.len() > 30, "{} blocks", blocks.len());
}

#[test]
fn serve_writes_the_run_of_a_program_that_a_sender_sends() {
    let scratch = Scratch::new("trace-serve");
    let served = scratch.path("served.csv");
    let arguments =
        ["serve", "--tcp", "127.0.0.1:0", "--once", "--speed", "50", "--baudrate", "115200", "--trace", &served];
    let mut server = Running::start(&scratch, "serve", &arguments);
    let address = server.line("port: socket://");
    let mut line = TcpStream::connect(address).expect("the control listens");
    let mut byte = [0];
    line.read_exact(&mut byte).expect("DC1");
    line.write_all(b"%\nO7\nG21G94G1X100.F6000\nG0X0.\nM30\n%\n").expect("the control takes it");
    let ended = server.end();
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    let blocks = rows(&scratch.path("served-blocks.csv"));
    let feeds: Vec<f64> = blocks.iter().map(|row| number(row, "feed_max_mm_per_min").round()).collect();
    assert_eq!((feeds.len(), feeds[0]), (2, 6000.0), "{blocks:?}");
    // 100 mm at 100 mm/s, with two ramps of 500 mm/s2 from and to rest at most.
    let moving = rows(&served).iter().filter(|row| row[1].1 == blocks[0][0].1).count();
    assert!((1_000..=1_201).contains(&moving), "{moving} ms");
    assert!(!scratch.files().contains(&"served-teeth.csv".to_owned()));
}

#[test]
fn a_trace_that_cannot_be_written_leaves_nothing_behind_and_says_why() {
    let scratch = Scratch::new("trace-refused");
    let job = scratch.path("job.toml");
    for name in ["job.toml", "ibr-slot.nc"] {
        scratch.write(name, std::fs::read(root().join("examples/ibr-slot").join(name)).expect("the example"));
    }
    let before = scratch.files();
    let folder = scratch.path("no-folder/run.csv");
    for (trace, code, words) in [
        ("run.txt", 2, "--trace: run.txt: give a name that ends in .parquet or .csv"),
        ("run", 2, "--trace: run: give a name that ends in .parquet or .csv"),
        (&folder, 1, "there is no folder"),
    ] {
        for command in [&["simulate", &job][..], &["stream", &job, "--port", "sim:"]] {
            let output = run(&[command, &["--trace", trace]].concat());
            let message = text(&output.stderr);
            assert!(output.status.code() == Some(code) && message.contains(words), "{command:?} {trace}: {message}");
        }
    }
    // The table of the blocks would take the place of the program's file.
    let program = std::fs::read_to_string(&job).expect("the job").replace("ibr-slot.nc", "run-blocks.csv");
    std::fs::rename(scratch.path("ibr-slot.nc"), scratch.path("run-blocks.csv")).expect("renamed");
    let over = scratch.write("over.toml", program);
    let output = run(&["simulate", &over, "--trace", &scratch.path("run.csv")]);
    assert!(output.status.code() == Some(1) && text(&output.stderr).contains("this is the input"), "{output:?}");
    std::fs::rename(scratch.path("run-blocks.csv"), scratch.path("ibr-slot.nc")).expect("renamed");
    std::fs::remove_file(over).expect("removed");
    assert_eq!(scratch.files(), before);
    let output = run(&["stream", &job, "--port", "loop://", "--trace", &scratch.path("run.csv")]);
    assert!(output.status.code() == Some(2) && text(&output.stderr).contains("or use sim:"), "{output:?}");
}

#[test]
fn a_simulation_that_the_operator_stops_writes_no_table() {
    let scratch = Scratch::new("trace-stopped");
    // 16 hours of machine time.
    let program = scratch.write("slow.nc", "%\nO1\nG21G17G90G94\nS9000M3\nG0X0.Y0.Z0.\nG1X1000.F1.\nM30\n%\n");
    let trace = scratch.path("slow.csv");
    let options = ["--tool", "10", "--teeth", "4", "--feed-per-tooth", "0.05", "--trace", &trace];
    let running = Running::start(&scratch, "run", &[&["simulate", &program][..], &options].concat());
    let growing = || scratch.files().iter().any(|name| name.ends_with(".part")).then_some(());
    wait_for("a table that grows", growing);
    running.interrupt();
    let ended = running.end();
    assert!(ended.code == Some(130) && ended.err.contains("no table of the trace is written"), "{ended:?}");
    assert_eq!(scratch.files(), ["run.err", "run.out", "slow.nc"]);
}

#[test]
fn the_document_has_every_column_with_its_unit_and_meaning() {
    let document = std::fs::read_to_string(root().join("docs/traces.md")).expect("the document");
    let mut columns = 0;
    for (table, heading) in [(&SAMPLES, "## Samples"), (&TEETH, "## Teeth"), (&BLOCKS, "## Blocks")] {
        let section = document.split_once(heading).expect(heading).1;
        let section = section.split("\n## ").next().expect("a section");
        let documented: Vec<&str> = section.lines().filter(|line| line.starts_with("| `")).collect();
        let wanted = table.columns.iter().map(|column| {
            let kind = match column.kind {
                Kind::Integer => "integer",
                Kind::Number => "number",
                Kind::Text => "text",
                Kind::Flag => "flag",
            };
            format!("| `{}` | {kind} | {} | {} |", column.name, column.unit, column.about)
        });
        assert_eq!(documented, wanted.collect::<Vec<_>>(), "{heading}");
        columns += documented.len();
    }
    assert_eq!(columns, 70);
}
