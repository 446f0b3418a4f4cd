//! Stability of a cut, from the tool's position once for each tooth at the same angle.
//!
//! In a stable cut every tooth finds the tool at the position of the tooth before. With samples x_1 .. x_n, one a
//! tooth,
//!
//! ```text
//! M_k = mean |x_i - x_(i-k)|        (1)
//! M_1 = 0              each tooth as the one before: stable
//! M_2 = 0              every other tooth: period doubling (flip)
//! M_z = 0              each tooth as a turn before: stable, teeth or runout uneven
//! none of them         chatter: a frequency that is no multiple of the teeth's
//! ```
//!
//! where 0 is a tolerance that the caller sets. Samples once a *turn* cannot show period doubling of an even number of
//! teeth. With two teeth doubling and runout look the same and are reported as doubling.
//!
//! Samples at the tooth rate r show a frequency f at its distance from the nearest multiple of r.
//!
//! Source: (1) with k of one turn is the stability metric of T. Schmitz and co-workers; once a tooth and the cases are ours.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

/// Largest number of samples, the last ones, for the frequency analysis.
const SAMPLES_MAX: usize = 512;

/// Number of tried frequencies for each one that the samples can resolve.
const FINER: usize = 4;

/// Verdict on the stability of a cut, from the tool's position sampled once for each tooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Stable: the samples repeat with every tooth.
    Stable,
    /// Stable with uneven teeth or runout: the samples repeat with every turn, but not with every tooth.
    Uneven,
    /// Period doubling (flip): the samples repeat with every second tooth.
    PeriodDoubling,
    /// Chatter: the samples do not repeat.
    Chatter {
        /// Strongest frequency as it appears in the samples: its distance from the nearest multiple of the tooth frequency.
        alias_hz: f64,
    },
}

/// Sampling of the tool's position, and the change from which on a cut counts as unstable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Teeth per turn.
    pub teeth: usize,
    /// Tooth passing frequency, which is also the rate of the samples.
    pub tooth_hz: f64,
    /// Largest mean change M_k of the position that still counts as no change.
    pub floor_mm: f64,
}

impl Sampling {
    /// Verdict for the samples of a cut, one for each tooth, without the beginning of the cut. Too few samples count as stable.
    pub fn evaluate(&self, samples_mm: &[Vector3<f64>]) -> Verdict {
        let repeats = |lag| metric_mm(samples_mm, lag) <= self.floor_mm;
        if repeats(1) {
            Verdict::Stable
        } else if repeats(2) {
            Verdict::PeriodDoubling
        } else if repeats(self.teeth) {
            Verdict::Uneven
        } else {
            Verdict::Chatter { alias_hz: strongest_ratio(samples_mm) * self.tooth_hz }
        }
    }

    /// The true chatter frequency: of all frequencies that appear as `alias_hz` in the samples, the one nearest to `natural_hz`.
    pub fn chatter_hz(&self, alias_hz: f64, natural_hz: f64) -> f64 {
        let multiple = libm::round(natural_hz / self.tooth_hz);
        let around = [multiple - 1.0, multiple, multiple + 1.0].map(|k| k * self.tooth_hz);
        let candidates = around.into_iter().flat_map(|hz| [hz - alias_hz, hz + alias_hz]);
        let distance = |hz: &f64| libm::fabs(hz - natural_hz);
        candidates.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(natural_hz)
    }
}

/// Mean change M_k, mm, of the position over `lag` = k samples; 0 if there are too few samples. (1)
pub fn metric_mm(samples_mm: &[Vector3<f64>], lag: usize) -> f64 {
    let later = samples_mm.get(lag..).unwrap_or(&[]);
    let sum_mm: f64 = later.iter().zip(samples_mm).map(|(after, before)| (after - before).norm()).sum();
    sum_mm / later.len().max(1) as f64
}

/// Standard deviation of the positions from their mean, mm, all directions together.
pub fn deviation_mm(samples_mm: &[Vector3<f64>]) -> f64 {
    let count = samples_mm.len().max(1) as f64;
    let mean_mm = samples_mm.iter().sum::<Vector3<f64>>() / count;
    libm::sqrt(samples_mm.iter().map(|sample| (sample - mean_mm).norm_squared()).sum::<f64>() / count)
}

/// Strongest frequency, relative to the sample rate: up to 1/2.
fn strongest_ratio(samples_mm: &[Vector3<f64>]) -> f64 {
    let last = &samples_mm[samples_mm.len().saturating_sub(SAMPLES_MAX)..];
    let (steps, count) = (FINER * last.len() / 2, last.len() as f64);
    let mean_mm = last.iter().sum::<Vector3<f64>>() / count;
    // A Hann window suppresses leakage from distant frequencies.
    let window = |at: usize| libm::sin(PI * (at as f64 + 0.5) / count) * libm::sin(PI * (at as f64 + 0.5) / count);
    let flat: Vec<Vector3<f64>> = last.iter().enumerate().map(|(at, sample)| (sample - mean_mm) * window(at)).collect();
    let ratio = |step: usize| step as f64 / (FINER * last.len()) as f64;
    let powers = (1..=steps).map(|step| power_mm2(&flat, ratio(step)));
    let strongest = powers.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    strongest.map_or(0.0, |(at, _)| ratio(at + 1))
}

fn power_mm2(samples_mm: &[Vector3<f64>], ratio: f64) -> f64 {
    let mut sums = [Vector3::zeros(); 2];
    for (at, sample) in samples_mm.iter().enumerate() {
        let (sin, cos) = libm::sincos(TAU * ratio * at as f64);
        sums = [sums[0] + sample * cos, sums[1] + sample * sin];
    }
    sums[0].norm_squared() + sums[1].norm_squared()
}
