//! Positions and directions of edges; runout, pitch and inserts of different height, compared with calculation by hand.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, EdgeError, EdgePiece, EndMill, Ring};
use arcfeed_milling::cutting::force::Loads;
use arcfeed_milling::cutting::material::{ChipSection, Cutting, EdgeForce};
use arcfeed_model::tool::Edge;
use nalgebra::Vector3;

const FLAT: EndMill = EndMill { diameter_mm: 10.0, corner_mm: 0.0, teeth: 2, helix_rad: 0.0, height_mm: 4.0 };

const CUP: Ring =
    Ring { outer_radius_mm: 128.576, inner_radius_mm: 112.701, corner_mm: 1.0, active_teeth: 5, height_mm: 2.5 };

#[test]
fn pieces_of_a_ball_make_up_its_quarter_circle_and_its_section() {
    let ball = EndMill { corner_mm: 5.0, height_mm: 5.0, helix_rad: 0.5, ..FLAT };
    let cutter = Cutter::end_mill(&ball, Pieces::Along(200)).unwrap();
    let tooth = || cutter.pieces().iter().filter(|piece| piece.tooth == 1);
    let width_mm: f64 = tooth().map(EdgePiece::width_mm).sum();
    assert!((width_mm - 5.0 * FRAC_PI_2).abs() < 1e-4, "{width_mm}");
    assert!((tooth().map(|piece| piece.rise_mm).sum::<f64>() - 5.0).abs() < 1e-12);
    for piece in tooth() {
        // Normals of a ball start at its centre.
        let normal = piece.directions(0.3).normal;
        let from_centre = piece.place_mm(0.3) - Vector3::new(0.0, 0.0, 5.0);
        assert!((normal * 5.0 - from_centre).norm() < 1e-12);
        assert!((piece.angle_rad - PI - piece.height_mm * libm::tan(0.5) / 5.0).abs() < 1e-12);
    }
    let shadow_mm2: f64 =
        tooth().map(|piece| piece.width_mm() * libm::sin(piece.lead_rad) * 2.0 * piece.radius_mm).sum();
    // Half of the ball's section through its axis.
    assert!((shadow_mm2 - PI * 25.0 / 2.0).abs() < 1e-2, "{shadow_mm2}");
}

#[test]
fn directions_are_a_frame_and_the_edge_moves_as_defined() {
    let cutter = Cutter::ring(&CUP, Pieces::Along(12)).unwrap();
    for piece in cutter.pieces() {
        let to = piece.directions(0.7);
        let step_rad = 1e-6;
        let moved =
            (piece.place_mm(0.7 + step_rad) - piece.place_mm(0.7 - step_rad)) / (2.0 * step_rad * piece.radius_mm);
        assert!((moved - to.motion).norm() < 1e-9, "M3 turns clockwise as seen from the holder");
        assert!(to.motion.dot(&to.normal).abs() < 1e-15 && to.normal.dot(&to.along).abs() < 1e-15);
        let outwards = piece.place_mm(0.7).xy().dot(&to.normal.xy());
        assert_eq!(outwards > 0.0, piece.side == Edge::Outer);
        assert!(to.along.z > 0.0 && to.normal.z <= 1e-15);
    }
}

#[test]
fn inserts_of_a_ring_stand_by_turns_outside_and_inside() {
    let cutter = Cutter::ring(&CUP, Pieces::Along(8)).unwrap();
    assert_eq!(cutter.teeth(), 10);
    for piece in cutter.pieces() {
        let (side, wall_mm) = if piece.tooth % 2 == 0 { (Edge::Outer, 128.576) } else { (Edge::Inner, 112.701) };
        assert_eq!(piece.side, side);
        assert!((piece.angle_rad - TAU * piece.tooth as f64 / 10.0).abs() < 1e-12);
        let inset_mm = (wall_mm - piece.radius_mm) * if side == Edge::Outer { 1.0 } else { -1.0 };
        assert!((0.0..1.0).contains(&inset_mm) && (piece.height_mm > 1.0) == (inset_mm == 0.0));
    }
    let of_tooth = |tooth| cutter.pieces().iter().filter(move |piece| piece.tooth == tooth);
    let width_mm: f64 = of_tooth(3).map(EdgePiece::width_mm).sum();
    assert!((width_mm - FRAC_PI_2 - 1.5).abs() < 0.01, "{width_mm}");
}

