//! Generates a rotor from a few numbers: NACA 65-010 thickness on circular-arc camber, laid on cylinders about the
//! axis.
//!
//! ```text
//! x_i     = (1 - cos(pi i / (n - 1))) / 2                 stations along the chord        (1)
//! rho     = c / (2 sin(theta / 2))                        radius of the camber arc        (2)
//! sin(a)  = c (x - 1/2) / rho                             the arc's direction             (3)
//! v       = rho (cos(a) - cos(theta / 2))                 its height over the chord       (4)
//! (U, V)  = (c (x - 1/2), -v) +- t (sin(a), -cos(a))      suction +, pressure -           (5)
//! w       = U sin(s) + V cos(s) + (R - R_hub) tan(lean)   along the circumference         (6)
//! z       = U cos(s) - V sin(s)                           along the rotor's axis          (7)
//! point   = (R cos(w / R), k R sin(w / R), z)             k = 1 right, -1 left            (8)
//! t(d)    >= sqrt(e^2/4 - (e/2 - d)^2), e/2 from d = e/2  the edge, d from either end     (9)
//! ```
//!
//! with chord c, camber angle theta, stagger s, edge thickness e and half thickness t, linear in the radius R between hub and tip. The middle
//! of every chord lies on one radius unless the blade leans.

use thiserror::Error;

use crate::vector::Point;

use super::blade::Sections;
use super::naca65::half_thickness_ratio;

/// Default number of points of a side.
pub const POINTS: usize = 81;

/// Default number of sections.
pub const SECTIONS: usize = 9;

/// Direction in which the blades' pressure sides face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hand {
    /// Towards increasing angles about the axis: blades of positive stagger wind as a right-hand thread does.
    #[default]
    Right,
    /// Mirror image.
    Left,
}

/// Dimensions from which a rotor is generated. Pairs are values at the hub and at the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotor {
    /// Number of blades.
    pub blades: u32,
    /// Radius of the cylinder between the blades.
    pub hub_radius_mm: f64,
    /// Radius at which the blades end.
    pub tip_radius_mm: f64,
    /// Chord length c.
    pub chord_mm: [f64; 2],
    /// Stagger angle s from the rotor's axis, of either sign.
    pub stagger_deg: [f64; 2],
    /// Camber angle theta.
    pub camber_deg: [f64; 2],
    /// Greatest thickness as a fraction of the chord.
    pub thickness_ratio: [f64; 2],
    /// Least thickness e at the edges; 0 leaves the profile as it is.
    pub edge_mm: f64,
    /// Lean of the blades towards their pressure sides.
    pub lean_deg: f64,
    /// Direction in which the pressure sides face.
    pub hand: Hand,
}

/// Reason why these dimensions define no rotor.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RotorError {
    /// There are too few blades; their given number.
    #[error("a rotor has 2 blades at least, not {0}")]
    Blades(u32),
    /// The tip's radius is not larger than the hub's.
    #[error("tip_radius must be greater than hub_radius, and both positive: {hub_radius_mm} mm, {tip_radius_mm} mm")]
    Radii {
        /// Radius at the hub.
        hub_radius_mm: f64,
        /// Radius at the tip.
        tip_radius_mm: f64,
    },
    /// A dimension is outside of its range.
    #[error("{name} must be {range}, not {value}")]
    Range {
        /// Name of the dimension in a part file.
        name: &'static str,
        /// Allowed range.
        range: &'static str,
        /// Value.
        value: f64,
    },
    /// The edge is as thick as the blade.
    #[error("an edge of {edge_mm} mm is no edge of a blade {thickness_mm} mm thick")]
    Edge {
        /// Edge thickness.
        edge_mm: f64,
        /// Greatest thickness of the blade where it is thinnest.
        thickness_mm: f64,
    },
}

/// Numbers of one section.
struct Section {
    radius_mm: f64,
    chord_mm: f64,
    stagger_rad: f64,
    camber_rad: f64,
    thickness_ratio: f64,
    shift_mm: f64,
}

impl Rotor {
    /// Sections of one blade, the first on the hub and the last at the tip, with `points` points per side; part frame.
    ///
    /// # Errors
    /// Describes the number that is out of range.
    pub fn sections(&self, sections: usize, points: usize) -> Result<Sections, RotorError> {
        self.check()?;
        let mut blade = Sections::default();
        for index in 0..sections {
            let section = self.section(index as f64 / (sections.max(2) - 1) as f64);
            let side = |outward: f64| (0..points).map(|i| self.point(&section, station(i, points), outward)).collect();
            blade.pressure.push(side(-1.0));
            blade.suction.push(side(1.0));
        }
        Ok(blade)
    }

