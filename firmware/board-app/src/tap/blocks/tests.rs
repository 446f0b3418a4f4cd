use super::*;
use arcfeed_nc::segment::Path;
use arcfeed_nc::settings::{Preset, Reading, Scope};
use arcfeed_units::{LengthUnit, Nm};

fn settings() -> Settings {
    let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
    Settings { scope: Scope::Everything, ..settings }
}

/// Reads lines behind each other; what the last one is, with the program begun at the origin.
fn last(lines: &str) -> Result<(BlockMotion, bool), TapLossReason> {
    let mut blocks = Blocks::new(settings(), true);
    blocks.begin(Some(Pose::ORIGIN));
    lines.lines().map(|line| blocks.read(line.as_bytes())).last().unwrap()
}

fn motion(lines: &str) -> BlockMotion {
    last(lines).unwrap().0
}

fn pose(x: i64, y: i64, z: i64) -> Pose {
    Pose { linear: [x, y, z].map(|mm| Nm(mm * 1_000_000)), ..Pose::ORIGIN }
}

fn along(lines: &str) -> (Pose, Pose, bool) {
    match motion(lines) {
        BlockMotion::Along(segment, may_govern) => (segment.start, segment.end, may_govern),
        other => panic!("{lines}: {other:?}"),
    }
}

#[test]
fn a_plain_move_is_followed_along_its_path() {
    assert_eq!(along("G1X1.F100."), (pose(0, 0, 0), pose(1, 0, 0), true));
    assert_eq!(along("G0X1.Y2.\nG91G1X1.F100."), (pose(1, 2, 0), pose(2, 2, 0), true));
    assert!(matches!(motion("G0X1."), BlockMotion::Along(Segment { path: Path::Rapid, .. }, _)));
    for nothing in ["M8", "G4P100", "G54", "T1M6", "#1=2", "#5204=0", "O1234", "(NOTE)"] {
        assert_eq!(motion(nothing), BlockMotion::Nothing, "{nothing}");
    }
}

#[test]
fn positions_are_seen_from_the_workpiece_whatever_its_offset() {
    assert_eq!(along("G0X1.\nG10L2P2X50.\nG55\nG0X1.\nG1X2.F1."), (pose(1, 0, 0), pose(2, 0, 0), true));
    assert_eq!(along("G0X1.\nG92X10.\nG1X11.F1."), (pose(10, 0, 0), pose(11, 0, 0), true));
}

#[test]
fn behind_a_reference_point_the_axes_are_unknown_until_each_is_given() {
    let home = "G0X1.Y1.Z1.\nG91G28Z0\n";
    assert_eq!(motion(home.trim_end()), BlockMotion::Nothing);
    assert_eq!(motion(&format!("{home}G90G0X5.Y5.")), BlockMotion::Nothing);
    assert_eq!(motion(&format!("{home}G0X5.Z5.")), BlockMotion::Nothing, "still incremental");
    let known = format!("{home}G90G0X5.Y5.\nZ3.");
    assert_eq!(motion(&known), BlockMotion::Passes { via: None, to: pose(5, 5, 3) });
    assert_eq!(along(&format!("{known}\nG1X6.F1.")), (pose(5, 5, 3), pose(6, 5, 3), true));
    assert_eq!(motion("G0Z1.\nG53G0Z0\nG0Z2."), BlockMotion::Passes { via: None, to: pose(0, 0, 2) });
}

#[test]
fn a_program_that_begins_somewhere_is_followed_once_all_axes_are_given() {
    let mut blocks = Blocks::new(settings(), true);
    blocks.begin(None);
    for (line, known) in [("G0X1.Y2.", false), ("G1Z3.F1.", true)] {
        let wanted = if known { BlockMotion::Passes { via: None, to: pose(1, 2, 3) } } else { BlockMotion::Nothing };
        assert_eq!(blocks.read(line.as_bytes()).unwrap().0, wanted, "{line}");
    }
}

#[test]
fn compensated_contour_is_skipped_up_to_the_end_of_the_g40_move() {
    let contour = "G1X1.F1.\nG41D1X2.\nX3.";
    assert_eq!(motion(contour), BlockMotion::Nothing);
    assert_eq!(motion(&format!("{contour}\nG40X4.")), BlockMotion::Passes { via: None, to: pose(4, 0, 0) });
    assert_eq!(along(&format!("{contour}\nG40X4.\nX5.")), (pose(4, 0, 0), pose(5, 0, 0), true));
}

#[test]
fn a_hole_is_passed_over_by_way_of_its_bottom() {
    let hole = "G0X0Y0Z10.\nG99G81X5.Y0Z-3.R2.F100.";
    assert_eq!(motion(hole), BlockMotion::Passes { via: Some(pose(5, 0, -3)), to: pose(5, 0, 2) });
    let high = "G0X0Y0Z10.\nG98G83X5.Y0Z-3.R2.Q1.F100.\nX6.";
    assert_eq!(motion(high), BlockMotion::Passes { via: Some(pose(6, 0, -3)), to: pose(6, 0, 10) });
    assert_eq!(along(&format!("{high}\nG80\nG1Z9.F1.")), (pose(6, 0, 10), pose(6, 0, 9), true));
}

#[test]
fn tapping_and_feed_per_revolution_are_followed_without_a_law() {
    assert!(!along("G63\nG1Z-1.F1.").2);
    assert!(along("G63\nG64\nG1Z-1.F1.").2);
    let BlockMotion::Along(segment, false) = motion("S100M3\nG95G1X1.F.1") else { panic!("a law could act") };
    assert_eq!(segment.feed, Feed::Missing);
}

#[test]
fn what_the_control_alone_knows_ends_it() {
    for line in ["M98P1000", "G65P9000", "G31X1.", "#1=#2", "X#1", "GOTO10", "G1X1.", "G2X1.Y1.", "G43.9", "X1.O2"] {
        assert!(last(line).is_err(), "{line}");
    }
    for line in ["#3004=2", "#3003=1", "G0X1.\nO2"] {
        assert_eq!(last(line), Err(TapLossReason::OutOfSight), "{line}");
    }
}

#[test]
fn a_control_that_keeps_its_codes_is_trusted_once_the_program_has_said_them() {
    let mut blocks = Blocks::new(settings(), false);
    blocks.begin(Some(Pose::ORIGIN));
    let mut governs = |line: &str| matches!(blocks.read(line.as_bytes()), Ok((BlockMotion::Along(_, true), _)));
    assert!(!governs("G21G17G1X1.F1."));
    assert!(!governs("G90X2."));
    assert!(governs("G94X3.F1."));
}

#[test]
fn the_block_of_the_end_is_reported() {
    for (line, ends) in [("M30", true), ("M2", true), ("G0X1.M30", true), ("M0", false), ("M1", false)] {
        assert_eq!(last(line).map(|(_, ends)| ends), Ok(ends), "{line}");
    }
}

#[test]
fn a_block_with_small_letters_is_lost_because_a_control_may_skip_them() {
    let lost = Err(TapLossReason::NotUnderstood(Fault::alarm(Alarm::Character, 7)));
    assert_eq!(last("G1X1.\nG1X10.f100."), lost);
    assert!(last("G1X10.F100.(note)").is_ok());
}
