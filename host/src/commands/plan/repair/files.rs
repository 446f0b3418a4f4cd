//! Files of the plan of a repair. All of them are made before the first is written.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use arcfeed_plan::output::stl::to_stl;
use arcfeed_plan::repair::passes::RepairContact;
use arcfeed_plan::vector::Vector;

use super::super::super::outcome::Failure;
use super::super::files::write_files;
use super::super::finish::files::{job, program};
use super::figures::{RepairFigures, region_word};
use super::page::page;
use super::result::RepairResult;

/// Distance of the simulation's dexel rays.
const RAYS_MM: f64 = 0.1;
/// Remark about the feeds in the job file.
const REMARK: &str = "The F words of the program keep the feed per tooth at the contact (docs/repair.md).";

/// Writes the plan's files into a folder.
///
/// # Errors
/// The program cannot be written for the machine, or a file cannot be written.
pub fn write(result: &RepairResult, figures: &RepairFigures, folder: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
    let (allowance, contacts) = (allowance(result), contacts(result));
    let page = page(result, figures).to_string();
    let (name, program) = program(&result.path)?;
    let job = job(&result.path, &name, REMARK, Some(RAYS_MM));
    let cl = result.path.cl.write();
    let meshes = result.solids.each_ref().map(|solid| to_stl(solid));
    let [stock, finished] = meshes.map(|mesh| mesh.map_err(|error| Failure::Input(error.to_string())));
    let (stock, finished) = (stock?, finished?);
    let files: [(&str, &[u8]); 8] = [
        (&name, program.as_bytes()),
        ("repair.apt", cl.as_bytes()),
        ("job.toml", job.as_bytes()),
        ("stock.stl", &stock),
        ("finished.stl", &finished),
        ("allowance.csv", allowance.as_bytes()),
        ("contacts.csv", contacts.as_bytes()),
        ("report.html", page.as_bytes()),
    ];
    write_files(folder, &files, inputs)
}

/// One line for each place of the lattice.
fn allowance(result: &RepairResult) -> String {
    let plan = &result.plan;
    let mut text = String::from(
        "# allowance above the nominal surface before, along its normal and to the nearest point; left: after finishing, empty where nothing is taken; predicted: what the balls of the finish leave\n\
         row,column,u,v,x_mm,y_mm,z_mm,nx,ny,nz,along_mm,nearest_mm,region,left_mm,predicted_mm\n",
    );
    let value = |value: Option<f64>| value.map_or_else(String::new, |mm| format!("{mm:.6}"));
    for (row, nodes) in plan.field.rows.iter().enumerate() {
        for (column, node) in nodes.iter().enumerate() {
            let _ = writeln!(
                text,
                "{row},{column},{},{},{},{},{},{}",
                place(node.at, &[node.point.coords, node.normal]),
                value(node.along_mm),
                value(node.nearest_mm),
                region_word(plan.regions.regions[row][column]),
                value(plan.planned_mm[row][column]),
                value(result.predicted_mm[row][column])
            );
        }
    }
    text
}

/// Contact points: rough layers from the highest, then the finish.
fn contacts(result: &RepairResult) -> String {
    let plan = &result.plan;
    let mut text = String::from(
        "# contact points of the ball: its centre lies at the radius along the normal; layer 0 is the finish\n\
         layer,run,u,v,x_mm,y_mm,z_mm,nx,ny,nz,left_mm\n",
    );
    let mut add = |layer: usize, runs: &[Vec<RepairContact>]| {
        for (run, contact) in runs.iter().enumerate().flat_map(|(run, line)| line.iter().map(move |at| (run, at))) {
            let at = place(contact.at, &[contact.point.coords, contact.normal]);
            let _ = writeln!(text, "{layer},{run},{at},{:.6}", contact.left_mm);
        }
    };
    for (layer, (_, runs)) in plan.layers.iter().enumerate() {
        add(layer + 1, runs);
    }
    add(0, &plan.finish);
    text
}

fn place(at: [f64; 2], vectors: &[Vector; 2]) -> String {
    let values = at.iter().chain(vectors.iter().flat_map(|vector| vector.iter()));
    values.map(|value| format!("{value:.6}")).collect::<Vec<_>>().join(",")
}
