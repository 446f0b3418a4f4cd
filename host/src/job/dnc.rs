//! `[dnc]`: how the control reads what is sent, and how long the sender waits for it.

use arcfeed_shared::units::{Micros, US_PER_S};
use toml::Spanned;

use super::schema::DncTable;
use super::serial::{Parity, SerialSettings};
use super::{Complaint, at};

/// Longest wait that can be asked for.
const TIMEOUT_MAX_S: f64 = 86_400.0;
/// Slowest reaction that can be told.
const REACTION_MAX_S: f64 = 10.0;
/// Blocks that a control reads ahead unless the job says it: the most of those in docs/control.md, assumed.
const READ_AHEAD: usize = 200;

/// How the control reads, and how long the sender waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DncSettings {
    /// The control's code where the sender makes it; `None`: the line's parity bit makes ISO of ASCII, or nothing is
    /// checked.
    pub code: Option<TapeCode>,
    /// Whether the control's TV check is on.
    pub tv_check: bool,
    /// How late a DC3 may be acted on, where it is told.
    pub reaction: Option<Micros>,
    /// How long the control may take until it asks for the program.
    pub start_timeout: Micros,
    /// How long it may then take nothing.
    pub xoff_timeout: Micros,
    /// Behind how many blocks the control is to report where it stands; `None`: it reports nothing.
    pub report_every: Option<usize>,
    /// Blocks that it reads ahead at most.
    pub read_ahead: usize,
}

/// A code that the sender makes itself, on a line of eight bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapeCode {
    /// Even parity in the eighth bit.
    Iso,
    /// RS-244.
    Eia,
    /// Nothing in the eighth bit.
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

/// Checks the table.
pub fn build(given: &DncTable, serial: &SerialSettings) -> Result<DncSettings, Complaint> {
    let is_bare = serial.bytesize == 8 && serial.parity == Parity::None;
    let code = match &given.code {
        None => None,
        Some(code) if !is_bare => {
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
