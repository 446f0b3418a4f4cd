//! Tournier, section 3: 2 m/min round a leading edge ask 65 450 deg/min of a rotary axis.

use arcfeed_kinematics::feed::AxisFeed;
use arcfeed_kinematics::forward::{Axes, ToolPose};
use arcfeed_kinematics::machine::{AxisName, Letter, LinearAxis, Machine};

use crate::kinematics::bench::{SETUP, machine};

const PROGRAMMED: f64 = 2_000.0;
const ASKED: f64 = 65_450.0;

/// The least feed that the axes allow along a circle of `radius`, the tool axis square to it, turning about `letter`.
fn least_feed(machine: &Machine, letter: Letter, radius: f64) -> AxisFeed {
    let point = |step: i32| {
        let (sin, cos) = libm::sincos((f64::from(step) * 0.25).to_radians());
        let out = if letter == Letter::A { [0.0, sin, cos] } else { [sin, 0.0, cos] };
        ToolPose { tip_mm: out.map(|component| component * radius), axis: out }
    };
    let poses: Vec<ToolPose> = (4..=100).map(point).collect();
    let course = machine.select_branches(&poses, None).expect("within reach");
    let axes: Vec<Axes> = poses
        .iter()
        .zip(&course)
        .map(|(pose, at)| Axes { linear_mm: machine.linear_for(pose.tip_mm, *at, &SETUP), rotary_deg: *at })
        .collect();
    let arc = radius * 0.25_f64.to_radians();
    let feeds = axes.windows(2).map(|pair| machine.axis_feed(&pair[0], &pair[1], arc).expect("a limit"));
    feeds.min_by(|one, other| one.feed_mm_per_min.total_cmp(&other.feed_mm_per_min)).expect("moves")
}

/// The machine with linear axes that follow whatever the rotary ones do, as the paper reckons.
fn with_tireless_slides(machine: &Machine) -> Machine {
    let linear = machine.linear().each_ref().map(|axis| LinearAxis { speed_mm_per_min: None, ..*axis });
    Machine::new(*machine.rotary(), linear, machine.tool()).expect("still a machine")
}

#[test]
fn the_feed_that_each_machine_reaches_is_that_of_the_closed_form() {
    let radius = PROGRAMMED / ASKED.to_radians();
    println!("{ASKED} deg/min at {PROGRAMMED} mm/min: an edge of radius {radius:.4} mm");
    assert!((radius - 1.751).abs() < 5e-4);
    for (file, letter, limit, printed) in
        [("ferrari-rtttr", Letter::B, 53_280.0, 1_628.1), ("mikron-ucp710", Letter::A, 5_400.0, 165.0)]
    {
        let closed = PROGRAMMED * limit / ASKED;
        let whole = machine(file);
        let tireless = with_tireless_slides(&whole);
        let AxisFeed { feed_mm_per_min: found, axis } = least_feed(&tireless, letter, radius);
        let real = least_feed(&whole, letter, radius);
        println!(
            "{file}: {letter} at {limit} deg/min allows {found:.2} mm/min, closed form V r = {closed:.2}; with the file's linear \
             axes {:.2}, set by {}",
            real.feed_mm_per_min, real.axis
        );
        assert_eq!(axis, AxisName::Rotary(letter));
        assert!((found / closed - 1.0).abs() < 1e-9 && (closed - printed).abs() < 0.06);
        assert!(real.feed_mm_per_min <= found);
        let wider = least_feed(&tireless, letter, 10.0 * radius);
        assert!((wider.feed_mm_per_min / found - 10.0).abs() < 1e-6);
    }
}

#[test]
fn a_long_way_from_pivot_to_tip_is_the_slides_to_go() {
    // About B the gauge point runs on a circle of pivot, tool and edge: where it moves along X or Z alone, that axis sets the feed.
    let ferrari = machine("ferrari-rtttr");
    let [_, head] = ferrari.rotary();
    let radius = PROGRAMMED / ASKED.to_radians();
    let arm = head.point_mm[2] + SETUP.tool_length_mm + radius;
    let speed = ferrari.linear()[0].speed_mm_per_min.expect("a limit");
    // The steepest of the moves looked at is the first, half way from 1 to 1.25 degrees.
    let closed = speed * radius / (arm * libm::cos(1.125_f64.to_radians()));
    let found = least_feed(&ferrari, Letter::B, radius);
    println!(
        "an arm of {arm:.1} mm: {:.3} mm/min set by {}, closed form {closed:.3}",
        found.feed_mm_per_min, found.axis
    );
    assert_eq!(found.axis, AxisName::Linear(0));
    assert!((found.feed_mm_per_min / closed - 1.0).abs() < 1e-5);
}
