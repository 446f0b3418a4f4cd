//! A cutter that goes straight along x through a layer, with nothing behind its axis.

use std::f64::consts::TAU;

use arcfeed_milling::cutting::edge_engagement::EdgeEngagement;
use arcfeed_milling::cutting::edges::Cutter;
use arcfeed_milling::cutting::layer::Layer;
use arcfeed_milling::cutting::layers::Layers;
use arcfeed_milling::cutting::pose::ToolPose;
use nalgebra::Vector2;

/// Chips in front of a tooth.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    pub tooth: usize,
    /// From y, clockwise: 0 to half a turn is in front of the tool.
    pub angle_rad: f64,
    pub thickness_mm: f64,
}

/// A straight cut.
#[derive(Clone, Copy, Debug)]
pub struct Straight {
    pub feed_mm_per_turn: f64,
    /// Between rays.
    pub step_mm: f64,
    /// From the lowest y that has material to the highest.
    pub material_mm: [f64; 2],
    pub steps_a_turn: usize,
    /// Turns in all, and those before anything is seen.
    pub turns: [usize; 2],
}

impl Straight {
    /// The block in front of a tool of this radius.
    fn layer(&self, radius_mm: f64) -> Layer {
        let [lowest_mm, highest_mm] = self.material_mm;
        let length_mm = self.feed_mm_per_turn * self.turns[0] as f64 + 2.0 * radius_mm + 2.0;
        let mut layer =
            Layer::rectangle([-radius_mm - 1.0, lowest_mm], [length_mm, highest_mm - lowest_mm], self.step_mm);
        layer.clear_ring(Vector2::zeros(), 0.0, radius_mm);
        let far_mm = 2.0 * radius_mm + highest_mm.abs() + lowest_mm.abs();
        layer.clear(&[[-far_mm, -far_mm], [-far_mm, far_mm], [0.0, far_mm], [0.0, -far_mm]].map(Vector2::from));
        layer
    }

    /// Every tooth at every step, after the turns that are not seen; edges 1 mm high.
    pub fn seen(&self, cutter: Cutter) -> Vec<Seen> {
        let radius_mm = cutter.pieces().iter().map(|piece| piece.radius_mm).fold(0.0, f64::max);
        let layer = self.layer(radius_mm);
        self.seen_in(layer, cutter)
    }

    /// The same in a layer of one's own.
    pub fn seen_in(&self, layer: Layer, cutter: Cutter) -> Vec<Seen> {
        let layers = Layers::alike(&layer, 0.0, 1.0, 1);
        let mut engagement = EdgeEngagement::new(cutter, layers, 0.5).expect("a tool in its layer");
        let mut seen = Vec::new();
        for step in 0..self.turns[0] * self.steps_a_turn {
            let turns = step as f64 / self.steps_a_turn as f64;
            let axis_mm = Vector2::new(self.feed_mm_per_turn * turns, 0.0);
            let stand = ToolPose { axis_mm, tip_mm: 0.0, turned_rad: TAU * turns };
            if turns >= self.turns[1] as f64 {
                seen.extend(engagement.chips(&engagement.poses(&stand), |_| Vector2::zeros()).map(|chip| Seen {
                    tooth: chip.piece.tooth,
                    angle_rad: (TAU / 4.0 - chip.piece.angle_at_rad(stand.turned_rad)).rem_euclid(TAU),
                    thickness_mm: chip.section.thickness_mm,
                }));
            }
            engagement.cut(&engagement.poses(&stand), |_| Vector2::zeros());
        }
        seen
    }
}
