//! Regions of a repaired blade, and the allowance that finishing leaves on them.
//!
//! ```text
//! D_old = median of D where D is not above the threshold's neighbourhood                                      (1)
//! S3: D - D_old > d0, closed by one node, its largest connected part with all pits in it; c_b its border        (2)
//! S2: distance from c_b at most w, outside of S3;  S1: the rest                                               (3)
//! ```
//!
//! Over an edge (1) is taken on both sides, with a smooth change from one to the other across the edge, and distances count on the unfolded surface.
//!
//! If c_b runs from one edge to the other and rises or falls all the way, with all of S3 towards the tip, the allowance is that of Feng et al. with
//! u1, u2, u3; otherwise (a nick in an edge, an island) it blends by distance from c_b.

use super::blend::{BlendShape, FinishAllowance};
use super::border::{MonotoneBorder, square_to, transition_begin};
use super::field::{AllowanceField, FieldNode};
use super::registration::median;
use crate::geometry::surface::{Surface, Unfolded};
use crate::vector::Point;

/// Crossings on either side of one over which c_b is smoothed.
const SMOOTHED: usize = 4;

/// Settings by which a measured side is divided into regions, and what finishing leaves there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionSettings {
    /// Deviation d0 above the old surface from which on a place belongs to the repaired region.
    pub threshold_mm: f64,
    /// Width w of the transition around the repaired region.
    pub width_mm: f64,
    /// Allowance D_min that stays in the repaired region.
    pub least_mm: f64,
    /// Way in which the allowance changes across the transition.
    pub shape: BlendShape,
}

/// Region to which a point of a repaired blade belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// S1: the old surface, which stays.
    Norm,
    /// S2: the strip around the repaired region, in which finishing leaves less and less of the old deviation.
    Transition,
    /// S3: the weld, which is milled down to the least allowance.
    Repaired,
}

/// Border c_b of the repaired region.
#[derive(Clone, Debug)]
pub enum RepairBorder {
    /// Curve from edge to edge, of u as a function of v; with v counted from the trailing edge if `is_mirrored`.
    Rising {
        /// The border as a function.
        curve: MonotoneBorder,
        /// Whether the border falls from the leading to the trailing edge.
        is_mirrored: bool,
    },
    /// Any other border, as straight pieces with both ends.
    Pieces(Vec<[Point; 2]>),
}

/// Regions of a measured side, and what finishing leaves on them.
#[derive(Clone, Debug)]
pub struct RepairRegions {
    /// Region of each node of the measured lattice, row by row.
    pub regions: Vec<Vec<Region>>,
    /// Border c_b of the repaired region.
    pub border: RepairBorder,
    /// Allowance that finishing is to leave.
    pub allowance: FinishAllowance,
    /// Deviation of the old blade beyond the edge, mm; on a surface without one that of the whole.
    pub old_beyond_mm: f64,
    width_mm: f64,
}

/// Regions of a measured side; `None` if no place is to be repaired.
pub fn regions(surface: &dyn Surface, field: &AllowanceField, settings: &RegionSettings) -> Option<RepairRegions> {
    let old_mm = |is_beyond: bool| old_deviation_mm(field, is_beyond, settings.threshold_mm);
    let before_mm = old_mm(false);
    let old_mm = [before_mm, if surface.is_over_edge() { old_mm(true) } else { before_mm }];
    let limit_mm = |node: &FieldNode| old_at_mm(old_mm, &node.unfolded, settings.width_mm) + settings.threshold_mm;
    let repaired = repaired_nodes(field, limit_mm);
    if !repaired.iter().flatten().any(|is_repaired| *is_repaired) {
        return None;
    }
    let border = match surface.is_over_edge() {
        true => RepairBorder::Pieces(pieces(field, &repaired)),
        false => border(field, &repaired, old_mm[0] + settings.threshold_mm),
    };
    let allowance = allowance(surface, field, &border, old_mm[0], settings);
    let [_, old_beyond_mm] = old_mm;
    let mut found =
        RepairRegions { regions: Vec::new(), border, allowance, old_beyond_mm, width_mm: settings.width_mm };
    let region = |is_repaired: bool, node: &FieldNode| match is_repaired {
        true => Region::Repaired,
        false if found.is_in_transition(node) => Region::Transition,
        false => Region::Norm,
    };
    let rows = field.rows.iter().zip(&repaired);
    let row = |(nodes, marks): (&Vec<FieldNode>, &Vec<bool>)| {
        nodes.iter().zip(marks).map(|(node, mark)| region(*mark, node)).collect()
    };
    let regions = rows.map(row).collect();
    found.regions = regions;
    Some(found)
}

