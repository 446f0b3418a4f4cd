//! Displacement at each edge of a flexible workpiece: a wall cut over its whole height at once by edges with equal
//! lateral forces.

use std::f64::consts::TAU;

use arcfeed_dexel::solid::Block;
use arcfeed_fe::body::Body;
use arcfeed_fe::clamped_block::{ClampedBlock, Face};
use arcfeed_fe::field::Field;
use arcfeed_fe::material::STEEL;
use arcfeed_fe::sparse::Factor;
use arcfeed_fe::unknowns::Unknowns;
use arcfeed_milling::cutting::edge_engagement::EdgeEngagement;
use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, EndMill};
use arcfeed_milling::cutting::layers::Layers;
use arcfeed_milling::cutting::material::Cutting;
use arcfeed_milling::cutting::pose::ToolPose;
use arcfeed_milling::process::Process;
use arcfeed_modal::dynamics::modal::Mode;
use arcfeed_modal::dynamics::transition::Rule;
use arcfeed_modal::dynamics::vibration::{Stepping, Vibration};
use arcfeed_modal::flexible::{Modal, Workpiece};
use arcfeed_modal::modal_point::ModalPoint;
use nalgebra::Vector2;

const HEIGHT_MM: f64 = 40.0;
const THICKNESS_MM: f64 = 3.0;
const WIDTH_MM: f64 = 8.0;
const RISE_MM: f64 = 2.0;
const RADIUS_MM: f64 = 5.0;
const FEED_MM_PER_TOOTH: f64 = 0.02;
const TURN_HZ: f64 = 50.0;
const STEPS_A_TURN: usize = 2400;
const RAY_MM: f64 = 0.02;
const TURNS: usize = 20;

/// Aside, of each millimetre of an edge that has a chip; next to nothing along its way.
const PUSH_N_PER_MM: f64 = 0.0625;

/// Nearly at once.
const DAMPING: f64 = 0.7;

/// One mode along the wall's thickness, as a function of the height.
#[derive(Clone, Copy, Debug)]
struct Lean {
    omega_rad_per_s: [f64; 1],
    /// At the top.
    stiffness_n_per_mm: f64,
    /// At a height, over that at the top.
    shape: fn(f64) -> f64,
}

impl Modal for Lean {
    fn omega_rad_per_s(&self) -> &[f64] {
        &self.omega_rad_per_s
    }

    fn reach_mm(&self) -> f64 {
        f64::INFINITY
    }

    fn evaluate_at(&self, [_, _, z_mm]: [f64; 3], _: f64, modal_point: &mut ModalPoint) {
        let mass_t = self.stiffness_n_per_mm / (self.omega_rad_per_s[0] * self.omega_rad_per_s[0]);
        modal_point.shapes = vec![[0.0, (self.shape)(z_mm) / libm::sqrt(mass_t), 0.0]];
    }
}

const LEAN: Lean = Lean { omega_rad_per_s: [1000.0 * TAU], stiffness_n_per_mm: 200.0, shape: |z_mm| z_mm / HEIGHT_MM };

/// The mill in the wall, which is in front of the XZ plane and has half a millimetre to be cut.
fn process(modes: Vec<Mode>) -> Process {
    let mill = EndMill { diameter_mm: 2.0 * RADIUS_MM, corner_mm: 0.0, teeth: 2, helix_rad: 0.0, height_mm: HEIGHT_MM };
    let cutter = Cutter::end_mill(&mill, Pieces::Slices { rise_mm: RISE_MM }).expect("a mill");
    let half_mm = WIDTH_MM / 2.0;
    let wall = Block { lowest_mm: [-half_mm, -THICKNESS_MM, 0.0], highest_mm: [half_mm, 0.5, HEIGHT_MM] };
    let layers = Layers::of_solid(&wall, 2, RISE_MM, RAY_MM).expect("layers");
    let cutting = Cutting::linear([0.1, 0.0, 0.0], [0.0, PUSH_N_PER_MM, 0.0]);
    let stepping = Stepping { rule: Rule::Exact, tolerance_mm: 1e-9, iterations_max: 20 };
    Process::new(
        EdgeEngagement::new(cutter, layers, 1.0).expect("slices as layers"),
        cutting,
        Vibration::new(modes, stepping),
    )
}

