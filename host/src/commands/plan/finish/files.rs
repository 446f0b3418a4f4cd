//! Files of a plan of finishing passes. All of them are made before the first is written.

use std::path::{Path, PathBuf};

use arcfeed_kinematics::deviation::Mode;
use arcfeed_plan::output::end_mill_job::{EndMillJob, ToolShape};
use arcfeed_units::LengthUnit;

use super::super::super::outcome::Failure;
use super::super::files::{CONTROL, file_stem, machine, machine_file, write_files};
use super::figures::FinishFigures;
use super::page::{page, picture};
use super::result::{FinishResult, TOLERANCE};
use crate::post::nc::{self, Style, ToolStart};

/// Writes the plan's files into a folder.
///
/// # Errors
/// The program cannot be written for the machine, or a file cannot be written.
pub fn write(result: &FinishResult, figures: &FinishFigures, folder: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
    let (name, text) = program(result)?;
    let remark = "The F words of the program keep the feed per tooth at the contact (docs/finish.md).";
    let (cl, job, page) = (result.cl.write(), job(result, &name, remark, None), page(result, figures).to_string());
    let files: [(&str, &[u8]); 5] = [
        (&name, text.as_bytes()),
        ("finish.apt", cl.as_bytes()),
        ("job.toml", job.as_bytes()),
        ("axes.svg", &picture(result).into_bytes()),
        ("report.html", page.as_bytes()),
    ];
    write_files(folder, &files, inputs)
}

/// Name and text of the program's file.
///
/// # Errors
/// The program cannot be written for the machine.
pub fn program(result: &FinishResult) -> Result<(String, String), Failure> {
    let output = &result.part.output;
    let style = Style {
        name: &result.part.machine.name,
        mode: Mode::PartRotary,
        tolerance: TOLERANCE,
        start: Some(ToolStart {
            number: output.number,
            tool: output.tool,
            rev_per_min: result.part.feeds.rev_per_min,
            coolant: output.coolant,
        }),
    };
    let (text, _) = nc::write(&result.cl, &result.axes, &result.task, &style)
        .map_err(|error| Failure::Input(format!("{}: move {error}", result.part.name)))?;
    Ok((format!("{}.nc", file_stem(&result.part.name)), text))
}

/// Text of the job file. With `rays_mm`, the distance of the dexel rays, the job also names files of stock and finished
/// part.
pub fn job(result: &FinishResult, program: &str, remark: &str, rays_mm: Option<f64>) -> String {
    let part = &result.part;
    let source = part.machine_source.as_ref();
    let file = machine_file(source);
    let feeds = result.cl.points.iter().filter_map(|point| point.feed_mm_per_min);
    EndMillJob {
        // The program is metric, whatever the part's unit.
        unit: LengthUnit::Mm,
        program,
        shape: ToolShape {
            radius_mm: part.mill.radius_mm,
            corner_radius_mm: part.mill.corner_radius_mm,
            height_mm: part.mill.length_mm,
            teeth: part.mill.teeth,
        },
        tool: part.output.tool,
        rev_per_min: part.feeds.rev_per_min,
        feed_per_tooth_mm: part.feeds.per_tooth_mm,
        feed_max_mm_per_min: feeds.fold(0.0, f64::max),
        remark,
        law: None,
        rays_mm,
        control: CONTROL,
        machine: machine(source, file.as_deref()),
    }
    .text()
}
