//! Other practice of shops: offsets and cycles, a restarted program, switches, a tap with little room.

use arcfeed_board_app::tap::settings::TapSettings;
use arcfeed_board_app::tap::status::{TapLossReason, TapState};
use arcfeed_control::code::TapeCode;
use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_units::Micros;

use crate::tap::bench::{Bench, control, encoded, example};
use crate::tap::machining::in_process;

const SLOT: &str = "examples/ibr-slot/job.toml";
const SHOP: &str = "tests/cases/shop-program/job.toml";

fn bench(job: &str, edit: impl Fn(String) -> String) -> Bench {
    let (file, text) = example(job);
    let text = edit(String::from_utf8(text).expect("the program is text"));
    let settings = TapSettings::new(file.job.unit);
    Bench::new(control(&file, None), settings, &file.job, encoded(text.as_bytes(), TapeCode::Iso))
}

#[test]
fn offsets_cycles_and_reference_points_are_passed_over_and_the_bore_has_its_law() {
    let mut bench = bench(SHOP, |text| text);
    let ended = bench.run();
    println!("{ended:?}");
    assert!(bench.simulation.control().has_ended(), "{:?}", bench.simulation.control().alarm());
    assert_eq!((ended.counters.losses, ended.state), (0, TapState::Listening));
    assert_eq!(ended.counters.governed, 1, "the bore");
    let percents: Vec<(u8, u8)> =
        bench.simulation.overrides().iter().map(|figures| (figures.min_percent, figures.max_percent)).collect();
    assert_eq!(percents, in_process(SHOP).1);
    assert!(ended.figures.governed > 1_000, "{:?}", ended.figures);
}

#[test]
fn behind_the_holes_a_second_bore_has_its_law_too() {
    // Behind cycles, G68, another tool and a second work offset: once more to the bore's level, on a length that is not G54's.
    let again = "T1M6\nS8000M3\nG0X20.Y0\nZ-5.\nG3I-20.F1500.\nG80G28Z5.";
    let mut bench = bench(SHOP, |text| text.replacen("N210G80G28Z5.", &format!("G80\n{again}"), 1));
    let ended = bench.run();
    println!("{ended:?}");
    assert!(bench.simulation.control().has_ended(), "{:?}", bench.simulation.control().alarm());
    assert_eq!((ended.counters.losses, ended.counters.governed), (0, 2));
    let figures = bench.simulation.overrides();
    assert_eq!((figures.len(), figures[0].min_percent), (2, figures[1].min_percent));
}

#[test]
fn a_program_that_is_reset_and_started_again_is_adapted_again() {
    let (file, text) = example(SLOT);
    let frames = encoded(&text, TapeCode::Iso);
    for reset_ms in [700, 5_000, 20_000, 45_000] {
        let mut bench = bench(SLOT, |text| text);
        while bench.simulation.now() < Micros::from_ms(reset_ms) {
            bench.step();
        }
        bench.simulation.control_mut().reset();
        while !bench.simulation.control().is_at_rest() {
            bench.step();
        }
        // A person looks what is the matter; then both start again.
        for _ in 0..3_000 {
            bench.step();
        }
        bench.sender.start_with(frames.clone());
        let before = bench.simulation.meter().moves().len();
        bench.simulation.control_mut().cycle_start();
        let ended = bench.run();
        println!("{reset_ms}: {ended:?} {:?}", bench.simulation.control().alarm());
        assert!(bench.simulation.control().has_ended(), "{reset_ms}");
        assert_eq!((ended.counters.programs, ended.counters.restarts, ended.counters.losses), (2, 1, 0), "{reset_ms}");
        assert_eq!(ended.figures.off_path_in_row, 0);
        let again: Vec<&MoveChips> = bench.simulation.meter().moves()[before..].iter().collect();
        assert_eq!(again.len(), 20);
        // Thin are only the arcs' ends.
        let (samples, thin) = again.iter().fold((0, 0), |(samples, thin), chips| {
            assert!(chips.any_contact.max_ratio < 1.005, "{reset_ms}: {chips:?}");
            (samples + chips.contact.samples, thin + chips.contact.thin)
        });
        assert!(100 * thin < 6 * samples, "{reset_ms}: {thin} of {samples}");
    }
    assert_eq!(file.job.rules.len(), 4);
}

#[test]
fn blocks_that_the_controls_switch_deletes_are_deleted_here_if_the_setting_says_so() {
    let (file, text) = example(SLOT);
    let text = String::from_utf8(text).expect("the program is text");
    // A block that leads away from the path.
    let text = text.replacen("N146", "/G1X10.Y10.F100.\nN146", 1);
    let mut settings = TapSettings::new(file.job.unit);
    for (switch, is_lost) in [(1 << 1, false), (0, true)] {
        settings.nc.delete_switches = switch;
        let mut control = control(&file, None);
        control.switches.block_delete = 1;
        let mut bench = Bench::new(control, settings, &file.job, encoded(text.as_bytes(), TapeCode::Iso));
        let ended = bench.run();
        assert!(bench.simulation.control().has_ended());
        assert_eq!(ended.counters.losses > 0, is_lost, "{ended:?}");
        assert_eq!(ended.counters.governed < 20, is_lost, "{ended:?}");
    }
}

#[test]
fn sender_too_far_ahead_is_reported_and_the_rest_runs_unadapted() {
    // The control's buffer is 1024 characters and 15 blocks; this tap has room for 300.
    let (file, text) = example(SLOT);
    let settings = TapSettings::new(file.job.unit);
    let frames = encoded(&text, TapeCode::Iso);
    let mut bench = Bench::<300>::with_room(control(&file, None), settings, &file.job, frames);
    let ended = bench.run();
    assert!(bench.simulation.control().has_ended());
    assert_eq!(ended.state, TapState::Lost(TapLossReason::TooFarAhead));
    assert!((1..20).contains(&ended.counters.governed), "{ended:?}");
    assert_eq!(ended.figures.off_path_in_row, 0);
}
