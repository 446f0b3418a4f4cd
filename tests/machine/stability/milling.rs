//! A straight cut by a mill so large that its path is a circle in the stock, as the theory has it: feed per tooth over radius
//! 0.0004. At 0.02 the boundary lies a tenth higher, see docs/chips.md.

use std::f64::consts::TAU;

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
use nalgebra::{Vector2, Vector3};

const RADIUS_MM: f64 = 50.0;
pub const FEED_MM_PER_TOOTH: f64 = 0.02;
/// Between rays: a wave of the fastest vibration on the slowest cut has 36 of them, which is right to 0.4 % of its height.
const STEP_MM: f64 = 0.2;
/// Steps per period of the fastest mode, and at least per period of a tooth.
const STEPS_A_PERIOD: f64 = 40.0;
const STEPS_A_TOOTH: usize = 200;
/// Differences that change by less than this from tooth to tooth neither grow nor die out.
const STANDING: f64 = 1.5e-3;
/// Amplitude below which only dexels and rounding matter.
const DIED_OUT_MM: f64 = 1e-4 * FEED_MM_PER_TOOTH;

/// Settings of the evaluation of a cut.
#[derive(Clone, Debug)]
pub struct Seen {
    /// For so long, and for so many teeth at least, so that what the start leaves has died out.
    pub time_s: f64,
    pub teeth: usize,
    /// Standing differences are chatter if they are larger than this, times the feed: rays and steps alone make some.
    pub noticed: f64,
}

/// At a tenth of the diameter, where edges enter in a thick chip and leave soon, rays alone make 0.035.
pub const BRIEFLY: Seen = Seen { time_s: 0.5, teeth: 150, noticed: 0.05 };
/// For chatter that swells and ebbs, stays small, or comes up late from below what the start leaves. Rays make 0.002 at half the
/// diameter.
pub const LONG: Seen = Seen { time_s: 1.5, teeth: 400, noticed: 0.02 };

/// Tool and cut.
#[derive(Clone, Debug)]
pub struct Milling {
    pub modes: Vec<Mode>,
    pub teeth: usize,
    /// Tangential and normal.
    pub specific_mpa: [f64; 2],
    /// Radial depth over the tool's diameter.
    pub immersion: f64,
    pub is_up: bool,
    pub seen: Seen,
}

impl Milling {
    /// Whether a cut of this depth chatters: whether the tool's path continues to differ from tooth to tooth.
    pub fn chatters(&self, spindle_rev_per_min: f64, depth_mm: f64) -> bool {
        let differences_mm = self.differences_mm(spindle_rev_per_min, depth_mm);
        let late = &differences_mm[differences_mm.len() / 2..];
        let growth = libm::exp(slope(late.iter().map(|mm| libm::log(*mm)))) - 1.0;
        let mean_mm = late.iter().sum::<f64>() / late.len() as f64;
        let is_standing = growth.abs() <= STANDING;
        mean_mm > DIED_OUT_MM
            && if is_standing { mean_mm > self.seen.noticed * FEED_MM_PER_TOOTH } else { growth > 0.0 }
    }

