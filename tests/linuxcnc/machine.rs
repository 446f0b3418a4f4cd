//! LinuxCNC with the sample configuration, without a screen and as a user of its own; one at a time.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use arcfeed_tests::emulation::images;
use arcfeed_tests::{Scratch, root, run, skip_loudly};

/// User that LinuxCNC runs as: it refuses root.
const USER: &str = "arcfeed-cnc";
/// Longest life of a LinuxCNC: a loaded computer takes twice as long as an idle one for the runs of a test.
const SECONDS_MAX: &str = "1200";
/// Longest wait for a LinuxCNC that is in use, and for one to start.
const OTHERS_SECONDS: u32 = 120;
const START_SECONDS: u32 = 60;

/// Running LinuxCNC, switched on and homed.
pub struct Machine {
    scratch: Scratch,
    linuxcnc: Child,
    _only: MutexGuard<'static, ()>,
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
        let folder = folder.join("examples/linuxcnc");
        write_headless(&folder);
        own(&folder);
        let linuxcnc = as_user(&folder, &format!("timeout -k 5 {SECONDS_MAX} linuxcnc headless.ini"))
            .stdin(Stdio::null())
            .stdout(File::create(folder.join("log")).expect("a file"))
            .stderr(Stdio::null())
            .spawn()
            .expect("nice runs");
        let machine = Machine { scratch, linuxcnc, _only: only };
        machine.wait_until_ready();
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

    /// A command as the user of LinuxCNC, in the folder of the configuration, which it owns.
    pub fn command(&self, command: &str) -> Command {
        let folder = PathBuf::from(self.path(""));
        own(&folder);
        as_user(&folder, command)
    }

    /// Ends LinuxCNC.
    pub fn stop(&mut self) {
        let _unwritten = fs::write(self.path("stop"), "");
        let _ended = self.linuxcnc.wait();
    }

    fn wait_until_ready(&self) {
        for _ in 0..10 * START_SECONDS {
            if Path::new(&self.path("ready")).exists() {
                return;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        panic!("LinuxCNC has not started: {}", fs::read_to_string(self.path("log")).unwrap_or_default());
    }
}

impl Drop for Machine {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Writes the sample configuration without panel and screen.
fn write_headless(folder: &Path) {
    let ini = fs::read_to_string(folder.join("arcfeed.ini")).expect("the sample configuration");
    let is_screen = |line: &&str| ["PYVCP", "POSTGUI_HALFILE", "DISPLAY ="].iter().any(|key| line.starts_with(key));
    let lines = ini.lines().filter(|line| !is_screen(line));
    let headless = lines.collect::<Vec<_>>().join("\n").replace("[DISPLAY]", "[DISPLAY]\nDISPLAY = ./display.sh");
    fs::write(folder.join("headless.ini"), headless + "\n").expect("a file");
    for script in ["display.py", "drive.py"] {
        fs::copy(root().join("tests/linuxcnc").join(script), folder.join(script)).expect("a script");
    }
    let display = folder.join("display.sh");
    fs::write(&display, "#!/bin/sh\nexec /usr/bin/python3 display.py\n").expect("a file");
    shell(&format!("chmod +x {}", display.display())).expect("it was just written");
}

/// A command as the user. Under a load LinuxCNC needs what a machine gives it: its servo thread, and the programs that feed and read
/// it, come before all others. Where the computer does not grant that, they come early.
fn as_user(folder: &Path, command: &str) -> Command {
    static IS_GRANTED: OnceLock<bool> = OnceLock::new();
    let is_granted = *IS_GRANTED.get_or_init(|| shell("chrt --rr 1 true").is_ok());
    let (first, realtime) = if is_granted { ("chrt --rr 1", "LINUXCNC_FORCE_REALTIME=1") } else { ("nice -n -15", "") };
    let folder = folder.display();
    let (program, arguments) = first.split_once(' ').expect("a program and its arguments");
    let mut early = Command::new(program);
    early.args(arguments.split(' ')).args(["su", USER, "-s", "/bin/sh", "-c"]);
    early.arg(format!("cd {folder} && export HOME={folder} {realtime} && {command}"));
    early
}

/// Passes a folder to the user.
fn own(folder: &Path) {
    shell(&format!("chown -R {USER} {}", folder.display())).expect("root gives files away");
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
    let library = images::static_library(false, "");
    let scratch = Scratch::new("halcompile");
    let component = scratch.write("arcfeed.comp", fs::read(root().join("firmware/linuxcnc/arcfeed.comp")).expect("it"));
    let output = Command::new("halcompile")
        .args(["--install", &component])
        .current_dir(scratch.path(""))
        .env("CPATH", root().join("firmware/c/include"))
        .env("LDFLAGS", format!("-Wl,-u,arcfeed_create {}", library.display()))
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
