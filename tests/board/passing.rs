//! The tapped line of a board that runs free: its receivers' handlers pass every character on, whatever the main loop does, and what
//! the main loop missed ends the adaptation.

use std::time::{Duration, Instant};

use arcfeed_hil_sim::override_source::board::{Wire, Wires};
use arcfeed_link::frame::ENCODED_MAX;

use crate::free::Free;
use crate::runs::Example;

/// The order to hold the main loop up until the tapped line has lost a character.
const HOLD_UP: u8 = b'l';
/// Instructions from a receiver's interrupt to its character in the other transmitter, just above what is needed, where no tick comes
/// in between. docs/tap.md.
const PASSED_IN_MAX: u32 = 130;
/// Capacity of a line's ring, plus one.
const RING: usize = 1024;
/// Characters sent at a time.
const PART: usize = RING / 2;
/// The main loop has been round behind a moment once this much more has come on the machine line: what its ring held at that
/// moment, and two setpoints.
const ROUND: usize = RING + 2 * ENCODED_MAX;
/// More than a ring holds.
const FLOOD: usize = 6_000;
/// A machine with much else to do may lose a board to its watchdog, not every time.
const ATTEMPTS: u32 = 10;
const TIMEOUT: Duration = Duration::from_secs(120);

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

    /// Lets the machine line run; how much has come there.
    fn take_machine(&mut self) -> usize {
        let mut bytes = [0; 512];
        let mut take = || self.0.board.take_waiting(Wire::Machine, &mut bytes).expect("the machine line is open");
        std::iter::from_fn(|| Some(take()).filter(|length| *length > 0)).sum()
    }

    /// Takes what has come at one end of the tapped line.
    fn take(&mut self, wire: Wire, into: &mut Vec<u8>) -> usize {
        let mut bytes = [0; 512];
        let length = self.0.board.take_waiting(wire, &mut bytes).expect("the tapped line is open");
        into.extend(&bytes[..length]);
        length
    }

    /// Sends at one end; what came at the other. `None` if the board starts anew before all of it came.
    fn pass(&mut self, text: &[u8], [from, to]: [Wire; 2]) -> Option<Vec<u8>> {
        self.0.board.put(from, text).expect("the tapped line is open");
        let mut passed = Vec::new();
        self.until(|tapped| {
            tapped.take_machine();
            tapped.take(to, &mut passed);
            passed.len() >= text.len()
        })?;
        Some(passed)
    }

    /// The same, no faster than the main loop hears it: a chip in a machine with much else to do is slow, and its sender is not.
    fn pass_heard(&mut self, text: &[u8], ends: [Wire; 2]) -> Option<Vec<u8>> {
        let mut passed = Vec::new();
        for part in text.chunks(PART) {
            passed.extend(self.pass(part, ends)?);
            let mut shown = 0;
            self.take_machine();
            self.until(|tapped| {
                shown += tapped.take_machine();
                shown >= ROUND
            })?;
        }
        Some(passed)
    }

    /// `None` if the board starts anew before this is so.
    fn until(&mut self, mut is_so: impl FnMut(&mut Self) -> bool) -> Option<()> {
        let began = Instant::now();
        while !is_so(self) {
            // To read the log takes long, and is only asked for when this does.
            if began.elapsed() > TIMEOUT / 50 && self.0.starts() > 1 {
                return None;
            }
            assert!(began.elapsed() < TIMEOUT, "{:?}", self.0.log());
            std::thread::sleep(Duration::from_millis(1));
        }
        Some(())
    }

    /// Until the log has a line with these words, with positions shown all the while; `None` if the board starts anew before.
    fn until_logged(&mut self, words: &str) -> Option<String> {
        let began = Instant::now();
        loop {
            self.0.show();
            self.take_machine();
            self.take(Wire::Control, &mut Vec::new());
            std::thread::sleep(Duration::from_millis(20));
            if let Some(line) = self.0.log().into_iter().rfind(|line| line.contains(words)) {
                return Some(line);
            }
            if self.0.starts() > 1 {
                return None;
            }
            assert!(began.elapsed() < TIMEOUT, "no {words} in {:?}", self.0.log());
        }
    }
}

/// Result of the first attempt that no restart disturbs.
fn attempted<T>(attempt: impl Fn(&mut Tapped) -> Option<T>) -> T {
    (0..ATTEMPTS).find_map(|_| attempt(&mut Tapped::start())).expect("its watchdog does not fire every time")
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
        let text = tapped.pass_heard(&example.text, [Wire::Sender, Wire::Control])?;
        let said = tapped.pass_heard(&back, [Wire::Control, Wire::Sender])?;
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
fn characters_that_the_main_loop_misses_still_pass_but_end_the_adaptation() {
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
