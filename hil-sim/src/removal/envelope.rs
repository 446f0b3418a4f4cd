//! Sweep of a cutter in one layer: depth of a point inside it.
//!
//! A slice of the tool is a ring from r to R about its axis (r = 0: a disc). A point at the distance d from the axis is
//!
//! ```text
//! deep = R - d                      of a disc                                   (1)
//! deep = min(R - d, d - r)          of a ring                                   (2)
//! deep = the most of these, over all places of the axis in the layer            (3)
//! ```
//!
//! A layer is swept where it is cut through: by the lowest slice while the tip is at the layer's bottom, by the slice
//! above it while the tip is inside the layer below, and so on. The remainder under a tip inside the layer is a floor.
//!
//! `deep` is the depth inside the swept area. If negative, it is the distance of a point outside; beside a wall it is
//! the distance from the wall. Along a segment d takes all values between two ends, so (3) is exact for each.
//!
//! Source: geometry.

use nalgebra::Vector2;

use super::tip_path::TipSegment;
use arcfeed_milling::cutting::edge_engagement::REACHED_RATIO;
use arcfeed_milling::cutting::layers::{LEVEL_RATIO, Layers, Slice};

/// Number of sweeps in a group; a group that is too far off is skipped as a whole.
const TOGETHER: usize = 64;

/// Margin of a bound.
const ROUNDING_MM: f64 = 1e-9;

/// Solid of revolution that the edges of a tool without runout sweep, as slices.
#[derive(Clone, Debug)]
pub struct CuttingSolid {
    /// Slices from the tip upwards, each as high as a layer; one more than the evaluated height, for a tip inside a
    /// layer.
    pub slices: Vec<Slice>,
    /// Height above the tip up to which edges are evaluated.
    pub reach_mm: f64,
}

/// Area of one layer that a tool's cuts have swept.
#[derive(Clone, Debug)]
pub struct Envelope {
    groups: Vec<Group>,
}

/// Depth of a point inside a swept area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// Distance of the point from the border of the swept area: positive inside, negative outside.
    pub deep_mm: f64,
    /// Index of the segment of the tip's path at which the point is deepest.
    pub segment: usize,
    /// Vector from the tool's axis there to the point.
    pub arm_mm: Vector2<f64>,
}

/// Successive sweeps with common bounds.
#[derive(Clone, Debug)]
struct Group {
    lowest_mm: Vector2<f64>,
    highest_mm: Vector2<f64>,
    outer_mm: f64,
    /// Inner radius; 0 for discs.
    inner_mm: f64,
    swept: Vec<Swept>,
}

/// Sweep of a slice on the part of a segment on which it was in the layer.
#[derive(Clone, Copy, Debug)]
struct Swept {
    segment: usize,
    from_mm: Vector2<f64>,
    to_mm: Vector2<f64>,
    slice: Slice,
}

impl Envelope {
    /// Area of the layer with the index `layer` that the solid `turned` sweeps when its tip follows these segments.
    pub fn new(segments: &[TipSegment], turned: &CuttingSolid, layers: &Layers, layer: usize) -> Self {
        let rise_mm = layers.rise_mm();
        let foot_mm = layers.middle_mm(layer) - rise_mm / 2.0;
        let highest = turned.reach_mm / rise_mm - REACHED_RATIO;
        // Heights of the tip at which a slice cuts through the layer.
        let tips_mm = |up: f64| {
            let least = if up > 0.0 { up - 1.0 + LEVEL_RATIO } else { -LEVEL_RATIO };
            [(up + LEVEL_RATIO).min(highest), least].map(|layers_below| foot_mm - layers_below * rise_mm)
        };
        let each: Vec<(Slice, [f64; 2])> =
            turned.slices.iter().zip(0_u32..).map(|(slice, up)| (*slice, tips_mm(f64::from(up)))).collect();
        let swept = |(segment, on): (usize, &TipSegment)| {
            each.iter().filter_map(|(slice, tips_mm)| Swept::of(segment, on, slice, *tips_mm)).collect::<Vec<_>>()
        };
        let swept: Vec<Swept> = segments.iter().enumerate().flat_map(swept).collect();
        Envelope { groups: swept.chunks(TOGETHER).map(Group::new).collect() }
    }

