//! A flexible workpiece seen from its contact, against the finite elements' own static solution.

use arcfeed_blades::beam::{Beam, BeamSection};
use arcfeed_blades::blade::Blade;
use arcfeed_fe::body::Body;
use arcfeed_fe::field::Field;
use arcfeed_fe::material::{STEEL, TITANIUM_6AL_4V};
use arcfeed_fe::sparse::Factor;
use arcfeed_fe::unknowns::Unknowns;
use arcfeed_modal::dynamics::transition::Rule;
use arcfeed_modal::dynamics::vibration::{Stepping, Vibration};
use arcfeed_modal::flexible::Workpiece;
use nalgebra::Vector3;

/// Nearly at once.
const DAMPING: f64 = 0.7;
const STEPPING: Stepping = Stepping { rule: Rule::Exact, tolerance_mm: 1e-12, iterations_max: 5 };
const FORCE_N: [f64; 3] = [0.5, 10.0, 1.0];

/// Displacement of a node under the force on it, by K^-1.
fn static_mm(body: &Body, node: usize) -> [f64; 3] {
    let unknowns = Unknowns::clamped(body.mesh(), &Blade::foot(body.mesh()));
    let (k, m) = body.matrices(&unknowns);
    let mut x: Vec<f64> = (0..unknowns.count())
        .map(|unknown| {
            let mut unit = vec![0.0; unknowns.count()];
            unit[unknown] = 1.0;
            let u = unknowns.displacements(0, &unit)[node];
            (0..3).map(|axis| u[axis] * FORCE_N[axis]).sum()
        })
        .collect();
    Factor::of(&k, 0.0, &m).unwrap().solve(&mut x);
    unknowns.displacements(0, &x)[node]
}

#[test]
fn static_force_bends_the_moving_contact_like_the_finite_element_blade() {
    let blade = Blade { camber_rad: [0.4, 0.2], edge_ratio: 0.4, ..Blade::plate(20.0, 16.0, 1.5) };
    let body = Body::new(blade.mesh([4, 1, 6], 0.5).unwrap(), &TITANIUM_6AL_4V);
    let nodes = body.mesh().nodes_where(|place| place[2] == 10 && place[1] == 2);
    let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
    let mut rests = Vec::new();
    for count in [10, 40, 160] {
        let modes = body.modes(&Blade::foot(body.mesh()), count).unwrap();
        let field = Field::new(body.mesh().clone(), &modes, 0.1);
        let mut workpiece = Workpiece::new(&field);
        let seen = workpiece.modes(body.mesh().nodes_mm()[first], DAMPING).unwrap();
        let mut vibration = Vibration::new(seen, STEPPING);
        let truth_mm = Vector3::from(static_mm(&body, last));
        // Pushed at one edge, then at the other.
        for node in [first, last] {
            vibration.set_shapes(workpiece.shapes_on(body.mesh().nodes_mm()[node]));
            for _ in 0..200 {
                vibration.step(2e-5, |_| Vector3::from(FORCE_N));
            }
        }
        rests.push((vibration.displacement_mm() - truth_mm).norm() / truth_mm.norm());
    }
    println!("missing with 10, 40, 160 modes: {rests:?}");
    assert!(rests[0] < 0.10 && rests[1] < rests[0] && rests[2] < rests[1] && rests[2] < 0.02, "{rests:?}");
}

#[test]
fn tool_and_workpiece_give_way_together_as_two_springs_in_a_row() {
    let body = Body::new(Blade::plate(20.0, 16.0, 1.5).mesh([4, 1, 6], 1.0).unwrap(), &TITANIUM_6AL_4V);
    let field = Field::new(body.mesh().clone(), &body.modes(&Blade::foot(body.mesh()), 6).unwrap(), 0.1);
    let mut modes = Workpiece::new(&field).modes([5.0, 0.75, 18.0], DAMPING).unwrap();
    let of_workpiece = modes.len();
    let section = BeamSection { length_mm: 40.0, diameter_mm: 8.0, material: STEEL };
    let beam = Beam { sections: vec![section], tip_mass_kg: 0.0, elements: 8 }.modes(12).unwrap();
    modes.extend(beam.modes_at([0.0; 3], DAMPING).unwrap());
    let force_n = Vector3::from(FORCE_N);
    let each: Vec<Vector3<f64>> = modes.iter().map(|mode| mode.static_mm(&force_n)).collect();
    // Bernoulli's beam and its shear: F l^3 / 3 E I + F l / kappa G A.
    let inertia_mm4 = std::f64::consts::PI / 64.0 * 8.0_f64.powi(4);
    let tip_mm = 10.0 * 40.0_f64.powi(3) / (3.0 * STEEL.young_mpa * inertia_mm4);
    let of_tool_mm = each[of_workpiece..].iter().sum::<Vector3<f64>>();
    assert!((of_tool_mm.y / tip_mm - 1.0).abs() < 0.05, "{} {tip_mm}", of_tool_mm.y);
    let mut vibration = Vibration::new(modes, STEPPING);
    for _ in 0..200 {
        vibration.step(2e-5, |_| force_n);
    }
    let sum_mm = each.iter().sum::<Vector3<f64>>();
    assert!((vibration.displacement_mm() - sum_mm).norm() < 1e-6 * sum_mm.norm());
}
