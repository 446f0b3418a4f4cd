//! TCP connection used as a port: never waits, and closes without losing written data.

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use super::PortError;
use super::url::Address;

/// Longest wait for a server, that of pyserial.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);
/// Longest wait for the server to close its end: bytes that arrive later would make the operating system break the
/// connection, and throw away what the server has not read yet.
const LINGER: Duration = Duration::from_millis(300);

/// Open TCP connection that never blocks.
pub struct Tcp {
    stream: TcpStream,
    name: String,
}

impl Tcp {
    /// Connects to a server; error messages call the port `name`. Fails if no server answers there.
    pub fn connect(address: &Address, name: &str) -> Result<Self, PortError> {
        let failed = |source: std::io::Error| PortError { name: name.to_owned(), source };
        let mut last = std::io::Error::new(ErrorKind::NotFound, "the host has no address");
        for place in (address.host.as_str(), address.port).to_socket_addrs().map_err(failed)? {
            match TcpStream::connect_timeout(&place, CONNECT_TIMEOUT) {
                Ok(stream) => {
                    stream.set_nodelay(true).and_then(|()| stream.set_nonblocking(true)).map_err(failed)?;
                    return Ok(Tcp { stream, name: name.to_owned() });
                }
                Err(error) => last = error,
            }
        }
        Err(failed(last))
    }

    /// Reads the bytes that have arrived; returns their number, 0 if there are none. Fails if the connection is lost.
    pub fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        match self.stream.read(buffer) {
            Ok(0) if !buffer.is_empty() => Err(PortError::in_words(&self.name, "the server closed the connection")),
            Ok(len) => Ok(len),
            Err(error) if is_not_now(&error) => Ok(0),
            Err(source) => Err(PortError { name: self.name.clone(), source }),
        }
    }

    /// Writes as many bytes as the system accepts at once; returns their number. Fails if the connection is lost.
    pub fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        match self.stream.write(bytes) {
            Ok(len) => Ok(len),
            Err(error) if is_not_now(&error) => Ok(0),
            Err(source) => Err(PortError { name: self.name.clone(), source }),
        }
    }
}

impl Drop for Tcp {
    fn drop(&mut self) {
        let _already_gone = self.stream.shutdown(Shutdown::Write);
        let (started, mut rest) = (Instant::now(), [0; 256]);
        while started.elapsed() < LINGER {
            match self.stream.read(&mut rest) {
                Ok(0) => return,
                Ok(_) => {}
                Err(error) if is_not_now(&error) => std::thread::sleep(Duration::from_millis(5)),
                Err(_) => return,
            }
        }
    }
}

fn is_not_now(error: &std::io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}
