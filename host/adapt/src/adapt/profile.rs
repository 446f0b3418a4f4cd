//! Demand of a feed law along a move: its values at evenly spaced points, and a lower bound in each cell between them.

use std::cell::Cell;
use std::iter::once;

use arcfeed_law::{FeedDemand, FeedLaw, NoDemand, Place};

use super::asked_cells::{AskedCells, CELLS};
use super::places::MovePlaces;

/// Dip between two points, over their value, above which it is looked at more closely.
const SHARP_RATIO: f64 = 1e-5;
/// Steps of a place in f32 by which a demand may dip: two neighbouring answers of a slope are rounded either way.
const ROUNDED_STEPS: f64 = 2.0;
/// Most halvings of a cell in this search. A fall that remains is a jump, not a dip.
const DEPTH_MAX: usize = 16;
/// Most intervals of a move that are halved. Where a law is rough everywhere, the dips that remain count in full.
const HALVED_MAX: usize = 2_000;
/// Part of a dip that remains in both halves of an interval where a law is rough: a smooth dip falls to a quarter, and a bend or a jump lies in one half.
const ROUGH_RATIO: f64 = 0.5;
/// Largest dip, over the value, that is taken for roughness.
const ROUGH_MAX_RATIO: f64 = 0.01;
/// Steps towards the bottom of a valley, each of which leaves two thirds of it.
const DESCENTS: usize = 40;
/// Halvings of a cell to the place where a law's demand begins or ends: f32 resolves a place to 24 bits of its move.
const HALVINGS: usize = 16;

/// Result of a law at one point of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// The law demands this path of the tool centre per tooth (with the contact point at which the chip has its target).
    Demand(FeedDemand),
    /// The law permits any feed there.
    Anything,
    /// The law has no demand there: it does not apply, so the move runs with the feed that was sent.
    Nothing,
}

/// Results of a law along a move, at the ends and knots of the cells in which it was evaluated.
#[derive(Clone, Debug)]
pub struct Profile {
    /// Results at the ends of the cells and at the law's knots, in order; each with its place, in cells from the start of the move.
    pub answers: Vec<(f64, Answer)>,
    /// For each cell: path of the tool centre per tooth that is not above the demand at any point of the cell, mm; infinite where any feed
    /// is permitted.
    pub bounds: Vec<f64>,
    /// For each cell: `true` if the law has a demand, or allows any feed, at both ends of the cell.
    pub covered: Vec<bool>,
}

/// Law, and the places at which it is evaluated.
struct Asked<'a, L> {
    law: &'a L,
    places: &'a MovePlaces,
    /// Resolution of a place in f32, cells.
    step: f64,
    /// Intervals that may still be halved.
    left: Cell<usize>,
}

/// The demand at five evenly spaced points of an interval. Those at its quarters reveal a jump that happens to lie on the chord.
struct Quarters {
    /// Ends of the interval.
    ends: [Point; 2],
    /// The least path per tooth, infinite where no feed is too high at any of them.
    least: f64,
    /// That in the middle.
    middle: f64,
    /// Distance by which a curve through them dips below the least; infinite where some feed is unbounded.
    dip: f64,
    /// Dip that is neglected: a closer look would find it again, or only the steps of f32.
    negligible: f64,
}

/// A point, in cells from the start, and the path per tooth demanded there.
type Point = (f64, f64);

impl Profile {
    /// Evaluates the law in `cells` and at its knots `knots_mm`, which are paths from the start of the move, mm, in ascending order. A law
    /// that is the same everywhere is evaluated once, for one cell that is the whole move.
    pub fn ask(law: &impl FeedLaw, places: &MovePlaces, knots_mm: &[f64], cells: &AskedCells) -> Self {
        let asked = Asked { law, places, step: places.resolution_ratio() * CELLS as f64, left: Cell::new(HALVED_MAX) };
        if law.is_uniform() {
            return Profile::uniform(asked.at(0.0));
        }
        let mut knots = knots_mm.iter().map(|mm| mm / places.feed_length_mm() * CELLS as f64).peekable();
        let count = cells.count();
        let mut profile = Profile {
            answers: Vec::with_capacity(count + cells.runs().len() + knots_mm.len()),
            bounds: Vec::with_capacity(count),
            covered: Vec::with_capacity(count),
        };
        let mut ends: Vec<Answer> = Vec::with_capacity(count + 3);
        for run in cells.runs() {
            // The bends at a run's ends need the points beyond them.
            let (first, last) = (run.start.saturating_sub(1), (run.end + 1).min(CELLS));
            ends.clear();
            ends.extend(places.evenly([first, last], CELLS).map(|place| asked.answer(&place)));
            let path = |border: usize| ends[border - first].path();
            // Beyond the move's ends nothing bends.
            let bend_at = |border: usize| match border {
                0 | CELLS => 0.0,
                _ => bend(path(border - 1), path(border), path(border + 1)),
            };
            let mut bend_before = bend_at(run.start);
            for cell in run.clone() {
                let (from, to) = (cell as f64, cell as f64 + 1.0);
                let bend_behind = bend_at(cell + 1);
                profile.answers.push((from, ends[cell - first]));
                let first_knot = profile.answers.len();
                while knots.next_if(|knot| *knot <= from).is_some() {}
                while let Some(knot) = knots.next_if(|knot| *knot < to) {
                    profile.answers.push((knot, asked.at(knot)));
                }
                let bound = match (path(cell), path(cell + 1)) {
                    (Some(a), Some(b)) => {
                        let dip = f64::max(bend_before, bend_behind) / 2.0;
                        asked.bound((from, a), &profile.answers[first_knot..], (to, b), dip)
                    }
                    (Some(demand), None) => asked.edge((from, demand), to),
                    (None, Some(demand)) => asked.edge((to, demand), from),
                    (None, None) => f64::INFINITY,
                };
                profile.bounds.push(bound);
                profile.covered.push(path(cell).is_some() && path(cell + 1).is_some());
                bend_before = bend_behind;
            }
            profile.answers.push((run.end as f64, ends[run.end - first]));
        }
        profile
    }

