use super::*;
use arcfeed_nc::modal::{Feed, Turn};
use arcfeed_nc::segment::Arc;

const TICK: Span = Span(1_000);

fn pose(x_mm: f64, y_mm: f64) -> Pose {
    Pose { linear: [Nm::from_mm(x_mm), Nm::from_mm(y_mm), Nm(0)], ..Pose::default() }
}

fn segment(start: Pose, end: Pose, path: Path) -> Segment {
    Segment { sequence: None, start, end, feed: Feed::Missing, path }
}

/// A clockwise quarter of radius 100 about (5, 0), from the top.
fn quarter() -> Track {
    let mm = |x, y| [Nm::from_mm(x), Nm::from_mm(y)];
    let (center, from, to) = (mm(5.0, 0.0), mm(0.0, 100.0), mm(100.0, 0.0));
    let arc = Arc { plane: Plane::Xy, turn: Turn::Cw, center, from, to };
    Track::new(&segment(pose(5.0, 100.0), pose(105.0, 0.0), Path::Arc(arc))).unwrap()
}

/// The point of the quarter at this path from its start.
fn on_quarter(travelled_mm: f64) -> Pose {
    let (sin, cos) = libm::sincos(travelled_mm / 100.0);
    pose(5.0 + 100.0 * sin, 100.0 * cos)
}

fn travelled(track: &Track, progress: &mut Progress, sample: &Pose) -> f32 {
    track.advance(&PositionFilter::Exact, progress, Some(sample), TICK);
    progress.travelled_mm()
}

#[test]
fn it_follows_the_samples_and_never_goes_back() {
    let (track, mut progress) = (quarter(), quarter().begin(&Progress::default()));
    for travelled_mm in [0.0, 0.03, 1.0, 20.0, 38.0] {
        let got = travelled(&track, &mut progress, &on_quarter(travelled_mm));
        assert!((f64::from(got) - travelled_mm).abs() < 2e-4, "{got} at {travelled_mm}");
    }
    let furthest = progress.travelled_mm();
    assert_eq!(travelled(&track, &mut progress, &on_quarter(37.9)), furthest);
}

#[test]
fn the_places_along_an_arc_lie_on_it_and_point_along_it() {
    for (at, place) in quarter().places(128).enumerate() {
        let (sin, cos) = libm::sincos(at as f64 / 128.0 * core::f64::consts::FRAC_PI_2);
        let [x, y] = place.center_mm;
        assert!((f64::from(x) - 100.0 * sin).abs() < 1e-4 && (f64::from(y) - 100.0 * cos).abs() < 1e-4, "{at}");
        let [vx, vy] = place.motion;
        assert!((f64::from(vx) - cos).abs() < 1e-6 && (f64::from(vy) + sin).abs() < 1e-6, "{at}");
    }
}

#[test]
fn a_deviation_across_the_path_does_not_move_it() {
    let (track, mut progress) = (quarter(), quarter().begin(&Progress::default()));
    let (sin, cos) = libm::sincos(0.3);
    let inside = pose(5.0 + 60.0 * sin, 60.0 * cos);
    assert!((travelled(&track, &mut progress, &inside) - 30.0).abs() < 1e-3);
}

#[test]
fn it_ends_with_its_segment() {
    let (track, mut progress) = (quarter(), quarter().begin(&Progress::default()));
    for step in 1..=20 {
        travelled(&track, &mut progress, &on_quarter(10.0 * f64::from(step)));
    }
    assert_eq!(progress.travelled_mm(), track.length_mm());
}

#[test]
fn samples_that_tremble_or_stray_add_nothing_to_the_path() {
    let (track, mut progress) = (quarter(), quarter().begin(&Progress::default()));
    for step in 1..=2_000_u32 {
        let tremble_mm = 0.02 * f64::from(step % 3) - 0.02;
        travelled(&track, &mut progress, &on_quarter(0.03 * f64::from(step) + tremble_mm));
        if step % 500 == 0 {
            // Behind the tool: ahead of nothing, and the next sample leads back.
            travelled(&track, &mut progress, &on_quarter(0.03 * f64::from(step) - 90.0));
        }
    }
    assert!((progress.travelled_mm() - 60.0).abs() < 0.1, "{}", progress.travelled_mm());
}

