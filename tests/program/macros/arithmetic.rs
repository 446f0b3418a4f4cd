//! Loops and functions against sums in closed form, `libm` and the rules of rounding.

use crate::macros::run::{corpus, run};

/// The value that an expression leaves in #500.
fn value(expression: &str) -> f64 {
    let run = run(&format!("#500={expression}\nM30\n"));
    assert!(run.ended.is_ok(), "{expression}: {:?}", run.ended);
    run.variable(500).unwrap_or_else(|| panic!("{expression} is vacant"))
}

#[test]
fn nested_loops_add_up_to_their_closed_forms() {
    let run = run(&corpus("nested-loops.nc"));
    assert!(run.ended.is_ok(), "{:?}", run.ended);
    let triangle = |n: f64| n * (n + 1.0) / 2.0;
    let sums = [500, 501, 502].map(|number| run.variable(number));
    let (i, j, k) = (triangle(12.0), triangle(9.0), triangle(5.0));
    assert_eq!(sums, [Some(i), Some(i * j), Some(i * j * k)]);
}

#[test]
fn newtons_loop_finds_square_roots() {
    for x in [2.0, 10.0, 12345.678, 0.04] {
        let run = run(&corpus("newton.nc").replacen("#501 = #500", &format!("#500 = {x}\n#501 = #500"), 1));
        assert!(run.ended.is_ok(), "{:?}", run.ended);
        let (root, steps) = (run.variable(501).expect("a root"), run.variable(502).expect("a count"));
        // One step beyond an error of 1e-7 the error is far below it: Newton's is quadratic.
        assert!((root - libm::sqrt(x)).abs() < 1e-12 * (1.0 + root), "{x}: {root}");
        println!("root of {x}: {root} in {steps} steps");
    }
}

#[test]
fn functions_are_those_of_libm_in_degrees() {
    let rad = |deg: f64| deg / 180.0 * std::f64::consts::PI;
    for degrees in [-400.0, -123.4, -30.0, 0.5, 29.0, 61.7, 133.0, 271.0, 719.0] {
        for (name, wanted) in
            [("SIN", libm::sin(rad(degrees))), ("COS", libm::cos(rad(degrees))), ("TAN", libm::tan(rad(degrees)))]
        {
            let found = value(&format!("{name}[{degrees}]"));
            assert!((found - wanted).abs() < 1e-12 * (1.0 + wanted.abs()), "{name}[{degrees}]: {found}, {wanted}");
        }
    }
    for (expression, wanted) in [
        ("SQRT[2]", libm::sqrt(2.0)),
        ("LN[10]", libm::log(10.0)),
        ("EXP[1]", std::f64::consts::E),
        ("POW[2,0.5]", libm::sqrt(2.0)),
        ("ASIN[0.5]", 30.0),
        ("ACOS[-0.5]", 120.0),
        ("ATAN[1]", 45.0),
    ] {
        assert!((value(expression) - wanted).abs() < 1e-12 * wanted, "{expression}");
    }
}

#[test]
fn the_arc_tangent_knows_its_quadrant() {
    for quarter in 0..16 {
        let degrees = 22.5 * f64::from(quarter) + 1.0;
        for form in ["ATAN[Y]/[X]", "ATAN[Y,X]"] {
            let form = form.replace('Y', &format!("3*SIN[{degrees}]")).replace('X', &format!("3*COS[{degrees}]"));
            assert!((value(&form) - degrees).abs() < 1e-9, "{form}: {}", value(&form));
        }
    }
    assert_eq!([value("ATAN[0]/[-1]"), value("ATAN[-1]/[0]")], [180.0, 270.0]);
}

#[test]
fn round_gives_whole_numbers_in_statements_and_increments_in_words() {
    assert_eq!(
        [value("ROUND[1.2345]"), value("ROUND[-2.5]"), value("FIX[-2.9]"), value("FUP[2.1]")],
        [1.0, -3.0, -2.0, 3.0]
    );
    // The manual's example: two moves rounded one by one come back to where they began only if their sum is rounded alike.
    let drift = |back: &str| {
        let run = run(&format!("#1=1.2345\n#2=2.3456\nG91G0X-#1\nX-#2\nX[{back}]\nM30\n"));
        run.ends_mm().last().expect("moves")[0]
    };
    // 1.2345 -> 1.235, 2.3456 -> 2.346, their sum 3.5801 -> 3.580.
    assert!((drift("#1+#2") - -0.001).abs() < 1e-9);
    assert!(drift("ROUND[#1]+ROUND[#2]").abs() < 1e-9);
}

#[test]
fn timers_run_while_a_program_waits() {
    let run = run("#3001=0\nWHILE[#3001LT20]DO1\nEND1\n#500=#3001\nM30\n");
    assert!(run.ended.is_ok(), "{:?}", run.ended);
    assert_eq!(run.variable(500), Some(20.0));
}

#[test]
fn codes_in_effect_can_be_read_and_restored() {
    let run = run("G91G1X1.F250\n#500=#4003\n#501=#4001\n#502=#4109\nG90\nG#500\nX1.\nM30\n");
    assert_eq!([500, 501, 502].map(|number| run.variable(number)), [91.0, 1.0, 250.0].map(Some));
    assert_eq!(run.ends_mm(), [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
}
