//! Cut rules that no move can meet.

use arcfeed::adapt::unused_rules::{RuleUse, unused_rules};
use arcfeed::job::JobFile;
use arcfeed::program::Source;
use arcfeed_tests::{Scratch, root, run};

/// A rule of the pocket's job, in front of the others or behind them.
fn with_rule(rule: &str, is_first: bool) -> Vec<String> {
    let path = root().join("examples/pocket/job-contour.toml");
    let text = std::fs::read_to_string(&path).expect("the example's job");
    let rule = format!("[[cut]]\n{rule}\n");
    let text =
        if is_first { text.replacen("[[cut]]", &format!("{rule}\n[[cut]]"), 1) } else { format!("{text}\n{rule}") };
    let file = JobFile::parse(&path, &text).unwrap_or_else(|error| panic!("{error}"));
    let program = Source::read(&file.program, file.nc, file.tables).expect("the example's program");
    let place = format!("{}:", path.display());
    let (job, mut used) = (&file.job, RuleUse::new(&file.job, None));
    program.survey(false, |line| used.add(line, &file, job.tool_in(line.machining.tool)), |_, _| {});
    let warnings = unused_rules(&path, &file, Some((&program.path, &used)));
    warnings.iter().map(|warning| warning.strip_prefix(&place).expect("its file").to_owned()).collect()
}

#[test]
fn rules_that_no_move_can_meet_are_warned_of() {
    let arcs = |rest: &str| format!("moves = \"arcs\"\ndirection = \"ccw\"\nside = \"slot\"\n{rest}");
    let behind = with_rule(&arcs("n = [150, 180]"), false);
    assert!(
        matches!(&behind[..], [one] if one.starts_with("45:1: warning: this rule is never used: the one in line 25")
        && one.ends_with("(in `cut.4`)")),
        "{behind:?}"
    );
    let before = with_rule(&arcs(""), true);
    assert_eq!(before.len(), 2, "both rules for ccw arcs are behind it: {before:?}");
    let elsewhere = with_rule(&arcs("n = [9000, 9001]"), false);
    assert!(
        matches!(&elsewhere[..], [one] if one.contains("no move of") && one.contains("pocket.nc")),
        "{elsewhere:?}"
    );
    assert_eq!(with_rule("moves = \"lines\"\nside = \"slot\"", false), [""; 0]);
}

#[test]
fn rules_of_a_tool_without_a_number_are_met_by_the_one_that_the_program_loads() {
    let folder = root().join("examples/pocket");
    let scratch = Scratch::new("unnamed");
    scratch.write("pocket.nc", std::fs::read(folder.join("pocket.nc")).expect("the example"));
    let job = std::fs::read_to_string(folder.join("job-contour.toml")).expect("the example");
    let path = scratch.write("job.toml", job.replacen("number = 1\n", "", 1));
    for command in ["check", "adapt"] {
        let output = run(&[command, &path]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), &*said), (Some(0), ""), "{command}");
    }
}
