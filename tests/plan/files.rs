//! Rotors from files: the published table, curve files of the same rotor, and what is said of wrong ones.

use std::fmt::Write;

use arcfeed_plan::geometry::blade::{RotorAxis, Sections, length_mm};
use arcfeed_plan::geometry::blisk::Revolution;
use arcfeed_plan::geometry::curves::{self, CurveFile, Texts};
use arcfeed_plan::geometry::generator::Rotor;
use arcfeed_plan::geometry::point_file::{Fault, PointFileFrame, ReadError};
use arcfeed_plan::geometry::sections;
use arcfeed_plan::vector::Point;

use crate::published_rotor::{ROTOR, TEXT, farthest_mm, sections as published};

const Y: PointFileFrame = PointFileFrame { axis: RotorAxis::Y, unit_mm: 1.0 };
const Z: PointFileFrame = PointFileFrame { axis: RotorAxis::Z, unit_mm: 1.0 };

fn hub() -> Revolution {
    Revolution { profile_mm: vec![[-20.0, 70.0], [20.0, 70.0]] }
}

fn refused(text: &str, drawn: &PointFileFrame) -> ReadError {
    sections::read(text, drawn, &hub()).expect_err("the table is wrong")
}

#[test]
fn the_table_of_sections_is_read_point_for_point() {
    let read = sections::read(TEXT, &Y, &hub()).unwrap();
    assert_eq!(read, [published()]);
    let inch = PointFileFrame { unit_mm: 25.4, ..Y };
    let large = Revolution { profile_mm: hub().profile_mm.iter().map(|place| place.map(|x| x * 25.4)).collect() };
    let read = sections::read(&TEXT.replace("_mm", ""), &inch, &large).unwrap();
    assert_eq!(sections::read(&TEXT.replace("_mm", "_in"), &Y, &large).unwrap(), read);
    // A unit behind a name is the column's own.
    assert_eq!(sections::read(TEXT, &inch, &hub()).unwrap(), [published()]);
    assert!((read[0].pressure[3][5] - published().pressure[3][5] * 25.4).norm() < 1e-9);
}

#[test]
fn a_wrong_table_is_refused_where_it_is_wrong() {
    let line = |number: usize, new: &str| {
        let lines = TEXT.lines().enumerate().map(|(at, old)| if at + 1 == number { new } else { old });
        lines.collect::<Vec<_>>().join("\n")
    };
    let error = refused(&line(5, "0.0000,70.0000,PS,3,-5.907565,nan,69.750274"), &Y);
    assert_eq!(error.to_string(), "5:31: `nan` is no number");
    let error = refused(&line(5, "0.0000,70.0000,PS,4,-5.907565,-11.453600,69.750274"), &Y);
    assert_eq!((error.line, error.column), (5, 19));
    assert!(error.to_string().contains("point 4 where point 3 was to come"), "{error}");
    let error = refused(&line(9, "0.0000,70.0000,TS,7,-5.583294,-11.150786,69.776979"), &Y);
    assert!(matches!(error, ReadError { line: 9, column: 16, fault: Fault::Side(_) }), "{error}");
    let error = refused(TEXT, &Z);
    assert!(error.to_string().starts_with("2:8: ") && error.to_string().ends_with(": \"y\" would do"), "{error}");
    let error = refused(&TEXT.replace("side", "half"), &Y);
    assert!(matches!(error.fault, Fault::Column("side")), "{error}");
    let error = refused(&TEXT.replace("PS", "QQ").replace("SS", "PS").replace("QQ", "SS"), &Y);
    assert!(matches!(error.fault, Fault::Swapped { shorter_mm } if shorter_mm > 1.0), "{error}");
    let only_one: String = TEXT
        .lines()
        .filter(|l| !l.starts_with("0.") || l.starts_with("0.0000"))
        .fold(String::new(), |all, l| all + l + "\n");
    let only_one = only_one.lines().filter(|l| !l.starts_with("1.0")).collect::<Vec<_>>().join("\n");
    assert!(matches!(refused(&only_one, &Y).fault, Fault::Sections { found: 1 }));
    let backwards: Vec<&str> = TEXT.lines().skip(1).collect();
    let backwards = backwards
        .chunks(162)
        .rev()
        .flatten()
        .fold(String::from("s,R_mm,side,i,x_mm,y_mm,z_mm\n"), |all, l| all + l + "\n");
    let error = refused(&backwards, &Y);
    assert!(matches!(error.fault, Fault::OffTheHub { .. } | Fault::Order { .. }), "{error}");
}

