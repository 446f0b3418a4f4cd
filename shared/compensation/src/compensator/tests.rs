use super::*;
use crate::contour::ContourCommand;
use arcfeed_nc::alarm::Cause;
use arcfeed_nc::reader::Reader;
use arcfeed_nc::settings::{Preset, Reading, Scope, Settings, Tables};
use arcfeed_units::LengthUnit;

/// A move of the tool centre: its end and, for an arc, its centre, in the plane and across; mm.
#[derive(Debug, PartialEq)]
struct Found {
    is_corner: bool,
    end: [f64; 3],
    center: Option<[f64; 2]>,
}

fn reader_and_compensator(start_up: StartUp, blocks: u8) -> (Reader, Compensator) {
    let mut settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
    settings.scope = Scope::Everything;
    settings.compensation = CompensationSettings { start_up, blocks, ..settings.compensation };
    let mut tables = Tables::default();
    for (radius, value) in tables.radii.iter_mut().zip([2.0, 5.0, -2.0, 0.5, 10.0]) {
        radius[0] = Nm::from_mm(value);
    }
    (Reader::with(settings, tables), Compensator::new(settings.compensation))
}

/// Moves of a program, whose blocks are separated by blanks, or its fault and the block in which it came up.
fn run(program: &str, start_up: StartUp, blocks: u8) -> Result<Vec<Found>, (usize, Cause, bool)> {
    let (mut reader, mut compensator) = reader_and_compensator(start_up, blocks);
    let mut found = Vec::new();
    let mut position = None;
    for (index, text) in program.split_whitespace().enumerate() {
        let line = reader.read(text.as_bytes()).map_err(|fault| (index, fault.cause, false))?;
        let command = ContourCommand::of(&line, reader.modal(), reader.tables());
        let moves = command.apply(line.segment.as_ref(), &mut compensator).map_err(|fault| match fault {
            CompensationFault::Held(fault) => (index, fault.cause, true),
            CompensationFault::Given(fault) => (index, fault.cause, false),
        })?;
        for center_move in moves {
            let (is_corner, segment) = match center_move {
                CenterMove::Corner(segment) => (true, segment),
                CenterMove::Main(segment) => (false, segment),
            };
            assert!(position.is_none_or(|position| position == segment.start), "{text}: no jump");
            position = Some(segment.end);
            let center = segment.arc().map(|arc| arc.center.map(Nm::to_mm));
            found.push(Found { is_corner, end: segment.end.linear.map(Nm::to_mm), center });
        }
    }
    Ok(found)
}

fn ends(program: &str) -> Vec<[f64; 2]> {
    run(program, StartUp::A, 3).unwrap().iter().map(|found| [found.end[0], found.end[1]]).collect()
}

fn assert_ends(program: &str, start_up: StartUp, wanted: &[[f64; 2]]) {
    let found = run(program, start_up, 3).unwrap();
    assert_eq!(found.len(), wanted.len(), "{program}: {found:?}");
    for (found, wanted) in found.iter().zip(wanted) {
        let near = found.end.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1.1e-6);
        assert!(near, "{program}: {found:?}, not {wanted:?}");
    }
}

fn cause(program: &str) -> (usize, Cause, bool) {
    run(program, StartUp::A, 3).unwrap_err()
}

#[test]
fn a_square_grows_by_the_radius_outside_and_shrinks_by_it_inside() {
    let square = |side| format!("G0X-10.Y10. {side}D1G1X0F100. Y20. X20. Y0 X0 Y10. G40X-10. M30");
    let outside = [[-10.0, 10.0], [-2.0, 10.0], [-2.0, 22.0], [22.0, 22.0], [22.0, -2.0], [-2.0, -2.0], [-2.0, 10.0]];
    assert_eq!(ends(&square("G41"))[..7], outside);
    let inside = [[-10.0, 10.0], [2.0, 10.0], [2.0, 18.0], [18.0, 18.0], [18.0, 2.0], [2.0, 2.0], [2.0, 10.0]];
    assert_eq!(ends(&square("G42"))[..7], inside);
    assert_eq!(ends(&square("G42D3")), ends(&square("G42")), "the last D counts");
}

#[test]
fn a_negative_radius_exchanges_the_sides() {
    let program = |side, d| format!("G0X-10.Y10. {side}D{d}G1X0F100. Y20. X20. G40Y30. M30");
    assert_eq!(ends(&program("G41", 3)), ends(&program("G42", 1)));
}

#[test]
fn a_mirrored_axis_exchanges_the_sides() {
    let mirrored = ends("G51.1X0 G0X10.Y10. G42D1G1X0F100. Y20. X-20. G40Y30. M30");
    assert_eq!(mirrored, ends("G0X-10.Y10. G41D1G1X0F100. Y20. X20. G40Y30. M30"));
}

