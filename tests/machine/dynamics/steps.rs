//! Effect of steps and rules on a verdict: deviation of the peak to peak from that of 4000 steps of Runge and Kutta.

use arcfeed_modal::dynamics::vibration::Stepping;

use crate::cutting_forces::rows::{Row, rows};
use crate::dynamics::regenerative::span;
use crate::dynamics::sets::{EXACT, NEWMARK, run_of};

const STEPS: [usize; 4] = [50, 100, 200, 400];

/// Result of another program with Newmark and three passes.
fn row(name: &str, steps: usize) -> Row<'static> {
    let of = |row: &Row<'_>| {
        let same = row.text("run") == name && row.text("integrator") == "Newmark 3 passes";
        same && row.number("steps_per_tooth") as usize == steps
    };
    rows(include_str!("td_integrator_error.csv")).into_iter().find(of).expect("a row")
}

fn true_um(name: &str) -> f64 {
    let row = row(name, STEPS[0]);
    row.number("p2p_x_um") / (1.0 + row.number("rel_err_vs_RK4_4000"))
}

fn peak_to_peak_um(name: &str, steps: usize, stepping: Stepping) -> f64 {
    let run = run_of(name).run(400, steps, stepping);
    assert_eq!(run.open, 0);
    span(run.displacements_mm.iter().map(|mm| mm.x)) * 1e3
}

/// Relative errors with Newmark and with the exact rule.
fn errors(name: &str) -> [[f64; 2]; 4] {
    STEPS.map(|steps| {
        let found = [NEWMARK, EXACT].map(|stepping| peak_to_peak_um(name, steps, stepping));
        let off = found.map(|um| um / true_um(name) - 1.0);
        println!("{name}, {steps}: Newmark {:.3} um {:+.4}, exact {:.3} um {:+.4}", found[0], off[0], found[1], off[1]);
        off
    })
}

#[test]
fn newmark_is_that_of_another_program() {
    let name = "A1_slot_5000_w0.50_unstable";
    for steps in STEPS {
        let (found, there) = (peak_to_peak_um(name, steps, NEWMARK), row(name, steps).number("p2p_x_um"));
        println!("{steps}: {found:.3} um, there {there:.3}");
        assert!((found / there - 1.0).abs() < 3e-4);
    }
}

#[test]
fn coarse_newmark_hides_chatter_and_the_exact_rule_does_not() {
    let errors = errors("A1_slot_5000_w0.50_unstable");
    assert!(errors[0][0] < -0.85, "50 steps of Newmark: as if stable");
    for ([newmark, exact], bound) in errors.into_iter().zip([0.06, 0.02, 0.005, 0.005]) {
        assert!(exact.abs() < bound && exact.abs() < newmark.abs() / 5.0, "{newmark} {exact}");
    }
}

#[test]
fn both_rules_are_of_second_order_in_a_stable_cut_with_jumps_of_force() {
    let errors = errors("A2_aD0.50down_15000_w0.20_stable");
    for (rule, least) in [(0, 1.8), (1, 1.5)] {
        let order = libm::log2(errors[0][rule] / errors[3][rule]) / 3.0;
        println!("order {order:.2}");
        assert!(order > least, "{order}");
    }
    assert!(errors.iter().all(|[newmark, exact]| exact.abs() < newmark.abs() / 3.0));
}
