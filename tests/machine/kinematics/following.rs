//! The feed of the tip that all axes of a machine can follow (G43.4), against closed forms and homogeneous matrices.

use arcfeed_tests::of_full_set;
use std::f64::consts::PI;

use arcfeed_kinematics::feed::AxisFeed;
use arcfeed_kinematics::forward::{Axes, Setup};
use arcfeed_kinematics::machine::{AxisName, Letter, Machine};
use arcfeed_kinematics::tip_feed::TipMove;
use arcfeed_kinematics::vector::{Vector, difference, dot, scaled};

use crate::kinematics::bench::{FILES, SETUP, machine};
use crate::kinematics::oracle;

/// Moves for each machine.
const MOVES: u64 = 2_000;
/// Places of a move that brute force looks at.
const PLACES: i32 = 4_000;
/// Largest margin of the limit below the exact value, relative.
const GIVEN_AWAY: f64 = 1e-3;

fn on_ring(radius: f64, at_deg: f64) -> Vector {
    let (sin, cos) = libm::sincos(at_deg.to_radians());
    [radius * cos, radius * sin, 40.0]
}

/// The least feed on a ring of the part about C, in chords of a degree, C turning `gear` times as far as the tip.
fn round_the_ring(machine: &Machine, radius: f64, gear: f64) -> AxisFeed {
    let chord = |at: i32| {
        let ends = [f64::from(at), f64::from(at + 1)];
        let of =
            TipMove { tip_mm: ends.map(|deg| on_ring(radius, deg)), rotary_deg: ends.map(|deg| [gear * deg, 0.0]) };
        machine.tip_feed(&of, &Setup { tool_length_mm: 80.0, ..Setup::default() }).expect("a limit")
    };
    let feeds = (0..360).map(chord);
    feeds.min_by(|one, other| one.feed_mm_per_min.total_cmp(&other.feed_mm_per_min)).expect("chords")
}

#[test]
fn a_ring_about_c_asks_of_the_axes_what_hand_reckoning_says() {
    // The UCP710: C 5400 deg/min, X and Y 20 m/min, C positive turns the tool relative to the part.
    let mikron = machine("mikron-ucp710");
    for radius in [2.0, 30.0, 100.0, 200.0] {
        // The tool stands still in the machine, the part turns under it: C alone, F = V r.
        let with_part = round_the_ring(&mikron, radius, 1.0);
        let closed = 5_400.0 * PI / 180.0 * radius;
        assert_eq!(with_part.axis, AxisName::Rotary(Letter::C));
        assert!((with_part.feed_mm_per_min / closed - 1.0).abs() < 2e-5, "{with_part:?}, {closed}");
        // The part turns against the tool at the same rate: the slides go at twice the feed, until C is faster still.
        let against = round_the_ring(&mikron, radius, -1.0);
        let (slides, closed) = (20_000.0 / 2.0, closed.min(20_000.0 / 2.0));
        println!(
            "r = {radius}: {:.1} with, {:.1} against the tool, by {}",
            with_part.feed_mm_per_min, against.feed_mm_per_min, against.axis
        );
        assert_eq!(matches!(against.axis, AxisName::Linear(_)), closed == slides);
        assert!((against.feed_mm_per_min / closed - 1.0).abs() < 1.2 * GIVEN_AWAY, "{against:?}, {closed}");
    }
}

#[test]
fn a_slide_is_fastest_where_its_axis_crosses_the_way_round() {
    // C goes 90 degrees while the tip rises by 3 mm at radius 200: X = r cos, Y = r sin, so r pi/2 is the greatest rate of both.
    let mikron = machine("mikron-ucp710");
    let of = TipMove { tip_mm: [[200.0, 0.0, 0.0], [200.0, 0.0, 3.0]], rotary_deg: [[0.0, 0.0], [90.0, 0.0]] };
    for (speeds, by, closed) in [
        ([Some(1_000.0), None, None], AxisName::Linear(0), 1_000.0 * 3.0 / (200.0 * PI / 2.0)),
        ([None, Some(500.0), Some(20.0)], AxisName::Linear(1), 500.0 * 3.0 / (200.0 * PI / 2.0)),
        ([None, None, Some(4.0)], AxisName::Linear(2), 4.0),
    ] {
        let found = mikron.with_speeds(speeds, [None; 2]).tip_feed(&of, &Setup::default()).expect("a limit");
        assert_eq!(found.axis, by);
        let ratio = found.feed_mm_per_min / closed;
        assert!(ratio <= 1.0 && ratio > 1.0 - 1.1 * GIVEN_AWAY, "{found:?}, {closed}");
    }
    assert_eq!(mikron.with_speeds([None; 3], [None; 2]).tip_feed(&of, &Setup::default()), None);
    let on_the_spot = TipMove { tip_mm: [[200.0, 0.0, 0.0]; 2], ..of };
    assert_eq!(mikron.tip_feed(&on_the_spot, &Setup::default()), None);
}