    /// The same answer everywhere, as one cell.
    fn uniform(answer: Answer) -> Self {
        let path = answer.path();
        Profile {
            answers: vec![(0.0, answer), (CELLS as f64, answer)],
            bounds: vec![path.unwrap_or(f64::INFINITY)],
            covered: vec![path.is_some()],
        }
    }

    /// Whether one result holds for the whole move.
    pub fn is_uniform(&self) -> bool {
        self.bounds.len() == 1
    }

    /// Demanded path of the tool centre per tooth at the fraction `ratio` (0 to 1) of the move, mm, interpolated between two results;
    /// `None` if one of them is not a finite demand.
    pub fn demand_at(&self, ratio: f64) -> Option<f64> {
        let point = ratio * CELLS as f64;
        let after = self.answers.partition_point(|(at, _)| *at < point);
        let (to, after_path) = self.answers.get(after).and_then(|(at, answer)| Some((*at, answer.path()?)))?;
        let demand = if to == point {
            after_path
        } else {
            let (from, before_path) =
                self.answers.get(after.checked_sub(1)?).and_then(|(at, answer)| Some((*at, answer.path()?)))?;
            before_path + (after_path - before_path) * (point - from) / (to - from)
        };
        Some(demand).filter(|demand| demand.is_finite())
    }

    /// Path of the tool centre per tooth that is not above the demand anywhere on the move, mm; `None` if the law has no finite demand.
    pub fn least(&self) -> Option<f64> {
        self.bounds.iter().copied().reduce(f64::min).filter(|least| least.is_finite())
    }
}

impl Answer {
    /// The path per tooth, infinite where no feed is too high.
    fn path(self) -> Option<f64> {
        match self {
            Answer::Demand(demand) => Some(f64::from(demand.path_mm_per_tooth)),
            Answer::Anything => Some(f64::INFINITY),
            Answer::Nothing => None,
        }
    }
}

