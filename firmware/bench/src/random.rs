//! Whole numbers from a seed: xorshift64*, the same on every machine.

/// Generator of pseudo-random numbers. Keeps its state between calls.
#[derive(Clone, Copy, Debug)]
pub struct Random(u64);

impl Random {
    /// A generator with a seed other than zero.
    pub const fn new(seed: u64) -> Self {
        Random(seed)
    }

    /// A number below `bound`, which is above zero and well below 2^64.
    pub fn below(&mut self, bound: u64) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) % bound
    }

    /// A random element; the slice must not be empty.
    pub fn one_of<'t, T>(&mut self, things: &'t [T]) -> &'t T {
        &things[self.below(things.len() as u64) as usize]
    }
}
