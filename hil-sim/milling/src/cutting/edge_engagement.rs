//! Engagement of all edges of a cutter in the layers of a workpiece: the chip in front of each edge, and the material
//! it removes.
//!
//! The cutter's axis is square to the layers. A piece of an edge meets one layer. The material in front of it is what
//! the edge itself, the other teeth, earlier passes and vibration have left; no formula is involved. The lowest pieces
//! reach no deeper into their layer than the tip; the edges on the tool's end ([`super::end`]) remove what the tip
//! descends on.
//!
//! A rounded corner is a staircase. When the tip enters the next layer, its steps meet material from above, which
//! belongs to no edge and is removed without chips ([`EdgeEngagement::enter`]); so is the material that a rapid removes
//! ([`EdgeEngagement::clear_at`]).

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::fmt;

use arcfeed_model::tool::Edge;
use nalgebra::{Vector2, Vector3};

use super::edge_element::EdgeHistory;
use super::edges::{Cutter, EdgePiece};
use super::end::{Descent, EdgePose, EndEdge};
use super::layers::{LEVEL_RATIO, Layers, Slice};
use super::material::ChipSection;
use super::partial_heights::DepthBand;
use super::pose::{EdgePoses, Placed, ToolPose, element, towards};

/// Relative difference of slice and layer heights that counts as rounding.
const RISE_TOLERANCE_RATIO: f64 = 1e-9;

/// Smallest part of a layer's height that must be below the highest evaluated place of the cutter for its edges to cut in that
/// layer. A layer with less is not cut at all. A layer with more is cut over its whole height, because columns are
/// cut from above, but its chips are no higher than that place.
pub const REACHED_RATIO: f64 = 0.5;

/// Motion of the tip below this is rounding.
const STILL_MM: f64 = 1e-9;

/// Cutter in a workpiece that is divided into layers; finds which edges cut, their chips, and the material that they remove.
#[derive(Clone, Debug)]
pub struct EdgeEngagement {
    cutter: Cutter,
    layers: Layers,
    depth_mm: f64,
    /// Height above the tip up to which edges are evaluated.
    reach_mm: f64,
    /// For each piece: the layer it was in, and its history.
    histories: Vec<(Option<usize>, EdgeHistory)>,
    /// The solid that the edges turn, from the tip upwards.
    slices: Vec<Slice>,
    /// For each piece: its slice, the sine of its lead angle, and its width.
    slice_of: Vec<usize>,
    sines: Vec<f64>,
    widths_mm: Vec<f64>,
    ends: Vec<EndEdge>,
    /// For each edge, the first edge at the same angle.
    same_angle: Vec<usize>,
    /// Last position of each end edge.
    end_edge_poses: Vec<Option<EdgePose>>,
    tips: Tips,
}

/// Chip in front of one edge at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeChip {
    /// Number of the edge: first the cutter's pieces, in their order, then the end edges tooth by tooth.
    pub edge: usize,
    /// Piece of the cutter that cuts the chip; for an edge on the tool's end, the part of it that cuts.
    pub piece: EdgePiece,
    /// Thickness and width of the chip.
    pub section: ChipSection,
}

/// Highest position of the tip during the last tooth period.
#[derive(Clone, Debug)]
struct Tips {
    /// The largest angle from one tooth to the next.
    window_rad: f64,
    turned_rad: f64,
    /// Positions of the tip with the angle turned then; only those that no later one exceeds, so the first is the
    /// highest.
    passed: VecDeque<(f64, f64)>,
    /// Last position of the tip, and the spindle's angle.
    last: Option<(f64, f64)>,
}

/// Reason why a cutter cannot be combined with these layers of a workpiece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EdgeEngagementError {
    /// A piece of an edge differs in height from a layer: two pieces in one layer would cut it twice, or layers would
    /// be left out.
    Slice {
        /// Height of the piece.
        rise_mm: f64,
        /// Height of a layer.
        layer_mm: f64,
    },
    /// The depth of the rake faces is not a positive number.
    Depth {
        /// Given depth.
        depth_mm: f64,
    },
}

