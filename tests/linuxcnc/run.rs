//! Runs of NC programs on LinuxCNC, with the positions of every servo period.

use std::fs;

use arcfeed_tests::run;
use arcfeed_units::MM_PER_INCH;
use serde_json::{Value, json};

use super::machine::Machine;

/// Inches of a program on a machine in millimetres.
pub const INCH_MM: f64 = MM_PER_INCH;
/// Longest run of a program, seconds.
const PROGRAM_SECONDS: u32 = 150;

/// Sample of a servo period.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub time_s: f64,
    pub position_mm: [f64; 3],
    pub velocity_mm_per_s: f64,
    /// Adaptive feed times the feed override.
    pub ratio: f64,
    pub spindle: f64,
    /// Line of the program; 0 between moves.
    pub line: i64,
    pub state: i64,
}

/// Result of a run.
pub struct Ran {
    pub samples: Vec<Sample>,
    /// Reports of the driver.
    pub reports: Vec<Value>,
}

/// Run of `program.ngc`.
#[derive(Clone, Debug)]
pub struct Run {
    /// The component is armed.
    pub arms: bool,
    /// Block before the run; empty for none.
    pub mdi: &'static str,
    /// Line to begin with; 0 for the whole program.
    pub line: usize,
    /// Single block up to this line; 0 for none.
    pub steps: usize,
    /// Events, as `drive.py` has them.
    pub events: Value,
}

impl Run {
    /// Whole program without events.
    pub fn whole(arms: bool) -> Self {
        Run { arms, mdi: "", line: 0, steps: 0, events: json!([]) }
    }
}

impl Machine {
    /// Line of an arc of `program.ngc`, from 1; the first arc is number 0.
    pub fn arc_line(&self, number: usize) -> usize {
        let program = fs::read_to_string(self.path("program.ngc")).expect("the program");
        let is_arc = |line: &str| line.contains("G2X") || line.contains("G3X");
        let arcs = program.lines().enumerate().filter(|(_, line)| is_arc(line));
        arcs.map(|(index, _)| index + 1).nth(number).expect("an arc")
    }

    /// Runs `program.ngc`.
    pub fn run(&self, run: &Run) -> Ran {
        let [program, samples, report, drive] =
            ["program.ngc", "samples", "report", "drive.json"].map(|file| self.path(file));
        let Run { arms, mdi, line, steps, events } = run;
        let arguments = json!({
            "program": program, "samples": samples, "report": report, "arm": arms, "mdi": mdi, "line": line, "steps": steps,
            "events": events, "seconds": PROGRAM_SECONDS
        });
        fs::write(&drive, arguments.to_string()).expect("a file");
        let output = self.command(&format!("ARCFEED_DRIVE={drive} /usr/bin/python3 drive.py")).output();
        let output = output.expect("nice runs");
        let text = fs::read_to_string(&report).unwrap_or_default();
        let reports: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("a report")).collect();
        let has_ended = reports.iter().any(|report| report.get("ended").is_some());
        assert!(has_ended, "{text}{}", String::from_utf8_lossy(&output.stderr));
        let ran = Ran { samples: Vec::new(), reports };
        ran.reports.iter().filter(|report| report.get("times").is_none()).for_each(|report| println!("{report}"));
        assert_eq!(ran.last("missing"), "0", "every servo period has a sample");
        let old_rows = ran.last("old_rows").parse().expect("a number");
        let samples = read_samples(&fs::read_to_string(&samples).expect("samples"), old_rows);
        Ran { samples, ..ran }
    }

    /// Figures of a run of a job's program, by `arcfeed measure`.
    pub fn measure(&self, job: &str, samples: &[Sample], unit_mm: f64) -> Value {
        let row = |sample: &Sample| {
            let [x, y, z] = sample.position_mm.map(|mm| mm / unit_mm);
            let feed = sample.velocity_mm_per_s * 60.0 / unit_mm;
            format!("{:.3},{x:.9},{y:.9},{z:.9},{},{feed:.9},{}\n", sample.time_s, sample.line, sample.spindle)
        };
        let rows: String = samples.iter().map(row).collect();
        let positions = self.path("positions.csv");
        fs::write(&positions, "time,x,y,z,line,feed,spindle\n".to_owned() + &rows).expect("a file");
        let output = run(&["measure", job, "--for", "linuxcnc", "--positions", &positions, "--json"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("figures")
    }
}

impl Ran {
    /// A figure of the driver's last report.
    pub fn last(&self, key: &str) -> String {
        let found = self.reports.iter().rev().find_map(|report| report.get(key));
        found.map_or(String::new(), |value| value.as_str().map_or(value.to_string(), str::to_owned))
    }

    /// States of the component, in their order.
    pub fn states(&self) -> Vec<i64> {
        let mut states: Vec<i64> = self.samples.iter().map(|sample| sample.state).collect();
        states.dedup();
        states
    }
}

/// Samples of a run, without those that were not read before it.
fn read_samples(text: &str, old_rows: usize) -> Vec<Sample> {
    let mut samples = Vec::new();
    for line in text.lines().skip(old_rows) {
        let fields: Vec<f64> = line.split_whitespace().filter_map(|field| field.parse().ok()).collect();
        let [tag, x, y, z, velocity, adaptive, dial, spindle, line, kind, state, _reason, _chip, _, _, _] = fields[..]
        else {
            // The sampler is stopped within its last line.
            continue;
        };
        samples.push(Sample {
            time_s: tag * 1e-3,
            position_mm: [x, y, z],
            velocity_mm_per_s: velocity,
            ratio: adaptive * dial,
            spindle,
            line: if kind == 0.0 { 0 } else { line as i64 },
            state: state as i64,
        });
    }
    samples
}
