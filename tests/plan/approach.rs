//! Where the programs of planned slots move faster than `axial_feed`, the ring is outside of the blank or in a place that it has cut already. The
//! program is read by its words, and the blank is a radius and two faces.

use arcfeed_plan::cup_mill::plan::{AxisChoice, Roughing, SlotPlan, plan};
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::geometry::blisk::{Blank, Blisk};
use arcfeed_plan::output::nc::{Feeds, Indexing, Setup, write};
use arcfeed_plan::vector::Point;
use arcfeed_units::LengthUnit;

use crate::plunge::command::words;
use crate::proof_cases::published_tool;
use crate::proof_published::ROUGHING;
use crate::published_rotor::blisk;

const APPROACH: f64 = 1_270.0;
const AXIAL: f64 = 50.8;
/// Distance from the blank that a rapid or an approach keeps, mm.
const NEAR_MM: f64 = 1.9;

fn setup() -> Setup {
    Setup {
        number: 1,
        title: Vec::new(),
        unit: LengthUnit::Mm,
        tool: 1,
        rev_per_min: 100.0,
        coolant: true,
        tilt_deg: 0.0,
        slots_deg: vec![0.0, 20.0],
        feeds: Feeds {
            cutting_mm_per_min: 101.6,
            approach_mm_per_min: Some(APPROACH),
            axial_mm_per_min: Some(AXIAL),
            indexing_per_min: 50.0,
        },
        indexing: Indexing::AtClearance,
        labels: false,
        reports: false,
    }
}

/// Upright moves of a program: place X and Y, heights from and to, and the feed, infinite for a rapid.
fn upright(program: &str) -> Vec<([f64; 2], [f64; 2], f64)> {
    let (mut at, mut feed, mut is_rapid, mut moves) = ([f64::NAN; 3], f64::NAN, false, Vec::new());
    for line in program.lines().take_while(|line| !line.contains("G91")).filter(|line| line.starts_with('N')) {
        let before = at;
        for (letter, number) in words(line) {
            match (letter, "XYZ".find(letter)) {
                (_, Some(axis)) => at[axis] = number,
                ('G', _) if number < 4.0 => is_rapid = number == 0.0,
                ('F', _) => feed = number,
                _ => {}
            }
        }
        if at[2] != before[2] && !before[2].is_nan() && at[..2] == before[..2] {
            moves.push(([at[0], at[1]], [before[2], at[2]], if is_rapid { f64::INFINITY } else { feed }));
        }
    }
    moves
}

/// Points of the ring at the lowest place of its inserts and on its walls, for a place of its axis.
fn ring(tool: &CupMill, [x, y]: [f64; 2], bottom_mm: f64) -> impl Iterator<Item = Point> {
    let radii =
        (0..=8).map(|k| tool.inner_radius_mm + (tool.outer_radius_mm - tool.inner_radius_mm) * f64::from(k) / 8.0);
    let circle = move |radius_mm: f64| {
        (0..720).map(move |k| {
            let (sin, cos) = libm::sincos(f64::from(k) * core::f64::consts::TAU / 720.0);
            [x + radius_mm * cos, y + radius_mm * sin]
        })
    };
    radii.flat_map(circle).flat_map(move |[x, y]| [0.0, 10.0, 20.0, 30.0].map(|up| Point::new(x, y, bottom_mm + up)))
}

/// Least distance of points from the blank, seen along its radius and its axis; not positive inside.
fn gap_mm(blank: &Blank, points: impl Iterator<Item = Point>) -> f64 {
    let of = |point: Point| {
        let radial_mm = libm::hypot(point.x, point.y) - blank.radius_mm;
        let axial_mm = (blank.faces_mm[0] - point.z).max(point.z - blank.faces_mm[1]);
        radial_mm.max(axial_mm)
    };
    points.map(of).fold(f64::INFINITY, f64::min)
}

fn assert_slow_in_the_blank(name: &str, blisk: &Blisk, tool: &CupMill, planned: &SlotPlan) {
    let moves = upright(&write(&planned.path, &setup()).expect("a program"));
    let to_part = planned.turn.inverse();
    let least_mm = |place: [f64; 2], bottom_mm: f64| {
        gap_mm(&blisk.blank, ring(tool, place, bottom_mm).map(|point| to_part * point))
    };
    let lowest_mm = planned.path.levels.last().expect("levels").height_mm;
    let downs = moves.iter().filter(|(_, [from, to], _)| to < from);
    let (mut fast, mut slow) = (Vec::new(), Vec::new());
    for (place, [_, to_mm], feed) in downs {
        (if *feed > AXIAL { &mut fast } else { &mut slow }).push(least_mm(*place, *to_mm));
    }
    println!("{name}: fast ways down end {fast:.3?} mm from the blank, slow ones {slow:.3?}");
    assert_eq!(fast.len(), 2, "one in each slot");
    assert!(fast.iter().all(|gap_mm| (NEAR_MM..6.0).contains(gap_mm)), "{name}: {fast:?}");
    assert!(slow[0] < 0.0, "{name}: the first level is in the blank");
    // On its way up the ring is in the place that it has cut on the lowest level.
    for (place, [from_mm, to_mm], _) in moves.iter().filter(|(_, [from, to], _)| to > from) {
        let base = planned.path.base;
        assert!(libm::hypot(place[0] - base.x, place[1] - base.y) < 2e-3 && (from_mm - lowest_mm).abs() < 2e-3);
        assert!(planned.path.contact_mm - from_mm < tool.cavity_depth_mm && *to_mm > planned.path.contact_mm);
    }
}

#[test]
fn ways_down_are_slow_within_the_blank() {
    let tool = published_tool();
    for (name, axis) in [("roomiest", AxisChoice::Roomiest), ("blade", AxisChoice::Blade)] {
        let roughing = Roughing { axis, ..ROUGHING };
        let blisk = blisk();
        let planned = plan(&blisk, &blisk.slot(), &tool, &roughing).expect("a plan");
        assert_slow_in_the_blank(name, &blisk, &tool, &planned);
        assert!(planned.path.contact_mm > planned.path.levels[0].height_mm + 0.3, "{name}");
    }
}
