//! Live page of a transmission for any number of browsers, and the commands that their users give.
//!
//! The sender puts a snapshot in the place of the last one and never waits: if a browser's thread is just taking it, the
//! snapshot is left out. Each browser's thread takes the newest when its browser has accepted the one before, so a
//! browser that hangs holds nothing but its own thread.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::reply::{Reply, begin_events};
use super::request::Request;
use super::server::{Server, Site, warn_of_network};
use super::snapshot::Snapshot;
use crate::screen::view::Command;

/// Time after which a browser hears something, so that one that is gone is noticed.
const QUIET_MAX: Duration = Duration::from_secs(1);
/// Time that sending one state to a browser takes at most, unless the browser hangs.
const SENDING_MAX: Duration = Duration::from_secs(1);
/// Longest wait at the end for browsers that have not taken the last state. A busy computer may leave their threads waiting.
const FAREWELL_MAX: Duration = Duration::from_secs(5);
/// Commands that may wait for the sender.
const COMMANDS_MAX: usize = 8;
/// Longest command.
const COMMAND_BYTES_MAX: usize = 16;

/// Live page; dropping it reports the end of the transmission to the browsers.
#[derive(Debug)]
pub struct LivePage {
    server: Server,
    shared: Arc<Shared>,
    commands: Receiver<Command>,
}

#[derive(Debug)]
struct Shared {
    page: String,
    latest: Mutex<Latest>,
    changed: Condvar,
    commands: SyncSender<Command>,
}

#[derive(Debug)]
struct Latest {
    snapshot: Arc<Snapshot>,
    /// Browsers that receive each snapshot, by their number: the time at which sending to each began; `None` while its thread waits for
    /// the next snapshot.
    watching: BTreeMap<u64, Option<Instant>>,
    /// Browsers so far.
    count: u64,
}

impl LivePage {
    /// Serves the page at an address.
    ///
    /// # Errors
    /// Nothing can listen there.
    pub fn open(address: SocketAddr, page: String, first: Snapshot) -> io::Result<Self> {
        let (sender, commands) = sync_channel(COMMANDS_MAX);
        let latest = Mutex::new(Latest { snapshot: Arc::new(first), watching: BTreeMap::new(), count: 0 });
        let shared = Arc::new(Shared { page, latest, changed: Condvar::new(), commands: sender });
        let site: Arc<dyn Site> = Arc::<Shared>::clone(&shared);
        let server = Server::start(address, site)?;
        warn_of_network(address);
        Ok(LivePage { server, shared, commands })
    }

    /// Address of the page, with its key.
    pub fn url(&self) -> String {
        self.server.url()
    }

    /// Shows this state from now on; never waits.
    pub fn show(&self, snapshot: Snapshot) {
        if let Ok(mut latest) = self.shared.latest.try_lock() {
            latest.replace(snapshot);
            self.shared.changed.notify_all();
        }
    }

    /// Shows the last state, and waits until all browsers that do not hang have taken it.
    pub fn end(&mut self, last: Snapshot) {
        let mut latest = self.shared.lock();
        latest.replace(Snapshot { is_over: true, ..last });
        self.shared.changed.notify_all();
        let until = Instant::now() + FAREWELL_MAX;
        while let Some(left) = latest.wait_for_browsers(until) {
            latest = self.shared.changed.wait_timeout(latest, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Next command from a browser, each once; `None` if there is none.
    pub fn command(&self) -> Option<Command> {
        self.commands.try_recv().ok()
    }
}

impl Drop for LivePage {
    /// After an error the page has not been ended yet.
    fn drop(&mut self) {
        let snapshot = Arc::clone(&self.shared.lock().snapshot);
        if !snapshot.is_over {
            self.end((*snapshot).clone());
        }
    }
}

impl Latest {
    /// Time for which a browser that does not hang may still need to take the last state; `None` if no browser may.
    fn wait_for_browsers(&self, until: Instant) -> Option<Duration> {
        let ends = self.watching.values().map(|began| began.map_or(until, |began| until.min(began + SENDING_MAX)));
        ends.max()?.checked_duration_since(Instant::now()).filter(|left| !left.is_zero())
    }

    fn replace(&mut self, snapshot: Snapshot) {
        self.snapshot = Arc::new(Snapshot { number: self.snapshot.number + 1, ..snapshot });
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Latest> {
        self.latest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of a new browser.
    fn begin_watching(&self) -> u64 {
        let mut latest = self.lock();
        latest.count += 1;
        let browser = latest.count;
        latest.watching.insert(browser, Some(Instant::now()));
        browser
    }

    /// Sends each snapshot to a browser, until the last one or the browser's end.
    fn watch(&self, browser: u64, stream: &mut TcpStream) -> io::Result<()> {
        begin_events(stream)?;
        let mut seen = None;
        loop {
            let snapshot = self.next(browser, seen);
            // A line that begins with a colon is no event.
            let event = match &snapshot {
                Some(snapshot) => format!("data: {}\n\n", serde_json::json!(**snapshot)),
                None => ":\n\n".into(),
            };
            stream.write_all(event.as_bytes())?;
            if snapshot.as_ref().is_some_and(|snapshot| snapshot.is_over) {
                return Ok(());
            }
            seen = snapshot.map(|snapshot| snapshot.number).or(seen);
        }
    }

    /// Newest snapshot, as soon as it is another one than that seen; `None` after a quiet time.
    fn next(&self, browser: u64, seen: Option<u64>) -> Option<Arc<Snapshot>> {
        let is_seen = |latest: &mut Latest| Some(latest.snapshot.number) == seen;
        let mut latest = self.lock();
        latest.watching.insert(browser, None);
        let waited = self.changed.wait_timeout_while(latest, QUIET_MAX, is_seen);
        let (mut latest, waited) = waited.unwrap_or_else(PoisonError::into_inner);
        latest.watching.insert(browser, Some(Instant::now()));
        (!waited.timed_out()).then(|| Arc::clone(&latest.snapshot))
    }

    /// Passes a command on. Resuming needs a hold before it.
    fn command(&self, word: &[u8]) -> Reply<'static> {
        let snapshot = Arc::clone(&self.lock().snapshot);
        let command = match word {
            b"hold" => Command::Hold,
            b"resume" => Command::Resume,
            b"abort" => Command::Abort,
            _ => return Reply::text("400 Bad Request", "the commands are hold, resume and abort"),
        };
        if snapshot.is_over {
            return Reply::text("409 Conflict", "the transmission has ended");
        }
        if command == Command::Resume && snapshot.state != "held" {
            return Reply::text("409 Conflict", "nothing is held");
        }
        match self.commands.try_send(command) {
            Ok(()) => Reply::text("202 Accepted", ""),
            Err(_) => Reply::text("503 Service Unavailable", "the sender has not taken the commands before this one"),
        }
    }
}

impl Site for Shared {
    fn respond(&self, mut request: Request) -> io::Result<()> {
        match (request.is_post, request.path.as_str()) {
            (false, "") => request.reply(&Reply::html(self.page.as_bytes())),
            (false, "events") => {
                let browser = self.begin_watching();
                let ended = self.watch(browser, &mut request.into_stream());
                self.lock().watching.remove(&browser);
                self.changed.notify_all();
                ended
            }
            (true, "command") => {
                let word = request.body(COMMAND_BYTES_MAX)?;
                request.reply(&self.command(&word))
            }
            _ => request.reply(&Reply::text("404 Not Found", "there is no such page")),
        }
    }
}