    /// Depth of a point; `None` if nothing was swept. (3)
    pub fn deepest(&self, point_mm: &Vector2<f64>) -> Option<Depth> {
        // The group with the largest bound mostly contains the deepest sweep; then nearly all others are skipped.
        let at_most_mm: Vec<f64> = self.groups.iter().map(|group| group.deep_at_most_mm(point_mm)).collect();
        let first = (0..at_most_mm.len()).max_by(|a, b| at_most_mm[*a].total_cmp(&at_most_mm[*b]))?;
        let mut deepest = (first, self.groups[first].deepest(point_mm)?);
        for (place, (group, at_most_mm)) in self.groups.iter().zip(&at_most_mm).enumerate() {
            let deep_mm = deepest.1.deep_mm;
            if place != first
                && *at_most_mm >= deep_mm
                && let Some(depth) = group.deepest(point_mm)
                // Among equal depths the first one counts.
                && (depth.deep_mm > deep_mm || depth.deep_mm == deep_mm && place < deepest.0)
            {
                deepest = (place, depth);
            }
        }
        Some(deepest.1)
    }
}

impl Group {
    fn new(swept: &[Swept]) -> Self {
        let ends = || swept.iter().flat_map(|swept| [swept.from_mm, swept.to_mm]);
        Group {
            lowest_mm: ends().fold(Vector2::repeat(f64::INFINITY), |low, end| low.inf(&end)),
            highest_mm: ends().fold(Vector2::repeat(f64::NEG_INFINITY), |high, end| high.sup(&end)),
            outer_mm: swept.iter().map(|swept| swept.slice.outer_mm).fold(0.0, f64::max),
            inner_mm: swept.iter().map(|swept| swept.slice.inner_mm).fold(f64::INFINITY, f64::min),
            swept: swept.to_vec(),
        }
    }

    fn deepest(&self, point_mm: &Vector2<f64>) -> Option<Depth> {
        let depths = self.swept.iter().map(|swept| swept.depth(point_mm));
        depths.reduce(|most, depth| if depth.deep_mm > most.deep_mm { depth } else { most })
    }

    fn deep_at_most_mm(&self, point_mm: &Vector2<f64>) -> f64 {
        let nearest_mm = point_mm.sup(&self.lowest_mm).inf(&self.highest_mm);
        let near_mm = self.outer_mm - (point_mm - nearest_mm).norm();
        if self.inner_mm == 0.0 {
            return near_mm;
        }
        let farthest = (point_mm - self.lowest_mm).abs().sup(&(point_mm - self.highest_mm).abs());
        near_mm.min(farthest.norm() - self.inner_mm) + ROUNDING_MM
    }
}

impl Swept {
    /// Sweep of a slice; `None` if the tip is never between the two heights.
    fn of(segment: usize, on: &TipSegment, slice: &Slice, [low_mm, high_mm]: [f64; 2]) -> Option<Self> {
        let [from_mm, to_mm] = [on.from_mm, on.to_mm].map(|tip_mm| tip_mm[2]);
        let rise_mm = to_mm - from_mm;
        let parts = if rise_mm == 0.0 {
            (low_mm..high_mm).contains(&from_mm).then_some([0.0, 1.0])
        } else {
            let [a, b] = [low_mm, high_mm].map(|at_mm| (at_mm - from_mm) / rise_mm);
            Some([a.min(b).max(0.0), a.max(b).min(1.0)]).filter(|[enters, leaves]| enters <= leaves)
        };
        let [from, to] = [on.from_mm, on.to_mm].map(|tip_mm| Vector2::new(tip_mm[0], tip_mm[1]));
        parts.map(|[enters, leaves]| Swept {
            segment,
            from_mm: from.lerp(&to, enters),
            to_mm: from.lerp(&to, leaves),
            slice: *slice,
        })
    }