/// (1): the median of what is left after the repaired places, whose own median is far above, are taken out.
fn old_deviation_mm(field: &AllowanceField, is_beyond: bool, threshold_mm: f64) -> f64 {
    let nodes = field.nodes().filter(|node| (node.unfolded.beyond_mm > 0.0) == is_beyond);
    let mut kept: Vec<f64> = nodes.filter_map(|node| node.along_mm).collect();
    loop {
        let low = lower_half_median(&kept);
        let count = kept.len();
        kept.retain(|height_mm| *height_mm - low <= threshold_mm);
        if kept.len() == count {
            return median(&kept);
        }
    }
}

/// Deviation of the old blade at a place, of those before and beyond an edge.
fn old_at_mm([before_mm, beyond_mm]: [f64; 2], place: &Unfolded, width_mm: f64) -> f64 {
    before_mm + (beyond_mm - before_mm) * BlendShape::Cubic.value(0.5 + place.beyond_mm / (2.0 * width_mm))
}

/// Median of the lower half: of old surface as long as at least a quarter of the field is old.
fn lower_half_median(values: &[f64]) -> f64 {
    let middle = median(values);
    let lower: Vec<f64> = values.iter().copied().filter(|value| *value <= middle).collect();
    median(&lower)
}

/// (2)
fn repaired_nodes(field: &AllowanceField, limit_mm: impl Fn(&FieldNode) -> f64) -> Vec<Vec<bool>> {
    let above = |node: &FieldNode| node.along_mm.is_some_and(|height_mm| height_mm > limit_mm(node));
    let marks: Vec<Vec<bool>> = field.rows.iter().map(|row| row.iter().map(above).collect()).collect();
    let grown = spread(&marks, true);
    let closed = spread(&grown, false);
    without_pits(&largest_part(&closed))
}

/// Neighbours of a node, and itself.
fn around(marks: &[Vec<bool>], i: usize, j: usize) -> impl Iterator<Item = (usize, usize)> {
    let (rows, columns) = (marks.len(), marks[0].len());
    let beside = |k: usize, count: usize| k.saturating_sub(1)..(k + 2).min(count);
    beside(i, rows).flat_map(move |i| beside(j, columns).map(move |j| (i, j)))
}

/// Marks that spread to their neighbours: the set ones, or else the others.
fn spread(marks: &[Vec<bool>], set: bool) -> Vec<Vec<bool>> {
    let mark = |i: usize, j: usize| if around(marks, i, j).any(|(i, j)| marks[i][j] == set) { set } else { !set };
    (0..marks.len()).map(|i| (0..marks[0].len()).map(|j| mark(i, j)).collect()).collect()
}

fn largest_part(marks: &[Vec<bool>]) -> Vec<Vec<bool>> {
    let mut seen = vec![vec![false; marks[0].len()]; marks.len()];
    let mut largest: Vec<(usize, usize)> = Vec::new();
    for start in (0..marks.len()).flat_map(|i| (0..marks[0].len()).map(move |j| (i, j))) {
        if marks[start.0][start.1] && !seen[start.0][start.1] {
            let part = connected(marks, true, start, &mut seen);
            if part.len() > largest.len() {
                largest = part;
            }
        }
    }
    with(marks, &largest, true)
}

/// Marks of all nodes that the root does not reach over unmarked ones: a pit in a weld is part of the repair, also at the tip.
fn without_pits(marks: &[Vec<bool>]) -> Vec<Vec<bool>> {
    let mut seen = vec![vec![false; marks[0].len()]; marks.len()];
    let mut outside = Vec::new();
    for j in 0..marks[0].len() {
        if !marks[0][j] && !seen[0][j] {
            outside.extend(connected(marks, false, (0, j), &mut seen));
        }
    }
    with(marks, &outside, false)
}

