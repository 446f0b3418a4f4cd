//! The example slot: chips that the ring's edges find in the stock against the geometric meter's formula, on the way that the axes
//! of the simulated machine take.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use arcfeed::adapt::adapt;
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_milling::cutting::chip::Circle;
use arcfeed_milling::cutting::edge_engagement::{EdgeChip, EdgeEngagement};
use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, Ring};
use arcfeed_milling::cutting::layer::Layer;
use arcfeed_milling::cutting::layers::Layers;
use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_milling::cutting::pose::ToolPose;
use arcfeed_model::cut::Work;
use arcfeed_model::stock::StockLine;
use arcfeed_model::tool::{CupMill, Edge, Tool};
use arcfeed_nc::block::Reading;
use arcfeed_tests::root;
use arcfeed_units::{Nm, RevPerMin};
use nalgebra::Vector2;

const STEP_MM: f64 = 1.0;
pub const STEPS_A_MS: usize = 2;
pub const HEIGHT_MM: f64 = 2.38;
const TOOTH_MS: usize = 6;
/// Until the spindle has turned a few times, the ring stands in walls that no edge has cut.
const SETTLED_MS: usize = 200;

/// The axes' way on one block, a place a millisecond, and what the meter saw of it.
pub struct Track {
    pub places_mm: Vec<Vector2<f64>>,
    pub chips: MoveChips,
}

/// A job, by its path from the top of the repository or from everywhere.
pub fn job(path: &str) -> JobFile {
    JobFile::load(&root().join(path)).expect("a sound job")
}

pub fn tracks(file: &JobFile) -> BTreeMap<i64, Track> {
    let program = Program::load(&file.program, file.job.unit, Reading::Lenient).expect("the example has a program");
    let text = [&adapt(&program, &file.job).text[..], b"\n"].concat();
    let settings = control_settings(file);
    let mut simulation =
        Simulation::from_memory(settings, &text, &file.job, ControllerFault::None).expect("limits that make sense");
    let mut places: BTreeMap<i64, Vec<Vector2<f64>>> = BTreeMap::new();
    while !simulation.is_done() {
        simulation.step();
        let sequence = simulation.control().active().and_then(|(_, segment)| segment.sequence);
        let [x, y, _] = simulation.control().actual_position().linear.map(Nm::to_mm);
        if let Some(sequence) = sequence {
            places.entry(sequence).or_default().push(Vector2::new(x, y));
        }
    }
    let moves = simulation.meter().moves().iter().filter_map(|chips| Some((chips.sequence?, chips.clone())));
    moves.map(|(sequence, chips)| (sequence, Track { places_mm: places[&sequence].clone(), chips })).collect()
}

/// Everything on one side of the line but the ring's own place.
fn layer(line: &StockLine, mill: &CupMill, center_mm: Vector2<f64>) -> Layer {
    let mut layer = Layer::rectangle([center_mm.x - 200.0, center_mm.y - 200.0], [400.0; 2], STEP_MM);
    let normal = Vector2::from(line.normal);
    let foot = center_mm + normal * line.distance_mm(center_mm.into());
    let (along, out) = (Vector2::new(-normal.y, normal.x) * 1e3, normal * 1e3);
    layer.clear(&[foot + along, foot - along, foot - along + out, foot + along + out]);
    layer.clear_ring(center_mm, mill.inner_radius.to_mm(), mill.outer_radius.to_mm());
    layer
}

pub fn edges(mill: &CupMill) -> Cutter {
    let ring = Ring {
        outer_radius_mm: mill.outer_radius.to_mm(),
        inner_radius_mm: mill.inner_radius.to_mm(),
        corner_mm: 0.0,
        active_teeth: usize::from(mill.active_teeth),
        height_mm: HEIGHT_MM,
    };
    Cutter::ring(&ring, Pieces::Slices { rise_mm: HEIGHT_MM }).expect("a ring")
}

/// Chips of one circle's edges in a block, by dexels and by the formula.
#[derive(Debug, Default)]
struct Compared {
    chips: usize,
    sum_mm: f64,
    squares_mm2: f64,
    thickest_mm: f64,
}

