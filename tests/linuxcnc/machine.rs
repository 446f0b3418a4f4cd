//! LinuxCNC with the sample configuration, without a screen and as a user of its own; one run at a time.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use arcfeed_tests::{Scratch, root, run, skip_loudly};
use arcfeed_units::MM_PER_INCH;
use serde_json::{Value, json};

/// User that LinuxCNC runs as: it refuses root.
const USER: &str = "arcfeed-cnc";
/// Longest run of LinuxCNC, from its start to its end.
const SECONDS_MAX: &str = "150";
/// Longest wait for a LinuxCNC that is in use.
const OTHERS_SECONDS: u32 = 120;
/// Longest run of a program, seconds.
const PROGRAM_SECONDS: u32 = 90;

/// Machine that programs run on.
pub struct Machine {
    scratch: Scratch,
    _only: MutexGuard<'static, ()>,
}

/// Sample of a servo period.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub time_s: f64,
    pub position_mm: [f64; 3],
    pub velocity_mm_per_s: f64,
    /// Adaptive feed times the feed override.
    pub ratio: f64,
    pub spindle: f64,
    pub line: i64,
    pub state: i64,
}

/// Result of a run.
pub struct Ran {
    pub samples: Vec<Sample>,
    /// Reports of the driver.
    pub reports: Vec<Value>,
}

impl Machine {
    /// A machine with the component installed; says so where there is none.
    pub fn or_skip(test: &str) -> Option<Machine> {
        static ONLY: Mutex<()> = Mutex::new(());
        static INSTALLED: OnceLock<Result<(), String>> = OnceLock::new();
        let only = ONLY.lock().unwrap_or_else(PoisonError::into_inner);
        if let Err(why) = INSTALLED.get_or_init(install) {
            skip_loudly(test, why);
            return None;
        }
        if !is_free() {
            skip_loudly(test, "LinuxCNC is in use by another program, and two do not run at a time");
            return None;
        }
        let scratch = Scratch::new(test);
        let folder = PathBuf::from(scratch.path(""));
        for part in ["examples/linuxcnc", "firmware/linuxcnc"] {
            copy(&root().join(part), &folder.join(part));
        }
        let machine = Machine { scratch, _only: only };
        let ini = fs::read_to_string(machine.path("arcfeed.ini")).expect("the sample configuration");
        let is_screen = |line: &&str| ["PYVCP", "POSTGUI_HALFILE", "DISPLAY ="].iter().any(|key| line.starts_with(key));
        let lines = ini.lines().filter(|line| !is_screen(line));
        let headless = lines.collect::<Vec<_>>().join("\n").replace("[DISPLAY]", "[DISPLAY]\nDISPLAY = ./display.sh");
        fs::write(machine.path("headless.ini"), headless + "\n").expect("a file");
        fs::copy(root().join("tests/linuxcnc/drive.py"), machine.path("drive.py")).expect("the driver");
        fs::write(machine.path("display.sh"), "#!/bin/sh\nexec /usr/bin/python3 drive.py\n").expect("a file");
        shell(&format!("chmod +x {}", machine.path("display.sh"))).expect("it was just written");
        Some(machine)
    }

    /// Path of a file beside the configuration.
    pub fn path(&self, file: &str) -> String {
        self.scratch.path(&format!("examples/linuxcnc/{file}"))
    }