impl fmt::Display for EdgeEngagementError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EdgeEngagementError::Slice { rise_mm, layer_mm } => {
                write!(f, "layers of {layer_mm} mm need edges in slices of the same height, not of {rise_mm} mm")
            }
            EdgeEngagementError::Depth { depth_mm } => write!(f, "rake faces {depth_mm} mm deep take no chip"),
        }
    }
}

impl std::error::Error for EdgeEngagementError {}

impl EdgeEngagement {
    /// Combines a cutter with a workpiece. `depth_mm` is the depth of the rake faces behind their edges; it must be larger than any
    /// chip thickness, because only material that deep is removed.
    ///
    /// # Errors
    /// A piece of an edge is not as high as a layer, or `depth_mm` is not a positive number.
    pub fn new(cutter: Cutter, layers: Layers, depth_mm: f64) -> Result<Self, EdgeEngagementError> {
        if !(depth_mm > 0.0 && depth_mm.is_finite()) {
            return Err(EdgeEngagementError::Depth { depth_mm });
        }
        let layer_mm = layers.rise_mm();
        let is_slice = |rise_mm: f64| libm::fabs(rise_mm - layer_mm) <= RISE_TOLERANCE_RATIO * layer_mm;
        if let Some(piece) = cutter.pieces().iter().find(|piece| !is_slice(piece.rise_mm)) {
            return Err(EdgeEngagementError::Slice { rise_mm: piece.rise_mm, layer_mm });
        }
        let (histories, slices, ends) =
            (vec![Default::default(); cutter.pieces().len()], slices(&cutter), EndEdge::all(&cutter));
        let of_piece = |piece: &EdgePiece| slices.iter().position(|slice| slice.height_mm == piece.height_mm);
        let slice_of = cutter.pieces().iter().filter_map(of_piece).collect();
        let sines = cutter.pieces().iter().map(|piece| libm::sin(piece.lead_rad)).collect();
        let widths_mm = cutter.pieces().iter().map(EdgePiece::width_mm).collect();
        let angles: Vec<f64> =
            cutter.pieces().iter().chain(ends.iter().map(|end| &end.piece)).map(|piece| piece.angle_rad).collect();
        let first = |angle: &f64| angles.iter().position(|other| other == angle).unwrap_or(usize::MAX);
        let same_angle = angles.iter().map(first).collect();
        let (end_edge_poses, tips) = (vec![None; ends.len()], Tips::new(&ends));
        let reach_mm = slices.len() as f64 * layer_mm;
        Ok(EdgeEngagement {
            cutter,
            layers,
            depth_mm,
            reach_mm,
            histories,
            slices,
            slice_of,
            sines,
            widths_mm,
            ends,
            same_angle,
            end_edge_poses,
            tips,
        })
    }

    /// Limits the evaluated edges to those up to `reach_mm` above the tip. The cutter should be one slice higher than that, so that the
    /// same height is evaluated when the tip is inside a layer.
    pub fn up_to_mm(self, reach_mm: f64) -> Self {
        EdgeEngagement { reach_mm, ..self }
    }

    /// Cutter with its edge pieces.
    pub fn cutter(&self) -> &Cutter {
        &self.cutter
    }

    /// Remaining workpiece.
    pub fn layers(&self) -> &Layers {
        &self.layers
    }

    /// Remaining workpiece, whose layers may get other material. The tool must be out of the cut ([`EdgeEngagement::lift`]) where it
    /// stands.
    pub fn layers_mut(&mut self) -> &mut Layers {
        &mut self.layers
    }

    /// Heights between which the cutter can touch layers with its tip at `tip_mm`.
    pub fn heights_mm(&self, tip_mm: f64) -> [f64; 2] {
        let rise_mm = self.layers.rise_mm();
        [tip_mm - rise_mm, tip_mm + (self.slices.len() + 1) as f64 * rise_mm]
    }

    /// Number of edges: the pieces of the cutter, one after the other, then those on its end.
    pub fn edges(&self) -> usize {
        self.histories.len() + self.ends.len()
    }

