//! Benchmark of finite elements: errors of plates and beams against closed forms and published tables as meshes get
//! finer, a disk of 56 sectors, points beside a plate, and queries a second. Times are wall-clock times on one core.
//!
//! `cargo bench --profile dist -p arcfeed-blades --bench fe_bench`. Figures of one run are in docs/fe.md.

use std::time::Instant;

use arcfeed_blades::beam::{Beam, BeamSection};
use arcfeed_blades::blade::Blade;
use arcfeed_blades::cyclic::Sector;
use arcfeed_blades::disk::{BladedDisk, SectorCells};
use arcfeed_blades::disk_field::DiskField;
use arcfeed_fe::body::Body;
use arcfeed_fe::field::Field;
use arcfeed_fe::locate::TooFar;
use arcfeed_fe::material::{STEEL, TITANIUM_6AL_4V};
use arcfeed_fe::sparse::Factor;
use arcfeed_fe::unknowns::Unknowns;
use arcfeed_modal::modal_point::ModalPoint;

type Error = Box<dyn std::error::Error>;

/// lambda = omega a^2 sqrt(rho h / D) of a square plate clamped along one edge, nu = 0.3: Ritz, 17 by 17 Legendre polynomials.
const PLATE: [f64; 5] = [3.47103, 8.50645, 21.28443, 27.19880, 30.95527];

/// Clamped and free ends: beta L.
const BEAM: [f64; 5] = [1.875_104_068_7, 4.694_091_133_0, 7.854_757_438_2, 10.995_540_734_9, 14.137_168_391_0];

/// Edge of the square plates.
const EDGE_MM: f64 = 100.0;

/// Cells at the clamp over those at the free edge.
const FOOT_RATIO: f64 = 0.2;

/// Number of timed queries.
const QUERIES: usize = 100_000;

fn per_cent(ours: f64, truth: f64) -> f64 {
    100.0 * (ours / truth - 1.0)
}

fn plate(cells: [usize; 3], thickness_mm: f64) -> Result<(), Error> {
    let begin = Instant::now();
    let body = Body::new(Blade::plate(EDGE_MM, EDGE_MM, thickness_mm).mesh(cells, FOOT_RATIO)?, &STEEL);
    let clamped = Blade::foot(body.mesh());
    let unknowns = Unknowns::clamped(body.mesh(), &clamped);
    let (k, m) = body.matrices(&unknowns);
    let assembled_s = begin.elapsed().as_secs_f64();
    let factor = Factor::of(&k, 0.0, &m).map_err(|singular| format!("{singular:?}"))?;
    let factored_s = begin.elapsed().as_secs_f64() - assembled_s;
    let begin = Instant::now();
    let modes = body.modes(&clamped, 10)?;
    let whole_s = begin.elapsed().as_secs_f64();
    let nu = STEEL.poisson_ratio;
    let bending = STEEL.young_mpa * thickness_mm * thickness_mm / (12.0 * (1.0 - nu * nu));
    let scale_s = EDGE_MM * EDGE_MM * libm::sqrt(STEEL.density_t_per_mm3() / bending);
    // Edgewise bending, most of whose motion is along the clamp, is not in the table.
    let moved = |shape: &[[f64; 3]], axis: usize| shape.iter().map(|u| u[axis] * u[axis]).sum::<f64>();
    let of_plate = modes.omega_rad_per_s.iter().zip(&modes.shapes).filter(|(_, u)| moved(u, 1) > moved(u, 0));
    print!("| {cells:?} | {} | {} | {} |", thickness_mm / EDGE_MM, unknowns.count(), factor.entries());
    for ((omega, _), truth) in of_plate.zip(PLATE) {
        print!(" {:+.2} |", per_cent(omega * scale_s, truth));
    }
    println!(" {assembled_s:.2} | {factored_s:.2} | {whole_s:.2} |");
    Ok(())
}

fn beam(elements: usize, diameter_mm: f64) -> Result<(), Error> {
    let section = BeamSection { length_mm: EDGE_MM, diameter_mm, material: STEEL };
    let modes = Beam { sections: vec![section], tip_mass_kg: 0.0, elements }.modes(5)?;
    let scale = libm::sqrt(STEEL.young_mpa / STEEL.density_t_per_mm3()) * diameter_mm / (4.0 * EDGE_MM * EDGE_MM);
    print!("| {elements} | {} |", diameter_mm / EDGE_MM);
    for (omega, beta) in modes.omega_rad_per_s.iter().step_by(2).zip(BEAM) {
        print!(" {:+.4} |", per_cent(*omega, beta * beta * scale));
    }
    println!();
    Ok(())
}

