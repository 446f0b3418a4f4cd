//! The numbers of RFC 2217, the same at both ends.

use crate::job::Parity;

/// Telnet's binary transmission: no bytes added behind CR.
const BINARY: u8 = 0;
/// Telnet's suppress go ahead.
const SGA: u8 = 3;
/// COM-PORT-OPTION.
pub const COM_PORT: u8 = 44;
/// What both ends speak.
pub const OPTIONS: [u8; 3] = [COM_PORT, BINARY, SGA];

/// Who is there, in words.
pub const SIGNATURE: u8 = 0;
/// Four bytes, the highest first.
pub const SET_BAUDRATE: u8 = 1;
/// Data bits.
pub const SET_DATASIZE: u8 = 2;
/// As [`parity_code`].
pub const SET_PARITY: u8 = 3;
/// 1, 2, or 3 for one and a half.
pub const SET_STOPSIZE: u8 = 4;
/// Flow control, break, DTR, RTS.
pub const SET_CONTROL: u8 = 5;
/// Errors of the line.
pub const NOTIFY_LINESTATE: u8 = 6;
/// The modem lines.
pub const NOTIFY_MODEMSTATE: u8 = 7;
/// No more data.
pub const SUSPEND: u8 = 8;
/// Data again.
pub const RESUME: u8 = 9;
/// Which errors are told.
pub const SET_LINESTATE_MASK: u8 = 10;
/// Which modem lines are told.
pub const SET_MODEMSTATE_MASK: u8 = 11;
/// Throw away what was received (1), what is to be sent (2), both (3).
pub const PURGE_DATA: u8 = 12;
/// From the code of a request to that of its answer.
pub const ANSWER: u8 = 100;

/// The value of [`SET_PARITY`].
pub const fn parity_code(parity: Parity) -> u8 {
    match parity {
        Parity::None => 1,
        Parity::Odd => 2,
        Parity::Even => 3,
    }
}
