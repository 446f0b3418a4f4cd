//! Programs as shops write them, through the command line.

use arcfeed::program::{RunBounds, Source};
use arcfeed_nc::segment::Segment;
use arcfeed_nc_macro::program::first_macro;
use arcfeed_tests::{Scratch, run};

use super::{CLOCKWISE, Case, JOB};

const HEAD: &str = "%\nO1000 (PART)\nG21G17G90G94\nT1M6\nS8000M3\nG0X0.Y0.Z5.\n";
const HOLE: &str = "O9010 (HOLE)\n#30=#4003\nG90G0X#24Y#25Z2.\nG1Z-2.F[#9/3]\nG1X[#24+#18]F#9\nG3I-#18 (CIRCLE)\n\
                    G1X#24\nG0Z2.\nG#30\nM99\n";

/// Runs a command; answers its exit code, stdout and stderr.
fn command(arguments: &[&str]) -> (Option<i32>, String, String) {
    let done = run(arguments);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (done.status.code(), text(&done.stdout), text(&done.stderr))
}

fn job(scratch: &Scratch, program: &str, more: &str) -> String {
    scratch.write("program.nc", program);
    scratch.write("job.toml", format!("{}{more}", JOB.replace(CLOCKWISE, "")))
}

fn adapted(scratch: &Scratch, job: &str, options: &[&str]) -> String {
    let out = scratch.path("out.nc");
    let (code, _, said) = command(&[&["adapt", job, "-o", &out], options].concat());
    assert!(code == Some(0) && !said.contains("error"), "{said}");
    std::fs::read_to_string(out).expect("the adapted program")
}

#[test]
fn holes_of_one_radius_get_their_feed_in_the_macro() {
    let scratch = Scratch::new("macros-holes");
    let program = format!("{HEAD}G65P9010X10.Y0.R8.F900.\nG65P9010X40.Y0.R8.F900.\nG0Z50.\nM30\n{HOLE}%\n");
    let job = job(&scratch, &program, "");
    let sent = "G3I-#18F984.6 (CIRCLE)\nG1X#24F900.\n";
    assert_eq!(adapted(&scratch, &job, &[]), program.replace("G3I-#18 (CIRCLE)\nG1X#24\n", sent));
    let (_, diff, _) = command(&["adapt", &job, "--diff"]);
    assert!(diff.contains("program.nc:16\n- G3I-#18 (CIRCLE)\n+ G3I-#18F984.6 (CIRCLE)\n"), "{diff}");
    let (_, checked, _) = command(&["check", &job]);
    assert!(checked.contains("called: O9010 2 times"), "{checked}");
    for name in ["simulate", "stream"] {
        let (code, said, _) = command(&[name, &job]);
        assert!(code == Some(0) && said.contains("no alarm"), "{said}");
    }
}

