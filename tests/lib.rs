//! Helpers of several test files. The tests themselves are the `[[test]]` targets beside this file.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

pub mod python;

pub mod emulation;

pub mod noticed;

pub mod recording;

pub mod valgrind;

/// Longest wait for a process under test.
const WAIT_MAX: Duration = Duration::from_secs(60);

/// The root of the workspace.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie in a folder of the workspace")
}

/// The program under test, built as these tests are.
pub fn arcfeed() -> &'static Path {
    static BINARY: OnceLock<PathBuf> = OnceLock::new();
    BINARY.get_or_init(|| {
        // This test runs as target/<profile>/deps/<name>-<hash>; the program lies one folder up.
        let test = std::env::current_exe().expect("a test knows its own path");
        let name = test.file_stem().and_then(|stem| stem.to_str()?.rsplit_once('-')).expect("a name and a hash").0;
        let built = Command::new(env!("CARGO"))
            // The features are those of the whole workspace with its tests, as `cargo xtask test` builds it: with others, the program and half of
            // what it needs would be built again.
            .args(["build", "--quiet", "--workspace", "--bin", "arcfeed", "--test", name])
            .current_dir(root())
            .status()
            .expect("cargo runs");
        assert!(built.success(), "arcfeed does not build");
        let folder = test.ancestors().nth(2).expect("tests run from the deps folder");
        folder.join(format!("arcfeed{}", std::env::consts::EXE_SUFFIX))
    })
}

/// The files below a folder of the workspace, each with its text.
pub fn texts_below(folder: &str) -> Vec<(PathBuf, String)> {
    let (mut folders, mut texts) = (vec![root().join(folder)], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder of the workspace") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                let is_installed = path.ends_with("target") || path.ends_with("node_modules");
                folders.extend((!is_installed).then_some(path));
            } else {
                let bytes = fs::read(&path).expect("a file");
                texts.push((path, String::from_utf8_lossy(&bytes).into_owned()));
            }
        }
    }
    texts
}

/// Runs `arcfeed` with these arguments in the root of the workspace.
pub fn run(arguments: &[&str]) -> Output {
    Command::new(arcfeed()).args(arguments).current_dir(root()).output().expect("arcfeed runs")
}

/// The one JSON object that `arcfeed` prints with these arguments and `--json`, after it has ended well.
pub fn object(arguments: &[&str]) -> Value {
    let output = run(&[arguments, &["--json"]].concat());
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {said}");
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// A number in an object, by its JSON pointer.
pub fn number(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}: {value}"))
}

/// A program written for G17, in the plane that the G word names: the axes X, Y, Z and the centre's I, J, K become
/// `letters`. Lines with a comment stay as they are.
pub fn in_plane(program: &str, plane: &str, letters: &str) -> String {
    let letter = |old: char| "XYZIJK".find(old).and_then(|at| letters.chars().nth(at)).unwrap_or(old);
    let line = |line: &str| if line.contains('(') { line.to_owned() } else { line.chars().map(letter).collect() };
    let lines: Vec<String> = program.lines().map(line).collect();
    lines.join("\n").replace("G17", plane) + "\n"
}

/// The part of a full set that is tried: all of it under `cargo xtask soak`.
pub fn of_full_set<T>(full: T, part: T) -> T {
    if std::env::var_os("ARCFEED_SOAK_SECONDS").is_some() { full } else { part }
}

/// A file that lies beside the project on some machines only. A test without it says so, and loudly: on its own output
/// and in the log that `cargo xtask test` prints at its end.
pub fn shared_or_skip(file: &str, test: &str) -> Option<PathBuf> {
    let path = root().parent()?.join("shared").join(file);
    if path.exists() {
        return Some(path);
    }
    skip_loudly(test, &format!("there is no {file} in the shared folder beside the project"));
    None
}

/// Says that a test does not run, and why: on its own output and in the log that `cargo xtask test` prints at its end.
pub fn skip_loudly(test: &str, why: &str) {
    let message = format!("SKIPPED (loudly): {test}: {why}");
    println!("{message}");
    if let Some(log) = std::env::var_os("ARCFEED_SKIP_LOG") {
        use std::io::Write;
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(log).expect("the skip log opens");
        writeln!(file, "{message}").expect("the skip log takes a line");
    }
}

/// A folder of a test's own, which goes with it.
#[derive(Debug)]
pub struct Scratch(TempDir);

impl Scratch {
    /// An empty one, no other's even under the same name.
    pub fn new(name: &str) -> Self {
        let folder = tempfile::Builder::new().prefix(&format!("arcfeed-{name}-")).tempdir();
        Scratch(folder.expect("a scratch folder can be made"))
    }

    /// The path of a file in it, as an argument.
    pub fn path(&self, file: &str) -> String {
        self.0.path().join(file).to_str().expect("scratch folders are named in ASCII").to_owned()
    }

    /// Writes a file into it; answers its path.
    pub fn write(&self, file: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.path(file);
        fs::write(&path, content).expect("a scratch file can be written");
        path
    }

