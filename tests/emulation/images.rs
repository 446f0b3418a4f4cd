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

/// Builds the static library with the C interface, for this machine or for the chip, with these further features.
pub fn static_library(for_chip: bool, features: &str) -> PathBuf {
    let mut command = Command::new(env!("CARGO"));
    command.args(["rustc", "--package", "arcfeed-c", "--lib", "--crate-type", "staticlib", "--locked", "--quiet"]);
    command.args(["--profile", "static-library", "--features", &format!("static-library,{features}")]);
    command.args(if for_chip { &["--target", TARGET][..] } else { &[] });
    // A folder for each: without its features the library would have the same name.
    let folder = target_dir().join(if features.is_empty() { "c" } else { "c-gate" });
    let output = command.arg("--target-dir").arg(&folder).current_dir(root()).output().expect("cargo runs");
    assert!(output.status.success(), "the library does not build:\n{}", String::from_utf8_lossy(&output.stderr));
    folder.join(if for_chip { TARGET } else { "" }).join("static-library/libarcfeed_c.a")
}

/// An image of the emulated board by its name; builds all of them once.
pub fn image(name: &str) -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    Path::new(FOLDER.get_or_init(|| built(EMULATED))).join(name)
}
