//! Base position, pivots and levels of a path in one slot, for one direction of the tool.

use arcfeed_nc::modal::Turn;

use crate::path::{Level, SlotPath};

use super::base::{Base, Limits, settle};
use super::depth::levels_mm;
use super::infeasibility::{Infeasible, check_levels};
use super::interior::{InteriorPivot, interior};
use super::level::Stop;
use super::roughing::{BaseLimits, Request};
use super::turns::{Surroundings, Turns};

/// Level context: base position and pivots of a slot, which are the same on all levels of its path.
pub struct LevelContext<'a> {
    /// Surroundings.
    around: &'a Surroundings,
    /// Base position, in which the ring touches both blades.
    pub base: Base,
    /// Pivot B1 of the turn at the suction side.
    pub interior: InteriorPivot,
    outward: Turn,
}

impl Surroundings {
    fn limits(&self, limits: BaseLimits) -> Limits<'_> {
        let whole = |is_outside: bool| {
            let own = self.blades.iter().filter(move |near| near.is_own && (near.blade == 0) == is_outside);
            own.filter(move |_| limits == BaseLimits::WholeBlades).map(|near| &near.patch)
        };
        let [pressure, suction] = self.upper();
        Limits {
            outside: std::iter::once(&pressure.patch).chain(whole(true)).collect(),
            inside: std::iter::once(&suction.patch).chain(whole(false)).collect(),
            hollow: suction.tip_middle(),
        }
    }

    /// Computes base position and pivots for one direction of the tool. `None` if no position of the ring touches both blades as required.
    pub fn level_context(&self, request: &Request<'_>) -> Option<LevelContext<'_>> {
        let Surroundings { pressure, suction, .. } = self;
        let lines = [pressure.tip(pressure.edges[0]), suction.tip(suction.edges[1])];
        let base = settle(&self.limits(request.limits), request.cutter, lines)?;
        // Sense in which the outer circle, turned about A, approaches the pressure side's middle.
        let spoke = pressure.tip_middle() - base.exterior;
        let away = pressure.tip_middle() - suction.tip_middle();
        let outward = if spoke.perp(&away) >= 0.0 { Turn::Ccw } else { Turn::Cw };
        let interior = interior(suction, request.cutter, &base, outward, request.roughing.interior_contact)?;
        Some(LevelContext { around: self, base, interior, outward })
    }
}

impl LevelContext<'_> {
    /// Computes the ends of the turns on all levels, and the path from the highest material at the height `top_mm` down. Between slots the
    /// tool is lifted to the height `clear_mm`; the ring meets the blank at the height `contact_mm`.
    ///
    /// # Errors
    /// The cup's cavity is not deep enough for the blade in it, or there would be too many levels.
    pub fn path(
        &self,
        request: &Request<'_>,
        top_mm: f64,
        [clear_mm, contact_mm]: [f64; 2],
    ) -> Result<(Vec<[Stop; 2]>, SlotPath), Infeasible> {
        let LevelContext { around, base, interior, outward } = self;
        let Request { cutter, roughing, .. } = *request;
        let pivots = [base.exterior, interior.pivot];
        let turns = Turns { around, cutter, centre: base.centre, pivots, outward: *outward };
        let low_mm = turns.lowest_mm().ok_or(Infeasible::NoFloor)?;
        let tallest_mm = around.suction.patch.samples().map(|point| point.z).fold(f64::MIN, f64::max);
        let needed_mm = tallest_mm - low_mm;
        if needed_mm > cutter.cavity_depth_mm {
            return Err(Infeasible::Shallow { cavity_mm: cutter.cavity_depth_mm, needed_mm });
        }
        let depth_max_mm = roughing.axial_depth_max_mm;
        let depth_mm = (top_mm - low_mm).max(0.0);
        check_levels(depth_mm, depth_max_mm)?;
        let coarse_mm = request.levels_max.map_or(0.0, |levels| depth_mm / f64::from(levels));
        let heights = levels_mm(cutter, top_mm, low_mm, depth_max_mm.max(coarse_mm));
        let stops = turns.stops(&heights);
        let levels = heights.iter().zip(&stops).map(|(height_mm, [exterior, interior])| Level {
            height_mm: *height_mm,
            exterior_end: exterior.centre,
            interior_end: interior.centre,
        });
        let path = SlotPath {
            exterior: base.exterior,
            interior: interior.pivot,
            base: base.centre,
            outward: *outward,
            levels: levels.collect(),
            clear_mm,
            contact_mm,
        };
        Ok((stops, path))
    }
}
