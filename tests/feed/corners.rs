//! Feeds beside chamfers and rounded corners (`,C`, `,R`): the executed path of random programs against the same path written
//! with G1, G2 and G3.

use arcfeed::adapt::{Adapted, Known, PlanReason, adapt_with};
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::commands::simulate::foreseen;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_nc::modal::{Feed, Turn};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_tests::{Scratch, of_full_set};
use arcfeed_units::Nm;
use fastrand::Rng;

/// Distance within which two ends are the same point: far below the shortest move.
const SAME_POINT_NM: i64 = 1_000;
/// Largest distance between ends of both paths: a corner is computed again from the rest of a divided line.
const END_MAX_NM: i64 = 3;
/// Amount by which `adapt` may shorten a part, as the ends of corners are whole nanometres.
const PART_ROUNDING_NM: i64 = 10;
/// Shortest move of a program that is compared, mm: more than a millisecond at twice the highest feed.
const LEAST_MM: f64 = 0.1;
/// Shortest part of a divided line, mm: the default of `piece_length`.
const PIECE_MM: f64 = 2.0;

/// Job of an end mill of 10 mm that may feed outside arcs faster, for the program `p.nc`. Under the contour law lines keep
/// their F; `lines` is that law with a wanted feed per tooth, on lines too.
fn job(scratch: &Scratch, law: &str, mode: &str) -> JobFile {
    job_of_mill(scratch, law, mode, 10.0)
}

/// The same for an end mill of another diameter, whose radius D1 has.
fn job_of_mill(scratch: &Scratch, law: &str, mode: &str, diameter: f64) -> JobFile {
    let radius = diameter / 2.0;
    scratch.write("machine.toml", format!("unit = 'mm'\n[radius]\n1 = {radius:?}\n"));
    let (law, has_lines) = if law == "lines" { ("contour", true) } else { (law, false) };
    let target = if mode == "rewrite-only" && law == "contour" && !has_lines { "'programmed'" } else { "0.05" };
    let lines = if has_lines { "[[cut]]\nmoves = 'lines'\nside = 'inside'\n" } else { "" };
    let inside_only = if law == "contour" { "inside_only = false\n" } else { "" };
    let depth = if law == "contour" { "" } else { "radial_depth = 1.0\n" };
    let cut = |direction: &str, side: &str| {
        format!("[[cut]]\nmoves = 'arcs'\ndirection = '{direction}'\nside = '{side}'\n{depth}")
    };
    let text = format!(
        "units = 'mm'\nprogram = 'p.nc'\n[tool]\nkind = 'end-mill'\ndiameter = {diameter:?}\nteeth = 2\n[spindle]\nrev_per_min = 5000\n\
         [law]\nkind = '{law}'\nfeed_per_tooth = {target}\n{inside_only}[limits]\nmax_feed = 5000\n[override]\nmode = '{mode}'\n\
         [control]\npreset = 'fanuc-16i'\nsettings = 'machine.toml'\n{}{}{lines}",
        cut("ccw", "inside"),
        cut("cw", "outside")
    );
    JobFile::load(scratch.write("job.toml", text).as_ref()).expect("a job")
}

fn adapted(file: &JobFile, text: &str) -> (Program, Adapted) {
    let program = Program::parse_with(&file.program, text.as_bytes(), file.nc, file.tables);
    assert!(!program.has_errors(), "{:?}\n{text}", program.diagnostics);
    let adapted = adapt_with(&program, &file.job, Known::of(file));
    (program, adapted)
}

fn text_of(adapted: &Adapted) -> String {
    String::from_utf8_lossy(&adapted.text).into_owned()
}

