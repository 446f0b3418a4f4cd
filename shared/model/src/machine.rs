//! Feed limits of the machine and its control: the largest feed on a segment.
//!
//! The feed is measured along the path; on a helix, along the arc in its plane. With d_i the distance that axis i
//! covers per unit of that path, V_i its maximum speed, and r the radius of an arc:
//!
//! ```text
//! axes:       v <= V_i / max |d_i|                          (1)
//! arc clamp:  v <= max(V sqrt(r/R), floor)                  (2)
//! ```
//!
//! (1) is what any control does with an axis at its maximum cutting feedrate; rotary axes have degrees per minute. (2) is
//! Fanuc's clamp of the feed by arc radius (parameters 1730 V, 1731 R, 1732 floor): it keeps the acceleration v^2/r.

use arcfeed_nc::modal::Turn;
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::{DegPerMin, MicroDeg, Mm, MmPerMin, NM_PER_MM, Nm};

/// Feed limits of a machine; `None` where a limit is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MachineLimits {
    /// Maximum cutting feeds of X, Y and Z; `None`: not known, so the axis sets no limit.
    pub linear: [Option<MmPerMin>; 3],
    /// Maximum feeds of A, B and C; `None`: not known, so the axis sets no limit.
    pub rotary: [Option<DegPerMin>; 3],
    /// Clamp of the control on arcs.
    pub arc_clamp: Option<ArcClamp>,
}

/// Clamp by which a control limits the feed on arcs in proportion to the square root of the arc's radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcClamp {
    /// V: maximum feed at the radius R.
    pub feed: MmPerMin,
    /// R: reference radius.
    pub radius: Mm,
    /// Lower limit: the clamp never reduces the feed below this.
    pub floor: MmPerMin,
}

/// Largest feed on a segment, and what limits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedLimit {
    /// Feed along the path; on a helix, along its arc.
    pub feed: MmPerMin,
    /// Cause of the limit.
    pub by: LimitedBy,
}

/// Cause of a feed limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LimitedBy {
    /// A linear or rotary axis at its maximum feed.
    Axis,
    /// The control's clamp on arcs.
    ArcClamp,
    /// The job: its maximum feed, or its maximum multiple of the programmed feed.
    Ceiling,
}

impl FeedLimit {
    /// The lower of two limits.
    #[must_use]
    pub fn lower(self, other: Self) -> Self {
        if other.feed.0 < self.feed.0 { other } else { self }
    }
}

impl ArcClamp {
    /// Largest feed on an arc of this radius. (2)
    pub fn feed_at(&self, radius: Mm) -> MmPerMin {
        let part = libm::sqrt(f64::from(radius.0) / f64::from(self.radius.0));
        MmPerMin((f64::from(self.feed.0) * part).max(f64::from(self.floor.0)) as f32)
    }
}

impl MachineLimits {
    /// Largest feed on a cutting move, from the axes and the arc clamp; `None` for rapids, and if no limit is known.
    pub fn feed_limit(&self, segment: &Segment) -> Option<FeedLimit> {
        // Early return: the chip computes f64 in software.
        if segment.path == Path::Rapid || *self == MachineLimits::default() {
            return None;
        }
        let axes = self.axes_limit(segment).map(|feed| FeedLimit { feed, by: LimitedBy::Axis });
        let clamp = self
            .arc_clamp
            .zip(segment.arc())
            .map(|(clamp, arc)| FeedLimit { feed: clamp.feed_at(Mm(arc.radius_mm() as f32)), by: LimitedBy::ArcClamp });
        match (axes, clamp) {
            (Some(axes), Some(clamp)) => Some(if clamp.feed.0 < axes.feed.0 { clamp } else { axes }),
            (one, other) => one.or(other),
        }
    }

    /// The axis whose maximum feed limits the move most, without regard to the arc clamp: `X`, `Y`, `Z`, `A`, `B` or
    /// `C`; `None` if no axis that moves has a known limit.
    pub fn limiting_axis(&self, segment: &Segment) -> Option<char> {
        let feeds = ['X', 'Y', 'Z', 'A', 'B', 'C'].into_iter().zip(self.axis_feeds(segment));
        let known = feeds.filter_map(|(name, feed)| Some((name, feed?)));
        known.min_by(|(_, one), (_, other)| one.total_cmp(other)).map(|(name, _)| name)
    }

    /// (1)
    fn axes_limit(&self, segment: &Segment) -> Option<MmPerMin> {
        let feeds = self.axis_feeds(segment).flatten();
        feeds.reduce(f64::min).map(|feed| MmPerMin(feed as f32))
    }