    /// Root mean square of what the tool's way over one tooth differs by from that over the tooth before.
    fn differences_mm(&self, spindle_rev_per_min: f64, depth_mm: f64) -> Vec<f64> {
        let difference = |pair: &[Vec<Vector3<f64>>]| {
            let squares = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).norm_squared());
            libm::sqrt(squares.sum::<f64>() / pair[0].len() as f64)
        };
        self.ways_mm(spindle_rev_per_min, depth_mm).windows(2).map(difference).collect()
    }

    /// Displacement of the tool in every step of every tooth; the first tooth begins along the feed.
    pub fn ways_mm(&self, spindle_rev_per_min: f64, depth_mm: f64) -> Vec<Vec<Vector3<f64>>> {
        let tooth_s = 60.0 / spindle_rev_per_min / self.teeth as f64;
        let periods = self.modes.iter().map(|mode| mode.frequency_hz * tooth_s).fold(0.0, f64::max);
        let steps = ((periods * STEPS_A_PERIOD) as usize).max(STEPS_A_TOOTH);
        let teeth_passed = ((self.seen.time_s / tooth_s) as usize).max(self.seen.teeth);
        let mut process = self.process(depth_mm, FEED_MM_PER_TOOTH * teeth_passed as f64);
        let mut ways_mm: Vec<Vector3<f64>> = Vec::new();
        let mut open = 0;
        for step in 1..=teeth_passed * steps {
            let teeth = step as f64 / steps as f64;
            let stand = ToolPose {
                axis_mm: Vector2::new(FEED_MM_PER_TOOTH * teeth, 0.0),
                tip_mm: 0.0,
                turned_rad: TAU * teeth / self.teeth as f64,
            };
            let moment = process.step(tooth_s / steps as f64, &stand);
            open += usize::from(!moment.has_converged);
            ways_mm.push(moment.displacement_mm);
        }
        // At the border of the material the force may have two solutions, with the edge in or out, or none.
        assert!(open * 1000 < ways_mm.len(), "{open} of {} steps disagree", ways_mm.len());
        ways_mm.chunks(steps).map(<[_]>::to_vec).collect()
    }

    /// The tool half in the material, everything behind its axis gone.
    fn process(&self, depth_mm: f64, way_mm: f64) -> Process {
        let (width_mm, margin_mm) = (2.0 * RADIUS_MM * self.immersion, 1.0);
        // The free side of the cut lies on a border of cells.
        let cells = ((width_mm + margin_mm) / STEP_MM).ceil();
        let lowest_mm = if self.is_up { RADIUS_MM - width_mm } else { width_mm - RADIUS_MM - cells * STEP_MM };
        let length_mm = way_mm + 2.0 * (RADIUS_MM + margin_mm);
        let from_mm = -RADIUS_MM - margin_mm;
        let mut layer = Layer::rectangle([from_mm, lowest_mm], [length_mm, cells * STEP_MM], STEP_MM);
        layer.clear_ring(Vector2::zeros(), 0.0, RADIUS_MM);
        let far_mm = 2.0 * RADIUS_MM;
        layer.clear(&[[-far_mm, -far_mm], [-far_mm, far_mm], [0.0, far_mm], [0.0, -far_mm]].map(Vector2::from));
        let mill = EndMill {
            diameter_mm: 2.0 * RADIUS_MM,
            corner_mm: 0.0,
            teeth: self.teeth,
            helix_rad: 0.0,
            height_mm: depth_mm,
        };
        let cutter = Cutter::end_mill(&mill, Pieces::Slices { rise_mm: depth_mm }).expect("a mill");
        let [tangential, normal] = self.specific_mpa;
        let engagement =
            EdgeEngagement::new(cutter, Layers::alike(&layer, 0.0, depth_mm, 1), 0.3).expect("a tool in its layer");
        let stepping = Stepping { rule: Rule::Exact, tolerance_mm: 1e-10, iterations_max: 20 };
        let cutting = Cutting::linear([tangential, normal, 0.0], [0.0; 3]);
        Process::new(engagement, cutting, Vibration::new(self.modes.clone(), stepping))
    }
}

/// Slope of the straight line nearest to equidistant values.
fn slope(values: impl ExactSizeIterator<Item = f64> + Clone) -> f64 {
    let count = values.len() as f64;
    let (middle, mean) = ((count - 1.0) / 2.0, values.clone().sum::<f64>() / count);
    let off = |at: usize| at as f64 - middle;
    let products = values.enumerate().map(|(at, value)| (off(at) * (value - mean), off(at) * off(at)));
    let (above, below) = products.fold((0.0, 0.0), |(a, b), (x, y)| (a + x, b + y));
    above / below
}
