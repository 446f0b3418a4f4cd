//! `[cutting]`: cutting edges, the depth in which their chips are computed, and the forces of a chip.

use arcfeed_model::job::Job;
use arcfeed_model::tool::Tool;
use serde::Deserialize;
use toml::Spanned;

use super::quantity::Quantity;
use super::{Complaint, at, length_mm};

/// Most layers of an axial depth.
const LAYERS_MAX: usize = 100;

/// `[cutting]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CuttingTable {
    material: Option<Spanned<String>>,
    kc11: Option<Spanned<f64>>,
    mc: Option<Spanned<f64>>,
    radial: Option<Spanned<f64>>,
    axial: Option<Spanned<f64>>,
    cutting: Option<Spanned<[f64; 3]>>,
    edge: Option<Spanned<[f64; 3]>>,
    axial_depth: Spanned<Quantity>,
    layers: Option<Spanned<usize>>,
    helix: Option<Spanned<f64>>,
    runout: Option<Spanned<RunoutTable>>,
    offsets: Option<Spanned<Vec<Quantity>>>,
    pitch: Option<Spanned<Vec<f64>>>,
    #[serde(default)]
    modes: Vec<Spanned<ModeTable>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ModeTable {
    frequency: f64,
    damping: f64,
    stiffness: f64,
    direction: [f64; 3],
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RunoutTable {
    eccentricity: Quantity,
    direction: f64,
}

/// Cutting edges, force coefficients and vibration modes of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Cutting {
    /// Force coefficients.
    pub coefficients: Coefficients,
    /// Height above the tip within which chips are computed, mm.
    pub axial_depth_mm: f64,
    /// Number of layers into which that height is divided.
    pub layers: usize,
    /// Helix angle of an end mill, rad; positive for a right-hand helix.
    pub helix_rad: f64,
    /// Offset of the tool's axis from the spindle's: distance in mm, and direction in rad before the spindle turns.
    /// `None`: no runout.
    pub runout: Option<(f64, f64)>,
    /// Radial offset of each tooth from the nominal radius, mm; empty if all teeth are alike.
    pub offsets_mm: Vec<f64>,
    /// Angle from each tooth to the next, rad; empty if the pitch is equal.
    pub pitch_rad: Vec<f64>,
    /// Vibration modes of the tool relative to the workpiece; empty if both are rigid.
    pub modes: Vec<Mode>,
    /// Byte offset of its table in the job file.
    pub offset: usize,
}

/// Vibration mode of tool against workpiece, as a tap test measures it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Natural frequency, Hz.
    pub frequency_hz: f64,
    /// Damping, as a fraction of critical damping.
    pub damping_ratio: f64,
    /// Stiffness along the mode's direction, N/mm.
    pub stiffness_n_per_mm: f64,
    /// Direction in the program's coordinates; its length does not matter.
    pub direction: [f64; 3],
    /// Byte offset in the job file.
    pub offset: usize,
}

/// Force coefficients of a job: a material of the catalogue, or values.
#[derive(Clone, Debug, PartialEq)]
pub enum Coefficients {
    /// Coefficients of a material, by its name.
    Material {
        /// Name in the table of materials.
        name: String,
        /// Byte offset of the name.
        offset: usize,
        /// Radial and axial force, each divided by the tangential one.
        ratios: [f64; 2],
    },
    /// Values of Kienzle's force model.
    Kienzle {
        /// kc1.1: specific cutting force at a chip of 1 mm, N/mm2.
        specific_mpa: f64,
        /// mc: exponent of the chip thickness.
        exponent_ratio: f64,
        /// Radial and axial force, each divided by the tangential one.
        ratios: [f64; 2],
    },
    /// Values of the linear force model, each tangential, radial and axial.
    Linear {
        /// Force per chip area, N/mm2.
        cutting_mpa: [f64; 3],
        /// Edge force per width of the chip, N/mm.
        edge_n_per_mm: [f64; 3],
    },
}

