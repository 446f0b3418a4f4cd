//! The influence of damping on the finishing of a blade: the study of Lorong et al., Simulation of a finishing operation, 2012, section 4.3, on a blade of our own.
//!
//! `cargo run --profile dist -p arcfeed-blades --example blade_damping -- blade.png` prints the tables of docs/virtual-machining.md and paints its picture: some ten
//! minutes on two cores.

use std::path::PathBuf;

use arcfeed_blades::finishing::pass::PassResolution;
use arcfeed_fe::field::Field;
use arcfeed_modal::flexible::Workpiece;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::bench::{BLADE, Bench, Damping, Failure, Outcome, WINDOWS, blade_alone, tool_point_mm};
use crate::picture::Picture;

mod bench;

mod blisk;

mod picture;

/// Chosen once, so that the limit of the tool alone is near the 0.03 of the paper.
const STEPOVER_MM: f64 = 0.21;
const FINENESS: PassResolution = PassResolution { rise_mm: 0.2, ray_mm: 0.05, steps: 400 };
/// Finer resolution, for comparison.
const FINER: PassResolution = PassResolution { rise_mm: 0.1, ray_mm: 0.025, steps: 800 };
/// Halvings of the range in which a limit is, by its logarithm.
const HALVINGS: usize = 6;
const OF_WORKPIECE: [f64; 2] = [0.002, 0.016];
const OF_TOOL: [f64; 2] = [0.01, 0.08];
const UM_PER_MM: f64 = 1e3;

const fn both(workpiece: f64, tool: f64) -> Damping {
    Damping { workpiece: Some(workpiece), tool: Some(tool) }
}

const fn workpiece(ratio: f64) -> Damping {
    Damping { workpiece: Some(ratio), tool: None }
}

const fn tool(ratio: f64) -> Damping {
    Damping { workpiece: None, tool: Some(ratio) }
}

/// Cases of the paper's figures 10, 11 and 12 that it gives in numbers, and others around them.
const CASES: [Damping; 12] = [
    workpiece(0.003),
    workpiece(0.004),
    workpiece(0.005),
    workpiece(0.0075),
    tool(0.01),
    tool(0.02),
    tool(0.03),
    tool(0.045),
    both(0.003, 0.01),
    both(0.004, 0.02),
    both(0.005, 0.03),
    both(0.0075, 0.045),
];

/// Parts of the limits of either alone: those of the paper's pairs to its limits first.
const PARTS: [[f64; 2]; 6] = [[0.6, 0.33], [0.8, 0.67], [0.7, 0.7], [0.8, 0.8], [0.9, 0.9], [1.0, 1.0]];

fn main() -> Result<(), Failure> {
    let path = std::env::args().nth(1).map_or_else(|| PathBuf::from("blade_damping.png"), PathBuf::from);
    let bench = |resolution| Bench::new(blade_alone(&BLADE, BLADE.thickness_mm[1])?, BLADE, STEPOVER_MM, resolution);
    let rough = bench(FINENESS)?;
    print_parts(&rough)?;
    let outcomes = print_cases(&rough, &CASES)?;
    let mut picture = Picture::new(rough.pass.side.length_mm());
    for (case, outcome) in CASES.iter().zip(&outcomes) {
        picture.add(&label(case), &outcome.marks);
    }
    picture.save(&path)?;
    let (of_workpiece, of_tool) = print_limits_alone(&rough)?;
    print_limits_together(&rough, of_workpiece, of_tool)?;
    let parts = PARTS.iter().flat_map(|[w, t]| {
        let (w, t) = (w * of_workpiece, t * of_tool);
        [workpiece(w), tool(t), both(w, t)]
    });
    print_cases(&rough, &parts.collect::<Vec<Damping>>())?;
    blisk::compare(&[both(0.005, 0.03), both(0.0075, 0.045)])?;
    let around = [0.85, 1.15].map(|part| [workpiece(part * of_workpiece), tool(part * of_tool)]);
    println!("finer, at 0.85 and 1.15 of both limits:");
    print_cases(&bench(FINER)?, &around.concat())?;
    Ok(())
}

fn label(damping: &Damping) -> String {
    let ratio = |ratio: Option<f64>| ratio.map_or("-".to_owned(), |ratio| (libm::round(ratio * 1e4) / 1e4).to_string());
    format!("W {}  T {}", ratio(damping.workpiece), ratio(damping.tool))
}

