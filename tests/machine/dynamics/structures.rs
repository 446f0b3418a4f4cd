//! Structures by themselves: closed forms of one mass on a spring, and how force and displacement come to agree.

use std::f64::consts::TAU;

use arcfeed_modal::dynamics::modal::{Mode, ModeError};
use arcfeed_modal::dynamics::vibration::{Stepping, Vibration};
use nalgebra::Vector3;

use crate::dynamics::sets::{EXACT, NEWMARK, mode_a};

/// Set A along x, N/mm and kg.
const STIFFNESS: f64 = 1340.049648;
const FREQUENCY_HZ: f64 = 922.0;
const DAMPING: f64 = 0.011;

fn alone(stepping: Stepping) -> Vibration {
    Vibration::new(vec![mode_a(Vector3::x())], stepping)
}

/// Displacement along x after steps to `end_s` under a force given as a function of time.
fn driven_mm(stepping: Stepping, end_s: f64, steps: usize, force_n: impl Fn(f64) -> f64) -> f64 {
    let mut vibration = alone(stepping);
    let dt_s = end_s / steps as f64;
    for at in 1..=steps {
        vibration.step(dt_s, |_| Vector3::x() * force_n(at as f64 * dt_s));
    }
    vibration.displacement_mm().x
}

/// A force that grows by 1000 N in a second, from rest.
fn ramp_mm(t_s: f64) -> f64 {
    let w = TAU * FREQUENCY_HZ;
    let damped = w * libm::sqrt(1.0 - DAMPING * DAMPING);
    let (sin, cos) = libm::sincos(damped * t_s);
    let decay = libm::exp(-DAMPING * w * t_s);
    let lag_s = 2.0 * DAMPING / w;
    let swing = decay * (lag_s * cos + (2.0 * DAMPING * DAMPING - 1.0) / damped * sin);
    1000.0 / STIFFNESS * (t_s - lag_s + swing)
}

/// Settled amplitude and lag under 10 N sin(2 pi f t).
fn settled(hz: f64) -> [f64; 2] {
    let r = hz / FREQUENCY_HZ;
    let (real, imaginary) = (1.0 - r * r, 2.0 * DAMPING * r);
    [10.0 / STIFFNESS / libm::hypot(real, imaginary), libm::atan2(imaginary, real)]
}

#[test]
fn a_tap_test_gives_mass_and_static_stiffness() {
    let along = Vector3::new(3.0, 0.0, -4.0);
    let mode = mode_a(along);
    assert!((1.0 / mode.shape.norm_squared() - 0.03993).abs() < 5e-6, "kg");
    let moved_mm = mode.static_mm(&(along * 10.0));
    assert!((moved_mm - along * 10.0 / STIFFNESS).norm() < 1e-15);
    assert!(mode.static_mm(&Vector3::y()).norm() < 1e-18);
}

#[test]
fn a_force_that_runs_straight_is_answered_exactly() {
    for steps in [3, 50, 2000] {
        let off_mm = driven_mm(EXACT, 0.01, steps, |t_s| 1000.0 * t_s) - ramp_mm(0.01);
        assert!(off_mm.abs() < 1e-12, "{steps} steps: {off_mm:e}");
    }
    let off = |steps| (driven_mm(NEWMARK, 0.01, steps, |t_s| 1000.0 * t_s) - ramp_mm(0.01)).abs();
    let order = libm::log2(off(1000) / off(4000)) / 2.0;
    println!("Newmark: order {order:.3}, {:.1e} mm with 4000 steps", off(4000));
    assert!((1.95..2.05).contains(&order), "{order}");
}

#[test]
fn a_settled_vibration_is_of_second_order_with_both_rules() {
    let hz = 700.0;
    let [amplitude_mm, lag] = settled(hz);
    // The start has decayed by exp(-zeta w t) = 3e-14.
    let end_s = 0.49;
    for (name, stepping, most) in [("Newmark", NEWMARK, 1e-3), ("exact", EXACT, 2e-4)] {
        let off = |per_period: f64| {
            let steps = (end_s * hz * per_period).round() as usize;
            let found_mm = driven_mm(stepping, end_s, steps, |t_s| 10.0 * libm::sin(TAU * hz * t_s));
            (found_mm - amplitude_mm * libm::sin(TAU * hz * end_s - lag)).abs() / amplitude_mm
        };
        let order = libm::log2(off(40.0) / off(160.0)) / 2.0;
        println!("{name}: order {order:.2}, {:.1e} with 40 steps a period", off(40.0));
        assert!((1.9..2.1).contains(&order), "{name}: {order}");
        assert!(off(40.0) < most);
    }
}

#[test]
fn left_alone_it_decays_as_damping_says() {
    let damped_s = 1.0 / (FREQUENCY_HZ * libm::sqrt(1.0 - DAMPING * DAMPING));
    let mut vibration = alone(EXACT);
    vibration.step(0.1, |_| Vector3::x() * 10.0);
    let mut path_mm = Vec::new();
    for _ in 0..33 {
        vibration.step(damped_s / 16.0, |_| Vector3::zeros());
        path_mm.push(vibration.displacement_mm().x);
    }
    let expected = libm::exp(-DAMPING * TAU * FREQUENCY_HZ * damped_s);
    for (before, after) in path_mm[1..].iter().zip(&path_mm[17..]) {
        assert!((after / before - expected).abs() < 1e-9, "{before} {after}");
    }
}

