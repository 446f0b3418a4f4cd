//! The edges on a tool's end: plunges and ramps against closed forms, and work against volume, which holds whatever the shape of the chips.

use std::f64::consts::{PI, TAU};

use arcfeed_milling::cutting::edge_engagement::{EdgeChip, EdgeEngagement};
use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, EndMill, Ring};
use arcfeed_milling::cutting::force::Loads;
use arcfeed_milling::cutting::layer::Layer;
use arcfeed_milling::cutting::layers::Layers;
use arcfeed_milling::cutting::material::{Cutting, Kienzle};
use arcfeed_milling::cutting::pose::ToolPose;
use nalgebra::{Vector2, Vector3};

use crate::cutting_forces::trochoid::Trochoid;

const RISE_MM: f64 = 0.5;
const SLICES: Pieces = Pieces::Slices { rise_mm: RISE_MM };
const MILL: EndMill = EndMill { diameter_mm: 10.0, corner_mm: 0.0, teeth: 4, helix_rad: 0.0, height_mm: 3.0 };
const RING: Ring =
    Ring { outer_radius_mm: 20.0, inner_radius_mm: 15.0, corner_mm: 0.0, active_teeth: 3, height_mm: 3.0 };
const STEPS: i32 = 120;
/// No edge forces: a cut's work is the tangential coefficient times its volume.
const LINEAR: Cutting = Cutting::linear([600.0, 200.0, 50.0], [0.0; 3]);

/// A tool over a block whose top is at 0, from one corner to another.
fn engagement(cutter: Cutter, from_mm: [f64; 2], size_mm: [f64; 2]) -> EdgeEngagement {
    let layer = Layer::rectangle(from_mm, size_mm, 0.25);
    EdgeEngagement::new(cutter, Layers::alike(&layer, -10.0 * RISE_MM, RISE_MM, 10), 2.0).expect("a tool in its layers")
}

fn mill() -> Cutter {
    Cutter::end_mill(&MILL, SLICES).expect("a mill")
}

/// A step of a run.
struct ProcessStep {
    loads: Loads,
    /// Thickest on the end and on the side; on the end of pieces that are half a radius from the axis or more.
    chips_mm: [f64; 2],
    /// Work of the torque in this step, with each chip's force at the centre of its section: on the side of a tool half a chip nearer
    /// to the axis than the edge.
    work_n_mm: f64,
}

/// Makes a number of turns along a path given by turns; returns the removed volume, which is the missing volume, and the work.
fn run(
    engagement: &mut EdgeEngagement,
    cutting: &Cutting,
    turns: i32,
    way_mm: impl Fn(f64) -> Vector3<f64>,
) -> (Vec<ProcessStep>, f64) {
    let before_mm3 = engagement.layers().volumes_mm3();
    let (mut taken_mm3, mut moments) = ([0.0; 2], Vec::new());
    for step in 0..=turns * STEPS {
        let turned = f64::from(step) / f64::from(STEPS);
        let tip = way_mm(turned);
        let stand = ToolPose { axis_mm: tip.xy(), tip_mm: tip.z, turned_rad: TAU * turned };
        let (mut loads, mut chips_mm, mut work_n_mm) = (Loads::default(), [0.0_f64; 2], 0.0);
        for EdgeChip { piece, section: chip, .. } in engagement.chips(&engagement.poses(&stand), |_| Vector2::zeros()) {
            let force = cutting.force(&chip);
            loads.add(&piece, stand.turned_rad, &force);
            let inwards_mm = f64::from(piece.side.advance()) * chip.thickness_mm * libm::sin(piece.lead_rad) / 2.0;
            work_n_mm += force.tangential_n * (piece.radius_mm - inwards_mm) * TAU / f64::from(STEPS);
            let thickest_mm = &mut chips_mm[usize::from(!piece.is_end())];
            if !piece.is_end() || piece.radius_mm > MILL.diameter_mm / 4.0 {
                *thickest_mm = thickest_mm.max(chip.thickness_mm);
            }
        }
        moments.push(ProcessStep { loads, chips_mm, work_n_mm });
        let removed = engagement.cut(&engagement.poses(&stand), |_| Vector2::zeros());
        taken_mm3 = [0, 1].map(|axis: usize| taken_mm3[axis] + removed[axis]);
    }
    let after_mm3 = engagement.layers().volumes_mm3();
    for axis in 0..2 {
        let lost_mm3 = before_mm3[axis] - after_mm3[axis];
        assert!((lost_mm3 - taken_mm3[axis]).abs() < 1e-11 * before_mm3[axis], "{lost_mm3} {taken_mm3:?}");
    }
    (moments, (taken_mm3[0] + taken_mm3[1]) / 2.0)
}

