//! Numbers of RFC 2217, the same at both ends.

use crate::settings::Parity;

/// Telnet's binary transmission: no bytes added behind CR.
const BINARY: u8 = 0;
/// Telnet's suppress go ahead.
const SGA: u8 = 3;
/// COM-PORT-OPTION.
pub const COM_PORT: u8 = 44;
/// Options that both ends use.
pub const OPTIONS: [u8; 3] = [COM_PORT, BINARY, SGA];

/// Signature: text that identifies an end.
pub const SIGNATURE: u8 = 0;
/// Baud rate: four bytes, the highest first.
pub const SET_BAUDRATE: u8 = 1;
/// Data bits.
pub const SET_DATASIZE: u8 = 2;
/// Parity, see [`parity_code`].
pub const SET_PARITY: u8 = 3;
/// Stop bits: 1, 2, or 3 for one and a half.
pub const SET_STOPSIZE: u8 = 4;
/// Flow control, break, DTR, RTS.
pub const SET_CONTROL: u8 = 5;
/// Errors of the line.
pub const NOTIFY_LINESTATE: u8 = 6;
/// The modem lines.
pub const NOTIFY_MODEMSTATE: u8 = 7;
/// Stops the data of the other end.
pub const SUSPEND: u8 = 8;
/// Continues the data.
pub const RESUME: u8 = 9;
/// Mask of the reported line errors.
pub const SET_LINESTATE_MASK: u8 = 10;
/// Mask of the reported modem lines.
pub const SET_MODEMSTATE_MASK: u8 = 11;
/// Discards received data (1), data to be sent (2), both (3).
pub const PURGE_DATA: u8 = 12;
/// Difference between the code of an answer and that of its request.
pub const ANSWER: u8 = 100;

/// Code of a parity in [`SET_PARITY`].
pub const fn parity_code(parity: Parity) -> u8 {
    match parity {
        Parity::None => 1,
        Parity::Odd => 2,
        Parity::Even => 3,
    }
}
