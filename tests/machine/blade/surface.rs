//! The surface that a pass leaves.

use arcfeed_blades::blade::Blade;
use arcfeed_blades::finishing::marks::{deviation_mm, marks};
use arcfeed_blades::finishing::pass::{FinishingPass, MillError, PassResult};
use arcfeed_fe::body::Body;
use arcfeed_fe::field::Field;
use arcfeed_fe::material::TITANIUM_6AL_4V;
use arcfeed_modal::dynamics::chatter::metric_mm;
use arcfeed_modal::flexible::Workpiece;

use crate::blade::small::{FEED_MM_PER_TOOTH, THICKNESS_MM, pass, plate, run, tool};

/// The rays of a layer that end on the machined side, away from the plate's edges: where they stand, where they end.
fn ends_mm(machined: &PassResult, layer: usize) -> Vec<[f64; 2]> {
    let layer = &machined.layers.layers()[layer];
    let rays = layer.rays(1).iter().enumerate().map(|(ray, dexel)| (layer.place_mm(1, ray), dexel));
    let inner = rays.filter(|(x_mm, _)| x_mm.abs() < 3.5);
    inner.filter_map(|(x_mm, dexel)| Some([x_mm, dexel.extent()?.to_mm])).collect()
}

#[test]
fn a_rigid_pair_leaves_the_nominal_surface_and_the_cusps_of_its_feed() {
    let pass = pass(plate(), 0.005);
    let machined = run(&pass, Vec::new());
    assert_eq!(machined.open, 0);
    for layer in 0..machined.layers.layers().len() {
        let nominal_mm = THICKNESS_MM / 2.0 + pass.after_mm(&machined.layers, layer);
        // A cusp of the ball's circle in this layer, and what an edge turns past the deepest point between two steps.
        let radius_mm = 2.0 - (nominal_mm - THICKNESS_MM / 2.0);
        let cusp_mm = FEED_MM_PER_TOOTH * FEED_MM_PER_TOOTH / (8.0 * radius_mm);
        for [x_mm, end_mm] in ends_mm(&machined, layer) {
            let off_mm = end_mm - nominal_mm;
            assert!(
                off_mm > -1e-4 && off_mm < 1.1 * cusp_mm + 1e-4,
                "layer {layer} at {x_mm}: {off_mm}, cusp {cusp_mm}"
            );
        }
    }
    // Highest points of the layer below the equator.
    let layer = machined.layers.index(pass.side.height_mm() - 0.1).unwrap();
    let ends = ends_mm(&machined, layer);
    let is_top = |at: &usize| {
        let around = &ends[at.saturating_sub(8)..(at + 9).min(ends.len())];
        *at >= 8 && at + 9 <= ends.len() && around.iter().all(|end| end[1] <= ends[*at][1])
    };
    let tops: Vec<f64> = (0..ends.len()).filter(is_top).map(|at| ends[at][0]).collect();
    let spacing_mm = (tops[tops.len() - 1] - tops[0]) / (tops.len() - 1) as f64;
    println!("{} cusps, {spacing_mm:.4} mm apart", tops.len());
    assert!((spacing_mm / FEED_MM_PER_TOOTH - 1.0).abs() < 0.02, "{spacing_mm}");
}

#[test]
fn more_damping_means_smaller_marks() {
    let pass = pass(plate(), 0.05);
    let rigid = run(&pass, Vec::new());
    let figures: Vec<[f64; 2]> = [0.005, 0.02, 0.2]
        .map(|damping| {
            let machined = run(&pass, tool(1960.0, damping, 600.0));
            let on_blade = machined.teeth.iter().filter(|tooth| tooth.along_mm.abs() < 3.5);
            let samples: Vec<_> = on_blade.map(|tooth| tooth.displacement_mm).collect();
            let of_surface = marks(&pass.side, &rigid, &machined);
            [metric_mm(&samples, 1), deviation_mm(of_surface.iter())]
        })
        .into();
    println!("M and surface: {figures:?} mm");
    for pair in figures.windows(2) {
        assert!(pair[1][0] < pair[0][0] && pair[1][1] < pair[0][1], "{figures:?}");
    }
    assert!(figures[0][0] > 0.005 && figures[2][0] < 0.0005, "{figures:?}");
}

#[test]
fn nearly_rigid_parts_leave_the_surface_of_rigid_ones() {
    // 1000 times as stiff and as heavy as titanium, and the pass is far up.
    let stiff = arcfeed_fe::material::ElasticMaterial {
        young_mpa: 1e3 * TITANIUM_6AL_4V.young_mpa,
        density_kg_per_m3: 1e3 * TITANIUM_6AL_4V.density_kg_per_m3,
        ..TITANIUM_6AL_4V
    };
    let pass = pass(plate(), 0.05);
    let rigid = run(&pass, Vec::new());
    let body = Body::new(plate().mesh([4, 1, 6], 1.0).unwrap(), &stiff);
    let field = Field::new(body.mesh().clone(), &body.modes(&Blade::foot(body.mesh()), 6).unwrap(), 0.5);
    let mut seen = Workpiece::new(&field);
    let modes = seen.modes(pass.side.place_mm(0.0), 0.05).unwrap();
    let machined = pass.run(modes, Some(seen)).unwrap();
    let deviation_mm = deviation_mm(marks(&pass.side, &rigid, &machined).iter());
    println!("surface {deviation_mm:.2e} mm");
    assert!(deviation_mm < 5e-5, "{deviation_mm}");
}

#[test]
fn a_ball_that_is_no_whole_number_of_layers_is_refused() {
    let refused = |change: fn(&mut FinishingPass)| {
        let mut odd = pass(plate(), 0.05);
        change(&mut odd);
        odd.run::<Field>(Vec::new(), None).err()
    };
    assert_eq!(refused(|pass| pass.resolution.rise_mm = 0.3), Some(MillError));
    assert_eq!(refused(|pass| pass.mill.corner_mm = 1.0), Some(MillError));
    assert_eq!(refused(|pass| pass.mill.helix_rad = 2.0), Some(MillError));
}
