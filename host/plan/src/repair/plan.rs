//! Plan of one repaired side: allowance, regions, what finishing leaves, and the contact points of roughing and finishing.

use thiserror::Error;

use super::blend::BlendShape;
use super::border::square_to;
use super::field::{AllowanceField, FieldNode};
use super::passes::{PassLines, PassSettings, RepairContact, layer_heights_mm, pass_lines, runs};
use super::regions::{Region, RegionSettings, RepairBorder, RepairRegions, regions};
use super::scan::{HeightField, HeightSample, NominalSurface};
use crate::geometry::face::FaceError;
use crate::geometry::surface::{Surface, Unfolded};
use crate::vector::Point;

/// Steepest slope of the blended allowance.
const SLOPE_MAX: f64 = 1.0 / 20.0;

/// Points behind what is to be left that are no outliers.
const LOW_POINTS: usize = 3;

/// Requirements on the milling of a repaired side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepairSettings {
    /// Way in which regions are found, and what finishing leaves in them.
    pub regions: RegionSettings,
    /// Ball mill, and the errors that the finishing passes may have.
    pub passes: PassSettings,
    /// Largest distance between the nodes at which the allowance is measured.
    pub spacing_mm: f64,
    /// Distance from the nearest measured point above which a place counts as a hole; `None`: three mean spacings of the points, and
    /// `spacing_mm` at least.
    pub hole_mm: Option<f64>,
    /// Allowance D_r that roughing leaves.
    pub rough_mm: f64,
    /// Depth a_p of a layer in roughing.
    pub depth_mm: f64,
}

impl RepairSettings {
    /// Measured heights of a side.
    pub fn height_field(&self, nominal: &NominalSurface<'_>, samples: &[HeightSample]) -> HeightField {
        // Dense clouds end farther than three spacings beside the edges; what is smaller than the lattice's cells is in no place of it.
        let usual_mm = || nominal.usual_hole_mm(samples.len()).max(self.spacing_mm);
        nominal.height_field(samples, self.hole_mm.unwrap_or_else(usual_mm))
    }
}

/// Reason why a repair cannot be planned.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RepairInfeasible {
    /// The measured points define no surface.
    #[error("the measured points define no surface: {0}")]
    Surface(#[from] FaceError),
    /// No place stands above the old surface by more than the threshold, so nothing is to be repaired.
    #[error(
        "no place stands more than {threshold_mm:.3} mm above the rest: nothing is repaired on this side; measure the weld, or reduce `threshold`"
    )]
    NothingRepaired {
        /// Threshold.
        threshold_mm: f64,
    },
    /// A part of the surface to be finished was not measured.
    #[error(
        "{holes} of {places} places to be finished lie in holes of the measurement, first about ({}): measure there, or raise `hole` above {hole_mm:.2} mm", place(.point)
    )]
    Unmeasured {
        /// Place.
        point: Point,
        /// Places in holes.
        holes: usize,
        /// Places of the region.
        places: usize,
        /// Farthest distance that is no hole.
        hole_mm: f64,
    },
    /// There is less material than finishing is to leave.
    #[error(
        "material is missing: {missing_mm:.3} mm at ({}), where {measured_mm:.3} mm stand and {planned_mm:.3} mm are to be left; weld more on there, reduce `least`, or allow the blade to be moved by `[datum] shift`", place(.point)
    )]
    Short {
        /// Place with the greatest amount.
        point: Point,
        /// Amount.
        missing_mm: f64,
        /// Measured allowance.
        measured_mm: f64,
        /// Planned allowance.
        planned_mm: f64,
    },
    /// The transition from the old surface is too steep, because it is too narrow.
    #[error(
        "the transition is too steep: 1 in {run:.1}, and 1 in 20 is allowed; make `width` {needed_mm:.2} mm at least"
    )]
    Steep {
        /// Width of the transition divided by its height, where it is steepest.
        run: f64,
        /// Width that is enough.
        needed_mm: f64,
    },
    /// A weld over one edge reaches the other one.
    #[error(
        "the {} over this edge reaches the other edge at ({}), where {standing_mm:.3} mm stand, and one edge at a time is planned: {}", if *.is_weld { "weld" } else { "transition of the weld" },
        place(.point), if *.is_weld { "take off there what stands more than `threshold`, and measure anew" } else { "reduce `width`" }
    )]
    Around {
        /// Place.
        point: Point,
        /// Measured allowance there.
        standing_mm: f64,
        /// Whether the weld itself reaches it; otherwise its transition does.
        is_weld: bool,
    },
    /// The ball does not fit.
    #[error(
        "a ball of radius {ball_mm:.2} mm cannot finish this side: a hollow is as narrow, or `cusp` or `chord` ask for millions of points"
    )]
    Ball {
        /// Radius.
        ball_mm: f64,
    },
}

