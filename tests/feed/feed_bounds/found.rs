//! Cases that an external review found.

use arcfeed::adapt::{Adapted, adapt};
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_tests::{Scratch, run, shared_or_skip};

const MILL: &str = "units = \"mm\"\nprogram = \"program.nc\"\n[tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nnumber = 1\n\
                    [spindle]\nrev_per_min = 8000\n[limits]\nmax_feed = 6000\n";

/// A job for the end mill, and the program as it is adapted.
fn adapted(name: &str, mode: &str, law: &str, rules: &str, program: &str) -> (String, Adapted) {
    let scratch = Scratch::new(&format!("found-{name}"));
    let text = format!("%\nG21G17G90G94\nT1M6\n{program}M30\n%\n");
    scratch.write("program.nc", &text);
    scratch.write("on.toml", "delete = [1]\n");
    let job = format!("{MILL}[law]\nkind = \"{law}\"\nfeed_per_tooth = 0.05\n[override]\nmode = \"{mode}\"\n{rules}");
    let file = JobFile::load(scratch.write("job.toml", job).as_ref()).unwrap_or_else(|error| panic!("{error:?}"));
    let program = Program::parse_with(&file.program, text.as_bytes(), file.nc, file.tables);
    assert!(!program.has_errors(), "{:?}", program.diagnostics);
    let adapted = adapt(&program, &file.job);
    (text, adapted)
}

fn rule(moves: &str, side: &str) -> String {
    format!("[[cut]]\nmoves = {moves}\nside = \"{side}\"\nradial_depth = 0.5\n")
}

/// No mode changes this program.
fn assert_kept(name: &str, law: &str, rules: &str, program: &str) {
    for mode in ["safe-base", "override-only", "rewrite-only"] {
        let (text, adapted) = adapted(&format!("{name}-{mode}"), mode, law, rules, program);
        assert_eq!(String::from_utf8_lossy(&adapted.text), text, "{mode}");
        assert!(adapted.blocks.iter().all(|block| block.demand.is_none()), "{mode}");
    }
}

/// The feed of each governed block, as sent, mm/min.
fn sent(adapted: &Adapted) -> Vec<f64> {
    let governed = adapted.blocks.iter().filter(|block| block.demand.is_some());
    governed.map(|block| block.sent.expect("a feed").to_mm()).collect()
}

#[test]
fn plunges_and_ramps_keep_their_feed() {
    let program = "S8000M3\nG0X0.Y0.Z5.\nG1Z-5.F100.\nG1X10.Z-6.\nG1X20.Y5.Z-8.\n";
    assert_kept("plunges", "engagement", &rule("\"lines\"", "inside"), program);
}

#[test]
fn helical_entries_keep_their_feed() {
    let program = "S8000M3\nG0X8.Y0.Z1.\nG3I-8.Z-2.F80.\nG3I-8.Z-5.\n";
    assert_kept("helices", "engagement", &rule("\"arcs\"\ndirection = \"ccw\"", "inside"), program);
}

#[test]
fn roll_ins_out_of_the_plane_keep_their_feed() {
    let program = "S8000M3\nG0X20.Y0.Z0.\nG18G3X0.Z20.K20.F300.\n";
    assert_kept("roll-ins", "contour", &rule("\"arcs\"\ndirection = \"ccw\"", "inside"), program);
}

#[test]
fn an_outside_arc_as_small_as_the_tool_stays_below_both_bounds() {
    let rules = format!("{}\n", rule("\"arcs\"\ndirection = \"cw\"", "outside"));
    // The contour's radius is a millionth of a millimetre: the law alone asks for 8e7 mm/min.
    let program = "S8000M3\nG0X5.000001Y0.Z-1.\nG2X0.Y-5.000001I-5.000001J0.F900.\n";
    let law = "contour\"\ninside_only = false\n#\"";
    let (_, adapted) = adapted("outside", "safe-base", law, &rules, program);
    // max_raise is 2.
    assert_eq!(sent(&adapted), [1_800.0]);
}

#[test]
fn no_other_tool_and_no_unknown_speed_is_governed() {
    let cut = "G0X0.Y0.Z-1.\nG1X30.F900.\n";
    let rules = rule("\"lines\"", "inside");
    for (name, before) in [
        ("tool", "T2M6\nS8000M3\n"),
        ("unstated", ""),
        ("zero", "S0M3\n"),
        ("off", "S8000M3\nM5\n"),
        ("skipped", "/S8000\nM3\n"),
    ] {
        assert_kept(name, "engagement", &rules, &format!("{before}{cut}"));
    }
    // Another speed than the job's is the program's: half of it, half the feed.
    let feed = |speed: u32| {
        let (_, adapted) =
            adapted(&format!("speed-{speed}"), "safe-base", "engagement", &rules, &format!("S{speed}M3\n{cut}"));
        sent(&adapted)[0]
    };
    assert!((feed(2_000) - 2.0 * feed(1_000)).abs() < 1.0);
}

