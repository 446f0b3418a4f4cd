//! The line behind the tap is the line before it, in both directions.

use arcfeed_board_app::tap::Tap;
use arcfeed_board_app::tap::settings::TapSettings;
use arcfeed_control::code::{DC1, DC3, TapeCode};
use arcfeed_tests::root;
use arcfeed_units::{LengthUnit, Micros};
use fastrand::Rng;

use crate::tap::bench::{Bench, control, encoded, example};

/// Characters of noise in each direction.
const NOISE: u32 = 200_000;

#[test]
fn the_program_arrives_as_it_was_sent_in_each_code() {
    let (file, text) = example("examples/ibr-slot/job.toml");
    for code in [TapeCode::Iso, TapeCode::Eia, TapeCode::Ascii] {
        let frames = encoded(&text, code);
        let settings =
            TapSettings { code: (code == TapeCode::Ascii).then_some(code), ..TapSettings::new(file.job.unit) };
        let mut bench = Bench::new(control(&file, settings.code), settings, &file.job, frames.clone());
        let ended = bench.run();
        let executed = bench.simulation.control().executed();
        let wanted: Vec<&[u8]> = text.split(|byte| *byte == b'\n').collect();
        assert!(bench.simulation.control().has_ended(), "{code:?}: {:?}", bench.simulation.control().alarm());
        // The label and the mark behind the program are no blocks.
        for (block, line) in executed.iter().zip(&wanted[1..]) {
            assert_eq!(block, line, "{code:?}");
        }
        assert!(executed.len() > 40 && ended.counters.from_sender as usize <= frames.len());
        assert_eq!((ended.counters.governed, ended.counters.losses), (20, 0), "{code:?}");
    }
}

#[test]
fn whatever_goes_over_the_line_passes_unchanged() {
    let mut rng = Rng::with_seed(7);
    for code in [None, Some(TapeCode::Iso), Some(TapeCode::Eia), Some(TapeCode::Ascii)] {
        let mut tap = Tap::<1_024>::new(TapSettings { code, ..TapSettings::new(LengthUnit::Mm) }).expect("sound");
        let mut now = Micros(0);
        for _ in 0..NOISE {
            now = now.after(Micros(rng.u64(..2_000_000)));
            let (sent, answered) = (rng.u8(..), rng.u8(..));
            assert_eq!((tap.from_sender(now, sent), tap.from_control(now, answered)), (sent, answered));
        }
        assert_eq!((tap.counters().from_sender, tap.counters().from_control), (NOISE, NOISE));
    }
}

#[test]
fn flow_control_passes_at_once_also_in_the_middle_of_a_block() {
    let text = std::fs::read(root().join("examples/ibr-slot/ibr-slot.nc")).expect("the example is there");
    let mut tap = Tap::<4_096>::new(TapSettings::new(LengthUnit::Inch)).expect("sound");
    let mut passed = Vec::new();
    for (index, byte) in text.iter().enumerate() {
        passed.push(tap.from_sender(Micros(index as u64), *byte));
        for code in [DC1, DC3, DC3 | 0x80] {
            assert_eq!(tap.from_control(Micros(index as u64), code), code);
        }
    }
    assert_eq!(passed, text);
    assert_eq!(tap.counters().stops as usize, 2 * text.len());
}
