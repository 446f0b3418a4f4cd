//! Every macro alarm, raised by a program of a few lines.
//!
//! Numbers: program-error list of the Fanuc 16i.

use arcfeed_nc_macro::step::MacroSettings;

use crate::macros::run::{run, run_with};

/// Alarm, its line and column, the program.
const ALARMS: [(u16, u32, u16, &str); 44] = [
    (76, 1, 1, "M98\n"),
    (76, 1, 1, "G65A1.\n"),
    (77, 2, 4, "O1\nM98P1\nM30\n"),
    (78, 1, 4, "M98P7\nM30\n"),
    (78, 5, 4, "O1\nM98P2\nM30\nO2\nM99P5\n"),
    (111, 1, 11, "#1=EXP[99]*POW[10,30]\n"),
    (112, 2, 5, "#2=0\n#1=1/#2\n"),
    (112, 1, 5, "#1=5MOD0\n"),
    (113, 1, 4, "#1=FOO[1]\n"),
    (114, 1, 6, "#1=2+\n"),
    (114, 1, 3, "#1\n"),
    (114, 1, 4, "#1=\n"),
    (114, 1, 8, "#1=[2+3\n"),
    (114, 1, 5, "#1=2]\n"),
    (114, 1, 2, "##1=2\n"),
    (115, 1, 1, "#34=1\n"),
    (115, 1, 4, "#1=#200\n"),
    (115, 1, 2, "#[-1]=1\n"),
    (116, 1, 1, "#0=1\n"),
    (116, 1, 1, "#5001=1\n"),
    (116, 1, 1, "#4003=91\n"),
    (118, 1, 9, "#1=[[[[[[1]]]]]]\n"),
    (119, 1, 4, "#1=SQRT[-1]\n"),
    (119, 1, 4, "#1=LN[0]\n"),
    (119, 1, 4, "#1=ASIN[2]\n"),
    (119, 1, 4, "#1=BIN[15]\n"),
    (122, 2, 4, "O1\nG65P1\nM30\n"),
    (124, 1, 1, "DO1\n"),
    (124, 1, 1, "END1\n"),
    (124, 1, 1, "WHILE[1EQ1]DO1\nDO2\nEND1\nEND2\n"),
    (124, 1, 5, "GOTO5\nDO1\nN5\nEND1\n"),
    (125, 1, 11, "IF[1 EQ 1]G0X1.\n"),
    (125, 1, 12, "WHILE[1EQ1]\n"),
    (126, 1, 3, "DO4\nEND4\n"),
    (126, 1, 4, "END\n"),
    (127, 1, 6, "G0X1.#1=2\n"),
    (127, 1, 6, "G0X1.GOTO5\n"),
    (127, 1, 5, "#1=2G0X1.\n"),
    (128, 1, 5, "GOTO5\n"),
    (128, 1, 5, "GOTO0\n"),
    (129, 1, 6, "G65P2N5\nM30\nO2\nM99\n"),
    (129, 1, 6, "G65P2G1\nM30\nO2\nM99\n"),
    (3017, 1, 1, "#3000=17(TOOL WORN)\n"),
    (5010, 5, 0, "O1\nM98P2\nM30\nO2\nX1.\n"),
];

#[test]
fn each_alarm_is_raised_at_its_place() {
    let mut wrong = Vec::new();
    for (number, line, column, text) in ALARMS {
        let run = run(text);
        let found = run
            .alarm()
            .map(|(number, column)| (number, run.ended.as_ref().map_or_else(|t| t.place.line, |_| 0), column));
        if found != Some((number, line, column)) {
            wrong.push(format!("{text:?}: wanted {:?}, found {found:?}", (number, line, column)));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn an_alarm_of_the_program_brings_its_message() {
    let trouble = run("#3000=17(TOOL WORN)\n").ended.expect_err("an alarm");
    assert_eq!(trouble.message, b"TOOL WORN");
}

#[test]
fn in_dnc_operation_a_main_program_cannot_jump() {
    for (text, column) in [("GOTO5", 1), ("IF[1EQ1]GOTO5", 9), ("WHILE[1EQ1]DO1", 1), ("DO1", 1)] {
        let mut run = run_with("", &[], MacroSettings { is_dnc: true, ..MacroSettings::default() });
        run.interpreter.feed(text.as_bytes(), 7);
        let context = run.interpreter.variables().context;
        let trouble = run.interpreter.next(&context).expect_err("refused");
        assert_eq!((trouble.place.line, trouble.fault.column), (7, column), "{text}");
        assert!(trouble.fault.cause.to_string().starts_with("PS0123"), "{text}");
    }
}

#[test]
fn going_round_without_a_move_ends_in_an_error_that_names_the_place() {
    for text in ["N1GOTO1\n", "DO1\nEND1\n", "DO1\nM8\nEND1\n"] {
        let trouble = run(text).ended.expect_err("bounded");
        assert!(trouble.place.line >= 1 && trouble.fault.column == 1, "{text}: {trouble:?}");
        assert!(trouble.fault.cause.to_string().contains("without a move"), "{text}");
    }
}
