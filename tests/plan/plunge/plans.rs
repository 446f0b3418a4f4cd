//! Whole plans: the axes keep their distance, the proof is a bound, images of rotors have images of plans, and tools about the largest one.

use std::sync::OnceLock;

use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::geometry::generator::{Hand, Rotor};
use arcfeed_plan::plunge::assembly::ball_mm;
use arcfeed_plan::plunge::field::Field;
use arcfeed_plan::plunge::infeasibility::PlungeInfeasible;
use arcfeed_plan::plunge::line::Fit;
use arcfeed_plan::plunge::mill::{MillPart, PlungeMill};
use arcfeed_plan::plunge::passage::{Passage, PlungeRequirements};
use arcfeed_plan::plunge::passage_plan::{PassagePlan, Plunge};
use arcfeed_plan::plunge::proof::{PlungeProof, prove};
use arcfeed_plan::proof::clearance::Obstacle;
use arcfeed_plan::vector::{Point, Vector};
use nalgebra::Rotation3;

use super::passage::rotor_b;
use crate::published_rotor;

const NEEDS: PlungeRequirements =
    PlungeRequirements { allowance_mm: 0.889, cusp_mm: 0.222, fit: Fit::Gap, clearance_mm: 5.0, relief_mm: 0.2 };

fn mill(radius_mm: f64) -> PlungeMill {
    PlungeMill {
        radius_mm,
        corner_radius_mm: 0.4,
        core_radius_mm: 0.0,
        width_max_mm: radius_mm,
        length_mm: 12.0,
        neck_mm: vec![[radius_mm - 0.5, 38.0]],
        holder_mm: vec![[20.0, 40.0]],
        teeth: 3,
    }
}

fn plan(blisk: &Blisk, field: &Field, mill: &PlungeMill) -> Result<PassagePlan, PlungeInfeasible> {
    Passage {
        blisk,
        field,
        mill,
        needs: &NEEDS,
        turning_mm: blisk.blank.radius_mm,
        turning_ball_mm: ball_mm(&blisk.blank),
    }
    .plan()
}

/// Samples of both blades beside the passage.
pub fn samples(blisk: &Blisk) -> Vec<Point> {
    let places = || (0..=140).flat_map(|i| (0..=70).map(move |j| [f64::from(i) / 140.0, f64::from(j) / 70.0]));
    let faces = [0, 1].map(|index| blisk.blade(index)).map(|blade| [blade.pressure, blade.suction]);
    faces.iter().flatten().flat_map(|face| places().map(|[u, v]| face.point(u, v)).collect::<Vec<_>>()).collect()
}

pub fn least_mm(samples: &[Point], at: &Point) -> f64 {
    libm::sqrt(samples.iter().map(|sample| (sample - at).norm_squared()).fold(f64::INFINITY, f64::min))
}

/// Distance of a sample from the mill whose end is at `place` in its frame: cylinder, flat end, corner.
fn from_mill_mm(mill: &PlungeMill, place: &Point, sample: &Point) -> f64 {
    let off = sample - place;
    let corner = mill.corner_radius_mm;
    let across = (off.xy().norm() - (mill.radius_mm - corner)).max(0.0);
    let up = (corner - off.z).max(off.z - mill.length_mm).max(0.0);
    libm::hypot(across, up) - corner
}

/// Least distance between the cutting part and samples, along all moves of a plunge.
fn sampled_mm(mill: &PlungeMill, plunge: &Plunge, samples: &[Point]) -> f64 {
    let turned: Vec<Point> = samples.iter().map(|sample| plunge.to_tool * sample).collect();
    let moves = plunge.places();
    let ways =
        moves.windows(2).flat_map(|ends| (0..=30).map(move |k| ends[0] + (ends[1] - ends[0]) * (f64::from(k) / 30.0)));
    ways.flat_map(|place| turned.iter().map(move |sample| from_mill_mm(mill, &place, sample)))
        .fold(f64::INFINITY, f64::min)
}

