//! One tick's decision as 20 bytes.
//!
//! Little endian, whole numbers only, so there is no NaN on the wire. Every record that decodes encodes to the same
//! bytes again. The bytes carry no checksum and no end mark: that is the business of the link they travel on.

use arcfeed_shared::units::{Micros, MmPerTooth, NM_PER_MM};

use super::reason::{code_of, reason_of};
use crate::controller::{Output, Reason};
use crate::ramp::FeedOverride;

/// Length of an encoded record, bytes.
pub const RECORD_LEN: usize = 20;

/// The first byte: this layout.
pub const LAYOUT: u8 = 1;

/// The highest override a record can say, %.
const HIGHEST_PERCENT: u8 = 254;

/// In place of a feed per tooth: there is none.
const NO_IPT: u32 = u32::MAX;

/// What a tick decided, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TelemetryRecord {
    /// When, by the board's clock.
    pub at: Micros,
    /// What was put out.
    pub feed_override: FeedOverride,
    /// The feed per tooth at the centre that the law wants, nanometres; at most `u32::MAX - 1`.
    pub ipt_center_nm: Option<u32>,
    /// Why.
    pub reason: Reason,
    /// Count of blocks begun.
    pub block: u32,
}

/// Why bytes are no record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// Another layout, or not the start of a record: its first byte.
    Layout(u8),
    /// A number that no reason has.
    Reason(u8),
    /// More than 254 %.
    Percent(u8),
    /// A byte of this layout that must be 0.
    Reserved(u8),
}

impl TelemetryRecord {
    /// The record of what a tick at `at` in the `block`-th block decided.
    pub fn new(at: Micros, block: u32, output: &Output) -> Self {
        TelemetryRecord {
            at,
            feed_override: output.feed_override,
            ipt_center_nm: output.ipt_center.and_then(to_nm),
            reason: output.reason,
            block,
        }
    }

    /// Its bytes.
    pub fn encode(&self) -> [u8; RECORD_LEN] {
        let percent = self.feed_override.percent.min(HIGHEST_PERCENT);
        let ipt_nm = self.ipt_center_nm.map_or(NO_IPT, |nm| nm.min(NO_IPT - 1));
        let [b0, b1, b2, b3] = self.block.to_le_bytes();
        let [i0, i1, i2, i3] = ipt_nm.to_le_bytes();
        let [t0, t1, t2, t3, t4, t5, t6, t7] = self.at.0.to_le_bytes();
        let reason = code_of(self.reason);
        [LAYOUT, reason, percent, 0, b0, b1, b2, b3, i0, i1, i2, i3, t0, t1, t2, t3, t4, t5, t6, t7]
    }

    /// Reads its bytes.
    ///
    /// # Errors
    /// The first byte that makes no sense.
    pub fn decode(bytes: &[u8; RECORD_LEN]) -> Result<Self, DecodeError> {
        let [layout, code, percent, reserved, b0, b1, b2, b3, i0, i1, i2, i3, t0, t1, t2, t3, t4, t5, t6, t7] = *bytes;
        if layout != LAYOUT {
            return Err(DecodeError::Layout(layout));
        }
        let reason = reason_of(code).ok_or(DecodeError::Reason(code))?;
        if percent > HIGHEST_PERCENT {
            return Err(DecodeError::Percent(percent));
        }
        if reserved != 0 {
            return Err(DecodeError::Reserved(reserved));
        }
        let ipt_nm = u32::from_le_bytes([i0, i1, i2, i3]);
        Ok(TelemetryRecord {
            at: Micros(u64::from_le_bytes([t0, t1, t2, t3, t4, t5, t6, t7])),
            feed_override: FeedOverride { percent },
            ipt_center_nm: (ipt_nm != NO_IPT).then_some(ipt_nm),
            reason,
            block: u32::from_le_bytes([b0, b1, b2, b3]),
        })
    }
}

/// The nearest whole nanometre; nothing for what is not a number or below zero.
fn to_nm(ipt: MmPerTooth) -> Option<u32> {
    let nm = ipt.0 * NM_PER_MM as f32 + 0.5;
    // The cast saturates and drops the fraction.
    (ipt.0 >= 0.0 && ipt.0.is_finite()).then_some((nm as u32).min(NO_IPT - 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ramp::Bound;

    const RECORD: TelemetryRecord = TelemetryRecord {
        at: Micros(0x0102_0304_0506_0708),
        feed_override: FeedOverride { percent: 117 },
        ipt_center_nm: Some(101_600),
        reason: Reason::Bounded(Bound::Slew),
        block: 0xA1B2_C3D4,
    };

    #[test]
    fn the_layout_is_the_documented_one() {
        let bytes = RECORD.encode();
        assert_eq!(bytes[..4], [1, 3, 117, 0]);
        assert_eq!(bytes[4..8], [0xD4, 0xC3, 0xB2, 0xA1]);
        assert_eq!(bytes[8..12], [0xE0, 0x8C, 0x01, 0x00]);
        assert_eq!(bytes[12..], [8, 7, 6, 5, 4, 3, 2, 1]);
    }

    #[test]
    fn every_override_reason_and_extreme_survives_the_way_there_and_back() {
        let mut records = 0;
        for percent in 0..=HIGHEST_PERCENT {
            for reason in (0..=255).filter_map(reason_of) {
                for ipt_center_nm in [None, Some(0), Some(101_600), Some(NO_IPT - 1)] {
                    for (at, block) in [(0, 0), (u64::MAX, u32::MAX), (86_400_000_000, 52)] {
                        let feed_override = FeedOverride { percent };
                        let record = TelemetryRecord { at: Micros(at), feed_override, ipt_center_nm, reason, block };
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
            bytes[1] &= 31;
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
            let mut bytes = RECORD.encode();
            bytes[at] = byte;
            TelemetryRecord::decode(&bytes)
        };
        assert_eq!(with(0, 2), Err(DecodeError::Layout(2)));
        assert_eq!(with(1, 8), Err(DecodeError::Reason(8)));
        assert_eq!(with(2, 255), Err(DecodeError::Percent(255)));
        assert_eq!(with(3, 1), Err(DecodeError::Reserved(1)));
    }

    #[test]
    fn the_feed_per_tooth_is_rounded_and_what_is_none_is_left_out() {
        let nm = |mm: f32| to_nm(MmPerTooth(mm));
        assert_eq!(nm(0.1016), Some(101_600));
        assert_eq!(nm(0.0), Some(0));
        assert_eq!(nm(0.000_001_4), Some(1));
        assert_eq!(nm(1e30), Some(NO_IPT - 1));
        for none in [f32::NAN, f32::INFINITY, -1.0] {
            assert_eq!(nm(none), None);
        }
        let output = Output {
            feed_override: FeedOverride { percent: 100 },
            ipt_center: None,
            wanted_ratio: 1.0,
            reason: Reason::Inhibited,
        };
        let record = TelemetryRecord::new(Micros(5), 7, &output);
        assert_eq!((record.ipt_center_nm, record.block, record.at), (None, 7, Micros(5)));
    }
}
