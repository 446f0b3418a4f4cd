//! The largest things that a desk keeps, in memory that its board gives it: handed on by value they would be copied along the stack.

use arcfeed_shared::job::Job;
use arcfeed_shared::wire::message::codes::RefusalCode;
use arcfeed_shared::wire::message::page::{self, PageError, Tapped};
use arcfeed_shared::wire::message::staging::Staging;

/// The job in force and the set on its way in; state.
#[derive(Debug)]
pub struct Papers {
    /// The job in force.
    pub(super) job: Option<Job>,
    /// The set on its way in.
    pub(super) staging: Staging,
}

impl Default for Papers {
    fn default() -> Self {
        Papers::new()
    }
}

impl Papers {
    /// No job, nothing on its way.
    pub const fn new() -> Self {
        Papers { job: None, staging: Staging::new() }
    }

    /// The same in place: they are too large to be made elsewhere.
    pub(super) fn clear(&mut self) {
        self.job = None;
        self.staging.forget();
    }

    /// Takes the job of a page of flash, if it suits; answers the line that it is for.
    pub(super) fn read_page(&mut self, page: &[u8], suits: impl Fn(&Job) -> bool) -> Result<Tapped, PageError> {
        let (job, tapped) = page::read(page, &mut self.staging)?;
        if !suits(job) {
            return Err(PageError::Set(RefusalCode::Value));
        }
        self.job = Some(job.clone());
        Ok(tapped)
    }
}