impl<L: FeedLaw> Asked<'_, L> {
    fn at(&self, point: f64) -> Answer {
        self.answer(&self.places.at(point / CELLS as f64))
    }

    fn answer(&self, place: &Place) -> Answer {
        match self.law.demand(place) {
            Ok(demand) => Answer::Demand(demand),
            Err(NoDemand::ChipUnreachable) => Answer::Anything,
            Err(_) => Answer::Nothing,
        }
    }

    /// The bound of a cell with demands at all of its points, for a law that is smooth between them but where it jumps. `dip`
    /// is how far a curve without knots dips below its lower end.
    fn bound(&self, first: Point, knots: &[(f64, Answer)], last: Point, dip: f64) -> f64 {
        let knots = || knots.iter().filter_map(|(at, answer)| Some((*at, answer.path()?)));
        let least = knots().map(|(_, path)| path).fold(first.1.min(last.1), f64::min);
        if least.is_infinite() {
            return least;
        }
        if dip <= SHARP_RATIO * least && knots().next().is_none() {
            return least - dip;
        }
        let points = || once(first).chain(knots()).chain(once(last));
        points().zip(points().skip(1)).map(|(first, last)| self.between(first, last)).fold(least, f64::min)
    }

    /// The least between two points: down into every bend, and to the bottom of the valley if there is one.
    fn between(&self, first: Point, last: Point) -> f64 {
        let quarters = self.quarters(first, last);
        if quarters.is_smooth() {
            return quarters.bound();
        }
        let least = self.looked_at(&quarters, DEPTH_MAX, f64::INFINITY);
        let (mut low, mut high, mut bottom) = (first.0, last.0, least);
        for _ in 0..DESCENTS {
            let third = (high - low) / 3.0;
            let [a, b] = [low + third, high - third].map(|point| self.at(point).path().unwrap_or(f64::INFINITY));
            bottom = bottom.min(a).min(b);
            if a < b {
                high -= third;
            } else {
                low += third;
            }
        }
        bottom
    }

    /// The least in an interval, halved as long as it might dip below what is known: the answers at its points, and `known`
    /// elsewhere in the cell.
    fn looked_at(&self, quarters: &Quarters, depth: usize, known: f64) -> f64 {
        if quarters.is_smooth() || quarters.dip.is_infinite() || depth == 0 {
            return quarters.bound();
        }
        let (lowest, left) = (quarters.lowest(), self.left.get());
        if lowest > known || left == 0 {
            return lowest;
        }
        self.left.set(left - 1);
        let [first, last] = quarters.ends;
        let middle = (0.5 * (first.0 + last.0), quarters.middle);
        let mut halves = [self.quarters(first, middle), self.quarters(middle, last)];
        if quarters.is_rough(&halves) {
            return halves.iter().map(Quarters::lowest).fold(lowest, f64::min);
        }
        // The lower half first: what it has leaves less to look for in the other.
        if last.1 < first.1 {
            halves.reverse();
        }
        halves.iter().fold(quarters.least, |least, half| least.min(self.looked_at(half, depth - 1, least.min(known))))
    }

    fn quarters(&self, first: Point, last: Point) -> Quarters {
        let at = |part: f64| self.at(first.0 + part * (last.0 - first.0)).path().unwrap_or(f64::INFINITY);
        let paths = [first.1, at(0.25), at(0.5), at(0.75), last.1];
        let bend = |a: usize, b: usize, c: usize| libm::fabs(paths[a] - 2.0 * paths[b] + paths[c]);
        let bends = [bend(0, 2, 4), bend(0, 1, 2), bend(1, 2, 3), bend(2, 3, 4)];
        let least = paths.into_iter().fold(f64::INFINITY, f64::min);
        let steps = libm::fabs(last.0 - first.0) / self.step;
        // A rise within a few steps may be a jump, which no step of f32 accounts for.
        let step = if steps > 2.0 * ROUNDED_STEPS { libm::fabs(last.1 - first.1) / steps } else { 0.0 };
        Quarters {
            ends: [first, last],
            least,
            middle: paths[2],
            negligible: f64::max(SHARP_RATIO * least, ROUNDED_STEPS * step),
            dip: if paths.contains(&f64::INFINITY) { f64::INFINITY } else { bends.into_iter().fold(0.0, f64::max) },
        }
    }

    /// The bound of a cell at one of whose ends the law has no demand: from `known` at its other end to where it begins.
    fn edge(&self, known: Point, end: f64) -> f64 {
        let (mut inside, mut outside) = (known, end);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside.0 + outside);
            match self.at(middle).path() {
                Some(path) => inside = (middle, path),
                None => outside = middle,
            }
        }
        self.between(known, inside)
    }
}

impl Quarters {
    /// Reports whether the demand falls below the points by a negligible amount only.
    fn is_smooth(&self) -> bool {
        self.dip <= self.negligible
    }

    /// Reports whether neither half dips much less than the whole.
    fn is_rough(&self, halves: &[Quarters; 2]) -> bool {
        self.dip <= ROUGH_MAX_RATIO * self.least && halves.iter().all(|half| half.dip >= ROUGH_RATIO * self.dip)
    }

    /// The lowest value that a curve through the points reaches.
    fn lowest(&self) -> f64 {
        (self.least - self.dip).max(0.0)
    }

    fn bound(&self) -> f64 {
        if self.dip.is_infinite() { self.least } else { self.least - self.dip.min(self.negligible) }
    }
}

/// Second difference of the paths per tooth at three neighbouring points; infinite next to a gap, where nothing is known of it.
///
/// Half of the larger one at a cell's two ends is how far a curve through the points dips below the lower end, smooth or bent at
/// the knots of a table. A smooth one dips by at most an eighth of the second difference there; one that is straight but for a
/// knot in between, by at most the half: the knot leaves f and 1 - f of its bend in the two differences, and dips f (1 - f) of it
/// below the chord.
fn bend(a: Option<f64>, b: Option<f64>, c: Option<f64>) -> f64 {
    let (Some(a), Some(b), Some(c)) = (a, b, c) else { return f64::INFINITY };
    let bend = libm::fabs(a - 2.0 * b + c);
    if bend.is_nan() { f64::INFINITY } else { bend }
}
