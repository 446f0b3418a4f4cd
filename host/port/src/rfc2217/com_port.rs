//! Numbers of RFC 2217 (serial port control over Telnet), used by client and server. `SET_...`, `NOTIFY_...` and the
//! like are commands of its option.

use crate::settings::Parity;

/// Telnet's binary transmission: no bytes added behind CR.
const BINARY: u8 = 0;
/// Telnet's suppress go ahead.
const SGA: u8 = 3;
/// Number of the Telnet option COM-PORT-OPTION.
pub const COM_PORT: u8 = 44;
/// Telnet options that client and server agree on: COM-PORT-OPTION, binary transmission, suppress go-ahead.
pub const OPTIONS: [u8; 3] = [COM_PORT, BINARY, SGA];

/// Command SIGNATURE: text that identifies the software of an end.
pub const SIGNATURE: u8 = 0;
/// Command that sets the baud rate, four bytes, the most significant first; 0 asks for the present one.
pub const SET_BAUDRATE: u8 = 1;
/// Command that sets the number of data bits.
pub const SET_DATASIZE: u8 = 2;
/// Command that sets the parity, by the codes of [`parity_code`].
pub const SET_PARITY: u8 = 3;
/// Command that sets the stop bits: 1, 2, or 3 for one and a half.
pub const SET_STOPSIZE: u8 = 4;
/// Command that sets flow control, break, DTR or RTS.
pub const SET_CONTROL: u8 = 5;
/// Report of errors on the serial line, from server to client.
pub const NOTIFY_LINESTATE: u8 = 6;
/// Report of the state of the modem lines, from server to client.
pub const NOTIFY_MODEMSTATE: u8 = 7;
/// Request that the other end sends no more data for the present.
pub const SUSPEND: u8 = 8;
/// Permission that the other end sends data again.
pub const RESUME: u8 = 9;
/// Command that selects the line errors to be reported.
pub const SET_LINESTATE_MASK: u8 = 10;
/// Command that selects the modem lines whose changes are reported.
pub const SET_MODEMSTATE_MASK: u8 = 11;
/// Command that discards data in the server: received from the line (1), to be sent on the line (2), or both (3).
pub const PURGE_DATA: u8 = 12;
/// Number added to a client's command code to get the code of the server's answer.
pub const ANSWER: u8 = 100;

/// Code of a parity in the command [`SET_PARITY`]: 1 none, 2 odd, 3 even.
pub const fn parity_code(parity: Parity) -> u8 {
    match parity {
        Parity::None => 1,
        Parity::Odd => 2,
        Parity::Even => 3,
    }
}
