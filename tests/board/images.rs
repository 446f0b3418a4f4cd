//! An image with a reachable panic does not link.

use arcfeed_tests::emulation::images::{EMULATED, build, image};

/// Undefined function that the panic handler calls.
const GATE: &str = "arcfeed_a_panic_can_be_reached";

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
