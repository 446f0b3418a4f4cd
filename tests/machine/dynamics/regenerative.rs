//! Milling with straight teeth whose chips depend on what the teeth before left, as the reference runs have it:
//!
//! ```text
//! v_j = x sin(a_j) + y cos(a_j),   h = max(0, v(t) - max over k = 1..10 of [v(t - k tau) - k fz sin(a_j)])   (1)
//! Fx = -w (Kt cos a + Kn sin a) h,   Fy = w (Kt sin a - Kn cos a) h                                           (2)
//! ```
//!
//! a from y, clockwise, x the feed. An engagement that begins or ends within a step counts by the part of that step.

use std::f64::consts::TAU;

use arcfeed_modal::dynamics::modal::Mode;
use arcfeed_modal::dynamics::vibration::{Stepping, Vibration};
use nalgebra::Vector3;

/// Teeth that a tooth remembers.
const MEMORY: usize = 10;

/// Turns that are looked at, the last ones.
pub const TURNS_SEEN: usize = 20;

#[derive(Clone, Debug)]
pub struct Milling {
    pub modes: Vec<Mode>,
    pub teeth: usize,
    /// Kt, Kn.
    pub specific_mpa: [f64; 2],
    pub engaged_rad: [f64; 2],
    pub spindle_rev_per_min: f64,
    pub depth_mm: f64,
    pub feed_mm_per_tooth: f64,
}

/// The last turns of a run.
pub struct Run {
    pub displacements_mm: Vec<Vector3<f64>>,
    pub forces_n: Vec<Vector3<f64>>,
    /// Once a tooth.
    pub samples_mm: Vec<Vector3<f64>>,
    pub iterations: usize,
    /// Steps in which force and displacement did not come to agree.
    pub open: usize,
}

/// One tooth at one step of its way.
struct Place {
    sin: f64,
    cos: f64,
    engaged: f64,
}

impl Milling {
    pub fn tooth_s(&self) -> f64 {
        60.0 / self.spindle_rev_per_min / self.teeth as f64
    }

    pub fn run(&self, turns: usize, steps_per_tooth: usize, stepping: Stepping) -> Run {
        let mut vibration = Vibration::new(self.modes.clone(), stepping);
        let places = self.places(steps_per_tooth);
        let (all, seen) = (turns * self.teeth * steps_per_tooth, TURNS_SEEN * self.teeth * steps_per_tooth);
        let mut path = vec![Vector3::zeros(); MEMORY * steps_per_tooth + 1];
        let mut run =
            Run { displacements_mm: path.clone(), forces_n: vec![], samples_mm: vec![], iterations: 0, open: 0 };
        run.displacements_mm.clear();
        for at in 1..=all {
            let here = &places[at % places.len()];
            let before = |k: usize| path[path.len() - k * steps_per_tooth];
            let step = vibration.step(self.tooth_s() / steps_per_tooth as f64, |now| {
                here.iter().map(|place| self.force_n(place, now, before)).sum()
            });
            path.push(step.displacement_mm);
            run.iterations += step.iterations;
            run.open += usize::from(!step.has_converged);
            if at > all - seen {
                run.displacements_mm.push(step.displacement_mm);
                run.forces_n.push(step.force_n);
            }
            if at >= all - seen && at % steps_per_tooth == 0 {
                run.samples_mm.push(step.displacement_mm);
            }
        }
        run
    }

    /// For each step of a turn, all teeth. The angle of tooth 0 is 0 at the begin.
    fn places(&self, steps_per_tooth: usize) -> Vec<Vec<Place>> {
        let steps = self.teeth * steps_per_tooth;
        let width = TAU / steps as f64;
        let place = |at: usize| {
            let angle = TAU * at as f64 / steps as f64;
            let [begin, end] = self.engaged_rad;
            let part = |shift: f64| {
                let angle = angle + shift;
                (((angle + width / 2.0).min(end) - (angle - width / 2.0).max(begin)) / width).clamp(0.0, 1.0)
            };
            let (sin, cos) = libm::sincos(angle);
            Place { sin, cos, engaged: part(0.0) + part(-TAU) }
        };
        (0..steps)
            .map(|at| (0..self.teeth).map(|tooth| place((at + tooth * steps_per_tooth) % steps)).collect())
            .collect()
    }

    fn force_n(&self, place: &Place, now: &Vector3<f64>, before: impl Fn(usize) -> Vector3<f64>) -> Vector3<f64> {
        if place.engaged == 0.0 {
            return Vector3::zeros();
        }
        let Place { sin, cos, .. } = *place;
        let outwards = |at: &Vector3<f64>| at.x * sin + at.y * cos;
        let left = |k: usize| outwards(&before(k)) - k as f64 * self.feed_mm_per_tooth * sin;
        let surface = (1..=MEMORY).map(left).fold(f64::NEG_INFINITY, f64::max);
        let section_mm2 = (outwards(now) - surface).max(0.0) * self.depth_mm * place.engaged; // (1)
        let [t, n] = self.specific_mpa.map(|k| k * section_mm2);
        Vector3::new(-(t * cos + n * sin), t * sin - n * cos, 0.0) // (2)
    }
}

/// From least to greatest.
pub fn span(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    high - low
}
