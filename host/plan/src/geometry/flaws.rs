//! Flaws for which a rotor cannot be planned, with their place and size.
//!
//! ```text
//! k = H + sqrt(H^2 - K)     largest curvature towards the outward normal        (1)
//! H = (E N - 2 F M + G L) / (2 (E G - F^2)),   K = (L N - M^2) / (E G - F^2)    (2)
//! the offset by a crosses itself where k a >= 1                                 (3)
//! ```
//!
//! Source: M. P. do Carmo, *Differential Geometry of Curves and Surfaces*, 1976, section 3-3. Everything is looked for on samples of the
//! faces, and from the worst one by ever smaller steps: a flaw smaller than a sample may be missed.

use std::fmt;

use crate::vector::{Point, Vector};

use super::blisk::Blisk;
use super::face::{Face, Jet};

/// Samples along u and v.
const SAMPLES: [usize; 2] = [80, 16];

/// Largest gap between a blade's end and the hub, or the blank: the error of a polyline or of a file's digits.
const SLACK_MM: f64 = 0.05;

/// Least step of the search, as a fraction of a side.
const STEP_MIN: f64 = 1e-6;

/// Side of a blade.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BladeSide {
    /// Concave side.
    Pressure,
    /// Convex side.
    Suction,
}

/// Flaw for which a rotor cannot be planned. Positions on a side are `[u, v]`: u from the leading edge, v from the hub, 0 to
/// 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flaw {
    /// The surface with its allowance crosses itself, because the blade is hollow with a smaller radius than the allowance.
    Folded {
        /// Side of the blade.
        side: BladeSide,
        /// Position of the narrowest hollow.
        at: [f64; 2],
        /// Radius of the hollow, mm.
        radius_mm: f64,
        /// Allowance, mm.
        allowance_mm: f64,
    },
    /// Two blades are nearer to each other than twice the allowance.
    Near {
        /// Distance between the blades, mm.
        gap_mm: f64,
        /// Twice the allowance, mm.
        needed_mm: f64,
        /// Position on the pressure side.
        at: [f64; 2],
    },
    /// The blade does not reach the hub.
    Floating {
        /// Side.
        side: BladeSide,
        /// Place along the lowest section.
        u: f64,
        /// Height of its end above the hub, mm.
        height_mm: f64,
    },
    /// The blade does not fit into the blank.
    AboveBlank {
        /// Side.
        side: BladeSide,
        /// Place.
        at: [f64; 2],
        /// Distance by which it exceeds the blank's rim, mm.
        by_mm: f64,
    },
    /// The blade is wider than the blank.
    BesideBlank {
        /// Side.
        side: BladeSide,
        /// Place.
        at: [f64; 2],
        /// Distance by which it exceeds the blank's face, mm.
        by_mm: f64,
    },
    /// Sections cross, so that the side runs back towards the hub.
    Crossed {
        /// Side.
        side: BladeSide,
        /// Place.
        at: [f64; 2],
        /// Distance by which the side runs back, mm.
        back_mm: f64,
    },
    /// The two sides of the blade cross.
    InsideOut {
        /// Place on the pressure side.
        at: [f64; 2],
        /// Distance by which they cross, mm.
        by_mm: f64,
    },
}

impl fmt::Display for BladeSide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == BladeSide::Pressure { "pressure side" } else { "suction side" })
    }
}

