//! Workpiece after a plan, in dexels: no mark in blades and hub, no pillar in the passage, the volume of a second count.
//!
//! The dexels cut the moves of the plan with the whole mill, at any tilt. What they should leave is counted by itself: a point is
//! gone if it lies in the mill at one of its places, which for a straight way along the axis is a distance from the axis.

use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::solid::Block;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::plunge::assembly::ball_mm;
use arcfeed_plan::plunge::boundary::Boundary;
use arcfeed_plan::plunge::field::{Field, WallSide};
use arcfeed_plan::plunge::line::Fit;
use arcfeed_plan::plunge::mill::PlungeMill;
use arcfeed_plan::plunge::passage::{Passage, PlungeRequirements};
use arcfeed_plan::plunge::passage_plan::{PassagePlan, Plunge};
use arcfeed_plan::vector::Point;
use arcfeed_tests::of_full_set;

use super::passage::rotor_b;
use super::plans::{least_mm, samples};
use crate::published_rotor;

/// Height of the mill that cuts: above the blank everywhere.
const HEIGHT_MM: f64 = 60.0;
/// Precision to which the plan keeps the allowance.
const KEPT_MM: f64 = 0.01;

/// A rotor, its mill and the plan of a passage.
pub struct Planned {
    pub blisk: Blisk,
    field: Field,
    pub mill: PlungeMill,
    needs: PlungeRequirements,
    pub plan: PassagePlan,
}

impl Planned {
    fn new(blisk: Blisk, [radius_mm, width_mm]: [f64; 2], [allowance_mm, cusp_mm]: [f64; 2]) -> Self {
        let mill = PlungeMill {
            radius_mm,
            corner_radius_mm: 0.4,
            core_radius_mm: 0.0,
            width_max_mm: width_mm,
            length_mm: 12.0,
            neck_mm: vec![[radius_mm - 0.5, 38.0]],
            holder_mm: vec![[20.0, 40.0]],
            teeth: 3,
        };
        let needs = PlungeRequirements { allowance_mm, cusp_mm, fit: Fit::Gap, clearance_mm: 5.0, relief_mm: 0.2 };
        Planned::of(blisk, mill, needs)
    }

    /// Plan of a rotor.
    pub fn of(blisk: Blisk, mill: PlungeMill, needs: PlungeRequirements) -> Self {
        let field = Field::new(&blisk);
        let turning_mm = blisk.blank.radius_mm;
        let plan = Passage {
            blisk: &blisk,
            field: &field,
            mill: &mill,
            needs: &needs,
            turning_mm,
            turning_ball_mm: ball_mm(&blisk.blank),
        }
        .plan()
        .unwrap();
        Planned { blisk, field, mill, needs, plan }
    }

    /// Box about the passage within the faces of the blank.
    pub fn block(&self) -> Block {
        let reach_mm = self.mill.radius_mm + 2.0;
        let tops = self.plan.plunges.iter().map(|plunge| plunge.tip + plunge.axis * 50.0);
        let ends: Vec<Point> = self.plan.plunges.iter().map(|plunge| plunge.tip).chain(tops).collect();
        let [from_mm, to_mm] = self.blisk.blank.faces_mm;
        let end = |axis: usize, sign: f64| {
            let ends = ends.iter().map(|end| sign * end[axis]).fold(f64::NEG_INFINITY, f64::max);
            // Beyond the blank's radius there is no material.
            sign * (ends + reach_mm).min(self.blisk.blank.radius_mm)
        };
        Block { lowest_mm: [end(0, -1.0), end(1, -1.0), from_mm], highest_mm: [end(0, 1.0), end(1, 1.0), to_mm] }
    }

    /// Block after the plan.
    fn stock(&self, step_mm: f64) -> Stock {
        let mut stock = Stock::new(&self.block(), step_mm, 1 << 30).unwrap();
        let corner_mm = self.mill.corner_radius_mm;
        let tool = Tool::bull_nose([self.mill.radius_mm, corner_mm], HEIGHT_MM, 1e-3).unwrap();
        for plunge in &self.plan.plunges {
            for ends in plunge.places().windows(2) {
                let pose = |place: &Point| Pose {
                    tip_mm: (plunge.to_tool.inverse() * place).coords.into(),
                    axis: plunge.axis.into(),
                };
                let sweeps = Move::Straight { from: pose(&ends[0]), to: pose(&ends[1]) }.sweeps(&tool, 1e-3).unwrap();
                stock.cut(&tool, &sweeps).unwrap();
            }
        }
        stock
    }

