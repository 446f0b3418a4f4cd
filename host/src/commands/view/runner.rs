//! Commands of the page as processes of their own, which can be stopped.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::CommandOutput;

/// Time between two looks at a running command.
const PERIOD: Duration = Duration::from_millis(20);
/// Most bytes of messages that are shown.
const MESSAGES_MAX: usize = 64 * 1024;

/// Runs one command at a time in the folder `in` of a workspace.
pub struct Runner {
    folder: PathBuf,
    running: Mutex<Running>,
}

#[derive(Default)]
struct Running {
    child: Option<Child>,
    is_closed: bool,
}

impl Runner {
    /// Runner in the folder of a workspace.
    pub fn new(folder: &Path) -> Self {
        Runner { folder: folder.to_owned(), running: Mutex::default() }
    }

    /// Runs arcfeed to its end; returns its output.
    ///
    /// # Errors
    /// It does not start, or its messages cannot be kept.
    pub fn run(&self, arguments: &[String]) -> io::Result<CommandOutput> {
        let [log, printed] = ["messages", "printed"].map(|name| self.folder.join(name));
        let only = |words: &str| CommandOutput { messages: words.into(), printed: String::new() };
        let mut command = Command::new(std::env::current_exe()?);
        command.args(arguments).stdin(Stdio::null()).stdout(File::create(&printed)?).stderr(File::create(&log)?);
        command.current_dir(self.folder.join("in"));
        {
            let mut running = self.running();
            if running.is_closed {
                return Ok(only("the page has ended"));
            }
            running.child = Some(command.spawn()?);
        }
        let ended = loop {
            let ended = match &mut self.running().child {
                Some(child) => child.try_wait()?,
                None => return Ok(only("stopped")),
            };
            match ended {
                Some(status) => break status,
                None => std::thread::sleep(PERIOD),
            }
        };
        self.running().child = None;
        let mut messages = std::fs::read(&log)?;
        messages.truncate(MESSAGES_MAX);
        let messages = String::from_utf8_lossy(&messages).into_owned();
        let messages = if ended.success() || !messages.is_empty() { messages } else { format!("arcfeed: {ended}") };
        Ok(CommandOutput { messages, printed: std::fs::read_to_string(&printed)? })
    }

    /// Stops the running command.
    pub fn stop(&self) {
        if let Some(mut child) = self.running().child.take() {
            let _has_ended = child.kill();
            let _reaped = child.wait();
        }
    }

    /// Stops the running command, and starts none any more.
    pub fn close(&self) {
        self.running().is_closed = true;
        self.stop();
    }

    fn running(&self) -> MutexGuard<'_, Running> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
