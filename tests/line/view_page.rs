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
    // A faulty job is explained as on the terminal, and the old result is gone.
    let state = view.post("run", &job.replace("units", "unit"));
    assert!(state["messages"].as_str().is_some_and(|words| words.contains("unit")), "{state}");
    assert_eq!((&state["has_report"], view.get("adapted").0), (&json!(false), 404));
    let state = view.post("run", &job.replace("\"pocket.nc\"", "\"/etc/hostname\""));
    assert!(state["messages"].as_str().is_some_and(|words| words.contains("outside of this page")), "{state}");
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
