use arcfeed_nc::reader::Reader;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_nc::settings::{Preset, Reading, Scope, Settings, Tables};

use super::*;
use crate::path::Level;

/// Ring of 128 and 112 mm about A and B1, four levels.
fn path() -> SlotPath {
    let on = |center: Flat, radius_mm: f64, angle_deg: f64| {
        let (sin, cos) = libm::sincos(angle_deg.to_radians());
        Flat::new(center.x + radius_mm * cos, center.y + radius_mm * sin)
    };
    let base = Flat::new(-91.552_34, 267.609_17);
    let (exterior, interior) = (on(base, 128.0, -37.0), on(base, 112.0, -29.7));
    let level = |index: i32| {
        let turn_deg = f64::from(index);
        Level {
            height_mm: -693.1 - 2.38 * turn_deg,
            exterior_end: on(exterior, 128.0, 143.0 - 16.0 + turn_deg),
            interior_end: on(interior, 112.0, 150.3 - 17.0 + turn_deg),
        }
    };
    let levels = (0..4).map(level).collect();
    let (clear_mm, contact_mm) = (-680.0, -692.3);
    SlotPath { exterior, interior, base, outward: Turn::Cw, levels, clear_mm, contact_mm }
}

fn setup() -> Setup {
    Setup {
        number: 1546,
        title: vec!["one slot".into()],
        unit: LengthUnit::Mm,
        tool: 14,
        rev_per_min: 1_000.0,
        coolant: true,
        tilt_deg: 0.0,
        slots_deg: vec![85.0, 85.0 + 360.0 / 19.0],
        feeds: Feeds {
            cutting_mm_per_min: 635.0,
            approach_mm_per_min: Some(2_540.0),
            axial_mm_per_min: Some(254.0),
            indexing_per_min: 50.0,
        },
        indexing: Indexing::AtClearance,
        labels: true,
        reports: false,
    }
}

/// Segments that a control reads from the program.
fn segments(text: &str, unit: LengthUnit) -> Vec<Segment> {
    let settings = Settings { scope: Scope::Everything, ..Settings::preset(Preset::Fanuc16i, unit, Reading::Strict) };
    let mut reader = Reader::with(settings, Tables::default());
    let understood = text.lines().map(|line| match reader.read(line.as_bytes()) {
        Ok(understood) => understood.segment,
        Err(fault) => panic!("{line}: {fault:?}"),
    });
    understood.flatten().collect()
}

#[test]
fn a_control_reads_the_way_that_was_planned() {
    for unit in [LengthUnit::Inch, LengthUnit::Mm] {
        let text = write(&path(), &Setup { unit, ..setup() }).unwrap();
        let wanted: Vec<Step> = path().steps().into_iter().filter(|step| step.about.is_some()).collect();
        let arcs: Vec<Segment> = segments(&text, unit).into_iter().filter(|segment| segment.arc().is_some()).collect();
        assert_eq!(arcs.len(), 2 * wanted.len());
        let step_mm = Format { unit }.step().to_mm();
        for (segment, step) in arcs.iter().zip(wanted.iter().cycle()) {
            let Path::Arc(arc) = segment.path else { panic!("an arc") };
            assert_eq!(Some(arc.turn), step.about.map(|(_, turn)| turn));
            assert!((arc.sweep_rad() - step.sweep_rad()).abs() < 2.0 * step_mm / arc.radius_mm());
            for axis in 0..3 {
                assert!((segment.end.linear[axis].to_mm() - step.to[axis]).abs() <= 0.501 * step_mm);
            }
        }
    }
}

#[test]
fn start_and_end_radius_agree_within_one_and_a_half_steps() {
    for unit in [LengthUnit::Inch, LengthUnit::Mm] {
        let text = write(&path(), &Setup { unit, ..setup() }).unwrap();
        let step_mm = Format { unit }.step().to_mm();
        let segments = segments(&text, unit);
        let off_mm = segments.iter().filter_map(Segment::arc).map(|arc| {
            let [from, to] = [arc.from, arc.to].map(|[x, y]| libm::hypot(x.to_mm(), y.to_mm()));
            (from - to).abs()
        });
        let most_mm = off_mm.fold(0.0, f64::max);
        println!("{unit:?}: radii differ by {:.5} mm at most", most_mm);
        assert!(most_mm <= 1.5 * step_mm);
    }
}

#[test]
fn the_rotor_stands_before_the_tool_goes_down() {
    let text = write(&path(), &setup()).unwrap();
    assert!(text.contains("G93X-91.552Y267.609B103.947F50.\n"), "{text}");
    assert!(text.contains("G94Z-690.3F2540.\n") && text.contains("Z-693.1F254.\n"), "{text}");
    assert_eq!(text.matches('B').count(), 2);
    let together = SlotPath { contact_mm: f64::MIN, ..path() };
    let together = write(&together, &Setup { indexing: Indexing::WhileDescending, ..setup() }).unwrap();
    assert!(together.contains("G93G1X-91.552Y267.609Z-693.1B85.F50.\n"), "{together}");
}

#[test]
fn above_the_blank_the_way_down_goes_on_at_the_feed_of_the_links() {
    let below = SlotPath { contact_mm: -700.0, ..path() };
    let text = write(&below, &setup()).unwrap();
    assert!(text.contains("G94Z-693.1F2540.\n"), "no blank above the first level: {text}");
    // The rotor is indexed even where the clearance leaves no approach.
    let near = SlotPath { contact_mm: -681.0, ..path() };
    let text = write(&near, &setup()).unwrap();
    assert!(text.contains("B103.947F50.\n") && text.contains("G94Z-693.1F254.\n"), "{text}");
}

#[test]
fn an_arc_too_short_to_have_a_direction_is_left_out() {
    let mut short = path();
    for (turn_rad, is_there) in [(1e-5, false), (0.1, true)] {
        let arm = nalgebra::Rotation2::new(-turn_rad) * (short.base - short.exterior);
        short.levels[1].exterior_end = short.exterior + arm;
        let text = write(&short, &setup()).unwrap();
        assert_eq!(text.contains("(LEVEL 2 MOVEMENT 2)"), is_there, "{text}");
        assert!(segments(&text, LengthUnit::Mm).iter().filter_map(Segment::arc).all(|arc| arc.sweep_rad() < 1.0));
    }
}

#[test]
fn reports_name_slot_level_and_height() {
    let text = write(&path(), &Setup { reports: true, ..setup() }).unwrap();
    assert!(text.contains("POPEN\nDPRNT[SLOT*2*LEVEL*4*Z#5003[43]]\nPCLOS\n"), "{text}");
    assert_eq!(text.matches("DPRNT").count(), 8);
}

#[test]
fn what_cannot_be_written_is_refused() {
    let bad = |setup: Setup| write(&path(), &setup).unwrap_err();
    assert_eq!(bad(Setup { number: 0, ..setup() }), NcError::Number(0));
    assert_eq!(bad(Setup { slots_deg: Vec::new(), ..setup() }), NcError::Empty);
    assert_eq!(bad(Setup { tilt_deg: f64::NAN, ..setup() }), NcError::NotANumber);
    let feeds = Feeds { axial_mm_per_min: Some(0.0), ..setup().feeds };
    assert_eq!(bad(Setup { feeds, ..setup() }), NcError::NotANumber);
}
