//! Tools as beams: round sections in series, clamped in the spindle, free at the tip.
//!
//! Timoshenko's beam, elements of two nodes, each with a deflection w and a rotation theta. Along an element of length l, x from 0 to 1,
//!
//! ```text
//! Phi = 12 E I / (kappa G A l^2),   kappa = 6 (1 + nu)^2 / (7 + 12 nu + 4 nu^2)                          (1)
//! w, theta: the deflection and rotation that a beam loaded at its ends alone has, of degree 3 and 2 in x   (2)
//! K = integral of E I theta' theta' + kappa G A (w' - theta)(w' - theta)                                (3)
//! M = integral of rho A w w + rho I theta theta, and the tip's mass                                     (4)
//! ```
//!
//! Source: Friedman, Kosmatka, An improved two-node Timoshenko beam finite element, Computers and Structures 47, 1993, for (2); kappa of the full circle:
//! Hutchinson, Shear coefficients for Timoshenko beam theory, J. Appl. Mech. 68, 2001. With Phi = 0 this is Euler and Bernoulli's beam.
//! A round section bends equally in all planes: one plane is solved, and each mode appears twice.

use nalgebra::{DMatrix, Matrix4, RowVector4, SymmetricEigen};

use arcfeed_fe::eigen::EigenError;
use arcfeed_fe::material::ElasticMaterial;
use arcfeed_modal::dynamics::modal::{Mode, ModeError};
use arcfeed_modal::flexible::modes_at;
use arcfeed_modal::modal_point::ModalPoint;
use arcfeed_units::T_PER_KG;

/// Cylindrical section of a tool that is modelled as a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamSection {
    /// Length along the axis.
    pub length_mm: f64,
    /// Outer diameter. For fluted parts: the diameter of a full bar of the same stiffness, about 0.8 of the cutting
    /// diameter (Kops, Vo, CIRP Annals 39, 1990).
    pub diameter_mm: f64,
    /// Material of the section.
    pub material: ElasticMaterial,
}

/// Beam model of a tool that is clamped at one end and free at the tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Beam {
    /// Sections from the clamp to the tip.
    pub sections: Vec<BeamSection>,
    /// Mass at the tip, without inertia of its own: an insert or a sensor.
    pub tip_mass_kg: f64,
    /// Number of elements in each section.
    pub elements: usize,
}

/// The bending modes of a tool in its own frame: z along the axis from the tip towards the clamp.
#[derive(Clone, Debug, PartialEq)]
pub struct BeamModes {
    /// Angular frequencies, the lowest first, in pairs: the mode along x, the mode along y.
    pub omega_rad_per_s: Vec<f64>,
    /// For each element from the clamp on: its beginning (distance from the clamp), its length, its Phi.
    spans: Vec<[f64; 3]>,
    /// For each pair of modes: deflection and rotation of all nodes.
    shapes: Vec<Vec<f64>>,
    length_mm: f64,
}

/// Four Gauss points on 0 to 1 and their weights, exact to degree 7.
const POINTS: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_71, 0.173_927_422_568_726_92],
    [0.330_009_478_207_571_9, 0.326_072_577_431_273_1],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_1],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_92],
];

/// Deflection per unit of w and theta at both ends (2).
fn deflection([length_mm, phi]: [f64; 2], x: f64) -> RowVector4<f64> {
    let c = 1.0 / (1.0 + phi);
    let l = length_mm;
    RowVector4::new(
        c * (1.0 - phi * x - 3.0 * x * x + 2.0 * x * x * x + phi),
        c * l * (x - 2.0 * x * x + x * x * x + 0.5 * phi * (x - x * x)),
        c * (phi * x + 3.0 * x * x - 2.0 * x * x * x),
        c * l * (x * x * x - x * x + 0.5 * phi * (x * x - x)),
    )
}