#[test]
fn sections_out_of_order_are_named() {
    let mut lines: Vec<&str> = TEXT.lines().collect();
    let fourth: Vec<&str> = lines.drain(1 + 3 * 162..1 + 4 * 162).collect();
    let at = 1 + 2 * 162;
    for (offset, line) in fourth.into_iter().enumerate() {
        lines.insert(at + offset, line);
    }
    let error = refused(&lines.join("\n"), &Y);
    assert_eq!(error.line, 1 + 3 * 162 + 1);
    assert!(matches!(error.fault, Fault::Order { section: 4, below_mm } if (below_mm - 3.575).abs() < 1e-3), "{error}");
}

/// The loops of a blade as a curve file, from a place somewhere on the suction side, in the given sense.
pub fn profile(blade: &Sections, is_reversed: bool, marks: bool) -> String {
    let mut text = String::new();
    for (at, (pressure, suction)) in blade.pressure.iter().zip(&blade.suction).enumerate() {
        writeln!(text, "# Profile {} at {:.2} %", at + 1, 100.0 * at as f64 / (blade.pressure.len() - 1) as f64)
            .unwrap();
        let last = pressure.len() - 1;
        let mut around: Vec<(Point, &str)> = pressure[..last].iter().map(|point| (*point, "")).collect();
        around.extend(suction[1..].iter().rev().map(|point| (*point, "")));
        if marks {
            around[0].1 = " le1";
            around[last].1 = " te1";
        }
        around.rotate_left(last + 20);
        around.push((around[0].0, ""));
        if is_reversed {
            around.reverse();
        }
        for (point, mark) in around {
            writeln!(text, "{:.9}  {:.9}\t{:.9}{mark}", point.x, point.y, point.z).unwrap();
        }
        writeln!(text).unwrap();
    }
    text
}

pub fn curve(radius_mm: f64, places: [f64; 2]) -> String {
    let step = |i: usize| places[0] + (places[1] - places[0]) * i as f64 / 10.0;
    (0..=10).map(|i| format!("{radius_mm:.6} 0.0 {:.6}\n", step(i))).collect()
}

