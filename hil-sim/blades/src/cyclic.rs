//! Modes of a body of equal sectors from the mesh of one sector.
//!
//! With alpha = 2 pi / N and R the rotation about the axis, a mode with d nodal diameters is a wave around the disk
//! with the complex shape a + i b:
//!
//! ```text
//! u_s = R(s alpha) Re((a + i b) e^(i d s alpha)) = R(s alpha) (a cos(d s alpha) - b sin(d s alpha))       (1)
//! right face: a_right = R(alpha) (cos(d alpha) a_left - sin(d alpha) b_left)
//!             b_right = R(alpha) (sin(d alpha) a_left + cos(d alpha) b_left)                              (2)
//! T' diag(K, K) T x = lambda T' diag(M, M) T x                                                            (3)
//! ```
//!
//! (2) defines T. The Hermitian problem of the sector becomes the real one (3) of twice its size, in which every
//! eigenvalue appears twice; both vectors are modes of the disk. For d = 0 and d = N/2 there is no b. A mode of unit
//! mass in (3) has the mass N/2 on all sectors, or N without b, and modes orthogonal there are orthogonal on the disk.
//! Source: Thomas, Dynamics of rotationally periodic structures, Int. J. Numer. Meth. Engng 14, 1979.

use std::f64::consts::TAU;
use std::fmt;

use arcfeed_fe::body::Body;
use arcfeed_fe::eigen::{EigenError, Eigenpair, lowest};
use arcfeed_fe::material::ElasticMaterial;
use arcfeed_fe::mesh::TetMesh;
use arcfeed_fe::unknowns::{MappingRow, Unknowns, numbers};

use crate::disk::turned;

/// Largest difference between left and right face, as a fraction of the distance from the axis.
const GAP_RATIO: f64 = 1e-9;

/// One of the equal sectors of a disk; the disk's axis is z, and the first axis of the mesh's lattice runs around it.
#[derive(Clone, Debug)]
pub struct Sector {
    body: Body,
    sectors: usize,
    /// For each node on the right face, its pair on the left.
    left: Vec<Option<usize>>,
}

/// Vibration mode of a whole disk: a wave around it, described by the displacements in one sector.
#[derive(Clone, Debug, PartialEq)]
pub struct Wave {
    /// Angular frequency.
    pub omega_rad_per_s: f64,
    /// Number of nodal diameters: waves around the disk.
    pub diameters: usize,
    /// Real part a at the sector's nodes, 1/sqrt(t), scaled to a modal mass of one for the whole disk.
    pub real: Vec<[f64; 3]>,
    /// Imaginary part b at the sector's nodes, scaled like the real part.
    pub imaginary: Vec<[f64; 3]>,
}

/// Reason why a mesh is not a sector of a disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SectorError {
    /// A disk needs at least two sectors.
    Few,
    /// A node on the right face has no pair on the left.
    Unpaired {
        /// Index of that node.
        node: usize,
    },
    /// A node on the right face differs from the rotated node of the left face.
    Gap {
        /// Index of the node on the right face.
        node: usize,
        /// Distance between the two.
        gap_mm: f64,
    },
}

impl fmt::Display for SectorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SectorError::Few => write!(f, "a disk has two sectors or more"),
            SectorError::Unpaired { node } => write!(f, "node {node} of the sector's right face has none on the left"),
            SectorError::Gap { node, gap_mm } => {
                write!(
                    f,
                    "node {node} of the sector's right face is {gap_mm} mm from where the left face is after the turn"
                )
            }
        }
    }
}

impl std::error::Error for SectorError {}

impl Sector {
    /// Sector with this mesh and material, one of `sectors` equal ones.
    ///
    /// # Errors
    /// The left and the right face of the mesh do not match, or there are fewer than two sectors.
    pub fn new(mesh: TetMesh, sectors: usize, material: &ElasticMaterial) -> Result<Self, SectorError> {
        if sectors < 2 {
            return Err(SectorError::Few);
        }
        let right = 2 * mesh.cells()[0];
        let mut left = vec![None; mesh.nodes_mm().len()];
        for node in mesh.nodes_where(|place| place[0] == right) {
            let [_, along, outwards] = mesh.places()[node];
            let pair = mesh.places().iter().position(|place| *place == [0, along, outwards]);
            let pair = pair.ok_or(SectorError::Unpaired { node })?;
            let (there, here) = (turned(mesh.nodes_mm()[pair], TAU / sectors as f64), mesh.nodes_mm()[node]);
            let gap_mm = (0..3).map(|axis| (there[axis] - here[axis]).abs()).fold(0.0, f64::max);
            if gap_mm > GAP_RATIO * libm::hypot(here[0], here[1]) {
                return Err(SectorError::Gap { node, gap_mm });
            }
            left[node] = Some(pair);
        }
        Ok(Sector { body: Body::new(mesh, material), sectors, left })
    }

    /// Body of one sector.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Number of sectors of the disk.
    pub fn sectors(&self) -> usize {
        self.sectors
    }