    fn depth(&self, point_mm: &Vector2<f64>) -> Depth {
        let (path_mm, from_begin_mm) = (self.to_mm - self.from_mm, point_mm - self.from_mm);
        let square = path_mm.norm_squared();
        let part = if square > 0.0 { (from_begin_mm.dot(&path_mm) / square).clamp(0.0, 1.0) } else { 0.0 };
        let near = from_begin_mm - path_mm * part;
        let Slice { inner_mm, outer_mm, .. } = self.slice;
        if inner_mm == 0.0 {
            return Depth { deep_mm: outer_mm - near.norm(), segment: self.segment, arm_mm: near }; // (1)
        }
        let from_end_mm = point_mm - self.to_mm;
        let far = if from_begin_mm.norm() > from_end_mm.norm() { from_begin_mm } else { from_end_mm };
        let middle_mm = (inner_mm + outer_mm) / 2.0;
        // Not `clamp`, which panics: the nearest point of a short segment may be farther than its ends by the last
        // digit.
        let off_mm = middle_mm.max(near.norm()).min(far.norm());
        let arm_mm = if off_mm < middle_mm { far } else { near };
        Depth { deep_mm: (outer_mm - off_mm).min(off_mm - inner_mm), segment: self.segment, arm_mm } // (2)
    }
}

#[cfg(test)]
mod tests {
    use super::super::trail::BlockRef;
    use super::*;
    use arcfeed_milling::cutting::layer::Layer;

    fn envelope(ends_mm: [[f64; 3]; 2], inner_mm: f64) -> Envelope {
        let block = BlockRef { count: 1, sequence: None, rule: None, is_rapid: false };
        let segment = TipSegment { block, from_mm: ends_mm[0], to_mm: ends_mm[1] };
        let layers = Layers::alike(&Layer::rectangle([0.0; 2], [1.0; 2], 1.0), 0.0, 1.0, 3);
        let slices = [0.5, 1.5].map(|height_mm| Slice { height_mm, inner_mm, outer_mm: 5.0 });
        Envelope::new(&[segment], &CuttingSolid { slices: slices.to_vec(), reach_mm: 1.0 }, &layers, 1)
    }

    #[track_caller]
    fn assert_deep(envelope: &Envelope, at_mm: [f64; 2], expected_mm: f64) {
        let deep_mm = envelope.deepest(&at_mm.into()).expect("something was swept").deep_mm;
        assert!((deep_mm - expected_mm).abs() < 1e-12, "{at_mm:?}: {deep_mm}");
    }

    #[test]
    fn a_disc_leaves_a_slot_with_round_ends() {
        let slot = envelope([[0.0, 0.0, 1.0], [20.0, 0.0, 1.0]], 0.0);
        for (at_mm, deep_mm) in [([7.0, 4.0], 1.0), ([7.0, -5.5], -0.5), ([23.0, 4.0], 0.0), ([-6.0, 0.0], -1.0)] {
            assert_deep(&slot, at_mm, deep_mm);
        }
    }

    #[test]
    fn a_ring_leaves_the_material_that_stays_inside_it() {
        let slot = envelope([[0.0, 0.0, 1.0], [2.0, 0.0, 1.0]], 3.0);
        for (at_mm, deep_mm) in [([1.0, 0.0], -2.0), ([-3.5, 0.0], 1.0), ([1.0, 5.5], -0.5), ([3.0, 0.0], 0.0)] {
            assert_deep(&slot, at_mm, deep_mm);
        }
    }

    #[test]
    fn a_nearest_point_that_is_farther_by_rounding_has_a_depth() {
        let ends_mm = [[67.95207082670174, 65.17546265597753, 1.0], [67.95207099493236, 65.17546294988988, 1.0]];
        assert_deep(&envelope(ends_mm, 3.0), [51.88488879411541, 74.37205456206897], 5.0 - 18.5130127519929);
    }

    #[test]
    fn a_ramp_counts_where_the_layer_is_cut_through() {
        // From 1 mm on, but for a fiftieth of a layer, down to where less than half of the layer is reached.
        let ramp = envelope([[0.0, 0.0, 1.5], [20.0, 0.0, -0.5]], 0.0);
        for at_mm in [4.8, 8.0, 10.0] {
            assert_deep(&ramp, [at_mm, 5.0], 0.0);
        }
        assert_deep(&ramp, [2.8, 5.0], 5.0 - libm::hypot(2.0, 5.0));
        assert_deep(&ramp, [12.0, 5.0], 5.0 - libm::hypot(2.0, 5.0));
        assert!(envelope([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]], 0.0).deepest(&Vector2::zeros()).is_none());
    }
}
