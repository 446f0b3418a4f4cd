//! Depth of the ring's cut at a place seen along the tool axis: all material above its lowest pass is removed, and the
//! walls are parallel to the axis.
//!
//! The ring's underside is flat except for its rounded corners. Over an arc only the range of distances between the
//! place and the tool's axis matters: the ring passes lowest with the lowest part of its underside in that range. Over
//! a line between levels the height is taken where the flat part enters and leaves the place and at both ends; in
//! between, the result may be too high by a corner's height, but never too low.

use core::f64::consts::{PI, TAU};

use crate::cutter::CupMill;
use crate::path::Step;
use crate::vector::{Flat, Point};

use super::motion::{Arc, Motion};

/// Floor that the ring of a cup mill leaves: the lowest height of its underside over each point, seen along the tool.
pub struct Floor {
    /// Inner and outer end of its flat part, from the axis, mm.
    flat_mm: [f64; 2],
    rounding_mm: f64,
    around: Around,
    levels: Vec<Level>,
}

/// Steps of the path that follow each other on one level.
struct Level {
    index: usize,
    around: Around,
    /// Lowest height of the ring.
    low_mm: f64,
    passes: Vec<Pass>,
}

/// Step of the path.
struct Pass {
    motion: Motion,
    around: Around,
    /// Height at which it begins.
    from_mm: f64,
    ends: [Flat; 2],
}

/// Circle about all places of the axis.
struct Around {
    middle: Flat,
    reach_mm: f64,
}

impl Around {
    /// Circle about some circles; about the origin without any.
    fn all<'c>(circles: impl ExactSizeIterator<Item = &'c Around> + Clone) -> Self {
        let sum: nalgebra::Vector2<f64> = circles.clone().map(|circle| circle.middle.coords).sum();
        let middle = Flat::from(sum / circles.len().max(1) as f64);
        let reaches_mm = circles.map(|circle| (circle.middle - middle).norm() + circle.reach_mm);
        Around { middle, reach_mm: reaches_mm.fold(0.0, f64::max) + SLACK_MM }
    }
}

/// Tolerance within which passes are kept in spite of rounding, mm.
const SLACK_MM: f64 = 1e-6;

impl Pass {
    fn new(step: &Step) -> Self {
        let motion = Motion::new(step);
        let middle = motion.at(motion.length_mm / 2.0).place.xy();
        Pass {
            around: Around { middle, reach_mm: motion.length_mm / 2.0 + SLACK_MM },
            from_mm: step.from[2],
            ends: motion.arc().map_or([Flat::origin(); 2], Arc::ends),
            motion,
        }
    }
}

impl Level {
    fn new(steps: &[Step]) -> Self {
        let passes: Vec<Pass> = steps.iter().map(Pass::new).collect();
        Level {
            index: steps[0].level,
            around: Around::all(passes.iter().map(|pass| &pass.around)),
            low_mm: steps.iter().map(|step| step.from[2].min(step.to[2])).fold(f64::INFINITY, f64::min) - SLACK_MM,
            passes,
        }
    }
}

impl Floor {
    /// Floor that a ring leaves on this path.
    pub fn new(tool: &CupMill, steps: &[Step]) -> Self {
        let rounding_mm = tool.insert_radius_mm;
        let levels: Vec<Level> = steps.chunk_by(|one, next| one.level == next.level).map(Level::new).collect();
        Floor {
            flat_mm: [tool.inner_radius_mm + rounding_mm, tool.outer_radius_mm - rounding_mm],
            rounding_mm,
            around: Around::all(levels.iter().map(|level| &level.around)),
            levels,
        }
    }

    /// Whether the ring may come to a point; `false` only if it never does.
    pub fn may_reach(&self, place: &Flat) -> bool {
        self.comes_to(&self.around, place)
    }

    /// Lowest height of the ring over a point, mm, in the slot frame; infinite if the ring never comes there.
    pub fn at_mm(&self, place: &Flat) -> f64 {
        self.levels.iter().map(|level| self.level_mm(level, place)).fold(f64::INFINITY, f64::min)
    }

    /// Lowest height of the ring over a place after each level, mm; the height decreases from one to the next.
    pub fn by_level_mm(&self, place: &Flat, levels: usize) -> Vec<f64> {
        let mut floors_mm = vec![f64::INFINITY; levels];
        for level in &self.levels {
            if let Some(floor_mm) = floors_mm.get_mut(level.index) {
                *floor_mm = floor_mm.min(self.level_mm(level, place));
            }
        }
        for level in 1..levels {
            floors_mm[level] = floors_mm[level].min(floors_mm[level - 1]);
        }
        floors_mm
    }

    /// First level of the path at which the ring removes a point; `None` if it never does.
    pub fn first_level(&self, point: &Point) -> Option<usize> {
        let takes = |level: &&Level| level.low_mm <= point.z && self.level_mm(level, &point.xy()) <= point.z;
        self.levels.iter().find(takes).map(|level| level.index)
    }

