//! The influence of damping on the finishing of a blade: the study of Lorong et al., Simulation of a finishing operation, 2012, section 4.3, on a blade of our own.
//!
//! `cargo run --release -p arcfeed-hil-sim --example blade_damping -- blade.png` prints the tables of docs/virtual-machining.md and paints its picture; some minutes.

use std::path::PathBuf;

use arcfeed_hil_sim::finishing::marks::Mark;
use arcfeed_hil_sim::flexible::{Workpiece, tool_modes};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::bench::{Bench, Damping, Failure, Outcome, WINDOWS};
use crate::picture::Picture;

mod bench;

mod picture;

/// Chosen once: the limit of the tool alone is then near the 0.03 of the paper.
const STEPOVER_MM: f64 = 0.21;
const STEPS: usize = 400;
/// Halvings of the range in which a limit is, by its logarithm.
const HALVINGS: usize = 6;
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

/// Those of the paper's figures 10, 11 and 12 that it tells in numbers, and others around them.
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

fn main() -> Result<(), Failure> {
    let path = std::env::args().nth(1).map_or_else(|| PathBuf::from("blade_damping.png"), PathBuf::from);
    let bench = Bench::new(STEPOVER_MM, STEPS)?;
    print_parts(&bench)?;
    let outcomes: Vec<Outcome> = CASES.par_iter().map(|case| bench.run(*case)).collect::<Result<_, Failure>>()?;
    print_cases(&outcomes);
    let mut picture = Picture::new(bench.pass.side.length_mm());
    for (case, outcome) in CASES.iter().zip(&outcomes) {
        picture.add(&label(case), &outcome.marks);
    }
    picture.save(&path)?;
    print_limits(&bench)
}

fn label(damping: &Damping) -> String {
    let ratio = |ratio: Option<f64>| ratio.map_or("-".to_owned(), |ratio| ratio.to_string());
    format!("W {}  T {}", ratio(damping.workpiece), ratio(damping.tool))
}

/// Frequencies, and what blade and tool give way along the blade's thickness to a force that stands.
fn print_parts(bench: &Bench) -> Result<(), Failure> {
    let tool = tool_modes(&bench.tool, Bench::tool_point_mm(), 0.0)?;
    println!("tool: {:.1} Hz, {:.0} N/mm", tool[0].frequency_hz, 1.0 / tool[0].static_mm(&Vector3::x()).x);
    let side = &bench.pass.side;
    let mut seen = Workpiece::new(&bench.field);
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

fn print_cases(outcomes: &[Outcome]) {
    let tenths = |each: &[f64]| -> Vec<String> {
        let most = each.chunks(WINDOWS / 10).map(|pair| pair.iter().copied().fold(0.0, f64::max) * UM_PER_MM);
        most.map(|um| format!("{um:.1}")).collect()
    };
    for (case, outcome) in CASES.iter().zip(outcomes) {
        let quality = [outcome.deviation_mm(), outcome.gouge_mm()].map(|mm| mm * UM_PER_MM);
        println!(
            "{}: stable {}, surface {:.2} um, deepest {:.1} um, force {:.0} N, open {}",
            label(case),
            outcome.is_stable(),
            quality[0],
            quality[1],
            outcome.force_n,
            outcome.open
        );
        println!("  M um       | {}", tenths(&outcome.metrics_mm).join(" | "));
        println!("  swing um   | {}", tenths(&outcome.swings_mm).join(" | "));
        println!("  surface um | {}", tenths(&outcome.deviations_mm).join(" | "));
        println!("  left, deepest um: {:?}", extremes_um(&outcome.marks));
    }
}

fn extremes_um(marks: &[Mark]) -> [f64; 2] {
    let ends =
        marks.iter().fold([0.0_f64; 2], |[high, low], mark| [high.max(mark.deviation_mm), low.min(mark.deviation_mm)]);
    ends.map(|mm| (mm * UM_PER_MM * 10.0).round() / 10.0)
}

fn print_limits(bench: &Bench) -> Result<(), Failure> {
    let alone = rayon::join(|| limit(bench, [0.002, 0.016], workpiece), || limit(bench, [0.01, 0.08], tool));
    let (of_workpiece, of_tool) = (alone.0?, alone.1?);
    println!("limit, workpiece alone: {of_workpiece:.5}; tool alone: {of_tool:.4}");
    let together = rayon::join(
        || limit(bench, [0.35, 2.8], |part| both(part * of_workpiece, part * of_tool)),
        || limit(bench, [0.002, 0.016], |ratio| both(ratio, 2.0 * of_tool)),
    );
    println!("limit, both: {:.3} of these", together.0?);
    println!("limit of the workpiece, tool at twice its own: {:.5}", together.1?);
    Ok(())
}

/// The least damping of a stable pass, between two that are not and that are.
fn limit(bench: &Bench, range: [f64; 2], damping: impl Fn(f64) -> Damping) -> Result<f64, Failure> {
    let [mut unstable, mut stable] = range;
    for _ in 0..HALVINGS {
        let middle = libm::sqrt(unstable * stable);
        let is_stable = bench.run(damping(middle))?.is_stable();
        *(if is_stable { &mut stable } else { &mut unstable }) = middle;
    }
    Ok(libm::sqrt(unstable * stable))
}
