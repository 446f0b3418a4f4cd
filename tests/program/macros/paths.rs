//! Paths of macro programs against their closed forms.

use std::f64::consts::{PI, TAU};

use arcfeed_nc::segment::Path;

use crate::macros::run::{corpus, run};

/// Half of the least increment, mm: what rounding a word may change.
const ROUNDING_MM: f64 = 0.000_5 + 1e-9;

#[test]
fn the_holes_of_a_bolt_circle_lie_on_it() {
    let run = run(&corpus("bolt-circle.nc"));
    assert!(run.ended.is_ok(), "{:?}", run.ended);
    let ends = run.ends_mm();
    assert_eq!(ends.len(), 7);
    for (hole, [x, y, _]) in ends.into_iter().enumerate() {
        let angle = (12.5 / 180.0) * PI + TAU * hole as f64 / 7.0;
        let (sin, cos) = libm::sincos(angle);
        assert!((x - (10.0 + 40.0 * cos)).abs() <= ROUNDING_MM, "hole {hole}: X{x}");
        assert!((y - (-5.0 + 40.0 * sin)).abs() <= ROUNDING_MM, "hole {hole}: Y{y}");
    }
}

#[test]
fn every_turn_of_a_thread_is_a_full_helix_of_its_pitch() {
    let run = run(&corpus("thread-mill.nc"));
    assert!(run.ended.is_ok(), "{:?}", run.ended);
    let helices: Vec<_> = run.moves.iter().filter_map(|(_, segment)| Some((segment, segment.arc()?))).collect();
    assert_eq!(helices.len(), 6);
    for (turn, (segment, arc)) in helices.into_iter().enumerate() {
        assert_eq!((segment.rise().to_mm(), arc.radius_mm(), arc.sweep_rad()), (-2.5, 4.0, TAU));
        assert_eq!(segment.end.linear[2].to_mm(), 2.0 - 2.5 * (turn + 1) as f64);
        // Unrolled, a turn is the hypotenuse of circumference and pitch.
        let wanted = libm::sqrt((8.0 * PI) * (8.0 * PI) + 2.5 * 2.5);
        assert!((segment.length_mm() - wanted).abs() < 1e-9);
    }
    let (place, last) = run.moves.last().expect("moves");
    assert_eq!((last.path, place.line), (Path::Rapid, 14));
}

#[test]
fn a_block_of_a_macro_knows_its_line_and_its_call() {
    let run = run(&corpus("bolt-circle.nc"));
    assert!(run.moves.iter().all(|(place, _)| place.line == 10 && place.library.is_none()));
}

#[test]
fn printed_positions_are_those_of_the_axes() {
    let run = run(&corpus("probing.nc"));
    assert!(run.ended.is_ok(), "{:?}", run.ended);
    let lines =
        ["HOLE  1 X    10.000 Y-   12.346", "HOLE  2 X    20.000 Y-   12.346", "HOLE  3 X    30.000 Y-   12.346"];
    let wanted = format!("\u{12}{}\n\u{14}", lines.join("\n"));
    assert_eq!(String::from_utf8(run.output).expect("ASCII"), wanted);
    assert_eq!(run.messages, ["CHECK THE BORE"]);
}
