//! Verdicts on samples, made up, of another program and of own runs.

use std::f64::consts::TAU;

use arcfeed_modal::dynamics::chatter::{Sampling, Verdict, deviation_mm, metric_mm};
use nalgebra::Vector3;

use crate::cutting_forces::rows::rows;
use crate::dynamics::regenerative::Milling;
use crate::dynamics::sets::{EXACT, run_of};

const FLOOR_MM: f64 = 1e-4;
const UM_PER_MM: f64 = 1e3;

/// The last 21 samples of x, once a turn.
fn once_a_turn(table: &str) -> Vec<Vector3<f64>> {
    let rows = rows(table);
    rows[rows.len() - 21..].iter().map(|row| Vector3::x() * (row.number("x_um") / UM_PER_MM)).collect()
}

fn sampling(milling: &Milling) -> Sampling {
    Sampling { teeth: milling.teeth, tooth_hz: 1.0 / milling.tooth_s(), floor_mm: FLOOR_MM }
}

#[test]
fn statistics_are_those_of_another_program() {
    let chatter = once_a_turn(include_str!("opr_A1_slot_5000_w0.50_unstable.csv"));
    let (metric_um, deviation_um) = (metric_mm(&chatter, 1) * UM_PER_MM, deviation_mm(&chatter) * UM_PER_MM);
    assert!((metric_um - 74.467002).abs() < 1e-6, "{metric_um}");
    assert!((deviation_um * deviation_um - 2142.0142).abs() < 1e-4, "{deviation_um}");
}

#[test]
fn once_a_turn_a_doubled_period_of_two_teeth_cannot_be_seen() {
    let flip = once_a_turn(include_str!("opr_A1_aD0.05down_18000_w2.00_flip.csv"));
    assert!(metric_mm(&flip, 1) < 1e-12 && deviation_mm(&flip) < 1e-12);
    let run = run_of("A1_aD0.05down_18000_w2.00_flip").run(400, 400, EXACT);
    let metric_um = metric_mm(&run.samples_mm, 1) * UM_PER_MM;
    println!("once a tooth {metric_um:.2} um, there 171.93");
    assert!((metric_um / 171.93397 - 1.0).abs() < 0.01, "{metric_um}");
}

#[test]
fn runs_are_judged_as_floquet_multipliers_do() {
    let stable = ["A1_slot_5000_w0.20_stable", "A1_slot_5000_w0.35_stable", "C_aD0.50up_9000_w2.00_stable"];
    for name in stable {
        let milling = run_of(name);
        assert_eq!(sampling(&milling).evaluate(&milling.run(300, 200, EXACT).samples_mm), Verdict::Stable, "{name}");
    }
    let flip = run_of("A1_aD0.05down_18000_w2.00_flip");
    assert_eq!(sampling(&flip).evaluate(&flip.run(300, 200, EXACT).samples_mm), Verdict::PeriodDoubling);
}

#[test]
fn chatter_begins_where_it_should_and_at_its_frequency() {
    // Boundaries and frequencies of another program: collocation of the monodromy operator.
    let a = Milling { depth_mm: 0.40863, ..run_of("A1_slot_5000_w0.50_unstable") };
    let c = Milling { depth_mm: 0.74779, spindle_rev_per_min: 10000.0, ..run_of("C_aD0.50up_9000_w2.00_stable") };
    for (milling, natural_hz, expected_hz) in [(a, 922.0, 942.71), (c, 900.0, 888.83)] {
        let sampling = sampling(&milling);
        let judged = |ratio: f64| {
            let milling = Milling { depth_mm: milling.depth_mm * ratio, ..milling.clone() };
            sampling.evaluate(&milling.run(600, 200, EXACT).samples_mm)
        };
        assert_eq!(judged(0.97), Verdict::Stable);
        let Verdict::Chatter { alias_hz } = judged(1.03) else { panic!("{:?}", judged(1.03)) };
        let chatter_hz = sampling.chatter_hz(alias_hz, natural_hz);
        println!("{chatter_hz:.1} Hz, at the boundary {expected_hz}");
        assert!((chatter_hz - expected_hz).abs() < 4.0, "{chatter_hz} {expected_hz}");
    }
}

#[test]
fn verdict_on_made_up_samples_follows_their_period() {
    let sampling = Sampling { teeth: 4, tooth_hz: 200.0, floor_mm: 1e-6 };
    let samples = |at: fn(usize) -> f64| (0..200).map(|i| Vector3::new(0.3, 0.01 * at(i), 0.0)).collect::<Vec<_>>();
    assert_eq!(sampling.evaluate(&samples(|_| 1.0)), Verdict::Stable);
    assert_eq!(sampling.evaluate(&samples(|i| (i % 2) as f64)), Verdict::PeriodDoubling);
    assert_eq!(sampling.evaluate(&samples(|i| [0.0, 3.0, 1.0, 2.0][i % 4])), Verdict::Uneven);
    assert_eq!(sampling.evaluate(&[]), Verdict::Stable);
    assert_eq!(sampling.evaluate(&samples(|_| 1.0)[..1]), Verdict::Stable);
    let verdict = sampling.evaluate(&samples(|i| libm::sin(TAU * 1071.3 * i as f64 / 200.0)));
    let Verdict::Chatter { alias_hz } = verdict else { panic!("{verdict:?}") };
    assert!((alias_hz - 71.3).abs() < 0.25, "{alias_hz}");
    assert!((sampling.chatter_hz(alias_hz, 1060.0) - 1071.3).abs() < 0.25);
    assert!((sampling.chatter_hz(alias_hz, 920.0) - 928.7).abs() < 0.25);
}
