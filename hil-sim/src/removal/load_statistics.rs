//! Statistics of the loads of a cut: peaks, means, variation within a turn, chip thickness.
//!
//! ```text
//! mean = integral of a load over the time in cut / that time          (1)
//! variation = mean over whole turns of (largest - least) / mean       (2) of the bending force in a turn
//! ```
//!
//! The time in cut is the time during which any edge has a chip of a thousandth of a millimetre or more. A turn counts
//! in (2) if it belongs completely to one block and the side of the tool cuts in it: the bending force of a plunge is
//! rounding. The *pass* of a tooth goes from where it meets material to where it leaves it, and counts with its
//! thickest chip.
//!
//! Source: own definitions.

use arcfeed_model::tool::Edge;
use arcfeed_units::Micros;

use super::trail::SECTION_TIME_MAX;

/// Chip thickness below which an edge counts as not cutting.
pub const CHIP_MIN_MM: f64 = 1e-3;

/// Cutting loads in one step of the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadSample {
    /// Duration of the step.
    pub dt_s: f64,
    /// Force across the tool's axis.
    pub bending_n: f64,
    /// Force along the axis, positive towards the tool's holder.
    pub thrust_n: f64,
    /// Torque against the spindle.
    pub torque_n_m: f64,
    /// Power of the spindle.
    pub power_w: f64,
    /// Mean thickness of the chip on the tool's end.
    pub end_mm: f64,
}

/// Statistics of one load (a force, torque or power): largest absolute value and integral over time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    max: f64,
    /// Integral over time, s.
    integral: f64,
}

/// Statistics of the thickest chips of several tooth passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Passes {
    /// Number of passes.
    pub count: u64,
    /// Thickest chip of all these passes.
    pub max_mm: f64,
    sum_mm: f64,
}

/// Load statistics of one block or of several.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadStatistics {
    /// Time in cut: during which any edge had a chip.
    pub time_s: f64,
    /// Force across the tool's axis, N.
    pub bending: Level,
    /// Force along the tool's axis, positive towards its holder, N.
    pub thrust: Level,
    /// Torque, N m.
    pub torque: Level,
    /// Power, W.
    pub power: Level,
    /// Passes of teeth on the outer circle and of those on the inner one.
    pub passes: [Passes; 2],
    /// Largest mean thickness of the chip of an edge on the tool's end.
    pub end_max_mm: f64,
    turns: u64,
    variation_sum: f64,
}

/// Load statistics of the current turn of the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnStatistics {
    steps: usize,
    least_n: f64,
    most_n: f64,
    sum_n: f64,
    /// Whether the side of the tool had a chip.
    is_aside: bool,
}

impl Level {
    /// Largest absolute value, in the unit of the load.
    pub fn max(&self) -> f64 {
        self.max
    }

    fn add(&mut self, value: f64, dt_s: f64) {
        self.max = self.max.max(libm::fabs(value));
        self.integral += value * dt_s;
    }

    fn merge(&mut self, other: &Level) {
        self.max = self.max.max(other.max);
        self.integral += other.integral;
    }
}

impl Passes {
    /// Mean of the thickest chips of all passes, mm; `None` without passes.
    pub fn mean_mm(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum_mm / self.count as f64)
    }

    fn merge(&mut self, other: &Passes) {
        self.count += other.count;
        self.max_mm = self.max_mm.max(other.max_mm);
        self.sum_mm += other.sum_mm;
    }
}

/// Load statistics of a time window of a quarter of a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadWindow {
    /// Beginning of the window.
    pub from: Micros,
    /// End of the window.
    pub to: Micros,
    /// Statistics of the loads.
    pub statistics: LoadStatistics,
}

impl LoadWindow {
    /// Empty window that contains this time. Windows begin at whole multiples of their length.
    pub fn around(at: Micros) -> Self {
        let from = Micros(at.0 / SECTION_TIME_MAX.0 * SECTION_TIME_MAX.0);
        LoadWindow { from, to: from.after(SECTION_TIME_MAX), statistics: LoadStatistics::default() }
    }
}

impl LoadStatistics {
    /// Adds a step of the tool in which it cuts.
    pub fn add(&mut self, sample: &LoadSample) {
        self.time_s += sample.dt_s;
        self.bending.add(sample.bending_n, sample.dt_s);
        self.thrust.add(sample.thrust_n, sample.dt_s);
        self.end_max_mm = self.end_max_mm.max(sample.end_mm);
        self.torque.add(sample.torque_n_m, sample.dt_s);
        self.power.add(sample.power_w, sample.dt_s);
    }

