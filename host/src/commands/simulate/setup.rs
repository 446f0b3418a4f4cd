//! Workpiece of the job as a stock model, and its tool as a solid and as cutting edges.

use std::path::Path;
use std::sync::Arc;

use arcfeed_dexel::motion::Pose;
use arcfeed_dexel::profile::ProfileError;
use arcfeed_dexel::solid::{Block, InitialSolid, Revolved};
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_hil_sim::removal::cutter::{NumberedTools, StockCutter, StockCutterSettings};
use arcfeed_hil_sim::removal::loads::{LoadMeter, LoadSettings};
use arcfeed_hil_sim::removal::tilted::TiltedWorkpiece;
use arcfeed_kinematics::vector::{difference, length};
use arcfeed_milling::cutting::layers::Layers;
use arcfeed_milling::cutting::material::Kienzle;
use arcfeed_model::job::ToolSetup;
use arcfeed_model::tool::Tool as JobTool;
use arcfeed_units::Nm;

use super::super::outcome::Failure;
use super::body;
use super::edges;
use super::mark_figures::MarkReference;
use super::surface;
use crate::engagement::sections::TangentialForce;
use crate::files;
use crate::job::workpiece::{Blank, Body};
use crate::job::{Cutting, JobFile, Workpiece};
use crate::place::place;

/// Tolerance of chords against the path and the tool's corners, as a fraction of the step between rays.
const TOLERANCE_RATIO: f64 = 1.0 / 50.0;

/// Workpiece of a job, prepared for a simulated run, with its place in the job file for error messages.
pub struct Setup<'a> {
    /// Workpiece as the job describes it.
    pub workpiece: &'a Workpiece,
    /// Stock before the run, and the tools that cut it.
    pub settings: StockCutterSettings,
    /// Place of the workpiece's table in the job file, as `file:line:column`.
    pub place: String,
    /// Height above the tip up to which the tool cuts.
    depth_mm: f64,
    /// Cutting edges and layers of the stock before the run; `None` without `[cutting]` in the job.
    pub loads: Option<LoadSettings>,
    /// Reference from which the marks of these edges are measured.
    pub truth: Option<MarkReference>,
    /// Tangential force per width of a chip; `None` without `[cutting]` in the job.
    pub force: Option<TangentialForce>,
    /// Specific cutting force (Kienzle) of the workpiece's material; `None` if the job does not name the material.
    pub material: Option<Kienzle>,
}

impl<'a> Setup<'a> {
    /// Setup of a job; `None` if it has no workpiece.
    ///
    /// # Errors
    /// The workpiece is invalid, or larger than allowed, or the tool has no such shape.
    pub fn of(path: &Path, file: &'a JobFile) -> Result<Option<Self>, Failure> {
        let Some(workpiece) = &file.workpiece else { return Ok(None) };
        let text = files::read_to_string(path).unwrap_or_default();
        let located = |offset: usize| {
            let [line, column] = place(&text, offset);
            format!("{}:{line}:{column}", path.display())
        };
        let place = located(workpiece.offset);
        let tolerance_mm = workpiece.step_mm * TOLERANCE_RATIO;
        let input_failure = |error: &dyn std::fmt::Display| Failure::Input(format!("{place}: {error}"));
        let solid_of = |setup: &ToolSetup, body: &Body| {
            tool(&setup.tool, body, tolerance_mm).map_err(|error| input_failure(&error))
        };
        let tool = solid_of(file.job.tools.first(), &workpiece.body)?;
        let others = file.job.tools.iter().skip(1).zip(&workpiece.other_bodies);
        let others = others.map(|(setup, body)| Ok((setup.number, solid_of(setup, body)?)));
        let others = others.collect::<Result<Vec<_>, Failure>>()?;
        let first = file.job.tools.first().number;
        // Without a job file the tools of unknown diameter are not in the job.
        let has_others = file.job.tools.len() > 1 || workpiece.assumed.is_some() && first.is_some();
        let numbered = has_others.then_some(NumberedTools { first, others });
        let blank: Arc<dyn InitialSolid> =
            solid(&workpiece.blank, tolerance_mm).map_err(|error| error.at(&place))?.into();
        let stock = Stock::new(&*blank, workpiece.step_mm, workpiece.memory_max_bytes)
            .map_err(|error| input_failure(&error))?;
        let machine = file.machine.as_ref().map(|named| named.machine);
        let edges = |cutting: &Cutting| -> Result<(LoadSettings, MarkReference), body::SetupFault> {
            let (process, flexible) = edges::process(file, cutting, &*blank)?;
            let truth =
                MarkReference { blank: process.engagement().layers().clone(), turned: edges::turned(file, cutting)? };
            let (step_max_rad, samples) = (edges::step_max_rad(file, &process), edges::samples(file));
            let can_tilt = machine.is_some() && flexible.is_none();
            let is_indexed = workpiece.is_indexed;
            // Thousands of plunges turn the part one after the other: only the material about each of them is turned with it.
            let about_mm = (is_indexed && file.plunge.is_some()).then(|| radius_mm(&file.job.tools.first().tool));
            let tilted = can_tilt.then(|| {
                let (blank, tool) = (Arc::clone(&blank), tool.clone());
                TiltedWorkpiece { blank, tool, tolerance_mm, about_mm }
            });
            Ok((LoadSettings { process, machine, step_max_rad, flexible, tilted, is_indexed, samples }, truth))
        };
        let wrong = |(offset, message): body::SetupFault, table: usize| {
            Failure::Input(format!("{}: {message}", located(offset.unwrap_or(table))))
        };
        let force = file.cutting.as_ref().map(|cutting| {
            edges::tangential_force(&cutting.coefficients).map_err(|fault| wrong(fault, cutting.offset))
        });
        let edges = file.cutting.as_ref().map(|cutting| edges(cutting).map_err(|fault| wrong(fault, cutting.offset)));
        let material = workpiece
            .material
            .as_ref()
            .map(|(name, offset)| edges::tangential(name, *offset).map_err(|fault| wrong(fault, *offset)));
        let (loads, truth) = edges.transpose()?.unzip();
        let depth_mm = file.cutting.as_ref().map_or(workpiece.body.height_mm, |cutting| cutting.axial_depth_mm);
        let settings = StockCutterSettings { stock, tool, numbered, machine, tolerance_mm };
        let material = material.transpose()?;
        Ok(Some(Setup { workpiece, settings, place, depth_mm, loads, truth, force: force.transpose()?, material }))
    }

