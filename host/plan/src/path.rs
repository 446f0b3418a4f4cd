//! Path of the tool's centre through one slot: two arcs per level, one line between levels (Petean, section 3.3.3).
//!
//! ```text
//! level 1          C -> E                      about B1
//! even levels      E -> C -> D                 about B1, then A
//! odd levels       D -> C -> E                 about A, then B1
//! the last one     and back to C
//! ```
//!
//! The way down to the first level changes to the feed of the lines between levels 2 mm above the blank.
//!
//! Places are those of the tool's axis in the slot frame, heights those of its bottom.

use arcfeed_nc::modal::Turn;
use nalgebra::Rotation3;

use crate::vector::Flat;

/// An arc that ends this little before its start has no length.
const SWEEP_NOISE_RAD: f64 = 1e-9;
/// Height above the blank at which the approach ends: a control whose axes lag behind it by a tenth of a second has slowed down from 1.2 m/min.
const ENTRY_MM: f64 = 2.0;

/// Path of a cup mill through a slot, level by level. Points are in the slot frame, whose z is the tool's axis.
#[derive(Clone, Debug, PartialEq)]
pub struct SlotPath {
    /// Pivot A, on the outer circle at the base position: the same on all levels.
    pub exterior: Flat,
    /// Pivot B1, on the inner circle at the base position: the same on all levels.
    pub interior: Flat,
    /// Centre C of the tool at the base position, in which the ring touches both blades.
    pub base: Flat,
    /// Sense of rotation in which the centre leaves the base position.
    pub outward: Turn,
    /// Levels from the top.
    pub levels: Vec<Level>,
    /// Height of the tool between slots, above all that turns, mm.
    pub clear_mm: f64,
    /// Height of the tool's bottom at which the ring meets the blank on its way down at the base position, mm; the height of the first
    /// level if it meets nothing above that.
    pub contact_mm: f64,
}

/// One pass through a slot: all levels of a path, with one tool axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Path, in the slot frame.
    pub path: SlotPath,
    /// Rotation from the part frame to the slot frame.
    pub to_slot: Rotation3<f64>,
}

/// One level of a slot's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Height of the tool's bottom on this level, mm.
    pub height_mm: f64,
    /// Centre of the tool at D, the end of the turn about A.
    pub exterior_end: Flat,
    /// Centre of the tool at E, the end of the turn about B1.
    pub interior_end: Flat,
}

/// Purpose of a piece of the path, such as a movement of the ring or a retraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Purpose {
    /// Line down to above the blank, at the base position.
    Approach,
    /// Line from there into the blank, down to the first level.
    Entry,
    /// Turn about B1 towards the base position; the outer circle cuts.
    Movement1,
    /// Turn about A away from the base position; the outer circle cuts.
    Movement2,
    /// Turn about A towards the base position; the inner circle cuts.
    Movement3,
    /// Turn about B1 away from the base position; the inner circle cuts.
    Movement4,
    /// Line from one level to the next.
    Link,
    /// Line up, at the base position.
    Retract,
}

/// One step of the path: a line or an arc of the tool's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Purpose of the step.
    pub purpose: Purpose,
    /// Index of the level; for a link, of the level to which it leads.
    pub level: usize,
    /// Start: x and y of the tool's axis, and the height of its bottom, slot frame.
    pub from: [f64; 3],
    /// End, likewise.
    pub to: [f64; 3],
    /// Centre and sense of rotation of an arc; `None` for a line.
    pub about: Option<(Flat, Turn)>,
}

impl Step {
    /// `count` evenly spaced points from the start to the end of the step.
    pub fn places(&self, count: u32) -> Vec<[f64; 3]> {
        let share = |k: u32| f64::from(k) / f64::from(count.max(2) - 1);
        let along =
            |share: f64| [0, 1, 2].map(|axis: usize| self.from[axis] + (self.to[axis] - self.from[axis]) * share);
        let Some((centre, turn)) = self.about else { return (0..count).map(|k| along(share(k))).collect() };
        let from = Flat::new(self.from[0], self.from[1]) - centre;
        let to = Flat::new(self.to[0], self.to[1]) - centre;
        let sense = if turn == Turn::Ccw { 1.0 } else { -1.0 };
        let ahead = sense * libm::atan2(from.perp(&to), from.dot(&to));
        let sweep = sense * if ahead < 0.0 { ahead + core::f64::consts::TAU } else { ahead };
        let at = |k: u32| {
            let place = centre + nalgebra::Rotation2::new(sweep * share(k)) * from;
            [place.x, place.y, along(share(k))[2]]
        };
        (0..count).map(at).collect()
    }
}

