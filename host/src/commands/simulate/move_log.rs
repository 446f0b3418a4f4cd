//! Log of a run: its moves, and the feed and the chip load over time.

use arcfeed_hil_sim::override_source::OverrideSource;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{Micros, S_PER_MIN};

/// Relative change that begins another step of a curve.
const STEP_RATIO: f64 = 2e-3;

/// Log of a run: its moves, and feed and chip load over time.
#[derive(Debug, Default)]
pub struct MoveLog {
    /// Moves in order of execution.
    pub moves: Vec<LoggedMove>,
    /// Feed along the path over time, mm/min; rapids left out.
    pub feeds: Curve,
    /// Measured chip load divided by its target, over time.
    pub chips: Curve,
    /// Moves that the control had begun at the last one logged.
    moves_begun: u64,
}

/// One move of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoggedMove {
    /// Number of blocks executed then, including the block of this move.
    pub block: u32,
    /// The move in workpiece coordinates.
    pub segment: Segment,
    /// A cut rule governs the move.
    pub is_governed: bool,
    /// Machine time at which the move began.
    pub began: Micros,
    /// Largest feed along the path during the move, mm/min; 0 for rapids.
    pub feed_max_mm_per_min: f64,
}

/// Quantity over time as steps: start, end, and value between them.
#[derive(Debug, Default)]
pub struct Curve(Vec<(Micros, Micros, f64)>);

impl MoveLog {
    /// Records the millisecond that the simulation has just executed.
    pub fn observe<D: OverrideSource>(&mut self, simulation: &Simulation<D>) {
        let (now, control) = (simulation.now(), simulation.control());
        let Some((block, segment)) = control.active().map(|(count, _)| count).zip(simulation.segment()) else { return };
        if control.moves_begun() != self.moves_begun {
            let is_governed = simulation.rule().is_some();
            self.moves_begun = control.moves_begun();
            self.moves.push(LoggedMove { block, segment: *segment, is_governed, began: now, feed_max_mm_per_min: 0.0 });
        }
        let Some(last) = self.moves.last_mut().filter(|last| last.segment.path != Path::Rapid) else { return };
        let feed_mm_per_min = control.speed_mm_per_s() * S_PER_MIN;
        last.feed_max_mm_per_min = last.feed_max_mm_per_min.max(feed_mm_per_min);
        self.feeds.add(now, feed_mm_per_min);
        if let Some(ratio) = simulation.meter().last_ratio() {
            self.chips.add(now, ratio);
        }
    }
}

impl Curve {
    /// Steps as start and end in s, and value divided by `unit`.
    pub fn steps(&self, unit: f64) -> Vec<([f64; 2], f64)> {
        self.0.iter().map(|(from, to, value)| ([from.to_s(), to.to_s()], value / unit)).collect()
    }

    /// Whether the curve has no steps.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn add(&mut self, now: Micros, value: f64) {
        let began = Micros(now.0.saturating_sub(arcfeed_hil_sim::simulation::STEP.0));
        match self.0.last_mut() {
            Some((_, to, last)) if *to == began && (value - *last).abs() <= STEP_RATIO * last.abs() => *to = now,
            _ => self.0.push((began, now, value)),
        }
    }
}