#[test]
fn a_sample_at_the_rotation_centre_changes_nothing() {
    let (track, mut progress) = (quarter(), quarter().begin(&Progress::default()));
    assert_eq!(travelled(&track, &mut progress, &pose(5.0, 0.0)), 0.0);
}

#[test]
fn a_line_in_space_counts_its_whole_length() {
    let mut end = pose(3.0, 4.0);
    end.linear[2] = Nm::from_mm(12.0);
    let track = Track::new(&segment(pose(0.0, 0.0), end, Path::Line)).unwrap();
    let mut progress = track.begin(&Progress::default());
    let mut middle = pose(1.5, 2.0);
    middle.linear[2] = Nm::from_mm(6.0);
    assert!((travelled(&track, &mut progress, &middle) - 6.5).abs() < 1e-5);
    let places: Vec<_> = track.places(2).map(|place| place.center_mm).collect();
    assert_eq!(places, [[0.0, 0.0], [1.5, 2.0], [3.0, 4.0]]);
}

#[test]
fn a_helix_counts_its_arc_in_the_plane_with_and_without_the_filter() {
    let sample = |travelled_mm: f64| {
        let mut sample = on_quarter(travelled_mm);
        sample.linear[2] = Nm::from_mm(-0.8 * travelled_mm);
        sample
    };
    let mm = |x, y| [Nm::from_mm(x), Nm::from_mm(y)];
    let (center, from, to) = (mm(5.0, 0.0), mm(0.0, 100.0), mm(100.0, 0.0));
    let arc = Arc { plane: Plane::Xy, turn: Turn::Cw, center, from, to };
    let quarter_mm = 50.0 * core::f64::consts::PI;
    let track = Track::new(&segment(sample(0.0), sample(quarter_mm), Path::Arc(arc))).unwrap();
    assert!((f64::from(track.length_mm()) - quarter_mm).abs() < 1e-4);
    for filter in [PositionFilter::Exact, PositionFilter::new(0.2, Span(0)).unwrap()] {
        let mut progress = track.begin(&Progress { speed_mm_per_us: 30e-6, ..Progress::default() });
        for step in 1..=5_000 {
            let seen_mm = 0.03 * f64::from(step);
            track.advance(&filter, &mut progress, Some(&sample(seen_mm)), TICK);
            assert!((f64::from(progress.travelled_mm()) - seen_mm).abs() < 2e-3, "{filter:?} at {seen_mm}");
        }
    }
}

#[test]
fn a_rapid_has_no_track() {
    assert_eq!(Track::new(&segment(pose(0.0, 0.0), pose(1.0, 0.0), Path::Rapid)), None);
}

#[test]
fn without_samples_it_goes_on_at_the_speed_it_had() {
    let (track, filter) = (quarter(), PositionFilter::new(0.2, Span(0)).unwrap());
    let mut progress = track.begin(&Progress::default());
    for step in 1..=500 {
        track.advance(&filter, &mut progress, Some(&on_quarter(0.03 * f64::from(step))), TICK);
    }
    assert!((progress.speed_mm_per_s() - 30.0).abs() < 0.1, "{}", progress.speed_mm_per_s());
    for _ in 0..100 {
        track.advance(&filter, &mut progress, None, TICK);
    }
    assert!((progress.travelled_mm() - 18.0).abs() < 0.02, "{}", progress.travelled_mm());
}

#[test]
fn late_samples_are_made_up_for() {
    let delay = Span(4_000);
    let (track, filter) = (quarter(), PositionFilter::new(0.2, delay).unwrap());
    let mut progress = track.begin(&Progress::default());
    for step in 1..=1_000 {
        let seen = 0.03 * f64::from((step - 4).max(0));
        track.advance(&filter, &mut progress, Some(&on_quarter(seen)), TICK);
    }
    assert!((progress.travelled_mm() - 30.0).abs() < 0.01, "{}", progress.travelled_mm());
}

#[test]
fn only_gains_between_none_and_all_make_a_filter() {
    for gain in [0.0, 1.0, -0.5, f32::NAN] {
        assert_eq!(PositionFilter::new(gain, Span(0)), None);
    }
}
