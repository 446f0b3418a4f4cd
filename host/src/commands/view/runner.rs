//! Commands of the page as processes of their own, which can be stopped.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

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

    /// Runs arcfeed to its end; returns its messages, as an error if it fails.
    ///
    /// # Errors
    /// It does not start, or its messages cannot be kept.
    pub fn run(&self, arguments: &[String]) -> io::Result<Result<String, String>> {
        let log = self.folder.join("messages");
        let mut command = Command::new(std::env::current_exe()?);
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(File::create(&log)?);
        command.current_dir(self.folder.join("in"));
        {
            let mut running = self.running();
            if running.is_closed {
                return Ok(Err("the page has ended".into()));
            }
            running.child = Some(command.spawn()?);
        }
        let ended = loop {
            let ended = match &mut self.running().child {
                Some(child) => child.try_wait()?,
                None => return Ok(Err("stopped".into())),
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
        Ok(match ended.success() {
            true => Ok(messages),
            false if messages.is_empty() => Err(format!("arcfeed: {ended}")),
            false => Err(messages),
        })
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
