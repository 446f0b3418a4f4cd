//! Settings of a serial line, with pyserial's names.

use arcfeed_units::Micros;

/// Settings of a serial line.
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
