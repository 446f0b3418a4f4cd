//! Options of the DNC line, in place of the job's `[serial]`.

use super::outcome::Failure;
use crate::job::{JobFile, Parity};

/// Options with the settings of the serial line, with pyserial's names.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct LineArgs {
    /// Line rate, in place of the job's
    #[arg(long, value_parser = clap::value_parser!(u32).range(50..=4_000_000))]
    baudrate: Option<u32>,
    /// Data bits, in place of the job's; without either 8
    #[arg(long, value_parser = clap::value_parser!(u8).range(5..=8))]
    bytesize: Option<u8>,
    /// Parity, in place of the job's: N, E or O; without either N
    #[arg(long, value_parser = parity)]
    parity: Option<Parity>,
    /// Stop bits, in place of the job's; without either 1
    #[arg(long, value_parser = clap::value_parser!(u8).range(1..=2))]
    stopbits: Option<u8>,
    /// RTS/CTS in place of the job's XON/XOFF
    #[arg(long)]
    rtscts: bool,
}

fn parity(letter: &str) -> Result<Parity, &'static str> {
    match letter {
        "N" => Ok(Parity::None),
        "E" => Ok(Parity::Even),
        "O" => Ok(Parity::Odd),
        _ => Err("write N, E or O"),
    }
}

impl LineArgs {
    /// Whether any of the options is given.
    pub fn is_any(&self) -> bool {
        let LineArgs { baudrate, bytesize, parity, stopbits, rtscts } = self;
        baudrate.is_some() || bytesize.is_some() || parity.is_some() || stopbits.is_some() || *rtscts
    }

    /// Replaces settings of the job by the given options.
    ///
    /// # Errors
    /// The options ask for a parity bit although the sender itself makes the character code.
    pub fn apply(&self, file: &mut JobFile) -> Result<(), Failure> {
        let LineArgs { baudrate, bytesize, parity, stopbits, rtscts } = *self;
        let line = &mut file.serial;
        line.baudrate = baudrate.unwrap_or(line.baudrate);
        line.bytesize = bytesize.unwrap_or(line.bytesize);
        line.parity = parity.unwrap_or(line.parity);
        line.stopbits = stopbits.unwrap_or(line.stopbits);
        if rtscts {
            (line.rtscts, line.xonxoff) = (true, false);
        }
        if file.dnc.code.is_some() && !file.serial.is_bare() {
            let message =
                "--bytesize, --parity: the job's [dnc] code needs a line of 8 bits without parity; drop the option";
            return Err(Failure::Usage(message.into()));
        }
        Ok(())
    }
}
