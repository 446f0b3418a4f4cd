//! Limits of the speed of a move, computed from geometry alone.

use core::f64::consts::{PI, TAU};

use crate::feed_bounds::jobs::RandomJob;
use crate::feed_bounds::programs::{ArcMove, Move, PLANES};

/// Largest excess of a chip over its target, relative.
const CHIP_TOLERANCE: f64 = 5e-3;
/// Largest excess of a feed over its bound: F words have four digits after the point.
const FEED_TOLERANCE: f64 = 1e-3;
/// Lowest feed of the contour law, of its target.
const CONTOUR_FLOOR: f64 = 0.2;
/// Sine of 1 degree.
const AXIAL_SINE: f64 = 0.017_453;

/// Position of the tool on a move, in its plane or in space, and its speed.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    pub at: [f64; 3],
    pub feed_per_min: f64,
}

/// Whether the law of this tool of the job may govern the move.
pub fn may_govern(job: &RandomJob, of: &Move) -> bool {
    let rises = libm::fabs(of.to[2] - of.from[2]) > AXIAL_SINE * path_length(of);
    let is_across = !rises && of.arc.is_none_or(|arc| arc.plane == 0);
    let has_rule = match (job.law, of.arc) {
        ("circumference", Some(arc)) => arc.is_ccw == job.circle.is_ccw,
        ("circumference", None) => false,
        _ => true,
    };
    of.spindle.is_some_and(|speed| speed > 0.0) && (is_across || job.law == "table") && has_rule
}

/// Violation at a moment of a move that keeps its programmed feed.
pub fn excess_as_programmed(of: &Move, now: &Moment) -> Option<String> {
    let too_fast = now.feed_per_min > of.feed * (1.0 + FEED_TOLERANCE);
    too_fast.then(|| format!("{} mm/min where the program says {}", now.feed_per_min, of.feed))
}

/// Violation at a moment of a governed move.
pub fn excess(job: &RandomJob, of: &Move, now: &Moment, has_own_feed: bool) -> Option<String> {
    // If the program's F is sent, the job's least override may hold the feed up; reports say so.
    let floor = if has_own_feed { of.feed * f64::from(job.limits[0]) / 100.0 } else { 0.0 };
    if now.feed_per_min <= floor * (1.0 + FEED_TOLERANCE) {
        return None;
    }
    let bound = job.max_feed.min(of.feed * job.max_raise);
    if now.feed_per_min > bound * (1.0 + FEED_TOLERANCE) {
        return Some(format!("{} mm/min, bound to {bound}", now.feed_per_min));
    }
    let per_tooth = now.feed_per_min / (of.spindle? * f64::from(job.teeth));
    let (chip, target) = match job.law {
        "contour" if is_at_floor(job, per_tooth) || is_short(job, of, now) => return None,
        "contour" => (contour_chip(job, of, per_tooth), job.chip),
        "engagement" => (engagement_chip(job, of, per_tooth), job.chip),
        "engaged-arc" => (disc_chip(job, of, now.at, per_tooth)?, job.chip),
        "table" => (per_tooth, table_feed(&job.table, travelled(of, now.at))),
        // The simulator's meter has it.
        _ => return None,
    };
    let share = chip / target;
    (share > 1.0 + CHIP_TOLERANCE)
        .then(|| format!("chip {share} of its target {target} mm at {} mm/min", now.feed_per_min))
}

/// Violation by the chips that the simulator's meter measured, relative to their target; `at_floor` is the chip at the
/// floor of the law.
pub fn excess_of_meter(max_ratio: f64, at_floor: f64) -> Option<String> {
    (max_ratio > at_floor.max(1.0) * (1.0 + CHIP_TOLERANCE))
        .then(|| format!("chip {max_ratio} of its target on the meter"))
}

/// Chip at the contour, relative to its target, where the floor of the contour law holds the feed up; 0 under other laws.
pub fn chip_at_floor(job: &RandomJob, of: &Move) -> f64 {
    if job.law == "contour" { CONTOUR_FLOOR * contour_chip(job, of, 1.0) } else { 0.0 }
}

/// The centre's path per tooth, which no chip exceeds, is a fifth of the target or less.
fn is_at_floor(job: &RandomJob, per_tooth: f64) -> bool {
    per_tooth <= CONTOUR_FLOOR * job.chip * (1.0 + CHIP_TOLERANCE)
}

/// An arc that ends before axes with 5 m/s2 have braked to the feed of the law, at its programmed F or below.
fn is_short(job: &RandomJob, of: &Move, now: &Moment) -> bool {
    let Some(spindle) = of.spindle.filter(|_| of.arc.is_some()) else { return false };
    let per_tooth = job.chip / contour_chip(job, of, 1.0).max(1e-9);
    let wanted = spindle * f64::from(job.teeth) * per_tooth.max(CONTOUR_FLOOR * job.chip);
    let [programmed, wanted] = [of.feed / 60.0, wanted / 60.0];
    let braking = (programmed * programmed - wanted * wanted) / (2.0 * 5_000.0);
    wanted < programmed
        && path_length(of) < braking * (1.0 + FEED_TOLERANCE)
        && now.feed_per_min <= of.feed * (1.0 + FEED_TOLERANCE)
}