    /// New meter for chips and forces of the edges in a run; `None` without `[cutting]`.
    pub fn load_meter(&self) -> Option<LoadMeter> {
        self.loads.clone().map(LoadMeter::new)
    }

    /// Workpiece as layers along Z, and the height above the tip up to which each layer is cut: the job's cutting
    /// depth, or the tool's height if there is none. The layers are as high as the distance of the dexel rays unless
    /// the job says otherwise.
    pub fn layers(&self) -> (Layers, f64) {
        match &self.loads {
            Some(loads) => (loads.process.engagement().layers().clone(), self.depth_mm),
            None => (Layers::of(&self.settings.stock, edges::UPRIGHT), self.depth_mm),
        }
    }

    /// Workpiece in which sections of plunges can be measured at all positions of the rotary axes; `None` if the job
    /// has no such plunges.
    pub fn tilted_for_plunges(&self, file: &JobFile) -> Option<TiltedWorkpiece> {
        let is_indexed = file.plunge.is_some() && self.workpiece.is_indexed;
        self.loads.as_ref().filter(|_| is_indexed).and_then(|loads| loads.tilted.clone())
    }

    /// New stock model for a run, with the tools that cut it.
    pub fn cutter(&self) -> StockCutter {
        StockCutter::new(self.settings.clone())
    }

    /// Finished part as a stock with the same rays; `None` if the job names none.
    ///
    /// # Errors
    /// The target's file contains no solid, or it needs too much memory.
    pub fn target(&self) -> Result<Option<Stock>, Failure> {
        let Some(file) = &self.workpiece.target else { return Ok(None) };
        let mesh = surface::mesh(file).map_err(Failure::Input)?;
        let stock = Stock::on(self.settings.stock.lattice(), &mesh, self.workpiece.memory_max_bytes);
        stock.map(Some).map_err(|error| Failure::Input(format!("{}: {error}", self.place)))
    }
}

/// Fault of a shape: complete with its file, or still without a place.
enum ShapeFault {
    Located(Failure),
    Here(String),
}

impl ShapeFault {
    fn at(self, place: &str) -> Failure {
        match self {
            ShapeFault::Located(failure) => failure,
            ShapeFault::Here(message) => Failure::Input(format!("{place}: {message}")),
        }
    }
}

fn solid(blank: &Blank, tolerance_mm: f64) -> Result<Box<dyn InitialSolid>, ShapeFault> {
    match blank {
        Blank::Block { lowest_mm, highest_mm } => {
            Ok(Box::new(Block { lowest_mm: *lowest_mm, highest_mm: *highest_mm }))
        }
        Blank::Round { from_mm, to_mm, radius_mm, bore_mm } => {
            let along = difference(*to_mm, *from_mm);
            let body = match bore_mm {
                Some(bore_mm) => Tool::ring([*radius_mm, *bore_mm], 0.0, length(along), tolerance_mm),
                None => Tool::cylinder(*radius_mm, length(along)),
            };
            let body = body.map_err(|error| ShapeFault::Here(error.to_string()))?;
            let round = Revolved::new(body, &Pose { tip_mm: *from_mm, axis: along });
            round
                .map(|round| Box::new(round) as Box<dyn InitialSolid>)
                .ok_or_else(|| ShapeFault::Here("it has no axis".into()))
        }
        Blank::Stl(file) => {
            let mesh = surface::mesh(file).map_err(|error| ShapeFault::Located(Failure::Input(error)))?;
            Ok(Box::new(mesh))
        }
    }
}

/// Outermost radius of a tool.
fn radius_mm(tool: &JobTool) -> f64 {
    Nm::to_mm(match tool {
        JobTool::CupMill(cup) => cup.outer_radius,
        JobTool::EndMill(mill) => mill.radius,
    })
}

/// Cutting solid of the job's tool.
fn tool(tool: &JobTool, body: &Body, tolerance_mm: f64) -> Result<Tool, ProfileError> {
    let Body { corner_mm, height_mm } = *body;
    match tool {
        JobTool::CupMill(cup) => {
            let radii_mm = [cup.outer_radius, cup.inner_radius].map(Nm::to_mm);
            Tool::ring(radii_mm, corner_mm, height_mm, tolerance_mm)
        }
        JobTool::EndMill(mill) => Tool::bull_nose([mill.radius.to_mm(), corner_mm], height_mm, tolerance_mm),
    }
}
