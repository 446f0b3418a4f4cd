//! Subprograms, macro calls and where they return to.

use arcfeed_nc_macro::stack::SourceLine;
use arcfeed_nc_macro::step::MacroSettings;

use crate::macros::run::{run, run_with};

fn xs(text: &str) -> Vec<f64> {
    let run = run(text);
    assert!(run.ended.is_ok(), "{:?}", run.ended);
    run.ends_mm().iter().map(|end| end[0]).collect()
}

#[test]
fn a_subprogram_runs_as_often_as_it_is_called() {
    let sub = "O2000\nG91G0X1.\nM99\n";
    for (call, times) in [("M98P2000", 1), ("M98P32000", 3), ("M98P2000L4", 4), ("M98P122000", 12), ("M98P2000L0", 0)] {
        assert_eq!(xs(&format!("O1\n{call}\nM30\n{sub}")).len(), times, "{call}");
    }
}

#[test]
fn words_beside_a_call_are_executed_before_it() {
    assert_eq!(xs("O1\nG0X5.M98P2\nM30\nO2\nX7.\nM99\n"), [5.0, 7.0]);
}

#[test]
fn m198_calls_a_program_of_the_library_only() {
    let library = [(2, "O2\nX9.\nM99\n"), (3, "O3\nX8.\nM98P2\nM99\n")];
    let ends = |text: &str| {
        let run = run_with(text, &library, MacroSettings::default());
        (run.ended.is_ok(), run.ends_mm().iter().map(|end| end[0]).collect::<Vec<_>>())
    };
    let own = "M30\nO2\nX7.\nM99\n";
    assert_eq!(ends(&format!("O1\nG0\nM98P2\nM198P2L2\n{own}")), (true, vec![7.0, 9.0, 9.0]));
    assert_eq!(ends(&format!("O1\nG0\nM198P3\n{own}")), (true, vec![8.0, 7.0]));
    assert_eq!(ends(&format!("O1\nG0\nM198P4\n{own}")), (false, vec![]));
}

#[test]
fn executions_of_called_programs_are_counted_with_their_repetitions() {
    let run = run("O1\nM98P2L3\nG65P3\nM98P4L0\nM30\nO2\nM98P3L2\nM99\nO3\nM99\nO4\nM99\n");
    let executions: Vec<_> = run.interpreter.executions().iter().map(|(number, count)| (*number, *count)).collect();
    assert_eq!(executions, [(2, 3), (3, 7)]);
}

#[test]
fn m99_with_p_returns_to_a_block() {
    assert_eq!(xs("O1\nM98P2\nG0X1.\nN50X2.\nM30\nO2\nG0X9.\nM99P50\n"), [9.0, 2.0]);
}

#[test]
fn locals_belong_to_their_macro_and_commons_to_all() {
    let text = "O1\n#1=5.\n#100=1.\nG65P2A7.\nG0X#1\nX#100\nM30\nO2\nG0X#1\n#1=9.\n#100=3.\nM98P3\nM99\nO3\nX#1\nM99\n";
    assert_eq!(xs(text), [7.0, 9.0, 5.0, 3.0]);
}

#[test]
fn a_modal_macro_follows_every_move_until_it_is_cancelled() {
    let text = "O1\nG0X1.\nG66P2A0.5\nX2.\nM8\nX3.\nG67\nX4.\nM30\nO2\nG91\nX#1\nG90\nM99\n";
    assert_eq!(xs(text), [1.0, 2.0, 2.5, 3.0, 3.5, 4.0]);
}

#[test]
fn under_g66_1_a_block_is_a_list_of_arguments() {
    assert_eq!(xs("O1\nG66.1P2\nX5.\nX6.\nG67\nM30\nO2\nG0X[#24*2]\nM99\n"), [10.0, 12.0]);
}

#[test]
fn a_library_is_asked_for_what_the_file_lacks() {
    let library = [(9010, "%\nO9010\nG0X3.\nG65P9011X4.\nM99\n%"), (9011, "G0X#24\n#1=1/0\nM99\n")];
    let run = run_with("O1\nG0X1.\n\nM98P9010\nM30\n", &library, MacroSettings::default());
    assert_eq!(run.ends_mm().iter().map(|end| end[0]).collect::<Vec<_>>(), [1.0, 3.0, 4.0]);
    let trouble = run.ended.expect_err("it divides by zero");
    assert_eq!(trouble.place, SourceLine { library: Some(9011), line: 2 });
    assert_eq!(trouble.calls, [SourceLine { library: None, line: 4 }, SourceLine { library: Some(9010), line: 4 }]);
    assert_eq!(trouble.fault.column, 5);
}

#[test]
fn goto_searches_forward_and_then_from_the_start() {
    assert_eq!(xs("O1\nG0\n#1=0\nN1X1.\n#1=#1+1\nIF[#1GT1]GOTO[1+1]\nGOTO1\nN1X8.\nN2X2.\nM30\n"), [1.0, 8.0, 2.0]);
}

#[test]
fn a_switch_leaves_blocks_out() {
    let settings = MacroSettings { block_delete: 0b100, ..MacroSettings::default() };
    let run = run_with("G0X1.\n/2X2.\n/X3.\n/2#1=4.\nX#1\nX5.\nM30\n", &[], settings);
    assert_eq!(run.ends_mm().iter().map(|end| end[0]).collect::<Vec<_>>(), [1.0, 3.0, 5.0]);
}