fn work(moments: &[ProcessStep]) -> f64 {
    moments.iter().map(|moment| moment.work_n_mm).sum()
}

#[track_caller]
fn assert_near(name: &str, found: f64, expected: f64, tolerance: f64) {
    let off = found / expected - 1.0;
    println!("{name}: {found:.6}, by hand {expected:.6}: {off:+.1e}");
    assert!(off.abs() <= tolerance, "{name}");
}

fn down(feed_mm: f64) -> impl Fn(f64) -> Vector3<f64> {
    move |turns| Vector3::new(0.0, 0.0, -feed_mm * turns)
}

#[test]
fn a_plunge_has_chips_torque_and_thrust_in_closed_form() {
    // 0.05 mm a tooth, along R = 5 mm of each of four; through three layers.
    let kienzle = Kienzle { specific_mpa: 800.0, exponent_ratio: 0.25 }.with_ratios(0.4, 0.2);
    let edges = Cutting::linear([600.0, 200.0, 50.0], [10.0, 5.0, 2.0]);
    for (cutting, tangential_n_per_mm, radial_n_per_mm) in [
        (edges, 600.0 * 0.05 + 10.0, 200.0 * 0.05 + 5.0),
        (kienzle, 800.0 * libm::pow(0.05, 0.75), 0.4 * 800.0 * libm::pow(0.05, 0.75)),
    ] {
        let mut engagement = engagement(mill(), [-7.0; 2], [14.0; 2]);
        let (moments, _) = run(&mut engagement, &cutting, 8, down(0.2));
        for moment in &moments[STEPS as usize..] {
            assert!((moment.chips_mm[0] - 0.05).abs() < 1e-12 && moment.chips_mm[1] < 1e-12, "{:?}", moment.chips_mm);
            let loads = &moment.loads;
            assert!((loads.torque_n_m * 1e3 - 4.0 * tangential_n_per_mm * 12.5).abs() < 1e-8, "{loads:?}");
            assert!((loads.force_n.z - 4.0 * radial_n_per_mm * 5.0).abs() < 1e-9 && loads.bending_n() < 1e-9);
        }
    }
}

#[test]
fn uneven_teeth_take_what_lies_between_them() {
    let pitches_rad = [80.0_f64, 100.0, 80.0, 100.0].map(f64::to_radians);
    let mut engagement = engagement(mill().with_pitch(&pitches_rad).expect("pitches"), [-7.0; 2], [14.0; 2]);
    let (moments, _) = run(&mut engagement, &LINEAR, 3, down(0.36));
    // Steps of 3 degrees do not divide a pitch: floors are looked up within one of where they were cut.
    let thickest_mm = moments[STEPS as usize..].iter().map(|moment| moment.chips_mm[0]).fold(0.0, f64::max);
    assert!((thickest_mm - 0.1).abs() <= 0.36 / f64::from(STEPS), "{thickest_mm}");
}

#[test]
fn half_a_hole_takes_half_the_torque() {
    let mut engagement = engagement(mill(), [0.0, -7.0], [14.0; 2]);
    let (moments, _) = run(&mut engagement, &LINEAR, 6, down(0.2));
    let turn = &moments[(5 * STEPS) as usize + 1..];
    let mean_n_m = turn.iter().map(|moment| moment.loads.torque_n_m).sum::<f64>() / turn.len() as f64;
    // One cell of 0.25 mm at the border, on either side of the axis.
    assert_near("half a hole, N m", mean_n_m, 2.0 * 600.0 * 0.05 * 12.5e-3, 5e-3);
}

#[test]
fn a_ring_plunges_with_all_its_teeth() {
    let cutter = Cutter::ring(&RING, SLICES).expect("a ring");
    let mut engagement = engagement(cutter, [-22.0; 2], [44.0; 2]);
    let (moments, taken_mm3) = run(&mut engagement, &LINEAR, 6, down(0.3));
    let last = moments.last().expect("steps");
    // The inner end moves along chords, with an error of 0.003 mm at their ends.
    assert_near("torque, N m", last.loads.torque_n_m, 6.0 * 600.0 * 0.05 * (400.0 - 225.0) / 2.0 * 1e-3, 1e-3);
    assert_near("thrust, N", last.loads.force_n.z, 6.0 * 200.0 * 0.05 * 5.0, 1e-3);
    assert_near("work, N mm", work(&moments), 600.0 * taken_mm3, 1e-3);
    // The last turn leaves between zero and a sixth of the feed.
    assert_near("volume, mm3", taken_mm3, PI * (400.0 - 225.0) * (1.8 - 0.3 / 12.0), 2e-3);
}

