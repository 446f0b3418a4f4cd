//! Vibrating disk: its displacement at any point, stored for one sector.

use std::f64::consts::TAU;

use arcfeed_fe::body::Modes;
use arcfeed_fe::field::{Field, material_point_mm};
use arcfeed_fe::locate::TooFar;
use arcfeed_modal::flexible::Modal;
use arcfeed_modal::modal_point::ModalPoint;

use crate::cyclic::{Sector, Wave};
use crate::disk::turned_by;

/// Modes of a vibrating disk, with the search for the mode shapes at any point of it.
#[derive(Clone, Debug)]
pub struct DiskField {
    /// Field of one sector; its modes are a and b of each wave, alternating.
    sector: Field,
    omega_rad_per_s: Vec<f64>,
    diameters: Vec<usize>,
    /// Cosine and sine of 0 to N - 1 sectors.
    turns: Vec<[f64; 2]>,
    /// Angle at which the first sector begins.
    begin_rad: f64,
}

impl DiskField {
    /// Field for these modes; `reach_mm` is the largest distance of points outside the disk: see [`Field::new`].
    pub fn new(sector: &Sector, waves: &[Wave], reach_mm: f64) -> Self {
        let mesh = sector.body().mesh();
        let of_left =
            mesh.nodes_where(|place| place[0] == 0).first().map_or([1.0, 0.0, 0.0], |node| mesh.nodes_mm()[*node]);
        let modes = Modes {
            omega_rad_per_s: waves.iter().flat_map(|wave| [wave.omega_rad_per_s; 2]).collect(),
            shapes: waves.iter().flat_map(|wave| [wave.real.clone(), wave.imaginary.clone()]).collect(),
        };
        let turn = |k: usize| {
            let (sin, cos) = libm::sincos(TAU * k as f64 / sector.sectors() as f64);
            [cos, sin]
        };
        DiskField {
            sector: Field::new(mesh.clone(), &modes, reach_mm),
            omega_rad_per_s: waves.iter().map(|wave| wave.omega_rad_per_s).collect(),
            diameters: waves.iter().map(|wave| wave.diameters).collect(),
            turns: (0..sector.sectors()).map(turn).collect(),
            begin_rad: libm::atan2(of_left[1], of_left[0]),
        }
    }

    /// Sets `modal_point` to the mode shapes at a point of the undeformed disk; returns the point's distance outside the disk, mm.
    ///
    /// # Errors
    /// The point is beyond the reach.
    pub fn at(&self, point_mm: [f64; 3], modal_point: &mut ModalPoint) -> Result<f64, TooFar> {
        let found =
            self.search_sectors(point_mm, modal_point, |in_first_mm, other| self.sector.at(in_first_mm, other).ok());
        found.ok_or(TooFar { point_mm })
    }

    /// Sets `modal_point` in the sector where the point is least outside, from a search in the first sector.
    fn search_sectors(
        &self,
        point_mm: [f64; 3],
        modal_point: &mut ModalPoint,
        outside_mm: impl Fn([f64; 3], &mut ModalPoint) -> Option<f64>,
    ) -> Option<f64> {
        let sectors = self.turns.len();
        let angle = libm::atan2(point_mm[1], point_mm[0]) - self.begin_rad;
        let guess = libm::floor(angle / TAU * sectors as f64) as isize;
        // A twisted blade extends into the neighbouring sectors.
        let mut best: Option<(f64, usize)> = None;
        let mut other = ModalPoint { element: modal_point.element, ..ModalPoint::default() };
        for sector in [guess, guess - 1, guess + 1].map(|s| s.rem_euclid(sectors as isize) as usize) {
            let [cos, sin] = self.turns[sector];
            let Some(outside_mm) = outside_mm(turned_by(point_mm, [cos, -sin]), &mut other) else { continue };
            if best.is_none_or(|(least_mm, _)| outside_mm < least_mm) {
                best = Some((outside_mm, sector));
                std::mem::swap(modal_point, &mut other);
            }
            if outside_mm == 0.0 {
                break;
            }
        }
        let (outside_mm, sector) = best?;
        self.expand(sector, modal_point);
        Some(outside_mm)
    }

    /// Converts a and b of the first sector to the displacement in another one: (1) of [`crate::cyclic`].
    fn expand(&self, sector: usize, modal_point: &mut ModalPoint) {
        let around = self.turns[sector];
        for (mode, diameters) in self.diameters.iter().enumerate() {
            let [cos, sin] = self.turns[diameters * sector % self.turns.len()];
            let [a, b] = [modal_point.shapes[2 * mode], modal_point.shapes[2 * mode + 1]];
            modal_point.shapes[mode] = turned_by(std::array::from_fn(|axis| a[axis] * cos - b[axis] * sin), around);
        }
        modal_point.shapes.truncate(self.diameters.len());
    }

    /// Point of the undeformed disk whose material is now at `now_mm`, for these modal amplitudes, mm; sets `modal_point` to the mode
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

impl Modal for DiskField {
    fn omega_rad_per_s(&self) -> &[f64] {
        &self.omega_rad_per_s
    }

    fn reach_mm(&self) -> f64 {
        self.sector.reach_mm()
    }

    fn evaluate_at(&self, point_mm: [f64; 3], beyond_mm: f64, modal_point: &mut ModalPoint) {
        self.search_sectors(point_mm, modal_point, |in_first_mm, other| {
            Some(self.sector.at_nearest(in_first_mm, beyond_mm, other))
        });
    }
}
