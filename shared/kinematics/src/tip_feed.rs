//! Feed limit of the tip under tool centre point control (G43.4): the linear axes follow the rotary ones at a varying
//! speed.
//!
//! On a straight move the tip goes evenly from x to x + x' and the rotary axes from q to q + q', over s from 0 to 1. With u, c, w
//! the direction of a rotary axis, its point and its turn over the move in radians, each axis of the table takes a point p that
//! moves by p' further as
//!
//! ```text
//! p -> c + R(-q)(p - c)       p' -> R(-q) p' - w u x (R(-q)(p - c))                       (1)
//! ```
//!
//! and each axis of the head, with its tip at rest, likewise by R(q) and +w; L' is the difference of the two. L' is
//! sampled at n + 1 points. Between two samples a component exceeds the larger sample by at most an eighth of the
//! square of their distance times its largest second derivative, which, with W the sum of all |w| and l the tool's
//! length, is
//!
//! ```text
//! |L'''| <= W^2 (W (|x| + l + 2 |c0| + 2 |c1|) + 3 |x'|)                                  (2)
//! F = |x'| / max over the axes of (max |L'| + |L'''| / (8 n^2)) / V                         (3)
//! ```
//!
//! n is doubled until the term of (2) is below a thousandth of the whole. Therefore F never exceeds the limit of the
//! axes, and is at most 0.1 % below it on moves of up to some hundred turns.
//!
//! Source: (1) is the derivative of `forward`'s chain; (2) the bound of linear interpolation on its third derivative.

use super::feed::AxisFeed;
use super::forward::Setup;
use super::machine::{AxisName, Carries, Machine, RotaryAxis};
use super::vector::{Vector, cross, difference, length, scaled, sum, turned};

/// Minimum number of steps on a move on which a rotary axis turns.
const STEPS_MIN: u32 = 16;
/// Maximum number of steps.
const STEPS_MAX: u32 = 1 << 14;
/// Allowed shortfall of the feed, as a fraction.
const SLACK_RATIO: f64 = 1e-3;

/// A straight move of the tip under tool centre point control, during which the rotary axes turn evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipMove {
    /// Positions of the tip at start and end, in the part's frame.
    pub tip_mm: [Vector; 2],
    /// Positions of the rotary axes at start and end; of each, in the order from the part to the tool.
    pub rotary_deg: [[f64; 2]; 2],
}

/// A point and its derivative by s.
#[derive(Clone, Copy, Debug)]
struct Moving {
    point: Vector,
    rate: Vector,
}

impl TipMove {
    /// Length of the tip's path, along which the feed is measured.
    pub fn way_mm(&self) -> f64 {
        length(self.tip_rate())
    }

    fn tip_rate(&self) -> Vector {
        difference(self.tip_mm[1], self.tip_mm[0])
    }

    fn turned_deg(&self) -> [f64; 2] {
        let [from, to] = self.rotary_deg;
        [to[0] - from[0], to[1] - from[1]]
    }
}

impl Machine {
    /// Largest feed of the tip, in the part's frame, at which no axis exceeds its maximum speed anywhere on the move;
    /// `None` if no limit is known or the tip does not move. (3)
    pub fn tip_feed(&self, of: &TipMove, setup: &Setup) -> Option<AxisFeed> {
        let [first, second] = of.turned_deg();
        let bound_mm = self.third_derivative_mm(of, setup);
        let mut steps = if first == 0.0 && second == 0.0 { 1 } else { STEPS_MIN };
        loop {
            let slack_mm = bound_mm / (8.0 * f64::from(steps) * f64::from(steps));
            let (axis, surely_min, at_least_min) = self.longest(of, setup, (steps, slack_mm))?;
            if surely_min <= at_least_min * (1.0 + SLACK_RATIO) || steps >= STEPS_MAX {
                let feed_mm_per_min = of.way_mm() / surely_min;
                return (feed_mm_per_min > 0.0).then_some(AxisFeed { feed_mm_per_min, axis });
            }
            steps *= 2;
        }
    }

    /// Derivative of X, Y, Z by s at one point of a move. (1)
    fn linear_rate(&self, of: &TipMove, setup: &Setup, s: f64) -> Vector {
        let [turned_first, turned_second] = of.turned_deg();
        let [from, _] = of.rotary_deg;
        let at = [(from[0] + s * turned_first, turned_first), (from[1] + s * turned_second, turned_second)];
        let tip = sum(of.tip_mm[0], scaled(of.tip_rate(), s));
        let mut on_table = Moving { point: sum(tip, setup.part_zero_mm), rate: of.tip_rate() };
        let mut held = Moving { point: scaled(self.tool(), -setup.tool_length_mm), rate: [0.0; 3] };
        let [first, second] = self.rotary();
        for (axis, (position_deg, rate_deg)) in [(first, at[0]), (second, at[1])] {
            if axis.carries == Carries::Part {
                on_table = on_table.turned(axis, -position_deg, -rate_deg);
            }
        }
        for (axis, (position_deg, rate_deg)) in [(second, at[1]), (first, at[0])] {
            if axis.carries == Carries::Tool {
                held = held.turned(axis, position_deg, rate_deg);
            }
        }
        difference(on_table.rate, held.rate)
    }

    /// The axis that needs the longest time for a move, with that time in minutes: with and without the allowance for
    /// the intervals between the samples.
    fn longest(&self, of: &TipMove, setup: &Setup, (steps, slack_mm): (u32, f64)) -> Option<(AxisName, f64, f64)> {
        let mut greatest = [0.0_f64; 3];
        for step in 0..=steps {
            let rate = self.linear_rate(of, setup, f64::from(step) / f64::from(steps));
            for (greatest, rate) in greatest.iter_mut().zip(rate) {
                *greatest = greatest.max(libm::fabs(rate));
            }
        }
        let linear = self.linear().iter().zip(greatest).enumerate().filter_map(|(at, (axis, rate))| {
            let speed = axis.speed_mm_per_min?;
            Some((AxisName::Linear(at), (rate + slack_mm) / speed, rate / speed))
        });
        let rotary = self.rotary().iter().zip(of.turned_deg()).filter_map(|(axis, turned)| {
            let time_min = libm::fabs(turned) / axis.speed_deg_per_min?;
            Some((AxisName::Rotary(axis.letter), time_min, time_min))
        });
        let longest = linear.chain(rotary).max_by(|(_, one, _), (_, other, _)| one.total_cmp(other))?;
        (longest.1 > 0.0).then_some(longest)
    }

    /// Bound of the third derivative. (2)
    fn third_derivative_mm(&self, of: &TipMove, setup: &Setup) -> f64 {
        let whole: f64 = of.turned_deg().iter().map(|turned| libm::fabs(turned.to_radians())).sum();
        let out = of.tip_mm.map(|tip| length(sum(tip, setup.part_zero_mm)));
        let points: f64 = self.rotary().iter().map(|axis| 2.0 * length(axis.point_mm)).sum();
        let arm_mm = out[0].max(out[1]) + libm::fabs(setup.tool_length_mm) + points;
        whole * whole * (whole * arm_mm + 3.0 * of.way_mm())
    }
}

impl Moving {
    /// (1)
    fn turned(self, axis: &RotaryAxis, by_deg: f64, rate_deg: f64) -> Self {
        let arm = turned(difference(self.point, axis.point_mm), axis.direction, by_deg);
        let swept = scaled(cross(axis.direction, arm), rate_deg.to_radians());
        Moving { point: sum(axis.point_mm, arm), rate: sum(turned(self.rate, axis.direction, by_deg), swept) }
    }
}
