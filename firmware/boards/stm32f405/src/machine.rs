//! The one machine this image is built for: to be set, and checked on the machine, before anything else.

use arcfeed_firmware::input::dial::DialInput;
use arcfeed_firmware::input::encoder::Encoder;
use arcfeed_firmware::input::tacho::Tacho;
use arcfeed_shared::units::RevPerMin;

/// X, Y, Z: nanometres a count, all four edges counted, negative for the other sense; and the most counts in a tick: 600 um/ms
/// are 36 m/min.
pub const ENCODERS: [Encoder; 3] = [axis(1_000, 600), axis(1_000, 600), axis(1_000, 600)];

/// The operator's dial on 12 bits: 1 kOhm to either rail from a track of 8 kOhm would read 410 and 3 686.
pub const DIAL: DialInput = match DialInput::new(410, 3_686, 4_095, 150) {
    Some(dial) => dial,
    None => panic!("the dial's ends make no sense"),
};

/// Pulses of the tacho in a revolution of the spindle, and the speeds it works at. Above the highest is noise: keep it
/// close to what the job uses, as a speed read too high feeds too much.
const PULSES_PER_REV: u16 = 1;
const LOWEST: RevPerMin = RevPerMin(60.0);
const HIGHEST: RevPerMin = RevPerMin(1_200.0);

/// What the couplers of *FV0 to *FV7 take to let go, nanoseconds, with something to spare.
pub const LINES_SETTLE_NS: u32 = 40_000;

/// The spindle's tacho; `None` if the speeds above make no sense.
pub fn tacho() -> Option<Tacho> {
    Tacho::new(PULSES_PER_REV, LOWEST, HIGHEST)
}

/// Refuses to compile what makes no sense.
const fn axis(nm_per_count: i32, most_counts: u16) -> Encoder {
    match Encoder::new(nm_per_count, most_counts) {
        Some(encoder) => encoder,
        None => panic!("an axis needs a scale, and a limit below 16 384 counts a tick"),
    }
}
