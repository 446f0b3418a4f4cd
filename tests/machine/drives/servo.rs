//! Axes that lag behind their commands, against closed forms and a published circle.

use arcfeed_control::drives::limits::AXES;
use arcfeed_control::drives::servo::{AxisServo, PositionLoops, Servo};
use arcfeed_control::{Control, ControlSettings, Preset};
use arcfeed_units::{LengthUnit, Micros};

use crate::drives::motion::{STEP, drives, settings};

/// Rounding error of the closed forms.
const EXACT: f64 = 1e-9;
pub const WIDTH_MM: f64 = 0.01;

pub fn axis(gain_per_s: f64, feed_forward_ratio: f64) -> AxisServo {
    AxisServo { gain_per_s, feed_forward_ratio, in_position_mm: WIDTH_MM }
}

/// Gains of X and Y; the other axes as X.
fn unequal(x: f64, y: f64) -> Servo {
    let mut servo = Servo::of_all(axis(x, 0.0));
    servo.axes[1] = axis(y, 0.0);
    servo
}

/// A control whose commands are known exactly: speed constant along the path but for its ends.
pub fn with_servo(servo: Servo) -> ControlSettings {
    let settings = Preset::Fanuc31i.settings(LengthUnit::Mm);
    ControlSettings { servo: Some(servo), operator_restart: None, ..settings }
}

/// Commanded and actual positions of a program, a millisecond apart.
fn followed(program: &str, settings: ControlSettings) -> Vec<[[f64; AXES]; 2]> {
    let mut control = Control::from_memory(settings, format!("{program}\nM30\n").as_bytes());
    let (mut at, mut now) = (Vec::new(), Micros(0));
    while !(control.is_over() && control.is_in_position()) {
        now = now.after(STEP);
        control.step(now, STEP, 100);
        at.push([*control.axes(), control.actual_axes()]);
        assert!(now < Micros::from_ms(600_000), "{program}");
    }
    assert_eq!(control.alarm(), None, "{program}");
    at
}

/// The second half of several turns, as vectors from the centre at X0 Y0.
fn settled_circle(radius_mm: f64, feed: f64, servo: Servo) -> Vec<[f64; 2]> {
    let turn = format!("G3I-{radius_mm:.3}F{feed}\n");
    let at = followed(&format!("G1X{radius_mm:.3}F600\n{}", turn.repeat(8)), with_servo(servo));
    let period_ms = std::f64::consts::TAU * radius_mm / feed * 60_000.0;
    let last = at.len() - (1.5 * period_ms) as usize;
    at[last - 4 * period_ms as usize..last].iter().map(|[_, [x, y, ..]]| [*x, *y]).collect()
}

#[test]
fn on_a_ramp_each_axis_lags_by_its_speed_over_its_gain() {
    let gains = [20.0, 30.0, 40.0, 50.0, 60.0, 80.0];
    for feed_forward in [0.0, 0.5, 0.97, 1.0] {
        let servo = Servo { axes: gains.map(|gain| axis(gain, feed_forward)) };
        let at = followed("G1X60.Y-80.Z24.A10.B20.C-30.F1500", with_servo(servo));
        let [before, after] = [at[at.len() / 2 - 1][0], at[at.len() / 2][0]];
        let actual = at[at.len() / 2][1];
        for (index, gain) in gains.into_iter().enumerate() {
            let speed = (after[index] - before[index]) / STEP.to_s();
            let lag = (1.0 - feed_forward) * speed / gain;
            assert!((after[index] - actual[index] - lag).abs() < EXACT, "axis {index} with {feed_forward}");
            assert!(speed.abs() > 1.0);
        }
    }
}

#[test]
fn behind_a_stop_the_lag_dies_away_exponentially_until_in_position() {
    let gain = 30.0;
    let at = followed("G1X50.F1500", with_servo(Servo::of_all(axis(gain, 0.0))));
    let stop = at.iter().position(|[commanded, _]| commanded[0] == 50.0).expect("it gets there");
    let lag = |index: usize| 50.0 - at[index][1][0];
    for index in stop..at.len() {
        let expected = lag(stop) * libm::exp(-gain * (index - stop) as f64 * STEP.to_s());
        assert!((lag(index) - expected).abs() < EXACT, "{} ms behind the stop", index - stop);
    }
    let settles_ms = libm::ceil(libm::log(lag(stop) / WIDTH_MM) / gain / STEP.to_s());
    println!("{:.4} mm behind at the stop, in position after {settles_ms} ms", lag(stop));
    assert_eq!((at.len() - 1 - stop) as f64, settles_ms);
}

