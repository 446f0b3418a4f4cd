//! Feeds of contours against those of the same path written by hand, and contours that keep their feeds.

use std::collections::HashMap;

use arcfeed::adapt::PlanReason;
use arcfeed_compensation::compensator::CenterMove;
use arcfeed_nc::modal::Turn;
use arcfeed_nc::segment::Path;
use arcfeed_nc::settings::StartUp;
use arcfeed_tests::{Scratch, of_full_set};
use arcfeed_units::Nm;

use super::compensated_path::compensated;
use super::contours::ContourProgram;
use super::{Case, FEED, point};

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
