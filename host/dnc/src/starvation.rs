//! Prediction of the waits of a control that executes blocks faster than the serial line delivers the next ones.
//!
//! Block i arrives one character time per character after the one before, but not before the control's buffer has room.
//! It begins when it has arrived and the block before is done. A control brakes for the end of the last block it has: a
//! block whose successor has not arrived when it begins ends at rest, and takes longer for that.

/// Length and execution time of a block: the input of [`predict`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockLoad {
    /// Number of characters on the line, including the end of block.
    pub characters: usize,
    /// Execution time if the axes do not stop at the block's start and end, s.
    pub time_s: f64,
    /// Execution time if the axes start and end at rest, s.
    pub alone_s: f64,
}

impl BlockLoad {
    /// Load of a move with this length, speed and acceleration: `s/v` in passing, `s/v + v/a` from rest to rest or,
    /// where v is not reached, `2 sqrt(s/a)`.
    pub fn of_move(characters: usize, way_mm: f64, speed_mm_per_s: f64, acceleration_mm_per_s2: f64) -> Self {
        let (s, v, a) = (way_mm, speed_mm_per_s, acceleration_mm_per_s2);
        let alone_s = if s * a < v * v { 2.0 * libm::sqrt(s / a) } else { s / v + v / a };
        BlockLoad { characters, time_s: s / v, alone_s }
    }

    /// Load of a dwell or of a block without motion, which takes `time_s` in either case.
    pub fn of_time(characters: usize, time_s: f64) -> Self {
        BlockLoad { characters, time_s, alone_s: time_s }
    }
}

/// Successive blocks before each of which the control waits for the serial line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wait {
    /// Indices of the first and the last of these blocks in the list given to [`predict`].
    pub blocks: [usize; 2],
    /// Sum of the waits, s.
    pub time_s: f64,
}

/// Predicts the waits of a control with a buffer of `buffer` characters at a line of `chars_per_s` characters per
/// second. The wait before the first block that takes time does not count.
pub fn predict(loads: &[BlockLoad], chars_per_s: f64, buffer: usize) -> Vec<Wait> {
    let (mut waits, mut begun): (Vec<Wait>, Vec<f64>) = (Vec::new(), Vec::with_capacity(loads.len()));
    let (mut arrived, mut free, mut has_moved) = (0.0_f64, 0.0_f64, false);
    let (mut oldest, mut held, mut rests) = (0, 0, true);
    for (index, load) in loads.iter().enumerate() {
        held += load.characters;
        while held > buffer && oldest < index {
            // The characters of a block leave the buffer when it begins.
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
        let follows_s = loads.get(index + 1).map_or(0.0, |next| next.characters as f64 / chars_per_s);
        let (began_at_rest, ends_at_rest) = (rests || start > free, arrived + follows_s > start);
        free = start
            + match (began_at_rest, ends_at_rest) {
                (true, true) => load.alone_s,
                (false, false) => load.time_s,
                _ => f64::midpoint(load.alone_s, load.time_s),
            };
        rests = ends_at_rest;
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

    fn load(characters: usize, time_s: f64) -> BlockLoad {
        BlockLoad::of_time(characters, time_s)
    }

    #[test]
    fn a_line_as_fast_as_the_program_causes_no_wait() {
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
    fn a_block_that_is_alone_takes_longer() {
        // 0.1 mm at 500 mm/s2 from rest to rest: 28.3 ms, where 20 characters take 20 ms: the control never waits.
        let alone = BlockLoad::of_move(20, 0.1, 100.0, 500.0);
        assert!((alone.alone_s - 0.028_284).abs() < 1e-6 && (alone.time_s - 0.001).abs() < 1e-12, "{alone:?}");
        let waits = predict(&[alone; 50], 1_000.0, 200);
        let waited: f64 = waits.iter().map(|wait| wait.time_s).sum();
        assert!(waited < 0.050 * 0.020 * 50.0, "{waits:?}");
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
