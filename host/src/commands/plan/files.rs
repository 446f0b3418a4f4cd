//! Files of a plan. All of them are made before the first is written.

use std::path::{Path, PathBuf};

use arcfeed_plan::geometry::mesh::{Triangle, blank, finished};
use arcfeed_plan::output::job::{JobFile, Law, Machine};
use arcfeed_plan::output::limits::StockLimit;
use arcfeed_plan::output::nc::{Indexing, Setup, write as program};
use arcfeed_plan::output::stl::to_stl;
use arcfeed_plan::output::workpiece::{StockShape, Workpiece};

use super::super::engage::write_map_of_equal_slots;
use super::super::outcome::{Failure, file_failure, refuse_inputs, write_whole};
use super::plan_result::{PlanResult, feeds};
use super::refusal::{pass_folder, set_aside};
use super::slot_frame::{blades, in_slot, ring, sector, sector_of_reach};
use super::{earlier_stock, page, viewer};
use crate::console::note;
use crate::part::MachineSource;
use crate::report::page::Page;

/// Largest distance of meshes from the surfaces, mm.
pub(super) const CHORD_MM: f64 = 0.02;
/// Distance of the simulation's dexel rays, mm.
pub(super) const RAYS_MM: f64 = 0.5;
/// Settings of the control, beside the job.
const SETTINGS: &str = "settings.toml";
/// Control of the programs.
pub(super) const CONTROL: &str = "fanuc-16i";

/// Writes the files of all passes, each into its own folder. The workpiece of a job is the whole wheel, or the part of it about the first
/// slot, as the earlier passes leave it.
///
/// # Errors
/// A program cannot be written for the control, or a file cannot be written.
pub fn write(passes: &[PlanResult], is_whole: bool, folder: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
    set_aside(folder, passes.len() + 1);
    passes.iter().try_for_each(|pass| write_pass(pass, is_whole, &pass_folder(folder, pass.number()), inputs))
}

fn write_pass(composed: &PlanResult, is_whole: bool, folder: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
    let failed = |error: &dyn std::fmt::Display| Failure::Input(error.to_string());
    let stem = file_stem(&composed.part.name);
    let number = composed.number();
    let stem = if number > 1 { format!("{stem}-pass-{number}") } else { stem };
    let name = format!("{stem}.nc");
    let text = program(&composed.valued.plan.path, &setup(composed)).map_err(|error| failed(&error))?;
    let [blank, part] = meshes(composed, is_whole);
    let part = to_stl(&part).map_err(|error| failed(&error))?;
    let stock = match number {
        2.. => earlier_stock::stl(composed, &blank, RAYS_MM).map_err(|why| failed(&why))?,
        _ => to_stl(&blank).map_err(|error| failed(&error))?,
    };
    let settings = control_settings(composed);
    let map = format!("{stem}.engaged.toml");
    let shape = match (is_whole, number) {
        (false, _) => StockShape::Mesh("stock.stl"),
        (true, 2..) => StockShape::WholeMesh("stock.stl"),
        (true, _) => StockShape::Ring(ring(&composed.part.blisk, &composed.valued.plan.turn)),
    };
    let job = job(composed, shape, [&name, &map], settings.as_ref().map(|_| SETTINGS))?;
    let page = Page { viewer: Some(viewer::data(composed)), ..page::report(composed).page() }.to_string();
    let mut files: Vec<(&str, &[u8])> = vec![
        (&name, text.as_bytes()),
        ("job.toml", job.as_bytes()),
        ("stock.stl", &stock),
        ("finished.stl", &part),
        ("report.html", page.as_bytes()),
    ];
    files.extend(settings.as_ref().map(|text| (SETTINGS, text.as_bytes())));
    write_files(folder, &files, inputs)?;
    if composed.part.is_engaged_arc {
        // Without the map, or with one of another plan, the job is refused.
        let (file, moves) = write_map_of_equal_slots(&folder.join("job.toml"))?;
        note(format_args!("{file}: {moves} moves"));
    }
    Ok(())
}

/// Settings of the simulated control, where the machine's travel is known: the program ends with a return to the reference point
/// of Z, which is at zero without them.
fn control_settings(composed: &PlanResult) -> Option<String> {
    let [_, _, z] = composed.part.machine.as_ref()?.machine.linear();
    let [_, highest_mm] = z.range_mm?;
    Some(format!(
        "# Assumed: the first reference point of Z is at the upper end of its travel in the machine file.\nunit = \"mm\"\n\n\
         [reference]\n1 = {{ Z = {highest_mm:?} }}\n"
    ))
}

