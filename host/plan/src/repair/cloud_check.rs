//! Checks of measured points against the part that is to be repaired: outliers, and weld in front of what is planned.

use super::blade::{CloudFault, NominalBlade};
use super::scan::{HeightSample, NominalSurface};
use crate::geometry::edge_strip::BladeEdge;
use crate::geometry::flaws::BladeSide;
use crate::parallel;
use crate::vector::Point;

/// Most points that are examined for outliers; of more points every k-th is taken.
const EXAMINED_MAX: usize = 20_000;
/// Share of outliers up to which a measurement is used.
const OUTLIERS_MAX_RATIO: f64 = 0.02;
/// Points in front of an edge that are no outliers.
const WELD_POINTS: usize = 3;

/// Checks that no point stands higher beyond the tip of the part to be repaired than `most_mm`.
///
/// # Errors
/// Names the highest one.
pub fn check_tip(points: &[Point], nominal: &NominalSurface<'_>, most_mm: f64) -> Result<(), CloudFault> {
    let over = |point: &Point| {
        let beyond_mm = nominal.beyond_tip_mm(point).filter(|beyond_mm| *beyond_mm > most_mm)?;
        Some((beyond_mm, *point))
    };
    match parallel::filter_map(points, &over).into_iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((beyond_mm, point)) => Err(CloudFault::OverTip { beyond_mm, point }),
        None => Ok(()),
    }
}

/// Checks that no weld stands higher than `most_mm` in front of an edge of a side that is repaired alone: the mill would cut it at the ends of its passes, and no
/// layer is planned for it.
///
/// # Errors
/// Names the edge and the highest point.
pub fn check_edges(
    points: &[Point],
    blade: &NominalBlade<'_>,
    side: BladeSide,
    most_mm: f64,
) -> Result<(), CloudFault> {
    let (word, other) = match side {
        BladeSide::Pressure => ("pressure", blade.side(BladeSide::Suction)),
        BladeSide::Suction => ("suction", blade.side(BladeSide::Pressure)),
    };
    let own = blade.side(side);
    let in_front = |point: &Point| {
        let foot = own.edge_foot(point)?;
        let (edge, sign) = if foot.at[1] > 0.5 { (BladeEdge::Trailing, 1.0) } else { (BladeEdge::Leading, -1.0) };
        let across = other.foot(point);
        let is_on_other = !across.is_on_border && across.distance_mm <= foot.distance_mm;
        // In front of a rounding is what stands along the normal in which the side ends, in front of a sharp edge what stands along the side.
        let direction = match is_on_other {
            true => own.surface().point_and_normal(foot.at).1,
            false => own.surface().jet(foot.at).v.normalize() * sign,
        };
        let beyond_mm = direction.dot(&(point - foot.point));
        (beyond_mm > most_mm).then_some((beyond_mm, *point, edge))
    };
    let found = parallel::filter_map(points, &in_front);
    match found.iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((beyond_mm, point, edge)) if found.len() >= WELD_POINTS => {
            let edge = if *edge == BladeEdge::Leading { "leading" } else { "trailing" };
            Err(CloudFault::OverEdge { beyond_mm: *beyond_mm, point: *point, edge, side: word })
        }
        _ => Ok(()),
    }
}

/// Checks that few samples lie farther outside of the heights of their neighbours than `off_mm`.
///
/// # Errors
/// Counts them, and names the farthest one.
pub fn check_outliers(samples: &[HeightSample], nominal: &NominalSurface<'_>, off_mm: f64) -> Result<(), CloudFault> {
    let every = samples.len().div_ceil(EXAMINED_MAX).max(1);
    let examined: Vec<HeightSample> = samples.iter().step_by(every).copied().collect();
    let heights = nominal.height_field(&examined, 0.0);
    let apart = |sample: &HeightSample| {
        let apart_mm = heights.apart_mm(sample);
        (apart_mm > off_mm).then_some((apart_mm, *sample))
    };
    let outliers = parallel::filter_map(&examined, &apart);
    match outliers.iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((apart_mm, farthest)) if outliers.len() as f64 > OUTLIERS_MAX_RATIO * examined.len() as f64 => {
            let (point, normal) = nominal.surface().point_and_normal(farthest.at);
            Err(CloudFault::Outliers {
                percent: 100.0 * outliers.len() as f64 / examined.len() as f64,
                off_mm,
                apart_mm: *apart_mm,
                point: point + normal * farthest.height_mm,
            })
        }
        _ => Ok(()),
    }
}
