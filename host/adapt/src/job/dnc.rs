//! `[dnc]`: reading mode of the control, and time-outs of the sender.

use arcfeed_units::{Micros, US_PER_S};
use toml::Spanned;

use super::SerialSettings;
use super::schema::DncTable;
use super::{Complaint, at};

/// Longest wait that a job may set.
const TIMEOUT_MAX_S: f64 = 86_400.0;
/// Longest reaction time that a job may set.
const REACTION_MAX_S: f64 = 10.0;
/// Assumed look-ahead of a control in blocks, unless the job sets it: the largest value in docs/control.md.
const READ_AHEAD: usize = 200;

/// Settings of the DNC sender: reading mode of the control, and time-outs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DncSettings {
    /// Character code that the sender itself produces, on a line of eight bits. `None`: the serial port's parity bit
    /// makes ISO code out of ASCII, or the control checks no parity.
    pub code: Option<TapeCode>,
    /// The TV check of the control is on: blocks must have an even number of characters.
    pub tv_check: bool,
    /// Longest time from the arrival of a DC3 until the sender stops, if the job sets it; otherwise it is assumed.
    pub reaction: Option<Micros>,
    /// Longest wait for the control's first DC1.
    pub start_timeout: Micros,
    /// Longest wait for DC1 after a DC3.
    pub xoff_timeout: Micros,
    /// Number of blocks after which the control reports its position; `None`: it reports nothing.
    pub report_every: Option<usize>,
    /// Largest number of blocks that the control reads ahead.
    pub read_ahead: usize,
}

/// Character code that the sender makes itself, on a line of eight bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapeCode {
    /// ISO: ASCII with even parity in the eighth bit.
    Iso,
    /// EIA (RS-244): a code of its own with odd parity.
    Eia,
    /// ASCII with the eighth bit 0.
    Ascii,
}

impl Default for DncSettings {
    fn default() -> Self {
        DncSettings {
            code: None,
            tv_check: false,
            reaction: None,
            start_timeout: Micros::from_ms(300_000),
            xoff_timeout: Micros::from_ms(1_800_000),
            report_every: None,
            read_ahead: READ_AHEAD,
        }
    }
}

/// DNC settings from the `[dnc]` table of a job; fails at the first value that makes no sense.
pub fn build(given: &DncTable, serial: &SerialSettings) -> Result<DncSettings, Complaint> {
    let code = match &given.code {
        None => None,
        Some(code) if !serial.is_bare() => {
            let message =
                "with this line its parity bit makes the code; remove code, or set bytesize = 8 and parity = \"N\"";
            return Err(at(code, message));
        }
        Some(code) => Some(match code.as_ref().as_str() {
            "iso" => TapeCode::Iso,
            "eia" => TapeCode::Eia,
            "ascii" => TapeCode::Ascii,
            _ => return Err(at(code, "no such code; write \"iso\", \"eia\" or \"ascii\"")),
        }),
    };
    let default = DncSettings::default();
    let time = |given: &Option<Spanned<f64>>, name: &str, most: f64, default: Micros| match given {
        None => Ok(default),
        Some(value) if (0.0..=most).contains(value.as_ref()) => Ok(Micros((value.as_ref() * US_PER_S as f64) as u64)),
        Some(value) => Err(at(value, &format!("{name} must be seconds, 0 to {most}"))),
    };
    match (&given.report_every, code) {
        (Some(every), Some(TapeCode::Eia)) => {
            return Err(at(
                every,
                "EIA has no # [ ]: a control cannot be asked for reports in it; remove this, or use ISO",
            ));
        }
        (Some(every), _) if *every.as_ref() == 0 => {
            return Err(at(every, "report_every counts blocks, from 1; leave it out for no reports"));
        }
        _ => {}
    }
    let reaction = time(&given.reaction, "reaction", REACTION_MAX_S, Micros(0))?;
    Ok(DncSettings {
        code,
        tv_check: given.tv_check,
        reaction: given.reaction.is_some().then_some(reaction),
        start_timeout: time(&given.start_timeout, "start_timeout", TIMEOUT_MAX_S, default.start_timeout)?,
        xoff_timeout: time(&given.xoff_timeout, "xoff_timeout", TIMEOUT_MAX_S, default.xoff_timeout)?,
        report_every: given.report_every.as_ref().map(|every| *every.as_ref()),
        read_ahead: given.read_ahead.unwrap_or(READ_AHEAD),
    })
}
