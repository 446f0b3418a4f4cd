//! Plan of one side: the sheet with a weld over its tip.

use arcfeed_plan::geometry::face::Jet;
use arcfeed_plan::geometry::surface::Surface;
use arcfeed_plan::repair::blend::BlendShape;
use arcfeed_plan::repair::passes::{PassSettings, RepairContact, layer_heights_mm};
use arcfeed_plan::repair::plan::{RepairInfeasible, RepairPlan, RepairSettings, plan};
use arcfeed_plan::repair::regions::{Region, RegionSettings, RepairBorder};
use arcfeed_plan::repair::scan::NominalSurface;
use arcfeed_plan::vector::{Point, Vector};

use super::scan::cloud;
use super::surfaces::Sheet;

const OLD_MM: f64 = 0.06;
const WELD_MM: f64 = 0.9;
const SETTINGS: RepairSettings = RepairSettings {
    regions: RegionSettings { threshold_mm: 0.1, width_mm: 3.0, least_mm: 0.02, shape: BlendShape::Cubic },
    passes: PassSettings { ball_mm: 3.0, cusp_mm: 0.01, chord_mm: 0.005, step_mm: 1.0 },
    spacing_mm: 0.5,
    hole_mm: None,
    rough_mm: 0.3,
    depth_mm: 0.25,
};

/// Weld above a border from the leading to the trailing edge.
fn weld([u, v]: [f64; 2]) -> f64 {
    let t = ((u - 0.55 - 0.2 * v) / 0.03).clamp(0.0, 1.0);
    OLD_MM + (WELD_MM - OLD_MM) * t * t * (3.0 - 2.0 * t)
}

fn planned(noise_mm: f64, height_mm: impl Fn([f64; 2]) -> f64) -> Result<RepairPlan, RepairInfeasible> {
    let nominal = NominalSurface::new(Sheet);
    let samples = nominal.heights(&cloud(8, 40_000, noise_mm, height_mm), 0.0);
    plan(&nominal, &samples, &SETTINGS)
}

#[test]
fn the_plan_keeps_the_old_surface_and_leaves_what_the_blend_says() {
    let plan = planned(0.0, weld).unwrap();
    let allowance = plan.regions.allowance;
    println!("{allowance:?}");
    assert!((allowance.old_mm - OLD_MM).abs() < 1e-4);
    // The weld stands 0.1 mm above the old surface a hundredth of u inside of its border.
    assert!((allowance.leading_u - 0.556).abs() < 0.005 && (allowance.trailing_u - 0.756).abs() < 0.005);
    assert!(matches!(plan.regions.border, RepairBorder::Rising { is_mirrored: false, .. }));
    let (mut norm, mut least_left): (usize, f64) = (0, f64::INFINITY);
    for ((node, region), planned) in
        plan.field.nodes().zip(plan.regions.regions.iter().flatten()).zip(plan.planned_mm.iter().flatten())
    {
        assert_eq!(planned.is_none(), *region == Region::Norm);
        match planned {
            None => {
                norm += 1;
                assert!(node.at[0] <= allowance.from_u, "the old surface below c1 stays");
            }
            Some(left_mm) => least_left = least_left.min(*left_mm),
        }
    }
    println!(
        "{norm} nodes of the norm region stay; least allowance left {least_left:.4} mm; removed {:?} mm3",
        plan.removed_mm3
    );
    assert!((least_left - 0.02).abs() < 1e-12 && norm > 1000);
    // All finishing contacts lie at and above c1, and meet the old surface there.
    let first = &plan.finish[0];
    let joint = first.iter().map(|contact| (contact.left_mm - allowance.old_mm).abs()).fold(0.0, f64::max);
    assert!(joint < 1e-9, "{joint}");
    assert!(plan.finish.iter().flatten().all(|contact| contact.at[0] >= allowance.from_u - 1e-12));
}

