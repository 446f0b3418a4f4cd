//! Sections of one blade, from a generator or from files.

use crate::vector::{Point, Vector};

use super::blisk::Revolution;
use super::face::{Face, FaceError};

/// Sections of one blade, from the hub to the tip, in the rotor's own frame, mm; the points run from leading to trailing edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sections {
    /// Points of the pressure (concave) side, section by section.
    pub pressure: Vec<Vec<Point>>,
    /// Points of the suction (convex) side, section by section.
    pub suction: Vec<Vec<Point>>,
}

/// Axis of a file's coordinates about which the rotor turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RotorAxis {
    /// x
    X,
    /// y
    Y,
    /// z
    #[default]
    Z,
}

impl RotorAxis {
    /// Converts a place of the file to the part frame by a cyclic change of axes, so that no rotor is mirrored.
    pub fn to_part(self, [x, y, z]: [f64; 3]) -> Point {
        match self {
            RotorAxis::X => Point::new(y, z, x),
            RotorAxis::Y => Point::new(z, x, y),
            RotorAxis::Z => Point::new(x, y, z),
        }
    }
}

impl Sections {
    /// Surfaces through the sections: pressure, then suction side.
    ///
    /// # Errors
    /// See [`Face::through`].
    pub fn faces(&self) -> Result<[Face; 2], FaceError> {
        let out = self.across();
        Ok([Face::through(&self.pressure, out)?, Face::through(&self.suction, -out)?])
    }

    /// Vector from the suction to the pressure side, over all points together: single places with exchanged sides do
    /// not turn it.
    fn across(&self) -> Vector {
        let pairs = self.pressure.iter().flatten().zip(self.suction.iter().flatten());
        pairs.map(|(pressure, suction)| pressure - suction).sum()
    }

    /// Length of the suction side minus that of the pressure side, mm, summed over all sections: larger than 0 with camber.
    pub fn bulge_mm(&self) -> f64 {
        let whole_mm = |side: &[Vec<Point>]| side.iter().map(|points| length_mm(points)).sum::<f64>();
        whole_mm(&self.suction) - whole_mm(&self.pressure)
    }

    /// The same blade with its sides exchanged.
    pub fn swapped(self) -> Self {
        Sections { pressure: self.suction, suction: self.pressure }
    }

    /// Whether the pressure side lies at greater angles about the axis than the suction side.
    pub fn is_pressure_ahead(&self) -> bool {
        let middle = |side: &[Point]| side[side.len() / 2];
        let pairs = self.pressure.iter().zip(&self.suction).map(|(one, other)| (middle(one), middle(other)));
        pairs.map(|(one, other)| one.coords.cross(&(one - other)).z).sum::<f64>() > 0.0
    }

    /// The same blade with its sides named as those of the rotor's main blade: a splitter may have no camber.
    #[must_use]
    pub fn named_as(self, main: &Sections) -> Self {
        if self.is_pressure_ahead() == main.is_pressure_ahead() { self } else { self.swapped() }
    }

    /// Mean height of each section above the hub, mm.
    pub fn heights_mm(&self, hub: &Revolution) -> Vec<f64> {
        let sides = self.pressure.iter().zip(&self.suction);
        sides
            .map(|(pressure, suction)| {
                let heights = pressure.iter().chain(suction).map(|point| hub.height_mm(point));
                heights.sum::<f64>() / (pressure.len() + suction.len()) as f64
            })
            .collect()
    }
}

/// Length of a polyline.
pub fn length_mm(points: &[Point]) -> f64 {
    points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}