#[test]
fn a_deleted_f_leaves_no_governed_feed_behind() {
    let program = "S8000M3\nG0X0.Y0.Z-1.\nG1X30.F900.\nG1Z-2./F300.\nG1X0.F700.\nG1Z5.\n";
    assert_kept("deleted", "engagement", &rule("\"lines\"", "inside"), program);
}

/// Each of them runs a block at another feed, in another unit or in another mode where a switch stands the other way.
#[test]
fn no_governed_feed_is_in_force_where_a_switch_decides() {
    let begin = "S8000M3\nG0X0.Y0.Z-1.\nG1X10.F300.\n";
    for (name, rest) in [
        ("plunge", "/Z-4.\nX40.F300.\n"),
        ("unit", "/G20\nZ-1.2\nG21X20.F300.\n"),
        ("revolution", "/G95F.1\nZ-4.\nG94X20.F300.\n"),
        ("motion", "G0Z5.\n/G1\nZ-4.\nX20.F300.\n"),
        ("two-switches", "/2Y18.\n/Z-5.\nX40.F300.\n"),
    ] {
        for settings in ["", "[control]\nsettings = \"on.toml\"\n"] {
            let rules = rule("\"lines\"", "inside") + settings;
            let (text, adapted) =
                adapted(&format!("switch-{name}"), "safe-base", "engagement", &rules, &format!("{begin}{rest}"));
            assert_eq!(String::from_utf8_lossy(&adapted.text), text, "{name} {settings}");
        }
    }
    // A coolant that a switch keeps off decides on no feed.
    let (_, adapted) =
        adapted("coolant", "safe-base", "engagement", &rule("\"lines\"", "inside"), &format!("{begin}/M8\nX20.\n"));
    assert_eq!(sent(&adapted), [600.0; 2]);
}

#[test]
fn a_move_that_turns_a_rotary_axis_keeps_its_feed() {
    let program = "S8000M3\nG0X0.Y0.Z-1.A0.\nG1A90.F300.\nX10.A100.\nG91C5.\n";
    assert_kept("rotary", "engagement", &rule("\"lines\"", "inside"), program);
}

#[test]
fn a_governed_move_before_any_f_gets_its_feed_written() {
    let program = "S8000M3\nG0X0.Y0.Z-1.\nG1X30.\nG1X60.F900.\n";
    let (_, adapted) = adapted("first", "safe-base", "engagement", &rule("\"lines\"", "inside"), program);
    let text = String::from_utf8_lossy(&adapted.text).into_owned();
    let first = text.lines().find(|line| line.starts_with("G1X30.")).expect("the cut");
    assert!(first.contains('F') || adapted.blocks.iter().any(|block| block.demand.is_none()), "{text}");
}

#[test]
fn an_arc_that_begins_on_a_lost_page_is_a_warning_and_no_alarm() {
    let scratch = Scratch::new("found-lost-page");
    // N58 of the published listing, whose start was on the page before.
    let program = "%\nG20G17G90G94\nN58G3X-3.6044Y10.5358I2.9247J-4.1317F25.\nG1X-3.Y10.\nM30\n%\n";
    let checked = run(&["check", &scratch.write("program.nc", program)]);
    let said = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert_eq!(checked.status.code(), Some(0), "{said}");
    assert!(said.contains("program.nc:3:") && said.contains("warning") && !said.contains("PS0020"), "{said}");
}

#[test]
fn every_arc_of_the_published_listing_is_found() {
    let name = "data/published-listing-slots-2-4.nc";
    let Some(path) = shared_or_skip(name, "feed_bounds: the published listing") else { return };
    let path = path.to_str().expect("a path in UTF-8");
    assert_eq!(run(&["check", path]).status.code(), Some(0));
    let scratch = Scratch::new("found-listing");
    let proposed = run(&["init", path, "-o", &scratch.path("job.toml")]);
    let said = String::from_utf8_lossy(&proposed.stdout).into_owned();
    assert!(proposed.status.success() && said.contains("78 arcs"), "{said}");
}