/// Climb milling past the middle of the wall; what is left too thick there, each layer by its middle.
fn left_mm(modes: Vec<Mode>, mut step: impl FnMut(&mut Process, f64, &ToolPose)) -> Vec<[f64; 2]> {
    let mut process = process(modes);
    let from_mm = -FEED_MM_PER_TOOTH * TURNS as f64;
    for n in 0..TURNS * STEPS_A_TURN {
        let turned = n as f64 / STEPS_A_TURN as f64;
        let axis_mm = Vector2::new(from_mm + 2.0 * FEED_MM_PER_TOOTH * turned, RADIUS_MM);
        let stand = ToolPose { axis_mm, tip_mm: 0.0, turned_rad: TAU * turned.fract() };
        process.engagement_mut().enter(&stand);
        step(&mut process, 1.0 / (TURN_HZ * STEPS_A_TURN as f64), &stand);
    }
    let layers = process.engagement().layers();
    let left = |(n, layer): (usize, &arcfeed_milling::cutting::layer::Layer)| {
        let middle = libm::round(layer.index(1, 0.0)) as usize;
        let end_mm = layer.rays(1)[middle].extent().expect("a wall").to_mm;
        [layers.middle_mm(n), end_mm]
    };
    layers.layers().iter().enumerate().map(left).collect()
}

fn seen_mm<B: Modal>(body: B) -> Vec<[f64; 2]> {
    let mut seen = Workpiece::new(body);
    let modes = seen.modes([0.0, 0.0, HEIGHT_MM / 2.0], DAMPING).expect("modes");
    left_mm(modes, |process, dt_s, stand| {
        process.step_on(dt_s, stand, &mut seen);
    })
}

/// Height of the cusps of the teeth, and of the rotation past the deepest point between two steps.
fn cusp_mm() -> f64 {
    let between_mm = RADIUS_MM * (1.0 - libm::cos(TAU / STEPS_A_TURN as f64));
    FEED_MM_PER_TOOTH * FEED_MM_PER_TOOTH / (8.0 * RADIUS_MM) + between_mm
}

/// Part of the static displacement that a mode of this frequency has reached when an edge cuts the wall: the mode follows the force, whose direction turns
/// with the tooth, and the chip ends half-way between two rays or a step too early, when the mode begins to move back.
fn reached_ratio(frequency_hz: f64) -> f64 {
    let lag_rad = 2.0 * DAMPING * TURN_HZ / frequency_hz;
    let early_s = RAY_MM / 2.0 / (TAU * TURN_HZ * RADIUS_MM) + 1.0 / (TURN_HZ * STEPS_A_TURN as f64);
    let back = TAU * frequency_hz * early_s;
    libm::cos(lag_rad) * (1.0 - back * back / 2.0)
}

#[test]
fn a_wall_on_a_hinge_leans_by_the_moment_of_all_edges() {
    let reached = reached_ratio(LEAN.omega_rad_per_s[0] / TAU);
    println!("{reached:.4} of the push");
    for [z_mm, left_mm] in seen_mm(LEAN) {
        // Half of the push counts at the top.
        let leaned_mm = z_mm / HEIGHT_MM * PUSH_N_PER_MM * HEIGHT_MM / 2.0 / LEAN.stiffness_n_per_mm;
        println!("{z_mm} mm up: {left_mm:.7} mm left, leaned by {leaned_mm:.7}");
        assert!((reached * leaned_mm..leaned_mm + cusp_mm()).contains(&left_mm));
    }
}