/// Cutting moves that the simulated control executes; `None` if it stops at an alarm, or if a move of the original takes less
/// than a millisecond. With `planned` the largest measured
/// feed at the contour over its target comes with them, and the number of samples.
fn executed(file: &JobFile, text: &[u8], planned: Option<&(Program, Adapted)>) -> Option<(Vec<Segment>, f64, u64)> {
    let settings = control_settings(file);
    let mut simulation = Simulation::from_memory(settings, text, &file.job, ControllerFault::None).expect("a run");
    if let Some((program, adapted)) = planned {
        simulation.set_planned_conditions(foreseen(program, adapted, file));
    }
    let (mut moves, mut begun, mut seen) = (Vec::new(), 0, 0);
    while !simulation.is_done() {
        simulation.step();
        let control = simulation.control();
        if let Some((_, segment)) = control.active().filter(|_| control.moves_begun() != begun) {
            seen += 1;
            moves.extend((segment.path != Path::Rapid).then_some(*segment));
        }
        begun = control.moves_begun();
    }
    if planned.is_none() && seen != simulation.control().moves_begun() {
        return None;
    }
    let chips = simulation.meter().moves();
    let samples = chips.iter().map(|chips| chips.any_contact.samples).sum();
    let most = chips.iter().filter(|chips| chips.any_contact.samples > 0).map(|chips| chips.any_contact.max_ratio);
    simulation.control().alarm().is_none().then(|| (moves, most.fold(0.0, f64::max), samples))
}

fn feed(segment: &Segment) -> Nm {
    let Feed::PerMinute(feed) = segment.feed else { panic!("no feed: {segment:?}") };
    feed
}

/// Cutting moves as a program without corners.
fn written_by_hand(moves: &[Segment]) -> String {
    let point = |segment: &Segment| [segment.start.linear[0], segment.start.linear[1]].map(Nm::to_mm);
    let [x, y] = point(&moves[0]);
    let mut text = format!("%\nO1\nG21G17G90G94\nS5000M3\nG0X{x:.6}Y{y:.6}Z0\n");
    for segment in moves {
        let [x, y, _] = segment.end.linear.map(Nm::to_mm);
        let feed = feed(segment).to_mm();
        text += &match &segment.path {
            Path::Arc(arc) => {
                let code = if arc.turn == Turn::Ccw { "G3" } else { "G2" };
                let start = point(segment);
                let [i, j] = [0, 1].map(|axis| arc.center[axis].to_mm() - start[axis]);
                format!("{code}X{x:.6}Y{y:.6}I{i:.6}J{j:.6}F{feed:.1}\n")
            }
            _ => format!("G1X{x:.6}Y{y:.6}F{feed:.1}\n"),
        };
    }
    text + "M30\n%\n"
}

/// A path of lines and arcs in the plane, most of them with a corner at their end.
fn random_program(rng: &mut Rng) -> String {
    let is_absolute = rng.bool();
    let mode = if is_absolute { "G90" } else { "G91" };
    let mut text = format!("%\nO1\nG21G17G90G94\nS5000M3\nG0X0Y0Z0\n{mode}\n");
    let (mut at, mut angle) = ([0_i64; 2], 0.0_f64);
    let count = rng.usize(4..11);
    for index in 0..count {
        let turned = (0.3 + 2.2 * rng.f64()) * if rng.bool() { 1.0 } else { -1.0 };
        let is_straight = rng.u8(0..10) < 7;
        angle = match rng.u8(0..3) {
            0 => {
                (angle / core::f64::consts::FRAC_PI_2).round() * core::f64::consts::FRAC_PI_2
                    + core::f64::consts::FRAC_PI_2
            }
            _ => angle + turned,
        };
        let length = 6.0 + 30.0 * rng.f64();
        let step = [libm::cos(angle), libm::sin(angle)].map(|part| (1e3 * length * part).round() as i64);
        let end = [at[0] + step[0], at[1] + step[1]];
        let word = |letter: char, value: i64| format!("{letter}{:.3}", value as f64 / 1e3);
        let coordinate = |axis: usize| if is_absolute { end[axis] } else { step[axis] };
        let is_given = |axis: usize| !is_straight || step[axis] != 0;
        let axes: String = [('X', 0), ('Y', 1)]
            .iter()
            .filter(|(_, axis)| is_given(*axis))
            .map(|(name, axis)| word(*name, coordinate(*axis)))
            .collect();
        let (code, center) = if is_straight {
            ("G1", String::new())
        } else {
            let radius = (1e3 * length * (0.55 + rng.f64())).round() as i64;
            (if rng.bool() { "G2" } else { "G3" }, word('R', radius))
        };
        let corner = match rng.u8(0..10) {
            _ if index + 1 == count => String::new(),
            0..=5 => format!(",R{:.2}", 0.5 + 6.0 * rng.f64() * rng.f64()),
            6..=7 => format!(",C{:.2}", 0.5 + 2.0 * rng.f64()),
            _ => String::new(),
        };
        let first = if index == 0 || rng.u8(0..3) == 0 { format!("F{}.", rng.u16(200..2500)) } else { String::new() };
        let other = if rng.u8(0..8) == 0 { "M8" } else { "" };
        text += &format!("{code}{axes}{center}{first}{corner}{other}\n");
        at = end;
    }
    text + "G90\nM30\n%\n"
}