/// Distance of points from a polyline.
fn beside_mm(points: &[Point], line: &[Point]) -> f64 {
    let from_piece = |point: &Point, pair: &[Point]| {
        let along = pair[1] - pair[0];
        let share = ((point - pair[0]).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (point - (pair[0] + along * share)).norm()
    };
    let nearest = |point: &Point| line.windows(2).map(|pair| from_piece(point, pair)).fold(f64::INFINITY, f64::min);
    points.iter().map(nearest).fold(0.0, f64::max)
}

#[test]
fn curve_files_of_a_rotor_give_its_sides_wherever_their_loops_begin() {
    let fine = ROTOR.sections(5, 2001).unwrap();
    let blade = ROTOR.sections(5, 81).unwrap();
    let (hub, shroud) = (curve(70.0, [-20.0, 20.0]), curve(99.0, [-20.0, 20.0]));
    for is_reversed in [false, true] {
        for marks in [false, true] {
            let text = profile(&blade, is_reversed, marks);
            let read = curves::read(&Texts { hub: &hub, shroud: &shroud, profile: &text }, &Z).unwrap();
            let mut worst_mm = 0.0_f64;
            for (ours, theirs) in [(&read.blades[0].pressure, &fine.pressure), (&read.blades[0].suction, &fine.suction)]
            {
                for (ours, theirs) in ours.iter().zip(theirs) {
                    assert_eq!(ours.len(), 81);
                    assert!((ours[0] - theirs[0]).norm() < 1e-6 && (ours[80] - theirs[2000]).norm() < 1e-6);
                    assert!((length_mm(ours) - length_mm(theirs)).abs() < 0.01);
                    worst_mm = worst_mm.max(beside_mm(ours, theirs));
                }
            }
            println!("reversed {is_reversed}, marked {marks}: {worst_mm:.4} mm off the rotor at most");
            assert!(worst_mm < 0.005);
        }
    }
}

#[test]
fn a_hub_that_runs_down_the_axis_turns_leading_and_trailing_edge_round() {
    let blade = ROTOR.sections(3, 81).unwrap();
    let (hub, shroud) = (curve(70.0, [20.0, -20.0]), curve(99.0, [20.0, -20.0]));
    let text = profile(&blade, false, false);
    let read = curves::read(&Texts { hub: &hub, shroud: &shroud, profile: &text }, &Z).unwrap();
    assert!(read.blades[0].pressure[0][0].z > 10.0 && read.blades[0].suction[0][80].z < -10.0);
    assert!(read.hub.profile_mm[0][0] < read.hub.profile_mm[10][0]);
}

#[test]
fn a_mirrored_rotor_keeps_its_concave_side_as_the_pressure_side() {
    let left = Rotor { hand: arcfeed_plan::geometry::generator::Hand::Left, ..ROTOR }.sections(3, 81).unwrap();
    let (hub, shroud) = (curve(70.0, [-20.0, 20.0]), curve(99.0, [-20.0, 20.0]));
    let text = profile(&left, false, false);
    let read = curves::read(&Texts { hub: &hub, shroud: &shroud, profile: &text }, &Z).unwrap();
    let ends = |blade: &Sections| vec![vec![blade.pressure[0][0], blade.pressure[2][80]]];
    assert!(farthest_mm(&ends(&read.blades[0]), &ends(&left)) < 1e-6);
    assert!(read.blades[0].bulge_mm() > 0.0);
    assert!(beside_mm(&read.blades[0].pressure[1][30..50], &left.pressure[1]) < 0.01);
}

#[test]
fn wrong_curve_files_are_refused_by_file_and_line() {
    let blade = ROTOR.sections(3, 21).unwrap();
    let (hub, shroud) = (curve(70.0, [-20.0, 20.0]), curve(99.0, [-20.0, 20.0]));
    let good = profile(&blade, false, false);
    let refused = |hub: &str, shroud: &str, profile: &str, drawn: &PointFileFrame| {
        curves::read(&Texts { hub, shroud, profile }, drawn).expect_err("a file is wrong")
    };
    let back = hub.replace("-4.000000", "-13.000000");
    let (which, error) = refused(&back, &shroud, &good, &Z);
    assert_eq!((which, error.line), (CurveFile::Hub, 5), "{error}");
    assert!(matches!(error.fault, Fault::TurnsBack { .. }));
    let (which, error) = refused(&hub, &curve(60.0, [-20.0, 20.0]), &good, &Z);
    assert!(matches!((which, &error.fault), (CurveFile::Shroud, Fault::Shroud { below_mm, .. }) if *below_mm == 10.0));
    let open: String = good
        .lines()
        .enumerate()
        .filter(|(at, _)| !(25..42).contains(at))
        .fold(String::new(), |all, (_, l)| all + l + "\n");
    let (which, error) = refused(&hub, &shroud, &open, &Z);
    assert_eq!((which, error.line), (CurveFile::Profile, 2), "{error}");
    assert!(error.to_string().contains("section 1 is open: "), "{error}");
    let (_, error) = refused(&hub, &shroud, &good.replacen('\t', " x", 1), &Z);
    assert!(matches!(error, ReadError { line: 2, fault: Fault::NotANumber(_), .. }), "{error}");
    let (_, error) = refused(&hub, &shroud, &good.replacen("\n# Profile 2", " middle\n# Profile 2", 1), &Z);
    assert!(matches!(error.fault, Fault::Coordinates(1) | Fault::Mark(_) | Fault::NotANumber(_)), "{error}");
    let (_, error) = refused(&hub, &shroud, &profile(&blade, false, true).replacen(" te1", "", 1), &Z);
    assert!(matches!(error.fault, Fault::Marks { section: 1, mark: "te", found: 0 }), "{error}");
    let (_, error) = refused(&hub, &shroud, "# Profile 1\n1 2 3\n", &Z);
    assert!(matches!(error.fault, Fault::Sections { found: 1 }), "{error}");
    for axis in [RotorAxis::X, RotorAxis::Y] {
        let (which, error) = refused(&hub, &shroud, &good, &PointFileFrame { axis, unit_mm: 1.0 });
        assert!(matches!((which, &error.fault), (CurveFile::Hub, Fault::TurnsBack { .. })), "{error}");
        assert!(error.to_string().contains("give the rotor's `axis`"));
    }
    // Three blades in one file; the line of the third one's first point is named.
    let three = format!("## Main Blade\n{good}## Splitter Blade 1\n{good}## Splitter Blade 2\n{good}");
    let (which, error) = refused(&hub, &shroud, &three, &Z);
    assert!(matches!((which, &error.fault), (CurveFile::Profile, Fault::ThirdBlade { section: 7 })), "{error}");
    assert_eq!(error.line, 2 * good.lines().count() + 5, "{error}");
    // A hub that belongs to another rotor.
    let (which, error) = refused(&curve(700.0, [-20.0, 20.0]), &curve(990.0, [-20.0, 20.0]), &good, &Z);
    assert!(matches!((which, error.fault), (CurveFile::Profile, Fault::OffTheHub { .. })));
}