fn compare(track: &Track, mill: &CupMill, edge: Edge, line: &StockLine, spindle: RevPerMin) -> Compared {
    let places = &track.places_mm;
    let place = |step: usize| {
        let (ms, part) = (step / STEPS_A_MS, (step % STEPS_A_MS) as f64 / STEPS_A_MS as f64);
        places[ms] + (places[ms + 1] - places[ms]) * part
    };
    let circle = Circle { radius_mm: mill.radius(edge).to_mm(), advance_ratio: f64::from(edge.advance()) };
    let layers = Layers::alike(&layer(line, mill, places[0]), 0.0, HEIGHT_MM, 1);
    let mut engagement = EdgeEngagement::new(edges(mill), layers, 2.0).expect("a ring in its layer");
    let mut compared = Compared::default();
    for step in 0..(places.len() - 1) * STEPS_A_MS {
        let turned_rad = TAU * f64::from(spindle.0) / 60e3 * step as f64 / STEPS_A_MS as f64;
        let stand = ToolPose { axis_mm: place(step), tip_mm: 0.0, turned_rad };
        // The axes come to rest at the end of the block: the last teeth are no concern of the meter either.
        if (SETTLED_MS..places.len() - SETTLED_MS / 2).contains(&(step / STEPS_A_MS)) {
            let delta_mm = place(step) - place(step - TOOTH_MS * STEPS_A_MS);
            for EdgeChip { piece, section, .. } in engagement.chips(&engagement.poses(&stand), |_| Vector2::zeros()) {
                if piece.side != edge {
                    continue;
                }
                let towards = piece.place_mm(turned_rad).xy().normalize();
                let at_mm = stand.axis_mm + towards * circle.radius_mm;
                let formula_mm = circle.chip_mm(&towards, &delta_mm);
                // Between the last ray and the line a chip is known to half the distance of rays.
                if line.distance_mm(at_mm.into()) > STEP_MM && formula_mm > 0.0 {
                    let off_mm = section.thickness_mm - formula_mm;
                    compared.chips += 1;
                    compared.sum_mm += off_mm;
                    compared.squares_mm2 += off_mm * off_mm;
                    compared.thickest_mm = compared.thickest_mm.max(section.thickness_mm);
                }
            }
        }
        engagement.cut(&engagement.poses(&stand), |_| Vector2::zeros());
    }
    compared
}

#[test]
fn chips_of_the_example_slot_are_those_of_the_geometric_meter() {
    let file = job("examples/ibr-slot/job.toml");
    let Tool::CupMill(mill) = file.job.tools.first().tool else { panic!("the example has a cup mill") };
    let target_mm = f64::from(file.job.tools.first().feed_per_tooth.0);
    let tracks = tracks(&file);
    for (sequence, rule) in [(144, 0), (146, 1), (150, 2), (152, 3)] {
        let Work::Ring(edge, stock) = &file.job.rules[rule].work else { panic!("a ring's rule") };
        let line = stock.line().expect("a line");
        let track = &tracks[&sequence];
        let compared = compare(track, &mill, *edge, line, file.job.tools.first().spindle);
        let count = compared.chips as f64;
        let (mean_mm, rms_mm) = (compared.sum_mm / count, libm::sqrt(compared.squares_mm2 / count));
        let circle = usize::from(*edge == Edge::Inner);
        let thickest_mm = track.chips.thickest[circle].max_ratio * target_mm;
        println!(
            "N{sequence}: {count} chips, off by {:+.2} % in the mean, {:.2} % rms; thickest {:.4} mm, by the meter {thickest_mm:.4}",
            1e2 * mean_mm / target_mm,
            1e2 * rms_mm / target_mm,
            compared.thickest_mm,
        );
        assert!(count > 2e3);
        // The formula leaves out the tool's rotation: 0.2 to 0.4 % here.
        assert!(mean_mm.abs() < 4e-3 * target_mm && rms_mm < 4e-3 * target_mm, "{mean_mm} {rms_mm}");
        assert!(compared.thickest_mm < 1.005 * thickest_mm);
    }
}