impl Purpose {
    /// Number in Petean's table 5.1; `None` for lines.
    pub const fn movement(self) -> Option<usize> {
        match self {
            Purpose::Movement1 => Some(1),
            Purpose::Movement2 => Some(2),
            Purpose::Movement3 => Some(3),
            Purpose::Movement4 => Some(4),
            Purpose::Approach | Purpose::Entry | Purpose::Link | Purpose::Retract => None,
        }
    }
}

impl Step {
    /// Angle about the centre from start to end in the arc's sense, in [0, 2 pi); 0 for a line.
    pub fn sweep_rad(&self) -> f64 {
        use std::f64::consts::TAU;
        let Some((center, turn)) = self.about else { return 0.0 };
        let arm = |[x, y, _]: [f64; 3]| [x - center.x, y - center.y];
        let ([x, y], [to_x, to_y]) = (arm(self.from), arm(self.to));
        let ccw_rad = libm::atan2(x * to_y - y * to_x, x * to_x + y * to_y);
        let sweep_rad = ccw_rad * f64::from(turn.sign());
        let is_before = sweep_rad < -SWEEP_NOISE_RAD;
        if is_before { sweep_rad + TAU } else { sweep_rad.max(0.0) }
    }

    /// Path length of the centre, mm.
    pub fn length_mm(&self) -> f64 {
        let [dx, dy, dz] = std::array::from_fn(|axis| self.to[axis] - self.from[axis]);
        match self.about {
            Some((center, _)) => self.sweep_rad() * libm::hypot(self.from[0] - center.x, self.from[1] - center.y),
            None => libm::hypot(libm::hypot(dx, dy), dz),
        }
    }
}

impl SlotPath {
    /// End of the slot at which the tool leaves a level, counted from 0: 0 for D (the turn about A), 1 for E (the
    /// turn about B1).
    pub fn end_of(level: usize) -> usize {
        usize::from(level.is_multiple_of(2))
    }

    /// Pieces of the path, without approach and retract if there are no levels.
    pub fn steps(&self) -> Vec<Step> {
        let mut way = PathBuilder { path: self, steps: Vec::new(), at: [self.base.x, self.base.y, self.clear_mm] };
        for (index, level) in self.levels.iter().enumerate() {
            let last = index + 1 == self.levels.len();
            match index {
                0 => {
                    let entry_mm = (self.contact_mm + ENTRY_MM).min(self.clear_mm);
                    if self.contact_mm > level.height_mm {
                        way.line(Purpose::Approach, index, self.base, entry_mm);
                        way.line(Purpose::Entry, index, self.base, level.height_mm);
                    } else {
                        way.line(Purpose::Approach, index, self.base, level.height_mm);
                    }
                    way.arc(Purpose::Movement4, index, level.interior_end);
                }
                _ if index % 2 == 1 => {
                    way.line(Purpose::Link, index, level.interior_end, level.height_mm);
                    way.arc(Purpose::Movement1, index, self.base);
                    way.arc(Purpose::Movement2, index, level.exterior_end);
                }
                _ => {
                    way.line(Purpose::Link, index, level.exterior_end, level.height_mm);
                    way.arc(Purpose::Movement3, index, self.base);
                    way.arc(Purpose::Movement4, index, level.interior_end);
                }
            }
            if last {
                let back = if index % 2 == 1 { Purpose::Movement3 } else { Purpose::Movement1 };
                way.arc(back, index, self.base);
                way.line(Purpose::Retract, index, self.base, self.clear_mm);
            }
        }
        way.steps
    }
}

struct PathBuilder<'p> {
    path: &'p SlotPath,
    steps: Vec<Step>,
    at: [f64; 3],
}

impl PathBuilder<'_> {
    fn line(&mut self, purpose: Purpose, level: usize, to: Flat, height_mm: f64) {
        self.push(Step { purpose, level, from: self.at, to: [to.x, to.y, height_mm], about: None });
    }

    fn arc(&mut self, purpose: Purpose, level: usize, to: Flat) {
        let back = match self.path.outward {
            Turn::Cw => Turn::Ccw,
            Turn::Ccw => Turn::Cw,
        };
        let about = match purpose {
            Purpose::Movement1 => (self.path.interior, back),
            Purpose::Movement4 => (self.path.interior, self.path.outward),
            Purpose::Movement3 => (self.path.exterior, back),
            _ => (self.path.exterior, self.path.outward),
        };
        self.push(Step { purpose, level, from: self.at, to: [to.x, to.y, self.at[2]], about: Some(about) });
    }

    fn push(&mut self, step: Step) {
        self.at = step.to;
        self.steps.push(step);
    }
}