    /// Whether the mill reaches a point on a plunge: in the hole, or in that which the step off the wall widens.
    pub fn is_reached(&self, plunge: &Plunge, point: &Point) -> bool {
        let off = plunge.to_tool * (point - plunge.tip);
        let (radius_mm, corner_mm, relief_mm) = (self.mill.radius_mm, self.mill.corner_radius_mm, plunge.relief_mm);
        if off.y.abs() > radius_mm || off.x.abs() > radius_mm + relief_mm.abs() {
            return false;
        }
        let is_in = |x: f64, up: f64| {
            let across_mm = (libm::hypot(x, off.y) - (radius_mm - corner_mm)).max(0.0);
            up >= 0.0 && libm::hypot(across_mm, (corner_mm - up).max(0.0)) <= corner_mm
        };
        // On the way off the wall the end rises by as much as it goes aside.
        (0..=8).any(|part| {
            let part = f64::from(part) / 8.0;
            is_in(off.x - part * relief_mm, off.z - part * relief_mm.abs())
        })
    }

    /// Coordinates of a point in the planes before and behind it; `None` beyond the outer planes.
    fn beside(&self, point: &Point) -> Option<[PlanePoint; 2]> {
        let planes = &self.plan.planes;
        let above = planes.partition_point(|plane| plane.z_mm < point.z);
        let pair = above.checked_sub(1).and_then(|below| planes.get(below).zip(planes.get(above)))?;
        Some([pair.0, pair.1].map(|plane| PlanePoint::new(&plane.boundary, point)))
    }

    /// Whether a point of the blank is farther than `beyond_mm` within the boundary axes of both planes beside it, and
    /// `above_mm` above the hub.
    fn is_open(&self, point: &Point, beyond_mm: f64, above_mm: f64) -> bool {
        let is_between = |at: PlanePoint| at.from_lines_mm.iter().all(|from_mm| *from_mm >= beyond_mm);
        libm::hypot(point.x, point.y) < self.blisk.blank.radius_mm
            && self.beside(point).is_some_and(|beside| beside.into_iter().all(is_between))
            && self.blisk.hub.height_mm(point) >= above_mm
    }

    /// Greatest height above the allowance of what the flat ends leave on the hub: their lift, the step to the next plane along
    /// the lean, and the hub's roundness between neighbouring axes.
    fn floor_mm(&self) -> f64 {
        let planes = &self.plan.planes;
        let spacing_mm = planes.windows(2).map(|pair| pair[1].z_mm - pair[0].z_mm).fold(0.0, f64::max);
        let of = |plunge: &Plunge| {
            let beside_mm = planes[plunge.plane].spacing_mm.min(self.mill.radius_mm);
            plunge.lift_mm
                + (spacing_mm + beside_mm) * libm::tan(plunge.lean_rad)
                + beside_mm * beside_mm / (2.0 * libm::hypot(plunge.tip.x, plunge.tip.y))
        };
        self.plan.plunges.iter().map(of).fold(0.0, f64::max)
    }
}

/// Point in a plane of the plan.
#[derive(Clone, Copy, Debug)]
struct PlanePoint {
    /// Distances from both boundary axes along x, positive between them.
    from_lines_mm: [f64; 2],
}

impl PlanePoint {
    fn new(boundary: &Boundary, point: &Point) -> Self {
        let (sin, cos) = libm::sincos(boundary.middle_rad);
        let [x, y] = [point.y * cos - point.x * sin, point.x * cos + point.y * sin];
        let line_mm = |side: usize| {
            let [roof, floor] = [boundary.roof[side], boundary.floor[side]];
            floor.x + (roof.x - floor.x) * (y - floor.y) / (roof.y - floor.y)
        };
        PlanePoint { from_lines_mm: [x - line_mm(0), line_mm(1) - x] }
    }
}

/// Nodes of a lattice with their cells.
pub fn nodes(lattice: &Lattice) -> impl Iterator<Item = ([usize; 3], Point)> + '_ {
    let [columns, rows, levels] = lattice.cells();
    let cells = (0..columns).flat_map(move |i| (0..rows).flat_map(move |j| (0..levels).map(move |k| [i, j, k])));
    cells.map(|cell| (cell, Point::from([0, 1, 2].map(|axis: usize| lattice.center_mm(axis, cell[axis])))))
}

/// Whether a node has material, by the ray along z.
pub fn is_material(stock: &Stock, cell: [usize; 3]) -> bool {
    let z_mm = stock.lattice().center_mm(2, cell[2]);
    stock.grids()[2].dexel(cell[0], cell[1]).is_some_and(|dexel| dexel.contains(z_mm))
}

