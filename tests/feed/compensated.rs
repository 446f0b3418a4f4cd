//! Laws along contours under G41 and G42: the feed at the contour, from the simulated control's own path, and the feeds of the
//! same path written without compensation.

use std::collections::{HashMap, HashSet};

use arcfeed::adapt::{Adapted, Known, PlanReason, adapt_with};
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::commands::simulate::foreseen;
use arcfeed::job::JobFile;
use arcfeed::program::{Program, ProgramLine};
use arcfeed_compensation::compensator::CenterMove;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::{STEP, Simulation};
use arcfeed_nc::modal::Turn;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_nc::settings::StartUp;
use arcfeed_tests::{Scratch, of_full_set};
use arcfeed_units::{Nm, S_PER_MIN};

use compensated_path::compensated;
use contours::ContourProgram;

#[path = "../rs274/compensated.rs"]
mod compensated_path;

#[path = "../rs274/contours.rs"]
mod contours;

/// Programmed feed of all contours, mm/min.
const FEED: f64 = 500.0;
/// Last digit of an F word, mm/min.
const F_DIGIT: f64 = 0.1;
/// Lowest factor of the law without a floor in the job, and the largest raise of F.
const FACTORS: [f64; 2] = [0.2, 2.0];
/// Error of a feed that is measured over a millisecond: rounding of both positions to nanometres.
const MEASURED: f64 = 2e-6 / 1e-3 * S_PER_MIN;

/// A contour with its job.
struct Case {
    scratch: Scratch,
    contour: ContourProgram,
}

/// Arc of the contour as programmed.
#[derive(Clone, Copy)]
struct ContourArc {
    center: [f64; 2],
    radius: f64,
}

impl Case {
    fn of_seed(name: &str, seed: u64) -> Self {
        Case { scratch: Scratch::new(&format!("{name}-{seed}")), contour: ContourProgram::of_seed(seed) }
    }

    /// Program with an N in each of these blocks.
    fn program(&self, blocks: &str) -> String {
        let blocks: String =
            blocks.lines().enumerate().map(|(index, block)| format!("N{}{block}\n", index + 1)).collect();
        format!("%\nO1\nG21G17G90G94\nS5000M3\n{blocks}M30\n%\n")
    }

    /// The job: the sides of counter-clockwise and clockwise arcs, and the lines of the settings file.
    fn job(&self, program: &str, [ccw, cw]: [&str; 2], mode: &str, settings: &str) -> (JobFile, Program, Adapted) {
        self.scratch.write("p.nc", program);
        self.scratch.write("machine.toml", format!("unit = 'mm'\n{settings}"));
        let target = if mode == "rewrite-only" { "'programmed'" } else { "0.05" };
        let text = format!(
            "units = 'mm'\nprogram = 'p.nc'\n[tool]\nkind = 'end-mill'\ndiameter = {}\nteeth = 2\n[spindle]\nrev_per_min = 5000\n\
             [law]\nkind = 'contour'\nfeed_per_tooth = {target}\ninside_only = false\n[limits]\nmax_feed = 5000\n\
             [override]\nmode = '{mode}'\n[control]\nsettings = 'machine.toml'\n\
             [[cut]]\nmoves = 'arcs'\ndirection = 'ccw'\nside = '{ccw}'\n[[cut]]\nmoves = 'arcs'\ndirection = 'cw'\nside = '{cw}'\n",
            2.0 * self.contour.radius_mm()
        );
        let file = JobFile::load(self.scratch.write("job.toml", text).as_ref()).expect("a job");
        let program = Program::parse_with(&file.program, program.as_bytes(), file.nc, file.tables);
        assert!(!program.has_errors(), "{:?}", program.diagnostics);
        let adapted = adapt_with(&program, &file.job, Known::of(&file));
        (file, program, adapted)
    }

    /// The tool's radius as that of the contour's D, whose number is twice the radius.
    fn radius(&self) -> String {
        format!("[radius]\n{} = {:?}\n", self.contour.d, self.contour.radius_mm())
    }

    fn is_left(&self) -> bool {
        self.contour.text.contains("G41")
    }

    /// Sides of counter-clockwise and clockwise arcs.
    fn sides(&self) -> [&'static str; 2] {
        if self.is_left() { ["inside", "outside"] } else { ["outside", "inside"] }
    }
}

