//! Where the transition begins, and volumes.

use arcfeed_plan::repair::blend::{BlendShape, FinishAllowance};
use arcfeed_plan::repair::border::{MonotoneBorder, transition_begin};

use super::surfaces::Sheet;
use crate::plunge::table::{Worst, rows};

#[test]
fn point_2_the_transition_begins_where_another_program_finds_it() {
    let mut worst = Worst::default();
    for row in rows(include_str!("data/feng_regions.csv")) {
        let [u2, u3, p, width_mm] = row.numbers(["u2", "u3", "p", "width_mm"]);
        let border = |v: f64| u2 + (u3 - u2) * libm::pow(v, 1.0 / p);
        worst.absolute("u1", transition_begin(&Sheet, border, width_mm), row.number("u1"));
        // The curve through places of a lattice is as good.
        let places = (0..=60).map(|k| f64::from(k) / 60.0).map(|v| [v, border(v)]).collect();
        let curve = MonotoneBorder::new(places).unwrap();
        worst.absolute("u1 by lattice", transition_begin(&Sheet, |v| curve.u_at(v), width_mm), row.number("u1"));
        for k in 1..100 {
            let u = u2 + (u3 - u2) * f64::from(k) / 100.0;
            worst.absolute("f", curve.v_at(u), libm::pow((u - u2) / (u3 - u2), p));
        }
    }
    worst.within("feng_regions", &[("u1", 5e-4), ("u1 by lattice", 5e-4), ("f", 2e-3)]);
}

#[test]
fn a_border_that_turns_back_is_no_function() {
    assert_eq!(MonotoneBorder::new(vec![[0.0, 0.5]]), None);
    assert_eq!(MonotoneBorder::new(vec![[0.0, 0.5], [0.5, 0.6], [1.0, 0.55]]), None);
    assert!(MonotoneBorder::new(vec![[0.0, 0.5], [0.5, 0.5], [1.0, 0.55]]).is_some());
}

#[test]
fn point_2_volumes_of_a_plane_blade_are_those_of_quadrature() {
    let mut worst = Worst::default();
    for row in rows(include_str!("data/feng_plate_volume.csv")) {
        let [from_u, leading_u, trailing_u] = row.numbers(["u1", "u2", "u3"]);
        let [old_mm, repaired_mm] = row.numbers(["old_mm", "repaired_mm"]);
        let allowance =
            FinishAllowance { from_u, leading_u, trailing_u, old_mm, least_mm: 0.0, shape: BlendShape::Linear };
        let (pieces, mut sums) = (1500, [0.0; 2]);
        for i in 0..pieces {
            for j in 0..pieces {
                let [u, v] = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(pieces));
                let border_v = ((u - leading_u) / (trailing_u - leading_u)).clamp(0.0, 1.0);
                let is_repaired = u > leading_u + (trailing_u - leading_u) * v;
                let stands_mm = if is_repaired { repaired_mm } else { old_mm };
                sums[usize::from(!is_repaired)] += stands_mm - allowance.left_mm([u, v], border_v);
            }
        }
        let [repaired, transition] = sums.map(|sum| sum * 40.0 * 30.0 / f64::from(pieces * pieces));
        worst.absolute("repaired, ratio", repaired / row.number("removed_repaired_mm3"), 1.0);
        worst.absolute("transition, ratio", transition / row.number("removed_transition_mm3"), 1.0);
    }
    worst.within("feng_plate_volume", &[("repaired, ratio", 1e-3), ("transition, ratio", 1e-3)]);
}
