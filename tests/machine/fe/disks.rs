//! Disks by one sector against the whole.

use arcfeed_blades::cyclic::{Sector, SectorError, Wave};
use arcfeed_blades::disk::{BladedDisk, SectorCells};
use arcfeed_blades::disk_field::DiskField;
use arcfeed_fe::body::Body;
use arcfeed_fe::eigen::below;
use arcfeed_fe::material::TITANIUM_6AL_4V;
use arcfeed_fe::mesh::TetMesh;
use arcfeed_fe::sparse::Sparse;
use arcfeed_fe::unknowns::Unknowns;
use arcfeed_modal::flexible::Modal;
use arcfeed_modal::modal_point::ModalPoint;

use crate::fe::at_nodes::unknowns_of_nodes;
use crate::fe::solver::all_of_dense;

fn disk(sectors: usize) -> BladedDisk {
    let rim_radius_mm = 3.0 * sectors as f64;
    BladedDisk {
        sectors,
        bore_radius_mm: 0.6 * rim_radius_mm,
        rim_radius_mm,
        width_mm: 12.0,
        span_mm: 30.0,
        taper_ratio: 0.8,
        twist_rad: 0.4,
        cells: SectorCells { around: [1, 1], along: 1, outwards: [1, 2] },
    }
}

fn sector(disk: &BladedDisk) -> Sector {
    Sector::new(disk.sector().unwrap(), disk.sectors, &TITANIUM_6AL_4V).unwrap()
}

fn waves(sector: &Sector, count: usize) -> Vec<Wave> {
    sector.modes(&sector.body().mesh().nodes_where(BladedDisk::is_hub), count).unwrap()
}

/// The whole disk: its body, its unknowns, stiffness and mass.
fn whole(disk: &BladedDisk) -> (Body, Unknowns, Sparse, Sparse) {
    let body = Body::new(disk.whole().unwrap(), &TITANIUM_6AL_4V);
    let unknowns = Unknowns::clamped(body.mesh(), &body.mesh().nodes_where(BladedDisk::is_hub));
    let (k, m) = body.matrices(&unknowns);
    (body, unknowns, k, m)
}

