//! Plan of a slot that removes most from it, over the tool's axis and the edges from which it starts, with its proof.
//!
//! The value of a plan is the fraction of the slot that it removes, between the blades and above the hub with their
//! allowances, in addition to earlier passes: the volume of the columns under the ring's path. Paths with few levels on samples of the surfaces are compared
//! first, then those with all levels on samples about the best of them, and at last exact ones.

use crate::axis_search::AxisSearch;
use crate::cup_mill::free_width::{FreeWidth, LEAN_STEP_RAD};
use crate::cup_mill::infeasibility::{Infeasible, check_levels};
use crate::cup_mill::neighbours::NEARER_RATIO;
use crate::cup_mill::normal_form::{GRAIN_MM, StartEdge};
use crate::cup_mill::plan::{AxisChoice, BaseLimits, PreparedSlot, Request, Roughing, SlotPlan, ValuedPlan};
use crate::cup_mill::turns::Surroundings;
use crate::cutter::CupMill;
use crate::geometry::blisk::{Blisk, Slot};
use crate::geometry::turning_height::highest_mm;
use crate::parallel;
use crate::path::Pass;
use crate::proof::earlier::{Earlier, EarlierFloor};
use crate::proof::floor::Floor;
use crate::proof::remaining::SlotWalls;
use crate::proof::removal::{Stock, slot_share_ratio};
use crate::proof::verdict::{Proof, ProofCase, ProofResolution, prove};
use crate::vector::Point;

/// A slot to be planned, with the cutter and the requirements, for a search of the plan that removes most.
pub struct Problem<'p> {
    blisk: &'p Blisk,
    cutter: &'p CupMill,
    roughing: &'p Roughing,
    fixture: &'p [[Point; 2]],
    /// Passes through the slot before this one, and the floors that they have left.
    earlier: Vec<Pass>,
    floors: Vec<EarlierFloor>,
    /// From the leading, and from the trailing edges.
    prepared: [PreparedSlot; 2],
}

/// Cell size for the comparison of full plans, mm.
const CELL_MM: f64 = 1.0;
/// The same for plans with few levels.
const COARSE_CELL_MM: f64 = 2.0;
/// Levels of plans that are compared first.
const COARSE_LEVELS: u32 = 6;
/// Least removed fraction of the slot that is worth a path.
const LEAST_RATIO: f64 = 0.02;
/// Number of plans that are proven before the search gives up.
const PROVEN_MAX: usize = 6;

impl<'p> Problem<'p> {
    /// Problem of a rotor, its slot (in the rotor's own frame), a cutter and the requirements.
    ///
    /// # Errors
    /// A blade does not reach the hub, there is no slot between the blades, or there would be too many levels.
    pub fn new(blisk: &'p Blisk, slot: &Slot, cutter: &'p CupMill, roughing: &'p Roughing) -> Result<Self, Infeasible> {
        let hub_radius_mm = blisk.hub.profile_mm.iter().map(|place| place[1]).fold(f64::INFINITY, f64::min);
        check_levels(blisk.blank.radius_mm - hub_radius_mm, roughing.axial_depth_max_mm)?;
        let half_slot_rad = core::f64::consts::PI / f64::from(blisk.blades) * blisk.slot_ratio();
        if blisk.blank.radius_mm * libm::cos(half_slot_rad) < hub_radius_mm {
            return Err(Infeasible::NoSlot { blades: blisk.count().unsigned_abs() });
        }
        let from = |start| PreparedSlot::new(blisk, slot, roughing.allowance_mm, start, Some(GRAIN_MM));
        let (leading, trailing) = parallel::join(|| from(StartEdge::Leading), || from(StartEdge::Trailing));
        let (earlier, floors) = (Vec::new(), Vec::new());
        Ok(Problem { blisk, cutter, roughing, fixture: &[], earlier, floors, prepared: [leading?, trailing?] })
    }

    /// The same problem with fixtures: boxes that turn with the rotor, each by two opposite corners in the rotor's own frame.
    #[must_use]
    pub fn with_fixture(self, fixture: &'p [[Point; 2]]) -> Self {
        Problem { fixture, ..self }
    }

    /// Passes through the slot before the one that is planned.
    pub fn earlier(&self) -> &[Pass] {
        &self.earlier
    }

