//! Moves of a program as LinuxCNC's `rs274` reads it.

use std::process::Command;

use arcfeed_tests::Scratch;
use arcfeed_units::MM_PER_INCH;

use super::moves::Move;

/// Tools in rs274's table, without length.
const TOOLS: u32 = 99;

/// Moves of a program as rs274 reads it, with tools of this radius.
pub fn theirs(rs274: &str, text: &[u8], radius_mm: f64) -> Result<Vec<Move>, String> {
    let scratch = Scratch::new("rs274");
    scratch.write("p.ngc", text);
    let tools: String =
        (1..=TOOLS).map(|tool| format!("T{tool} P{tool} D{}\n", 2.0 * radius_mm / MM_PER_INCH)).collect();
    scratch.write("t.tbl", tools);
    scratch.write("v.var", "");
    let folder = scratch.path("");
    let arguments = ["20", rs274, "-t", "t.tbl", "-v", "v.var", "-g", "p.ngc"];
    // rs274 keeps its tool table in the user's home, where programs running at the same time share it.
    let mut command = Command::new("timeout");
    let output = command.args(arguments).current_dir(&folder).env("HOME", &folder).output().expect("rs274 runs");
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
            // To the bottom with the spindle, and back.
            "RIGID_TAP" => {
                let above = moves.last().map_or([0.0; 3], |step: &Move| step.end_mm);
                let bottom = std::array::from_fn(|axis| numbers[axis] * scale + shift[axis]);
                moves.extend([bottom, above].map(|end_mm| Move { kind: 1, end_mm, center_mm: [0.0; 2] }));
            }
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
