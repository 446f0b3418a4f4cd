//! A bladed disk, by sectors: a ring with a hub to clamp it, and on its rim one straight blade per sector, tapered and
//! twisted.
//!
//! Frame: the disk's axis is z, the first sector's middle points along x. Lattice: around, along the axis, outwards.

use arcfeed_fe::mesh::{HalfCells, TetMesh, TetMeshError};

/// A bladed disk, by its dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BladedDisk {
    /// Number of blades.
    pub sectors: usize,
    /// Radius of the hub, where the disk is clamped.
    pub bore_radius_mm: f64,
    /// Radius of the rim, where blades begin.
    pub rim_radius_mm: f64,
    /// Width along the axis.
    pub width_mm: f64,
    /// Length of the blades.
    pub span_mm: f64,
    /// Ratio of the blades' section at the tip to that at the rim, in both directions.
    pub taper_ratio: f64,
    /// Twist of the blades from rim to tip, about their own radius.
    pub twist_rad: f64,
    /// Cells of a sector.
    pub cells: SectorCells,
}

/// Numbers of mesh cells of a sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SectorCells {
    /// Cells around: in the gap on either side of the blade, and in each half of the blade. Their number is even, so
    /// all sectors of a whole disk have the same mesh, though neighbouring cells are mirror images.
    pub around: [usize; 2],
    /// Cells along the axis.
    pub along: usize,
    /// Cells outwards: in the disk, and in the blade.
    pub outwards: [usize; 2],
}

impl BladedDisk {
    fn sector_cells(&self) -> [usize; 3] {
        let SectorCells { around, along, outwards } = self.cells;
        [2 * (around[0] + around[1]), along, outwards[0] + outwards[1]]
    }

    /// Whether a cell belongs to the disk or to a blade; `around` may count through all sectors.
    fn is_kept(&self, [around, _, outwards]: [usize; 3]) -> bool {
        let [gap, half] = self.cells.around;
        let in_sector = around % self.sector_cells()[0];
        outwards < self.cells.outwards[0] || (gap..gap + 2 * half).contains(&in_sector)
    }

    /// Point of a sector, with `around` in cells from its left face. Left and right faces are equal apart from the
    /// rotation.
    fn point_mm(&self, [around, along, outwards]: [f64; 3]) -> [f64; 3] {
        let [cells_around, cells_along, _] = self.sector_cells();
        let angle = std::f64::consts::TAU / self.sectors as f64 * (around / cells_around as f64 - 0.5);
        let z_mm = self.width_mm * (along / cells_along as f64 - 0.5);
        let [in_disk, in_blade] = self.cells.outwards.map(|cells| cells as f64);
        let part = (outwards / in_disk).min(1.0);
        let radius_mm = self.bore_radius_mm + part * (self.rim_radius_mm - self.bore_radius_mm);
        let (sin, cos) = libm::sincos(angle);
        let height = ((outwards - in_disk) / in_blade).max(0.0);
        let taper = 1.0 + (self.taper_ratio - 1.0) * height;
        let (turn_sin, turn_cos) = libm::sincos(self.twist_rad * height);
        let (y_mm, z_mm) = (radius_mm * sin * taper, z_mm * taper);
        [radius_mm * cos + height * self.span_mm, turn_cos * y_mm - turn_sin * z_mm, turn_sin * y_mm + turn_cos * z_mm]
    }

    /// Mesh of the first sector.
    ///
    /// # Errors
    /// No cells, or a shape that folds cells.
    pub fn sector(&self) -> Result<TetMesh, TetMeshError> {
        TetMesh::mapped(self.sector_cells(), |cell| self.is_kept(cell), |at| self.point_mm(at))
    }

    /// Mesh of all sectors.
    ///
    /// # Errors
    /// The same as for [`Self::sector`].
    pub fn whole(&self) -> Result<TetMesh, TetMeshError> {
        let [around, along, outwards] = self.sector_cells();
        let point_mm = |at: [f64; 3]| {
            let sector = (at[0] / around as f64).floor();
            let point_mm = self.point_mm([at[0] - sector * around as f64, at[1], at[2]]);
            turned(point_mm, std::f64::consts::TAU / self.sectors as f64 * sector)
        };
        TetMesh::ring([around * self.sectors, along, outwards], |cell| self.is_kept(cell), point_mm)
    }

    /// Whether a lattice point is on the hub.
    pub fn is_hub(place: HalfCells) -> bool {
        place[2] == 0
    }
}

/// Vector rotated about z.
pub(crate) fn turned(vector: [f64; 3], angle_rad: f64) -> [f64; 3] {
    let (sin, cos) = libm::sincos(angle_rad);
    turned_by(vector, [cos, sin])
}

/// Vector rotated about z by an angle given as cosine and sine.
pub(crate) fn turned_by([x, y, z]: [f64; 3], [cos, sin]: [f64; 2]) -> [f64; 3] {
    [cos * x - sin * y, sin * x + cos * y, z]
}