/// Distance of the displacement above a plate from that of Kirchhoff's straight normals, as a fraction of the mode's
/// largest displacement.
fn outside() -> Result<(), Error> {
    let thickness_mm = 2.0;
    let body = Body::new(Blade::plate(EDGE_MM, 60.0, thickness_mm).mesh([6, 1, 12], FOOT_RATIO)?, &STEEL);
    let modes = body.modes(&Blade::foot(body.mesh()), 5)?;
    let field = Field::new(body.mesh().clone(), &modes, 2.0 * thickness_mm);
    let mut modal_point = ModalPoint::default();
    let mut at = |along_mm: f64, height_mm: f64| -> Result<Vec<[f64; 3]>, TooFar> {
        field.at([7.0, height_mm, along_mm], &mut modal_point)?;
        Ok(modal_point.shapes.clone())
    };
    for ratio in [0.1, 0.25, 0.5, 1.0, 2.0] {
        print!("| {ratio} |");
        for (mode, shape) in modes.shapes.iter().enumerate() {
            let whole = shape.iter().flatten().fold(0.0, |most: f64, u| most.max(u.abs()));
            let mut worst: f64 = 0.0;
            for place in 1..100 {
                let along_mm = 0.01 * EDGE_MM * f64::from(place);
                let [middle, face, air] = [0.0, 0.5, 0.5 + ratio].map(|height| at(along_mm, height * thickness_mm));
                let (middle, face, air) = (middle?[mode], face?[mode], air?[mode]);
                for axis in 0..3 {
                    let truth = middle[axis] + (1.0 + 2.0 * ratio) * (face[axis] - middle[axis]);
                    worst = worst.max((air[axis] - truth).abs());
                }
            }
            print!(" {:.1e} |", worst / whole);
        }
        println!();
    }
    Ok(())
}

/// Mean time of a call in microseconds, over points along a line.
fn micros(mut query: impl FnMut(f64) -> Result<f64, TooFar>) -> Result<f64, TooFar> {
    let begin = Instant::now();
    let mut sum = 0.0;
    for number in 0..QUERIES {
        sum += query(number as f64 / QUERIES as f64)?;
    }
    let each = begin.elapsed().as_secs_f64() / QUERIES as f64 * 1e6;
    assert!(sum.is_finite());
    Ok(each)
}

fn blade() -> Result<(), Error> {
    let blade = Blade { camber_rad: [0.5, 0.3], stagger_rad: [0.4, 0.9], ..Blade::plate(40.0, 30.0, 2.119) };
    let begin = Instant::now();
    let body = Body::new(blade.mesh([12, 1, 16], FOOT_RATIO)?, &TITANIUM_6AL_4V);
    let modes = body.modes(&Blade::foot(body.mesh()), 10)?;
    println!("a twisted blade, 10 modes in {:.2} s: {:.0?} Hz", begin.elapsed().as_secs_f64(), modes.frequencies_hz());
    let field = Field::new(body.mesh().clone(), &modes, 2.0);
    let [low, high] = [[-0.45, 0.0, 0.5], [0.45, 0.0, 0.5]].map(|place| blade.point_mm(place));
    let way = |part: f64, off_mm: f64| {
        std::array::from_fn(|axis| low[axis] + part * (high[axis] - low[axis]) + if axis == 1 { off_mm } else { 0.0 })
    };
    let mut modal_point = ModalPoint::default();
    let near = micros(|part| field.at(way(part, 1.5), &mut modal_point))?;
    let cold = micros(|part| field.at(way(part, 1.5), &mut ModalPoint::default()))?;
    let air = micros(|part| field.at(way(part, 2.8), &mut modal_point))?;
    let amplitudes = [1e-6; 10];
    let back = micros(|part| Ok(field.material_point_mm(way(part, 1.5), &amplitudes, &mut modal_point)?[0]))?;
    println!(
        "a query: {near:.2} us, without the last point's {cold:.2}, in the air beside {air:.2}, back to the material {back:.2}"
    );
    Ok(())
}

fn disk() -> Result<(), Error> {
    let disk = BladedDisk {
        sectors: 56,
        bore_radius_mm: 100.0,
        rim_radius_mm: 168.0,
        width_mm: 12.0,
        span_mm: 30.0,
        taper_ratio: 0.8,
        twist_rad: 0.4,
        cells: SectorCells { around: [1, 1], along: 2, outwards: [2, 4] },
    };
    let begin = Instant::now();
    let sector = Sector::new(disk.sector()?, disk.sectors, &TITANIUM_6AL_4V)?;
    let waves = sector.modes(&sector.body().mesh().nodes_where(BladedDisk::is_hub), 180)?;
    let hz = |mode: usize| waves[mode].omega_rad_per_s / std::f64::consts::TAU;
    let nodes = sector.body().mesh().nodes_mm().len();
    println!(
        "56 sectors of {nodes} nodes: 180 modes from {:.0} to {:.0} Hz in {:.1} s",
        hz(0),
        hz(179),
        begin.elapsed().as_secs_f64()
    );
    let field = DiskField::new(&sector, &waves, 1.0);
    let mut modal_point = ModalPoint::default();
    let each = micros(|part| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * part);
        field.at([160.0 * cos, 160.0 * sin, 1.0], &mut modal_point)
    })?;
    println!("a query of 180 modes: {each:.2} us");
    Ok(())
}

fn main() -> Result<(), Error> {
    println!(
        "square plates: cells, h/a, unknowns, entries of the factor, five errors in %, s for assembly, factor, 10 modes in all"
    );
    for cells in [[4, 1, 6], [6, 1, 8], [8, 1, 12], [12, 1, 16], [16, 1, 22]] {
        plate(cells, 2.0)?;
    }
    for thickness_mm in [0.5, 1.0, 2.0, 5.0, 10.0] {
        plate([16, 1, 22], thickness_mm)?;
    }
    println!("bars, d/L, five errors in % of beta L of a slender one");
    for elements in [4, 8, 16, 32] {
        beam(elements, 0.01)?;
    }
    for diameter_mm in [1.0, 5.0, 10.0, 20.0] {
        beam(64, diameter_mm)?;
    }
    println!("air above a plate, distance over thickness, error of five modes");
    outside()?;
    blade()?;
    disk()
}
