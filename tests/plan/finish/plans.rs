//! Plans of a whole blade: what is left on the surface, gouges, distances, and the feed at the contact, all measured from the path.

use arcfeed::machine_file::MachineFile;
use arcfeed_kinematics::machine::Machine;
use arcfeed_plan::finish::access::{FinishInfeasible, MoveKind};
use arcfeed_plan::finish::feed::ContactFeed;
use arcfeed_plan::finish::mill::{CutterLocation, FinishMill};
use arcfeed_plan::finish::needs::FinishNeeds;
use arcfeed_plan::finish::obstacles::obstacles;
use arcfeed_plan::finish::passes::{Course, Sampling};
use arcfeed_plan::finish::plan::{FinishPlan, Planner};
use arcfeed_plan::finish::proof::FinishProof;
use arcfeed_plan::finish::reach::Margins;
use arcfeed_plan::finish::rows::Spacing;
use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::geometry::generator::Rotor;
use arcfeed_plan::vector::{Point, Vector};

use arcfeed_tests::root;

use crate::published_rotor;

const SCALLOP_MM: f64 = 0.02;
const TOLERANCE_MM: f64 = 0.005;
/// Gouges that the proof accepts, as the command has them: the tolerance and 0.01 mm.
const GOUGE_MM: f64 = 0.015;

/// The rotor of the published size, with its round leading and sharp trailing edge.
pub fn blisk() -> Blisk {
    published_rotor::rotor(&published_rotor::ROTOR.sections(9, 161).unwrap())
}

/// The same with trailing edges 0.5 mm thick that end in half circles; there its sides have kinks.
fn blisk_with_kinks() -> Blisk {
    published_rotor::rotor(&Rotor { edge_mm: 0.5, ..published_rotor::ROTOR }.sections(9, 81).unwrap())
}

pub fn mill() -> FinishMill {
    FinishMill {
        radius_mm: 2.5,
        corner_radius_mm: 2.5,
        length_mm: 6.0,
        neck_mm: vec![[2.2, 34.0]],
        holder_mm: vec![[12.0, 40.0]],
        teeth: 2,
    }
}

pub fn needs(course: Course, spacing: Spacing) -> FinishNeeds {
    FinishNeeds {
        margins: Margins { safety_mm: 0.5, gouge_mm: GOUGE_MM },
        sampling: Sampling { tolerance_mm: TOLERANCE_MM, step_mm: 2.0, angle_rad: 0.02 },
        scallop_mm: SCALLOP_MM,
        span: [Some(0.5), Some(0.56)],
        spacing,
        course,
        is_climb: true,
        clearance_mm: 5.0,
        axes: None,
        tilt_rad: [10.0_f64.to_radians(), 80.0_f64.to_radians()],
    }
}

/// Machine of the example.
pub fn mikron() -> Machine {
    MachineFile::load(&root().join("host/adapt/machines/mikron-ucp710.toml")).expect("a preset").machine
}

fn plan(blisk: &Blisk, needs: &FinishNeeds) -> Result<FinishPlan, FinishInfeasible> {
    Planner { blisk, mill: &mill(), machine: &mikron(), needs, bodies: &obstacles(blisk, &[]) }.plan()
}

/// Centres of the ball along the cutting moves, as a control leads them: the tip straight, the axis turned with it.
fn centres(plan: &FinishPlan, pieces: usize) -> Vec<Point> {
    let mut found = Vec::new();
    for pair in plan.path.windows(2).filter(|pair| pair[1].kind == MoveKind::Cut) {
        for k in 0..pieces {
            let part = k as f64 / pieces as f64;
            found.push(led(&pair[0].location, &pair[1].location, part).tip_to_centre());
        }
    }
    found
}

/// Place between two others: tip straight, axis turned evenly.
fn led(from: &CutterLocation, to: &CutterLocation, part: f64) -> Led {
    let axis = from.axis.slerp(&to.axis, part);
    Led { tip: from.tip + (to.tip - from.tip) * part, axis }
}

struct Led {
    tip: Point,
    axis: Vector,
}

impl Led {
    fn tip_to_centre(&self) -> Point {
        self.tip + self.axis * mill().corner_radius_mm
    }
}

