//! Settings of a link between host and board: role, times and limits.

use super::frame::ENCODED_MAX;
use arcfeed_units::{Micros, Span, US_PER_S};

/// Bits per byte on the line: start bit, eight data bits, stop bit.
pub const BITS_PER_BYTE: u64 = 10;

const HEARTBEAT_MIN: Span = Span::from_ms(1);
const HEARTBEAT_MAX: Span = Span::from_ms(50_000);
const DRIFT_MAX_PPM: u32 = 10_000;
/// Number of hellos per heartbeat: a restarted end is noticed within a heartbeat even if two hellos are corrupt.
const HELLOS_PER_HEARTBEAT: u32 = 3;

/// Role of an end of the link. Each end accepts only frames of the other role, so it does not take its own echo for
/// the peer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Role {
    /// The end with the job: the host program.
    Host = 1,
    /// The end that sets the override: the board.
    Board = 2,
}

impl Role {
    /// Role of the peer.
    pub const fn other(self) -> Self {
        match self {
            Role::Host => Role::Board,
            Role::Board => Role::Host,
        }
    }
}

/// Times and limits of one end of a link between host and board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkSettings {
    /// Role of this end.
    pub role: Role,
    /// Hash of all messages and their fields; both ends must have the same one.
    pub schema: u32,
    /// Bit rate of the line, at ten bits for each byte; 0 for unlimited (memory, sockets).
    pub bits_per_s: u32,
    /// Time by which bytes may be passed to the line before it can send them: the longest time between two calls. If
    /// it is longer, values become old in the driver's buffer.
    pub ahead: Span,
    /// Longest time between two heartbeats (signs of life) that this end sends.
    pub heartbeat: Span,
    /// Time without a valid frame of the peer after which the link is lost; late copies of frames do not count.
    pub lost_after: Span,
    /// Age of the oldest unacknowledged reliable message from which the link is lost, although frames of the peer
    /// arrive and the peer is not busy.
    pub unacknowledged_after: Span,
    /// Longest time for which an acknowledgement waits for another frame that can carry it.
    pub ack_delay: Span,
    /// Smallest time-out after which an unacknowledged message is sent again.
    pub rto_floor: Span,
    /// Largest value of that time-out, which is also its first one.
    pub rto_ceiling: Span,
    /// Largest difference between the rates of both clocks, parts per million.
    pub drift_max_ppm: u32,
    /// Number of consecutive invalid frames from which the link is lost.
    pub bad_frames_max: u32,
}

/// Reason why settings of a link are invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SettingsError {
    /// The heartbeat interval is shorter than 1 ms or longer than 50 s.
    Heartbeat(Span),
    /// `lost_after` is so short that a single lost heartbeat would end the link.
    LostAfter(Span),
    /// The smallest retransmission time-out is zero, or above the largest.
    Rto(Span, Span),
    /// `unacknowledged_after` ends before the first retransmission.
    UnacknowledgedAfter(Span),
    /// The bit rate is so low that one frame takes longer than `lost_after`.
    BitsPerS(u32),
    /// `bad_frames_max` is zero.
    BadFramesMax,
    /// `drift_max_ppm` is above 10 000.
    DriftMaxPpm(u32),
}

impl LinkSettings {
    /// Settings for a line of 115 200 bit/s, with time-outs that most USB adapters keep. `schema` is the hash of the messages.
    pub const fn new(role: Role, schema: u32) -> Self {
        LinkSettings {
            role,
            schema,
            bits_per_s: 115_200,
            ahead: Span::from_ms(3),
            heartbeat: Span::from_ms(50),
            lost_after: Span::from_ms(250),
            unacknowledged_after: Span::from_ms(3_000),
            ack_delay: Span::from_ms(5),
            rto_floor: Span::from_ms(100),
            rto_ceiling: Span::from_ms(500),
            drift_max_ppm: 500,
            bad_frames_max: 20,
        }
    }

    /// Time between two hellos while the link is not up.
    pub const fn hello_every(&self) -> Span {
        Span(self.heartbeat.0 / HELLOS_PER_HEARTBEAT)
    }

    /// Time that the longest frame takes on the line; zero if the bit rate is unlimited.
    pub fn longest_frame(&self) -> Span {
        let bits_us = ENCODED_MAX as u64 * BITS_PER_BYTE * US_PER_S;
        Micros(bits_us.checked_div(u64::from(self.bits_per_s)).unwrap_or(0)).into()
    }

    /// Checks that the settings fit each other.
    ///
    /// # Errors
    /// The first invalid setting.
    pub fn check(&self) -> Result<(), SettingsError> {
        let two_heartbeats = self.heartbeat.longer_by(self.heartbeat);
        if self.heartbeat < HEARTBEAT_MIN || self.heartbeat > HEARTBEAT_MAX {
            Err(SettingsError::Heartbeat(self.heartbeat))
        } else if self.lost_after < two_heartbeats {
            Err(SettingsError::LostAfter(self.lost_after))
        } else if self.lost_after < self.longest_frame() {
            Err(SettingsError::BitsPerS(self.bits_per_s))
        } else if self.rto_floor == Span(0) || self.rto_floor > self.rto_ceiling {
            Err(SettingsError::Rto(self.rto_floor, self.rto_ceiling))
        } else if self.unacknowledged_after <= self.rto_ceiling {
            Err(SettingsError::UnacknowledgedAfter(self.unacknowledged_after))
        } else if self.bad_frames_max == 0 {
            Err(SettingsError::BadFramesMax)
        } else if self.drift_max_ppm > DRIFT_MAX_PPM {
            Err(SettingsError::DriftMaxPpm(self.drift_max_ppm))
        } else {
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_that_cannot_work_are_refused_by_name() {
        let good = LinkSettings::new(Role::Host, 0);
        let ms = Span::from_ms;
        let cases = [
            (LinkSettings { heartbeat: ms(0), ..good }, SettingsError::Heartbeat(ms(0))),
            (LinkSettings { heartbeat: ms(50_001), ..good }, SettingsError::Heartbeat(ms(50_001))),
            (LinkSettings { lost_after: ms(99), ..good }, SettingsError::LostAfter(ms(99))),
            (LinkSettings { bits_per_s: 9_600, ..good }, SettingsError::BitsPerS(9_600)),
            (LinkSettings { rto_floor: ms(0), ..good }, SettingsError::Rto(ms(0), ms(500))),
            (LinkSettings { rto_floor: ms(501), ..good }, SettingsError::Rto(ms(501), ms(500))),
            (LinkSettings { unacknowledged_after: ms(500), ..good }, SettingsError::UnacknowledgedAfter(ms(500))),
            (LinkSettings { bad_frames_max: 0, ..good }, SettingsError::BadFramesMax),
            (LinkSettings { drift_max_ppm: 10_001, ..good }, SettingsError::DriftMaxPpm(10_001)),
        ];
        assert_eq!(good.check(), Ok(()));
        for (settings, error) in cases {
            assert_eq!(settings.check(), Err(error));
        }
    }

    #[test]
    fn the_longest_frame_takes_its_bytes_at_ten_bits_each() {
        assert_eq!(
            LinkSettings { bits_per_s: 100_000, ..LinkSettings::new(Role::Host, 0) }.longest_frame(),
            Span(24_300)
        );
        assert_eq!(LinkSettings { bits_per_s: 0, ..LinkSettings::new(Role::Host, 0) }.longest_frame(), Span(0));
    }
}
