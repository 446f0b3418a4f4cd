//! Plunges of a passage, their planes, and both together: what a plan consists of.

use nalgebra::Rotation3;

use crate::vector::{Point, Vector};

use super::boundary::{Boundary, LargestTool};

/// Plunge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plunge {
    /// Plane, from 0.
    pub plane: usize,
    /// Tool axis, part frame.
    pub axis: Vector,
    /// Rotation from the part frame into that of the tool.
    pub to_tool: Rotation3<f64>,
    /// Middle of the mill's end at the lowest place, part frame.
    pub tip: Point,
    /// Height at which the tool turns and moves, along its axis from the rotor's axis, mm.
    pub clear_mm: f64,
    /// Highest and lowest place of the blank under the mill's end, along the axis, mm.
    pub roof_mm: [f64; 2],
    /// Step off the wall across the axis, towards growing angles if positive, mm.
    pub relief_mm: f64,
    /// Lift of the flat end from the floor, mm.
    pub lift_mm: f64,
    /// Angle between the axis and the hub's normal.
    pub lean_rad: f64,
}

/// Family of planes of plunges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlungeFamily {
    /// Across the rotor's axis; the mill comes from the blank's rim.
    Radial,
    /// Along the rotor's axis, from the lower face of the blank (faces.rs).
    LowerFace,
    /// The same from the upper face.
    UpperFace,
}

/// Plane and its boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungePlane {
    /// Family.
    pub family: PlungeFamily,
    /// Place of its origin along the rotor's axis, mm; 0 for planes along that axis.
    pub z_mm: f64,
    /// Distance of its origin from the rotor's axis, mm; 0 for planes across it.
    pub radius_mm: f64,
    /// Boundary axes.
    pub boundary: Boundary,
    /// Columns.
    pub columns: usize,
    /// Distance of neighbouring columns at the roof, mm.
    pub spacing_mm: f64,
    /// Distance from the plane before, square to the axes, over the one allowed by the cusp, at most.
    pub step_ratio: f64,
}

/// Plan of a passage.
#[derive(Clone, Debug)]
pub struct PassagePlan {
    /// Planes in order.
    pub planes: Vec<PlungePlane>,
    /// Plunges in order.
    pub plunges: Vec<Plunge>,
    /// Largest tool in planes along the blade.
    pub largest: Vec<LargestTool>,
}

impl Plunge {
    /// Places of the mill's end in its own frame: above, at the lowest place, off the wall, above.
    pub fn places(&self) -> [Point; 4] {
        let low = self.to_tool * self.tip;
        let off = low + Vector::new(self.relief_mm, 0.0, self.relief_mm.abs());
        let above = |place: Point| Point::new(place.x, place.y, self.clear_mm);
        [above(low), low, off, above(off)]
    }
}