#[test]
fn removed_volumes_are_those_of_the_exact_heights() {
    let plan = planned(0.0, weld).unwrap();
    let (pieces, mut sums) = (800, [0.0; 2]);
    for i in 0..pieces {
        for j in 0..pieces {
            let at = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(pieces));
            if at[0] < plan.regions.allowance.from_u {
                continue;
            }
            let jet = Sheet.jet(at);
            let left_mm = plan.regions.left_mm(at, &jet.point, false);
            let is_repaired = weld(at) > OLD_MM + 0.1;
            let area_mm2 = jet.u.cross(&jet.v).norm() / f64::from(pieces * pieces);
            sums[usize::from(!is_repaired)] += (weld(at) - left_mm).max(0.0) * area_mm2;
        }
    }
    let ratio = plan.removed_mm3[0] / sums[0];
    println!(
        "repaired {:.3} mm3, exactly {:.3}; transition {:.3}, exactly {:.3}",
        plan.removed_mm3[0], sums[0], plan.removed_mm3[1], sums[1]
    );
    let whole = (plan.removed_mm3[0] + plan.removed_mm3[1]) / (sums[0] + sums[1]);
    assert!((ratio - 1.0).abs() < 0.005 && (whole - 1.0).abs() < 0.002, "{ratio} {whole}");
}

/// Samples of the nominal sheet along each parameter, and the part of each within which a ball can touch it.
const SAMPLES: usize = 240;
const NEAR: f64 = 0.1;

