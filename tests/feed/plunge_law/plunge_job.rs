//! A job of plunges, made of its parts, and what its simulation finds.

use arcfeed_tests::{Scratch, run};
use serde_json::Value;

/// A job.
pub struct PlungeJob<'a> {
    pub name: &'a str,
    pub tool: &'a str,
    pub workpiece: &'a str,
    /// Lines of `[cutting]`.
    pub cutting: &'a str,
    /// Lines of `[spindle]`.
    pub spindle: &'a str,
    /// Lines of `[override]`.
    pub mode: &'a str,
    pub feed_per_tooth_mm: f64,
    pub max_raise: f64,
    pub program: &'a str,
}

/// A block with a load, in both runs.
#[derive(Clone, Copy, Debug)]
pub struct Load {
    pub power_w: f64,
    pub torque_n_m: f64,
    pub chip_mm: f64,
}

/// What the simulation finds.
pub struct Found {
    /// After and before.
    pub loads: [Vec<Load>; 2],
    pub time_s: [f64; 2],
    /// `adapt --json`.
    pub adapted: Vec<Value>,
}

impl PlungeJob<'_> {
    /// Writes job and program.
    pub fn written(&self) -> (Scratch, String) {
        let scratch = Scratch::new(&format!("plunge-{}", self.name));
        scratch.write("program.nc", self.program);
        let PlungeJob { tool, workpiece, cutting, spindle, mode, feed_per_tooth_mm, max_raise, .. } = self;
        let job = scratch.write(
            "job.toml",
            format!(
                "units = \"mm\"\nprogram = \"program.nc\"\n[tool]\n{tool}\n[workpiece]\n{workpiece}\n[cutting]\n{cutting}\n\
                 [spindle]\n{spindle}\n[limits]\nmax_feed = 3000\nmax_raise = {max_raise}\n\
                 [law]\nkind = \"plunge\"\nfeed_per_tooth = {feed_per_tooth_mm}\n\
                 [plunge]\nmap = \"map.toml\"\nramps = true\n[override]\n{mode}\n"
            ),
        );
        (scratch, job)
    }

    /// Makes the map, adapts and simulates.
    pub fn found(&self) -> Found {
        let (_scratch, job) = self.written();
        let output = |arguments: &[&str]| {
            let output = run(arguments);
            assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
            String::from_utf8(output.stdout).expect("text")
        };
        output(&["engage", &job]);
        let adapted = output(&["adapt", &job, "--json"]);
        let report: Value = serde_json::from_str(&output(&["simulate", &job, "--json"])).expect("one object");
        let loads = ["load", "baseline"].map(|run| {
            let blocks = report["loads"]["blocks"].as_array().expect("blocks").iter();
            blocks.filter_map(|block| Load::of(&block[run])).collect()
        });
        let time_s = ["cycle_time_s", "baseline_cycle_time_s"].map(|key| report[key].as_f64().expect("a time"));
        let adapted = adapted.lines().map(|line| serde_json::from_str(line).expect("an object")).collect();
        Found { loads, time_s, adapted }
    }
}

impl Load {
    fn of(load: &Value) -> Option<Self> {
        let number = |key: &str| load[key].as_f64();
        Some(Load {
            power_w: number("power_max_w")?,
            torque_n_m: number("torque_max_n_m")?,
            chip_mm: number("end_chip_max").unwrap_or(0.0),
        })
    }
}

impl Found {
    /// Largest of a figure, after and before.
    pub fn most(&self, figure: impl Fn(&Load) -> f64) -> [f64; 2] {
        self.loads.each_ref().map(|loads| loads.iter().map(&figure).fold(0.0, f64::max))
    }
}
