//! `sweep`: the same rows whatever the shards, and none lost or made twice when it is killed; `--set`, which its runs are made of.

use std::collections::BTreeMap;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use arcfeed_tests::{Scratch, arcfeed, of_full_set, root, run, run_with_memory};
use serde_json::Value;

const POCKET: &str = "examples/pocket/job-contour.toml";

/// Longest wait for a child to finish some runs.
const WAIT_MAX: Duration = Duration::from_secs(120);

/// Longest time of a whole campaign.
const WHOLE_MAX: Duration = Duration::from_secs(3_600);

/// Most memory of a campaign, whatever the number of its runs.
const MEMORY_KB: u64 = 40_000;

/// Text of a sweep file for the pocket.
fn sweep_text(rest: &str) -> String {
    format!("job = {:?}\n{rest}", root().join(POCKET).to_str().expect("the folder is named in ASCII"))
}

/// Faults of the line and drawn feeds per tooth: 24 runs, some of which end in alarms.
fn mixed() -> String {
    sweep_text(
        "command = \"stream\"\nport = \"fault://tx.flip={flip},seed={seed}/sim:\"\naccept = [\"passed\", \"stopped\"]\n\
         assert = [\"chip<=1.005\"]\nfigures = [\"cycle_time_s\", \"alarms\", \"link.bytes\", \"chip_load.error_ratio_max\"]\n\
         [list]\nflip = [0.0, 0.002]\nlimits.max_feed = [6000, 5000]\n[grid]\nseed = { from = 3, to = 5 }\n\
         [random]\nruns = 4\nseed = 9\nlaw.feed_per_tooth = { from = 0.08, to = 0.1 }\n",
    )
}

/// Faults of the line, which has parity, with each of four programs.
fn of_programs(scratch: &Scratch, runs: usize) -> String {
    let pocket = std::fs::read_to_string(root().join("examples/pocket/pocket.nc")).expect("the program");
    let programs = [10, 11, 12, 13].map(|island| {
        let start = format!("N300G1X.0Y-{island}.");
        let circle = format!("X.0Y-{island}.I.0J{}.", island + 5);
        let text = pocket.replace("N300G1X.0Y-10.", &start).replace("X.0Y-10.I.0J15.", &circle);
        assert!(text.contains(&start) && text.contains(&circle));
        format!("{:?}", scratch.write(&format!("pocket-{island}.nc"), text))
    });
    let grid = format!("[grid]\ndnc.code = [\"iso\"]\nprogram = [{}]\n", programs.join(", "));
    mixed()
        .replace("[grid]\n", &grid)
        .replace("runs = 4", "runs = 5")
        .replace("to = 5 ", &format!("to = {} ", 2 + runs / 40))
}

