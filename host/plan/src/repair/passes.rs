//! Contact points of rough layers and of the finish, on lines u = const of the nominal surface.
//!
//! ```text
//! finish   C = Q + D n_Q, D what finishing leaves;  n_C = unit(C_u x C_v), tilted by the slope of D           (1)
//! rough    N = ceil((max D - D_r) / a_p);  layer k at D_r + (N - k) a_p, only where the measured D is above it (2)
//! ```
//!
//! Source: Feng et al. project iso-parametric curves on the surface; their layers leave the constant D_r that the finish presumes. Numbers of passes and
//! of points: `repair::stepover`.

use super::arc_length::ArcLength;
use super::stepover::{contact_chord, pass_spacing};
use crate::geometry::surface::Surface;
use crate::plunge::step::stepover;
use crate::vector::{Point, Vector};

/// Places along each parameter at which curvatures and lengths are taken.
const PROBES: usize = 17;
/// Step of the differences in (1), as a share of a parameter's range.
const DIFFERENCE: f64 = 1e-5;
/// Product of both slopes in (1) below which they define no normal.
const FLAT_MM2: f64 = 1e-6;
/// Distance of points along a pass where the surface between the probes is too curved for the ball.
const STEP_LEAST_MM: f64 = 0.05;
/// Most points of all passes of one kind.
const POINTS_MAX: usize = 2_000_000;

/// Contact point of a ball mill on a repaired blade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepairContact {
    /// Parameters u and v of the nominal point below it.
    pub at: [f64; 2],
    /// Contact point C.
    pub point: Point,
    /// Outward unit normal n_C of the surface that is left.
    pub normal: Vector,
    /// Allowance D that is left above the nominal surface.
    pub left_mm: f64,
}

/// Ball mill, and the errors that its passes may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassSettings {
    /// Radius r of the ball.
    pub ball_mm: f64,
    /// Largest height of the cusps between passes.
    pub cusp_mm: f64,
    /// Largest chord error between points of a pass.
    pub chord_mm: f64,
    /// Largest distance between points of a pass.
    pub step_mm: f64,
}

/// Passes as lines of constant u, with the number of points on each.
#[derive(Clone, Debug, PartialEq)]
pub struct PassLines {
    /// Parameters u of the lines.
    pub us: Vec<f64>,
    /// Number of points on each line.
    pub points: usize,
    /// Parameters v between which the lines run.
    pub vs: [f64; 2],
    /// Smallest and largest distance of neighbouring lines.
    pub steps_mm: [f64; 2],
    settings: PassSettings,
}

/// Lines from `from_u` to the tip, between two parameters `vs`; `None` where a hollow is as narrow as the ball, or there would be more points than a control takes.
pub fn pass_lines(surface: &dyn Surface, from_u: f64, vs: [f64; 2], settings: &PassSettings) -> Option<PassLines> {
    let [us, _] = surface.ranges();
    let probe = |from: f64, to: f64, k: usize| from + (to - from) * k as f64 / (PROBES - 1) as f64;
    let mut step_mm = f64::INFINITY;
    for at in (0..PROBES).flat_map(|i| (0..PROBES).map(move |j| (i, j))) {
        let [across, along] = curvatures_per_mm(surface, [probe(from_u, us[1], at.0), probe(vs[0], vs[1], at.1)]);
        step_mm = step_mm.min(stepover(settings.ball_mm, settings.cusp_mm, across)?.wall_mm);
        contact_chord(settings.ball_mm, settings.chord_mm, along)?;
    }
    let lines: Vec<f64> = (0..PROBES)
        .map(|j| probe(vs[0], vs[1], j))
        .map(|v| ArcLength::new([from_u, us[1]], |u| surface.jet([u, v]).u.norm()).length_mm())
        .collect();
    let longest = (0..PROBES).max_by(|a, b| lines[*a].total_cmp(&lines[*b]))?;
    let spacing = pass_spacing(&lines, step_mm)?;
    let chords = (0..PROBES).map(|i| chords(surface, probe(from_u, us[1], i), vs, settings).length_mm());
    let points = libm::ceil(chords.fold(0.0, f64::max)).max(1.0) + 1.0;
    if points * spacing.passes as f64 > POINTS_MAX as f64 {
        return None;
    }
    let longest_v = probe(vs[0], vs[1], longest);
    let us = ArcLength::new([from_u, us[1]], |u| surface.jet([u, longest_v]).u.norm()).equal_arcs(spacing.passes);
    let steps_mm = [spacing.least_mm, spacing.greatest_mm];
    Some(PassLines { us, points: points as usize, vs, steps_mm, settings: *settings })
}

