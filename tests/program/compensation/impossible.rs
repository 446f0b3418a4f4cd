//! Contours that the tool cannot follow: each with its alarm, and the block that has it.

use arcfeed_nc::alarm::{Alarm, Cause};
use arcfeed_nc::settings::StartUp;

use super::compensated::compensated;

/// Lead-in along X at the origin, with a tool of 2 mm on the left; the contour follows from line 4 on.
const LEFT: &str = "G21G17G90G94\nG0X-10.Y0\nG41D4G1X0F100.\n";
/// The same with the tool on the right.
const RIGHT: &str = "G21G17G90G94\nG0X-10.Y0\nG42D4G1X0F100.\n";

/// Program (`;` ends a line), alarm, and line of the move that the control does not execute.
#[rustfmt::skip]
const CONTOURS: [(&str, &str, Alarm, usize); 20] = [
    (LEFT, "X10.;Y1.;X0;", Alarm::Interference, 5),
    (LEFT, "X10.;Y-9.;X13.5;Y0;X30.;", Alarm::Interference, 6),
    (RIGHT, "X10.;Y9.;X13.5;Y0;X30.;", Alarm::Interference, 6),
    (LEFT, "X10.;X11.Y-9.;X13.;X14.Y0;X30.;", Alarm::Interference, 6),
    (LEFT, "X10.;G3X11.9Y1.9J1.9;", Alarm::Interference, 5),
    (RIGHT, "X10.;G2X11.9Y-1.9J-1.9;", Alarm::Interference, 5),
    (LEFT, "X10.;G3J1.5;", Alarm::Interference, 5),
    (LEFT, "X10.;G3Y3.8J1.9;G1X0;", Alarm::Interference, 5),
    (LEFT, "X10.;G3X11.9Y1.9Z-1.J1.9;", Alarm::Interference, 5),
    (LEFT, "X10.;Y-5.;G3X13.8I1.9;G1Y0;X30.;", Alarm::Interference, 6),
    (LEFT, "X10.;G3X13.Y3.J3.;G1X12.;G1Y20.;", Alarm::NoIntersection, 5),
    ("G51.1X0\nG0X10.Y0\nG42D4G1X0F100.\n", "X-10.;G2X-11.9Y1.9J1.9;", Alarm::Interference, 5),
    ("G18G21\nG0Z-10.X0\nG41D4G1Z0F100.\n", "Z10.;G3Z11.9X1.9I1.9;", Alarm::Interference, 5),
    ("G21G17\nG0X6.Y0\nG42D10G1X5.F1.\n", "X-6.;G2X0Y6.I6.;G1X5.;", Alarm::NoIntersection, 4),
    ("G21G17\nG0X-10.Y6.\nG42D10G1X-5.F1.\n", "X0;G2X6.Y0J-6.;G1X-6.;", Alarm::NoIntersection, 5),
    ("G21G17\nG0X-10.Y-6.\nG41D10G1X-5.F1.\n", "X0;G3X6.Y0J6.;G3X0Y1.5R3.4;", Alarm::Interference, 6),
    (LEFT, "X10.;G2X10.02I.02;G1X20.;", Alarm::ArcEndInCenter, 5),
    ("G21G17\nG0X-10.\nG41D4G2X0I5.F100.\n", "", Alarm::ArcAtStartUp, 3),
    (LEFT, "X10.;G40G2X14.Y-4.J-4.;", Alarm::ArcAtStartUp, 5),
    (LEFT, "X10.;G18;", Alarm::PlaneUnderCompensation, 5),
];

#[test]
fn each_impossible_contour_is_refused_with_its_alarm_at_its_block() {
    for (head, contour, alarm, line) in CONTOURS {
        let text = format!("{head}{}", contour.replace(';', "\n"));
        for start_up in [StartUp::A, StartUp::B] {
            let found = compensated(&text, start_up).expect_err(&text);
            let at = if found.is_held { found.line - 1 } else { found.line };
            assert_eq!((found.fault.cause, at), (Cause::Alarm(alarm), line), "{text}: {found:?}");
        }
    }
}
