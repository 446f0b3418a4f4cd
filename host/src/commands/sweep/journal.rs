//! Journal of the runs of one shard (part of a campaign): a line for each run, appended when it has ended.
//!
//! ```text
//! arcfeed sweep journal 1 FINGERPRINT
//! CRC32 {"run":12,"status":"passed","message":"","figures":[4630826316843712512,null]}
//! ```
//!
//! A line is written by one call, so a killed process loses the runs that it had not finished, and no other. A last line that
//! is cut off or whose checksum is wrong is removed when the shard goes on; any other such line is an error.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::super::outcome::{Failure, file_failure};
use super::row::Row;
use crate::checksum::CRC_32;

/// First words of a journal.
const MAGIC: &str = "arcfeed sweep journal 1";

/// Journal of the shard that this process runs, open for appending.
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
}

/// Place of a run's row in its journal file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowPlace {
    /// Number of the run.
    pub run: u64,
    /// Byte offset of the line.
    pub offset: u64,
}

impl Journal {
    /// Opens or creates the journal of the campaign with this fingerprint; also returns the numbers of the runs that it already contains.
    ///
    /// # Errors
    /// It is another campaign's, damaged, or in use by another process; it cannot be written.
    pub fn open(path: &Path, fingerprint: u64) -> Result<(Self, Vec<u64>), Failure> {
        let failed = |error: std::io::Error| file_failure(path, &error);
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        file.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => Failure::Input(format!(
                "{}: another process runs this shard; wait for its end, or give another -o",
                path.display()
            )),
            TryLockError::Error(error) => failed(error),
        })?;
        let mut journal = Journal { file, path: path.to_owned() };
        let length = journal.file.metadata().map_err(failed)?.len();
        let header = header(fingerprint);
        // A process that was killed while it wrote the first line has finished no run.
        if length < header.len() as u64 {
            journal.file.set_len(0).map_err(failed)?;
            journal.append(header.as_bytes())?;
            return Ok((journal, Vec::new()));
        }
        let mut runs = Vec::new();
        let end = read(path, fingerprint, &mut |place| runs.push(place.run))?;
        journal.file.set_len(end).and_then(|()| journal.file.seek(SeekFrom::End(0)).map(drop)).map_err(failed)?;
        Ok((journal, runs))
    }

    /// Appends a row.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn add(&mut self, row: &Row) -> Result<(), Failure> {
        let json = serde_json::to_string(row).map_err(|error| Failure::Input(error.to_string()))?;
        self.append(format!("{:08x} {json}\n", CRC_32.checksum(json.as_bytes())).as_bytes())
    }

    fn append(&mut self, line: &[u8]) -> Result<(), Failure> {
        self.file.write_all(line).map_err(|error| file_failure(&self.path, &error))
    }

    /// Waits until all rows are on the disk.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn sync(&self) -> Result<(), Failure> {
        self.file.sync_all().map_err(|error| file_failure(&self.path, &error))
    }
}

/// Calls `take` with the place of every row in a journal; returns the offset after the last row.
///
/// # Errors
/// The journal is another campaign's, or damaged before its last line.
pub fn read(path: &Path, fingerprint: u64, take: &mut dyn FnMut(RowPlace)) -> Result<u64, Failure> {
    let failed = |error: std::io::Error| file_failure(path, &error);
    let mut file = BufReader::new(File::open(path).map_err(failed)?);
    let (mut line, mut offset, mut number) = (Vec::new(), 0, 0);
    let mut damaged: Option<usize> = None;
    loop {
        line.clear();
        let read = file.read_until(b'\n', &mut line).map_err(failed)? as u64;
        if read == 0 {
            return Ok(offset);
        }
        number += 1;
        if let Some(damaged) = damaged {
            let message = "the checksum of this line is wrong: remove the line, its run is made again";
            return Err(Failure::Input(format!("{}:{damaged}:1: {message}", path.display())));
        }
        if number == 1 {
            if line != header(fingerprint).as_bytes() {
                return Err(Failure::Input(format!(
                    "{}:1:1: this is the journal of another campaign, or sweep file, job or program have changed since: give another \
                     -o, or remove the folder",
                    path.display()
                )));
            }
        } else {
            match row_of(&line) {
                Some(row) => take(RowPlace { run: row.run, offset }),
                None => {
                    damaged = Some(number);
                    continue;
                }
            }
        }
        offset += read;
    }
}

/// Row at a place of a journal file.
///
/// # Errors
/// It cannot be read, or the file has changed.
pub fn row_at(file: &mut BufReader<File>, path: &Path, place: RowPlace) -> Result<Row, Failure> {
    let mut line = Vec::new();
    let read = file.seek(SeekFrom::Start(place.offset)).and_then(|_| file.by_ref().read_until(b'\n', &mut line));
    read.map_err(|error| file_failure(path, &error))?;
    row_of(&line).ok_or_else(|| Failure::Input(format!("{}: it has changed while it was read", path.display())))
}

fn header(fingerprint: u64) -> String {
    format!("{MAGIC} {fingerprint:016x}\n")
}

/// The row of a whole line with the right checksum.
fn row_of(line: &[u8]) -> Option<Row> {
    let (checksum, json) = std::str::from_utf8(line).ok()?.strip_suffix('\n')?.split_once(' ')?;
    let is_right = u32::from_str_radix(checksum, 16).ok()? == CRC_32.checksum(json.as_bytes());
    is_right.then(|| serde_json::from_str(json).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::sweep::row::RunStatus;

    fn row(run: u64) -> Row {
        let figures = vec![Some(0.1_f64.to_bits()), None];
        Row { run, status: RunStatus::Stopped, message: "PS0010 \"é\"".into(), figures }
    }

    #[test]
    fn a_journal_that_is_cut_anywhere_keeps_every_whole_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let (mut journal, runs) = Journal::open(&path, 7).unwrap();
        assert_eq!(runs, [0; 0]);
        let mut ends = vec![std::fs::metadata(&path).unwrap().len() as usize];
        for run in [3, 1, 2] {
            journal.add(&row(run)).unwrap();
            ends.push(std::fs::metadata(&path).unwrap().len() as usize);
        }
        drop(journal);
        let whole = std::fs::read(&path).unwrap();
        for cut in 0..=whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let (mut journal, runs) = Journal::open(&path, 7).unwrap();
            let kept = ends[1..].iter().filter(|end| **end <= cut).count();
            assert_eq!(runs, [3, 1, 2][..kept], "{cut} bytes");
            // It goes on behind them.
            [3, 1, 2][kept..].iter().for_each(|run| journal.add(&row(*run)).unwrap());
            assert_eq!(std::fs::read(&path).unwrap(), whole, "{cut} bytes");
        }
    }

    #[test]
    fn a_damaged_line_before_the_last_is_named_and_another_campaign_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let (mut journal, _) = Journal::open(&path, 7).unwrap();
        [1, 2].into_iter().for_each(|run| journal.add(&row(run)).unwrap());
        assert!(matches!(Journal::open(&path, 7), Err(Failure::Input(message)) if message.contains("another process")));
        drop(journal);
        assert!(
            matches!(Journal::open(&path, 8), Err(Failure::Input(message)) if message.contains("another campaign"))
        );
        let text = std::fs::read_to_string(&path).unwrap().replacen("stopped", "stooped", 1);
        std::fs::write(&path, text).unwrap();
        assert!(
            matches!(Journal::open(&path, 7), Err(Failure::Input(message)) if message.contains(":2:1: the checksum"))
        );
    }
}
