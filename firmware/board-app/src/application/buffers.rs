//! The largest objects of the command handler, in memory that the board provides; moved by value they would be copied
//! on the stack.

use arcfeed_link::message::codes::RefusalCode;
use arcfeed_link::message::page::{self, PageError, TappedLine};
use arcfeed_link::message::staging::{Staging, empty_job};
use arcfeed_link::message::{moves, table};
use arcfeed_model::job::Job;
use arcfeed_model::machine::{FeedLimit, LimitedBy};
use arcfeed_units::{MmPerMin, Nm, RevPerMin};

use arcfeed_firmware::active::{ActiveSegment, Conditions};

use super::received_table::ReceivedTable;

/// Large data of the command handler: the job in force, the job that is being received, and the table along the next
/// segment.
#[derive(Debug)]
pub struct Buffers {
    /// The job in force, if there is one.
    job: Job,
    has_job: bool,
    /// Receiver of the next job's messages.
    pub staging: Staging,
    /// Table received for the next segment, or for one that waits for a free slot.
    pub table: ReceivedTable,
}

impl Default for Buffers {
    fn default() -> Self {
        Buffers::new()
    }
}

impl Buffers {
    /// Empty buffers: no job, no parameter set, no table.
    pub const fn new() -> Self {
        Buffers { job: empty_job(), has_job: false, staging: Staging::new(), table: ReceivedTable::None }
    }

    /// Makes the buffers empty in place, because they are too large to be built elsewhere and moved.
    pub fn clear(&mut self) {
        self.has_job = false;
        self.staging.forget();
        self.table = ReceivedTable::None;
    }

    /// The job in force; `None` if there is none.
    pub fn job(&self) -> Option<&Job> {
        self.has_job.then_some(&self.job)
    }

    /// Puts the job that was received last in force.
    pub fn put_in_force(&mut self) {
        self.staging.swap_job(&mut self.job);
        self.has_job = true;
    }

    /// Checks a segment of the host, with the table received for it, against the job in force.
    ///
    /// # Errors
    /// [`RefusalCode`] to be sent to the host.
    pub fn check(&self, segment: &table::Segment) -> Result<(), RefusalCode> {
        let job = self.job().ok_or(RefusalCode::NoParameters)?;
        let rule = segment.rule.map(|rule| job.rules.get(usize::from(rule)).ok_or(RefusalCode::Value)).transpose()?;
        moves::decode(segment).map_err(|_| RefusalCode::Value)?;
        self.table.check_rule(rule)
    }

    /// Prepares a checked segment under its law, with the table received for it, which is then deleted. `None` only for
    /// a segment that was not checked.
    pub fn prepare(&mut self, message: &table::Segment) -> Option<ActiveSegment> {
        let job = self.has_job.then_some(&self.job)?;
        let segment = moves::decode(message).ok()?;
        let rule = message.rule.and_then(|rule| job.rules.get(usize::from(rule)));
        let own = Conditions::with_table(&segment, (rule, self.table.table()), job);
        let ceiling =
            message.max_feed.map(|feed| FeedLimit { feed: MmPerMin(Nm(feed).to_mm() as f32), by: LimitedBy::Ceiling });
        let conditions = Conditions {
            spindle: message.spindle.map_or(own.spindle, |speed| RevPerMin(speed.value())),
            end_percent: message.end_percent.unwrap_or(own.end_percent),
            limit: own.limit.map_or(ceiling, |own| Some(ceiling.map_or(own, |ceiling| own.lower(ceiling)))),
            ..own
        };
        let active = ActiveSegment::with_conditions(&segment, &conditions, job);
        self.table = ReceivedTable::None;
        Some(active)
    }

    /// Reads the job from a flash page and puts it in force, if `suits` accepts it. Returns the properties of the
    /// tapped line that stand in the page too.
    pub fn read_page(&mut self, page: &[u8], suits: impl Fn(&Job) -> bool) -> Result<TappedLine, PageError> {
        let (job, tapped) = page::read(page, &mut self.staging)?;
        if !suits(job) {
            return Err(PageError::Set(RefusalCode::Value));
        }
        self.put_in_force();
        Ok(tapped)
    }
}
