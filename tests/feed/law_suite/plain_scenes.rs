//! Scenes of the laws that look at no stock.

use super::{Scene, View};
use crate::geometry::{between, log_between, unit};
use arcfeed_law::contour::{Contour, ContourLimits};
use arcfeed_law::engagement::{Engagement, PathShape};
use arcfeed_law::table::Table;
use arcfeed_law::{FeedLaw, Place};
use arcfeed_model::cut::ContourSide;
use arcfeed_units::{Mm, MmPerTooth};
use core::f64::consts::PI;
use fastrand::Rng;

/// The contour law.
#[derive(Clone, Debug)]
pub struct ContourScene {
    pub path_radius: f64,
    pub tool_radius: f64,
    pub side: ContourSide,
    pub chip: f64,
    pub inside_only: bool,
    pub floor: f64,
}

impl ContourScene {
    pub fn sample(random: &mut Rng) -> Self {
        ContourScene {
            path_radius: log_between(random, 0.01, 1e3),
            tool_radius: log_between(random, 0.5, 100.0),
            side: if random.bool() { ContourSide::Inside } else { ContourSide::Outside },
            chip: log_between(random, 1e-3, 1.0),
            inside_only: random.bool(),
            floor: if random.bool() { 0.0 } else { between(random, 0.0, 0.5) },
        }
    }
}

/// Any place will do for a law that asks for none.
fn any_place(ratio: f64) -> Place {
    Place::on_arc(unit(ratio).map(|x| x as f32), 1.0, 10.0, ratio as f32)
}

impl Scene for ContourScene {
    fn seen(&self, view: &View) -> Self {
        ContourScene {
            path_radius: view.scale * (self.path_radius + view.grown * self.tool_radius.min(self.path_radius)),
            tool_radius: view.scale * self.tool_radius,
            chip: view.scale * view.chip * self.chip,
            ..self.clone()
        }
    }

    fn numbers(&mut self) -> Vec<&mut f64> {
        vec![&mut self.path_radius, &mut self.tool_radius, &mut self.chip, &mut self.floor]
    }

    fn law(&self) -> Option<Box<dyn FeedLaw>> {
        let limits = ContourLimits { inside_only: self.inside_only, floor_ratio: self.floor as f32 };
        let (path, tool) = (Mm(self.path_radius as f32), Mm(self.tool_radius as f32));
        Some(Box::new(Contour::new(path, tool, self.side, MmPerTooth(self.chip as f32), limits)))
    }

    fn place(&self, ratio: f64) -> Place {
        any_place(ratio)
    }
}

/// The engagement law.
#[derive(Clone, Debug)]
pub struct EngagementScene {
    pub tool_radius: f64,
    pub depth: f64,
    pub chip: f64,
    pub contour_radius: f64,
    pub turn_rad: f64,
    pub straight: bool,
}

impl EngagementScene {
    pub fn sample(random: &mut Rng) -> Self {
        let tool_radius = log_between(random, 0.5, 100.0);
        EngagementScene {
            tool_radius,
            depth: tool_radius * between(random, 0.01, 1.95),
            chip: log_between(random, 1e-3, 1.0),
            contour_radius: tool_radius * log_between(random, 0.9, 100.0),
            turn_rad: between(random, 0.01, PI),
            straight: random.u8(..4) == 0,
        }
    }
}

impl Scene for EngagementScene {
    fn seen(&self, view: &View) -> Self {
        EngagementScene {
            tool_radius: view.scale * self.tool_radius,
            depth: view.scale * (self.depth + view.grown * (self.tool_radius + self.contour_radius)),
            chip: view.scale * view.chip * self.chip,
            contour_radius: view.scale * self.contour_radius,
            ..*self
        }
    }

    fn numbers(&mut self) -> Vec<&mut f64> {
        vec![&mut self.tool_radius, &mut self.depth, &mut self.chip, &mut self.contour_radius, &mut self.turn_rad]
    }

    fn law(&self) -> Option<Box<dyn FeedLaw>> {
        let inside =
            PathShape::Inside { contour_radius: Mm(self.contour_radius as f32), turn_rad: self.turn_rad as f32 };
        let shape = if self.straight { PathShape::Straight } else { inside };
        let (tool, depth) = (Mm(self.tool_radius as f32), Mm(self.depth as f32));
        Some(Box::new(Engagement::new(tool, depth, MmPerTooth(self.chip as f32), shape)))
    }

    fn place(&self, ratio: f64) -> Place {
        any_place(ratio)
    }
}

/// The table law.
#[derive(Clone, Debug)]
pub struct TableScene {
    pub knots: Vec<(f64, f64)>,
    pub length: f64,
}

impl TableScene {
    pub fn sample(random: &mut Rng) -> Self {
        let mut at = between(random, -10.0, 10.0);
        let count = random.usize(1..=32);
        let knot = |_| {
            // Steeper, and two neighbours in f32 are a jump apart.
            at += log_between(random, 2.0, 20.0);
            (at, log_between(random, 1e-3, 1.0))
        };
        let knots: Vec<(f64, f64)> = (0..count).map(knot).collect();
        let length = knots.last().map_or(0.0, |(last, _)| last + 10.0);
        TableScene { knots, length }
    }
}

impl Scene for TableScene {
    fn seen(&self, view: &View) -> Self {
        let chip = view.scale * view.chip;
        let shift = view.grown * self.length;
        let knots = self.knots.iter().map(|(at, feed)| (view.scale * (at + shift), chip * feed)).collect();
        TableScene { knots, length: view.scale * self.length }
    }

    fn numbers(&mut self) -> Vec<&mut f64> {
        self.knots.iter_mut().flat_map(|(at, feed)| [at, feed]).collect()
    }

    fn law(&self) -> Option<Box<dyn FeedLaw>> {
        let knots: Vec<_> = self.knots.iter().map(|(at, feed)| (Mm(*at as f32), MmPerTooth(*feed as f32))).collect();
        Table::new(&knots).ok().map(|table| Box::new(table) as Box<dyn FeedLaw>)
    }

    fn place(&self, ratio: f64) -> Place {
        Place { travelled_mm: (ratio * self.length) as f32, ..any_place(ratio) }
    }
}