    fn check(&self) -> Result<(), RotorError> {
        let Rotor { hub_radius_mm, tip_radius_mm, .. } = *self;
        if self.blades < 2 {
            return Err(RotorError::Blades(self.blades));
        }
        if !(hub_radius_mm > 0.0 && tip_radius_mm > hub_radius_mm && tip_radius_mm.is_finite()) {
            return Err(RotorError::Radii { hub_radius_mm, tip_radius_mm });
        }
        let within = |name, values: &[f64], [low, high]: [f64; 2], range| {
            let beyond = values.iter().find(|value| !(**value > low && **value < high));
            beyond.map_or(Ok(()), |value| Err(RotorError::Range { name, range, value: *value }))
        };
        within("chord", &self.chord_mm, [0.0, f64::INFINITY], "positive")?;
        within("stagger_deg", &self.stagger_deg, [-89.0, 89.0], "between -89 and 89")?;
        within(
            "camber_deg",
            &self.camber_deg,
            [0.0, 120.0],
            "positive and below 120: the concave side is the pressure side",
        )?;
        within("thickness_ratio", &self.thickness_ratio, [0.0, 0.4], "positive and below 0.4")?;
        within("lean_deg", &[self.lean_deg], [-60.0, 60.0], "between -60 and 60")?;
        within("edge", &[self.edge_mm], [-f64::MIN_POSITIVE, f64::INFINITY], "0 or more")?;
        let thickness_mm =
            (0..2).map(|end| self.chord_mm[end] * self.thickness_ratio[end]).fold(f64::INFINITY, f64::min);
        if self.edge_mm < thickness_mm { Ok(()) } else { Err(RotorError::Edge { edge_mm: self.edge_mm, thickness_mm }) }
    }

    fn section(&self, share: f64) -> Section {
        let between = |[hub, tip]: [f64; 2]| hub + (tip - hub) * share;
        let radius_mm = between([self.hub_radius_mm, self.tip_radius_mm]);
        Section {
            radius_mm,
            chord_mm: between(self.chord_mm),
            stagger_rad: between(self.stagger_deg).to_radians(),
            camber_rad: between(self.camber_deg).to_radians(),
            thickness_ratio: between(self.thickness_ratio),
            shift_mm: (radius_mm - self.hub_radius_mm) * libm::tan(self.lean_deg.to_radians()),
        }
    }

    fn point(&self, section: &Section, station_ratio: f64, outward: f64) -> Point {
        let Section { radius_mm, chord_mm, .. } = *section;
        let (sin_half, cos_half) = libm::sincos(section.camber_rad / 2.0);
        let arc_mm = chord_mm / (2.0 * sin_half); // (2)
        let along_mm = chord_mm * (station_ratio - 0.5);
        let sin = along_mm / arc_mm; // (3)
        let cos = libm::sqrt(1.0 - sin * sin);
        let half_mm = self.half_mm(section, station_ratio) * outward;
        let u_mm = along_mm + half_mm * sin; // (5)
        let v_mm = -arc_mm * (cos - cos_half) - half_mm * cos; // (4), (5)
        let (sin_stagger, cos_stagger) = libm::sincos(section.stagger_rad);
        let around_mm = u_mm * sin_stagger + v_mm * cos_stagger + section.shift_mm; // (6)
        let (sin_around, cos_around) = libm::sincos(around_mm / radius_mm);
        let hand = match self.hand {
            Hand::Right => 1.0,
            Hand::Left => -1.0,
        };
        let z_mm = u_mm * cos_stagger - v_mm * sin_stagger; // (7)
        Point::new(radius_mm * cos_around, hand * radius_mm * sin_around, z_mm) // (8)
    }

    fn half_mm(&self, section: &Section, station_ratio: f64) -> f64 {
        let profile_mm = section.chord_mm * half_thickness_ratio(station_ratio, section.thickness_ratio);
        let end_mm = section.chord_mm * station_ratio.min(1.0 - station_ratio);
        let edge_radius_mm = self.edge_mm / 2.0;
        let off_mm = (edge_radius_mm - end_mm).max(0.0);
        let edge_mm = libm::sqrt((edge_radius_mm * edge_radius_mm - off_mm * off_mm).max(0.0)); // (9)
        profile_mm.max(edge_mm)
    }
}

/// (1)
fn station(index: usize, points: usize) -> f64 {
    let angle = core::f64::consts::PI * index as f64 / (points.max(2) - 1) as f64;
    (1.0 - libm::cos(angle)) / 2.0
}
