//! Allowance that finishing leaves.

use arcfeed_plan::repair::blend::{BlendShape, FinishAllowance};

use crate::plunge::table::{Worst, rows};

/// Half of the last digit of the file's numbers.
const HALF_DIGIT: f64 = 5e-13;
/// Inputs of a row.
const INPUTS: [&str; 8] = ["u", "v", "u1", "u2", "u3", "d_max", "d_min", "p"];

fn border_v([u, _, _, u2, u3, _, _, p]: [f64; 8]) -> f64 {
    libm::pow(((u - u2) / (u3 - u2)).clamp(0.0, 1.0), p)
}

fn left_mm(inputs: [f64; 8], shape: BlendShape) -> f64 {
    let [u, v, from_u, leading_u, trailing_u, old_mm, least_mm, _] = inputs;
    let patch = FinishAllowance { from_u, leading_u, trailing_u, old_mm, least_mm, shape };
    patch.left_mm([u, v], border_v(inputs))
}

/// Equations 10 and 12 as printed, with u and v where u - u1 and v - f belong.
fn printed_mm(inputs: [f64; 8], region: &str) -> f64 {
    let [u, v, u1, u2, u3, d_max, d_min, _] = inputs;
    let along = |to: f64| d_max - (d_max - d_min) * u / (to - u1);
    match region {
        "S2' (10)" => along(u2) + (along(u3) - along(u2)) * v,
        "S2' (12)" => d_min + (along(u3) - d_min) * v / (1.0 - border_v(inputs)),
        _ => d_min,
    }
}

/// Rounding that the digits of the inputs and of the result explain; `p` is exact.
fn rounding(inputs: [f64; 8], value: impl Fn([f64; 8]) -> f64) -> f64 {
    let slope = |k: usize| {
        let beside = |by: f64| {
            let mut moved = inputs;
            moved[k] += by;
            ((value(moved) - value(inputs)) / by).abs()
        };
        beside(1e-8).max(beside(-1e-8))
    };
    HALF_DIGIT * (1.0 + (0..INPUTS.len() - 1).map(slope).sum::<f64>())
}

#[test]
fn point_1_allowances_are_those_of_the_corrected_equations() {
    let table = rows(include_str!("data/feng_blend.csv"));
    let mut worst = Worst::default();
    for row in &table {
        let inputs = row.numbers(INPUTS);
        let mut compare = |kind, share, column, shape| {
            let off = left_mm(inputs, shape) - row.number(column);
            worst.absolute(kind, off, 0.0);
            worst.absolute(share, off / rounding(inputs, |moved| left_mm(moved, shape)), 0.0);
        };
        compare("corrected", "corrected, of its digits", "d_corrected", BlendShape::Linear);
        compare("cubic", "cubic, of its digits", "d_cubic", BlendShape::Cubic);
        compare("quintic", "quintic, of its digits", "d_quintic", BlendShape::Quintic);
    }
    let limits = [
        ("corrected", 1e-12),
        ("corrected, of its digits", 1.0),
        ("cubic", 1e-12),
        ("cubic, of its digits", 1.0),
        // The steepest shape carries the rounding of the inputs farthest.
        ("quintic", 1.4e-12),
        ("quintic, of its digits", 1.0),
    ];
    worst.within("feng_blend", &limits);
}

#[test]
fn point_1_the_printed_equations_miss_their_own_border_values() {
    let table = rows(include_str!("data/feng_blend.csv"));
    let mut worst = Worst::default();
    let mut farthest_mm: f64 = 0.0;
    for row in &table {
        let (inputs, region) = (row.numbers(INPUTS), row.word("region"));
        let printed = printed_mm(inputs, region);
        let off = printed - row.number("d_as_printed");
        worst.absolute("of its digits", off / rounding(inputs, |moved| printed_mm(moved, region)), 0.0);
        if inputs[0] == inputs[2] {
            farthest_mm = farthest_mm.max((printed - inputs[5]).abs());
        }
    }
    worst.within("feng_blend, as printed", &[("of its digits", 1.0)]);
    println!("as printed, the joint with the old blade is off by {farthest_mm:.4} mm");
    assert!(farthest_mm > 0.05);
}

#[test]
fn the_allowance_is_continuous_and_smooth_where_its_shape_is() {
    let base = FinishAllowance {
        from_u: 0.2,
        leading_u: 0.4,
        trailing_u: 0.7,
        old_mm: 0.08,
        least_mm: 0.02,
        shape: BlendShape::Linear,
    };
    let border = |u: f64| ((u - 0.4) / 0.3_f64).clamp(0.0, 1.0);
    let h = 1e-7;
    for shape in [BlendShape::Linear, BlendShape::Cubic, BlendShape::Quintic] {
        let patch = FinishAllowance { shape, ..base };
        let left = |u: f64, v: f64| patch.left_mm([u, v], border(u));
        let (mut jump, mut kink, mut steepest): (f64, f64, f64) = (0.0, 0.0, 0.0);
        for k in 1..1000 {
            let s = f64::from(k) / 1000.0;
            // Across c1 and across c_b, along u.
            let (at_c1, at_cb) = ((0.2, s), (0.4 + 0.3 * s, s));
            for (u, v) in [at_c1, at_cb] {
                jump = jump.max((left(u + h, v) - left(u - h, v)).abs());
                let (after, before) = ((left(u + h, v) - left(u, v)) / h, (left(u, v) - left(u - h, v)) / h);
                kink = kink.max((after - before).abs());
            }
            for j in 0..=20 {
                let v = f64::from(j) / 20.0;
                steepest = steepest.max((left(s + h, v) - left(s - h, v)).abs() / (2.0 * h));
                let value = left(s, v);
                assert!((0.02 - 1e-15..=0.08 + 1e-15).contains(&value), "{value}");
            }
        }
        println!("{shape:?}: jump {jump:.1e} mm, kink {kink:.1e} mm per u, steepest {steepest:.4} mm per u");
        assert!(jump < 1e-6);
        assert_eq!(kink < 1e-3, shape != BlendShape::Linear, "{shape:?} {kink}");
        // On the leading edge the transition is narrowest: K q' / (u2 - u1).
        assert!((steepest - 0.06 * shape.steepest_ratio() / 0.2).abs() < 1e-3, "{steepest}");
    }
}

#[test]
fn patches_of_any_shape_blend_by_distance() {
    let patch = FinishAllowance {
        from_u: 0.0,
        leading_u: 0.5,
        trailing_u: 1.0,
        old_mm: 0.1,
        least_mm: 0.02,
        shape: BlendShape::Cubic,
    };
    // Inside, on both borders, in the middle, and beyond.
    let expected = [(-1.0, 0.02), (0.0, 0.02), (1.5, 0.06), (3.0, 0.1), (4.0, 0.1)];
    for (distance_mm, left_mm) in expected {
        assert!((patch.left_at_distance_mm(distance_mm, 3.0) - left_mm).abs() < 1e-15);
    }
}