/// Exit code, stdout and stderr.
fn ended(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = run(&[&["sweep"], arguments].concat());
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn rows_are_the_same_bytes_for_any_number_of_shards_and_threads() {
    let scratch = Scratch::new("sweep-shards");
    let sweep = scratch.write("SWEEP.toml", mixed());
    for format in ["parquet", "csv"] {
        let csv: &[&str] = if format == "csv" { &["--csv"] } else { &[] };
        let table =
            |folder: &str| std::fs::read(scratch.path(&format!("{folder}/runs/part-00001.{format}"))).expect("a table");
        let whole = scratch.path("whole");
        let (code, out, err) = ended(&[&[&sweep, "-o", &whole, "--threads", "3"], csv].concat());
        assert!(code == Some(0) && out.starts_with("24 runs: "), "{out}{err}");
        for shards in [2, 5] {
            let folder = format!("of-{shards}");
            // In another order than they are numbered, and the last part twice.
            for shard in (1..=shards).rev().chain([1]) {
                let shard = format!("{shard}/{shards}");
                let (code, out, err) = ended(&[&sweep, "-o", &scratch.path(&folder), "--shard", &shard]);
                assert_eq!((code, out.as_str(), err.as_str()), (Some(0), "", ""), "{shard}");
            }
            let (code, _, err) = ended(&[&[&sweep, "-o", &scratch.path(&folder), "--merge"], csv].concat());
            assert_eq!((code, err.as_str()), (Some(0), ""));
            assert!(table(&folder) == table("whole"), "{format}: {shards} shards");
        }
    }
    let text = std::fs::read_to_string(scratch.path("whole/runs/part-00001.csv")).expect("CSV");
    let ends = text.lines().skip(1).map(|line| line.split(',').nth(1).expect("a status"));
    let counts = ends.fold(BTreeMap::new(), |mut counts: BTreeMap<&str, usize>, end| {
        *counts.entry(end).or_default() += 1;
        counts
    });
    println!("{counts:?}");
    assert!(counts["passed"] >= 12 && counts["stopped"] > 0 && counts.len() == 2, "{counts:?}");
}

#[test]
fn a_campaign_that_is_killed_goes_on_and_makes_no_run_twice() {
    let scratch = Scratch::new("sweep-killed");
    let runs = of_full_set(10_000, 120);
    let sweep = scratch.write("SWEEP.toml", of_programs(&scratch, runs));
    let journal = scratch.path("killed/shard-1-of-1.journal");
    let lines = || std::fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
    let mut kills = 0;
    // Killed some runs after each start, until less is left than that.
    while lines() + 20 < runs {
        let wanted = lines() + 15;
        let mut child = Command::new(arcfeed())
            .args(["sweep", &sweep, "-o", &scratch.path("killed"), "--csv"])
            .stdout(Stdio::null())
            .spawn()
            .expect("arcfeed runs");
        let started = Instant::now();
        while lines() < wanted && started.elapsed() < WAIT_MAX {
            sleep(Duration::from_millis(1));
        }
        assert!(lines() >= wanted, "{:?} with {} rows", child.try_wait(), lines());
        child.kill().expect("SIGKILL");
        child.wait().expect("it is gone");
        kills += 1;
    }
    let finish = |folder: &str| {
        let started = Instant::now();
        let arguments = ["sweep", &sweep, "-o", &scratch.path(folder), "--csv"];
        let (ended, kb) = run_with_memory(&scratch, folder, &arguments, WHOLE_MAX);
        assert_eq!((ended.code, ended.err.as_str()), (Some(0), ""));
        println!("{folder}: ended in {:.1} s with {kb} kB of memory", started.elapsed().as_secs_f64());
        assert!(kb < MEMORY_KB, "{kb} kB");
        std::fs::read_to_string(scratch.path(&format!("{folder}/runs/part-00001.csv"))).expect("CSV")
    };
    let [killed, whole] = ["killed", "whole"].map(finish);
    println!("{runs} runs, killed {kills} times");
    assert!(kills > 2 && killed == whole);
    let journal = std::fs::read_to_string(&journal).expect("the journal");
    let mut numbers: Vec<&str> = journal.lines().skip(1).filter_map(|line| line.split([':', ',']).nth(1)).collect();
    numbers.sort_unstable();
    let count = numbers.len();
    numbers.dedup();
    assert_eq!((count, numbers.len()), (runs, runs), "a run is missing, or was made twice");
}

#[test]
fn a_failing_run_is_named_with_the_command_that_repeats_it() {
    let scratch = Scratch::new("sweep-failing");
    let text = sweep_text("assert = [\"time<=14.5s\"]\n[grid]\nlaw.feed_per_tooth = [0.1, 0.08]\n");
    let (sweep, junit) = (scratch.write("SWEEP.toml", text), scratch.path("runs.xml"));
    let (code, out, err) = ended(&[&sweep, "--csv", "--junit", &junit]);
    assert!(code == Some(1) && out.starts_with("2 runs: 1 failed, 1 passed"), "{out}{err}");
    assert!(err.contains("run 2: failed: --assert time<=14.5s: ") && err.contains("time is 14.93 s"), "{err}");
    let command = err.lines().find_map(|line| line.trim().strip_prefix("arcfeed ")).expect("a command");
    assert!(command.contains("--set law.feed_per_tooth=0.08 --assert 'time<=14.5s'"), "{command}");
    let repeated = Command::new("sh").args(["-c", &format!("{} {command}", arcfeed().display())]).output().expect("sh");
    let by_number = run(&["sweep", &sweep, "--run", "2"]);
    for output in [repeated, by_number] {
        let err = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(1) && err.contains("time is 14.93 s"), "{err}");
    }
    let xml = std::fs::read_to_string(junit).expect("JUnit");
    assert!(xml.contains("tests=\"2\" failures=\"1\" errors=\"0\""), "{xml}");
    assert!(xml.contains("name=\"run 2: law.feed_per_tooth=0.08\"") && xml.matches("<testcase").count() == 2, "{xml}");
}

