//! `[workpiece.flexible]`: the flexible part of the workpiece, clamped at a face: a block, or a wall or a blade from an
//! STL file.

use arcfeed_kinematics::vector::Vector;
use arcfeed_units::LengthUnit;
use serde::Deserialize;
use toml::Spanned;

use super::quantity::Quantity;
use super::stl::StlFile;
use super::{Complaint, at};

/// Most cells of all axes together: more take minutes (docs/fe.md).
const CELLS_MAX: usize = 2000;

/// Number of modes, unless the job sets it.
const MODES: usize = 10;

/// Most modes; high natural frequencies require short time steps.
const MODES_MAX: usize = 100;

/// `[workpiece.flexible]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FlexibleTable {
    block: Option<Spanned<BlockTable>>,
    stl: Option<Spanned<SheetTable>>,
    material: Option<Spanned<String>>,
    young: Option<Spanned<f64>>,
    poisson: Option<Spanned<f64>>,
    density: Option<Spanned<f64>>,
    modes: Option<Spanned<usize>>,
    damping: Spanned<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct BlockTable {
    from: [Quantity; 3],
    to: [Quantity; 3],
    cells: Spanned<[usize; 3]>,
    clamped: Spanned<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SheetTable {
    file: Spanned<String>,
    thickness: Spanned<String>,
    cells: Spanned<[usize; 3]>,
    clamped: Spanned<String>,
}

/// Flexible body and the number of its modes.
#[derive(Clone, Debug, PartialEq)]
pub struct Flexible {
    /// Undeformed shape, in the coordinates of the program.
    pub shape: Shape,
    /// Index (0 X, 1 Y, 2 Z) of the axis square to the clamped face, and whether that face is at the axis's higher end.
    pub clamped: (usize, bool),
    /// Number of finite elements along each axis.
    pub cells: [usize; 3],
    /// Elastic constants or material.
    pub material: Elastic,
    /// Number of vibration modes that are used, from the lowest frequency on.
    pub modes: usize,
    /// Damping of each mode, as a fraction of critical damping.
    pub damping_ratio: f64,
    /// Byte offset of its table in the job file.
    pub offset: usize,
}

/// Undeformed shape of a flexible workpiece.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Block with its edges along the axes.
    Block {
        /// Corner with the lowest coordinates, mm.
        lowest_mm: Vector,
        /// Corner with the highest coordinates, mm.
        highest_mm: Vector,
    },
    /// Wall or blade from a mesh, thin between its two sides.
    Sheet {
        /// Closed surface, from an STL file.
        file: StlFile,
        /// Index (0 X, 1 Y, 2 Z) of the axis from side to side.
        thickness: usize,
        /// Byte offset of the file's name in the job file.
        offset: usize,
    },
}

/// Elastic properties of a flexible workpiece.
#[derive(Clone, Debug, PartialEq)]
pub enum Elastic {
    /// Material of the table of materials, by its name.
    Material {
        /// Name in the table of materials.
        name: String,
        /// Byte offset of the name.
        offset: usize,
    },
    /// Constants given in the job.
    Constants {
        /// Young's modulus, N/mm2.
        young_mpa: f64,
        /// Poisson's ratio.
        poisson_ratio: f64,
        /// Density, kg/m3.
        density_kg_per_m3: f64,
    },
}