/// The vectors of unknowns of all modes, as the field of the sector's modes has them at the nodes of the whole.
fn expanded(field: &DiskField, body: &Body, unknowns: &Unknowns) -> Vec<Vec<f64>> {
    let mut modal_point = ModalPoint::default();
    let nodes_mm = body.mesh().nodes_mm();
    let at_nodes: Vec<Vec<[f64; 3]>> = nodes_mm
        .iter()
        .map(|node_mm| {
            assert!(field.at(*node_mm, &mut modal_point).unwrap() < 1e-6);
            modal_point.shapes.clone()
        })
        .collect();
    let mut vectors = vec![vec![0.0; unknowns.count()]; field.omega_rad_per_s().len()];
    for (shapes, numbers) in at_nodes.iter().zip(unknowns_of_nodes(unknowns)) {
        for (vector, shape) in vectors.iter_mut().zip(shapes) {
            for (u, unknown) in shape.iter().zip(numbers) {
                unknown.into_iter().for_each(|unknown| vector[unknown] = *u);
            }
        }
    }
    vectors
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn small_disks_have_all_the_frequencies_of_a_dense_solver() {
    for sectors in [2, 3, 4] {
        let cells = SectorCells { around: [1, 1], along: 1, outwards: [1, 1] };
        let disk = BladedDisk { rim_radius_mm: 30.0, bore_radius_mm: 15.0, cells, ..disk(sectors) };
        let (_, _, k, m) = whole(&disk);
        let truth = all_of_dense(&k, &m);
        let ours = waves(&sector(&disk), 40);
        for (wave, truth) in ours.iter().zip(&truth) {
            assert!(
                (wave.omega_rad_per_s.powi(2) / truth - 1.0).abs() < 1e-8,
                "{sectors}: {} {truth}",
                wave.omega_rad_per_s
            );
        }
    }
}

/// The disk of Lorong's example has 56 blades; 180 modes of it were used there.
#[test]
fn the_modes_of_a_sector_of_56_are_those_of_the_whole_disk() {
    let disk = disk(56);
    let sector = sector(&disk);
    let waves = waves(&sector, 180);
    let field = DiskField::new(&sector, &waves, 0.5);
    let (body, unknowns, k, m) = whole(&disk);
    assert!((body.mass_t() / (56.0 * sector.body().mass_t()) - 1.0).abs() < 1e-12);
    let vectors = expanded(&field, &body, &unknowns);
    let inertias: Vec<Vec<f64>> = vectors.iter().map(|vector| m.times(vector)).collect();
    for (i, wave) in waves.iter().enumerate() {
        // Rayleigh's quotient is off by the square of what the vector is.
        let force = k.times(&vectors[i]);
        let lambda = product(&force, &vectors[i]) / product(&inertias[i], &vectors[i]);
        assert!((lambda / wave.omega_rad_per_s.powi(2) - 1.0).abs() < 1e-8, "mode {i}");
        let left: Vec<f64> = force.iter().zip(&inertias[i]).map(|(f, m)| f - lambda * m).collect();
        let residual = libm::sqrt(product(&left, &left) / product(&force, &force));
        assert!(residual < 1e-5, "mode {i}: {residual:.1e}");
        for (j, inertia) in inertias.iter().enumerate() {
            let wanted = if i == j { 1.0 } else { 0.0 };
            assert!((product(inertia, &vectors[i]) - wanted).abs() < 1e-7, "modes {i} and {j}");
        }
    }
    // As many as the whole disk has below the last one but its like: none is missed.
    let between = |i: usize| waves[i].omega_rad_per_s < (1.0 - 1e-6) * waves[i + 1].omega_rad_per_s;
    let last = (0..179).rev().find(|i| between(*i)).unwrap();
    let lambda = 0.5 * (waves[last].omega_rad_per_s.powi(2) + waves[last + 1].omega_rad_per_s.powi(2));
    assert_eq!(below(&k, &m, lambda), Ok(last + 1));
    let [first_hz, last_hz] = [0, 179].map(|mode| waves[mode].omega_rad_per_s / std::f64::consts::TAU);
    println!("{} unknowns, 180 modes from {first_hz:.1} to {last_hz:.1} Hz", k.size());
}

#[test]
fn a_place_on_a_shaken_disk_is_found_again_on_every_blade() {
    let disk = disk(12);
    let sector = sector(&disk);
    let waves = waves(&sector, 12);
    let field = DiskField::new(&sector, &waves, 0.5);
    let body = Body::new(disk.whole().unwrap(), &TITANIUM_6AL_4V);
    let mut modal_point = ModalPoint::default();
    let amplitudes: Vec<f64> = (0..12).map(|r| 1e-5 * f64::from(r - 5)).collect();
    let mut greatest_mm: f64 = 0.0;
    for node_mm in body.mesh().nodes_mm() {
        field.at(*node_mm, &mut modal_point).unwrap();
        let u_mm = modal_point.displacement_mm(&amplitudes);
        greatest_mm = u_mm.iter().fold(greatest_mm, |most, u| most.max(u.abs()));
        let now_mm = std::array::from_fn(|axis| node_mm[axis] + u_mm[axis]);
        let found_mm = field.material_point_mm(now_mm, &amplitudes, &mut modal_point).unwrap();
        assert!((0..3).all(|axis| (found_mm[axis] - node_mm[axis]).abs() < 1e-9), "{found_mm:?} {node_mm:?}");
    }
    assert!(greatest_mm > 0.01, "{greatest_mm} mm");
}

#[test]
fn a_mesh_that_does_not_close_is_no_sector() {
    let block = || TetMesh::block([1.0, 1.0, 1.0], [1; 3]).unwrap();
    assert!(matches!(Sector::new(block(), 4, &TITANIUM_6AL_4V), Err(SectorError::Gap { .. })));
    assert!(matches!(Sector::new(block(), 1, &TITANIUM_6AL_4V), Err(SectorError::Few)));
}
