//! Telemetry record: the decision of a tick in 24 bytes.
//!
//! Little endian, whole numbers only, so NaN cannot occur. Decoding and encoding again gives the same bytes. The bytes
//! have no checksum and no end mark; the link provides them.

use arcfeed_units::{Micros, MmPerMin, MmPerTooth, NM_PER_MM, UM_PER_MM};

use super::reason::Cause;
use crate::ramp::FeedOverride;
use crate::supervisor::Output;
use crate::supervisor::input::Work;
use crate::supervisor::report::Reason;

/// Length of an encoded record, bytes.
pub const RECORD_LEN: usize = 24;

/// First byte of a record: number of the layout of its bytes.
pub const LAYOUT: u8 = 1;

/// Largest override of a record, %.
const HIGHEST_PERCENT: u8 = 254;

/// Code of a missing feed.
const NONE: u32 = u32::MAX;

/// Decision of one control tick: override, reason and feeds, with its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TelemetryRecord {
    /// Time by the board's clock.
    pub at: Micros,
    /// Override at the output.
    pub feed_override: FeedOverride,
    /// Feed per tooth at the tool's centre that the law demands, nanometres, at most `u32::MAX - 1`; `None` without a
    /// demand.
    pub ipt_center_nm: Option<u32>,
    /// Feed of the machine at this override, reduced to the segment's feed limit, micrometres per minute, at most
    /// `u32::MAX - 1`; `None` if the override does not act on a feed.
    pub feed_um_per_min: Option<u32>,
    /// Reason of the override.
    pub cause: Cause,
    /// Amount by which the chip exceeds its target because the override must not be lower, %, at most 255; 0 for every
    /// other reason.
    pub chip_excess_percent: u8,
    /// Number of the segment in execution; 0 for none.
    pub block: u32,
}

/// Reason why bytes are not a telemetry record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// The layout number in the first byte is unknown.
    Layout(u8),
    /// No reason has this number.
    Cause(u8),
    /// An override above 254 %.
    Percent(u8),
    /// A value in the byte of the chip's excess, although the reason has none.
    Detail(u8),
}

impl TelemetryRecord {
    /// The record of the tick at the time `at`, with the segment in execution and the tick's decision.
    pub fn new(at: Micros, work: Work<'_>, output: &Output) -> Self {
        let feed = work.and_then(|(_, segment)| segment.feed_at(output.feed_override));
        let chip_excess_percent = match output.reason {
            Reason::Floor { chip_excess_percent } => u8::try_from(chip_excess_percent).unwrap_or(u8::MAX),
            _ => 0,
        };
        TelemetryRecord {
            at,
            feed_override: output.feed_override,
            ipt_center_nm: output.ipt_center.and_then(|MmPerTooth(mm)| whole(mm, NM_PER_MM)),
            feed_um_per_min: feed.and_then(|MmPerMin(feed)| whole(feed, UM_PER_MM)),
            cause: output.reason.into(),
            chip_excess_percent,
            block: work.map_or(0, |(count, _)| count),
        }
    }

    /// The record as bytes.
    pub fn encode(&self) -> [u8; RECORD_LEN] {
        let percent = self.feed_override.percent.min(HIGHEST_PERCENT);
        let [ipt_nm, feed_um] =
            [self.ipt_center_nm, self.feed_um_per_min].map(|number| number.map_or(NONE, |number| number.min(NONE - 1)));
        let detail = if self.cause == Cause::Floor { self.chip_excess_percent } else { 0 };
        let [f0, f1, f2, f3] = feed_um.to_le_bytes();
        let [b0, b1, b2, b3] = self.block.to_le_bytes();
        let [i0, i1, i2, i3] = ipt_nm.to_le_bytes();
        let [t0, t1, t2, t3, t4, t5, t6, t7] = self.at.0.to_le_bytes();
        let code = self.cause as u8;
        [LAYOUT, code, percent, detail, b0, b1, b2, b3, i0, i1, i2, i3, f0, f1, f2, f3, t0, t1, t2, t3, t4, t5, t6, t7]
    }

    /// Reads a record from bytes.
    ///
    /// # Errors
    /// The first invalid byte.
    pub fn decode(bytes: &[u8; RECORD_LEN]) -> Result<Self, DecodeError> {
        let [layout, code, percent, detail, rest @ ..] = *bytes;
        let [b0, b1, b2, b3, i0, i1, i2, i3, f0, f1, f2, f3, t0, t1, t2, t3, t4, t5, t6, t7] = rest;
        if layout != LAYOUT {
            return Err(DecodeError::Layout(layout));
        }
        let cause = Cause::of_code(code).ok_or(DecodeError::Cause(code))?;
        if percent > HIGHEST_PERCENT {
            return Err(DecodeError::Percent(percent));
        }
        if detail != 0 && cause != Cause::Floor {
            return Err(DecodeError::Detail(detail));
        }
        let some = |number: u32| (number != NONE).then_some(number);
        Ok(TelemetryRecord {
            at: Micros(u64::from_le_bytes([t0, t1, t2, t3, t4, t5, t6, t7])),
            feed_override: FeedOverride { percent },
            ipt_center_nm: some(u32::from_le_bytes([i0, i1, i2, i3])),
            feed_um_per_min: some(u32::from_le_bytes([f0, f1, f2, f3])),
            cause,
            chip_excess_percent: detail,
            block: u32::from_le_bytes([b0, b1, b2, b3]),
        })
    }
}