#[test]
fn holes_of_two_radii_are_refused_by_name_and_expanded_on_request() {
    let scratch = Scratch::new("macros-radii");
    let calls = "G65P9010X10.Y0.R8.F900.\nG65P9010X40.Y0.R12.F900.\n";
    let job = job(&scratch, &format!("{HEAD}{calls}G0Z50.\nM30\n{HOLE}%\n"), "");
    let (code, _, said) = command(&["adapt", &job, "-o", &scratch.path("out.nc")]);
    let refusal = "program.nc:16:8: error: its executions need different feeds: F984.6 in execution 1, called from line 7, \
                   but F1129.4 in execution 2, called from line 8";
    assert!(code == Some(1) && said.contains(refusal), "{said}");
    for part in ["--expand", "found `G3I-#18"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(!std::path::Path::new(&scratch.path("out.nc")).exists());
    let hole = |x: i32, radius: i32, feed: &str| {
        format!(
            "(HOLE)\nG90G0X{x}.Y0.Z2.\nG1Z-2.F300.\nG1X{}.F900.\nG3I-{radius}.F{feed}\nG1X{x}.F900.\nG0Z2.\nG90\n",
            x + radius
        )
    };
    let head = HEAD.replace("(PART)\n", "(PART)\n(EXPANDED FROM PROGRAM.NC)\n");
    let blocks = format!("{head}{}{}G0Z50.\nM30\n%\n", hole(10, 8, "984.6"), hole(40, 12, "1129.4"));
    assert_eq!(adapted(&scratch, &job, &["--expand"]), blocks);
    let (code, said, note) = command(&["simulate", &job]);
    assert!(code == Some(0) && said.contains("no alarm") && note.contains("--expand"), "{said}{note}");
}

#[test]
fn a_loop_of_depths_gets_one_feed() {
    let scratch = Scratch::new("macros-depths");
    let program = format!(
        "{HEAD}#3=0\nWHILE[#3GT-4]DO1\n#3=#3-1\nG1Z#3F200.\nG1X8.F900.\nN10 G3 I-8.\nG1X0.\nEND1\nG0Z50.\nM30\n%\n"
    );
    let job = job(&scratch, &program, "");
    let sent = "N10 G3 I-8.F984.6\nG1X0.F900.\n";
    assert_eq!(adapted(&scratch, &job, &[]), program.replace("N10 G3 I-8.\nG1X0.\n", sent));
    let expanded = adapted(&scratch, &job, &["--expand"]);
    assert_eq!(expanded.matches("N10G3I-8.F984.6").count() + expanded.matches("N10 G3 I-8.F984.6").count(), 4);
}

#[test]
fn a_contour_called_several_times_gets_its_feeds_also_from_a_library_as_blocks() {
    let scratch = Scratch::new("macros-contour");
    let head = HEAD.replace("Z5.\n", "Z5.\nG1Z0.F900.\n");
    let call = "G91\nM98P2000L3\nG90\nG0Z50.\nM30\n";
    let contour = "O2000\nG1Z-1.F200.\nX10.F900.\nG3X16.I8.\nG1X-26.\nM99\n";
    let program = format!("{head}{call}{contour}%\n");
    let job_file = job(&scratch, &program, "");
    let sent = adapted(&scratch, &job_file, &[]);
    assert_eq!(sent, program.replace("G3X16.I8.\nG1X-26.\n", "G3X16.I8.F984.6\nG1X-26.F900.\n"));
    // From a library, with M98 or M198, there is no place for a feed.
    for code in ["M98", "M198"] {
        let folder = scratch.path(code);
        std::fs::create_dir_all(&folder).expect("a folder");
        scratch.write(&format!("{code}/2000.nc"), contour);
        let main = format!("{head}{}%\n", call.replace("M98", code));
        let job_file = job(&scratch, &main, &format!("[control]\nlibrary = \"{code}\"\n"));
        let (status, _, said) = command(&["adapt", &job_file, "-o", &scratch.path("refused.nc")]);
        assert!(status == Some(1) && said.contains("a file of the library is not changed"), "{said}");
        assert!(
            said.contains("program.nc:9:1: error: ") && said.contains("2000.nc:4 needs F984.6, called from line 9"),
            "{said}"
        );
        let blocks = adapted(&scratch, &job_file, &["--expand"]);
        assert_eq!(blocks.matches("G3X16.I8.F984.6\nG1X-26.F900.\n").count(), 3, "{blocks}");
        let (status, said, _) = command(&["simulate", &job_file]);
        assert!(status == Some(0) && said.contains("no alarm"), "{said}");
        let proposed =
            ["init", &scratch.path("program.nc"), "--library", &folder, "--force", "-o", &scratch.path("first.toml")];
        let (status, said, _) = command(&proposed);
        assert!(status == Some(0) && said.contains("3 arcs"), "{said}");
        let first = std::fs::read_to_string(scratch.path("first.toml")).expect("a job");
        assert!(first.contains("library = "), "{first}");
    }
}

#[test]
fn an_f_from_a_variable_is_replaced_where_all_executions_agree() {
    let scratch = Scratch::new("macros-variable");
    let program =
        format!("{HEAD}#9=900.\nM98P2L2\nM30\nO2\nG1Z-1.F[#9/3]\nX8.F#9\nG3I-8.F[#9 / 2] (A)\nG1X0.F#9\nM99\n%\n");
    let job = job(&scratch, &program, "");
    assert_eq!(adapted(&scratch, &job, &[]), program.replace("G3I-8.F[#9 / 2] (A)", "G3I-8.F900. (A)"));
}

#[test]
fn a_stop_with_a_message_stays_a_stop() {
    let scratch = Scratch::new("macros-message");
    let program = format!("{HEAD}#1=1\nIF[#1EQ1]THEN#3006=1(TURN PART)\nG1X8.F900.\nM30\n%\n");
    let job = job(&scratch, &program, "");
    let expanded = adapted(&scratch, &job, &["--expand"]);
    assert!(expanded.contains("\nM0(TURN PART)\nG1X8.F900.\n"), "{expanded}");
}

/// Moves with their feeds that a program executes.
fn moves(source: &Source) -> Vec<Segment> {
    let program = source.whole().expect("a short program");
    assert!(!program.has_errors(), "{:?}", program.diagnostics);
    program.lines().filter_map(|line| line.segment()).collect()
}

#[test]
fn moves_in_pieces_are_written_back_where_all_executions_have_the_same() {
    let job = format!("{JOB}[override]\nmode = \"rewrite-only\"\n");
    // Lines before slower rounded corners are sent in two blocks: in a subprogram with absolute and one with relative ends.
    let body = "#2=1\nM98P3L2\nWHILE[#2LE3]DO1\nM98P2\n#2=#2+1\nEND1\nM30\nO2\nG91G1X40.F900.,R3.\nY30.\nX-40.\nY-30.\nG90\nM99\nO3\nG90G1X0Y0F900.\nX60.,R2.5\r\nY40.\nM99\n";
    let case = Case::new(&Scratch::new("pieces-back"), &format!("{HEAD}{body}"), &[], &job).expect("a job");
    let written = case.written.as_ref().expect("written back").clone();
    println!("{written}");
    let lines = |text: &str| text.lines().count();
    assert_eq!(lines(&written), lines(&case.text) + 2, "{written}");
    let of = |bytes: Vec<u8>| Source { macro_line: first_macro(&bytes), bytes, places: None, ..case.source.clone() };
    let again = of(written.into_bytes()).expanded(None, RunBounds::default()).expect("the program runs");
    let [again, adapted] = [again, of(case.adapted.text.clone())].map(|source| moves(&source));
    assert!(adapted.len() > 20 && again == adapted, "{again:?}\n{adapted:?}");
}