/// Prints frequencies, and the static compliance of blade and tool along the blade's thickness.
fn print_parts(bench: &Bench<Field>) -> Result<(), Failure> {
    let tool = bench.tool.modes_at(tool_point_mm(), 0.0)?;
    println!("tool: {:.1} Hz, {:.0} N/mm", tool[0].frequency_hz, 1.0 / tool[0].static_mm(&Vector3::x()).x);
    let side = &bench.pass.side;
    let mut seen = Workpiece::new(&bench.body);
    let modes = seen.modes(side.place_mm(0.0), 0.0)?;
    let hz: Vec<String> = modes.iter().map(|mode| format!("{:.0}", mode.frequency_hz)).collect();
    println!("blade: {} Hz; the line {:.1} mm long at {:.1} mm", hz.join(", "), side.length_mm(), side.height_mm());
    for place in [-0.5, -0.4, -0.2, 0.0, 0.2, 0.4, 0.5] {
        let modes = seen.modes(side.place_mm(place * side.length_mm()), 0.0)?;
        let given_mm: f64 = modes.iter().map(|mode| mode.static_mm(&Vector3::y()).y).sum();
        println!("  at {place:4} of the line: {:.0} N/mm", 1.0 / given_mm);
    }
    Ok(())
}

fn print_cases(bench: &Bench<Field>, cases: &[Damping]) -> Result<Vec<Outcome>, Failure> {
    let outcomes: Vec<Outcome> = cases.par_iter().map(|case| bench.run(*case)).collect::<Result<_, Failure>>()?;
    for (case, outcome) in cases.iter().zip(&outcomes) {
        print_outcome("", case, outcome);
    }
    Ok(outcomes)
}

fn print_outcome(name: &str, case: &Damping, outcome: &Outcome) {
    let tenths = |each: &[f64]| {
        let most = each.chunks(WINDOWS / 10).map(|pair| pair.iter().copied().fold(0.0, f64::max) * UM_PER_MM);
        most.map(|um| format!("{um:.1}")).collect::<Vec<String>>().join(" | ")
    };
    let [surface_um, deepest_um] = [outcome.deviation_mm(), outcome.gouge_mm()].map(|mm| mm * UM_PER_MM);
    println!(
        "{name} {}: stable {}, surface {surface_um:.2} um, scatter {:.2} um, deepest {deepest_um:.1} um, force {:.0} N, open {}",
        label(case),
        outcome.is_stable(),
        outcome.scatter_mm() * UM_PER_MM,
        outcome.force_n,
        outcome.open
    );
    println!("  M um       | {}", tenths(&outcome.metrics_mm));
    println!("  swing um   | {}", tenths(&outcome.swings_mm));
    println!("  surface um | {}", tenths(&outcome.deviations_mm));
}

fn print_limits_alone(bench: &Bench<Field>) -> Result<(f64, f64), Failure> {
    let alone = rayon::join(|| limit(bench, OF_WORKPIECE, workpiece), || limit(bench, OF_TOOL, tool));
    let (of_workpiece, of_tool) = (alone.0?, alone.1?);
    println!("limit, workpiece alone: {of_workpiece:.5}; tool alone: {of_tool:.4}");
    Ok((of_workpiece, of_tool))
}

fn print_limits_together(bench: &Bench<Field>, of_workpiece: f64, of_tool: f64) -> Result<(), Failure> {
    let part = |part: f64| both(part * of_workpiece, part * of_tool);
    let with_tool = |ratio| both(ratio, 2.0 * of_tool);
    let with_workpiece = |ratio| both(2.0 * of_workpiece, ratio);
    let together = limit(bench, [0.35, 2.8], part)?;
    let beside = rayon::join(|| limit(bench, OF_WORKPIECE, with_tool), || limit(bench, OF_TOOL, with_workpiece));
    println!("limit, both: {together:.3} of these: {:.5}, {:.4}", together * of_workpiece, together * of_tool);
    println!("limit of the workpiece, tool damped twice its limit: {:.5}", beside.0?);
    println!("limit of the tool, workpiece damped twice its limit: {:.4}", beside.1?);
    Ok(())
}

/// The least damping of a stable pass, between one that is not and one that is.
fn limit(bench: &Bench<Field>, range: [f64; 2], damping: impl Fn(f64) -> Damping) -> Result<f64, Failure> {
    let [mut unstable, mut stable] = range;
    for _ in 0..HALVINGS {
        let middle = libm::sqrt(unstable * stable);
        let is_stable = bench.run(damping(middle))?.is_stable();
        *(if is_stable { &mut stable } else { &mut unstable }) = middle;
    }
    Ok(libm::sqrt(unstable * stable))
}