#[test]
fn round_the_published_leading_edge_the_rotary_axis_sets_the_published_feed() {
    // Tournier, section 3: 2 m/min ask 65 450 deg/min, so r = 2000 / 65450 rad.
    let radius = 2_000.0 / 65_450_f64.to_radians();
    for (file, closed, printed) in [("ferrari-rtttr", 1_628.11, 53_280.0), ("mikron-ucp710", 165.01, 5_400.0)] {
        let whole = machine(file);
        let tireless = whole.with_speeds([None; 3], [Some(printed); 2]);
        let about_x = file.starts_with("mikron");
        let edge = |deg: f64| {
            let (sin, cos) = libm::sincos(deg.to_radians());
            let out = if about_x { [0.0, -sin, cos] } else { [sin, 0.0, cos] };
            scaled(out, radius)
        };
        let ends = [4.0, 4.25];
        let of = TipMove { tip_mm: ends.map(edge), rotary_deg: ends.map(|deg| [0.0, deg]) };
        let found = tireless.tip_feed(&of, &SETUP).expect("a limit");
        let real = whole.tip_feed(&of, &SETUP).expect("a limit");
        println!(
            "{file}: {:.2} mm/min by {}, with its slides {:.2} by {}",
            found.feed_mm_per_min, found.axis, real.feed_mm_per_min, real.axis
        );
        assert!((found.feed_mm_per_min - closed).abs() < 0.006 && matches!(found.axis, AxisName::Rotary(_)));
        assert!(real.feed_mm_per_min <= found.feed_mm_per_min);
    }
}

/// X, Y, Z for a tip: a rigid chain leads each of them along a direction of its own.
fn slides(machine: &Machine, tip_mm: Vector, rotary_deg: [f64; 2]) -> Vector {
    let at = |linear_mm: Vector| oracle::forward(machine, &Axes { linear_mm, rotary_deg }, &SETUP).tip_mm;
    let origin = at([0.0; 3]);
    let wanted = difference(tip_mm, origin);
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|unit| dot(difference(at(unit), origin), wanted))
}

/// The feed at which the first axis of a move is at its fastest, by the way that each axis covers from place to place.
fn by_brute_force(machine: &Machine, of: &TipMove) -> f64 {
    let at = |place: f64| {
        let s = place / f64::from(PLACES);
        let mixed = |from: f64, to: f64| from + s * (to - from);
        let tip = [0, 1, 2].map(|axis: usize| mixed(of.tip_mm[0][axis], of.tip_mm[1][axis]));
        let rotary = [0, 1].map(|axis: usize| mixed(of.rotary_deg[0][axis], of.rotary_deg[1][axis]));
        (slides(machine, tip, rotary), rotary)
    };
    let mut longest = 0.0_f64;
    // Around each place, the ends too: a mean of one side would miss what is greatest at an end.
    let mut before = at(-0.5);
    for place in 0..=PLACES {
        let here = at(f64::from(place) + 0.5);
        for (axis, slide) in machine.linear().iter().enumerate() {
            let covered = (here.0[axis] - before.0[axis]).abs();
            longest = longest.max(covered / slide.speed_mm_per_min.unwrap_or(f64::INFINITY));
        }
        for (axis, turning) in machine.rotary().iter().enumerate() {
            let covered = (here.1[axis] - before.1[axis]).abs();
            longest = longest.max(covered / turning.speed_deg_per_min.unwrap_or(f64::INFINITY));
        }
        before = here;
    }
    of.way_mm() / (longest * f64::from(PLACES))
}

#[test]
fn tip_feed_is_never_above_the_brute_force_limit_and_hardly_below() {
    for file in FILES {
        let machine = machine(file);
        let mut random = fastrand::Rng::with_seed(7);
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for _ in 0..of_full_set(MOVES, 60) {
            let mut somewhere = |by: f64| (random.f64() - 0.5) * 2.0 * by;
            let from = [(); 3].map(|()| somewhere(300.0));
            let reach = somewhere(1.0).abs().powi(3) * 200.0;
            let to = from.map(|at| at + somewhere(reach));
            let turn = somewhere(1.0).powi(3) * 400.0;
            let start = [somewhere(180.0), somewhere(90.0)];
            let end = [start[0] + turn, start[1] + somewhere(turn.abs())];
            let of = TipMove { tip_mm: [from, to], rotary_deg: [start, end] };
            let found = machine.tip_feed(&of, &SETUP).expect("a limit").feed_mm_per_min;
            let ratio = found / by_brute_force(&machine, &of);
            (least, most) = (least.min(ratio), most.max(ratio));
        }
        println!("{file}: {least:.6} to {most:.6} of what brute force finds");
        // Brute force sees means over a four-thousandth of the move.
        assert!(most < 1.0 + 1e-5 && least > 1.0 - 1.01 * GIVEN_AWAY, "{least} to {most}");
    }
}
