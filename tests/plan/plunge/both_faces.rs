//! A part whose passages no mill of its size enters radially, through the command: dexels after the CL data, and its program in
//! another interpreter.
//!
//! The blades are flat and radial, so the passage has a closed form: with its middle at the angle m and alpha = pi / N, a point y along
//! the middle and x beside it is `y sin alpha - |x| cos alpha - t/2` from the nearer blade or farther.

use arcfeed::part::plunge::PlungePart;
use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_plan::plunge::passage_plan::PlungeFamily;
use arcfeed_plan::vector::Point;
use arcfeed_tests::{Scratch, of_full_set, run};

use super::executed::assert_read_by_rs274;
use super::stock::{Planned, is_material, no_mark_is_in_blades_or_hub, nodes};

const PART: &str = "units = \"mm\"\nname = \"both-faces\"\n\
    [geometry]\ngenerate = { blades = 13, hub_radius = 60, tip_radius = 95, chord = [40, 40], stagger_deg = [0, 0], camber_deg = [2, 2], \
    thickness_ratio = [0.07, 0.07] }\n[blank]\nradius = 95\nfrom = -20\nto = 20\n\
    [plunge]\ndiameter = 28\ncorner_radius = 0.4\nteeth = 4\nlength = 12\nneck = [[13.5, 60]]\nholder = [[20, 40]]\ncusp = 0.3\n\
    approach_feed = 2000\n[roughing]\nallowance = 0.8\nrev_per_min = 600\nfeed_per_tooth = 0.08\n";
/// Half of the blades' greatest thickness, with their camber.
const HALF_MM: f64 = 1.4 + 0.2;

/// Places of CL data with their axes.
fn poses(text: &str) -> Vec<Pose> {
    let numbers = |rest: &str| -> [f64; 6] {
        let numbers: Vec<f64> = rest.split(',').map(|word| word.trim().parse().expect("a number")).collect();
        numbers.try_into().expect("a place and an axis")
    };
    let places = text.lines().filter_map(|line| line.strip_prefix("GOTO/")).map(numbers);
    places.map(|[x, y, z, i, j, k]| Pose { tip_mm: [x, y, z], axis: [i, j, k] }).collect()
}

/// Block about the first passage after the moves of its CL data; between two axes the mill is above all that turns.
fn stock(planned: &Planned, poses: &[Pose]) -> Stock {
    let mut stock = Stock::new(&planned.block(), of_full_set(0.25, 0.5), 1 << 30).expect("a stock");
    let tool = Tool::bull_nose([planned.mill.radius_mm, planned.mill.corner_radius_mm], 60.0, 1e-3).expect("a tool");
    for pair in poses.windows(2).filter(|pair| pair[0].axis == pair[1].axis && pair[0].tip_mm != pair[1].tip_mm) {
        let sweeps = Move::Straight { from: pair[0], to: pair[1] }.sweeps(&tool, 1e-3).expect("a move");
        stock.cut(&tool, &sweeps).expect("a cut");
    }
    stock
}

/// Volume left in the passage within the blank: of nodes with material, and of those that no plunge reaches.
fn left_mm3(planned: &Planned, stock: &Stock) -> [f64; 2] {
    let (blisk, middle_rad) = (&planned.blisk, planned.plan.planes[0].boundary.middle_rad);
    let ((sin, cos), (up, aside)) = (libm::sincos(core::f64::consts::PI / 13.0), libm::sincos(middle_rad));
    let is_in_passage = |point: &Point| {
        let [x, y] = [point.y * aside - point.x * up, point.x * aside + point.y * up];
        y * sin - x.abs() * cos >= HALF_MM
            && libm::hypot(point.x, point.y) < blisk.blank.radius_mm
            && blisk.hub.height_mm(point) >= 0.0
    };
    // One wall lies along the lattice: other points than the nodes would count another volume there.
    let (lattice, mut left, mut whole) = (stock.lattice(), [0_usize; 2], 0_usize);
    for (cell, node) in nodes(lattice).filter(|(_, node)| is_in_passage(node)) {
        whole += 1;
        left[0] += usize::from(is_material(stock, cell));
        left[1] += usize::from(!planned.plan.plunges.iter().any(|plunge| planned.is_reached(plunge, &node)));
    }
    let cell_mm3 = lattice.area_mm2() * lattice.step_mm();
    println!("passage {:.0} mm3", whole as f64 * cell_mm3);
    left.map(|count| count as f64 * cell_mm3)
}

#[test]
fn passages_that_a_mill_does_not_enter_radially_are_bored_from_both_faces_by_the_command() {
    let scratch = Scratch::new("plunge-both-faces");
    let (path, folder) = (scratch.write("PART.toml", PART), scratch.path("out"));
    let output = run(&["plan", "plunge", &path, "-o", &folder]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    let part = PlungePart::load(path.as_ref()).expect("a part");
    let planned = Planned::of(part.blisk, part.mill, part.needs);
    assert!(planned.plan.planes.iter().all(|plane| plane.family != PlungeFamily::Radial));
    let poses = poses(&std::fs::read_to_string(format!("{folder}/plunges.apt")).expect("CL data"));
    let stock = stock(&planned, &poses[..poses.len() / 13]);
    no_mark_is_in_blades_or_hub(&planned, &stock);
    let [found_mm3, expected_mm3] = left_mm3(&planned, &stock);
    println!("left {found_mm3:.0} mm3, by points {expected_mm3:.0}: {:+.2} %", (found_mm3 / expected_mm3 - 1.0) * 1e2);
    assert!((found_mm3 / expected_mm3 - 1.0).abs() <= 0.01);
    assert_read_by_rs274(&folder, "both-faces");
}