    /// Feed along the path that each of X, Y, Z, A, B, C allows, mm/min.
    fn axis_feeds(&self, segment: &Segment) -> impl Iterator<Item = Option<f64>> {
        let way = segment.feed_length_mm();
        let linear =
            linear_parts(segment, way).into_iter().zip(self.linear.map(|limit| limit.map(|MmPerMin(feed)| feed)));
        let turned =
            segment.start.rotary.into_iter().zip(segment.end.rotary).map(|(from, to)| to.0.saturating_sub(from.0));
        let turned = turned.map(move |swing| MicroDeg(swing).to_deg() / way);
        let rotary = turned.zip(self.rotary.map(|limit| limit.map(|DegPerMin(feed)| feed)));
        linear.chain(rotary).map(|(part, limit)| {
            let part = libm::fabs(part);
            // An axis that does not move sets no limit along the path, nor does one on a path of length zero.
            limit.filter(|_| part > 0.0 && part.is_finite()).map(|limit| f64::from(limit) / part)
        })
    }
}

/// Largest distance that each linear axis covers per unit of the path.
fn linear_parts(segment: &Segment, way: f64) -> [f64; 3] {
    let moved = |axis: usize| {
        let at = |linear: &[Nm; 3]| linear.get(axis).copied().unwrap_or_default();
        (at(&segment.end.linear).to_mm() - at(&segment.start.linear).to_mm()) / way
    };
    let mut parts = [0, 1, 2].map(moved);
    if let Some(arc) = segment.arc() {
        let (first, second, _) = arc.plane.axes();
        for (axis, part) in [first, second].into_iter().zip(largest_parts(arc)) {
            if let Some(slot) = parts.get_mut(axis) {
                *slot = part;
            }
        }
    }
    parts
}

/// Largest components of an arc's tangent along its two axes: 1 where the tangent runs along the axis at some point of
/// the arc.
fn largest_parts(arc: &Arc) -> [f64; 2] {
    let radius_mm = arc.radius_mm();
    let [x, y] = arc.from.map(|Nm(nm)| nm as f64 / NM_PER_MM as f64 / radius_mm);
    let [end_x, end_y] = arc.to.map(|Nm(nm)| nm as f64 / NM_PER_MM as f64 / radius_mm);
    let (from, to) = if arc.turn == Turn::Ccw { ([x, y], [end_x, end_y]) } else { ([end_x, end_y], [x, y]) };
    let passes = |direction: [f64; 2]| arc.from == arc.to || lies_between(from, direction, to);
    let largest = |square: [f64; 2], start: f64, end: f64| {
        let opposite = square.map(|component| -component);
        if passes(square) || passes(opposite) { 1.0 } else { libm::fabs(start).max(libm::fabs(end)) }
    };
    [largest([0.0, 1.0], y, end_y), largest([1.0, 0.0], x, end_x)]
}

