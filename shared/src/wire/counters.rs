//! What a link has seen and done.

use crate::units::Span;

/// Counts since the link was made; all wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Frames handed out, retransmissions among them.
    pub frames_out: u32,
    /// Bytes handed out.
    pub bytes_out: u32,
    /// Valid frames of the peer and this session.
    pub frames_in: u32,
    /// Valid frames with a time stamp before that of one heard already: copies, which do nothing.
    pub copies: u32,
    /// Bytes taken in, valid or not.
    pub bytes_in: u32,
    /// Frames whose checksum does not fit.
    pub crc_errors: u32,
    /// Too long, too short, or no frame at all.
    pub framing_errors: u32,
    /// Whole frames of a session that is not, or no longer, the peer's.
    pub stale_sessions: u32,
    /// Reliable messages received again.
    pub duplicates: u32,
    /// Reliable messages received before one that is missing.
    pub gaps: u32,
    /// Reliable messages received while there was no room.
    pub refused: u32,
    /// Acknowledgements of what was never sent.
    pub bad_acks: u32,
    /// Reliable messages sent again.
    pub retransmissions: u32,
    /// Timeouts of the retransmission timer.
    pub timeouts: u32,
    /// Requests to send again that were followed.
    pub naks: u32,
    /// Latest-wins values replaced by a newer one before they went out.
    pub replaced: u32,
    /// Latest-wins values whose time was over before they went out.
    pub expired_out: u32,
    /// Latest-wins values whose time was over when they came in.
    pub expired_in: u32,
    /// Latest-wins values that came in behind a newer one, or twice.
    pub outdated: u32,
    /// The peer's clock was found where it could not be.
    pub clock_steps: u32,
    /// Smoothed round trip of reliable messages.
    pub srtt: Span,
    /// Retransmission timeout now.
    pub rto: Span,
}
