//! What `check`, `init` and `adapt` say of everyday programs: an assumed unit, a stopped spindle, T0, comments of tools, errors of
//! one kind, words of LinuxCNC, and why nothing is governed.
//!
//! Places are counted by hand in the programs' text.

use arcfeed_tests::{Scratch, run};
use serde_json::Value;

/// Exit code and JSON object of `check`.
fn check(scratch: &Scratch, program: &str, options: &[&str]) -> (Option<i32>, Value) {
    let output = run(&[&["check", "--json", &scratch.write("p.nc", program)][..], options].concat());
    (output.status.code(), serde_json::from_slice(&output.stdout).expect("an object"))
}

/// Places of the warnings whose message contains `part`.
fn warned(report: &Value, part: &str) -> Vec<(u64, u64)> {
    let entries = report["warnings"].as_array().expect("warnings").iter();
    let of = entries.filter(|entry| entry["message"].as_str().is_some_and(|message| message.contains(part)));
    of.map(|entry| (entry["line"].as_u64().expect("a line"), entry["column"].as_u64().expect("a column"))).collect()
}

fn messages(output: &std::process::Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn an_assumed_unit_is_named_with_its_reason_and_read_alike_by_all_commands() {
    let scratch = Scratch::new("noticed-unit");
    let moves = |decimals: &str| format!("G1X1.{decimals}F100.\nX2.{decimals}\n").repeat(4);
    for (title, decimals, unit, why) in [
        ("", "5", "in", "inches, the unit at power-on"),
        ("", "125", "mm", "millimetres, because coordinates have three decimals"),
        ("", "0125", "in", "inches, because coordinates have four decimals"),
        ("(10MM ENDMILL)", "5", "mm", "millimetres, the unit in its comments"),
    ] {
        let program = format!("%\nO1{title}\nT1M6\nS1000M3\nG0 X10.Y0\n{}M30\n%\n", moves(decimals));
        let (code, report) = check(&scratch, &program, &[]);
        assert_eq!((code, &report["summary"]["unit"]), (Some(0), &Value::from(unit)), "{program}");
        assert_eq!(warned(&report, why), [(5, 4)], "{program}");
        // Extents in the unit: the coordinates as written.
        let low = report["summary"]["extents"][0]["min"].as_f64().expect("a number");
        let written: f64 = format!("1.{decimals}").parse().expect("a number");
        assert!((low - written).abs() < 1e-9, "{low}");
        for given in ["inch", "mm"] {
            let (_, report) = check(&scratch, &program, &["--units", given]);
            assert_eq!(warned(&report, "G20"), []);
            assert_eq!(report["summary"]["unit"], Value::from(if given == "mm" { "mm" } else { "in" }));
        }
        let settings = scratch.write("settings.toml", "unit = \"mm\"\n");
        assert_eq!(warned(&check(&scratch, &program, &["--settings", &settings]).1, "G20"), []);
        let (job, path) = (scratch.path("p.toml"), scratch.path("p.nc"));
        assert!(run(&["init", &path, "-o", &job, "--force"]).status.success());
        let written = std::fs::read_to_string(&job).expect("the job");
        let unit = match (unit, why.contains("power-on")) {
            (_, true) => "?",
            ("mm", _) => "mm",
            _ => "inch",
        };
        assert!(written.contains(&format!("units = \"{unit}\"")), "{written}");
        assert!(run(&["init", &path, "-o", &job, "--force", "--settings", &settings]).status.success());
        let written = std::fs::read_to_string(&job).expect("the job");
        assert!(written.contains("units = \"mm\""), "the settings file states it: {written}");
    }
    let (_, report) = check(&scratch, "%\nO1\nG21\nG1X1.F100.\nM30\n%\n", &[]);
    assert_eq!(warned(&report, "G20"), []);
}

#[test]
fn cuts_with_a_stopped_spindle_are_warned_of_in_plain_and_in_called_blocks() {
    let scratch = Scratch::new("noticed-spindle");
    let stopped = |program: &str| warned(&check(&scratch, program, &[]).1, "spindle stands still");
    assert_eq!(stopped("%\nO1\nG21T1M6\nS500M3\nG0X0Y0\nG1X9.F100.\nM5\nG1X1.\nX2.\nM3\nX3.\nM30\n%\n"), [(8, 1)]);
    assert_eq!(stopped("%\nO1\nG21T1M6\nG0X0Y0\nG2I1.F100.\nM30\n%\n"), [(5, 1)]);
    assert_eq!(stopped("%\nO1\nG21T1M6\nS500M3\nM98P2\nM5\nM98P2\nM30\nO2\nG1X9.F100.\nM99\n%\n"), [(10, 1)]);
    assert_eq!(stopped("%\nO1\nG21T1M6\nS500M3\nG0X0Y0\nG1X9.F100.\nM30\n%\n"), []);
    assert_eq!(stopped("%\nO1\nG21T1M6\nM29S500\nG0X0Y0\nG84X9.Z-5.R1.F500.\nM30\n%\n"), []);
}

/// A pocket corner of an end mill, between these lines.
fn corner(before: &str, behind: &str) -> String {
    format!("%\nO1\nG21G90G17G94\n{before}\nG0X0Y0\nG1X20.F400.\nG3X30.Y10.I0J10.\nG1Y20.\n{behind}M30\n%\n")
}

#[test]
fn t0_unloads_and_is_no_tool_of_the_program() {
    let scratch = Scratch::new("noticed-t0");
    let program = scratch.write("p.nc", corner("T1M6\nS1000M3", "M5\nT0M6\n"));
    let job = "units = \"mm\"\nprogram = \"p.nc\"\n[tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 2\n[spindle]\n\
               rev_per_min = 1000\n[limits]\nmax_feed = 900\n[law]\nkind = \"contour\"\nfeed_per_tooth = 0.1\n[[cut]]\n\
               moves = \"arcs\"\ndirection = \"ccw\"\nside = \"inside\"\n";
    for text in [corner("T1M6\nS1000M3", "M5\nT0M6\n"), corner("T0M6\nT1M6\nS1000M3", "")] {
        scratch.write("p.nc", text);
        let output = run(&["adapt", &scratch.write("job.toml", job)]);
        let said = String::from_utf8_lossy(&output.stdout).into_owned() + &messages(&output);
        assert!(output.status.success() && said.contains("1 of "), "{said}");
        let output = run(&["init", &program, "-o", &scratch.path("own.toml"), "--force", "--json"]);
        let report: Value = serde_json::from_slice(&output.stdout).expect("an object");
        assert_eq!(report["tools"], serde_json::json!([1]), "{report}");
    }
}

#[test]
fn the_table_of_tools_has_the_comment_that_describes_the_tool() {
    let scratch = Scratch::new("noticed-comment");
    for (before, comment) in [
        ("(T1 D=10. - FLAT END MILL)\n()\nT1M6( )\n(OP 10)", "T1 D=10. - FLAT END MILL"),
        ("(10MM ENDMILL)\n(---)\nT1M6", "10MM ENDMILL"),
        ("T1M6(OP 10)", "OP 10"),
        ("(T1 D=6. - BALL)(T2 D=8.)\nT1M6", "T1 D=6. - BALL"),
    ] {
        let (_, report) = check(&scratch, &corner(&format!("{before}\nS1000M3"), ""), &[]);
        let tools = report["summary"]["tools"].as_array().expect("tools");
        let own = tools.iter().find(|tool| tool["tool"].as_i64() == Some(1)).expect("T1");
        assert_eq!(own["comment"], Value::from(comment), "{before}");
    }
}

#[test]
fn init_names_the_error_that_check_does_not_have() {
    let scratch = Scratch::new("noticed-init");
    let program = scratch.write("p.nc", corner("T1M6\nS1000M3\n#1=#13001", ""));
    assert!(run(&["check", &program]).status.success());
    let said = messages(&run(&["init", &program, "-o", &scratch.path("p.toml")]));
    assert!(said.contains("p.nc:6:4: error: ") && said.contains("#13001") && said.contains("[radius]"), "{said}");
}

#[test]
fn errors_of_one_kind_are_one_message_with_its_places() {
    let scratch = Scratch::new("noticed-errors");
    let program = scratch.write("p.nc", "%\nO1\nG21G187P1\nG187P2\nG1X1.F100.\nG187P3\nG187P1\nG14\nM30\n%\n");
    let output = run(&["check", &program]);
    let said = messages(&output);
    let errors: Vec<&str> = said.lines().filter(|line| line.contains(": error")).collect();
    let [first, second] = errors[..] else { panic!("{said}") };
    assert!(first.contains("p.nc:3:4: error") && first.ends_with("; also at 4:1, 6:1 and 1 more"), "{first}");
    assert!(second.contains("p.nc:8:1: error PS0010"), "{second}");
    assert!(said.contains("5 errors"), "{said}");
}

#[test]
fn remedies_name_what_to_write() {
    let scratch = Scratch::new("noticed-remedies");
    for (line, words) in [
        ("X#5410", &["LinuxCNC", "#13001", "#4120"][..]),
        ("#1=#5063", &["G31"]),
        ("G1X10,5Y2.F100.", &["PS0009", "a decimal point", "comma"]),
        ("G1Z-2,F100.", &["a decimal point", "comma"]),
        ("M98P9010", &["PS0078", "--library", "M99"]),
        ("o100 sub", &["LinuxCNC", "M98 P"]),
        ("o<pocket> call [1] [2]", &["LinuxCNC", "G65 P"]),
        ("o101 if [#1 EQ 1]", &["LinuxCNC", "IF, WHILE"]),
    ] {
        let program = scratch.write("p.nc", corner(&format!("T1M6\nS1000M3\n{line}"), ""));
        for command in [&["check", &program][..], &["init", &program, "-o", &scratch.path("p.toml"), "--force"]] {
            let output = run(command);
            let said = messages(&output);
            let error = said.lines().find(|line| line.contains("p.nc:6:")).unwrap_or_else(|| panic!("{line}: {said}"));
            assert!(words.iter().all(|word| error.contains(word)), "{line}: {error}");
        }
    }
}

#[test]
fn a_program_without_a_governed_move_says_why_and_what_to_change() {
    let scratch = Scratch::new("noticed-nothing");
    scratch.write("p.nc", corner("T1M6\nS1000M3", ""));
    let job = |tool: &str, rule: &str| {
        format!(
            "units = \"mm\"\nprogram = \"p.nc\"\n[tool]\nkind = \"end-mill\"\nnumber = {tool}\ndiameter = 10\nteeth = 2\n[spindle]\n\
             rev_per_min = 1000\n[limits]\nmax_feed = 900\n[law]\nkind = \"contour\"\nfeed_per_tooth = 0.1\n{rule}"
        )
    };
    let arcs = "[[cut]]\nmoves = \"arcs\"\nside = \"inside\"\n";
    for (job, why) in [
        (job("1", &format!("{arcs}direction = \"cw\"\n")), Some("no cut rule fits its 3 cutting moves")),
        (job("1", ""), Some("the job has no cut rule")),
        (job("2", &format!("{arcs}direction = \"ccw\"\n")), Some("2 no-rule, 1 other-tool")),
        (job("1", &format!("{arcs}direction = \"ccw\"\n")), None),
    ] {
        let output = run(&["adapt", &scratch.write("job.toml", &job), "-o", &scratch.path("out.nc")]);
        assert!(output.status.success());
        let said = messages(&output);
        let found = said.lines().find(|line| line.contains("no move is governed"));
        assert_eq!(found.is_some(), why.is_some(), "{said}");
        assert!(why.is_none_or(|why| found.is_some_and(|found| found.contains(why))), "{said}");
    }
}

#[test]
fn one_warning_and_one_error_are_no_plural() {
    let scratch = Scratch::new("one-warning");
    let contour = "%\nO1\nG21G17G90\nG0X0Y0\nG41D1G1X9.Y0.F90.\nY9.\nG40X0.\nM30\n%\n";
    let said = String::from_utf8_lossy(&run(&["check", &scratch.write("p.nc", contour)]).stdout).into_owned();
    assert!(
        said.contains(": 9 lines, 7 blocks ") && said.contains(" 1 rapid; ") && said.ends_with("; 1 warning\n"),
        "{said}"
    );
    let refused = run(&["check", &scratch.write("q.nc", "%\nO1\nG21G0X0Y0\nG2X9.Y0I1.J1.F90.\nM30\n%\n")]);
    assert!(messages(&refused).contains("q.nc: 1 error: the control would stop"), "{}", messages(&refused));
}

/// Output and messages of `init` for a program.
fn proposed(scratch: &Scratch, program: &str, options: &[&str]) -> String {
    let program = scratch.write("p.nc", program);
    let output = run(&[&["init", &program, "-o", &scratch.path("p.toml"), "--force"][..], options].concat());
    assert!(output.status.success(), "{}", messages(&output));
    String::from_utf8_lossy(&output.stdout).into_owned() + &messages(&output)
}

#[test]
fn init_says_which_arcs_keep_their_feeds_and_what_to_give() {
    let scratch = Scratch::new("noticed-kept");
    let of = |comment: &str| corner(&format!("T7M6({comment})\nS1000M3"), "");
    let said = proposed(&scratch, &of("8MM BALL"), &[]);
    assert!(said.contains("all feeds stay") && said.contains("(8MM BALL) it is no end mill"), "{said}");
    let said = proposed(&scratch, &of("8MM SLOT DRILL 2 FLUTE"), &[]);
    assert!(
        said.contains("T7: likely an end mill, diameter 8.0 mm; 1 cut rule\n") && said.contains("  line 8  Z"),
        "{said}"
    );
    // A centre path of 10 mm cannot run around the outside of a contour with a tool of 24 mm.
    let clockwise = of("24MM ENDMILL").replace("G3X30.Y10.I0J10.", "G2X30.Y-10.I0J-10.");
    assert!(proposed(&scratch, &clockwise, &[]).contains("--milling conventional"));
    assert!(!proposed(&scratch, &clockwise, &["--milling", "conventional"]).contains("--milling"));
    assert!(!proposed(&scratch, &clockwise.replace("24MM", "18MM"), &[]).contains("--milling"));
    let contour = of("8MM ENDMILL").replace("G1X20.F400.", "G41D7G1X20.F400.");
    let said = proposed(&scratch, &contour, &[]);
    assert!(
        said.contains("p.nc:8: note: the arcs under G41 or G42 (1) keep their feed") && said.contains("[radius]"),
        "{said}"
    );
}

#[test]
fn init_names_files_relative_to_the_job_also_in_another_folder() {
    let scratch = Scratch::new("noticed-relative");
    let program = scratch.write("p.nc", corner("T7M6(8MM ENDMILL)\nS1000M3", ""));
    let settings = scratch.write("cnc.toml", "unit = \"mm\"\n");
    for (folder, up) in [("jobs", "../"), ("jobs/milling", "../../")] {
        std::fs::create_dir_all(scratch.path(folder)).expect("a folder");
        let job = scratch.path(&format!("{folder}/p.toml"));
        assert!(run(&["init", &program, "-o", &job, "--settings", &settings]).status.success());
        let text = std::fs::read_to_string(&job).expect("the job");
        for (key, file) in [("program", "p.nc"), ("settings", "cnc.toml")] {
            assert!(text.contains(&format!("{key} = \"{up}{file}\"\n")), "{text}");
        }
        assert!(run(&["check", &job]).status.success(), "the names lead to the files");
    }
}
