//! Repairs over an edge: the strip over it on the blade of examples/blisk-19, whose leading edge is round and whose trailing edge is sharp; feet and heights of
//! points that were made with them; refusals.

use arcfeed_plan::geometry::edge_strip::{BladeEdge, EdgeStrip};
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::geometry::surface::Surface;
use arcfeed_plan::repair::blade::{CloudFault, NominalBlade, sides};
use arcfeed_plan::repair::blend::BlendShape;
use arcfeed_plan::repair::passes::PassSettings;
use arcfeed_plan::repair::plan::{RepairInfeasible, RepairPlan, RepairSettings, plan};
use arcfeed_plan::repair::regions::{Region, RegionSettings};
use arcfeed_plan::repair::scan::NominalSurface;
use arcfeed_plan::vector::{Point, Vector};

use super::blade::blisk;
use super::scan::normal;

const EDGES: [BladeEdge; 2] = [BladeEdge::Leading, BladeEdge::Trailing];
const OLD_MM: f64 = 0.05;
const WELD_MM: f64 = 0.8;
const LEAST_MM: f64 = 0.02;
const SETTINGS: RepairSettings = RepairSettings {
    regions: RegionSettings { threshold_mm: 0.1, width_mm: 4.0, least_mm: LEAST_MM, shape: BlendShape::Cubic },
    passes: PassSettings { ball_mm: 2.5, cusp_mm: 0.01, chord_mm: 0.0025, step_mm: 0.1 },
    spacing_mm: 0.5,
    hole_mm: None,
    rough_mm: 0.3,
    depth_mm: 0.25,
};

/// Measured point with the side, the way from the edge as a share of the side, and the height that it was made with.
struct Made {
    point: Point,
    side: usize,
    way: f64,
    height_mm: f64,
}

/// Unit vector at an angle from `from` in the plane of `from` and `ahead`.
fn turned(from: &Vector, ahead: &Vector, angle: f64) -> Vector {
    let across = (ahead - from * from.dot(ahead)).normalize();
    from * libm::cos(angle) + across * libm::sin(angle)
}

/// Parameter of a side at a way from the edge.
fn side_u(edge: BladeEdge, way: f64) -> f64 {
    if edge == BladeEdge::Leading { way } else { 1.0 - way }
}

/// Places on both sides, spaced by `step_mm` near the edge, and round the edge where the normals differ; made from the faces alone.
fn made(faces: &[Face; 2], edge: BladeEdge, noise_mm: f64, height_mm: impl Fn(usize, f64, f64) -> f64) -> Vec<Made> {
    let mut random = fastrand::Rng::with_seed(31);
    let mut found = Vec::new();
    for row in 0..70 {
        let span = 0.005 + 0.99 * (f64::from(row) + random.f64()) / 70.0;
        for (side, face) in faces.iter().enumerate() {
            // The weld turns about the rounding of the edge: there its points are closer to one another on the nominal surface.
            for k in 0..90 {
                let share = (f64::from(k) + random.f64()) / 90.0;
                let way = 0.95 * (0.3 * share * share * share + 0.7 * share.powi(6)).max(1e-6);
                let height_mm = height_mm(side, way, span) + noise_mm * normal(&mut random);
                let u = side_u(edge, way);
                found.push(Made { point: face.offset(u, span, height_mm), side, way, height_mm });
            }
        }
        let u = side_u(edge, 0.0);
        let [first, last] = [0, 1].map(|k: usize| faces[k].normal(u, span));
        let tip = nalgebra::center(&faces[0].point(u, span), &faces[1].point(u, span));
        let inner =
            nalgebra::center(&faces[0].point(side_u(edge, 0.05), span), &faces[1].point(side_u(edge, 0.05), span));
        let whole = first.angle(&last);
        for k in 0..8 {
            let height_mm = height_mm(0, 0.0, span) + noise_mm * normal(&mut random);
            let direction = turned(&first, &(tip - inner), whole * (f64::from(k) + 0.5) / 8.0);
            found.push(Made { point: tip + direction * height_mm, side: 0, way: 0.0, height_mm });
        }
    }
    found
}

