//! Clearances against dense samples of way and surface: no sample may be below the lower bound, and some must come near it.

use arcfeed_nc::modal::Turn;
use arcfeed_plan::cutter::{CupMill, ToolPart};
use arcfeed_plan::geometry::mesh::Triangle;
use arcfeed_plan::path::Step;
use arcfeed_plan::vector::{Flat, Point};
use fastrand::Rng;

use crate::proof_cases::{body, least, poses, step};

/// Between poses, and points along each side of a triangle.
const SPACING_MM: f64 = 0.1;
const SIDE: u32 = 11;

fn between(random: &mut Rng, low: f64, high: f64) -> f64 {
    low + random.f64() * (high - low)
}

fn tool(random: &mut Rng) -> CupMill {
    let inner_radius_mm = between(random, 20.0, 60.0);
    let width_mm = between(random, 5.0, 15.0);
    let cavity_depth_mm = between(random, 20.0, 30.0);
    CupMill {
        outer_radius_mm: inner_radius_mm + width_mm,
        inner_radius_mm,
        insert_radius_mm: between(random, 0.0, width_mm / 2.0),
        cavity_depth_mm,
        height_mm: cavity_depth_mm + 10.0,
        holder_mm: vec![[between(random, 5.0, 90.0), 20.0], [between(random, 5.0, 90.0), 10.0]],
        active_teeth: 1,
    }
}

fn way(random: &mut Rng) -> Vec<Step> {
    let mut at = [between(random, -20.0, 20.0), between(random, -20.0, 20.0), between(random, -10.0, 10.0)];
    let mut steps = Vec::new();
    for _ in 0..3 {
        let to = [between(random, -20.0, 20.0), between(random, -20.0, 20.0), between(random, -10.0, 10.0)];
        steps.push(step(at, to, None));
        let centre = Flat::new(between(random, -60.0, 60.0), between(random, -60.0, 60.0));
        let (sin, cos) = libm::sincos(between(random, -0.5, 0.5));
        let off = [to[0] - centre.x, to[1] - centre.y];
        at = [centre.x + cos * off[0] - sin * off[1], centre.y + sin * off[0] + cos * off[1], to[2]];
        steps.push(step(to, at, Some((centre, if sin > 0.0 { Turn::Ccw } else { Turn::Cw }))));
    }
    steps
}

fn points([a, b, c]: &Triangle) -> Vec<Point> {
    let inner = (0..SIDE).flat_map(|i| (0..SIDE - i).map(move |j| [i, j].map(|k| f64::from(k) / f64::from(SIDE - 1))));
    inner.map(|[s, t]| a + (b - a) * s + (c - a) * t).collect()
}

fn triangle(random: &mut Rng) -> Triangle {
    let place = [-80.0, -80.0, -40.0].map(|low| between(random, low, -low));
    [(); 3].map(|()| Point::from(place.map(|middle| middle + between(random, -10.0, 10.0))))
}

#[test]
fn no_sample_is_nearer_than_the_certified_bound() {
    let (mut collisions, mut largest_off_mm, mut samples) = (0, 0.0_f64, 0);
    for seed in 0..30 {
        let mut random = Rng::with_seed(seed);
        let (tool, steps) = (tool(&mut random), way(&mut random));
        let triangles: Vec<Triangle> = (0..4).map(|_| triangle(&mut random)).collect();
        let points: Vec<Point> = triangles.iter().flat_map(points).collect();
        let poses: Vec<Point> = steps.iter().flat_map(|step| poses(step, SPACING_MM)).collect();
        for part in [ToolPart::Ring, ToolPart::Body, ToolPart::Holder] {
            let found = least(&tool, part, &steps, &body(triangles.clone(), 0.0));
            let off = |pose: &Point, point: &Point| (libm::hypot(point.x - pose.x, point.y - pose.y), point.z - pose.z);
            let pairs = poses.iter().flat_map(|pose| points.iter().map(move |point| off(pose, point)));
            let distances_mm = pairs.map(|(radius_mm, height_mm)| tool.distance_of_mm(part, radius_mm, height_mm));
            let sampled_mm = distances_mm.fold(f64::INFINITY, f64::min);
            samples += poses.len() * points.len();
            let [low_mm, high_mm] = found.bounds_mm;
            collisions += usize::from(high_mm < 0.0);
            // The tool's own distance is exact outside only; the sign is right in any case.
            if sampled_mm > 0.0 {
                assert!(sampled_mm >= low_mm, "seed {seed}, {part:?}: {sampled_mm} below {low_mm}");
                largest_off_mm = largest_off_mm.max(sampled_mm - high_mm);
                let place = found.place.expect("a place");
                let off = off(&place.tool, &place.point);
                assert!((tool.distance_of_mm(part, off.0, off.1) - high_mm).abs() < 1e-9, "seed {seed}, {part:?}");
            } else {
                assert!(low_mm <= 0.0, "seed {seed}, {part:?}: a sample is inside, yet {low_mm}");
            }
        }
    }
    println!(
        "{samples} samples, {collisions} collisions of 90, samples outside of the tool up to {largest_off_mm:.4} mm above what was found"
    );
    assert!((20..80).contains(&collisions), "{collisions} collisions of 90");
}