    /// Makes this the problem of the next pass through the slot: a plan counts by what it removes in addition to this one.
    pub fn add_pass(&mut self, plan: &SlotPlan) {
        let pass = plan.pass();
        self.floors.push(EarlierFloor::new(self.cutter, &pass));
        self.earlier.push(pass);
    }

    /// Plan that removes most of the slot, among those that `admits` accepts; collisions are not checked.
    ///
    /// # Errors
    /// See [`Problem::ranked`].
    pub fn best(&self, admits: impl Fn(&SlotPlan) -> bool + Sync) -> Result<ValuedPlan, Infeasible> {
        self.ranked(admits).map(|mut ranked| ranked.swap_remove(0))
    }

    /// Plans that `admits` accepts, at least one, sorted by the fraction that they remove, the largest first. Without an accepted
    /// plan, the one with the tool axis of the largest free width.
    ///
    /// # Errors
    /// There is no plan at all; the reason is that for the tool axis with the largest free width.
    pub fn ranked(&self, admits: impl Fn(&SlotPlan) -> bool + Sync) -> Result<Vec<ValuedPlan>, Infeasible> {
        self.ranked_with(self.cutter, &admits)
    }

    /// Plan over the whole depth with the tool axis `axis`, from the edges from which it removes more.
    ///
    /// # Errors
    /// There is no plan with this axis.
    pub fn along(&self, axis: AxisChoice) -> Result<ValuedPlan, Infeasible> {
        self.along_with(self.cutter, axis)
    }

    fn along_with(&self, cutter: &CupMill, axis: AxisChoice) -> Result<ValuedPlan, Infeasible> {
        let from = |edge: usize| self.full(cutter, edge, axis, 0);
        match parallel::join(|| from(0), || from(1)) {
            (Ok(leading), Ok(trailing)) if trailing.share_ratio > leading.share_ratio => Ok(trailing),
            (Err(_), Ok(trailing)) => Ok(trailing),
            (leading, _) => leading,
        }
    }

    /// Best plan that is proven free of collisions, with its proof; if there is none, the best plan with its failed proof. Plans that
    /// `admits` rejects do not count as proven. With `axis` only the plan along this axis is tried.
    ///
    /// # Errors
    /// There is no plan at all.
    pub fn proven(
        &self,
        axis: Option<AxisChoice>,
        admits: impl Fn(&SlotPlan) -> bool + Sync,
    ) -> Result<(ValuedPlan, Proof), Infeasible> {
        self.proven_with(self.cutter, axis, &admits)
    }

    /// Fraction of the slot that another cutter removes, by its plan with the tool axis `axis` or, without it, by its best proven plan.
    ///
    /// # Errors
    /// There is no plan, or none that is proven free of collisions.
    pub fn share_ratio(
        &self,
        cutter: &CupMill,
        axis: Option<AxisChoice>,
        admits: &(dyn Fn(&SlotPlan) -> bool + Sync),
    ) -> Result<f64, Infeasible> {
        let (_, proof) = self.proven_with(cutter, axis, admits)?;
        if self.holds(&proof) { Ok(proof.removed.share_ratio()) } else { Err(Infeasible::Unproven) }
    }

    fn proven_with(
        &self,
        cutter: &CupMill,
        axis: Option<AxisChoice>,
        admits: &(dyn Fn(&SlotPlan) -> bool + Sync),
    ) -> Result<(ValuedPlan, Proof), Infeasible> {
        let ranked = match axis {
            Some(axis) => vec![self.along_with(cutter, axis)?],
            None => self.ranked_with(cutter, admits)?,
        };
        self.first_proven(cutter, ranked)
    }

    fn holds(&self, proof: &Proof) -> bool {
        let allowance_mm = self.roughing.allowance_mm;
        proof.holds(allowance_mm, NEARER_RATIO * allowance_mm)
    }

    fn first_proven(&self, cutter: &CupMill, ranked: Vec<ValuedPlan>) -> Result<(ValuedPlan, Proof), Infeasible> {
        let allowance_mm = self.roughing.allowance_mm;
        let mut first = None;
        for valued in ranked.into_iter().take(PROVEN_MAX) {
            let case = ProofCase {
                blisk: self.blisk,
                tool: cutter,
                path: &valued.plan.path,
                to_slot: valued.plan.turn,
                allowance_mm,
                fixture: self.fixture,
                earlier: &self.earlier,
            };
            let proof = prove(&case, &ProofResolution::default()).ok_or(Infeasible::NoFoot("pressure"))?;
            if self.holds(&proof) {
                return Ok((valued, proof));
            }
            first.get_or_insert((valued, proof));
        }
        first.ok_or(Infeasible::NoAxis)
    }