/// Weld about 60 % of the height, 4.5 mm up and down, 5 mm along the pressure and 4 mm along the suction side.
fn weld(side: usize, way: f64, span: f64) -> f64 {
    let along_mm = 26.0 * way / if side == 0 { 5.0 } else { 4.0 };
    let off = libm::hypot((span - 0.6) * 28.6 / 4.5, along_mm);
    let t = ((1.0 - off) * 6.0).clamp(0.0, 1.0);
    OLD_MM + (WELD_MM - OLD_MM) * t * t * (3.0 - 2.0 * t)
}

/// Plan of a repair over an edge from some of the points, and more.
fn planned(
    edge: BladeEdge,
    noise_mm: f64,
    height_mm: impl Fn(usize, f64, f64) -> f64,
    is_kept: impl Fn(&Made) -> bool,
    more: &[Point],
) -> Result<RepairPlan, RepairInfeasible> {
    let blisk = blisk();
    let faces = sides(&blisk, 1);
    let blade = NominalBlade::new([&faces[0], &faces[1]], &blisk);
    let points = made(&faces, edge, noise_mm, height_mm);
    let points = points.iter().filter(|at| is_kept(at)).map(|at| at.point);
    let points: Vec<Point> = points.chain(more.iter().copied()).collect();
    let strip = NominalSurface::new(EdgeStrip::new([&faces[0], &faces[1]], edge).unwrap());
    plan(&strip, &blade.edge_heights(&points, &strip, 0.0).unwrap(), &SETTINGS)
}

#[test]
fn points_over_an_edge_have_the_feet_and_heights_that_they_were_made_with() {
    let blisk = blisk();
    let faces = sides(&blisk, 1);
    for edge in EDGES {
        let strip = EdgeStrip::new([&faces[0], &faces[1]], edge).unwrap();
        let angle = strip.edge_angle_rad().to_degrees();
        let strip = NominalSurface::new(strip);
        let (mut off, mut apart, mut turn, mut on_edge) = (0.0_f64, 0.0_f64, 0.0_f64, 0);
        for at in made(&faces, edge, 0.0, |side, way, span| 0.3 + 0.1 * libm::sin(9.0 * (way + span) + side as f64)) {
            let (foot, on) = strip.foot_and_normal(&at.point);
            let (point, direction) = strip.surface().point_and_normal(foot.at);
            off = off.max((on.normal.dot(&(at.point - on.point)) - at.height_mm).abs());
            apart = apart.max((point - foot.point).norm());
            turn = turn.max(direction.angle(&(at.point - foot.point)));
            let beyond_mm = strip.surface().unfolded(foot.at, &foot.point).beyond_mm;
            if at.way > 0.01 {
                assert_eq!(beyond_mm > 0.0, at.side == 1, "{edge:?} {}", at.way);
            } else if at.way == 0.0 {
                on_edge += 1;
            }
        }
        println!(
            "{edge:?}: normals {angle:.1} degrees apart; {on_edge} points on the edge; heights off by {off:.1e} mm, feet by {apart:.1e} mm, directions by {turn:.1e}"
        );
        // The sides of the leading edge end up to 0.0013 mm apart.
        assert!(off < 2e-3 && apart < 2e-3 && turn < 0.02);
    }
}

#[test]
fn the_strip_has_derivatives_that_are_those_of_its_points() {
    let blisk = blisk();
    let faces = sides(&blisk, 1);
    for edge in EDGES {
        let strip = EdgeStrip::new([&faces[0], &faces[1]], edge).unwrap();
        let mut worst = 0.0_f64;
        for k in 1..400 {
            let at = [0.37, (f64::from(k) + 0.3) / 400.0];
            let step = 1e-7;
            let [before, after] = [-step, step].map(|step| strip.point_and_normal([at[0], at[1] + step]));
            let jet = strip.jet(at);
            let slope = (after.0 - before.0) / (2.0 * step);
            let raised = ((after.0 + after.1 * 0.5) - (before.0 + before.1 * 0.5)) / (2.0 * step);
            let speed = strip.speed_mm(at, 0.5);
            worst = worst.max((slope - jet.v).norm() / speed).max((raised.norm() / speed - 1.0).abs());
            let outwards = jet.u.cross(&jet.v) * strip.outward();
            assert!(outwards.norm() < 1.0 || outwards.dot(&before.1) > 0.0, "{at:?}");
        }
        println!("{edge:?}: derivatives off by a share of {worst:.1e}");
        // At a few places a difference straddles two intervals of the course.
        assert!(worst < 2e-2, "{worst}");
    }
}