/// Height of the material left above a point of the surface, along its normal, and the depth by which the ball reaches below the point.
fn left_mm(point: &Point, normal: &Vector, centres: &[Point], radius_mm: f64) -> [f64; 2] {
    let over = |centre: &Point| {
        let off = centre - point;
        let along = off.dot(normal);
        let across = radius_mm * radius_mm - (off.norm_squared() - along * along);
        // Not a ball on the other side of the blade.
        (across > 0.0 && along > 0.0).then(|| along - libm::sqrt(across))
    };
    let nearest_mm = centres.iter().map(|centre| (centre - point).norm()).fold(f64::INFINITY, f64::min);
    [centres.iter().filter_map(over).fold(f64::INFINITY, f64::min), radius_mm - nearest_mm]
}

#[test]
fn scallops_and_gouges_of_a_spiral_are_within_the_stated_ones() {
    let blisk = blisk();
    for spacing in [Spacing::IsoParametric, Spacing::IsoStepover] {
        let started = std::time::Instant::now();
        let plan = plan(&blisk, &needs(Course::Spiral, spacing)).unwrap();
        let points: usize = plan.passes.iter().map(Vec::len).sum();
        println!("{spacing:?}: {} turns, {points} points, {:?}", plan.passes.len(), started.elapsed());
        let centres = centres(&plan, 12);
        let (mut most, mut deepest, mut worst) = (f64::NEG_INFINITY, f64::NEG_INFINITY, (0.0, 0.0));
        for face in [&blisk.pressure, &blisk.suction] {
            for i in 0..=150 {
                for j in 0..=40 {
                    // Denser at both edges, and off the borders of the span, beyond which a ball of the last turn leaves more.
                    let u = (1.0 - libm::cos(core::f64::consts::PI * f64::from(i) / 150.0)) / 2.0;
                    let v = 0.5 + 0.06 * f64::from(j) / 40.0;
                    let [left, depth] = left_mm(&face.point(u, v), &face.normal(u, v), &centres, mill().radius_mm);
                    if left > most {
                        worst = (u, v);
                    }
                    (most, deepest) = (most.max(left), deepest.max(depth));
                }
            }
        }
        println!("left: at most {most:.4} mm, at {worst:?}; gouges: at most {deepest:.4} mm");
        assert!(most <= SCALLOP_MM + TOLERANCE_MM && deepest <= GOUGE_MM, "{most} {deepest}");
        // It is no plan of needless passes either.
        assert!(most >= 0.5 * SCALLOP_MM, "{most}");
    }
}

/// Points of the blades and the hub, dense.
fn samples(blisk: &Blisk, own: bool) -> Vec<Point> {
    let places = |many: i32| (0..=many).map(move |k| f64::from(k) / f64::from(many));
    let numbers = if own { 0..1 } else { 1..blisk.blades.cast_signed() };
    let near = numbers.filter(|k| own || [1, 2, 17, 18].contains(k));
    let faces = near.flat_map(|k| [blisk.blade(k).pressure, blisk.blade(k).suction]).collect::<Vec<_>>();
    faces.iter().flat_map(|face| places(60).flat_map(move |u| places(40).map(move |v| face.point(u, v)))).collect()
}

/// Distance of a point from the neck and the holder of the mill, by cylinders.
fn from_shank_mm(mill: &FinishMill, tip: &Point, axis: &Vector, point: &Point) -> f64 {
    let off = point - tip;
    let up = off.dot(axis);
    let across = (off - axis * up).norm();
    let mut from_mm = mill.length_mm;
    let mut least = f64::INFINITY;
    for [radius_mm, length_mm] in mill.neck_mm.iter().chain(&mill.holder_mm) {
        let beyond = (from_mm - up).max(up - from_mm - length_mm).max(0.0);
        least = least.min(libm::hypot((across - radius_mm).max(0.0), beyond));
        from_mm += length_mm;
    }
    least
}

