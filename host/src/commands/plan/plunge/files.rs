//! Files of a plan of plunges. All of them are made before the first is written.

use std::path::{Path, PathBuf};

use arcfeed_kinematics::forward::ToolPose;
use arcfeed_plan::geometry::mesh::{Triangle, blank, finished};
use arcfeed_plan::output::end_mill_job::{EndMillJob, PlungeLaw, ToolShape};
use arcfeed_plan::output::plunge_nc::{PlungeSetup, axis_in_part, in_part, plunge_moves, write as program};
use arcfeed_plan::output::stl::to_stl;

use super::super::super::outcome::Failure;
use super::super::files::{CHORD_MM, CONTROL, RAYS_MM, file_stem, machine, machine_file, write_files};
use super::super::slot_frame::{BESIDE_PITCHES, ring};
use super::figures::PlungeFigures;
use super::page::page;
use super::result::PlungeResult;
use crate::post::cl::{Cl, ClPoint};

/// Writes the plan's files into a folder.
///
/// # Errors
/// A file cannot be written.
pub fn write(result: &PlungeResult, figures: &PlungeFigures, folder: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
    let failed = |error: std::io::Error| Failure::Input(error.to_string());
    let name = format!("{}.nc", file_stem(&result.part.name));
    let text = program(&result.plan.plunges, &setup(result));
    let [stock, finished] = meshes(result).map(|triangles| to_stl(&triangles));
    let (stock, finished) = (stock.map_err(failed)?, finished.map_err(failed)?);
    let (cl, job) = (cl(result).write(), job(result, &name));
    let page = page(result, figures).to_string();
    let files: [(&str, &[u8]); 6] = [
        (&name, text.as_bytes()),
        ("plunges.apt", cl.as_bytes()),
        ("job.toml", job.as_bytes()),
        ("stock.stl", &stock),
        ("finished.stl", &finished),
        ("report.html", page.as_bytes()),
    ];
    write_files(folder, &files, inputs)
}

fn setup(result: &PlungeResult) -> PlungeSetup {
    let part = &result.part;
    PlungeSetup {
        number: part.output.number,
        title: vec![
            part.name.clone(),
            format!("{} passages, plunge mill D{:.3} mm", part.blisk.blades, 2.0 * part.mill.radius_mm),
            "zero: where A and B cross, the rotor's axis along B".into(),
        ],
        unit: part.output.unit,
        tool: part.output.tool,
        rev_per_min: part.feeds.rev_per_min,
        coolant: part.output.coolant,
        tilt: result.rotary[0],
        index: result.rotary[1],
        passages: part.blisk.blades,
        feeds: result.feeds,
    }
}

/// CL points of all passages, part frame.
fn cl(result: &PlungeResult) -> Cl {
    let pitch_rad = result.part.blisk.pitch_rad();
    let mut cl = Cl { name: Some(result.part.name.clone()), ..Cl::default() };
    for passage in 0..result.part.blisk.blades {
        let passage_rad = f64::from(passage) * pitch_rad;
        for plunge in &result.plan.plunges {
            let axis = axis_in_part(plunge, passage_rad).into();
            for step in plunge_moves(plunge, &result.feeds) {
                let tip_mm = in_part(plunge, &step.to, passage_rad).into();
                let pose = ToolPose { tip_mm, axis };
                cl.points.push(ClPoint { line: 0, pose, feed_mm_per_min: step.feed_mm_per_min });
            }
        }
    }
    cl
}

/// Blank and finished part about the first passage, under the plunge law the whole part, in the frame of the first plunge.
fn meshes(result: &PlungeResult) -> [Vec<Triangle>; 2] {
    let blisk = &result.part.blisk;
    // A plan has a plunge.
    let turn = result.plan.plunges[0].to_tool;
    // The law governs the plunges of all passages, in the material that there is.
    let (reach_rad, last) = match result.part.law {
        Some(_) => (core::f64::consts::PI, blisk.blades.cast_signed() - 1),
        None => ((0.5 + BESIDE_PITCHES) * blisk.pitch_rad(), 1),
    };
    let sector = result.sector(reach_rad);
    [blank(blisk, &sector, CHORD_MM), finished(blisk, &sector, [0, last], CHORD_MM)]
        .map(|triangles| triangles.into_iter().map(|corners| corners.map(|corner| turn * corner)).collect())
}

fn job(result: &PlungeResult, program: &str) -> String {
    let part = &result.part;
    let source = part.machine_source.as_ref();
    let file = machine_file(source);
    EndMillJob {
        unit: part.output.unit,
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
        feed_max_mm_per_min: result.feeds.plunge_mm_per_min.max(result.feeds.approach_mm_per_min),
        remark: match part.law {
            Some(_) => "`arcfeed engage` finds the sections of the plunges, `adapt` keeps chip, power and torque by them.",
            None => "Plunges keep their programmed feed: the chip of a flat end is the feed per tooth, however wide the cut.",
        },
        law: part.law.as_ref().map(|limits| PlungeLaw { limits, ring: ring(&part.blisk, &result.plan.plunges[0].to_tool) }),
        rays_mm: Some(RAYS_MM),
        control: CONTROL,
        machine: machine(source, file.as_deref()),
    }
    .text()
}
