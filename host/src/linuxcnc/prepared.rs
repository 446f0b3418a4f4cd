//! Prepared program for the component `arcfeed`: parameters of the job, and the moves of one NC file by their lines.

use arcfeed_link::message::Message;
use arcfeed_link::message::moves::MoveError;
use arcfeed_link::message::parameters::{self, ParametersError};
use arcfeed_link::message::prepared::{PreparedHeader, seal, write_entry};
use arcfeed_model::job::Job;
use arcfeed_nc::modal::Feed;

use super::dialect::Translation;
use crate::adapt::PlannedBlock;
use crate::board::plan::planned_move;
use crate::checksum::CRC_32;

/// Reason why the file for the component cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PrepareError {
    /// The job has more rules or tables than the component can hold.
    #[error("the job is too large for the component: {0:?}")]
    Job(ParametersError),
    /// A move of this line, counted from 1, has numbers out of the range of its message.
    #[error("line {0}: this move cannot be sent to the component: {1:?}")]
    Move(usize, MoveError),
}

/// File for the component: the job's parameters and the moves of an adapted program. Moves in inverse time and under functions that no law
/// covers are left out; for them the override is 100 %.
///
/// # Errors
/// The job or a move does not fit.
pub fn prepare(translation: &Translation, blocks: &[PlannedBlock], job: &Job) -> Result<Vec<u8>, PrepareError> {
    let (mut entries, mut moves) = (Vec::new(), 0);
    let mut emit = |line: usize, message: &Message| {
        write_entry(line as u32, message, &mut |bytes| entries.extend_from_slice(bytes));
    };
    parameters::messages(job, 1, &mut |message| emit(0, &message)).map_err(PrepareError::Job)?;
    for block in blocks.iter().filter(|block| is_followed(block)) {
        let Some(line) = translation.first_lines.get(block.line - 1) else { continue };
        let messages = planned_move(block, job).map_err(|error| PrepareError::Move(block.line, error))?;
        messages.iter().for_each(|message| emit(*line, message));
        moves += 1;
    }
    let text = &translation.text;
    let (program_check, program_len, entries_len) = (CRC_32.checksum(text), text.len() as u32, entries.len() as u32);
    let mut bytes = PreparedHeader { program_check, program_len, moves, entries_len }.encode().to_vec();
    bytes.extend(entries);
    bytes.extend(seal(&bytes));
    Ok(bytes)
}

fn is_followed(block: &PlannedBlock) -> bool {
    block.under.is_none() && !matches!(block.segment.feed, Feed::InverseTime(_))
}
