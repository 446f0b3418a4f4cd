//! Time and memory of the command with many points; the full set has a million of them.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use arcfeed_tests::{Scratch, arcfeed, of_full_set, root, skip_loudly};

/// Most memory: of the plan itself, and for each point.
const PLAN_MIB: f64 = 90.0;
const BYTES_PER_POINT: f64 = 250.0;
/// Most processor time for each point beyond that of the smallest cloud; linear, 7 us were measured.
const MOST_US: f64 = 25.0;
/// Ticks of the system's clock in a second.
const TICKS_PER_S: f64 = 100.0;

/// Processor time and largest memory of a planning without output; `None` where the system does not tell them.
fn measured(repair: &str) -> Option<(f64, f64)> {
    let command = ["plan", "repair", repair];
    let mut child = Command::new(arcfeed()).args(command).stdout(Stdio::null()).spawn().expect("arcfeed starts");
    let folder = format!("/proc/{}", child.id());
    let mut largest_mib = 0.0_f64;
    let seconds = loop {
        let Ok(stat) = std::fs::read_to_string(format!("{folder}/stat")) else { break None };
        // Behind the name in parentheses: the state, and 11 fields further both times.
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
        if fields.first() == Some(&"Z") {
            let ticks = |at: usize| fields.get(at).and_then(|ticks| ticks.parse::<f64>().ok());
            break ticks(11).zip(ticks(12)).map(|(user, system)| (user + system) / TICKS_PER_S);
        }
        let status = std::fs::read_to_string(format!("{folder}/status")).unwrap_or_default();
        let kib = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.split_whitespace().next()?.parse().ok());
        largest_mib = largest_mib.max(kib.unwrap_or(0.0) / 1024.0);
        std::thread::sleep(Duration::from_millis(5));
    };
    assert!(child.wait().expect("arcfeed ends").success());
    Some((seconds?, largest_mib))
}

#[test]
fn time_and_memory_grow_with_the_points_and_no_faster() {
    let name = "time_and_memory_grow_with_the_points_and_no_faster";
    if !Path::new("/proc/self/stat").exists() {
        return skip_loudly(name, "no /proc on this system");
    }
    let scratch = Scratch::new("repair-large");
    let example = root().join("examples/repaired-blade");
    let text = std::fs::read_to_string(example.join("REPAIR.toml")).unwrap();
    let part = root().join("examples/finish-blisk/PART.toml").display().to_string();
    let repair = scratch.write("REPAIR.toml", text.replace("../finish-blisk/PART.toml", &part));
    let mut smallest: Option<(usize, f64)> = None;
    for asked in of_full_set(&[10_000, 100_000, 1_000_000][..], &[10_000, 100_000]) {
        let made = Command::new("python3").arg(example.join("make_points.py")).arg(asked.to_string()).output();
        let Some(table) = made.ok().filter(|made| made.status.success()).map(|made| made.stdout) else {
            return skip_loudly(name, "no python3");
        };
        let points = table.iter().filter(|byte| **byte == b'\n').count() - 2;
        scratch.write("points.csv", table);
        let (seconds, mib) = measured(&repair).expect("times of a process");
        println!("{points} points: {seconds:.1} s of the processor, {mib:.0} MiB");
        let (fewest, least_s) = *smallest.get_or_insert((points, seconds));
        assert!(mib <= PLAN_MIB + BYTES_PER_POINT * points as f64 / (1024.0 * 1024.0), "{mib}");
        assert!(seconds <= 1.5 * least_s + MOST_US * 1e-6 * (points - fewest) as f64, "{seconds} {least_s}");
    }
}