/// Place on a side, in percent.
pub(super) fn shown([u, v]: [f64; 2]) -> String {
    format!("{:.0} % from the leading edge, {:.0} % from the hub", u * 100.0, v * 100.0)
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Flaw::Folded { side, at, radius_mm, allowance_mm } => write!(
                f,
                "the {side} is hollow with a radius of {radius_mm:.3} mm at {}; with an allowance of {allowance_mm:.3} mm its \
                 offset crosses itself there: leave less, or smooth the sections",
                shown(*at)
            ),
            Flaw::Near { gap_mm, needed_mm, at } => write!(
                f,
                "two blades are {gap_mm:.3} mm apart at {} of the pressure side; the allowances on both take {needed_mm:.3} mm",
                shown(*at)
            ),
            Flaw::Floating { side, u, height_mm } => write!(
                f,
                "the {side} ends {height_mm:.3} mm above the hub, {:.0} % from the leading edge; the lowest section must lie \
                 on the hub or below it",
                u * 100.0
            ),
            Flaw::AboveBlank { side, at, by_mm } => write!(
                f,
                "the {side} stands {by_mm:.3} mm out of the blank's rim at {}; the blank's `radius` is too small",
                shown(*at)
            ),
            Flaw::BesideBlank { side, at, by_mm } => write!(
                f,
                "the {side} stands {by_mm:.3} mm out of the blank's face at {}; the blank's `from` or `to` is too narrow",
                shown(*at)
            ),
            Flaw::Crossed { side, at, back_mm } => {
                write!(f, "sections cross: the {side} runs {back_mm:.3} mm back towards the hub at {}", shown(*at))
            }
            Flaw::InsideOut { at, by_mm } => {
                write!(f, "the sides of the blade cross by {by_mm:.3} mm at {} of the pressure side", shown(*at))
            }
        }
    }
}

/// All flaws of a rotor whose blades and hub are to keep this allowance; each kind is reported once for each side, where it is
/// worst.
pub fn flaws(blisk: &Blisk, allowance_mm: f64) -> Vec<Flaw> {
    let sides = [(BladeSide::Pressure, &blisk.pressure), (BladeSide::Suction, &blisk.suction)];
    let of_sides = sides.into_iter().flat_map(|(side, face)| {
        [
            folded(side, face, allowance_mm),
            floating(side, face, blisk),
            above(side, face, blisk),
            beside(side, face, blisk),
            crossed(side, face, blisk),
        ]
    });
    of_sides.chain([inside_out(blisk), near(blisk, allowance_mm)]).flatten().collect()
}

/// Largest curvature towards the outward normal, 1/mm; positive where the face is hollow.
pub fn hollowness_per_mm(face: &Face, u: f64, v: f64) -> f64 {
    let Jet { u: su, v: sv, uu, uv, vv, .. } = face.jet(u, v);
    let normal = face.normal(u, v);
    let [e, f, g] = [su.dot(&su), su.dot(&sv), sv.dot(&sv)];
    let [l, m, n] = [uu.dot(&normal), uv.dot(&normal), vv.dot(&normal)];
    let area = e * g - f * f;
    let mean = (e * n - 2.0 * f * m + g * l) / (2.0 * area); // (2)
    let gauss = (l * n - m * m) / area; // (2)
    mean + libm::sqrt((mean * mean - gauss).max(0.0)) // (1)
}

/// All samples of a side.
fn places() -> impl Iterator<Item = [f64; 2]> {
    let [along, across] = SAMPLES;
    (0..=along).flat_map(move |i| (0..=across).map(move |j| [i as f64 / along as f64, j as f64 / across as f64]))
}

/// Place and size of the maximum: the largest sample, improved by a local search.
fn worst(of: impl Fn([f64; 2]) -> f64) -> ([f64; 2], f64) {
    let found = places().map(|at| (at, of(at))).max_by(|a, b| a.1.total_cmp(&b.1));
    let mut best = found.unwrap_or(([0.0; 2], f64::NEG_INFINITY));
    let mut step = 1.0 / SAMPLES[1] as f64;
    while step > STEP_MIN {
        let ways = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]];
        let tries = ways.map(|way| [0, 1].map(|axis| (best.0[axis] + way[axis]).clamp(0.0, 1.0)));
        match tries.into_iter().map(|at| (at, of(at))).find(|tried| tried.1 > best.1) {
            Some(better) => best = better,
            None => step /= 2.0,
        }
    }
    best
}

