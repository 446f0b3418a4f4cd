//! End of the stock for each movement: the faces as planes of the part, and the chip as the area that the shift of a
//! circle uncovers.

use arcfeed_law::{FeedLaw, Place, SegmentLaw};
use arcfeed_model::cut::{CutRule, Moves, RotationCircle, Work};
use arcfeed_model::job::{FeedPolicy, Job, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::knots::Knots;
use arcfeed_model::machine::MachineLimits;
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{self, Edge, Tool};
use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::frame::slot_frame;
use arcfeed_plan::geometry::blisk::Blank;
use arcfeed_plan::output::limits::{BlankFace, LimitError, StockLimit, stock_limits};
use arcfeed_plan::path::{Level, Purpose, SlotPath, Step};
use arcfeed_plan::vector::{Flat, Point, Vector};
use arcfeed_units::{LengthUnit, MmPerTooth, Nm, RevPerMin};

pub const CHIP_MM: f64 = 0.1016;
const OUTER_MM: f64 = 128.576_07;
const INNER_MM: f64 = 112.701_324;

pub fn mill() -> CupMill {
    CupMill {
        outer_radius_mm: OUTER_MM,
        inner_radius_mm: INNER_MM,
        insert_radius_mm: 0.8,
        cavity_depth_mm: 40.0,
        height_mm: 60.0,
        holder_mm: Vec::new(),
        active_teeth: 10,
    }
}

/// A blank whose faces lie 6 mm beyond both pivots at the path's middle, however the tool leans.
pub fn blank(lean_deg: f64) -> Blank {
    let (sin, cos) = libm::sincos(lean_deg.to_radians());
    Blank { radius_mm: 260.0, faces_mm: [184.0, 218.0].map(|y_mm| y_mm * cos + 195.0 * sin) }
}

/// The published base figures, mm, with turns of some degrees; in mirror image for a rotor of the other hand.
pub fn path(mirror: bool) -> SlotPath {
    let sign = if mirror { -1.0 } else { 1.0 };
    let flat = |x_in: f64, y_in: f64| Flat::new(sign * x_in * 25.4, y_in * 25.4);
    let (exterior, interior, base) = (flat(0.4354, 7.4854), flat(0.2495, 8.3369), flat(-3.6044, 10.5358));
    let turned = |center: Flat, angle_deg: f64| {
        center + nalgebra::Rotation2::new(-sign * angle_deg.to_radians()) * (base - center)
    };
    let level = |index: usize| Level {
        height_mm: 200.0 - 2.4 * index as f64,
        exterior_end: turned(exterior, 12.0 - index as f64),
        interior_end: turned(interior, 9.0 - index as f64),
    };
    let outward = if mirror { Turn::Ccw } else { Turn::Cw };
    SlotPath {
        exterior,
        interior,
        base,
        outward,
        levels: (0..6).map(level).collect(),
        clear_mm: 210.0,
        contact_mm: f64::MIN,
    }
}

/// A tool axis in the part frame that leans towards the rotor's.
pub fn leaning(lean_deg: f64) -> Vector {
    let (sin, cos) = libm::sincos(lean_deg.to_radians());
    Vector::new(cos, 0.0, sin)
}

fn limits(path: &SlotPath, lean_deg: f64) -> Vec<StockLimit> {
    stock_limits(path, &mill(), &blank(lean_deg), &leaning(lean_deg)).expect("limits")
}

#[test]
fn the_four_movements_cut_as_in_table_5_1_on_rotors_of_both_hands() {
    let table = [
        (1, RotationCircle::Interior, Edge::Outer, BlankFace::Lower),
        (2, RotationCircle::Exterior, Edge::Outer, BlankFace::Upper),
        (3, RotationCircle::Exterior, Edge::Inner, BlankFace::Upper),
        (4, RotationCircle::Interior, Edge::Inner, BlankFace::Lower),
    ];
    for mirror in [false, true] {
        let found = limits(&path(mirror), 0.0);
        for (limit, row) in found.iter().zip(table) {
            println!("{limit:.3?}");
            assert_eq!((limit.movement, limit.rotation, limit.edge, limit.face), row);
        }
        assert_eq!(found.len(), table.len());
    }
}

#[test]
fn lines_are_the_blanks_faces_wherever_the_tool_leans() {
    for lean_deg in [-12.0, 0.0, 7.5] {
        let axis = leaning(lean_deg);
        let to_part = slot_frame(&axis).expect("a frame").inverse();
        for limit in limits(&path(false), lean_deg) {
            let face_mm = blank(lean_deg).faces_mm[usize::from(limit.face == BlankFace::Upper)];
            for height_mm in [150.0, 187.3, 201.0] {
                let line = StockLine {
                    rise_ratio: limit.rise_ratio,
                    ..StockLine::from_angle(limit.normal_deg, limit.offset_mm)
                };
                let at = line.at_height(height_mm);
                let [x, y] = at.normal.map(|part| part * at.offset_mm);
                // The cutting plane lies the inserts' radius above the programmed height.
                let point = to_part * Point::new(x + 31.7, y, height_mm + 0.8);
                assert!((point.z - face_mm).abs() < 1e-9, "{lean_deg}: {point}");
            }
        }
    }
}

/// Distance that a shift of the centre by `delta` uncovers before a circle in direction `u`: along the ray from the old centre,
/// from the old circle to the new one.
fn laid_open_mm(u: [f64; 2], delta: [f64; 2], radius_mm: f64, edge: Edge) -> f64 {
    let along = u[0] * delta[0] + u[1] * delta[1];
    let across = u[0] * delta[1] - u[1] * delta[0];
    let reach_mm = along + libm::sqrt(radius_mm * radius_mm - across * across);
    f64::from(edge.advance()) * (reach_mm - radius_mm)
}

fn job(limit: &StockLimit) -> Job {
    let line = StockLine { rise_ratio: limit.rise_ratio, ..StockLine::from_angle(limit.normal_deg, limit.offset_mm) };
    let rule = CutRule {
        tool: 0,
        moves: Moves::Rotations(limit.rotation, limit.turn),
        work: Work::Ring(limit.edge, Stock::half_plane(line)),
        feed_per_tooth: None,
        table: None,
        sequence: None,
        level: None,
    };
    let [outer_radius, inner_radius] = [OUTER_MM, INNER_MM].map(Nm::from_mm);
    Job {
        unit: LengthUnit::Mm,
        tools: Tools::one(ToolSetup::new(
            Tool::CupMill(tool::CupMill { outer_radius, inner_radius, active_teeth: 10 }),
            RevPerMin(1_000.0),
            LawKind::Circumference,
            MmPerTooth(CHIP_MM as f32),
        )),
        ceiling: Default::default(),
        policy: FeedPolicy::SafeBase,
        limits: OverrideLimits::default(),
        machine: MachineLimits::default(),
        rules: [rule].into_iter().collect(),
        knots: Knots::new(),
    }
}

fn segment(step: &Step, center: Flat, turn: Turn) -> Segment {
    let pose = |place: [f64; 3]| Pose { linear: place.map(Nm::from_mm), ..Pose::default() };
    let arm = |place: [f64; 3]| [place[0] - center.x, place[1] - center.y].map(Nm::from_mm);
    let arc = Arc {
        plane: Plane::Xy,
        turn,
        center: [center.x, center.y].map(Nm::from_mm),
        from: arm(step.from),
        to: arm(step.to),
    };
    let (start, end) = (pose(step.from), pose(step.to));
    Segment { sequence: None, start, end, feed: Feed::Missing, path: Path::Arc(arc) }
}

/// Chips at the face of one movement with the law's feed: at the limit, and the thickest of both circles on either side of the pivot
/// that a scan over the stock between the faces finds.
fn chips(limit: &StockLimit, step: &Step, lean_deg: f64) -> Vec<[f64; 2]> {
    let (center, turn) = step.about.expect("an arc");
    let (segment, job) = (segment(step, center, turn), job(limit));
    let law = SegmentLaw::for_segment(&segment, job.rules.first(), &job);
    let to_part = slot_frame(&leaning(lean_deg)).expect("a frame").inverse();
    let [low_mm, high_mm] = blank(lean_deg).faces_mm;
    let sign = f64::from(turn.sign());
    let arm = Flat::new(step.from[0], step.from[1]) - center;
    let radius_mm = arm.norm();
    (0..=8)
        .map(|part| {
            let toward = nalgebra::Rotation2::new(sign * step.sweep_rad() * f64::from(part) / 8.0) * arm / radius_mm;
            let place = Place::on_arc([toward.x as f32, toward.y as f32], sign as f32, radius_mm as f32, 0.0);
            let demand = law.demand(&place).expect("a demand");
            let angle_rad = sign * f64::from(demand.path_mm_per_tooth) / radius_mm;
            let at = center + toward * radius_mm;
            let next = center + nalgebra::Rotation2::new(angle_rad) * toward * radius_mm;
            let delta = [next.x - at.x, next.y - at.y];
            let mut found = [0.0_f64; 2];
            for (edge, circle_mm) in [(Edge::Outer, OUTER_MM), (Edge::Inner, INNER_MM)] {
                for angle in 0..18_000 {
                    let (sin, cos) = libm::sincos(f64::from(angle) * 2e-2_f64.to_radians());
                    let point =
                        to_part * Point::new(at.x + circle_mm * cos, at.y + circle_mm * sin, step.from[2] + 0.8);
                    // The ring meets the blank's planes again further round, where there is no blank.
                    let is_near = cos * -toward.x + sin * -toward.y > 0.7;
                    if is_near && (low_mm..=high_mm).contains(&point.z) {
                        let chip = laid_open_mm([cos, sin], delta, circle_mm, edge) / CHIP_MM;
                        found[usize::from(edge != limit.edge)] = found[usize::from(edge != limit.edge)].max(chip);
                    }
                }
            }
            found
        })
        .collect()
}

#[test]
fn the_thickest_chip_anywhere_between_the_faces_is_the_wanted_one() {
    for (mirror, lean_deg) in [(false, 0.0), (false, 9.0), (true, -9.0)] {
        let path = path(mirror);
        for limit in limits(&path, lean_deg) {
            let mut steps = path.steps();
            // But for the way back and up.
            steps.truncate(steps.len() - 2);
            let own = |step: &&Step| step.purpose.movement() == Some(limit.movement);
            let all: Vec<[f64; 2]> = steps.iter().filter(own).flat_map(|step| chips(&limit, step, lean_deg)).collect();
            let [least, most] =
                [f64::min, f64::max].map(|pick| all.iter().map(|chip| chip[0]).reduce(pick).expect("chips"));
            let other = all.iter().map(|chip| chip[1]).fold(0.0, f64::max);
            println!(
                "lean {lean_deg}, movement {}: {least:.5} to {most:.5} of the wanted chip, other circle {other:.3}",
                limit.movement
            );
            // The scan's directions stand a fiftieth of a degree apart: 2e-3 of the chip at 10 degrees.
            assert!(least > 0.998 * limit.kept_ratio && most > 0.998 && most < 1.000_01, "{limit:?}");
            assert!(other < limit.elsewhere_ratio + 1e-3, "{other}: {limit:?}");
            assert!(limit.kept_ratio < 1.0 || other > 0.98 * limit.elsewhere_ratio, "{other}: {limit:?}");
        }
    }
}

#[test]
fn levels_end_before_the_arc_that_goes_back_through_what_is_cut() {
    let path = path(false);
    let found = limits(&path, 0.0);
    let last = path.levels.last().expect("levels").height_mm;
    let third = found.iter().find(|limit| limit.movement == 3).expect("movement 3");
    assert!(third.heights_mm[0] > last + 1.0, "{third:?}");
    let steps = path.steps();
    let back = steps.iter().rfind(|step| step.about.is_some()).expect("an arc");
    assert_eq!((back.purpose, back.from[2]), (Purpose::Movement3, last));
}

#[test]
fn a_tool_along_the_rotor_has_no_face() {
    assert_eq!(stock_limits(&path(false), &mill(), &blank(0.0), &Vector::z()), Err(LimitError::AlongRotor));
    let narrow = Blank { faces_mm: [-10.0, -5.0], ..blank(0.0) };
    assert!(matches!(stock_limits(&path(false), &mill(), &narrow, &leaning(0.0)), Err(LimitError::NoContact(_))));
}
