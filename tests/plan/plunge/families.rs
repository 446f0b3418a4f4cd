//! The family of planes beside the radial one: from both faces. Blades of plane walls give closed forms:
//!
//! ```text
//! middle between two blades: m; their planes at the angle alpha = pi / N from it; thickness t, D = R + a
//! from a face, at radius y:        x_L = (D + t/2 - y sin alpha) / cos alpha,                   R_max = ((r_h + a) sin alpha - t/2 - a) / (1 - sin alpha)
//! ```

use arcfeed_plan::geometry::blisk::{Blank, Blisk, Revolution};
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::plunge::assembly::ball_mm;
use arcfeed_plan::plunge::faces::{EntryFace, FaceFamily, radial_stretch};
use arcfeed_plan::plunge::field::Field;
use arcfeed_plan::plunge::infeasibility::PlungeInfeasible;
use arcfeed_plan::plunge::line::Fit;
use arcfeed_plan::plunge::mill::PlungeMill;
use arcfeed_plan::plunge::passage::{Passage, PlungeRequirements};
use arcfeed_plan::plunge::passage_plan::{PassagePlan, Plunge, PlungeFamily};
use arcfeed_plan::plunge::proof::prove;
use arcfeed_plan::plunge::section::{Midway, SectionFamily};
use arcfeed_plan::vector::{Point, Vector};

use super::plans::{least_mm, samples};

const NEEDS: PlungeRequirements =
    PlungeRequirements { allowance_mm: 0.8, cusp_mm: 0.3, fit: Fit::Gap, clearance_mm: 5.0, relief_mm: 0.2 };
const THICKNESS_MM: f64 = 3.0;
/// Hub, tip and half length of the flat blades.
const FLAT_MM: [f64; 3] = [60.0, 95.0, 20.0];

fn mill(radius_mm: f64) -> PlungeMill {
    PlungeMill {
        radius_mm,
        corner_radius_mm: 0.4,
        core_radius_mm: 0.0,
        width_max_mm: radius_mm,
        length_mm: 12.0,
        neck_mm: vec![[radius_mm - 0.5, 60.0]],
        holder_mm: vec![[20.0, 40.0]],
        teeth: 3,
    }
}

/// A blade about the plane y = 0 whose points and shifts along y follow from u and v.
fn blade(point: impl Fn(f64, f64) -> [f64; 3]) -> [Face; 2] {
    [1.0, -1.0].map(|sign| {
        let at = |i: usize, j: usize| {
            let [radius, shift, z] = point(i as f64 / 24.0, j as f64 / 12.0);
            Point::new(radius, shift + sign * THICKNESS_MM / 2.0, z)
        };
        let rows: Vec<Vec<Point>> = (0..=12).map(|j| (0..=24).map(|i| at(i, j)).collect()).collect();
        Face::through(&rows, Vector::y() * sign).unwrap()
    })
}

/// Thirteen flat radial blades, bowed by an amount that depends on the place along the axis.
fn flat(bow_mm: impl Fn(f64) -> f64) -> Blisk {
    let [hub_mm, tip_mm, half_mm] = FLAT_MM;
    let [pressure, suction] = blade(|u, v| {
        let (radius, z) = (hub_mm - 2.0 + (tip_mm - hub_mm + 2.0) * v, half_mm * (2.0 * u - 1.0));
        let height = (radius - hub_mm) / (tip_mm - hub_mm);
        [radius, bow_mm(z) * 4.0 * height * (1.0 - height), z]
    });
    let hub = Revolution { profile_mm: vec![[-30.0, hub_mm], [30.0, hub_mm]] };
    Blisk {
        blades: 13,
        pressure,
        suction,
        further_blades: Vec::new(),
        hub,
        blank: Blank { radius_mm: tip_mm, faces_mm: [-half_mm, half_mm] },
    }
}

fn passage<'p>(blisk: &'p Blisk, field: &'p Field, mill: &'p PlungeMill) -> Passage<'p> {
    let (turning_mm, turning_ball_mm) = (blisk.blank.radius_mm, ball_mm(&blisk.blank));
    Passage { blisk, field, mill, needs: &NEEDS, turning_mm, turning_ball_mm }
}

/// Largest radius from a face between flat radial blades.
fn largest_from_face_mm() -> f64 {
    let sin = libm::sin(core::f64::consts::PI / 13.0);
    ((FLAT_MM[0] + NEEDS.allowance_mm) * sin - THICKNESS_MM / 2.0 - NEEDS.allowance_mm) / (1.0 - sin)
}

fn families(plan: &PassagePlan) -> Vec<PlungeFamily> {
    let mut found: Vec<PlungeFamily> = plan.planes.iter().map(|plane| plane.family).collect();
    found.dedup();
    found
}

