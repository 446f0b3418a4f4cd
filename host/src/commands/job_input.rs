//! Job with its program and the engagement map that its rules may name.

use std::path::Path;

use arcfeed_model::cut::CutRule;

use super::executed_blocks::Warnings;
use super::outcome::{Failure, file_failure, load_source, load_unmapped};
use crate::adapt::{Adapted, Known, PlannedBlock, adapt_with};
use crate::checksum::fingerprint;
use crate::console::note;
use crate::engagement::EngagementMap;
use crate::job::JobFile;
use crate::job::stl::StlFile;
use crate::job::workpiece::Blank;
use crate::program::{Program, Source};

/// Loads a job and its program, both without errors, with the engagement map that the job names.
///
/// # Errors
/// Every error of the program, one per line; a program too long to be kept as a whole; a fault of the map.
pub fn load(job: &Path) -> Result<(JobFile, Program), Failure> {
    let (mut file, program) = load_unmapped(job)?;
    read_map(&mut file, || program.bytes())?;
    Ok((file, program))
}

/// As [`load`] with the program's text alone, and whether a feed could leak into one of its lines.
///
/// # Errors
/// Every error of the program, one per line; a fault of the map.
pub fn load_text(job: &Path) -> Result<(JobFile, Source, bool), Failure> {
    let (mut file, source, may_leak) = load_source(job)?;
    read_map(&mut file, || source.bytes.clone())?;
    Ok((file, source, may_leak))
}

fn read_map(file: &mut JobFile, program: impl FnOnce() -> Vec<u8>) -> Result<(), Failure> {
    if let Some(named) = &file.map_file {
        file.map = Some(EngagementMap::read(named, made_of(file, program())?)?);
    }
    Ok(())
}

/// Fingerprint of the input of an engagement map: program, tool, workpiece.
///
/// # Errors
/// A file of the workpiece cannot be read.
pub fn made_of(file: &JobFile, mut made_of: Vec<u8>) -> Result<u64, Failure> {
    let JobFile { job, workpiece, cutting, .. } = file;
    let depth = cutting.as_ref().map(|cutting| (cutting.axial_depth_mm, cutting.layers));
    let body = workpiece.as_ref().map(|workpiece| (workpiece.body, workpiece.step_mm));
    made_of.extend(
        format!("{:?}", (job.unit, job.tools.first().tool, job.tools.first().feed_per_tooth, body, depth)).bytes(),
    );
    match workpiece.as_ref().map(|workpiece| &workpiece.blank) {
        Some(Blank::Stl(StlFile { path, unit })) => {
            made_of.extend(format!("{unit:?}").bytes());
            made_of.extend(std::fs::read(path).map_err(|error| file_failure(path, &error))?);
        }
        shape => made_of.extend(format!("{shape:?}").bytes()),
    }
    Ok(fingerprint(&made_of))
}

/// Applies the job's feeds to the program; warns on stderr of moves that keep their own feed although a cut rule
/// matches them.
pub fn adapted(program: &Program, file: &JobFile) -> Adapted {
    let adapted = adapt_with(program, &file.job, Known::of(file));
    let (mut warnings, places) = (Warnings::default(), program.places.as_deref());
    adapted.left_alone(program).into_iter().for_each(|warning| warnings.add(&program.path, places, warning));
    let mut unknown = UnknownMoves::default();
    adapted.blocks.iter().for_each(|block| unknown.add(block, file));
    unknown.warn(&program.path, file);
    adapted
}

/// Moves that are not in the map although their rule takes the engaged arcs from it.
#[derive(Clone, Copy, Debug, Default)]
pub struct UnknownMoves {
    first_line: usize,
    count: usize,
}

impl UnknownMoves {
    /// Counts a block if it is one of these moves.
    pub fn add(&mut self, block: &PlannedBlock, file: &JobFile) {
        let rule = block.rule.and_then(|rule| file.job.rules.get(rule));
        if block.along.is_none() && block.under.is_none() && rule.is_some_and(CutRule::expects_engagement_per_move) {
            self.first_line = if self.count == 0 { block.line } else { self.first_line };
            self.count += 1;
        }
    }

    /// Warns on stderr of their number.
    pub fn warn(&self, program: &Path, file: &JobFile) {
        let Some(named) = file.map_file.as_ref().filter(|_| self.count > 0) else { return };
        note(format_args!(
            "{}:{}:1: warning: {} knows nothing of {} moves from here on: they keep their own feed; make the map \
             anew with `arcfeed engage` if rules have changed",
            program.display(),
            self.first_line,
            named.display(),
            self.count
        ));
    }
}