#[test]
fn where_all_edges_see_the_same_it_does_not_matter_which_sees_it() {
    let alike = Lean { shape: |_| 1.0, ..LEAN };
    let each = seen_mm(alike);
    let modes = Workpiece::new(alike).modes([0.0; 3], DAMPING).expect("modes");
    let one = left_mm(modes, |process, dt_s, stand| {
        process.step(dt_s, stand);
    });
    for ([z_mm, each_mm], [_, one_mm]) in each.into_iter().zip(one) {
        assert!((each_mm - one_mm).abs() < 1e-9, "{z_mm}: {each_mm} {one_mm}");
        assert!(each_mm > 0.01);
    }
}

/// Deflection of the wall under an even load along the line in the middle of its face, at that line: K^-1 of all
/// elements, by heights.
fn bent_mm(body: &Body, clamped: &[usize]) -> Vec<[f64; 2]> {
    let mesh = body.mesh();
    let unknowns = Unknowns::clamped(mesh, clamped);
    let [cells, through, up] = mesh.cells();
    let line = (0..=2 * up).map(|z| mesh.nodes_where(|place| place == [cells, 2 * through, z])[0]);
    let line: Vec<usize> = line.collect();
    let z_mm: Vec<f64> = line.iter().map(|node| mesh.nodes_mm()[*node][2]).collect();
    // Simpson's rule, which is that of quadratic elements.
    let mut pushes_n = vec![0.0; line.len()];
    for first in (0..2 * up).step_by(2) {
        let whole_n = PUSH_N_PER_MM * (z_mm[first + 2] - z_mm[first]);
        [1.0, 4.0, 1.0].iter().enumerate().for_each(|(n, part)| pushes_n[first + n] += whole_n * part / 6.0);
    }
    let mut x: Vec<f64> = (0..unknowns.count())
        .map(|unknown| {
            let mut unit = vec![0.0; unknowns.count()];
            unit[unknown] = 1.0;
            let moved = unknowns.displacements(0, &unit);
            line.iter().zip(&pushes_n).map(|(node, push_n)| moved[*node][1] * push_n).sum()
        })
        .collect();
    let (k, m) = body.matrices(&unknowns);
    Factor::of(&k, 0.0, &m).expect("it is held").solve(&mut x);
    let moved = unknowns.displacements(0, &x);
    line.iter().zip(z_mm).map(|(node, z_mm)| [z_mm, moved[*node][1]]).collect()
}

#[test]
fn a_wall_is_left_thicker_towards_its_top_as_an_even_push_bends_it() {
    let half_mm = WIDTH_MM / 2.0;
    let held = Face { axis: 2, is_upper: false };
    let wall = ClampedBlock { lowest_mm: [-half_mm, -THICKNESS_MM, 0.0], highest_mm: [half_mm, 0.0, HEIGHT_MM], held };
    let mesh = wall.mesh([2, 1, 12]).expect("a mesh");
    let body = Body::new(mesh.clone(), &STEEL);
    let clamped = held.nodes(&mesh);
    let modes = body.modes(&clamped, 5).expect("modes");
    let whole = bent_mm(&body, &clamped);
    let field = Field::new(mesh.clone(), &modes, mesh.thickness_mm());
    let top_mm = whole.last().expect("a top")[1];
    for [z_mm, left_mm] in seen_mm(&field) {
        let above = whole.iter().position(|[at_mm, _]| *at_mm >= z_mm).expect("a node");
        let ([low_mm, low], [high_mm, high]) = (whole[above - 1], whole[above]);
        let whole_mm = low + (high - low) * (z_mm - low_mm) / (high_mm - low_mm);
        println!("{z_mm} mm up: {left_mm:.6} mm left, bent by {whole_mm:.6}");
        // Near the foot the shear is more than five modes know.
        assert!((left_mm - whole_mm).abs() < 0.005 * top_mm);
    }
}