/// The command is a polygon in the circle, inside it by up to r (w T)^2/8; a loop passes that on, but no more of it.
#[test]
fn circles_shrink_as_their_speed_and_the_gain_say() {
    for (radius_mm, feed) in [(5.0, 3_000.0), (5.0, 600.0), (40.0, 3_000.0), (120.0, 6_000.0)] {
        for (gain, feed_forward) in [(20.0, 0.0), (30.0, 0.0), (50.0, 0.0), (30.0, 0.7), (30.0, 1.0)] {
            let turns = feed / 60.0 / radius_mm;
            let square = |value: f64| value * value;
            let ratio = (1.0 + square(feed_forward * turns / gain)) / (1.0 + square(turns / gain));
            let expected = radius_mm * libm::sqrt(ratio);
            let sagitta = radius_mm * square(turns * STEP.to_s()) / 8.0;
            for [x, y] in settled_circle(radius_mm, feed, Servo::of_all(axis(gain, feed_forward))) {
                let radius = libm::hypot(x, y);
                assert!(
                    (radius - expected).abs() < sagitta + EXACT,
                    "{radius} mm, not {expected} mm: r {radius_mm}, F{feed}, {gain}/s, {feed_forward}"
                );
            }
        }
    }
}

/// A machining centre with a Fanuc 10M made holes of 9.5 mm with G3 I-5 at F3000, of 10.00 mm at F100, and round ones
/// (industrialmonitordirect.com, "Resolving Fanuc 10M circle size errors caused by servo lag"). Its gain is not published: 30/s is
/// what parameter 1825 usually has.
#[test]
fn with_the_usual_gain_a_published_circle_has_its_published_size() {
    for (feed, published) in [(3_000.0, "9.5"), (100.0, "10.0")] {
        let circle = settled_circle(5.0, feed, Servo::of_all(axis(30.0, 0.0)));
        let diameters = circle.iter().map(|[x, y]| 2.0 * libm::hypot(*x, *y));
        let [least, most] = [diameters.clone().fold(f64::INFINITY, f64::min), diameters.fold(0.0, f64::max)];
        println!("F{feed}: {least:.4} to {most:.4} mm, published {published} mm");
        assert_eq!((format!("{least:.1}"), format!("{most:.1}")), (published.into(), published.into()));
        assert!(most - least < 1e-3, "not round");
    }
}

/// An axis with gain K is smaller by cos and later by the angle atan(w/K). The squares of both semi-axes and their product
/// are those of the matrix that makes the ellipse of the circle.
#[test]
fn unequal_gains_make_an_ellipse_of_known_size_and_tilt() {
    let (radius_mm, feed, gains) = (20.0, 3_000.0, [30.0, 36.0]);
    let turns = feed / 60.0 / radius_mm;
    let [late_x, late_y] = gains.map(|gain| libm::atan(turns / gain));
    let [a, b] = [late_x, late_y].map(|late| radius_mm * libm::cos(late));
    let (sum, product) = (a * a + b * b, a * b * libm::cos(late_x - late_y));
    let [major, minor] =
        [1.0, -1.0].map(|sign| (libm::sqrt(sum + 2.0 * product) + sign * libm::sqrt(sum - 2.0 * product)) / 2.0);
    let tilt_deg = libm::atan2(2.0 * a * b * libm::sin(late_x - late_y), a * a - b * b).to_degrees() / 2.0;

    let circle = settled_circle(radius_mm, feed, unequal(gains[0], gains[1]));
    let length = |at: &&[f64; 2]| libm::hypot(at[0], at[1]);
    let far = circle.iter().max_by(|one, other| length(one).total_cmp(&length(other))).expect("a circle");
    let least = circle.iter().map(|at| length(&at)).fold(f64::INFINITY, f64::min);
    let direction_deg = libm::atan(far[1] / far[0]).to_degrees();
    println!("{:.5} x {least:.5} mm at {direction_deg:.2}, {major:.5} x {minor:.5} at {tilt_deg:.2}", length(&far));
    let sagitta = radius_mm * turns * turns * STEP.to_s() * STEP.to_s() / 8.0;
    assert!((length(&far) - major).abs() < sagitta && (least - minor).abs() < sagitta);
    // Sampled every w T, the far point is known to half of that.
    assert!((direction_deg - tilt_deg).abs() < (turns * STEP.to_s() / 2.0).to_degrees() + 0.02);
    assert!(major - minor > 100.0 * sagitta, "hardly an ellipse");
}

