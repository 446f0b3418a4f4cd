//! Holds our reading of programs against LinuxCNC's `rs274`: `compare-rs274 RS274 FOLDER_OR_FILE`. With `contours COUNT
//! FOLDER` it writes contours with cutter compensation, and what rs274 makes of them, as a case.
//!
//! Both read the same text: capitals, without comments and blanks. Moves of no length are left out on both sides, lengths
//! compared in mm on the path (what rs274 prints is relative to the offsets it announces, which are added), to four
//! decimals of the unit it prints. One line a program: what both read, or who refuses it and why.

use std::path::{Path, PathBuf};

use arcfeed_nc::settings::{Decimals, StartUp};
use arcfeed_nc::text::Lines;
use arcfeed_units::LengthUnit;

use canonical::theirs;
use contours::ContourProgram;
use moves::{Move, moving, off_mm, ours};

mod compensated;

mod contours;

mod moves;

mod canonical;

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
        let (theirs, ours) = (theirs(rs274, &text, 0.0), ours(&text, Decimals::Calculator, LengthUnit::Mm));
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
