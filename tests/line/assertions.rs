//! `simulate --assert` and `--junit`: broken limits, missing figures, and the file that a CI server reads.

use arcfeed_tests::{Scratch, root, run};

const JOB: &str = "examples/pocket/job-contour.toml";

/// Exit code and messages of a run with these assertions.
fn asserted(job: &str, assertions: &[&str], options: &[&str]) -> (Option<i32>, String) {
    let asserted = assertions.iter().flat_map(|assertion| ["--assert", assertion]);
    let arguments: Vec<&str> = ["simulate", job].into_iter().chain(asserted).chain(options.iter().copied()).collect();
    let output = run(&arguments);
    (output.status.code(), String::from_utf8(output.stderr).expect("text"))
}

#[test]
fn limits_that_hold_are_printed_with_their_figures() {
    let output =
        run(&["simulate", JOB, "--assert", "chip<=1.005", "--assert", "feed<=127in/min", "--assert", "time<=20s"]);
    let text = String::from_utf8(output.stdout).expect("text");
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("--assert")).collect();
    // The highest feed is that of the program, 3200 mm/min; the time is that of the summary.
    let time = text.lines().find_map(|line| line.split_once("before, ")?.1.split_once(" s after")).expect("a time").0;
    assert!(lines[0].starts_with("--assert chip<=1.005: holds, at most 1.0"), "{text}");
    assert_eq!(lines[1], "--assert feed<=127in/min: holds, at most 3200 mm/min", "{text}");
    assert!(lines[2].starts_with(&format!("--assert time<=20s: holds, at most {time}")), "{text}");
    assert_eq!(lines.len(), 3, "{text}");
}

#[test]
fn limits_that_hold_change_nothing() {
    let found = asserted(JOB, &["chip<=1.005", "feed<=3201mm/min", "feed<=127in/min", "time<=20s", "time<=1min"], &[]);
    assert_eq!(found, (Some(0), String::new()));
}

#[test]
fn a_broken_limit_names_the_first_block_above_it() {
    for (assertion, words) in [
        ("chip<=0.9", "pocket.nc:13: N140: chip is 1.000, the limit 0.9000"),
        ("feed<=3000mm/min", "pocket.nc:12: N130: feed is 3200 mm/min, the limit 3000 mm/min"),
        ("time<=10s", "pocket.nc:26: N410: time is 14.2"),
    ] {
        let (code, found) = asserted(JOB, &["chip<=1.05", assertion], &[]);
        assert!(code == Some(1) && found.lines().count() == 1 && found.contains(words), "{words}: {found}");
    }
}

#[test]
fn a_figure_that_the_run_does_not_have_never_passes() {
    let scratch = Scratch::new("assert-missing");
    scratch.write("p.nc", "%\nG21G17G90G94\nS3000M3\nG0X0Y0Z5.\nG1X9.F600.\nM30\n%\n");
    let job = "units = \"mm\"\nprogram = \"p.nc\"\n[tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\n\
               [spindle]\nrev_per_min = 3000\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n";
    let job = scratch.write("job.toml", job);
    for (assertion, words) in [
        ("chip<=9", "add a [[cut]] rule"),
        ("power<=9kW", "[workpiece] with `material`"),
        ("torque<=9Nm", "[cutting]"),
        ("force<=9kN", "[cutting]"),
    ] {
        let (code, found) = asserted(&job, &[assertion], &[]);
        assert!(code == Some(1) && found.contains(words), "{words}: {found}");
    }
    let (code, found) = asserted(&job, &["chip<1"], &[]);
    assert!(code == Some(2) && found.contains("FIGURE<=LIMIT"), "{found}");
    let (code, found) = asserted(&job, &[], &["--junit", &scratch.path("x.xml")]);
    assert!(code == Some(2) && found.contains("--assert"), "{found}");
}

#[test]
fn the_limits_of_the_example_workflow_are_such_that_the_example_keeps_them() {
    let workflow = std::fs::read_to_string(root().join("examples/ci/workflow.yml")).expect("the example");
    let limits: Vec<&str> =
        workflow.split("--assert '").skip(1).filter_map(|rest| Some(rest.split_once('\'')?.0)).collect();
    assert_eq!(limits.len(), 3);
    assert_eq!(asserted(JOB, &limits, &[]), (Some(0), String::new()));
}

/// Element of an XML text: its name and attributes.
#[derive(Debug, PartialEq)]
struct Element<'x> {
    name: &'x str,
    attributes: Vec<(&'x str, &'x str)>,
}

impl<'x> Element<'x> {
    fn attribute(&self, name: &str) -> &'x str {
        let found = self.attributes.iter().find(|(other, _)| *other == name);
        found.unwrap_or_else(|| panic!("no {name} in {self:?}")).1
    }
}