fn folded(side: BladeSide, face: &Face, allowance_mm: f64) -> Option<Flaw> {
    let (at, per_mm) = worst(|[u, v]| hollowness_per_mm(face, u, v));
    let is_folded = per_mm * allowance_mm >= 1.0; // (3)
    is_folded.then_some(Flaw::Folded { side, at, radius_mm: 1.0 / per_mm, allowance_mm })
}

fn floating(side: BladeSide, face: &Face, blisk: &Blisk) -> Option<Flaw> {
    let ([u, _], height_mm) = worst(|[u, _]| blisk.hub.height_mm(&face.point(u, 0.0)));
    (height_mm > SLACK_MM).then_some(Flaw::Floating { side, u, height_mm })
}

fn above(side: BladeSide, face: &Face, blisk: &Blisk) -> Option<Flaw> {
    let out = |[u, v]: [f64; 2]| {
        let point = face.point(u, v);
        libm::hypot(point.x, point.y) - blisk.blank.radius_mm
    };
    let (at, by_mm) = worst(out);
    (by_mm > SLACK_MM).then_some(Flaw::AboveBlank { side, at, by_mm })
}

fn beside(side: BladeSide, face: &Face, blisk: &Blisk) -> Option<Flaw> {
    let [low_mm, high_mm] = blisk.blank.faces_mm;
    let (at, by_mm) = worst(|[u, v]| {
        let z_mm = face.point(u, v).z;
        (z_mm - high_mm).max(low_mm - z_mm)
    });
    (by_mm > SLACK_MM).then_some(Flaw::BesideBlank { side, at, by_mm })
}

fn crossed(side: BladeSide, face: &Face, blisk: &Blisk) -> Option<Flaw> {
    let step = 1.0 / SAMPLES[1] as f64;
    let (at, back_mm) = worst(|[u, v]| {
        let [here, next] = [v, (v + step).min(1.0)].map(|v| blisk.hub.height_mm(&face.point(u, v)));
        here - next
    });
    (back_mm > 0.0).then_some(Flaw::Crossed { side, at, back_mm })
}

fn inside_out(blisk: &Blisk) -> Option<Flaw> {
    let (at, by_mm) = worst(|[u, v]| {
        let across = blisk.suction.point(u, v) - blisk.pressure.point(u, v);
        across.dot(&blisk.pressure.normal(u, v))
    });
    (by_mm > SLACK_MM).then_some(Flaw::InsideOut { at, by_mm })
}

fn near(blisk: &Blisk, allowance_mm: f64) -> Option<Flaw> {
    let slot = blisk.slot();
    let (at, gap_mm) = nearest(&slot.pressure, &slot.suction);
    let needed_mm = 2.0 * allowance_mm;
    (gap_mm < needed_mm).then_some(Flaw::Near { gap_mm, needed_mm, at })
}

/// Least distance of two faces, mm, and its place on the first one.
pub fn nearest(one: &Face, other: &Face) -> ([f64; 2], f64) {
    let points = |face: &Face| places().map(|[u, v]| ([u, v], face.point(u, v))).collect::<Vec<([f64; 2], Point)>>();
    let others = points(other);
    let mut best = ([0.0; 4], f64::INFINITY);
    for ([u, v], point) in points(one) {
        for ([s, t], across) in &others {
            let squared = (across - point).norm_squared();
            if squared < best.1 {
                best = ([u, v, *s, *t], squared);
            }
        }
    }
    let gap = |[u, v, s, t]: [f64; 4]| -> f64 {
        let across: Vector = other.point(s, t) - one.point(u, v);
        across.norm_squared()
    };
    let mut step = 1.0 / SAMPLES[1] as f64;
    while step > STEP_MIN {
        let tries = (0..8).map(|k| {
            let mut place = best.0;
            let moved = place[k / 2] + if k % 2 == 0 { step } else { -step };
            place[k / 2] = moved.clamp(0.0, 1.0);
            (place, gap(place))
        });
        match tries.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|found| found.1 < best.1) {
            Some(found) => best = found,
            None => step /= 2.0,
        }
    }
    let [u, v, ..] = best.0;
    ([u, v], libm::sqrt(best.1))
}
