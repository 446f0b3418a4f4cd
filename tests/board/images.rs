//! Building the images of the boards.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use arcfeed_tests::root;

const TARGET: &str = "thumbv7em-none-eabihf";
const BOARDS: &str = "firmware/boards";
/// The board whose images run here.
const EMULATED: &str = "qemu-mps2";
/// What the panic handler calls and nobody defines.
const GATE: &str = "arcfeed_a_panic_can_be_reached";

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

/// Asserts that an image with a panic within reach, which a feature of its board puts there, does not link.
pub fn assert_gated(board: &str, image: &str) {
    // It fails before it could replace the image without the panic; if it does not, nothing here is worth anything.
    let output = build(board, &["--bin", image, "--features", "prove-the-gate"]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success(), "an image with a reachable panic links");
    assert!(errors.contains("undefined symbol") && errors.contains(GATE), "it fails, but not at the gate:\n{errors}");
    println!("{image}, a reachable panic: undefined symbol {GATE}");
}

#[test]
fn a_panic_that_can_be_reached_keeps_the_image_from_linking() {
    let harmless = image("feedboard");
    assert!(harmless.exists(), "{}", harmless.display());
    assert_gated(EMULATED, "feedboard");
}
