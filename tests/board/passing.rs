//! The tapped line of a board that runs free: its receivers' handlers pass every character on, whatever the main loop does, and what
//! the main loop missed ends the adaptation.

use std::time::{Duration, Instant};

use arcfeed_hil_sim::decider::board::{Wire, Wires};

use crate::free::Free;
use crate::runs::Example;

/// The order to hold the main loop up until the tapped line has lost a character.
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
struct Tapped(Free);

impl Tapped {
    fn start() -> Self {
        let mut free = Free::start();
        // The first word, and what makes the tap read on.
        free.show();
        while free.log().is_empty() {
            std::thread::sleep(Duration::from_millis(50));
        }
        Tapped(free)
    }

    /// Lets the machine line run, and takes what has come at one end of the tapped line.
    fn take(&mut self, wire: Wire, into: &mut Vec<u8>) -> usize {
        let mut bytes = [0; 512];
        while self.0.board.take_waiting(Wire::Machine, &mut bytes).expect("the machine line is open") > 0 {}
        let length = self.0.board.take_waiting(wire, &mut bytes).expect("the tapped line is open");
        into.extend(&bytes[..length]);
        length
    }

    /// Sends at one end; what came at the other. `None` if that stops before all of it came.
    fn pass(&mut self, text: &[u8], [from, to]: [Wire; 2]) -> Option<Vec<u8>> {
        let mut passed = Vec::new();
        for part in text.chunks(PART) {
            self.0.board.put(from, part).expect("the tapped line is open");
            let (whole, began) = (passed.len() + part.len(), Instant::now());
            while passed.len() < whole {
                if self.take(to, &mut passed) == 0 {
                    std::thread::sleep(Duration::from_millis(1));
                }
                if began.elapsed() > PATIENCE || (began.elapsed() > PATIENCE / 50 && self.0.starts() > 1) {
                    return None;
                }
            }
        }
        Some(passed)
    }

    /// Until the log has a line with these words, with positions shown all the while; `None` if the board starts anew before.
    fn until_logged(&mut self, words: &str) -> Option<String> {
        let began = Instant::now();
        loop {
            self.0.show();
            self.take(Wire::Control, &mut Vec::new());
            std::thread::sleep(Duration::from_millis(20));
            if let Some(line) = self.0.log().into_iter().rfind(|line| line.contains(words)) {
                return Some(line);
            }
            if self.0.starts() > 1 {
                return None;
            }
            assert!(began.elapsed() < PATIENCE, "no {words} in {:?}", self.0.log());
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
        tapped.0.board.order(HOLD_UP);
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
