//! HTTP/1.1 server for a few browsers: a thread for each connection, one request on each.
//!
//! All is bounded: the number of connections, the head and the body of a request, and the time for each. A key of 128
//! random bits is the first part of each path, so relative addresses in a page have it too; pages forbid browsers to
//! pass their address on. Hosts other than the server's own address are refused, so that no foreign page reaches it
//! under a name of its own (DNS rebinding), as are requests from pages of other origins. There is no encryption.

use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::time::Duration;

use super::request::{Gate, Request};
use crate::console::note;

/// Most connections at a time; others are closed at once.
const CONNECTIONS_MAX: usize = 64;
/// Longest time in which a browser takes none of an answer.
const WRITE_TIMEOUT: Duration = Duration::from_secs(5);
/// Time until the next attempt if no connection can be accepted.
const PAUSE: Duration = Duration::from_millis(100);
/// Bytes of the key.
const KEY_BYTES: usize = 16;

/// Pages and commands behind a server.
pub trait Site: Send + Sync + 'static {
    /// Answers a request that has been admitted.
    ///
    /// # Errors
    /// The browser is gone, or takes nothing.
    fn respond(&self, request: Request) -> io::Result<()>;
}

/// Server that runs until the program ends.
#[derive(Debug)]
pub struct Server {
    gate: Arc<Gate>,
}

impl Server {
    /// Listens at an address; port 0 is a free one.
    ///
    /// # Errors
    /// The address is taken, or belongs to another computer; the system has no random numbers.
    pub fn start(address: SocketAddr, site: Arc<dyn Site>) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let gate = Arc::new(Gate { address: listener.local_addr()?, key: new_key()? });
        let at_door = Arc::clone(&gate);
        std::thread::spawn(move || accept(&listener, &at_door, &site));
        Ok(Server { gate })
    }

    /// Address for a browser on this computer, with the key.
    pub fn url(&self) -> String {
        let mut address = self.gate.address;
        if address.ip().is_unspecified() {
            address.set_ip(if address.is_ipv4() {
                [127, 0, 0, 1].into()
            } else {
                std::net::Ipv6Addr::LOCALHOST.into()
            });
        }
        format!("http://{address}/{}/", self.gate.key)
    }
}

/// Warns if others than this computer reach an address.
pub fn warn_of_network(address: SocketAddr) {
    if !address.ip().is_loopback() {
        note(format_args!(
            "warning: --web {address}: who reaches this address and knows the page's key can do all that the page can. Nothing is \
             encrypted: use it only in a network that you trust"
        ));
    }
}

fn accept(listener: &TcpListener, gate: &Arc<Gate>, site: &Arc<dyn Site>) {
    let open = Arc::new(());
    loop {
        let Ok((stream, _)) = listener.accept() else {
            std::thread::sleep(PAUSE);
            continue;
        };
        if Arc::strong_count(&open) > CONNECTIONS_MAX || stream.set_write_timeout(Some(WRITE_TIMEOUT)).is_err() {
            continue;
        }
        let (gate, site, counted) = (Arc::clone(gate), Arc::clone(site), Arc::clone(&open));
        let serve = move || {
            let _counted = counted;
            let _browser_is_gone = gate.admit(stream).and_then(|request| site.respond(request));
        };
        let _no_thread_left = std::thread::Builder::new().name("browser".into()).spawn(serve);
    }
}

fn new_key() -> io::Result<String> {
    let mut bytes = [0; KEY_BYTES];
    getrandom::fill(&mut bytes).map_err(|error| io::Error::other(error.to_string()))?;
    Ok(bytes.iter().fold(String::new(), |key, byte| key + &format!("{byte:02x}")))
}
