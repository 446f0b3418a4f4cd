//! Ring buffer of the last telemetry records.

use heapless::Deque;

use super::record::TelemetryRecord;

/// Ring buffer of the last `N` telemetry records; a new record replaces the oldest. `N` must not be zero.
#[derive(Clone, Debug, Default)]
pub struct RecordLog<const N: usize> {
    records: Deque<TelemetryRecord, N>,
    overwritten: u32,
}

impl<const N: usize> RecordLog<N> {
    /// An empty log.
    pub const fn new() -> Self {
        RecordLog { records: Deque::new(), overwritten: 0 }
    }

    /// Adds a record; replaces the oldest if the log is full.
    pub fn push(&mut self, record: TelemetryRecord) {
        let Err(record) = self.records.push_back(record) else { return };
        self.overwritten = self.overwritten.saturating_add(1);
        self.records.pop_front();
        // Fits: a record was removed.
        let _ = self.records.push_back(record);
    }

    /// Removes and returns the oldest record.
    pub fn pop(&mut self) -> Option<TelemetryRecord> {
        self.records.pop_front()
    }

    /// All records, the oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &TelemetryRecord> {
        self.records.iter()
    }

    /// Number of records that were replaced before they were read; at most `u32::MAX`.
    pub fn overwritten(&self) -> u32 {
        self.overwritten
    }
}

#[cfg(test)]
mod tests {
    use super::super::reason::Cause;
    use super::*;
    use crate::ramp::FeedOverride;
    use arcfeed_units::Micros;

    fn record(at_us: u64) -> TelemetryRecord {
        TelemetryRecord {
            at: Micros(at_us),
            feed_override: FeedOverride::PROGRAMMED,
            ipt_center_nm: None,
            feed_um_per_min: Some(1),
            cause: Cause::NoLaw,
            chip_excess_percent: 0,
            block: 0,
        }
    }

    fn times<const N: usize>(log: &RecordLog<N>) -> Vec<u64> {
        log.iter().map(|record| record.at.0).collect()
    }

    #[test]
    fn the_last_records_are_kept_in_order_and_the_lost_ones_counted() {
        let mut log = RecordLog::<4>::new();
        (0..4).for_each(|at_us| log.push(record(at_us)));
        assert_eq!((times(&log), log.overwritten()), (vec![0, 1, 2, 3], 0));
        (4..11).for_each(|at_us| log.push(record(at_us)));
        assert_eq!((times(&log), log.overwritten()), (vec![7, 8, 9, 10], 7));
    }

    #[test]
    fn what_is_taken_out_is_not_lost() {
        let mut log = RecordLog::<2>::new();
        for at_us in 0..10 {
            log.push(record(at_us));
            assert_eq!(log.pop(), Some(record(at_us)));
        }
        assert_eq!((log.pop(), log.overwritten()), (None, 0));
    }

    #[test]
    fn a_record_takes_32_bytes_of_memory() {
        assert_eq!(size_of::<TelemetryRecord>(), 32);
        assert!(size_of::<RecordLog<128>>() <= 128 * 32 + 32);
    }

    #[test]
    fn the_count_of_the_lost_does_not_wrap() {
        let mut log = RecordLog::<1> { overwritten: u32::MAX, ..RecordLog::new() };
        log.push(record(0));
        log.push(record(1));
        assert_eq!(log.overwritten(), u32::MAX);
    }
}
