//! Where a control will wait for the line: blocks that are executed faster than their successors arrive.
//!
//! Block i has arrived a character's time per character after the one before, but not before the control's buffer has
//! room, and begins when it has arrived and the block before is done. Accelerations are left out: the control is rather
//! slower, and waits rather less.

/// One block of what is sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Characters, its end among them.
    pub characters: usize,
    /// What it takes, s.
    pub time_s: f64,
}

/// A stretch of blocks before each of which the control waits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wait {
    /// Indices of the first and the last of them.
    pub blocks: [usize; 2],
    /// How long it waits in all, s.
    pub time_s: f64,
}

/// Predicts the waits at a line of `chars_per_s`, for a buffer of so many characters. What comes before the first block
/// that takes time is no wait.
pub fn predict(loads: &[Load], chars_per_s: f64, buffer: usize) -> Vec<Wait> {
    let (mut waits, mut begun): (Vec<Wait>, Vec<f64>) = (Vec::new(), Vec::with_capacity(loads.len()));
    let (mut arrived, mut free, mut has_moved) = (0.0_f64, 0.0_f64, false);
    let (mut oldest, mut held) = (0, 0);
    for (index, load) in loads.iter().enumerate() {
        held += load.characters;
        while held > buffer && oldest < index {
            // Its characters leave the buffer when it begins.
            arrived = arrived.max(begun[oldest]);
            held -= loads[oldest].characters;
            oldest += 1;
        }
        arrived += load.characters as f64 / chars_per_s;
        let start = arrived.max(free);
        if has_moved && start > free {
            add(&mut waits, index, start - free);
        }
        begun.push(start);
        free = start + load.time_s;
        has_moved |= load.time_s > 0.0;
    }
    waits
}

fn add(waits: &mut Vec<Wait>, index: usize, time_s: f64) {
    match waits.last_mut() {
        Some(wait) if wait.blocks[1] + 1 == index => (wait.blocks[1], wait.time_s) = (index, wait.time_s + time_s),
        _ => waits.push(Wait { blocks: [index; 2], time_s }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(characters: usize, time_s: f64) -> Load {
        Load { characters, time_s }
    }

    #[test]
    fn a_line_as_fast_as_the_program_starves_nobody() {
        assert_eq!(predict(&[load(10, 0.01); 50], 1_000.0, 200), []);
    }

    #[test]
    fn short_blocks_wait_for_what_they_are_short_of() {
        // 20 ms on the line, 5 ms to execute: 15 ms before each but the first.
        let waits = predict(&[load(20, 0.005); 11], 1_000.0, 200);
        assert_eq!(waits.len(), 1);
        assert_eq!(waits[0].blocks, [1, 10]);
        assert!((waits[0].time_s - 0.150).abs() < 1e-9, "{waits:?}");
    }

    #[test]
    fn a_long_block_fills_the_buffer_and_no_more_than_that() {
        // A second fills 100 characters: five blocks of 20 are there, the sixth is short again.
        let mut loads = vec![load(20, 1.0)];
        loads.extend([load(20, 0.0); 20]);
        let waits = predict(&loads, 1_000.0, 100);
        assert_eq!(waits[0].blocks[0], 6, "{waits:?}");
    }
}
