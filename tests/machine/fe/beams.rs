//! Tools as beams.

use std::f64::consts::PI;

use arcfeed_blades::beam::{Beam, BeamSection};
use arcfeed_fe::material::{STEEL, TITANIUM_6AL_4V};
use arcfeed_modal::modal_point::ModalPoint;

/// beta L of a beam with one end clamped, the other free.
const CANTILEVER: [f64; 5] = [1.875_104_068_7, 4.694_091_133_0, 7.854_757_438_2, 10.995_540_734_9, 14.137_168_391_0];

fn bar(length_mm: f64, diameter_mm: f64) -> BeamSection {
    BeamSection { length_mm, diameter_mm, material: STEEL }
}

fn beam(sections: &[BeamSection], elements: usize) -> Beam {
    Beam { sections: sections.to_vec(), tip_mass_kg: 0.0, elements }
}

/// E I / (rho A L^4) of a bar, its square root: omega = (beta L)^2 times this.
fn scale_rad_per_s(section: BeamSection) -> f64 {
    let density = section.material.density_kg_per_m3 * 1e-12;
    libm::sqrt(section.material.young_mpa / density) * section.diameter_mm / (4.0 * section.length_mm.powi(2))
}

/// kappa G A / (E I), per mm2.
fn shear_over_bending(section: BeamSection) -> f64 {
    let nu = section.material.poisson_ratio;
    let kappa = 6.0 * (1.0 + nu).powi(2) / (7.0 + 12.0 * nu + 4.0 * nu * nu);
    kappa / (2.0 * (1.0 + nu)) * 16.0 / section.diameter_mm.powi(2)
}

/// The lowest frequencies, of each pair the one along x.
fn lowest_rad_per_s(beam: &Beam, pairs: usize) -> Vec<f64> {
    let modes = beam.modes(pairs).unwrap();
    assert!(modes.omega_rad_per_s.chunks(2).all(|pair| pair[0] == pair[1]));
    modes.omega_rad_per_s.into_iter().step_by(2).collect()
}

fn bisected(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (mut low, mut high) = (low, high);
    assert!(f(low) * f(high) < 0.0, "no sign change from {low} to {high}");
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(low) * f(middle) <= 0.0 { high = middle } else { low = middle }
    }
    low
}

#[test]
fn a_slender_cantilever_has_the_frequencies_of_the_closed_form() {
    let section = bar(1000.0, 0.1);
    for (omega, beta) in lowest_rad_per_s(&beam(&[section], 60), 5).iter().zip(CANTILEVER) {
        let error = omega / (beta * beta * scale_rad_per_s(section)) - 1.0;
        assert!(error.abs() < 5e-6, "beta L = {beta}: {error:.2e}");
    }
}

#[test]
fn errors_fall_with_the_fourth_power_of_the_element() {
    let section = bar(1000.0, 0.1);
    let error = |elements| {
        lowest_rad_per_s(&beam(&[section], elements), 3)[2] / (CANTILEVER[2].powi(2) * scale_rad_per_s(section)) - 1.0
    };
    for elements in [8, 16] {
        let order = libm::log2(error(elements) / error(2 * elements));
        assert!((order - 4.0).abs() < 0.2, "{elements} elements: order {order:.2}");
    }
}

/// Huang, The effect of rotatory inertia and of shear deformation on the frequency and normal mode equations of uniform beams, J. Appl. Mech. 28, 1961.
#[test]
fn a_stubby_cantilever_has_the_frequencies_of_timoshenkos_beam() {
    let section = bar(60.0, 12.0);
    let r2 = section.diameter_mm.powi(2) / 16.0 / section.length_mm.powi(2);
    let s2 = 1.0 / (shear_over_bending(section) * section.length_mm.powi(2));
    let equation = |b: f64| {
        let root = libm::sqrt((r2 - s2).powi(2) + 4.0 / (b * b));
        let (alpha, beta) = (libm::sqrt(0.5 * (root - r2 - s2)), libm::sqrt(0.5 * (root + r2 + s2)));
        let mixed = b * (r2 + s2) / libm::sqrt(1.0 - b * b * r2 * s2) * libm::sinh(b * alpha) * libm::sin(b * beta);
        2.0 + (b * b * (r2 - s2).powi(2) + 2.0) * libm::cosh(b * alpha) * libm::cos(b * beta) - mixed
    };
    // With shear the elements converge with the square of their length.
    let [coarse, fine] = [40, 80].map(|elements| lowest_rad_per_s(&beam(&[section], elements), 3));
    for (mode, beta) in CANTILEVER[..3].iter().enumerate() {
        let b = (4.0 * fine[mode] - coarse[mode]) / 3.0 / scale_rad_per_s(section);
        let truth = bisected(equation, 0.99 * b, 1.01 * b);
        assert!(truth < 0.99 * beta * beta, "shear does not show");
        assert!((b / truth - 1.0).abs() < 1e-6, "{b} {truth}");
        assert!((coarse[mode] / fine[mode] - 1.0).abs() < 5e-4);
    }
}

