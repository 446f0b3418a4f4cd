//! Whatever is fed to what reads: no panic, no hang, spans that lie in their line.
//!
//! Inputs are mutations of the programs in this repository and of a dictionary, from a seed that is printed. Here each
//! target has a fixed number of them; `cargo xtask soak` runs for the given time.

mod macros;

mod written_back;

mod mutate;

mod targets;

mod dnc;

mod wire;

mod tap;

use std::sync::mpsc;
use std::time::{Duration, Instant};

use mutate::Mutator;

/// Inputs of a target that reads, and of one in which a control runs, unless more are requested.
const SMOKE: u32 = 100_000;
const SMOKE_OF_CONTROLS: u32 = 1_000;
/// Seconds per target, set by `cargo xtask soak`.
const SOAK: &str = "ARCFEED_SOAK_SECONDS";
/// No input takes a thousandth of this.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Feeds a target until its time is over; what hangs is reported with its seed and count.
fn feed(name: &str, seed: u64, smoke: u32, target: fn(&[u8], u64)) {
    let soak = std::env::var(SOAK).ok().map(|seconds| {
        Duration::from_secs(seconds.parse().unwrap_or_else(|_| panic!("{SOAK}={seconds}: not a number of seconds")))
    });
    let seed = if soak.is_some() { seed ^ u64::from(std::process::id()) } else { seed };
    println!("{name}: seed {seed}");
    let (done, progress) = mpsc::channel();
    let worker = std::thread::spawn(move || {
        let (started, mut mutator, mut count) = (Instant::now(), Mutator::new(seed), 0);
        while soak.map_or(count < smoke, |time| started.elapsed() < time) {
            let input = mutator.next();
            target(&input, seed.wrapping_add(u64::from(count)));
            count += 1;
            if done.send(count).is_err() {
                break;
            }
        }
        count
    });
    let mut last = 0;
    loop {
        match progress.recv_timeout(TIMEOUT) {
            Ok(count) => last = count,
            Err(mpsc::RecvTimeoutError::Disconnected) => break,
            Err(mpsc::RecvTimeoutError::Timeout) => panic!("{name}: input {last} of seed {seed} hangs"),
        }
    }
    let count = worker.join().unwrap_or_else(|_| panic!("{name}: input {last} of seed {seed} panics"));
    println!("{name}: {count} inputs");
    assert!(count > 0);
}

#[test]
fn the_lexer_takes_whatever_comes() {
    feed("lexer", 1, SMOKE, targets::lexer);
}

#[test]
fn blocks_are_read_or_refused() {
    feed("blocks", 2, SMOKE, targets::blocks);
}

#[test]
fn whole_programs_are_understood_or_refused() {
    feed("program", 3, SMOKE, targets::program);
}

#[test]
fn the_controls_port_takes_whatever_bytes_at_whatever_time() {
    feed("port", 4, SMOKE / 4, targets::port);
}

#[test]
fn job_files_are_read_or_refused() {
    feed("job", 5, SMOKE, targets::job);
}

#[test]
fn port_urls_are_read_or_refused() {
    feed("url", 6, SMOKE, targets::url);
}

#[test]
fn both_ends_of_rfc2217_take_whatever_the_other_says() {
    feed("rfc2217", 7, SMOKE, targets::rfc2217);
}

#[test]
fn macro_programs_end_within_their_bounds() {
    feed("macros", 8, SMOKE / 10, macros::interpreter);
}

#[test]
fn feeds_are_written_back_into_macro_programs_or_refused() {
    feed("written-back", 21, SMOKE / 10, written_back::written_back);
}

#[test]
fn the_control_runs_or_refuses_macro_programs() {
    feed("memory", 9, SMOKE_OF_CONTROLS, macros::memory);
}

#[test]
fn the_line_takes_whatever_bytes_under_whatever_settings() {
    feed("line", 10, SMOKE / 4, targets::line);
}

#[test]
fn the_control_takes_macro_programs_over_its_line() {
    feed("dnc", 11, SMOKE_OF_CONTROLS, macros::over_the_line);
}

#[test]
fn the_sender_takes_whatever_a_control_says() {
    feed("sender", 12, SMOKE / 4, dnc::sender);
}

#[test]
fn a_journal_is_read_or_refused() {
    feed("journal", 13, SMOKE, dnc::journal);
}

#[test]
fn both_ends_of_the_board_link_survive_corrupted_frames() {
    feed("wire", 14, SMOKE / 10, wire::link);
}

#[test]
fn the_tap_takes_whatever_goes_over_its_line() {
    feed("tap", 15, SMOKE / 4, tap::tap);
}