#[test]
fn a_ramp_has_both_chips_and_the_work_of_its_volume() {
    // 0.1 mm a tooth, 10 degrees down.
    let (sin, cos) = libm::sincos(10.0_f64.to_radians());
    for (name, cutter, teeth) in [("mill", mill(), 4.0), ("ring", Cutter::ring(&RING, SLICES).expect("a ring"), 6.0)] {
        let mut engagement = engagement(cutter, [-22.0; 2], [60.0, 44.0]);
        let way = |turns: f64| Vector3::new(cos, 0.0, -sin) * 0.1 * teeth * turns;
        let (moments, taken_mm3) = run(&mut engagement, &LINEAR, 24, way);
        let settled = &moments[(4 * STEPS) as usize..];
        let most = |which: usize| settled.iter().map(|moment| moment.chips_mm[which]).fold(0.0, f64::max);
        assert_near(&format!("{name}: work, N mm"), work(&moments), 600.0 * taken_mm3, 8e-3);
        if name == "mill" {
            // A place at r is passed again 0.1 mm / r later or sooner than a quarter of a turn, to a step of the 30 of that.
            assert_near("end, mm", most(0), 0.1 * sin, 0.1 / 2.5 / (PI / 2.0) + 1.0 / 30.0);
            assert_near("side, mm", most(1), 0.1 * cos, 2e-3);
        }
    }
}

#[test]
fn a_level_way_over_a_floor_has_no_chips_on_the_end() {
    // Down to the middle of a layer in a ramp, then on.
    let way = |turns: f64| Vector3::new(0.4 * turns, 0.0, -0.05 * turns.min(15.0));
    let mut engagement = engagement(mill(), [-7.0; 2], [40.0, 14.0]);
    let (moments, taken_mm3) = run(&mut engagement, &LINEAR, 40, way);
    for (step, moment) in moments.iter().enumerate().skip(STEPS as usize) {
        // After the last step down each of the four teeth passes once more, where the one before passed a little beside it.
        let off = step as i32 - (15 * STEPS + STEPS / 4);
        assert!(off.abs() < 3 || (moment.chips_mm[0] > 0.0) == (off < 0), "step {step}");
    }
    let level = &moments[(20 * STEPS) as usize..];
    let most_n_m = level.iter().map(|moment| moment.loads.torque_n_m).fold(0.0, f64::max);
    // Two of four teeth side by side in a slot 0.75 mm deep.
    let path = Trochoid { radius_mm: 5.0, teeth: 4, feed_mm_per_tooth: 0.1 };
    let chips_mm = (0..STEPS / 4).map(|step| {
        let angle_rad = TAU * f64::from(step) / f64::from(STEPS);
        path.chip_mm(angle_rad).max(0.0) + path.chip_mm(angle_rad + PI / 2.0).max(0.0)
    });
    assert_near("torque in the slot, N m", most_n_m, 600.0 * 0.75 * chips_mm.fold(0.0, f64::max) * 5e-3, 1e-3);
    assert_near("work, N mm", work(&moments), 600.0 * taken_mm3, 5e-3);
}

#[test]
fn a_helix_of_several_turns_in_one_layer_is_cut_by_the_side() {
    // Around a circle of 4 mm with 0.4 mm a turn of that, 0.05 mm a tooth.
    let turns_a_lap = TAU * 4.0 / 0.2;
    let laps = 4.0;
    let way = |turns: f64| {
        let (sin, cos) = libm::sincos(TAU * turns / turns_a_lap);
        Vector3::new(4.0 * cos, 4.0 * sin, -0.4 * turns / turns_a_lap)
    };
    let layer = Layer::rectangle([-10.0; 2], [20.0; 2], 0.25);
    let slices = Pieces::Slices { rise_mm: 3.0 };
    let mut engagement =
        EdgeEngagement::new(Cutter::end_mill(&MILL, slices).unwrap(), Layers::alike(&layer, -3.0, 3.0, 1), 2.0)
            .unwrap();
    let (moments, taken_mm3) = run(&mut engagement, &LINEAR, (laps * turns_a_lap) as i32, way);
    assert_near("work, N mm", work(&moments), 600.0 * taken_mm3, 5e-3);
    let last = &moments[((laps - 1.0) * turns_a_lap) as usize * STEPS as usize..];
    let most = |which: usize| last.iter().map(|moment| moment.chips_mm[which]).fold(0.0, f64::max);
    println!("thickest on the end {:.5} mm, on the side {:.5} mm", most(0), most(1));
    assert_near("end, mm", most(0), 0.1 / turns_a_lap, 1e-6);
    // The outer edge goes along a circle of 9 mm when the axis does so along one of 4.
    assert!((0.05..=0.06).contains(&most(1)), "{}", most(1));
}