/// Checks the `[cutting]` table; `height_mm` is the tool's height, if there is a workpiece.
pub(super) fn build(entry: &Spanned<CuttingTable>, job: &Job, height_mm: Option<f64>) -> Result<Cutting, Complaint> {
    if job.tools.len() > 1 {
        return Err(at(entry, "[cutting] has the edges of one tool: give the job one [tool], or leave [cutting] out"));
    }
    // Chatter and marks are measured in feeds per tooth.
    if job.tools.iter().any(|setup| setup.follows_program) {
        return Err(at(entry, "[cutting] needs a feed per tooth in [law], in place of \"programmed\""));
    }
    let CuttingTable { axial_depth, layers, helix, runout, offsets, pitch, .. } = entry.as_ref();
    let Some(height_mm) = height_mm else {
        return Err(at(entry, "[cutting] needs a [workpiece]: edges find their chips in it"));
    };
    let axial_depth_mm = length_mm(axial_depth, job.unit, "axial_depth")?;
    if axial_depth_mm > height_mm {
        return Err(at(axial_depth, "axial_depth must be at most the tool's height"));
    }
    if let Some(helix) = helix
        && !(matches!(job.tools.first().tool, Tool::EndMill(_)) && (-80.0..=80.0).contains(helix.as_ref()))
    {
        return Err(at(helix, "helix is that of an end-mill, -80 to 80 degrees"));
    }
    if let Some(pitch) = pitch.as_ref().filter(|pitch| pitch.as_ref().iter().any(|degrees| *degrees <= 0.0)) {
        return Err(at(pitch, "pitch, degrees from each tooth to the next, must be above 0"));
    }
    let layers = match layers {
        Some(layers) if !(1..=LAYERS_MAX).contains(layers.as_ref()) => {
            return Err(at(layers, "layers must be 1 to 100"));
        }
        given => given.as_ref().map_or(1, |layers| *layers.as_ref()),
    };
    let to_mm = |quantity: &Quantity| quantity.to_mm(job.unit);
    Ok(Cutting {
        coefficients: coefficients(entry)?,
        axial_depth_mm,
        layers,
        helix_rad: helix.as_ref().map_or(0.0, |helix| helix.as_ref().to_radians()),
        runout: runout.as_ref().map(|runout| {
            let RunoutTable { eccentricity, direction } = runout.as_ref();
            (to_mm(eccentricity), direction.to_radians())
        }),
        offsets_mm: offsets.iter().flat_map(|offsets| offsets.as_ref()).map(to_mm).collect(),
        pitch_rad: pitch.iter().flat_map(|pitch| pitch.as_ref()).map(|degrees| degrees.to_radians()).collect(),
        modes: entry.as_ref().modes.iter().map(mode).collect::<Result<_, _>>()?,
        offset: entry.span().start,
    })
}

fn mode(entry: &Spanned<ModeTable>) -> Result<Mode, Complaint> {
    let ModeTable { frequency, damping, stiffness, direction } = *entry.as_ref();
    let is_mode = frequency > 0.0 && stiffness > 0.0 && (0.0..1.0).contains(&damping);
    if !is_mode || direction == [0.0; 3] {
        let message = "a mode has a frequency (Hz) and a stiffness (N/mm) above 0, a damping of 0 to less than 1, and a \
                       direction that is not [0, 0, 0]";
        return Err(at(entry, message));
    }
    Ok(Mode {
        frequency_hz: frequency,
        damping_ratio: damping,
        stiffness_n_per_mm: stiffness,
        direction,
        offset: entry.span().start,
    })
}

fn coefficients(entry: &Spanned<CuttingTable>) -> Result<Coefficients, Complaint> {
    let CuttingTable { material, kc11, mc, radial, axial, cutting, edge, .. } = entry.as_ref();
    let ratios = || match (radial, axial) {
        (Some(radial), Some(axial)) => Ok([number(radial, "radial")?, number(axial, "axial")?]),
        _ => Err(at(entry, "give `radial` and `axial`, these forces over the tangential one: no source has a default")),
    };
    match (material, kc11, mc, cutting, edge) {
        (Some(name), None, None, None, None) => {
            Ok(Coefficients::Material { name: name.as_ref().clone(), offset: name.span().start, ratios: ratios()? })
        }
        (None, Some(kc11), Some(mc), None, None) => {
            let (specific_mpa, exponent_ratio) = (number(kc11, "kc11")?, number(mc, "mc")?);
            if specific_mpa == 0.0 {
                return Err(at(kc11, "kc11, N/mm2, must be above 0"));
            }
            if !(0.0..1.0).contains(&exponent_ratio) {
                return Err(at(mc, "mc must be 0 to less than 1"));
            }
            Ok(Coefficients::Kienzle { specific_mpa, exponent_ratio, ratios: ratios()? })
        }
        (None, None, None, Some(cutting), Some(edge)) => match (radial, axial) {
            (None, None) => Ok(Coefficients::Linear { cutting_mpa: *cutting.as_ref(), edge_n_per_mm: *edge.as_ref() }),
            (Some(ratio), _) | (_, Some(ratio)) => {
                Err(at(ratio, "`cutting` and `edge` have radial and axial values of their own"))
            }
        },
        _ => Err(at(
            entry,
            "give the coefficients as one of material = \"Ti-6Al-4V\", kc11 and mc, or cutting = [Ktc, Krc, Kac] and \
             edge = [Kte, Kre, Kae]",
        )),
    }
}

fn number(given: &Spanned<f64>, name: &str) -> Result<f64, Complaint> {
    let value = *given.as_ref();
    if value >= 0.0 { Ok(value) } else { Err(at(given, &format!("{name} must be a number, 0 or more"))) }
}
