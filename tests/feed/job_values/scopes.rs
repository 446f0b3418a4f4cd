//! Cut rules that name lines of the program's file, or a plane.

use std::collections::BTreeSet;
use std::path::Path;

use arcfeed::adapt::{Known, PlanReason, adapt_with};
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_tests::{Scratch, run};
use fastrand::Rng;
use serde_json::Value;

/// A tool of 10 mm that may be fed by a table in any plane, and by the contour law in its own.
fn job(law: &str, mode: &str, rules: &str) -> String {
    format!(
        "units = \"mm\"\nprogram = \"p.nc\"\n[tool]\nkind = \"end-mill\"\nnumber = 1\ndiameter = 10\nteeth = 4\n[spindle]\n\
         rev_per_min = 2000\n[limits]\nmax_feed = 2000\n[law]\nkind = \"{law}\"\nfeed_per_tooth = 0.05\n[override]\nmode = \"{mode}\"\n\
         {rules}"
    )
}

/// Arcs of 12 mm in G17 in lines 5 to 9, a lead-in in G18 in line 10.
const PROGRAM: &str = "%\nO1\nG21G90G17G94T1M6\nS2000M3G0X12.Y0Z0F400.\nG3X-12.Y0I-12.\nG3X12.Y0I12.\nG0X30.\nG3X6.Y0I-12.\n\
                       G3X30.Y0I12.\nG18G3X6.Z0I-12.K0\nG17\nM30\n%\n";

fn arcs(rest: &str) -> String {
    format!("[[cut]]\nmoves = \"arcs\"\ndirection = \"ccw\"\nside = \"inside\"\n{rest}\n")
}