#[derive(Debug, Default)]
struct Figures {
    programs: usize,
    moves: usize,
    corners: usize,
    slowed: usize,
    raised: usize,
    divided: usize,
    whole: usize,
    samples: u64,
    most_of_target: f64,
    end_max_nm: i64,
}

/// Compares the moves of an adapted program with those of the same path written by hand.
fn compare(original: &[Segment], adapted: &[Segment], by_hand: &[Segment], figures: &mut Figures, text: &str) {
    let mut sent = adapted.iter().peekable();
    for (own, hand) in original.iter().zip(by_hand) {
        let mut parts = vec![*sent.next().unwrap_or_else(|| panic!("a move is missing\n{text}"))];
        let apart = |part: &Segment, axis: usize| (part.end.linear[axis].0 - own.end.linear[axis].0).abs();
        let apart_nm = |part: &Segment| apart(part, 0).max(apart(part, 1));
        while apart_nm(&parts[parts.len() - 1]) > SAME_POINT_NM {
            parts.push(*sent.next().unwrap_or_else(|| panic!("{own:?} is not finished\n{text}")));
        }
        figures.end_max_nm = figures.end_max_nm.max(apart_nm(&parts[parts.len() - 1]));
        let length_mm: f64 = parts.iter().map(Segment::length_mm).sum();
        assert!((length_mm - own.length_mm()).abs() < 1e-4, "{own:?}: {parts:?}\n{text}");
        for part in &parts {
            assert!(
                feed(part) <= feed(hand),
                "{:?} above {:?} of the same path by hand: {part:?}\n{text}",
                feed(part),
                feed(hand)
            );
            figures.slowed += usize::from(feed(part) < feed(own));
            figures.raised += usize::from(feed(part) > feed(own));
        }
        if let [first, rest] = parts.as_slice() {
            let least_mm = PIECE_MM - Nm(PART_ROUNDING_NM + END_MAX_NM).to_mm();
            assert!(rest.length_mm() >= least_mm && first.length_mm() >= least_mm, "{parts:?}\n{text}");
            assert_eq!((feed(first), own.path), (feed(hand), Path::Line), "{text}");
            figures.divided += 1;
        }
        figures.moves += 1;
    }
    assert_eq!(sent.next(), None, "{text}");
}

/// Whether the corner of a block has the least feed that its moves have by hand.
fn check_least(program: &(Program, Adapted), by_hand: &[Segment], original: &[Segment], figures: &mut Figures) {
    for block in &program.1.blocks {
        let Some(inserted) = &block.inserted else { continue };
        let find = |wanted: &Segment| {
            let same = |segment: &&Segment| (segment.start, segment.end) == (wanted.start, wanted.end);
            original.iter().position(|segment| same(&segment)).map(|at| feed(&by_hand[at]))
        };
        // Moves around a corner of a contour have the feed of the block behind them, and outside arcs behind them that of a line.
        if [block, inserted].iter().any(|of| of.contour.is_some_and(|place| place.has_corner)) {
            continue;
        }
        // A rounding of the tool's radius is a point of the tool centre.
        let [Some(own), Some(behind)] = [&block.segment, &inserted.segment].map(find) else { continue };
        assert_eq!(inserted.sent, Some(own.min(behind)), "{block:?}\n{}", text_of(&program.1));
        figures.corners += 1;
        figures.whole += usize::from(block.whole.is_some());
    }
}

