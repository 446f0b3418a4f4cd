//! Data that the main program prepares for an interrupt handler, and memory that is taken once.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

/// Cell for data that the main program stores before it enables the interrupt whose handler uses them.
#[derive(Debug)]
pub struct Handed<T>(UnsafeCell<Option<T>>);

// SAFETY: written before the interrupt is enabled, used only by its handler from then on.
unsafe impl<T> Sync for Handed<T> {}

impl<T> Handed<T> {
    /// An empty cell.
    pub const fn nothing() -> Self {
        Handed(UnsafeCell::new(None))
    }

    /// A cell with this value.
    pub const fn with(value: T) -> Self {
        Handed(UnsafeCell::new(Some(value)))
    }

    /// Stores this value.
    ///
    /// # Safety
    /// No handler that uses it runs yet.
    pub unsafe fn put(&self, value: T) {
        // SAFETY: the caller guarantees that there is no other user yet.
        unsafe { *self.0.get() = Some(value) }
    }

    /// The stored value; `None` if none was stored.
    ///
    /// # Safety
    /// Only one user at a time: handlers of one priority, or the main program before any of them runs.
    #[allow(clippy::mut_from_ref, reason = "there is one user at a time, says the caller")]
    pub unsafe fn get(&self) -> Option<&mut T> {
        // SAFETY: as required of the caller.
        unsafe { (*self.0.get()).as_mut() }
    }
}

/// Static memory for a value that can be taken once, as a reference that lasts as long as the program.
#[derive(Debug)]
pub struct Once<T> {
    value: UnsafeCell<T>,
    is_given: AtomicBool,
}

// SAFETY: taken once, by one user.
unsafe impl<T: Send> Sync for Once<T> {}

impl<T> Once<T> {
    /// Memory with this value, which is not taken yet.
    pub const fn new(value: T) -> Self {
        Once { value: UnsafeCell::new(value), is_given: AtomicBool::new(false) }
    }

    /// The value, at the first call; `None` at every later one.
    #[allow(clippy::mut_from_ref, reason = "it is given out once")]
    pub fn take(&self) -> Option<&mut T> {
        let is_first = !self.is_given.swap(true, Ordering::Relaxed);
        // SAFETY: only the first call gets the reference.
        is_first.then(|| unsafe { &mut *self.value.get() })
    }
}
