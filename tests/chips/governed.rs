//! From the plan to the cut: where the ring will stand in material is found in the stock, the engaged-arc law is told, the
//! machine runs by it, and the chips that the edges then find are those wanted.

use std::f64::consts::TAU;

use arcfeed_hil_sim::cutting::bite::{Bite, Stand};
use arcfeed_hil_sim::cutting::engaged::{EdgeCircle, knots};
use arcfeed_hil_sim::cutting::layer::Layer;
use arcfeed_hil_sim::cutting::layers::Layers;
use arcfeed_shared::tool::{CupMill, Edge, Tool};
use arcfeed_shared::units::LengthUnit;
use arcfeed_tests::{Scratch, root};
use nalgebra::Vector2;

use crate::slot::{HEIGHT_MM, STEPS_A_MS, edges, job, tracks};

const STEP_MM: f64 = 0.5;
const KNOTS: usize = 16;
/// Between two looks at the stock.
const LOOK_EVERY_MS: usize = 10;
const ARC: i64 = 146;
/// The arc on the same level before it.
const BEFORE: i64 = 144;
/// Centre of the arc, inches: the published A.
const ROTATION_IN: [f64; 2] = [0.4354, 7.4854];

fn file_text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).expect("a file of the example")
}

/// The rim of the disc on the arc's level, the ring's first place and all of the arc before taken from it.
fn rim(mill: &CupMill, before_mm: &[Vector2<f64>]) -> Layer {
    let inch = LengthUnit::Inch.mm();
    let mut layer = Layer::rectangle([-3.0 * inch, 6.0 * inch], [6.5 * inch, 4.0 * inch], STEP_MM);
    for place_mm in before_mm {
        layer.clear_ring(*place_mm, mill.inner_radius.to_mm(), mill.outer_radius.to_mm());
    }
    layer
}

/// Rows of the job's table: path in inches, from and to in degrees as the laws count them.
fn engaged_rows(mill: &CupMill, mut layer: Layer, places_mm: &[Vector2<f64>], ahead_mm: f64) -> String {
    let inch = LengthUnit::Inch.mm();
    let center_mm = Vector2::from(ROTATION_IN) * inch;
    let (mut path_mm, mut last_mm) = (0.0, places_mm[0]);
    let (mut paths, mut arcs) = (Vec::new(), Vec::new());
    for (ms, place_mm) in places_mm.iter().enumerate() {
        path_mm += (place_mm - last_mm).norm();
        last_mm = *place_mm;
        if ms % LOOK_EVERY_MS == 0 {
            paths.push(path_mm / inch);
            arcs.push(engaged_deg(mill, &layer, place_mm, &center_mm, ahead_mm));
        }
        layer.clear_ring(*place_mm, mill.inner_radius.to_mm(), mill.outer_radius.to_mm());
    }
    let row = |knot: usize| format!("[{:.5}, {:.3}, {:.3}, 0, 0]", paths[knot], arcs[knot][0], arcs[knot][1]);
    knots(&paths, &arcs, KNOTS).into_iter().map(row).collect::<Vec<_>>().join(", ")
}

/// From where to where the outer circle is engaged, as the laws count angles on an arc that turns clockwise.
fn engaged_deg(
    mill: &CupMill,
    layer: &Layer,
    place_mm: &Vector2<f64>,
    center_mm: &Vector2<f64>,
    ahead_mm: f64,
) -> [f64; 2] {
    let circle = EdgeCircle { center_mm: *place_mm, radius_mm: mill.radius(Edge::Outer).to_mm(), side: Edge::Outer };
    // Seen from the tool, what points at the centre is to the right of the motion.
    let towards = (center_mm - place_mm).normalize();
    let motion = Vector2::new(-towards.y, towards.x);
    let from_towards = |angle_rad: f64| {
        let (sin, cos) = libm::sincos(angle_rad);
        let u = Vector2::new(cos, sin);
        libm::atan2(u.dot(&motion), u.dot(&towards)).to_degrees()
    };
    let ends: Vec<f64> = circle.engaged_rad(layer, ahead_mm).iter().flatten().map(|end| from_towards(*end)).collect();
    let (from, to) = ends.iter().fold((360.0_f64, -360.0_f64), |(low, high), end| (low.min(*end), high.max(*end)));
    // Nothing behind can be cut; where nothing is engaged the arc is empty.
    [from.clamp(0.0, 360.0), to.max(0.0)]
}

