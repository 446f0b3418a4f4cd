//! What the main program prepares and an interrupt's handler owns from then on, and memory that is given out once.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

/// Handed over before the interrupt is let through, then the handler's.
#[derive(Debug)]
pub struct Handed<T>(UnsafeCell<Option<T>>);

// SAFETY: written before the interrupt is let through, used by its handler alone from then on.
unsafe impl<T> Sync for Handed<T> {}

impl<T> Handed<T> {
    /// Nothing yet.
    pub const fn nothing() -> Self {
        Handed(UnsafeCell::new(None))
    }

    /// This.
    pub const fn with(value: T) -> Self {
        Handed(UnsafeCell::new(Some(value)))
    }

    /// Hands something over.
    ///
    /// # Safety
    /// No handler that takes it runs yet.
    pub unsafe fn put(&self, value: T) {
        // SAFETY: nobody else looks at it yet, says the caller.
        unsafe { *self.0.get() = Some(value) }
    }

    /// What was handed over.
    ///
    /// # Safety
    /// One user at a time: handlers of one priority, or the main program before any of them runs.
    #[allow(clippy::mut_from_ref, reason = "there is one user at a time, says the caller")]
    pub unsafe fn get(&self) -> Option<&mut T> {
        // SAFETY: as required of the caller.
        unsafe { (*self.0.get()).as_mut() }
    }
}

/// Memory with something in it, for the first who asks.
#[derive(Debug)]
pub struct Once<T> {
    value: UnsafeCell<T>,
    is_given: AtomicBool,
}

// SAFETY: given out once, to one user.
unsafe impl<T: Send> Sync for Once<T> {}

impl<T> Once<T> {
    /// Not given out yet.
    pub const fn new(value: T) -> Self {
        Once { value: UnsafeCell::new(value), is_given: AtomicBool::new(false) }
    }

    /// For the first who asks; `None` for all others.
    #[allow(clippy::mut_from_ref, reason = "it is given out once")]
    pub fn take(&self) -> Option<&mut T> {
        let is_first = !self.is_given.swap(true, Ordering::Relaxed);
        // SAFETY: nobody else was given it, and nobody will be.
        is_first.then(|| unsafe { &mut *self.value.get() })
    }
}
