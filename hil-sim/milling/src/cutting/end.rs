//! The edge on the end of a tooth: a line from an inner to an outer radius, square to the axis.
//!
//! The edge turns over a floor and lowers it to the height of the tip. Its chip is the part of the floor above that
//! height, measured in the material's columns ([`super::partial_heights`]), which contain everything that earlier
//! teeth, a hole, or a pause in the feed have left. In front of the tool, where no end edge has cut yet, columns are as
//! high as the wall and belong to the side edges. The border between both is the highest position of the tip since the
//! tooth before: a floor that the tip has passed is no higher, and everything higher is no floor. Further inside than
//! the side edges reach, all material belongs to the end edge.
//!
//! ```text
//! h(r) = top(r) - tip               where tip < top <= border, else 0                                     (1)
//! dT = r dFt(h, dr)                 about the axis; the normal points down, so Fr pushes the tool up      (2)
//! sum h dr r dtheta = what the step takes                                                                 (3)
//! ```
//!
//! The chip is measured on the bisector of the sector that a step sweeps, at the height of the step's end, on the rays
//! that cross the bisector at the larger angle, each for the part of the edge nearest to it. So (3) is exact if the
//! sector has the same height everywhere, and right to half a cell at a border. With linear coefficients without edge
//! forces, torque times angle is then the tangential coefficient times the volume.
//!
//! The edge is straight and level (no helix, no dish) and cuts up to its inner radius: up to the axis on an end mill.
//! In reality nothing cuts there, because the speed is zero; the tool pushes material aside with a thrust that no
//! coefficient here includes.
//!
//! Source: own.

use arcfeed_model::tool::Edge;
use nalgebra::Vector2;

use super::edges::{Cutter, EdgePiece};
use super::layer::{Layer, is_beside};
use super::layers::Layers;
use super::material::ChipSection;
use super::partial_heights::DepthBand;

/// Inverse of the rounding step of a ratio.
const CHORD_DIGITS: f64 = 1e9;

/// Cutting edge on the end of a tool, of one tooth: a radial line, square to the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndEdge {
    /// Piece at the outer end of the edge; its normal points straight down.
    pub piece: EdgePiece,
    /// Radius of the inner end of the edge; 0 if it reaches the axis.
    pub inner_mm: f64,
}

/// Position of an edge in the plane of the layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgePose {
    /// Position of the tool's axis.
    pub center_mm: Vector2<f64>,
    /// Direction from the axis along the edge, a unit vector.
    pub towards: Vector2<f64>,
}

/// Descent of the tool's tip since the tooth before; it decides what the end edges cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Descent {
    /// Present height of the tip, in the height coordinate of the layers.
    pub tip_mm: f64,
    /// Highest position of the tip since the tooth before: end edges cut material up to this height, side edges the material above.
    pub border_mm: f64,
    /// Depth of the side edges' rake faces: further inside than that, all material belongs to the end edge.
    pub side_mm: f64,
}

/// A part of the edge, from an inner to an outer radius, with its depth bands of the layers.
type RadialBand = ([f64; 2], Vec<(usize, DepthBand)>);

impl EdgePose {
    /// Points at two distances from the axis.
    fn ends_mm(&self, radii_mm: [f64; 2]) -> [Vector2<f64>; 2] {
        radii_mm.map(|radius_mm| self.center_mm + self.towards * radius_mm)
    }
}

impl Descent {
    /// Whether the tip is lower than at the tooth before, so that the end edges have a floor to cut.
    pub fn lowers(&self) -> bool {
        self.border_mm > self.tip_mm
    }
}

