//! Building the images of the boards.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use crate::root;

const TARGET: &str = "thumbv7em-none-eabihf";
const BOARDS: &str = "firmware/boards";
/// The board whose images run here.
pub const EMULATED: &str = "qemu-mps2";
/// Where boards are built: beside everything else that cargo builds.
fn target_dir() -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own path");
    test.ancestors().nth(3).expect("tests run from target/<profile>/deps").join("boards")
}

/// Runs cargo for a board.
pub fn build(board: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO"));
    command.args(["build", "--release", "--locked", "--quiet", "--target", TARGET]).arg("--manifest-path");
    command.arg(format!("{BOARDS}/{board}/Cargo.toml")).arg("--target-dir").arg(target_dir());
    command.args(arguments).current_dir(root()).output().expect("cargo runs")
}

/// All images of a board: the folder they are in.
pub fn built(board: &str) -> PathBuf {
    let output = build(board, &["--bins"]);
    assert!(output.status.success(), "the images do not build:\n{}", String::from_utf8_lossy(&output.stderr));
    target_dir().join(TARGET).join("release")
}

/// An image of the emulated board by its name; builds all of them once.
pub fn image(name: &str) -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    Path::new(FOLDER.get_or_init(|| built(EMULATED))).join(name)
}
