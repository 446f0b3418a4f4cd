//! Mode shapes at one point of a body.
//!
//! With the mass-normalised shapes phi_r of the modes and their amplitudes q_r (mm sqrt(t)),
//!
//! ```text
//! u(X) = sum over r of phi_r(X) q_r                                              (1)
//! Q_r  = phi_r(X) . F                                                            (2)
//! q_r'' + 2 zeta_r omega_r q_r' + omega_r^2 q_r = Q_r                            (3)
//! ```
//!
//! Source: Lorong et al., Simulation of a finishing operation, 2012: (1) is its (7) and (8), (2) its (4) and (6), both
//! reduced to modes (its section 1). [`crate::dynamics`] integrates (3); F in N and X in mm give seconds, with masses
//! in t.

/// Mode shapes at one point of a body, with the element of the point, at which the search for the next point starts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModalPoint {
    /// Mode by mode, the mass-normalised shape phi_r(X) at the point, 1/sqrt(t).
    pub shapes: Vec<[f64; 3]>,
    /// Element of the mesh in which the point is.
    pub element: Option<usize>,
}

impl ModalPoint {
    /// Displacement of the point, mm, for these modal amplitudes, mm sqrt(t). (1)
    pub fn displacement_mm(&self, amplitudes: &[f64]) -> [f64; 3] {
        let mut u_mm = [0.0; 3];
        for (shape, amplitude) in self.shapes.iter().zip(amplitudes) {
            for axis in 0..3 {
                u_mm[axis] += shape[axis] * amplitude; // (1)
            }
        }
        u_mm
    }

    /// Adds to the modal forces `onto`, N/sqrt(t), the effect of a force at the point. (2)
    pub fn add_force(&self, force_n: [f64; 3], onto: &mut [f64]) {
        for (modal, shape) in onto.iter_mut().zip(&self.shapes) {
            *modal += (0..3).map(|axis| shape[axis] * force_n[axis]).sum::<f64>(); // (2)
        }
    }
}
