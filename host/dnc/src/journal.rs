//! Journal of a transmission, for a restart after a crash: one record per line.
//!
//! ```text
//! b2a9c3d1 0 arcfeed-journal 2 program=00.. job=00.. sent=00.. bytes=1680 from=0 blocks=0 restart_bytes=0 restart_blocks=0
//! 5d0b7f02 1 out sent=0 until=214
//! 91c44e7a 2 executed blocks=7 stopped=0
//! e81290bb 3 end sent=214 reason=aborted
//! ```
//! The eight hexadecimal digits at the start are the CRC-32 of the rest of the line; the record's number follows. `out` is on disk (fsync)
//! before a character behind its `sent` leaves: after a crash, between `sent` and `until` characters of the last such record are out. A
//! record torn off at the end had no effect yet and is dropped; damage anywhere else is rejected. Offsets and blocks are those of the
//! transmission. `from` and `restart_bytes` of a resumed one lead back to the program's (`from` characters and `blocks` of it are left
//! out, `restart_bytes` characters and `restart_blocks` blocks of them are sent first).

use std::fmt::Write;

use crc::{CRC_32_ISO_HDLC, Crc};

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
const NAME: &str = "arcfeed-journal 2";
/// First words of a journal of any release.
const ANY_NAME: &str = "0 arcfeed-journal ";

/// First record of a journal: the transmission to which the journal belongs. A fingerprint is a 64-bit hash.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Start {
    /// Fingerprint of the program's file.
    pub program: u64,
    /// Fingerprint of the job's data about program and control, those of its settings file included.
    pub job: u64,
    /// Fingerprint of the whole program, in the form in which it is sent over the line.
    pub sent: u64,
    /// Number of characters of the transmission.
    pub bytes: usize,
    /// Number of characters at the program's start that this transmission leaves out: 0 unless it is a restart.
    pub from: usize,
    /// Number of blocks that it leaves out there.
    pub blocks: usize,
    /// Number of characters that arcfeed sends before the rest of the program, to restore the control's state: 0 unless this is a restart.
    pub restart_bytes: usize,
    /// Number of blocks among the characters in `restart_bytes`.
    pub restart_blocks: usize,
}

/// Record of a journal after the first. Characters and blocks are counted from the start of the transmission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record {
    /// The sender has sent `sent` characters, and will not go beyond `until` before it writes the next record.
    Out {
        /// Number of characters sent.
        sent: usize,
        /// Largest number of characters that may be sent before the next record.
        until: usize,
    },
    /// The control has started this many blocks, and continues with those that it has unless it has stopped.
    Executed {
        /// Number of blocks of the transmission that the control has started.
        blocks: usize,
        /// The control is in alarm or feed hold, with its axes at rest: it starts no further block.
        stopped: bool,
    },
    /// The transmission ended: complete, aborted or failed.
    End {
        /// Number of characters sent.
        sent: usize,
        /// Reason for the end.
        reason: EndReason,
    },
}

/// Reason why a sender ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndReason {
    /// All characters are out.
    Complete,
    /// The operator stopped it.
    Aborted,
    /// The line or the control failed.
    Failed,
}

/// Content of a journal, in characters and blocks of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct History {
    /// First record.
    pub start: Start,
    /// Least and most characters of the program that are out.
    pub sent: [usize; 2],
    /// Least number of blocks of the program that the control had started, if it reported that.
    pub executed: Option<usize>,
    /// The control had stopped then, so that no later block was started.
    pub stopped: bool,
    /// Reason for the end, if the sender ended.
    pub ended: Option<EndReason>,
    /// Characters torn off at the end.
    pub torn: usize,
}

/// Reason why a journal cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum JournalError {
    /// The file does not begin as a journal.
    #[error("this is no journal of arcfeed, or its first record was never written: nothing was sent with it")]
    NoStart,
    /// The first record is sound, and this release does not read it.
    #[error(
        "another release of arcfeed wrote this journal: resume with that one, or find the place at the control and use --from"
    )]
    OtherRelease,
    /// A record is corrupted, and good ones follow.
    #[error(
        "line {0} is damaged in the middle of the journal: it says nothing reliable any more; find the place at the control"
    )]
    Line(usize),
}

impl EndReason {
    const fn word(self) -> &'static str {
        match self {
            EndReason::Complete => "complete",
            EndReason::Aborted => "aborted",
            EndReason::Failed => "failed",
        }
    }
}

