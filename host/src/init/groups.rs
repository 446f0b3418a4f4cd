//! Groups of arcs with the same tool, plane and direction, and with equal radii.

use arcfeed_model::cut::RADIUS_MATCH_RATIO;
use arcfeed_nc::modal::{Plane, Turn};
use arcfeed_units::Nm;

use super::survey::FoundArc;

/// Arcs of a program with the same tool, plane, direction and radius.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// T number of the cutting tool; `None` before the first.
    pub tool: Option<i64>,
    /// Plane of the arcs.
    pub plane: Plane,
    /// Direction of the arcs: clockwise or counter-clockwise.
    pub turn: Turn,
    /// Mean radius, mm.
    pub radius_mm: f64,
    /// Number of arcs.
    pub arcs: usize,
    /// Number of arcs that also move along the axis square to their plane.
    pub helices: usize,
    /// Number of arcs that round a corner of a contour.
    pub corners: usize,
    /// N numbers of the first and of the last arc that has one; `None` if none has.
    pub sequence: Option<[i64; 2]>,
    /// First and last line of the program with such an arc, counted from 1.
    pub lines: [usize; 2],
    /// Z coordinates at which the arcs start, each once, in ascending order.
    pub levels: Vec<Nm>,
    /// Feeds per minute of the arcs, each once, in ascending order.
    pub feeds: Vec<Nm>,
    /// Smallest and largest angle of the arcs (sweep), rad.
    pub sweep_rad: [f64; 2],
}

/// Groups of these arcs, sorted by tool and plane, then by radius and direction.
pub fn group(arcs: &[FoundArc]) -> Vec<Group> {
    let mut sorted: Vec<&FoundArc> = arcs.iter().collect();
    let key = |arc: &FoundArc| (arc.tool, arc.plane.axes());
    sorted.sort_by(|a, b| key(a).cmp(&key(b)).then(a.radius_mm.total_cmp(&b.radius_mm)).then(a.line.cmp(&b.line)));
    let mut clusters: Vec<Vec<&FoundArc>> = Vec::new();
    for arc in sorted {
        match clusters.last_mut() {
            Some(cluster) if key(cluster[0]) == key(arc) && same_radius(cluster[0].radius_mm, arc.radius_mm) => {
                cluster.push(arc);
            }
            _ => clusters.push(vec![arc]),
        }
    }
    let by_turn = clusters.into_iter().flat_map(|cluster| {
        [Turn::Ccw, Turn::Cw].map(|turn| cluster.iter().copied().filter(|arc| arc.turn == turn).collect::<Vec<_>>())
    });
    by_turn.filter(|arcs| !arcs.is_empty()).map(|arcs| Group::of(&arcs)).collect()
}

/// Whether two radii are so close that a cut rule cannot distinguish them.
pub fn same_radius(a_mm: f64, b_mm: f64) -> bool {
    libm::fabs(a_mm - b_mm) <= RADIUS_MATCH_RATIO * a_mm.min(b_mm)
}

impl Group {
    fn of(arcs: &[&FoundArc]) -> Self {
        let count = |is: fn(&FoundArc) -> bool| arcs.iter().filter(|arc| is(arc)).count();
        let numbers = || arcs.iter().filter_map(|arc| arc.sequence);
        let sweeps = arcs.iter().map(|arc| arc.sweep_rad);
        Group {
            tool: arcs[0].tool,
            plane: arcs[0].plane,
            turn: arcs[0].turn,
            radius_mm: arcs.iter().map(|arc| arc.radius_mm).sum::<f64>() / arcs.len() as f64,
            arcs: arcs.len(),
            helices: count(|arc| arc.rises),
            corners: count(|arc| arc.is_corner),
            sequence: numbers().min().zip(numbers().max()).map(|(first, last)| [first, last]),
            lines: [
                arcs.iter().map(|arc| arc.line).min().unwrap_or_default(),
                arcs.iter().map(|arc| arc.line).max().unwrap_or_default(),
            ],
            levels: once(arcs.iter().map(|arc| arc.level)),
            feeds: once(arcs.iter().filter_map(|arc| arc.feed)),
            sweep_rad: [sweeps.clone().fold(f64::INFINITY, f64::min), sweeps.fold(0.0, f64::max)],
        }
    }
}

fn once(values: impl Iterator<Item = Nm>) -> Vec<Nm> {
    let mut values: Vec<Nm> = values.collect();
    values.sort_unstable();
    values.dedup();
    values
}