#[test]
fn forces_of_single_pieces_are_those_of_a_drawing() {
    let force = EdgeForce { tangential_n: 100.0, radial_n: 40.0, axial_n: 7.0 };
    let piece = |side, lead_rad| EdgePiece {
        tooth: 0,
        height_mm: 1.0,
        rise_mm: 0.5,
        radius_mm: 20.0,
        angle_rad: FRAC_PI_2,
        lead_rad,
        side,
    };
    let on_tool = |piece: &EdgePiece| {
        let mut loads = Loads::default();
        loads.add(piece, FRAC_PI_2, &force);
        assert!((loads.torque_n_m - 2.0).abs() < 1e-15);
        assert!((loads.power_w(3000.0) - 2.0 * TAU * 50.0).abs() < 1e-9);
        loads.force_n
    };
    // M3 brings the piece from y to x, where it moves to -y.
    let at = |x, y, z| Vector3::new(x, y, z);
    assert!((on_tool(&piece(Edge::Outer, FRAC_PI_2)) - at(-40.0, 100.0, -7.0)).norm() < 1e-12);
    assert!((on_tool(&piece(Edge::Inner, FRAC_PI_2)) - at(40.0, 100.0, -7.0)).norm() < 1e-12);
    assert!((on_tool(&piece(Edge::Outer, 0.0)) - at(-7.0, 100.0, 40.0)).norm() < 1e-12);
    assert!((on_tool(&piece(Edge::Inner, 0.0)) - at(7.0, 100.0, 40.0)).norm() < 1e-12);
}

#[test]
fn rounded_edges_under_an_even_load_give_closed_forms() {
    // 10, 10, 4 N/mm on a quarter circle of 1.5 mm: the integrals of sin and cos over it are 1.5 mm each.
    let cutting = Cutting::linear([0.0; 3], [10.0, 10.0, 4.0]);
    let ring = Ring { outer_radius_mm: 20.0, inner_radius_mm: 12.0, corner_mm: 1.5, active_teeth: 1, height_mm: 1.5 };
    let cutter = Cutter::ring(&ring, Pieces::Along(400)).unwrap();
    for (tooth, wall_mm, side) in [(0, 20.0, 1.0), (1, 12.0, -1.0)] {
        let mut loads = Loads::default();
        // Each tooth in turn to the x axis, where M3 moves it to -y.
        let turned_rad = PI * tooth as f64;
        for piece in cutter.pieces().iter().filter(|piece| piece.tooth == tooth) {
            let chip = ChipSection { thickness_mm: 0.1, width_mm: piece.width_mm() };
            loads.add(piece, turned_rad, &cutting.force(&chip));
        }
        let tangential_n = 15.0 * FRAC_PI_2;
        let expected_n = Vector3::new(-side * (15.0 + 6.0), tangential_n, 15.0 - 6.0);
        assert!((loads.force_n - expected_n).norm() < 1e-4, "{} {expected_n}", loads.force_n);
        // The integral of the radius, wall -+ 1.5 (1 - sin k), over the arc.
        let moment = 10.0 * 1.5 * (wall_mm * FRAC_PI_2 - side * 1.5 * (FRAC_PI_2 - 1.0));
        assert!((loads.torque_n_m * 1e3 - moment).abs() < 1e-3, "{} {moment}", loads.torque_n_m);
    }
}

/// Tangential forces of two teeth straight ahead, where each meets what the other left: fz + r - r before.
fn ahead_n(cutter: &Cutter) -> [f64; 2] {
    let cutting = Cutting::linear([1000.0, 0.0, 0.0], [20.0, 0.0, 0.0]);
    let radius_mm = |tooth: usize| cutter.pieces().iter().find(|piece| piece.tooth == tooth).unwrap().radius_mm;
    [0, 1].map(|tooth| {
        let thickness_mm = 0.1 + radius_mm(tooth) - radius_mm(1 - tooth);
        let of_tooth = cutter.pieces().iter().filter(|piece| piece.tooth == tooth);
        let forces = of_tooth.map(|piece| cutting.force(&ChipSection { thickness_mm, width_mm: piece.width_mm() }));
        forces.map(|force| force.tangential_n).sum()
    })
}

#[test]
fn runout_and_offsets_change_the_force_of_each_tooth() {
    let cutter = Cutter::end_mill(&FLAT, Pieces::Along(3)).unwrap();
    // 4 mm wide: (1000 * 0.1 + 20) * 4 = 480 N.
    let expect = |cutter: &Cutter, expected_n: [f64; 2]| {
        let found_n = ahead_n(cutter);
        assert!((0..2).all(|tooth| (found_n[tooth] - expected_n[tooth]).abs() < 1e-9), "{found_n:?} {expected_n:?}");
    };
    expect(&cutter, [480.0, 480.0]);
    // Along tooth 0 the radii are 5.01 and 4.99 mm, chips 0.12 and 0.08 mm.
    expect(&cutter.clone().with_runout(0.01, 0.0).unwrap(), [560.0, 400.0]);
    // Across the teeth both are hypot(5, 0.01).
    expect(&cutter.clone().with_runout(0.01, FRAC_PI_2).unwrap(), [480.0, 480.0]);
    // Tooth 1 would have -0.02 mm and cuts nothing, tooth 0 has 0.22 mm.
    expect(&cutter.clone().with_runout(0.06, 0.0).unwrap(), [960.0, 0.0]);
    expect(&cutter.with_offsets(&[0.0, 0.03]).unwrap(), [360.0, 600.0]);
}

