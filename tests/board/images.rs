//! Building the images.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use arcfeed_tests::root;

const TARGET: &str = "thumbv7em-none-eabihf";
const MANIFEST: &str = "firmware/boards/qemu-mps2/Cargo.toml";
/// What the panic handler calls and nobody defines.
const GATE: &str = "arcfeed_a_panic_can_be_reached";

/// Where boards are built: beside everything else that cargo builds.
fn target_dir() -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own path");
    test.ancestors().nth(3).expect("tests run from target/<profile>/deps").join("boards")
}

fn build(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO"));
    command.args(["build", "--release", "--locked", "--quiet", "--manifest-path", MANIFEST, "--target", TARGET]);
    command.arg("--target-dir").arg(target_dir()).args(arguments).current_dir(root());
    command.output().expect("cargo runs")
}

/// An image by its name; builds all of them once.
pub fn image(name: &str) -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let output = build(&["--bins"]);
        assert!(output.status.success(), "the images do not build:\n{}", String::from_utf8_lossy(&output.stderr));
        target_dir().join(TARGET).join("release")
    });
    Path::new(folder).join(name)
}

#[test]
fn a_panic_that_can_be_reached_keeps_the_image_from_linking() {
    let harmless = image("feedboard");
    assert!(harmless.exists(), "{}", harmless.display());
    // It fails before it could replace the image without the panic; if it does not, nothing here is worth anything.
    let output = build(&["--bin", "feedboard", "--features", "prove-the-gate"]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success(), "an image with a reachable panic links");
    assert!(errors.contains("undefined symbol") && errors.contains(GATE), "it fails, but not at the gate:\n{errors}");
    println!("a reachable panic: undefined symbol {GATE}");
}