#[test]
fn an_edge_without_enough_material_is_refused_with_its_place_and_amount() {
    let blisk = blisk();
    let faces = sides(&blisk, 1);
    for edge in EDGES {
        // A weld that ends 0.3 mm behind the edge about one place, in a plane face.
        let broken = faces[0].point(side_u(edge, 0.0), 0.6);
        let strip = EdgeStrip::new([&faces[0], &faces[1]], edge).unwrap();
        let out = strip
            .point_and_normal([
                0.6,
                strip.v_on_side(0, side_u(edge, 0.0) - if edge == BladeEdge::Leading { 1.0 } else { -1.0 }),
            ])
            .1;
        let is_kept = |at: &Made| {
            let off = at.point - broken;
            (off - out * off.dot(&out)).norm() > 1.6 || off.dot(&out) < -0.3
        };
        let along = (faces[0].point(side_u(edge, 0.0), 0.61) - broken).normalize();
        let across = out.cross(&along).normalize();
        let face = |k: i32| {
            let (i, j) = (k % 15 - 7, k / 15 - 4);
            broken - out * 0.3 + along * (0.2 * f64::from(i)) + across * (0.2 * f64::from(j))
        };
        let end: Vec<Point> = (0..135).map(face).collect();
        let refused = planned(edge, 0.0, weld, is_kept, &end).expect_err("a refusal");
        println!("{edge:?}: {refused}");
        let RepairInfeasible::Short { point, missing_mm, planned_mm, .. } = refused else { panic!("{refused}") };
        assert!((point - broken).norm() < 1.6 && (planned_mm - LEAST_MM).abs() < 1e-12);
        assert!((missing_mm - 0.32).abs() < 0.15, "{missing_mm}");
        // Too thin a weld about one place of the edge; behind a sharp edge no surface lies that far inside.
        if edge == BladeEdge::Trailing {
            continue;
        }
        let thin = |side: usize, way: f64, span: f64| {
            let near = libm::exp(-(26.0 * way).powi(2) - ((span - 0.6) * 28.6).powi(2));
            weld(side, way, span) * (1.0 - near) - 0.04 * near
        };
        let refused = planned(edge, 0.0, thin, |_| true, &[]).expect_err("a refusal");
        println!("{edge:?}: {refused}");
        let RepairInfeasible::Short { point, missing_mm, .. } = refused else { panic!("{refused}") };
        assert!((point - broken).norm() < 0.6 && (missing_mm - 0.06).abs() < 0.01, "{point} {missing_mm}");
    }
}

#[test]
fn points_of_one_side_and_welds_over_the_other_edge_are_refused() {
    let blisk = blisk();
    let faces = sides(&blisk, 1);
    let blade = NominalBlade::new([&faces[0], &faces[1]], &blisk);
    let edge = BladeEdge::Leading;
    let strip = NominalSurface::new(EdgeStrip::new([&faces[0], &faces[1]], edge).unwrap());
    let points = made(&faces, edge, 0.0, weld);
    let pressure: Vec<Point> = points.iter().filter(|at| at.side == 0 && at.way > 0.01).map(|at| at.point).collect();
    let refused = blade.edge_heights(&pressure, &strip, 0.0).unwrap_err();
    println!("{refused}");
    assert!(matches!(refused, CloudFault::OtherSide { side: "suction", .. }));
    // Both sides, but the one without points where the weld is.
    let refused = planned(edge, 0.0, weld, |at| at.side == 0 || at.way > 0.4, &[]).expect_err("a refusal");
    println!("{refused}");
    assert!(matches!(refused, RepairInfeasible::Unmeasured { .. }), "{refused}");
    let long = |side: usize, way: f64, span: f64| weld(side, way / 7.0, span);
    let refused = planned(edge, 0.0, long, |_| true, &[]).expect_err("a refusal");
    println!("{refused}");
    assert!(matches!(refused, RepairInfeasible::Around { is_weld: true, .. }), "{refused}");
    // A weld over the whole tip, both sides and both edges.
    let tip = |_: usize, _: f64, span: f64| OLD_MM + (WELD_MM - OLD_MM) * ((span - 0.7) * 20.0).clamp(0.0, 1.0);
    let refused = planned(edge, 0.0, tip, |_| true, &[]).expect_err("a refusal");
    println!("{refused}");
    let RepairInfeasible::Around { point, standing_mm, is_weld: true } = refused else { panic!("{refused}") };
    let strip = strip.surface();
    let ends = [0.0, 1.0].map(|v| (0..=100).map(move |k| [f64::from(k) / 100.0, v])).into_iter().flatten();
    let off_mm = ends.map(|at| (strip.point_and_normal(at).0 - point).norm()).fold(f64::INFINITY, f64::min);
    assert!((standing_mm - WELD_MM).abs() < 0.01 && off_mm < 0.2, "{standing_mm} {off_mm}");
    // The transition alone.
    let near = |side: usize, way: f64, span: f64| weld(side, way / 4.9, span);
    let refused = planned(edge, 0.0, near, |_| true, &[]).expect_err("a refusal");
    println!("{refused}");
    assert!(matches!(refused, RepairInfeasible::Around { is_weld: false, .. }), "{refused}");
}

