//! `adapt`, `simulate` and `stream` of a program without a job file: the tools come from its comments and from options.

mod given;

mod measured;

mod tool_changes;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use arcfeed::program::Program;
use arcfeed_nc::modal::Feed;
use arcfeed_nc::settings::Reading;
use arcfeed_tests::{Scratch, root, run};
use arcfeed_units::LengthUnit;
use fastrand::Rng;

const POCKET: &str = "examples/pocket/pocket.nc";
/// Random programs.
const PROGRAMS: u64 = 300;
/// Of those, streamed to the simulated control.
const STREAMS: u64 = 24;

fn text_of(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("arcfeed speaks UTF-8")
}

fn file_text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).expect("a text")
}

/// Output of `adapt` with these options.
fn adapted(program: &str, options: &[&str]) -> String {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let scratch = Scratch::new(&format!("without-job-{}", COUNT.fetch_add(1, Ordering::Relaxed)));
    let out = scratch.path("out.nc");
    let output = run(&[&["adapt", program, "-o", &out], options].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    file_text(&out)
}

/// Exit code and message.
fn refused(arguments: &[&str]) -> (Option<i32>, String) {
    let output = run(arguments);
    (output.status.code(), text_of(&output.stderr))
}

/// F of each cutting move, per minute, nm.
pub fn feeds(text: &str, unit: LengthUnit) -> Vec<Option<i64>> {
    let program = Program::parse(Path::new("p.nc"), text.as_bytes(), unit, Reading::Lenient);
    let moves = program.lines().filter_map(|line| line.meaning?.segment);
    moves.map(|segment| if let Feed::PerMinute(feed) = segment.feed { Some(feed.0) } else { None }).collect()
}

#[test]
fn an_inside_corner_gets_the_programmed_feed_at_its_contour() {
    // Centre path of radius 3 inside a contour of radius 8; the slot of radius 25 has its inside wall at 30.
    let original = file_text(POCKET);
    let corners =
        original.replace("G3X45.Y-17.I.0J3.", "G3X45.Y-17.I.0J3.F1200.").replace("N150G1Y27.", "N150G1Y27.F3200.");
    let corners =
        corners.replace("G3X42.Y30.I-3.J.0", "G3X42.Y30.I-3.J.0F1200.").replace("N170G1X-42.", "N170G1X-42.F3200.");
    let corners =
        corners.replace("G3X-45.Y27.I.0J-3.", "G3X-45.Y27.I.0J-3.F1200.").replace("N190G1Y-17.", "N190G1Y-17.F3200.");
    let corners =
        corners.replace("G3X-42.Y-20.I3.J.0", "G3X-42.Y-20.I3.J.0F1200.").replace("N210G1X5.", "N210G1X5.F3200.");
    assert_eq!(adapted(POCKET, &["--tool", "10"]), corners.replace("F1600.", "F1333.3"));
    assert_eq!(adapted(POCKET, &["--tool", "T1=10mm", "--mode", "rewrite-only"]), corners.replace("F1600.", "F1333.3"));
}

#[test]
fn a_wanted_feed_per_tooth_counts_where_it_is_below_the_programmed_feed() {
    let options = ["--tool", "10", "--teeth", "4", "--feed-per-tooth", "0.05", "--mode", "rewrite-only"];
    let text = adapted(POCKET, &options);
    // 0.05 mm x 4 teeth x 8000 rev/min = 1600 mm/min at the contour; times 3/8 and 25/30 at the centre. The island gets 1600.
    for block in ["N140G3X45.Y-17.I.0J3.F600.", "N310G2X.0Y-10.I.0J15.F1600.", "N440G3X125.Y25.I.0J25.F1333.3"] {
        assert!(text.contains(block), "{block}:\n{text}");
    }
    let faster = adapted(POCKET, &["--tool", "10", "--max", "140"]);
    // Outside, contour radius 10, centre 15: 1.5 times the feed at the contour, and at most 1.4.
    assert!(faster.contains("N310G2X.0Y-10.I.0J15.F4479.9"), "{faster}");
}

#[test]
fn tools_come_from_the_comments_and_other_tools_keep_their_feeds() {
    let program = "%\nO1\n(T1 D=10. CR=0. - ZMIN=-5. - FLAT END MILL)\n(T2 D=6. CR=3. - BALL END MILL)\n(T3 D=4. CR=0. - FLAT END MILL)\n\
                   G90G94G17G21\n@1@2@3M30\n%\n";
    let cut = |tool: i32| format!("T{tool}M6\nS5000M3\nG0X0Y0Z5.\nG1Z-1.F200.\nX20.F900.\nG3X26.Y6.I0J6.\nG1Y20.\n");
    let program = (1..=3).fold(program.to_owned(), |text, tool| text.replace(&format!("@{tool}"), &cut(tool)));
    let scratch = Scratch::new("without-job-tools");
    let path = scratch.write("p.nc", &program);
    let text = adapted(&path, &[]);
    // Contour radii 11 and 8; the ball keeps its feed.
    let arcs: Vec<&str> = text.lines().filter(|line| line.starts_with("G3")).collect();
    assert_eq!(arcs, ["G3X26.Y6.I0J6.F490.9", "G3X26.Y6.I0J6.", "G3X26.Y6.I0J6.F675."]);
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("G1Y20.")).collect();
    assert_eq!(lines, ["G1Y20.F900.", "G1Y20.", "G1Y20.F900."]);
    // A given diameter counts before the comment's, for its tool alone.
    assert!(
        adapted(&path, &["--tool", "T2=6"])
            .contains("T2M6\nS5000M3\nG0X0Y0Z5.\nG1Z-1.F200.\nX20.F900.\nG3X26.Y6.I0J6.F600.\n")
    );
    let (code, message) = refused(&["adapt", &path, "--tool", "10"]);
    assert!(code == Some(2) && message.contains("--tool T1=DIAMETER --tool T3=DIAMETER"), "{message}");
    let (code, message) = refused(&["adapt", &path, "--tool", "T9=10"]);
    assert!(code == Some(2) && message.contains("T9: this tool mills no arcs in G17"), "{message}");
}

