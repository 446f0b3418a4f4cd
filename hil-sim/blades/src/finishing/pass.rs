//! One pass of a ball end mill along the side of a blade, its axis along the span.
//!
//! The ball's centre is at the height of the contact; the same ball made the pass before, one stepover higher. So at a
//! height z above the centre, with the ball's radius R and c(z) = R - sqrt(R^2 - z^2) for z < 0, else 0,
//!
//! ```text
//! stands out before the pass: least of the allowance and c(z - stepover)        (1)
//! after it, with a rigid pair: least of that and c(z)                           (2)
//! ```
//!
//! so the chip is a crescent of about the allowance times the stepover. Over these few millimetres the blade's section
//! is that at the height of the contact. The modes act at the contact, whose position on the blade is updated some
//! times a tooth.
//!
//! Source: own; the operation is that of Lorong et al., Simulation of a finishing operation, 2012, section 4.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};

use super::side::Side;
use arcfeed_milling::cutting::edge_engagement::EdgeEngagement;
use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, EndMill};
use arcfeed_milling::cutting::layer::Layer;
use arcfeed_milling::cutting::layers::Layers;
use arcfeed_milling::cutting::material::Cutting;
use arcfeed_milling::cutting::pose::ToolPose;
use arcfeed_milling::process::Process;
use arcfeed_modal::dynamics::modal::Mode;
use arcfeed_modal::dynamics::transition::Rule;
use arcfeed_modal::dynamics::vibration::{Stepping, Vibration};
use arcfeed_modal::flexible::{Modal, Workpiece};

/// Updates of the workpiece's modes in a tooth.
const UPDATES_PER_TOOTH: usize = 4;
/// Distance before and after the cut.
const AIR_MM: f64 = 0.5;
/// Rounding of a whole number of layers.
const WHOLE_RATIO: f64 = 1e-9;
/// Depth of the rake faces; chips are not thicker.
const RAKE_MM: f64 = 1.0;

/// Finishing pass of a ball end mill along the side of a blade: geometry, cutting conditions and resolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishingPass {
    /// Side of the blade.
    pub side: Side,
    /// Ball end mill: its corner radius is half of its diameter.
    pub mill: EndMill,
    /// Allowance: material above the nominal surface before the pass, square to it.
    pub allowance_mm: f64,
    /// Distance to the pass before, along the tool's axis.
    pub stepover_mm: f64,
    /// Feed per tooth of the contact, along the side of the blade.
    pub feed_mm_per_tooth: f64,
    /// Tooth passing frequency: teeth per second.
    pub tooth_hz: f64,
    /// Force model of the material.
    pub cutting: Cutting,
    /// Resolution of the computation.
    pub resolution: PassResolution,
}

/// Resolution of the simulation of a finishing pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassResolution {
    /// Height of a layer; the ball's radius is a whole number of them.
    pub rise_mm: f64,
    /// Distance of the rays of a layer.
    pub ray_mm: f64,
    /// Time steps from one tooth to the next.
    pub steps: usize,
}

/// Result of a simulated finishing pass.
#[derive(Clone, Debug)]
pub struct PassResult {
    /// Material of the blade that remains.
    pub layers: Layers,
    /// Samples of tool and force, one for each tooth in order.
    pub teeth: Vec<Tooth>,
    /// Number of time steps in which force and displacement did not converge.
    pub open: usize,
}

/// State at the end of one tooth of a finishing pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tooth {
    /// Position of the contact along the blade's side, from its middle.
    pub along_mm: f64,
    /// Displacement of the tool relative to the workpiece, by vibration and deflection of both.
    pub displacement_mm: Vector3<f64>,
    /// Largest displacement square to the axis since the tooth before.
    pub swing_mm: f64,
    /// Largest force square to the axis since the tooth before.
    pub force_n: f64,
}

/// Error: the mill is no ball end mill with edges, or its radius is not a whole number of layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MillError;

impl std::fmt::Display for MillError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a pass needs a ball end mill whose radius is a whole number of layers")
    }
}

impl std::error::Error for MillError {}

impl FinishingPass {
    fn radius_mm(&self) -> f64 {
        self.mill.diameter_mm / 2.0
    }

    /// Clearance c(z).
    fn clearance_mm(&self, z_mm: f64) -> f64 {
        let below_mm = z_mm.min(0.0);
        let square = self.radius_mm() * self.radius_mm() - below_mm * below_mm;
        self.radius_mm() - libm::sqrt(square.max(0.0))
    }

    /// Height of the material before the pass (1).
    fn before_mm(&self, z_mm: f64) -> f64 {
        self.clearance_mm(z_mm - self.stepover_mm).min(self.allowance_mm)
    }

    /// Distance ahead of the contact at which the ball begins to cut the allowance, mm.
    pub fn reach_mm(&self) -> f64 {
        libm::sqrt(self.allowance_mm * (2.0 * self.radius_mm() - self.allowance_mm))
    }

