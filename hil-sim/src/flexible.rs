//! Tool and workpiece as one structure, seen from the place where they touch.
//!
//! The place wanders over the workpiece, so what its modes do there changes; what those of the tool do stays. In the list of all
//! modes the workpiece's stand first, for [`Vibration::see_from`](crate::dynamics::vibration::Vibration::see_from) leaves the rest as they are.
//!
//! Source: Lorong et al., Simulation of a finishing operation, 2012, eqs 3 to 6, reduced to modes; one damping ratio for all modes of a part as in their
//! section 4.3.

use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

use arcfeed_shared::units::T_PER_KG;
use nalgebra::Vector3;

use crate::dynamics::modal::{Mode, ModeError};
use crate::fe::beam::BeamModes;
use crate::fe::disk_field::DiskField;
use crate::fe::field::Field;
use crate::fe::locate::TooFar;
use crate::fe::station::Station;

/// A body whose modes are known at each of its points.
pub trait Modal {
    /// Angular frequencies, rad/s.
    fn omega_rad_per_s(&self) -> &[f64];

    /// Sets `station` to a point.
    ///
    /// # Errors
    /// The point is too far from the body.
    fn stand_at(&self, point_mm: [f64; 3], station: &mut Station) -> Result<(), TooFar>;
}

impl Modal for Field {
    fn omega_rad_per_s(&self) -> &[f64] {
        self.omega_rad_per_s()
    }

    fn stand_at(&self, point_mm: [f64; 3], station: &mut Station) -> Result<(), TooFar> {
        self.at(point_mm, station).map(|_| ())
    }
}

impl Modal for DiskField {
    fn omega_rad_per_s(&self) -> &[f64] {
        self.omega_rad_per_s()
    }

    fn stand_at(&self, point_mm: [f64; 3], station: &mut Station) -> Result<(), TooFar> {
        self.at(point_mm, station).map(|_| ())
    }
}

impl<B: Modal> Modal for &B {
    fn omega_rad_per_s(&self) -> &[f64] {
        (*self).omega_rad_per_s()
    }

    fn stand_at(&self, point_mm: [f64; 3], station: &mut Station) -> Result<(), TooFar> {
        (*self).stand_at(point_mm, station)
    }
}

impl<B: Modal> Modal for Arc<B> {
    fn omega_rad_per_s(&self) -> &[f64] {
        (**self).omega_rad_per_s()
    }

    fn stand_at(&self, point_mm: [f64; 3], station: &mut Station) -> Result<(), TooFar> {
        (**self).stand_at(point_mm, station)
    }
}

/// A workpiece that a tool moves along; state: where it was seen from last, for the next place is near.
#[derive(Clone, Debug)]
pub struct Workpiece<B> {
    body: B,
    station: Station,
    shapes: Vec<Vector3<f64>>,
}

/// Why a structure cannot be seen from a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SeenError {
    /// It is not there.
    TooFar(TooFar),
    /// What it does there is no mode.
    Mode(ModeError),
}

impl fmt::Display for SeenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SeenError::TooFar(error) => error.fmt(f),
            SeenError::Mode(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for SeenError {}

impl From<TooFar> for SeenError {
    fn from(error: TooFar) -> Self {
        SeenError::TooFar(error)
    }
}

impl<B: Modal> Workpiece<B> {
    /// A body, not seen yet.
    pub fn new(body: B) -> Self {
        Workpiece { body, station: Station::default(), shapes: Vec::new() }
    }

    /// How many modes it has.
    pub fn count(&self) -> usize {
        self.body.omega_rad_per_s().len()
    }

    /// What the modes do at a point, 1/sqrt(kg).
    ///
    /// # Errors
    /// The point is too far from the body.
    pub fn shapes(&mut self, point_mm: [f64; 3]) -> Result<&[Vector3<f64>], TooFar> {
        self.body.stand_at(point_mm, &mut self.station)?;
        self.shapes.clear();
        self.shapes.extend(self.station.shapes.iter().map(per_root_kg));
        Ok(&self.shapes)
    }

    /// The modes as seen from a point, all with the same damping.
    ///
    /// # Errors
    /// The point is too far from the body, or the damping none.
    pub fn modes(&mut self, point_mm: [f64; 3], damping_ratio: f64) -> Result<Vec<Mode>, SeenError> {
        self.shapes(point_mm)?;
        modes(self.body.omega_rad_per_s(), &self.shapes, damping_ratio).map_err(SeenError::Mode)
    }
}

/// The modes of a tool as seen from a point of it, all with the same damping.
///
/// # Errors
/// The damping is none.
pub fn tool_modes(tool: &BeamModes, point_mm: [f64; 3], damping_ratio: f64) -> Result<Vec<Mode>, ModeError> {
    let mut station = Station::default();
    tool.at(point_mm, &mut station);
    let shapes: Vec<Vector3<f64>> = station.shapes.iter().map(per_root_kg).collect();
    modes(&tool.omega_rad_per_s, &shapes, damping_ratio)
}

fn modes(omegas: &[f64], shapes: &[Vector3<f64>], damping_ratio: f64) -> Result<Vec<Mode>, ModeError> {
    omegas.iter().zip(shapes).map(|(omega, shape)| Mode::new(omega / TAU, damping_ratio, *shape)).collect()
}

/// From 1/sqrt(t).
fn per_root_kg(shape: &[f64; 3]) -> Vector3<f64> {
    Vector3::from(*shape) * libm::sqrt(T_PER_KG)
}
