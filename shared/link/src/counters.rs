//! Counters of a link between host and board.

use arcfeed_units::Span;

/// Counts of frames, bytes, errors and repetitions since the link was created; all wrap around.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Frames sent, including retransmissions.
    pub frames_out: u32,
    /// Bytes sent.
    pub bytes_out: u32,
    /// Valid frames from the peer in this session.
    pub frames_in: u32,
    /// Valid frames with an older time stamp than a frame before them: late copies, which are ignored.
    pub copies: u32,
    /// Bytes received, valid or not.
    pub bytes_in: u32,
    /// Frames with a wrong checksum.
    pub crc_errors: u32,
    /// Frames that are too long, too short, or malformed.
    pub framing_errors: u32,
    /// Valid frames that belong to the previous pair of sessions of both ends.
    pub stale_sessions: u32,
    /// Reliable messages received again.
    pub duplicates: u32,
    /// Reliable messages received while an earlier one is missing; they are discarded and requested again.
    pub gaps: u32,
    /// Reliable messages rejected because this end was not ready to accept any.
    pub refused: u32,
    /// Acknowledgements of messages that were never sent.
    pub bad_acks: u32,
    /// Retransmitted reliable messages.
    pub retransmissions: u32,
    /// Time-outs of the retransmission timer.
    pub timeouts: u32,
    /// Requests for retransmission (nak) by the peer that were followed.
    pub naks: u32,
    /// Values (latest-wins messages) replaced by a newer one before they were sent.
    pub replaced: u32,
    /// Values (latest-wins messages) whose time to live ended before they were sent.
    pub expired_out: u32,
    /// Values (latest-wins messages) whose time to live had ended on arrival.
    pub expired_in: u32,
    /// Values (latest-wins messages) that arrived after a newer one, or twice.
    pub outdated: u32,
    /// Number of times that the peer's clock was found to have stepped.
    pub clock_steps: u32,
    /// Smoothed time from sending a reliable message to its acknowledgement; zero before the first.
    pub srtt: Span,
    /// Current time-out after which an unacknowledged reliable message is sent again.
    pub rto: Span,
}
