//! Wall time. In a web page (`wasm32`) the system has no clock; there the page provides one.

#[cfg(not(target_family = "wasm"))]
pub use std::time::Instant;

#[cfg(target_family = "wasm")]
pub use of_page::{Instant, set};

#[cfg(target_family = "wasm")]
mod of_page {
    use std::sync::OnceLock;
    use std::time::Duration;

    static CLOCK: OnceLock<fn() -> f64> = OnceLock::new();

    /// Sets the function by which the page gives the time, in ms from any origin; without it time stands still.
    pub fn set(clock: fn() -> f64) {
        let _is_set_once = CLOCK.set(clock);
    }

    /// Point in time of the page's clock.
    #[derive(Clone, Copy, Debug)]
    pub struct Instant(f64);

    impl Instant {
        /// The present time.
        pub fn now() -> Self {
            Instant(CLOCK.get().map_or(0.0, |clock| clock()))
        }

        /// Time since this instant.
        pub fn elapsed(&self) -> Duration {
            Instant::now().duration_since(*self)
        }

        /// Time from an earlier instant to this one.
        pub fn duration_since(&self, earlier: Instant) -> Duration {
            Duration::from_secs_f64(((self.0 - earlier.0) / 1e3).max(0.0))
        }
    }
}
