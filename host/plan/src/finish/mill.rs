//! Finishing mill: ball end or filleted end, flutes, neck and holder; and its place at a contact.
//!
//! ```text
//! tip = C + r n - r t + (R - r) unit(n - (n . t) t)                             (1)
//! ```
//!
//! r is the corner's radius, R the mill's; a ball has r = R. If t and n agree, the last direction is that of a small tilt, -f: the contact then lies at
//! the front of the flat end.
//!
//! Source: ours; the corner is a torus, whose normal at the contact is that of the surface.

use crate::proof::section::Section;
use crate::vector::{Point, Vector};

use super::contact::Contact;

/// Component of the normal across the tool axis below which both agree.
const LEAST: f64 = 1e-9;

/// Finishing mill with neck and holder, dimensions in mm; heights are measured from its tip.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishMill {
    /// Radius R of the mill.
    pub radius_mm: f64,
    /// Radius r of the corner; equal to that of the mill for a ball end.
    pub corner_radius_mm: f64,
    /// Height up to which the mill has the radius R.
    pub length_mm: f64,
    /// Cylinders of the neck behind the cutting part, from below, each as radius and length.
    pub neck_mm: Vec<[f64; 2]>,
    /// Cylinders of the holder behind the neck, from below, each as radius and length.
    pub holder_mm: Vec<[f64; 2]>,
    /// Number of teeth.
    pub teeth: u16,
}

/// Part of a finishing mill whose clearance is computed on its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FinishPart {
    /// Ball end, or the rounded corner of a filleted end.
    End,
    /// Flutes above the end.
    Flutes,
    /// Neck.
    Neck,
    /// Holder.
    Holder,
}

/// Short piece of a mill, for bounds of its distance while the tool axis turns.
#[derive(Clone, Debug)]
pub struct MillPiece {
    /// Part of the mill to which it belongs.
    pub part: FinishPart,
    /// Shape of the piece; heights are measured from the pivot (point of the axis at the height of the corner's centre).
    pub section: Section,
    /// Largest path of a point of its surface per radian of a turn about the pivot, mm.
    pub reach_mm: f64,
}

/// Position of the mill at a contact, in the rotor's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutterLocation {
    /// Middle of the mill's end (tip).
    pub tip: Point,
    /// Unit vector from the tip to the holder.
    pub axis: Vector,
}

impl FinishMill {
    /// Place of the mill at a contact. (1)
    pub fn at(&self, contact: &Contact, axis: Vector) -> CutterLocation {
        let Contact { point, normal, feed } = contact;
        let across = normal - axis * normal.dot(&axis);
        let direction = across.try_normalize(LEAST).unwrap_or(-feed);
        let (corner_mm, flat_mm) = (self.corner_radius_mm, self.radius_mm - self.corner_radius_mm);
        CutterLocation { tip: point + (normal - axis) * corner_mm + direction * flat_mm, axis } // (1)
    }

    /// Pivot: the point of the axis at the height of the corner's centre; of a ball its centre.
    pub fn pivot(&self, location: &CutterLocation) -> Point {
        location.tip + location.axis * self.corner_radius_mm
    }

    /// Whether the end is a ball.
    pub fn is_ball(&self) -> bool {
        self.corner_radius_mm >= self.radius_mm
    }

    /// Height of the upper end of the holder above the tip, mm.
    pub fn height_mm(&self) -> f64 {
        self.length_mm + self.neck_mm.iter().chain(&self.holder_mm).map(|[_, length_mm]| length_mm).sum::<f64>()
    }

    /// Short pieces of the whole mill; the farther from the end, the longer they are.
    pub fn pieces(&self) -> Vec<MillPiece> {
        let corner_mm = self.corner_radius_mm;
        let end = MillPiece {
            part: FinishPart::End,
            section: Section::rounded_disc(self.radius_mm, [-corner_mm, corner_mm], corner_mm),
            reach_mm: self.radius_mm - corner_mm,
        };
        let mut pieces = vec![end];
        let mut from_mm = 0.0;
        let flutes = [[self.radius_mm, self.length_mm - corner_mm]];
        let stacks = [
            (FinishPart::Flutes, &flutes[..]),
            (FinishPart::Neck, &self.neck_mm),
            (FinishPart::Holder, &self.holder_mm),
        ];
        for (part, cylinders) in stacks {
            for [radius_mm, length_mm] in cylinders {
                let to_mm = from_mm + length_mm;
                while from_mm < to_mm {
                    // A piece is as high as the pivot is far below it, and at least as high as the end is thick.
                    let high_mm = (from_mm + from_mm.max(corner_mm)).min(to_mm);
                    let section = Section::rounded_disc(*radius_mm, [from_mm, high_mm], 0.0);
                    pieces.push(MillPiece { part, section, reach_mm: libm::hypot(*radius_mm, high_mm) });
                    from_mm = high_mm;
                }
            }
        }
        pieces
    }
}
