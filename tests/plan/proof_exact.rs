//! Clearances of bodies whose distance is known in closed form.

use core::f64::consts::PI;

use arcfeed_plan::cutter::ToolPart;
use arcfeed_plan::geometry::blisk::Revolution;
use arcfeed_plan::geometry::mesh::Triangle;
use arcfeed_plan::path::Step;
use arcfeed_plan::proof::bodies::{cuboid, revolved};
use arcfeed_plan::proof::clearance::{Body, clearance};
use arcfeed_plan::vector::{Point, Vector};

use crate::proof_cases::{GAP_MM, arc, body, least, published_tool, step};

const CHORD_MM: f64 = 0.002;

/// A surface of revolution about an upright line.
fn standing(profile_mm: Vec<[f64; 2]>, [x, y]: [f64; 2]) -> Vec<Triangle> {
    let faces_mm = [profile_mm[0][0], profile_mm[profile_mm.len() - 1][0]];
    let triangles = revolved(&Revolution { profile_mm }, faces_mm, CHORD_MM);
    triangles.into_iter().map(|corners| corners.map(|corner| corner + Vector::new(x, y, 0.0))).collect()
}

/// A sphere: half a polygon, turned; both are within the chord error inside of it.
fn sphere(radius_mm: f64, centre: Point) -> Body {
    let pieces = (PI / libm::acos(1.0 - CHORD_MM / radius_mm)).ceil() as u32;
    let at = |k: u32| PI * f64::from(k) / f64::from(pieces);
    let place = |k: u32| [centre.z - radius_mm * libm::cos(at(k)), radius_mm * libm::sin(at(k))];
    body(standing((0..=pieces).map(place).collect(), [centre.x, centre.y]), 2.0 * CHORD_MM)
}

fn cylinder(radius_mm: f64, place: [f64; 2], heights_mm: [f64; 2]) -> Body {
    body(standing(heights_mm.map(|height_mm| [height_mm, radius_mm]).to_vec(), place), CHORD_MM)
}

#[track_caller]
fn assert_holds(part: ToolPart, steps: &[Step], body: &Body, exact_mm: f64) {
    let found = least(&published_tool(), part, steps, body);
    let [low_mm, high_mm] = found.bounds_mm;
    println!("{part:?}: {exact_mm:.6} in {low_mm:.6} .. {high_mm:.6} mm, {} pieces", found.pieces);
    assert!((low_mm..=high_mm).contains(&exact_mm), "{exact_mm} {found:?}");
}

#[test]
fn a_sphere_beside_the_ring() {
    // The tool turns about the origin, 120 mm off; the sphere lies beyond its arc, and is nearest where both are in one direction.
    let tool = published_tool();
    for (angle_deg, height_mm) in [(20.0, 10.0), (75.0, 20.0), (33.3, 1.0)] {
        let (sin, cos) = libm::sincos(f64::to_radians(angle_deg));
        let centre = Point::new(270.0 * cos, 270.0 * sin, height_mm);
        let exact_mm = tool.distance_of_mm(ToolPart::Ring, 150.0, height_mm) - 7.0;
        assert_holds(ToolPart::Ring, &[arc(120.0, 0.0, [10.0, 80.0])], &sphere(7.0, centre), exact_mm);
    }
}

#[test]
fn a_sphere_under_the_rounded_corner() {
    let tool = published_tool();
    let way = [step([-50.0, 0.0, 5.0], [40.0, 0.0, 5.0], None)];
    let exact_mm = tool.distance_of_mm(ToolPart::Ring, 130.0, -7.0) - 2.0;
    assert_holds(ToolPart::Ring, &way, &sphere(2.0, Point::new(0.0, 130.0, -2.0)), exact_mm);
}

#[test]
fn a_pin_inside_the_cup() {
    // The farther the tool's axis from the pin, the nearer the ring: at the end of the arc.
    let at = Point::new(80.0, 0.0, 0.0);
    let far_mm = libm::hypot(80.0 - 120.0 * libm::cos(PI / 3.0), 120.0 * libm::sin(PI / 3.0));
    let pin = cylinder(5.0, [at.x, at.y], [-20.0, 30.0]);
    assert_holds(ToolPart::Ring, &[arc(120.0, 0.0, [0.0, 60.0])], &pin, 112.702 - far_mm - 5.0);
    // Top of the tool and body: the tool's height is constant.
    assert_holds(ToolPart::Body, &[arc(120.0, 0.0, [0.0, 60.0])], &pin, 30.0);
}

#[test]
fn a_pin_that_the_tool_turns_about_is_as_near_all_along() {
    let pin = cylinder(5.0, [0.0, 0.0], [-20.0, 30.0]);
    assert_holds(ToolPart::Ring, &[arc(140.0, 0.0, [0.0, 60.0])], &pin, 140.0 - 128.576 - 5.0);
    assert_holds(ToolPart::Ring, &[arc(100.0, 0.0, [0.0, -60.0])], &pin, 112.702 - 100.0 - 5.0);
}

#[test]
fn a_plate_below_and_a_wall_beside_are_known_to_the_gap() {
    let plate = body(cuboid(&[Point::new(-500.0, -500.0, -30.0), Point::new(500.0, 500.0, -20.0)]), 0.0);
    let way = [step([0.0, 0.0, 80.0], [10.0, -30.0, 3.0], None), arc(60.0, 4.0, [0.0, 90.0])];
    assert_holds(ToolPart::Ring, &way, &plate, 23.0);
    assert_holds(ToolPart::Body, &way, &plate, 83.0);
    assert_holds(ToolPart::Holder, &way, &plate, 113.0);
    let wall = body(cuboid(&[Point::new(200.0, -500.0, -30.0), Point::new(210.0, 500.0, 300.0)]), 0.0);
    assert_holds(ToolPart::Ring, &way, &wall, 200.0 - 60.0 - 128.576);
    assert_holds(ToolPart::Holder, &way, &wall, 200.0 - 60.0 - 80.0);
}

#[test]
fn a_collision_is_as_deep_as_the_deepest_point_of_the_surface_in_the_tool() {
    // The wall's inner face stands 2 mm inside the outer circle where the tool is farthest.
    let wall = body(cuboid(&[Point::new(186.576, -500.0, -30.0), Point::new(210.0, 500.0, 300.0)]), 0.0);
    assert_holds(ToolPart::Ring, &[arc(60.0, 4.0, [-10.0, 90.0])], &wall, -2.0);
    // A thin pin in the middle of the ring's wall cannot be deeper than half the wall.
    let pin = cylinder(0.5, [120.639, 0.0], [-20.0, 30.0]);
    assert_holds(ToolPart::Ring, &[step([0.0; 3], [10.0, 0.0, 0.0], None)], &pin, -(128.576 - 112.702) / 2.0);
}

#[test]
fn nothing_is_infinitely_far() {
    let way = [arc(60.0, 4.0, [0.0, 90.0])];
    let found = clearance(&published_tool(), ToolPart::Ring, &way, &body(Vec::new(), 0.0), GAP_MM);
    assert_eq!((found.bounds_mm, found.place), ([f64::INFINITY; 2], None));
}