/// A line u = const, measured in chords of the tolerance: equal parts of it are dense where it is curved. Over an edge the path of the ball's centre is
/// measured, because the contact hardly moves there.
fn chords<'s>(
    surface: &'s dyn Surface,
    u: f64,
    vs: [f64; 2],
    settings: &PassSettings,
) -> ArcLength<impl Fn(f64) -> f64 + 's> {
    let PassSettings { ball_mm, chord_mm, step_mm, .. } = *settings;
    let is_over_edge = surface.is_over_edge();
    let per_parameter = move |v: f64| {
        let [_, along] = curvatures_per_mm(surface, [u, v]);
        let chord = contact_chord(ball_mm, chord_mm, along);
        let chord = chord.map(|chord| if is_over_edge { chord.centres_mm } else { chord.surface_mm });
        let height_mm = if is_over_edge { ball_mm } else { 0.0 };
        surface.speed_mm([u, v], height_mm) / chord.unwrap_or(STEP_LEAST_MM).min(step_mm)
    };
    ArcLength::new(vs, per_parameter)
}

/// Normal curvatures along the first and the second parameter, positive if convex.
fn curvatures_per_mm(surface: &dyn Surface, at: [f64; 2]) -> [f64; 2] {
    let jet = surface.jet(at);
    // On an edge the derivatives define no normal.
    let is_over_edge = surface.is_over_edge();
    let normal =
        if is_over_edge { surface.point_and_normal(at).1 } else { jet.u.cross(&jet.v).normalize() * surface.outward() };
    [-jet.uu.dot(&normal) / jet.u.norm_squared(), -jet.vv.dot(&normal) / jet.v.norm_squared()]
}

impl PassLines {
    /// Contact points of each line from the leading to the trailing edge, with what is left at a place.
    pub fn contacts(
        &self,
        surface: &dyn Surface,
        left_mm: impl Fn([f64; 2], &Point) -> f64,
    ) -> Vec<Vec<RepairContact>> {
        let line = |u: &f64| {
            let curve = chords(surface, *u, self.vs, &self.settings);
            let contact = |v: f64| contact(surface, [*u, v], &left_mm);
            curve.equal_arcs(self.points).into_iter().map(contact).collect()
        };
        self.us.iter().map(line).collect()
    }
}

/// (1)
fn contact(surface: &dyn Surface, at: [f64; 2], left_mm: impl Fn([f64; 2], &Point) -> f64) -> RepairContact {
    let displaced = |at: [f64; 2]| {
        let (point, normal) = surface.point_and_normal(at);
        let left = left_mm(at, &point);
        (point + normal * left, left)
    };
    let ranges = surface.ranges();
    let slope = |k: usize| {
        let h = (ranges[k][1] - ranges[k][0]) * DIFFERENCE;
        let (mut after, mut before) = (at, at);
        after[k] = (at[k] + h).min(ranges[k][1]);
        before[k] = (at[k] - h).max(ranges[k][0]);
        (displaced(after).0 - displaced(before).0) / (after[k] - before[k])
    };
    let (point, left_mm) = displaced(at);
    let across = slope(0).cross(&slope(1)).try_normalize(FLAT_MM2).map(|normal| normal * surface.outward());
    // On an edge the surface has no extent unless it is displaced.
    let normal = across.unwrap_or_else(|| surface.point_and_normal(at).1);
    RepairContact { at, point, normal, left_mm }
}

/// Heights of rough layers (2), from the highest; none if nothing stands above the rough allowance.
pub fn layer_heights_mm(greatest_mm: f64, rough_mm: f64, depth_mm: f64) -> Vec<f64> {
    let count = libm::ceil((greatest_mm - rough_mm) / depth_mm).max(0.0) as usize;
    (1..=count).map(|k| rough_mm + (count - k) as f64 * depth_mm).collect()
}

/// Runs of a line on which the ball cuts.
pub fn runs(line: &[RepairContact], is_cut: impl Fn(&RepairContact) -> bool) -> Vec<Vec<RepairContact>> {
    let marks: Vec<bool> = line.iter().map(is_cut).collect();
    // One point beyond each end: the border lies between.
    let is_near = |k: usize| marks[k.saturating_sub(1)..(k + 2).min(marks.len())].contains(&true);
    let kept: Vec<Option<RepairContact>> = line.iter().enumerate().map(|(k, at)| is_near(k).then_some(*at)).collect();
    let runs = kept.split(Option::is_none).map(|run| run.iter().flatten().copied().collect());
    runs.filter(|run: &Vec<_>| run.len() > 1).collect()
}
