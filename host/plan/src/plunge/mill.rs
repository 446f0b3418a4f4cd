//! Mill for plunging: a cylinder that cuts with its end, its neck, and its holder, as solids of revolution.

use crate::proof::section::Section;

/// Plunge mill with neck and holder, dimensions in mm; heights are measured from its end.
#[derive(Clone, Debug, PartialEq)]
pub struct PlungeMill {
    /// Radius R of the cutting part.
    pub radius_mm: f64,
    /// Radius r_c of the corner between end and side.
    pub corner_radius_mm: f64,
    /// Radius r_k of the core: the part of the end about the axis that does not cut; 0 if the mill cuts up to its axis.
    pub core_radius_mm: f64,
    /// Greatest radial width of a cut.
    pub width_max_mm: f64,
    /// Length of the part that has the radius R.
    pub length_mm: f64,
    /// Cylinders of the neck behind the cutting part, from below, each as radius and length.
    pub neck_mm: Vec<[f64; 2]>,
    /// Cylinders of the holder behind the neck, from below, each as radius and length.
    pub holder_mm: Vec<[f64; 2]>,
    /// Number of teeth.
    pub teeth: u16,
}

/// Part of a plunge mill.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MillPart {
    /// Cutting part.
    Cutter,
    /// Neck.
    Neck,
    /// Holder.
    Holder,
}

impl PlungeMill {
    /// Sections of a part.
    pub fn sections(&self, part: MillPart) -> Vec<Section> {
        let neck_end_mm = self.length_mm + self.neck_mm.iter().map(|[_, length_mm]| length_mm).sum::<f64>();
        match part {
            MillPart::Cutter => {
                // The rounding of the upper edge lies above the cutting part.
                let heights_mm = [0.0, self.length_mm + self.corner_radius_mm];
                vec![Section::rounded_disc(self.radius_mm, heights_mm, self.corner_radius_mm)]
            }
            MillPart::Neck => stacked(&self.neck_mm, self.length_mm),
            MillPart::Holder => stacked(&self.holder_mm, neck_end_mm),
        }
    }

    /// Whether the part is nowhere thicker than the hole that the mill cuts.
    pub fn fits_hole(&self, part: MillPart) -> bool {
        let cylinders = match part {
            MillPart::Cutter => return true,
            MillPart::Neck => &self.neck_mm,
            MillPart::Holder => &self.holder_mm,
        };
        cylinders.iter().all(|[radius_mm, _]| *radius_mm <= self.radius_mm)
    }

    /// Whether the neck is thinner than the hole by at least this distance all around.
    pub fn is_relieved_by(&self, distance_mm: f64) -> bool {
        !self.neck_mm.is_empty() && self.neck_mm.iter().all(|[radius_mm, _]| radius_mm + distance_mm <= self.radius_mm)
    }

    /// Lift of a flat end along the axis, so that it stands on a plane whose normal has an angle with the axis:
    ///
    /// ```text
    /// ((R - r_c) sin gamma + r_c (1 - cos gamma)) / cos gamma                        (1)
    /// ```
    ///
    /// Exact on a plane, to the safe side on a convex hub.
    pub fn lift_mm(&self, angle_rad: f64) -> f64 {
        let (sin, cos) = libm::sincos(angle_rad);
        ((self.radius_mm - self.corner_radius_mm) * sin + self.corner_radius_mm * (1.0 - cos)) / cos // (1)
    }
}

fn stacked(cylinders: &[[f64; 2]], from_mm: f64) -> Vec<Section> {
    let discs = cylinders.iter().scan(from_mm, |from_mm, [radius_mm, length_mm]| {
        let heights_mm = [*from_mm, *from_mm + length_mm];
        *from_mm = heights_mm[1];
        Some(Section::rounded_disc(*radius_mm, heights_mm, 0.0))
    });
    discs.collect()
}
