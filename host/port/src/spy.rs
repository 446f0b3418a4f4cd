//! `spy://`: records the traffic of a port in the format of pyserial's spy.
//!
//! ```text
//! 000003.001 TX   0000  48 45 4C 4C 4F                                    HELLO
//! 000003.102 RX   0000  48 45 4C 4C 4F                                    HELLO
//! ```
//! Columns: seconds since the port was opened, on the port's own clock; direction; offset within one read or write;
//! bytes; text.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::SystemTime;

use arcfeed_line_errors::Counts;
use arcfeed_units::Micros;

use super::log::note;
use super::url::SpyOptions;
use super::{Machine, Port, PortError};

/// Bytes in a line of a dump.
const ROW: usize = 16;
const RX_COLOR: &[u8] = b"\x1b[32m";
const TX_COLOR: &[u8] = b"\x1b[31m";

/// Function that creates a file for a spy's record.
pub type CreateFile = fn(&Path) -> std::io::Result<File>;

/// Port that records its traffic in a file or on stderr, and passes it on unchanged.
pub struct Spy<'p> {
    inner: Box<dyn Port + 'p>,
    options: SpyOptions,
    output: Box<dyn Write>,
    broken: bool,
}

impl<'p> Spy<'p> {
    /// Wraps a port so that its traffic is recorded; `create` creates the file, if the options name one.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn new(inner: Box<dyn Port + 'p>, options: &SpyOptions, create: CreateFile) -> Result<Self, PortError> {
        let output: Box<dyn Write> = match &options.file {
            Some(name) => {
                let failed = |source| PortError { name: format!("spy://...?file={name}"), source };
                Box::new(BufWriter::new(create(Path::new(name)).map_err(failed)?))
            }
            None => Box::new(std::io::stderr()),
        };
        Ok(Spy { inner, options: options.clone(), output, broken: false })
    }

    fn show(&mut self, label: &str, color: &[u8], bytes: &[u8]) {
        if self.broken {
            return;
        }
        let mut text = if self.options.color { color.to_vec() } else { Vec::new() };
        if self.options.raw {
            text.extend(bytes);
        } else {
            let seconds = self.inner.now().to_s();
            let mut line = |value: &str| text.extend(format!("{seconds:010.3} {label:4} {value}\n").into_bytes());
            if bytes.is_empty() {
                line("<empty>");
            }
            for (row, bytes) in bytes.chunks(ROW).enumerate() {
                line(&format!("{:04X}  {}", row * ROW, dump(bytes)));
            }
        }
        if let Err(error) = self.output.write_all(&text).and_then(|()| self.output.flush()) {
            // A full disk is no reason to stop a machine.
            self.broken = true;
            note(format_args!("spy: nothing more is written down: {error}"));
        }
    }
}

impl Port for Spy<'_> {
    fn now(&self) -> Micros {
        self.inner.now()
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        let len = self.inner.read(buffer)?;
        if len > 0 || self.options.all {
            self.show("RX", RX_COLOR, &buffer[..len]);
        }
        Ok(len)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        let len = self.inner.write(bytes)?;
        if len > 0 {
            self.show("TX", TX_COLOR, &bytes[..len]);
        }
        Ok(len)
    }

    fn out_waiting(&mut self) -> Result<usize, PortError> {
        self.inner.out_waiting()
    }

    fn wait(&mut self, deadline: Micros) {
        self.inner.wait(deadline);
    }

    fn line_errors(&self) -> Option<Counts> {
        self.inner.line_errors()
    }

    fn opened(&self) -> Option<SystemTime> {
        self.inner.opened()
    }

    fn control_is_done(&self) -> Option<bool> {
        self.inner.control_is_done()
    }

    fn blocks_executed(&self) -> Option<usize> {
        self.inner.blocks_executed()
    }

    fn machine(&self) -> Machine {
        self.inner.machine()
    }

    fn feed_hold(&mut self) -> bool {
        self.inner.feed_hold()
    }
}

/// Up to 16 bytes: in hexadecimal, a gap after eight, then as characters.
fn dump(bytes: &[u8]) -> String {
    let (mut hex, mut text) = (String::new(), String::new());
    for at in 0..ROW {
        match bytes.get(at) {
            Some(&byte) => {
                hex += &format!("{byte:02X} ");
                text.push(if (b' '..0x7f).contains(&byte) { char::from(byte) } else { '.' });
            }
            None => {
                hex += "   ";
                text.push(' ');
            }
        }
        if at == ROW / 2 - 1 {
            hex.push(' ');
        }
    }
    format!("{hex} {text}")
}