#[test]
fn the_proof_holds_and_is_nowhere_above_the_distances_of_samples() {
    let blisk = blisk_with_kinks();
    let (mill, needs) = (mill(), needs(Course::Spiral, Spacing::IsoParametric));
    let bodies = obstacles(&blisk, &[]);
    let plan = plan(&blisk, &needs).unwrap();
    let path: Vec<CutterLocation> = plan.path.iter().map(|step| step.location).collect();
    let proof = FinishProof { mill: &mill, bodies: &bodies, margins: needs.margins, departure_rad: 3.5e-4 };
    let found = proof.clearances(&path);
    for clearance in &found {
        println!(
            "{:?} {:?}: {:.4} of {:.4} mm",
            clearance.part, clearance.obstacle, clearance.certified_mm, clearance.needed_mm
        );
        assert!(clearance.holds(), "{clearance:?}");
    }
    let others = samples(&blisk, false);
    let mut least = f64::INFINITY;
    for pair in path.windows(2).step_by(5) {
        let at = led(&pair[0], &pair[1], 0.37);
        least = others.iter().map(|point| from_shank_mm(&mill, &at.tip, &at.axis, point)).fold(least, f64::min);
    }
    println!("neck and holder from samples of the neighbours: {least:.4} mm");
    assert!(least >= needs.margins.safety_mm);
    // A mill with a neck as thick as the passage is refused, with the place.
    let thick = FinishMill { neck_mm: vec![[9.0, 34.0]], ..mill };
    let refused = Planner { blisk: &blisk, mill: &thick, machine: &mikron(), needs: &needs, bodies: &bodies }.plan();
    assert!(matches!(refused, Err(FinishInfeasible::NoAxis { .. })), "{refused:?}");
}

#[test]
fn the_contact_keeps_its_feed_while_the_tip_swings_round_the_edges() {
    let blisk = blisk();
    let plan = plan(&blisk, &needs(Course::Spiral, Spacing::IsoParametric)).unwrap();
    let target = 400.0;
    for max_raise_ratio in [2.0, 10.0] {
        let feed = ContactFeed { target_mm_per_min: target, max_raise_ratio, max_mm_per_min: 1e6 };
        let (mut at_contact, mut at_end, mut highest) = (0.0_f64, 0.0_f64, 0.0_f64);
        for pair in plan.path.windows(2).filter(|pair| pair[1].kind == MoveKind::Cut) {
            let (from, to) = (pair[0].point.unwrap(), pair[1].point.unwrap());
            let f = feed.tip_mm_per_min(&mill(), &from, &to);
            let minutes = (to.location.tip - from.location.tip).norm() / f;
            // The foot of the ball's centre on the surface, by the surface's own normals: not the contact that the law used.
            let [start, end] = [from, to].map(|point| led(&point.location, &point.location, 0.0).tip_to_centre());
            let [foot_from, foot_to] = [start, end].map(|centre| foot(&blisk, &centre));
            // Both sides end up to a micrometre apart at an edge.
            at_contact = at_contact.max(((foot_to - foot_from).norm() - 0.002).max(0.0) / minutes);
            at_end = at_end.max((end - start).norm() / minutes);
            highest = highest.max(f);
        }
        println!("at the contact at most {at_contact:.2}, at the ball {at_end:.1}, F at most {highest:.1} mm/min");
        assert!(at_contact <= target * 1.005 && at_end <= max_raise_ratio * target * 1.0001);
        assert!(at_contact >= 0.98 * target);
    }
}

/// Nearest point of the blade to a point, by samples that close in.
pub fn foot(blisk: &Blisk, centre: &Point) -> Point {
    let mut best = (f64::INFINITY, Point::origin());
    for face in [&blisk.pressure, &blisk.suction] {
        let (mut at, mut half) = ([0.5, 0.5], 0.5);
        for round in 0..60 {
            let steps = if round == 0 { 40 } else { 4 };
            let place =
                |k: i32, middle: f64| (middle + half * (2.0 * f64::from(k) / f64::from(steps) - 1.0)).clamp(0.0, 1.0);
            let tried = (0..=steps)
                .flat_map(|i| (0..=steps).map(move |j| (i, j)))
                .map(|(i, j)| [place(i, at[0]), place(j, at[1])]);
            let near = |uv: &[f64; 2]| (face.point(uv[0], uv[1]) - centre).norm();
            at = tried.min_by(|one, other| near(one).total_cmp(&near(other))).unwrap_or(at);
            half *= if round == 0 { 0.1 } else { 0.7 };
        }
        let point = face.point(at[0], at[1]);
        if (point - centre).norm() < best.0 {
            best = ((point - centre).norm(), point);
        }
    }
    best.1
}