#[test]
fn a_contour_under_compensation_needs_the_radius_of_its_d() {
    let scratch = Scratch::new("without-job-contour");
    let blocks = "G90G94G21G17\nS5000M3\nG0X0Y0\nG41D7G1X20.F900.\nX40.\nG3X60.Y20.J20.\nG1Y40.\nG40X80.\nM30\n";
    let path = scratch.write("p.nc", blocks);
    let unknown = run(&["adapt", &path, "--tool", "10"]);
    assert_eq!(unknown.status.code(), Some(0), "{}", text_of(&unknown.stderr));
    let said = text_of(&unknown.stderr);
    assert!(said.contains("p.nc:6: note: the arcs under G41 or G42 (1) keep their feed"), "{said}");
    assert_eq!(adapted(&path, &["--tool", "10"]), blocks);
    let settings = scratch.write("machine.toml", "unit = 'mm'\n[radius]\n7 = 5.0\n");
    // Contour radius 20, centre 15.
    let governed = blocks.replace("J20.", "J20.F675.").replace("G1Y40.", "G1Y40.F900.");
    assert_eq!(adapted(&path, &["--tool", "10", "--settings", &settings]), governed);
    let settings = scratch.write("machine.toml", "unit = 'mm'\ncompensation = 'wear'\n");
    let governed = governed.replace("F675.", "F720.");
    assert_eq!(adapted(&path, &["--tool", "10", "--settings", &settings]), governed);
}

#[test]
fn a_corner_in_a_contour_has_the_feed_of_its_block() {
    let scratch = Scratch::new("without-job-corner");
    let settings = scratch.write("machine.toml", "unit = 'mm'\n[radius]\n7 = 5.0\n");
    let options = ["--tool", "10", "--max", "150", "--settings", &settings];
    let contour = "G90G94G21G17\nS5000M3\nG0X0Y0\nG41D7G1X20.F900.\nX40.\nG2X50.Y-10.J-10.\nG1X80.\nG40Y0\nM30\n";
    // An outside arc of radius 10 with a centre path of 15: half as fast again.
    let path = scratch.write("p.nc", contour);
    assert_eq!(adapted(&path, &options), contour.replace("J-10.", "J-10.F1350.").replace("G1X80.", "G1X80.F900."));
    // The tool does not fit a rounding of 2 there (PS0041): nothing is known of the contour from there on.
    let with_corner = contour.replace("J-10.", "J-10.,R2.");
    let path = scratch.write("q.nc", &with_corner);
    assert_eq!(adapted(&path, &options), with_corner);
    // A rounding of 8 has a centre path of 3: the least of 15/10 and 3/8.
    let with_corner = contour.replace("J-10.", "J-10.,R8.");
    let path = scratch.write("r.nc", &with_corner);
    assert_eq!(adapted(&path, &options), with_corner.replace("R8.", "R8.F337.5").replace("G1X80.", "G1X80.F900."));
}

