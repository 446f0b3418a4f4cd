//! Forces of a helical end mill at one angle, integrated along the edges in closed form, with the chip fz sin(a); a is from y, clockwise.
//!
//! ```text
//! dFx = -(Ft cos a + Fr sin a)    dFy = Ft sin a - Fr cos a    dFz = Fa    dT = R Ft        (1)
//! Fi = (ki fz sin a + ei) da / q,    q = tan(helix) / R: da along the edge for each mm up   (2)
//! ```

use std::f64::consts::TAU;

/// An end mill that feeds along x.
#[derive(Clone, Copy, Debug)]
pub struct Milling {
    pub radius_mm: f64,
    pub teeth: usize,
    pub helix_rad: f64,
    pub depth_mm: f64,
    pub feed_mm_per_tooth: f64,
    /// Beginning and end of the material.
    pub engaged_rad: [f64; 2],
    /// Tangential, radial, axial: N/mm2, then N/mm.
    pub cutting: [f64; 3],
    pub edge: [f64; 3],
}

/// Fx, Fy, Fz in N as above, T in N mm.
pub type Forces = [f64; 4];

impl Milling {
    /// With tooth 0 at `angle_rad` at its tip; each further tooth follows, as each place further up does.
    pub fn forces(&self, angle_rad: f64) -> Forces {
        let lag_rad_per_mm = libm::tan(self.helix_rad) / self.radius_mm;
        let [begin, end] = self.engaged_rad;
        let mut sum = [0.0; 4];
        for tooth in 0..self.teeth {
            let tip = (angle_rad - TAU * tooth as f64 / self.teeth as f64).rem_euclid(TAU);
            for tip in [tip, tip + TAU] {
                let top = tip - lag_rad_per_mm * self.depth_mm;
                let (from, to) = (top.max(begin), tip.min(end));
                let add = match lag_rad_per_mm > 0.0 {
                    true if from < to => between(self.integral(from), self.integral(to), 1.0 / lag_rad_per_mm),
                    false if (begin..=end).contains(&tip) => self.density(tip).map(|f| f * self.depth_mm),
                    _ => continue,
                };
                sum = std::array::from_fn(|i| sum[i] + add[i]);
            }
        }
        sum
    }

    /// The mean over a turn, whatever the helix.
    pub fn mean(&self) -> Forces {
        let [begin, end] = self.engaged_rad;
        let scale = self.teeth as f64 * self.depth_mm / TAU;
        between(self.integral(begin), self.integral(end), scale)
    }

    /// Force per millimetre of edge. (1)
    fn density(&self, a: f64) -> Forces {
        let (sin, cos) = libm::sincos(a);
        let [t, r, ax]: [f64; 3] =
            std::array::from_fn(|i| self.cutting[i] * self.feed_mm_per_tooth * sin + self.edge[i]);
        [-(t * cos + r * sin), t * sin - r * cos, ax, self.radius_mm * t]
    }

    /// The integral of (1) over the angle.
    fn integral(&self, a: f64) -> Forces {
        let (sin, cos) = libm::sincos(a);
        let [t, r, ax] = self.cutting.map(|k| k * self.feed_mm_per_tooth);
        let [te, re, axe] = self.edge;
        let (sin_cos, sin_sin) = (sin * sin / 2.0, (a - sin * cos) / 2.0);
        [
            -(t * sin_cos + te * sin + r * sin_sin - re * cos),
            t * sin_sin - te * cos - r * sin_cos - re * sin,
            axe * a - ax * cos,
            self.radius_mm * (te * a - t * cos),
        ]
    }
}

fn between(from: Forces, to: Forces, scale: f64) -> Forces {
    std::array::from_fn(|i| (to[i] - from[i]) * scale)
}
