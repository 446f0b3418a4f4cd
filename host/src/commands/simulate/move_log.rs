//! Log of a run: its moves, and the feed and the chip load over time.

use arcfeed_hil_sim::simulated_machine::{STEP, SimulatedMachine};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{Micros, S_PER_MIN};

/// Most moves of a path that is drawn below the viewer, which draws any number of them in less space.
pub const DRAWN_MAX: usize = 2_000;

/// Relative change that begins another step of a curve.
const STEP_RATIO: f64 = 2e-3;

/// Most steps of a curve; of more, neighbours are joined. A plot has a hundredth of this number of columns.
const STEPS_MAX: usize = 1 << 18;

/// Longest time without a value that is joined with its neighbours, as a fraction of the curve's length.
const GAP_RATIO: u64 = 4_096;

/// Log of a run: its moves, and feed and chip load over time.
#[derive(Debug, Default)]
pub struct MoveLog {
    /// Moves in order of execution.
    pub moves: Vec<LoggedMove>,
    /// Whether a page shows the log: otherwise only `moves` are recorded.
    pub is_shown: bool,
    /// The first [`DRAWN_MAX`] moves and one more, as they are drawn.
    pub drawn: Vec<DrawnMove>,
    /// Feed along the path over time, mm/min; rapids left out.
    pub feeds: Curve,
    /// Measured chip load divided by its target, over time.
    pub chips: Curve,
    /// Override that the control uses, %, over time.
    pub overrides: Curve,
    /// Moves that the control had begun at the last one logged.
    moves_begun: u64,
}

/// One move of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoggedMove {
    /// Number of blocks executed then, including the block of this move.
    pub block: u32,
    /// N number of the block; `None` without one.
    pub sequence: Option<i64>,
    /// The move is a rapid.
    pub is_rapid: bool,
    /// A cut rule governs the move.
    pub is_governed: bool,
    /// Machine time at which the move began.
    pub began: Micros,
    /// Largest feed along the path during the move, mm/min; 0 for rapids.
    pub feed_max_mm_per_min: f64,
}

/// Path of a move of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnMove {
    /// Number of blocks executed then, including the block of this move.
    pub block: u32,
    /// The move in workpiece coordinates.
    pub segment: Segment,
    /// A cut rule governs the move.
    pub is_governed: bool,
}

/// Quantity over time as steps: start, end, and value between them. A curve of any length has a bounded number of steps.
#[derive(Debug, Default)]
pub struct Curve(Vec<(Micros, Micros, f64)>);

impl MoveLog {
    /// Records the millisecond that the simulation has just executed.
    pub fn observe(&mut self, simulation: &SimulatedMachine) {
        let (now, control) = (simulation.now(), simulation.control());
        if self.is_shown {
            self.overrides.add(now, f64::from(control.override_percent()));
        }
        let Some((block, segment)) = control.active().map(|(count, _)| count).zip(simulation.segment()) else { return };
        if control.moves_begun() != self.moves_begun {
            self.moves_begun = control.moves_begun();
            let (sequence, is_rapid) = (segment.sequence, segment.path == Path::Rapid);
            let is_governed = simulation.rule().is_some();
            self.moves.push(LoggedMove {
                block,
                sequence,
                is_rapid,
                is_governed,
                began: now,
                feed_max_mm_per_min: 0.0,
            });
            if self.is_shown && self.drawn.len() <= DRAWN_MAX {
                self.drawn.push(DrawnMove { block, segment: *segment, is_governed });
            }
        }
        let Some(last) = self.moves.last_mut().filter(|last| !last.is_rapid) else { return };
        let feed_mm_per_min = control.speed_mm_per_s() * S_PER_MIN;
        last.feed_max_mm_per_min = last.feed_max_mm_per_min.max(feed_mm_per_min);
        if !self.is_shown {
            return;
        }
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
        let began = Micros(now.0.saturating_sub(STEP.0));
        match self.0.last_mut() {
            Some((_, to, last)) if *to == began && (value - *last).abs() <= STEP_RATIO * last.abs() => *to = now,
            _ => {
                if self.0.len() >= STEPS_MAX {
                    self.join_neighbours();
                }
                self.0.push((began, now, value));
            }
        }
    }

    /// Replaces the steps that begin in the same interval, if there are more than two, by two: the lowest and the highest value, in their
    /// order. The intervals are as long as the whole curve wants, and whole powers of two, so that those of a longer curve
    /// contain those of a shorter one.
    fn join_neighbours(&mut self) {
        let [Some((first, ..)), Some((_, last, _))] = [self.0.first(), self.0.last()] else { return };
        let whole = last.since(*first).0;
        let (gap_max, interval) = (whole / GAP_RATIO, (4 * whole / STEPS_MAX as u64).next_power_of_two());
        let belong = |a: &(Micros, Micros, f64), b: &(Micros, Micros, f64)| {
            a.0.0 / interval == b.0.0 / interval && b.0.since(a.1).0 <= gap_max
        };
        let joined = self.0.chunk_by(belong).flat_map(|steps| match steps {
            [a, _, .., d] => {
                let values = || steps.iter().enumerate().map(|(index, (.., value))| (index, *value));
                let low = values().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
                let high = values().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
                let [one, other] = if low.0 < high.0 { [low.1, high.1] } else { [high.1, low.1] };
                let middle = Micros(a.0.0.midpoint(d.1.0));
                vec![(a.0, middle, one), (middle, d.1, other)]
            }
            few => few.to_vec(),
        });
        self.0 = joined.collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_of_any_length_has_a_bounded_number_of_steps_and_keeps_its_extremes_in_their_place() {
        let mut curve = Curve::default();
        let (ms, peak, low, pause) = (3_000_000_u32, 1_234_567, 2_345_678, 500_000..600_000);
        for at in (1..=ms).filter(|at| !pause.contains(at)) {
            let value = match at {
                _ if at == peak => 9.0,
                _ if at == low => 0.5,
                _ => 2.0 + f64::from(at % 7) / 10.0,
            };
            curve.add(Micros::from_ms(u64::from(at)), value);
        }
        let steps = curve.steps(1.0);
        assert!((STEPS_MAX / 4..=STEPS_MAX).contains(&steps.len()), "{} steps", steps.len());
        assert!(steps.windows(2).all(|pair| pair[0].0[1] <= pair[1].0[0]));
        for (at_ms, value) in [(peak, 9.0), (low, 0.5)] {
            let ([from, to], _) = steps.iter().find(|(_, other)| *other == value).expect("the extreme");
            let at = f64::from(at_ms) / 1e3;
            assert!((from - at).abs() < 0.1 && (to - at).abs() < 0.1, "{value} from {from} to {to}, at {at}");
        }
        let gap = steps.windows(2).map(|pair| pair[1].0[0] - pair[0].0[1]).fold(0.0, f64::max);
        assert!((gap - 100.0).abs() < 0.1, "{gap} s");
    }
}