/// Elements in order of their beginnings; each must end, and in the right order.
fn elements(xml: &str) -> Vec<Element<'_>> {
    let (mut found, mut open) = (Vec::new(), Vec::new());
    let body = xml.strip_prefix("<?xml version=\"1.0\" encoding=\"UTF-8\"?>").expect("a declaration");
    for part in body.split('<').skip(1) {
        let (tag, text) = part.split_once('>').expect("a tag ends");
        assert!(!text.contains('>'), "{text}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
            continue;
        }
        let inner = tag.strip_suffix('/').unwrap_or(tag);
        let (name, mut rest) = inner.split_once(' ').expect("each element has attributes");
        let mut attributes = Vec::new();
        while let Some((key, after)) = rest.trim_start().split_once("=\"") {
            let (value, after) = after.split_once('"').expect("a value ends");
            attributes.push((key, value));
            rest = after;
        }
        if inner == tag {
            open.push(name);
        }
        found.push(Element { name, attributes });
    }
    assert!(open.is_empty(), "{open:?}");
    found
}

#[test]
fn the_file_has_the_structure_that_ci_servers_read() {
    let scratch = Scratch::new("assert-junit");
    let path = scratch.path("result.xml");
    let (code, _) = asserted(JOB, &["chip<=1.05", "time<=10s", "power<=11kW"], &["--junit", &path]);
    assert_eq!(code, Some(1));
    let xml = std::fs::read_to_string(&path).expect("it is written although a limit is broken");
    let elements = elements(&xml);
    let names: Vec<&str> = elements.iter().map(|element| element.name).collect();
    assert_eq!(names, ["testsuites", "testsuite", "testcase", "testcase", "failure", "testcase", "error"]);
    for suite in &elements[..2] {
        let counts = ["tests", "failures", "errors"].map(|count| suite.attribute(count));
        assert_eq!(counts, ["3", "1", "1"]);
        assert!(suite.attribute("time").parse::<f64>().expect("a number") >= 0.0);
    }
    for case in elements.iter().filter(|element| element.name == "testcase") {
        assert!(case.attribute("classname").ends_with("job-contour.toml") && case.attribute("time") == "0");
    }
    assert_eq!(elements[2].attribute("name"), "chip&lt;=1.05");
    assert!(
        elements[4].attribute("message").contains("N410") && elements[6].attribute("message").contains("[cutting]")
    );
    assert!(!scratch.files().iter().any(|name| name.ends_with(".part")), "{:?}", scratch.files());
}

#[test]
fn a_run_over_the_line_writes_its_outcomes_and_refuses_figures_that_it_does_not_have() {
    let scratch = Scratch::new("assert-stream");
    let path = scratch.path("result.xml");
    let limits = ["--assert", "chip<=1.05", "--assert", "time<=10s", "--junit", &path];
    let output = run(&[&["stream", JOB][..], &limits].concat());
    let (code, found) = (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned());
    assert!(code == Some(1) && found.contains("N410: time is 1"), "{found}");
    let held = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(held.contains("--assert chip<=1.05: holds, at most 1.0"), "{held}");
    let xml = std::fs::read_to_string(&path).expect("it is written although a limit is broken");
    let elements = elements(&xml);
    let names: Vec<&str> = elements.iter().map(|element| element.name).collect();
    assert_eq!(names, ["testsuites", "testsuite", "testcase", "testcase", "failure"]);
    assert_eq!(elements[1].attribute("name"), format!("arcfeed stream {JOB}"));
    for port in ["sim:", "linuxcnc:"] {
        let output = run(&["stream", JOB, "--port", port, "--assert", "power<=9kW"]);
        let found = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && found.contains("give this one to `arcfeed simulate`"), "{found}");
    }
}

#[test]
fn a_run_that_ends_in_an_alarm_passes_no_assertion() {
    let scratch = Scratch::new("assert-alarm");
    let text = |path: &str| std::fs::read_to_string(root().join(path)).expect("the example");
    let (job, program) = (text(JOB), text("examples/pocket/pocket.nc"));
    // Without any F the simulated control stops at the first cutting move.
    scratch.write("pocket.nc", program.replace("F500.", "").replace("F3200.", "").replace("F1600.", ""));
    let path = scratch.path("result.xml");
    let (code, words) = asserted(&scratch.write("job.toml", job), &["time<=99s"], &["--junit", &path]);
    println!("{code:?} {words}");
    let xml = std::fs::read_to_string(&path).expect("it is written");
    assert!(code == Some(3) && xml.contains("errors=\"1\"") && xml.contains("the run did not end: "), "{xml}");
}
