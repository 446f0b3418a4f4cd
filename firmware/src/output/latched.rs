//! Fault latch of an output: 0 % after a hardware fault until a person resets it.

use super::OverrideOutput;
use crate::ramp::FeedOverride;

/// Wraps an override output: after its first hardware failure it stays released (0 %) until a person resets it,
/// instead of being written again at each tick.
#[derive(Clone, Debug)]
pub struct Latched<O: OverrideOutput> {
    output: O,
    fault: Option<O::Error>,
}

impl<O: OverrideOutput> Latched<O> {
    /// Wraps an output without a failure.
    pub fn new(output: O) -> Self {
        Latched { output, fault: None }
    }

    /// The first failure since the last reset; `None` if there was none.
    pub fn fault(&self) -> Option<&O::Error> {
        self.fault.as_ref()
    }

    /// Clears the fault, on the request of a person who has removed its cause. The output stays released until the
    /// next update.
    pub fn reset(&mut self) {
        self.fault = None;
    }
}

impl<O: OverrideOutput<Error: Clone>> Latched<O> {
    /// Latches the first fault, releases the output, and returns the fault.
    fn fail(&mut self, error: O::Error) -> Result<(), O::Error> {
        let fault = self.fault.get_or_insert(error).clone();
        // The first fault is the one to report.
        let _ = self.output.release();
        Err(fault)
    }
}

impl<O: OverrideOutput<Error: Clone>> OverrideOutput for Latched<O> {
    type Error = O::Error;

    /// After a failure, releases the output again and returns the first fault.
    fn put(&mut self, feed_override: FeedOverride) -> Result<(), O::Error> {
        if let Some(fault) = self.fault.clone() {
            return self.fail(fault);
        }
        self.output.put(feed_override).or_else(|error| self.fail(error))
    }

    /// An error of the release is a fault too.
    fn release(&mut self) -> Result<(), O::Error> {
        self.output.release().or_else(|error| self.fail(error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Output that fails while `broken` is set; counts its updates.
    #[derive(Default)]
    struct Fickle {
        broken: bool,
        at: Option<u8>,
        puts: u32,
    }

    impl OverrideOutput for Fickle {
        type Error = u32;

        fn put(&mut self, feed_override: FeedOverride) -> Result<(), u32> {
            self.puts += 1;
            self.at = Some(feed_override.percent);
            if self.broken { Err(self.puts) } else { Ok(()) }
        }

        fn release(&mut self) -> Result<(), u32> {
            self.at = Some(0);
            if self.broken { Err(99) } else { Ok(()) }
        }
    }

    #[test]
    fn a_fault_holds_until_it_is_reset_even_if_the_hardware_recovers() {
        let mut hardware = Fickle::default();
        let mut output = Latched::new(&mut hardware);
        assert_eq!(output.put(FeedOverride::PROGRAMMED), Ok(()));
        output.output.broken = true;
        assert_eq!(output.put(FeedOverride::PROGRAMMED), Err(2));
        output.output.broken = false;
        for _ in 0..5 {
            assert_eq!(output.put(FeedOverride::PROGRAMMED), Err(2));
            assert_eq!(output.output.at, Some(0));
        }
        assert_eq!((output.fault(), output.output.puts), (Some(&2), 2));
        output.reset();
        assert_eq!(output.put(FeedOverride::PROGRAMMED), Ok(()));
        assert_eq!((output.fault(), output.output.at), (None, Some(100)));
    }

    #[test]
    fn a_release_that_fails_is_a_fault() {
        let mut output = Latched::new(Fickle { broken: true, ..Fickle::default() });
        assert_eq!(output.release(), Err(99));
        assert_eq!(output.put(FeedOverride::PROGRAMMED), Err(99));
    }
}
