//! Adapted program for a control with a dialect of its own.

use std::path::{Path, PathBuf};

use arcfeed_model::job::FeedPolicy;
use arcfeed_units::PERCENT;

use super::outcome::{Failure, write_whole};
use crate::adapt::{Known, adapt_with};
use crate::job::JobFile;
use crate::linuxcnc::codes::FeedSource;
use crate::linuxcnc::dialect::{Translation, translate};
use crate::linuxcnc::prepared::prepare;
use crate::program::Source;

/// Control other than Fanuc for which a program can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum TargetControl {
    /// LinuxCNC
    Linuxcnc,
}

/// Path of the file with the moves for the LinuxCNC component `arcfeed`, which stands beside the NC file `output`.
pub fn prepared_path(output: &Path) -> PathBuf {
    let mut name = output.as_os_str().to_owned();
    name.push(".arcfeed");
    name.into()
}

/// Source of the feed on LinuxCNC for this job: the component, or F words alone.
pub fn feed_source(file: &JobFile) -> FeedSource {
    match file.job.policy {
        FeedPolicy::RewriteOnly(_) => FeedSource::Words,
        FeedPolicy::SafeBase | FeedPolicy::OverrideOnly => FeedSource::Component,
    }
}

/// Checks that LinuxCNC can execute a program, and that its component can raise the feed as far as the job allows.
///
/// # Errors
/// A text with every line that LinuxCNC cannot execute.
pub fn check_for_linuxcnc(source: &Source, file: &JobFile) -> Result<(), Failure> {
    let percent = file.job.limits.max_percent;
    if feed_source(file) == FeedSource::Component && f64::from(percent) > 2.0 * f64::from(PERCENT) {
        let path = source.path.display();
        return Err(Failure::Input(format!(
            "{path}: the override goes up to {percent} %, and the component for LinuxCNC to 200; write `max = 200` in [override]"
        )));
    }
    translated(source, source.bytes.clone(), feed_source(file)).map(drop)
}

/// Writes an adapted program in LinuxCNC's dialect and, if its feeds need the component, the file with its moves before
/// it: a program without its file is not governed.
///
/// # Errors
/// It has a line that LinuxCNC cannot execute, or a file cannot be written.
pub fn write_for_linuxcnc(output: &Path, source: &Source, file: &JobFile, text: Vec<u8>) -> Result<(), Failure> {
    let feed = feed_source(file);
    if feed == FeedSource::Words {
        return write_whole(output, &translated(source, text, feed)?.text);
    }
    let adapted = adapt_with(&source.whole().map_err(Failure::Input)?, &file.job, Known::of(file));
    let translation = translated(source, adapted.text, feed)?;
    let prepared = prepare(&translation, &adapted.blocks, &file.job)
        .map_err(|error| Failure::Input(format!("{}: {error}", source.path.display())))?;
    write_whole(&prepared_path(output), &prepared)?;
    write_whole(output, &translation.text)
}

/// Text of a program, in LinuxCNC's dialect.
///
/// # Errors
/// Every line that LinuxCNC cannot execute; settings of a control that reduces feeds which LinuxCNC does not.
pub fn translated(source: &Source, bytes: Vec<u8>, feed: FeedSource) -> Result<Translation, Failure> {
    let places = if bytes == source.bytes { source.places.clone() } else { None };
    let Source { path, settings, tables, .. } = source.clone();
    if settings.compensation.inside_arc_least_percent.is_some() {
        return Err(Failure::Input(format!(
            "{}: the settings say that the control reduces the feed on inside arcs (inside_arc_least), and LinuxCNC does not: remove \
             the key",
            path.display()
        )));
    }
    let text = Source { path, bytes, settings, tables, macro_line: None, places };
    translate(&text, feed).map_err(|refusals| {
        let name = text.path.display();
        let lines = refusals.into_iter().map(|refusal| format!("{name}:{}", text.in_file(refusal)));
        Failure::Input(lines.collect::<Vec<_>>().join("\n"))
    })
}
