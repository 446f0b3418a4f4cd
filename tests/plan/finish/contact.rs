//! Contact frame and cutter location, against the paper's printed points and the equations of ball and torus.

use arcfeed_plan::finish::contact::{Contact, Displacement, Orientation, displaced};
use arcfeed_plan::finish::mill::FinishMill;
use arcfeed_plan::vector::{Point, Vector};
use arcfeed_tests::root;

use crate::published_rotor;

fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

fn any_vector(state: &mut u64) -> Vector {
    Vector::new(random(state) - 0.5, random(state) - 0.5, random(state) - 0.5)
}

pub fn mill(radius_mm: f64, corner_radius_mm: f64) -> FinishMill {
    FinishMill { radius_mm, corner_radius_mm, length_mm: 20.0, neck_mm: Vec::new(), holder_mm: Vec::new(), teeth: 2 }
}

/// Printed tips and axes of a strategy.
fn printed(strategy: f64) -> Vec<[f64; 6]> {
    let text = std::fs::read_to_string(root().join("tests/cases/tournier-ikt/pairs.csv")).expect("the case");
    let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let numbers = rows.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>());
    numbers.filter(|row| row[0] == strategy).map(|row| [row[2], row[3], row[4], row[5], row[6], row[7]]).collect()
}

#[test]
fn the_tilt_of_the_papers_strategy_2_leans_forward_by_5_degrees() {
    // Strategy 1 has no tilt: its axes are normals, and i = k j^2 on them. Both paths run towards growing y.
    let normals = printed(1.0);
    let bends: Vec<f64> = normals.iter().filter(|row| row[4].abs() > 0.01).map(|row| row[3] / row[4].powi(2)).collect();
    let bend = bends.iter().sum::<f64>() / bends.len() as f64;
    assert!(bends.iter().all(|each| (each - bend).abs() < 0.01 * bend), "{bends:?}");
    let rows = printed(2.0);
    assert!(rows.windows(2).all(|pair| pair[1][1] > pair[0][1]));
    let mut worst = 0.0_f64;
    for [_, _, _, i, j, k] in rows {
        // The tilt turns the axis in the plane of the feed direction, across which i lies: i stays that of the normal.
        let of_normal = -libm::sqrt(i / bend);
        let normal = Vector::new(i, of_normal, libm::sqrt(1.0 - of_normal * of_normal - i * i));
        let contact = Contact::new(Point::origin(), &normal, &Vector::y()).unwrap();
        let found = contact.orientation(&Vector::new(i, j, k).normalize());
        let forward = found.tilt_rad.to_degrees() * libm::copysign(1.0, libm::cos(found.yaw_rad));
        println!("tilt {forward:.3} degrees towards the feed direction");
        worst = worst.max((forward - 5.0).abs());
        let again = contact.axis(&Orientation { tilt_rad: 5.0_f64.to_radians(), yaw_rad: 0.0 });
        assert!((again - Vector::new(i, j, k)).norm() < 0.002, "{again}");
    }
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn tilt_and_yaw_are_found_again_from_the_axis() {
    let mut state = 5;
    for _ in 0..2_000 {
        let Some(contact) = Contact::new(Point::origin(), &any_vector(&mut state), &any_vector(&mut state)) else {
            continue;
        };
        assert!(contact.normal.dot(&contact.feed).abs() < 1e-12 && (contact.feed.norm() - 1.0).abs() < 1e-12);
        let given = Orientation { tilt_rad: 0.01 + 1.5 * random(&mut state), yaw_rad: 6.0 * random(&mut state) - 3.0 };
        let axis = contact.axis(&given);
        // Both angles by their meaning: from the normal, and of the projection from the feed direction.
        assert!((axis.angle(&contact.normal) - given.tilt_rad).abs() < 1e-9);
        let flat = axis - contact.normal * axis.dot(&contact.normal);
        let turned = libm::atan2(contact.feed.cross(&flat).dot(&contact.normal), flat.dot(&contact.feed));
        assert!((turned - given.yaw_rad).abs() < 1e-9);
        let found = contact.orientation(&axis);
        assert!((found.tilt_rad - given.tilt_rad).abs() < 1e-9 && (found.yaw_rad - given.yaw_rad).abs() < 1e-9);
    }
    assert_eq!(Contact::new(Point::origin(), &Vector::z(), &Vector::z()), None);
    assert_eq!(Contact::new(Point::origin(), &Vector::zeros(), &Vector::x()), None);
}

/// Left side of the equation of a torus, and its gradient, about the tip `at` with the axis `axis`.
fn torus(mill: &FinishMill, at: &Point, axis: &Vector, place: &Point) -> (f64, Vector) {
    let off = place - (at + axis * mill.corner_radius_mm);
    let up = off.dot(axis);
    let across = off - axis * up;
    let major = mill.radius_mm - mill.corner_radius_mm;
    let out = across.norm() - major;
    let gradient = across.try_normalize(0.0).unwrap_or_else(Vector::zeros) * out + axis * up;
    (out * out + up * up - mill.corner_radius_mm * mill.corner_radius_mm, gradient.normalize())
}

#[test]
fn ball_and_torus_touch_the_contact_with_the_normal_of_the_surface() {
    let (mut state, mut worst) = (11, 0.0_f64);
    for _ in 0..5_000 {
        let radius_mm = 0.5 + 9.5 * random(&mut state);
        let tool =
            mill(radius_mm, radius_mm * if random(&mut state) < 0.3 { 1.0 } else { 0.05 + 0.9 * random(&mut state) });
        let point = Point::from(any_vector(&mut state) * 100.0);
        let Some(contact) = Contact::new(point, &any_vector(&mut state), &any_vector(&mut state)) else { continue };
        let tilt_rad = 0.02 + 1.4 * random(&mut state);
        let axis = contact.axis(&Orientation { tilt_rad, yaw_rad: 6.0 * random(&mut state) });
        let location = tool.at(&contact, axis);
        let (value, gradient) = torus(&tool, &location.tip, &axis, &contact.point);
        worst = worst.max(value.abs()).max((gradient + contact.normal).norm());
        // The mill's lower half touches, not its flank.
        assert!((contact.point - location.tip).dot(&axis) <= tool.corner_radius_mm + 1e-9);
    }
    println!("off the torus and its normal by {worst:.1e}");
    assert!(worst < 1e-9);
}

#[test]
fn without_a_tilt_a_filleted_mill_touches_at_the_front_as_with_a_small_one() {
    let tool = mill(5.0, 1.0);
    let contact = Contact::new(Point::new(1.0, 2.0, 3.0), &Vector::z(), &Vector::x()).unwrap();
    let at = |tilt_rad: f64| tool.at(&contact, contact.axis(&Orientation { tilt_rad, yaw_rad: 0.0 })).tip;
    assert!((at(0.0) - Point::new(-3.0, 2.0, 3.0)).norm() < 1e-12);
    assert!((at(0.0) - at(1e-7)).norm() < 1e-6);
}

#[test]
fn the_normal_of_a_displaced_surface_is_that_of_its_differences() {
    let blisk = published_rotor::blisk();
    let (mut worst, mut leaning) = (0.0_f64, 0.0_f64);
    for face in [&blisk.pressure, &blisk.suction] {
        let depth = |u: f64, v: f64| 0.4 + 0.3 * libm::sin(3.0 * u) * v - 0.2 * v * v;
        let at = |u: f64, v: f64| {
            let by_u = 0.9 * libm::cos(3.0 * u) * v;
            let by_v = 0.3 * libm::sin(3.0 * u) - 0.4 * v;
            displaced(face, u, v, &Displacement { outward_mm: depth(u, v), by_u, by_v })
        };
        for place in (1..400).map(|k| f64::from(k) / 400.0) {
            let (u, v) = (0.1 + 0.8 * place, (place * 7.0).fract() * 0.9 + 0.05);
            let h = 1e-5;
            let difference = |du: f64, dv: f64| at(u + du, v + dv).0 - at(u - du, v - dv).0;
            let measured = difference(h, 0.0).cross(&difference(0.0, h)).normalize();
            let (point, normal) = at(u, v);
            let measured = measured * libm::copysign(1.0, measured.dot(&face.normal(u, v)));
            worst = worst.max((normal - measured).norm());
            leaning = leaning.max(normal.angle(&face.normal(u, v)).to_degrees());
            assert!((point - face.offset(u, v, depth(u, v))).norm() < 1e-12);
        }
    }
    println!("normal off by {worst:.1e}; the displaced surface leans by up to {leaning:.2} degrees");
    assert!(worst < 1e-6 && leaning > 0.5);
}
