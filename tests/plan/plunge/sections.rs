//! Sections of plunges one after the other.

use arcfeed_plan::plunge::disc::{Disc, engaged_mm2, union_mm2};
use arcfeed_plan::vector::Flat;

use super::table::{Worst, rows};

#[test]
fn point_4_sections_of_a_sequence_are_those_of_polar_integration() {
    let table = rows(include_str!("data/an_sequence.csv"));
    let mut worst = Worst::default();
    for (at, row) in table.iter().enumerate() {
        let case = row.word("case");
        let of_case = table.iter().filter(|other| other.word("case") == case);
        let discs: Vec<Disc> = of_case
            .map(|row| {
                let [radius_mm, x, y] = row.numbers(["R_mm", "x_mm", "y_mm"]);
                Disc { centre: Flat::new(x, y), radius_mm }
            })
            .collect();
        let first = table.iter().position(|other| other.word("case") == case).unwrap();
        let square = discs[0].radius_mm * discs[0].radius_mm;
        worst.absolute("engaged, R2", engaged_mm2(&discs[..=at - first]) / square, row.number("engaged_mm2") / square);
        worst.absolute("union, R2", union_mm2(&discs) / square, row.number("union_mm2") / square);
    }
    worst.within("an_sequence", &[("engaged, R2", 1e-5), ("union, R2", 1e-5)]);
}

#[test]
fn equal_and_enclosed_discs_count_once() {
    let disc = |x: f64, radius_mm: f64| Disc { centre: Flat::new(x, 0.0), radius_mm };
    let whole = core::f64::consts::PI * 25.0;
    for discs in [
        vec![disc(0.0, 5.0); 3],
        vec![disc(0.0, 5.0), disc(1.0, 2.0)],
        vec![disc(1.0, 2.0), disc(0.0, 5.0), disc(0.0, 5.0)],
    ] {
        assert!((union_mm2(&discs) - whole).abs() < 1e-12, "{discs:?}");
    }
    // Apart: the sum.
    assert!((union_mm2(&[disc(0.0, 5.0), disc(20.0, 5.0)]) - 2.0 * whole).abs() < 1e-12);
}
