//! Programs whose blocks do not follow from program and settings, or that would run otherwise with feeds written back.

use arcfeed_tests::{Scratch, run};

use super::{CLOCKWISE, Case, JOB};

const HEAD: &str = "%\nG21G17G90G94\nT1M6\nS8000M3\nG0X0.Y0.Z5.\n#1=0\n";

fn refusal(name: &str, body: &str, job: &str) -> String {
    let scratch = Scratch::new(&format!("macros-refused-{name}"));
    match Case::new(&scratch, &format!("{HEAD}{body}"), &[], job) {
        Err(refusal) => refusal,
        Ok(case) => case.written.expect_err(body),
    }
}

#[test]
fn what_only_the_control_knows_is_refused_at_its_place() {
    for (name, body, place, words) in [
        ("common", "G1X#500F900.\nM30\n", "7:4", "the value of #500 here is known to the control only"),
        ("timer", "WHILE[#3001LT9]DO1\nEND1\nM30\n", "7:7", "#3001"),
        ("offset", "G1X[#5221+1.]F900.\nM30\n", "7:5", "#5221"),
        ("switch", "/GOTO5\nN5M30\n", "7:1", "a / before a macro statement"),
        ("switched-end", "#2=#1\n/M30\nM30\n", "8:1", "a / before a macro statement"),
        ("switched-feed", "/G1X5.F900.\n#2=#4109\nM30\n", "8:4", "#4109 here is known"),
        ("switched-position", "/G1X5.F900.\n#2=#5001\nM30\n", "8:4", "#5001 here is known"),
        ("switched-function", "/M8\n#2=#4113\nM30\n", "8:4", "#4113 here is known"),
        ("offset-set", "#5221=10.\nM30\n", "7:1", "#5221 sets an offset"),
        ("restart", "IF[#1EQ0]GOTO9\nN9M99\n", "8:1", "end it with M30"),
        ("unknown", "M98P77\nM30\n", "7:4", "PS0078"),
        ("end", "#2=#1\n", "7:1", "PS5010"),
        ("alarm", "#3000=5(NO TOOL)\nM30\n", "7:1", "NO TOOL"),
    ] {
        let said = refusal(name, body, JOB);
        assert!(
            said.starts_with(&format!("program.nc:{place}: error ")) || said.contains(&format!(":{place}: error")),
            "{said}"
        );
        assert!(said.contains(words), "{said}");
    }
    let start = "%\nG21G17G90G94\nG1X[#5001+5.]F900.\nM30\n";
    let scratch = Scratch::new("macros-refused-position");
    let said = Case::new(&scratch, start, &[], JOB).err().expect("an unknown position");
    assert!(said.contains("program.nc:3:5: error") && said.contains("#5001"), "{said}");
}

#[test]
fn values_set_by_the_program_are_known() {
    let scratch = Scratch::new("macros-known");
    let text = format!("{HEAD}#500=#0\nIF[#500EQ#0]GOTO8\nG1X9.F900.\nN8G1X[#5001+2.]F900.\n#5204=0\nM30\n%\n");
    let case = Case::new(&scratch, &text, &[], JOB).expect("an executable program");
    let blocks = "G0X0.Y0.Z5.\nN8G1X2.F900.\n#5204=0\nM30\n%\n";
    assert!(case.expanded()[0].ends_with(blocks), "{}", case.expanded()[0]);
    assert_eq!(case.written.expect("nothing to write"), text);
}

#[test]
fn a_macro_that_reads_f_is_not_written_back() {
    let body = "G1X8.Z-1.F900.\nG3I-8.\n#2=#4109\nG1X[#2/100]F900.\nM30\n%\n";
    let said = refusal("reads-f", body, JOB);
    assert!(said.contains(":10:1: error: with the feeds written back the program executes other blocks"), "{said}");
}

#[test]
fn a_move_in_pieces_whose_ends_depend_on_variables_is_not_written_back() {
    let table = JOB
        .replace(CLOCKWISE, "")
        .replace("kind = \"contour\"\ninside_only = false", "kind = \"table\"")
        .replace("side = \"inside\"\nradial_depth = 0.5\n", "side = \"slot\"\ntable = [[0.0, 0.02], [20.0, 0.06]]\n");
    let table = table + "[override]\nmode = \"rewrite-only\"\n";
    let said = refusal("pieces", "#2=8.\nG1X8.Z-1.F900.\nG3I-#2\nM30\n", &table);
    let why = "error: this move is sent in pieces, and their ends cannot be written where it has values of variables";
    assert!(said.contains(":9:") && said.contains(why) && said.contains("--expand"), "{said}");
}

#[test]
fn blocks_that_cannot_stand_for_the_program_are_not_written() {
    let scratch = Scratch::new("macros-ignored");
    let program = format!("{HEAD}#3004=2\nG1X5.F900.\n#3004=0\nM30\n%\n");
    scratch.write("program.nc", program);
    let job = scratch.write("job.toml", JOB);
    for (arguments, code) in [
        (vec!["adapt", &job, "--expand", "-o", &scratch.path("out.nc")], 1),
        (vec!["stream", &job], 1),
        (vec!["adapt", &job, "-o", &scratch.path("out.nc")], 0),
    ] {
        let done = run(&arguments);
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(code), "{said}");
        assert!(code == 0 || said.contains("program.nc: #3004 is set, line 7"), "{said}");
    }
}

#[test]
fn more_than_a_million_blocks_are_refused_with_their_number() {
    let scratch = Scratch::new("macros-many");
    let program = format!("{HEAD}WHILE[#1LT600000]DO1\n#1=#1+1\nG1X1.F900.\nX0.\nEND1\nM30\n%\n");
    scratch.write("program.nc", program);
    let done = run(&["adapt", &scratch.write("job.toml", JOB)]);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(1));
    assert!(said.contains("program.nc:6:1: error") || said.contains("program.nc:7:1: error"), "{said}");
    assert!(said.contains("1200005 blocks as executed, and at most 1048576"), "{said}");
}
