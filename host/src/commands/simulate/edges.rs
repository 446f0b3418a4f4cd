//! Cutting edges of the job's tool, the layers of its workpiece, and the cutting forces of its material.

use std::f64::consts::{PI, TAU};

use arcfeed_dexel::solid::Solid;
use arcfeed_hil_sim::removal::chatter_detection::{ChatterSamples, FLOOR_RATIO};
use arcfeed_hil_sim::removal::envelope::CuttingSolid;
use arcfeed_hil_sim::removal::flexible_workpiece::FlexibleWorkpiece;
use arcfeed_milling::cutting::edge_engagement::{EdgeEngagement, slices};
use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, EdgeError, EndMill, Ring};
use arcfeed_milling::cutting::layers::Layers;
use arcfeed_milling::cutting::material::{Cutting as Forces, Kienzle, Linear, MATERIALS};
use arcfeed_milling::process::Process;
use arcfeed_modal::dynamics::modal::Mode;
use arcfeed_modal::dynamics::transition::Rule;
use arcfeed_modal::dynamics::vibration::{Stepping, Vibration};
use arcfeed_model::tool::Tool;
use arcfeed_units::{Nm, S_PER_MIN};

use super::body::{self, SetupFault};
use crate::engagement::sections::TangentialForce;
use crate::job::cutting::{Coefficients, Mode as ModeFigures};
use crate::job::{Cutting, JobFile};

/// Index of the axis Z along which the tool stands, except under G43.4.
pub const UPRIGHT: usize = 2;

/// Largest turn of the tool in a step.
const STEP_RAD: f64 = 3.0 / 180.0 * PI;

/// Steps in a period of the fastest relevant mode: larger steps hide chatter or invent it (docs/forces.md).
const STEPS_A_PERIOD: f64 = 25.0;

/// Time stepping with displacements that agree with their forces to this tolerance.
const FLEXIBLE: Stepping = Stepping { rule: Rule::Exact, tolerance_mm: 1e-7, iterations_max: 20 };

/// A rigid tool does not move: one pass.
const RIGID: Stepping = Stepping { rule: Rule::Exact, tolerance_mm: 0.0, iterations_max: 1 };

/// Cutting process (edges, layers, forces, vibration) of a job in its blank before a run, and the blank as a flexible
/// workpiece if the job describes one.
///
/// # Errors
/// The material is unknown, the edges are invalid, there are too many layers, or the flexible part has no such modes.
pub fn process(
    file: &JobFile,
    cutting: &Cutting,
    blank: &dyn Solid,
) -> Result<(Process, Option<FlexibleWorkpiece>), SetupFault> {
    let Some(workpiece) = &file.workpiece else { return Err((None, "there is no workpiece".into())) };
    let forces = forces(&cutting.coefficients)?;
    let input_failure = |error: &dyn std::fmt::Display| (None, error.to_string());
    let rise_mm = rise_mm(cutting);
    let edges = edges(file, cutting, workpiece.body.corner_mm).map_err(|error| input_failure(&error))?;
    let layers = Layers::of_solid(blank, UPRIGHT, rise_mm, workpiece.step_mm).map_err(|error| input_failure(&error))?;
    let depth_mm = edges.rake_max_mm();
    let engagement = EdgeEngagement::new(edges, layers, depth_mm)
        .map_err(|error| input_failure(&error))?
        .up_to_mm(cutting.axial_depth_mm);
    let (mut modes, mut flexible_workpiece) = (Vec::new(), None);
    if let Some(flexible) = &workpiece.flexible {
        let (body, of_body) = body::flexible(flexible, blank, cutting.axial_depth_mm)?;
        modes.extend(of_body);
        flexible_workpiece = Some(body);
    }
    for settings in &cutting.modes {
        modes.push(mode(settings)?);
    }
    let stepping = if modes.is_empty() { RIGID } else { FLEXIBLE };
    Ok((Process::new(engagement, forces, Vibration::new(modes, stepping)), flexible_workpiece))
}

/// Solid that the edges of the tool would sweep without runout: the reference from which marks are measured.
///
/// # Errors
/// The edges are invalid.
pub fn turned(file: &JobFile, cutting: &Cutting) -> Result<CuttingSolid, SetupFault> {
    let corner_mm = file.workpiece.as_ref().map_or(0.0, |workpiece| workpiece.body.corner_mm);
    let edges = true_edges(file, cutting, corner_mm).map_err(|error| (None, error.to_string()))?;
    Ok(CuttingSolid { slices: slices(&edges), reach_mm: cutting.axial_depth_mm })
}

/// Largest rotation of the tool in one step of the vibration's integration, rad.
///
/// The fastest modes are ignored as long as their vibrations together stay below the largest change that counts as
/// none. Such modes cannot chatter, and the exact rule follows their motion in steps longer than their periods.
pub fn step_max_rad(file: &JobFile, process: &Process) -> f64 {
    let tool = file.job.tools.first();
    let turned_rad_per_s = f64::from(tool.spindle.0) * TAU / S_PER_MIN;
    let feed_mm = f64::from(tool.feed_per_tooth.0);
    let (force_n, mut left_mm) = (process.force_max_n(feed_mm), feed_mm * FLOOR_RATIO);
    let mut modes: Vec<&Mode> = process.vibration().modes().iter().collect();
    modes.sort_by(|one, other| other.frequency_hz.total_cmp(&one.frequency_hz));
    let fastest = modes.into_iter().find(|mode| {
        left_mm -= mode.swing_max_mm(force_n);
        left_mm <= 0.0
    });
    let fastest_hz = fastest.map_or(0.0, |mode| mode.frequency_hz);
    STEP_RAD.min(turned_rad_per_s / (fastest_hz * STEPS_A_PERIOD))
}