/// Advance of a tooth along the contour at the contact of the tool's side.
fn contour_chip(job: &RandomJob, of: &Move, per_tooth: f64) -> f64 {
    let Some(arc) = of.arc else { return per_tooth };
    let path = radius(of, &arc);
    if job.is_inside {
        per_tooth * (path + job.radius) / path
    } else {
        per_tooth * ((path - job.radius) / path).max(0.0)
    }
}

/// The thickest chip of a straight pass at this depth, over the share of the feed that the longer engagement in an inside corner
/// leaves.
fn engagement_chip(job: &RandomJob, of: &Move, per_tooth: f64) -> f64 {
    let (r, depth) = (job.radius, job.depth);
    let straight_chip = per_tooth * if depth < r { libm::sin(libm::acos(1.0 - depth / r)) } else { 1.0 };
    let Some(arc) = of.arc.filter(|_| job.is_inside) else { return straight_chip };
    let q = radius(of, &arc);
    let previous = q + r - depth;
    let straight = libm::acos(1.0 - depth / r);
    let turn = sweep(of, &arc);
    let ahead = (previous * previous + q * q - r * r) / (2.0 * q * previous);
    let engaged = if previous > 0.0 && (-1.0..=1.0).contains(&ahead) && libm::acos(ahead) <= turn {
        libm::acos((1.0 - depth * (2.0 * (q + r) - depth) / (2.0 * q * r)).clamp(-1.0, 1.0))
    } else {
        turn + libm::acos(((previous - q * libm::cos(turn)) / r).clamp(-1.0, 1.0))
    };
    straight_chip * (engaged.min(PI) / straight).max(1.0)
}

/// The thickest chip in a disc of material, direction by direction; none out of the cut.
fn disc_chip(job: &RandomJob, of: &Move, at: [f64; 3], per_tooth: f64) -> Option<f64> {
    let next = match of.arc {
        None => {
            let length = path_length(of);
            [0, 1].map(|axis| at[axis] + (of.to[axis] - of.from[axis]) * per_tooth / length)
        }
        Some(arc) => {
            let angle = per_tooth / radius(of, &arc) * if arc.is_ccw { 1.0 } else { -1.0 };
            let (sin, cos) = libm::sincos(angle);
            let [x, y] = [0, 1].map(|axis| at[axis] - arc.center[axis]);
            [arc.center[0] + x * cos - y * sin, arc.center[1] + x * sin + y * cos]
        }
    };
    let step = [next[0] - at[0], next[1] - at[1]];
    let directions = (0..720).map(|i| TAU * f64::from(i) / 720.0);
    let chips = directions.filter_map(|angle| {
        let (sin, cos) = libm::sincos(angle);
        let [x, y] = [at[0] + job.radius * cos - job.disc.0[0], at[1] + job.radius * sin - job.disc.0[1]];
        let along = step[0] * cos + step[1] * sin;
        let across = step[0] * sin - step[1] * cos;
        let reach = along + libm::sqrt((job.radius * job.radius - across * across).max(0.0));
        (libm::hypot(x, y) <= job.disc.1).then_some(reach - job.radius)
    });
    chips.reduce(f64::max)
}

/// Linear between rows, level beyond.
fn table_feed(rows: &[(f64, f64)], path: f64) -> f64 {
    let behind = rows.iter().position(|(at, _)| *at > path);
    match behind {
        Some(0) => rows[0].1,
        None => rows[rows.len() - 1].1,
        Some(next) => {
            let ((a, low), (b, high)) = (rows[next - 1], rows[next]);
            low + (high - low) * (path - a) / (b - a)
        }
    }
}

/// Path from the start, in the plane of an arc.
fn travelled(of: &Move, at: [f64; 3]) -> f64 {
    let Some(arc) = of.arc else { return distance(of.from, at) };
    radius(of, &arc) * turn(&arc, in_plane(of.from, arc.plane), in_plane(at, arc.plane))
}

fn sweep(of: &Move, arc: &ArcMove) -> f64 {
    let angle = turn(arc, in_plane(of.from, arc.plane), in_plane(of.to, arc.plane));
    if angle < 1e-9 { TAU } else { angle }
}

/// The angle between two points in the arc's sense, 0 to a whole turn.
fn turn(arc: &ArcMove, from: [f64; 2], to: [f64; 2]) -> f64 {
    let angle = |point: [f64; 2]| libm::atan2(point[1] - arc.center[1], point[0] - arc.center[0]);
    let turned = angle(to) - angle(from);
    (if arc.is_ccw { turned } else { -turned }).rem_euclid(TAU)
}

fn radius(of: &Move, arc: &ArcMove) -> f64 {
    let [x, y] = in_plane(of.from, arc.plane);
    libm::hypot(x - arc.center[0], y - arc.center[1])
}

fn path_length(of: &Move) -> f64 {
    match of.arc {
        None => distance(of.from, of.to),
        Some(arc) => radius(of, &arc) * sweep(of, &arc),
    }
}

pub fn in_plane(at: [f64; 3], plane: usize) -> [f64; 2] {
    let (first, second, _) = PLANES[plane];
    [at[first], at[second]]
}

pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| b[axis] - a[axis]);
    libm::hypot(libm::hypot(x, y), z)
}