/// The nearest whole number of fractions of a millimetre; `None` for NaN and for negative numbers.
fn whole(mm: f32, parts_per_mm: i64) -> Option<u32> {
    let parts = mm * parts_per_mm as f32 + 0.5;
    // The cast saturates and drops the fraction.
    (mm >= 0.0 && mm.is_finite()).then_some((parts as u32).min(NONE - 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::supervisor::report::Alarm;
    use crate::supervisor::state::State;

    const RECORD: TelemetryRecord = TelemetryRecord {
        at: Micros(0x0102_0304_0506_0708),
        feed_override: FeedOverride { percent: 117 },
        ipt_center_nm: Some(101_600),
        feed_um_per_min: Some(0x1122_3344),
        cause: Cause::Floor,
        chip_excess_percent: 25,
        block: 0xA1B2_C3D4,
    };

    #[test]
    fn the_layout_is_the_documented_one() {
        let bytes = RECORD.encode();
        assert_eq!(bytes[..4], [1, 1, 117, 25]);
        assert_eq!(bytes[4..8], [0xD4, 0xC3, 0xB2, 0xA1]);
        assert_eq!(bytes[8..12], [0xE0, 0x8C, 0x01, 0x00]);
        assert_eq!(bytes[12..16], [0x44, 0x33, 0x22, 0x11]);
        assert_eq!(bytes[16..], [8, 7, 6, 5, 4, 3, 2, 1]);
    }

    #[test]
    fn every_override_cause_and_extreme_survives_the_way_there_and_back() {
        let mut records = 0;
        for percent in 0..=HIGHEST_PERCENT {
            for cause in (0..=255).filter_map(Cause::of_code) {
                for number in [None, Some(0), Some(101_600), Some(NONE - 1)] {
                    for (at, block) in [(0, 0), (u64::MAX, u32::MAX), (86_400_000_000, 52)] {
                        let record = TelemetryRecord {
                            at: Micros(at),
                            feed_override: FeedOverride { percent },
                            ipt_center_nm: number,
                            feed_um_per_min: number,
                            cause,
                            chip_excess_percent: if cause == Cause::Floor { percent } else { 0 },
                            block,
                        };
                        assert_eq!(TelemetryRecord::decode(&record.encode()), Ok(record));
                        records += 1;
                    }
                }
            }
        }
        println!("{records} records there and back");
    }

    #[test]
    fn whatever_decodes_encodes_to_the_same_bytes() {
        let (mut accepted, mut refused) = (0, 0);
        let mut random = 0x9E37_79B9_7F4A_7C15_u64;
        for _ in 0..200_000 {
            let mut bytes = [0; RECORD_LEN];
            for byte in &mut bytes {
                // xorshift64: reproducible without a dependency.
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                *byte = random as u8;
            }
            // Most random bytes are refused at once: let all four checks be reached.
            bytes[0] &= 1;
            bytes[1] &= 63;
            bytes[3] &= 1;
            match TelemetryRecord::decode(&bytes) {
                Ok(record) => {
                    assert_eq!(record.encode(), bytes);
                    accepted += 1;
                }
                Err(_) => refused += 1,
            }
        }
        println!("{accepted} accepted, {refused} refused");
        assert!(accepted > 10_000 && refused > 10_000);
    }

    #[test]
    fn what_makes_no_sense_is_refused_by_name() {
        let with = |at: usize, byte: u8| {
            let mut bytes = TelemetryRecord { cause: Cause::Law, chip_excess_percent: 0, ..RECORD }.encode();
            bytes[at] = byte;
            TelemetryRecord::decode(&bytes)
        };
        assert_eq!(with(0, 2), Err(DecodeError::Layout(2)));
        assert_eq!(with(1, 9), Err(DecodeError::Cause(9)));
        assert_eq!(with(2, 255), Err(DecodeError::Percent(255)));
        assert_eq!(with(3, 1), Err(DecodeError::Detail(1)));
    }

    #[test]
    fn numbers_are_rounded_and_what_is_none_is_left_out() {
        let nm = |mm: f32| whole(mm, NM_PER_MM);
        assert_eq!(nm(0.1016), Some(101_600));
        assert_eq!(nm(0.0), Some(0));
        assert_eq!(nm(0.000_001_4), Some(1));
        assert_eq!(nm(1e30), Some(NONE - 1));
        for none in [f32::NAN, f32::INFINITY, -1.0] {
            assert_eq!(nm(none), None);
        }
    }

    #[test]
    fn what_a_tick_decides_is_what_is_recorded() {
        let output = Output {
            feed_override: FeedOverride { percent: 10 },
            state: State::Running,
            reason: Reason::Floor { chip_excess_percent: 300 },
            alarm: Alarm::None,
            refusal: None,
            ipt_center: Some(MmPerTooth(0.1)),
        };
        let record = TelemetryRecord::new(Micros(5), None, &output);
        assert_eq!((record.cause, record.chip_excess_percent), (Cause::Floor, 255));
        assert_eq!((record.ipt_center_nm, record.feed_um_per_min), (Some(100_000), None));
        assert_eq!((record.block, record.at), (0, Micros(5)));
    }
}
