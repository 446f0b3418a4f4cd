//! Plates clamped along one edge.

use arcfeed_blades::blade::Blade;
use arcfeed_fe::body::Body;
use arcfeed_fe::material::{ElasticMaterial, STEEL, TITANIUM_6AL_4V};

/// Cells along the clamp, through the thickness and away from the clamp.
const CELLS: [usize; 3] = [12, 1, 16];

/// Cells at the clamp over those at the free end.
const FOOT_RATIO: f64 = 0.2;

/// A row of the table: a / b, source, the lowest lambda.
fn table() -> Vec<(f64, &'static str, Vec<f64>)> {
    let rows = include_str!("plate_cfff.csv").lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let row = |line: &'static str| {
        let fields: Vec<&str> = line.split(',').collect();
        (fields[0].parse().unwrap(), fields[1], fields[2..].iter().map(|field| field.parse().unwrap()).collect())
    };
    rows.map(row).collect()
}

/// lambda of the five lowest modes of a plate of these edges.
fn lambdas([span_mm, width_mm, thickness_mm]: [f64; 3], cells: [usize; 3], material: &ElasticMaterial) -> Vec<f64> {
    let body = Body::new(Blade::plate(span_mm, width_mm, thickness_mm).mesh(cells, FOOT_RATIO).unwrap(), material);
    let modes = body.modes(&Blade::foot(body.mesh()), 5).unwrap();
    let nu = material.poisson_ratio;
    let bending = material.young_mpa * thickness_mm * thickness_mm / (12.0 * (1.0 - nu * nu));
    let scale = span_mm * span_mm * libm::sqrt(material.density_t_per_mm3() / bending);
    modes.omega_rad_per_s.iter().map(|omega| omega * scale).collect()
}

#[test]
fn five_frequencies_of_cantilever_plates_are_within_one_per_cent_of_the_table() {
    for (a_over_b, source, truths) in table() {
        let (span_mm, width_mm): (f64, f64) = (100.0, 100.0 / a_over_b);
        let cells = if a_over_b < 1.0 {
            [20, 1, 14]
        } else if a_over_b > 1.0 {
            [10, 1, 20]
        } else {
            CELLS
        };
        // Thin, as the table's theory is: a fiftieth of the shorter edge.
        let ours = lambdas([span_mm, width_mm, 0.02 * span_mm.min(width_mm)], cells, &STEEL);
        let errors: Vec<f64> = ours.iter().zip(&truths).map(|(ours, truth)| 100.0 * (ours / truth - 1.0)).collect();
        println!("a/b {a_over_b} {source}: {errors:+.2?} %");
        assert!(errors.iter().all(|error| error.abs() <= 1.0), "a/b {a_over_b} {source}: {errors:.2?} %");
    }
}

#[test]
fn a_finer_mesh_is_softer_and_nearer_to_the_truth() {
    let runs: Vec<Vec<f64>> =
        [[4, 1, 6], [6, 1, 9], [8, 1, 12], [12, 1, 16]].map(|cells| lambdas([100.0, 100.0, 2.0], cells, &STEEL)).into();
    for mode in 0..5 {
        let of_mode: Vec<f64> = runs.iter().map(|run| run[mode]).collect();
        assert!(of_mode.is_sorted_by(|coarse, fine| coarse > fine), "mode {mode}: {of_mode:?}");
    }
}

#[test]
fn shear_lowers_the_frequencies_of_thick_plates() {
    let runs: Vec<Vec<f64>> =
        [0.02, 0.05, 0.1].map(|ratio| lambdas([100.0, 100.0, 100.0 * ratio], [8, 1, 12], &STEEL)).into();
    for mode in [1, 2, 3] {
        let of_mode: Vec<f64> = runs.iter().map(|run| run[mode]).collect();
        assert!(of_mode.is_sorted_by(|thin, thick| thin > thick), "mode {mode}: {of_mode:?}");
    }
}

/// A titanium plate of 40 by 30 by 2.119 mm has, thin, the 1130 Hz of Lorong's blade.
#[test]
fn the_plate_in_place_of_the_blade_has_its_first_frequency() {
    let body = Body::new(Blade::plate(40.0, 30.0, 2.119).mesh(CELLS, FOOT_RATIO).unwrap(), &TITANIUM_6AL_4V);
    let modes = body.modes(&Blade::foot(body.mesh()), 6).unwrap();
    // A solid also bends edgewise, which thin-plate theory does not know: there most of the motion is along the chord.
    let moved = |shape: &[[f64; 3]], axis: usize| shape.iter().map(|u| u[axis] * u[axis]).sum::<f64>();
    let of_plate = modes.frequencies_hz().into_iter().zip(&modes.shapes).filter(|(_, u)| moved(u, 1) > moved(u, 0));
    let ours_hz: Vec<f64> = of_plate.map(|(hz, _)| hz).collect();
    let thin_hz = [1130.0, 3400.8, 6989.3, 11744.6, 14257.0];
    println!("{ours_hz:.1?} Hz, thin {thin_hz:?} Hz");
    assert_eq!(ours_hz.len(), 5);
    assert!((ours_hz[0] / thin_hz[0] - 1.0).abs() < 0.01, "{ours_hz:?}");
    // The plate's thickness is a fourteenth of its width: shear and rotation make the higher modes slower than thin ones.
    assert!(
        ours_hz.iter().zip(thin_hz).skip(1).all(|(ours, thin)| (0.95..1.0).contains(&(ours / thin))),
        "{ours_hz:?}"
    );
}

#[test]
fn a_plate_weighs_what_it_must_and_a_twisted_blade_is_no_plate() {
    let plate = Blade::plate(40.0, 30.0, 2.0);
    let body = Body::new(plate.mesh([2, 1, 2], 1.0).unwrap(), &TITANIUM_6AL_4V);
    assert!((body.mass_t() / (2400.0 * 4.43e-9) - 1.0).abs() < 1e-12);
}

/// Reference: a cantilever of constant width, half as thick at its tip: 3.8238 in place of 3.5160 (Mabie, Rogers, Transverse vibrations of double-tapered
/// cantilever beams, J. Acoust. Soc. Am. 51, 1972; Banerjee et al., J. Sound Vib. 298, 2006).
#[test]
fn taper_makes_a_blade_faster_as_it_does_a_beam_and_camber_makes_it_stiffer() {
    let straight = Blade::plate(80.0, 8.0, 2.0);
    let first_hz = |blade: Blade| {
        let body = Body::new(blade.mesh([2, 1, 16], FOOT_RATIO).unwrap(), &TITANIUM_6AL_4V);
        body.modes(&Blade::foot(body.mesh()), 1).unwrap().frequencies_hz()[0]
    };
    let tapered = first_hz(Blade { thickness_mm: [2.0, 1.0], ..straight }) / first_hz(straight);
    println!("taper: {tapered:.4}, truth {:.4}", 3.8238 / 3.5160);
    assert!((tapered / (3.8238 / 3.5160) - 1.0).abs() < 0.005, "{tapered}");
    assert!(first_hz(Blade { camber_rad: [1.0; 2], ..straight }) > 1.05 * first_hz(straight));
}
