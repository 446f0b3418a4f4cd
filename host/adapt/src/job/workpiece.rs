//! `[workpiece]` of a job, and the cutting bodies of its tools.

use std::path::Path;

use arcfeed_kinematics::vector::{Vector, difference, length};
use arcfeed_model::job::Job;
use arcfeed_model::tool::Tool;
use arcfeed_units::{LengthUnit, Nm};
use serde::Serialize;
use toml::Spanned;

use super::flexible::{self, Flexible, Shape};
use super::schema::{BlockTable, JobTable, Quantity, RoundTable, ToolTable, WorkpieceTable};
use super::stl::StlFile;
use super::{Complaint, at, length_mm};

/// Largest memory of a stock model unless the job sets it, in bytes.
pub const MEMORY_MAX_BYTES: usize = 512 * MIB;

/// Bytes in a MiB.
const MIB: usize = 1 << 20;

/// Workpiece of a job, in the coordinates of the program.
#[derive(Clone, Debug, PartialEq)]
pub struct Workpiece {
    /// Shape before the cut (stock).
    pub blank: Blank,
    /// Source of that shape if no job file describes it; `None` if one does.
    pub assumed: Option<AssumedStock>,
    /// Shape of the finished part, if the job names it.
    pub target: Option<StlFile>,
    /// Name of the material, and the byte offset of the name in the job file.
    pub material: Option<(String, usize)>,
    /// Distance of neighbouring dexel rays, mm.
    pub step_mm: f64,
    /// Largest memory that the stock model may take, in bytes.
    pub memory_max_bytes: usize,
    /// The stock is that of the whole part: edges and descents are evaluated at all positions of the rotary axes.
    pub is_indexed: bool,
    /// Flexible part of the workpiece; `None` if it is rigid.
    pub flexible: Option<Flexible>,
    /// Cutting body of the tool, or of the first tool of several.
    pub body: Body,
    /// Cutting bodies of the other tools, in their order.
    pub other_bodies: Vec<Body>,
    /// Byte offset of its table in the job file.
    pub offset: usize,
}

/// Block that is assumed as the stock of a program without a job file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AssumedStock {
    /// Source of the size.
    #[serde(flatten)]
    pub source: StockSource,
    /// Lowest X, Y and Z.
    pub from: [f64; 3],
    /// Highest X, Y and Z.
    pub to: [f64; 3],
}

/// Source of the size of an assumed stock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "source", rename_all = "lowercase")]
pub enum StockSource {
    /// The option `--stock`.
    Option,
    /// A comment of the program.
    Comment {
        /// Line of the comment, counted from 1.
        line: usize,
    },
    /// The extents of the cutting moves.
    Extents,
}

/// Shape of the stock before the run.
#[derive(Clone, Debug, PartialEq)]
pub enum Blank {
    /// Block with its edges along the axes.
    Block {
        /// Corner with the lowest coordinates, mm.
        lowest_mm: Vector,
        /// Corner with the highest coordinates, mm.
        highest_mm: Vector,
    },
    /// Round bar or tube.
    Round {
        /// Centre of one end.
        from_mm: Vector,
        /// Centre of the other end.
        to_mm: Vector,
        /// Outer radius, mm.
        radius_mm: f64,
        /// Inner radius, mm; `None` for a solid bar.
        bore_mm: Option<f64>,
    },
    /// Closed triangle mesh from a file.
    Stl(StlFile),
}

/// Shape of a tool's cutting part apart from its radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Corner radius, mm: of an insert on both sides, of a mill at its end. For a ball-end mill it equals the mill's
    /// radius.
    pub corner_mm: f64,
    /// Height of the cutting edges above the tip, mm.
    pub height_mm: f64,
}

