//! Vibrating body: its displacement at any point, and the material point at any position.
//!
//! ```text
//! phi_r(X) = sum over the element's nodes of N_a(X) phi_ra                       (1)
//! Phi(X)   = X + u(X)                                                            (2)
//! Phi^-1(x): X <- x - u(X), again and again, u from the last point first          (3)
//! ```
//!
//! Source: Lorong et al., 2012: (1) is [H(X)] of its (7), (2) the map of its section 3.1. There a separate mesh extends
//! the map outside the part; here the functions of the nearest element do, evaluated beyond its border, as far as the
//! reach. Each iteration of (3) reduces the error by the strain.

use arcfeed_modal::dynamics::modal::{Mode, ModeError};
use arcfeed_modal::flexible::{Modal, modes_at};
use arcfeed_modal::modal_point::ModalPoint;

use super::body::Modes;
use super::locate::{LocatedPoint, Locator, TooFar};
use super::mesh::TetMesh;
use super::tetrahedron::functions;

/// Change of X at which (3) ends.
const STILL_MM: f64 = 1e-10;

/// Largest number of iterations of (3). With strains below 0.1 ten would suffice.
const ROUNDS: usize = 30;

/// Modes of a vibrating body, with the search for the mode shapes at any point of it.
#[derive(Clone, Debug)]
pub struct Field {
    mesh: TetMesh,
    locator: Locator,
    /// Shapes by nodes, and for each node by modes: the data of one point are adjacent.
    shapes: Vec<Vec<[f64; 3]>>,
    omega_rad_per_s: Vec<f64>,
}

impl Field {
    /// Field for the modes of a mesh; `reach_mm` is the largest distance of points outside: at most about the thickness
    /// of an element, see docs/fe.md.
    pub fn new(mesh: TetMesh, modes: &Modes, reach_mm: f64) -> Self {
        let at_node = |node| modes.shapes.iter().map(|shape| shape[node]).collect();
        let shapes = (0..mesh.nodes_mm().len()).map(at_node).collect();
        let locator = Locator::new(&mesh, reach_mm);
        Field { mesh, locator, shapes, omega_rad_per_s: modes.omega_rad_per_s.clone() }
    }

    /// Angular frequencies of the modes, rad/s.
    pub fn omega_rad_per_s(&self) -> &[f64] {
        &self.omega_rad_per_s
    }

    /// Sets `modal_point` to the mode shapes at a point of the undeformed body; returns the point's distance outside the body, mm. A
    /// point near the previous one is found fastest.
    ///
    /// # Errors
    /// The point is beyond the reach.
    pub fn at(&self, point_mm: [f64; 3], modal_point: &mut ModalPoint) -> Result<f64, TooFar> {
        let found = self.locator.find(&self.mesh, point_mm, modal_point.element)?;
        self.evaluate(&found, modal_point);
        Ok(found.outside_mm)
    }

    /// Sets `modal_point` to a point or, if that is outside by more than `beyond_mm`, to the point at that distance
    /// from the body on the line from the nearest point of the body. Returns the distance of the point outside, mm.
    /// Beyond the reach all elements are searched, which takes time.
    pub fn at_nearest(&self, point_mm: [f64; 3], beyond_mm: f64, modal_point: &mut ModalPoint) -> f64 {
        let found = self.locator.find_nearest(&self.mesh, point_mm, beyond_mm, modal_point.element);
        if let Some(found) = &found {
            self.evaluate(found, modal_point);
        }
        found.map_or(f64::INFINITY, |found| found.outside_mm)
    }

    /// Modes with the same damping and the largest shape along each axis at any node.
    ///
    /// # Errors
    /// The damping is out of range.
    pub fn largest_modes(&self, damping_ratio: f64) -> Result<Vec<Mode>, ModeError> {
        let largest = |mode: usize| {
            let at_nodes = self.shapes.iter().map(|shapes| shapes[mode].map(libm::fabs));
            at_nodes.fold([0.0; 3], |one, other| std::array::from_fn(|axis| f64::max(one[axis], other[axis])))
        };
        let shapes = (0..self.omega_rad_per_s.len()).map(largest).collect();
        modes_at(&self.omega_rad_per_s, &ModalPoint { shapes, element: None }, damping_ratio)
    }

    /// Largest distance, mm, of points outside the body for which mode shapes are extrapolated.
    pub fn reach_mm(&self) -> f64 {
        self.locator.reach_mm()
    }

    /// Mesh of the body.
    pub fn mesh(&self) -> &TetMesh {
        &self.mesh
    }

    /// Evaluates (1) at a located point.
    fn evaluate(&self, found: &LocatedPoint, modal_point: &mut ModalPoint) {
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

    /// Point of the undeformed body whose material is now at `now_mm`, for these modal amplitudes, mm; sets `modal_point` to the mode
    /// shapes there. The search starts at the point that `modal_point` has, if any.
    ///
    /// # Errors
    /// The point is beyond the reach.
    pub fn material_point_mm(
        &self,
        now_mm: [f64; 3],
        amplitudes: &[f64],
        modal_point: &mut ModalPoint,
    ) -> Result<[f64; 3], TooFar> {
        material_point_mm(now_mm, amplitudes, modal_point, |point_mm, modal_point| self.at(point_mm, modal_point))
    }
}

impl Modal for Field {
    fn omega_rad_per_s(&self) -> &[f64] {
        self.omega_rad_per_s()
    }

    fn reach_mm(&self) -> f64 {
        self.reach_mm()
    }

    fn evaluate_at(&self, point_mm: [f64; 3], beyond_mm: f64, modal_point: &mut ModalPoint) {
        self.at_nearest(point_mm, beyond_mm, modal_point);
    }
}

/// Iteration (3) of [`Field::material_point_mm`] for any body; `at` is its [`Field::at`].
///
/// # Errors
/// The same as for `at`.
pub fn material_point_mm(
    now_mm: [f64; 3],
    amplitudes: &[f64],
    modal_point: &mut ModalPoint,
    at: impl Fn([f64; 3], &mut ModalPoint) -> Result<f64, TooFar>,
) -> Result<[f64; 3], TooFar> {
    let before = |modal_point: &ModalPoint| -> [f64; 3] {
        let u_mm = modal_point.displacement_mm(amplitudes);
        std::array::from_fn(|axis| now_mm[axis] - u_mm[axis])
    };
    let mut point_mm = before(modal_point);
    for _ in 0..ROUNDS {
        at(point_mm, modal_point)?;
        let next_mm = before(modal_point); // (3)
        let moved_mm = (0..3).map(|axis| (next_mm[axis] - point_mm[axis]).abs()).fold(0.0, f64::max);
        point_mm = next_mm;
        if moved_mm < STILL_MM {
            break;
        }
    }
    Ok(point_mm)
}
