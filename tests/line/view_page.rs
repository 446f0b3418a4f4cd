//! `arcfeed view` without a browser: its requests, and the folder that is gone at the end.
#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

use arcfeed_tests::{Scratch, arcfeed, root, run, wait_for};
use serde_json::{Value, json};

use crate::live_page::Page;

const CONTOUR: &str = "examples/pocket/job-contour.toml";
const PROGRAM: &str = "examples/pocket/pocket.nc";

/// Page with a folder of its own for temporary files.
struct View {
    child: Child,
    page: Page,
}

impl View {
    fn start(scratch: &Scratch, arguments: &[&str]) -> Self {
        let folder = scratch.path("tmp");
        std::fs::create_dir_all(&folder).expect("a folder");
        let mut child = Command::new(arcfeed())
            .arg("view")
            .args(arguments)
            .env("TMPDIR", folder)
            .current_dir(root())
            .stdout(Stdio::piped())
            .spawn()
            .expect("arcfeed starts");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("piped")).read_line(&mut line).expect("a line");
        let page = Page::at(line.trim_end().strip_prefix("page: ").expect("the address"));
        View { child, page }
    }

    /// State that follows a POST.
    fn post(&self, path: &str, body: &str) -> Value {
        let (status, answer) = self.page.post(path, body, "");
        assert_eq!(status, 200, "{path}: {answer}");
        serde_json::from_str(&answer).expect("JSON")
    }

    fn get(&self, path: &str) -> (u16, String) {
        self.page.get(&format!("{}{path}", self.page.path), "")
    }

    /// Ends by Ctrl-C; nothing stays.
    fn end(mut self, scratch: &Scratch) {
        let left = || std::fs::read_dir(scratch.path("tmp")).expect("a folder").count();
        assert_eq!(left(), 1);
        let sent = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status();
        assert!(sent.expect("kill runs").success());
        let status = wait_for("the end of arcfeed", || self.child.try_wait().expect("a child can be waited for"));
        assert_eq!((status.code(), left()), (Some(0), 0));
    }
}

impl Drop for View {
    fn drop(&mut self) {
        let _already_over = self.child.kill();
        let _reaped = self.child.wait();
    }
}

#[test]
fn a_program_and_its_job_come_back_as_the_command_line_writes_them() {
    let scratch = Scratch::new("view");
    let view = View::start(&scratch, &[]);
    assert_eq!(serde_json::from_str::<Value>(&view.get("state").1).expect("JSON")["program"], Value::Null);
    assert_eq!([view.get("adapted").0, view.get("job").0, view.get("report").0], [404; 3]);
    let program = std::fs::read_to_string(root().join(PROGRAM)).expect("the example");
    let state = view.post("program?../pocket.nc", &program);
    assert_eq!((&state["program"], &state["has_report"]), (&json!("pocket.nc"), &json!(false)), "{state}");
    let values = json!({ "tool": "10", "teeth": "4", "feed_per_tooth": "0.1" });
    let state = view.post("init", &values.to_string());
    assert_eq!(state["questions"], json!([]), "{state}");
    let job = state["job"].as_str().expect("a job").to_owned();
    let state = view.post("run", &job);
    assert_eq!(state["has_report"], true, "{state}");
    let local = scratch.path("pocket.nc");
    std::fs::write(&local, &program).expect("the program");
    let [own_job, own] = ["own.toml", "own.nc"].map(|name| scratch.path(name));
    let init = ["init", &local, "--output", &own_job, "--tool=10", "--teeth=4", "--feed-per-tooth=0.1"];
    assert!(run(&init).status.success() && run(&["adapt", &own_job, "--output", &own]).status.success());
    let text = |path: &str| std::fs::read_to_string(path).expect("text");
    assert_eq!((view.get("adapted"), view.get("job")), ((200, text(&own)), (200, text(&own_job))));
    assert!(view.get("report").1.contains("arcfeed-data"));
    // A job that is refused is explained, a faulty one as on the terminal, and the old result is gone.
    for (found, in_its_place, explained) in
        [("\"pocket.nc\"", "\"/etc/hostname\"", "outside of this page"), ("units", "unit", "unit")]
    {
        assert_eq!(view.post("run", &job)["has_report"], true);
        let state = view.post("run", &job.replace(found, in_its_place));
        assert!(state["messages"].as_str().is_some_and(|words| words.contains(explained)), "{state}");
        assert_eq!((&state["has_report"], view.get("adapted").0), (&json!(false), 404), "{in_its_place}");
    }
    assert_eq!(view.page.post("init", "{\"tool\": 1}", "").0, 400);
    assert_eq!(view.page.post("init", "{}", "Origin: http://arcfeed.example\r\n").0, 403);
    view.end(&scratch);
}

