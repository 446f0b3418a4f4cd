//! `arcfeed init`: what it makes of the examples, and of generated programs whose tool is known.

mod generated;

use arcfeed::init::answers::Answers;
use arcfeed::init::findings::Findings;
use arcfeed::init::groups::group;
use arcfeed::init::job_writer::job;
use arcfeed::init::proposal::{LikelyTool, propose};
use arcfeed::init::survey;
use arcfeed::job::{JobFile, questions};
use arcfeed_model::tool::Tool;
use arcfeed_nc::settings::{Preset, Reading, Scope, Settings, Tables};
use arcfeed_tests::{Scratch, root, run};
use arcfeed_units::LengthUnit;
use fastrand::Rng;
use generated::{cup_mill, end_mill};
use serde_json::Value;

/// Generated programs of each kind.
const PROGRAMS: u64 = 200;

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
        let answered: Vec<String> = (1..)
            .zip(now.lines())
            .map(|(n, old)| if n == line { old.replace("\"?\"", "\"!\"") } else { old.into() })
            .collect();
        std::fs::write(job, answered.join("\n")).expect("it was just written");
    }
    std::fs::write(job, text).expect("it was just written");
}

#[test]
fn the_published_cup_mill_is_found_and_its_four_movements_are_distinguished() {
    let scratch = Scratch::new("init-slot");
    let program =
        scratch.write("ibr-slot.nc", std::fs::read(root().join("examples/ibr-slot/ibr-slot.nc")).expect("the example"));
    let job = scratch.path("ibr-slot.toml");
    let report = init(&program, &job);
    let tool = &report["proposed"][0];
    // The program's coordinates have four decimals, and its arcs sweep 6 degrees.
    for (field, published) in [("outer_radius", 5.06205), ("inner_radius", 4.43706)] {
        let found = tool[field].as_f64().expect("a radius");
        println!("{field}: {found:.5}, published {published}");
        assert!((found - published).abs() < 1e-4, "{tool}");
    }
    assert_eq!((&tool["kind"], &tool["number"], &report["unit"]), (&"cup-mill".into(), &14.into(), &"in".into()));
    let wanted = [
        "tool.active_teeth",
        "law.feed_per_tooth",
        "cut.1.stock",
        "cut.2.stock",
        "cut.3.stock",
        "cut.4.stock",
        "limits.max_feed",
    ];
    assert_eq!((keys(&report), &tool["rules"]), (wanted.to_vec(), &4.into()));
    assert_asks_in_order(&job, &report);
    let stocks = [(54.187, 4.2391), (48.104, 10.4502), (81.715, 10.7843), (97.563, 7.2959)]
        .map(|(normal, offset)| format!("{{ normal_deg = {normal}, offset = {offset} }}"));
    answer(&job, &[&["10", "0.004"][..], &stocks.each_ref().map(String::as_str), &["100"]].concat());
    let text = std::fs::read_to_string(&job).expect("a job");
    std::fs::write(&job, text.replace("max_raise = 2", "max_raise = 4")).expect("it was just written");
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
fn the_pockets_job_has_a_rule_for_each_sense_and_no_question() {
    let scratch = Scratch::new("init-pocket");
    let program =
        scratch.write("pocket.nc", std::fs::read(root().join("examples/pocket/pocket.nc")).expect("the example"));
    let job = scratch.path("pocket.toml");
    let report = init(&program, &job);
    let found: Vec<(f64, u64, &Value)> = report["groups"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|group| {
            (group["radius"].as_f64().expect("a radius"), group["arcs"].as_u64().expect("a count"), &group["n"])
        })
        .collect();
    let n = |first: i64, last: i64| Value::from(vec![first, last]);
    assert_eq!(found, [(3.0, 4, &n(140, 200)), (15.0, 1, &n(310, 310)), (25.0, 1, &n(440, 440))]);
    let tool = &report["proposed"][0];
    // From the comment "END MILL D10, 4 TEETH" before the tool change.
    assert_eq!((&tool["kind"], &tool["teeth"], &tool["rules"]), (&"end-mill".into(), &4.into(), &2.into()));
    assert_eq!((&tool["diameter"], &tool["comment_line"]), (&10.0.into(), &3.into()));
    assert_eq!((keys(&report), &report["spindle_speeds"]), (Vec::new(), &vec![8_000].into()));
    for (mine, example) in adapted(&job).iter().zip(&adapted("examples/pocket/job-contour.toml")) {
        // The example wants 0.1 mm per tooth, the programmed feed, everywhere but in the slot.
        if mine["n"] != 440 {
            assert_eq!((&mine["side"], &mine["law"]), (&example["side"], &example["law"]));
            assert_eq!(mine["sent_feed"], example["sent_feed"]);
        }
    }
}

#[test]
fn comments_and_options_answer_the_questions() {
    let scratch = Scratch::new("init-answers");
    let program = "%\nO1\n(T1 D=10. CR=0.5 - BULLNOSE END MILL)\n(T7 8MM 3FL ENDMILL)\nG21G90G94\nT1M6\nS900M3\nG0X0Y0\n\
                   G3X10.Y0I5.F100.\nT7M6\nS700M3\nG0X0Y0\nG2X10.Y0I5.F200.\nM30\n";
    let (program, job) = (scratch.write("p.nc", program), scratch.path("p.toml"));
    let report = init(&program, &job);
    let found = |index: usize, key: &str| report["proposed"][index][key].clone();
    assert_eq!([found(0, "diameter"), found(1, "diameter")], [Value::from(10.0), Value::from(8.0)]);
    assert_eq!([found(0, "teeth"), found(1, "teeth"), found(1, "comment_line")], [Value::Null, 3.into(), 4.into()]);
    assert_eq!(keys(&report), Vec::<&str>::new());
    assert_eq!(adapted(&job).iter().filter(|block| block["reason"] == "law").count(), 2);
    let given =
        ["--feed-per-tooth", "0.02", "--teeth", "T1=2", "--tool", "T7=6", "--max", "120", "--force", "-o", &job];
    assert_eq!(run(&[&["init", &program][..], &given].concat()).status.code(), Some(0));
    let text = std::fs::read_to_string(&job).expect("a job");
    for line in ["diameter = 10.0", "diameter = 6.0", "teeth = 2", "teeth = 3", "max_feed = 240.0", "max_raise = 1.2"] {
        assert!(text.contains(line), "{line}:\n{text}");
    }
    assert_eq!(run(&["check", &job]).status.code(), Some(0));
}

#[test]
fn init_of_a_2003_program_asks_for_diameter_and_speed_and_the_answered_job_checks() {
    let scratch = Scratch::new("init-corpus");
    let job = scratch.path("first.toml");
    let report = init("tests/corpus/cam-2003.nc", &job);
    let wanted = ["tool.diameter", "spindle.rev_per_min"];
    assert_eq!((keys(&report), &report["arcs"], &report["errors"]), (wanted.to_vec(), &3.into(), &0.into()));
    assert_asks_in_order(&job, &report);
    answer(&job, &["1", "1000"]);
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
    assert!(asked.contains(&"tool.diameter".to_owned()) && text.contains("rev_per_min = 500"));
    let missing = run(&["init", &scratch.path("nothing.nc")]);
    assert_eq!((missing.status.code(), scratch.files()), (Some(1), vec!["bare.nc".to_owned(), "bare.toml".into()]));
    let broken = scratch.write("broken.nc", "G21G90G94\nG1X5.F100.\nG3X0.Y0.\nG3X0Y0I-2.5\n");
    let output = run(&["init", &broken]);
    let said = text_of(&output.stderr);
    assert!(output.status.success() && said.contains("broken.nc:3:1: error PS0022: "), "{said}");
    assert!(said.contains("arcs behind them may be missing"), "{said}");
}

/// Result of `init` for a text: the tool, and the written job.
fn proposed(scratch: &Scratch, text: &str) -> (LikelyTool, String) {
    let path = scratch.write("p.nc", text);
    let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Inch, Reading::Lenient);
    let settings = Settings { scope: Scope::Everything, ..settings };
    let loaded = survey::load(path.as_ref(), (settings, Tables::default()), None, None);
    let (program, survey) = loaded.expect("just written");
    assert!(!program.has_errors(), "{:?}\n{text}", program.diagnostics);
    let groups = group(&survey.arcs);
    let answers = &Answers::default();
    let proposal = propose(&groups, &survey, answers);
    let control = &[("preset", "fanuc-16i".to_owned())];
    let job =
        job(&Findings { program: "p.nc", survey: &survey, groups: &groups, proposal: &proposal, answers, control });
    (proposal.tools[0].kind, job)
}

