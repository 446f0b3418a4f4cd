//! What the plunge law refuses, and which moves it leaves alone.

use arcfeed_tests::run;

use crate::plunge_law::plunge_job::PlungeJob;

const JOB: PlungeJob<'_> = PlungeJob {
    name: "complaints",
    tool: "kind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 8",
    workpiece: "block = { from = [-8, -8, -9], to = [40, 8, 0] }\nstep = 0.5",
    cutting: "kc11 = 1000\nmc = 0.2\nradial = 0.3\naxial = 0.2\naxial_depth = 2",
    spindle: "rev_per_min = 1000\nmax_torque = \"5 Nm\"",
    mode: "mode = \"safe-base\"",
    feed_per_tooth_mm: 0.05,
    max_raise: 2.0,
    program: "%\nG21G17G90G94\nS1000M3\nN1G0X0.Y0.Z3.\nN2G1Z-4.F100.\nN3G0Z3.\nN4X12.\nN5G93G1Z-4.F20.\nN6G94G0Z3.\n\
              N7X24.\nN8/G1Z-2.F80.\nN9G0Z3.\nN10M30\n%\n",
};

/// Exit code and what `adapt` says of the job with a change.
fn said(from: &str, to: &str) -> (Option<i32>, String) {
    let (scratch, job) = JOB.written();
    let text = std::fs::read_to_string(&job).expect("a job");
    assert!(text.contains(from), "{from}");
    scratch.write("job.toml", text.replace(from, to));
    let output = run(&["adapt", &job]);
    (output.status.code(), String::from_utf8_lossy(&output.stderr).replace(&job, "job.toml"))
}

#[test]
fn missing_keys_of_the_plunge_law_are_named_with_their_place() {
    for (from, to, expected) in [
        ("max_torque = \"5 Nm\"", "", "[plunge] needs max_power or max_torque in [spindle]"),
        ("max_feed = 3000\n", "", "[plunge] needs a fastest feed"),
        ("mode = \"safe-base\"", "mode = \"override-only\"", "[plunge] sends the least feed of each move as F"),
        ("height = 8", "height = 8\naxis = \"y\"", "[plunge] is for a tool along Z"),
        ("[plunge]\nmap = \"map.toml\"\nramps = true\n", "", "this law needs a table [plunge]"),
        ("ramps = true", "ramp = true", "unknown field `ramp`"),
        ("ramps = true", "feed_per_tooth = -1", "feed_per_tooth must be a positive length"),
        ("ramps = true", "", "there is no such engagement map yet; make it with `arcfeed engage`"),
    ] {
        let (code, said) = said(from, to);
        assert!(code == Some(1) && said.contains(expected) && said.contains(".toml:"), "{code:?} {said}");
    }
}

#[test]
fn descents_that_keep_their_feed_are_named() {
    let (_scratch, job) = PlungeJob { name: "kept-feeds", ..JOB }.written();
    assert!(run(&["engage", &job]).status.success());
    let output = run(&["adapt", &job]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.contains("program.nc:8:") && said.contains("inverse time"), "{said}");
    assert!(said.contains("program.nc:11:") && said.contains("block-delete"), "{said}");
}

#[test]
fn torque_limit_below_the_edge_force_keeps_the_feed_with_a_reason() {
    let job = PlungeJob {
        name: "overload",
        cutting: "cutting = [1000, 0, 0]\nedge = [60, 0, 0]\naxial_depth = 2",
        spindle: "rev_per_min = 1000\nmax_torque = \"1 Nm\"",
        ..JOB
    };
    let (_scratch, path) = job.written();
    assert!(run(&["engage", &path]).status.success());
    let output = run(&["adapt", &path, "--json"]);
    let (text, said) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(
        text.lines().any(|line| line.contains("\"reason\":\"overload\"") && line.contains("\"sent_feed\":100.0")),
        "{text}"
    );
    assert!(said.contains("no feed of it keeps max_power and max_torque"), "{said}");
}
