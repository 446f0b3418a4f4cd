//! The sparse eigenproblem against a dense one, and what its answers must satisfy.

use arcfeed_blades::blade::Blade;
use arcfeed_fe::body::Body;
use arcfeed_fe::eigen::{EigenError, below, lowest};
use arcfeed_fe::material::TITANIUM_6AL_4V;
use arcfeed_fe::mesh::TetMesh;
use arcfeed_fe::sparse::Sparse;
use arcfeed_fe::unknowns::Unknowns;
use nalgebra::{DMatrix, DVector};

pub fn dense(matrix: &Sparse) -> DMatrix<f64> {
    let columns = (0..matrix.size()).map(|column| {
        let mut unit = vec![0.0; matrix.size()];
        unit[column] = 1.0;
        DVector::from_vec(matrix.times(&unit))
    });
    DMatrix::from_columns(&columns.collect::<Vec<_>>())
}

/// All eigenvalues of a dense K x = lambda M x, rising.
pub fn all_of_dense(k: &Sparse, m: &Sparse) -> Vec<f64> {
    let lower = dense(k).cholesky().unwrap().unpack();
    let half = lower.solve_lower_triangular(&dense(m)).unwrap().transpose();
    let inverse = lower.solve_lower_triangular(&half).unwrap();
    let mut values: Vec<f64> = inverse.symmetric_eigenvalues().iter().map(|theta| 1.0 / theta).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn matrices(cells: [usize; 3]) -> (Sparse, Sparse) {
    let blade = Blade { stagger_rad: [0.2, 0.6], camber_rad: [0.4; 2], ..Blade::plate(40.0, 30.0, 3.0) };
    let body = Body::new(blade.mesh(cells, 0.5).unwrap(), &TITANIUM_6AL_4V);
    body.matrices(&Unknowns::clamped(body.mesh(), &Blade::foot(body.mesh())))
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn eigenvalues_are_those_of_a_dense_solver() {
    let (k, m) = matrices([3, 1, 3]);
    let truth = all_of_dense(&k, &m);
    for count in [1, 7, 40, k.size()] {
        let ours = lowest(&k, &m, count).unwrap();
        assert_eq!(ours.len(), count);
        for (pair, truth) in ours.iter().zip(&truth) {
            let error = (pair.lambda_per_s2 / truth - 1.0).abs();
            assert!(error < 1e-8, "{count} wanted: {} {truth}", pair.lambda_per_s2);
        }
    }
}

#[test]
fn vectors_solve_the_equation_are_orthonormal_in_the_mass_and_none_is_missed() {
    let (k, m) = matrices([6, 1, 8]);
    let pairs = lowest(&k, &m, 20).unwrap();
    for (i, a) in pairs.iter().enumerate() {
        let (force, inertia) = (k.times(&a.vector), m.times(&a.vector));
        let left: Vec<f64> = force.iter().zip(&inertia).map(|(f, i)| f - a.lambda_per_s2 * i).collect();
        let residual = libm::sqrt(product(&left, &left) / product(&force, &force));
        assert!(residual < 1e-6, "mode {i}: {residual:.1e}");
        for (j, b) in pairs.iter().enumerate() {
            let wanted = if i == j { 1.0 } else { 0.0 };
            assert!((product(&b.vector, &inertia) - wanted).abs() < 1e-11, "modes {i} and {j}");
        }
    }
    for (i, pair) in pairs.iter().enumerate() {
        assert_eq!(below(&k, &m, pair.lambda_per_s2 * (1.0 + 1e-6)), Ok(i + 1));
    }
}

/// The thinner, the more of a solid's stiffness cancels out in bending: rounding grows with the fourth power of span over thickness (docs/fe.md).
#[test]
fn a_thin_sheet_is_solved_as_a_plate_is() {
    for thickness_mm in [0.5, 0.2] {
        let body = Body::new(Blade::plate(100.0, 100.0, thickness_mm).mesh([6, 1, 8], 0.5).unwrap(), &TITANIUM_6AL_4V);
        let (k, m) = body.matrices(&Unknowns::clamped(body.mesh(), &Blade::foot(body.mesh())));
        let pairs = lowest(&k, &m, 6).unwrap();
        for (i, pair) in pairs.iter().enumerate() {
            assert_eq!(below(&k, &m, pair.lambda_per_s2 * (1.0 - 1e-4)), Ok(i), "{thickness_mm} mm");
            assert_eq!(below(&k, &m, pair.lambda_per_s2 * (1.0 + 1e-4)), Ok(i + 1), "{thickness_mm} mm");
        }
    }
}

#[test]
fn repeated_eigenvalues_are_all_found() {
    // A square bar bends in two planes alike.
    let mesh = TetMesh::block([6.0, 6.0, 40.0], [2, 2, 4]).unwrap();
    let body = Body::new(mesh, &TITANIUM_6AL_4V);
    let clamped = body.mesh().nodes_where(|place| place[2] == 0);
    let modes = body.modes(&clamped, 2).unwrap();
    assert!((modes.omega_rad_per_s[1] / modes.omega_rad_per_s[0] - 1.0).abs() < 1e-3);
    // Diagonal: eigenvalues 1, 1, 1, 2, 2, 2, and so on.
    let of = |value: fn(usize) -> f64| Sparse::from_rows((0..60).map(|i| vec![(i, value(i))]).collect());
    let pairs = lowest(&of(|i| (i / 3 + 1) as f64), &of(|_| 1.0), 9).unwrap();
    let values: Vec<f64> = pairs.iter().map(|pair| libm::round(pair.lambda_per_s2 * 1e9) / 1e9).collect();
    assert_eq!(values, [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0]);
}

#[test]
fn a_body_that_nothing_holds_is_refused() {
    let body = Body::new(TetMesh::block([1.0; 3], [1; 3]).unwrap(), &TITANIUM_6AL_4V);
    assert_eq!(body.modes(&[], 1), Err(EigenError::Singular));
    let clamped = body.mesh().nodes_where(|place| place[2] == 0);
    assert_eq!(body.modes(&clamped, 55), Err(EigenError::TooMany { size: 54 }));
    assert!(body.modes(&clamped, 54).is_ok());
}
