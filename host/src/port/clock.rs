//! Wall time since a port was opened.

use std::time::{Duration, Instant};

use arcfeed_shared::units::Micros;

/// Starts when it is made.
#[derive(Clone, Copy, Debug)]
pub struct WallClock(Instant);

impl WallClock {
    /// Zero is now.
    pub fn start() -> Self {
        WallClock(Instant::now())
    }

    /// Time since the start.
    pub fn now(&self) -> Micros {
        Micros(u64::try_from(self.0.elapsed().as_micros()).unwrap_or(u64::MAX))
    }

    /// Sleeps until then.
    pub fn wait(&self, deadline: Micros) {
        std::thread::sleep(Duration::from_micros(deadline.since(self.now()).0));
    }
}
