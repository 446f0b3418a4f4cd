//! One pass of a ball end mill along the side of a blade, its axis along the span.
//!
//! The ball's centre is at the height of the contact; the pass before was made by the same ball, one stepover higher. So at
//! a height z over the centre, with the ball's radius R and c(z) = R - sqrt(R^2 - z^2) for z < 0, else 0,
//!
//! ```text
//! stands out before the pass: least of the allowance and c(z - stepover)        (1)
//! after it, with a rigid pair: least of that and c(z)                           (2)
//! ```
//!
//! so the chip is a crescent of about the allowance times the stepover. Over these few millimetres the blade's section is taken as that
//! at the height of the contact; the modes are seen from the contact, which has its place on the blade anew some times a tooth.
//!
//! Source: own; the operation is that of Lorong et al., Simulation of a finishing operation, 2012, section 4.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};

use super::side::Side;
use crate::cutting::edge_engagement::EdgeEngagement;
use crate::cutting::edges::meridian::Pieces;
use crate::cutting::edges::{Cutter, EndMill};
use crate::cutting::layer::Layer;
use crate::cutting::layers::Layers;
use crate::cutting::material::Cutting;
use crate::cutting::pose::Stand;
use crate::dynamics::modal::Mode;
use crate::dynamics::transition::Rule;
use crate::dynamics::vibration::{Stepping, Vibration};
use crate::flexible::{Modal, Workpiece};
use crate::process::Process;

/// How often the workpiece is seen anew, in a tooth.
const LOOKS_A_TOOTH: usize = 4;
/// Air before and after the cut.
const AIR_MM: f64 = 0.5;
/// Rounding of a whole number of layers.
const WHOLE_RATIO: f64 = 1e-9;
/// Chips are not thicker.
const RAKE_MM: f64 = 1.0;

/// The pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Where.
    pub side: Side,
    /// A ball: the corner is half of the diameter.
    pub mill: EndMill,
    /// Square to the surface.
    pub allowance_mm: f64,
    /// Along the axis, to the pass before.
    pub stepover_mm: f64,
    /// Along the line of contacts.
    pub feed_mm_per_tooth: f64,
    /// Teeth in a second.
    pub tooth_hz: f64,
    /// What the material does to an edge.
    pub cutting: Cutting,
    /// How finely it is computed.
    pub fineness: Fineness,
}

/// How finely a pass is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Height of a layer; a whole number of them is the ball's radius.
    pub rise_mm: f64,
    /// Between rays of a layer.
    pub ray_mm: f64,
    /// Steps in a tooth.
    pub steps: usize,
}

/// What a pass did.
#[derive(Clone, Debug)]
pub struct Machined {
    /// What is left of the blade.
    pub layers: Layers,
    /// Once a tooth.
    pub teeth: Vec<Tooth>,
    /// Steps in which force and displacement did not come to agree.
    pub open: usize,
}

/// One moment a tooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tooth {
    /// Where the contact is, from the middle of the line.
    pub along_mm: f64,
    /// Of the tool against the workpiece.
    pub displacement_mm: Vector3<f64>,
    /// The largest square to the axis since the tooth before.
    pub swing_mm: f64,
    /// The largest force square to the axis since the tooth before.
    pub force_n: f64,
}

/// The mill has no such edges, or not in such layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MillError;

impl std::fmt::Display for MillError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a pass needs a ball end mill whose radius is a whole number of layers")
    }
}

impl std::error::Error for MillError {}

impl Pass {
    fn radius_mm(&self) -> f64 {
        self.mill.diameter_mm / 2.0
    }

    /// c(z).
    fn clearance_mm(&self, z_mm: f64) -> f64 {
        let below_mm = z_mm.min(0.0);
        let square = self.radius_mm() * self.radius_mm() - below_mm * below_mm;
        self.radius_mm() - libm::sqrt(square.max(0.0))
    }

    /// (1)
    fn before_mm(&self, z_mm: f64) -> f64 {
        self.clearance_mm(z_mm - self.stepover_mm).min(self.allowance_mm)
    }

    /// How far ahead of the contact the deepest chip begins.
    pub fn reach_mm(&self) -> f64 {
        libm::sqrt(self.allowance_mm * (2.0 * self.radius_mm() - self.allowance_mm))
    }