/// Places at which the mill has left a surface: ends of material within the block.
pub fn surface(stock: &Stock, block: &Block) -> Vec<Point> {
    let lattice = stock.lattice();
    let mut places = Vec::new();
    for grid in stock.grids() {
        let axis = grid.axis();
        let [columns, _] = lattice.size(axis);
        let [across, along] = Lattice::across(axis);
        for (ray, dexel) in grid.dexels().iter().enumerate() {
            let mut at = Point::origin();
            at[across] = lattice.center_mm(across, ray % columns);
            at[along] = lattice.center_mm(along, ray / columns);
            for end_mm in dexel.intervals().iter().flat_map(|piece| [piece.from_mm, piece.to_mm]) {
                at[axis] = end_mm;
                if block.lowest_mm[axis] < end_mm && end_mm < block.highest_mm[axis] {
                    places.push(at);
                }
            }
        }
    }
    places
}

/// Distances from blades and hub of all that the mill has left, and the nearest places to dense samples of the blades.
pub fn no_mark_is_in_blades_or_hub(planned: &Planned, stock: &Stock) {
    let places = surface(stock, &planned.block());
    // Places follow one another along rows of rays.
    let mut last = [None; 2];
    let mut from_blades = |place: &Point| {
        let sides = [WallSide::Left, WallSide::Right].into_iter().zip(&mut last);
        let distances_mm = sides.map(|(side, last)| {
            let (distance_mm, on) = planned.field.distance_after(side, place, *last);
            *last = Some(on);
            distance_mm
        });
        distances_mm.fold(f64::INFINITY, f64::min)
    };
    let mut found: Vec<(f64, Point)> = places.iter().map(|place| (from_blades(place), *place)).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let from_hub_mm = places.iter().map(|place| planned.blisk.hub.height_mm(place)).fold(f64::INFINITY, f64::min);
    let samples = samples(&planned.blisk);
    let sampled = found.iter().take(of_full_set(2_000, 200)).map(|(_, place)| least_mm(&samples, place));
    let sampled_mm = sampled.fold(f64::INFINITY, f64::min);
    let allowance_mm = planned.needs.allowance_mm;
    println!(
        "{} places that the mill has left: {:.4} mm from the blades ({sampled_mm:.4} by samples), {from_hub_mm:.4} mm from the hub, \
         of {allowance_mm}",
        found.len(),
        found[0].0
    );
    assert!(found[0].0 >= allowance_mm - KEPT_MM && sampled_mm >= allowance_mm - KEPT_MM);
    assert!(from_hub_mm >= allowance_mm - KEPT_MM);
}

/// Material between the boundary axes, and volume of all that is left in reach of the mill, against points in no place of it.
fn no_pillar_stands_and_the_rest_has_the_volume_of_points(planned: &Planned, stock: &Stock) {
    let allowance_mm = planned.needs.allowance_mm;
    let floor_mm = planned.floor_mm();
    let lattice = stock.lattice();
    let (mut pillars, mut clear, mut left) = (0, 0, [0_usize; 2]);
    let reach_mm = planned.mill.radius_mm + allowance_mm;
    for (cell, node) in nodes(lattice) {
        if planned.is_open(&node, 0.0, allowance_mm + floor_mm) {
            clear += 1;
            pillars += usize::from(is_material(stock, cell));
        }
        // Both counts are at the nodes: what is left is thinner than a cell, and places beside them have another volume by up to 4 %.
        if planned.is_open(&node, -reach_mm, 0.0) {
            left[0] += usize::from(is_material(stock, cell));
            left[1] += usize::from(!planned.plan.plunges.iter().any(|plunge| planned.is_reached(plunge, &node)));
        }
    }
    let [found_mm3, expected_mm3] = left.map(|count| count as f64 * lattice.area_mm2() * lattice.step_mm());
    println!(
        "{clear} nodes between the axes, {pillars} with material above {floor_mm:.3} mm on the hub's allowance; left {found_mm3:.0} mm3, \
         by points in no place of the mill {expected_mm3:.0}: {:+.2} %",
        (found_mm3 / expected_mm3 - 1.0) * 1e2
    );
    assert!(clear > 10_000 && pillars == 0);
    assert!((found_mm3 / expected_mm3 - 1.0).abs() < 0.01);
}

/// Cuts the plan in dexels and holds what is left to all of the above.
pub fn check(planned: &Planned) {
    let stock = planned.stock(of_full_set(0.25, 0.4));
    no_mark_is_in_blades_or_hub(planned, &stock);
    no_pillar_stands_and_the_rest_has_the_volume_of_points(planned, &stock);
}

#[test]
fn point_4_the_dexels_of_impeller_13_after_its_plan_have_allowance_no_pillar_and_the_volume_of_points() {
    check(&Planned::new(rotor_b(), [6.0, 5.0], [0.8, 0.2]));
}

#[test]
fn point_4_the_dexels_of_blisk_19_after_its_plan_have_allowance_no_pillar_and_the_volume_of_points() {
    check(&Planned::new(published_rotor::blisk(), [5.0, 5.0], [0.889, 0.222]));
}