#[test]
fn a_circle_keeps_its_centre_and_changes_its_radius() {
    for (side, x) in [("G41", -8.0), ("G42", -12.0)] {
        let found = run(&format!("G0X-20. {side}D1G1X-10.F100. G3I10. G1G40X-20. M30"), StartUp::A, 3).unwrap();
        let wanted = |x, center| Found { is_corner: false, end: [x, 0.0, 0.0], center };
        let arc = wanted(x, Some([0.0, 0.0]));
        assert_eq!(found, [wanted(-20.0, None), wanted(x, None), arc, wanted(-20.0, None)]);
    }
}

#[test]
fn a_slot_as_wide_as_the_tool_is_followed_and_a_narrower_one_is_an_alarm() {
    let slot = |d| format!("G0X0Y0 G41D{d}G1X0Y5.F100. X-20. G3Y-5.J-5. G1X20. G3Y5.J5. G1X0 G40Y0 M30");
    let wide = ends(&slot(2));
    assert_eq!(
        wide,
        [[0.0, 0.0], [0.0, 0.0], [-20.0, 0.0], [-20.0, 0.0], [20.0, 0.0], [20.0, 0.0], [0.0, 0.0], [0.0, 0.0]]
    );
    assert_eq!(cause(&slot(5)).1, Cause::Alarm(Alarm::Interference));
    let groove = |width: f64| format!("G0Y20. G41D1G1Y10.F1. X10. Y0 X{} Y10. X40. G40Y20. M30", 10.0 + width);
    assert!(run(&groove(4.0), StartUp::A, 3).is_ok());
    assert_eq!(cause(&groove(3.9)), (5, Cause::Alarm(Alarm::Interference), true));
}

#[test]
fn a_start_up_inside_ends_at_the_normal_of_the_next_block() {
    for start_up in [StartUp::A, StartUp::B] {
        let program = "G0X-10. G41D1G1X0F1. Y10. G40X-10. M30";
        assert_ends(program, start_up, &[[-10.0, 0.0], [-2.0, 0.0], [-2.0, 10.0], [-10.0, 10.0]]);
    }
}

#[test]
fn a_start_up_outside_goes_straight_or_around_the_corner_by_its_type() {
    let obtuse = "G0X-10. G42D1G1X0F1. Y10. G40X-10. M30";
    assert_ends(obtuse, StartUp::A, &[[-10.0, 0.0], [2.0, 0.0], [2.0, 10.0], [-10.0, 10.0]]);
    assert_ends(obtuse, StartUp::B, &[[-10.0, 0.0], [2.0, -2.0], [2.0, 12.0], [-10.0, 10.0]]);
    // The workpiece has 45 degrees in the corner.
    let acute = "G0X-10. G42D1G1X0F1. X-10.Y10. M30";
    let (half, far) = (core::f64::consts::SQRT_2, 2.0 * core::f64::consts::SQRT_2);
    assert_ends(acute, StartUp::A, &[[-10.0, 0.0], [half, half], [half - 10.0, 10.0 + half]]);
    let around = [[-10.0, 0.0], [2.0, -2.0], [far, 0.0], [half - 10.0, 10.0 + half]];
    assert_ends(acute, StartUp::B, &around);
}

#[test]
fn moves_around_a_corner_belong_to_the_block_behind_it() {
    let found = run("G0X-10. G42D1G1X0F1. X10. Z-1. X0Y10. G40Y20. M30", StartUp::A, 3).unwrap();
    let corners: Vec<bool> = found.iter().map(|found| found.is_corner).collect();
    assert_eq!(corners, [false, false, false, false, true, false, false]);
    assert_eq!(found[2].end, [12.0, -2.0, 0.0]);
    assert_eq!(found[3].end, [12.0, -2.0, -1.0]);
}

#[test]
fn a_corner_inside_between_line_and_arc_is_their_intersection() {
    // The offset line y = 2 and the offset circle of radius 7 about the origin.
    let found = ends("G0X-20. G41D1G1X-10.F1. X-5. G2X5.I5. G1X10. G40X20. M30");
    let across = libm::sqrt(45.0);
    for (end, x) in found[2..4].iter().zip([-across, across]) {
        assert!((end[0] - x).abs() < 1e-6 && (end[1] - 2.0).abs() < 1e-6, "{found:?}");
    }
}