fn clearance(proof: &PlungeProof, part: MillPart, obstacle: Obstacle) -> f64 {
    proof.clearances.iter().find(|found| found.part == part && found.obstacle == obstacle).unwrap().bounds_mm[0]
}

/// Plan of the 13-blade rotor for a mill of 12 mm, made once for all tests.
fn plan_of_12_mm() -> &'static (Blisk, PassagePlan) {
    static PLAN: OnceLock<(Blisk, PassagePlan)> = OnceLock::new();
    PLAN.get_or_init(|| {
        let blisk = rotor_b();
        let plan = plan(&blisk, &Field::new(&blisk), &mill(6.0)).unwrap();
        (blisk, plan)
    })
}

#[test]
fn point_2_every_axis_of_a_plan_keeps_its_distance() {
    let (blisk, plan) = plan_of_12_mm();
    let (mill, samples) = (mill(6.0), samples(blisk));
    let mut random = fastrand::Rng::with_seed(26);
    let needed_mm = mill.radius_mm + NEEDS.allowance_mm;
    let nearest_mm = (0..10_000)
        .map(|_| {
            let plunge = &plan.plunges[random.usize(0..plan.plunges.len())];
            let at = plunge.tip + plunge.axis * (random.f64() * 40.0);
            least_mm(&samples, &at)
        })
        .fold(f64::INFINITY, f64::min);
    let steepest = plan.planes.iter().map(|plane| plane.step_ratio).fold(0.0, f64::max);
    println!(
        "{} planes, {} plunges; 10000 places of axes: {nearest_mm:.4} mm from the blades of {needed_mm}; steps up to {steepest:.3} of the cusp's",
        plan.planes.len(),
        plan.plunges.len()
    );
    assert!(nearest_mm >= needed_mm - 0.01);
    assert!(steepest <= 1.0);
    for plane in &plan.planes {
        assert!(plane.spacing_mm <= mill.width_max_mm + 1e-9);
    }
}

#[test]
fn point_3_the_proof_is_a_bound_and_a_shifted_plunge_has_none() {
    let (blisk, plan) = plan_of_12_mm();
    let (mill, samples) = (mill(6.0), samples(blisk));
    let proof = prove(blisk, &mill, &plan.plunges, NEEDS.allowance_mm, &[]);
    assert!(proof.holds(), "{proof:?}");
    let proven_mm = clearance(&proof, MillPart::Cutter, Obstacle::Blades);
    let sampled = plan.plunges.iter().step_by(6).map(|plunge| sampled_mm(&mill, plunge, &samples));
    let sampled_mm = sampled.fold(f64::INFINITY, f64::min);
    println!("cutter to blades: proven {proven_mm:.4} mm, least of samples {sampled_mm:.4} mm");
    assert!(proven_mm <= sampled_mm);

    // One plunge moved towards a blade by 0.1 mm is found.
    let mut moved = plan.plunges.clone();
    let nearest = (0..moved.len()).min_by(|a, b| {
        let off = |k: usize| least_mm(&samples, &(moved[k].tip + moved[k].axis * 15.0));
        off(*a).total_cmp(&off(*b))
    });
    let worst = &mut moved[nearest.unwrap()];
    let aside = Vector::z().cross(&worst.axis) * 0.1;
    let towards =
        if least_mm(&samples, &(worst.tip + aside)) < least_mm(&samples, &worst.tip) { aside } else { -aside };
    worst.tip += towards;
    let proof = prove(blisk, &mill, &moved, NEEDS.allowance_mm, &[]);
    assert!(!proof.holds());
}

