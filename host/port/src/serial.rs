//! Native serial port of this computer: raw bytes, without the operating system's XON/XOFF, with RTS/CTS if requested.

use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, SystemTime};

use arcfeed_line_errors::{Counts, NativePort, counts};
use arcfeed_units::Micros;
use serialport::{ClearBuffer, DataBits, FlowControl, SerialPort, StopBits};

use super::clock::WallClock;
use super::{Port, PortError};
use crate::settings::{Parity, SerialSettings};

/// Longest time that one write may wait for room: the caller has other work.
const WRITE_TIMEOUT: Duration = Duration::from_millis(20);

/// Serial port of this computer, opened.
pub struct Serial {
    name: String,
    port: NativePort,
    clock: WallClock,
    /// Counts of its driver before the port was opened.
    errors_before: Option<Counts>,
}

impl Serial {
    /// Opens the port with this device name (`/dev/ttyUSB0`, `COM3`).
    ///
    /// # Errors
    /// There is no such port, another program uses it, or it refuses a setting.
    pub fn open(name: &str, settings: &SerialSettings) -> Result<Self, PortError> {
        let builder = serialport::new(name, settings.baudrate)
            .data_bits(match settings.bytesize {
                5 => DataBits::Five,
                6 => DataBits::Six,
                7 => DataBits::Seven,
                _ => DataBits::Eight,
            })
            .parity(match settings.parity {
                Parity::None => serialport::Parity::None,
                Parity::Even => serialport::Parity::Even,
                Parity::Odd => serialport::Parity::Odd,
            })
            .stop_bits(if settings.stopbits == 2 { StopBits::Two } else { StopBits::One })
            .flow_control(if settings.rtscts { FlowControl::Hardware } else { FlowControl::None })
            .timeout(WRITE_TIMEOUT);
        // Windows opens a port for one program only, whatever the job sets.
        #[cfg(unix)]
        let builder = builder.exclusive(settings.exclusive);
        let failed = |source: std::io::Error| PortError { name: name.into(), source };
        let port = builder.open_native().map_err(|error| failed(error.into()))?;
        port.clear(ClearBuffer::Output).map_err(|error| failed(error.into()))?;
        let errors_before = counts(&port);
        Ok(Serial { name: name.into(), port, clock: WallClock::start(), errors_before })
    }

    fn failed(&self, source: std::io::Error) -> PortError {
        PortError { name: self.name.clone(), source }
    }
}

impl Port for Serial {
    fn now(&self) -> Micros {
        self.clock.now()
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        // Without waiting bytes a read would block for the write's time-out.
        let waiting = self.port.bytes_to_read().map_err(|error| self.failed(error.into()))?;
        if waiting == 0 {
            return Ok(0);
        }
        match self.port.read(buffer) {
            Ok(0) => Err(self.failed(ErrorKind::UnexpectedEof.into())),
            Ok(len) => Ok(len),
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => Ok(0),
            Err(error) => Err(self.failed(error)),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        if bytes.is_empty() {
            return Ok(0);
        }
        match self.port.write(bytes) {
            Ok(len) => Ok(len),
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => Ok(0),
            Err(error) => Err(self.failed(error)),
        }
    }

    fn out_waiting(&mut self) -> Result<usize, PortError> {
        // Some drivers cannot report it.
        Ok(self.port.bytes_to_write().map_or(0, |waiting| waiting as usize))
    }

    fn line_errors(&self) -> Option<Counts> {
        counts(&self.port).zip(self.errors_before).map(|(now, before)| now.since(&before))
    }

    fn opened(&self) -> Option<SystemTime> {
        Some(self.clock.started())
    }

    fn wait(&mut self, deadline: Micros) {
        self.clock.wait(deadline);
    }
}
