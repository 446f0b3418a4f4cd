//! Teeth that are not alike: runout, offsets, uneven pitch, inner and outer edges by turns.

use std::f64::consts::{PI, TAU};

use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, EndMill, Ring};
use arcfeed_milling::cutting::layer::Layer;
use nalgebra::Vector2;

use crate::chips::bench::{Seen, Straight};

const RADIUS_MM: f64 = 20.0;
const MILL: EndMill =
    EndMill { diameter_mm: 2.0 * RADIUS_MM, corner_mm: 0.0, teeth: 4, helix_rad: 0.0, height_mm: 1.0 };
const SLICES: Pieces = Pieces::Slices { rise_mm: 1.0 };

fn cut(cutter: Cutter, feed_mm_per_turn: f64) -> Vec<Seen> {
    let straight = Straight {
        feed_mm_per_turn,
        step_mm: 0.1,
        material_mm: [-RADIUS_MM - 1.0, RADIUS_MM + 1.0],
        steps_a_turn: 720,
        turns: [8, 6],
    };
    straight.seen(cutter)
}

/// The chip of a tooth straight ahead.
fn ahead_mm(seen: &[Seen], tooth: usize) -> f64 {
    let of_tooth = seen.iter().filter(|seen| seen.tooth == tooth);
    let off = |seen: &&Seen| (seen.angle_rad - PI / 2.0).abs();
    of_tooth.min_by(|a, b| off(a).total_cmp(&off(b))).expect("a tooth").thickness_mm
}

#[test]
fn a_tooth_behind_a_wide_pitch_has_a_thick_chip() {
    // M3 brings the teeth to a place in their order: before tooth n comes n - 1, the pitch from that to this one ago.
    let pitches_rad = [0.20, 0.30, 0.23, 0.27].map(|part| part * TAU);
    let cutter = Cutter::end_mill(&MILL, SLICES).unwrap().with_pitch(&pitches_rad).unwrap();
    let seen = cut(cutter, 0.4);
    for tooth in 0..4 {
        let part = pitches_rad[(tooth + 3) % 4] / TAU;
        let found = ahead_mm(&seen, tooth);
        assert!((found - 0.4 * part).abs() < 2e-5, "tooth {tooth}: {found}, {}", 0.4 * part);
    }
}

#[test]
fn longer_tooth_cuts_the_material_that_the_next_one_misses() {
    let offsets_mm = [0.02, 0.0, -0.03, 0.01];
    let cutter = Cutter::end_mill(&MILL, SLICES).unwrap().with_offsets(&offsets_mm).unwrap();
    let seen = cut(cutter, 0.4);
    for tooth in 0..4 {
        let should_mm = 0.1 + offsets_mm[tooth] - offsets_mm[(tooth + 3) % 4];
        let found = ahead_mm(&seen, tooth);
        assert!((found - should_mm).abs() < 2e-5, "tooth {tooth}: {found}, {should_mm}");
    }
}

#[test]
fn a_tooth_too_short_for_the_feed_cuts_nothing_and_the_next_one_both() {
    let cutter = Cutter::end_mill(&MILL, SLICES).unwrap().with_offsets(&[0.0, -0.3, 0.0, 0.0]).unwrap();
    let seen = cut(cutter, 0.4);
    for (tooth, should_mm) in [(0, 0.1), (1, 0.0), (2, 0.2), (3, 0.1)] {
        let found = ahead_mm(&seen, tooth);
        assert!((found - should_mm).abs() < 2e-5, "tooth {tooth}: {found}");
    }
}

#[test]
fn runout_makes_chips_differ_by_what_the_edges_do() {
    // Eccentric by e towards tooth 0: edges at R + e, R, R - e, R.
    let cutter = Cutter::end_mill(&MILL, SLICES).unwrap().with_runout(0.02, 0.0).unwrap();
    let seen = cut(cutter, 0.4);
    for (tooth, should_mm) in [(0, 0.12), (1, 0.08), (2, 0.08), (3, 0.12)] {
        let found = ahead_mm(&seen, tooth);
        // Teeth 1 and 3 stand e/R of a turn's angle off.
        assert!((found - should_mm).abs() < 1e-4, "tooth {tooth}: {found}");
    }
}

#[test]
fn a_ring_cuts_outside_in_front_and_inside_behind() {
    let ring = Ring { outer_radius_mm: 20.0, inner_radius_mm: 15.0, corner_mm: 0.0, active_teeth: 4, height_mm: 1.0 };
    let cutter = Cutter::ring(&ring, SLICES).unwrap();
    // Material everywhere but where the ring stands at first.
    let mut layer = Layer::rectangle([-21.0, -21.0], [45.0, 42.0], 0.1);
    layer.clear_ring(Vector2::zeros(), 15.0, 20.0);
    let straight =
        Straight { feed_mm_per_turn: 0.4, step_mm: 0.1, material_mm: [-21.0, 21.0], steps_a_turn: 720, turns: [6, 5] };
    let seen = straight.seen_in(layer, cutter);
    // Beside the tool, where chips begin and end, is left out.
    for seen in seen.iter().filter(|seen| libm::sin(seen.angle_rad).abs() > 0.2) {
        let (is_outer, ahead) = (seen.tooth % 2 == 0, libm::sin(seen.angle_rad));
        // Each circle is moved by the feed of one of its own teeth: outside in front, inside behind.
        let should_mm = if is_outer == (ahead > 0.0) { 0.1 * ahead.abs() } else { 0.0 };
        // The path is no circle: z fz / (2 pi R) of the chip, and fz^2 / 2R beside the tool.
        assert!((seen.thickness_mm - should_mm).abs() < 1.5e-3, "{seen:?} {should_mm}");
    }
}
