//! Positions of the tool along a move, in the form in which feed laws take them. Constants of the move are computed
//! once.

use arcfeed_law::Place;
use arcfeed_nc::segment::{Arc, ArcAngles, Segment};
use arcfeed_units::Nm;

/// Positions of the tool along a move, at which laws are evaluated.
#[derive(Clone, Copy, Debug)]
pub struct MovePlaces {
    feed_length_mm: f64,
    shape: Shape,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Arc {
        angles: ArcAngles,
        /// +1 counter-clockwise, -1 clockwise.
        turn: f32,
        radius_mm: f32,
    },
    /// The components of its direction in the plane.
    Line([f32; 2]),
}

impl MovePlaces {
    /// Positions along a move, line or arc.
    pub fn of(segment: &Segment) -> Self {
        let shape = match segment.arc() {
            Some(arc) => return MovePlaces::on_arc(arc),
            None => {
                let [x, y, _] = segment.start.linear.map(Nm::to_mm);
                let [to_x, to_y, _] = segment.end.linear.map(Nm::to_mm);
                let length_mm = segment.length_mm();
                let part = |from: f64, to: f64| ((to - from) / length_mm) as f32;
                Shape::Line([part(x, to_x), part(y, to_y)])
            }
        };
        MovePlaces { feed_length_mm: segment.feed_length_mm(), shape }
    }

    /// Positions along an arc.
    pub fn on_arc(arc: &Arc) -> Self {
        let (angles, turn, radius_mm) = (arc.angles(), f32::from(arc.turn.sign()), arc.radius_mm() as f32);
        MovePlaces { feed_length_mm: arc.length_mm(), shape: Shape::Arc { angles, turn, radius_mm } }
    }

    /// Length of the path along which the feed F is measured, mm.
    pub fn feed_length_mm(&self) -> f64 {
        self.feed_length_mm
    }

    /// Smallest distance of two positions that single precision can tell apart, as a fraction of the move.
    pub fn resolution_ratio(&self) -> f64 {
        // Components of a direction up to 1, and paths up to the length, have 24 bits.
        let turned_rad = self.turn().map_or(1.0, |[_, _, turned_rad]| libm::fabs(turned_rad));
        f64::from(f32::EPSILON) / turned_rad.min(1.0)
    }

    /// For an arc: direction (+1 counter-clockwise, -1 clockwise), start angle and angle of rotation (sweep), rad;
    /// `None` for a line.
    pub fn turn(&self) -> Option<[f64; 3]> {
        match &self.shape {
            Shape::Arc { angles, turn, .. } => {
                Some([f64::from(*turn), angles.start_rad, f64::from(*turn) * angles.turned_rad])
            }
            Shape::Line(_) => None,
        }
    }

    /// Positions at the cell borders with the numbers `first` to `last`, for a move divided into `cells` equal cells.
    pub fn evenly(&self, [first, last]: [usize; 2], cells: usize) -> impl Iterator<Item = Place> {
        let ratio = move |border: usize| border as f64 / cells as f64;
        let (mut direction, step) = match &self.shape {
            Shape::Arc { angles, .. } => (angles.direction_at(ratio(first)), angles.step(cells)),
            Shape::Line(_) => ([1.0, 0.0], [1.0, 0.0]),
        };
        (first..=last).map(move |border| {
            let [x, y] = direction;
            direction = [x * step[0] - y * step[1], y * step[0] + x * step[1]];
            self.place([x, y], ratio(border))
        })
    }

    /// Position at the fraction `ratio` (0 to 1) of the move.
    pub fn at(&self, ratio: f64) -> Place {
        let direction = match &self.shape {
            Shape::Arc { angles, .. } => angles.direction_at(ratio),
            Shape::Line(_) => [1.0, 0.0],
        };
        self.place(direction, ratio)
    }

    /// The place at `ratio`, on an arc in this direction from its centre.
    fn place(&self, direction: [f64; 2], ratio: f64) -> Place {
        let travelled_mm = (self.feed_length_mm * ratio) as f32;
        match &self.shape {
            Shape::Arc { turn, radius_mm, .. } => {
                Place::on_arc(direction.map(|component| component as f32), *turn, *radius_mm, travelled_mm)
            }
            Shape::Line(motion) => Place::on_line(*motion, travelled_mm),
        }
    }
}
