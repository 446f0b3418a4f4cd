//! `arcfeed init`: what it makes of the examples, and of generated programs whose tool is known.

use std::f64::consts::TAU;

use arcfeed::init::groups::group;
use arcfeed::init::propose::{LikelyTool, propose};
use arcfeed::init::survey;
use arcfeed::init::write::{Findings, job};
use arcfeed::job::{JobFile, questions};
use arcfeed_shared::tool::Tool;
use arcfeed_tests::{Scratch, root, run};
use fastrand::Rng;
use serde_json::Value;

/// Generated programs of each kind.
const PROGRAMS: u64 = 200;
/// rev/min of the examples and of what is generated.
const SPEEDS: [i64; 2] = [1_000, 8_000];

fn text_of(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("arcfeed speaks UTF-8")
}

fn init(program: &str, job: &str) -> Value {
    let output = run(&["init", program, "-o", job, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn keys(report: &Value) -> Vec<&str> {
    report["questions"].as_array().expect("a list").iter().map(|one| one["key"].as_str().expect("a key")).collect()
}

/// Puts the answers in place of the questions, in their order; an empty one removes the line.
fn answer(job: &str, answers: &[&str]) {
    let text = std::fs::read_to_string(job).expect("a job");
    let mut answers = answers.iter();
    let line = |line: &str| {
        if line.starts_with('#') || !line.contains("\"?\"") {
            return format!("{line}\n");
        }
        let answer = answers.next().expect("an answer for each question");
        if answer.is_empty() { String::new() } else { format!("{}\n", line.replace("\"?\"", answer)) }
    };
    let answered: String = text.lines().map(line).collect();
    assert_eq!(answers.next(), None);
    std::fs::write(job, answered).expect("it was just written");
}

fn adapted(job: &str) -> Vec<Value> {
    let output = run(&["adapt", job, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    text_of(&output.stdout).lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// Answering one question after another, check and adapt name the next one at its place.
fn assert_asks_in_order(job: &str, report: &Value) {
    let questions = report["questions"].as_array().expect("a list");
    let text = std::fs::read_to_string(job).expect("a job");
    for question in questions {
        let place = format!("{job}:{}:{}: an open question: `", question["line"], question["column"]);
        for command in ["check", "adapt", "simulate"] {
            let output = run(&[command, job]);
            let stderr = text_of(&output.stderr);
            assert_eq!((output.status.code(), stderr.starts_with(&place)), (Some(1), true), "{stderr} where {place}");
            assert!(stderr.contains(question["key"].as_str().expect("a key")), "{stderr}");
        }
        let line = question["line"].as_u64().expect("a line") as usize;
        let now = std::fs::read_to_string(job).expect("a job");
        let answered: Vec<String> =
            (1..).zip(now.lines()).map(|(n, old)| if n == line { old.replace("\"?\"", "\"!\"") } else { old.into() }).collect();
        std::fs::write(job, answered.join("\n")).expect("it was just written");
    }
    std::fs::write(job, text).expect("it was just written");
}

#[test]
fn the_published_cup_mill_is_found_and_its_four_movements_are_told_apart() {
    let scratch = Scratch::new("init-slot");
    let program = scratch.write("ibr-slot.nc", std::fs::read(root().join("examples/ibr-slot/ibr-slot.nc")).expect("the example"));
    let job = scratch.path("ibr-slot.toml");
    let report = init(&program, &job);
    let tool = &report["tool"];
    // The program's coordinates have four decimals, and its arcs sweep 6 degrees.
    for (field, published) in [("outer_radius", 5.06205), ("inner_radius", 4.43706)] {
        let found = tool[field].as_f64().expect("a radius");
        println!("{field}: {found:.5}, published {published}");
        assert!((found - published).abs() < 1e-4, "{tool}");
    }
    assert_eq!((&tool["kind"], &tool["number"], &report["unit"]), (&"cup-mill".into(), &14.into(), &"in".into()));
    let wanted = ["tool.active_teeth", "law.feed_per_tooth", "cut.1.stock", "cut.2.stock", "cut.3.stock", "cut.4.stock"];
    assert_eq!((keys(&report), &report["rules"]), (wanted.to_vec(), &4.into()));
    assert_asks_in_order(&job, &report);
    let stocks = [(54.187, 4.2391), (48.104, 10.4502), (81.715, 10.7843), (97.563, 7.2959)]
        .map(|(normal, offset)| format!("{{ normal_deg = {normal}, offset = {offset} }}"));
    answer(&job, &[&["10", "0.004"][..], &stocks.each_ref().map(String::as_str)].concat());
    assert_eq!(run(&["check", &job]).status.code(), Some(0));
    let published = adapted("examples/ibr-slot/job.toml");
    let mut compared = 0;
    for (mine, example) in adapted(&job).iter().zip(&published).filter(|(_, example)| example["reason"] == "law") {
        for field in ["rotation", "direction", "side", "line"] {
            assert_eq!(mine[field], example[field]);
        }
        let [mine, example] = [mine, example].map(|block| block["feed_min"].as_f64().expect("a feed"));
        assert!((mine / example - 1.0).abs() < 1e-3, "{mine} in/min, not {example}");
        compared += 1;
    }
    assert_eq!(compared, 20);
}

#[test]
fn the_pockets_arcs_are_told_apart_by_their_numbers() {
    let scratch = Scratch::new("init-pocket");
    let program = scratch.write("pocket.nc", std::fs::read(root().join("examples/pocket/pocket.nc")).expect("the example"));
    let job = scratch.path("pocket.toml");
    let report = init(&program, &job);
    let found: Vec<(f64, u64, &Value)> = report["groups"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|group| (group["radius"].as_f64().expect("a radius"), group["arcs"].as_u64().expect("a count"), &group["n"]))
        .collect();
    let n = |first: i64, last: i64| Value::from(vec![first, last]);
    assert_eq!(found, [(3.0, 4, &n(140, 200)), (15.0, 1, &n(310, 310)), (25.0, 1, &n(440, 440))]);
    assert_eq!((&report["tool"]["kind"], &report["spindle_speeds"]), (&"end-mill".into(), &vec![8_000].into()));
    assert_asks_in_order(&job, &report);
    answer(&job, &["10", "4", "0.1", "\"inside\"", "1.0", "\"slot\"", "", "\"outside\"", "1.0"]);
    let (mine, example) = (adapted(&job), adapted("examples/pocket/job-contour.toml"));
    for (mine, example) in mine.iter().zip(&example) {
        assert_eq!((&mine["side"], &mine["law"]), (&example["side"], &example["law"]));
        // The example wants half the feed in the slot, and no less than 30 % anywhere.
        if mine["n"] != 440 {
            assert_eq!(mine, example);
        }
    }
}

#[test]
fn a_program_of_its_time_leaves_all_questions_open_and_its_job_says_so() {
    let scratch = Scratch::new("init-corpus");
    let job = scratch.path("first.toml");
    let report = init("tests/corpus/cam-2003.nc", &job);
    let wanted = [
        "tool.diameter", "tool.teeth", "spindle.rev_per_min", "law.feed_per_tooth", "cut.1.side", "cut.1.radial_depth",
        "cut.2.side", "cut.2.radial_depth",
    ];
    assert_eq!((keys(&report), &report["arcs"], &report["errors"]), (wanted.to_vec(), &3.into(), &0.into()));
    assert_asks_in_order(&job, &report);
    answer(&job, &["1", "4", "1000", "0.004", "\"inside\"", "0.1", "\"outside\"", "0.1"]);
    assert_eq!(run(&["check", &job]).status.code(), Some(0));
    assert_eq!(adapted(&job).iter().filter(|block| block["reason"] == "law").count(), 3);
}

#[test]
fn nothing_is_written_over_without_force_and_nothing_made_up() {
    let scratch = Scratch::new("init-force");
    let program = scratch.write("bare.nc", "G90G94\nG0X1.Y0\nG3X0Y1.I-1.F10.S500\nS600\nM30\n");
    let job = scratch.write("bare.toml", "mine\n");
    let output = run(&["init", &program]);
    assert_eq!((output.status.code(), std::fs::read_to_string(&job).expect("mine")), (Some(1), "mine\n".into()));
    assert!(text_of(&output.stderr).starts_with(&format!("{job}: exists already")));
    assert_eq!(run(&["init", &program, "--force"]).status.code(), Some(0));
    let text = std::fs::read_to_string(&job).expect("a job");
    let asked: Vec<String> = questions::open(&text).into_iter().map(|question| question.key).collect();
    assert_eq!(asked[0], "units");
    assert!(asked.contains(&"spindle.rev_per_min".to_owned()) && text.contains("S500, S600"));
    let missing = run(&["init", &scratch.path("nothing.nc")]);
    assert_eq!((missing.status.code(), scratch.files()), (Some(1), vec!["bare.nc".to_owned(), "bare.toml".into()]));
    let broken = scratch.write("broken.nc", "G21G90G94\nG1X5.F100.\nG3X0.Y0.\nG3X0Y0I-2.5\n");
    let output = run(&["init", &broken]);
    assert!(output.status.success() && text_of(&output.stderr).contains("1 errors, see `arcfeed check`"));
}

/// A program under construction.
struct Program {
    lines: Vec<String>,
    is_inch: bool,
    at: [f64; 2],
}

impl Program {
    fn new(rng: &mut Rng) -> Self {
        let is_inch = rng.bool();
        let lines = vec![format!("G{}G17G90G94T3M6", if is_inch { 20 } else { 21 }), format!("S{}M3", SPEEDS[rng.usize(0..2)])];
        Program { lines, is_inch, at: [0.0; 2] }
    }

    fn word(&self, letter: char, mm: f64) -> String {
        if self.is_inch { format!("{letter}{:.4}", mm / 25.4) } else { format!("{letter}{mm:.3}") }
    }

    fn add(&mut self, words: String) {
        let number = 10 * self.lines.len();
        self.lines.push(format!("N{number}{words}"));
    }

    /// Turns about a point, by so many radians, counter-clockwise positive.
    fn turn(&mut self, center: [f64; 2], by: f64) {
        let ([x, y], [cx, cy]) = (self.at, center);
        let (sin, cos) = libm::sincos(by);
        let to = [cx + (x - cx) * cos - (y - cy) * sin, cy + (x - cx) * sin + (y - cy) * cos];
        let code = if by > 0.0 { "G3" } else { "G2" };
        let words = [self.word('X', to[0]), self.word('Y', to[1]), self.word('I', cx - x), self.word('J', cy - y)];
        self.add(format!("{code}{}F25.", words.concat()));
        self.at = to;
    }

    fn go(&mut self, code: &str, to: [f64; 2]) {
        let words = [self.word('X', to[0]), self.word('Y', to[1])].concat();
        self.add(format!("{code}{words}F25."));
        self.at = to;
    }

    fn text(&self) -> String {
        self.lines.join("\n") + "\nM30\n"
    }
}

/// A cup mill's program, its inner and outer radius, mm: there and back about two points, a level after the other, and now
/// and then an arc that is none of its.
fn cup_mill(rng: &mut Rng) -> (String, [f64; 2]) {
    let outer = 30.0 + 150.0 * rng.f64();
    let inner = outer * (0.6 + 0.37 * rng.f64());
    let mut program = Program::new(rng);
    let base = [200.0 * rng.f64() - 100.0, 200.0 * rng.f64() - 100.0];
    let angle = TAU * rng.f64();
    let about = [(inner, angle), (outer, angle + 0.4 * rng.f64())]
        .map(|(radius, angle)| [base[0] + radius * libm::cos(angle), base[1] + radius * libm::sin(angle)]);
    program.go("G0", base);
    for level in 0..rng.usize(3..9) {
        let z = program.word('Z', -(level as f64));
        program.add(format!("G1{z}F25."));
        for (center, sense) in about.into_iter().zip([-1.0, 1.0]) {
            let by = sense * (0.1 + 0.5 * rng.f64());
            program.turn(center, by);
            program.turn(center, -by);
        }
        if rng.u8(0..3) == 0 {
            let other = [base[0] + 2.0 + 300.0 * rng.f64(), base[1]];
            program.turn(other, 0.3 + rng.f64());
            program.go("G0", base);
        }
    }
    (program.text(), [inner, outer])
}

/// An end mill's program: a rectangle whose corners have two radii, twice each, a few times over.
fn end_mill(rng: &mut Rng) -> String {
    let mut program = Program::new(rng);
    let radii = [2.0 + 8.0 * rng.f64(), 2.0 + 8.0 * rng.f64()];
    let (width, height) = (60.0 + 40.0 * rng.f64(), 60.0 + 40.0 * rng.f64());
    for pass in 0..rng.usize(1..4) {
        let grow = 20.0 * pass as f64;
        program.go("G0", [0.0, -grow]);
        let (right, top) = (width + grow, height + grow);
        // Each side, then the corner behind it.
        for (index, (to, into)) in
            [([right, -grow], [0.0, 1.0]), ([right, top], [-1.0, 0.0]), ([-grow, top], [0.0, -1.0]), ([-grow, -grow], [1.0, 0.0])]
                .into_iter()
                .enumerate()
        {
            let radius = radii[index % 2];
            let along: [f64; 2] = [into[1], -into[0]];
            let before = [to[0] - radius * along[0], to[1] - radius * along[1]];
            program.go("G1", before);
            program.turn([before[0] + radius * into[0], before[1] + radius * into[1]], TAU / 4.0);
        }
    }
    program.text()
}

/// What init makes of a text: the tool, and the job it writes.
fn proposed(scratch: &Scratch, text: &str) -> (LikelyTool, String) {
    let path = scratch.write("p.nc", text);
    let (program, survey) = survey::load(path.as_ref()).expect("just written");
    assert!(!program.has_errors(), "{:?}\n{text}", program.diagnostics);
    let groups = group(&survey.arcs);
    let proposal = propose(&groups);
    let job = job(&Findings { program: "p.nc", survey: &survey, groups: &groups, proposal: &proposal });
    (proposal.tool, job)
}

/// The job with an answer that makes sense for every question.
fn sound(scratch: &Scratch, job: &str) -> JobFile {
    let answers = [
        ("teeth = \"?\"", "teeth = 4"),
        ("diameter = \"?\"", "diameter = \"10 mm\""),
        ("feed_per_tooth = \"?\"", "feed_per_tooth = \"0.1 mm\""),
        ("stock = \"?\"", "stock = { from = [0, 1], to = [-1, 0] }"),
        ("side = \"?\"", "side = \"inside\""),
        ("radial_depth = \"?\"", "radial_depth = \"1 mm\""),
    ];
    let text = answers.iter().fold(job.to_owned(), |text, (question, answer)| text.replace(question, answer));
    JobFile::parse(scratch.path("p.toml").as_ref(), &text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn a_generated_cup_mill_is_found_with_its_radii() {
    let scratch = Scratch::new("init-cup-mills");
    let mut worst = 0.0_f64;
    for seed in 0..PROGRAMS {
        let (text, [inner, outer]) = cup_mill(&mut Rng::with_seed(seed));
        let (tool, job) = proposed(&scratch, &text);
        let LikelyTool::CupMill { outer_mm, inner_mm } = tool else { panic!("seed {seed}: {tool:?}\n{text}") };
        worst = worst.max((outer_mm / outer - 1.0).abs()).max((inner_mm / inner - 1.0).abs());
        assert!(worst < 1e-4, "seed {seed}: {outer_mm}, {inner_mm}, not {outer}, {inner}");
        let file = sound(&scratch, &job);
        let Tool::CupMill(mill) = file.job.tool else { panic!("{:?}", file.job.tool) };
        assert!((mill.outer_radius.to_mm() / outer - 1.0).abs() < 1e-4);
        assert_eq!(file.job.rules.len(), 4);
    }
    println!("{PROGRAMS} cup mills, radii off by {worst:.1e} at most");
}

#[test]
fn a_generated_contour_with_two_corner_radii_is_an_end_mills() {
    let scratch = Scratch::new("init-end-mills");
    for seed in 0..PROGRAMS {
        let text = end_mill(&mut Rng::with_seed(seed));
        let (tool, job) = proposed(&scratch, &text);
        assert_eq!(tool, LikelyTool::EndMill, "seed {seed}:\n{text}");
        assert!((1..=2).contains(&sound(&scratch, &job).job.rules.len()));
    }
}

#[test]
fn of_two_tools_the_one_with_more_arcs_gets_the_job_and_rules_that_leave_the_other_alone() {
    let scratch = Scratch::new("init-two-tools");
    let mut rng = Rng::with_seed(1);
    let (cup, [_, outer]) = cup_mill(&mut rng);
    let mut lines: Vec<String> = cup.lines().filter(|line| *line != "M30").map(str::to_owned).collect();
    let unit = if cup.starts_with("G20") { 25.4 } else { 1.0 };
    lines.push("T9M6".into());
    lines.push("N9000G0X0Y0".into());
    lines.push(format!("N9010G3X0Y0I{:.4}F30.", outer / unit));
    lines.push("M30".into());
    let (tool, job) = proposed(&scratch, &(lines.join("\n") + "\n"));
    assert!(matches!(tool, LikelyTool::CupMill { .. }) && job.contains("The program uses T3, T9. This job is for T3"));
    let rules = &sound(&scratch, &job).job.rules;
    assert!(rules.iter().any(|rule| rule.sequence.is_some_and(|(_, last)| last < 9_000)), "{job}");
    assert!(rules.iter().all(|rule| rule.sequence.is_none_or(|(_, last)| last < 9_000)), "{job}");
}