fn point(pose: &[Nm; 3]) -> [f64; 2] {
    [pose[0], pose[1]].map(Nm::to_mm)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// F word of each block by its N.
fn words(text: &[u8]) -> HashMap<usize, String> {
    let text = String::from_utf8_lossy(text).into_owned();
    let word = |line: &str| {
        let number = line.strip_prefix('N')?;
        let digits = number.find(|letter: char| !letter.is_ascii_digit())?;
        let feed = line.rfind('F').map_or(String::new(), |at| line[at..].to_owned());
        Some((number[..digits].parse().ok()?, feed))
    };
    text.lines().filter_map(word).collect()
}

/// Arcs in the plane, by N.
fn arcs(moves: &[Segment]) -> HashMap<i64, ContourArc> {
    let arc = |segment: &Segment| {
        let arc = segment.arc()?;
        Some((segment.sequence?, ContourArc { center: arc.center.map(Nm::to_mm), radius: arc.radius_mm() }))
    };
    moves.iter().filter_map(arc).collect()
}

#[derive(Debug, Default)]
struct Figures {
    contours: usize,
    samples: usize,
    even: usize,
    /// Largest difference from the programmed feed at the contour, in digits of F.
    worst_digits: f64,
    metered: u64,
    metered_max: f64,
}

/// Measurement of the feed at a contour.
struct Measurement {
    arcs: HashMap<i64, ContourArc>,
    /// N of the blocks that a law governs.
    governed: HashSet<i64>,
    /// N of the arcs behind moves around a corner.
    behind_corner: HashSet<i64>,
    /// The program as sent.
    text: String,
}

impl Measurement {
    fn of(program: &Program, adapted: &Adapted) -> Self {
        let programmed: Vec<Segment> = program.lines.iter().filter_map(ProgramLine::segment).collect();
        let governed = adapted.blocks.iter().filter(|block| block.demand.is_some());
        Measurement {
            arcs: arcs(&programmed),
            governed: governed.filter_map(|block| block.segment.sequence).collect(),
            behind_corner: HashSet::new(),
            text: String::from_utf8_lossy(&adapted.text).into_owned(),
        }
    }

    /// Judges the feed of the centre on a move, at this place; `before` is that of the millisecond before.
    fn add(&mut self, segment: &Segment, at: [f64; 2], [before, center_feed]: [f64; 2], figures: &mut Figures) {
        let number = segment.sequence.expect("each block has an N");
        let text = &self.text;
        figures.samples += 1;
        let Some(arc) = self.arcs.get(&number).filter(|_| segment.arc().is_some()) else {
            if self.arcs.contains_key(&number) {
                self.behind_corner.insert(number);
            }
            assert!(center_feed <= FEED + MEASURED, "N{number}: {center_feed}\n{text}");
            return;
        };
        let factor = distance(at, arc.center) / arc.radius;
        let is_governed = self.governed.contains(&number);
        let most = if is_governed { FEED * factor.clamp(FACTORS[0], FACTORS[1]) } else { FEED };
        assert!(center_feed <= most * 1.005 + MEASURED, "N{number}: {center_feed} above {most}\n{text}");
        let is_free = is_governed && (FACTORS[0]..FACTORS[1]).contains(&factor);
        let is_held_down = factor > 1.0 && self.behind_corner.contains(&number);
        let is_steady = (center_feed - before).abs() < MEASURED && center_feed > 0.9 * most;
        if is_free && is_steady && !is_held_down {
            let digits = (center_feed - FEED * factor).abs() / F_DIGIT;
            assert!(digits <= 1.0 + MEASURED / F_DIGIT, "N{number}: {center_feed}, factor {factor}\n{text}");
            figures.worst_digits = figures.worst_digits.max(digits);
            figures.even += 1;
        }
    }
}

/// Runs an adapted contour; measures the feed at the contour each millisecond.
fn run(case: &Case, (file, program, adapted): &(JobFile, Program, Adapted), figures: &mut Figures) {
    let mut measurement = Measurement::of(program, adapted);
    let settings = control_settings(file);
    let mut simulation =
        Simulation::from_memory(settings, &adapted.text, &file.job, ControllerFault::None).expect("a run");
    simulation.set_planned_conditions(foreseen(program, adapted, &file.job));
    let (mut last, mut feed_before) = (None, 0.0);
    while !simulation.is_done() {
        simulation.step();
        let control = simulation.control();
        assert_eq!(control.alarm(), None, "{}", measurement.text);
        let at = point(&control.actual_position().linear);
        let now = control.active().map(|(count, segment)| (count, *segment));
        if let (Some((before, position)), Some((count, segment))) = (last, now)
            && before == (count, segment)
            && segment.path != Path::Rapid
        {
            let feed = distance(position, at) / STEP.to_s() * S_PER_MIN;
            measurement.add(&segment, at, [feed_before, feed], figures);
            feed_before = feed;
        }
        last = now.map(|now| (now, at));
    }
    let Measurement { arcs, governed, text, .. } = &measurement;
    for chips in simulation.meter().moves() {
        let number = chips.sequence.expect("each block has an N");
        assert!(governed.contains(&number), "N{number}\n{text}");
        let block = &simulation.control().executed()[chips.block as usize - 1];
        assert!(String::from_utf8_lossy(block).starts_with(&format!("N{number}G")), "N{number}");
        figures.metered += chips.any_contact.samples;
        // At the floor the feed at the contour is above its target, and the chip is not.
        if chips.any_contact.samples > 0 && case.contour.radius_mm() < 4.0 * arcs[&number].radius / 5.0 {
            figures.metered_max = figures.metered_max.max(chips.any_contact.max_ratio);
        }
    }
    figures.contours += 1;
}

#[test]
fn the_feed_at_the_contour_is_the_programmed_one_inside_and_outside() {
    let mut figures = Figures::default();
    for seed in 0..of_full_set(1_000, 120) {
        let case = Case::of_seed("compensated-run", seed);
        if compensated(&format!("G21G17\n{}", case.contour.text), StartUp::A).is_err() {
            continue;
        }
        // The job's sides are wrong for G42; the program's side counts.
        let job = case.job(&case.program(&case.contour.text), ["inside", "outside"], "rewrite-only", &case.radius());
        run(&case, &job, &mut figures);
    }
    println!("{figures:?}");
    assert!(figures.contours > 60 && figures.even > 10_000 && figures.metered > 1_000);
    assert!(figures.metered_max <= 1.005, "{figures:?}");
}

/// Arc of a contour in the path written by hand.
struct HandArc {
    /// N in the contour.
    number: usize,
    /// Block of the path, from 1.
    block: usize,
    /// Moves around a corner precede it.
    has_corner: bool,
}

/// The path of the tool centre as a program of its own, and the arcs of the contour in it.
fn written_by_hand(case: &Case) -> Option<(String, Vec<HandArc>)> {
    let found = compensated(&format!("G21G17\n{}", case.contour.text), StartUp::A).ok()?;
    let (mut blocks, mut arcs, mut number, mut has_corner) = (String::new(), Vec::new(), 0, false);
    for center_move in &found.centers {
        let (CenterMove::Corner(segment) | CenterMove::Main(segment)) = center_move;
        let is_main = matches!(center_move, CenterMove::Main(_));
        number += usize::from(is_main);
        let [x, y, z] = segment.end.linear.map(Nm::to_mm);
        let block = match &segment.path {
            Path::Rapid => format!("G0X{x:.6}Y{y:.6}Z{z:.3}"),
            Path::Line => format!("G1X{x:.6}Y{y:.6}Z{z:.3}F500."),
            Path::Arc(arc) => {
                let code = if arc.turn == Turn::Ccw { "G3" } else { "G2" };
                let start = point(&segment.start.linear);
                let [i, j] = [0, 1].map(|axis| arc.center[axis].to_mm() - start[axis]);
                format!("{code}X{x:.6}Y{y:.6}Z{z:.3}I{i:.6}J{j:.6}F500.")
            }
        };
        blocks += &format!("{block}\n");
        if is_main && segment.arc().is_some() {
            arcs.push(HandArc { number, block: blocks.lines().count(), has_corner });
        }
        has_corner = !is_main;
    }
    Some((blocks, arcs))
}

/// F of an F word; the program's without one.
fn value(word: &str) -> f64 {
    word.strip_prefix('F').map_or(FEED, |digits| digits.parse().expect("a number"))
}

#[test]
fn a_contour_gets_the_feeds_of_its_path_written_by_hand() {
    let (mut compared, mut changed, mut wear) = (0, 0, 0);
    for seed in 0..of_full_set(4_000, 400) {
        let case = Case::of_seed("compensated-hand", seed);
        let Some((blocks, arcs)) = written_by_hand(&case) else { continue };
        let contour = case.program(&case.contour.text);
        let (_, _, offset) = case.job(&contour, ["inside", "outside"], "rewrite-only", &case.radius());
        let (_, _, by_hand) = case.job(&case.program(&blocks), case.sides(), "rewrite-only", "");
        // The same path as a program with compensation of wear only, which is none.
        let side = if case.is_left() { "G41D9" } else { "G42D9" };
        let mut lines: Vec<String> = blocks.lines().map(str::to_owned).collect();
        let last = lines.len() - 1;
        lines[1] = format!("{side}{}", lines[1]);
        lines[last] = format!("G40{}", lines[last]);
        let (_, _, without_wear) = case.job(
            &case.program(&lines.join("\n")),
            ["inside", "outside"],
            "rewrite-only",
            "compensation = 'wear'\n",
        );
        let [offset, by_hand, without_wear] = [offset, by_hand, without_wear].map(|adapted| words(&adapted.text));
        for HandArc { number, block, has_corner } in arcs {
            let (ours, theirs) = (value(&offset[&number]), value(&by_hand[&block]));
            let wanted = if has_corner { theirs.min(FEED) } else { theirs };
            let what = format!("seed {seed}, N{number} and N{block}: {ours}, not {wanted}\n{contour}");
            assert!((ours - wanted).abs() < 1e-9, "{what}");
            compared += 1;
            changed += usize::from(ours != FEED);
            if block > 2 && block < last + 1 {
                assert!((value(&without_wear[&block]) - theirs).abs() < 1e-9, "wear: {what}\n{}", lines.join("\n"));
                wear += 1;
            }
        }
    }
    println!("{compared} arcs, {changed} with another feed than the programmed one, {wear} as wear only");
    assert!(changed > 200 && wear > 200);
}

#[test]
fn a_contour_whose_path_is_not_known_keeps_its_feeds() {
    let case = Case { scratch: Scratch::new("compensated-kept"), contour: ContourProgram::of_seed(3) };
    let radius_mm = case.contour.radius_mm();
    let blocks = format!(
        "G0X-20.Y0Z0\n{side}D{d}G1X0F500.\nX20.\nG3X30.Y10.J10.\nG1Y30.\nG2X50.Y50.I20.\nG1X70.\nG40X80.\n",
        side = "G41",
        d = case.contour.d
    );
    let program = case.program(&blocks);
    let kept = |program: &str, mode: &str, settings: &str| {
        let (_, _, adapted) = case.job(program, ["inside", "outside"], mode, settings);
        let reasons: Vec<PlanReason> =
            adapted.blocks.iter().filter(|block| block.rule.is_some()).map(|block| block.reason).collect();
        (String::from_utf8_lossy(&adapted.text) == *program, reasons)
    };
    let both = |reason| (true, vec![reason; 2]);
    let d = case.contour.d;
    let of = |radius_mm: f64| format!("[radius]\n{d} = {radius_mm:?}\n");
    assert_eq!(kept(&program, "rewrite-only", &of(radius_mm)), (false, vec![PlanReason::Law; 2]));
    assert_eq!(kept(&program, "rewrite-only", ""), both(PlanReason::NoRadius));
    for wrong in [0.02, -0.02, 0.7 * radius_mm, 1.3 * radius_mm] {
        assert_eq!(kept(&program, "rewrite-only", &of(wrong)), both(PlanReason::OtherRadius), "{wrong}");
    }
    let wear = |radius_mm: f64| format!("compensation = 'wear'\n{}", of(radius_mm));
    assert_eq!(kept(&program, "rewrite-only", &wear(radius_mm)), both(PlanReason::OtherRadius));
    // Wear of either sign leaves the tool on its side: F q/(q + r) inside and F q/(q - r) outside.
    for by in [0.0, 0.02, -0.02] {
        assert_eq!(kept(&program, "rewrite-only", &wear(by)).1, [PlanReason::Law; 2], "{by}");
    }
    for mode in ["safe-base", "override-only"] {
        assert_eq!(kept(&program, mode, &of(radius_mm)), both(PlanReason::NeedsRewriting), "{mode}");
    }
    for (from, to) in [("G1Y30.", "G1Y30.\n/M8"), ("X20.\n", "/X20.\n")] {
        let switched = case.program(&blocks.replace(from, to));
        let (is_same, reasons) = kept(&switched, "rewrite-only", &of(radius_mm));
        assert!(is_same || from == "G1Y30.", "{switched}");
        assert!(reasons.contains(&PlanReason::Special) || reasons.contains(&PlanReason::BlockDelete), "{reasons:?}");
    }
    for code in ["G63", "G95"] {
        let program = case.program(&blocks.replace("G0X-20.", &format!("{code}G0X-20.")));
        assert_eq!(kept(&program, "rewrite-only", &of(radius_mm)), both(PlanReason::Special), "{code}");
    }
}