    /// Adapts a job for LinuxCNC to `program.ngc`.
    pub fn adapt(&self, job: &str) {
        let output = run(&["adapt", job, "--for", "linuxcnc", "-o", &self.path("program.ngc")]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }

    /// Line of an arc of `program.ngc`, from 1; the first arc is number 0.
    pub fn arc_line(&self, number: usize) -> usize {
        let program = fs::read_to_string(self.path("program.ngc")).expect("the program");
        let is_arc = |line: &str| line.contains("G2X") || line.contains("G3X");
        let arcs = program.lines().enumerate().filter(|(_, line)| is_arc(line));
        arcs.map(|(index, _)| index + 1).nth(number).expect("an arc")
    }

    /// Runs `program.ngc`; `events` are as `drive.py` has them.
    pub fn run(&self, arms: bool, events: Value) -> Ran {
        let [program, samples, report, drive] =
            ["program.ngc", "samples", "report", "drive.json"].map(|file| self.path(file));
        let arguments = json!({
            "program": program, "samples": samples, "report": report, "arm": arms, "events": events, "seconds": PROGRAM_SECONDS
        });
        fs::write(&drive, arguments.to_string()).expect("a file");
        shell(&format!("chown -R {USER} {}", self.scratch.path(""))).expect("root gives files away");
        let folder = Path::new(&drive).parent().expect("a folder").display().to_string();
        let command = format!(
            "cd {folder} && HOME={folder} ARCFEED_DRIVE={drive} timeout -k 5 {SECONDS_MAX} linuxcnc headless.ini"
        );
        // Before the other tests: without a real-time kernel a component that gets no time has lost its link.
        let mut nice = Command::new("nice");
        let output =
            nice.args(["-n", "-15", "su", USER, "-s", "/bin/sh", "-c", &command]).stdin(Stdio::null()).output();
        let output = output.expect("nice runs");
        let text = fs::read_to_string(&report).unwrap_or_default();
        let reports: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("a report")).collect();
        let has_ended = reports.iter().any(|report| report.get("ended").is_some());
        assert!(has_ended, "{text}{}", String::from_utf8_lossy(&output.stdout));
        reports.iter().for_each(|report| println!("{report}"));
        Ran { samples: read_samples(&fs::read_to_string(&samples).expect("samples")), reports }
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

/// Inches of a program on a machine in millimetres.
pub const INCH_MM: f64 = MM_PER_INCH;

impl Ran {
    /// A figure of the driver's last report.
    pub fn last(&self, key: &str) -> String {
        let found = self.reports.iter().rev().find_map(|report| report.get(key));
        found.map_or(String::new(), |value| value.as_str().map_or(value.to_string(), str::to_owned))
    }
}

/// Samples without a gap: the sampler counts every servo period.
fn read_samples(text: &str) -> Vec<Sample> {
    let mut samples = Vec::new();
    let mut count = None;
    for line in text.lines() {
        let fields: Vec<f64> = line.split_whitespace().filter_map(|field| field.parse().ok()).collect();
        let [tag, x, y, z, velocity, adaptive, dial, spindle, line, _kind, state, _reason, _chip] = fields[..] else {
            // The sampler is stopped within its last line.
            continue;
        };
        assert!(count.is_none_or(|count: f64| tag == count + 1.0), "samples are missing before {tag}");
        count = Some(tag);
        samples.push(Sample {
            time_s: tag * 1e-3,
            position_mm: [x, y, z],
            velocity_mm_per_s: velocity,
            ratio: adaptive * dial,
            spindle,
            line: line as i64,
            state: state as i64,
        });
    }
    samples
}

/// Whether no other LinuxCNC runs, after a while at the latest.
fn is_free() -> bool {
    for _ in 0..OTHERS_SECONDS {
        if shell("pgrep -x linuxcncsvr").is_err() {
            return true;
        }
        std::thread::sleep(Duration::from_secs(1));
    }
    false
}

/// Builds the component and installs it where LinuxCNC loads it from, and makes the user.
fn install() -> Result<(), String> {
    if shell("id -u")?.trim() != "0" {
        return Err("the component is installed into LinuxCNC's folder, which takes root".into());
    }
    let missing = |program: &&&str| shell(&format!("command -v {program}")).is_err();
    if let Some(program) = ["linuxcnc", "halcompile", "halsampler", "su", "timeout"].iter().find(missing) {
        return Err(format!("there is no `{program}` (Debian's linuxcnc-uspace and linuxcnc-uspace-dev)"));
    }
    if shell(&format!("id {USER}")).is_err() {
        shell(&format!("useradd --create-home {USER}"))?;
    }
    let library = ["rustc", "--quiet", "--locked", "-p", "arcfeed-c", "--lib", "--crate-type", "staticlib"];
    let profile = ["--profile", "static-library", "--features", "static-library"];
    let built = Command::new(env!("CARGO")).args(library).args(profile).current_dir(root()).status();
    assert!(built.is_ok_and(|status| status.success()), "the static library builds");
    // A test runs as TARGET/PROFILE/deps/NAME.
    let test = std::env::current_exe().expect("a test knows its own path");
    let target = test.ancestors().nth(3).expect("a target folder").join("static-library/libarcfeed_c.a");
    let scratch = Scratch::new("halcompile");
    let component = scratch.write("arcfeed.comp", fs::read(root().join("firmware/linuxcnc/arcfeed.comp")).expect("it"));
    let output = Command::new("halcompile")
        .args(["--install", &component])
        .current_dir(scratch.path(""))
        .env("CPATH", root().join("firmware/c/include"))
        .env("LDFLAGS", format!("-Wl,-u,arcfeed_create {}", target.display()))
        .output()
        .expect("halcompile runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    Ok(())
}

fn shell(command: &str) -> Result<String, String> {
    let Output { status, stdout, stderr } =
        Command::new("sh").args(["-c", command]).output().map_err(|error| error.to_string())?;
    if status.success() {
        Ok(String::from_utf8_lossy(&stdout).into_owned())
    } else {
        Err(format!("{command}: {}", String::from_utf8_lossy(&stderr)))
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder of the project").map(|entry| entry.expect("an entry")) {
        fs::copy(entry.path(), to.join(entry.file_name())).expect("a file of the project");
    }
}