#[test]
fn a_weld_over_either_edge_is_planned_on_both_sides() {
    let blisk = blisk();
    for edge in EDGES {
        let plan = planned(edge, 0.005, weld, |_| true, &[]).unwrap();
        let (mut counts, mut reach) = ([0; 3], [0.0_f64; 2]);
        let nodes = plan.field.nodes().zip(plan.regions.regions.iter().flatten());
        for ((node, region), left) in nodes.zip(plan.planned_mm.iter().flatten()) {
            counts[*region as usize] += 1;
            match region {
                Region::Norm => assert_eq!(*left, None),
                Region::Repaired => {
                    assert_eq!(*left, Some(LEAST_MM));
                    let beyond_mm = node.unfolded.beyond_mm;
                    reach = [reach[0].max(-beyond_mm), reach[1].max(beyond_mm)];
                }
                Region::Transition => {
                    assert!((LEAST_MM..OLD_MM + 1e-3).contains(&left.unwrap()), "{:?}", node.at);
                }
            }
        }
        let old = [plan.regions.allowance.old_mm, plan.regions.old_beyond_mm];
        println!(
            "{edge:?}: {counts:?} nodes; the weld reaches {reach:.2?} mm from the edge; old deviations {old:.4?} mm"
        );
        println!("  {} passes, {} layers, {:?} mm3", plan.finish.len(), plan.layers.len(), plan.removed_mm3);
        // The made weld stands 0.1 mm above the old surface at 0.962 of its extent; places are 0.5 mm apart.
        let faces = sides(&blisk, 1);
        for (side, extent_mm) in [(0, 5.0), (1, 4.0)] {
            let [tip, end] = [0.0, 0.962 * extent_mm / 26.0].map(|way| faces[side].point(side_u(edge, way), 0.6));
            let exact_mm = (tip - end).norm();
            assert!((exact_mm - 0.6..exact_mm + 0.1).contains(&reach[side]), "{reach:?} {exact_mm}");
        }
        assert!(old.iter().all(|old_mm| (old_mm - OLD_MM).abs() < 0.002), "{old:?}");
        // Neighbouring positions of the ball are near on every pass, round the edge as well.
        for run in plan.finish.iter().chain(plan.layers.iter().flat_map(|layer| &layer.1)) {
            for pair in run.windows(2) {
                let [from, to] = [&pair[0], &pair[1]].map(|at| at.point + at.normal * SETTINGS.passes.ball_mm);
                assert!((to - from).norm() < 0.25 && (pair[1].normal.norm() - 1.0).abs() < 1e-9, "{:?}", pair[0]);
            }
        }
        // On every layer the mill turns round the edge.
        let is_round = |run: &Vec<arcfeed_plan::repair::passes::RepairContact>| {
            run.windows(2).map(|pair| pair[0].normal.angle(&pair[1].normal)).sum::<f64>() > 2.0
        };
        // Noise alone stands above the highest one.
        let whole: Vec<bool> = plan.layers.iter().map(|(_, runs)| runs.iter().any(is_round)).collect();
        assert!(whole.ends_with(&[true, true]) && whole.len() <= 3, "{whole:?}");
    }
}
