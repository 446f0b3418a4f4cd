//! Swept and remaining volumes of the ring, compared with closed forms.

use core::f64::consts::{FRAC_PI_4, TAU};

use arcfeed_plan::cutter::{CupMill, ToolPart};
use arcfeed_plan::frame::slot_frame;
use arcfeed_plan::geometry::blisk::{Blank, Revolution, Slot};
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::path::Step;
use arcfeed_plan::proof::earlier::Earlier;
use arcfeed_plan::proof::floor::Floor;
use arcfeed_plan::proof::motion::Motion;
use arcfeed_plan::proof::remaining::{Map, RemainingMaterial, Ring, SlotWalls, leaves};
use arcfeed_plan::proof::removal::{RemovedVolumes, Stock, removed};
use arcfeed_plan::proof::section::Section;
use arcfeed_plan::vector::{Flat, Point, Vector};
use nalgebra::Rotation3;

use crate::proof_cases::{GAP_MM, arc, published_tool, step};

const MM_PER_IN: f64 = 25.4;

/// Fields between the name and the unit of one of the 28 rows about cup mills.
struct Row<'r> {
    name: &'r str,
    area_mm2: f64,
}

fn rows() -> Vec<Row<'static>> {
    let lines = include_str!("../machine/stock/mrr_checks.csv").lines().map(|line| line.trim_start_matches('"'));
    let cups = lines.filter(|line| line.starts_with("cup ") && line.contains("ADDED area"));
    cups.map(|line| {
        let (name, rest) = line.split_once("ADDED area").expect("an area");
        let value: f64 = rest.split(',').nth(1).expect("a value").parse().expect("a number");
        Row { name, area_mm2: value * MM_PER_IN * MM_PER_IN }
    })
    .collect()
}

impl Row<'_> {
    fn number(&self, after: &str) -> Option<f64> {
        let rest = self.name.split_once(after)?.1;
        rest.split(['d', ' ']).next()?.trim_end_matches(':').parse().ok()
    }
}

/// Cells that the ring clears while it turns, less those it covers at the start.
fn swept_mm2(row: &Row<'_>, cell_mm: f64) -> f64 {
    let tool =
        CupMill { outer_radius_mm: 5.06205 * MM_PER_IN, inner_radius_mm: 4.43706 * MM_PER_IN, ..published_tool() };
    let tool = CupMill { insert_radius_mm: 0.0, ..tool };
    let radius_mm = if row.name.contains("interior") { tool.inner_radius_mm } else { tool.outer_radius_mm };
    let line = row.number("n@").map(|deg| (deg.to_radians(), row.number("c=").expect("an offset") * MM_PER_IN));
    let whole = arc(radius_mm, 0.0, [0.0, row.number("phi=").expect("an angle")]);
    let start = step(whole.from, whole.from, None);
    let [before, after] = [start, whole].map(|way| Floor::new(&tool, &[way]));
    let cells = (-265.0 / cell_mm) as i32..(265.0 / cell_mm) as i32;
    let place = |x: i32, y: i32| Flat::new((f64::from(x) + 0.5) * cell_mm, (f64::from(y) + 0.5) * cell_mm);
    let is_stock = |at: &Flat| line.is_none_or(|(rad, offset)| at.x * libm::cos(rad) + at.y * libm::sin(rad) >= offset);
    let places = cells.clone().flat_map(|x| cells.clone().map(move |y| place(x, y))).filter(|at| is_stock(at));
    let swept = places.filter(|at| after.at_mm(at).is_finite() && before.at_mm(at).is_infinite());
    swept.count() as f64 * cell_mm * cell_mm
}

/// Cells on a border are in or out as if by chance: each is off by half its area at most, one in three of that in the mean of squares, and a
/// border of length l crosses 4 l / (pi h) of them.
fn sigma_mm2(border_mm: f64, cell_mm: f64) -> f64 {
    cell_mm * cell_mm * libm::sqrt(border_mm / cell_mm / FRAC_PI_4 / 12.0)
}

#[test]
fn the_floor_of_a_turn_is_the_area_of_the_independent_program() {
    let rows = rows();
    assert_eq!(rows.len(), 28);
    for row in rows {
        let cell_mm = if row.area_mm2 < 10_000.0 { 0.5 } else { 1.0 };
        let (swept_mm2, both_borders_mm) = (swept_mm2(&row, cell_mm), 2.0 * TAU * (5.06205 + 4.43706) * MM_PER_IN);
        let off_mm2 = swept_mm2 - row.area_mm2;
        println!("{}{:.1} mm2, off by {off_mm2:.1} ({:.3} %)", row.name, row.area_mm2, off_mm2 / row.area_mm2 * 100.0);
        assert!(off_mm2.abs() < 3.0 * sigma_mm2(both_borders_mm, cell_mm), "{}", row.name);
    }
}

