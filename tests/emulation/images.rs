//! Building the images of the boards.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use crate::root;

const TARGET: &str = "thumbv7em-none-eabihf";
/// Folder of the board whose images run here.
pub const EMULATED: &str = "firmware/boards/qemu-mps2";
/// Folder in which boards are built: beside cargo's other builds.
fn target_dir() -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own path");
    test.ancestors().nth(3).expect("tests run from target/<profile>/deps").join("boards")
}

/// Runs cargo in the folder of a board, as seen from the workspace's root.
pub fn build(folder: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO"));
    command.args(["build", "--release", "--locked", "--quiet", "--target", TARGET]).arg("--manifest-path");
    command.arg(format!("{folder}/Cargo.toml")).arg("--target-dir").arg(target_dir());
    command.args(arguments).current_dir(root()).output().expect("cargo runs")
}

/// Builds all images of a board; the folder they are in.
pub fn built(folder: &str) -> PathBuf {
    let output = build(folder, &["--bins"]);
    assert!(output.status.success(), "the images do not build:\n{}", String::from_utf8_lossy(&output.stderr));
    target_dir().join(TARGET).join("release")
}

/// An image of the emulated board by its name; builds all of them once.
pub fn image(name: &str) -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    Path::new(FOLDER.get_or_init(|| built(EMULATED))).join(name)
}