/// Plan of one side.
#[derive(Clone, Debug)]
pub struct RepairPlan {
    /// Allowance before.
    pub field: AllowanceField,
    /// Regions.
    pub regions: RepairRegions,
    /// Allowance that finishing leaves at each node; `None` in the norm region.
    pub planned_mm: Vec<Vec<Option<f64>>>,
    /// Heights of the measured surface.
    pub heights: HeightField,
    /// Lines of the finish.
    pub lines: PassLines,
    /// Contact points of the finish on whole lines.
    pub whole: Vec<Vec<RepairContact>>,
    /// Finishing passes; of an island or a nick the runs on which they cut.
    pub finish: Vec<Vec<RepairContact>>,
    /// Rough layers, from the highest: their heights and the runs of contact points.
    pub layers: Vec<(f64, Vec<Vec<RepairContact>>)>,
    /// Volumes that roughing and finishing remove together, mm3: in the repaired region, and in the transition.
    pub removed_mm3: [f64; 2],
}

fn place(point: &Point) -> String {
    format!("{:.2}, {:.2}, {:.2}", point.x, point.y, point.z)
}

/// Plans the milling of one side from the heights that were measured on it.
///
/// # Errors
/// Describes why there is no plan, with the place and the amount.
pub fn plan(
    nominal: &NominalSurface<'_>,
    samples: &[HeightSample],
    settings: &RepairSettings,
) -> Result<RepairPlan, RepairInfeasible> {
    let surface = nominal.surface();
    let heights = settings.height_field(nominal, samples);
    let mut field = AllowanceField::new(nominal, &heights, settings.spacing_mm)?;
    let threshold_mm = settings.regions.threshold_mm;
    let found =
        regions(surface, &field, &settings.regions).ok_or(RepairInfeasible::NothingRepaired { threshold_mm })?;
    let planned_mm = found.planned_mm(&field);
    let is_over_edge = surface.is_over_edge();
    if is_over_edge {
        check_around(&field, &found)?;
        correct_edge(surface, samples, &mut field, &heights, &found);
    }
    check_slope(&found, &settings.regions)?;
    check_material(&field, &found, &planned_mm, threshold_mm)?;
    check_measured(&field, &planned_mm, heights.hole_mm())?;
    let ball_mm = settings.passes.ball_mm;
    let vs = if is_over_edge { finished_range(&field, &found) } else { surface.ranges()[1] };
    let lines =
        pass_lines(surface, found.allowance.from_u, vs, &settings.passes).ok_or(RepairInfeasible::Ball { ball_mm })?;
    let region = |at: [f64; 2], point: &Point| nearest_region(&field, &found, at, &surface.unfolded(at, point).point);
    let is_repaired = |at: [f64; 2], point: &Point| region(at, point) == Region::Repaired;
    let whole =
        lines.contacts(surface, |at, point| found.left_mm(at, surface.unfolded(at, point), is_repaired(at, point)));
    // Beside an island or a nick the old surface stays; above c1 of a border from edge to edge everything is finished.
    let is_all = matches!(found.border, RepairBorder::Rising { .. });
    let is_finished =
        |contact: &RepairContact| is_all || region(contact.at, &surface.jet(contact.at).point) != Region::Norm;
    let finish = whole.iter().flat_map(|line| runs(line, is_finished)).collect();
    // A place of the weld that was not measured counts as standing above every layer.
    let stands_above = |contact: &RepairContact| {
        is_repaired(contact.at, &surface.jet(contact.at).point)
            && heights.height_mm(contact.at).is_none_or(|height_mm| height_mm > contact.left_mm)
    };
    let layers = layers(surface, &lines, settings, greatest_mm(&field, &found), stands_above);
    let removed_mm3 = removed_mm3(&field, &found, &planned_mm, is_over_edge);
    Ok(RepairPlan { layers, finish, whole, lines, removed_mm3, planned_mm, regions: found, field, heights })
}

impl RepairPlan {
    /// Allowance, mm, that finishing leaves at a point; where it removes nothing, the deviation of the old blade.
    pub fn left_mm(&self, at: [f64; 2], place: impl Into<Unfolded>) -> f64 {
        let place = place.into();
        let is_repaired = nearest_region(&self.field, &self.regions, at, &place.point) == Region::Repaired;
        self.regions.left_mm(at, place, is_repaired)
    }