/// Writes files, each with its name, into a folder, which is created if it does not exist.
///
/// # Errors
/// One of them is an input, or cannot be written.
pub(super) fn write_files(folder: &Path, files: &[(&str, &[u8])], inputs: &[PathBuf]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
    for (name, _) in files {
        refuse_inputs(&[Some(&folder.join(name))], inputs)?;
    }
    for (name, bytes) in files {
        let path = folder.join(name);
        write_whole(&path, bytes)?;
        note(format_args!("{}: {} bytes", path.display(), bytes.len()));
    }
    Ok(())
}

fn setup(composed: &PlanResult) -> Setup {
    let part = &composed.part;
    let mut title = vec![
        part.name.clone(),
        format!(
            "{} slots, cup mill R{:.3} r{:.3} mm",
            part.blisk.blades, part.cutter.outer_radius_mm, part.cutter.inner_radius_mm
        ),
        "zero: where A and B cross, the rotor's axis along B".into(),
    ];
    title.extend(part.slot_name());
    if composed.number() > 1 {
        // Its feeds are those of the material that the pass before leaves.
        title.push(format!("pass {}: only after pass {} in all slots", composed.number(), composed.number() - 1));
    }
    Setup {
        number: part.output.number + composed.earlier.len() as u32,
        title,
        unit: part.output.unit,
        tool: part.output.tool,
        rev_per_min: part.feeds.rev_per_min,
        coolant: part.output.coolant,
        tilt_deg: composed.placement.tilt_deg,
        slots_deg: composed.slots_deg(),
        feeds: feeds(part),
        indexing: Indexing::AtClearance,
        labels: true,
        reports: part.output.dprnt,
    }
}

/// Blank and finished part, whole or about the slot, slot frame.
fn meshes(composed: &PlanResult, is_whole: bool) -> [Vec<Triangle>; 2] {
    let blisk = &composed.part.blisk;
    let (sector, blades) = if is_whole {
        (sector_of_reach(composed, core::f64::consts::PI), [0, blisk.count() - 1])
    } else {
        (sector(composed), blades(composed))
    };
    [blank(blisk, &sector, CHORD_MM), finished(blisk, &sector, blades, CHORD_MM)]
        .map(|triangles| in_slot(composed, triangles))
}

fn job(
    composed: &PlanResult,
    stock: StockShape<'_>,
    [program, map]: [&str; 2],
    settings: Option<&str>,
) -> Result<String, Failure> {
    let part = &composed.part;
    let source = part.machine_source.as_ref();
    let file = machine_file(source);
    if !part.is_engaged_arc && !composed.limits.iter().any(StockLimit::is_governed_by_line) {
        let message = "no movement has its thickest chip at one face of the blank, as law = \"circumference\" needs: leave out `law`";
        return Err(Failure::Input(message.into()));
    }
    Ok(JobFile {
        unit: part.output.unit,
        program,
        mill: &part.cutter,
        tool: part.output.tool,
        cutting_mm_per_min: feeds(part).cutting_mm_per_min,
        rev_per_min: part.feeds.rev_per_min,
        feed_per_tooth_mm: part.feeds.per_tooth_mm,
        limits: &composed.limits,
        law: if part.is_engaged_arc { Law::EngagedArc(map) } else { Law::Circumference },
        workpiece: Some(Workpiece { stock, target: Some("finished.stl"), step_mm: RAYS_MM }),
        control: CONTROL,
        settings,
        machine: machine(source, file.as_deref()),
    }
    .text())
}

/// Absolute path of the machine's file, which the job finds from any folder.
pub(super) fn machine_file(source: Option<&MachineSource>) -> Option<String> {
    let Some(MachineSource::File(path)) = source else { return None };
    let whole = path.canonicalize().unwrap_or_else(|_| path.clone());
    Some(whole.to_string_lossy().into_owned())
}

/// The machine as the job names it; `file` is that of [`machine_file`].
pub(super) fn machine<'s>(source: Option<&'s MachineSource>, file: Option<&'s str>) -> Option<Machine<'s>> {
    match source? {
        MachineSource::Preset(preset) => Some(Machine::Preset(preset)),
        MachineSource::File(_) => file.map(Machine::File),
    }
}

/// File name that every file system accepts.
pub(super) fn file_stem(name: &str) -> String {
    let stem: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' }).collect();
    if stem.trim_matches(['-', '.']).is_empty() { "plan".into() } else { stem }
}