/// Proof, and distances of places on the axes from samples of the blades: axes keep radius and allowance.
fn assert_proven(blisk: &Blisk, mill: &PlungeMill, plan: &PassagePlan) {
    let proof = prove(blisk, mill, &plan.plunges, NEEDS.allowance_mm, &[]);
    assert!(proof.holds(), "{proof:?}");
    let samples = samples(blisk);
    let places = plan.plunges.iter().flat_map(|plunge| (0..=8).map(|k| plunge.tip + plunge.axis * f64::from(k) * 5.0));
    let nearest_mm = places.map(|place| least_mm(&samples, &place)).fold(f64::INFINITY, f64::min);
    let needed_mm = mill.radius_mm + NEEDS.allowance_mm;
    println!("{} planes, {} plunges: {nearest_mm:.4} mm of {needed_mm}", plan.planes.len(), plan.plunges.len());
    assert!(nearest_mm >= needed_mm - 0.01);
}

/// Whether a mill has cut a point.
fn is_cut(plunges: &[Plunge], radius_mm: f64, point: &Point) -> bool {
    plunges.iter().any(|plunge| {
        let way = point - plunge.tip;
        let up_mm = way.dot(&plunge.axis);
        up_mm >= 0.4 && (way - plunge.axis * up_mm).norm() <= radius_mm
    })
}

#[test]
fn between_flat_blades_the_axes_from_a_face_are_those_of_the_closed_form() {
    let blisk = flat(|_| 0.0);
    let (field, midway) = (Field::new(&blisk), Midway::new(&blisk));
    let (sin, cos) = libm::sincos(core::f64::consts::PI / 13.0);
    let mut off_mm = 0.0_f64;
    for radius_mm in [4.0, 9.0, 14.0] {
        let mill = mill(radius_mm);
        let passage = passage(&blisk, &field, &mill);
        for (face, inner_mm) in [(EntryFace::Lower, 5.0), (EntryFace::Upper, -8.0)] {
            let family = FaceFamily { passage: &passage, midway: &midway, face, inner_mm };
            let [high_mm, low_mm] = family.range_mm();
            assert!(high_mm <= FLAT_MM[1] && low_mm == FLAT_MM[0] + NEEDS.allowance_mm + radius_mm);
            for at_mm in [low_mm, f64::midpoint(low_mm, high_mm)] {
                let section = family.at(at_mm).unwrap();
                let expected_mm = (radius_mm + NEEDS.allowance_mm + THICKNESS_MM / 2.0 - at_mm * sin) / cos;
                let found = section.boundary;
                for place in [found.roof[0], found.floor[0]] {
                    off_mm = off_mm.max((place.x - expected_mm).abs());
                }
                for place in [found.roof[1], found.floor[1]] {
                    off_mm = off_mm.max((place.x + expected_mm).abs());
                }
                assert_eq!(section.plane.point(&found.floor[0]).z, inner_mm);
            }
        }
    }
    println!("axes from faces: {off_mm:.4} mm from the closed form");
    assert!(off_mm < 0.005);
}

#[test]
fn a_mill_too_thick_for_radial_plunging_comes_from_both_faces_up_to_the_closed_form() {
    let blisk = flat(|_| 0.0);
    let field = Field::new(&blisk);
    let largest_mm = largest_from_face_mm();
    let thick = mill(largest_mm - 0.05);
    let plan = passage(&blisk, &field, &thick).plan().unwrap();
    assert_eq!(families(&plan), [PlungeFamily::LowerFace, PlungeFamily::UpperFace]);
    assert_proven(&blisk, &thick, &plan);
    assert_no_pillar(&thick, &plan);
    // Links between both sides lie beyond all that turns.
    assert!(plan.plunges.iter().all(|plunge| plunge.clear_mm >= libm::hypot(95.0, 20.0) + NEEDS.clearance_mm));

    let mill = mill(largest_mm + 0.05);
    let refused = passage(&blisk, &field, &mill).plan().unwrap_err();
    println!("{refused}");
    let PlungeInfeasible::FaceTooNarrow { radius_mm, missing_mm, touching, largest_mm: named_mm, .. } = refused else {
        panic!("{refused:?}")
    };
    let (sin, cos) = libm::sincos(core::f64::consts::PI / 13.0);
    let lowest_mm = FLAT_MM[0] + NEEDS.allowance_mm + mill.radius_mm;
    let room_mm = 2.0 * (lowest_mm * sin - THICKNESS_MM / 2.0 - NEEDS.allowance_mm - mill.radius_mm) / cos;
    assert!((radius_mm - lowest_mm).abs() < 1e-9 && (missing_mm + room_mm).abs() < 0.01, "{missing_mm} {room_mm}");
    assert!((named_mm.unwrap() - 2.0 * largest_mm).abs() < 0.03, "{named_mm:?} {largest_mm}");
    let samples = samples(&blisk);
    assert!(touching.iter().all(|point| least_mm(&samples, point) < 0.5), "{touching:?}");
}