    /// Names of the files in it, sorted.
    pub fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).expect("a scratch folder can be read");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

/// `arcfeed` running beside a test. It never outlives the test, also not one that panics.
#[derive(Debug)]
pub struct Running {
    child: Child,
    out: PathBuf,
    err: PathBuf,
}

/// End of a process.
#[derive(Debug)]
pub struct Ended {
    /// Exit code; none if a signal ended it.
    pub code: Option<i32>,
    /// All it wrote to stdout.
    pub out: String,
    /// All it wrote to stderr.
    pub err: String,
}

impl Running {
    /// Starts `arcfeed`; what it writes goes to files named after `name`, so that no pipe can fill up.
    pub fn start(scratch: &Scratch, name: &str, arguments: &[&str]) -> Self {
        Running::start_command(scratch, name, Command::new(arcfeed()).args(arguments))
    }

    fn start_command(scratch: &Scratch, name: &str, command: &mut Command) -> Self {
        let file = |ending: &str| PathBuf::from(scratch.path(&format!("{name}.{ending}")));
        let (out, err) = (file("out"), file("err"));
        let create = |path: &Path| File::create(path).expect("a scratch file can be made");
        let child = command
            .current_dir(root())
            .stdin(Stdio::null())
            .stdout(create(&out))
            .stderr(create(&err))
            .spawn()
            .expect("it starts");
        Running { child, out, err }
    }

    /// Waits for a whole line on stdout that begins with `start`; answers the rest of it.
    pub fn line(&mut self, start: &str) -> String {
        wait_for(&format!("a line `{start}`"), || {
            let text = fs::read_to_string(&self.out).unwrap_or_default();
            let whole = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
            whole.filter_map(|line| line.strip_prefix(start)).next().map(str::to_owned)
        })
    }

    /// The number of its process.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// A figure of `/proc/PID/status`, in kB: `VmRSS` is the memory in use, `VmHWM` the most so far.
    pub fn memory_kb(&self, field: &str) -> u64 {
        let path = format!("/proc/{}/status", self.child.id());
        let status = fs::read_to_string(path).expect("it runs, on Linux");
        let line = status.lines().find_map(|line| line.strip_prefix(field)?.strip_prefix(':'));
        let number = line.and_then(|rest| rest.split_whitespace().next()).and_then(|word| word.parse().ok());
        number.unwrap_or_else(|| panic!("no {field}: {status}"))
    }

    /// Output on stderr so far.
    pub fn said(&self) -> String {
        fs::read_to_string(&self.err).unwrap_or_default()
    }

    /// Sends SIGINT, as Ctrl-C does.
    pub fn interrupt(&self) {
        let sent = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status();
        assert!(sent.expect("kill runs").success(), "nothing left to interrupt");
    }

    /// Sends SIGKILL.
    pub fn kill(&mut self) {
        self.child.kill().expect("it still runs, or has been waited for");
    }

    /// Waits for its end.
    pub fn end(mut self) -> Ended {
        wait_for("the end of arcfeed", || self.child.try_wait().expect("a child can be waited for"));
        self.end_however_late()
    }

    /// As [`Running::end`], for what may take longer than a minute.
    fn end_however_late(mut self) -> Ended {
        let status = self.child.wait().expect("a child can be waited for");
        let read = |path: &Path| fs::read_to_string(path).expect("its output is text");
        Ended { code: status.code(), out: read(&self.out), err: read(&self.err) }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _already_over = self.child.kill();
        let _reaped = self.child.wait();
    }
}

/// Program that runs a command for at most a time, and writes to a file the most memory that the command had in use. The kernel's figure is never
/// less than the memory of the process that starts the command; this one needs less than arcfeed.
const MEASURED: &str = "
import resource, subprocess, sys
file, seconds, *command = sys.argv[1:]
code = subprocess.run(command, timeout=float(seconds)).returncode
with open(file, 'w') as file:
    file.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
sys.exit(code)
";

/// Runs `arcfeed` to its end; answers also the most memory it had in use, in kB (of 1024 bytes; Linux).
///
/// # Panics
/// It takes longer than `longest`.
pub fn run_with_memory(scratch: &Scratch, name: &str, arguments: &[&str], longest: Duration) -> (Ended, u64) {
    let file = scratch.path(&format!("{name}.memory"));
    let mut python = Command::new("python3");
    python.args(["-c", MEASURED, &file, &longest.as_secs().to_string()]).arg(arcfeed()).args(arguments);
    let ended = Running::start_command(scratch, name, &mut python).end_however_late();
    let most = fs::read_to_string(&file).unwrap_or_else(|_| panic!("not measured: {}", ended.err));
    (ended, most.parse().expect("a number"))
}

/// Asks again and again until there is an answer, for a minute.
///
/// # Panics
/// There is none by then.
pub fn wait_for<T>(what: &str, mut answer: impl FnMut() -> Option<T>) -> T {
    let started = Instant::now();
    loop {
        if let Some(found) = answer() {
            return found;
        }
        assert!(started.elapsed() < WAIT_MAX, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}