#[test]
fn what_makes_no_sense_is_refused_with_its_place_before_anything_runs() {
    let scratch = Scratch::new("sweep-refused");
    let good = "assert = [\"chip<=1.1\"]\nfigures = [\"cycle_time_s\"]\n[grid]\nspindle.rev_per_min = [7000, 8000]\n";
    for (old, new, place, words) in [
        ("rev_per_min", "rev_per_mn", "5:", "unknown field `rev_per_mn`"),
        ("8000", "-5", "5:30:", "must be positive"),
        ("[7000, 8000]", "7000", "5:23:", "write a list of values"),
        ("[7000, 8000]", "{ from = 7000, to = 8000.5 }", "5:23:", "needs `steps`"),
        ("cycle_time_s", "cycle_tim", "3:", "no figure `cycle_tim`"),
        ("cycle_time_s", "real_time_factor", "3:", "differs from run to run"),
        ("chip<=1.1", "chip<1.1", "2:", "FIGURE<=LIMIT"),
        ("[grid]", "[gird]", "4:2:", "no such key"),
        ("[grid]", "port = \"sim:\"\n[grid]", "4:8:", "only runs of `command"),
        ("[grid]", "command = \"stream\"\nport = \"fault://seed={s}/sim:\"\n[grid]", "5:8:", "`{s}` has no values"),
        ("[grid]", "command = \"stream\"\nport = \"loop://\"\n[grid]", "7:", "sim: only"),
        ("[grid]", "[random]\nlimits.max_feed = { from = 1, to = 2 }\n[grid]", "4:1:", "`runs`"),
    ] {
        assert!(good.contains(old), "{old}");
        let sweep = scratch.write("bad.toml", sweep_text(&good.replace(old, new)));
        let (code, out, err) = ended(&[&sweep, "-o", &scratch.path("out")]);
        let has_place = err.contains(&format!("bad.toml:{place}"));
        assert!(code == Some(1) && out.is_empty() && has_place && err.contains(words), "{new}: {code:?} {out}{err}");
        let journal = scratch.path("out/shard-1-of-1.journal");
        assert!(!std::path::Path::new(&journal).exists(), "{new}: something ran");
    }
    let sweep = scratch.write("good.toml", sweep_text(good));
    let folder = scratch.path("good");
    for (options, code, words) in [
        (&["--shard", "3/2"][..], 2, "I from 1 to N"),
        (&["--run", "9"], 2, "the runs 1 to 2"),
        (&["--merge"], 1, "2 of 2 runs are missing, the first 1, 2"),
    ] {
        std::fs::create_dir_all(&folder).expect("a folder");
        let folder: &[&str] = if options[0] == "--run" { &[] } else { &["-o", &folder] };
        let (found, _, err) = ended(&[&[sweep.as_str()], folder, options].concat());
        assert!(found == Some(code) && err.contains(words), "{options:?}: {err}");
    }
}

#[test]
fn a_changed_campaign_does_not_go_on_with_the_journal_of_the_old_one() {
    let scratch = Scratch::new("sweep-changed");
    let text = sweep_text("[grid]\nlaw.feed_per_tooth = [0.1]\n");
    let sweep = scratch.write("SWEEP.toml", &text);
    assert_eq!(ended(&[&sweep, "--csv"]).0, Some(0));
    scratch.write("SWEEP.toml", text.replace("0.1", "0.09"));
    let (code, _, err) = ended(&[&sweep, "--csv"]);
    assert!(code == Some(1) && err.contains("the journal of another campaign"), "{err}");
}

#[test]
fn a_figure_that_no_run_has_stops_the_campaign_at_its_place() {
    let scratch = Scratch::new("sweep-figure");
    let text = sweep_text("figures = [\"chip_load.nothing\"]\n[grid]\nlaw.feed_per_tooth = [0.1, 0.09]\n");
    let (code, _, err) = ended(&[&scratch.write("SWEEP.toml", text), "--csv"]);
    assert!(
        code == Some(1) && err.contains("SWEEP.toml:2:12: ") && err.contains("no `nothing`, only error_ratio_max"),
        "{err}"
    );
}