impl EndEdge {
    /// End edge of each tooth of a cutter: from the radius of the tooth's lowest piece to the axis or, on a ring, to the edges on the
    /// ring's other side.
    pub fn all(cutter: &Cutter) -> Vec<EndEdge> {
        let lowest = |tooth: usize| {
            let of_tooth = cutter.pieces().iter().filter(|piece| piece.tooth == tooth);
            of_tooth.min_by(|a, b| a.height_mm.total_cmp(&b.height_mm)).copied()
        };
        let lowest: Vec<EdgePiece> = (0..cutter.teeth()).filter_map(lowest).collect();
        let radii = |side: Edge| lowest.iter().filter(move |piece| piece.side == side).map(|piece| piece.radius_mm);
        let innermost_mm = radii(Edge::Inner).reduce(f64::min).unwrap_or(0.0);
        let outermost_mm = radii(Edge::Outer).fold(0.0, f64::max);
        let end = |piece: &EdgePiece| {
            let [inner_mm, radius_mm] = match piece.side {
                Edge::Outer => [innermost_mm, piece.radius_mm],
                Edge::Inner => [piece.radius_mm, outermost_mm],
            };
            let piece =
                EdgePiece { height_mm: 0.0, rise_mm: 0.0, lead_rad: 0.0, side: Edge::Outer, radius_mm, ..*piece };
            EndEdge { piece, inner_mm }
        };
        lowest.iter().map(end).filter(|end| end.inner_mm < end.piece.radius_mm).collect()
    }

    /// Radius of the middle of the edge, mm.
    pub fn middle_mm(&self) -> f64 {
        (self.inner_mm + self.piece.radius_mm) / 2.0
    }

    /// Chips in front of the edge on its step between these two poses, each with the part of the edge that cuts it; parts without
    /// material have a chip of thickness 0. Empty if the edge cannot meet material. (1)
    pub fn chips(&self, poses: [&EdgePose; 2], descent: &Descent, layers: &Layers) -> Vec<(EdgePiece, ChipSection)> {
        if !self.may_meet(poses, descent, layers) {
            return Vec::new();
        }
        let bands = self.bands(descent, layers);
        let first = bands.iter().flat_map(|(_, depth_bands)| depth_bands).next();
        let Some(grid) = first.map(|(index, _)| &layers.layers()[*index]) else { return Vec::new() };
        let center_mm = (poses[0].center_mm + poses[1].center_mm) / 2.0;
        let towards = (poses[0].towards + poses[1].towards).normalize();
        let axis = usize::from(libm::fabs(towards.x) > libm::fabs(towards.y));
        let chip = |(at_mm, [from_mm, to_mm]): (f64, [f64; 2])| {
            let depth_bands =
                bands.iter().find(|([_, outer_mm], _)| at_mm <= *outer_mm).map(|(_, depth_bands)| depth_bands);
            let place_mm = center_mm + towards * at_mm;
            let of_layer = |(index, depth_band): &(usize, DepthBand)| {
                let top_ratio = layers.layers()[*index].top_ratio(place_mm, axis);
                top_ratio.map_or(0.0, |top_ratio| depth_band.cut_ratio(top_ratio)) * layers.rise_mm()
            };
            let thickness_mm = depth_bands.into_iter().flatten().map(of_layer).sum();
            let radius_mm = (from_mm + to_mm) / 2.0;
            (EdgePiece { radius_mm, ..self.piece }, ChipSection { thickness_mm, width_mm: to_mm - from_mm })
        };
        let parts = self.parts(grid, axis, [center_mm, towards]);
        parts.into_iter().map(chip).collect()
    }

    /// Parts of the edge nearest to each of the rays that it crosses: the radius of the crossing, and the part's inner
    /// and outer radius.
    fn parts(&self, grid: &Layer, axis: usize, [center_mm, towards]: [Vector2<f64>; 2]) -> Vec<(f64, [f64; 2])> {
        let ends_mm = [self.inner_mm, self.piece.radius_mm];
        let [from, to] = ends_mm.map(|mm| grid.index(axis, (center_mm + towards * mm)[1 - axis]));
        let at_mm = |ray: i64| ends_mm[0] + (ends_mm[1] - ends_mm[0]) * (ray as f64 - from) / (to - from);
        let mut rays_mm: Vec<f64> = (from.min(to).ceil() as i64..=from.max(to).floor() as i64).map(at_mm).collect();
        if rays_mm.is_empty() {
            rays_mm.push((ends_mm[0] + ends_mm[1]) / 2.0);
        }
        rays_mm.sort_unstable_by(f64::total_cmp);
        let half_way_mm = rays_mm.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
        let borders_mm: Vec<f64> = [ends_mm[0]].into_iter().chain(half_way_mm).chain([ends_mm[1]]).collect();
        rays_mm.into_iter().zip(borders_mm.windows(2).map(|pair| [pair[0], pair[1]])).collect()
    }

