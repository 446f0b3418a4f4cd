//! Stiffness and mass of one ten-node tetrahedron.
//!
//! With g_a the gradient of the function of node a in space and lambda, mu Lame's constants, blocks of three by three:
//!
//! ```text
//! K_ab = integral of  lambda g_a g_b' + mu g_b g_a' + mu (g_a . g_b) 1        (1)
//! M_ab = 1 integral of  rho N_a N_b                                          (2)
//! ```
//!
//! Source: Hughes, The Finite Element Method, 2000, chapter 2 (the isotropic case of B' D B, written out). (1) at four points, (2) at fourteen: both are exact
//! for straight edges; on bent ones (1) is the value of the rule, as is usual.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::material::ElasticMaterial;
use super::tetrahedron::{NODES, NaturalCoordinates, derivatives, four_points, fourteen_points, functions};

/// Stiffness: the three directions of a node follow each other.
pub type Stiffness = SMatrix<f64, 30, 30>;

/// Mass, the same in all three directions.
pub type Mass = SMatrix<f64, 10, 10>;

/// Derivatives of the position (rows) by the reference coordinates (columns), mm.
pub fn jacobian(nodes_mm: &[[f64; 3]; NODES], place: NaturalCoordinates) -> Matrix3<f64> {
    let mut jacobian = Matrix3::zeros();
    for (node_mm, derivative) in nodes_mm.iter().zip(derivatives(place)) {
        jacobian += Vector3::from(*node_mm) * Vector3::from(derivative).transpose();
    }
    jacobian
}

/// Gradients of the functions in space, per mm, and the determinant of the Jacobian; `None` if the element has no
/// volume.
fn gradients(nodes_mm: &[[f64; 3]; NODES], place: NaturalCoordinates) -> Option<([Vector3<f64>; NODES], f64)> {
    let jacobian = jacobian(nodes_mm, place);
    let inverse = jacobian.try_inverse()?.transpose();
    Some((derivatives(place).map(|d| inverse * Vector3::from(d)), jacobian.determinant()))
}

/// Stiffness matrix, N/mm.
pub fn stiffness(nodes_mm: &[[f64; 3]; NODES], material: &ElasticMaterial) -> Stiffness {
    let [lambda, mu] = material.lame_mpa();
    let mut k = Stiffness::zeros();
    for (place, weight) in four_points() {
        let Some((g, volume)) = gradients(nodes_mm, place) else { continue };
        for a in 0..NODES {
            for b in 0..NODES {
                let shear = g[b] * g[a].transpose() + Matrix3::identity() * g[a].dot(&g[b]);
                let block = (g[a] * g[b].transpose() * lambda + shear * mu) * (weight * volume); // (1)
                let mut at = k.fixed_view_mut::<3, 3>(3 * a, 3 * b);
                at += block;
            }
        }
    }
    k
}

/// Consistent mass matrix, t.
pub fn mass(nodes_mm: &[[f64; 3]; NODES], material: &ElasticMaterial) -> Mass {
    let mut m = Mass::zeros();
    for (place, weight) in fourteen_points() {
        let n = SMatrix::<f64, NODES, 1>::from(functions(place));
        let volume = jacobian(nodes_mm, place).determinant();
        m += n * n.transpose() * (material.density_t_per_mm3() * weight * volume); // (2)
    }
    m
}

#[cfg(test)]
mod tests {
    use super::super::material::STEEL;
    use super::super::mesh::TetMesh;
    use super::*;

    fn bent() -> TetMesh {
        TetMesh::mapped([1, 1, 1], |_| true, |[x, y, z]| [x + 0.1 * y * y, 2.0 * y + 0.2 * z * x, z - 0.1 * x * x])
            .unwrap()
    }

    #[test]
    fn rigid_motion_takes_no_force() {
        let mesh = bent();
        for element in 0..6 {
            let nodes_mm = mesh.nodes_of_mm(element);
            let k = stiffness(&nodes_mm, &STEEL);
            for motion in 0..6 {
                let turn = Vector3::ith(motion % 3, 1.0);
                let u = nodes_mm.map(|x| if motion < 3 { turn } else { turn.cross(&Vector3::from(x)) });
                let u = SMatrix::<f64, 30, 1>::from_iterator(u.iter().flat_map(|u| u.iter().copied()));
                assert!((k * u).amax() < 1e-11 * k.amax(), "motion {motion}");
            }
        }
    }

    #[test]
    fn uniform_strain_has_the_energy_of_hookes_law() {
        let mesh = TetMesh::mapped([1, 1, 1], |_| true, |[x, y, z]| [x + 0.3 * y, 2.0 * y, 0.5 * z + 0.2 * x]).unwrap();
        let [lambda, mu] = STEEL.lame_mpa();
        // u = (1e-3 x + 2e-3 y, 0, -1e-3 z): strains 1e-3, -1e-3, shear 2e-3; volume 1 mm3.
        let energy: f64 = (0..6)
            .map(|element| {
                let u = mesh.nodes_of_mm(element).map(|x| [1e-3 * x[0] + 2e-3 * x[1], 0.0, -1e-3 * x[2]]);
                let u = SMatrix::<f64, 30, 1>::from_iterator(u.into_iter().flatten());
                0.5 * (u.transpose() * stiffness(&mesh.nodes_of_mm(element), &STEEL) * u)[0]
            })
            .sum();
        let truth = 0.5 * lambda * 0.0 + mu * (2.0 * 1e-6) + 0.5 * mu * 4e-6;
        assert!((energy / truth - 1.0).abs() < 1e-12, "{energy} {truth}");
    }

    #[test]
    fn the_mass_of_a_bent_body_is_density_times_volume() {
        // x = X, y = Y, z = Z (1 + X^2 / 4): volume 1 + 1/12.
        let mesh = TetMesh::mapped([1, 1, 1], |_| true, |[x, y, z]| [x, y, z * (1.0 + 0.25 * x * x)]).unwrap();
        let sum: f64 = (0..6).map(|element| mass(&mesh.nodes_of_mm(element), &STEEL).sum()).sum();
        let interpolated = sum / STEEL.density_t_per_mm3();
        // A quadratic element represents z x^2 except for its cubic part.
        assert!((interpolated - 13.0 / 12.0).abs() < 2e-3, "{interpolated}");
    }
}