    /// Positions of all edges for a pose of the tool, without deflection of the tool.
    pub fn poses(&self, pose: &ToolPose) -> EdgePoses {
        let descent = self.descent(pose);
        let placed = self.slices.iter().map(|slice| self.placed(slice.height_mm, &descent)).collect();
        let pieces = self.cutter.pieces().iter().chain(self.ends.iter().map(|end| &end.piece));
        let mut directions: Vec<Vector2<f64>> = Vec::with_capacity(self.edges());
        for (piece, first) in pieces.zip(&self.same_angle) {
            directions.push(directions.get(*first).map_or_else(|| towards(piece, pose), Vector2::clone));
        }
        EdgePoses { pose: *pose, descent, towards: directions, placed, is_apart: vec![false; self.edges()] }
    }

    /// Middle of one edge element, mm: X and Y in the plane of the layers, Z as the height along the tool's axis from the same zero as
    /// that of the layers. Without deflection.
    pub fn edge_mm(&self, edge: usize, at: &EdgePoses) -> Vector3<f64> {
        let (height_mm, radius_mm) = match edge.checked_sub(self.histories.len()) {
            None => (self.cutter.pieces()[edge].height_mm, self.cutter.pieces()[edge].radius_mm),
            Some(end) => (self.ends[end].piece.height_mm, self.ends[end].middle_mm()),
        };
        let EdgePose { center_mm, towards } = at.edge_pose(edge, Vector2::zeros());
        let place_mm = center_mm + towards * radius_mm;
        Vector3::new(place_mm.x, place_mm.y, at.pose.tip_mm + height_mm)
    }

    /// Whether an edge, displaced by `bent_mm`, may have a chip: whether there is material around it, on its path since the last step, or
    /// within `margin_mm` of both. For an edge on the tool's end: whether the tip descends.
    pub fn is_near(&self, edge: usize, at: &EdgePoses, bent_mm: Vector2<f64>, margin_mm: f64) -> bool {
        let Some(piece) = self.cutter.pieces().get(edge) else { return at.descent.lowers() };
        let Some(placed) = &at.placed[self.slice_of[edge]] else { return false };
        let element = element(piece, self.depth_mm, at.edge_pose(edge, bent_mm), &placed.depth_band);
        let (layer, (_, history)) = (&self.layers.layers()[placed.index], &self.histories[edge]);
        history.has_left(&element, layer)
            || element.is_near(layer, margin_mm + history.way_mm(&element) + layer.step_mm())
    }

