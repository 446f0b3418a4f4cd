//! How deep the stack goes: paint what is free of it, run, and look how much paint is left.

/// What no function leaves behind by chance.
const PAINT: u32 = 0x5ca1_ab1e;
/// Bytes painted; more than the deepest call needs.
const DEPTH: usize = 4096;
/// Bytes right below the stack pointer that are left alone: what painting itself may use.
const CLEARANCE: usize = 64;

/// Paints what is free below the caller's frame; answers where it begins.
#[inline(always)]
pub fn paint() -> *mut u32 {
    let top = (cortex_m::register::msp::read() as usize - CLEARANCE) as *mut u32;
    for word in 0..DEPTH / 4 {
        // SAFETY: free stack below every frame in use; interrupts use it too, but only while they run.
        unsafe { top.sub(word + 1).write_volatile(PAINT) }
    }
    top
}

/// Bytes used since [`paint`], from the stack pointer it saw.
#[inline(always)]
pub fn used(top: *mut u32) -> usize {
    // SAFETY: reads of the same words.
    let deepest = (0..DEPTH / 4).rev().find(|word| unsafe { top.sub(word + 1).read_volatile() } != PAINT);
    deepest.map_or(0, |word| (word + 1) * 4 + CLEARANCE)
}