#[test]
fn the_script_for_slurm_runs_every_shard() {
    let scratch = Scratch::new("sweep-slurm");
    let sweep = scratch.write("SWEEP.toml", sweep_text("[grid]\nlaw.feed_per_tooth = [0.1, 0.09, 0.08]\n"));
    let folder = scratch.path("out");
    let (code, script, _) = ended(&[&sweep, "-o", &folder, "--slurm", "2"]);
    assert!(code == Some(0) && script.contains("#SBATCH --array=1-2\n"), "{script}");
    // The tasks as Slurm starts them, each with its number; `arcfeed` is found in the path.
    let path =
        format!("{}:{}", arcfeed().parent().expect("a folder").display(), std::env::var("PATH").unwrap_or_default());
    let script = scratch.write("array.sh", script);
    for task in ["2", "1"] {
        let mut shell = Command::new("sh");
        shell.arg(&script).env("PATH", &path).env("SLURM_ARRAY_TASK_ID", task).env("SLURM_CPUS_PER_TASK", "1");
        assert!(shell.status().expect("sh").success());
    }
    assert_eq!(ended(&[&sweep, "-o", &folder, "--merge", "--csv"]).0, Some(0));
    assert_eq!(ended(&[&sweep, "-o", &scratch.path("whole"), "--csv"]).0, Some(0));
    let table = |folder: &str| std::fs::read(format!("{folder}/runs/part-00001.csv")).expect("CSV");
    assert!(table(&folder) == table(&scratch.path("whole")));
}

#[test]
fn a_value_that_is_set_is_that_of_a_job_with_it() {
    let scratch = Scratch::new("set-value");
    let text = std::fs::read_to_string(root().join(POCKET)).expect("the job");
    let program = format!("program = {:?}", root().join("examples/pocket/pocket.nc").to_str().expect("ASCII"));
    let written =
        text.replace("program = \"pocket.nc\"", &program).replace("feed_per_tooth = 0.05 ", "feed_per_tooth = 0.04 ");
    let job = scratch.write("job.toml", written);
    let blocks = |arguments: &[&str]| -> Vec<Value> {
        let output = run(&[&["adapt"], arguments, &["--json"]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).expect("JSON is text");
        text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect()
    };
    let set = blocks(&[POCKET, "--set", "cut.3.feed_per_tooth=0.04"]);
    assert_eq!(set, blocks(&[&job]));
    assert_ne!(set, blocks(&[POCKET]));
    for (value, words) in [
        ("cut.3.feed_per_tooth=-1", "job-contour.toml:42:"),
        ("cut.3.nothing=1", "unknown field `nothing`"),
        ("machine-file.name=\"x\"", "names no machine"),
        ("spindle=1", "`spindle` is a table"),
    ] {
        let output = run(&["adapt", POCKET, "--set", value]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(1) && message.contains(words) && message.contains("--set"), "{message}");
    }
    let output = run(&["simulate", "examples/pocket/pocket.nc", "--tool", "10", "--set", "units=mm"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn limits_of_a_transmission_hold_as_far_as_it_went() {
    let job = ["stream", POCKET, "--assert", "chip<=1.005"];
    assert_eq!(run(&job).status.code(), Some(0));
    let broken = run(&[&job[..], &["--assert", "feed<=3000mm/min"]].concat());
    let message = String::from_utf8_lossy(&broken.stderr).into_owned();
    assert!(broken.status.code() == Some(1) && message.contains("feed is 3200 mm/min"), "{message}");
    // An alarm in the second block: no chip was cut, and the run does not pass either.
    let stopped = run(&[&job[..], &["--port", "fault://tx.flip=0.001,seed=16/sim:"]].concat());
    let message = String::from_utf8_lossy(&stopped.stderr).into_owned();
    assert!(stopped.status.code() == Some(3) && message.contains("the control stopped"), "{message}");
    let on_line = run(&[&job[..], &["--port", "loop://"]].concat());
    assert_eq!(on_line.status.code(), Some(2));
}
