//! The surface of a stock as a closed mesh: surface nets on the lattice's nodes.
//!
//! Between neighbouring nodes of which one has material and the other has not, the surface crosses, and the ray through both
//! says where. Each cube of eight nodes gets one corner, the mean of the crossings on its twelve edges; each crossing
//! becomes a quad between the four cubes around its edge. Faces square to an axis come out exact, smooth ones to
//! second order in the step; sharp edges are cut off by up to half a step, and what is thinner than a step may be lost.
//!
//! The rays along z decide which nodes have material; where another ray differs, its node lies on the surface to the last
//! bit. So the mesh is closed whatever is in the rays.
//!
//! Source: S. F. F. Gibson, "Constrained elastic surface nets", 1998, without its relaxation.

use std::collections::HashMap;
use std::ops::Range;

use super::dexel::{Dexel, Interval};
use super::lattice::Lattice;
use super::mesh::{Mesh, MeshError};
use super::workpiece::Stock;

/// Along z, whose rays decide.
const UPRIGHT: usize = 2;

/// Neighbouring nodes with material, and where it begins and ends.
struct Run {
    nodes: Range<usize>,
    material: Interval,
}

/// Two nodes between which the surface crosses.
struct Crossing {
    axis: usize,
    /// The lower node, counted from one before the first.
    node: [usize; 3],
    at_mm: f64,
    /// Whether the lower node is the one with material.
    leaves: bool,
}

/// Surface of the remaining stock, as a closed mesh of triangles.
///
/// # Errors
/// No node (centre of a cell) has material.
pub fn surface(stock: &Stock) -> Result<Mesh, MeshError> {
    let crossings = crossings(stock);
    let mut numbers: HashMap<[usize; 3], usize> = HashMap::new();
    let mut sums: Vec<([f64; 3], f64)> = Vec::new();
    let mut triangles = Vec::new();
    for crossing in &crossings {
        let point_mm = crossing.point_mm(stock.lattice());
        let quad = crossing.cubes().map(|cube| {
            let number = *numbers.entry(cube).or_insert(sums.len());
            if number == sums.len() {
                sums.push(([0.0; 3], 0.0));
            }
            let (sum, count) = &mut sums[number];
            *sum = [0, 1, 2].map(|axis| sum[axis] + point_mm[axis]);
            *count += 1.0;
            number
        });
        triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
    }
    Mesh::new(sums.into_iter().map(|(sum, count)| sum.map(|x| x / count)).collect(), triangles)
}

impl Crossing {
    fn point_mm(&self, lattice: &Lattice) -> [f64; 3] {
        let mut point_mm = [0, 1, 2].map(|axis| node_mm(lattice, axis, self.node[axis]));
        point_mm[self.axis] = self.at_mm;
        point_mm
    }

    /// The four cubes around it, by their lowest nodes, counter-clockwise as seen from outside.
    fn cubes(&self) -> [[usize; 3]; 4] {
        let [first, second] = Lattice::across(self.axis);
        let mut cubes = [[1, 1], [0, 1], [0, 0], [1, 0]].map(|[back, down]| {
            let mut cube = self.node;
            cube[first] -= back;
            cube[second] -= down;
            cube
        });
        if !self.leaves {
            cubes.reverse();
        }
        cubes
    }
}

/// Coordinate of a node counted from one before the first.
fn node_mm(lattice: &Lattice, axis: usize, node: usize) -> f64 {
    lattice.lowest_mm()[axis] + (node as f64 - 0.5) * lattice.step_mm()
}

fn crossings(stock: &Stock) -> Vec<Crossing> {
    let lattice = stock.lattice();
    let [width, height, _] = lattice.cells();
    let all: Vec<Vec<Run>> = stock.grids()[UPRIGHT].dexels().iter().map(|dexel| runs(dexel, lattice)).collect();
    let none = Vec::new();
    // Columns and rows are counted from one before the first, where there is nothing.
    let at = |x: usize, y: usize| {
        if (1..=width).contains(&x) && (1..=height).contains(&y) { &all[(y - 1) * width + x - 1] } else { &none }
    };
    let mut found = Vec::new();
    for y in 0..=height {
        for x in 0..=width {
            for run in at(x, y) {
                let crossing = |z, at_mm, leaves| Crossing { axis: UPRIGHT, node: [x, y, z], at_mm, leaves };
                found.push(crossing(run.nodes.start, run.material.from_mm, false));
                found.push(crossing(run.nodes.end, run.material.to_mm, true));
            }
            for (axis, next) in [(0, at(x + 1, y)), (1, at(x, y + 1))] {
                for (z, leaves) in differences(at(x, y), next) {
                    let node = [x, y, z + 1];
                    found.push(Crossing { axis, node, at_mm: crossing_mm(stock, axis, node, leaves), leaves });
                }
            }
        }
    }
    found
}

/// Coordinate at which the material ends on the ray through a node and the next one along `axis`.
fn crossing_mm(stock: &Stock, axis: usize, node: [usize; 3], leaves: bool) -> f64 {
    let lattice = stock.lattice();
    let [low_mm, high_mm] = [0, 1].map(|next| node_mm(lattice, axis, node[axis] + next));
    let [column, row] = Lattice::across(axis).map(|across| node[across].wrapping_sub(1));
    let with_material_mm = if leaves { low_mm } else { high_mm };
    let pieces = stock.grids()[axis].dexel(column, row).map_or(&[][..], Dexel::intervals);
    let piece = pieces.iter().find(|piece| piece.from_mm <= with_material_mm && with_material_mm <= piece.to_mm);
    let end_mm = piece.map_or(with_material_mm, |piece| if leaves { piece.to_mm } else { piece.from_mm });
    end_mm.clamp(low_mm, high_mm)
}

/// The nodes of a ray along z that have material.
fn runs(dexel: &Dexel, lattice: &Lattice) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for piece in dexel.intervals() {
        let mut nodes = lattice.cells_between(UPRIGHT, piece.from_mm, piece.to_mm);
        if !nodes.is_empty() && lattice.center_mm(UPRIGHT, nodes.end - 1) >= piece.to_mm {
            nodes.end -= 1;
        }
        match runs.last_mut() {
            _ if nodes.is_empty() => {}
            Some(last) if last.nodes.end == nodes.start => {
                last.nodes.end = nodes.end;
                last.material.to_mm = piece.to_mm;
            }
            _ => runs.push(Run { nodes, material: *piece }),
        }
    }
    runs
}

/// The nodes that are in one of two rays only, with whether that is the first.
fn differences(first: &[Run], second: &[Run]) -> Vec<(usize, bool)> {
    let is_in = |runs: &[Run], node: usize| runs.iter().any(|run| run.nodes.contains(&node));
    let only_in = |one: &[Run], other: &[Run], is_first: bool| {
        let nodes = one.iter().flat_map(|run| run.nodes.clone());
        nodes.filter(|node| !is_in(other, *node)).map(|node| (node, is_first)).collect::<Vec<_>>()
    };
    let mut found = only_in(first, second, true);
    found.extend(only_in(second, first, false));
    found
}
