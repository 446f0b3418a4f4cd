//! Position of the tool from three incremental encoders.
//!
//! Incremental encoders count from the position at power-on. The operator must set zero at the program's zero. After a
//! fault (a jump, a broken wire, an error of the receiver) the counts are invalid until zero is set again.

use arcfeed_nc::modal::Pose;
use arcfeed_units::{Nm, Span};

use crate::supervisor::input::Freshness;

use super::encoder::{Counter, Encoder};

/// Readings of the timers that count the encoders of X, Y and Z; `None` while a receiver reports a broken line.
pub type Readings = Option<[u16; 3]>;

/// Position of the tool from three incremental encoders. Unknown until the operator sets zero, and again after a
/// fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Position {
    axes: Option<[Counter; 3]>,
    /// Time since the last sample; `None` if there was none since zero was set.
    age: Option<Span>,
}

impl Position {
    /// Processes the readings of this tick, `dt` after the last one. Returns the position, or `None` if it is unknown
    /// or the readings are invalid.
    pub fn follow(&mut self, encoders: &[Encoder; 3], readings: Readings, dt: Span) -> Option<Pose> {
        let linear = self.axes.as_mut().zip(readings).and_then(|(axes, readings)| follow(encoders, axes, readings));
        if linear.is_some() {
            self.age = Some(Span(0));
        } else {
            self.axes = None;
            self.age = self.age.map(|age| age.longer_by(dt));
        }
        linear.map(|linear| Pose { linear, ..Pose::default() })
    }

    /// Makes the present position the program's zero. Returns false, and changes nothing, while an encoder line is
    /// broken.
    pub fn set_zero(&mut self, readings: Readings) -> bool {
        if let Some(readings) = readings {
            self.axes = Some(readings.map(Counter::zero_at));
        }
        readings.is_some()
    }

    /// Time since the last valid position, and whether the position is known.
    pub fn freshness(&self) -> Freshness {
        Freshness { age: self.age.unwrap_or(Span(u32::MAX)), invalid_in_row: 0 }
    }
}

fn follow(encoders: &[Encoder; 3], axes: &mut [Counter; 3], readings: [u16; 3]) -> Option<[Nm; 3]> {
    let mut linear = [Nm(0); 3];
    for (((encoder, axis), reading), at) in encoders.iter().zip(axes).zip(readings).zip(&mut linear) {
        *at = encoder.follow(axis, reading).ok()?;
    }
    Some(linear)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: Span = Span::from_ms(1);
    const ENCODERS: [Encoder; 3] = [Encoder::new(1_000, 100).unwrap(); 3];

    fn age(position: &Position) -> Span {
        position.freshness().age
    }

    #[test]
    fn there_is_no_place_before_zero_is_set() {
        let mut position = Position::default();
        assert_eq!(position.follow(&ENCODERS, Some([1, 2, 3]), TICK), None);
        assert_eq!(age(&position), Span(u32::MAX));
        assert!(!position.set_zero(None));
        assert!(position.set_zero(Some([1, 2, 3])));
        let pose = position.follow(&ENCODERS, Some([2, 0, 3]), TICK).unwrap();
        assert_eq!(pose, Pose { linear: [Nm(1_000), Nm(-2_000), Nm(0)], ..Pose::default() });
        assert_eq!(age(&position), Span(0));
    }

    #[test]
    fn after_a_broken_line_or_a_jump_of_one_axis_the_place_is_lost_until_zero_is_set_again() {
        for fault in [None, Some([0, 101, 0]), Some([0, 0, 0x8000])] {
            let mut position = Position::default();
            position.set_zero(Some([0; 3]));
            assert!(position.follow(&ENCODERS, Some([0; 3]), TICK).is_some());
            assert_eq!(position.follow(&ENCODERS, fault, TICK), None);
            for tick in 2..60 {
                assert_eq!(position.follow(&ENCODERS, Some([0; 3]), TICK), None);
                assert_eq!(age(&position), Span::from_ms(tick));
            }
            position.set_zero(Some([7; 3]));
            assert_eq!(position.follow(&ENCODERS, Some([7; 3]), TICK), Some(Pose::default()));
            assert_eq!(age(&position), Span(0));
        }
    }
}
