//! Building the images of the boards.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, OnceLock};

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

/// The static library with the C interface, for this machine or for the chip, with these further features; builds each
/// of them once.
pub fn static_library(for_chip: bool, features: &'static str) -> PathBuf {
    static BUILT: Mutex<BTreeMap<(bool, &str), PathBuf>> = Mutex::new(BTreeMap::new());
    let mut built = BUILT.lock().expect("no build has failed");
    built.entry((for_chip, features)).or_insert_with(|| build_library(for_chip, features)).clone()
}

fn build_library(for_chip: bool, features: &str) -> PathBuf {
    let mut command = Command::new(env!("CARGO"));
    command.args(["rustc", "--package", "arcfeed-c", "--lib", "--crate-type", "staticlib", "--locked", "--quiet"]);
    command.args(["--profile", "static-library", "--features", &format!("static-library,{features}")]);
    command.args(if for_chip { &["--target", TARGET][..] } else { &[] });
    let folder = target_dir().join("c");
    let output = command.arg("--target-dir").arg(&folder).current_dir(root()).output().expect("cargo runs");
    assert!(output.status.success(), "the library does not build:\n{}", String::from_utf8_lossy(&output.stderr));
    let library = folder.join(if for_chip { TARGET } else { "" }).join("static-library/libarcfeed_c.a");
    // The next one, with other features, has the same name.
    let kept = library.with_file_name(format!("libarcfeed_c-{features}.a"));
    std::fs::copy(&library, &kept).expect("cargo has built it");
    kept
}

/// An image of the emulated board by its name; builds all of them once.
pub fn image(name: &str) -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    Path::new(FOLDER.get_or_init(|| built(EMULATED))).join(name)
}
