//! Mode shapes at a point of the body, and beside it.

use arcfeed_blades::blade::Blade;
use arcfeed_fe::body::{Body, Modes};
use arcfeed_fe::field::Field;
use arcfeed_fe::material::{STEEL, TITANIUM_6AL_4V};
use arcfeed_fe::mesh::TetMesh;
use arcfeed_fe::sparse::Factor;
use arcfeed_fe::tetrahedron::functions;
use arcfeed_fe::unknowns::Unknowns;
use arcfeed_modal::modal_point::ModalPoint;

use crate::fe::at_nodes::unknowns_of_nodes;
use crate::fe::random::fractions;

const TWISTED: Blade = Blade {
    span_mm: 40.0,
    chord_mm: [30.0, 24.0],
    thickness_mm: [3.0, 2.0],
    edge_ratio: 0.6,
    camber_rad: [0.6, 0.4],
    stagger_rad: [0.3, 0.8],
    lean_rad: 0.1,
};

/// A mesh whose only mode is a displacement of our own.
fn extended_field(mesh: TetMesh, displacement: impl Fn([f64; 3]) -> [f64; 3], reach_mm: f64) -> Field {
    let shape = mesh.nodes_mm().iter().map(|node_mm| displacement(*node_mm)).collect();
    Field::new(mesh, &Modes { omega_rad_per_s: vec![1.0], shapes: vec![shape] }, reach_mm)
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    libm::sqrt((0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum())
}

fn quadratic([x, y, z]: [f64; 3]) -> [f64; 3] {
    [1.0 + x * y - z * z, x * x + 0.3 * y * z, 0.2 * z - x * z + y * y]
}

#[test]
fn a_quadratic_field_is_met_inside_and_outside() {
    let field = extended_field(TetMesh::block([4.0, 2.0, 5.0], [4, 2, 5]).unwrap(), quadratic, 0.8);
    let mut next = fractions(1);
    let mut modal_point = ModalPoint::default();
    for _ in 0..2000 {
        let point_mm = [4.0, 2.0, 5.0].map(|edge| -0.4 + (edge + 0.8) * next());
        let outside_mm = field.at(point_mm, &mut modal_point).unwrap();
        assert!(distance(modal_point.displacement_mm(&[1.0]), quadratic(point_mm)) < 1e-10);
        let truth_mm = distance(point_mm, std::array::from_fn(|axis| point_mm[axis].clamp(0.0, [4.0, 2.0, 5.0][axis])));
        assert!((outside_mm - truth_mm).abs() < 1e-6, "{outside_mm} {truth_mm}");
    }
    for point_mm in [[-0.81, 1.0, 1.0], [2.0, 1.0, 5.81], [1e9, 0.0, 0.0], [f64::NAN, 0.0, 0.0]] {
        assert!(field.at(point_mm, &mut modal_point).is_err());
    }
}

#[test]
fn beyond_the_reach_a_field_is_as_at_the_reach() {
    let edges_mm = [4.0, 2.0, 5.0];
    let field = extended_field(TetMesh::block(edges_mm, [4, 2, 5]).unwrap(), quadratic, 0.8);
    let mut next = fractions(2);
    let mut modal_point = ModalPoint::default();
    for _ in 0..2000 {
        let point_mm = edges_mm.map(|edge| -3.0 + (edge + 6.0) * next());
        for beyond_mm in [0.0, 0.5] {
            let outside_mm = field.at_nearest(point_mm, beyond_mm, &mut modal_point);
            let nearest_mm: [f64; 3] = std::array::from_fn(|axis| point_mm[axis].clamp(0.0, edges_mm[axis]));
            assert!((outside_mm - distance(point_mm, nearest_mm)).abs() < 1e-6);
            let part = if outside_mm > beyond_mm { beyond_mm / outside_mm } else { 1.0 };
            let stood_mm = std::array::from_fn(|axis| nearest_mm[axis] + (point_mm[axis] - nearest_mm[axis]) * part);
            assert!(distance(modal_point.displacement_mm(&[1.0]), quadratic(stood_mm)) < 1e-9, "{point_mm:?}");
        }
    }
}

#[test]
fn every_point_of_a_bent_blade_is_found_where_it_is() {
    let mesh = TWISTED.mesh([6, 1, 8], 0.3).unwrap();
    let linear = |[x, y, z]: [f64; 3]| [x - 2.0 * y, 3.0 * z + y, 0.5 * x];
    let field = extended_field(mesh.clone(), linear, 0.5);
    let mut next = fractions(2);
    let mut warm = ModalPoint::default();
    for _ in 0..2000 {
        let element = (next() * mesh.elements().len() as f64) as usize;
        let mut cuts = [next(), next(), next()];
        cuts.sort_by(f64::total_cmp);
        let n = functions([cuts[0], cuts[1] - cuts[0], cuts[2] - cuts[1]]);
        let nodes_mm = mesh.nodes_of_mm(element);
        let point_mm: [f64; 3] = std::array::from_fn(|axis| (0..10).map(|a| n[a] * nodes_mm[a][axis]).sum());
        let mut cold = ModalPoint::default();
        assert_eq!(field.at(point_mm, &mut cold), Ok(0.0));
        assert!(distance(cold.displacement_mm(&[1.0]), linear(point_mm)) < 1e-8);
        assert_eq!(field.at(point_mm, &mut warm), Ok(0.0));
        assert!(distance(cold.shapes[0], warm.shapes[0]) < 1e-8, "where one looked before shows");
    }
}

/// A force at a point, its modes' answers, the displacement at another point: with all modes the same as of the matrices, and the same backwards.
#[test]
fn a_static_force_moves_the_body_as_its_stiffness_says() {
    let mesh = TWISTED.mesh([3, 1, 3], 0.5).unwrap();
    let body = Body::new(mesh.clone(), &TITANIUM_6AL_4V);
    let clamped = Blade::foot(&mesh);
    let unknowns = Unknowns::clamped(&mesh, &clamped);
    let (k, m) = body.matrices(&unknowns);
    let modes = body.modes(&clamped, k.size()).unwrap();
    let (pushed, seen) = (mesh.nodes_mm().len() - 1, mesh.nodes_mm().len() / 2);
    // By the stiffness.
    let force_n = [3.0, -5.0, 2.0];
    let mut x = vec![0.0; k.size()];
    for (unknown, force_n) in unknowns_of_nodes(&unknowns)[pushed].into_iter().zip(force_n) {
        x[unknown.expect("the tip is free")] = force_n;
    }
    Factor::of(&k, 0.0, &m).unwrap().solve(&mut x);
    let truth_mm = unknowns.displacements(0, &x)[seen];
    // By the modes.
    let field = Field::new(mesh.clone(), &modes, 0.1);
    let answer_mm = |from: usize, to: usize, force_n: [f64; 3]| {
        let mut modal_point = ModalPoint::default();
        let mut amplitudes = vec![0.0; modes.omega_rad_per_s.len()];
        field.at(mesh.nodes_mm()[from], &mut modal_point).unwrap();
        modal_point.add_force(force_n, &mut amplitudes);
        amplitudes.iter_mut().zip(&modes.omega_rad_per_s).for_each(|(q, omega)| *q /= omega * omega);
        field.at(mesh.nodes_mm()[to], &mut modal_point).unwrap();
        modal_point.displacement_mm(&amplitudes)
    };
    let ours_mm = answer_mm(pushed, seen, force_n);
    assert!(distance(ours_mm, truth_mm) < 1e-8 * distance(truth_mm, [0.0; 3]), "{ours_mm:?} {truth_mm:?}");
    // Maxwell and Betti.
    let there = answer_mm(pushed, seen, [1.0, 0.0, 0.0])[1];
    let back = answer_mm(seen, pushed, [0.0, 1.0, 0.0])[0];
    assert!((there / back - 1.0).abs() < 1e-9);
}

#[test]
fn the_point_that_came_to_a_place_is_found_again() {
    let body = Body::new(TWISTED.mesh([6, 1, 8], 0.3).unwrap(), &TITANIUM_6AL_4V);
    let modes = body.modes(&Blade::foot(body.mesh()), 4).unwrap();
    let field = Field::new(body.mesh().clone(), &modes, 0.5);
    let tip_mm = body.mesh().nodes_mm()[body.mesh().nodes_mm().len() - 1];
    let mut modal_point = ModalPoint::default();
    field.at(tip_mm, &mut modal_point).unwrap();
    // Half a millimetre at the tip from each mode: far more than a blade does that is being cut.
    let amplitudes: Vec<f64> = modal_point.shapes.iter().map(|shape| 0.5 / distance(*shape, [0.0; 3])).collect();
    for node_mm in body.mesh().nodes_mm() {
        field.at(*node_mm, &mut modal_point).unwrap();
        let u_mm = modal_point.displacement_mm(&amplitudes);
        let now_mm = std::array::from_fn(|axis| node_mm[axis] + u_mm[axis]);
        let found_mm = field.material_point_mm(now_mm, &amplitudes, &mut modal_point).unwrap();
        assert!(distance(found_mm, *node_mm) < 1e-9, "{found_mm:?} {node_mm:?}");
    }
}

/// Kirchhoff: a point at height n above the middle plane moves by w across and by -n w' along the plane. So must the air above it.
#[test]
fn the_air_beside_a_plate_moves_with_it() {
    let (span_mm, thickness_mm) = (100.0, 2.0);
    let body = Body::new(Blade::plate(span_mm, 60.0, thickness_mm).mesh([6, 1, 12], 0.3).unwrap(), &STEEL);
    let modes = body.modes(&Blade::foot(body.mesh()), 3).unwrap();
    let field = Field::new(body.mesh().clone(), &modes, thickness_mm);
    let mut modal_point = ModalPoint::default();
    let mut shapes = |point_mm: [f64; 3]| {
        field.at(point_mm, &mut modal_point).unwrap();
        modal_point.shapes.clone()
    };
    for mode in 0..3 {
        let whole = modes.shapes[mode].iter().map(|u| distance(*u, [0.0; 3])).fold(0.0, f64::max);
        for place in 1..20 {
            let at = |height_mm: f64| [7.0, height_mm, 0.05 * span_mm * f64::from(place)];
            let (middle, face) = (shapes(at(0.0))[mode], shapes(at(0.5 * thickness_mm))[mode]);
            let above = shapes(at(1.5 * thickness_mm))[mode];
            let truth = std::array::from_fn(|axis| middle[axis] + 3.0 * (face[axis] - middle[axis]));
            assert!(distance(above, truth) < 4e-3 * whole, "mode {mode}, place {place}: {above:?} {truth:?}");
        }
    }
}