/// Lines that the law governs, as `adapt` says.
fn governed(name: &str, job: &str, program: &str) -> BTreeSet<u64> {
    let scratch = Scratch::new(name);
    scratch.write("p.nc", program);
    let output = run(&["adapt", "--json", &scratch.write("job.toml", job)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let blocks = String::from_utf8(output.stdout).expect("text");
    let blocks = blocks.lines().map(|line| serde_json::from_str::<Value>(line).expect("an object"));
    let is_governed = |block: &Value| block["reason"].as_str().is_some_and(|reason| reason.starts_with("law"));
    blocks.filter(is_governed).map(|block| block["line"].as_u64().expect("a line")).collect()
}

#[test]
fn a_rule_governs_only_its_lines_of_the_file() {
    for mode in ["safe-base", "rewrite-only"] {
        let of = |rest: &str| governed("scope-lines", &job("contour", mode, &arcs(rest)), PROGRAM);
        assert_eq!(of(""), BTreeSet::from([5, 6, 8, 9]), "{mode}");
        assert_eq!(of("lines = \"6-8\""), BTreeSet::from([6, 8]), "{mode}");
        assert_eq!(of("lines = \"9\""), BTreeSet::from([9]), "{mode}");
        assert_eq!(of("lines = \"1-4\""), BTreeSet::new(), "{mode}");
    }
}

#[test]
fn the_first_rule_whose_scope_admits_a_move_governs_it() {
    let rules = arcs("feed_per_tooth = 0.02\nlines = \"5-6\"") + &arcs("feed_per_tooth = 0.04");
    let scratch = Scratch::new("scope-order");
    scratch.write("p.nc", PROGRAM);
    let path = scratch.write("job.toml", job("contour", "rewrite-only", &rules));
    let output = run(&["adapt", &path, "-o", &scratch.path("out.nc")]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // Tool radius 5, path radius 12: the path has 12 / 17 of the feed at the contour, 8000 teeth a minute.
    let text = std::fs::read_to_string(scratch.path("out.nc")).expect("the output");
    let feeds: Vec<f64> = text
        .lines()
        .filter(|line| line.starts_with("G3"))
        .filter_map(|line| line.split_once('F').map(|(_, feed)| feed.parse().expect("a number")))
        .collect();
    let expected = [0.02, 0.04].map(|per_tooth| per_tooth * 8_000.0 * 12.0 / 17.0);
    let is_near = |found: f64, wanted: f64| (wanted - 1.0..=wanted).contains(&found);
    assert!(
        matches!(feeds[..], [a, b] if is_near(a, expected[0]) && is_near(b, expected[1])),
        "{feeds:?} {expected:?}"
    );
}

#[test]
fn a_rule_governs_only_arcs_of_its_plane_and_a_side_law_only_those_across_the_tools_axis() {
    let table = |rest: &str| {
        let rule = arcs(&format!("{rest}\ntable = [[0, 0.04], [100, 0.04]]")).replace("inside", "slot");
        governed("scope-plane", &job("table", "safe-base", &rule), PROGRAM)
    };
    assert_eq!(table("plane = \"G17\""), BTreeSet::from([5, 6, 8, 9]));
    assert_eq!(table("plane = \"G18\""), BTreeSet::from([10]));
    assert_eq!(table("plane = \"G19\""), BTreeSet::new());
    assert_eq!(table(""), BTreeSet::from([5, 6, 8, 9, 10]));
    let side = |rest: &str| governed("scope-plane", &job("contour", "safe-base", &arcs(rest)), PROGRAM);
    assert_eq!(side(""), BTreeSet::from([5, 6, 8, 9]));
    assert_eq!(side("plane = \"G18\""), BTreeSet::new());
}

#[test]
fn a_subprogram_has_the_lines_at_which_it_stands_in_the_file() {
    let called = "%\nO1\nG21G90G17G94T1M6\nS2000M3G0X12.Y0Z0F400.\nM98P2\nM98P2\nM30\nO2\nG3X-12.Y0I-12.\nG3X12.Y0I12.\nM99\n%\n";
    let of = |lines: &str| governed("scope-called", &job("contour", "safe-base", &arcs(lines)), called);
    assert_eq!(of("lines = \"9\"").len(), 1);
    assert_eq!(of("lines = \"5-6\""), BTreeSet::new());
}

/// Arcs that the simulated machine executed under each rule, and the highest chip load there before and after.
fn metered(command: &[&str], mode: &str, rules: &str) -> Vec<(u64, [f64; 2])> {
    let scratch = Scratch::new(&format!("scope-{}", command.join("-")));
    scratch.write("p.nc", PROGRAM);
    let path = scratch.write("job.toml", job("contour", mode, rules));
    let output = run(&[command, &["--json", &path]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("an object");
    let movements = report["movements"].as_array().expect("one for each rule");
    let most = |movement: &Value, key: &str| movement[key]["max"].as_f64().unwrap_or_default();
    let chips = |movement: &Value| ["baseline_chip_load", "chip_load"].map(|key| most(movement, key));
    movements.iter().map(|movement| (movement["arcs"].as_u64().expect("a count"), chips(movement))).collect()
}

#[test]
fn the_simulated_machine_meters_each_arc_under_the_rule_that_governs_it() {
    let rules = arcs("feed_per_tooth = 0.02\nlines = \"6\"") + &arcs("feed_per_tooth = 0.04\nlines = \"8-9\"");
    // F400 at 8000 teeth a minute is 0.05 mm, and 17 / 12 of that at the contour.
    let programmed = 0.05 * 17.0 / 12.0;
    let (simulate, stream) = (["simulate"], ["stream", "--port", "sim:"]);
    let with_board = ["stream", "--port", "sim:", "--board", "sim:"];
    for (command, mode) in [
        (&simulate[..], "safe-base"),
        (&simulate, "override-only"),
        (&simulate, "rewrite-only"),
        (&stream, "safe-base"),
        (&with_board, "safe-base"),
        (&with_board, "override-only"),
    ] {
        let found = metered(command, mode, &rules);
        println!("{command:?} {mode}: {found:?}");
        let [(1, first), (2, second)] = found[..] else { panic!("{mode}: {found:?}") };
        for ([before, after], target) in [(first, 0.02), (second, 0.04)] {
            assert!((before / programmed - 1.0).abs() < 2e-3, "{mode}: {before}");
            assert!((target * 0.97..=target * 1.002).contains(&after), "{mode}: {after}");
        }
    }
}

#[test]
fn who_knows_only_blocks_refuses_scopes_by_their_key() {
    let scratch = Scratch::new("scope-refused");
    scratch.write("p.nc", PROGRAM);
    for (rest, key) in [("lines = \"6-8\"", "`lines`"), ("plane = \"G17\"", "`plane`")] {
        let path = scratch.write("job.toml", job("contour", "safe-base", &arcs(rest)));
        for command in [&["parameters", path.as_str(), "-o", &scratch.path("page.bin")][..], &["serve", "--pty", &path]]
        {
            let output = run(command);
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(1), "{said}");
            assert!(said.contains("job.toml:17:1: error: ") && said.contains(key), "{said}");
        }
    }
}

#[test]
fn a_scope_that_makes_no_sense_is_refused_at_its_place() {
    let lines = "[[cut]]\nmoves = \"lines\"\nside = \"slot\"\nplane = \"G17\"\n".to_owned();
    for (rules, place) in [
        (arcs("lines = \"40-10\""), "21:9"),
        (arcs("lines = \"0-10\""), "21:9"),
        (arcs("lines = \"ten\""), "21:9"),
        (arcs("lines = 10"), "21:9"),
        (arcs("plane = \"G20\""), "21:9"),
        (lines, "20:9"),
    ] {
        let scratch = Scratch::new("scope-senseless");
        scratch.write("p.nc", PROGRAM);
        let output = run(&["adapt", &scratch.write("job.toml", job("contour", "safe-base", &rules))]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(1) && said.contains(&format!("job.toml:{place}: ")), "{rules}: {said}");
    }
}

/// Arcs and lines of random radius, sense and plane, each in a line of its own.
fn random_program(rng: &mut Rng) -> String {
    let mut text = String::from("%\nO1\nG21G90G17G94T1M6\nS2000M3G0X0Y0Z0F400.\n");
    for _ in 0..rng.usize(5..30) {
        let radius = 6.0 + 34.0 * rng.f64();
        let turn = if rng.bool() { "G2" } else { "G3" };
        text += &match rng.u8(0..4) {
            0 => format!("G91G1X{radius:.3}G90\n"),
            1 => format!("G18{turn}I-{radius:.3}K0\n"),
            2 => format!("G17{turn}I-{radius:.3}J0F{}.\n", rng.u32(100..900)),
            _ => format!("G17{turn}I-{radius:.3}J0\n"),
        };
    }
    text + "M30\n%\n"
}

#[test]
fn a_scope_changes_no_move_within_it_and_leaves_the_programmed_feed_outside() {
    let (mut rng, mut counts) = (Rng::with_seed(23), [0, 0]);
    for number in 0..400 {
        let program = random_program(&mut rng);
        let count = program.lines().count();
        let first = rng.usize(1..count);
        let last = rng.usize(first..=count);
        let mode = ["safe-base", "override-only", "rewrite-only"][number % 3];
        let planned = |scope: &str| {
            let both = arcs(scope) + &arcs(scope).replace("ccw", "cw");
            let file = JobFile::parse(Path::new("job.toml"), &job("contour", mode, &both)).expect("a job");
            let program = Program::parse_with(Path::new("p.nc"), program.as_bytes(), file.nc, file.tables);
            adapt_with(&program, &file.job, Known::of(&file)).blocks
        };
        let (free, scoped) = (planned(""), planned(&format!("lines = \"{first}-{last}\"")));
        assert_eq!(free.len(), scoped.len());
        for (free, scoped) in free.iter().zip(&scoped) {
            if (first..=last).contains(&scoped.line) {
                let leaks = scoped.reason == PlanReason::FeedLeak;
                assert!(leaks || (free.sent, free.reason) == (scoped.sent, scoped.reason), "{program}{first}-{last}");
                counts[0] += 1;
            } else {
                assert_eq!((scoped.sent, scoped.rule), (scoped.programmed(), None), "{program}{first}-{last}");
                counts[1] += 1;
            }
        }
    }
    println!("{} moves within a scope, {} outside", counts[0], counts[1]);
    assert!(counts[0].min(counts[1]) > 2_000);
}