    fn level_mm(&self, level: &Level, place: &Flat) -> f64 {
        if !self.comes_to(&level.around, place) {
            return f64::INFINITY;
        }
        level.passes.iter().map(|pass| self.pass_mm(pass, place)).fold(f64::INFINITY, f64::min)
    }

    /// Whether the ring may pass over a place, with its axis somewhere in a circle.
    fn comes_to(&self, Around { middle, reach_mm }: &Around, place: &Flat) -> bool {
        let off_mm = (place - middle).norm();
        self.lip_mm([off_mm - reach_mm, off_mm + reach_mm]).is_finite()
    }

    fn pass_mm(&self, pass: &Pass, place: &Flat) -> f64 {
        if !self.comes_to(&pass.around, place) {
            return f64::INFINITY;
        }
        match pass.motion.arc() {
            Some(arc) => pass.from_mm + self.lip_mm(range_mm(arc, &pass.ends, place)),
            None => self.line_mm(&pass.motion, place),
        }
    }

    /// Height of the underside above the bottom, at its lowest, in a range of distances from the axis.
    fn lip_mm(&self, [from_mm, to_mm]: [f64; 2]) -> f64 {
        let beyond_mm = (from_mm - self.flat_mm[1]).max(self.flat_mm[0] - to_mm).max(0.0);
        if beyond_mm > self.rounding_mm {
            return f64::INFINITY;
        }
        self.rounding_mm - libm::sqrt((self.rounding_mm - beyond_mm) * (self.rounding_mm + beyond_mm))
    }

    fn line_mm(&self, motion: &Motion, place: &Flat) -> f64 {
        let (start, end) = (motion.at(0.0), motion.at(motion.length_mm));
        let (way, off) = ((end.place - start.place).xy(), start.place.xy() - place);
        // |off + share way| = a radius of the flat part's
        let crossings = self.flat_mm.into_iter().flat_map(|radius_mm| {
            let (square, half) = (way.norm_squared(), off.dot(&way));
            let root = libm::sqrt(half * half - square * (off.norm_squared() - radius_mm * radius_mm));
            [(-half - root) / square, (-half + root) / square]
        });
        let shares = crossings.filter(|share| *share > 0.0 && *share < 1.0).chain([0.0, 1.0]);
        let height_mm = |share: f64| {
            let axis_mm = (off + way * share).norm();
            start.place.z + share * (end.place.z - start.place.z) + self.lip_mm([axis_mm; 2])
        };
        shares.map(height_mm).fold(f64::INFINITY, f64::min)
    }
}

/// Least and greatest distance of a place from the points of an arc.
fn range_mm(arc: &Arc, ends: &[Flat; 2], place: &Flat) -> [f64; 2] {
    let off = place - arc.centre;
    let far_mm = off.norm();
    let [start, end] = ends.map(|end| end.coords * arc.sweep_rad.signum());
    let (past_start, before_end) = (start.perp(&off), off.perp(&end));
    // Beyond half a turn the arc is all that is not between its end and its start.
    let holds = |past_start: f64, before_end: f64| match arc.sweep_rad.abs() {
        sweep_rad if sweep_rad >= TAU => true,
        sweep_rad if sweep_rad > PI => past_start >= 0.0 || before_end >= 0.0,
        _ => past_start >= 0.0 && before_end >= 0.0,
    };
    let ends_mm = ends.map(|end| (off - end.coords).norm());
    let least_mm = match holds(past_start, before_end) {
        true => (far_mm - arc.radius_mm).abs(),
        false => ends_mm[0].min(ends_mm[1]),
    };
    let greatest_mm = match holds(-past_start, -before_end) {
        true => far_mm + arc.radius_mm,
        false => ends_mm[0].max(ends_mm[1]),
    };
    [least_mm, greatest_mm]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_from_an_arc_are_those_of_its_points() {
        for case in 0..200 {
            let number = |k: usize| ((case * 37 + k * 101) % 211) as f64 / 211.0;
            let sweep_rad = (number(1) - 0.5) * 12.0;
            let arc = Arc {
                centre: Flat::new(number(2), number(3)),
                radius_mm: 3.0 * number(4) + 0.1,
                start_rad: 6.0 * number(5),
                sweep_rad,
            };
            let place = Flat::new(8.0 * number(6) - 4.0, 8.0 * number(7) - 4.0);
            let [least_mm, greatest_mm] = range_mm(&arc, &arc.ends(), &place);
            let points = (0..=4000).map(|k| {
                let angle = arc.start_rad + sweep_rad * f64::from(k) / 4000.0;
                (place - arc.centre - nalgebra::Vector2::new(libm::cos(angle), libm::sin(angle)) * arc.radius_mm).norm()
            });
            let [low, high] = points.fold([f64::MAX, 0.0_f64], |[low, high], d| [low.min(d), high.max(d)]);
            assert!((low - least_mm).abs() < 1e-4 && low > least_mm - 1e-12, "{case}: {low} {least_mm}");
            assert!((high - greatest_mm).abs() < 1e-4 && high < greatest_mm + 1e-12, "{case}: {high} {greatest_mm}");
        }
    }
}