/// A tool that stands along the part's x: slot x, y, z are the part's y, z, x.
fn across_rotor() -> Rotation3<f64> {
    slot_frame(&Vector::x()).expect("a frame")
}

fn small_tool(insert_radius_mm: f64) -> CupMill {
    CupMill { outer_radius_mm: 40.0, inner_radius_mm: 30.0, insert_radius_mm, ..published_tool() }
}

/// Two plane walls at x = 10 and -10 with y from -8 to 8 and z from 40 to 60 of the slot frame, and a hub of radius 30. Part frame.
fn plane_slot() -> (Slot, Revolution) {
    let wall = |x: f64, outward: Vector| {
        let row = |z: f64| (0..5).map(|k| Point::new(x, f64::from(k) * 4.0 - 8.0, z)).collect();
        let face = Face::through(&[row(40.0), row(46.0), row(53.0), row(60.0)], outward).expect("a plane");
        face.turned(&across_rotor().inverse())
    };
    let hub = Revolution { profile_mm: vec![[-20.0, 30.0], [20.0, 30.0]] };
    (Slot { pressure: wall(10.0, -Vector::x()), suction: wall(-10.0, Vector::x()) }, hub)
}

/// Along the pressure side's offset by 0.5 mm, 0.2 mm beside it.
fn along_the_wall() -> [Step; 1] {
    [step([-30.7, -5.0, 50.0], [-30.7, 5.0, 50.0], None)]
}

const ROWS: usize = 11;
const COLUMNS: usize = 9;

fn left(tool: &CupMill) -> RemainingMaterial {
    let (slot, hub) = plane_slot();
    let walls = SlotWalls::new(&slot, &hub, 0.5, across_rotor()).expect("walls");
    let motions = along_the_wall().map(|step| Motion::new(&step));
    let ring = Ring { sections: &Section::of(tool, ToolPart::Ring), motions: &motions, gap_mm: GAP_MM };
    leaves(&[(ring, Rotation3::identity())], &walls, [ROWS, COLUMNS])
}

/// Compares a map with what is known at each y and z (or share of the way across).
fn assert_map(map: &Map, exact_mm: impl Fn(f64, f64) -> f64) {
    assert_eq!((map.rows(), map.columns), (ROWS, COLUMNS));
    for (k, value_mm) in map.values_mm.iter().enumerate() {
        let y = (k % COLUMNS) as f64 / (COLUMNS - 1) as f64 * 16.0 - 8.0;
        let exact_mm = exact_mm(y, (k / COLUMNS) as f64 / (ROWS - 1) as f64);
        assert!((value_mm - exact_mm).abs() < GAP_MM, "{k}: {value_mm} {exact_mm}");
    }
}

#[test]
fn material_left_on_plane_walls_is_the_gap_and_the_corner_below() {
    let left = left(&small_tool(2.0));
    // Above the corner the gap itself, below it the way to the corner's circle.
    let wall = |gap_mm: f64, v: f64| libm::hypot(gap_mm + 2.0, (52.0 - (40.0 + 20.0 * v)).max(0.0)) - 2.0;
    assert_map(&left.pressure, |y, v| wall(libm::hypot(40.2, (y.abs() - 5.0).max(0.0)) - 40.0, v));
    // The inner circle comes nearest where the tool is farthest along.
    assert_map(&left.suction, |y, v| wall(30.0 - libm::hypot(21.2, y.abs() + 5.0), v));
    let half_rad = libm::atan2(9.5, 40.0);
    assert_map(&left.hub, |y, across| {
        let at = [30.5 * libm::sin(half_rad * (1.0 - 2.0 * across)), 30.5 * libm::cos(half_rad * (1.0 - 2.0 * across))];
        let poses = (0..=2000).map(|k| f64::from(k) / 200.0 - 5.0);
        let beside = poses.map(|along| libm::hypot(at[0] + 30.7, y - along));
        let distance = |radius_mm| small_tool(2.0).distance_of_mm(ToolPart::Ring, radius_mm, at[1] - 50.0);
        beside.map(distance).fold(f64::INFINITY, f64::min)
    });
}

