//! Exact intervals that a moving slab (part of a tool between two heights) removes from a ray.
//!
//! A point of the ray is o + u d. The slab's reference point is at f + s v, s from 0 to 1. With w = o - f, the tool's axis a, and
//! the parts of all vectors perpendicular to it marked by ', the ray's point is in the slab at s where
//!
//! ```text
//! z = w.a + u d.a - s v.a            z0 <= z <= z1,  0 <= s <= 1            (1)
//! |w' + u d' - s v'|^2 - r(z)^2 <= 0 for the outside's r, >= 0 for the hole's      (2)
//! ```
//!
//! In the plane of s and u, (1) is a parallelogram and (2) a conic. The swept points are all u for which there is an s.
//! Their intervals begin and end where the outside's conic is extreme in u, where a conic crosses an edge of the
//! parallelogram, or at a corner of it. Between two neighbouring candidates all points are swept or none, so one test in
//! the middle is enough. For each u the values of s inside the outside form one interval, because a conical slab is
//! convex, and so do those inside the hole: the point is swept unless the hole contains both ends of the first interval.
//!
//! Source: own derivation.

use arcfeed_kinematics::vector::{Vector, dot};

use super::dexel::Interval;
use super::frame::Frame;
use super::quadratic::Quadratic;
use super::tool::Slab;

/// Places closer than this are one.
const SAME_MM: f64 = 1e-11;

/// Most places there can be: the outside's 2 extremes, 8 crossings of each conic with the edges, 4 corners.
const PLACES_MAX: usize = 22;

/// A straight move of the tool's tip with a fixed tool axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Tip position at the start.
    pub from_mm: Vector,
    /// Tip position at the end.
    pub to_mm: Vector,
    /// Unit vector from the tip to the holder.
    pub axis: Vector,
}

impl Sweep {
    /// Displacement of the tip, v.
    pub fn motion_mm(&self) -> Vector {
        [0, 1, 2].map(|axis| self.to_mm[axis] - self.from_mm[axis])
    }

    /// The same sweep in the coordinates of another frame.
    pub fn in_frame(&self, frame: &Frame) -> Self {
        let [from_mm, to_mm, axis] = [self.from_mm, self.to_mm, self.axis].map(|vector| frame.coordinates(vector));
        Sweep { from_mm, to_mm, axis }
    }
}

/// A cone about the tool's axis as the rays of one direction see it: the part of (2) that is the same for all of them.
#[derive(Clone, Copy, Debug)]
struct Cone {
    base_mm: f64,
    slope: f64,
    /// Factors of u^2, s^2 and 2 u s.
    squares: [f64; 3],
}

/// (2) on one ray: factors of u^2, s^2, 2 u s, 2 u, 2 s and 1.
#[derive(Clone, Copy, Debug)]
struct Conic([f64; 6]);

/// Intersection of a slab on a sweep with rays of one direction, prepared for many rays.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    ray_axis: usize,
    sweep: Sweep,
    motion_mm: Vector,
    heights_mm: [f64; 2],
    /// d.a and v.a
    rise: [f64; 2],
    outer: Cone,
    inner: Option<Cone>,
}

/// Coordinates along the ray where the answer may change.
struct Places {
    within: Interval,
    count: usize,
    at_mm: [f64; PLACES_MAX],
}

impl Section {
    /// Prepares a slab on a sweep, for rays along `ray_axis` (0, 1, 2 for x, y, z).
    pub fn new(slab: &Slab, sweep: &Sweep, ray_axis: usize) -> Self {
        let motion_mm = sweep.motion_mm();
        let rise = [sweep.axis[ray_axis], dot(motion_mm, sweep.axis)];
        let cone = |radii_mm: [f64; 2]| {
            let slope = (radii_mm[1] - radii_mm[0]) / (slab.heights_mm[1] - slab.heights_mm[0]);
            let steepness = 1.0 + slope * slope;
            let uu = 1.0 - steepness * rise[0] * rise[0];
            let ss = dot(motion_mm, motion_mm) - steepness * rise[1] * rise[1];
            let us = steepness * rise[0] * rise[1] - motion_mm[ray_axis];
            Cone { base_mm: radii_mm[0], slope, squares: [uu, ss, us] }
        };
        Section {
            ray_axis,
            sweep: *sweep,
            motion_mm,
            heights_mm: slab.heights_mm,
            rise,
            outer: cone(slab.outer_mm),
            inner: slab.inner_mm.map(cone),
        }
    }

    /// Calls `take` with each interval that the slab sweeps on the ray through `point_mm`, in ascending order; the coordinate
    /// of `point_mm` along the ray is ignored. `within` must contain all swept intervals.
    pub fn for_each_span(&self, mut point_mm: Vector, within: &Interval, mut take: impl FnMut(Interval)) {
        let origin_mm = self.sweep.from_mm[self.ray_axis];
        point_mm[self.ray_axis] = origin_mm;
        let w: Vector = [0, 1, 2].map(|axis| point_mm[axis] - self.sweep.from_mm[axis]);
        let height_mm = dot(w, self.sweep.axis);
        let outer = self.conic(&self.outer, w, height_mm);
        let inner = self.inner.as_ref().map(|cone| self.conic(cone, w, height_mm));
        let within = Interval::new(within.from_mm - origin_mm, within.to_mm - origin_mm);
        let mut places = Places { within, count: 0, at_mm: [0.0; PLACES_MAX] };
        outer.add_extremes(&mut places);
        self.add_corners(height_mm, &mut places);
        self.add_crossings(&outer, height_mm, &mut places);
        if let Some(inner) = &inner {
            self.add_crossings(inner, height_mm, &mut places);
        }
        let is_swept = |pair: &[f64]| self.is_swept((pair[0] + pair[1]) / 2.0, height_mm, &outer, inner.as_ref());
        let mut pairs = places.sorted().windows(2);
        let mut take_from_to = |from: f64, to: f64| take(Interval::new(origin_mm + from, origin_mm + to));
        while let Some(first) = pairs.find(|pair| is_swept(pair)) {
            // A slab without a hole sweeps a convex region: one piece, whose end is found faster from the back.
            let last = match inner {
                None => pairs.rfind(|pair| is_swept(pair)).unwrap_or(first),
                Some(_) => {
                    let more = pairs.clone().take_while(|pair| is_swept(pair)).count();
                    if more > 0 { pairs.nth(more - 1).unwrap_or(first) } else { first }
                }
            };
            take_from_to(first[0], last[1]);
            if inner.is_none() {
                return;
            }
        }
    }