/// Rotation, and its derivative by the length (2).
fn rotation([length_mm, phi]: [f64; 2], x: f64) -> [RowVector4<f64>; 2] {
    let c = 1.0 / (1.0 + phi);
    let l = length_mm;
    let theta = RowVector4::new(
        c * 6.0 / l * (x * x - x),
        c * (1.0 - 4.0 * x + 3.0 * x * x + phi * (1.0 - x)),
        c * 6.0 / l * (x - x * x),
        c * (3.0 * x * x - 2.0 * x + phi * x),
    );
    let bend = RowVector4::new(
        c * 6.0 / l * (2.0 * x - 1.0),
        c * (6.0 * x - 4.0 - phi),
        c * 6.0 / l * (1.0 - 2.0 * x),
        c * (6.0 * x - 2.0 + phi),
    );
    [theta, bend / l]
}

impl BeamSection {
    fn area_mm2(&self) -> f64 {
        std::f64::consts::FRAC_PI_4 * self.diameter_mm * self.diameter_mm
    }

    fn inertia_mm4(&self) -> f64 {
        self.area_mm2() * self.diameter_mm * self.diameter_mm / 16.0
    }

    /// Shear stiffness kappa G A, N.
    fn shear_n(&self) -> f64 {
        let nu = self.material.poisson_ratio;
        let kappa = 6.0 * (1.0 + nu) * (1.0 + nu) / (7.0 + 12.0 * nu + 4.0 * nu * nu);
        kappa * self.material.lame_mpa()[1] * self.area_mm2()
    }

    /// Stiffness and mass of an element, and its Phi.
    fn matrices(&self, length_mm: f64) -> (Matrix4<f64>, Matrix4<f64>, f64) {
        let bending = self.material.young_mpa * self.inertia_mm4();
        let phi = 12.0 * bending / (self.shear_n() * length_mm * length_mm); // (1)
        let density = self.material.density_t_per_mm3();
        let (mut k, mut m) = (Matrix4::zeros(), Matrix4::zeros());
        for [x, weight] in POINTS {
            let w = deflection([length_mm, phi], x);
            let [theta, bend] = rotation([length_mm, phi], x);
            // The shear of (2) is constant along the element: w' - theta at x = 0.
            let slope = RowVector4::new(-phi, length_mm * (1.0 + 0.5 * phi), phi, -0.5 * phi * length_mm)
                / ((1.0 + phi) * length_mm);
            let shear = slope - rotation([length_mm, phi], 0.0)[0];
            let part = weight * length_mm;
            k += (bend.transpose() * bend * bending + shear.transpose() * shear * self.shear_n()) * part; // (3)
            let inertia = w.transpose() * w * self.area_mm2() + theta.transpose() * theta * self.inertia_mm4();
            m += inertia * (density * part); // (4)
        }
        (k, m, phi)
    }
}

impl Beam {
    /// Bending modes of the tool, `pairs` pairs (one along x, one along y) with the lowest frequencies.
    ///
    /// # Errors
    /// The tool has fewer modes, or a section has no length, diameter or mass.
    pub fn modes(&self, pairs: usize) -> Result<BeamModes, EigenError> {
        let elements = self.elements.max(1);
        let size = 2 * elements * self.sections.len();
        if pairs > size || size == 0 {
            return Err(EigenError::TooMany { size });
        }
        // With the clamped node, whose two rows are removed at the end.
        let (mut k, mut m) = (DMatrix::zeros(size + 2, size + 2), DMatrix::zeros(size + 2, size + 2));
        let (mut spans, mut from_mm) = (Vec::new(), 0.0);
        for (number, section) in
            self.sections.iter().flat_map(|section| std::iter::repeat_n(section, elements)).enumerate()
        {
            let length_mm = section.length_mm / elements as f64;
            let (of_k, of_m, phi) = section.matrices(length_mm);
            let mut at = k.fixed_view_mut::<4, 4>(2 * number, 2 * number);
            at += of_k;
            let mut at = m.fixed_view_mut::<4, 4>(2 * number, 2 * number);
            at += of_m;
            spans.push([from_mm, length_mm, phi]);
            from_mm += length_mm;
        }
        m[(size, size)] += self.tip_mass_kg * T_PER_KG;
        let (k, m) = (k.remove_rows(0, 2).remove_columns(0, 2), m.remove_rows(0, 2).remove_columns(0, 2));
        let (omega_rad_per_s, shapes) = solve(k, &m, pairs)?;
        Ok(BeamModes { omega_rad_per_s, spans, shapes, length_mm: from_mm })
    }
}

