//! Runs that are stable, that chatter and that double their period, against an independent program: 1000 steps a tooth here,
//! 4000 of Runge and Kutta there.

use crate::cutting_forces::rows::{Row, rows};
use crate::dynamics::regenerative::{Run, span};
use crate::dynamics::sets::{EXACT, run_of};

const UM_PER_MM: f64 = 1e3;

/// The reference run of this name with the finer steps.
fn finest(name: &str) -> Row<'static> {
    let rows = rows(include_str!("td_nonlinear_metrics.csv"));
    rows.into_iter().find(|row| row.text("run") == name && row.text("steps_per_tooth") == "4000").expect("a row")
}

/// Peak to peak of x and y, least and greatest Fx, against the table.
#[track_caller]
fn assert_same(name: &str, ratio: f64) -> Run {
    let row = finest(name);
    let turns = row.number("nrev") as usize;
    let run = run_of(name).run(turns, 1000, EXACT);
    let passes = run.iterations as f64 / (turns * 1000 * row.number("N") as usize) as f64;
    println!("{name}: {passes:.2} passes a step, {} steps open", run.open);
    assert_eq!(run.open, 0);
    let check = |what: &str, found: f64, there: f64, scale: f64| {
        let off = (found - there) / scale;
        println!("  {what}: {found:.4}, there {there:.4}: {off:+.1e}");
        assert!(off.abs() <= ratio, "{name}, {what}: {found} {there}");
    };
    for (axis, letter) in ["x", "y"].into_iter().enumerate() {
        let found = span(run.displacements_mm.iter().map(|mm| mm[axis])) * UM_PER_MM;
        let there = row.number(&format!("p2p_{letter}_um"));
        check(letter, found, there, there.max(1.0));
        let fourier = row.number(&format!("p2p_{letter}_fourier_um"));
        if fourier.is_finite() {
            check("the same by Fourier series", found, fourier, fourier.max(1.0));
        }
    }
    let fx = || run.forces_n.iter().map(|n| n.x);
    let (low, high) = (row.number("Fx_min_N"), row.number("Fx_max_N"));
    check("least Fx", fx().fold(f64::INFINITY, f64::min), low, high - low);
    check("greatest Fx", fx().fold(f64::NEG_INFINITY, f64::max), high, high - low);
    run
}

#[test]
fn stable_runs_are_those_of_another_program_and_of_fourier_series() {
    for name in ["A1_slot_5000_w0.20_stable", "A1_slot_5000_w0.35_stable", "C_aD0.50up_9000_w2.00_stable"] {
        assert_same(name, 1e-4);
    }
}

#[test]
fn chatter_grows_to_what_another_program_has() {
    assert_same("A1_slot_5000_w0.50_unstable", 1e-3);
}

#[test]
fn a_doubled_period_is_that_of_another_program() {
    // The force begins with a jump within a step: 1000 steps give 192.69 um, 4000 steps 191.60 um.
    let run = assert_same("A1_aD0.05down_18000_w2.00_flip", 2e-3);
    let samples = &run.samples_mm;
    let every_second = samples.windows(3).map(|of| (of[2] - of[0]).norm()).fold(0.0, f64::max);
    assert!(every_second < 1e-9, "{every_second}");
}
