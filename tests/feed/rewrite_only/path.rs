//! The path: programs before and after, as the simulated control executes them.

use arcfeed::commands::simulate::control::control_settings;
use arcfeed::job::JobFile;
use arcfeed_control::Control;
use arcfeed_nc::modal::Pose;
use arcfeed_units::{LengthUnit, Micros, Nm};

use crate::rewrite_only::{Case, PROGRAMS, case, moves};

const TICK: Micros = Micros::from_ms(1);

/// The axes at each tick of each move, and where each ends.
fn executed(file: &JobFile, text: &[u8]) -> Vec<[f64; 3]> {
    let mut control = Control::from_memory(control_settings(file), text);
    let (mut now, mut points, mut last) = (Micros(0), Vec::new(), None);
    while !control.is_over() {
        now = now.after(TICK);
        control.step(now, TICK, 100);
        // Between two ticks it may turn a corner.
        let active = control.active().map(|(count, segment)| (count, segment.end));
        if let Some((_, end)) = last.filter(|(count, _)| active.is_none_or(|(now, _)| now != *count)) {
            let end: Pose = end;
            points.push(end.linear.map(Nm::to_mm));
        }
        last = active;
        points.push(control.position().linear.map(Nm::to_mm));
        assert!(points.len() < 2_000_000, "it never ends");
    }
    assert_eq!(control.alarm(), None, "{}", String::from_utf8_lossy(text));
    points
}

/// Largest distance of the points from the way that others went, in their order.
fn apart(points: &[[f64; 3]], way: &[[f64; 3]]) -> f64 {
    let distance = |p: &[f64; 3], a: &[f64; 3], b: &[f64; 3]| {
        let along = |from: &[f64; 3], to: &[f64; 3]| [0, 1, 2].map(|axis| to[axis] - from[axis]);
        let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let (ab, ap) = (along(a, b), along(a, p));
        let length = dot(ab, ab);
        let t = if length > 0.0 { (dot(ap, ab) / length).clamp(0.0, 1.0) } else { 0.0 };
        let off = [0, 1, 2].map(|axis| ap[axis] - t * ab[axis]);
        libm::sqrt(dot(off, off))
    };
    let (mut at, mut worst) = (0, 0.0_f64);
    for point in points {
        let best = |range: std::ops::Range<usize>| {
            let pairs = range.filter_map(|at| Some((at, distance(point, way.get(at)?, way.get(at + 1)?))));
            pairs.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((at, f64::INFINITY))
        };
        let (nearest, off) = best(at..at + 200);
        at = nearest;
        worst = worst.max(off);
    }
    worst
}

#[test]
fn the_machine_runs_the_same_path_to_the_same_ends() {
    let (mut in_plane, mut across) = (0.0_f64, 0.0_f64);
    for seed in 0..PROGRAMS {
        let Case { spelled, file, program, adapted, .. } = case(seed);
        let ends =
            |text: &[u8]| -> Vec<[Nm; 3]> { moves(text, file.job.unit).iter().map(|sent| sent.end.linear).collect() };
        let mut sent = ends(&adapted.text).into_iter();
        for end in ends(program.bytes()) {
            assert!(sent.any(|sent| sent == end), "seed {seed}: no move ends at {end:?}");
        }
        let (before, after) = (executed(&file, program.bytes()), executed(&file, &adapted.text));
        assert_eq!(before.last(), after.last());
        let worst = apart(&after, &before).max(apart(&before, &after));
        if spelled.flat {
            in_plane = in_plane.max(worst);
        } else {
            across = across.max(worst);
        }
        // A flat helix in inches cannot be written better than half an increment across its plane: 1.27 um.
        let bound = if spelled.flat || spelled.unit == LengthUnit::Mm { 1e-3 } else { 1.5e-3 };
        assert!(worst < bound, "seed {seed}: {worst} mm apart\n{}", spelled.text);
    }
    println!("apart: {:.3} um at most without helices, {:.3} um with them", 1e3 * in_plane, 1e3 * across);
}
