//! The campaigns of `examples/campaigns`: every run is accepted, faults take effect, and the vibration of the cut is that of the linear
//! theory.

use std::fs;
use std::path::Path;
use std::process::Command;

use arcfeed_tests::{Scratch, arcfeed, of_full_set, root, run};
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

/// Runs the step of the example workflow that starts a campaign with these words, in a folder, as a hosted runner would.
#[track_caller]
fn workflow_step(words: &str, shard: &str, folder: &Path) {
    let workflow = fs::read_to_string(root().join("examples/ci/campaign.yml")).expect("the example");
    let steps = workflow.lines().filter_map(|line| line.trim().strip_prefix("run: arcfeed sweep "));
    let step = steps.into_iter().find(|step| step.contains(words)).expect("a step");
    let command = format!("arcfeed sweep {}", step.replace("${{ matrix.shard }}", shard));
    let programs = arcfeed().parent().expect("a folder").display();
    let path = format!("{programs}:{}", std::env::var("PATH").expect("a path"));
    let output = Command::new("sh").args(["-ec", &command]).env("PATH", path).current_dir(folder).output();
    let output = output.expect("sh runs");
    assert!(output.status.success(), "{command}: {output:?}");
}

/// Files of a folder with this ending are copied into another one.
fn copy_files(from: &Path, ending: &str, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for file in fs::read_dir(from).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if file.extension().is_some_and(|found| ending.is_empty() || found == ending) {
            fs::copy(&file, to.join(file.file_name().expect("a name"))).expect("copied");
        }
    }
}

#[test]
fn the_workflow_of_four_shards_makes_the_table_of_one_computer() {
    let scratch = Scratch::new("sweep-workflow");
    let campaign = fs::read_to_string(root().join("examples/campaigns/pocket-feeds.toml")).expect("the example");
    // Every runner has a checkout of its own.
    let checkout = |name: &str| {
        let folder = scratch.path(name);
        let folder = Path::new(&folder);
        copy_files(&root().join("examples/pocket"), "", &folder.join("pocket"));
        fs::create_dir_all(folder.join("campaign")).expect("a folder");
        fs::write(folder.join("campaign/SWEEP.toml"), &campaign).expect("a sweep file");
        folder.to_owned()
    };
    let table = checkout("table");
    for shard in ["1", "2", "3", "4"] {
        let runner = checkout(&format!("runner-{shard}"));
        workflow_step("--shard", shard, &runner);
        copy_files(&runner.join("out"), "journal", &table.join("out"));
    }
    workflow_step("--merge", "", &table);
    let alone = checkout("alone");
    let sweep_file = alone.join("campaign/SWEEP.toml");
    sweep(&[sweep_file.to_str().expect("ASCII"), "-o", alone.join("out").to_str().expect("ASCII")]);
    let rows = |folder: &Path| fs::read(folder.join("out/runs/part-00001.parquet")).expect("a table");
    assert!(rows(&table) == rows(&alone), "four runners and one computer");
    let xml = fs::read_to_string(table.join("out/runs.xml")).expect("JUnit XML");
    assert_eq!(xml.matches("<testcase ").count(), 40);
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