    /// Material of the blade around the pass, before it, as layers.
    pub fn layers(&self) -> Layers {
        let rise_mm = self.resolution.rise_mm;
        let (below, above) = (libm::ceil(self.reach_mm() / rise_mm), libm::ceil(self.stepover_mm / rise_mm));
        let layer = |n: usize| {
            let z_mm = (n as f64 + 0.5 - below) * rise_mm;
            Layer::outline(&self.side.outline_mm(self.before_mm(z_mm)), self.resolution.ray_mm)
        };
        let lowest_mm = self.side.height_mm() - below * rise_mm;
        Layers::new(lowest_mm, rise_mm, (0..(below + above) as usize).map(layer).collect())
    }

    /// Material that a rigid pair of tool and blade leaves above the nominal surface at the height of a layer's middle, mm. (2)
    pub fn after_mm(&self, layers: &Layers, layer: usize) -> f64 {
        let z_mm = layers.middle_mm(layer) - self.side.height_mm();
        self.before_mm(z_mm).min(self.clearance_mm(z_mm))
    }

    fn process(&self, modes: Vec<Mode>) -> Result<Process, MillError> {
        let layers_a_radius = self.radius_mm() / self.resolution.rise_mm;
        let off = libm::fabs(layers_a_radius - libm::round(layers_a_radius));
        if off > WHOLE_RATIO || self.mill.corner_mm != self.radius_mm() {
            return Err(MillError);
        }
        let pieces = Pieces::Slices { rise_mm: self.resolution.rise_mm };
        let cutter = Cutter::end_mill(&self.mill, pieces).map_err(|_| MillError)?;
        let engagement = EdgeEngagement::new(cutter, self.layers(), RAKE_MM).map_err(|_| MillError)?;
        let stepping = Stepping { rule: Rule::Exact, tolerance_mm: 1e-7, iterations_max: 12 };
        Ok(Process::new(engagement, self.cutting, Vibration::new(modes, stepping)))
    }

    /// Position of the tool, from the contact and the number of teeth passed.
    fn pose(&self, along_mm: f64, teeth: f64) -> ToolPose {
        let contact = self.side.contact(along_mm);
        ToolPose {
            axis_mm: contact.point_mm + contact.normal * self.radius_mm(),
            tip_mm: self.side.height_mm() - self.radius_mm(),
            turned_rad: TAU * teeth / self.mill.teeth as f64,
        }
    }

    /// Simulates the pass from one edge of the blade to the other. `modes` begins with the modes of the workpiece, whose mode shapes at any
    /// point `workpiece` gives; for a rigid workpiece it is `None`, and `modes` has only those of the tool.
    ///
    /// # Errors
    /// The mill is no ball end mill with edges, or its radius is not a whole number of layers.
    pub fn run<B: Modal>(
        &self,
        modes: Vec<Mode>,
        mut workpiece: Option<Workpiece<B>>,
    ) -> Result<PassResult, MillError> {
        let mut process = self.process(modes)?;
        let half_mm = self.side.length_mm() / 2.0;
        let from_mm = -half_mm - self.reach_mm() - AIR_MM;
        let count = libm::ceil((half_mm + AIR_MM - from_mm) / self.feed_mm_per_tooth) as usize;
        let steps = self.resolution.steps;
        let (mut teeth, mut open) = (Vec::with_capacity(count), 0);
        for tooth in 0..count {
            let (mut swing_mm, mut force_n, mut displacement_mm) = (0.0_f64, 0.0_f64, Vector3::zeros());
            let mut along_mm = from_mm;
            for step in 0..steps {
                let passed = tooth as f64 + (step + 1) as f64 / steps as f64;
                along_mm = from_mm + passed * self.feed_mm_per_tooth;
                if let Some(seen) = workpiece.as_mut().filter(|_| step % (steps / UPDATES_PER_TOOTH).max(1) == 0) {
                    process.vibration_mut().set_shapes(seen.shapes_on(self.side.place_mm(along_mm)));
                }
                let (dt_s, pose) = (1.0 / (self.tooth_hz * steps as f64), self.pose(along_mm, passed));
                let moment = match &mut workpiece {
                    Some(workpiece) => process.step_on(dt_s, &pose, workpiece),
                    None => process.step(dt_s, &pose),
                };
                displacement_mm = moment.displacement_mm;
                swing_mm = swing_mm.max(displacement_mm.xy().norm());
                force_n = force_n.max(moment.loads.bending_n());
                open += usize::from(!moment.has_converged);
            }
            teeth.push(Tooth { along_mm, displacement_mm, swing_mm, force_n });
        }
        Ok(PassResult { layers: process.engagement().layers().clone(), teeth, open })
    }
}

/// Component of a tooth's displacement, mm, along the blade's outward normal at the contact; positive away from the material.
pub fn normal_mm(side: &Side, tooth: &Tooth) -> f64 {
    let normal: Vector2<f64> = side.contact(tooth.along_mm).normal;
    tooth.displacement_mm.xy().dot(&normal)
}
