//! A board decides in place of the controller notified of each block: in process, and on the emulated chip.

use arcfeed_link::message::Message;
use arcfeed_tests::emulation::host::Host;
use arcfeed_tests::emulation::images::image;
use arcfeed_tests::emulation::log::messages;
use arcfeed_tests::emulation::qemu::{Clock, Emulator};

use crate::runs::{Example, chip_range};

/// Ticks from one line with figures to the next, in the image.
const FIGURES_EVERY: usize = 1_000;

#[test]
fn the_chip_decides_bit_for_bit_what_the_application_in_process_does() {
    let example = Example::load();
    let (chip, chips_host, board) = example.by_board(Emulator::start("feedboard", Clock::Lockstep));
    let console = board.console();
    let (in_process, host) = example.by_application(logged(&console));
    println!(
        "{} periods, trace {:08x} on the chip, {:08x} in process",
        chip.overrides.len(),
        chip.hash(),
        in_process.hash()
    );
    let differs = chip.overrides.iter().zip(&in_process.overrides).position(|(chip, in_process)| chip != in_process);
    assert_eq!(differs, None, "first period with another override");
    assert_eq!(chip.overrides.len(), in_process.overrides.len());
    assert_eq!(chip.chips, in_process.chips, "the meter saw the same chips");
    // Not only the overrides: every byte of the link.
    assert_eq!(chips_host.bytes(), host.bytes());
    assert_eq!(chips_host.report, host.report);
    assert_log_came(&chips_host, &console);
}

/// Frames that the image logs, with the number of ticks before each: its start, then its figures.
fn logged(console: &[u8]) -> Vec<(u32, Vec<u8>)> {
    let mut frames: Vec<Vec<u8>> = Vec::new();
    for part in console.split_inclusive(|byte| *byte == 0) {
        match frames.last_mut() {
            // The delimiter before the first one.
            Some(delimiter) if delimiter == &[0] => delimiter.extend(part),
            _ => frames.push(part.to_vec()),
        }
    }
    (0..).step_by(FIGURES_EVERY).zip(frames).collect()
}

/// The log that came over the link, decoded with the image, is that of the console as far as the link was up.
fn assert_log_came(host: &Host, console: &[u8]) {
    let parts = host.heard.iter().filter_map(|message| match message {
        Message::Log(log) => Some(log.bytes.bytes()),
        _ => None,
    });
    let log: Vec<u8> = parts.flatten().copied().collect();
    let image = std::fs::read(image("feedboard")).expect("the image is there");
    let (over_link, at_console) = (messages(&image, &log), messages(&image, console));
    println!("{} of {} messages over the link: {:?}", over_link.len(), at_console.len(), over_link.last());
    assert_eq!(over_link, at_console[..over_link.len()]);
    assert!(over_link.len() + 1 >= at_console.len(), "but for the last, all of them");
    assert!(over_link.len() > 50 && over_link[0].contains("feedboard: start 1"), "{:?}", over_link.first());
}

#[test]
fn the_application_that_follows_the_position_cuts_the_chips_of_a_controller_notified_of_each_block() {
    let example = Example::load();
    let (controller, (in_process, host)) = (example.by_controller(), example.by_application(Vec::new()));
    let differing = controller
        .overrides
        .iter()
        .zip(&in_process.overrides)
        .filter(|(controller, in_process)| controller != in_process);
    let furthest =
        differing.clone().map(|(controller, in_process)| controller.abs_diff(*in_process)).max().unwrap_or(0);
    let (controller_range, range) = (chip_range(&controller.chips), chip_range(&in_process.chips));
    let stretches = stretches(&controller.overrides, &in_process.overrides);
    println!("{} of {} overrides differ, by {furthest} points at most", differing.count(), controller.overrides.len());
    println!("in {} stretches of periods: {stretches:?}", stretches.len());
    println!("chip over target: notified {controller_range:.5?}, by position {range:.5?}");
    assert!(stretches.iter().all(|[first, last]| last - first < 2), "where moves begin, for a tick or two");
    assert!(stretches.len() <= controller.chips.len(), "no more often than moves begin");
    assert!(host.is_through() && host.link().counters().retransmissions == 0);
    assert_eq!(controller.chips.len(), in_process.chips.len());
    assert!(
        controller_range.iter().zip(range).all(|(controller, by_position)| (controller - by_position).abs() < 0.01)
    );
}

/// First and last period of each stretch in which two traces differ.
fn stretches(one: &[u8], other: &[u8]) -> Vec<[usize; 2]> {
    let mut stretches: Vec<[usize; 2]> = Vec::new();
    for period in
        one.iter().zip(other).enumerate().filter_map(|(period, (one, other))| (one != other).then_some(period))
    {
        match stretches.last_mut() {
            Some([_, last]) if *last + 1 == period => *last = period,
            _ => stretches.push([period, period]),
        }
    }
    stretches
}