#[test]
fn point_6_a_tool_below_the_largest_one_is_planned_and_one_above_it_refused() {
    let blisk = rotor_b();
    let field = Field::new(&blisk);
    let any = mill(6.0);
    let looked =
        Passage { blisk: &blisk, field: &field, mill: &any, needs: &NEEDS, turning_mm: 95.0, turning_ball_mm: 100.0 }
            .largest();
    let least = looked.iter().min_by(|a, b| a.radius_mm.total_cmp(&b.radius_mm)).unwrap();
    assert!(plan(&blisk, &field, &mill(least.radius_mm - 0.05)).is_ok());
    let refused = plan(&blisk, &field, &mill(least.radius_mm + 0.05)).unwrap_err();
    println!("largest {:.3} mm at z {:.2}: {refused}", least.radius_mm, least.z_mm);
    let PlungeInfeasible::TooNarrow { z_mm, missing_mm, touching, largest_mm } = refused else { panic!("{refused:?}") };
    assert!((z_mm - least.z_mm).abs() < 5.0 && missing_mm < 0.2, "{z_mm} {missing_mm}");
    assert!((largest_mm.unwrap() - 2.0 * least.radius_mm).abs() < 1e-9);
    // Both points lie on the blades.
    let samples = samples(&blisk);
    assert!(touching.iter().all(|point| least_mm(&samples, point) < 0.5), "{touching:?}");
}

/// The 19-blade rotor, of either hand, turned about its axis.
fn blisk_19(hand: Hand, turn_rad: f64) -> Blisk {
    let [pressure, suction] = Rotor { hand, ..published_rotor::ROTOR }.sections(9, 81).unwrap().faces().unwrap();
    let turn = Rotation3::from_axis_angle(&Vector::z_axis(), turn_rad);
    Blisk { pressure: pressure.turned(&turn), suction: suction.turned(&turn), ..published_rotor::blisk() }
}

#[test]
fn point_5_mirrored_and_turned_rotors_have_images_of_the_plan() {
    const TURN_RAD: f64 = 0.5;
    let of = |hand: Hand, turn_rad: f64| {
        let blisk = blisk_19(hand, turn_rad);
        plan(&blisk, &Field::new(&blisk), &mill(4.0)).unwrap()
    };
    let (right, left, turned) = (of(Hand::Right, 0.0), of(Hand::Left, 0.0), of(Hand::Right, TURN_RAD));
    let back = Rotation3::from_axis_angle(&Vector::z_axis(), -TURN_RAD);
    // The image of a passage may be the next one of the mirrored rotor.
    let pitch_rad = core::f64::consts::TAU / 19.0;
    let [one_rad, image_rad] = [&right, &left].map(|plan| plan.planes[0].boundary.middle_rad);
    let passages = libm::round((one_rad + image_rad) / pitch_rad);
    let to_passage = Rotation3::from_axis_angle(&Vector::z_axis(), passages * pitch_rad);
    let mut off_mm = [0.0_f64; 2];
    // In the mirror image a plane begins at the other blade: its columns come in reversed order.
    for (number, plane) in right.planes.iter().enumerate() {
        let of_plane = |plan: &PassagePlan| {
            plan.plunges.iter().filter(|plunge| plunge.plane == number).copied().collect::<Vec<_>>()
        };
        let [one, mut image, same] = [&right, &left, &turned].map(of_plane);
        assert!(one.len() == plane.columns && one.len() == image.len() && one.len() == same.len());
        let is_rising = |row: &[Plunge]| {
            let angle = |plunge: &Plunge| libm::atan2(plunge.axis.y, plunge.axis.x);
            row.len() > 1 && angle(&row[0]) < angle(&row[1])
        };
        if is_rising(&one) == is_rising(&image) {
            image.reverse();
        }
        for (index, plunge) in one.iter().enumerate() {
            let mirror = |vector: Vector| to_passage * Vector::new(vector.x, -vector.y, vector.z);
            let pairs = [
                (mirror(image[index].tip.coords), mirror(image[index].axis)),
                (back * same[index].tip.coords, back * same[index].axis),
            ];
            for (off_mm, (tip, axis)) in off_mm.iter_mut().zip(pairs) {
                *off_mm = off_mm.max((plunge.tip.coords - tip).norm()).max((plunge.axis - axis).norm() * 98.6);
            }
        }
    }
    println!(
        "{} plunges; of the mirror image {:.1e} mm apart at most, turned {:.1e}",
        right.plunges.len(),
        off_mm[0],
        off_mm[1]
    );
    assert!(right.plunges.len() == left.plunges.len() && off_mm.into_iter().all(|off_mm| off_mm < 1e-9));
}
