//! Ten plans against ten million pairs of a pose of the ring and a point of a blade: no pair is nearer than the proof says. Blades, poses and the
//! ring's shape are written here anew, from their formulas.

use arcfeed_nc::modal::Turn;
use arcfeed_plan::cup_mill::plan::AxisChoice;
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::path::Step;
use arcfeed_plan::vector::Point;
use nalgebra::Rotation3;

use crate::parts::proven_mm;
use crate::twisted::{BLADES, ROTORS, Twisted, ring, roughing};

/// Pairs of one plan.
const PAIRS: u32 = 1_000_000;
/// Pairs from which the nearest place is sought in ever smaller steps, and these steps.
const STARTS: usize = 20;
const STEPS: u32 = 2000;

/// Distance of a point from a ring with rounded lower corners, by its distance from the axis and its height above the bottom.
fn ring_mm(tool: &CupMill, radius_mm: f64, height_mm: f64) -> f64 {
    let corner_mm = tool.insert_radius_mm;
    let middle_mm = (tool.outer_radius_mm + tool.inner_radius_mm) / 2.0;
    let beside_mm = (radius_mm - middle_mm).abs() - (tool.outer_radius_mm - tool.inner_radius_mm) / 2.0;
    if height_mm >= corner_mm {
        return beside_mm;
    }
    let (across_mm, below_mm) = (beside_mm + corner_mm, corner_mm - height_mm);
    if across_mm > 0.0 { libm::hypot(across_mm, below_mm) - corner_mm } else { -height_mm }
}

/// Place of the tool on a step.
fn place(step: &Step, share: f64) -> [f64; 3] {
    let Some((centre, sense)) = step.about else {
        return [0, 1, 2].map(|k: usize| step.from[k] + (step.to[k] - step.from[k]) * share);
    };
    let angle = |at: [f64; 3]| libm::atan2(at[1] - centre.y, at[0] - centre.x);
    let (from, to) = (angle(step.from), angle(step.to));
    let sweep = if sense == Turn::Ccw { to - from } else { from - to };
    // The arcs of a path are shorter than half a turn; one without length may end just before its start.
    let sweep = (sweep + 3.0).rem_euclid(core::f64::consts::TAU) - 3.0;
    let radius_mm = libm::hypot(step.from[0] - centre.x, step.from[1] - centre.y);
    let at = if sense == Turn::Ccw { from + sweep * share } else { from - sweep * share };
    let (sin, cos) = libm::sincos(at);
    [centre.x + radius_mm * cos, centre.y + radius_mm * sin, step.from[2]]
}

/// Step and its share, height and place on a side.
type Pair = [f64; 4];

/// Sampler of one plan.
pub struct Sampler<'s> {
    /// All blades of the rotor, each with its angle about the rotor's axis.
    pub blades: Vec<(Twisted, f64)>,
    pub tool: &'s CupMill,
    pub steps: Vec<Step>,
    pub turn: Rotation3<f64>,
}

impl Sampler<'_> {
    fn distance_mm(&self, step: usize, blade: u32, outward: f64, [_, share, height, along]: Pair) -> f64 {
        let (rotor, angle) = &self.blades[blade as usize];
        let point: Point = self.turn * rotor.point(height, along, outward, *angle);
        let [x, y, z] = place(&self.steps[step], share);
        ring_mm(self.tool, libm::hypot(point.x - x, point.y - y), point.z - z)
    }

    /// Least distance of a random pair of a pose and a point, from which nearer ones were sought.
    pub fn least_mm(&self) -> f64 {
        let mut random = fastrand::Rng::with_seed(25);
        let mut nearest: Vec<(f64, usize, u32, f64, Pair)> = Vec::new();
        for _ in 0..PAIRS {
            let (step, blade) = (random.usize(0..self.steps.len()), random.u32(0..self.blades.len() as u32));
            let outward = if random.bool() { 1.0 } else { -1.0 };
            let pair = [0.0, random.f64(), random.f64(), random.f64()];
            let off_mm = self.distance_mm(step, blade, outward, pair);
            if nearest.len() < STARTS || off_mm < nearest[STARTS - 1].0 {
                let at = nearest.partition_point(|one| one.0 < off_mm);
                nearest.insert(at, (off_mm, step, blade, outward, pair));
                nearest.truncate(STARTS);
            }
        }
        let climbed = nearest.into_iter().map(|(mut best_mm, step, blade, outward, mut at)| {
            let mut scale = 0.1;
            for _ in 0..STEPS {
                let near = at.map(|value| (value + scale * (2.0 * random.f64() - 1.0)).clamp(0.0, 1.0));
                let off_mm = self.distance_mm(step, blade, outward, near);
                if off_mm < best_mm { (best_mm, at) = (off_mm, near) } else { scale = (scale * 0.99).max(1e-5) }
            }
            best_mm
        });
        climbed.fold(f64::INFINITY, f64::min)
    }
}

#[test]
fn no_pair_of_ten_million_is_nearer_than_the_proof_says() {
    let widths = [10.0, 13.0, 15.875];
    let right = ROTORS.into_iter().flat_map(|rotor| widths.map(|width_mm| (rotor, width_mm)));
    let plans: Vec<(Twisted, f64)> = right.chain([(Twisted { hand: -1.0, ..ROTORS[0] }, 12.0)]).collect();
    assert_eq!(plans.len(), 10);
    for (rotor, width_mm) in plans {
        let middle_mm = (ring().outer_radius_mm + ring().inner_radius_mm) / 2.0;
        let (outer_radius_mm, inner_radius_mm) = (middle_mm + width_mm / 2.0, middle_mm - width_mm / 2.0);
        let tool = CupMill { outer_radius_mm, inner_radius_mm, ..ring() };
        let ((blisk, slot), roughing) = (rotor.slot(0.0), roughing());
        let plan = Problem::new(&blisk, &slot, &tool, &roughing).unwrap().along(AxisChoice::Blade).unwrap().plan;
        let [certified_mm, _] = proven_mm(&blisk, &plan, &tool);
        let pitch_rad = core::f64::consts::TAU / f64::from(BLADES);
        let blades = (0..BLADES).map(|blade| (rotor, pitch_rad * f64::from(blade))).collect();
        let sampler = Sampler { blades, tool: &tool, steps: plan.path.steps(), turn: plan.turn };
        let least_mm = sampler.least_mm();
        println!(
            "{} hand {}, {width_mm} mm wide: certified {certified_mm:.4}, sampled {least_mm:.4} mm",
            rotor.name, rotor.hand
        );
        assert!(least_mm >= certified_mm, "{} {width_mm}: {least_mm} < {certified_mm}", rotor.name);
        // The samples come as near as the proof's own bounds are apart, so they could have found a wrong one.
        assert!(least_mm < certified_mm + 0.1, "{} {width_mm}: {least_mm} {certified_mm}", rotor.name);
    }
}