/// Text of a journal's first line, with its line end.
pub fn first_line(start: &Start) -> String {
    let Start { program, job, sent, bytes, from, blocks, restart_bytes, restart_blocks } = start;
    seal(&format!(
        "0 {NAME} program={program:016x} job={job:016x} sent={sent:016x} bytes={bytes} from={from} blocks={blocks} \
         restart_bytes={restart_bytes} restart_blocks={restart_blocks}"
    ))
}

/// Text of a record's line, with its line end; `number` counts the records after the first, from 1.
pub fn line(number: u32, record: &Record) -> String {
    seal(&match record {
        Record::Out { sent, until } => format!("{number} out sent={sent} until={until}"),
        Record::Executed { blocks, stopped } => {
            format!("{number} executed blocks={blocks} stopped={}", u8::from(*stopped))
        }
        Record::End { sent, reason } => format!("{number} end sent={sent} reason={}", reason.word()),
    })
}

fn seal(text: &str) -> String {
    let mut line = String::with_capacity(text.len() + 10);
    let _never_fails = writeln!(line, "{:08x} {text}", CRC.checksum(text.as_bytes()));
    line
}

/// Whether the file is empty, or its first line is that of a journal of any arcfeed release, with a correct CRC.
pub fn is_journal(bytes: &[u8]) -> bool {
    let first = bytes.split_inclusive(|byte| *byte == b'\n').next();
    first.is_none_or(|line| open(line).is_some_and(|text| text.starts_with(ANY_NAME)))
}

/// Reads a journal and returns how far the transmission came.
///
/// # Errors
/// The file does not begin as a journal, another release wrote it, or a record before the last is damaged or missing.
pub fn read(bytes: &[u8]) -> Result<History, JournalError> {
    let mut lines = bytes.split_inclusive(|byte| *byte == b'\n');
    let first = lines.next().and_then(open).ok_or(JournalError::NoStart)?;
    let other = if first.starts_with(ANY_NAME) { JournalError::OtherRelease } else { JournalError::NoStart };
    let start = parse_start(first).ok_or(other)?;
    let mut history = History { start, sent: [0; 2], executed: None, stopped: false, ended: None, torn: 0 };
    let (mut sent, mut executed) = ([0; 2], None);
    for (index, line) in lines.enumerate() {
        let number = u32::try_from(index + 1).unwrap_or(u32::MAX);
        match open(line).and_then(|text| parse(text, number)) {
            Some(_) if history.torn > 0 => return Err(JournalError::Line(index + 1)),
            Some(Record::Out { sent: out, until }) => sent = [out, until],
            Some(Record::Executed { blocks, stopped }) => (executed, history.stopped) = (Some(blocks), stopped),
            // Characters given to a failed line need not have left.
            Some(Record::End { sent: out, reason: EndReason::Failed }) => {
                (sent, history.ended) = ([sent[0].min(out), out], Some(EndReason::Failed));
            }
            Some(Record::End { sent: out, reason }) => (sent, history.ended) = ([out; 2], Some(reason)),
            // Valid record in the wrong place: one before it is missing.
            None if open(line).is_some() => return Err(JournalError::Line(index + 2)),
            None => history.torn += line.len(),
        }
    }
    let of_program = |out: usize| start.from + out.saturating_sub(start.restart_bytes);
    history.sent = sent.map(|out| of_program(out.min(start.bytes)));
    history.executed = executed.map(|blocks: usize| start.blocks + blocks.saturating_sub(start.restart_blocks));
    Ok(history)
}

/// Text of a line whose CRC is right.
fn open(line: &[u8]) -> Option<&str> {
    let text = std::str::from_utf8(line.strip_suffix(b"\n")?).ok()?;
    let (crc, rest) = text.split_once(' ')?;
    let is_good = crc.len() == 8 && u32::from_str_radix(crc, 16).ok()? == CRC.checksum(rest.as_bytes());
    is_good.then_some(rest)
}

fn parse_start(text: &str) -> Option<Start> {
    let fields = text.strip_prefix("0 ")?.strip_prefix(NAME)?;
    let hex = |name| u64::from_str_radix(field(fields, name)?, 16).ok();
    let count = |name| field(fields, name)?.parse().ok();
    Some(Start {
        program: hex("program")?,
        job: hex("job")?,
        sent: hex("sent")?,
        bytes: count("bytes")?,
        from: count("from")?,
        blocks: count("blocks")?,
        restart_bytes: count("restart_bytes")?,
        restart_blocks: count("restart_blocks")?,
    })
}

