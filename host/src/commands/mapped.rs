//! A job with its program and the engagement map that its rules may name.

use std::path::Path;

use arcfeed_shared::cut::CutRule;

use super::outcome::{Failure, file_failure, load_unmapped};
use crate::adapt::{Adapted, Known, PlannedBlock, adapt_with};
use crate::checksum::fingerprint;
use crate::engagement::EngagementMap;
use crate::job::JobFile;
use crate::job::stl::StlFile;
use crate::job::workpiece::Blank;
use crate::program::Program;

/// A job and its program, both without errors, with the engagement map that the job names.
///
/// # Errors
/// Every error of the program, one a line; what is wrong with the map.
pub fn load(job: &Path) -> Result<(JobFile, Program), Failure> {
    let (mut file, program) = load_unmapped(job)?;
    if let Some(named) = &file.map_file {
        file.map = Some(EngagementMap::read(named, made_of(&file, &program)?)?);
    }
    Ok((file, program))
}

/// What an engagement map is made of: program, tool, workpiece.
///
/// # Errors
/// A file of the workpiece cannot be read.
pub fn made_of(file: &JobFile, program: &Program) -> Result<u64, Failure> {
    let JobFile { job, workpiece, cutting, .. } = file;
    let mut made_of = program.bytes();
    let depth = cutting.as_ref().map(|cutting| (cutting.axial_depth_mm, cutting.layers));
    let body = workpiece.as_ref().map(|workpiece| (workpiece.body, workpiece.step_mm));
    made_of.extend(format!("{:?}", (job.unit, job.tool, job.feed_per_tooth, body, depth)).bytes());
    match workpiece.as_ref().map(|workpiece| &workpiece.blank) {
        Some(Blank::Stl(StlFile { path, unit })) => {
            made_of.extend(format!("{unit:?}").bytes());
            made_of.extend(std::fs::read(path).map_err(|error| file_failure(path, &error))?);
        }
        shape => made_of.extend(format!("{shape:?}").bytes()),
    }
    Ok(fingerprint(&made_of))
}

/// The program with its job's feeds; says on stderr which moves keep their own although a cut rule speaks of them.
pub fn adapted(program: &Program, file: &JobFile) -> Adapted {
    let adapted = adapt_with(program, &file.job, Known::of(file));
    for warning in adapted.left_alone(program) {
        eprintln!("{}:{warning}", program.path.display());
    }
    warn_of_unknown(&adapted, program, file);
    adapted
}

/// Moves whose rule leaves their engaged arcs to the map, which does not know them.
fn warn_of_unknown(adapted: &Adapted, program: &Program, file: &JobFile) {
    let is_unknown = |block: &&PlannedBlock| {
        let rule = block.rule.and_then(|rule| file.job.rules.get(rule));
        block.along.is_none() && block.under.is_none() && rule.is_some_and(CutRule::is_told_along)
    };
    let unknown: Vec<&PlannedBlock> = adapted.blocks.iter().filter(is_unknown).collect();
    if let (Some(first), Some(named)) = (unknown.first(), &file.map_file) {
        let (program, map, count) = (program.path.display(), named.display(), unknown.len());
        eprintln!(
            "{program}:{}:1: warning: {map} knows nothing of {count} moves from here on: they keep their own feed; make the map \
             anew with `arcfeed engage` if rules have changed",
            first.line
        );
    }
}
