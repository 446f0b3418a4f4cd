//! Flash page of a job: a board at a tapped line reads its job from it instead of from a host.
//!
//! ```text
//! byte    what
//! 0..4    "AFPG"
//! 4..8    hash of the schema that the messages are written in
//! 8       code of the line: 0 ISO or EIA, as each program says; 1 ISO, 2 EIA, 3 ASCII
//! 9       what a number without a point counts in: 0 least increments, 1 whole units
//! 10..12  bytes of the messages, n
//! 12..    the messages of a set, Begin to Commit: kind, bytes of the payload, payload
//! 12 + n  CRC-32C over all before, four bytes
//! ```
//! Numbers are little endian. Bytes after the page are ignored, since flash is written page by page. Source: our own;
//! the messages are those of `docs/protocol.md`.

use super::codes::RefusalCode;
use super::field::PAYLOAD_MAX;
use super::parameters::{ParametersError, messages};
use super::staging::Staging;
use super::{Message, SCHEMA_HASH};
use crate::frame::checksum;
use arcfeed_model::cut::CutRule;
use arcfeed_model::job::Job;
use arcfeed_nc::settings::Decimals;
use arcfeed_nc::tape_code::TapeCode;

/// Largest length of a flash page with a job, bytes.
pub const PAGE_MAX: usize = 16 * 1024;

const MAGIC: [u8; 4] = *b"AFPG";
const HEADER_LEN: usize = 12;
const CHECK_LEN: usize = 4;
/// Number of the set; arbitrary, as there is only one.
const SET: u32 = 1;
/// Byte of erased flash.
const ERASED: u8 = 0xFF;

/// Reason why a flash page does not hold a valid job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PageError {
    /// The flash is erased.
    Blank,
    /// The page has no valid header, or is cut off.
    Form,
    /// The page was written for another version of the messages.
    Schema,
    /// Wrong checksum.
    Checksum,
    /// The messages are not a valid set of parameters.
    Set(RefusalCode),
}

/// Properties of a serial line that a board reads along with (taps), and of the control at its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TappedLine {
    /// Character code on the line; `None`: ISO or EIA, detected at the start of each program.
    pub code: Option<TapeCode>,
    /// Unit of a number without a decimal point in the program: the control's least increment, or a millimetre, degree
    /// or second.
    pub decimals: Decimals,
}

/// Bytes of a flash page.
pub type Page = heapless::Vec<u8, PAGE_MAX>;

/// Writes the flash page of a job, for a board without a host.
///
/// # Errors
/// A job that cannot be sent to a board, or that needs a host while it is executed.
pub fn write(job: &Job, tapped: TappedLine) -> Result<Page, ParametersError> {
    if let Some(index) = job.rules.iter().position(CutRule::expects_engagement_per_move) {
        return Err(ParametersError::EngagementPerMove(index));
    }
    let mut entries = Page::new();
    let mut has_room = true;
    messages(job, SET, &mut |message| {
        let mut payload = [0; PAYLOAD_MAX];
        let length = message.encode(&mut payload).unwrap_or_default();
        let payload = payload.get(..length).unwrap_or_default();
        has_room &= entries.extend_from_slice(&[message.kind(), length as u8]).is_ok();
        has_room &= entries.extend_from_slice(payload).is_ok();
    })?;
    let code = match tapped.code {
        None => 0,
        Some(TapeCode::Iso) => 1,
        Some(TapeCode::Eia) => 2,
        Some(TapeCode::Ascii) => 3,
    };
    let decimals = match tapped.decimals {
        Decimals::LeastIncrement => 0,
        Decimals::Calculator => 1,
    };
    let [low, high] = (entries.len() as u16).to_le_bytes();
    let mut page = Page::new();
    for part in [&MAGIC[..], &SCHEMA_HASH.to_le_bytes(), &[code, decimals, low, high], &entries] {
        has_room &= page.extend_from_slice(part).is_ok();
    }
    let sum = checksum(&page).to_le_bytes();
    has_room &= page.extend_from_slice(&sum).is_ok();
    if has_room { Ok(page) } else { Err(ParametersError::Large) }
}

