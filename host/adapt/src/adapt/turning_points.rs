//! Turning points of the circumference law's demand along an arc: directions of the tool's centre O from the rotation centre
//! A. Between two neighbouring ones the demand only rises, only falls, or is refused.
//!
//! The contact B lies on the stock line, at the distance s from A. The contact angle th is the angle at O in the triangle A O B:
//!
//! ```text
//! s^2 = rho^2 + r0^2 - 2 rho r0 cos(th)                                    (1)
//! ```
//!
//! The step depends on th alone, so on s alone (a, k, w as in `law::step`). It begins, ends or turns at
//!
//! ```text
//! ends of validity:          cos(th) = 1,  cos(th) = 0                     (2)
//! reach of the chip, D = 0:  cos(th) = (r0 + k w/(2 rho))/(r0 + k a)       (3)
//! the least step:            cos(th) = k a/(2 rho)                         (4)
//! ```
//!
//! (3) is a root of h^2 = p w. (4): the step turns where B moves square to the line from O' to C, which is then the chord, of
//! length a. s itself turns where B passes the foot of the perpendicular from A to the line: s = |offset| (5). At each of these
//! s the direction of O, counted from the line's normal, is
//!
//! ```text
//! +-t - sigma g,    cos(t) = offset/s,    cos(g) = (s^2 + rho^2 - r0^2)/(2 s rho)        (6)
//! ```
//!
//! with sigma = k on a counter-clockwise arc, -k on a clockwise one. The circle begins or ceases to meet the line at
//! +-acos((offset -+ r0)/rho) (7). Of two contacts the one with the smaller step counts; they change places at 0 and pi (8).
//! The smaller of two steps that each only rise or fall has no valley in between.
//!
//! Source: ours; docs/laws.md#turning-points.

use std::f64::consts::PI;

use arcfeed_law::SegmentLaw;
use arcfeed_law::circumference::ContactGeometry;

/// Error of a cosine: what f32 moves a turning point by, with much to spare.
const COSINE_ERROR: f64 = 1e-5;
/// Radii and the line's distance from A, over the larger radius, below which rounding may move a turning point by more.
const LENGTH_MIN_RATIO: f64 = 0.05;
/// Feed per tooth, over the smaller radius, above which (3) and (4) may have other roots.
const CHIP_MAX_RATIO: f64 = 0.1;

/// Range of angles in radians: from, to.
pub type AngleRange = [f64; 2];

/// Passes the turning points of the demand along an arc to `take`: directions from the rotation centre, as ranges of
/// angles from the plane's first axis, where the demand can begin, end, turn or jump. Between two neighbouring ones,
/// knots or ends, the demand only rises, only falls, or is refused. Returns false if the turning points of this law
/// are not known.
pub fn each(law: &SegmentLaw, take: &mut dyn FnMut(AngleRange)) -> bool {
    match law {
        SegmentLaw::Circumference(law) => each_of(&law.geometry(), take),
        SegmentLaw::EngagedArc(_) => false,
        // Straight between knots, or uniform.
        SegmentLaw::Table(_) | SegmentLaw::Contour(_) | SegmentLaw::Engagement(_) | SegmentLaw::Programmed => true,
    }
}

fn each_of(geometry: &ContactGeometry, take: &mut dyn FnMut(AngleRange)) -> bool {
    let ContactGeometry { path_radius_mm, edge_radius_mm, feed_per_tooth, offset_mm, .. } = *geometry;
    let [rho, r0, a, offset] = [path_radius_mm, edge_radius_mm, feed_per_tooth.0, offset_mm].map(f64::from);
    let k = f64::from(geometry.edge_sign);
    let [nx, ny] = geometry.normal.map(f64::from);
    let w = a * (2.0 * r0 + k * a);
    // NaN fails each of these comparisons.
    let is_plain = [rho, r0, libm::fabs(offset)].iter().all(|length| *length >= LENGTH_MIN_RATIO * rho.max(r0))
        && a > 0.0
        && a <= CHIP_MAX_RATIO * rho.min(r0)
        && libm::fabs(nx * nx + ny * ny - 1.0) <= COSINE_ERROR;
    if !is_plain {
        return false;
    }
    let normal_rad = libm::atan2(ny, nx);
    let mut on_both_sides = |[from, to]: AngleRange| {
        take([normal_rad + from, normal_rad + to]);
        take([normal_rad - to, normal_rad - from]);
    };
    [[0.0; 2], [PI; 2]].into_iter().for_each(&mut on_both_sides); // (8)
    for cosine in [(offset - r0) / rho, (offset + r0) / rho] {
        angles(cosine).into_iter().for_each(&mut on_both_sides); // (7)
    }
    let distance = |cosine: f64| libm::sqrt(rho * rho + r0 * r0 - 2.0 * rho * r0 * cosine); // (1)
    let within_reach = (r0 + k * w / (2.0 * rho)) / (r0 + k * a); // (3)
    let least_step = k * a / (2.0 * rho); // (4)
    let [recedes, beyond, reached, least] = [1.0, 0.0, within_reach, least_step].map(distance);
    for s in [recedes, beyond, reached, least, libm::fabs(offset)] {
        let Some([from, to]) = angles(offset / s) else { continue };
        let Some([narrow, wide]) = angles((s * s + rho * rho - r0 * r0) / (2.0 * s * rho)) else { continue };
        let [first, last] = if geometry.advance_sign > 0 { [-wide, -narrow] } else { [narrow, wide] };
        take([normal_rad + from + first, normal_rad + to + last]); // (6)
        take([normal_rad - to + first, normal_rad - from + last]);
    }
    true
}

/// The angles from 0 to pi with this cosine, give or take [`COSINE_ERROR`].
fn angles(cosine: f64) -> Option<AngleRange> {
    let is_cosine = libm::fabs(cosine) <= 1.0 + COSINE_ERROR;
    is_cosine.then(|| [cosine + COSINE_ERROR, cosine - COSINE_ERROR].map(|cosine| libm::acos(cosine.clamp(-1.0, 1.0))))
}