#[test]
fn the_floor_of_the_law_is_named_where_it_decides() {
    let scratch = Scratch::new("without-job-floor");
    let text = "G21G90G94G17\nS5000M3\nG0X0Y0Z0\nG3X2.Y0I1.F300.\nG3X4.6I1.3\nG2X6.6I1.\nG1X9.\nM30\n";
    let output = run(&["adapt", &scratch.write("p.nc", text), "--tool", "10", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    let blocks = text_of(&output.stdout);
    let blocks = blocks.lines().map(|line| serde_json::from_str(line).expect("an object"));
    let sent: Vec<(Option<f64>, String)> = blocks
        .filter(|block: &serde_json::Value| block["kind"] == "arc")
        .map(|block| (block["sent_feed"].as_f64(), block["reason"].as_str().expect("a reason").to_owned()))
        .collect();
    // Radius of the tool 5: factors 1/6, below a fifth, and 1.3/6.3, above; outside the F stays.
    let expected = [(60.0, "law-floor"), (61.9, "law"), (300.0, "law")];
    assert_eq!(sent, expected.map(|(feed, reason)| (Some(feed), reason.to_owned())));
}

#[test]
fn missing_values_are_named_with_their_option() {
    let scratch = Scratch::new("without-job-missing");
    let path = scratch.write("p.nc", "G90G94\nG0X0Y0\nG3X10.Y0I5.F100.\nM30\n");
    let (code, message) = refused(&["adapt", &path]);
    assert!(code == Some(2) && message.contains("write --tool DIAMETER"), "{message}");
    let (code, message) = refused(&["adapt", &path, "--tool", "4"]);
    assert!(
        code == Some(2) && message.contains("--units mm") && message.contains("--spindle REV_PER_MIN"),
        "{message}"
    );
    let options = ["--tool", "4", "--units", "mm", "--spindle", "9000"];
    let (code, message) = refused(&[&["adapt", &path][..], &options, &["--feed-per-tooth", "0.1"]].concat());
    assert!(code == Some(2) && message.contains("--teeth COUNT"), "{message}");
    assert!(adapted(&path, &options).contains("G3X10.Y0I5.F71.4\n"));
    let (code, message) = refused(&["adapt", "examples/pocket/job-contour.toml", "--tool", "10"]);
    assert!(code == Some(2) && message.contains("write them into the job"), "{message}");
    let lines = scratch.write("lines.nc", "G90G94G21\nG0X0Y0\nG1X10.F100.\nM30\n");
    assert_eq!(adapted(&lines, &[]), file_text(&lines));
}

#[test]
fn a_simulation_needs_no_job_file() {
    let output = run(&["simulate", POCKET, "--tool", "10", "--teeth", "4", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert_eq!(report["alarms"], serde_json::json!([]));
    assert!(report["cycle_time_s"].as_f64() > report["baseline_cycle_time_s"].as_f64());
}

/// Blocks of a program: its lines without `%`, as a control counts them.
fn blocks_of(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !matches!(line.trim(), "" | "%")).collect()
}

/// Blocks that the simulated control executes when the program is streamed to it.
fn streamed(program: &str, options: &[&str]) -> String {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let scratch = Scratch::new(&format!("without-job-stream-{}", COUNT.fetch_add(1, Ordering::Relaxed)));
    let executed = scratch.path("executed.nc");
    let output = run(&[&["stream", program, "--executed", &executed, "--baudrate", "115200"], options].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    file_text(&executed)
}

#[test]
fn a_program_is_streamed_with_the_feeds_that_adapt_writes() {
    let scratch = Scratch::new("without-job-streams");
    let mut streams = 0;
    for seed in 0..STREAMS {
        let text = random_program(&mut Rng::with_seed(seed));
        let path = scratch.write("p.nc", &text);
        if run(&["check", &path]).status.code() != Some(0) || !text.contains("G2") && !text.contains("G3") {
            continue;
        }
        let options: &[&str] = [&[][..], &["--milling", "conventional"], &["--max", "150"]][seed as usize % 3];
        let [executed, wanted] = [streamed(&path, options), adapted(&path, options)];
        assert_eq!(blocks_of(&executed), blocks_of(&wanted), "seed {seed}:\n{text}");
        streams += 1;
    }
    println!("{streams} programs streamed");
    assert!(streams > STREAMS / 2);
}

#[test]
fn a_stream_without_a_job_has_the_report_of_one_with_a_job() {
    let scratch = Scratch::new("without-job-same");
    let (program, job) = (scratch.write("p.nc", file_text(POCKET)), scratch.path("job.toml"));
    let options = ["--tool", "10", "--teeth", "4", "--feed-per-tooth", "0.05"];
    assert_eq!(run(&[&["init", &program, "-o", &job][..], &options].concat()).status.code(), Some(0));
    let report = |arguments: &[&str]| {
        let output = run(&[arguments, &["--json"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
        let mut report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
        report["real_time_factor"] = serde_json::Value::Null;
        report
    };
    let without = report(&[&["stream", &program][..], &options].concat());
    assert_eq!(without, report(&["stream", &job]));
    assert!(without["cycle_time_s"].as_f64() > without["baseline_cycle_time_s"].as_f64());
}

#[test]
fn a_stream_without_a_job_needs_a_mode_that_its_line_can_carry() {
    let teeth = ["--tool", "10", "--teeth", "4", "--feed-per-tooth", "0.05"];
    let stream = |options: &[&str]| refused(&[&["stream", POCKET][..], &teeth, options].concat());
    // Without a board nothing sets the override of a real control.
    let (code, message) = stream(&["--mode", "safe-base", "--port", "loop://"]);
    assert!(code == Some(2) && message.contains("--board"), "{message}");
    let (code, message) = stream(&["--port", "loop://", "--board", "loop://"]);
    assert!(code == Some(2) && message.contains("a board has nothing to do"), "{message}");
    let (code, message) = stream(&["--mode", "safe-base", "--board", "sim:"]);
    assert!(code == Some(0), "{message}");
    let (code, message) = refused(&["stream", POCKET, "--tool", "10", "--mode", "safe-base"]);
    assert!(code == Some(2) && message.contains("missing: --feed-per-tooth LENGTH; or make a job file"), "{message}");
    let (code, message) = refused(&["stream", "examples/pocket/job-contour.toml", "--tool", "10"]);
    assert!(code == Some(2) && message.contains("write them into the job"), "{message}");
}

/// A contour of lines and arcs with several tools, planes, levels and feeds.
fn random_program(rng: &mut Rng) -> String {
    let mut text = String::from("%\nO1\nG21G17G90G94\n");
    for tool in 1..=rng.u8(1..4) {
        text += &format!(
            "T{tool}M6 ({}MM ENDMILL)\nS{}M3\nG0X0Y0Z5.\nG1Z4.F500.\n",
            rng.u8(1..20),
            1000 * i32::from(rng.u8(1..9))
        );
        let mut x = 0.0;
        for _ in 0..rng.u8(3..20) {
            let radius = 0.01 + 20.0 * rng.f64() * rng.f64() * rng.f64();
            let feed = if rng.bool() { format!("F{}.", rng.u16(20..4000)) } else { String::new() };
            // Half turns and lines along X.
            let radius = (radius * 1e3_f64).round() / 1e3;
            x += 2.0 * radius;
            text += &match ["G2", "G3", "G1", "G18"][rng.usize(0..4)] {
                "G1" => format!("G1X{x:.3}{feed}\n"),
                "G18" => format!("G18G3X{x:.3}I{radius:.3}K0{feed}\nG17\n"),
                code => format!("{code}X{x:.3}I{radius:.3}J0{feed}\n"),
            };
        }
    }
    text + "M30\n%\n"
}

#[test]
fn without_max_no_feed_is_ever_above_its_programmed_one() {
    let scratch = Scratch::new("without-job-random");
    let (mut moves, mut slowed) = (0, 0);
    for seed in 0..PROGRAMS {
        let text = random_program(&mut Rng::with_seed(seed));
        let path = scratch.write("p.nc", &text);
        if run(&["check", &path]).status.code() != Some(0) || !text.contains("G2") && !text.contains("G3") {
            continue;
        }
        let options: &[&str] =
            [&[][..], &["--milling", "conventional"], &["--teeth", "9", "--feed-per-tooth", "0.5"]][seed as usize % 3];
        let (before, after) = [text.as_str(), &adapted(&path, options)].map(|text| feeds(text, LengthUnit::Mm)).into();
        assert_eq!(before.len(), after.len());
        for (before, after) in before.iter().zip(&after) {
            assert!(after <= before, "seed {seed}: {after:?} above {before:?}\n{text}");
            moves += 1;
            slowed += usize::from(after < before);
        }
    }
    println!("{moves} moves, {slowed} slowed down");
    assert!(slowed > moves / 10);
}

#[test]
fn subprograms_come_from_a_folder() {
    let scratch = Scratch::new("without-job-library");
    let main = "%\nO1\nG21G17G90G94\n(T1 D=10. - FLAT END MILL)\nT1M6\nS8000M3\nG0X0Y0Z5.\nM98P2000\nG3X8.Y0I-8.F1300.\nM30\n%\n";
    let program = scratch.write("main.nc", main);
    let folder = scratch.path("lib");
    std::fs::create_dir(&folder).expect("a scratch folder");
    scratch.write("lib/O2000.nc", "O2000\nG1X8.Z-1.F900.\nM99\n");
    for command in ["adapt", "simulate"] {
        let (code, said) = refused(&[command, &program]);
        assert!(code == Some(1) && said.contains("PS0078") && said.contains("--library"), "{said}");
    }
    // The circle begins at X8: radius 8 inside a contour of 13.
    let sent = adapted(&program, &["--library", &folder]);
    assert_eq!(sent, main.replace("G3X8.Y0I-8.F1300.", "G3X8.Y0I-8.F800."));
    assert_eq!(refused(&["simulate", &program, "--library", &folder]).0, Some(0));
}