/// Judges an adapted program against its path written by hand; skips programs at which the control stops.
fn judge(law: &str, file: &JobFile, text: &str, figures: &mut Figures) {
    if Program::parse_with(&file.program, text.as_bytes(), file.nc, file.tables).has_errors() {
        return;
    }
    let Some((original, ..)) = executed(file, text.as_bytes(), None) else { return };
    // A control takes eight digits, and each move must take a millisecond also where it is faster.
    let is_far = |segment: &Segment| segment.end.linear.iter().any(|nm| nm.0.abs() >= 100_000_000);
    if original.iter().any(|segment| is_far(segment) || segment.length_mm() < LEAST_MM) {
        return;
    }
    let hand = written_by_hand(&original);
    let by_hand = adapted(file, &hand);
    let (hand_moves, hand_most, _) = executed(file, &by_hand.1.text, Some(&by_hand)).expect("the path by hand runs");
    assert_eq!(hand_moves.len(), original.len(), "{text}\n{hand}");
    let planned = adapted(file, text);
    let sent = text_of(&planned.1);
    let (moves, most_of_target, samples) =
        executed(file, &planned.1.text, Some(&planned)).unwrap_or_else(|| panic!("an alarm\n{text}\n{sent}"));
    compare(&original, &moves, &hand_moves, figures, &format!("{text}\n{sent}"));
    check_least(&planned, &hand_moves, &original, figures);
    assert!(most_of_target <= 1.005 * hand_most.max(1.0), "{most_of_target} by hand {hand_most}\n{text}\n{sent}");
    // At its floor the contour law leaves the feed at the contour above the target.
    let is_at_floor = planned.1.blocks.iter().flat_map(|block| [Some(block), block.inserted.as_deref()]).flatten();
    let mut is_at_floor = is_at_floor.filter(|block| matches!(block.reason, PlanReason::LawFloor | PlanReason::Short));
    if law != "engagement" && is_at_floor.next().is_none() {
        figures.most_of_target = figures.most_of_target.max(most_of_target);
        figures.samples += samples;
    }
    figures.programs += 1;
}

#[test]
fn no_move_beside_a_corner_is_faster_than_the_same_move_written_by_hand() {
    let scratch = Scratch::new("corners");
    let mut figures = Figures::default();
    for seed in 0..of_full_set(2_000, 300) {
        let law = ["contour", "lines", "engagement"][seed as usize % 3];
        let file = job(&scratch, law, "rewrite-only");
        judge(law, &file, &random_program(&mut Rng::with_seed(seed)), &mut figures);
    }
    println!("{figures:?}");
    assert!(figures.programs > 100 && figures.corners > 500 && figures.slowed > 300, "{figures:?}");
    assert!(figures.divided > 50 && figures.raised > 20 && figures.whole > 50, "{figures:?}");
    assert!(figures.most_of_target <= 1.005 && figures.end_max_nm <= END_MAX_NM, "{figures:?}");
}

/// The path as a contour that a tool of D1 follows on its left side. No law governs the way there: it is slow, so a start near by.
fn contour_of(text: &str) -> String {
    let text = text.replacen("G0X0Y0Z0\n", "G0X-3.Y-3.Z0\nG90G41D1G1X0Y0F100.\n", 1);
    text.replacen("G90\nM30", "G90\nG40G0X900.Y900.\nM30", 1)
}

#[test]
fn no_move_beside_a_corner_of_a_compensated_contour_is_faster_than_its_path_written_by_hand() {
    let scratch = Scratch::new("corners-contour");
    let mut figures = Figures::default();
    for seed in 0..of_full_set(6_000, 900) {
        // Under the engagement law a block behind moves around a corner keeps its feed.
        let law = ["contour", "lines"][seed as usize % 2];
        let file = job_of_mill(&scratch, law, "rewrite-only", 2.0);
        judge(law, &file, &contour_of(&random_program(&mut Rng::with_seed(seed))), &mut figures);
    }
    println!("{figures:?}");
    assert!(figures.programs > 60 && figures.corners > 100 && figures.slowed > 100, "{figures:?}");
    assert!(figures.divided > 20 && figures.end_max_nm <= END_MAX_NM, "{figures:?}");
}