#[test]
fn a_straight_line_stays_straight_with_equal_gains_only() {
    for (gains, angle_deg) in
        [([30.0, 30.0], 30.0_f64), ([30.0, 33.0], 45.0), ([30.0, 40.0], 20.0), ([40.0, 30.0], 70.0)]
    {
        let (sin, cos) = (libm::sin(angle_deg.to_radians()), libm::cos(angle_deg.to_radians()));
        let program = format!("G1X{:.6}Y{:.6}F3000", 100.0 * cos, 100.0 * sin);
        let at = followed(&program, with_servo(unequal(gains[0], gains[1])));
        let off = |[x, y]: [f64; 2]| y * cos - x * sin;
        let half = off([at[at.len() / 2][1][0], at[at.len() / 2][1][1]]);
        let expected = 50.0 * (1.0 / gains[0] - 1.0 / gains[1]) * libm::sin(2.0 * angle_deg.to_radians()) / 2.0;
        println!("gains {gains:?} at {angle_deg} degrees: {half:.6} mm off the line, {expected:.6}");
        // The ends of the line are written to a nanometre.
        assert!((half - expected).abs() < 2e-6);
        let most = at.iter().map(|[_, [x, y, ..]]| off([*x, *y]).abs()).fold(0.0, f64::max);
        assert!(most <= expected.abs() + 2e-6, "{most} mm where speed changes");
    }
}

/// Round a right angle the commands are known in closed form, and so is how far the axes cut it short.
#[test]
fn a_corner_is_cut_short_by_the_lag() {
    let (gain, speed) = (30.0, 4.0);
    let at = followed("G1X10.F240\nY10.", with_servo(Servo::of_all(axis(gain, 0.0))));
    let miss = at.iter().map(|[_, [x, y, ..]]| libm::hypot(10.0 - x, *y)).fold(f64::INFINITY, f64::min);
    let lag = speed / gain;
    let distance = |t: f64| {
        let gone = libm::exp(-gain * t);
        libm::hypot(lag * gone, speed * t - lag * (1.0 - gone))
    };
    let expected = (0..200_000).map(|us| distance(f64::from(us) * 1e-6)).fold(f64::INFINITY, f64::min);
    println!("the corner is missed by {miss:.6} mm, {expected:.6} in closed form, {lag:.6} mm of lag");
    // The nearest point lies between two samples: second order of the way in half a period.
    let half_mm = speed * STEP.to_s() / 2.0;
    assert!(miss > expected - EXACT && miss < expected + half_mm * half_mm / expected);
}

/// A rapid is over when the axes are there; what flows behind feed does not wait.
#[test]
fn the_next_block_waits_for_the_axes_behind_a_rapid() {
    let at = followed("G0X10.\nG1Y1.F600", with_servo(Servo::of_all(axis(30.0, 0.0))));
    let begins = at.iter().position(|[commanded, _]| commanded[1] > 0.0).expect("it moves");
    let before = at[begins - 1][1][0];
    assert!((10.0 - before).abs() <= WIDTH_MM && (10.0 - at[begins - 3][1][0]).abs() > WIDTH_MM, "{before}");
}

#[test]
fn a_dwell_begins_when_the_axes_are_there() {
    let at = followed("G1X10.F600\nG4P500\nG1Y1.", with_servo(Servo::of_all(axis(30.0, 0.0))));
    let there = at.iter().position(|[_, actual]| 10.0 - actual[0] <= WIDTH_MM).expect("it gets there");
    let begins = at.iter().position(|[commanded, _]| commanded[1] > 0.0).expect("it goes on");
    assert!((begins - there).abs_diff(500) <= 1, "{} ms", begins - there);
}

#[test]
fn limits_of_the_axes_hold_for_the_actual_positions_too() {
    let servo = Servo::of_all(axis(30.0, 0.5));
    let limited = ControlSettings { servo: Some(servo), ..settings(drives()) };
    let at = followed("G1X20.Y10.F6000\nY-5.\nG3X10.I-5.\nG0X0Y0", limited);
    let actual: Vec<_> = at.iter().map(|[_, actual]| *actual).collect();
    let axes = [vec![[0.0; AXES]; 3], actual].concat();
    crate::drives::motion::Motion { axes }.keeps(&drives(), "actual positions");
}

/// The mean over a period of v (1 - (1 - f) exp(-K t)).
#[test]
fn a_sudden_feed_reaches_the_axes_in_time() {
    for (gain, feed_forward) in [(30.0, 0.0), (50.0, 0.6), (40.0, 1.0)] {
        let mut loops = PositionLoops::new(Servo::of_all(axis(gain, feed_forward)), [0.0; AXES]);
        for ms in 1..500 {
            let gone = |ms: i32| libm::exp(-gain * f64::from(ms) * STEP.to_s());
            let missing = (1.0 - feed_forward) * (gone(ms - 1) - gone(ms)) / (gain * STEP.to_s());
            assert!((loops.follow(20.0, STEP.to_s()) - 20.0 * (1.0 - missing)).abs() < EXACT, "{ms} ms");
        }
    }
}