    /// Allowance, mm, before the milling at a point; in a hole of the measurement, the deviation of the old blade.
    pub fn standing_mm(&self, at: [f64; 2], place: impl Into<Unfolded>) -> f64 {
        self.heights.height_mm(at).unwrap_or_else(|| self.regions.old_at_mm(&place.into()))
    }
}

/// Region of the node nearest to a place; `point` is unfolded.
fn nearest_region(field: &AllowanceField, regions: &RepairRegions, at: [f64; 2], point: &Point) -> Region {
    let row = field.rows.partition_point(|row| row[0].at[0] < at[0]).min(field.rows.len() - 1);
    let rows = row.saturating_sub(1)..=row;
    let column = |i: usize| field.rows[i].partition_point(|node| node.at[1] < at[1]).min(field.rows[i].len() - 1);
    let beside = rows.flat_map(|i| (column(i).saturating_sub(1)..=column(i)).map(move |j| (i, j)));
    let off = |(i, j): &(usize, usize)| square_to(&field.rows[*i][*j].unfolded.point, *point, *point);
    let (i, j) = beside.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or((row, 0));
    regions.regions[i][j]
}

fn check_slope(regions: &RepairRegions, settings: &RegionSettings) -> Result<(), RepairInfeasible> {
    let allowance = &regions.allowance;
    let fall_mm = |old_mm: f64| (old_mm - allowance.least_mm).abs();
    let fall_mm =
        fall_mm(allowance.old_mm).max(fall_mm(regions.old_beyond_mm)) * BlendShape::steepest_ratio(settings.shape);
    let slope = fall_mm / settings.width_mm;
    if slope <= SLOPE_MAX {
        return Ok(());
    }
    Err(RepairInfeasible::Steep { run: 1.0 / slope, needed_mm: fall_mm / SLOPE_MAX })
}

fn check_measured(
    field: &AllowanceField,
    planned_mm: &[Vec<Option<f64>>],
    hole_mm: f64,
) -> Result<(), RepairInfeasible> {
    let finished = || field.nodes().zip(planned_mm.iter().flatten()).filter(|(_, planned)| planned.is_some());
    let mut holes = finished().filter(|(node, _)| node.along_mm.is_none()).peekable();
    let Some((first, _)) = holes.peek() else { return Ok(()) };
    let point = first.point;
    Err(RepairInfeasible::Unmeasured { point, holes: holes.count(), places: finished().count(), hole_mm })
}

/// A weld over an edge must end before the other edge.
fn check_around(field: &AllowanceField, regions: &RepairRegions) -> Result<(), RepairInfeasible> {
    // The other edge itself may lie beside the measurement.
    let measured_mm = |node: &FieldNode| node.along_mm;
    let ends = |(nodes, marks): (&Vec<FieldNode>, &Vec<Region>)| {
        let last = nodes.len() - 1;
        [
            (marks[0], nodes.iter().find_map(measured_mm).unwrap_or(0.0), nodes[0].point),
            (marks[last], nodes.iter().rev().find_map(measured_mm).unwrap_or(0.0), nodes[last].point),
        ]
    };
    let reached = field.rows.iter().zip(&regions.regions).flat_map(ends).filter(|(region, ..)| *region != Region::Norm);
    let highest = reached.max_by(|(a, a_mm, _), (b, b_mm, _)| {
        let [a, b] = [a, b].map(|region| *region == Region::Repaired);
        a.cmp(&b).then(a_mm.total_cmp(b_mm))
    });
    match highest {
        Some((region, standing_mm, point)) => {
            Err(RepairInfeasible::Around { point, standing_mm, is_weld: region == Region::Repaired })
        }
        None => Ok(()),
    }
}

