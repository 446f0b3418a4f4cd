//! Depth limits of the linear theory as the product computes them: the tables of an independent program, and a slot of four
//! teeth, whose forces do not depend on the angle, in closed form.

use std::f64::consts::{PI, TAU};

use arcfeed_milling::stability::{ChatterKind, LinearMilling};
use arcfeed_tests::of_full_set;
use arcfeed_units::S_PER_MIN;
use nalgebra::Vector3;

use crate::cutting_forces::rows::rows;
use crate::stability::tables::{Table, mode_a, tables};

/// Largest relative difference from a table.
const TABLE_RATIO: f64 = 0.01;

/// Beyond every limit of the tables.
const DEPTH_MAX_MM: f64 = 100.0;

#[test]
fn limits_are_those_of_the_tables_within_a_hundredth() {
    for Table { name, csv, milling } in tables() {
        let linear = LinearMilling {
            engaged_rad: LinearMilling::engaged_rad(milling.immersion, milling.is_up),
            modes: milling.modes,
            teeth: milling.teeth,
            specific_mpa: milling.specific_mpa,
        };
        let (mut worst, mut of_other_kind, mut count) = ([0.0; 2], Vec::new(), 0);
        for row in rows(csv).iter().step_by(of_full_set(1, 5)) {
            let (speed, wanted_mm) = (row.number("rpm"), row.number("alim_ref_mm"));
            let found = linear.limit(speed, DEPTH_MAX_MM).expect("a limit");
            let off = libm::fabs(found.depth_mm / wanted_mm - 1.0);
            worst = if off > worst[0] { [off, speed] } else { worst };
            let is_same = (found.kind == ChatterKind::Flip) == (row.text("bifurcation") == "flip");
            of_other_kind.extend((!is_same).then_some(speed));
            count += 1;
        }
        println!(
            "{name}: {count} limits, {:.5} at most, at {} rev/min; of another kind {of_other_kind:?}",
            worst[0], worst[1]
        );
        assert!(worst[0] < TABLE_RATIO, "{name}: {} at {} rev/min", worst[0], worst[1]);
    }
}

/// Smallest depth at which the loop has the gain 1 and the phase 0 at some frequency, of a mode along x under a force that
/// is `specific_mpa` times the chip along x: 1 + w K (1 - e^(-i v T)) G(v) = 0, so w = -1 / (2 K Re G).
fn closed_form_mm(tooth_s: f64, specific_mpa: f64) -> f64 {
    let (natural_hz, zeta, stiffness) = (922.0, 0.011, 1340.049648);
    let of_frequency = |hz: f64| {
        let ratio = hz / natural_hz;
        let (re, im) = (1.0 - ratio * ratio, 2.0 * zeta * ratio);
        let square = re * re + im * im;
        // G = (re - i im) / (k (re^2 + im^2))
        let depth_mm = -stiffness * square / (2.0 * specific_mpa * re);
        // e^(-i v T) = 1 + 1 / (w K G)
        let (a, b) = (1.0 + stiffness * re / (depth_mm * specific_mpa), stiffness * im / (depth_mm * specific_mpa));
        let phase = (-TAU * hz * tooth_s - libm::atan2(b, a) + PI).rem_euclid(TAU) - PI;
        (depth_mm, phase)
    };
    let step_hz = 0.01;
    let pairs = (0..400_000).map(|step| natural_hz + (f64::from(step) + 0.5) * step_hz).map(of_frequency);
    let mut last: Option<(f64, f64)> = None;
    let mut least_mm = f64::INFINITY;
    for (depth_mm, phase) in pairs {
        if let Some((before_mm, before)) = last
            && before * phase <= 0.0
            && libm::fabs(before - phase) < 1.0
        {
            let part = before / (before - phase);
            least_mm = least_mm.min(before_mm + (depth_mm - before_mm) * part);
        }
        last = Some((depth_mm, phase));
    }
    least_mm
}

#[test]
fn a_slot_of_four_teeth_has_the_limits_of_turning() {
    // Two teeth a quarter of a turn apart are in the cut: (2) sums to [[Kn, Kt], [-Kt, Kn]] at every angle.
    let (teeth, specific_mpa) = (4, [600.0, 200.0]);
    let (modes, engaged_rad) = (vec![mode_a(Vector3::x())], LinearMilling::engaged_rad(1.0, false));
    let linear = LinearMilling { modes, teeth, specific_mpa, engaged_rad };
    let mut worst: f64 = 0.0;
    for speed in (2_000..=20_000).step_by(1_000).map(f64::from) {
        let wanted_mm = closed_form_mm(S_PER_MIN / (speed * teeth as f64), specific_mpa[1]);
        let found = linear.limit(speed, DEPTH_MAX_MM).expect("a limit");
        worst = worst.max(libm::fabs(found.depth_mm / wanted_mm - 1.0));
    }
    println!("19 speeds: {worst:.6} at most");
    assert!(worst < 2e-3, "{worst}");
}
