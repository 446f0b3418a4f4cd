//! Tool axes along a pass: the four strategies of the paper on a round edge, and the smoothest course against all courses.

use arcfeed_plan::finish::axis::{AxisProgram, Station, along_arc};
use arcfeed_plan::finish::contact::{Contact, Orientation};
use arcfeed_plan::finish::reach::smoothest;
use arcfeed_plan::vector::{Point, Vector};

fn station(share: f64, tilt_deg: f64) -> Station<Orientation> {
    Station { share, value: Orientation { tilt_rad: tilt_deg.to_radians(), yaw_rad: 0.0 } }
}

/// Pass over a round edge along x from the normal at -60 to that at 60 degrees.
fn round_edge() -> Vec<Contact> {
    let at = |k: i32| {
        let (sin, cos) = libm::sincos(f64::from(k).to_radians());
        let normal = Vector::new(0.0, sin, cos);
        Contact::new(Point::from(normal * 3.0), &normal, &Vector::new(0.0, cos, -sin)).unwrap()
    };
    (-60..=60).map(at).collect()
}

fn lean_deg(axis: &Vector) -> f64 {
    libm::atan2(axis.y, axis.z).to_degrees()
}

#[test]
fn strategy_4_turns_the_axis_by_50_degrees_less_and_the_others_by_as_much_as_the_normal() {
    let pass = round_edge();
    let turned = |program: &AxisProgram| {
        let axes = program.axes(&pass, 5.0);
        lean_deg(&axes[120]) - lean_deg(&axes[0])
    };
    let fixed = |tilt_deg: f64| AxisProgram::Angles(vec![station(0.0, tilt_deg)]);
    let keys = [30.0, 5.0, -20.0];
    let stations: Vec<_> = keys.iter().zip([0.0, 0.5, 1.0]).map(|(tilt, share)| station(share, *tilt)).collect();
    let level: Vec<_> = [0.0, 0.5, 1.0].map(|share| station(share, 0.0)).into();
    for (strategy, program, expected) in [
        (1, fixed(0.0), 120.0),
        (2, fixed(5.0), 120.0),
        (3, AxisProgram::Positions(level), 120.0),
        (4, AxisProgram::Positions(stations.clone()), 70.0),
        (4, AxisProgram::Angles(stations), 70.0),
    ] {
        println!("strategy {strategy}: the axis turns by {:.3} degrees", turned(&program));
        assert!((turned(&program) - expected).abs() < 1e-9);
    }
}

#[test]
fn between_positions_the_axis_keeps_to_one_plane_and_to_an_even_angle() {
    let pass = round_edge();
    let key = |share: f64, tilt_deg: f64, yaw_deg: f64| Station {
        share,
        value: Orientation { tilt_rad: tilt_deg.to_radians(), yaw_rad: yaw_deg.to_radians() },
    };
    let axes = AxisProgram::Positions(vec![key(0.0, 20.0, 40.0), key(1.0, 10.0, -30.0)]).axes(&pass, 5.0);
    assert!((axes[0] - pass[0].axis(&key(0.0, 20.0, 40.0).value)).norm() < 1e-12);
    assert!((axes[120] - pass[120].axis(&key(0.0, 10.0, -30.0).value)).norm() < 1e-12);
    let whole = axes[0].angle(&axes[120]);
    let normal = axes[0].cross(&axes[120]).normalize();
    for (k, axis) in axes.iter().enumerate() {
        assert!(axis.dot(&normal).abs() < 1e-12 && (axis.angle(&axes[0]) - whole * k as f64 / 120.0).abs() < 1e-9);
    }
    assert_eq!(along_arc(&Vector::x(), &Vector::x(), 0.3), Vector::x());
}

/// Least cost over all sequences, one after the other.
fn least(layers: &[Vec<Vector>], is_closed: bool) -> f64 {
    let count: usize = layers.iter().map(Vec::len).product();
    let cost = |mut number: usize| {
        let mut chosen = Vec::new();
        for layer in layers {
            chosen.push(layer[number % layer.len()]);
            number /= layer.len();
        }
        if is_closed {
            chosen.push(chosen[0]);
        }
        chosen.windows(2).map(|pair| (pair[1] - pair[0]).norm_squared()).sum::<f64>()
    };
    (0..count).map(cost).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_smoothest_course_is_the_best_of_all_courses() {
    let mut state = 3_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for round in 0..200 {
        let mut axis = || Vector::new(random(), random(), random()).normalize();
        let layers: Vec<Vec<Vector>> = (0..5).map(|k| (0..=(round + k) % 4).map(|_| axis()).collect()).collect();
        for is_closed in [false, true] {
            let found = smoothest(&layers, is_closed).unwrap();
            assert_eq!(found.len(), layers.len());
            assert!(found.iter().zip(&layers).all(|(axis, layer)| layer.contains(axis)));
            let ends = is_closed.then(|| found[0]);
            let whole: Vec<Vector> = found.iter().copied().chain(ends).collect();
            let cost: f64 = whole.windows(2).map(|pair| (pair[1] - pair[0]).norm_squared()).sum();
            assert!((cost - least(&layers, is_closed)).abs() < 1e-12, "{round} {is_closed}");
        }
    }
    assert_eq!(smoothest(&[vec![Vector::x()], Vec::new()], false), None);
    assert_eq!(smoothest(&[], false), None);
}
