//! `[serial]`: the DNC line, with pyserial's names and defaults, except that XON/XOFF is on. Settings that make no
//! sense for a sender are rejected.

use arcfeed_port::settings::{Parity, SerialSettings};
use arcfeed_units::{Micros, US_PER_S};
use toml::Spanned;

use super::schema::SerialTable;
use super::{Complaint, at};

/// Longest wait that a job may set.
const TIMEOUT_MAX_S: f64 = 86_400.0;
/// Shortest wait: less would round to 0.
const TIMEOUT_MIN_S: f64 = 0.001;

/// Settings of the serial line from the `[serial]` table of a job; fails at the first value that makes no sense.
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