    /// Chips in front of all edges at these positions: one for every edge that is in a layer (of thickness 0 without material), and one
    /// for every part of an end edge that has a floor below it. `bent` returns the displacement, mm, of the edge with a given number.
    pub fn chips<'a>(
        &'a mut self,
        at: &'a EdgePoses,
        bent: impl Fn(usize) -> Vector2<f64> + Copy + 'a,
    ) -> impl Iterator<Item = EdgeChip> + 'a {
        let Self { cutter, layers, depth_mm, histories, slice_of, sines, widths_mm, ends, end_edge_poses, .. } = self;
        let (layers, depth_mm, first_end) = (&*layers, *depth_mm, histories.len());
        let of_end = move |(edge, (end, last)): (usize, (&EndEdge, &Option<EdgePose>))| {
            let edge_pose = at.edge_pose(edge, bent(edge));
            let chips = last.map_or_else(Vec::new, |last| end.chips([&last, &edge_pose], &at.descent, layers));
            chips.into_iter().map(move |(piece, section)| EdgeChip { edge, piece, section })
        };
        let side = cutter.pieces().iter().zip(histories).enumerate();
        let side = side.filter_map(move |(edge, (piece, (was_in, history)))| {
            let placed = at.placed[slice_of[edge]].as_ref().filter(|_| !at.is_apart[edge])?;
            let layer = &layers.layers()[placed.index];
            let element = element(piece, depth_mm, at.edge_pose(edge, bent(edge)), &placed.depth_band);
            let front = match *was_in == Some(placed.index) {
                true => history.front(&element, layer),
                false => history.in_other_layer().front(&element, layer),
            };
            // The chip is measured across the circle; its thickness is square to the edge.
            let thickness_mm = front.thickness_mm * sines[edge];
            let height_ratio = front.top_ratio.min(placed.reach_ratio) - placed.depth_band.foot_ratio;
            let section = ChipSection { thickness_mm, width_mm: widths_mm[edge] * height_ratio };
            Some(EdgeChip { edge, piece: *piece, section })
        });
        side.chain((first_end..).zip(ends.iter().zip(end_edge_poses.iter())).flat_map(of_end))
    }

    /// Moves the cutter to its next position, less than a quarter of a turn on, and removes the material that the edges sweep. Returns
    /// the removed volume, mm3, as measured by the rays along each of the two axes of the layers.
    pub fn cut(&mut self, at: &EdgePoses, bent: impl Fn(usize) -> Vector2<f64>) -> [f64; 2] {
        let mut removed_mm3 = [0.0; 2];
        let mut add = |mm3: [f64; 2]| removed_mm3 = [0, 1].map(|axis: usize| removed_mm3[axis] + mm3[axis]);
        let rise_mm = self.layers.rise_mm();
        for (edge, (piece, (was_in, history))) in self.cutter.pieces().iter().zip(&mut self.histories).enumerate() {
            let placed = at.placed[self.slice_of[edge]].as_ref();
            let index = placed.map(|placed| placed.index);
            let depth_band = placed.map_or(&DepthBand::ALL, |placed| &placed.depth_band);
            let element = element(piece, self.depth_mm, at.edge_pose(edge, bent(edge)), depth_band);
            if std::mem::replace(was_in, index) != index {
                *history = history.in_other_layer();
            }
            match index.filter(|_| !at.is_apart[edge]).and_then(|index| self.layers.layers_mut().get_mut(index)) {
                None => history.move_without_cut(&element),
                Some(layer) => add(history.cut(&element, layer).map(|mm2| mm2 * rise_mm)),
            }
        }
        for (edge, (end, last)) in (self.histories.len()..).zip(self.ends.iter().zip(&mut self.end_edge_poses)) {
            let edge_pose = at.edge_pose(edge, bent(edge));
            if let Some(last) = last.replace(edge_pose) {
                add(end.cut([&last, &edge_pose], &at.descent, &mut self.layers));
            }
        }
        self.tips.add(&at.pose);
        removed_mm3
    }

    /// Whether any edge is at the height of a layer when the tip is at `tip_mm`, or up to `above_mm` deeper.
    pub fn is_in(&self, tip_mm: f64, above_mm: f64) -> bool {
        let [first, last] = [tip_mm - above_mm, tip_mm + self.reach_mm].map(|mm| self.layers.nth(mm));
        last >= 0 && self.layers.place(first.max(0)).is_some()
    }

    /// Whether the tip would be lower at this pose than now, apart from rounding.
    pub fn descends(&self, pose: &ToolPose) -> bool {
        self.tips.last.is_some_and(|(tip_mm, _)| pose.tip_mm < tip_mm - STILL_MM)
    }

    /// Removes, without chips, the material that no edge would cut when the cutter moves to `pose`. If it has not cut before, that is
    /// all material at its position. If the tip enters another layer, it is the material above the steps by which
    /// slices represent a rounded corner.
    pub fn enter(&mut self, pose: &ToolPose) {
        let Some(last_mm) = self.tips.last.map(|(tip_mm, _)| tip_mm) else { return self.clear_at(pose) };
        let nth = self.layers.nth(pose.tip_mm);
        if nth == self.layers.nth(last_mm) {
            return;
        }
        let foot = self.slices[0];
        for (slice, up) in self.slices.iter().zip(0..).skip(1) {
            let Some(index) = self.layers.place(nth + up) else { continue };
            let layer = &mut self.layers.layers_mut()[index];
            for [inner_mm, outer_mm] in [[slice.inner_mm, foot.inner_mm], [foot.outer_mm, slice.outer_mm]] {
                if inner_mm < outer_mm {
                    layer.clear_ring(pose.axis_mm, inner_mm, outer_mm);
                }
            }
        }
    }

    /// Removes all material inside the tool at this pose, without chips.
    pub fn clear_at(&mut self, pose: &ToolPose) {
        let nth = self.layers.nth(pose.tip_mm);
        for (slice, up) in self.slices.iter().zip(0..) {
            if let Some(index) = self.layers.place(nth + up) {
                self.layers.layers_mut()[index].clear_ring(pose.axis_mm, slice.inner_mm, slice.outer_mm);
            }
        }
    }

    /// Takes the tool out of the cut: all edges forget their last position and the surface that they passed.
    pub fn lift(&mut self) {
        self.histories.fill(Default::default());
        self.end_edge_poses.fill(None);
        self.tips = Tips::new(&self.ends);
    }

    fn descent(&self, pose: &ToolPose) -> Descent {
        let highest_mm = self.tips.passed.front().map_or(pose.tip_mm, |(tip_mm, _)| *tip_mm);
        let border_mm = if highest_mm > pose.tip_mm + STILL_MM { highest_mm } else { pose.tip_mm };
        Descent { tip_mm: pose.tip_mm, border_mm, side_mm: self.depth_mm }
    }

    /// Layer of a slice: the lowest slice is in the layer of the tip, the others one by one above it.
    fn placed(&self, height_mm: f64, descent: &Descent) -> Option<Placed> {
        let up = libm::floor(height_mm / self.layers.rise_mm()) as i64;
        let nth = self.layers.nth(descent.tip_mm) + up;
        let index = self.layers.place(nth)?;
        let reach_ratio = self.layers.part_ratio(nth, descent.tip_mm + self.reach_mm).min(1.0);
        let foot_ratio = if up == 0 { self.layers.part_ratio(nth, descent.tip_mm) } else { 0.0 };
        // A remainder below a level that is slightly above a layer's bottom stays a floor.
        let border_ratio = self.layers.part_ratio(nth, descent.border_mm).max(LEVEL_RATIO);
        let depth_band = DepthBand { foot_ratio, border_ratio, is_end: false };
        (reach_ratio >= REACHED_RATIO).then_some(Placed { index, depth_band, reach_ratio })
    }
}

