//! Debouncing of up to sixteen switches.
//!
//! A contact changes its settled level after eight consecutive ticks at the other level; a single sample at the
//! settled level restarts the count. The counters are stored bit-sliced, one bit of each in a word, so that a tick
//! costs the same for one contact and for sixteen.

/// Debounces sixteen switches, one bit each: a level counts only after eight consecutive ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contacts {
    settled: u16,
    /// Bits 0, 1 and 2 of each contact's count.
    counts: [u16; 3],
}

impl Contacts {
    /// Starts with these levels as the debounced ones; they must be the safe ones.
    pub const fn at(settled: u16) -> Self {
        Contacts { settled, counts: [0; 3] }
    }

    /// Processes the levels read at this tick, one bit for each contact; returns the debounced levels.
    pub fn follow(&mut self, levels: u16) -> u16 {
        let differs = levels ^ self.settled;
        let [ones, twos, fours] = self.counts;
        let eighth = differs & ones & twos & fours;
        // A count of seven wraps around to zero.
        self.counts = [!ones, twos ^ ones, fours ^ (twos & ones)].map(|bits| bits & differs);
        self.settled ^= eighth;
        self.settled
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eighth_sample_in_a_row_counts_and_a_bounce_starts_anew() {
        let mut contacts = Contacts::at(0);
        let mut bouncing = vec![1; 7];
        bouncing.push(0);
        bouncing.extend([1; 7]);
        assert!(bouncing.iter().all(|level| contacts.follow(*level) == 0));
        assert_eq!(contacts.follow(1), 1);
        assert!((0..7).all(|_| contacts.follow(0) == 1));
        assert_eq!(contacts.follow(0), 0);
    }

    #[test]
    fn every_contact_settles_as_it_would_alone() {
        let mut random = 0x2545_F491_u32;
        let mut contacts = Contacts::at(0xA5A5);
        let mut alone: [(bool, u32); 16] = core::array::from_fn(|bit| (0xA5A5 >> bit & 1 == 1, 0));
        let (mut levels, mut changes) = (0, 0);
        for _ in 0..20_000 {
            random ^= random << 13;
            random ^= random >> 17;
            random ^= random << 5;
            // Some contacts move at each sample, most stay: runs of all lengths come up.
            levels ^= (random & random >> 16 & random >> 7) as u16;
            let settled = contacts.follow(levels);
            for (bit, (level, count)) in alone.iter_mut().enumerate() {
                *count = if (levels >> bit & 1 == 1) == *level { 0 } else { *count + 1 };
                if *count == 8 {
                    (*level, *count, changes) = (!*level, 0, changes + 1);
                }
                assert_eq!(settled >> bit & 1 == 1, *level, "contact {bit}");
            }
        }
        assert!(changes > 1_000, "{changes}");
    }
}
