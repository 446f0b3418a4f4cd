//! Settings of the serial line, for both ends, and counters of its traffic.
//!
//! Source: B-63503EN p. 62 (start-stop, eight bits with parity, two stop bits; ten characters after DC3). Buffer sizes
//! and levels are not published: assumed.

use super::code::{with_even_parity, without_parity};
use super::tape::TapeSettings;

/// Settings of the serial (DNC) line, for both ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineSettings {
    /// Bits per second.
    pub baudrate: u32,
    /// Bits that a character takes on the line: start, data, parity and stop bits.
    pub bits_per_char: u32,
    /// Parity that the sender's hardware applies to its bytes.
    pub sender: SenderParity,
    /// Size of the control's receive buffer, characters.
    pub buffer: usize,
    /// Number of free characters in the buffer below which the control sends DC3 (XOFF).
    pub xoff_below: usize,
    /// Number of free characters in the buffer above which the control sends DC1 (XON).
    pub xon_above: usize,
    /// Number of characters that the control accepts after DC3; one more is alarm PS0087.
    pub after_dc3_max: u32,
    /// Settings by which the received characters are decoded and checked.
    pub tape: TapeSettings,
}

impl Default for LineSettings {
    /// 9600 baud, 7E2.
    fn default() -> Self {
        LineSettings {
            baudrate: 9_600,
            bits_per_char: 11,
            sender: SenderParity::Even,
            buffer: 1_024,
            xoff_below: 256,
            xon_above: 768,
            after_dc3_max: 10,
            tape: TapeSettings::default(),
        }
    }
}

/// Parity bit that the sender's hardware adds to the characters it sends, and removes from those it receives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SenderParity {
    /// Eight data bits, no parity: bytes travel as they are.
    None,
    /// Seven data bits, even.
    Even,
    /// Seven data bits, odd.
    Odd,
}

impl SenderParity {
    /// Character on the line, with its parity bit, for a byte that the sender sends.
    pub fn frame(self, byte: u8) -> u8 {
        match self {
            SenderParity::None => byte,
            SenderParity::Even => with_even_parity(byte),
            SenderParity::Odd => with_even_parity(byte) ^ 0x80,
        }
    }

    /// Byte that the sender reads for a character that the control sends; its parity bit is removed.
    pub fn byte(self, frame: u8) -> u8 {
        match self {
            SenderParity::None => frame,
            SenderParity::Even | SenderParity::Odd => without_parity(frame),
        }
    }
}

/// Counters of the characters that the control has received over the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineCounters {
    /// Characters received.
    pub bytes: u64,
    /// Number of times that the control has sent DC3 (XOFF).
    pub xoff_count: u32,
    /// Largest number of characters that arrived after one DC3.
    pub max_bytes_after_xoff: u32,
}