/// Empty collection of samples for chatter detection: one sample for each active tooth and turn.
pub fn samples(file: &JobFile) -> ChatterSamples {
    let teeth = usize::from(file.job.tools.first().tool.active_teeth());
    ChatterSamples::new(teeth, f64::from(file.job.tools.first().feed_per_tooth.0) * FLOOR_RATIO)
}

/// Vibration mode of a tool, from its values in the job, in the program's coordinates.
///
/// # Errors
/// The values do not describe a mode.
pub fn mode(figures: &ModeFigures) -> Result<Mode, SetupFault> {
    Mode::from_stiffness(
        figures.frequency_hz,
        figures.damping_ratio,
        figures.stiffness_n_per_mm,
        &figures.direction.into(),
    )
    .map_err(|error| (Some(figures.offset), error.to_string()))
}

fn rise_mm(cutting: &Cutting) -> f64 {
    cutting.axial_depth_mm / cutting.layers as f64
}

/// Equal teeth about the spindle's axis, with one slice above the highest computed layer, for a tip inside a layer.
fn true_edges(file: &JobFile, cutting: &Cutting, corner_mm: f64) -> Result<Cutter, EdgeError> {
    let rise_mm = rise_mm(cutting);
    let (slices, height_mm) = (Pieces::Slices { rise_mm }, cutting.axial_depth_mm + rise_mm);
    match &file.job.tools.first().tool {
        Tool::CupMill(cup) => {
            let ring = Ring {
                outer_radius_mm: cup.outer_radius.to_mm(),
                inner_radius_mm: cup.inner_radius.to_mm(),
                corner_mm,
                active_teeth: usize::from(cup.active_teeth),
                height_mm,
            };
            Cutter::ring(&ring, slices)
        }
        Tool::EndMill(mill) => {
            let mill = EndMill {
                diameter_mm: 2.0 * Nm::to_mm(mill.radius),
                corner_mm,
                teeth: usize::from(mill.teeth),
                helix_rad: cutting.helix_rad,
                height_mm,
            };
            Cutter::end_mill(&mill, slices)
        }
    }
}

fn edges(file: &JobFile, cutting: &Cutting, corner_mm: f64) -> Result<Cutter, EdgeError> {
    let mut cutter = true_edges(file, cutting, corner_mm)?;
    if !cutting.pitch_rad.is_empty() {
        cutter = cutter.with_pitch(&cutting.pitch_rad)?;
    }
    if !cutting.offsets_mm.is_empty() {
        cutter = cutter.with_offsets(&cutting.offsets_mm)?;
    }
    match cutting.runout {
        Some((eccentricity_mm, direction_rad)) => cutter.with_runout(eccentricity_mm, direction_rad),
        None => Ok(cutter),
    }
}

/// Looks up the tangential force coefficients of a material by its name in the job; `offset` is the place of the name
/// in the file.
///
/// # Errors
/// The material is unknown.
pub fn tangential(name: &str, offset: usize) -> Result<Kienzle, SetupFault> {
    let found = MATERIALS.iter().find(|material| material.name == name);
    found.map(|material| material.tangential).ok_or_else(|| {
        let names = MATERIALS.map(|material| format!("\"{}\"", material.name)).join(", ");
        (Some(offset), format!("no coefficients are known of `{name}`; write one of {names}, or kc11 and mc"))
    })
}

/// Tangential force per width of a chip, from the coefficients of a job.
///
/// # Errors
/// The material is unknown.
pub fn tangential_force(coefficients: &Coefficients) -> Result<TangentialForce, SetupFault> {
    Ok(match forces(coefficients)? {
        Forces::Kienzle([Kienzle { specific_mpa, exponent_ratio }, ..]) => {
            TangentialForce { specific_mpa, exponent_ratio, edge_n_per_mm: 0.0 }
        }
        Forces::Linear([Linear { specific_mpa, edge_n_per_mm }, ..]) => {
            TangentialForce { specific_mpa, exponent_ratio: 0.0, edge_n_per_mm }
        }
    })
}

/// Slopes of the tangential and of the radial force per width against the chip thickness, at this thickness, N/mm2:
///
/// ```text
/// Kienzle  dF/(b dh) = k (1 - m) h^-m     (1)
/// linear   dF/(b dh) = k                  (2)
/// ```
///
/// # Errors
/// The material is unknown.
pub fn slopes_mpa(coefficients: &Coefficients, chip_mm: f64) -> Result<[f64; 2], SetupFault> {
    Ok(match forces(coefficients)? {
        Forces::Kienzle([tangential, radial, _]) => {
            [tangential, radial].map(|Kienzle { specific_mpa, exponent_ratio }| {
                specific_mpa * (1.0 - exponent_ratio) * libm::pow(chip_mm, -exponent_ratio) // (1)
            })
        }
        Forces::Linear([tangential, radial, _]) => [tangential, radial].map(|linear| linear.specific_mpa), // (2)
    })
}

fn forces(coefficients: &Coefficients) -> Result<Forces, SetupFault> {
    match coefficients {
        Coefficients::Material { name, offset, ratios: [radial, axial] } => {
            Ok(tangential(name, *offset)?.with_ratios(*radial, *axial))
        }
        Coefficients::Kienzle { specific_mpa, exponent_ratio, ratios: [radial, axial] } => {
            let (specific_mpa, exponent_ratio) = (*specific_mpa, *exponent_ratio);
            Ok(Kienzle { specific_mpa, exponent_ratio }.with_ratios(*radial, *axial))
        }
        Coefficients::Linear { cutting_mpa, edge_n_per_mm } => Ok(Forces::linear(*cutting_mpa, *edge_n_per_mm)),
    }
}
