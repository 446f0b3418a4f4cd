//! The tapped line of a board that runs free: its receivers' handlers pass every character on, whatever the main loop does, and what
//! the main loop missed ends the adaptation.

use std::fs;
use std::time::{Duration, Instant};

use arcfeed_hil_sim::decider::board::{Wire, Wires};
use arcfeed_shared::units::Micros;
use arcfeed_shared::wire::frame::ENCODED_MAX;
use arcfeed_shared::wire::message::Message;
use arcfeed_shared::wire::message::codes::ModeCode;
use arcfeed_shared::wire::message::fixed::Q40;
use arcfeed_shared::wire::message::table::Sample;
use arcfeed_shared::wire::plain::PlainLine;
use arcfeed_tests::emulation::images::image;
use arcfeed_tests::emulation::log::messages;
use arcfeed_tests::emulation::qemu::Emulator;

use crate::runs::Example;
use crate::tapped::{chip_with_page, page_of};

/// The tapped board that obeys orders, and the order to hold the main loop up until the tapped line has lost a character.
const IMAGE: &str = "feedboard-hang";
const HOLD_UP: u8 = b'l';
/// Instructions from a receiver's interrupt to its character in the other transmitter, just above what is needed, where no tick comes
/// in between. docs/tap.md.
const PASSED_IN_MAX: u32 = 130;
/// Characters sent at a time: fewer than a ring holds.
const PART: usize = 256;
/// More than a ring holds.
const FLOOD: usize = 6_000;
/// A machine with much else to do may lose a board to its watchdog, not every time.
const ATTEMPTS: u32 = 10;
const PATIENCE: Duration = Duration::from_secs(120);

/// A board that runs free, and both ends of its tapped line.
struct Tapped {
    board: Emulator,
    line: PlainLine,
}

impl Tapped {
    fn start() -> Self {
        let mut tapped = Tapped { board: chip_with_page(IMAGE, &page_of(&Example::load())), line: PlainLine::new() };
        tapped.show();
        while tapped.log().is_empty() {
            std::thread::sleep(Duration::from_millis(50));
        }
        tapped
    }

    /// Shows a position: the first word, and what makes the tap read on.
    fn show(&mut self) {
        let sample = Sample {
            at: 0,
            mode: ModeCode::Free,
            linear: Some([0; 3]),
            rotary: None,
            spindle: Q40::of(1_000.0_f32).expect("a speed"),
            operator_percent: 100,
            signals: 0,
            link_bytes: 0,
            tap_bytes: 0,
        };
        let mut frame = [0; ENCODED_MAX];
        let length = self.line.encode(Micros(0), &Message::Sample(sample), &mut frame);
        self.board.put(Wire::Machine, &frame[..length]).expect("the machine line is open");
    }

    /// Lets the machine line run, and takes what has come at one end of the tapped line.
    fn take(&mut self, wire: Wire, into: &mut Vec<u8>) -> usize {
        let mut bytes = [0; 512];
        while self.board.take_waiting(Wire::Machine, &mut bytes).expect("the machine line is open") > 0 {}
        let length = self.board.take_waiting(wire, &mut bytes).expect("the tapped line is open");
        into.extend(&bytes[..length]);
        length
    }

    /// Sends at one end; what came at the other. `None` if that stops before all of it came.
    fn pass(&mut self, text: &[u8], [from, to]: [Wire; 2]) -> Option<Vec<u8>> {
        let mut passed = Vec::new();
        for part in text.chunks(PART) {
            self.board.put(from, part).expect("the tapped line is open");
            let (whole, began) = (passed.len() + part.len(), Instant::now());
            while passed.len() < whole {
                if self.take(to, &mut passed) == 0 {
                    std::thread::sleep(Duration::from_millis(1));
                }
                if began.elapsed() > PATIENCE || (began.elapsed() > PATIENCE / 50 && self.has_restarted()) {
                    return None;
                }
            }
        }
        Some(passed)
    }

    fn log(&self) -> Vec<String> {
        let console = self.board.console();
        let whole = console.iter().rposition(|byte| *byte == 0).map_or(0, |end| end + 1);
        if whole == 0 { Vec::new() } else { messages(&fs::read(image(IMAGE)).expect("the image"), &console[..whole]) }
    }

    fn has_restarted(&self) -> bool {
        self.log().iter().filter(|line| line.contains("feedboard: start")).count() > 1
    }

    /// Until the log has a line with these words, with positions shown all the while; `None` if the board starts anew before.
    fn until_logged(&mut self, words: &str) -> Option<String> {
        let began = Instant::now();
        loop {
            self.show();
            self.take(Wire::Control, &mut Vec::new());
            std::thread::sleep(Duration::from_millis(20));
            if let Some(line) = self.log().into_iter().rfind(|line| line.contains(words)) {
                return Some(line);
            }
            if self.has_restarted() {
                return None;
            }
            assert!(began.elapsed() < PATIENCE, "no {words} in {:?}", self.log());
        }
    }
}

/// What an attempt comes to that no restart spoils.
fn attempted<T>(attempt: impl Fn(&mut Tapped) -> Option<T>) -> T {
    (0..ATTEMPTS).find_map(|_| attempt(&mut Tapped::start())).expect("its watchdog does not bite every time")
}

/// The numbers in a line.
fn numbers(line: &str) -> Vec<u32> {
    line.split_whitespace().filter_map(|word| word.trim_end_matches(',').parse().ok()).collect()
}

#[test]
fn every_character_passes_from_within_the_receivers_interrupt_in_both_directions() {
    let example = Example::load();
    let back: Vec<u8> = (0..=u8::MAX).cycle().take(2 * FLOOD).collect();
    let (text, said, figures, cost) = attempted(|tapped| {
        let text = tapped.pass(&example.text, [Wire::Sender, Wire::Control])?;
        let said = tapped.pass(&back, [Wire::Control, Wire::Sender])?;
        let cost = tapped.until_logged("passed on in")?;
        let figures = tapped.until_logged("ticks, worst")?;
        Some((text, said, figures, cost))
    });
    println!("{cost}");
    assert!(text == example.text && said == back, "byte for byte, in order");
    assert_eq!(numbers(&figures)[4], 0, "lost: {figures}");
    assert!((1..=PASSED_IN_MAX).contains(&numbers(&cost)[0]), "{cost}");
}

#[test]
fn what_the_main_loop_missed_passes_all_the_same_and_ends_the_adaptation() {
    let program: Vec<u8> = b"%\nO0001\n".iter().copied().chain(b"G1X1.Y2.F100.\n".repeat(FLOOD / 14)).collect();
    let (label, blocks) = program.split_at(8);
    let (begun, passed, lost, figures) = attempted(|tapped| {
        let begun = tapped.pass(label, [Wire::Sender, Wire::Control])?;
        tapped.until_logged("tap: in step")?;
        tapped.board.order(HOLD_UP);
        let passed = tapped.pass(blocks, [Wire::Sender, Wire::Control])?;
        let lost = tapped.until_logged("tap: lost")?;
        let figures = tapped.until_logged("ticks, worst")?;
        Some((begun, passed, lost, figures))
    });
    println!("{lost}; {figures}");
    assert_eq!([begun, passed].concat(), program, "byte for byte, in order");
    assert!(lost.ends_with("tap: lost, a damaged block"), "{lost}");
    assert!(numbers(&figures)[4] > 0, "counted: {figures}");
}
