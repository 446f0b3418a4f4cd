//! Measurement of the stack's depth: fill the free stack with a pattern, run, and count the overwritten words.

/// Pattern that no function leaves by chance.
const PAINT: u32 = 0x5ca1_ab1e;
/// Filled bytes, more than the deepest call needs: for the controller alone, and for a complete board.
const DEPTH: usize = 8_192;
const DEPTH_OF_A_BOARD: usize = 98_304;
/// Bytes below the stack pointer that are not filled, for the filling code itself.
const CLEARANCE: usize = 64;

/// Part of the free stack that is filled with a pattern, so that the stack's use can be measured.
#[derive(Clone, Copy, Debug)]
pub struct Painted {
    /// Upper address of the pattern.
    top: usize,
    /// Length of the pattern.
    depth: usize,
}

impl Painted {
    /// Fills the free stack below the caller's frame with the pattern, deep enough for the controller alone.
    #[inline(always)]
    pub fn below_here() -> Self {
        Painted::so_deep(DEPTH)
    }

    /// Fills the free stack below the caller's frame with the pattern, deep enough for a complete board.
    #[inline(always)]
    pub fn far_below_here() -> Self {
        Painted::so_deep(DEPTH_OF_A_BOARD)
    }

    #[inline(always)]
    fn so_deep(depth: usize) -> Self {
        let painted = Painted { top: cortex_m::register::msp::read() as usize - CLEARANCE, depth };
        for word in 0..depth / 4 {
            // SAFETY: free stack below every frame in use; interrupts use it too, but only while they run.
            unsafe { painted.word(word).write_volatile(PAINT) }
        }
        painted
    }

    /// Greatest number of bytes of stack in use since the pattern was written, counted from the stack pointer at that
    /// time.
    #[inline(always)]
    pub fn used(self) -> usize {
        // SAFETY: reads of the words that were painted.
        let is_used = |word: &usize| unsafe { self.word(*word).read_volatile() } != PAINT;
        (0..self.depth / 4).rev().find(is_used).map_or(0, |word| (word + 1) * 4 + CLEARANCE)
    }

    /// Number of bytes of stack that were in use when the pattern was written.
    pub fn above(self) -> usize {
        unsafe extern "C" {
            static _stack_start: u32;
        }
        (&raw const _stack_start as usize).saturating_sub(self.top + CLEARANCE)
    }

    fn word(self, word: usize) -> *mut u32 {
        (self.top - 4 * (word + 1)) as *mut u32
    }
}
