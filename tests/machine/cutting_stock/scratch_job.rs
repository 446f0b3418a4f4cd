//! Jobs of a few lines, and what `simulate --json` says of them.

use arcfeed_tests::{Scratch, run};
use serde_json::Value;

/// A slot of 40 mm by a mill of R 5 mm, 4 mm deep, in the middle of a block.
pub const SLOT: &str = "%\nG21G17G90G94\nN1G0X.013Y.021\nN2G0Z5.\nN3G1Z-4.F400.\nN4G1X40.013F600.\nN5G0Z5.\nN6M30\n%\n";

/// The mill, and the block that the slot is cut from.
pub const MILL: &str = "units = \"mm\"\nprogram = \"program.nc\"\n\
    [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 30\n\
    [spindle]\nrev_per_min = 3000\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n\
    [workpiece]\nblock = { from = [-10, -10, -12], to = [50, 10, 0] }\nstep = 0.25\n";

/// Output of a run.
pub struct RunOutput {
    pub report: Value,
    pub complaints: String,
}

/// A job with its program.
pub struct ScratchJob {
    pub scratch: Scratch,
    pub job: String,
}

impl ScratchJob {
    pub fn new(name: &str, job: &str, program: &str) -> Self {
        let scratch = Scratch::new(&format!("cutting-{name}"));
        scratch.write("program.nc", program);
        let job = scratch.write("job.toml", job);
        ScratchJob { scratch, job }
    }

    /// Runs the job with these options.
    #[track_caller]
    pub fn run(&self, options: &[&str]) -> RunOutput {
        let output = run(&[&["simulate", &self.job, "--json"], options].concat());
        let complaints = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(0), "{complaints}");
        RunOutput { report: serde_json::from_slice(&output.stdout).expect("one object"), complaints }
    }

    /// Exit code and messages of a run that fails.
    pub fn failed(&self, options: &[&str]) -> (Option<i32>, String) {
        let output = run(&[&["simulate", &self.job], options].concat());
        (output.status.code(), String::from_utf8(output.stderr).expect("text"))
    }
}

impl RunOutput {
    /// A number of the material's.
    #[track_caller]
    pub fn material(&self, pointer: &str) -> f64 {
        self.report["material"].pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {pointer}"))
    }

    /// Material that the block N removed.
    pub fn block(&self, n: i64) -> Option<&Value> {
        self.report["material"]["blocks"].as_array().expect("a list").iter().find(|block| block["n"] == n)
    }

    /// Volume that the block N removed.
    #[track_caller]
    pub fn removed(&self, n: i64) -> f64 {
        self.block(n).and_then(|block| block["removal"]["removed"].as_f64()).unwrap_or_else(|| panic!("no block {n}"))
    }
}