#[test]
fn runout_moves_every_place_by_the_same() {
    let mill = EndMill { teeth: 3, helix_rad: 0.6, ..FLAT };
    let plain = Cutter::end_mill(&mill, Pieces::Along(5)).unwrap();
    let moved = plain.clone().with_runout(0.05, 1.0).unwrap();
    let by = Vector3::new(0.05 * libm::cos(1.0), 0.05 * libm::sin(1.0), 0.0);
    for (before, after) in plain.pieces().iter().zip(moved.pieces()) {
        assert!((after.place_mm(0.0) - before.place_mm(0.0) - by).norm() < 1e-14);
    }
    let moved_back = moved.with_runout(0.02, 4.0).unwrap().with_runout(0.0, 0.0).unwrap();
    for (before, after) in plain.pieces().iter().zip(moved_back.pieces()) {
        assert!((after.place_mm(0.0) - before.place_mm(0.0)).norm() < 1e-14);
    }
    let other_order = plain.clone().with_runout(0.05, 1.0).unwrap().with_offsets(&[0.1, 0.0, -0.1]).unwrap();
    let order = plain.with_offsets(&[0.1, 0.0, -0.1]).unwrap().with_runout(0.05, 1.0).unwrap();
    for (a, b) in order.pieces().iter().zip(other_order.pieces()) {
        assert!((a.place_mm(0.0) - b.place_mm(0.0)).norm() < 1e-13);
    }
}

#[test]
fn pitches_put_each_tooth_where_they_say() {
    let mill = EndMill { teeth: 4, helix_rad: 0.5, ..FLAT };
    let pitches_rad = [85.0_f64, 95.0, 80.0, 100.0].map(f64::to_radians);
    let plain = Cutter::end_mill(&mill, Pieces::Along(4)).unwrap();
    let cutter = plain.clone().with_pitch(&pitches_rad).unwrap();
    for (piece, before) in cutter.pieces().iter().zip(plain.pieces()) {
        let expected_deg = [0.0, 85.0, 180.0, 260.0][piece.tooth] - 90.0 * piece.tooth as f64;
        assert!((piece.angle_rad - before.angle_rad - expected_deg.to_radians()).abs() < 1e-12);
    }
    let back = cutter.with_pitch(&[FRAC_PI_2; 4]).unwrap();
    assert!(back.pieces().iter().zip(plain.pieces()).all(|(a, b)| (a.angle_rad - b.angle_rad).abs() < 1e-12));
}

#[test]
fn invalid_cutters_are_refused() {
    let refused = |mill: EndMill| Cutter::end_mill(&mill, Pieces::Along(4)).unwrap_err();
    assert_eq!(refused(EndMill { teeth: 0, ..FLAT }), EdgeError::Nothing);
    assert_eq!(refused(EndMill { corner_mm: 5.1, ..FLAT }), EdgeError::Dimensions);
    assert_eq!(refused(EndMill { corner_mm: f64::NAN, ..FLAT }), EdgeError::Dimensions);
    assert_eq!(refused(EndMill { diameter_mm: 0.0, ..FLAT }), EdgeError::Dimensions);
    assert_eq!(refused(EndMill { height_mm: f64::INFINITY, ..FLAT }), EdgeError::Dimensions);
    assert_eq!(refused(EndMill { helix_rad: FRAC_PI_2, ..FLAT }), EdgeError::Dimensions);
    assert_eq!(Cutter::end_mill(&FLAT, Pieces::Along(0)), Err(EdgeError::Nothing));
    assert_eq!(Cutter::ring(&Ring { corner_mm: 8.0, ..CUP }, Pieces::Along(4)), Err(EdgeError::Dimensions));
    let cutter = || Cutter::end_mill(&FLAT, Pieces::Along(4)).unwrap();
    assert_eq!(cutter().with_pitch(&[TAU]), Err(EdgeError::Count { teeth: 2, given: 1 }));
    assert_eq!(cutter().with_pitch(&[PI, 3.0]), Err(EdgeError::Pitch));
    assert_eq!(cutter().with_pitch(&[-PI, 3.0 * PI]), Err(EdgeError::Pitch));
    assert_eq!(cutter().with_offsets(&[-5.0, 0.0]), Err(EdgeError::Radius { tooth: 0 }));
    assert_eq!(cutter().with_runout(6.0, 0.0), Err(EdgeError::Radius { tooth: 1 }));
    assert!(cutter().with_runout(f64::NAN, 0.0).is_err());
}
