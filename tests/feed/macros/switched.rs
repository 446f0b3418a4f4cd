//! Blocks with a `/` in programs with macro statements: the feeds are right with the switch on and off.

use std::path::Path;

use arcfeed::job::JobFile;
use arcfeed::program::{Expansion, MoveTrace, Program, RunBounds};
use arcfeed_nc::modal::{Feed, Turn};
use arcfeed_nc::settings::Settings;
use arcfeed_nc_macro::variables::OutsideValues;
use arcfeed_tests::Scratch;
use fastrand::Rng;

use super::{Case, JOB};

/// Radius of the arcs and of the tool, mm.
const RADII_MM: [f64; 2] = [8.0, 5.0];

fn program(seed: u64) -> String {
    let mut rng = Rng::with_seed(seed);
    let mut text = "%\nG21G17G90G94\nT1M6\nS8000M3\nG0X0Y0Z5.\nG1Z0F300.\n#2=0\nWHILE[#2LT3]DO1\n".to_owned();
    for _ in 0..rng.usize(3..9) {
        let feed = 100 * rng.u32(2..9);
        text += &match rng.u32(0..8) {
            0 => "/M8\n".to_owned(),
            1 => format!("/F{feed}.\n"),
            2 => format!("/G1X{}.\n", rng.u32(1..40)),
            3 => format!("/2G3I-8.F{feed}.\n"),
            4 => format!("G1Y[{}.+#2]\n", rng.u32(1..40)),
            5 => format!("G1X{}.Y0F{feed}.\n", rng.u32(1..40)),
            6 => "G3I-8.\n".to_owned(),
            _ => format!("G3I-8.F{feed}.\n"),
        };
    }
    text + "#2=#2+1\nEND1\nM30\n%\n"
}

/// Moves of a program in a control's memory with these switches on.
fn moves(text: &str, file: &JobFile, delete_switches: u16) -> Vec<MoveTrace> {
    let (settings, outside) = (Settings { delete_switches, ..file.nc }, OutsideValues::Assumed);
    let (tables, bounds) = (file.tables, RunBounds::default());
    let expansion = Expansion { settings, tables, library: None, keeps_moves: true, bounds, outside };
    Program::run(Path::new("p.nc"), text.as_bytes(), expansion).executed_moves()
}

fn feed_mm(moved: &MoveTrace) -> Option<f64> {
    if let Feed::PerMinute(feed) = moved.segment.feed { Some(feed.to_mm()) } else { None }
}

#[test]
fn feeds_are_right_with_the_switches_on_and_off() {
    let job = JOB.replace("inside_only = false\nfeed_per_tooth = 0.05\n", "feed_per_tooth = \"programmed\"\n");
    let job = format!("{job}[override]\nmode = \"rewrite-only\"\n");
    let (mut written, mut slowed, mut kept) = (0, 0, 0);
    for seed in 0..300 {
        let text = program(seed);
        let case = Case::new(&Scratch::new("macros-switched"), &text, &[], &job)
            .unwrap_or_else(|error| panic!("{error}\n{text}"));
        let Ok(back) = &case.written else { continue };
        written += 1;
        for switches in [0, 0b10, 0b100, 0b110] {
            let [before, after] = [&text, back].map(|text| moves(text, &case.file, switches));
            assert_eq!(before.len(), after.len(), "seed {seed}");
            for (before, after) in before.iter().zip(&after) {
                assert_eq!((before.segment.start, before.segment.end), (after.segment.start, after.segment.end));
                let (Some(programmed), Some(sent)) = (feed_mm(before), feed_mm(after)) else { continue };
                let [path, tool] = RADII_MM;
                let at_contour = programmed * path / (path + tool);
                let is_inside = before.segment.arc().is_some_and(|arc| arc.turn == Turn::Ccw);
                let is_slowed = is_inside && sent <= at_contour && sent > at_contour - 0.11;
                slowed += u32::from(is_slowed);
                kept += u32::from(is_inside && !is_slowed);
                assert!(
                    is_slowed || sent == programmed,
                    "seed {seed}, {switches:b}: {sent} for {programmed}\n{text}\n{back}"
                );
            }
        }
    }
    println!("{written} of 300 programs written back; {slowed} arcs slowed, {kept} kept their F");
    assert!(written > 50 && slowed > 200, "{written} {slowed}");
}