/// Reads the job and the properties of the tapped line from a flash page; `staging` checks the job and holds it.
///
/// # Errors
/// See [`PageError`].
pub fn read<'s>(page: &[u8], staging: &'s mut Staging) -> Result<(&'s Job, TappedLine), PageError> {
    if page.iter().take(HEADER_LEN).all(|byte| *byte == ERASED) {
        return Err(PageError::Blank);
    }
    let Some((&[m0, m1, m2, m3, s0, s1, s2, s3, code, decimals, low, high], body)) =
        page.split_first_chunk::<HEADER_LEN>()
    else {
        return Err(PageError::Form);
    };
    if [m0, m1, m2, m3] != MAGIC {
        return Err(PageError::Form);
    }
    if u32::from_le_bytes([s0, s1, s2, s3]) != SCHEMA_HASH {
        return Err(PageError::Schema);
    }
    let length = usize::from(u16::from_le_bytes([low, high]));
    let (entries, behind) = body.split_at_checked(length).ok_or(PageError::Form)?;
    let sum = behind.first_chunk::<CHECK_LEN>().ok_or(PageError::Form)?;
    if page.get(..HEADER_LEN + length).map(checksum) != Some(u32::from_le_bytes(*sum)) {
        return Err(PageError::Checksum);
    }
    let code = match code {
        0 => None,
        1 => Some(TapeCode::Iso),
        2 => Some(TapeCode::Eia),
        3 => Some(TapeCode::Ascii),
        _ => return Err(PageError::Form),
    };
    let decimals = match decimals {
        0 => Decimals::LeastIncrement,
        1 => Decimals::Calculator,
        _ => return Err(PageError::Form),
    };
    stage(entries, staging).map(|job| (job, TappedLine { code, decimals })).map_err(PageError::Set)
}

fn stage<'s>(mut entries: &[u8], staging: &'s mut Staging) -> Result<&'s Job, RefusalCode> {
    loop {
        let (&[kind, length], rest) = entries.split_first_chunk().ok_or(RefusalCode::Incomplete)?;
        let (payload, rest) = rest.split_at_checked(usize::from(length)).ok_or(RefusalCode::Incomplete)?;
        match Message::decode(kind, payload).map_err(|_| RefusalCode::Message)? {
            Message::Begin(begin) => staging.begin(begin.set)?,
            Message::Commit(commit) => return staging.commit(&commit),
            message => staging.add(&message)?,
        }
        entries = rest;
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{mill_job, ring_job};
    use super::*;
    use arcfeed_model::cut::Work;
    use arcfeed_model::stock::Stock;
    use arcfeed_model::tool::Edge;

    #[test]
    fn a_job_lies_there_as_it_was_to_the_bit() {
        for (job, code) in [(ring_job(), None), (mill_job(), Some(TapeCode::Eia)), (ring_job(), Some(TapeCode::Ascii))]
        {
            let decimals = if code.is_none() { Decimals::Calculator } else { Decimals::LeastIncrement };
            let tapped = TappedLine { code, decimals };
            let page = write(&job, tapped).unwrap();
            let mut staging = Staging::new();
            assert_eq!(read(&page, &mut staging), Ok((&job, tapped)));
            let in_flash = [&page[..], &[ERASED; 100]].concat();
            assert_eq!(read(&in_flash, &mut staging), Ok((&job, tapped)), "what lies behind does not count");
        }
    }

    #[test]
    fn a_rule_whose_arcs_come_with_each_segment_is_no_tapped_boards() {
        let mut job = ring_job();
        job.rules[3].work = Work::Ring(Edge::Outer, Stock::PerMove);
        assert_eq!(write(&job, TappedLine::default()), Err(ParametersError::EngagementPerMove(3)));
    }

    #[test]
    fn a_page_with_any_byte_altered_or_cut_off_is_none() {
        let page = write(&ring_job(), TappedLine { code: Some(TapeCode::Iso), ..TappedLine::default() }).unwrap();
        let mut staging = Staging::new();
        for at in 0..page.len() {
            for bit in 0..8 {
                let mut altered = page.clone();
                altered[at] ^= 1 << bit;
                assert!(read(&altered, &mut staging).is_err(), "byte {at}, bit {bit}");
            }
            assert!(read(&page[..at], &mut staging).is_err(), "{at} bytes");
        }
    }

    #[test]
    fn an_unwritten_page_is_distinguished_from_a_corrupt_one() {
        let mut staging = Staging::new();
        assert_eq!(read(&[ERASED; PAGE_MAX], &mut staging), Err(PageError::Blank));
        assert_eq!(read(&[], &mut staging), Err(PageError::Blank));
        assert_eq!(read(&[0; 64], &mut staging), Err(PageError::Form));
        let mut page = write(&mill_job(), TappedLine::default()).unwrap();
        page[4] ^= 1;
        assert_eq!(read(&page, &mut staging), Err(PageError::Schema));
    }
}