/// Lowest eigenvalues of `K x = lambda M x`, dense: with K = L L' the largest 1 / lambda of L^-1 M L'^-1, whose lowest
/// frequencies are the most exact.
fn solve(k: DMatrix<f64>, m: &DMatrix<f64>, pairs: usize) -> Result<(Vec<f64>, Vec<Vec<f64>>), EigenError> {
    let lower = k.cholesky().ok_or(EigenError::Singular)?.unpack();
    let half = lower.solve_lower_triangular(m).ok_or(EigenError::Singular)?.transpose();
    let whole = lower.solve_lower_triangular(&half).ok_or(EigenError::Singular)?;
    let eigen = SymmetricEigen::new(whole);
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|i, j| eigen.eigenvalues[*j].total_cmp(&eigen.eigenvalues[*i]));
    let mut modes = (Vec::new(), Vec::new());
    for mode in order.into_iter().take(pairs) {
        let omega = libm::sqrt(1.0 / eigen.eigenvalues[mode]);
        let y = eigen.eigenvectors.column(mode) * omega;
        let x = lower.tr_solve_lower_triangular(&y).ok_or(EigenError::Singular)?;
        // The clamped node's two, then all others.
        modes.1.push([0.0, 0.0].into_iter().chain(x.iter().copied()).collect());
        modes.0.extend([omega; 2]);
    }
    Ok(modes)
}

impl BeamModes {
    /// Natural frequencies in Hz, the lowest first, in pairs.
    pub fn frequencies_hz(&self) -> Vec<f64> {
        self.omega_rad_per_s.iter().map(|omega| omega / std::f64::consts::TAU).collect()
    }

    /// Sets `modal_point` to the mode shapes at a point of the tool, in the tool's frame. Sections stay plane, so a point off the axis
    /// also moves along it; a point below the tip moves like the tip's section.
    pub fn at(&self, point_mm: [f64; 3], modal_point: &mut ModalPoint) {
        let from_clamp_mm = self.length_mm - point_mm[2];
        let element = self.spans.iter().rposition(|[from_mm, _, _]| *from_mm <= from_clamp_mm).unwrap_or(0);
        let [from_mm, length_mm, phi] = self.spans[element];
        let x = ((from_clamp_mm - from_mm) / length_mm).clamp(0.0, 1.0);
        let (w, [theta, _]) = (deflection([length_mm, phi], x), rotation([length_mm, phi], x));
        let beyond_mm = from_clamp_mm - from_mm - x * length_mm;
        modal_point.shapes.clear();
        for shape in &self.shapes {
            let ends = nalgebra::Vector4::from_column_slice(&shape[2 * element..2 * element + 4]);
            let turn = (theta * ends)[0];
            let across = (w * ends)[0] + turn * beyond_mm;
            // The axis runs from the clamp along -z: a positive rotation lifts points at positive x.
            modal_point.shapes.push([across, 0.0, turn * point_mm[0]]);
            modal_point.shapes.push([0.0, across, turn * point_mm[1]]);
        }
    }

    /// Modes of the tool at one of its points, all with the same damping.
    ///
    /// # Errors
    /// The damping is out of range.
    pub fn modes_at(&self, point_mm: [f64; 3], damping_ratio: f64) -> Result<Vec<Mode>, ModeError> {
        let mut modal_point = ModalPoint::default();
        self.at(point_mm, &mut modal_point);
        modes_at(&self.omega_rad_per_s, &modal_point, damping_ratio)
    }
}
