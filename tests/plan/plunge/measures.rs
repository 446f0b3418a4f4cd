//! Twist, bend, depth, width, and reach.

use arcfeed_plan::geometry::generator::{Hand, Rotor};
use arcfeed_plan::plunge::machinability::{SideMeasures, camber_point, widths};
use arcfeed_plan::plunge::measure::{ChordAngles, CurveJet, CurveShape};
use arcfeed_plan::plunge::reach::UprightSlot;
use arcfeed_plan::vector::{Point, Vector};

use super::table::{Row, Worst, rows};
use crate::published_rotor;

/// Point of a curve with its two derivatives at a parameter.
type Curve = Box<dyn Fn(f64) -> [[f64; 2]; 3]>;

/// Curve of a row, before its rotation, and the range of its parameter.
fn curve(row: &Row<'_>) -> (Curve, [f64; 2]) {
    let [p1, p2, p3, p4] = row.numbers(["p1", "p2", "p3", "p4"]);
    match row.word("kind") {
        // Chord p1 along x, turning p2.
        "arc" => {
            let radius = p1 / 2.0 / libm::sin(p2 / 2.0);
            let arc = move |t: f64| {
                let (sin, cos) = libm::sincos(t);
                let point = [radius * sin, radius * (cos - libm::cos(p2 / 2.0))];
                [point, [radius * cos, -radius * sin], [-radius * sin, -radius * cos]]
            };
            (Box::new(arc), [-p2 / 2.0, p2 / 2.0])
        }
        "parabola" => {
            let parabola = move |x: f64| {
                let scale = 4.0 * p2 / p1;
                [[x, scale * x * (1.0 - x / p1)], [1.0, scale * (1.0 - 2.0 * x / p1)], [0.0, -2.0 * scale / p1]]
            };
            (Box::new(parabola), [0.0, p1])
        }
        "hyperbola" => {
            let hyperbola = move |x: f64| {
                let root = libm::sqrt(p2 * p2 + x * x);
                [[x, -p1 * root], [1.0, -p1 * x / root], [0.0, -p1 * p2 * p2 / (root * root * root)]]
            };
            (Box::new(hyperbola), [-p3, p4])
        }
        other => panic!("{other}"),
    }
}

#[test]
fn point_1_twist_and_bend_of_curves_are_their_closed_forms() {
    let mut worst = Worst::default();
    for row in rows(include_str!("data/an_twist_bend_curves.csv")) {
        let (curve, range) = curve(&row);
        let (sin, cos) = libm::sincos(row.number("rotated_rad"));
        // The file's axis is x; ours is z.
        let turned = |[x, y]: [f64; 2]| Vector::new(sin * x + cos * y, 0.0, cos * x - sin * y);
        let shape = CurveShape::new(range, |t| {
            let [point, first, second] = curve(t).map(turned);
            CurveJet { point: Point::from(point), first, second }
        });
        let angles = shape.angles(&shape.split());
        let [phi, phi2, twist, psi, sag] = row.numbers(["phi_deg", "phi2_deg", "twist_deg", "psi_deg", "sag"]);
        for (kind, found, expected) in [
            ("phi", angles.to_axis_rad[0].to_degrees(), phi),
            ("phi'", angles.to_axis_rad[1].to_degrees(), phi2),
            ("twist", angles.twist_rad().to_degrees(), twist),
            ("psi", angles.bend_rad.to_degrees(), psi),
            // The file's sag is that of its P_m.
            ("sag", shape.off_chord_mm(&shape.split()), sag),
        ] {
            worst.relative(kind, found, expected);
        }
        assert!(shape.sag_mm >= sag - 1e-9);
        match row.word("kind") {
            "arc" => assert_eq!(shape.by_curvature, None, "an arc has no point of greatest curvature"),
            "hyperbola" => assert!(shape.by_curvature.is_some(), "{}", row.word("case")),
            _ => {}
        }
    }
    let limits = ["phi", "phi'", "twist", "psi", "sag"].map(|kind| (kind, 1e-6));
    worst.within("an_twist_bend_curves", &limits);
}