    /// Moves the edge from the first pose to the second and removes the floor that it sweeps; returns the removed volume, mm3, as
    /// measured by the rays along each of the two axes of the layers.
    pub fn cut(&self, poses: [&EdgePose; 2], descent: &Descent, layers: &mut Layers) -> [f64; 2] {
        if !self.may_meet(poses, descent, layers) {
            return [0.0; 2];
        }
        let angle_rad =
            libm::fabs(libm::atan2(poses[0].towards.perp(&poses[1].towards), poses[0].towards.dot(&poses[1].towards)));
        // The innermost end moves along a chord that encloses as much of the sector as its arc. It is rounded so that
        // equal steps share their ends.
        let chord_ratio = libm::round((1.0 + angle_rad * angle_rad / 12.0) * CHORD_DIGITS) / CHORD_DIGITS;
        let (mut sum_mm3, rise_mm) = ([0.0; 2], layers.rise_mm());
        for ([inner_mm, outer_mm], depth_bands) in self.bands(descent, layers) {
            let [is_innermost, is_outermost] = [inner_mm == self.inner_mm, outer_mm == self.piece.radius_mm];
            let inner_mm = if is_innermost { inner_mm * chord_ratio } else { inner_mm };
            let [[root, from], [last_root, to]] = poses.map(|edge_pose| edge_pose.ends_mm([inner_mm, outer_mm]));
            for (index, depth_band) in &depth_bands {
                let layer = &mut layers.layers_mut()[*index];
                let area_mm2 = match is_outermost {
                    true => layer.clear_strip([[root, from], [last_root, to]], outer_mm, depth_band),
                    false => layer.clear_band(&[root, from, to, last_root], depth_band),
                };
                sum_mm3 = [0, 1].map(|axis: usize| sum_mm3[axis] + area_mm2[axis] * rise_mm);
            }
        }
        sum_mm3
    }

    /// Whether there is a floor to lower and the swept area is over the layers.
    fn may_meet(&self, poses: [&EdgePose; 2], descent: &Descent, layers: &Layers) -> bool {
        let is_over = |extent_mm: [[f64; 2]; 2]| {
            let [[root, from], [last_root, to]] =
                poses.map(|edge_pose| edge_pose.ends_mm([self.inner_mm, self.piece.radius_mm]));
            !is_beside(&[root, from, to, last_root], &extent_mm)
        };
        descent.lowers() && layers.extent_mm().is_some_and(is_over)
    }

    /// Bands of the edge, from its inner end outwards.
    fn bands(&self, descent: &Descent, layers: &Layers) -> Vec<RadialBand> {
        let [inner_mm, outer_mm] = [self.inner_mm, self.piece.radius_mm];
        let (floor, all) =
            (depth_bands(descent, descent.border_mm, layers), depth_bands(descent, f64::INFINITY, layers));
        // An edge that ends on the axis has no side edge there.
        let from_mm = if inner_mm > 0.0 { inner_mm + descent.side_mm } else { 0.0 };
        let to_mm = outer_mm - descent.side_mm;
        if from_mm >= to_mm {
            return vec![([inner_mm, outer_mm], floor)];
        }
        let bands = [([inner_mm, from_mm], floor.clone()), ([from_mm, to_mm], all), ([to_mm, outer_mm], floor)];
        bands.into_iter().filter(|([from_mm, to_mm], _)| from_mm < to_mm).collect()
    }
}

/// Depth bands of the end edge in the layers, up to a border, but not beyond the layer above the highest position of
/// the tip since the tooth before.
fn depth_bands(descent: &Descent, border_mm: f64, layers: &Layers) -> Vec<(usize, DepthBand)> {
    let depth_band = |nth: i64| {
        let [foot_ratio, border_ratio] = [descent.tip_mm, border_mm].map(|mm| layers.part_ratio(nth, mm));
        Some((layers.place(nth)?, DepthBand { foot_ratio, border_ratio, is_end: true }))
    };
    (layers.nth(descent.tip_mm)..=layers.nth(descent.border_mm) + 1).filter_map(depth_band).collect()
}
