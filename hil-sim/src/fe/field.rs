//! A vibrating body: its displacement at any point, and which of its points is where.
//!
//! ```text
//! phi_r(X) = sum over the element's nodes of N_a(X) phi_ra                       (1)
//! Phi(X)   = X + u(X)                                                            (2)
//! Phi^-1(x): X <- x - u(X), again and again, u from the last point first          (3)
//! ```
//!
//! Source: Lorong et al., 2012: (1) is [H(X)] of its (7), (2) the map of its section 3.1. There it is carried on outside of the part by a mesh of its own; here
//! by the functions of the nearest element, evaluated beyond its border, as far as the reach. (3) comes closer by the strain each time.

use super::body::Modes;
use super::locate::{Found, Locator, TooFar};
use super::mesh::Mesh;
use super::modal_point::ModalPoint;
use super::tetrahedron::functions;

/// Change of X below which (3) is at its end.
const STILL_MM: f64 = 1e-10;

/// Rounds of (3). With strains below 0.1 ten would do.
const ROUNDS: usize = 30;

/// A mesh, its modes, and a way to find points in it.
#[derive(Clone, Debug)]
pub struct Field {
    mesh: Mesh,
    locator: Locator,
    /// By nodes, and of each node by modes: what one point needs lies together.
    shapes: Vec<Vec<[f64; 3]>>,
    omega_rad_per_s: Vec<f64>,
}

impl Field {
    /// The modes of a mesh, and how far outside of it points may be: at most about the thickness of an element, see docs/fe.md.
    pub fn new(mesh: Mesh, modes: &Modes, reach_mm: f64) -> Self {
        let at_node = |node| modes.shapes.iter().map(|shape| shape[node]).collect();
        let shapes = (0..mesh.nodes_mm().len()).map(at_node).collect();
        let locator = Locator::new(&mesh, reach_mm);
        Field { mesh, locator, shapes, omega_rad_per_s: modes.omega_rad_per_s.clone() }
    }

    /// Angular frequencies of the modes, rad/s.
    pub fn omega_rad_per_s(&self) -> &[f64] {
        &self.omega_rad_per_s
    }

    /// Sets `modal_point` to a point of the undeformed body and answers how far outside it is, mm. One that was near before is found fastest.
    ///
    /// # Errors
    /// The point is beyond the reach.
    pub fn at(&self, point_mm: [f64; 3], modal_point: &mut ModalPoint) -> Result<f64, TooFar> {
        let found = self.locator.find(&self.mesh, point_mm, modal_point.element)?;
        self.stand(&found, modal_point);
        Ok(found.outside_mm)
    }

    /// Sets `modal_point` to a point, or, if that is outside by more than `beyond_mm`, to the one that far from the body on the way to it from the nearest point
    /// of the body; answers how far outside the point is, mm. Beyond the reach all elements are looked at, which takes its time.
    pub fn carried(&self, point_mm: [f64; 3], beyond_mm: f64, modal_point: &mut ModalPoint) -> f64 {
        let found = self.locator.carried(&self.mesh, point_mm, beyond_mm, modal_point.element);
        if let Some(found) = &found {
            self.stand(found, modal_point);
        }
        found.map_or(f64::INFINITY, |found| found.outside_mm)
    }

    /// The largest displacement of each mode along each axis at any node, 1/sqrt(t).
    pub fn largest_shapes(&self) -> Vec<[f64; 3]> {
        let largest = |mode: usize| {
            let at_nodes = self.shapes.iter().map(|shapes| shapes[mode].map(libm::fabs));
            at_nodes.fold([0.0; 3], |one, other| std::array::from_fn(|axis| f64::max(one[axis], other[axis])))
        };
        (0..self.omega_rad_per_s.len()).map(largest).collect()
    }

    /// How far outside of the body points may be.
    pub fn reach_mm(&self) -> f64 {
        self.locator.reach_mm()
    }

    /// The nodes and the elements between them.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// (1)
    fn stand(&self, found: &Found, modal_point: &mut ModalPoint) {
        modal_point.element = Some(found.element);
        modal_point.shapes.clear();
        modal_point.shapes.resize(self.omega_rad_per_s.len(), [0.0; 3]);
        for (node, n) in self.mesh.elements()[found.element].iter().zip(functions(found.place)) {
            for (sum, shape) in modal_point.shapes.iter_mut().zip(&self.shapes[*node]) {
                for axis in 0..3 {
                    sum[axis] += n * shape[axis];
                }
            }
        }
    }

    /// Which point of the undeformed body is now at `now_mm`; `modal_point`, at a point nearby or at none, is set to it.
    ///
    /// # Errors
    /// The point is beyond the reach.
    pub fn material_point_mm(
        &self,
        now_mm: [f64; 3],
        amplitudes: &[f64],
        modal_point: &mut ModalPoint,
    ) -> Result<[f64; 3], TooFar> {
        settled_mm(now_mm, modal_point.displacement_mm(amplitudes), |point_mm| {
            self.at(point_mm, modal_point)?;
            Ok(modal_point.displacement_mm(amplitudes))
        })
    }
}

/// (3), with u as told, and first as it was nearby.
pub(super) fn settled_mm(
    now_mm: [f64; 3],
    near_mm: [f64; 3],
    mut displacement_mm: impl FnMut([f64; 3]) -> Result<[f64; 3], TooFar>,
) -> Result<[f64; 3], TooFar> {
    let before = |u_mm: [f64; 3]| -> [f64; 3] { std::array::from_fn(|axis| now_mm[axis] - u_mm[axis]) };
    let mut point_mm = before(near_mm);
    for _ in 0..ROUNDS {
        let next_mm = before(displacement_mm(point_mm)?); // (3)
        let moved_mm = (0..3).map(|axis| (next_mm[axis] - point_mm[axis]).abs()).fold(0.0, f64::max);
        point_mm = next_mm;
        if moved_mm < STILL_MM {
            break;
        }
    }
    Ok(point_mm)
}
