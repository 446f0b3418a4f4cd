//! Pythons with the packages that tests need, and scripts that run in them.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;

use crate::{root, skip_loudly, wait_for};

/// Interpreters: Debian's packages belong to the second one if it is not the first.
const CANDIDATES: [&str; 2] = ["python3", "/usr/bin/python3"];

/// Place of the packages that `cargo xtask test` installs in the build directory.
const PACKAGES: &str = "tools/python";

/// A Python that can import these modules, with the packages of the build directory; `None` if there is none.
pub fn python_with(modules: &str) -> Option<Command> {
    let command = |python: &str| {
        let mut command = Command::new(python);
        // No bytecode beside the scripts.
        command.env("PYTHONPATH", packages()).env("PYTHONPYCACHEPREFIX", packages().with_file_name("python-bytecode"));
        command
    };
    let has_them = |python: &&str| {
        let import = command(python).args(["-c", &format!("import {modules}")]).stderr(Stdio::null()).status();
        import.is_ok_and(|status| status.success())
    };
    CANDIDATES.into_iter().find(has_them).map(command)
}

fn packages() -> PathBuf {
    // A test runs as <build directory>/<profile>/deps/<name>.
    let test = std::env::current_exe().expect("a test knows its own path");
    test.ancestors().nth(3).expect("tests run from the deps folder").join(PACKAGES)
}

/// A Python with pyserial, or a loud word that `test` needs one.
pub fn python_or_skip(test: &str) -> Option<&'static str> {
    static FOUND: OnceLock<Option<&'static str>> = OnceLock::new();
    let has_it = |python: &&str| {
        let import = Command::new(python).args(["-c", "import serial.rfc2217"]).stderr(Stdio::null()).status();
        import.is_ok_and(|status| status.success())
    };
    let found = *FOUND.get_or_init(|| CANDIDATES.into_iter().find(has_it));
    if found.is_none() {
        skip_loudly(test, "no Python with pyserial (`cargo xtask test` installs it)");
    }
    found
}

fn script(python: &str, name: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(python);
    command.arg(root().join("tests/line/pyserial").join(name)).args(arguments).env("PYTHONDONTWRITEBYTECODE", "1");
    command
}

/// Output of a script with this `input`.
pub fn output(python: &str, name: &str, arguments: &[&str], input: &str) -> String {
    let mut command = script(python, name, arguments);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("Python starts");
    // The scripts read all of it before or while they print less than a pipe holds.
    child.stdin.take().expect("a pipe").write_all(input.as_bytes()).expect("the script reads");
    let output = child.wait_with_output().expect("the script ends");
    assert!(output.status.success(), "{name} failed");
    String::from_utf8(output.stdout).expect("text")
}

/// A script that runs beside the test and ends with it.
pub struct Script {
    child: Child,
    out: String,
}

impl Script {
    /// Starts it; what it prints goes to the file `out`.
    pub fn start(python: &str, name: &str, arguments: &[&str], out: &str) -> Self {
        let file = std::fs::File::create(out).expect("a scratch file can be made");
        let child = script(python, name, arguments).stdin(Stdio::null()).stdout(file).spawn().expect("Python starts");
        Script { child, out: out.to_owned() }
    }

    /// Waits for a whole line that begins with `start`; answers the rest of it.
    pub fn line(&self, start: &str) -> String {
        wait_for(&format!("a line `{start}` of Python"), || {
            let text = std::fs::read_to_string(Path::new(&self.out)).unwrap_or_default();
            let whole = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
            whole.filter_map(|line| line.strip_prefix(start)).next().map(str::to_owned)
        })
    }

    /// All it has printed.
    pub fn printed(&self) -> String {
        std::fs::read_to_string(Path::new(&self.out)).unwrap_or_default()
    }
}

impl Drop for Script {
    fn drop(&mut self) {
        let _already_over = self.child.kill();
        let _reaped = self.child.wait();
    }
}
