//! Settings of a serial line, with pyserial's names.

use arcfeed_units::Micros;

/// Settings of a serial line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SerialSettings {
    /// Bits per second.
    pub baudrate: u32,
    /// Number of data bits per character.
    pub bytesize: u8,
    /// Parity.
    pub parity: Parity,
    /// Number of stop bits per character.
    pub stopbits: u8,
    /// The control sends XON/XOFF; the sender follows them itself, never the operating system.
    pub xonxoff: bool,
    /// RTS/CTS flow control, done by the driver or by the server at the other end of `rfc2217://`.
    pub rtscts: bool,
    /// Longest time for which the line may accept no character; `None`: the default of
    /// [`SerialSettings::write_timeout`].
    pub write_timeout: Option<Micros>,
    /// The port is locked, so that no other program can open it.
    pub exclusive: bool,
}

/// Parity of a serial line.
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
    /// Number of bits on the line per character: start bit, data bits, parity bit and stop bits.
    pub fn bits_per_char(&self) -> u32 {
        1 + u32::from(self.bytesize) + u32::from(self.parity != Parity::None) + u32::from(self.stopbits)
    }

    /// Whether characters have eight data bits and no parity bit. Then the sender itself can produce the control's
    /// character code, with its parity.
    pub fn is_bare(&self) -> bool {
        self.bytesize == 8 && self.parity == Parity::None
    }

    /// Longest time for which the line may accept no character: unlimited with RTS/CTS, because the control may stop
    /// the line with them. Otherwise only the sender can stop the line, so that one that accepts nothing is broken.
    pub fn write_timeout(&self) -> Option<Micros> {
        self.write_timeout.or((!self.rtscts).then_some(Micros::from_ms(5_000)))
    }
}

/// pyserial's defaults, 9600 8N1 without flow control, but for one program at a time.
impl Default for SerialSettings {
    fn default() -> Self {
        SerialSettings {
            baudrate: 9_600,
            bytesize: 8,
            parity: Parity::None,
            stopbits: 1,
            xonxoff: false,
            rtscts: false,
            write_timeout: None,
            exclusive: true,
        }
    }
}
