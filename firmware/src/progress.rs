//! Where on its arc the tool's centre is, from the axes' positions.
//!
//! The direction from the rotation centre only ever moves on in the sense of the arc: a sample behind the furthest one
//! (noise, a reversal while stopping) changes nothing.

use arcfeed_shared::fmath;
use arcfeed_shared::nc::modal::{Plane, Pose};
use arcfeed_shared::segment::Arc;
use arcfeed_shared::units::Nm;

/// An arc as progress sees it; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcTrack {
    plane: Plane,
    center: [Nm; 2],
    turn: f32,
    start: [f32; 2],
}

/// The furthest direction reached, a unit vector from the rotation centre; state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    direction: [f32; 2],
}

impl ArcTrack {
    /// The track of an arc.
    pub fn new(arc: &Arc) -> Self {
        ArcTrack {
            plane: arc.plane,
            center: arc.center,
            turn: f32::from(arc.turn.sign()),
            start: direction_of(arc.from),
        }
    }

    /// Progress before the first sample: at the arc's start.
    pub fn begin(&self) -> Progress {
        Progress { direction: self.start }
    }

    /// Takes a sample of the position and answers the direction to use.
    pub fn advance(&self, progress: &mut Progress, position: &Pose) -> [f32; 2] {
        let [x, y, z] = position.linear;
        let (first, second) = match self.plane {
            Plane::Xy => (x, y),
            Plane::Zx => (z, x),
            Plane::Yz => (y, z),
        };
        let [center_x, center_y] = self.center;
        // Wrapping: coordinates stay far below the 9 million kilometres at which it would.
        let relative = [Nm(first.0.wrapping_sub(center_x.0)), Nm(second.0.wrapping_sub(center_y.0))];
        // At the rotation centre there is no direction: it is NaN, and ahead of nothing.
        let direction = direction_of(relative);
        let ([x, y], [to_x, to_y]) = (progress.direction, direction);
        if self.turn * (x * to_y - y * to_x) > 0.0 {
            progress.direction = direction;
        }
        progress.direction
    }
}

/// The direction of a vector, NaN if it has no length; the scale cancels, so nanometres go into f32 as they are.
fn direction_of([x, y]: [Nm; 2]) -> [f32; 2] {
    let [x_nm, y_nm] = fmath::from_pair([x.0, y.0]);
    let length_nm = fmath::length(x_nm, y_nm);
    [x_nm / length_nm, y_nm / length_nm]
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_shared::nc::modal::Turn;

    const QUARTER: Arc = Arc {
        plane: Plane::Xy,
        turn: Turn::Cw,
        center: [Nm(5_000_000), Nm(0)],
        from: [Nm(0), Nm(100_000_000)],
        to: [Nm(100_000_000), Nm(0)],
    };

    fn at(x_nm: i64, y_nm: i64) -> Pose {
        Pose { linear: [Nm(x_nm), Nm(y_nm), Nm(0)], ..Pose::default() }
    }

    #[test]
    fn it_follows_the_arc_and_never_goes_back() {
        let track = ArcTrack::new(&QUARTER);
        let mut progress = track.begin();
        assert_eq!(track.advance(&mut progress, &at(5_000_000, 100_000_000)), [0.0, 1.0]);
        let on = track.advance(&mut progress, &at(65_000_000, 80_000_000));
        assert_eq!(on, [0.6, 0.8]);
        let back = track.advance(&mut progress, &at(64_990_000, 80_010_000));
        assert_eq!(back, on);
    }

    #[test]
    fn a_radial_deviation_does_not_move_it() {
        let track = ArcTrack::new(&QUARTER);
        let mut progress = track.begin();
        let inside = track.advance(&mut progress, &at(35_000_000, 40_000_000));
        assert_eq!(inside, [0.6, 0.8]);
    }

    #[test]
    fn a_sample_at_the_rotation_centre_has_no_direction_and_changes_nothing() {
        let track = ArcTrack::new(&QUARTER);
        let mut progress = track.begin();
        assert_eq!(track.advance(&mut progress, &at(5_000_000, 0)), [0.0, 1.0]);
    }
}