/// The thickest chip of the outer edges of each twentieth of the arc, over the one wanted.
fn thickest(mill: &CupMill, layer: &Layer, places_mm: &[Vector2<f64>], target_mm: f64) -> Vec<f64> {
    let mut bite = Bite::new(edges(mill), Layers::alike(layer, 0.0, HEIGHT_MM, 1), 2.0).expect("a ring in its layer");
    let steps = (places_mm.len() - 1) * STEPS_A_MS;
    let mut thickest = vec![0.0_f64; 20];
    for step in 0..steps {
        let (ms, part) = (step / STEPS_A_MS, (step % STEPS_A_MS) as f64 / STEPS_A_MS as f64);
        let axis_mm = places_mm[ms] + (places_mm[ms + 1] - places_mm[ms]) * part;
        // 1000 turns a minute.
        let stand = Stand { axis_mm, tip_mm: 0.0, turned_rad: TAU / 60.0 * step as f64 / STEPS_A_MS as f64 };
        let outer = bite.chips(&stand, |_| Vector2::zeros()).filter(|(piece, _)| piece.side == Edge::Outer);
        let now = outer.map(|(_, chip)| chip.thickness_mm / target_mm).fold(0.0, f64::max);
        thickest[step * 20 / steps] = thickest[step * 20 / steps].max(now);
        bite.cut(&stand, |_| Vector2::zeros());
    }
    thickest
}

#[test]
fn a_law_that_is_told_the_engagement_keeps_the_thickest_chip() {
    let example = job("examples/ibr-slot/job.toml");
    let Tool::CupMill(mill) = example.job.tool else { panic!("the example has a cup mill") };
    let target_mm = f64::from(example.job.feed_per_tooth.0);
    let before = tracks(&example);
    let layer = rim(&mill, &before[&BEFORE].places_mm);
    let rows = engaged_rows(&mill, layer.clone(), &before[&ARC].places_mm, target_mm);
    let text = file_text("examples/ibr-slot/job.toml");
    let head = &text[..text.find("[[cut]]").expect("rules")];
    let tail = &text[text.find("[control]").expect("a control")..];
    // At 200 % a second the override is too slow for the corner: 1.12 of the chip wanted.
    let head = head
        .replace("kind = \"circumference\"", "kind = \"engaged-arc\"\nedges = \"side\"")
        .replace("slew_down = 200", "slew_down = 2000");
    let rule = format!(
        "[[cut]]\nrotation = \"exterior\"\ndirection = \"cw\"\nside = \"outer\"\nn = [{ARC}, {ARC}]\nstock = {{ engaged = [{rows}] }}\n"
    );
    let scratch = Scratch::new("chips-governed");
    scratch.write("ibr-slot.nc", file_text("examples/ibr-slot/ibr-slot.nc"));
    let governed = tracks(&job(&scratch.write("job.toml", format!("{head}{rule}\n{tail}"))));
    let by_law = thickest(&mill, &layer, &governed[&ARC].places_mm, target_mm);
    let by_line = thickest(&mill, &layer, &before[&ARC].places_mm, target_mm);
    println!("told the engagement {by_law:.3?}\ntold a line {by_line:.3?}");
    // First the chip wanted is out of reach of 200 %; then the stock's corner is met, and it is kept.
    assert!(by_law[..9].iter().all(|ratio| *ratio < 0.8), "{by_law:?}");
    assert!(by_law[10..].iter().all(|ratio| (0.93..1.005).contains(ratio)), "{by_law:?}");
    assert!(by_line[10..].iter().all(|ratio| *ratio < 0.7), "{by_line:?}");
}
