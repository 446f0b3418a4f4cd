//! A law asked along a whole move: its answers at evenly spaced points, and between them a bound that it does not undercut.

use arcfeed_firmware::law::{FeedLaw, NoWish, Place};
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::Nm;

/// Cells that a move is divided into; the law is asked at their ends.
pub const CELLS: usize = 256;
/// Parts that a cell is divided into where the law bends sharply or jumps.
const PARTS: usize = 32;
/// Bend within a cell, over its value, above which it is looked at more closely.
const SHARP_RATIO: f64 = 1e-3;
/// Largest dip between two points of a divided cell that is reckoned with, over its value.
const DIP_RATIO_MAX: f64 = 5e-3;
/// Halvings to the place where a law's wish begins or ends.
const HALVINGS: usize = 30;

/// What a law says at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// A path of the centre per tooth, mm, and the contact's angle, radians.
    Wish(f64, f64),
    /// No feed is too high there.
    Anything,
    /// It has no wish.
    Nothing,
}

/// The answers of a law along a move.
#[derive(Clone, Debug)]
pub struct Profile {
    /// At the ends of the cells, [`CELLS`] + 1 of them.
    pub answers: Vec<Answer>,
    /// Path per tooth that no point of the cell undercuts, mm; infinite where no feed is too high.
    pub bounds: Vec<f64>,
    /// Whether the law says something everywhere in the cell.
    pub covered: Vec<bool>,
}

/// Where the law is asked.
struct Asked<'a, L> {
    law: &'a L,
    segment: &'a Segment,
}

impl Profile {
    /// Asks the law.
    pub fn ask(law: &impl FeedLaw, segment: &Segment) -> Self {
        let asked = Asked { law, segment };
        let answers: Vec<Answer> = (0..=CELLS).map(|point| asked.at(point as f64 / CELLS as f64)).collect();
        let values: Vec<Option<f64>> = answers.iter().map(|answer| answer.path()).collect();
        let (mut bounds, mut covered) = (Vec::with_capacity(CELLS), Vec::with_capacity(CELLS));
        for cell in 0..CELLS {
            let (bound, covers) = match (values[cell], values[cell + 1]) {
                (Some(a), Some(b)) => (asked.bound(cell, a.min(b), dip(&values, cell)), true),
                (Some(wish), None) => (asked.edge(wish, cell as f64, cell as f64 + 1.0), false),
                (None, Some(wish)) => (asked.edge(wish, cell as f64 + 1.0, cell as f64), false),
                (None, None) => (f64::INFINITY, false),
            };
            bounds.push(bound);
            covered.push(covers);
        }
        Profile { answers, bounds, covered }
    }

    /// A path per tooth that no point of the move undercuts; `None` where the law has no finite wish.
    pub fn least(&self) -> Option<f64> {
        self.bounds.iter().copied().reduce(f64::min).filter(|least| least.is_finite())
    }
}

impl Answer {
    /// The path per tooth, infinite where no feed is too high.
    fn path(self) -> Option<f64> {
        match self {
            Answer::Wish(path_mm, _) => Some(path_mm),
            Answer::Anything => Some(f64::INFINITY),
            Answer::Nothing => None,
        }
    }
}

impl<L: FeedLaw> Asked<'_, L> {
    fn at(&self, ratio: f64) -> Answer {
        match self.law.wish(&place_at(self.segment, ratio)) {
            Ok(wish) => Answer::Wish(f64::from(wish.path_mm_per_tooth), f64::from(wish.contact_rad())),
            Err(NoWish::ChipUnreachable) => Answer::Anything,
            Err(_) => Answer::Nothing,
        }
    }

    /// The bound of a cell with wishes at both ends.
    fn bound(&self, cell: usize, least: f64, dip: f64) -> f64 {
        if dip <= SHARP_RATIO * least || least.is_infinite() {
            return least - dip.min(least);
        }
        let at = |part: usize| self.at((cell as f64 + part as f64 / PARTS as f64) / CELLS as f64).path();
        let parts: Vec<Option<f64>> = (0..=PARTS).map(at).collect();
        let least = parts.iter().copied().flatten().fold(least, f64::min);
        let deepest = (0..PARTS).map(|part| self::dip(&parts, part)).fold(0.0, f64::max);
        least - deepest.min(DIP_RATIO_MAX * least)
    }

    /// The bound of a cell at one of whose ends the law has no wish: the wish at its other end, and where it begins.
    fn edge(&self, wish: f64, mut inside: f64, mut outside: f64) -> f64 {
        let mut least = wish;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            match self.at(middle / CELLS as f64).path() {
                Some(path) => {
                    least = least.min(path);
                    inside = middle;
                }
                None => outside = middle,
            }
        }
        least
    }
}

/// How far a curve through the points dips below the lower end of an interval, smooth or bent at the knots of a table. A
/// smooth one dips by at most an eighth of the second difference there; one that is straight but for a knot in between,
/// by at most the half: the knot leaves f and 1 - f of its bend in the two differences, and dips f (1 - f) of it below
/// the chord.
fn dip(values: &[Option<f64>], interval: usize) -> f64 {
    let bend = |middle: usize| match middle.checked_sub(1).and_then(|first| values.get(first..middle + 2)) {
        Some([Some(a), Some(b), Some(c)]) if a.is_finite() && b.is_finite() && c.is_finite() => {
            libm::fabs(a - 2.0 * b + c)
        }
        _ => 0.0,
    };
    bend(interval).max(bend(interval + 1)) / 2.0
}

/// The place at `ratio` (0 to 1) of a move.
pub fn place_at(segment: &Segment, ratio: f64) -> Place {
    let travelled_mm = (segment.feed_length_mm() * ratio) as f32;
    match segment.arc() {
        Some(arc) => {
            let direction = arc.direction_at(ratio).map(|component| component as f32);
            Place::on_arc(direction, f32::from(arc.turn.sign()), arc.radius_mm() as f32, travelled_mm)
        }
        None => {
            let [x, y, _] = segment.start.linear.map(Nm::to_mm);
            let [to_x, to_y, _] = segment.end.linear.map(Nm::to_mm);
            let part = |from: f64, to: f64| ((to - from) / segment.length_mm()) as f32;
            Place::on_line([part(x, to_x), part(y, to_y)], travelled_mm)
        }
    }
}