    fn ranked_with(
        &self,
        cutter: &CupMill,
        admits: &(dyn Fn(&SlotPlan) -> bool + Sync),
    ) -> Result<Vec<ValuedPlan>, Infeasible> {
        let on_samples = |levels_max: u32, cell_mm: f64| {
            move |edge: usize, free_width: FreeWidth, uncut_eighths: usize| {
                let roughing = Roughing { axis: AxisChoice::Found(free_width), ..*self.roughing };
                let levels_max = Some(levels_max);
                let request = Request { uncut_eighths, levels_max, ..Request::whole(cutter, &roughing) };
                let valued = self.valued(edge, &request, cell_mm).ok()?;
                (valued.share_ratio >= LEAST_RATIO && admits(&valued.plan)).then_some(valued)
            }
        };
        let full = |edge: usize, free_width: FreeWidth, uncut_eighths: usize| {
            let valued = self.full(cutter, edge, AxisChoice::Found(free_width), uncut_eighths).ok()?;
            admits(&valued.plan).then_some(valued)
        };
        let prepared = &self.prepared;
        let step_rad = LEAN_STEP_RAD / 2.0;
        let few = AxisSearch { prepared, cutter, step_rad, value: &on_samples(COARSE_LEVELS, COARSE_CELL_MM) };
        let all = AxisSearch { prepared, cutter, step_rad, value: &on_samples(u32::MAX, CELL_MM) };
        let exact = AxisSearch { prepared, cutter, step_rad: LEAN_STEP_RAD / 4.0, value: &full };
        let along = |axis: AxisChoice| self.along_with(cutter, axis);
        let (found, (blade, roomiest)) = parallel::join(
            || exact.near(&all.near(&few.best())),
            || parallel::join(|| along(AxisChoice::Blade), || along(AxisChoice::Roomiest)),
        );
        let found = found.into_iter().map(|one| Ok(one.valued));
        let all = found.chain([blade, roomiest.clone()]).flatten();
        let mut admitted: Vec<ValuedPlan> = all.filter(|valued| admits(&valued.plan)).collect();
        admitted.sort_by(|a, b| b.share_ratio.total_cmp(&a.share_ratio));
        if admitted.is_empty() { roomiest.map(|plan| vec![plan]) } else { Ok(admitted) }
    }

    /// Plan with all levels.
    fn full(
        &self,
        cutter: &CupMill,
        edge: usize,
        axis: AxisChoice,
        uncut_eighths: usize,
    ) -> Result<ValuedPlan, Infeasible> {
        let roughing = Roughing { axis, ..*self.roughing };
        self.valued(edge, &Request { uncut_eighths, ..Request::whole(cutter, &roughing) }, CELL_MM)
    }

    fn valued(&self, edge: usize, request: &Request<'_>, cell_mm: f64) -> Result<ValuedPlan, Infeasible> {
        let Request { cutter, roughing, .. } = *request;
        let prepared = &self.prepared[edge];
        let (mut plan, mut around) = prepared.plan(request)?;
        let bottom_mm = plan.path.levels.last().map_or(f64::NEG_INFINITY, |level| level.height_mm);
        if around.cuts_edge(cutter, plan.base.centre, bottom_mm)
            && let Ok(whole) = prepared.plan(&Request { limits: BaseLimits::WholeBlades, ..*request })
        {
            (plan, around) = whole;
        }
        let blisk = &prepared.blisk;
        let Surroundings { pressure, suction, .. } = around;
        let walls = SlotWalls::between([pressure, suction], &blisk.hub, roughing.allowance_mm, plan.turn);
        let earlier = Earlier::new(&self.floors, prepared.to_part() * plan.turn.matrix().transpose());
        let stock = Stock { blank: &blisk.blank, to_slot: plan.turn, earlier };
        let floor = Floor::new(cutter, &plan.path.steps());
        let share_ratio = slot_share_ratio(&floor, plan.path.levels.len(), &stock, &walls, cell_mm);
        let mut plan = prepared.restored(plan);
        let turning_mm = highest_mm(&self.blisk.blank, self.fixture, &plan.turn);
        plan.path.clear_mm = plan.path.clear_mm.max(turning_mm + roughing.clearance_mm);
        Ok(ValuedPlan { plan, share_ratio })
    }
}
