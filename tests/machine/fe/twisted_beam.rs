//! A strip twisted by a right angle, clamped at one end, pushed at the other: MacNeal, Harder, A proposed standard set of problems to test finite
//! element accuracy, Finite Elements in Analysis and Design 1, 1985. Lengths in inches, the modulus in psi: any one set of units will do.

use std::f64::consts::FRAC_PI_2;

use arcfeed_blades::blade::Blade;
use arcfeed_fe::body::Body;
use arcfeed_fe::material::ElasticMaterial;
use arcfeed_fe::sparse::Factor;
use arcfeed_fe::unknowns::Unknowns;

use crate::fe::at_nodes::unknowns_of_nodes;

/// Displacement of the middle of the tip under a force of 1: along the tip's thickness, and along its width.
const TRUTH: [f64; 2] = [1.754e-3, 5.424e-3];

fn moved(cells: [usize; 3]) -> [f64; 2] {
    let strip = Blade { stagger_rad: [0.0, FRAC_PI_2], ..Blade::plate(12.0, 1.1, 0.32) };
    let material = ElasticMaterial { young_mpa: 29e6, poisson_ratio: 0.22, density_kg_per_m3: 1.0 };
    let body = Body::new(strip.mesh(cells, 1.0).unwrap(), &material);
    let unknowns = Unknowns::clamped(body.mesh(), &Blade::foot(body.mesh()));
    let (k, m) = body.matrices(&unknowns);
    let factor = Factor::of(&k, 0.0, &m).unwrap();
    // In half cells: the middle of chord and thickness, the end of the span.
    let tip = body.mesh().nodes_where(|place| place == [cells[0], cells[1], 2 * cells[2]]);
    let of_tip = unknowns_of_nodes(&unknowns)[tip[0]];
    [0, 1].map(|axis| {
        let pushed = of_tip[axis].expect("the tip is free");
        let mut x = vec![0.0; unknowns.count()];
        x[pushed] = 1.0;
        factor.solve(&mut x);
        x[pushed]
    })
}

#[test]
fn a_twisted_strip_gives_way_as_published() {
    for (cells, tolerance) in [([2, 1, 12], 0.02), ([4, 2, 24], 0.005)] {
        let ours = moved(cells);
        println!("{cells:?}: {ours:.7?}, truth {TRUTH:.7?}");
        for (ours, truth) in ours.iter().zip(TRUTH) {
            assert!((ours / truth - 1.0).abs() < tolerance, "{cells:?}: {ours} {truth}");
        }
    }
}