#[test]
fn point_1_twist_of_generated_camber_lines_is_the_other_programs() {
    let mut worst = Worst::default();
    for row in rows(include_str!("data/an_twist_rotor_section.csv")) {
        let [radius_mm, chord_mm, stagger_deg, camber_deg] =
            row.numbers(["R_mm", "chord_mm", "stagger_deg", "camber_deg"]);
        let rotor = Rotor {
            blades: 11,
            hub_radius_mm: radius_mm,
            tip_radius_mm: radius_mm + 10.0,
            chord_mm: [chord_mm; 2],
            stagger_deg: [stagger_deg; 2],
            camber_deg: [camber_deg; 2],
            thickness_ratio: [0.06; 2],
            edge_mm: 0.0,
            lean_deg: 0.0,
            hand: Hand::Right,
        };
        let sections = rotor.sections(2, 81).unwrap();
        let at = |index: usize| camber_point(&sections.pressure[0][index], &sections.suction[0][index]);
        let angles = ChordAngles::new(&at(0), &at(40), &at(80));
        for (kind, found, column) in [
            ("phi", angles.to_axis_rad[0], "phi_deg"),
            ("phi'", angles.to_axis_rad[1], "phi2_deg"),
            ("twist", angles.twist_rad(), "twist_deg"),
        ] {
            worst.absolute(kind, found.to_degrees(), row.number(column));
        }
        let flat_deg = stagger_deg.abs() + camber_deg / 4.0;
        worst.absolute("unrolled", flat_deg, row.number("flat_closed_form_deg"));
    }
    worst.within("an_twist_rotor_section", &["phi", "phi'", "twist", "unrolled"].map(|kind| (kind, 1e-6)));
}

#[test]
fn measures_of_the_blisk_are_the_other_programs() {
    let blisk = published_rotor::blisk();
    let range = [0.05, 0.95];
    let mut worst = Worst::default();
    for row in rows(include_str!("data/an_rotor_measures.csv")) {
        let [a, b, c] = row.numbers(["a", "b", "c"]);
        if let Some(k) = row.word("what").strip_prefix("width k=") {
            let across = blisk.blade(k.parse().unwrap());
            let found = widths(&blisk.pressure, &across.suction, [0.0, 1.0]);
            worst.absolute("width", found.corresponding_mm[0], a);
            worst.absolute("width", found.corresponding_mm[1], b);
            worst.absolute("free width", found.free_mm, c);
        } else {
            let face = if row.word("what") == "PS" { &blisk.pressure } else { &blisk.suction };
            let found = SideMeasures::new(face, range);
            worst.absolute("twist, deg", found.twist_rad[1].to_degrees(), a);
            worst.absolute("bend, deg", found.bend_rad[1].to_degrees(), b);
            worst.absolute("sag", found.sag_mm, c);
            worst.absolute("depth", found.depth_mm, row.number("d"));
        }
    }
    // The file's P_m is a sample; its widths are those of samples.
    let limits = [
        ("twist, deg", 0.01),
        ("bend, deg", 1e-5),
        ("sag", 1e-6),
        ("depth", 1e-6),
        ("width", 5e-4),
        ("free width", 1e-5),
    ];
    worst.within("an_rotor_measures", &limits);
}

#[test]
fn point_1_reach_between_upright_walls_is_the_closed_form() {
    let mut worst = Worst::default();
    for row in rows(include_str!("data/an_reach_slot.csv")) {
        let [width_mm, height_mm, radius_mm, x_mm, y_mm] =
            row.numbers(["width_mm", "height_mm", "R_mm", "x_mm", "y_mm"]);
        let [least, most] = UprightSlot { width_mm, height_mm }.tilts_rad(radius_mm, [x_mm, y_mm]).unwrap();
        worst.relative("tilt", least.to_degrees(), row.number("tilt_min_deg"));
        worst.relative("tilt", most.to_degrees(), row.number("tilt_max_deg"));
    }
    worst.within("an_reach_slot", &[("tilt", 1e-6)]);
}
