//! `arcfeed stream` as a command: what it refuses before the first character, says before it, and says at the end.

use arcfeed_tests::{Running, Scratch, run};
use serde_json::Value;

use crate::dnc::kill::{job, lines};

#[test]
fn what_the_line_or_the_control_cannot_carry_is_refused_before_the_first_character() {
    let scratch = Scratch::new("preflight");
    let job = job(&scratch);
    let program = std::fs::read_to_string(scratch.path("ibr-slot.nc")).expect("text");
    let traffic = scratch.path("traffic");
    let port = format!("spy://sim:?raw&file={traffic}");
    for (text, place) in [
        (program.replacen("(ONE BLISK", "(one blisk", 1), "ibr-slot.nc:2:8: error"),
        (program.replace("M30", "M9"), "M02 or M30"),
    ] {
        scratch.write("ibr-slot.nc", &text);
        let output = run(&["stream", &job, "--keep-comments", "--port", &port]);
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(1) && stderr.contains(place), "{place}: {stderr}");
        assert!(!std::path::Path::new(&traffic).exists(), "the line was opened");
    }
    scratch.write("ibr-slot.nc", program.replacen("(ONE BLISK", "(one {blisk}", 1));
    let executed = scratch.path("executed.nc");
    let output = run(&["stream", &job, "--executed", &executed]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(0) && stderr.contains("note: 1 line with comments"), "{stderr}");
    assert!(lines(&scratch, "executed.nc")[0].contains("(ONE  BLISK  SLOT"), "{:?}", lines(&scratch, "executed.nc")[0]);
    scratch.write("ibr-slot.nc", program.replacen("%\n", "", 1));
    let output = run(&["stream", &job, "--executed", &executed]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(0) && stderr.contains("% is sent before the first block"), "{stderr}");
    assert!(lines(&scratch, "executed.nc")[0].starts_with("O1546"), "{:?}", lines(&scratch, "executed.nc")[0]);
}

