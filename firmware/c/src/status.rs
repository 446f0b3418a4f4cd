//! Results of the calls.

use arcfeed_link::message::codes::RefusalCode;
use arcfeed_link::message::page::PageError;
use arcfeed_link::message::prepared::PreparedError;

/// Result of a call of this interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum ArcfeedStatus {
    /// The call has done what it should.
    Ok = 0,
    /// More bytes of the prepared program are needed.
    Incomplete = 1,
    /// A pointer is null.
    Null = -1,
    /// A pointer is not aligned to its type, or the memory of a controller not to `ARCFEED_ALIGNMENT`.
    Alignment = -2,
    /// The memory is smaller than a controller without moves.
    Size = -3,
    /// There is no controller at this address.
    NoController = -4,
    /// There is a controller at this address already.
    Exists = -5,
    /// Not possible while the laws are armed: disarm first.
    Busy = -6,
    /// The bytes are not a page or a prepared program.
    Form = -7,
    /// The bytes were written for another version of the messages.
    Schema = -8,
    /// Wrong checksum.
    Checksum = -9,
    /// A value is invalid.
    Value = -10,
    /// The memory has no place for another move.
    Full = -11,
    /// A line is not after the line of the last move.
    Order = -12,
    /// There are no parameters yet.
    NoParameters = -13,
    /// An input of the tick is invalid; the tick has been done without it.
    Input = -14,
}

impl From<RefusalCode> for ArcfeedStatus {
    fn from(refusal: RefusalCode) -> Self {
        match refusal {
            RefusalCode::Busy => ArcfeedStatus::Busy,
            RefusalCode::NoParameters => ArcfeedStatus::NoParameters,
            RefusalCode::Full => ArcfeedStatus::Full,
            RefusalCode::Order => ArcfeedStatus::Order,
            RefusalCode::Checksum => ArcfeedStatus::Checksum,
            RefusalCode::Message | RefusalCode::NoSet | RefusalCode::Incomplete => ArcfeedStatus::Form,
            RefusalCode::Value | RefusalCode::Outdated | RefusalCode::Faulted => ArcfeedStatus::Value,
            RefusalCode::NotFresh | RefusalCode::Operator | RefusalCode::Condition => ArcfeedStatus::Value,
        }
    }
}

impl From<PageError> for ArcfeedStatus {
    fn from(error: PageError) -> Self {
        match error {
            PageError::Blank | PageError::Form => ArcfeedStatus::Form,
            PageError::Schema => ArcfeedStatus::Schema,
            PageError::Checksum => ArcfeedStatus::Checksum,
            PageError::Set(refusal) => refusal.into(),
        }
    }
}

impl From<PreparedError> for ArcfeedStatus {
    fn from(error: PreparedError) -> Self {
        match error {
            PreparedError::Form => ArcfeedStatus::Form,
            PreparedError::Schema => ArcfeedStatus::Schema,
            PreparedError::Checksum => ArcfeedStatus::Checksum,
            PreparedError::Entry(refusal) => refusal.into(),
        }
    }
}
