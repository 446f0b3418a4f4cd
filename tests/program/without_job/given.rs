//! Values of the command line that do not fit the program.

use arcfeed_tests::{Scratch, run};

use super::{adapted, refused, text_of};

#[test]
fn where_an_axis_is_mirrored_no_arc_is_fed_faster() {
    let scratch = Scratch::new("without-job-mirror");
    // A pocket's corner, and its image: inside both times, and clockwise in the image.
    let text = "%\nO1\nG21G17G90G94\nT1M6\nS5000M3\nM98P2\nG51.1X0\nM98P2\nG50.1X0\nM30\nO2\nG0X10.Y5.Z1.\nG1Z-2.F150.\nX30.F600.\nG3X38.Y13.J8.\nG1Y30.\nG0Z5.\nM99\n%\n";
    let path = scratch.write("p.nc", text);
    for command in ["adapt", "simulate", "stream", "init"] {
        let (code, message) = refused(&[command, &path, "--tool", "10", "--max", "150"]);
        assert!(code == Some(2) && message.contains("p.nc:7: --max: the program mirrors an axis here"), "{message}");
    }
    let expanded = adapted(&path, &["--tool", "10", "--expand"]);
    let arcs: Vec<&str> = expanded.lines().filter(|line| line.starts_with("G3")).collect();
    assert_eq!(arcs, ["G3X38.Y13.J8.F369.2", "G3X38.Y13.J8."]);
}

#[test]
fn a_diameter_that_is_not_that_of_the_comment_is_warned_of() {
    let scratch = Scratch::new("without-job-diameter");
    let text = "%\nO1\n(T2 - 1/4 FLAT ENDMILL - H2 - D2)\nG20G17G90G94\nT2M6\nS5000M3\nG0X0Y0Z1.\nG1Z-.1F9.\nX2.F30.\nG3X3.Y1.J1.\nM30\n%\n";
    let path = scratch.write("p.nc", text);
    let said = |tool: &str| text_of(&run(&["adapt", &path, "--tool", tool]).stderr);
    assert!(
        said("10").contains("warning: --tool gives a diameter of 10.0 in, line 3 says 0.25 in: "),
        "{}",
        said("10")
    );
    assert!(!said("0.25").contains("warning") && !said("6.35mm").contains("warning"), "{}", said("0.25"));
}

#[test]
fn a_program_for_linuxcnc_does_not_count_on_another_controls_reduction() {
    let scratch = Scratch::new("without-job-reduction");
    let text = "G90G94G21G17\nS5000M3\nG0X0Y0\nG41D7G1X20.F900.\nX40.\nG3X60.Y20.J20.\nG1Y40.\nG40X80.\nM30\n";
    let path = scratch.write("p.nc", text);
    let settings = |more: &str| scratch.write("machine.toml", format!("unit = 'mm'\n{more}[radius]\n7 = 5.0\n"));
    let reducing = settings("inside_arc_least = 10\n");
    // The control does all that the law wants: 15/20 of F.
    assert_eq!(adapted(&path, &["--tool", "10", "--settings", &reducing]), text);
    let out = scratch.path("out.ngc");
    let arguments = ["adapt", &path, "--tool", "10", "--settings", &reducing, "--for", "linuxcnc", "-o", &out];
    let (code, message) = refused(&arguments);
    assert!(code == Some(1) && message.contains("inside_arc_least"), "{message}");
    settings("");
    assert_eq!(run(&arguments).status.code(), Some(0));
}
