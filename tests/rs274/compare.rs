//! Holds our reading of programs against LinuxCNC's `rs274`: `compare-rs274 RS274 FOLDER_OR_FILE`. With `contours COUNT
//! FOLDER` it writes contours with cutter compensation, and what rs274 makes of them, as a case.
//!
//! Both read the same text: capitals, without comments and blanks. Moves of no length are left out on both sides, lengths
//! compared in mm on the path (what rs274 prints is relative to the offsets it announces, which are added), to four
//! decimals of the unit it prints. One line a program: what both read, or who refuses it and why.

use std::path::{Path, PathBuf};
use std::process::Command;

use arcfeed_nc::settings::StartUp;
use arcfeed_nc::text::Lines;
use arcfeed_units::MM_PER_INCH;

use contours::ContourProgram;
use moves::{Move, moving, off_mm, ours};

mod compensated;

mod contours;

mod moves;

/// Tools in rs274's table, without length.
const TOOLS: u32 = 99;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (rs274, target) = match arguments.as_slice() {
        [rs274, target] => (rs274, target),
        [rs274, program, moves] if moves == "moves" => return print_moves(rs274, program),
        [rs274, what, count, folder] if what == "contours" => {
            return write_contours(rs274, count.parse().expect("a count"), Path::new(folder));
        }
        _ => {
            eprintln!("compare-rs274 RS274 FOLDER_OR_FILE, compare-rs274 RS274 PROGRAM moves, or");
            eprintln!("compare-rs274 RS274 contours COUNT FOLDER");
            std::process::exit(2);
        }
    };
    let target = Path::new(target);
    let mut totals = [0_usize; 4];
    for file in programs(target) {
        let text = normalised(&std::fs::read(&file).expect("a program"));
        let (theirs, ours) = (theirs(rs274, &text, 0.0), ours(&text));
        let name = file.strip_prefix(target).ok().filter(|name| !name.as_os_str().is_empty()).unwrap_or(&file);
        let (class, verdict) = verdict(&theirs, &ours);
        totals[class] += 1;
        println!("{} | {verdict}", name.display());
    }
    let [agree, differ, refused_here, refused_there] = totals;
    println!("agree {agree}, differ {differ}, refused by arcfeed {refused_here}, refused by rs274 {refused_there}");
}

/// Prints rs274's moves of one program, one per line: kind, end, centre.
fn print_moves(rs274: &str, program: &str) {
    let text = normalised(&std::fs::read(program).expect("a program"));
    for Move { kind, end_mm: [x, y, z], center_mm: [u, v] } in
        moving(&theirs(rs274, &text, 0.0).expect("it is accepted"))
    {
        println!("{kind} {x:.4} {y:.4} {z:.4} {u:.4} {v:.4}");
    }
}

/// Writes `count` contours that both accept, and rs274's moves; prints how many one of them refuses.
fn write_contours(rs274: &str, count: usize, folder: &Path) {
    let (mut programs, mut expected, mut written) = (String::new(), String::new(), 0);
    let mut refused = [0_usize; 3];
    for seed in 0..4 * count as u64 {
        if written == count {
            break;
        }
        let contour = ContourProgram::of_seed(seed);
        let text = format!("G21G17G90G94\n{}", contour.text);
        let with_tool = format!("{text}M2\n").replacen("G40G0", &format!("T{}M6\nG40G0", contour.d), 1);
        let theirs = theirs(rs274, with_tool.as_bytes(), contour.radius_mm());
        let ours = compensated::compensated(&text, StartUp::A);
        let (Ok(theirs), Ok(_)) = (&theirs, &ours) else {
            refused[usize::from(theirs.is_err()) + 2 * usize::from(ours.is_err()) - 1] += 1;
            match (&theirs, &ours) {
                (Err(reason), Ok(_)) => println!("seed {seed}: rs274 alone refuses: {reason}"),
                (Ok(_), Err(found)) => println!("seed {seed}: arcfeed alone refuses: {found:?}\n{with_tool}"),
                _ => {}
            }
            continue;
        };
        programs += &format!("(SEED {seed})\n{text}");
        expected += &format!("(SEED {seed})\n");
        for Move { kind, end_mm: [x, y, z], center_mm: [u, v] } in theirs {
            expected += &format!("{kind} {x:.4} {y:.4} {z:.4} {u:.4} {v:.4}\n");
        }
        written += 1;
    }
    std::fs::write(folder.join("program.nc"), programs).expect("the folder can be written");
    std::fs::write(folder.join("expected.txt"), expected).expect("the folder can be written");
    let [by_rs274, by_arcfeed, by_both] = refused;
    println!("{written} contours; refused by rs274 alone {by_rs274}, by arcfeed alone {by_arcfeed}, by both {by_both}");
}

