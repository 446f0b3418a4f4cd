//! Checks of a campaign before its first run: every value that it names is tried in a job.

use std::collections::BTreeSet;
use std::path::PathBuf;

use serde_json::Value;

use super::super::outcome::{Failure, file_failure, read_source};
use super::super::simulate::assertions::Assertion;
use super::sweep_file::Campaign;
use crate::checksum::fingerprint as hash;
use crate::console::printed_by;
use crate::job::JobFile;
use crate::port::url::{Base, PortUrl};
use crate::report::figures::RunReport;

/// Checks values, URLs, assertions and figures; returns the files that the runs read.
///
/// # Errors
/// Names the first fault with its place in the sweep file.
pub fn check(campaign: &Campaign) -> Result<Vec<PathBuf>, Failure> {
    for assertion in &campaign.assertions {
        let read = assertion.text.parse::<Assertion>();
        read.map_err(|message| campaign.complaint(assertion.offset, message))?;
    }
    check_figures(campaign)?;
    check_placeholders(campaign)?;
    let base = campaign.named_values(1);
    let mut inputs = BTreeSet::from([campaign.path.clone()]);
    for axis in &campaign.axes {
        for probe in axis.probes() {
            let with_others: Vec<(&str, String)> = base
                .iter()
                .map(|(name, value)| (*name, if *name == axis.name { probe.text.clone() } else { value.clone() }))
                .collect();
            // Alone in the job, so that no other value is to blame; some keys make sense only together.
            let alone: Vec<(&str, String)> = with_others
                .iter()
                .filter(|(name, _)| *name == axis.name || campaign.is_placeholder(name))
                .cloned()
                .collect();
            let mut check = |values: &[_]| check_values(campaign, values, probe.offset, &mut inputs);
            check(&alone).or_else(|fault| check(&with_others).map_err(|_| fault))?;
        }
    }
    check_values(campaign, &base, campaign.job_offset, &mut inputs)?;
    Ok(inputs.into_iter().collect())
}

/// Hash of everything on which the results depend: the sweep file, the files that its runs read, and the release of
/// arcfeed.
///
/// # Errors
/// A file cannot be read.
pub fn fingerprint(campaign: &Campaign, inputs: &[PathBuf]) -> Result<u64, Failure> {
    let mut hashes = vec![hash(env!("CARGO_PKG_VERSION").as_bytes()), hash(campaign.text.as_bytes())];
    for path in inputs.iter().filter(|path| **path != campaign.path) {
        let bytes = std::fs::read(path).map_err(|error| file_failure(path, &error))?;
        hashes.push(hash(&bytes));
    }
    // The order of the paths depends on the folder; that of the contents does not.
    hashes.sort_unstable();
    Ok(hash(&hashes.into_iter().flat_map(u64::to_le_bytes).collect::<Vec<_>>()))
}

/// The job with these values is a job, its program a program, the URLs lead to the control in software.
fn check_values(
    campaign: &Campaign,
    values: &[(&str, String)],
    offset: usize,
    inputs: &mut BTreeSet<PathBuf>,
) -> Result<(), Failure> {
    let complaint = |message: String| Failure::from(campaign.complaint(offset, message));
    let file = JobFile::load_with(&campaign.job, &campaign.key_values(values))
        .map_err(|error| complaint(error.to_string()))?;
    inputs.extend(file.inputs(&campaign.job));
    for url in campaign.urls() {
        let filled = campaign.filled(url, values);
        let read: Result<PortUrl, _> = filled.parse();
        match read {
            Ok(read) if read.base == Base::Sim => {}
            Ok(_) => return Err(complaint(format!("`{filled}`: a campaign runs with sim: only"))),
            Err(error) => return Err(complaint(format!("`{filled}`: {error}"))),
        }
    }
    // Warnings of the job are those of every run.
    let (read, _) = printed_by(|| read_source(&campaign.job, file));
    read.map(drop).map_err(|failure| complaint(failure.into_message().0))
}

/// Every `{name}` of a URL has values.
fn check_placeholders(campaign: &Campaign) -> Result<(), Failure> {
    for url in campaign.urls() {
        for part in url.text.split('{').skip(1) {
            let name = part.split('}').next().unwrap_or_default();
            if !campaign.axes.iter().any(|axis| axis.name == name) {
                let message = format!("`{{{name}}}` has no values: add `{name}` to [grid], [list] or [random]");
                return Err(campaign.complaint(url.offset, message).into());
            }
        }
    }
    Ok(())
}

/// The first word of every figure is a figure of a run; the rest of the key depends on the job.
fn check_figures(campaign: &Campaign) -> Result<(), Failure> {
    let report = serde_json::json!(RunReport::default());
    let Value::Object(known) = &report else { return Ok(()) };
    for figure in &campaign.figures {
        let first = figure.text.split('.').next().unwrap_or_default();
        let message = match first {
            "real_time_factor" => "`real_time_factor` differs from run to run and from computer to computer".to_owned(),
            _ if known.contains_key(first) => continue,
            _ => {
                let known: Vec<&str> = known.keys().map(String::as_str).collect();
                format!("a run has no figure `{first}`; write one of {}", known.join(", "))
            }
        };
        return Err(campaign.complaint(figure.offset, message).into());
    }
    Ok(())
}
