//! Journal file of a transmission. A record is written and synced to disk before its characters may be sent. A separate
//! thread writes, so that a slow disk does not hold up the line.

use std::fs::{File, TryLockError};
use std::io::{Error, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender as Queue, channel};
use std::thread::JoinHandle;

use super::super::outcome::{Failure, file_failure};
use crate::dnc::Sender;
use crate::dnc::journal::{EndReason, Record, Start, first_line, is_journal, line};
use crate::dnc::sender::{CHUNK, Gate};
use crate::output::{explained, is_plain_file};

/// Limit above the length of a journal's first line.
const FIRST_MAX: u64 = 1_024;

/// Syncs per second of the line's time: one sync permits the characters of this fraction of a second.
const SYNCS_PER_S: usize = 4;

/// Writer of a transmission's journal; writes nothing if no journal is requested.
pub struct Logbook {
    open: Option<OpenJournal>,
}

struct OpenJournal {
    path: PathBuf,
    /// Channel to the writing thread; `None` once it is closed.
    records: Option<Queue<Record>>,
    /// Offsets up to which characters may be sent, from the records on disk.
    permits: Receiver<usize>,
    writer: Option<JoinHandle<Result<(), Error>>>,
    /// Number of characters that one sync permits.
    ahead: usize,
    until: usize,
    executed: usize,
}

impl Logbook {
    /// Logbook that writes no journal.
    pub fn none() -> Self {
        Logbook { open: None }
    }

    /// Creates the journal file; an existing journal is kept as `.old`. The sender may send nothing before the first
    /// record is on disk.
    ///
    /// # Errors
    /// The file cannot be written, or the existing file is no journal.
    pub fn create(path: &Path, start: &Start, chars_per_s: usize, sender: &mut Sender) -> Result<Self, Failure> {
        let begin = || {
            refuse_foreign(path)?;
            if let Ok(before) = File::open(path) {
                before.try_lock().map_err(|error| match error {
                    TryLockError::WouldBlock => Error::new(ErrorKind::WouldBlock, "another sender writes this journal"),
                    TryLockError::Error(error) => error,
                })?;
                refuse_foreign(&old(path))?;
                std::fs::rename(path, old(path))?;
            }
            let opened = File::options().append(true).create_new(true).open(path);
            let mut file = opened.map_err(|error| explained(error, path))?;
            file.try_lock()?;
            let written = file.write_all(first_line(start).as_bytes()).and_then(|()| file.sync_data());
            if let Err(error) = written {
                let _begun_only = std::fs::remove_file(path);
                return Err(explained(error, path));
            }
            Ok(file)
        };
        let file = begin().map_err(|error: Error| {
            let Failure::Input(message) = file_failure(path, &error) else { unreachable!("a file failure is one") };
            Failure::Input(format!("{message}; the journal must be written before anything is sent: see --journal"))
        })?;
        sender.permit(Gate::Journal, 0);
        let (records, inbox) = channel();
        let (outbox, permits) = channel();
        let writer = std::thread::spawn(move || write_all(file, &inbox, &outbox));
        let ahead = (chars_per_s / SYNCS_PER_S).max(1);
        let (records, writer) = (Some(records), Some(writer));
        Ok(Logbook {
            open: Some(OpenJournal { path: path.into(), records, permits, writer, ahead, until: 0, executed: 0 }),
        })
    }

    /// Queues records of what the sender has sent and the control has executed, and permits the sender the blocks whose
    /// records are on disk.
    ///
    /// # Errors
    /// The file cannot be written; the sender then sends nothing more.
    pub fn follow(&mut self, sender: &mut Sender, executed: Option<usize>) -> Result<(), Failure> {
        let Some(open) = &mut self.open else { return Ok(()) };
        if let Some(blocks) = executed.filter(|blocks| *blocks > open.executed) {
            open.executed = blocks;
            open.write(Record::Executed { blocks, stopped: false })?;
        }
        let (sent, total) = sender.progress();
        if open.until < total && open.until < sent + open.ahead / 2 + 1 {
            let sending = sender.transmission();
            let wanted = sending.line_at((sent + open.ahead).min(total - 1));
            open.until = sending.start_of(wanted + 1);
            // The last characters handed out may still be in the adapter.
            open.write(Record::Out { sent: sent.saturating_sub(CHUNK), until: open.until })?;
        }
        // While nothing may leave before the disk has answered, no time passes at the port, simulated or not.
        while sender.wants_permit(Gate::Journal) {
            match open.permits.recv() {
                Ok(until) => sender.permit(Gate::Journal, until),
                Err(_) => return open.close(),
            }
        }
        if let Some(until) = open.permits.try_iter().last() {
            sender.permit(Gate::Journal, until);
        }
        Ok(())
    }

    /// Closes the journal; `stopped` is the number of blocks that the control had started, if it has stopped.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn end(&mut self, sender: &Sender, reason: EndReason, stopped: Option<usize>) -> Result<(), Failure> {
        let Some(open) = &mut self.open else { return Ok(()) };
        if let Some(blocks) = stopped {
            open.write(Record::Executed { blocks, stopped: true })?;
        }
        open.write(Record::End { sent: sender.progress().0, reason })?;
        open.close()
    }

    /// Path of the journal, if there is one.
    pub fn path(&self) -> Option<&Path> {
        self.open.as_ref().map(|open| open.path.as_path())
    }
}

impl OpenJournal {
    fn write(&mut self, record: Record) -> Result<(), Failure> {
        let is_taken = self.records.as_ref().is_some_and(|records| records.send(record).is_ok());
        if is_taken { Ok(()) } else { self.close() }
    }

    /// Waits until all records are written.
    fn close(&mut self) -> Result<(), Failure> {
        self.records = None;
        let ended = self.writer.take().map(JoinHandle::join);
        let message = match ended {
            Some(Ok(Ok(()))) => return Ok(()),
            Some(Ok(Err(error))) => error.to_string(),
            Some(Err(_)) | None => "it is closed".into(),
        };
        Err(Failure::Machine(format!("{}: {message}: nothing more is sent without a journal", self.path.display())))
    }
}

/// Writes records as they come; a record that permits characters is synced before it is confirmed.
fn write_all(mut file: File, records: &Receiver<Record>, permits: &Queue<usize>) -> Result<(), Error> {
    for (number, record) in (1..).zip(records) {
        file.write_all(line(number, &record).as_bytes())?;
        match record {
            Record::Out { until, .. } => {
                file.sync_data()?;
                let _nobody_sends_any_more = permits.send(until);
            }
            Record::End { .. } => file.sync_data()?,
            Record::Executed { .. } => {}
        }
    }
    Ok(())
}

/// A file at the path of a journal must be a journal or empty; any other file is kept.
fn refuse_foreign(path: &Path) -> Result<(), Error> {
    if path.symlink_metadata().is_err() {
        return Ok(());
    }
    let refused =
        |what: &str| Err(Error::other(format!("{}: {what}; give another name with --journal", path.display())));
    if !is_plain_file(path) {
        return refused("a journal is a file of its own: no link, device or folder");
    }
    let mut first = Vec::new();
    File::open(path)?.take(FIRST_MAX).read_to_end(&mut first)?;
    if is_journal(&first) { Ok(()) } else { refused("there is a file that is no journal, and it is kept as it is") }
}

fn old(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".old");
    name.into()
}