    /// The layers that the pass cuts.
    pub fn layers(&self) -> Layers {
        let rise_mm = self.fineness.rise_mm;
        let (below, above) = (libm::ceil(self.reach_mm() / rise_mm), libm::ceil(self.stepover_mm / rise_mm));
        let layer = |n: usize| {
            let z_mm = (n as f64 + 0.5 - below) * rise_mm;
            Layer::outline(&self.side.outline_mm(self.before_mm(z_mm)), self.fineness.ray_mm)
        };
        let lowest_mm = self.side.height_mm() - below * rise_mm;
        Layers::new(lowest_mm, rise_mm, (0..(below + above) as usize).map(layer).collect())
    }

    /// What stands out at the middle of a layer after the pass of a rigid pair. (2)
    pub fn after_mm(&self, layers: &Layers, layer: usize) -> f64 {
        let z_mm = layers.middle_mm(layer) - self.side.height_mm();
        self.before_mm(z_mm).min(self.clearance_mm(z_mm))
    }

    fn process(&self, modes: Vec<Mode>) -> Result<Process, MillError> {
        let layers_a_radius = self.radius_mm() / self.fineness.rise_mm;
        let off = libm::fabs(layers_a_radius - libm::round(layers_a_radius));
        if off > WHOLE_RATIO || self.mill.corner_mm != self.radius_mm() {
            return Err(MillError);
        }
        let pieces = Pieces::Slices { rise_mm: self.fineness.rise_mm };
        let cutter = Cutter::end_mill(&self.mill, pieces).map_err(|_| MillError)?;
        let engagement = EdgeEngagement::new(cutter, self.layers(), RAKE_MM).map_err(|_| MillError)?;
        let stepping = Stepping { rule: Rule::Exact, tolerance_mm: 1e-7, passes_max: 12 };
        Ok(Process::new(engagement, self.cutting, Vibration::new(modes, stepping)))
    }

    /// Where the tool is, from the contact and how many teeth have passed.
    fn stand(&self, along_mm: f64, teeth: f64) -> Stand {
        let contact = self.side.contact(along_mm);
        Stand {
            axis_mm: contact.point_mm + contact.normal * self.radius_mm(),
            tip_mm: self.side.height_mm() - self.radius_mm(),
            turned_rad: TAU * teeth / self.mill.teeth as f64,
        }
    }

    /// From one edge of the blade to the other. Modes of the workpiece, as seen from anywhere, stand first; a rigid one has none, and is not seen.
    ///
    /// # Errors
    /// There is no such tool.
    pub fn run<B: Modal>(&self, modes: Vec<Mode>, mut workpiece: Option<Workpiece<B>>) -> Result<Machined, MillError> {
        let mut process = self.process(modes)?;
        let half_mm = self.side.length_mm() / 2.0;
        let from_mm = -half_mm - self.reach_mm() - AIR_MM;
        let count = libm::ceil((half_mm + AIR_MM - from_mm) / self.feed_mm_per_tooth) as usize;
        let steps = self.fineness.steps;
        let (mut teeth, mut open) = (Vec::with_capacity(count), 0);
        for tooth in 0..count {
            let (mut swing_mm, mut force_n, mut displacement_mm) = (0.0_f64, 0.0_f64, Vector3::zeros());
            let mut along_mm = from_mm;
            for step in 0..steps {
                let passed = tooth as f64 + (step + 1) as f64 / steps as f64;
                along_mm = from_mm + passed * self.feed_mm_per_tooth;
                if let Some(seen) = workpiece.as_mut().filter(|_| step % (steps / LOOKS_A_TOOTH).max(1) == 0) {
                    process.vibration_mut().see_from(seen.shapes_on(self.side.place_mm(along_mm)));
                }
                let (dt_s, stand) = (1.0 / (self.tooth_hz * steps as f64), self.stand(along_mm, passed));
                let moment = match &mut workpiece {
                    Some(workpiece) => process.step_on(dt_s, &stand, workpiece),
                    None => process.step(dt_s, &stand),
                };
                displacement_mm = moment.displacement_mm;
                swing_mm = swing_mm.max(displacement_mm.xy().norm());
                force_n = force_n.max(moment.loads.bending_n());
                open += usize::from(!moment.agrees);
            }
            teeth.push(Tooth { along_mm, displacement_mm, swing_mm, force_n });
        }
        Ok(Machined { layers: process.engagement().layers().clone(), teeth, open })
    }
}

/// The displacement alone of a pass across the blade's normal at its contact; positive away from the material.
pub fn normal_mm(side: &Side, tooth: &Tooth) -> f64 {
    let normal: Vector2<f64> = side.contact(tooth.along_mm).normal;
    tooth.displacement_mm.xy().dot(&normal)
}
