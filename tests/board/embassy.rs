//! The example firmware with embassy, on the emulated board: arms, and puts out the override of the contour law.

use std::sync::OnceLock;

use arcfeed_tests::emulation::images::built;
use arcfeed_tests::emulation::qemu;

const FOLDER: &str = "examples/embassy";
const IMAGE: &str = "arcfeed-embassy-example";
/// Radii of the example's tool and of the path of its centre, mm.
const TOOL_MM: f64 = 5.0;
const PATH_MM: f64 = 20.0;

fn console() -> &'static str {
    static CONSOLE: OnceLock<String> = OnceLock::new();
    CONSOLE.get_or_init(|| qemu::run_image(IMAGE, &built(FOLDER).join(IMAGE)).text())
}

/// The overrides that the example printed, each change of them, %.
fn overrides() -> Vec<u8> {
    let percent = |line: &str| line.strip_prefix("override ")?.strip_suffix(" %")?.parse().ok();
    console().lines().filter_map(percent).collect()
}

/// docs/laws.md#contour: the contour keeps its feed where the centre moves at q/(q - r) of it outside, q/(q + r) inside.
#[test]
fn the_example_arms_and_puts_out_the_feed_of_both_contours() {
    assert_eq!(console().lines().next(), Some("armed"));
    assert_eq!(console().lines().last(), Some("program end"));
    let overrides = overrides();
    let [outside, inside] = [PATH_MM / (PATH_MM - TOOL_MM), PATH_MM / (PATH_MM + TOOL_MM)].map(|ratio| ratio * 100.0);
    assert_eq!(overrides.iter().max(), Some(&(outside.floor() as u8)));
    assert_eq!(overrides.last(), Some(&(inside.floor() as u8)));
}

/// Up on the boss and down to what the bore can begin with; no step above 1 % but the fall at the block's boundary.
#[test]
fn the_override_rises_and_falls_by_the_slew() {
    let overrides = overrides();
    let boundary = overrides.len() - 1;
    let steps = overrides.windows(2).map(|pair| i16::from(pair[1]) - i16::from(pair[0]));
    let steps: Vec<i16> = steps.collect();
    assert!(steps[..boundary - 1].iter().all(|step| step.abs() == 1), "{overrides:?}");
    assert_eq!(overrides[boundary - 1], 100, "the last override before the bore");
}