/// Whether a direction lies on the counter-clockwise sweep from one direction to another.
fn lies_between(from: [f64; 2], direction: [f64; 2], to: [f64; 2]) -> bool {
    let cross = |[x, y]: [f64; 2], [to_x, to_y]: [f64; 2]| x * to_y - y * to_x;
    if cross(from, to) >= 0.0 {
        cross(from, direction) >= 0.0 && cross(direction, to) >= 0.0
    } else {
        !(cross(to, direction) > 0.0 && cross(direction, from) > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};

    fn pose(mm: [f64; 3], b_deg: f64) -> Pose {
        Pose { linear: mm.map(Nm::from_mm), rotary: [MicroDeg(0), MicroDeg((b_deg * 1e6) as i64), MicroDeg(0)] }
    }

    fn line(to: [f64; 3], b_deg: f64) -> Segment {
        let (start, end) = (pose([0.0; 3], 0.0), pose(to, b_deg));
        Segment { sequence: None, start, end, feed: Feed::Missing, path: Path::Line }
    }

    /// Counter-clockwise about the origin, in degrees from +X.
    fn arc(radius_mm: f64, from_deg: f64, to_deg: f64, rise_mm: f64) -> Segment {
        let at = |deg: f64| {
            let (sin, cos) = libm::sincos(deg.to_radians());
            [radius_mm * cos, radius_mm * sin]
        };
        let [from, to] = [at(from_deg), at(to_deg)];
        let path = Path::Arc(Arc {
            plane: Plane::Xy,
            turn: Turn::Ccw,
            center: [Nm(0); 2],
            from: from.map(Nm::from_mm),
            to: to.map(Nm::from_mm),
        });
        let (start, end) = (pose([from[0], from[1], 0.0], 0.0), pose([to[0], to[1], rise_mm], 0.0));
        Segment { sequence: None, start, end, feed: Feed::Missing, path }
    }

    fn limits() -> MachineLimits {
        MachineLimits {
            linear: [Some(MmPerMin(1_000.0)), Some(MmPerMin(2_000.0)), Some(MmPerMin(500.0))],
            rotary: [None, Some(DegPerMin(360.0)), None],
            arc_clamp: None,
        }
    }

    fn feed(limits: &MachineLimits, segment: &Segment) -> f64 {
        limits.feed_limit(segment).map_or(f64::INFINITY, |limit| f64::from(limit.feed.0))
    }

    #[test]
    fn on_a_line_the_axis_that_is_at_its_fastest_first_counts() {
        for (to, b_deg, expected) in [
            ([10.0, 0.0, 0.0], 0.0, 1_000.0),
            ([0.0, -10.0, 0.0], 0.0, 2_000.0),
            ([3.0, 4.0, 0.0], 0.0, 1_000.0 / 0.6),
            ([3.0, 4.0, 0.0], 36.0, 360.0 * 5.0 / 36.0),
            ([1.0, 0.0, -1.0], 0.0, 500.0 * core::f64::consts::SQRT_2),
        ] {
            assert!((feed(&limits(), &line(to, b_deg)) / expected - 1.0).abs() < 1e-6, "{to:?}");
        }
        assert_eq!(MachineLimits::default().feed_limit(&line([1.0, 0.0, 0.0], 5.0)), None);
        assert_eq!(limits().feed_limit(&Segment { path: Path::Rapid, ..line([1.0, 0.0, 0.0], 0.0) }), None);
    }

    #[test]
    fn on_an_arc_the_fastest_moment_of_each_axis_counts() {
        // The tangent at 90 degrees runs along X, at 0 degrees along Y.
        for (from, to, expected) in [
            (60.0, 120.0, 1_000.0),
            (10.0, 30.0, 1_000.0 / 0.5),
            (-30.0, 30.0, 2_000.0_f64.min(1_000.0 / 0.5)),
            (1.0, 5.0, 2_000.0 / libm::cos(1.0_f64.to_radians())),
            (200.0, 190.0, 1_000.0),
            (240.0, 300.0, 1_000.0),
        ] {
            let found = feed(&limits(), &arc(50.0, from, to, 0.0));
            assert!((found / expected - 1.0).abs() < 1e-4, "{from} to {to}: {found}, not {expected}");
        }
    }

    #[test]
    fn it_agrees_with_every_point_of_a_thousand_arcs() {
        let mut seed = 1_u64;
        let mut random = |below: f64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 * below
        };
        for _ in 0..1_000 {
            let (from, sweep) = (random(360.0), 0.1 + random(359.0));
            let found = feed(&limits(), &arc(80.0, from, from + sweep, 0.0));
            let at = |i: i32| {
                let (sin, cos) = libm::sincos((from + sweep * f64::from(i) / 4_000.0).to_radians());
                (1_000.0 / libm::fabs(sin)).min(2_000.0 / libm::fabs(cos))
            };
            let least = (0..=4_000).map(at).fold(f64::INFINITY, f64::min);
            assert!(found <= least * (1.0 + 1e-6) && found > least * (1.0 - 1e-5), "{from} {sweep}: {found} {least}");
        }
    }

    #[test]
    fn on_a_helix_the_axis_across_counts_against_the_way_in_the_plane() {
        let quarter_mm = 50.0 * core::f64::consts::FRAC_PI_2;
        let helix = arc(50.0, 45.0, 135.0, quarter_mm);
        assert!((feed(&limits(), &helix) / 500.0 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_clamp_keeps_the_acceleration_and_has_a_floor() {
        let clamp = ArcClamp { feed: MmPerMin(6_000.0), radius: Mm(10.0), floor: MmPerMin(100.0) };
        for (radius, feed) in [(10.0, 6_000.0), (2.5, 3_000.0), (40.0, 12_000.0), (0.001, 100.0)] {
            assert_eq!(clamp.feed_at(Mm(radius)), MmPerMin(feed));
        }
        let both = MachineLimits { arc_clamp: Some(clamp), ..limits() };
        let by = |radius| both.feed_limit(&arc(radius, 60.0, 120.0, 0.0)).unwrap().by;
        assert_eq!((by(0.1), by(10.0)), (LimitedBy::ArcClamp, LimitedBy::Axis));
        assert_eq!(both.feed_limit(&line([0.0, 1.0, 0.0], 0.0)).unwrap().by, LimitedBy::Axis);
    }
}
