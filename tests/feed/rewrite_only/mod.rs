//! `rewrite-only`: arcs in pieces with F words, no override.
//!
//! Random arcs in every spelling a program may have, under tables of feeds, so that what is wanted where is worked out
//! here: chips by brute force, the path by the simulated control that executes the program before and after.

mod laws;

mod measured;

mod path;

mod spelled;

use std::f64::consts::TAU;

use arcfeed::adapt::{Adapted, PlannedBlock, adapt};
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_model::job::{FeedPolicy, PieceSettings};
use arcfeed_nc::block::Reading;
use arcfeed_nc::modal::{Feed, Turn};
use arcfeed_nc::segment::{Arc, Segment};
use arcfeed_tests::{Scratch, root};
use arcfeed_units::{LengthUnit, Nm};
use fastrand::Rng;
use spelled::{Spelled, spelled};

/// Programs; each has a dozen arcs.
const PROGRAMS: u64 = 64;
/// Points on each arc at which the demand is worked out.
const POINTS: usize = 10_000;
/// Largest error of the law's demand in single precision.
const SINGLE: f64 = 1e-6;
/// rev/min times teeth.
const TEETH_PER_MIN: f64 = 10_000.0 * 4.0;

/// Feeds per tooth over the path, mm, of each sense.
type Tables = [Vec<[f64; 2]>; 2];

struct Case {
    spelled: Spelled,
    tables: Tables,
    file: JobFile,
    program: Program,
    adapted: Adapted,
}

fn random_table(rng: &mut Rng) -> Vec<[f64; 2]> {
    let mut path = 0.0;
    (0..rng.usize(1..24))
        .map(|_| {
            path += 0.5 + 15.0 * rng.f64();
            [path, 0.05 + 0.1 * rng.f64()]
        })
        .collect()
}

fn job(unit: LengthUnit, tables: &Tables, settings: &str) -> String {
    let rows = |table: &[[f64; 2]]| -> String {
        table.iter().map(|[path, feed]| format!("[\"{path} mm\", \"{feed} mm\"], ")).collect()
    };
    let name = if unit == LengthUnit::Inch { "inch" } else { "mm" };
    let rule = |direction: &str, table: &[[f64; 2]]| {
        format!("[[cut]]\nmoves = \"arcs\"\ndirection = \"{direction}\"\nside = \"slot\"\ntable = [{}]\n", rows(table))
    };
    format!(
        "units = \"{name}\"\nprogram = \"p.nc\"\n[tool]\nkind = \"end-mill\"\ndiameter = \"10 mm\"\nteeth = 4\n[spindle]\n\
         rev_per_min = 10000\nset_by = \"operator\"\n[limits]\nmax_feed = \"90000 mm\"\nmax_raise = 100\n[law]\nkind = \"table\"\nfeed_per_tooth = \"0.1 mm\"\n[override]\nmode = \"rewrite-only\"\n{settings}\n{}{}",
        rule("cw", &tables[0]),
        rule("ccw", &tables[1])
    )
}