/// Corrects the allowance of the weld on an edge, where heights from beside it say little of what stands in front of it. Without a measured point there a place
/// is a hole. Points of the weld behind what is to be left are nearest to a side: of them the highest along the normal of the edge counts.
fn correct_edge(
    surface: &dyn Surface,
    samples: &[HeightSample],
    field: &mut AllowanceField,
    heights: &HeightField,
    regions: &RepairRegions,
) {
    let gauge_mm = surface.gauge_mm();
    let measured = |sample: &HeightSample| {
        let (point, normal) = surface.point_and_normal(sample.at);
        // By its noise the old surface lies behind it, too.
        let region = nearest_region(field, regions, sample.at, &surface.unfolded(sample.at, &point).point);
        (region == Region::Repaired).then(|| point + normal * sample.height_mm)
    };
    let low: Vec<Point> =
        samples.iter().filter(|sample| sample.height_mm < regions.allowance.least_mm).filter_map(measured).collect();
    for (node, region) in field.rows.iter_mut().flatten().zip(regions.regions.iter().flatten()) {
        if *region != Region::Repaired || node.unfolded.beyond_mm.abs() >= gauge_mm {
            continue;
        }
        let along = |point: &Point| {
            let off = point - node.point;
            let along_mm = off.dot(&node.normal);
            ((off - node.normal * along_mm).norm() < gauge_mm).then_some(along_mm)
        };
        let near: Vec<f64> = low.iter().filter_map(along).collect();
        let highest_mm = near.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let is_measured = heights.is_measured(node.at, gauge_mm);
        node.along_mm = match near.len() >= LOW_POINTS {
            true => Some(node.along_mm.map_or(highest_mm, |height_mm| height_mm.min(highest_mm))),
            false => node.along_mm.filter(|_| is_measured),
        };
    }
}

/// Parameters v between which everything lies that is finished over an edge, with a place beyond either end.
fn finished_range(field: &AllowanceField, regions: &RepairRegions) -> [f64; 2] {
    let mut range = [1.0, 0.0];
    for (nodes, marks) in field.rows.iter().zip(&regions.regions) {
        let is_finished = |mark: &Region| *mark != Region::Norm;
        if let Some((first, last)) = marks.iter().position(is_finished).zip(marks.iter().rposition(is_finished)) {
            let (first, last) = (first.saturating_sub(1), (last + 1).min(nodes.len() - 1));
            range = [nodes[first].at[1].min(range[0]), nodes[last].at[1].max(range[1])];
        }
    }
    range
}

/// In the transition the old surface itself may lie below the plan by the threshold; the repaired region may not.
fn check_material(
    field: &AllowanceField,
    regions: &RepairRegions,
    planned_mm: &[Vec<Option<f64>>],
    threshold_mm: f64,
) -> Result<(), RepairInfeasible> {
    let regions = regions.regions.iter().flatten();
    let missing =
        field.nodes().zip(regions).zip(planned_mm.iter().flatten()).filter_map(|((node, region), planned)| {
            let (measured_mm, planned_mm) = (node.along_mm?, (*planned)?);
            let missing_mm = planned_mm - measured_mm;
            let allowed_mm = if *region == Region::Repaired { 0.0 } else { threshold_mm };
            (missing_mm > allowed_mm).then_some((missing_mm, node.point, measured_mm, planned_mm))
        });
    match missing.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((missing_mm, point, measured_mm, planned_mm)) => {
            Err(RepairInfeasible::Short { point, missing_mm, measured_mm, planned_mm })
        }
        None => Ok(()),
    }
}

/// Greatest allowance of the repaired region.
fn greatest_mm(field: &AllowanceField, regions: &RepairRegions) -> f64 {
    let nodes = field.nodes().zip(regions.regions.iter().flatten());
    nodes.filter(|(_, region)| **region == Region::Repaired).filter_map(|(node, _)| node.along_mm).fold(0.0, f64::max)
}

/// Rough layers where material stands above them.
fn layers(
    surface: &dyn Surface,
    lines: &PassLines,
    settings: &RepairSettings,
    greatest_mm: f64,
    stands_above: impl Fn(&RepairContact) -> bool,
) -> Vec<(f64, Vec<Vec<RepairContact>>)> {
    let layer = |height_mm: f64| {
        let whole = lines.contacts(surface, |_, _| height_mm);
        (height_mm, whole.iter().flat_map(|line| runs(line, &stands_above)).collect())
    };
    layer_heights_mm(greatest_mm, settings.rough_mm, settings.depth_mm).into_iter().map(layer).collect()
}

/// Over an edge areas count half way between what stands and what is left: the surface itself has hardly any there.
fn removed_mm3(
    field: &AllowanceField,
    regions: &RepairRegions,
    planned_mm: &[Vec<Option<f64>>],
    is_over_edge: bool,
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (i, row) in field.rows.iter().enumerate() {
        for (j, node) in row.iter().enumerate() {
            let Some((measured, planned)) = node.along_mm.zip(planned_mm[i][j]) else { continue };
            let region = usize::from(regions.regions[i][j] != Region::Repaired);
            let height_mm = if is_over_edge { (measured + planned) / 2.0 } else { 0.0 };
            sums[region] += (measured - planned).max(0.0) * field.area_mm2(i, j, height_mm);
        }
    }
    sums
}
