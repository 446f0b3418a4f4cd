//! Counters of a link.

use arcfeed_units::Span;

/// Counts since the link was created; all wrap around.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Frames sent, including retransmissions.
    pub frames_out: u32,
    /// Bytes sent.
    pub bytes_out: u32,
    /// Valid frames from the peer in this session.
    pub frames_in: u32,
    /// Copies: valid frames with a time stamp before that of an earlier frame; they have no effect.
    pub copies: u32,
    /// Bytes received, valid or not.
    pub bytes_in: u32,
    /// Frames with a wrong checksum.
    pub crc_errors: u32,
    /// Frames that are too long, too short, or malformed.
    pub framing_errors: u32,
    /// Valid frames of a session that is not, or no longer, the peer's.
    pub stale_sessions: u32,
    /// Reliable messages received again.
    pub duplicates: u32,
    /// Reliable messages received after a missing one.
    pub gaps: u32,
    /// Reliable messages rejected because this end was busy.
    pub refused: u32,
    /// Acknowledgements of messages that were never sent.
    pub bad_acks: u32,
    /// Retransmitted reliable messages.
    pub retransmissions: u32,
    /// Time-outs of the retransmission timer.
    pub timeouts: u32,
    /// Accepted requests for retransmission (nak).
    pub naks: u32,
    /// Latest-wins values replaced by a newer one before they were sent.
    pub replaced: u32,
    /// Latest-wins values that expired before they were sent.
    pub expired_out: u32,
    /// Latest-wins values that had expired on arrival.
    pub expired_in: u32,
    /// Latest-wins values that arrived after a newer one, or twice.
    pub outdated: u32,
    /// Steps of the peer's clock.
    pub clock_steps: u32,
    /// Smoothed round trip of reliable messages.
    pub srtt: Span,
    /// Current retransmission time-out.
    pub rto: Span,
}
