//! `engage --alike`: moves at other positions of the rotary axes get the arcs of the same path at the first ones, and those of moves at the
//! first positions are the same as without it, however late the program comes back to them.

use arcfeed_tests::run;

use crate::engage::cut_job::{Cut, MILL, rows};

/// A slot, the same path after the table has turned, beside the slot at the first position, and that path turned.
const PROGRAM: &str = "%\nG21G17G90G94\nG0A0.C0.Z50.\n\
    X-10.Y0.\nZ-2.\nN3G1X70.F600.\nG0Z50.\n\
    C90.\nX-10.Y0.\nZ-2.\nN4G1X70.\nG0Z50.\n\
    C0.\nX-10.Y3.\nZ-2.\nN5G1X70.\nG0Z50.\n\
    C90.\nX-10.Y3.\nZ-2.\nN6G1X70.\nG0Z50.\nM30\n%\n";

#[test]
fn moves_at_the_first_positions_have_their_own_arcs_and_the_others_those_of_the_same_path() {
    let tool = format!("{MILL}\n[machine]\npreset = \"mikron-ucp710\"");
    let cut = Cut {
        name: "alike",
        tool: &tool,
        workpiece: "block = { from = [0, -20, -2], to = [60, 20, 0] }",
        rule: "moves = \"lines\"\nside = \"outer\"\nn = [3, 6]",
        program: PROGRAM,
    };
    let (scratch, job) = cut.engaged();
    let alike = scratch.path("alike.toml");
    let output = run(&["engage", "--alike", &job, "-o", &alike]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |path: &str| rows(&std::fs::read_to_string(path).expect("a map"));
    let (own, alike) = (read(&scratch.path("map.toml")), read(&alike));
    assert_eq!(own.iter().map(|rows| !rows.is_empty()).collect::<Vec<_>>(), [true, false, true, false]);
    assert_ne!(own[0], own[2]);
    assert_eq!(alike, [&own[0], &own[0], &own[2], &own[2]].map(Clone::clone));
}
