//! Coordinates against closed forms: mirrored, scaled, turned and shifted points written out by hand, never taken from
//! the reader.

use arcfeed_nc::modal::Turn;
use arcfeed_nc::settings::{Settings, Tables};
use arcfeed_units::Nm;

use crate::cycles::{assert_does, reader, run};

#[test]
fn a_mirror_turns_contours_over_and_holes_with_them() {
    // Mirrored at X = 10: x becomes 20 - x, the arc runs the other way round, Y and Z stay.
    assert_does(
        "G0X0Y0Z5.\nG51.1X10.\nG0X4.Y1.\nG1Y3.F100.\nG91G1X-1.\nG90G99G81X2.Y0R1.Z-4.\nG80G50.1X0\nG0X1.Y0",
        &["r 0 0 5", "r 16 1 5", "f 16 3 5", "f 17 3 5", "r 18 0 5", "r 18 0 1", "f 18 0 -4", "r 18 0 1", "r 1 0 1"],
    );
    let arc = |line: &str| {
        let mut reader = reader(|_, _| ());
        for line in ["G0X5.Y0", "G51.1X0", "G0X5.Y0F100."] {
            assert!(reader.read(line.as_bytes()).is_ok());
        }
        let segment = reader.read(line.as_bytes()).expect("an arc").segment.expect("a move");
        let arc = *segment.arc().expect("an arc");
        (arc.turn, arc.center.map(Nm::to_mm), segment.end.linear.map(Nm::to_mm))
    };
    for line in ["G2X0Y-5.I-5.", "G2X0Y-5.R5."] {
        assert_eq!(arc(line), (Turn::Ccw, [0.0, 0.0], [0.0, -5.0, 0.0]), "{line}");
    }
}

#[test]
fn scaling_is_about_its_point_and_an_axis_that_is_not_named_stays() {
    // About 10, 20 by 2: 10 + 2 (x - 10), 20 + 2 (y - 20).
    assert_does(
        "G0X3.001Y7.\nG51X10.Y20.P2000\nX15.\nY25.\nG91X1.\nG90G50\nX0",
        &["r 3.001 7 0", "r 20 7 0", "r 20 30 0", "r 22 30 0", "r 0 30 0"],
    );
    // Each axis its own, one of them mirrored; by a third there is no exact way back.
    assert_does("G51X0Y0I-500J333K1000\nG0X8.Y1.Z4.\nX2.", &["r -4 0.333 4", "r -1 0.333 4"]);
    let mut reader = reader(|_, _| ());
    for line in ["G51X0Y0P3000", "G0X5.Y0F100."] {
        assert!(reader.read(line.as_bytes()).is_ok());
    }
    let segment = reader.read(b"G2X0Y-5.R5.").expect("an arc").segment.expect("a move");
    let arc = segment.arc().expect("an arc");
    assert_eq!((arc.turn, arc.radius_mm(), arc.center.map(Nm::to_mm)), (Turn::Cw, 15.0, [0.0, 0.0]));
}

#[test]
fn a_scaled_pattern_is_turned_behind_and_shifted_last() {
    // 2 (1, 0) turned by 90 degrees about 2 (3, 0) is (6, -4); the work offset comes on top.
    let mut reader = reader(|_, tables| tables.systems[0].linear[0] = Nm::from_mm(100.0));
    let program = "G51X0Y0P2000\nG68X3.Y0R90.\nG0X1.Y0";
    assert_eq!(run(&mut reader, program), ["r 106 -4 0"]);
}

#[test]
fn a_turned_arc_is_the_arc_turned() {
    let mut reader = reader(|_, _| ());
    run(&mut reader, "G0X0Y0\nG68X10.Y0R90.\nG90G0X15.Y0");
    let arc = reader.read(b"G3X10.Y5.I-5.F100.").expect("an arc").segment.expect("a segment");
    // About (10, 0), radius 5: from straight up to the left.
    assert_eq!((arc.start.linear[0].to_mm(), arc.start.linear[1].to_mm()), (10.0, 5.0));
    assert_eq!((arc.end.linear[0].to_mm(), arc.end.linear[1].to_mm()), (5.0, 0.0));
    let circle = arc.arc().expect("an arc");
    assert_eq!(circle.center.map(Nm::to_mm), [10.0, 0.0]);
    assert!((circle.sweep_rad() - core::f64::consts::FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn offsets_move_the_path_and_not_the_program() {
    let offset = |_: &mut Settings, tables: &mut Tables| {
        tables.systems[0].linear[0] = Nm::from_mm(100.0);
        tables.systems[1].linear[0] = Nm::from_mm(200.0);
        tables.systems[6].linear[1] = Nm::from_mm(-7.0);
        tables.lengths[2] = [Nm::from_mm(80.0), Nm::from_mm(-0.5)];
    };
    let mut reader = reader(offset);
    let program = "G54G0X1.Y2.\nG55X1.\nG52X5.\nX1.\nG52X0\nG54.1P1X1.Y2.\nG10L2P1X300.\nG54X1.Y0\nG92X50.\nX51.\nG91X1.\nG90G53X0Y0";
    let wanted = ["r 101 2 0", "r 201 2 0", "r 206 2 0", "r 1 -5 0", "r 301 0 0", "r 302 0 0", "r 303 0 0", "r 0 0 0"];
    assert_eq!(run(&mut reader, program), wanted);
    assert_eq!(run(&mut reader, "G92.1X0Y0\nG54X0\nG43H3Z10."), ["r 300 0 0", "r 300 0 10"]);
    assert_eq!(reader.machine().linear[2].to_mm(), 10.0 + 79.5);
    assert_eq!(run(&mut reader, "G44H3Z10.\nG49Z11."), ["r 300 0 10", "r 300 0 11"]);
    assert_eq!(reader.machine().linear[2].to_mm(), 11.0);
}

#[test]
fn the_origin_of_the_workpiece_follows_offsets_and_g92_but_neither_g52_nor_g68() {
    let mut reader = reader(|_, tables| {
        tables.external.linear[0] = Nm::from_mm(1000.0);
        tables.systems[0].linear[0] = Nm::from_mm(100.0);
        tables.systems[1].linear[0] = Nm::from_mm(200.0);
    });
    let lines = [
        ("G0X1.", 1100.0),
        ("G55X1.", 1200.0),
        ("G52X5.", 1200.0),
        ("X1.", 1200.0),
        // The tool stands at 1206.
        ("G92X50.", 1156.0),
        ("G52X-7.", 1156.0),
        ("G68X0Y0R30.", 1156.0),
        ("G10L2P2X210.", 1166.0),
        ("G69", 1166.0),
        ("G92.1X0", 1210.0),
        ("G54", 1100.0),
    ];
    for (line, wanted_mm) in lines {
        run(&mut reader, line);
        assert_eq!(reader.modal().work_origin().linear[0].to_mm(), wanted_mm, "{line}");
    }
}

#[test]
fn the_way_to_a_reference_point_leads_by_way_of_the_point_given() {
    let mut reader = reader(|settings, tables| {
        settings.reference[0].linear = [Nm(0), Nm(0), Nm::from_mm(400.0)];
        settings.reference[1].linear[0] = Nm::from_mm(-50.0);
        tables.systems[0].linear[2] = Nm::from_mm(-100.0);
    });
    let done = run(&mut reader, "G0X10.Y20.Z5.\nG91G28Z10.\nG30P2X0\nG90Z0");
    assert_eq!(done, ["r 10 20 -95", "r 10 20 -85", "r 10 20 400", "r -50 20 400", "r -50 20 -100"]);
}
