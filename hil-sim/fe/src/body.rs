//! Vibration modes of a body of one material.

use super::eigen::{EigenError, Eigenpair, lowest};
use super::element::{Mass, Stiffness, mass, stiffness};
use super::material::ElasticMaterial;
use super::mesh::TetMesh;
use super::sparse::Sparse;
use super::unknowns::Unknowns;

/// Body of one elastic material: a mesh with the stiffness and mass matrices of its elements.
#[derive(Clone, Debug)]
pub struct Body {
    mesh: TetMesh,
    elements: Vec<(Stiffness, Mass)>,
}

/// Vibration modes of a body: angular frequencies and shapes, the lowest frequency first.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// Angular frequencies.
    pub omega_rad_per_s: Vec<f64>,
    /// Mode by mode, the displacements of all nodes, 1/sqrt(t), scaled to a modal mass of one.
    pub shapes: Vec<Vec<[f64; 3]>>,
}

impl Modes {
    /// Natural frequencies in Hz, the lowest first.
    pub fn frequencies_hz(&self) -> Vec<f64> {
        self.omega_rad_per_s.iter().map(|omega| omega / std::f64::consts::TAU).collect()
    }
}

impl Body {
    /// Body with this mesh, of this material.
    pub fn new(mesh: TetMesh, material: &ElasticMaterial) -> Self {
        let of = |element| {
            let nodes_mm = mesh.nodes_of_mm(element);
            (stiffness(&nodes_mm, material), mass(&nodes_mm, material))
        };
        let elements = (0..mesh.elements().len()).map(of).collect();
        Body { mesh, elements }
    }

    /// Mesh of the body.
    pub fn mesh(&self) -> &TetMesh {
        &self.mesh
    }

    /// Stiffness (N/mm) and mass (t) matrices for these unknowns.
    pub fn matrices(&self, unknowns: &Unknowns) -> (Sparse, Sparse) {
        unknowns.assemble(&self.mesh, &self.elements)
    }

    /// Mass of the body in tonnes.
    pub fn mass_t(&self) -> f64 {
        self.elements.iter().map(|(_, mass)| mass.sum()).sum()
    }

    /// The `count` modes with the lowest frequencies, with these nodes clamped.
    ///
    /// # Errors
    /// The clamped nodes do not hold the body, or it has fewer modes.
    pub fn modes(&self, clamped: &[usize], count: usize) -> Result<Modes, EigenError> {
        let unknowns = Unknowns::clamped(&self.mesh, clamped);
        let (k, m) = self.matrices(&unknowns);
        let pairs = lowest(&k, &m, count)?;
        Ok(Modes {
            omega_rad_per_s: pairs.iter().map(Eigenpair::omega_rad_per_s).collect(),
            shapes: pairs.iter().map(|pair| unknowns.displacements(0, &pair.vector)).collect(),
        })
    }
}
