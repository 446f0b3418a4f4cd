//! The journal on disk: what may leave is written and synced before it does.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::super::outcome::{Failure, file_failure};
use crate::dnc::Sender;
use crate::dnc::journal::{How, Record, Start, first_line, line};
use crate::dnc::sender::CHUNK;

/// How much of the line's time one sync is good for, as a part of a second.
const SYNCS_PER_S: usize = 4;

/// A journal being written; or none, where nobody asked for one.
pub struct Logbook {
    open: Option<Open>,
}

struct Open {
    path: PathBuf,
    file: File,
    number: u32,
    /// Characters that one sync lets out.
    ahead: usize,
    until: usize,
    executed: usize,
}

impl Logbook {
    /// No journal.
    pub fn none() -> Self {
        Logbook { open: None }
    }

    /// Begins a journal; one that is there is kept as `.old`. Nothing leaves before the first record is on disk.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn create(path: &Path, start: &Start, chars_per_s: usize, sender: &mut Sender) -> Result<Self, Failure> {
        let begin = || {
            if let Ok(before) = File::open(path) {
                before.try_lock()?;
                std::fs::rename(path, old(path))?;
            }
            let mut file = File::options().append(true).create_new(true).open(path)?;
            file.try_lock()?;
            file.write_all(first_line(start).as_bytes())?;
            file.sync_data()?;
            Ok(file)
        };
        let file = begin().map_err(|error: std::io::Error| {
            let Failure::Input(message) = file_failure(path, &error) else { unreachable!("a file failure is one") };
            Failure::Input(format!("{message}; the journal must be written before anything is sent: see --journal"))
        })?;
        sender.permit(0);
        let ahead = (chars_per_s / SYNCS_PER_S).max(1);
        Ok(Logbook { open: Some(Open { path: path.into(), file, number: 0, ahead, until: 0, executed: 0 }) })
    }

    /// Writes what is new, and permits the next blocks once they are on disk.
    ///
    /// # Errors
    /// The file cannot be written: then nothing more leaves.
    pub fn follow(&mut self, sender: &mut Sender, executed: Option<usize>) -> Result<(), Failure> {
        let Some(open) = &mut self.open else { return Ok(()) };
        if let Some(blocks) = executed.filter(|blocks| *blocks > open.executed) {
            open.executed = blocks;
            open.write(&Record::Executed { blocks, stands: false }, false)?;
        }
        let (sent, total) = sender.progress();
        if open.until < total && open.until - sent.min(open.until) < open.ahead / 2 + 1 {
            let sending = sender.transmission();
            let wanted = sending.line_at((sent + open.ahead).min(total - 1));
            open.until = sending.start_of(wanted + 1);
            // The last characters handed out may still be in the adapter.
            open.write(&Record::Out { sent: sent.saturating_sub(CHUNK), until: open.until }, true)?;
            sender.permit(open.until);
        }
        Ok(())
    }

    /// Closes it; `stands` is what the control had taken up, if it stands.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn end(&mut self, sender: &Sender, how: How, stands: Option<usize>) -> Result<(), Failure> {
        let Some(open) = &mut self.open else { return Ok(()) };
        if let Some(blocks) = stands {
            open.write(&Record::Executed { blocks, stands: true }, false)?;
        }
        open.write(&Record::End { sent: sender.progress().0, how }, true)
    }

    /// Its path, if there is one.
    pub fn path(&self) -> Option<&Path> {
        self.open.as_ref().map(|open| open.path.as_path())
    }
}

impl Open {
    fn write(&mut self, record: &Record, sync: bool) -> Result<(), Failure> {
        self.number += 1;
        let written = self.file.write_all(line(self.number, record).as_bytes());
        let synced = written.and_then(|()| if sync { self.file.sync_data() } else { Ok(()) });
        synced.map_err(|error| {
            Failure::Machine(format!("{}: {error}: nothing more is sent without a journal", self.path.display()))
        })
    }
}

fn old(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".old");
    name.into()
}