/// Depth to which the ball comes below what is to be left, over dense samples of the nominal sheet, on its straight ways from contact to contact.
fn deepest_mm(plan: &RepairPlan, ball_mm: f64) -> (usize, f64) {
    let share = |k: usize| k as f64 / SAMPLES as f64;
    let sample = |i: usize, j: usize| {
        let point = Sheet.jet([share(i), share(j)]).point;
        (point, plan.left_mm([share(i), share(j)], &point))
    };
    let samples: Vec<Vec<(Point, f64)>> =
        (0..=SAMPLES).map(|i| (0..=SAMPLES).map(|j| sample(i, j)).collect()).collect();
    let near = |at: f64| {
        let last = |t: f64| (t.clamp(0.0, 1.0) * SAMPLES as f64) as usize;
        last(at - NEAR)..=last(at + NEAR)
    };
    let (mut ways, mut deepest) = (0, f64::NEG_INFINITY);
    for pair in plan.finish.iter().flat_map(|run| run.windows(2)) {
        let [from, to] = [&pair[0], &pair[1]].map(|contact| contact.point + contact.normal * ball_mm);
        ways += 1;
        for row in &samples[near(pair[0].at[0])] {
            for (point, left_mm) in &row[near(pair[0].at[1])] {
                let (way, off) = (to - from, point - from);
                let part = (off.dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
                deepest = deepest.max(ball_mm + left_mm - (off - way * part).norm());
            }
        }
    }
    (ways, deepest)
}

/// The sheet's round side; `Sheet` is its hollow one.
struct RoundSide;

impl Surface for RoundSide {
    fn jet(&self, at: [f64; 2]) -> Jet {
        Sheet.jet(at)
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        Sheet.ranges()
    }

    fn outward(&self) -> f64 {
        -Sheet.outward()
    }
}

#[test]
fn point_4_the_ball_stays_off_the_nominal_surface_over_the_whole_finish() {
    let nominal = NominalSurface::new(RoundSide);
    let samples = nominal.heights(&cloud(8, 40_000, 0.0, |at| -weld(at)), 0.0);
    let round = plan(&nominal, &samples, &SETTINGS).unwrap();
    // Between two contacts the ball cuts into a round surface, and stands off a hollow one.
    for (name, plan, least_mm) in [("hollow", planned(0.0, weld).unwrap(), -1e-4), ("round", round, 1e-4)] {
        let (ways, deepest_mm) = deepest_mm(&plan, SETTINGS.passes.ball_mm);
        println!("{name}: {ways} ways of the ball, below what is to be left by {deepest_mm:.5} mm at most");
        assert!(ways > 1500 && (least_mm..SETTINGS.passes.chord_mm).contains(&deepest_mm));
    }
}

#[test]
fn layers_stand_in_the_weld_only_and_fall_by_the_depth() {
    let plan = planned(0.0, weld).unwrap();
    let heights: Vec<f64> = plan.layers.iter().map(|layer| layer.0).collect();
    println!("{heights:?}");
    assert_eq!(heights.len(), 3);
    assert!((heights[2] - 0.3).abs() < 1e-12 && (heights[0] - 0.8).abs() < 1e-12);
    for (height_mm, runs) in &plan.layers {
        assert!(!runs.is_empty());
        for contact in runs.iter().flatten() {
            let (point, normal) = Sheet.point_and_normal(contact.at);
            assert!((contact.point - (point + normal * *height_mm)).norm() < 1e-9);
            assert!(contact.at[0] > 0.55 + 0.2 * contact.at[1] - 0.02, "{:?}", contact.at);
        }
    }
    assert!(layer_heights_mm(0.25, 0.3, 0.25).is_empty());
}

#[test]
fn point_5_noise_of_5_um_moves_the_path_by_less_than_10_um() {
    let (clean, noisy) = (planned(0.0, weld).unwrap(), planned(0.005, weld).unwrap());
    assert_eq!(clean.finish.len(), noisy.finish.len());
    let moved = |(one, other): (&RepairContact, &RepairContact)| (one.point - other.point).norm();
    let farthest = clean.finish.iter().flatten().zip(noisy.finish.iter().flatten()).map(moved).fold(0.0, f64::max);
    println!("noise of 5 um moves contact points by {:.2} um at most", farthest * 1000.0);
    assert!(farthest < 0.010);
}

#[test]
fn point_6_missing_material_is_refused_with_its_place_and_amount() {
    // A pit in the weld, 0.05 mm below the least allowance.
    let pit = |at: [f64; 2]| {
        let off_mm = (Sheet.jet(at).point - Sheet.jet([0.9, 0.4]).point).norm();
        let deep = libm::exp(-off_mm * off_mm / 4.0);
        weld(at) * (1.0 - deep) + (0.02 - 0.05) * deep
    };
    let refused = planned(0.0, pit).expect_err("a refusal");
    println!("{refused}");
    let RepairInfeasible::Short { point, missing_mm, planned_mm, .. } = refused else { panic!("{refused}") };
    assert!((point - Sheet.jet([0.9, 0.4]).point).norm() < 0.5, "{point}");
    assert!((missing_mm - 0.05).abs() < 0.01 && (planned_mm - 0.02).abs() < 1e-12);
    // No weld, a steep transition, a hole.
    assert!(matches!(planned(0.005, |_| OLD_MM), Err(RepairInfeasible::NothingRepaired { .. })));
    let nominal = NominalSurface::new(Sheet);
    let mut samples = nominal.heights(&cloud(8, 40_000, 0.0, weld), 0.0);
    let narrow = RepairSettings { regions: RegionSettings { width_mm: 0.5, ..SETTINGS.regions }, ..SETTINGS };
    let steep = plan(&nominal, &samples, &narrow).expect_err("a refusal");
    println!("{steep}");
    assert!(matches!(steep, RepairInfeasible::Steep { needed_mm, .. } if (needed_mm - 1.2).abs() < 0.01));
    samples.retain(|sample| libm::hypot(sample.at[0] - 0.9, sample.at[1] - 0.5) > 0.05);
    let hole = plan(&nominal, &samples, &SETTINGS).expect_err("a refusal");
    println!("{hole}");
    assert!(matches!(hole, RepairInfeasible::Unmeasured { .. }));
}

#[test]
fn a_dense_cloud_may_end_beside_the_edges() {
    let nominal = NominalSurface::new(Sheet);
    let mut samples = nominal.heights(&cloud(8, 120_000, 0.005, weld), 0.0);
    samples.retain(|sample| sample.at.iter().all(|t| (0.008..0.992).contains(t)));
    // In the corners the nearest point lies 0.45 mm away: more than three spacings, less than the lattice's.
    assert!(nominal.usual_hole_mm(samples.len()) < 0.4);
    assert!(plan(&nominal, &samples, &SETTINGS).is_ok());
    let strict = RepairSettings { hole_mm: Some(0.35), ..SETTINGS };
    assert!(matches!(plan(&nominal, &samples, &strict), Err(RepairInfeasible::Unmeasured { .. })));
}

#[test]
fn a_nick_in_an_edge_blends_by_distance() {
    let nick = |[u, v]: [f64; 2]| {
        let t = ((1.0 - libm::hypot((u - 0.5) / 0.12, v / 0.15)) * 8.0).clamp(0.0, 1.0);
        OLD_MM + (WELD_MM - OLD_MM) * t
    };
    let plan = planned(0.0, nick).unwrap();
    assert!(matches!(plan.regions.border, RepairBorder::Pieces(_)));
    for ((node, region), left) in
        plan.field.nodes().zip(plan.regions.regions.iter().flatten()).zip(plan.planned_mm.iter().flatten())
    {
        match (region, left) {
            (Region::Norm, left) => assert_eq!(*left, None),
            (Region::Repaired, left) => assert_eq!(*left, Some(0.02)),
            (Region::Transition, left) => assert!((0.02..=OLD_MM + 1e-3).contains(&left.unwrap()), "{:?}", node.at),
        }
    }
}

#[test]
fn passes_about_a_nick_keep_off_the_old_surface() {
    // 4.8 mm up and down the span and 5.4 mm along the chord, then 3 mm of transition, and a point beyond.
    let nick = |[u, v]: [f64; 2]| {
        let t = ((1.0 - libm::hypot((u - 0.5) / 0.12, v / 0.15)) * 8.0).clamp(0.0, 1.0);
        OLD_MM + (WELD_MM - OLD_MM) * t
    };
    let plan = planned(0.0, nick).unwrap();
    let contacts: Vec<&RepairContact> = plan.finish.iter().flatten().collect();
    let middle = Sheet.jet([0.5, 0.0]).point;
    let farthest = contacts.iter().map(|at| (Sheet.jet(at.at).point - middle).norm()).fold(0.0, f64::max);
    println!("{} contacts, {farthest:.2} mm from the nick's middle at most", contacts.len());
    assert!(contacts.len() > 50 && farthest < 5.4 + 3.0 + 2.5, "{farthest}");
}

#[test]
fn a_border_that_falls_towards_the_trailing_edge_is_planned_like_one_that_rises() {
    let plan = planned(0.0, |[u, v]| weld([u, 1.0 - v])).unwrap();
    assert!(matches!(plan.regions.border, RepairBorder::Rising { is_mirrored: true, .. }));
    let allowance = plan.regions.allowance;
    // The trailing edge is the lower end now.
    let left = |at: [f64; 2]| plan.regions.left_mm(at, &Sheet.jet(at).point, false);
    assert!((left([allowance.leading_u, 1.0]) - 0.02).abs() < 1e-6);
    assert!(left([allowance.leading_u, 0.0]) > 0.03);
    assert!((left([allowance.from_u, 0.5]) - allowance.old_mm).abs() < 1e-9);
}

/// Sheet after an orthogonal map.
#[derive(Clone, Copy)]
struct Mapped(nalgebra::Matrix3<f64>);

impl Surface for Mapped {
    fn jet(&self, at: [f64; 2]) -> Jet {
        let jet = Sheet.jet(at);
        let [u, v, uu, uv, vv] = [jet.u, jet.v, jet.uu, jet.uv, jet.vv].map(|derivative| self.0 * derivative);
        Jet { point: Point::from(self.0 * jet.point.coords), u, v, uu, uv, vv }
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        Sheet.ranges()
    }

    fn outward(&self) -> f64 {
        Sheet.outward() * self.0.determinant().signum()
    }
}

#[test]
fn point_7_turned_and_mirrored_blades_have_turned_and_mirrored_paths() {
    let points = cloud(8, 20_000, 0.005, weld);
    let of = |map: nalgebra::Matrix3<f64>| {
        let nominal = NominalSurface::new(Mapped(map));
        let mapped: Vec<Point> = points.iter().map(|point| Point::from(map * point.coords)).collect();
        plan(&nominal, &nominal.heights(&mapped, 0.0), &SETTINGS).unwrap()
    };
    let plain = of(nalgebra::Matrix3::identity());
    let turn = nalgebra::Rotation3::new(Vector::new(0.4, -1.1, 2.0)).into_inner();
    let mirror = nalgebra::Matrix3::from_diagonal(&Vector::new(1.0, -1.0, 1.0));
    for map in [turn, mirror, turn * mirror] {
        let other = of(map);
        let contacts = plain.finish.iter().flatten().zip(other.finish.iter().flatten());
        let off = contacts
            .map(|(one, other)| {
                (map * one.point.coords - other.point.coords).norm().max((map * one.normal - other.normal).norm())
            })
            .fold(0.0, f64::max);
        println!("mapped path off by {off:.1e}");
        assert_eq!(plain.finish.len(), other.finish.len());
        assert!(off < 1e-9);
    }
}
