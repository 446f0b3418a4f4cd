//! Outlines of a blade's mesh at equal shares of its height.
//!
//! ```text
//! s(p) = (r - r_hub(z)) / (r_tip(z) - r_hub(z))                              (1)
//! ```
//!
//! An outline has a point on every edge of the mesh that passes through its height, on the smooth curve behind the edge.

use std::collections::HashMap;

use crate::vector::Point;

use super::blisk::Revolution;
use super::solid_fault::SolidFault;
use super::surface_mesh::{EdgeKey, SmoothMesh, edge_keys};

/// Largest gap between two surfaces that meet, mm.
const GAP_MM: f64 = 0.05;

/// Points nearer than this count as one, mm.
const SAME_MM: f64 = 1e-4;

/// Halvings that find a place on an edge.
const HALVINGS: u32 = 40;

/// Inner and outer end of the gas path.
#[derive(Clone, Copy)]
pub(super) struct GasPath<'p> {
    pub(super) hub: &'p Revolution,
    pub(super) tip: &'p Revolution,
}

impl GasPath<'_> {
    /// (1)
    pub(super) fn share(&self, point: &Point) -> f64 {
        let low_mm = self.hub.radius_mm(point.z);
        (libm::hypot(point.x, point.y) - low_mm) / (self.tip.radius_mm(point.z) - low_mm)
    }
}

/// Closed outline at a share of the height; the first point is not repeated.
///
/// # Errors
/// There is no single closed outline there.
pub(super) fn outline(
    mesh: &SmoothMesh<'_>,
    shares: &[f64],
    path: &GasPath<'_>,
    share: f64,
) -> Result<Vec<Point>, SolidFault> {
    let is_above = |point: usize| shares[point] >= share;
    let mut next: HashMap<EdgeKey, Vec<EdgeKey>> = HashMap::new();
    let mut order: Vec<EdgeKey> = Vec::new();
    for triangle in &mesh.mesh().triangles {
        let crossed: Vec<EdgeKey> =
            edge_keys(triangle).into_iter().filter(|[from, to]| is_above(*from) != is_above(*to)).collect();
        if let [one, other] = crossed[..] {
            for (from, to) in [(one, other), (other, one)] {
                let ways = next.entry(from).or_default();
                if ways.is_empty() {
                    order.push(from);
                }
                ways.push(to);
            }
        }
    }
    let place = |edge: &EdgeKey| {
        let curve = mesh.curve(*edge);
        let rises = is_above(edge[1]);
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if (path.share(&curve.at(middle)) >= share) == rises { high = middle } else { low = middle }
        }
        curve.at((low + high) / 2.0)
    };
    let chains = chains(&next, &order).into_iter().map(|(edges, is_closed)| {
        let mut points: Vec<Point> = edges.iter().map(place).collect();
        points.dedup_by(|a, b| (*a - *b).norm() < SAME_MM);
        (points, is_closed)
    });
    let (closed, open): (Vec<_>, Vec<_>) =
        chains.filter(|(points, _)| points.len() > 1).partition(|(_, is_closed)| *is_closed);
    let mut loops: Vec<Vec<Point>> = closed.into_iter().map(|(points, _)| points).collect();
    loops.extend(joined(open.into_iter().map(|(points, _)| points).collect(), share)?);
    match loops.len() {
        1 => Ok(loops.remove(0)),
        found => Err(SolidFault::Outlines { found, share_ratio: share }),
    }
}

/// Chains of edges, and whether they are closed.
fn chains(next: &HashMap<EdgeKey, Vec<EdgeKey>>, order: &[EdgeKey]) -> Vec<(Vec<EdgeKey>, bool)> {
    let mut is_used: HashMap<EdgeKey, bool> = HashMap::new();
    let mut found = Vec::new();
    // Open chains first, from their ends.
    let ends = order.iter().filter(|edge| next[*edge].len() == 1);
    for start in ends.chain(order) {
        if is_used.contains_key(start) {
            continue;
        }
        let mut chain = vec![*start];
        is_used.insert(*start, true);
        while let Some(edge) = next[&chain[chain.len() - 1]].iter().find(|edge| !is_used.contains_key(*edge)) {
            chain.push(*edge);
            is_used.insert(*edge, true);
        }
        let is_closed = chain.len() > 2 && next[&chain[chain.len() - 1]].contains(start);
        found.push((chain, is_closed));
    }
    found
}

/// Open chains joined end to end.
fn joined(mut chains: Vec<Vec<Point>>, share: f64) -> Result<Vec<Vec<Point>>, SolidFault> {
    let Some(mut outline) = chains.pop() else { return Ok(Vec::new()) };
    loop {
        let end = outline[outline.len() - 1];
        let ends = chains.iter().enumerate().flat_map(|(at, chain)| {
            [(at, false, (chain[0] - end).norm()), (at, true, (chain[chain.len() - 1] - end).norm())]
        });
        let nearest = ends.min_by(|a, b| a.2.total_cmp(&b.2));
        let closing_mm = (outline[0] - end).norm();
        match nearest {
            Some((at, is_reversed, gap_mm)) if gap_mm <= GAP_MM => {
                let mut chain = chains.remove(at);
                if is_reversed {
                    chain.reverse();
                }
                outline.extend(chain);
            }
            _ if closing_mm <= GAP_MM => {
                outline.dedup_by(|a, b| (*a - *b).norm() < SAME_MM);
                if (outline[0] - outline[outline.len() - 1]).norm() < SAME_MM {
                    outline.pop();
                }
                let mut loops = joined(chains, share)?;
                loops.push(outline);
                return Ok(loops);
            }
            nearest => {
                let gap_mm = nearest.map_or(closing_mm, |(_, _, gap_mm)| gap_mm.min(closing_mm));
                return Err(SolidFault::Gap { gap_mm, share_ratio: share });
            }
        }
    }
}
