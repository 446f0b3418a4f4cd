//! Points, distances and directions of moves in the plane X Y, computed apart from the compensation.

use std::f64::consts::TAU;

use arcfeed_nc::modal::Turn;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::Nm;

/// A move in the plane, mm.
#[derive(Clone, Copy, Debug)]
pub struct Track {
    pub from: [f64; 2],
    pub to: [f64; 2],
    /// Centre, sense, and angle turned, of an arc.
    arc: Option<([f64; 2], f64, f64)>,
}

impl Track {
    pub fn of(segment: &Segment) -> Self {
        let point = |linear: &[Nm; 3]| [linear[0], linear[1]].map(Nm::to_mm);
        let (from, to) = (point(&segment.start.linear), point(&segment.end.linear));
        let arc = match &segment.path {
            Path::Arc(arc) => {
                let center = arc.center.map(Nm::to_mm);
                let sign = if arc.turn == Turn::Ccw { 1.0 } else { -1.0 };
                let turned = (sign * (angle(minus(to, center)) - angle(minus(from, center)))).rem_euclid(TAU);
                Some((center, sign, if turned == 0.0 { TAU } else { turned }))
            }
            Path::Rapid | Path::Line => None,
        };
        Track { from, to, arc }
    }

    pub fn length(&self) -> f64 {
        match self.arc {
            Some((center, _, turned)) => length(minus(self.from, center)) * turned,
            None => length(minus(self.to, self.from)),
        }
    }

    /// The point at a part of the length, and the direction there.
    pub fn at(&self, part: f64) -> ([f64; 2], [f64; 2]) {
        let Some((center, sign, turned)) = self.arc else {
            let way = minus(self.to, self.from);
            let total = length(way).max(f64::MIN_POSITIVE);
            return ([0, 1].map(|axis| self.from[axis] + part * way[axis]), way.map(|along| along / total));
        };
        let radius = (1.0 - part) * length(minus(self.from, center)) + part * length(minus(self.to, center));
        let (sin, cos) = libm::sincos(angle(minus(self.from, center)) + sign * part * turned);
        ([center[0] + radius * cos, center[1] + radius * sin], [-sign * sin, sign * cos])
    }

    /// Distance of a point.
    pub fn distance(&self, point: [f64; 2]) -> f64 {
        let to_ends = length(minus(point, self.from)).min(length(minus(point, self.to)));
        let Some((center, sign, turned)) = self.arc else {
            let way = minus(self.to, self.from);
            let square = way[0] * way[0] + way[1] * way[1];
            let from = minus(point, self.from);
            let part = (from[0] * way[0] + from[1] * way[1]) / square.max(f64::MIN_POSITIVE);
            let foot = [0, 1].map(|axis| self.from[axis] + part.clamp(0.0, 1.0) * way[axis]);
            return length(minus(point, foot));
        };
        let from_center = minus(point, center);
        let at = (sign * (angle(from_center) - angle(minus(self.from, center)))).rem_euclid(TAU);
        if at <= turned { (length(from_center) - length(minus(self.from, center))).abs() } else { to_ends }
    }

    /// Points at most `step` apart, both ends among them, with their directions.
    pub fn samples(&self, step: f64) -> Vec<([f64; 2], [f64; 2])> {
        let count = (self.length() / step).ceil().max(1.0) as usize;
        (0..=count).map(|index| self.at(index as f64 / count as f64)).collect()
    }
}

/// Angle from one direction to another, in (-pi, pi].
pub fn turn(from: [f64; 2], to: [f64; 2]) -> f64 {
    libm::atan2(from[0] * to[1] - from[1] * to[0], from[0] * to[0] + from[1] * to[1])
}

pub fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

pub fn length([x, y]: [f64; 2]) -> f64 {
    libm::hypot(x, y)
}

fn angle([x, y]: [f64; 2]) -> f64 {
    libm::atan2(y, x)
}