#[test]
fn a_line_of_a_contour_keeps_its_feed_up_to_a_point_before_its_corner() {
    let scratch = Scratch::new("corners-contour-pocket");
    let text =
        "G90G94G21G17\nS5000M3\nG0X-20.Y-20.\nG41D1G1X0Y0F1000.\nX50.,R8.\nY40.,C4.\nX20.,R10.\nG1Y10.\nG40G0X0\nM30\n";
    // Tool of radius 5 inside: centre radii 3 and 5 on arcs of 8 and 10, so 3/8 and 5/10. The line along Y ends in a chamfer,
    // a line too. Divided 2 mm before the corner: the rounding takes 8 of X50., so at X40.; 10 of X20., so at X32.
    let wanted = "G90G94G21G17\nS5000M3\nG0X-20.Y-20.\nG41D1G1X0Y0F1000.\nX40.\nX50.,R8.F375.\nY40.,C4.F1000.\nX32.\nX20.,R10.F500.\nG1Y10.F1000.\nG40G0X0\nM30\n";
    let file = job(&scratch, "contour", "rewrite-only");
    assert_eq!(text_of(&adapted(&file, text).1), wanted);
    for mode in ["safe-base", "override-only"] {
        assert_eq!(text_of(&adapted(&job(&scratch, "contour", mode), text).1), text);
    }
}

#[test]
fn a_line_keeps_its_feed_up_to_a_point_before_its_corner() {
    let scratch = Scratch::new("corners-pocket");
    let text = "G90G94G21G17\nS5000M3\nG0X0Y0\nG1X50.F1000.,R3.\nY40.,R8.\nX20.,C4.\nG91X-40.Y-30.,R3.\nY-10.5,R2.M8\nX40.\nG90\nM30\n";
    // A radius of the tool of 5 inside: 3/8, 8/13 and 2/7. The shortest piece is 2 mm. X-40. Y-30. has points at
    // each 4 and 3 um; its corner takes 3 mm times the tangent of half the angle to Y-10.5 (53.13 degrees): 1.5 mm.
    let wanted = "G90G94G21G17\nS5000M3\nG0X0Y0\nG1X45.F1000.\nX50.,R3.F375.\nY30.F1000.\nY40.,R8.F615.3\nX20.,C4.F1000.\n\
                  G91X-37.2Y-27.9\nX-2.8Y-2.1,R3.F375.\nY-10.5,R2.M8F285.7\nX40.F1000.\nG90\nM30\n";
    let file = job(&scratch, "contour", "rewrite-only");
    assert_eq!(text_of(&adapted(&file, text).1), wanted);
    // With an override the blocks keep their feeds.
    for mode in ["safe-base", "override-only"] {
        assert_eq!(text_of(&adapted(&job(&scratch, "contour", mode), text).1), text);
    }
}

#[test]
fn beside_a_block_that_a_switch_may_skip_a_corner_keeps_its_feed() {
    let scratch = Scratch::new("corners-switch");
    let file = job(&scratch, "contour", "rewrite-only");
    let corner = "G90G94G21G17\nS5000M3\nG0X0Y0\nG1X50.F1000.,R3.\nY40.\nX0\nM30\n";
    assert!(text_of(&adapted(&file, corner).1).contains("X50.,R3.F375."));
    for (from, to) in [("Y40.", "/Y40."), ("G1X50.", "/G1X50."), ("G0X0Y0", "/G0X0Y0"), ("G94G21", "G95G21")] {
        let text = corner.replace(from, to).replace("F1000.", if to == "G95G21" { "F.2" } else { "F1000." });
        assert_eq!(text_of(&adapted(&file, &text).1), text, "{to}");
    }
}