fn parse(text: &str, number: u32) -> Option<Record> {
    let (found, rest) = text.split_once(' ')?;
    if found.parse() != Ok(number) {
        return None;
    }
    let (kind, fields) = rest.split_once(' ')?;
    let count = |name| field(fields, name)?.parse().ok();
    Some(match kind {
        "out" => Record::Out { sent: count("sent")?, until: count("until")? },
        "executed" => Record::Executed { blocks: count("blocks")?, stopped: field(fields, "stopped")? == "1" },
        "end" => {
            let word = field(fields, "reason")?;
            let reason = [EndReason::Complete, EndReason::Aborted, EndReason::Failed]
                .into_iter()
                .find(|reason| reason.word() == word)?;
            Record::End { sent: count("sent")?, reason }
        }
        _ => return None,
    })
}

fn field<'t>(fields: &'t str, name: &str) -> Option<&'t str> {
    fields.split(' ').find_map(|field| field.strip_prefix(name)?.strip_prefix('='))
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: Start =
        Start { program: 1, job: 2, sent: 3, bytes: 400, from: 0, blocks: 0, restart_bytes: 0, restart_blocks: 0 };

    fn journal(start: &Start, records: &[Record]) -> Vec<u8> {
        let mut text = first_line(start);
        for (index, record) in records.iter().enumerate() {
            text += &line(index as u32 + 1, record);
        }
        text.into_bytes()
    }

    fn records() -> [Record; 4] {
        [
            Record::Out { sent: 0, until: 100 },
            Record::Executed { blocks: 2, stopped: false },
            Record::Out { sent: 98, until: 210 },
            Record::Executed { blocks: 5, stopped: false },
        ]
    }

    #[test]
    fn the_last_records_count() {
        let history = read(&journal(&START, &records())).unwrap();
        assert_eq!((history.sent, history.executed, history.ended), ([98, 210], Some(5), None));
        let end = Record::End { sent: 207, reason: EndReason::Aborted };
        let history = read(&journal(&START, &[records().as_slice(), &[end]].concat())).unwrap();
        assert_eq!((history.sent, history.ended), ([207, 207], Some(EndReason::Aborted)));
    }

    #[test]
    fn a_journal_torn_anywhere_says_what_its_whole_records_say() {
        let whole = journal(&START, &records());
        let ends: Vec<usize> = (0..whole.len()).filter(|at| whole[*at] == b'\n').map(|at| at + 1).collect();
        for len in 0..=whole.len() {
            let found = read(&whole[..len]);
            match ends.iter().rposition(|end| *end <= len) {
                None => assert_eq!(found, Err(JournalError::NoStart)),
                Some(last) => {
                    let history = found.unwrap();
                    assert_eq!(history.torn, len - ends[last]);
                    assert_eq!(history.sent, [[0, 0], [0, 100], [0, 100], [98, 210], [98, 210]][last]);
                }
            }
        }
    }

    #[test]
    fn damage_in_the_middle_is_not_passed_over() {
        let whole = journal(&START, &records());
        let second = whole.iter().position(|byte| *byte == b'\n').unwrap() + 20;
        let mut corrupted = whole.clone();
        corrupted[second] ^= 1;
        assert!(matches!(read(&corrupted), Err(JournalError::Line(_))));
        let lines: Vec<&[u8]> = whole.split_inclusive(|byte| *byte == b'\n').collect();
        let missing = [lines[0], lines[2], lines[3]].concat();
        assert!(matches!(read(&missing), Err(JournalError::Line(_))));
    }

    #[test]
    fn a_journal_of_another_release_is_named_so() {
        let other = seal("0 arcfeed-journal 1 program=00 job=00 sent=00 bytes=1680 from=0 blocks=0 ours=0 own=0");
        assert_eq!(read(other.as_bytes()), Err(JournalError::OtherRelease));
        assert_eq!(read(seal("0 something else").as_bytes()), Err(JournalError::NoStart));
    }

    #[test]
    fn garbage_behind_the_last_record_is_torn_off() {
        let mut bytes = journal(&START, &records());
        bytes.extend([0; 40]);
        assert_eq!(read(&bytes).unwrap().torn, 40);
    }

    #[test]
    fn a_resumed_transmission_counts_in_the_programs_characters() {
        let start = Start { from: 1_000, blocks: 40, restart_bytes: 120, restart_blocks: 9, ..START };
        let out = [Record::Out { sent: 60, until: 320 }, Record::Executed { blocks: 12, stopped: false }];
        let history = read(&journal(&start, &out)).unwrap();
        assert_eq!((history.sent, history.executed), ([1_000, 1_200], Some(43)));
    }
}