    /// (2)
    fn conic(&self, cone: &Cone, w: Vector, height_mm: f64) -> Conic {
        let radius_mm = cone.base_mm + cone.slope * (height_mm - self.heights_mm[0]);
        let [along_u, along_s] = self.rise;
        let [uu, ss, us] = cone.squares;
        let tilt = height_mm + cone.slope * radius_mm;
        let u = w[self.ray_axis] - tilt * along_u;
        let s = tilt * along_s - dot(w, self.motion_mm);
        Conic([uu, ss, us, u, s, dot(w, w) - height_mm * height_mm - radius_mm * radius_mm])
    }

    /// Corners of the parallelogram (1).
    fn add_corners(&self, height_mm: f64, places: &mut Places) {
        let [along_u, along_s] = self.rise;
        for edge_mm in self.heights_mm {
            places.add((edge_mm - height_mm) / along_u);
            places.add((edge_mm - height_mm + along_s) / along_u);
        }
    }

    /// Adds the places where a conic crosses the lines of the parallelogram's edges.
    fn add_crossings(&self, conic: &Conic, height_mm: f64, places: &mut Places) {
        for s in [0.0, 1.0] {
            let [first, second] = conic.on_line([s, 0.0], [0.0, 1.0]).roots();
            places.add(first);
            places.add(second);
        }
        let [along_u, along_s] = self.rise;
        let square = along_u * along_u + along_s * along_s;
        if square == 0.0 {
            return;
        }
        for edge_mm in self.heights_mm {
            let to_edge = (edge_mm - height_mm) / square;
            let base = [-along_s * to_edge, along_u * to_edge];
            let [first, second] = conic.on_line(base, self.rise).roots();
            places.add(base[1] + first * along_s);
            places.add(base[1] + second * along_s);
        }
    }

    /// Whether the ray's point at `u` is reached at some s.
    fn is_swept(&self, u: f64, height_mm: f64, outer: &Conic, inner: Option<&Conic>) -> bool {
        let [along_u, along_s] = self.rise;
        let height_mm = height_mm + u * along_u;
        let above = [height_mm - self.heights_mm[0], height_mm - self.heights_mm[1]];
        let mut range = [0.0_f64, 1.0_f64];
        if along_s == 0.0 {
            if above[0] < 0.0 || above[1] >= 0.0 {
                return false;
            }
        } else {
            let ends = [above[0] / along_s, above[1] / along_s];
            range = [range[0].max(ends[0].min(ends[1])), range[1].min(ends[0].max(ends[1]))];
        }
        let outside = if range[0] <= range[1] { outer.in_s(u).not_positive_within(range) } else { None };
        match (outside, inner) {
            (None, _) => false,
            (Some(_), None) => true,
            (Some(ends), Some(inner)) => ends.iter().any(|s| inner.in_s(u).at(*s) >= 0.0),
        }
    }
}

impl Conic {
    /// As a function of s.
    fn in_s(&self, at_u: f64) -> Quadratic {
        let Conic([uu, ss, us, u, s, one]) = self;
        Quadratic([*ss, us * at_u + s, (uu * at_u + 2.0 * u) * at_u + one])
    }

    /// As a function of t on (s, u) = base + t direction.
    fn on_line(&self, base: [f64; 2], direction: [f64; 2]) -> Quadratic {
        let Conic([uu, ss, us, u, s, one]) = self;
        let ([s0, u0], [ds, du]) = (base, direction);
        let a = (uu * du + 2.0 * us * ds) * du + ss * ds * ds;
        let b = (uu * u0 + us * s0 + u) * du + (ss * s0 + us * u0 + s) * ds;
        let c = (uu * u0 + 2.0 * (us * s0 + u)) * u0 + (ss * s0 + 2.0 * s) * s0 + one;
        Quadratic([a, b, c])
    }

    /// Adds the places where the function of s has a double root.
    fn add_extremes(&self, places: &mut Places) {
        let Conic([uu, ss, us, u, s, one]) = self;
        let [first, second] = Quadratic([us * us - ss * uu, us * s - ss * u, s * s - ss * one]).roots();
        places.add(first);
        places.add(second);
    }
}

impl Places {
    /// Infinite and missing ones are none.
    fn add(&mut self, at_mm: f64) {
        if at_mm >= self.within.from_mm
            && at_mm <= self.within.to_mm
            && let Some(place) = self.at_mm.get_mut(self.count)
        {
            *place = at_mm;
            self.count += 1;
        }
    }

    /// In order, each once.
    fn sorted(&mut self) -> &[f64] {
        let places = &mut self.at_mm[..self.count];
        places.sort_unstable_by(f64::total_cmp);
        let mut kept = 0;
        for at in 0..places.len() {
            if kept == 0 || places[at] - places[kept - 1] > SAME_MM {
                places[kept] = places[at];
                kept += 1;
            }
        }
        &places[..kept]
    }
}
