//! Use of the line, number of characters after DC3, and places where the line is too slow.

use arcfeed::dnc::starvation::{BlockLoad, predict};
use arcfeed::dnc::{Sender, State};
use arcfeed_control::ControlSettings;
use arcfeed_units::{LengthUnit, Micros};

use crate::dnc::line::{Line, Outcome, line_use, send};
use crate::dnc::program::{Check, control, transmission};
use crate::dnc::schedule::Schedule;

const DC1: u8 = 0x11;
const RATES: [u32; 4] = [4_800, 9_600, 19_200, 115_200];

/// Long blocks that take no time, and now and then a dwell that fills the buffer.
fn program(baudrate: u32) -> String {
    let mut text = String::from("%\nO1\nG21G90\nG0X1.\n");
    for stretch in 0..6 {
        for line in 0..60 {
            text += &format!("N{line}(STRETCH {stretch} OF BLOCKS THAT TAKE NO TIME)\n");
        }
        // As long as 2000 characters take: the buffer fills.
        text += &format!("G4P{}\n", 2_000 * 11_000 / baudrate);
    }
    text + "M30\n%\n"
}

/// Sends it over a line whose DC3 is seen `latency` after its own time of a character.
fn run(baudrate: u32, latency: Micros) -> Outcome {
    let mut settings = ControlSettings::fanuc_16i(LengthUnit::Mm);
    settings.line = control(Check::Parity, baudrate).line;
    settings.line =
        arcfeed_control::line::LineSettings { buffer: 1_024, xoff_below: 256, xon_above: 768, ..settings.line };
    let char_us = 11_000_000 / u64::from(baudrate);
    let step = Micros((char_us / 8).max(5));
    let line = Line::new(settings, step, Micros(char_us).after(latency), &Schedule::default());
    let reaction = Micros(char_us).after(latency).after(step).after(step);
    let mut sender = Sender::new(transmission(&program(baudrate), Check::Parity), line_use(&settings, reaction));
    send(line, &mut sender, |_, _| false)
}

/// The share of the bit rate used between each DC1 and the DC3 after it; what comes behind the last is not all sending.
fn used(outcome: &Outcome, baudrate: u32) -> f64 {
    let (mut time_us, mut chars) = (0, 0);
    let said = &outcome.line.said;
    for pair in said[..said.len() - 1].windows(2) {
        let [(from, said, before), (to, _, after)] = [pair[0], pair[1]];
        if said == DC1 && after - before > 400 {
            time_us += to.since(from).0;
            chars += after - before;
        }
    }
    chars as f64 * 11.0 / f64::from(baudrate) / (time_us as f64 / 1e6)
}

#[test]
fn the_line_is_full_while_the_control_accepts_and_ten_characters_are_enough() {
    for baudrate in RATES {
        let outcome = run(baudrate, Micros(0));
        assert_eq!((outcome.state, outcome.line.control.alarm()), (State::Sent, None), "{baudrate} baud");
        let counters = outcome.line.control.line_counters();
        let share = used(&outcome, baudrate);
        println!(
            "{baudrate} baud: {:.2} % of the bit rate, {} DC3, at most {} characters after one",
            share * 100.0,
            counters.xoff_count,
            counters.max_bytes_after_xoff
        );
        assert!(counters.xoff_count >= 4 && counters.max_bytes_after_xoff <= 10, "{baudrate} baud: {counters:?}");
        assert!((0.99..1.001).contains(&share), "{baudrate} baud: {share}");
    }
}

#[test]
fn a_late_reaction_costs_speed_and_never_characters() {
    for (baudrate, latency) in [(9_600, 4_000), (9_600, 16_000), (115_200, 1_000), (115_200, 16_000)] {
        let outcome = run(baudrate, Micros(latency));
        let counters = outcome.line.control.line_counters();
        println!(
            "{baudrate} baud, {latency} us late: {} characters in {} s, {} after DC3",
            counters.bytes,
            outcome.line.now.to_s(),
            counters.max_bytes_after_xoff
        );
        assert_eq!((outcome.state, outcome.line.control.alarm()), (State::Sent, None));
        assert!(counters.max_bytes_after_xoff <= 10, "{baudrate} baud, {latency} us: {counters:?}");
    }
}

/// Long blocks, then a stretch of blocks of 0.1 mm at 6000 mm/min, then long ones again: lines and times.
fn short_stretch() -> (String, Vec<BlockLoad>) {
    let mut text = String::from("%\nO1\nG21G90G94G1F6000.\n");
    let mut loads: Vec<BlockLoad> = text.lines().map(|line| BlockLoad::of_time(line.len() + 1, 0.0)).collect();
    let mut x_um = 0_u32;
    for (count, step_um) in [(20, 5_000), (200, 100), (20, 5_000)] {
        for _ in 0..count {
            x_um += step_um;
            let line = format!("X{}.{:03}(A SHORT BLOCK)\n", x_um / 1_000, x_um % 1_000);
            loads.push(BlockLoad::of_move(line.len(), f64::from(step_um) / 1e3, 100.0, 500.0));
            text += &line;
        }
    }
    loads.extend([4, 2].map(|characters| BlockLoad::of_time(characters, 0.0)));
    (text + "M30\n%\n", loads)
}

#[test]
fn starvation_is_predicted_and_found_where_predicted() {
    for baudrate in [2_400, 4_800, 38_400] {
        let (text, loads) = short_stretch();
        let settings = control(Check::Parity, baudrate);
        let chars_per_s = f64::from(baudrate) / 11.0;
        let waits = predict(&loads, chars_per_s, settings.line.buffer);
        let line = Line::new(settings, Micros::from_ms(1), Micros(0), &Schedule::default());
        let mut sender = Sender::new(transmission(&text, Check::Parity), line_use(&settings, Micros(0)));
        // Waiting places, as the number of blocks executed before.
        let (mut found, mut starved) = (Vec::new(), 0);
        let outcome = send(line, &mut sender, |line, _| {
            if line.control.starved_ms() > starved && sender_is_before_the_end(line) {
                found.push(line.control.executed().len());
            }
            starved = line.control.starved_ms();
            false
        });
        assert!(outcome.line.control.has_ended());
        let predicted_s: f64 = waits.iter().map(|wait| wait.time_s).sum();
        let found_s = starved as f64 / 1e3;
        println!("{baudrate} baud: {predicted_s:.3} s predicted {waits:?}, {found_s:.3} s found");
        assert_eq!(found.is_empty(), waits.is_empty(), "{baudrate} baud");
        if let (Some(first), Some(last)) = (found.first(), found.last()) {
            // Line index i (the label is line 0) is the block that waits when i - 1 blocks have been taken up.
            let [from, to] = [waits[0].blocks[0] - 1, waits[waits.len() - 1].blocks[1]];
            assert!(from <= *first + 1 && *last <= to + 1, "{baudrate} baud: {first} to {last} in {from} to {to}");
            assert!((found_s / predicted_s - 1.0).abs() < 0.1, "{found_s} s, predicted {predicted_s} s");
        }
    }
}

fn sender_is_before_the_end(line: &Line) -> bool {
    !line.control.has_ended()
}
