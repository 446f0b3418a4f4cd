//! The simulated axes: they follow the arcs at the feed that the override makes of their F. Yours have encoders.

use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_units::{MmPerMin, NM_PER_MM, Nm, S_PER_MIN, Span, US_PER_S};

/// The axes on their way along a block. Single precision: the chip has no other in hardware.
#[derive(Default)]
pub struct Machine {
    /// Signed with the direction of rotation, mm.
    radius_mm: f32,
    start_rad: f32,
    length_mm: f32,
    travelled_mm: f32,
}

impl Machine {
    /// Begins a block, which must be an arc about the origin.
    pub fn begin(&mut self, block: &Segment) {
        let Some(arc) = block.arc() else { return };
        self.radius_mm = f32::from(arc.turn.sign()) * arc.radius_mm() as f32;
        self.start_rad = arc.angles().start_rad as f32;
        self.length_mm = arc.length_mm() as f32;
        self.travelled_mm = 0.0;
    }

    /// Whether the block is at its end, or none was begun.
    pub fn is_at_end_of_block(&self) -> bool {
        self.travelled_mm >= self.length_mm
    }

    /// Position of the tool's centre.
    pub fn position(&self) -> Pose {
        let turned_rad = if self.radius_mm == 0.0 { 0.0 } else { self.travelled_mm / self.radius_mm };
        let (sin, cos) = libm::sincosf(self.start_rad + turned_rad);
        let [x, y] = [cos, sin].map(|part| Nm((self.radius_mm.abs() * part * NM_PER_MM as f32) as i64));
        Pose { linear: [x, y, Nm(0)], ..Pose::default() }
    }

    /// Moves on for `dt` at the feed that the control makes of the override; stops at the end of the block.
    pub fn advance(&mut self, feed: Option<MmPerMin>, dt: Span) {
        let mm_per_s = feed.map_or(0.0, |feed| feed.0) / S_PER_MIN as f32;
        self.travelled_mm = (self.travelled_mm + mm_per_s * dt.us() / US_PER_S as f32).min(self.length_mm);
    }
}
