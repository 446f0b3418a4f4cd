//! What several test files need. The promises themselves are the `[[test]]` targets beside this file.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// The root of the workspace.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie in a folder of the workspace")
}

/// The program under test, built as these tests are.
pub fn arcfeed() -> &'static Path {
    static BINARY: OnceLock<PathBuf> = OnceLock::new();
    BINARY.get_or_init(|| {
        let built = Command::new(env!("CARGO"))
            .args(["build", "--quiet", "--package", "arcfeed", "--bin", "arcfeed"])
            .current_dir(root())
            .status()
            .expect("cargo runs");
        assert!(built.success(), "arcfeed does not build");
        // This test runs as target/<profile>/deps/<name>; the program lies one folder up.
        let test = std::env::current_exe().expect("a test knows its own path");
        let folder = test.ancestors().nth(2).expect("tests run from the deps folder");
        folder.join(format!("arcfeed{}", std::env::consts::EXE_SUFFIX))
    })
}

/// Runs `arcfeed` with these arguments in the root of the workspace.
pub fn run(arguments: &[&str]) -> Output {
    Command::new(arcfeed()).args(arguments).current_dir(root()).output().expect("arcfeed runs")
}

/// A file that lies beside the project on some machines only. A test without it says so, and loudly: on its own output
/// and in the log that `cargo xtask test` prints at its end.
pub fn shared_or_skip(file: &str, test: &str) -> Option<PathBuf> {
    let path = root().parent()?.join("shared").join(file);
    if path.exists() {
        return Some(path);
    }
    let message = format!("SKIPPED (loudly): {test}: there is no {file} in the shared folder beside the project");
    println!("{message}");
    if let Some(log) = std::env::var_os("ARCFEED_SKIP_LOG") {
        use std::io::Write;
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(log).expect("the skip log opens");
        writeln!(file, "{message}").expect("the skip log takes a line");
    }
    None
}
