//! `check` of programs that never come to their end: an error at the line reached, which says how many blocks were executed and
//! what raises the bound.

use std::time::{Duration, Instant};

use arcfeed_tests::{Ended, Running, Scratch};

/// Checks a program with these flags.
fn check(name: &str, text: &str, flags: &[&str]) -> (Ended, String) {
    let scratch = Scratch::new(&format!("loop-{name}"));
    scratch.write("O9001.nc", "O9001\nM98P9001\nM99\n");
    let (path, library) = (scratch.write("loop.nc", text), scratch.path(""));
    let ended = Running::start(&scratch, "check", &[&["check", &path, "--library", &library], flags].concat()).end();
    (ended, path)
}

fn assert_endless(name: &str, text: &str, line: usize, bound: &str) {
    let (ended, path) = check(name, text, &["--max-blocks", "5000"]);
    assert_eq!(ended.code, Some(1), "{name}: {ended:?}");
    let place = format!("{path}:{line}:1: error: the program does not come to its end");
    assert!(ended.err.contains(&place), "{name}: {}", ended.err);
    for words in [" blocks executed", bound, "--max-blocks raises the bound"] {
        assert!(ended.err.contains(words), "{name}: {words}: {}", ended.err);
    }
}

#[test]
fn loops_without_a_move_end_at_the_bound_of_statements() {
    let bound = "5000 statements since the last move";
    assert_endless("while", "%\nO1\nWHILE[1EQ1]DO1\nEND1\nM30\n%\n", 3, bound);
    assert_endless("goto", "%\nO1\nN10#1=#1+1\nG90\nGOTO10\nM30\n%\n", 3, bound);
}

#[test]
fn loops_that_make_blocks_for_ever_end_at_the_bound_of_blocks() {
    assert_endless("blocks", "%\nO1\nG21G1F100.\nWHILE[1EQ1]DO1\nX1.\nEND1\nM30\n%\n", 5, "at most 5000");
    assert_endless("dwells", "%\nO1\nN10G4X1.\nGOTO10\nM30\n%\n", 3, "at most 5000");
}

#[test]
fn calls_of_a_program_by_itself_end_at_once_and_m99_in_the_main_program_ends_it() {
    let (ended, path) = check("recursion", "%\nO1\nM98P9001\nM30\n%\n", &[]);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(ended.err.contains(&format!("{path}:3:1: error PS0077")), "{}", ended.err);
    let (ended, _) = check("m99", "%\nO1\nG4X1.\n#1=1\nM99\n%\n", &[]);
    assert_eq!(ended.code, Some(0), "{ended:?}");
}

#[test]
fn many_calls_end_at_the_bound_of_blocks() {
    let text = "%\nO1\nM98P2L99999999\nM30\nO2\nG4X1.\nM99\n%\n";
    assert_endless("calls", text, 6, "at most 5000");
}

#[test]
fn a_loop_within_the_bounds_of_blocks_ends_at_the_bound_of_time() {
    let text = "%\nO1\nG21G1F100.\nWHILE[1EQ1]DO1\n#1=0\nWHILE[#1LT100000]DO2\n#1=#1+1\nEND2\nX1.\nEND1\nM30\n%\n";
    let started = Instant::now();
    let (ended, path) = check("time", text, &["--max-seconds", "2"]);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(
        ended.err.contains(&format!("{path}:")) && ended.err.contains("error: the program does not come"),
        "{}",
        ended.err
    );
    assert!(ended.err.contains("2 s; --max-seconds raises the bound"), "{}", ended.err);
    assert!(started.elapsed() < Duration::from_secs(30), "{:?}", started.elapsed());
}
