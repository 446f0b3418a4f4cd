//! `[serial]`: the DNC line, with pyserial's names and defaults, except that XON/XOFF is on. Settings that make no
//! sense for a sender are rejected.

use arcfeed_units::{Micros, US_PER_S};
use toml::Spanned;

use super::schema::SerialTable;
use super::{Complaint, at};

/// Longest wait that a job may set.
const TIMEOUT_MAX_S: f64 = 86_400.0;
/// Shortest wait: less would round to 0.
const TIMEOUT_MIN_S: f64 = 0.001;

/// The DNC line, with pyserial's names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SerialSettings {
    /// Bits per second.
    pub baudrate: u32,
    /// Data bits.
    pub bytesize: u8,
    /// Parity.
    pub parity: Parity,
    /// Stop bits.
    pub stopbits: u8,
    /// XON/XOFF, handled by the sender itself.
    pub xonxoff: bool,
    /// RTS/CTS, handled by the driver or by the server at the other end of `rfc2217://`.
    pub rtscts: bool,
    /// Longest time in which the line may accept no character; the default is that of
    /// [`SerialSettings::write_timeout`].
    pub write_timeout: Option<Micros>,
    /// No other program may open the port.
    pub exclusive: bool,
}

/// Parity of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// No parity bit (N).
    None,
    /// Even parity (E).
    Even,
    /// Odd parity (O).
    Odd,
}

impl SerialSettings {
    /// Bits on the line per character.
    pub fn bits_per_char(&self) -> u32 {
        1 + u32::from(self.bytesize) + u32::from(self.parity != Parity::None) + u32::from(self.stopbits)
    }

    /// Whether characters have eight bits and no parity bit, so that the sender can make their code itself.
    pub fn is_bare(&self) -> bool {
        self.bytesize == 8 && self.parity == Parity::None
    }

    /// Longest time in which the line may accept no character: unlimited with RTS/CTS, by which the control may stop
    /// it. Otherwise only the sender can stop the line, so that one that accepts nothing is broken.
    pub fn write_timeout(&self) -> Option<Micros> {
        self.write_timeout.or((!self.rtscts).then_some(Micros::from_ms(5_000)))
    }
}

/// Checks the table.
pub fn build(given: &SerialTable) -> Result<SerialSettings, Complaint> {
    let choice = |value: &Spanned<u8>, allowed: std::ops::RangeInclusive<u8>, name: &str| {
        let (low, high) = (allowed.start(), allowed.end());
        if allowed.contains(value.as_ref()) {
            Ok(*value.as_ref())
        } else {
            Err(at(value, &format!("{name} must be {low} to {high}")))
        }
    };
    let baudrate = *given.baudrate.as_ref();
    if !(50..=4_000_000).contains(&baudrate) {
        return Err(at(&given.baudrate, "baudrate must lie between 50 and 4000000"));
    }
    refuse_what_has_no_meaning(given)?;
    Ok(SerialSettings {
        baudrate,
        bytesize: choice(&given.bytesize, 5..=8, "bytesize")?,
        parity: match given.parity.as_ref().as_str() {
            "N" => Parity::None,
            "E" => Parity::Even,
            "O" => Parity::Odd,
            _ => return Err(at(&given.parity, "parity must be \"N\", \"E\" or \"O\"")),
        },
        stopbits: choice(&given.stopbits, 1..=2, "stopbits")?,
        // Most controls use XON/XOFF; it is never on together with RTS/CTS.
        xonxoff: given.xonxoff.unwrap_or(!*given.rtscts.as_ref()),
        rtscts: *given.rtscts.as_ref(),
        write_timeout: given.write_timeout.as_ref().map(write_timeout).transpose()?,
        exclusive: given.exclusive.unwrap_or(true),
    })
}

fn refuse_what_has_no_meaning(given: &SerialTable) -> Result<(), Complaint> {
    if *given.rtscts.as_ref() && given.xonxoff == Some(true) {
        return Err(at(&given.rtscts, "xonxoff and rtscts together: keep the one that the control is set to"));
    }
    if *given.dsrdtr.as_ref() {
        return Err(at(&given.dsrdtr, "no DSR/DTR flow control here; write rtscts = true or xonxoff = true"));
    }
    for (value, name) in [(&given.timeout, "timeout"), (&given.inter_byte_timeout, "inter_byte_timeout")] {
        if let Some(value) = value {
            return Err(at(value, &format!("{name}: a sender never waits for characters to read; remove it")));
        }
    }
    Ok(())
}

fn write_timeout(seconds: &Spanned<f64>) -> Result<Micros, Complaint> {
    let given = *seconds.as_ref();
    if (TIMEOUT_MIN_S..=TIMEOUT_MAX_S).contains(&given) {
        Ok(Micros((given * US_PER_S as f64) as u64))
    } else {
        Err(at(seconds, "write_timeout must be seconds, more than 0 (from 0.001) and at most 86400 (a day)"))
    }
}
