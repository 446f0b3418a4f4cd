//! Numbers, ranges and keys that make no sense, in every place.

use std::path::Path;

use arcfeed_tests::{Scratch, root, run};

use crate::job_values::files::{Item, JOBS, files, items, line, names, refusal, replaced};

/// Refused wherever a number stands.
const SENSELESS: [&str; 8] = ["nan", "inf", "-inf", "1e300", "-1e300", "\"nan mm\"", "\"inf in\"", "\"1e300 mm\""];

#[test]
fn numbers_that_make_no_sense_are_refused_in_every_key_of_every_file() {
    let mut tried = 0;
    for (path, text) in files() {
        for Item { key, span, .. } in items(&text).iter().filter(|item| item.is_number) {
            for senseless in SENSELESS {
                let wanted = format!("{}:", line(&text, span.start));
                let complaint = refusal(&path, &replaced(&text, span, senseless));
                let complaint = complaint.unwrap_or_else(|| panic!("{path:?}: {key} = {senseless} is taken"));
                let is_placed = complaint.starts_with(&wanted) && names(&complaint, key);
                assert!(is_placed, "{path:?}: {key} = {senseless}, line {wanted} {complaint}");
                tried += 1;
            }
        }
    }
    println!("{tried} senseless values refused");
    assert!(tried > 2_000, "{tried}");
}

#[test]
fn a_zero_is_taken_or_refused_by_its_key() {
    let (mut taken, mut refused) = (Vec::new(), Vec::new());
    for (path, text) in files() {
        for Item { key, span, .. } in items(&text).iter().filter(|item| item.is_number) {
            match refusal(&path, &replaced(&text, span, "0")) {
                None => taken.push(key.clone()),
                Some(complaint) => {
                    assert!(names(&complaint, key), "{path:?}: {key} = 0: {complaint}");
                    refused.push(key.clone());
                }
            }
        }
    }
    for key in [
        "cutting.kc11",
        "cutting.modes.1.frequency",
        "cutting.pitch.3",
        "tool.active_teeth",
        "tool.outer_radius",
        "spindle.rev_per_min",
        "law.feed_per_tooth",
        "serial.baudrate",
    ] {
        assert!(refused.iter().any(|found| found == key) && !taken.iter().any(|found| found == key), "{key}");
    }
    taken.sort();
    taken.dedup();
    println!("{} refused; taken: {taken:?}", refused.len());
}

#[test]
fn unknown_keys_are_refused_in_every_table() {
    let mut tried = 0;
    for (path, text) in files() {
        for Item { key, name, .. } in items(&text) {
            let Some(name) = name else { continue };
            let unknown = format!("{}_x", &text[name.clone()]);
            let complaint = refusal(&path, &replaced(&text, &name, &unknown));
            let complaint = complaint.unwrap_or_else(|| panic!("{path:?}: {unknown} for {key} is taken"));
            let is_placed = complaint.starts_with(&format!("{}:", line(&text, name.start)));
            let is_named = complaint.contains(&format!("unknown field `{unknown}`"));
            // The header of one axis or tool of several: the others still make the table, and that one is missing in it.
            let is_of_several =
                ["rotary", "linear", "workpiece"].contains(&key.as_str()) || key == "tool" && text.contains("[[tool]]");
            assert!(is_placed && is_named || is_of_several, "{path:?}: {key}: {complaint}");
            tried += 1;
        }
    }
    assert!(tried > 300, "{tried}");
}

#[test]
fn reversed_ranges_are_refused_at_their_key() {
    let mut tried = 0;
    for (path, text) in files() {
        for Item { key, span, .. } in items(&text) {
            let is_range = ["n", "z", "range"].contains(&key.rsplit('.').next().expect("a name"));
            let found = &text[span.clone()];
            let [from, to] = found.trim_matches(['[', ']']).split(", ").collect::<Vec<_>>()[..] else { continue };
            if !is_range || from == to {
                continue;
            }
            let complaint = refusal(&path, &replaced(&text, &span, &format!("[{to}, {from}]")));
            let complaint = complaint.unwrap_or_else(|| panic!("{path:?}: {key} is taken"));
            assert!(names(&complaint, &key), "{path:?}: {key}: {complaint}");
            tried += 1;
        }
    }
    assert!(tried > 15, "{tried}");
    for (from, to, key) in [
        ("to = [0, 0, -1]", "to = [0, 0, -40]", "workpiece.round"),
        ("min = 10, max = 200", "min = 200, max = 10", "override.min"),
        ("floor = 100", "floor = 5001", "control.arc_clamp.floor"),
        ("to = [5, 4, 0]", "to = [5, -4, 0]", "workpiece.flexible.block"),
    ] {
        let job = JOBS.iter().find(|job| job.contains(from)).expect("one of the jobs");
        let complaint = refusal(Path::new("job.toml"), &job.replace(from, to));
        assert!(complaint.as_ref().is_some_and(|complaint| names(complaint, key)), "{to}: {complaint:?}");
    }
}

#[test]
fn check_says_what_is_wrong_and_exits_with_1() {
    let text = std::fs::read_to_string(root().join("examples/pocket/job-contour.toml")).expect("the example's job");
    let program = root().join("examples/pocket/pocket.nc");
    let text = text.replace("\"pocket.nc\"", &format!("{:?}", program.display().to_string()));
    let scratch = Scratch::new("job-values");
    let bad = run(&["check", &scratch.write("bad.toml", text.replace("max_feed = 6000", "max_feed = nan"))]);
    let said = String::from_utf8_lossy(&bad.stderr);
    assert_eq!(bad.status.code(), Some(1));
    assert!(said.contains("bad.toml:16:12: ") && said.contains("`limits.max_feed = nan`"), "{said}");
    let rule = "\n[[cut]]\nmoves = \"arcs\"\ndirection = \"cw\"\nside = \"slot\"\n";
    let unused = run(&["check", &scratch.write("unused.toml", text + rule)]);
    let said = String::from_utf8_lossy(&unused.stderr);
    assert!(unused.status.success() && said.contains("warning: this rule is never used"), "{said}");
}
