//! The engaged-arc law of an end mill, as a job's rule and segment make it, against closed forms.
//!
//! After one tooth the circle passes through C, at r0 + a from the old centre O in the direction of the end of the engaged arc
//! that is nearest straight ahead. The new centre O' lies on the path, r0 from C: on a line by a quadratic, on an arc by the
//! law of cosines in the triangle of C, O' and the rotation centre. To first order the path is a / sin(angle from the side).

use arcfeed_law::move_table::MoveTable;
use arcfeed_law::{FeedLaw, NoDemand, Place, SegmentLaw};
use arcfeed_model::cut::{CutRule, Moves, Work};
use arcfeed_model::engaged::{EngagedInterval, EngagedKnot, EngagedTable};
use arcfeed_model::job::{FeedPolicy, Job, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::knots::Knots;
use arcfeed_model::machine::MachineLimits;
use arcfeed_model::stock::Stock;
use arcfeed_model::tool::{CupMill, Edge, EndMill, Tool};
use arcfeed_nc::modal::{Center, Feed, Motion, MotionKind, Plane, Pose, Turn};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{LengthUnit, Mm, MmPerTooth, Nm, RevPerMin};

const TOOL_RADIUS_MM: f64 = 6.0;
const CHIP_MM: f32 = 0.08;
const PATH_RADII_MM: [f64; 3] = [4.0, 15.0, 200.0];
/// Half a unit in the last place of f32, relative, and how many may add up along the law's formulas.
const HALF_ULP: f64 = 1.0 / (1 << 24) as f64;
const ROUNDINGS: f64 = 12.0;

fn job(tool: Tool, stock: Stock, both_edges: bool, chip_mm: f32) -> Job {
    let work = Work::Ring(Edge::Outer, stock);
    let rule =
        CutRule { tool: 0, moves: Moves::Lines, work, feed_per_tooth: None, table: None, sequence: None, level: None };
    Job {
        unit: LengthUnit::Mm,
        tools: Tools::one(ToolSetup::new(
            tool,
            RevPerMin(8_000.0),
            LawKind::EngagedArc { both_edges },
            MmPerTooth(chip_mm),
        )),
        ceiling: Default::default(),
        policy: FeedPolicy::SafeBase,
        limits: OverrideLimits::default(),
        machine: MachineLimits::default(),
        rules: [rule].into_iter().collect(),
        knots: Knots::new(),
    }
}

fn end_mill() -> Tool {
    Tool::EndMill(EndMill { radius: Nm::from_mm(TOOL_RADIUS_MM), teeth: 3 })
}

fn interval([from, to]: [f64; 2]) -> EngagedInterval {
    EngagedInterval::from_degrees(from, to).expect("an arc")
}

/// One engaged arc for the outer circle, all round for the inner one, which an end mill has not.
fn knot(travelled_mm: f32, outer: [f64; 2]) -> EngagedKnot {
    EngagedKnot { travelled: Mm(travelled_mm), outer: interval(outer), inner: interval([0.0, 360.0]) }
}

fn table(outer: [f64; 2]) -> EngagedTable {
    EngagedTable::new(&[knot(0.0, outer)]).expect("a table")
}

fn segment(kind: MotionKind, [x, y]: [f64; 2], center: [f64; 2]) -> Segment {
    let start = Pose { linear: [12.5, -3.0, 1.0].map(Nm::from_mm), ..Pose::default() };
    let end = Pose { linear: [12.5 + x, -3.0 + y, 1.0].map(Nm::from_mm), ..start };
    let [i, j] = center.map(Nm::from_mm);
    let center = Center::Offset([i, j, Nm(0)]);
    let feed = Feed::PerMinute(Nm::from_mm(500.0));
    let motion = Motion { kind, plane: Plane::Xy, start, end, center, feed };
    Segment::from_motion(&motion, None).expect("a segment")
}

fn line() -> Segment {
    segment(MotionKind::Line, [30.0, 40.0], [0.0, 0.0])
}

/// Half a turn that begins at the right of its centre.
fn arc(turn: Turn, radius_mm: f64) -> Segment {
    segment(MotionKind::Arc(turn), [-2.0 * radius_mm, 0.0], [-radius_mm, 0.0])
}

fn place(segment: &Segment, travelled_mm: f32) -> Place {
    let Path::Arc(arc) = &segment.path else { return Place::on_line([0.6, 0.8], travelled_mm) };
    let radius_mm = arc.radius_mm() as f32;
    let ratio = f64::from(travelled_mm) / (core::f64::consts::PI * arc.radius_mm());
    Place::on_arc(arc.direction_at(ratio).map(|x| x as f32), f32::from(arc.turn.sign()), radius_mm, travelled_mm)
}

/// Path per tooth; the same with the table in the rule or with the segment, and with any setting of `edges`.
fn path_mm(segment: &Segment, table: &EngagedTable, travelled_mm: f32) -> Result<f64, NoDemand> {
    path_of_chip_mm(segment, table, travelled_mm, CHIP_MM)
}

fn path_of_chip_mm(segment: &Segment, table: &EngagedTable, travelled_mm: f32, chip: f32) -> Result<f64, NoDemand> {
    let place = place(segment, travelled_mm);
    let mut found = Vec::new();
    for both_edges in [false, true] {
        let in_rule = job(end_mill(), Stock::Engaged(table.clone()), both_edges, chip);
        let along = job(end_mill(), Stock::PerMove, both_edges, chip);
        found.push(SegmentLaw::for_segment(segment, in_rule.rules.first(), &in_rule).demand(&place));
        let sent = MoveTable::Engaged(table.clone());
        found.push(SegmentLaw::with_table(segment, Some(&along.rules[0]), Some(&sent), &along).demand(&place));
    }
    assert!(found.iter().all(|demand| *demand == found[0]), "{found:?}");
    found[0].map(|demand| f64::from(demand.path_mm_per_tooth))
}

/// The path to O' on a line.
fn on_line_mm(degrees: f64, chip_mm: f64) -> f64 {
    let along = (TOOL_RADIUS_MM + chip_mm) * libm::sin(degrees.to_radians());
    along - libm::sqrt(along * along - chip_mm * (2.0 * TOOL_RADIUS_MM + chip_mm))
}

/// The path to O' on an arc.
fn on_arc_mm(degrees: f64, chip_mm: f64, path_radius_mm: f64) -> f64 {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let (reach, rho) = (TOOL_RADIUS_MM + chip_mm, path_radius_mm);
    // C seen from the rotation centre: along the motion, and towards the old centre.
    let (ahead, back) = (reach * sin, rho - reach * cos);
    let distance = libm::hypot(ahead, back);
    let cosine = (distance * distance + rho * rho - TOOL_RADIUS_MM * TOOL_RADIUS_MM) / (2.0 * distance * rho);
    rho * (libm::atan2(ahead, back) - libm::acos(cosine))
}

/// Compares with a tolerance for f32: the step follows the sine of the angle, so the error grows for flat chips.
fn assert_near(found: Result<f64, NoDemand>, expected_mm: f64, degrees: f64, what: &str) {
    let found = found.unwrap_or_else(|why| panic!("{what} at {degrees}: {why:?}"));
    let slope = libm::fabs(1.0 / libm::tan(degrees.to_radians()));
    let off = libm::fabs(found / expected_mm - 1.0);
    assert!(off <= ROUNDINGS * HALF_ULP * (1.0 + slope) * (1.0 + slope), "{what} at {degrees}: {found}, {expected_mm}");
}

#[test]
fn on_a_line_the_end_nearest_straight_ahead_decides_on_either_side() {
    for degrees in (20..90).map(f64::from) {
        let expected_mm = on_line_mm(degrees, f64::from(CHIP_MM));
        for outer in [[0.0, degrees], [-90.0, degrees], [180.0 - degrees, 180.0], [-180.0 - degrees, -90.0]] {
            assert_near(path_mm(&line(), &table(outer), 7.0), expected_mm, degrees, &format!("{outer:?}"));
        }
    }
}

#[test]
fn to_first_order_the_path_times_the_sine_is_the_chip() {
    let chip_mm = 0.004;
    for degrees in (20..90).map(f64::from) {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        let path_mm = path_of_chip_mm(&line(), &table([0.0, degrees]), 0.0, chip_mm).expect("a demand");
        let off = path_mm * sin / f64::from(chip_mm) - 1.0;
        // The next term of the quadratic's root, and what rounding leaves at 90 degrees.
        let next = f64::from(chip_mm) / (2.0 * TOOL_RADIUS_MM) * (cos / sin) * (cos / sin);
        assert!(libm::fabs(off - next) <= 0.01 * next + ROUNDINGS * HALF_ULP, "{degrees}: {off:e}, {next:e}");
    }
}

#[test]
fn on_arcs_of_either_sense_the_angle_counts_from_the_rotation_centre() {
    for (turn, radius_mm) in
        [Turn::Cw, Turn::Ccw].into_iter().flat_map(|turn| PATH_RADII_MM.map(|radius| (turn, radius)))
    {
        let arc = arc(turn, radius_mm);
        for degrees in (25..90).chain(91..155).map(f64::from) {
            let outer = if degrees < 90.0 { [degrees - 40.0, degrees] } else { [degrees, degrees + 40.0] };
            let expected_mm = on_arc_mm(degrees, f64::from(CHIP_MM), radius_mm);
            let found = path_mm(&arc, &table(outer), 3.0);
            assert_near(found, expected_mm, degrees, &format!("{turn:?} {radius_mm}"));
        }
    }
}

#[test]
fn where_straight_ahead_is_engaged_the_chord_is_the_chip() {
    let chip_mm = f64::from(CHIP_MM);
    for outer in [[0.0, 90.0], [0.0, 180.0], [90.0, 120.0], [-300.0, -200.0], [-360.0, 0.0]] {
        assert_near(path_mm(&line(), &table(outer), 1.0), chip_mm, 90.0, "line");
        for radius_mm in PATH_RADII_MM {
            let expected_mm = 2.0 * radius_mm * libm::asin(chip_mm / (2.0 * radius_mm));
            for turn in [Turn::Cw, Turn::Ccw] {
                assert_near(path_mm(&arc(turn, radius_mm), &table(outer), 1.0), expected_mm, 90.0, "arc");
            }
        }
    }
}

#[test]
fn between_knots_the_end_goes_with_the_path_travelled() {
    let table = EngagedTable::new(&[knot(0.0, [0.0, 30.0]), knot(20.0, [0.0, 70.0])]).expect("a table");
    for travelled_mm in [0.0, 2.5, 10.0, 17.5, 20.0, 45.0] {
        let degrees = 30.0 + 2.0 * f64::min(travelled_mm, 20.0);
        let found = path_mm(&line(), &table, travelled_mm as f32);
        assert_near(found, on_line_mm(degrees, f64::from(CHIP_MM)), degrees, "line");
        let found = path_mm(&arc(Turn::Cw, 15.0), &table, travelled_mm as f32);
        assert_near(found, on_arc_mm(degrees, f64::from(CHIP_MM), 15.0), degrees, "arc");
    }
}

#[test]
fn directions_without_a_demand_give_their_reason() {
    // The chip at 5 degrees is thinner than wanted at any feed: (r0 + a) sin 5 is less than the half chord of both circles.
    for (outer, why) in [
        ([0.0, 0.0], NoDemand::NoContact),
        ([40.0, 20.0], NoDemand::NoContact),
        ([0.0, 5.0], NoDemand::ChipUnreachable),
        ([190.0, 350.0], NoDemand::OutsideValidity),
    ] {
        assert_eq!(path_mm(&line(), &table(outer), 0.0), Err(why), "{outer:?}");
    }
}

#[test]
fn without_a_table_and_for_a_ring_on_a_line_there_is_no_law() {
    let (line, engagement) = (line(), MoveTable::Engaged(table([0.0, 60.0])));
    let along = job(end_mill(), Stock::PerMove, true, CHIP_MM);
    let ring =
        Tool::CupMill(CupMill { outer_radius: Nm::from_mm(60.0), inner_radius: Nm::from_mm(50.0), active_teeth: 8 });
    let ring = job(ring, Stock::PerMove, true, CHIP_MM);
    assert_eq!(SegmentLaw::for_segment(&line, along.rules.first(), &along), SegmentLaw::Programmed);
    assert_eq!(SegmentLaw::with_table(&line, Some(&ring.rules[0]), Some(&engagement), &ring), SegmentLaw::Programmed);
}
