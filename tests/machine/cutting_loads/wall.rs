//! A thin wall on its foot as a tool beside it sees it, against the stiffness of all its elements.

use std::sync::Arc;

use arcfeed_fe::body::Body;
use arcfeed_fe::clamped_block::{ClampedBlock, Face};
use arcfeed_fe::field::Field;
use arcfeed_fe::material::TITANIUM_6AL_4V;
use arcfeed_fe::sparse::Factor;
use arcfeed_fe::unknowns::Unknowns;
use arcfeed_hil_sim::removal::flexible_workpiece::FlexibleWorkpiece;
use arcfeed_modal::dynamics::modal::Mode;
use nalgebra::Vector3;

use crate::fe::at_nodes::unknowns_of_nodes;

const WALL: ClampedBlock = ClampedBlock {
    lowest_mm: [0.0, -3.0, -40.0],
    highest_mm: [80.0, 0.0, 0.0],
    held: Face { axis: 2, is_upper: false },
};

/// Height of the edges of the tool beside the wall, up from its tip.
const EDGES_MM: f64 = 1.0;

/// Deflection by 1 N across the wall at nodes of its face: by all of K, and by `count` modes as a tool beside the node sees
/// them.
fn bent_mm(cells: [usize; 3], count: Option<usize>, places: &[[usize; 2]]) -> Vec<[f64; 2]> {
    let mesh = WALL.mesh(cells).expect("a mesh");
    let body = Body::new(mesh.clone(), &TITANIUM_6AL_4V);
    let clamped = WALL.held.nodes(&mesh);
    let unknowns = Unknowns::clamped(&mesh, &clamped);
    let (k, m) = body.matrices(&unknowns);
    let factor = Factor::of(&k, 0.0, &m).expect("it is held");
    let modes = body.modes(&clamped, count.unwrap_or(k.size())).expect("so many");
    let field = Field::new(mesh.clone(), &modes, 1e-3);
    let given = field.largest_modes(0.01).expect("a damping");
    let mut flexible = FlexibleWorkpiece::new(Arc::new(field), mesh.bounds_mm(), EDGES_MM);
    let at = |[x, z]: &[usize; 2]| {
        let node = mesh.nodes_where(|place| place == [*x, 2 * cells[1], *z])[0];
        let mut push = vec![0.0; k.size()];
        let unknown = unknowns_of_nodes(&unknowns)[node][1].expect("it is free");
        push[unknown] = 1.0;
        factor.solve(&mut push);
        let [x_mm, _, z_mm] = mesh.nodes_mm()[node];
        // Beside the wall by 5 mm; above its top there is nothing to be beside of.
        let tip_mm = [x_mm, 5.0, if z_mm == 0.0 { 0.0 } else { z_mm - EDGES_MM / 2.0 }];
        let seen = given.iter().zip(flexible.shapes(&tip_mm)).map(|(mode, shape)| Mode { shape: *shape, ..*mode });
        [push[unknown], seen.map(|mode| mode.static_mm(&Vector3::y()).y).sum()]
    };
    places.iter().map(at).collect()
}

#[test]
fn all_modes_bend_it_as_its_stiffness_does() {
    // The middle of the top, its corner, and below its middle.
    for [whole_mm, seen_mm] in bent_mm([4, 1, 3], None, &[[4, 6], [0, 6], [4, 4]]) {
        println!("{whole_mm:.6e} mm, by modes {seen_mm:.6e}");
        assert!((seen_mm / whole_mm - 1.0).abs() < 1e-8);
    }
}

#[test]
fn ten_modes_bend_it_nearly_as_much() {
    let bent = bent_mm([16, 1, 10], Some(10), &[[16, 20], [0, 20], [16, 14]]);
    let parts = bent.iter().map(|[whole_mm, seen_mm]| seen_mm / whole_mm);
    println!("{bent:?} mm; {:.3?} of it by ten modes", parts.clone().collect::<Vec<f64>>());
    // Every mode adds to it. A plate deflects most at its corners, and less towards its foot.
    assert!(parts.into_iter().all(|part| (0.8..1.0).contains(&part)));
    assert!(bent[1][1] > 1.5 * bent[0][1] && bent[2][1] < 0.5 * bent[0][1]);
}