/// Workpiece from a job, `None` if it has none; fails at the first faulty value, also of a tool's body.
pub fn build(table: &JobTable, job: &Job, folder: &Path) -> Result<Option<Workpiece>, Complaint> {
    let bodies = table.tool.0.iter().zip(job.tools.iter()).map(|(tool, setup)| {
        let height = tool.height.as_ref().map(|height| length_mm(height, job.unit, "height")).transpose()?;
        Ok((tool, corner_mm(tool, &setup.tool, job.unit)?, height))
    });
    let bodies = bodies.collect::<Result<Vec<_>, Complaint>>()?;
    let Some(entry) = &table.workpiece else { return Ok(None) };
    let WorkpieceTable { stl_units, step, memory_mib, target, material, indexed, .. } = entry.as_ref();
    let body = |(tool, corner_mm, height_mm): &(&ToolTable, f64, Option<f64>)| match *height_mm {
        None if bodies.len() > 1 => {
            Err(at(&tool.kind, "a workpiece needs the height of each [[tool]]: how far up from its tip the tool cuts"))
        }
        None => Err(at(entry, "a workpiece needs [tool] height: how far up from its tip the tool cuts")),
        Some(height_mm) if height_mm < *corner_mm => {
            Err(at(&tool.kind, "the tool's height must be at least its corner_radius"))
        }
        Some(height_mm) => Ok(Body { corner_mm: *corner_mm, height_mm }),
    };
    let mut solids = bodies.iter().map(body).collect::<Result<Vec<_>, Complaint>>()?.into_iter();
    let Some(first) = solids.next() else { return Ok(None) };
    let stl_unit = stl_units.map_or(LengthUnit::Mm, LengthUnit::from);
    let named = |file: &Spanned<String>| StlFile::named(file, folder, stl_unit);
    let target = target.as_ref().map(named).transpose()?;
    let memory_max_bytes = match memory_mib {
        Some(mib) if !(1..=1 << 20).contains(mib.as_ref()) => {
            return Err(at(mib, "memory_mib must be 1 or more, in MiB"));
        }
        given => given.as_ref().map_or(MEMORY_MAX_BYTES, |mib| *mib.as_ref() * MIB),
    };
    if let Some(material) = material.as_ref().filter(|_| job.tools.iter().any(|setup| setup.follows_program)) {
        return Err(at(
            material,
            "the estimate of the power needs the feed per tooth: write it in [law] in place of \"programmed\", or remove material",
        ));
    }
    let has_machine = table.machine.file.is_some() || table.machine.preset.is_some();
    if let Some(indexed) = indexed.as_ref().filter(|indexed| *indexed.as_ref() && !has_machine) {
        return Err(at(indexed, "indexed = true needs a [machine]: it turns the workpiece to the tool"));
    }
    let flexible = entry.as_ref().flexible.as_ref();
    if let Some(flexible) = flexible.filter(|_| table.cutting.is_none()) {
        return Err(at(flexible, "[workpiece.flexible] needs [cutting]: without edges there are no forces"));
    }
    Ok(Some(Workpiece {
        flexible: flexible.map(|flexible| flexible::build(flexible, job.unit, &named)).transpose()?,
        blank: blank(entry, job.unit, folder, stl_unit)?,
        assumed: None,
        target,
        material: material.as_ref().map(|name| (name.as_ref().clone(), name.span().start)),
        step_mm: length_mm(step, job.unit, "step")?,
        memory_max_bytes,
        is_indexed: indexed.as_ref().is_some_and(|indexed| *indexed.as_ref()),
        body: first,
        other_bodies: solids.collect(),
        offset: entry.span().start,
    }))
}

impl Workpiece {
    /// STL files that the workpiece names.
    pub fn files(&self) -> impl Iterator<Item = &StlFile> {
        let blank = match &self.blank {
            Blank::Stl(file) => Some(file),
            Blank::Block { .. } | Blank::Round { .. } => None,
        };
        let sheet = match self.flexible.as_ref().map(|flexible| &flexible.shape) {
            Some(Shape::Sheet { file, .. }) => Some(file),
            Some(Shape::Block { .. }) | None => None,
        };
        blank.into_iter().chain(&self.target).chain(sheet)
    }
}

fn corner_mm(table: &ToolTable, tool: &Tool, unit: LengthUnit) -> Result<f64, Complaint> {
    let Some(given) = &table.corner_radius else { return Ok(0.0) };
    let corner_mm = given.as_ref().to_mm(unit);
    let (most_mm, message) = match tool {
        Tool::CupMill(cup) => (
            Nm(cup.outer_radius.0 - cup.inner_radius.0).to_mm() / 2.0,
            "corner_radius of a cup-mill's inserts must be 0 to half the width of its ring",
        ),
        Tool::EndMill(mill) => {
            (mill.radius.to_mm(), "corner_radius of an end-mill must be 0 (flat) to half its diameter (a ball)")
        }
    };
    if (0.0..=most_mm + Nm(1).to_mm()).contains(&corner_mm) {
        Ok(corner_mm.min(most_mm))
    } else {
        Err(at(given, message))
    }
}

fn blank(
    entry: &Spanned<WorkpieceTable>,
    unit: LengthUnit,
    folder: &Path,
    stl_unit: LengthUnit,
) -> Result<Blank, Complaint> {
    let point = |point: &[Quantity; 3]| point.map(|quantity| quantity.to_mm(unit));
    match (&entry.as_ref().block, &entry.as_ref().round, &entry.as_ref().stl) {
        (Some(block), None, None) => {
            let BlockTable { from, to } = block.as_ref();
            let (lowest_mm, highest_mm) = (point(from), point(to));
            let is_block = lowest_mm.iter().zip(highest_mm).all(|(low, high)| *low < high);
            let message = "`from` must be below `to` in X, Y and Z";
            if is_block { Ok(Blank::Block { lowest_mm, highest_mm }) } else { Err(at(block, message)) }
        }
        (None, Some(round), None) => {
            let RoundTable { from, to, radius, bore } = round.as_ref();
            let (from_mm, to_mm) = (point(from), point(to));
            if length(difference(to_mm, from_mm)) == 0.0 {
                return Err(at(round, "`from` and `to`, the middles of both ends, are the same point"));
            }
            let radius_mm = length_mm(radius, unit, "radius")?;
            let bore_mm = bore.as_ref().map(|bore| length_mm(bore, unit, "bore")).transpose()?;
            match (bore, bore_mm) {
                (Some(bore), Some(bore_mm)) if bore_mm >= radius_mm => {
                    Err(at(bore, "bore, a radius, must be less than radius"))
                }
                _ => Ok(Blank::Round { from_mm, to_mm, radius_mm, bore_mm }),
            }
        }
        (None, None, Some(file)) => StlFile::named(file, folder, stl_unit).map(Blank::Stl),
        _ => Err(at(
            entry,
            "give the workpiece as one of block = { from = [x, y, z], to = [x, y, z] }, round = { from = [x, y, z], \
             to = [x, y, z], radius, bore } or stl = \"file.stl\"",
        )),
    }
}