fn case(seed: u64) -> Case {
    let mut rng = Rng::with_seed(seed);
    let spelled = spelled(&mut rng);
    let tables = [random_table(&mut rng), random_table(&mut rng)];
    let settings =
        ["", "piece_step = 4\npiece_hysteresis = 0", "piece_length = \"1 mm\"\npiece_step = 0.5\npieces_max = 200"];
    let text = job(spelled.unit, &tables, settings[rng.usize(0..settings.len())]);
    let file = JobFile::parse("p.toml".as_ref(), &text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let program = Program::parse("p.nc".as_ref(), spelled.text.as_bytes(), file.job.unit, Reading::Lenient);
    assert!(!program.has_errors(), "{:?}\n{}", program.diagnostics, spelled.text);
    let adapted = adapt(&program, &file.job);
    Case { spelled, tables, file, program, adapted }
}

/// Linear between the knots, held beyond the ends.
fn demanded(table: &[[f64; 2]], path: f64) -> f64 {
    let after = table.iter().position(|[at, _]| *at >= path);
    match after {
        Some(0) => table[0][1],
        None => table[table.len() - 1][1],
        Some(after) => {
            let ([at, feed], [to, next]) = (table[after - 1], table[after]);
            feed + (next - feed) * (path - at) / (to - at)
        }
    }
}

fn arcs(adapted: &Adapted) -> impl Iterator<Item = (&PlannedBlock, &Arc)> {
    adapted.blocks.iter().filter_map(|block| Some((block, block.segment.arc()?)))
}

/// Path along an arc to a point on it, mm.
fn travelled(arc: &Arc, point: &[Nm; 3]) -> f64 {
    let (first, second, _) = arc.plane.axes();
    let angle = |[x, y]: [Nm; 2]| libm::atan2(y.to_mm(), x.to_mm());
    let to = [(first, 0), (second, 1)].map(|(axis, center)| Nm(point[axis].0 - arc.center[center].0));
    arc.radius_mm() * (f64::from(arc.turn.sign()) * (angle(to) - angle(arc.from))).rem_euclid(TAU)
}

/// The moves of a text, as the control reads them.
fn moves(text: &[u8], unit: LengthUnit) -> Vec<Segment> {
    let program = Program::parse("out.nc".as_ref(), text, unit, Reading::Lenient);
    assert!(!program.has_errors(), "{:?}\n{}", program.diagnostics, String::from_utf8_lossy(text));
    program.lines().filter_map(|line| line.meaning?.segment).collect()
}

/// The text as sent, program line by program line.
fn lines_sent(adapted: &Adapted) -> Vec<&str> {
    let mut start = 0;
    let line = |end: &usize| {
        let text = &adapted.text[start..*end];
        start = *end;
        std::str::from_utf8(text).expect("ASCII")
    };
    adapted.line_ends.iter().map(line).collect()
}

fn feed_mm(segment: &Segment) -> f64 {
    match segment.feed {
        Feed::PerMinute(feed) => feed.to_mm(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn pieces_never_exceed_the_demand_and_the_reported_chip_error_is_right() {
    let (mut pieces, mut whole, mut worst, mut slowest) = (0, 0, f64::NEG_INFINITY, 0.0_f64);
    for seed in 0..PROGRAMS {
        let Case { tables, file, adapted, .. } = case(seed);
        let mut sent = moves(&adapted.text, file.job.unit).into_iter().peekable();
        for block in &adapted.blocks {
            // A move that no law governs is sent unchanged.
            let Some(arc) = block.segment.arc().filter(|_| !block.pieces.is_empty()) else {
                assert_eq!(sent.next().map(|sent| sent.end), Some(block.segment.end), "seed {seed}");
                continue;
            };
            let table = &tables[usize::from(arc.turn == Turn::Ccw)];
            let (mut from, mut errors) = (0.0, Vec::new());
            for index in 0..block.pieces.len() {
                let piece = sent.next().expect("a piece");
                let last = index + 1 == block.pieces.len();
                let until = if last { arc.length_mm() } else { travelled(arc, &piece.end.linear) };
                let share = POINTS.div_ceil(block.pieces.len());
                for point in 0..=share {
                    let path = from + (until - from) * point as f64 / share as f64;
                    errors.push(feed_mm(&piece) / (TEETH_PER_MIN * demanded(table, path)) - 1.0);
                }
                from = until;
            }
            let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
            let most = errors.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert!(most <= SINGLE, "seed {seed}, line {}: {most} too thick", block.line);
            let said = block.chip_error.expect("governed");
            let is_inside = least >= said.min - SINGLE && most <= said.max + SINGLE;
            assert!(
                is_inside && least < said.min + 5e-3 && most > said.max - 5e-3,
                "seed {seed}, {said:?}: {least} {most}"
            );
            assert!(said.min <= said.mean && said.mean <= said.max && said.max <= SINGLE, "{said:?}");
            pieces += block.pieces.len();
            whole += usize::from(block.whole.is_some());
            (worst, slowest) = (worst.max(most), slowest.min(least));
        }
        assert_eq!(sent.next(), None);
    }
    println!("{pieces} pieces, {whole} arcs left whole, chips {:+.4} .. {:+.4} %", 1e2 * slowest, 1e2 * worst);
    assert!(pieces > 3_000 && whole < 20);
}

#[test]
fn every_byte_outside_the_arcs_in_pieces_stays_and_pieces_keep_the_programs_style() {
    let without = |line: &str, letters: &str| -> String {
        let (code, comment) = line.split_at(line.find('(').unwrap_or(line.len()));
        let mut kept = true;
        let code = code.chars().filter(|c| {
            if c.is_ascii_alphabetic() {
                kept = !letters.contains(*c);
            }
            kept || !(c.is_ascii_alphanumeric() || "+-.".contains(*c))
        });
        code.collect::<String>() + comment
    };
    let mut in_pieces = 0;
    for seed in 0..PROGRAMS {
        let Case { program, adapted, .. } = case(seed);
        let planned = |line: usize| adapted.blocks.iter().find(|block| block.line == line);
        for ((index, line), sent) in program.lines().enumerate().zip(lines_sent(&adapted)) {
            let old = std::str::from_utf8(&line.text).expect("ASCII");
            let ending = std::str::from_utf8(&line.ending).expect("ASCII");
            let pieces: Vec<&str> = sent.strip_suffix(ending).expect("its line end").split("\r\n").collect();
            let count = planned(index + 1).map_or(1, |block| block.pieces.len().max(1));
            assert_eq!(pieces.len(), count, "{sent}");
            if count == 1 {
                assert_eq!(without(pieces[0], "F"), without(old, "F"));
                continue;
            }
            in_pieces += 1;
            assert_eq!(without(pieces[0], "FXYZR"), without(old, "FXYZR"));
            for piece in &pieces[1..] {
                assert!(!piece.contains('N') && !piece.contains('('), "{piece}");
                assert_eq!(piece.starts_with('/'), old.starts_with('/'), "{piece}");
                assert_eq!(piece.contains('R'), old.contains('R'), "{piece}");
                let points = |text: &str| text.split('(').next().is_some_and(|code| without(code, "FNG").contains('.'));
                assert_eq!(points(piece), points(old), "{piece} for {old}");
            }
            let code = |piece: &&str| piece.split('(').next().map_or(0, |code| code.matches('F').count());
            let words: usize = pieces.iter().map(code).sum();
            assert_eq!(Some(words), planned(index + 1).map(|block| block.f_words), "{sent}");
        }
    }
    println!("{in_pieces} arcs in pieces");
    // One in six has a `/`, and stays whole.
    assert!(in_pieces > 280);
}

#[test]
fn pieces_keep_their_length_and_their_number() {
    let (mut shortest, mut seen) = (f64::INFINITY, 0);
    for seed in 0..PROGRAMS {
        let Case { file, adapted, .. } = case(seed);
        let FeedPolicy::RewriteOnly(settings) = file.job.policy else { panic!("{:?}", file.job.policy) };
        for (block, arc) in arcs(&adapted).filter(|(block, _)| block.pieces.len() > 1) {
            let mut from = 0.0;
            for piece in &block.pieces {
                let length = arc.radius_mm() * arc.sweep_rad().min(TAU) * (piece.until_ratio - from);
                from = piece.until_ratio;
                shortest = shortest.min(length / settings.least_length.to_mm());
            }
            seen += block.pieces.len();
        }
    }
    println!("{seen} pieces, the shortest {shortest:.3} times the least length");
    assert!(seen > 3_000 && shortest >= 1.0);
}

#[test]
fn words_that_pieces_cannot_share_keep_an_arc_whole_at_its_least_feed() {
    let tables: Tables = [vec![[0.0, 0.05]], vec![[0.0, 0.05], [60.0, 0.1]]];
    for (block, why) in [
        ("G3X0Y0I-20.M8", Some("words")),
        ("G3X0Y0I-20.#101=5", Some("words")),
        ("G1X0Y0", None),
        ("G20G3X0Y0I-.787402", Some("digits")),
        ("G3X0Y0I-20.", None),
    ] {
        let scratch = Scratch::new("whole");
        let path = scratch.write("p.toml", job(LengthUnit::Mm, &tables, ""));
        let file = JobFile::load(path.as_ref()).expect("a sound job");
        let text = format!("G21G17G90G94\nG0X40.Y0\n{block}F500.");
        let text = text.replace("#101=5F500.", "F500.#101=5");
        let program = Program::parse("p.nc".as_ref(), text.as_bytes(), LengthUnit::Mm, Reading::Lenient);
        assert!(!program.has_errors(), "{:?}", program.diagnostics);
        let adapted = adapt(&program, &file.job);
        let block_planned = &adapted.blocks[1];
        assert_eq!(block_planned.whole.map(|why| why.label()), why, "{block}");
        let sent = String::from_utf8(adapted.text.clone()).expect("ASCII");
        println!("{}", sent.replace('\n', " | "));
        if why.is_some() {
            assert_eq!(sent.matches('\n').count(), 2, "{sent}");
            assert!(sent.contains("F"), "{sent}");
        }
    }
}

#[test]
fn the_documented_defaults_are_those_in_force() {
    let document = std::fs::read_to_string(root().join("docs/rewrite-only.md")).expect("it is there");
    let PieceSettings { step_percent, hysteresis_percent, least_length, most } = PieceSettings::default();
    for (name, value) in [
        ("piece_step", format!("{step_percent} %")),
        ("piece_hysteresis", format!("{hysteresis_percent} %")),
        ("piece_length", format!("{} mm", least_length.to_mm())),
        ("pieces_max", most.to_string()),
    ] {
        assert!(document.contains(&format!("| `{name}` | {value} |")), "{name}: {value}");
    }
}