fn programs(target: &Path) -> Vec<PathBuf> {
    if target.is_file() {
        return vec![target.to_owned()];
    }
    let entries = std::fs::read_dir(target).expect("a folder").map(|entry| entry.expect("an entry").path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let is_program = |path: &PathBuf| path.extension().is_some_and(|kind| kind == "ngc");
    let nested = folders.iter().flat_map(|folder| programs(folder));
    let mut found: Vec<_> = files.into_iter().filter(is_program).chain(nested).collect();
    found.sort();
    found
}

/// As both read it; a part of another program gets an end.
fn normalised(bytes: &[u8]) -> Vec<u8> {
    let mut text = Vec::new();
    for line in Lines::new(bytes) {
        let mut in_comment = false;
        for byte in line.text.to_ascii_uppercase() {
            match byte {
                b';' if !in_comment => break,
                b'(' => in_comment = true,
                b')' => in_comment = false,
                b' ' | b'\t' => {}
                _ if !in_comment => text.push(byte),
                _ => {}
            }
        }
        text.push(b'\n');
    }
    let last = text.split(|byte| *byte == b'\n').rfind(|line| !line.is_empty()).unwrap_or_default();
    if !matches!(last, b"%" | b"M2" | b"M02" | b"M30") {
        text.extend(b"M2\n");
    }
    text
}

/// Moves of a program as rs274 reads it, with tools of this radius.
fn theirs(rs274: &str, text: &[u8], radius_mm: f64) -> Result<Vec<Move>, String> {
    let folder = std::env::temp_dir().join(format!("rs274-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("p.ngc"), text).expect("a program");
    let tools: String =
        (1..=TOOLS).map(|tool| format!("T{tool} P{tool} D{}\n", 2.0 * radius_mm / MM_PER_INCH)).collect();
    std::fs::write(folder.join("t.tbl"), tools).expect("a table");
    std::fs::write(folder.join("v.var"), "").expect("variables");
    let arguments = ["20", rs274, "-t", "t.tbl", "-v", "v.var", "-g", "p.ngc"];
    let output = Command::new("timeout").args(arguments).current_dir(&folder).output().expect("rs274 runs");
    std::fs::remove_dir_all(&folder).expect("our own folder");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    if !said.contains("PROGRAM_END") {
        let complaint = String::from_utf8_lossy(&output.stderr).into_owned() + "\n" + &said;
        let mut lines = complaint
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty() && *line != "executing" && !line.contains("N....."));
        return Err(lines.next().unwrap_or("no end of program").to_owned());
    }
    Ok(canonical(&said))
}

/// The moves among canonical commands.
fn canonical(said: &str) -> Vec<Move> {
    let (mut scale, mut plane, mut moves) = (1.0, (0, 1, 2), Vec::new());
    let (mut work, mut preset) = ([0.0; 3], [0.0; 3]);
    for line in said.lines() {
        // `   12 N0030  STRAIGHT_FEED(1.0000, ...)`
        let command =
            line.split_whitespace().nth(2).and_then(|word| Some((word.split_once('(')?.0, line.split_once('(')?.1)));
        let Some((name, rest)) = command else { continue };
        let numbers: Vec<f64> =
            rest.trim_end_matches(')').split(',').filter_map(|part| part.trim().parse().ok()).collect();
        let shift: [f64; 3] = std::array::from_fn(|axis| work[axis] + preset[axis]);
        match name {
            "USE_LENGTH_UNITS" => scale = if rest.contains("INCH") { 25.4 } else { 1.0 },
            "SET_G5X_OFFSET" => work = std::array::from_fn(|axis| numbers[axis + 1] * scale),
            "SET_G92_OFFSET" => preset = std::array::from_fn(|axis| numbers[axis] * scale),
            "SELECT_PLANE" => {
                plane = match rest.trim_end_matches(')') {
                    "CANON_PLANE_XZ" | "CANON_PLANE::XZ" => (2, 0, 1),
                    "CANON_PLANE_YZ" | "CANON_PLANE::YZ" => (1, 2, 0),
                    _ => (0, 1, 2),
                }
            }
            "STRAIGHT_TRAVERSE" | "STRAIGHT_FEED" => moves.push(Move {
                kind: i8::from(name == "STRAIGHT_FEED"),
                end_mm: std::array::from_fn(|axis| numbers[axis] * scale + shift[axis]),
                center_mm: [0.0; 2],
            }),
            "ARC_FEED" => {
                let (first, second, normal) = plane;
                let mut end_mm = shift;
                for (axis, value) in [(first, numbers[0]), (second, numbers[1]), (normal, numbers[5])] {
                    end_mm[axis] += value * scale;
                }
                let center_mm = [numbers[2] * scale + shift[first], numbers[3] * scale + shift[second]];
                moves.push(Move { kind: 2 * numbers[4].signum() as i8, end_mm, center_mm });
            }
            _ => {}
        }
    }
    moves
}

fn verdict(theirs: &Result<Vec<Move>, String>, ours: &Result<Vec<Move>, String>) -> (usize, String) {
    let (theirs, ours) = match (theirs, ours) {
        (Ok(theirs), Ok(ours)) => (moving(theirs), moving(ours)),
        (Err(reason), _) => return (3, format!("rs274 refuses: {reason}")),
        (_, Err(reason)) => return (2, format!("arcfeed refuses: {reason}")),
    };
    let arcs = ours.iter().filter(|step| step.kind.abs() == 2).count();
    // Half of the last decimal of an inch, and of ours.
    let limit_mm = 0.000_05 * 25.4 + 1e-6;
    let first = theirs.iter().zip(&ours).position(|(a, b)| a.kind != b.kind || off_mm(a, b) > limit_mm);
    if first.is_none() && theirs.len() == ours.len() {
        let worst = theirs.iter().zip(&ours).map(|(a, b)| off_mm(a, b)).fold(0.0, f64::max);
        return (0, format!("{} moves, {arcs} of them arcs, worst {worst:.6} mm", ours.len()));
    }
    let at = first.unwrap_or(theirs.len().min(ours.len()));
    let (there, here) = (theirs.get(at), ours.get(at));
    (1, format!("move {} of {} (here {}): rs274 {there:?}, arcfeed {here:?}", at + 1, theirs.len(), ours.len()))
}