/// Marks that have a value at some nodes only.
fn with(marks: &[Vec<bool>], nodes: &[(usize, usize)], value: bool) -> Vec<Vec<bool>> {
    let mut found = vec![vec![!value; marks[0].len()]; marks.len()];
    nodes.iter().for_each(|(i, j)| found[*i][*j] = value);
    found
}

/// Nodes of one value that neighbours connect with a start.
fn connected(marks: &[Vec<bool>], value: bool, start: (usize, usize), seen: &mut [Vec<bool>]) -> Vec<(usize, usize)> {
    seen[start.0][start.1] = true;
    let (mut part, mut next) = (vec![start], 0);
    while next < part.len() {
        let (i, j) = part[next];
        next += 1;
        for (i, j) in around(marks, i, j) {
            if marks[i][j] == value && !seen[i][j] {
                seen[i][j] = true;
                part.push((i, j));
            }
        }
    }
    part
}

fn border(field: &AllowanceField, repaired: &[Vec<bool>], limit_mm: f64) -> RepairBorder {
    crossings(field, repaired, limit_mm)
        .and_then(rising)
        .unwrap_or_else(|| RepairBorder::Pieces(pieces(field, repaired)))
}

/// Place `[v, u]` at which each column of the lattice enters the repaired region; `None` if one does not, or leaves it again.
fn crossings(field: &AllowanceField, repaired: &[Vec<bool>], limit_mm: f64) -> Option<Vec<[f64; 2]>> {
    let column = |j: usize| {
        let first = repaired.iter().position(|row| row[j])?;
        let is_all = repaired[first..].iter().all(|row| row[j]);
        if first == 0 || !is_all {
            return None;
        }
        let (below, above) = (&field.rows[first - 1][j], &field.rows[first][j]);
        let heights = below.along_mm.zip(above.along_mm).filter(|(low, high)| high > low);
        let share = heights.map_or(0.5, |(low, high)| ((limit_mm - low) / (high - low)).clamp(0.0, 1.0));
        let between = |k: usize| below.at[k] + (above.at[k] - below.at[k]) * share;
        Some([between(1), between(0)])
    };
    (0..repaired[0].len()).map(column).collect()
}

/// Monotone curve through smoothed crossings; `None` if they turn back by more than a third of the rise from end to end.
fn rising(places: Vec<[f64; 2]>) -> Option<RepairBorder> {
    let mut places: Vec<[f64; 2]> = (0..places.len()).map(|k| smoothed(&places, k)).collect();
    let whole = places[places.len() - 1][1] - places[0][1];
    let is_mirrored = whole < 0.0;
    if is_mirrored {
        places.reverse();
        places.iter_mut().for_each(|place| place[0] = 1.0 - place[0]);
    }
    let mut highest = f64::NEG_INFINITY;
    for place in &mut places {
        if highest - place[1] > whole.abs() / 3.0 {
            return None;
        }
        highest = highest.max(place[1]);
        place[1] = highest;
    }
    MonotoneBorder::new(places).map(|curve| RepairBorder::Rising { curve, is_mirrored })
}

/// Place `[v, u]` of the line through the crossings beside one: noise of the points moves a crossing along the blade.
fn smoothed(places: &[[f64; 2]], at: usize) -> [f64; 2] {
    let beside = &places[at.saturating_sub(SMOOTHED)..(at + SMOOTHED + 1).min(places.len())];
    let count = beside.len() as f64;
    let [mean_v, mean_u] = [0, 1].map(|k: usize| beside.iter().map(|place| place[k]).sum::<f64>() / count);
    let square: f64 = beside.iter().map(|[v, _]| (v - mean_v) * (v - mean_v)).sum();
    let product: f64 = beside.iter().map(|[v, u]| (v - mean_v) * (u - mean_u)).sum();
    let slope = if square > 0.0 { product / square } else { 0.0 };
    let v = places[at][0];
    [v, mean_u + slope * (v - mean_v)]
}