#[test]
fn a_program_arrives_in_every_code_and_under_the_tv_check() {
    let scratch = Scratch::new("codes");
    let job = job(&scratch);
    let executed = scratch.path("executed.nc");
    let text = std::fs::read_to_string(&job).expect("text");
    let bare = text.replace("bytesize = 7", "bytesize = 8").replace("\"E\"", "\"N\"");
    let stream_with = |job_text: String| {
        scratch.write("job.toml", job_text);
        let output = run(&["stream", &job, "--executed", &executed]);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert_eq!(stream_with(text), (Some(0), String::new()));
    let wanted = lines(&scratch, "executed.nc");
    for dnc in ["code = \"iso\"", "code = \"eia\"", "code = \"ascii\"", "code = \"iso\"\ntv_check = true"] {
        assert_eq!(stream_with(format!("{bare}\n[dnc]\n{dnc}\n")), (Some(0), String::new()), "{dnc}");
        let found = lines(&scratch, "executed.nc");
        assert_eq!(found.iter().map(|block| block.trim_end()).collect::<Vec<_>>(), wanted, "{dnc}");
    }
    for (dnc, hint) in [("code = \"utf-8\"", "\"iso\""), ("reaction = -1", "seconds"), ("echo = 1", "echo")] {
        let (code, stderr) = stream_with(format!("{bare}\n[dnc]\n{dnc}\n"));
        assert!(code == Some(1) && stderr.contains(hint) && stderr.contains("job.toml:"), "{stderr}");
    }
}

#[test]
fn a_dc1_that_is_lost_ends_in_words() {
    let scratch = Scratch::new("lost-dc1");
    let job = job(&scratch);
    let (journal, text) = (scratch.path("journal"), std::fs::read_to_string(&job).expect("text"));
    scratch.write("job.toml", format!("{text}\n[dnc]\nstart_timeout = 2\nxoff_timeout = 3\n"));
    let output = run(&["stream", &job, "--port", "fault://lost_xon=1,seed=1/sim:", "--journal", &journal]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(3) && stderr.contains("no DC1"), "{stderr}");
    // The first gets through, the next does not.
    let output = run(&["stream", &job, "--port", "fault://lost_xon=0.5,seed=1/sim:", "--journal", &journal]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(3) && stderr.contains("nothing since its DC3"), "{stderr}");
}

#[test]
fn waits_of_a_slow_line_are_predicted() {
    let scratch = Scratch::new("slow");
    let job = job(&scratch);
    for (baudrate, is_slow) in [("150", true), ("300", true), ("9600", false)] {
        let output = run(&["stream", &job, "--baudrate", baudrate, "--json"]);
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        let report: Value = serde_json::from_slice(&output.stdout).expect("the report");
        let found_s = report["link"]["starved_ms"].as_f64().expect("a number") / 1e3;
        let predicted = stderr
            .split(" s in all")
            .next()
            .and_then(|text| text.rsplit(' ').next())
            .and_then(|text| text.parse().ok());
        println!("{baudrate} baud: {predicted:?} s predicted, {found_s} s found");
        assert_eq!((predicted.is_some(), found_s > 0.0), (is_slow, is_slow), "{stderr}");
        let predicted: f64 = predicted.unwrap_or(0.0);
        assert!(
            (found_s - predicted).abs() <= 0.05 * found_s,
            "{baudrate} baud: {predicted} s predicted, {found_s} s found"
        );
    }
}

#[test]
fn completed_or_never_begun_transmissions_are_not_resumed() {
    let scratch = Scratch::new("nothing-to-resume");
    let (job, journal) = ("examples/ibr-slot/job.toml", scratch.path("journal"));
    let resume = ["stream", job, "--journal", &journal, "--resume", "--approve"];
    let stderr = |output: &std::process::Output| String::from_utf8_lossy(&output.stderr).into_owned();
    let never = run(&resume);
    assert_eq!((never.status.code(), stderr(&never).contains("no journal there")), (Some(1), true));
    assert!(run(&["stream", job, "--journal", &journal, "--json"]).status.success());
    let again = run(&resume);
    assert_eq!((again.status.code(), stderr(&again).contains("executed to its end")), (Some(1), true), "{again:?}");
}

#[test]
fn a_changed_settings_file_stops_a_resume_and_a_comment_does_not() {
    let scratch = Scratch::new("resume-settings");
    let job = job(&scratch);
    let text = std::fs::read_to_string(&job).expect("text");
    let text = text.replace("[control]", "[control]\nsettings = \"settings.toml\"");
    scratch.write("job.toml", &text);
    let settings = "unit = \"inch\"\n[work]\n\"G54\" = { X = 1.0 }\n";
    scratch.write("settings.toml", settings);
    let journal = scratch.path("journal");
    let cut = run(&["stream", &job, "--port", "fault://disconnect=900/sim:", "--journal", &journal]);
    assert_eq!(cut.status.code(), Some(3), "{}", String::from_utf8_lossy(&cut.stderr));
    let resumed = || {
        let output = run(&["stream", &job, "--journal", &journal, "--resume", "--from", "20", "--clearance", "0"]);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    // Asked to agree: the journal still counts.
    assert_eq!(resumed().0, Some(4), "{}", resumed().1);
    scratch.write("settings.toml", format!("# the vice on the left\n{settings}"));
    scratch.write("job.toml", format!("# the second part\n{text}").replace("baudrate = 9600", "baudrate = 19200"));
    assert_eq!(resumed().0, Some(4), "{}", resumed().1);
    scratch.write("settings.toml", settings.replace("1.0", "1.5"));
    let (code, stderr) = resumed();
    assert!(code == Some(1) && stderr.contains("settings file") && stderr.contains("is not what it was"), "{stderr}");
    scratch.write("settings.toml", settings);
    scratch.write("job.toml", text.replace("slew_up = 50", "slew_up = 40"));
    let (code, stderr) = resumed();
    assert!(code == Some(1) && stderr.contains("what the job"), "{stderr}");
}

/// The example with reports behind every tenth block; its job.
fn reporting(scratch: &Scratch) -> String {
    let job = job(scratch);
    let text = std::fs::read_to_string(&job).expect("text");
    scratch.write("job.toml", format!("{text}\n[dnc]\nreport_every = 10\nread_ahead = 15\n"))
}

#[test]
fn the_control_reports_where_it_is_and_the_file_stays_as_it_is() {
    let scratch = Scratch::new("reports");
    let job = reporting(&scratch);
    let (program, executed) =
        (std::fs::read(scratch.path("ibr-slot.nc")).expect("a program"), scratch.path("executed.nc"));
    let output = run(&["stream", &job, "--executed", &executed, "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).expect("the report");
    assert_eq!(report["reports"], serde_json::json!({ "requested": 6, "confirmed": 6, "line": 52 }), "{report}");
    assert_eq!(report["print_output"], serde_json::json!([]));
    let dprnt = |line: &&String| line.starts_with("DPRNT[ARCFEED*L");
    assert_eq!(lines(&scratch, "executed.nc").iter().filter(dprnt).count(), 6);
    assert_eq!(std::fs::read(scratch.path("ibr-slot.nc")).expect("a program"), program);
}

#[test]
fn reports_over_a_line_reach_the_journal_and_a_restart() {
    let scratch = Scratch::new("reports-line");
    let job = reporting(&scratch);
    let serve = ["serve", &job, "--tcp", "127.0.0.1:0", "--once", "--speed", "10"];
    let mut server = Running::start(&scratch, "whole", &serve);
    let port = server.line("port: ");
    let output = run(&["stream", &job, "--port", &port]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("6 of 6 as the program has it, it has read up to line 52"), "{said}");
    let journal = std::fs::read_to_string(scratch.path("job.journal")).expect("a journal");
    assert!(journal.contains(" executed blocks=") && journal.contains("stopped=0"), "{journal}");
    assert!(!journal.contains("stopped=1"), "the present position is unknown");
    drop(server);
    let mut server = Running::start(&scratch, "cut", &serve);
    let port = server.line("port: ");
    let output = run(&["stream", &job, "--port", &format!("fault://disconnect=2000/{port}")]);
    assert_eq!(output.status.code(), Some(3));
    let output = run(&["stream", &job, "--port", &port, "--resume", "--clearance", "0"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    let line: usize = stderr
        .split_once("executed at least up to line ")
        .and_then(|(_, rest)| rest.split(',').next())
        .and_then(|line| line.parse().ok())
        .unwrap_or_else(|| panic!("no least line: {stderr}"));
    assert!((3..50).contains(&line), "{stderr}");
}

#[test]
fn a_report_of_another_program_stops_the_sender() {
    let scratch = Scratch::new("reports-differ");
    let job = reporting(&scratch);
    let text = std::fs::read_to_string(&job).expect("text").replace("bytesize = 7", "bytesize = 8");
    scratch.write("job.toml", text.replace("\"E\"", "\"N\""));
    // A line without parity: a digit becomes another, and nothing but the report shows it.
    let output = run(&["stream", &job, "--port", "fault://tx.flip=0.0005,seed=13/sim:"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(3) && stderr.contains("is not what was sent"), "{stderr}");
    assert!(stderr.contains("feed hold, axes at rest"), "{stderr}");
}