#[test]
fn a_job_of_the_command_line_opens_on_its_report_and_is_not_changed() {
    let scratch = Scratch::new("view-job");
    let before = std::fs::read(root().join(CONTOUR)).expect("the example");
    let view = View::start(&scratch, &[CONTOUR]);
    let state = view.post("run", "program = \"other.nc\"");
    assert_eq!((&state["has_report"], &state["is_fixed"]), (&json!(true), &json!(true)), "{state}");
    let own = scratch.path("own.nc");
    assert!(run(&["adapt", CONTOUR, "--output", &own]).status.success());
    assert_eq!(view.get("adapted"), (200, std::fs::read_to_string(own).expect("text")));
    assert_eq!(std::fs::read(root().join(CONTOUR)).expect("the example"), before);
    view.end(&scratch);
    let output = run(&["view", "examples/no-such.toml"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A pocket's circle by T3, whose comment says D 10.
const COMMENTED: &str = "%\nO1\n(T3 D=10. CR=0. - FLAT END MILL)\nG21G17G90G94\nT3M6\nS3000M3\nG0X0.Y0.Z5.\nG1Z-2.F300.\n\
    G1X10.F600.\nG3I-10.\nG0Z5.\nM30\n%\n";

#[test]
fn a_value_that_cannot_be_used_leaves_job_and_result_and_is_refused_at_its_field() {
    let scratch = Scratch::new("view-refused");
    let view = View::start(&scratch, &[]);
    let state = view.post("program?one.nc", COMMENTED);
    let tool = &state["found"]["proposed"][0];
    assert_eq!([&tool["number"], &tool["diameter"], &tool["comment_line"]], [&json!(3), &json!(10.0), &json!(3)]);
    assert_eq!(state["found"]["extents"][0], json!([-10.0, 10.0]), "{state}");
    let job = state["job"].as_str().expect("a job").to_owned();
    assert_eq!(view.post("run", &job)["has_report"], true);
    for (field, value) in [("tool", "-10"), ("tool", "10,5"), ("teeth", "2.5"), ("spindle", "fast"), ("max", "-20")] {
        let state = view.post("init", &json!({ field: value }).to_string());
        let [problem] = state["problems"].as_array().expect("a list").as_slice() else { panic!("{state}") };
        let words = problem["text"].as_str().expect("words");
        assert!(problem["field"] == field && words.starts_with(value) && !words.contains("--"), "{problem}");
        assert_eq!(words.contains("comma"), value.contains(','), "{words}");
        assert_eq!((&state["job"], &state["has_report"]), (&json!(job), &json!(true)));
    }
    // What contradicts the program is warned of, and done.
    let state = view.post("init", &json!({ "tool": "500" }).to_string());
    let words = state["messages"].as_str().expect("words");
    assert_eq!(words, "warning: T3: diameter 500.0 mm, but the comment in line 3 says 10.0 mm: check it\n");
    assert!(state["problems"] == json!([]) && state["job"].as_str().expect("a job").contains("diameter = 500.0"));
    let bare = COMMENTED.replace("(T3 D=10. CR=0. - FLAT END MILL)\n", "");
    view.post("program?bare.nc", &bare);
    let warned = |diameter: &str| view.post("init", &json!({ "tool": diameter }).to_string())["messages"].clone();
    assert_eq!((warned("19.9"), warned("10")), (json!(""), json!("")));
    assert_eq!(
        warned("21"),
        "warning: T3: diameter 21.0 mm, but its centre moves within X 20.0 mm and Y 20.0 mm only: check it\n"
    );
    view.end(&scratch);
}

#[test]
fn a_file_that_is_no_program_is_refused_at_once() {
    let scratch = Scratch::new("view-no-program");
    let view = View::start(&scratch, &[]);
    for (name, text, words) in [
        ("empty.nc", "", "empty.nc: the file is empty: choose another file"),
        ("marks.nc", "%\r\n\r\n%\r\n", "marks.nc: the file is empty: choose another file"),
        ("list.txt", "two apples\nbread\nmilk, 1 l\n", "list.txt: this is no NC program: choose another file"),
        ("picture.nc", "\u{1}PNG\u{2}\n\u{0}\u{0}IHDR\n", "picture.nc: this is no NC program: choose another file"),
    ] {
        let state = view.post(&format!("program?{name}"), text);
        assert_eq!((&state["messages"], &state["job"], &state["program"]), (&json!(words), &Value::Null, &Value::Null));
    }
    assert_eq!(view.post("program?one.nc", COMMENTED)["program"], "one.nc");
    view.end(&scratch);
}

#[test]
fn a_job_without_its_program_says_that_it_wants_it_beside_itself() {
    let scratch = Scratch::new("view-alone");
    let job = scratch.path("one.toml");
    let program = scratch.write("one.nc", COMMENTED);
    assert!(run(&["init", &program, "--output", &job]).status.success());
    std::fs::remove_file(&program).expect("the program");
    let output = run(&["adapt", &job]);
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(1) && words.contains("names it as its program: keep both in one folder"),
        "{words}"
    );
}