#[test]
fn a_mass_at_the_tip_lowers_the_frequencies_as_it_must() {
    let section = bar(1000.0, 0.1);
    let mass_kg = PI / 4.0 * 0.1 * 0.1 * 1000.0 * section.material.density_kg_per_m3 * 1e-9;
    for share in [0.1, 1.0, 10.0] {
        let tool = Beam { tip_mass_kg: share * mass_kg, ..beam(&[section], 40) };
        let equation = |x: f64| {
            1.0 + libm::cos(x) * libm::cosh(x)
                + share * x * (libm::cos(x) * libm::sinh(x) - libm::sin(x) * libm::cosh(x))
        };
        for omega in lowest_rad_per_s(&tool, 3) {
            let x = libm::sqrt(omega / scale_rad_per_s(section));
            assert!((x / bisected(equation, 0.99 * x, 1.01 * x) - 1.0).abs() < 1e-5, "share {share}: {x}");
        }
    }
}

#[test]
fn deflection_of_a_stepped_tool_is_that_of_bending_and_shear() {
    let steps = [bar(40.0, 32.0), bar(30.0, 20.0), BeamSection { material: TITANIUM_6AL_4V, ..bar(50.0, 12.0) }];
    let modes = beam(&steps, 6).modes(36).unwrap();
    let mut modal_point = ModalPoint::default();
    modes.at([0.0; 3], &mut modal_point);
    let mut amplitudes = vec![0.0; modal_point.shapes.len()];
    modal_point.add_force([1.0, 0.0, 0.0], &mut amplitudes);
    amplitudes.iter_mut().zip(&modes.omega_rad_per_s).for_each(|(q, omega)| *q /= omega * omega);
    let [sum, aside, along] = modal_point.displacement_mm(&amplitudes);
    assert_eq!([aside, along], [0.0; 2]);
    let mut from_tip_mm: f64 = steps.iter().map(|step| step.length_mm).sum();
    let mut truth = 0.0;
    for step in steps {
        let bending = step.material.young_mpa * PI / 64.0 * step.diameter_mm.powi(4);
        let near_mm = from_tip_mm - step.length_mm;
        truth += (from_tip_mm.powi(3) - near_mm.powi(3)) / (3.0 * bending);
        truth += step.length_mm / (shear_over_bending(step) * bending);
        from_tip_mm = near_mm;
    }
    assert!((sum / truth - 1.0).abs() < 1e-9, "{sum:e} {truth:e} mm/N");
}

#[test]
fn a_point_of_the_tool_moves_with_its_section() {
    let modes = beam(&[bar(50.0, 2.0), bar(30.0, 1.0)], 4).modes(2).unwrap();
    let shapes = |point_mm: [f64; 3]| {
        let mut modal_point = ModalPoint::default();
        modes.at(point_mm, &mut modal_point);
        modal_point.shapes
    };
    let (step_mm, height_mm) = (1e-4, 21.3);
    for mode in 0..2 {
        let across = |z_mm: f64| shapes([0.0, 0.0, z_mm])[2 * mode];
        let slope = (across(height_mm + step_mm)[0] - across(height_mm - step_mm)[0]) / (2.0 * step_mm);
        let beside = shapes([3.0, 4.0, height_mm]);
        // z grows towards the clamp. A section stays square to the axis but for shear.
        assert!((beside[2 * mode][2] / (-3.0 * slope) - 1.0).abs() < 2e-3, "{} {slope}", beside[2 * mode][2]);
        assert!((beside[2 * mode + 1][2] / beside[2 * mode][2] - 4.0 / 3.0).abs() < 1e-12);
        assert_eq!(beside[2 * mode][0], beside[2 * mode + 1][1]);
        assert_eq!(shapes([0.0, 0.0, 80.0])[2 * mode], [0.0; 3]);
        // Below the tip: straight on.
        let tip: Vec<f64> = [0.0, -1.0, -2.0].iter().map(|z_mm| across(*z_mm)[0]).collect();
        assert!((tip[0] - 2.0 * tip[1] + tip[2]).abs() < 1e-12 * tip[0].abs());
    }
}