#[test]
fn a_helix_rises_as_programmed() {
    let found = run("G0X-20. G41D1G1X-10.F100. G3I10.Z-3. G1Z-4. G40X-20. M30", StartUp::A, 3).unwrap();
    let heights: Vec<f64> = found.iter().map(|found| found.end[2]).collect();
    assert_eq!(heights, [0.0, 0.0, -3.0, -4.0, -4.0]);
    assert_eq!(found[2].end[0], -8.0);
}

#[test]
fn every_plane_has_its_own_left() {
    let [xy, zx, yz] = [
        run("G17G0X-10.Y10. G41D1G1X0F1. Y20. X20. M30", StartUp::A, 3),
        run("G18G0Z-10.X10. G41D1G1Z0F1. X20. Z20. M30", StartUp::A, 3),
        run("G19G0Y-10.Z10. G41D1G1Y0F1. Z20. Y20. M30", StartUp::A, 3),
    ]
    .map(|found| found.unwrap().into_iter().map(|found| found.end).collect::<Vec<_>>());
    for ((xy, zx), yz) in xy.iter().zip(&zx).zip(&yz) {
        assert_eq!((xy[0], xy[1]), (zx[2], zx[0]));
        assert_eq!((xy[0], xy[1]), (yz[1], yz[2]));
    }
}

#[test]
fn one_block_without_a_move_changes_nothing_and_two_end_at_the_normal() {
    let plain = ends("G0X-10. G42D1G1X0F1. X10. X10.Y10. G40X0 M30");
    assert_eq!(ends("G0X-10. G42D1G1X0F1. X10. M8 X10.Y10. G40X0 M30"), plain);
    let unread = (5, Cause::NotModelled(NotModelled::UnreadCorner), false);
    assert_eq!(cause("G0X-10. G42D1G1X0F1. X10. M8 M9 X10.Y10. G40X0 M30"), unread);
    assert_eq!(cause("G0X-10. G42D1G1X0F1. X10. M0 X10.Y10. G40X0 M30"), (4, unread.1, false));
    assert_eq!(cause("G0X-10. G42D1G1X0F1. X10. G91X0 G90X10.Y10. G40X0 M30"), (4, unread.1, false));
    assert!(run("G0X-10. G42D1G1X0F1. X10. M8 M9 X10.Y10. G40X0 M30", StartUp::A, 4).is_ok());
    // A tangent continuation, and the end of compensation, need no corner.
    assert_eq!(ends("G0X-10. G42D1G1X0F1. X10. M8 M9 X20. G40Y9. M30")[3], [20.0, -2.0]);
    assert_eq!(ends("G0X-10. G42D1G1X0F1. X10. Z9. M9 G40Y9. M30")[2..], [[10.0, -2.0], [10.0, -2.0], [10.0, 9.0]]);
}

#[test]
fn g40_without_a_move_ends_at_the_normal_and_the_next_move_goes_back() {
    for start_up in [StartUp::A, StartUp::B] {
        let program = "G0X-10. G42D1G1X0F1. X10. G40 X10.Y10. M30";
        assert_ends(program, start_up, &[[-10.0, 0.0], [0.0, -2.0], [10.0, -2.0], [10.0, 10.0]]);
    }
}

#[test]
fn another_radius_counts_from_the_end_of_its_line() {
    let found = ends("G0X-10. G42D1G1X0F1. X10. D2X20. X30. G40Y9. M30");
    assert_eq!(found[2..5], [[10.0, -2.0], [20.0, -5.0], [30.0, -5.0]]);
    let arc = cause("G0X-10. G42D1G1X0F1. X10. D2G3X20.Y10.J10. G40Y9. M30");
    assert_eq!(arc, (3, Cause::NotModelled(NotModelled::RadiusInArc), false));
}

#[test]
fn d0_ends_compensation_like_g40() {
    assert_eq!(ends("G0X-10. G42D1G1X0F1. X10. D0X20. X30. M30"), ends("G0X-10. G42D1G1X0F1. X10. G40X20. X30. M30"));
    assert_eq!(cause("G0X-10. G42D1G1X0F1. X10. D0G3X20.R9.").1, Cause::Alarm(Alarm::ArcAtStartUp));
}

#[test]
fn contours_that_the_tool_cannot_follow_are_alarms() {
    for (program, alarm) in [
        ("G0X-10. G41D2G1X0F1. X10. G3X14.Y4.J4. G1Y9.", Alarm::Interference),
        ("G0X-10. G41D1G1X0F1. X10. X10.Y1. X0", Alarm::Interference),
        // From the middle of a circle to its edge and on along it, with a tool that only fits the middle.
        ("G0X6.Y0 G42D2G1X5.F1. X-6. G2X0Y6.I6. G1X5.", Alarm::NoIntersection),
        ("G0X-10. G41D1G1X0F1. X10. G2X10.02I.02 G1X20.", Alarm::ArcEndInCenter),
        ("G41D1 G2X5.R9.F1.", Alarm::ArcAtStartUp),
        ("G41D1 G18", Alarm::PlaneUnderCompensation),
    ] {
        assert_eq!(cause(program).1, Cause::Alarm(alarm), "{program}");
    }
}