impl Tips {
    fn new(ends: &[EndEdge]) -> Self {
        let mut angles_rad: Vec<f64> = ends.iter().map(|end| end.piece.angle_rad.rem_euclid(TAU)).collect();
        angles_rad.sort_unstable_by(f64::total_cmp);
        let whole_rad = angles_rad.first().map_or(TAU, |first_rad| first_rad + TAU);
        let next_rad = angles_rad.iter().skip(1).chain([&whole_rad]);
        let window_rad =
            angles_rad.iter().zip(next_rad).map(|(from_rad, to_rad)| to_rad - from_rad).fold(0.0, f64::max);
        Tips { window_rad, turned_rad: 0.0, passed: VecDeque::new(), last: None }
    }

    fn add(&mut self, pose: &ToolPose) {
        let step_rad = self.last.map_or(0.0, |(_, last_rad)| (pose.turned_rad - last_rad).rem_euclid(TAU));
        self.last = Some((pose.tip_mm, pose.turned_rad));
        self.turned_rad += step_rad;
        // The step before the window may have passed a position, and the next step is as long as this one.
        let from_rad = self.turned_rad - self.window_rad - 2.0 * step_rad;
        while self.passed.front().is_some_and(|(_, turned_rad)| *turned_rad < from_rad) {
            self.passed.pop_front();
        }
        while self.passed.back().is_some_and(|(tip_mm, _)| *tip_mm <= pose.tip_mm) {
            self.passed.pop_back();
        }
        self.passed.push_back((pose.tip_mm, self.turned_rad));
    }
}

/// Solid of revolution that a cutter's edges sweep, as slices from the tip upwards.
///
/// The heights are those of the first tooth's pieces; the pieces of all other teeth must be at the same heights.
pub fn slices(cutter: &Cutter) -> Vec<Slice> {
    let mut slices: Vec<Slice> = Vec::new();
    for piece in cutter.pieces() {
        let found = slices.iter().position(|slice| slice.height_mm == piece.height_mm);
        let index = found.unwrap_or_else(|| {
            slices.push(Slice { height_mm: piece.height_mm, inner_mm: 0.0, outer_mm: 0.0 });
            slices.len() - 1
        });
        let slice = &mut slices[index];
        match piece.side {
            Edge::Outer => slice.outer_mm = slice.outer_mm.max(piece.radius_mm),
            // The innermost one counts.
            Edge::Inner if slice.inner_mm == 0.0 => slice.inner_mm = piece.radius_mm,
            Edge::Inner => slice.inner_mm = slice.inner_mm.min(piece.radius_mm),
        }
    }
    slices
}