/// Marching squares between nodes with and without a mark: pieces through the middles of the edges.
fn pieces(field: &AllowanceField, repaired: &[Vec<bool>]) -> Vec<[Point; 2]> {
    let middle = |a: (usize, usize), b: (usize, usize)| {
        nalgebra::center(&field.rows[a.0][a.1].unfolded.point, &field.rows[b.0][b.1].unfolded.point)
    };
    let cell = |i: usize, j: usize| {
        let corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)];
        let sides = (0..4).map(|k| (corners[k], corners[(k + 1) % 4]));
        let crossed: Vec<Point> =
            sides.filter(|(a, b)| repaired[a.0][a.1] != repaired[b.0][b.1]).map(|(a, b)| middle(a, b)).collect();
        crossed.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>()
    };
    let cells = (0..repaired.len() - 1).flat_map(|i| (0..repaired[0].len() - 1).map(move |j| (i, j)));
    cells.flat_map(|(i, j)| cell(i, j)).collect()
}

fn allowance(
    surface: &dyn Surface,
    field: &AllowanceField,
    border: &RepairBorder,
    old_mm: f64,
    settings: &RegionSettings,
) -> FinishAllowance {
    let [from_u, leading_u, trailing_u] = match border {
        RepairBorder::Rising { curve, is_mirrored } => {
            let at = |v: f64| curve.u_at(if *is_mirrored { 1.0 - v } else { v });
            [transition_begin(surface, at, settings.width_mm), curve.u_at(0.0), curve.u_at(1.0)]
        }
        RepairBorder::Pieces(pieces) => {
            let is_beside = |node: &&FieldNode| distance_mm(pieces, &node.unfolded.point) <= settings.width_mm;
            let least = field.nodes().filter(is_beside).map(|node| node.at[0]).fold(f64::INFINITY, f64::min);
            [least.min(1.0), least.min(1.0), 1.0]
        }
    };
    FinishAllowance { from_u, leading_u, trailing_u, old_mm, least_mm: settings.least_mm, shape: settings.shape }
}

fn distance_mm(pieces: &[[Point; 2]], point: &Point) -> f64 {
    libm::sqrt(pieces.iter().map(|[from, to]| square_to(point, *from, *to)).fold(f64::INFINITY, f64::min))
}

impl RepairRegions {
    /// Allowance, mm, that finishing leaves at a point; `is_repaired` (the point is in S3) is used only if the border is no function.
    pub fn left_mm(&self, at: [f64; 2], place: impl Into<Unfolded>, is_repaired: bool) -> f64 {
        match &self.border {
            RepairBorder::Rising { curve, is_mirrored } => {
                let v = if *is_mirrored { 1.0 - at[1] } else { at[1] };
                self.allowance.left_mm([at[0], v], curve.v_at(at[0]))
            }
            RepairBorder::Pieces(_) if is_repaired => self.allowance.least_mm,
            RepairBorder::Pieces(pieces) => {
                let place = place.into();
                let old_mm = self.old_at_mm(&place);
                let distance_mm = distance_mm(pieces, &place.point);
                FinishAllowance { old_mm, ..self.allowance }.left_at_distance_mm(distance_mm, self.width_mm)
            }
        }
    }

    /// Deviation of the old blade at a place, mm.
    pub fn old_at_mm(&self, place: &Unfolded) -> f64 {
        old_at_mm([self.allowance.old_mm, self.old_beyond_mm], place, self.width_mm)
    }

    /// Planned allowance of each node, mm, row by row; `None` in the norm region, which stays.
    pub fn planned_mm(&self, field: &AllowanceField) -> Vec<Vec<Option<f64>>> {
        let node = |(node, region): (&FieldNode, &Region)| match region {
            Region::Norm => None,
            _ => Some(self.left_mm(node.at, node.unfolded, *region == Region::Repaired)),
        };
        let row = |(nodes, regions): (&Vec<FieldNode>, &Vec<Region>)| nodes.iter().zip(regions).map(node).collect();
        field.rows.iter().zip(&self.regions).map(row).collect()
    }

    fn is_in_transition(&self, node: &FieldNode) -> bool {
        match &self.border {
            RepairBorder::Rising { .. } => node.at[0] > self.allowance.from_u,
            RepairBorder::Pieces(pieces) => distance_mm(pieces, &node.unfolded.point) <= self.width_mm,
        }
    }
}
