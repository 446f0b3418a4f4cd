//! Sender of telemetry records over a serial line.

use embedded_io::Write;

use super::log::RecordLog;
use super::record::RECORD_LEN;

/// Sends telemetry records over a serial line; holds the record that is partly sent.
#[derive(Clone, Debug)]
pub struct RecordSender {
    bytes: [u8; RECORD_LEN],
    sent: usize,
}

/// Reason why the line accepted no more bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SendError<E> {
    /// The line accepts no bytes, but reports no error.
    Closed,
    /// The line has reported an error.
    Line(E),
}

impl Default for RecordSender {
    fn default() -> Self {
        RecordSender { bytes: [0; RECORD_LEN], sent: RECORD_LEN }
    }
}

impl RecordSender {
    /// Sends the records of the log, the oldest first. Returns the number of completely sent records.
    ///
    /// The next call completes a record that an error has interrupted: no record is sent twice or left incomplete.
    /// Blocks as long as the line does.
    ///
    /// # Errors
    /// The line accepted no more bytes; the rest is sent by the next call.
    pub fn drain<W: Write, const N: usize>(
        &mut self,
        log: &mut RecordLog<N>,
        line: &mut W,
    ) -> Result<u32, SendError<W::Error>> {
        let mut whole = u32::from(self.finish(line)?);
        while let Some(record) = log.pop() {
            *self = RecordSender { bytes: record.encode(), sent: 0 };
            whole = whole.saturating_add(u32::from(self.finish(line)?));
        }
        Ok(whole)
    }

    /// Sends the rest of the current record; returns whether there was one.
    fn finish<W: Write>(&mut self, line: &mut W) -> Result<bool, SendError<W::Error>> {
        let mut any = false;
        // `write_all` would panic on a line that accepts no bytes.
        while let Some(rest) = self.bytes.get(self.sent..).filter(|rest| !rest.is_empty()) {
            any = true;
            match line.write(rest).map_err(SendError::Line)? {
                0 => return Err(SendError::Closed),
                taken => self.sent = self.sent.saturating_add(taken),
            }
        }
        Ok(any)
    }
}

#[cfg(test)]
mod tests {
    use super::super::reason::Cause;
    use super::super::record::TelemetryRecord;
    use super::*;
    use crate::ramp::FeedOverride;
    use arcfeed_units::Micros;
    use embedded_io::{ErrorKind, ErrorType};

    /// Takes a few bytes at a time, then refuses for once.
    struct Stuttering {
        taken: Vec<u8>,
        at_once: usize,
        until_refusal: usize,
    }

    impl ErrorType for Stuttering {
        type Error = ErrorKind;
    }

    impl Write for Stuttering {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
            if self.until_refusal == 0 {
                self.until_refusal = usize::MAX;
                return Err(ErrorKind::TimedOut);
            }
            self.until_refusal -= 1;
            let some = &bytes[..bytes.len().min(self.at_once)];
            self.taken.extend_from_slice(some);
            Ok(some.len())
        }

        fn flush(&mut self) -> Result<(), ErrorKind> {
            Ok(())
        }
    }

    fn record(block: u32) -> TelemetryRecord {
        TelemetryRecord {
            at: Micros(u64::from(block) * 1_000),
            feed_override: FeedOverride::PROGRAMMED,
            ipt_center_nm: Some(block * 7),
            feed_um_per_min: Some(1),
            cause: Cause::NoLaw,
            chip_excess_percent: 0,
            block,
        }
    }

    #[test]
    fn the_other_end_decodes_what_was_logged() {
        let (mut log, mut line) = (RecordLog::<8>::new(), [0; 8 * RECORD_LEN]);
        (0..5).for_each(|block| log.push(record(block)));
        assert_eq!(RecordSender::default().drain(&mut log, &mut &mut line[..]), Ok(5));
        let received = line.as_chunks().0.iter().take(5).map(TelemetryRecord::decode);
        assert!(received.eq((0..5).map(|block| Ok(record(block)))));
    }

    #[test]
    fn wherever_the_line_refuses_every_record_arrives_once_and_whole() {
        for at_once in [1, 3, 7, RECORD_LEN] {
            for until_refusal in 0..3 * RECORD_LEN {
                let mut line = Stuttering { taken: Vec::new(), at_once, until_refusal };
                let (mut log, mut sender) = (RecordLog::<4>::new(), RecordSender::default());
                (0..3).for_each(|block| log.push(record(block)));
                let first = sender.drain(&mut log, &mut line);
                assert!(matches!(first, Ok(3) | Err(SendError::Line(ErrorKind::TimedOut))));
                sender.drain(&mut log, &mut line).unwrap();
                let (records, rest) = line.taken.as_chunks();
                assert!(rest.is_empty());
                assert!(records.iter().map(TelemetryRecord::decode).eq((0..3).map(|block| Ok(record(block)))));
            }
        }
    }

    #[test]
    fn a_line_that_takes_nothing_is_closed_and_does_not_panic() {
        let mut log = RecordLog::<4>::new();
        log.push(record(0));
        let mut line = Stuttering { taken: Vec::new(), at_once: 0, until_refusal: 9 };
        assert_eq!(RecordSender::default().drain(&mut log, &mut line), Err(SendError::Closed));
    }
}