/// Between the axes of the closed form all is cut, from the lowest plane to the rim.
fn assert_no_pillar(mill: &PlungeMill, plan: &PassagePlan) {
    let (sin, cos) = libm::sincos(core::f64::consts::PI / 13.0);
    let middle = Vector::new(cos, sin, 0.0);
    let across = Vector::z().cross(&middle);
    let mut random = fastrand::Rng::with_seed(26);
    let lowest_mm = FLAT_MM[0] + NEEDS.allowance_mm + mill.radius_mm;
    for _ in 0..20_000 {
        let y = lowest_mm + random.f64() * (FLAT_MM[1] - lowest_mm);
        let half_mm = (y * sin - THICKNESS_MM / 2.0 - NEEDS.allowance_mm - mill.radius_mm) / cos;
        let [x, z] = [half_mm, FLAT_MM[2]].map(|most| (random.f64() * 2.0 - 1.0) * most);
        let point = Point::origin() + middle * y + across * x + Vector::z() * z;
        assert!(is_cut(&plan.plunges, mill.radius_mm, &point), "{point}");
    }
}

#[test]
fn an_inlet_that_radial_axes_do_not_pass_is_opened_from_its_face_and_a_middle_is_refused() {
    // Bowed by more than the room between the blades at low places; a radial axis is straight.
    let bow = |z: f64| 12.0 * ((-z / FLAT_MM[2]).max(0.0)).powi(2);
    let blisk = flat(bow);
    let (field, mill) = (Field::new(&blisk), mill(10.0));
    let plan = passage(&blisk, &field, &mill).plan().unwrap();
    assert_eq!(families(&plan), [PlungeFamily::LowerFace, PlungeFamily::Radial]);
    assert_proven(&blisk, &mill, &plan);
    // The planes from the face end a radius within the radial ones.
    let first_mm = plan.planes.iter().find(|plane| plane.family == PlungeFamily::Radial).unwrap().z_mm;
    let ends = plan.plunges.iter().filter(|plunge| plan.planes[plunge.plane].family == PlungeFamily::LowerFace);
    for plunge in ends {
        assert!((plunge.tip.z - first_mm - mill.radius_mm).abs() < 1e-9);
    }

    // Bowed in the middle alone: no face opens that.
    let blisk = flat(|z| 12.0 * libm::exp(-z * z / 20.0));
    let field = Field::new(&blisk);
    let found = radial_stretch(&passage(&blisk, &field, &mill), [-FLAT_MM[2], FLAT_MM[2]]);
    assert!(found.is_err_and(|z_mm| z_mm.abs() < 15.0), "{found:?}");
}

/// Radius of a bowl's generatrix, and that of its start about the rotor's axis.
const BOWL_MM: [f64; 2] = [40.0, 30.0];

/// Place of the bowl's hub at an angle of its generatrix, and its normal: z, radius.
fn bowl(angle_rad: f64) -> ([f64; 2], [f64; 2]) {
    let (sin, cos) = libm::sincos(angle_rad);
    ([BOWL_MM[0] * sin, BOWL_MM[1] + BOWL_MM[0] * (1.0 - cos)], [-sin, cos])
}

/// Eight flat blades on a hub that turns from the rotor's axis into the plane across it.
fn centrifugal() -> Blisk {
    let angle = |share: f64| share * core::f64::consts::FRAC_PI_2;
    let [pressure, suction] = blade(|u, v| {
        let ([z, radius], [up_z, up_radius]) = bowl(angle(1.07 * u - 0.1));
        let height = -2.0 + 17.0 * v;
        [radius + up_radius * height, 0.0, z + up_z * height]
    });
    let hub = Revolution { profile_mm: (0..=400).map(|k| bowl(angle(f64::from(k) / 400.0)).0).collect() };
    Blisk {
        blades: 8,
        pressure,
        suction,
        further_blades: Vec::new(),
        hub,
        blank: Blank { radius_mm: 70.0, faces_mm: [0.0, 40.0] },
    }
}

/// In a plane across the rotor's axis the hub's normal leans by the angle of the generatrix, and a boundary axis, parallel to its blade, by its
/// own angle in the plane as well.
#[test]
fn a_centrifugal_hub_is_refused_where_its_normal_leans_too_far_from_radial_axes() {
    let blisk = centrifugal();
    let (field, mill) = (Field::new(&blisk), mill(5.0));
    let refused = passage(&blisk, &field, &mill).plan().unwrap_err();
    let PlungeInfeasible::Steep { z_mm, angle_deg } = refused else { panic!("{refused:?}") };
    let above_mm = BOWL_MM[0] - NEEDS.allowance_mm;
    let angle_rad = libm::asin(z_mm / above_mm);
    let radius_mm = BOWL_MM[0] + BOWL_MM[1] - above_mm * libm::cos(angle_rad);
    let beside_ratio = (mill.radius_mm + NEEDS.allowance_mm + THICKNESS_MM / 2.0) / radius_mm;
    let most_rad = libm::acos(libm::cos(angle_rad) * libm::sqrt(1.0 - beside_ratio * beside_ratio));
    println!("{refused}: between {:.2} and {:.2} degrees", angle_rad.to_degrees(), most_rad.to_degrees());
    assert!(angle_deg > 60.0);
    assert!(angle_deg > angle_rad.to_degrees() - 0.05 && angle_deg < most_rad.to_degrees() + 0.05);
}
