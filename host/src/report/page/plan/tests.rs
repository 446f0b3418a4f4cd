use arcfeed_nc::modal::Turn;
use arcfeed_plan::output::baseline::planned_time;
use arcfeed_plan::path::Level;
use arcfeed_plan::vector::Flat;

use super::*;

fn report() -> PlanReport {
    let level =
        |height_mm| Level { height_mm, exterior_end: Flat::new(0.0, -20.0), interior_end: Flat::new(10.0, 10.0) };
    let path = SlotPath {
        exterior: Flat::new(0.0, -10.0),
        interior: Flat::new(0.0, 10.0),
        base: Flat::new(0.0, 0.0),
        outward: Turn::Ccw,
        levels: vec![level(-1.0), level(-3.0)],
        clear_mm: 4.0,
        contact_mm: 0.0,
    };
    let planned = planned_time(&path, |_| 100.0, 5_000.0);
    PlanReport {
        name: "a <blisk>".into(),
        unit: LengthUnit::Mm,
        verdict: PlanVerdict { is_safe: false, sentences: vec!["the holder touches a blade".into()] },
        axis: Axis { direction: [1.0, 0.0, 0.0], tilt_deg: 0.0, first_deg: 85.0, slots: 19 },
        mill: CupMill {
            outer_radius_mm: 10.0,
            inner_radius_mm: 8.0,
            insert_radius_mm: 0.8,
            cavity_depth_mm: 40.0,
            height_mm: 60.0,
            holder_mm: Vec::new(),
            active_teeth: 10,
        },
        path,
        stops: vec![Stops { exterior: "outer torus at the pressure side".into(), ..Stops::default() }],
        limits: Vec::new(),
        times: Times { planned, baseline: Err("no ball <passes>".into()) },
        clearances: vec![Clearance {
            part: "ring".into(),
            obstacle: "blade 2".into(),
            certified_mm: 0.889,
            found_mm: 0.8896,
            place: "level 3, movement 2".into(),
        }],
        removed: Some(Removed { available_mm3: 8_000.0, removed_mm3: 6_000.0, levels_mm3: vec![4_000.0, 2_000.0] }),
        left: vec![LeftMap {
            surface: "pressure side".into(),
            sides: ["leading edge", "trailing edge", "hub", "tip"].map(String::from),
            columns: 2,
            values_mm: vec![Some(0.0), Some(0.5), None, Some(1.0)],
        }],
        outlines: vec![Outline { name: "pressure side".into(), points_mm: vec![[0.0, -12.0], [3.0, 4.0]] }],
    }
}

#[test]
fn the_page_has_every_section_and_needs_no_other_file() {
    let html = report().page().to_string();
    let headings = [
        "Verdict",
        "Tool and part",
        "Seen along the tool",
        "Levels",
        "Movements and stock",
        "Time",
        "Clearances",
        "Removed",
        "Left",
    ];
    for heading in headings {
        assert!(html.contains(&format!("<h2>{heading}</h2>")), "{heading}");
    }
    assert!(!html.contains("src=") && !html.contains("href=\"http"), "{html}");
    assert!(html.contains("<p class=\"warning\">the holder touches a blade</p>"));
    assert!(html.contains("Plan: a &lt;blisk&gt;") && html.contains("no ball &lt;passes&gt;"));
    assert!(html.contains("<td>ring from blade 2</td><td>0.889</td><td>0.890</td>"));
    assert!(html.contains("75.0 % of the slot: 6.000 of 8.000 cm3"));
    // A turn about B1 by a quarter.
    assert!(html.contains("<td>90.00</td>"), "{html}");
}

#[test]
fn tags_close() {
    let html = report().page().to_string();
    for tag in ["table", "tr", "td", "th", "svg", "p", "h3", "text", "polyline", "title"] {
        let open = html.matches(&format!("<{tag}>")).count() + html.matches(&format!("<{tag} ")).count();
        assert_eq!(open, html.matches(&format!("</{tag}>")).count(), "{tag}");
    }
}

#[test]
fn an_arc_is_drawn_in_its_sense() {
    let picture = picture::slot(&report());
    // From C counter-clockwise about B1, which lies above it: to the right and up, on the screen without the flag.
    assert!(picture.contains(" 0 0 0 605.68 37.50"), "{picture}");
    assert!(!picture.contains(" 0 1 0 ") && !picture.contains(" 0 1 1 "), "no long arc: {picture}");
}
