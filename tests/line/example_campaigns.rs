//! The campaigns of `examples/campaigns`: every run is accepted, faults take effect, and the vibration of the cut is that of the linear
//! theory.

use arcfeed_tests::{Scratch, of_full_set, root, run};
use serde_json::Value;

/// Runs a campaign, which must end without a word on stderr.
#[track_caller]
fn sweep(arguments: &[&str]) {
    let output = run(&[&["sweep"], arguments].concat());
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
}

#[test]
fn the_examples_are_campaigns_whose_runs_are_accepted() {
    let scratch = Scratch::new("sweep-examples");
    let campaigns = [
        ("dnc-faults", 210, 5),
        ("link-faults", 70, 5),
        ("random-jobs", 160, 5),
        ("pocket-feeds", 40, 1),
        ("stability", 10, 1),
    ];
    for (name, runs, parts) in campaigns {
        let folder = scratch.path(name);
        // Of the long ones the first of five shards.
        let parts = of_full_set(1, parts);
        let (file, shard) = (format!("examples/campaigns/{name}.toml"), format!("1/{parts}"));
        sweep(&[&file, "-o", &folder, "--csv", "--shard", &shard]);
        let text = std::fs::read_to_string(format!("{folder}/shard-1-of-{parts}.journal")).expect("a journal");
        let ended_so = |status: &str| text.lines().skip(1).filter(|line| line.contains(status)).count();
        let [passed, stopped] = ["\"passed\"", "\"stopped\""].map(ended_so);
        println!("{name}: {passed} passed, {stopped} stopped");
        assert_eq!(passed + stopped, runs / parts, "{name}");
        assert_eq!(stopped > 0, name.ends_with("faults"), "{name}: the faults take effect");
    }
}

#[test]
fn the_campaign_of_stability_agrees_with_the_linear_theory() {
    let scratch = Scratch::new("sweep-stability");
    let folder = scratch.path("out");
    sweep(&["examples/campaigns/stability.toml", "-o", &folder, "--csv"]);
    let table = std::fs::read_to_string(format!("{folder}/runs/part-00001.csv")).expect("CSV");
    let job = std::fs::read_to_string(root().join("examples/campaigns/stability/job.toml")).expect("the job");
    let mut kinds = [0, 0];
    for row in table.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let [depth, speed, unstable] = [3, 5, 7].map(|at| cells[at]);
        let at_speed = job
            .replace("rev_per_min = 5000", &format!("rev_per_min = {speed}"))
            .replace("axial_depth = 3", &format!("axial_depth = {depth}"));
        let lobes =
            run(&["lobes", &scratch.write("job.toml", at_speed), "--speeds", "5000,8000", "--points", "2", "--json"]);
        let lobes: Value = serde_json::from_slice(&lobes.stdout).expect("one object");
        let is_stable = lobes["job"]["is_stable"].as_bool().expect("a verdict");
        assert_eq!(unstable == "0", is_stable, "{row}: {}", lobes["job"]);
        kinds[usize::from(is_stable)] += 1;
    }
    assert_eq!(kinds, [3, 7]);
}
