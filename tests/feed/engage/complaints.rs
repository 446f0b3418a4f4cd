//! Errors in a map, or of a job without one, name their place and the remedy.

use arcfeed_tests::run;

use crate::engage::cut_job::{Cut, MILL};

const SLOT: Cut<'_> = Cut {
    name: "slot-of-complaints",
    tool: MILL,
    workpiece: "block = { from = [0, -20, -2], to = [60, 20, 0] }",
    rule: "moves = \"lines\"\nside = \"outer\"\nn = [3, 3]",
    program: "%\nG21G17G90G94\nN1G0X-10.Y0.\nN2Z-2.\nN3G1X70.F600.\nN4M30\n%\n",
};

fn said(arguments: &[&str]) -> (Option<i32>, String) {
    let output = run(arguments);
    (output.status.code(), String::from_utf8_lossy(&output.stderr).trim_end().to_owned())
}

#[test]
fn a_map_of_something_else_is_refused() {
    let (scratch, job) = Cut { name: "of-else", ..SLOT }.engaged();
    let good = std::fs::read_to_string(&job).expect("a job");
    for (file, from, to) in [
        ("program.nc", "X70.", "X71."),
        ("job.toml", "diameter = 10", "diameter = 12"),
        ("job.toml", "to = [60, 20, 0]", "to = [61, 20, 0]"),
        ("job.toml", "feed_per_tooth = 0.05", "feed_per_tooth = 0.06"),
    ] {
        scratch.write("program.nc", SLOT.program);
        scratch.write("job.toml", &good);
        let changed = std::fs::read_to_string(scratch.path(file)).expect("a file").replace(from, to);
        scratch.write(file, changed);
        for command in ["adapt", "simulate"] {
            let (code, words) = said(&[command, &job]);
            let expected = "map.toml:3:11: this map is of another program, tool or workpiece than the job's";
            assert!(code == Some(1) && words.contains(expected), "{from}: {words}");
        }
    }
    // A change that does not affect the engagement leaves the map valid.
    scratch.write("program.nc", SLOT.program);
    scratch.write("job.toml", good.replace("rev_per_min = 3000", "rev_per_min = 2000"));
    assert_eq!(said(&["adapt", &job]).0, Some(0));
    scratch.write("job.toml", good);
    std::fs::remove_file(scratch.path("map.toml")).expect("it was there");
    let (code, words) = said(&["adapt", &job]);
    assert!(code == Some(1) && words.contains("map.toml:1:1: there is no such engagement map yet"), "{words}");
}

#[test]
fn a_job_that_makes_no_sense_of_a_map_is_refused_with_its_place() {
    let (scratch, job) = Cut { name: "no-sense", ..SLOT }.engaged();
    let good = std::fs::read_to_string(&job).expect("a job");
    let own = "stock = { map = \"map.toml\" }";
    let slot = "side = \"slot\"";
    for (changes, expected) in [
        (&[(own, "stock = { map = \"map.toml\", disc = [0, 0, 1] }")][..], "job.toml:24:9: give the stock as"),
        (
            &[(
                own,
                "stock = { map = \"map.toml\" }\n[[cut]]\nmoves = \"lines\"\nside = \"outer\"\nstock = { map = \"b.toml\" }",
            )],
            "job.toml:28:17: one map is for all rules of a job: write \"map.toml\"",
        ),
        (&[("engaged-arc", "engagement")], "an end-mill's rule has moves"),
        (&[("side = \"outer\"", slot)], "an end-mill's rule under engaged-arc has moves"),
        (&[("engaged-arc\"", "engaged-arc\"\nedges = \"both\"")], "an end-mill has one circle only"),
    ] {
        let changed = changes.iter().fold(good.clone(), |job, (from, to)| job.replace(from, to));
        let (code, words) = said(&["adapt", &scratch.write("job.toml", changed)]);
        assert!(code == Some(1) && words.contains(expected), "{expected}: {words}");
    }
    for (from, to, expected) in [
        (own, "stock = { disc = [0, 0, 1] }", "no rule asks for an engagement map; write stock = { map"),
        ("[workpiece]\nblock = { from = [0, -20, -2], to = [60, 20, 0] }\nstep = 0.25\n", "", "and there is none"),
    ] {
        assert!(good.contains(from), "{from}");
        let (code, words) = said(&["engage", &scratch.write("job.toml", good.replace(from, to))]);
        assert!(code == Some(1) && words.contains(expected), "{expected}: {words}");
    }
}

#[test]
fn a_program_that_a_control_refuses_leaves_no_map() {
    let (scratch, job) = Cut { name: "refused", ..SLOT }.engaged();
    std::fs::remove_file(scratch.path("map.toml")).expect("it was there");
    scratch.write("program.nc", SLOT.program.replace("N4M30", "N4G2X0.Y0.I1.J1.\nM30"));
    let (code, words) = said(&["engage", &job]);
    assert!(
        code == Some(1) && words.contains("program.nc:6:") && !scratch.files().contains(&"map.toml".to_owned()),
        "{words}"
    );
}

#[test]
fn moves_that_are_not_in_a_map_are_reported() {
    let cut = Cut { name: "unknown", program: &SLOT.program.replace("N4M30", "N4G1Y9.\nN5M30"), ..SLOT };
    let (scratch, job) = cut.engaged();
    assert_eq!(said(&["adapt", &job]), (Some(0), String::new()));
    // A rule that speaks of more than it did when the map was made.
    let more = std::fs::read_to_string(&job).expect("a job").replace("n = [3, 3]", "n = [3, 4]");
    let (code, words) = said(&["adapt", &scratch.write("job.toml", more)]);
    let place = "program.nc:6:1: warning: ";
    assert!(
        code == Some(0) && words.contains(place) && words.contains("knows nothing of 1 move from here on"),
        "{words}"
    );
}