#[test]
fn what_is_not_compensated_is_refused_by_name() {
    let contour = "G0X-10. G41D1G1X0F1. X10.";
    for (block, what) in [
        ("G28X0", NotModelled::InContour(280)),
        ("G53X0", NotModelled::InContour(530)),
        ("G81R1.Z-1.", NotModelled::InContour(810)),
        ("G92X0", NotModelled::InContour(920)),
        ("G55X20.", NotModelled::InContour(550)),
        ("G68X0Y0R30.", NotModelled::InContour(680)),
        ("G41", NotModelled::InContour(410)),
        ("G40X20.I1.", NotModelled::InContour(400)),
        ("G93X20.F9.", NotModelled::InContour(930)),
        ("G42X20.", NotModelled::ChangeOfSide),
    ] {
        assert_eq!(cause(&format!("{contour} {block}")), (3, Cause::NotModelled(what), false), "{block}");
    }
    assert!(run(&format!("{contour} G40 Y20. G28X0 M30"), StartUp::A, 3).is_ok());
}

#[test]
fn without_an_offset_every_move_stays_as_it_is() {
    let program = "G0X-10.Z5. G41D9 G1X0F1. G2X10.Y-10.I10. G1X3.Z1. G40X9. G3X0I-4.5Z2. M30";
    let (mut reader, mut compensator) = reader_and_compensator(StartUp::A, 3);
    let program = program.replace("G41D9 ", "");
    for text in program.split_whitespace() {
        let line = reader.read(text.as_bytes()).unwrap();
        let command = ContourCommand::of(&line, reader.modal(), reader.tables());
        let moves = command.apply(line.segment.as_ref(), &mut compensator).unwrap();
        let wanted: Vec<CenterMove> = line.segment.into_iter().map(CenterMove::Main).collect();
        assert_eq!(moves[..], wanted[..], "{text}");
    }
}

const WORDS: [&str; 34] = [
    "G0", "G1", "G1", "G2", "G3", "G40", "G41", "G42", "D1", "D2", "D3", "D4", "D0", "X0", "X1.", "X5.", "X-7.5",
    "X20.", "Y0", "Y2.", "Y-3.", "Y12.", "Z1.", "I1.", "I-5.", "J3.", "J-2.", "R4.", "R-9.", "M8", "M0", "G4P1", "G91",
    "G90",
];

#[test]
fn random_blocks_come_out_once_each_in_order_and_without_a_jump() {
    let (mut seed, mut corners, mut faults, mut compensated) = (1_u32, 0, 0, 0);
    let mut next = |below: usize| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 16) as usize % below
    };
    for start_up in [StartUp::A, StartUp::B].repeat(5_000) {
        let (mut reader, mut compensator) = reader_and_compensator(start_up, 3 + next(3) as u8);
        let (mut given, mut out, mut position) = (0, 0, None);
        for _ in 0..30 {
            let text: String = (0..1 + next(4)).map(|_| WORDS[next(WORDS.len())]).collect();
            let Ok(line) = reader.read(format!("{text}F1.").as_bytes()) else { break };
            let command = ContourCommand::of(&line, reader.modal(), reader.tables());
            let moves = match command.apply(line.segment.as_ref(), &mut compensator) {
                Ok(moves) => moves,
                Err(_) => {
                    faults += 1;
                    compensator.reset();
                    break;
                }
            };
            given += usize::from(line.segment.is_some());
            compensated += usize::from(command.offset != Nm(0) && line.segment.is_some());
            for center_move in moves {
                let (CenterMove::Corner(segment) | CenterMove::Main(segment)) = center_move;
                assert!(position.is_none_or(|position| position == segment.start), "{text}");
                position = Some(segment.end);
                match center_move {
                    CenterMove::Corner(_) => corners += 1,
                    CenterMove::Main(_) => out += 1,
                }
            }
            let waiting = compensator.waiting.len() + usize::from(compensator.held().is_some());
            assert_eq!(out + waiting, given, "{text}");
        }
        let waiting = compensator.waiting.len() + usize::from(compensator.held().is_some());
        if let Ok(rest) = compensator.end_held() {
            assert_eq!(rest.iter().filter(|moved| matches!(moved, CenterMove::Main(_))).count(), waiting);
        }
    }
    assert!(corners > 100 && faults > 500 && compensated > 5_000, "{corners} {faults} {compensated}");
}
