//! A cut that doubles its period: each tooth finds the tool where the last but one did. With two teeth samples once a turn see nothing.

use arcfeed_modal::dynamics::chatter::{Sampling, Verdict, metric_mm};
use nalgebra::Vector3;

use crate::stability::milling::{BRIEFLY, FEED_MM_PER_TOOTH, Milling};
use crate::stability::tables::mode_a;

/// M of an independent program's run at 18 000 rev/min, 2 mm, a twentieth of the diameter down, over its feed per tooth.
const METRIC_RATIO: f64 = 171.93e-3 / 0.1;

#[test]
fn a_doubled_period_shows_once_a_tooth_and_not_once_a_turn() {
    let milling = Milling {
        modes: vec![mode_a(Vector3::x())],
        teeth: 2,
        specific_mpa: [600.0, 200.0],
        immersion: 0.05,
        is_up: false,
        seen: BRIEFLY,
    };
    let ways_mm = milling.ways_mm(18_000.0, 2.0);
    // The sample of that program is with a tooth across the feed, half a tooth on.
    let samples: Vec<Vector3<f64>> = ways_mm[ways_mm.len() / 2..].iter().map(|way| way[way.len() / 2 - 1]).collect();
    let sampling = Sampling { teeth: 2, tooth_hz: 600.0, floor_mm: 0.02 * FEED_MM_PER_TOOTH };
    assert_eq!(sampling.evaluate(&samples), Verdict::PeriodDoubling);
    let (tooth_mm, turn_mm) = (metric_mm(&samples, 1), metric_mm(&samples, 2));
    println!(
        "once a tooth {:.4}, once a turn {:.4} of the feed",
        tooth_mm / FEED_MM_PER_TOOTH,
        turn_mm / FEED_MM_PER_TOOTH
    );
    assert!((tooth_mm / FEED_MM_PER_TOOTH / METRIC_RATIO - 1.0).abs() < 0.01);
    assert!(turn_mm < 0.01 * tooth_mm);
}
