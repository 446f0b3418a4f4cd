//! The edges remove the volume that the material loses and that the solid of the tool sweeps.

use std::f64::consts::{PI, TAU};

use arcfeed_dexel::solid::Block;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_milling::cutting::edge_engagement::{EdgeEngagement, EdgeEngagementError};
use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, EndMill};
use arcfeed_milling::cutting::layers::Layers;
use arcfeed_milling::cutting::pose::ToolPose;
use nalgebra::Vector2;

const STEP_MM: f64 = 0.25;

fn ball() -> EndMill {
    EndMill { diameter_mm: 12.0, corner_mm: 6.0, teeth: 3, helix_rad: 0.5, height_mm: 6.0 }
}

fn slices() -> Pieces {
    Pieces::Slices { rise_mm: STEP_MM }
}

fn layers() -> Layers {
    let block = Block { lowest_mm: [0.0, -10.0, 0.0], highest_mm: [20.0, 10.0, 4.0] };
    Layers::of(&Stock::new(&block, STEP_MM, 1 << 26).expect("a block"), 2)
}

#[test]
fn removed_and_remaining_volume_add_up_to_the_initial_one() {
    let mut engagement = EdgeEngagement::new(Cutter::end_mill(&ball(), slices()).unwrap(), layers(), 3.0).unwrap();
    let before = engagement.layers().volumes_mm3();
    let mut taken = [0.0; 2];
    for step in 0..7200 {
        let turns = f64::from(step) / 360.0;
        let stand = ToolPose { axis_mm: Vector2::new(-6.5 + turns, 1.0), tip_mm: 1.0, turned_rad: TAU * turns };
        let removed = engagement.cut(&engagement.poses(&stand), |_| Vector2::zeros());
        taken = [0, 1].map(|axis: usize| taken[axis] + removed[axis]);
    }
    let after = engagement.layers().volumes_mm3();
    for axis in 0..2 {
        assert!((taken[axis] + after[axis] - before[axis]).abs() < 1e-12 * before[axis] * 100.0);
        assert!(taken[axis] > 100.0);
    }
    // A ball's way of 3 mm depth at the end: section of a circle's segment, R 6, 3 mm deep, along 13.5 mm up to the axis.
    let segment_mm2 = 36.0 * libm::acos(0.5) - 3.0 * libm::sqrt(36.0 - 9.0);
    let along_mm = 13.5;
    let cap = PI * 9.0 * (18.0 - 3.0) / 3.0 / 2.0;
    let should = segment_mm2 * along_mm + cap;
    for taken in taken {
        assert!((taken / should - 1.0).abs() < 0.02, "{taken} {should}");
    }
}

#[test]
fn an_edge_in_other_pieces_than_the_layers_is_refused() {
    let cutter = Cutter::end_mill(&ball(), Pieces::Along(10)).unwrap();
    let error = EdgeEngagement::new(cutter, layers(), 1.0).unwrap_err();
    assert!(
        error.to_string().starts_with("layers of 0.25 mm need edges in slices of the same height, not of "),
        "{error}"
    );
    let cutter = Cutter::end_mill(&ball(), slices()).unwrap();
    assert_eq!(EdgeEngagement::new(cutter, layers(), 0.0).unwrap_err(), EdgeEngagementError::Depth { depth_mm: 0.0 });
}
