//! Shapes of a stock before the first cut, and the shape that a tool has left of one.

use std::fmt::Debug;

use arcfeed_kinematics::vector::Vector;

use super::dexel::{Dexel, Interval};
use super::frame::Frame;
use super::grid::Grid;
use super::lattice::Lattice;
use super::motion::Pose;
use super::section::Sweep;
use super::sweep::{Pass, passes};
use super::tool::Tool;

/// Gaps between the slabs of a solid of revolution that are rounding.
const GAP_MM: f64 = 1e-9;

/// Solid that can be intersected with the rays of a tri-dexel model.
pub trait Solid: Debug + Send + Sync {
    /// Lowest and highest corner of a box around the solid, with faces along the axes.
    fn bounds_mm(&self) -> [Vector; 2];

    /// Material of the solid on all rays of a lattice along `axis` (0, 1, 2 for x, y, z).
    fn grid(&self, lattice: &Lattice, axis: usize) -> Grid;
}

/// Solid before its first cut; its coordinates can be transformed to another frame.
pub trait InitialSolid: Solid {
    /// The same solid in the coordinates of another frame.
    fn in_frame(&self, frame: &Frame) -> Box<dyn InitialSolid>;
}

/// Solid without the material that a tool has swept.
#[derive(Debug)]
pub struct Machined<'a> {
    /// Solid before the sweeps.
    pub solid: &'a dyn Solid,
    /// Tool that removes the material.
    pub tool: &'a Tool,
    /// Sweeps that the tool has made.
    pub sweeps: &'a [Sweep],
}

impl Solid for Machined<'_> {
    fn bounds_mm(&self) -> [Vector; 2] {
        self.solid.bounds_mm()
    }

    fn grid(&self, lattice: &Lattice, axis: usize) -> Grid {
        let mut grid = self.solid.grid(lattice, axis);
        let mut passes = passes(self.tool, self.sweeps, axis);
        // A lattice may be one layer of many, of which most sweeps meet few.
        passes.retain(|pass| Lattice::across(axis).iter().all(|across| !pass.cells(lattice, *across).is_empty()));
        grid.cut(&passes);
        grid
    }
}

/// Rectangular block with its edges along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// The lowest corner.
    pub lowest_mm: Vector,
    /// The highest corner.
    pub highest_mm: Vector,
}

impl Solid for Block {
    fn bounds_mm(&self) -> [Vector; 2] {
        [self.lowest_mm, self.highest_mm]
    }

    fn grid(&self, lattice: &Lattice, axis: usize) -> Grid {
        let is_in =
            |point: &Vector, across: usize| (self.lowest_mm[across]..self.highest_mm[across]).contains(&point[across]);
        Grid::new(lattice, axis, |point| {
            let is_met = Lattice::across(axis).into_iter().all(|across| is_in(&point, across));
            let whole = Interval::new(self.lowest_mm[axis], self.highest_mm[axis]);
            if is_met { Dexel::One(whole) } else { Dexel::Empty }
        })
    }
}

/// A solid of revolution in any position: a round bar, a tube, a turned blank.
#[derive(Clone, Debug)]
pub struct Revolved {
    tool: Tool,
    standing: Sweep,
}

impl Revolved {
    /// The solid of `tool`, at rest, with the bottom at the pose's tip. `None` if the pose's axis has no direction.
    pub fn new(tool: Tool, pose: &Pose) -> Option<Self> {
        let axis = arcfeed_kinematics::vector::unit(pose.axis)?;
        Some(Revolved { tool, standing: Sweep { from_mm: pose.tip_mm, to_mm: pose.tip_mm, axis } })
    }
}

impl Solid for Revolved {
    fn bounds_mm(&self) -> [Vector; 2] {
        let boxes = passes(&self.tool, &[self.standing], 0);
        let corner = |side: usize, choose: fn(f64, f64) -> f64| {
            [0, 1, 2].map(|axis| {
                boxes.iter().map(|pass| pass.box_mm()[side][axis]).reduce(choose).unwrap_or(self.standing.from_mm[axis])
            })
        };
        [corner(0, f64::min), corner(1, f64::max)]
    }

    fn grid(&self, lattice: &Lattice, axis: usize) -> Grid {
        let passes = passes(&self.tool, &[self.standing], axis);
        Grid::new(lattice, axis, |point| united(passes.iter().flat_map(|pass: &Pass<'_>| pass.spans(point)).collect()))
    }
}

impl InitialSolid for Revolved {
    fn in_frame(&self, frame: &Frame) -> Box<dyn InitialSolid> {
        Box::new(Revolved { tool: self.tool.clone(), standing: self.standing.in_frame(frame) })
    }
}

/// The material of pieces that may overlap.
fn united(mut pieces: Vec<Interval>) -> Dexel {
    pieces.sort_by(|a, b| a.from_mm.total_cmp(&b.from_mm));
    let mut apart: Vec<Interval> = Vec::new();
    for piece in pieces {
        match apart.last_mut() {
            Some(last) if piece.from_mm <= last.to_mm + GAP_MM => last.to_mm = last.to_mm.max(piece.to_mm),
            _ => apart.push(piece),
        }
    }
    Dexel::new(apart)
}
