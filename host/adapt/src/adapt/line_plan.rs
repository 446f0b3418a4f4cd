//! Feed plan of a program that is too long to be kept in memory.

use arcfeed_model::job::Job;
use arcfeed_nc::text::Lines;

use super::known::{KeptLines, Known};
use super::rewrite::Leak;
use super::writer::{PlannedLine, Writer};
use crate::program::{ProgramLine, Source, may_have_contours};

/// Feed plan of a program of any length, line by line in constant memory. Unlike [`super::adapt`], it does not set
/// the override at the end of each move, which depends on later moves.
pub struct LinePlan<'a> {
    source: &'a Source,
    job: &'a Job,
    known: Known<'a>,
    line_end: &'a [u8],
    has_contours: bool,
    kept: KeptLines,
}

impl<'a> LinePlan<'a> {
    /// Plan for a program without errors. `may_leak` says whether a feed set by a law could stay in force for a later
    /// line that needs another feed; then the program is read several times.
    pub fn new(source: &'a Source, may_leak: bool, job: &'a Job, known: Known<'a>) -> Self {
        let known = Known { places: source.places.as_deref(), ..known };
        let line_end = Lines::new(&source.bytes).next().map_or(&b""[..], |line| line.ending);
        let has_contours = may_have_contours(&source.bytes);
        let mut plan = LinePlan { source, job, known, line_end, has_contours, kept: KeptLines::default() };
        if may_leak {
            while let Err(last_governed) = plan.run(|_, _| {}) {
                plan.kept = plan.kept.with(last_governed);
            }
        }
        plan
    }

    /// Calls `each` for every line of the program, with the line as programmed and as it is sent.
    ///
    /// # Errors
    /// None, as long as [`may_leak`](super::rewrite::may_leak) knows every line into which a feed can leak.
    pub fn each(&self, each: impl FnMut(&ProgramLine, PlannedLine)) -> Result<(), Leak> {
        self.run(each).map_err(|_| Leak)
    }

    /// Up to the first feed that leaks; then the line that it comes from.
    fn run(&self, mut each: impl FnMut(&ProgramLine, PlannedLine)) -> Result<(), Option<usize>> {
        let reader = self.source.reader();
        let mut writer = Writer::new(reader.control(), self.line_end, self.job, self.known, &self.kept);
        if self.has_contours {
            writer.read_contours(reader.control(), Lines::new(&self.source.bytes).map(|raw| raw.text));
        }
        let mut lines = self.source.lines();
        while let Some(line) = lines.next_line() {
            let Ok(planned) = writer.take(line) else { return Err(writer.last_governed) };
            each(line, planned);
        }
        Ok(())
    }
}
