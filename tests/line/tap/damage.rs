//! Characters that are corrupted on their way: no law acts on a move that it is not for without being noticed.
//!
//! Held against an oracle that does not know the tap: the program as the tap heard it, read line by line, and the nearest of
//! two thousand places on each of its moves.

use arcfeed_board_app::tap::settings::TapSettings;
use arcfeed_board_app::tap::status::{TapLossReason, TapState};
use arcfeed_control::code::TapeCode;
use arcfeed_units::Nm;
use fastrand::Rng;

use crate::tap::bench::{Bench, Ended, control, encoded, example, moves};

/// Arcs about points on a ring, which must close; an end mill's contour with its lines, which need not.
const JOBS: [&str; 2] = ["examples/ibr-slot/job.toml", "examples/pocket/job-contour.toml"];
/// Runs of each kind.
const RUNS: u64 = 40;
/// Positions in a row that may lie off the path before the tap gives up: its setting.
const OFF_PATH_COUNT: u32 = 5;

/// Damage at one place of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Damage {
    Flip,
    Drop,
    Repeat,
    Swap,
    Burst,
    Truncate,
}

const ALL: [Damage; 6] = [Damage::Flip, Damage::Drop, Damage::Repeat, Damage::Swap, Damage::Burst, Damage::Truncate];

fn corrupt(frames: &mut Vec<u8>, damage: Damage, rng: &mut Rng) {
    // Behind the label: without one there is no program.
    let at = rng.usize(4..frames.len() - 4);
    match damage {
        Damage::Flip => frames[at] ^= 1 << rng.u8(..8),
        Damage::Drop => drop(frames.remove(at)),
        Damage::Repeat => frames.insert(at, frames[at]),
        Damage::Swap => frames.swap(at, at + 1),
        Damage::Burst => frames[at..at + 4].iter_mut().for_each(|frame| *frame = rng.u8(..)),
        Damage::Truncate => frames.truncate(at),
    }
}

/// A stream that is corrupted before the tap (true) or between the tap and the control.
fn run(code: TapeCode, damage: Damage, seed: u64, before: bool) -> Ended {
    let (file, text) = example(JOBS[seed as usize / ALL.len() % JOBS.len()]);
    let mut rng = Rng::with_seed(seed);
    let mut corrupted = encoded(&text, code);
    corrupt(&mut corrupted, damage, &mut rng);
    let heard = if before { corrupted.clone() } else { encoded(&text, code) };
    let settings = TapSettings { code: Some(code), ..TapSettings::new(file.job.unit) };
    let mut bench = Bench::new(control(&file, Some(code)), settings, &file.job, heard.clone());
    bench.simulation.source_mut().heard = moves(&decoded(&heard, code), file.job.unit);
    if !before {
        let mut rest = corrupted.into_iter();
        let last = heard.len() - 1;
        // As many characters in as out, and at the end what is left.
        bench.between = Box::new(
            move |index, _| {
                if index == last { rest.by_ref().collect() } else { rest.by_ref().take(1).collect() }
            },
        );
    }
    let ended = bench.run();
    let alarm = bench.simulation.control().alarm();
    println!("{damage:?} {code:?} {seed} before {before}: {:?} {:?} alarm {alarm:?}", ended.state, ended.figures);
    ended
}

fn decoded(frames: &[u8], code: TapeCode) -> Vec<u8> {
    use arcfeed_control::code::Symbol;
    let byte = |frame: &u8| match code.decode(*frame) {
        Ok(Symbol::Character(byte)) => Some(byte),
        Ok(Symbol::EndOfBlock) => Some(b'\n'),
        Ok(Symbol::Ignored) => None,
        // The reference reading also ends at an unreadable character.
        Err(_) => Some(b'!'),
    };
    frames.iter().filter_map(byte).collect()
}

#[test]
fn tap_reads_a_corrupted_stream_like_the_control() {
    for code in [TapeCode::Iso, TapeCode::Ascii] {
        for seed in 0..RUNS {
            let ended = run(code, ALL[seed as usize % ALL.len()], seed, true);
            assert!(ended.figures.off_path_in_row <= OFF_PATH_COUNT, "{ended:?}");
        }
    }
}

#[test]
fn corruption_behind_the_tap_is_detected_when_the_axes_leave_the_path() {
    let mut found_out = 0;
    for code in [TapeCode::Iso, TapeCode::Ascii] {
        for seed in 0..RUNS {
            let ended = run(code, ALL[seed as usize % ALL.len()], seed, false);
            assert!(ended.figures.off_path_in_row <= OFF_PATH_COUNT, "{ended:?}");
            found_out += u32::from(ended.state == TapState::Lost(TapLossReason::OffPath));
        }
    }
    println!("off its path in {found_out} of {} runs", 2 * RUNS);
    assert!(found_out > 0);
}

/// The pocket, of which the control gets something else in one place, all of it sound.
fn another(written: &str, executed: &str, off_path: Nm) -> Ended {
    let (file, text) = example(JOBS[1]);
    let text = String::from_utf8(text).expect("the example is text");
    let other = text.replacen(written, executed, 1);
    assert!(other != text && other.len() == text.len(), "{written} is in it");
    let settings = TapSettings { code: Some(TapeCode::Ascii), off_path, ..TapSettings::new(file.job.unit) };
    let frames = text.clone().into_bytes();
    let mut bench = Bench::new(control(&file, settings.code), settings, &file.job, frames);
    bench.simulation.source_mut().heard = moves(text.as_bytes(), file.job.unit);
    let other = other.into_bytes();
    bench.between = Box::new(move |index, _| vec![other[index]]);
    let ended = bench.run();
    println!(
        "{written:?} {executed:?}: {:?} {:?} {:?}",
        ended.state,
        ended.figures,
        bench.simulation.control().alarm()
    );
    ended
}

/// Sound pieces of program that lead elsewhere.
const ELSEWHERE: [[&str; 2]; 5] = [
    ["N140G3", "N140G2"],
    ["X45.Y-17.I.0J3.", "X44.Y-18.I.0J2."],
    ["N310G2", "N310G3"],
    ["N160G3X42.Y30.I-3.J.0", "N160G1X42.Y28.F3000.0"],
    ["N120G1Z-5.", "N120G1Z-3."],
];

#[test]
fn another_path_than_the_one_that_was_read_is_noticed_within_the_count() {
    for [written, executed] in ELSEWHERE {
        let ended = another(written, executed, Nm(500_000));
        assert_eq!(ended.state, TapState::Lost(TapLossReason::OffPath), "{written}");
        assert!(ended.figures.off_path_in_row <= OFF_PATH_COUNT, "{ended:?}");
    }
}

#[test]
fn without_the_watch_a_law_would_act_where_it_has_no_business() {
    let acts = |[written, executed]: &[&str; 2]| {
        another(written, executed, Nm(i64::MAX)).figures.off_path_in_row > 10 * OFF_PATH_COUNT
    };
    assert!(ELSEWHERE.iter().filter(|places| acts(places)).count() >= 3);
}