/// Checks the `[workpiece.flexible]` table.
pub(super) fn build(
    entry: &Spanned<FlexibleTable>,
    unit: LengthUnit,
    named: &dyn Fn(&Spanned<String>) -> Result<StlFile, Complaint>,
) -> Result<Flexible, Complaint> {
    let FlexibleTable { block, stl, modes, damping, .. } = entry.as_ref();
    let (shape, cells, clamped) = match (block, stl) {
        (Some(entry), None) => {
            let BlockTable { cells, clamped, .. } = entry.as_ref();
            (block_shape(entry, unit)?, cells, clamped)
        }
        (None, Some(entry)) => {
            let SheetTable { cells, clamped, .. } = entry.as_ref();
            (sheet_shape(entry.as_ref(), named)?, cells, clamped)
        }
        _ => {
            return Err(at(
                entry,
                "give the flexible part as one of block = { from, to, cells, clamped } or stl = { file, thickness, cells, clamped }",
            ));
        }
    };
    let count = cells.as_ref().iter().try_fold(1_usize, |product, cells| product.checked_mul(*cells));
    if !count.is_some_and(|count| (1..=CELLS_MAX).contains(&count)) {
        return Err(at(cells, "cells along X, Y and Z: 1 or more each, at most 2000 in all"));
    }
    let modes = match modes {
        Some(modes) if !(1..=MODES_MAX).contains(modes.as_ref()) => return Err(at(modes, "modes must be 1 to 100")),
        given => given.as_ref().map_or(MODES, |modes| *modes.as_ref()),
    };
    if !(0.0..1.0).contains(damping.as_ref()) {
        return Err(at(damping, "damping, a part of the critical one, must be 0 to less than 1"));
    }
    Ok(Flexible {
        shape,
        clamped: face(clamped)?,
        cells: *cells.as_ref(),
        material: material(entry)?,
        modes,
        damping_ratio: *damping.as_ref(),
        offset: entry.span().start,
    })
}

fn block_shape(entry: &Spanned<BlockTable>, unit: LengthUnit) -> Result<Shape, Complaint> {
    let corner = |corner: &[Quantity; 3]| corner.each_ref().map(|quantity| quantity.to_mm(unit));
    let (lowest_mm, highest_mm) = (corner(&entry.as_ref().from), corner(&entry.as_ref().to));
    if !lowest_mm.iter().zip(highest_mm).all(|(low, high)| *low < high) {
        return Err(at(entry, "`from` must be below `to` in X, Y and Z"));
    }
    Ok(Shape::Block { lowest_mm, highest_mm })
}

fn sheet_shape(
    SheetTable { file, thickness, clamped, .. }: &SheetTable,
    named: &dyn Fn(&Spanned<String>) -> Result<StlFile, Complaint>,
) -> Result<Shape, Complaint> {
    let Some(axis) = ["x", "y", "z"].iter().position(|axis| axis == thickness.as_ref()) else {
        return Err(at(
            thickness,
            "no such axis; write \"x\", \"y\" or \"z\": from one side of the wall or blade to the other",
        ));
    };
    if axis == face(clamped)?.0 {
        return Err(at(thickness, "a wall or a blade is held at a face square to another axis than its thickness"));
    }
    Ok(Shape::Sheet { file: named(file)?, thickness: axis, offset: file.span().start })
}

/// Axis and end of a face name such as `-Z`.
fn face(entry: &Spanned<String>) -> Result<(usize, bool), Complaint> {
    let faces = ["x-", "x+", "y-", "y+", "z-", "z+"];
    match faces.iter().position(|face| face == entry.as_ref()) {
        Some(index) => Ok((index / 2, index % 2 == 1)),
        None => Err(at(
            entry,
            "no such face; write \"x-\", \"x+\", \"y-\", \"y+\", \"z-\" or \"z+\": - at the lower end, + at the upper",
        )),
    }
}

fn material(entry: &Spanned<FlexibleTable>) -> Result<Elastic, Complaint> {
    let FlexibleTable { material, young, poisson, density, .. } = entry.as_ref();
    match (material, young, poisson, density) {
        (Some(name), None, None, None) => {
            Ok(Elastic::Material { name: name.as_ref().clone(), offset: name.span().start })
        }
        (None, Some(young), Some(poisson), Some(density)) => {
            let is_positive = |value: &Spanned<f64>| *value.as_ref() > 0.0 && value.as_ref().is_finite();
            let named = [(young, "young, N/mm2, must be positive"), (density, "density, kg/m3, must be positive")];
            if let Some((wrong, message)) = named.into_iter().find(|(value, _)| !is_positive(value)) {
                return Err(at(wrong, message));
            }
            if !(0.0..0.5).contains(poisson.as_ref()) {
                return Err(at(poisson, "poisson must be 0 to less than 0.5"));
            }
            let [young_mpa, poisson_ratio, density_kg_per_m3] = [young, poisson, density].map(|value| *value.as_ref());
            Ok(Elastic::Constants { young_mpa, poisson_ratio, density_kg_per_m3 })
        }
        _ => Err(at(
            entry,
            "say what it is made of: material = \"Ti-6Al-4V\", or young (N/mm2), poisson and density (kg/m3)",
        )),
    }
}
