//! Constants of the machine for which this image is built; they must be set, and checked on the machine, before use.

use arcfeed_firmware::input::dial::DialInput;
use arcfeed_firmware::input::encoder::Encoder;
use arcfeed_firmware::input::tacho::Tacho;
use arcfeed_units::RevPerMin;

/// Encoders of X, Y, Z: nanometres per count with all four edges counted (negative reverses the sense), and the
/// largest number of counts per tick: 600 um/ms are 36 m/min.
pub const ENCODERS: [Encoder; 3] = [axis(1_000, 600), axis(1_000, 600), axis(1_000, 600)];

/// The operator's dial on 12 bits: a track of 8 kOhm with 1 kOhm to each rail reads 410 and 3 686.
pub const DIAL: DialInput = match DialInput::new(410, 3_686, 4_095, 150) {
    Some(dial) => dial,
    None => panic!("the dial's ends make no sense"),
};

/// Pulses of the tacho per revolution of the spindle, and its range of speeds. Speeds above the maximum count as
/// noise: keep it close to the job's speed, since too high a reading raises the feed too much.
const PULSES_PER_REV: u16 = 1;
const LOWEST: RevPerMin = RevPerMin(60.0);
const HIGHEST: RevPerMin = RevPerMin(1_200.0);

/// Time that the couplers of *FV0 to *FV7 need to release, with a margin, nanoseconds.
pub const LINES_SETTLE_NS: u32 = 40_000;

/// The spindle's tacho; `None` if the speeds above are invalid.
pub fn tacho() -> Option<Tacho> {
    Tacho::new(PULSES_PER_REV, LOWEST, HIGHEST)
}

/// An encoder; invalid values do not compile.
const fn axis(nm_per_count: i32, most_counts: u16) -> Encoder {
    match Encoder::new(nm_per_count, most_counts) {
        Some(encoder) => encoder,
        None => panic!("an axis needs a scale, and a limit below 16 384 counts a tick"),
    }
}