    /// Whether waves with this number of diameters are standing waves: one mode each, not a pair.
    fn is_single(&self, diameters: usize) -> bool {
        diameters == 0 || 2 * diameters == self.sectors
    }

    /// T of (2), real and imaginary part.
    fn unknowns(&self, clamped: &[usize], diameters: usize) -> Unknowns {
        let mut leaders: Vec<Option<usize>> =
            (0..self.left.len()).map(|node| Some(self.left[node].unwrap_or(node))).collect();
        for node in clamped {
            leaders[*node] = None;
            leaders[self.left[*node].unwrap_or(*node)] = None;
        }
        let numbers = numbers(self.body.mesh(), &leaders);
        let parts = if self.is_single(diameters) { 1 } else { 2 };
        let count = numbers.iter().flatten().max().map_or(0, |last| 3 * parts * (last + 1));
        let alpha = TAU / self.sectors as f64;
        let (sin, cos) = libm::sincos(diameters as f64 * alpha);
        // For each part, the coefficients of a and b on the left.
        let of_left = [[cos, -sin], [sin, cos]];
        let row = |part: usize, node: usize, axis: usize| -> MappingRow {
            let Some(number) = numbers[node] else { return MappingRow::new() };
            let first = 3 * parts * number;
            if self.left[node].is_none() {
                return vec![(first + 3 * part + axis, 1.0)];
            }
            let mut row = MappingRow::new();
            for from in 0..3 {
                let turn = turned(std::array::from_fn(|k| if k == from { 1.0 } else { 0.0 }), alpha)[axis];
                let of_parts = of_left[part][..parts].iter().enumerate();
                row.extend(of_parts.map(|(other, factor)| (first + 3 * other + from, turn * factor)));
            }
            row.retain(|(_, coefficient)| *coefficient != 0.0);
            row
        };
        let nodes = 0..self.left.len();
        let of_part = |part| {
            nodes.clone().flat_map(|node| (0..3).map(move |axis| (node, axis))).map(|(n, a)| row(part, n, a)).collect()
        };
        Unknowns::from_rows((0..parts).map(of_part).collect(), count)
    }

    /// The `count` modes of the disk with the lowest frequencies that have `diameters` nodal diameters. Except for 0 and N/2 diameters
    /// they come in pairs. `clamped` are nodes of the sector.
    ///
    /// # Errors
    /// The clamped nodes do not hold the disk, or it has fewer modes.
    pub fn waves(&self, clamped: &[usize], diameters: usize, count: usize) -> Result<Vec<Wave>, EigenError> {
        let unknowns = self.unknowns(clamped, diameters);
        let (k, m) = self.body.matrices(&unknowns);
        let share = if self.is_single(diameters) { 1.0 } else { 2.0 };
        let scale = libm::sqrt(share / self.sectors as f64);
        let scaled = |part: usize, x: &[f64]| -> Vec<[f64; 3]> {
            unknowns.displacements(part, x).into_iter().map(|u| u.map(|u| u * scale)).collect()
        };
        let wave = |pair: Eigenpair| Wave {
            omega_rad_per_s: pair.omega_rad_per_s(),
            diameters,
            real: scaled(0, &pair.vector),
            imaginary: if share > 1.0 { scaled(1, &pair.vector) } else { vec![[0.0; 3]; self.left.len()] },
        };
        Ok(lowest(&k, &m, count)?.into_iter().map(wave).collect())
    }

    /// The `count` modes of the disk with the lowest frequencies, of 0 to N/2 nodal diameters. None is missing, because for every number
    /// of diameters modes are computed until the last one is above them all.
    ///
    /// # Errors
    /// The same as for [`Self::waves`].
    pub fn modes(&self, clamped: &[usize], count: usize) -> Result<Vec<Wave>, EigenError> {
        let mut families: Vec<Vec<Wave>> = vec![Vec::new(); self.sectors / 2 + 1];
        loop {
            let mut known: Vec<f64> = families.iter().flatten().map(|wave| wave.omega_rad_per_s).collect();
            known.sort_unstable_by(f64::total_cmp);
            let limit = if count == 0 { 0.0 } else { known.get(count - 1).copied().unwrap_or(f64::INFINITY) };
            let mut is_done = true;
            for (diameters, family) in families.iter_mut().enumerate() {
                if family.last().is_some_and(|wave| wave.omega_rad_per_s >= limit) {
                    continue;
                }
                let more = if family.is_empty() { 2 * (count / self.sectors + 1) } else { family.len() / 2 + 2 };
                let wanted = (family.len() + more).min(self.unknowns(clamped, diameters).count());
                if wanted > family.len() {
                    *family = self.waves(clamped, diameters, wanted)?;
                    is_done = false;
                }
            }
            if is_done {
                break;
            }
        }
        let mut waves: Vec<Wave> = families.into_iter().flatten().collect();
        if waves.len() < count {
            return Err(EigenError::TooMany { size: waves.len() });
        }
        waves.sort_by(|a, b| a.omega_rad_per_s.total_cmp(&b.omega_rad_per_s));
        waves.truncate(count);
        Ok(waves)
    }
}
