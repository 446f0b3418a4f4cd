//! A vibrating disk: its displacement at any point, kept for one sector.

use std::f64::consts::TAU;

use super::body::Modes;
use super::cyclic::{Sector, Wave};
use super::disk::turned_by;
use super::field::{Field, settled_mm};
use super::locate::TooFar;
use super::modal_point::ModalPoint;

/// Modes of a disk, and a way to find points in it.
#[derive(Clone, Debug)]
pub struct DiskField {
    /// a and b of the waves by turns.
    sector: Field,
    omega_rad_per_s: Vec<f64>,
    diameters: Vec<usize>,
    /// Cosine and sine of 0 to N - 1 sectors.
    turns: Vec<[f64; 2]>,
    /// Where the first sector begins.
    begin_rad: f64,
}

impl DiskField {
    /// The modes of a disk, and how far outside of it points may be: see [`Field::new`].
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

    /// Angular frequencies of the modes, rad/s.
    pub fn omega_rad_per_s(&self) -> &[f64] {
        &self.omega_rad_per_s
    }

    /// Sets `modal_point` to a point of the undeformed disk and answers how far outside it is, mm.
    ///
    /// # Errors
    /// The point is beyond the reach.
    pub fn at(&self, point_mm: [f64; 3], modal_point: &mut ModalPoint) -> Result<f64, TooFar> {
        let found = self.stand(point_mm, modal_point, |in_first_mm, other| self.sector.at(in_first_mm, other).ok());
        found.ok_or(TooFar { point_mm })
    }

    /// How far outside of the disk points may be.
    pub fn reach_mm(&self) -> f64 {
        self.sector.reach_mm()
    }

    /// As [`Field::carried`].
    pub fn carried(&self, point_mm: [f64; 3], beyond_mm: f64, modal_point: &mut ModalPoint) -> f64 {
        let carried = |in_first_mm, other: &mut ModalPoint| Some(self.sector.carried(in_first_mm, beyond_mm, other));
        self.stand(point_mm, modal_point, carried).unwrap_or(f64::INFINITY)
    }

    /// Sets `modal_point` in the sector where the point is least outside, from a search of the first sector.
    fn stand(
        &self,
        point_mm: [f64; 3],
        modal_point: &mut ModalPoint,
        outside_mm: impl Fn([f64; 3], &mut ModalPoint) -> Option<f64>,
    ) -> Option<f64> {
        let sectors = self.turns.len();
        let angle = libm::atan2(point_mm[1], point_mm[0]) - self.begin_rad;
        let guess = libm::floor(angle / TAU * sectors as f64) as isize;
        // A twisted blade hangs over into the sectors beside its own.
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

    /// From a and b in the first sector to the displacement in another one: (1) of [`super::cyclic`].
    fn expand(&self, sector: usize, modal_point: &mut ModalPoint) {
        let around = self.turns[sector];
        for (mode, diameters) in self.diameters.iter().enumerate() {
            let [cos, sin] = self.turns[diameters * sector % self.turns.len()];
            let [a, b] = [modal_point.shapes[2 * mode], modal_point.shapes[2 * mode + 1]];
            modal_point.shapes[mode] = turned_by(std::array::from_fn(|axis| a[axis] * cos - b[axis] * sin), around);
        }
        modal_point.shapes.truncate(self.diameters.len());
    }

    /// Which point of the undeformed disk is now at `now_mm`; `modal_point`, at a point nearby or at none, is set to it.
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