#[test]
fn a_spring_in_the_force_is_a_stiffer_structure() {
    let (cut_n_per_mm, dt_s) = (400.0, 2e-5);
    let stiffer = libm::sqrt(1.0 + cut_n_per_mm / STIFFNESS);
    let stiff =
        Mode::from_stiffness(FREQUENCY_HZ * stiffer, DAMPING / stiffer, STIFFNESS + cut_n_per_mm, &Vector3::x());
    let tight = Stepping { tolerance_mm: 1e-15, ..NEWMARK };
    let (mut with_cut, mut stiff) = (alone(tight), Vibration::new(vec![stiff.unwrap()], tight));
    for at in 0..2000 {
        let outside = Vector3::x() * 10.0 * libm::sin(0.05 * f64::from(at));
        let step = with_cut.step(dt_s, |now| outside - now * cut_n_per_mm);
        stiff.step(dt_s, |_| outside);
        assert!(step.has_converged && step.iterations <= 8, "{step:?}");
        assert!((with_cut.displacement_mm() - stiff.displacement_mm()).norm() < 1e-10);
        assert!((with_cut.displacement_mm() - step.displacement_mm).norm() < 1e-15);
    }
}

#[test]
fn tool_and_workpiece_in_one_list_give_way_together() {
    let tool = Mode::from_stiffness(1960.0, 0.03, 20000.0, &Vector3::x()).unwrap();
    let blade = Mode::from_stiffness(1130.0, 0.005, 5000.0, &Vector3::new(1.0, 1.0, 0.0)).unwrap();
    let mut both = Vibration::new(vec![tool, blade], EXACT);
    let force_n = Vector3::new(100.0, -20.0, 0.0);
    for _ in 0..200_000 {
        both.step(1e-5, |_| force_n);
    }
    // The blade is pushed by -F and moves the other way; u_T - u_W has both with the sign of F.
    let expected_mm = Vector3::new(100.0 / 20000.0, 0.0, 0.0) + Vector3::new(1.0, 1.0, 0.0) * (80.0 / 2.0 / 5000.0);
    assert!((both.displacement_mm() - expected_mm).norm() < 1e-12);
}

#[test]
fn a_force_that_cannot_agree_is_reported() {
    let jumps = |now: &Vector3<f64>| Vector3::x() * if now.x > 0.0 { -1000.0 } else { 1000.0 };
    let mut vibration = alone(Stepping { iterations_max: 5, ..EXACT });
    let step = vibration.step(1e-4, jumps);
    assert!(!step.has_converged && step.iterations == 5 && step.change_mm > 1e-3, "{step:?}");
    let once = alone(Stepping { iterations_max: 0, ..EXACT }).step(1e-4, |_| Vector3::x());
    assert!(!once.has_converged && once.iterations == 1);
}

#[test]
fn neither_a_jump_nor_resonance_swings_a_mode_beyond_its_bound() {
    let bound_mm = mode_a(Vector3::x()).swing_max_mm(10.0);
    let largest_mm = |force_n: &dyn Fn(f64) -> f64| {
        let mut vibration = alone(EXACT);
        let at_mm =
            |step: u32| vibration.step(1e-5, |_| Vector3::x() * force_n(f64::from(step) * 1e-5)).displacement_mm.x;
        (1..=20_000).map(at_mm).fold(0.0, |most: f64, mm| most.max(mm.abs()))
    };
    let jump_mm = largest_mm(&|_| 10.0);
    let resonance_mm = largest_mm(&|t_s| 10.0 * libm::sin(TAU * FREQUENCY_HZ * t_s));
    println!("jump {jump_mm:.6} mm, resonance {resonance_mm:.6}, bound {bound_mm:.6}");
    assert!(jump_mm > 1.9 * 10.0 / STIFFNESS && jump_mm < bound_mm);
    assert!((0.97..1.0).contains(&(resonance_mm / bound_mm)));
}

#[test]
fn seen_from_elsewhere_the_same_modes_give_way_otherwise() {
    let mut vibration = alone(EXACT);
    let shape = vibration.modes()[0].shape;
    vibration.step(1e-4, |_| Vector3::x() * 10.0);
    vibration.set_shapes(&[shape / 2.0]);
    for _ in 0..20_000 {
        let step = vibration.step(1e-4, |_| Vector3::x() * 10.0);
        assert!((vibration.displacement_mm() - step.displacement_mm).norm() < 1e-15);
    }
    assert!((vibration.displacement_mm().x - 10.0 / STIFFNESS / 4.0).abs() < 1e-12);
}

#[test]
fn invalid_modes_are_refused() {
    let x = Vector3::x();
    assert_eq!(Mode::new(0.0, 0.1, x), Err(ModeError::Frequency { given_hz: 0.0 }));
    assert_eq!(Mode::new(1.0, 1.0, x), Err(ModeError::Damping { given_ratio: 1.0 }));
    assert!(Mode::new(1.0, f64::NAN, x).is_err());
    assert_eq!(Mode::new(1.0, 0.1, x * f64::NAN), Err(ModeError::Shape));
    assert_eq!(Mode::from_stiffness(1.0, 0.1, -1.0, &x), Err(ModeError::Stiffness { given_n_per_mm: -1.0 }));
    assert_eq!(Mode::from_stiffness(1.0, 0.1, 1.0, &(x * 0.0)), Err(ModeError::Shape));
    assert!(Mode::from_stiffness(f64::NAN, 0.1, 1.0, &x).is_err());
}