    /// Adds the pass of a tooth that has left the material, with its thickest chip.
    pub fn add_pass(&mut self, side: Edge, thickest_mm: f64) {
        let passes = &mut self.passes[usize::from(side == Edge::Inner)];
        passes.merge(&Passes { count: 1, max_mm: thickest_mm, sum_mm: thickest_mm });
    }

    /// Adds a finished turn; `steps` is the number of steps in a whole turn.
    pub fn add_turn(&mut self, turn: &TurnStatistics, steps: usize) {
        let mean_n = turn.sum_n / turn.steps as f64;
        if turn.steps == steps && turn.is_aside && mean_n > 0.0 {
            self.turns += 1;
            self.variation_sum += (turn.most_n - turn.least_n) / mean_n;
        }
    }

    /// Adds the statistics of another cut.
    pub fn merge(&mut self, other: &LoadStatistics) {
        self.time_s += other.time_s;
        self.bending.merge(&other.bending);
        self.thrust.merge(&other.thrust);
        self.end_max_mm = self.end_max_mm.max(other.end_max_mm);
        self.torque.merge(&other.torque);
        self.power.merge(&other.power);
        self.passes.iter_mut().zip(&other.passes).for_each(|(passes, others)| passes.merge(others));
        self.turns += other.turns;
        self.variation_sum += other.variation_sum;
    }

    /// Mean of one of these loads over the time in cut; 0 without a cut. (1)
    pub fn mean(&self, level: &Level) -> f64 {
        if self.time_s > 0.0 { level.integral / self.time_s } else { 0.0 }
    }

    /// Variation of the bending force within a turn, relative to its mean; `None` without a whole turn. (2)
    pub fn variation_ratio(&self) -> Option<f64> {
        (self.turns > 0).then(|| self.variation_sum / self.turns as f64)
    }
}

impl TurnStatistics {
    /// Statistics before the first step.
    pub fn new() -> Self {
        TurnStatistics { steps: 0, least_n: f64::INFINITY, most_n: 0.0, sum_n: 0.0, is_aside: false }
    }

    /// Adds a step, with the bending force and the thickest chip on the tool's side.
    pub fn add(&mut self, bending_n: f64, side_mm: f64) {
        self.is_aside |= side_mm >= CHIP_MIN_MM;
        self.steps += 1;
        self.least_n = self.least_n.min(bending_n);
        self.most_n = self.most_n.max(bending_n);
        self.sum_n += bending_n;
    }
}

impl Default for TurnStatistics {
    fn default() -> Self {
        TurnStatistics::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_over_time_and_variation_over_whole_turns() {
        let mut statistics = LoadStatistics::default();
        let mut turn = TurnStatistics::new();
        for (dt_s, bending_n) in [(1.0, 10.0), (3.0, 30.0)] {
            statistics.add(&LoadSample {
                dt_s,
                bending_n,
                thrust_n: -bending_n,
                torque_n_m: 0.0,
                power_w: 0.0,
                end_mm: 0.0,
            });
            turn.add(bending_n, CHIP_MIN_MM);
        }
        statistics.add_turn(&turn, 3);
        assert_eq!((statistics.mean(&statistics.bending), statistics.variation_ratio()), (25.0, None));
        assert_eq!((statistics.mean(&statistics.thrust), statistics.thrust.max()), (-25.0, 30.0));
        statistics.add_turn(&TurnStatistics { is_aside: false, ..turn }, 2);
        assert_eq!(statistics.variation_ratio(), None, "a plunge");
        statistics.add_turn(&turn, 2);
        assert_eq!(statistics.variation_ratio(), Some(1.0));
    }

    #[test]
    fn passes_are_counted_by_side() {
        let mut statistics = LoadStatistics::default();
        for thickest_mm in [0.1, 0.3] {
            statistics.add_pass(Edge::Inner, thickest_mm);
        }
        assert_eq!(statistics.passes[0].mean_mm(), None);
        assert_eq!((statistics.passes[1].count, statistics.passes[1].max_mm), (2, 0.3));
        assert!((statistics.passes[1].mean_mm().unwrap() - 0.2).abs() < 1e-15);
    }
}