/// The job with an answer that makes sense for every question.
fn sound(scratch: &Scratch, job: &str) -> JobFile {
    let answers = [
        ("teeth = \"?\"", "teeth = 4"),
        ("max_feed = \"?\"", "max_feed = \"3000 mm\""),
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
        let Tool::CupMill(mill) = file.job.tools.first().tool else { panic!("{:?}", file.job.tools.first().tool) };
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
fn each_of_two_tools_gets_its_own_rules() {
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
    assert!(matches!(tool, LikelyTool::CupMill { .. }), "{job}");
    assert!(job.contains("# T9 keeps its feeds: its diameter is unknown."), "{job}");
    let mut is_inside = false;
    let uncommented = job.lines().map(|line| {
        is_inside = line.starts_with("# T9 keeps") || (is_inside && line.starts_with('#'));
        line.strip_prefix("# ").filter(|_| is_inside && !line.contains("T9 keeps")).unwrap_or(line).to_owned() + "\n"
    });
    let job = sound(&scratch, &uncommented.collect::<String>()).job;
    let numbers: Vec<Option<i64>> = job.tools.iter().map(|setup| setup.number).collect();
    let tools: Vec<u8> = job.rules.iter().map(|rule| rule.tool).collect();
    assert_eq!((numbers, tools), (vec![Some(3), Some(9)], vec![0, 0, 0, 0, 1]));
}
