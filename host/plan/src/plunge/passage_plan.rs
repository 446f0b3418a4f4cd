//! Plunges of a passage, their planes, and both together: what a plan consists of.

use nalgebra::Rotation3;

use crate::vector::{Point, Vector};

use super::boundary::{Boundary, LargestTool};

/// One plunge: a straight move of the mill along its axis into the passage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plunge {
    /// Index of the plane to which it belongs.
    pub plane: usize,
    /// Tool axis, unit vector in the rotor's own frame.
    pub axis: Vector,
    /// Rotation from the rotor's own frame into that of the tool, whose z is the tool axis.
    pub to_tool: Rotation3<f64>,
    /// Lowest position of the middle of the mill's end, in the rotor's own frame.
    pub tip: Point,
    /// Height, along the tool axis from the rotor's axis, at which the mill moves from plunge to plunge, mm.
    pub clear_mm: f64,
    /// Highest and lowest point of the blank's material over the mill's end, as heights along the tool axis, mm.
    pub roof_mm: [f64; 2],
    /// Step off the wall across the axis, towards growing angles if positive, mm.
    pub relief_mm: f64,
    /// Distance by which the flat end is lifted off the floor, so that it does not cut into an inclined hub, mm.
    pub lift_mm: f64,
    /// Angle between the tool axis and the hub's normal.
    pub lean_rad: f64,
}

/// Family of the planes in which plunges lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlungeFamily {
    /// Across the rotor's axis; the mill comes from the blank's rim.
    Radial,
    /// Along the rotor's axis, from the lower face of the blank (faces.rs).
    LowerFace,
    /// The same from the upper face.
    UpperFace,
}

/// Plane of plunges with its boundary axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungePlane {
    /// Family to which the plane belongs.
    pub family: PlungeFamily,
    /// Place of its origin along the rotor's axis, mm; 0 for planes along that axis.
    pub z_mm: f64,
    /// Distance of its origin from the rotor's axis, mm; 0 for planes across it.
    pub radius_mm: f64,
    /// Boundary axes in the plane: those nearest to the two blades.
    pub boundary: Boundary,
    /// Number of columns (plunge axes) in the plane.
    pub columns: usize,
    /// Distance of neighbouring columns at the roof, mm.
    pub spacing_mm: f64,
    /// Largest distance from the plane before, square to the axes, divided by the one that the cusp height allows.
    pub step_ratio: f64,
}

/// Plan of all plunges of a passage.
#[derive(Clone, Debug)]
pub struct PassagePlan {
    /// Planes in the order of machining.
    pub planes: Vec<PlungePlane>,
    /// Plunges in the order of machining.
    pub plunges: Vec<Plunge>,
    /// Largest tools that would pass, in planes along the blade.
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