fn taken(tool: &CupMill, steps: &[Step], blank: Blank, cell_mm: f64) -> RemovedVolumes {
    let (slot, hub) = plane_slot();
    let walls = SlotWalls::new(&slot, &hub, 0.5, across_rotor()).expect("walls");
    let stock = Stock { blank: &blank, to_slot: across_rotor(), earlier: Earlier::none() };
    removed(&Floor::new(tool, steps), 2, &stock, &walls, cell_mm)
}

/// The integral over a ring, by rings and sectors of its own.
fn over_ring(tool: &CupMill, height: impl Fn(f64, f64) -> f64) -> f64 {
    let (rings, sectors) = (2000, 720);
    let width_mm = (tool.outer_radius_mm - tool.inner_radius_mm) / f64::from(rings);
    let mut sum = 0.0;
    for ring in 0..rings {
        let radius_mm = tool.inner_radius_mm + (f64::from(ring) + 0.5) * width_mm;
        for sector in 0..sectors {
            let x_mm = radius_mm * libm::cos(TAU * (f64::from(sector) + 0.5) / f64::from(sectors));
            sum += height(radius_mm, x_mm) * radius_mm * width_mm * TAU / f64::from(sectors);
        }
    }
    sum
}

#[test]
fn a_plunge_takes_the_ring_from_a_round_blank_level_by_level() {
    let tool = CupMill { outer_radius_mm: 8.0, inner_radius_mm: 5.0, insert_radius_mm: 1.0, ..published_tool() };
    let blank = Blank { radius_mm: 50.0, faces_mm: [-10.0, 10.0] };
    let plunge = |level, from, to| Step { level, ..step([0.0, 0.0, from], [0.0, 0.0, to], None) };
    let found = taken(&tool, &[plunge(0, 60.0, 47.0), plunge(1, 47.0, 45.0)], blank, 0.1);
    let lip = |radius_mm: f64| {
        let beyond_mm = (6.0 - radius_mm).max(radius_mm - 7.0).max(0.0);
        1.0 - libm::sqrt(1.0 - beyond_mm * beyond_mm)
    };
    let down_to = |floor_mm: f64| {
        over_ring(&tool, |radius_mm, x_mm| libm::sqrt(2500.0 - x_mm * x_mm) - lip(radius_mm) - floor_mm)
    };
    let exact_mm3 = [down_to(47.0), down_to(45.0) - down_to(47.0)];
    println!("{exact_mm3:?} {:?} +- {}", found.by_level_mm3, found.error_mm3);
    let off_mm3 = found.by_level_mm3.iter().zip(exact_mm3).map(|(found, exact)| found - exact);
    for off_mm3 in off_mm3.chain([found.total_mm3() - down_to(45.0)]) {
        assert!(off_mm3.abs() < 3.0 * sigma_mm2(TAU * 13.0, 0.1) * 5.0, "{off_mm3}");
    }
    assert!((found.total_mm3() - down_to(45.0)).abs() < found.error_mm3);
}

#[test]
fn a_pass_at_half_the_depth_takes_half_of_what_it_crosses() {
    let found = taken(&small_tool(0.0), &along_the_wall(), Blank { radius_mm: 100.0, faces_mm: [-50.0, 50.0] }, 0.5);
    assert!((found.slot_mm3 - 19.0 * 16.0 * 20.0).abs() < 1e-6, "{}", found.slot_mm3);
    // Crossed where one of the tool's places along y has both circles about it, by squares and roots alone.
    let is_crossed = |x: f64, y: f64| {
        let across = (x + 30.7) * (x + 30.7);
        let [far, near] = [1600.0 - across, 900.0 - across].map(|rest| libm::sqrt(rest.max(0.0)));
        // |y - along| between near and far, along between -5 and 5
        let meets = |low: f64, high: f64| low.max(-5.0) <= high.min(5.0);
        across <= 1600.0 && (meets(y - far, y - near) || meets(y + near, y + far))
    };
    let at = |k: u32, count: u32, wide: f64| (f64::from(k) + 0.5) / f64::from(count) * wide - wide / 2.0;
    let cells = (0..1900).flat_map(|i| (0..1600).map(move |j| is_crossed(at(i, 1900, 19.0), at(j, 1600, 16.0))));
    let exact_ratio = cells.filter(|crossed| *crossed).count() as f64 / (1900.0 * 1600.0) / 2.0;
    println!("{:.4} of the slot, exactly {exact_ratio:.4}", found.share_ratio());
    assert!((found.share_ratio() - exact_ratio).abs() < 1.5 * sigma_mm2(40.0, 0.5) / (19.0 * 16.0));
}
